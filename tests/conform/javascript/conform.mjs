// Takes runs on standard input and prints their traces, as docs/conformance.md says.

import { createInterface } from "node:readline";
import { readImage, Refused } from "./image.mjs";
import { Fault, Machine } from "./machine.mjs";

const yesOrNo = (value) => (value === 0 ? "FALSE" : "TRUE");

/** The shortest decimal of a count of thousandths. */
function decimal(value) {
  const size = Math.abs(value);
  const digits = `${Math.floor(size / 1000)}.${String(size % 1000).padStart(3, "0")}`;
  return (value < 0 ? "-" : "") + digits.replace(/\.?0+$/, "");
}

const printed = (device, value) => (device.kind === "yes/no" ? yesOrNo(value) : decimal(value));

function device(line) {
  const [, name, kind, , low, high] = line.split(" ");
  return { line, name, kind, low: Number(low), high: Number(high), readings: [] };
}

function freshRun() {
  return { sensors: [], actuators: [], seed: 1, begin: 0, every: [1], until: 0, image: new Uint8Array() };
}

function take(run, line) {
  const [word, ...rest] = line.split(" ");
  if (word === "sensor") run.sensors.push(device(line));
  else if (word === "actuator") run.actuators.push(device(line));
  else if (word === "readings") run.sensors[rest[0]].readings = rest.slice(1).map(Number);
  else if (word === "every") run.every = rest.map(Number);
  else if (word === "image") run.image = Uint8Array.from(Buffer.from(rest[0] ?? "", "hex"));
  else run[word] = Number(rest[0]);
}

/** The milliseconds since the start are counted here without a bound; the machine gets them modulo 2^32. */
function perform(run) {
  let elapsed = 0;
  const out = [];
  const say = (text) => out.push(`${elapsed} ${text}`);
  const robot = {
    motors: (left, right) => say(`MOTORS ${left + 0} ${right + 0}`),
    read: (number) => {
      const sensor = run.sensors[number];
      const value = (sensor.readings.length > 1 ? sensor.readings.shift() : sensor.readings[0]) ?? 0;
      say(`READ ${sensor.name} ${printed(sensor, value)}`);
      return value;
    },
    showNumber: (value) => say(`SHOW ${decimal(value)}`),
    showYesNo: (value) => say(`SHOW ${yesOrNo(value)}`),
    set: (number, value, rounded) => {
      const { name, kind, low, high } = run.actuators[number];
      say(`SET ${name} ${kind === "yes/no" ? yesOrNo(value) : decimal(Math.min(Math.max(rounded, low), high))}`);
    },
    beep: (hertz, ms) => say(`BEEP ${hertz} ${ms}`),
  };
  try {
    const machine = new Machine(readImage(run.image, run), robot, run.seed, run.begin);
    for (;;) {
      machine.turn(run.begin + elapsed);
      if (machine.ended) break;
      const wait = (machine.clock - run.begin - elapsed) >> 0;
      const every = run.every.length > 1 ? run.every.shift() : run.every[0];
      const next = Math.ceil(Math.max(elapsed + wait, elapsed) / every) * every;
      if (next > run.until) {
        elapsed = run.until;
        say("LIMIT");
        return out;
      }
      elapsed = next;
    }
    say("DONE");
  } catch (error) {
    if (error instanceof Refused) out.push(`REFUSED ${error.message}`);
    else if (error instanceof Fault) say(`FAULT ${error.message}`);
    else throw error;
  }
  return out;
}

let run = freshRun();
for await (const line of createInterface({ input: process.stdin })) {
  if (line === "run") {
    process.stdout.write(`${perform(run).join("\n")}\n`);
    run = freshRun();
  } else take(run, line);
}
