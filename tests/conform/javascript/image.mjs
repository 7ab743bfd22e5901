// Reads an image as bytecode_spec.md says, and refuses it with the first reason that applies.
// It knows no instruction but by the verifier and the decoder.

import { decode } from "./opcodes.mjs";
import { verify } from "./verifier.mjs";

export class Refused extends Error {}

const CRC = new Uint32Array(256).map((_, byte) => {
  let crc = byte;
  for (let bit = 0; bit < 8; bit++) crc = crc & 1 ? (crc >>> 1) ^ 0xedb88320 : crc >>> 1;
  return crc;
});

/** CRC-32 as zlib has it. */
export function crc32(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = (crc >>> 8) ^ CRC[(crc ^ byte) & 255];
  return ~crc >>> 0;
}

/** The hash of a device from its line, without the line feed. */
function deviceHash(line) {
  const low = crc32(new TextEncoder().encode(`${line}\n`)) & 0xffff;
  return low === 0 ? 0xffff : low;
}

/** The `devices` that code gives with the devices of a kit. */
function devicesOf(code, kit) {
  const hashes = { sensor: kit.sensors.map((d) => deviceHash(d.line)), actuator: kit.actuators.map((d) => deviceHash(d.line)) };
  let sum = 0;
  for (let at = 0; at < code.length; ) {
    const { operands, after } = decode(code, at);
    for (const { kind, value } of operands) {
      if (!(kind in hashes)) continue;
      sum = ((sum << 1) & 0xffff) ^ (sum & 0x8000 ? 0x002d : 0) ^ hashes[kind][value];
    }
    at = after;
  }
  return sum;
}

/** The code of an image that a machine of version 2.0 with this kit may run; throws Refused. */
export function readImage(bytes, kit) {
  const refuse = (reason) => {
    throw new Refused(reason);
  };
  if (bytes[0] !== 0x54 || (bytes.length > 1 && bytes[1] !== 0x53)) refuse("NOT_AN_IMAGE");
  if (bytes.length < 4) refuse("TRUNCATED");
  if (bytes[2] !== 2 || bytes[3] > 0) refuse("OTHER_VERSION");
  if (bytes.length < 15) refuse("TRUNCATED");
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  const headerLength = bytes[5];
  const codeLength = view.getUint16(8, true);
  if (headerLength < 15 || codeLength > 32767) refuse("BAD_HEADER");
  const end = headerLength + codeLength;
  if (bytes.length < end) refuse("TRUNCATED");
  if (bytes.length > end) refuse("TRAILING");
  const covered = new Uint8Array(end - 4);
  covered.set(bytes.subarray(0, 10));
  covered.set(bytes.subarray(14), 10);
  if (crc32(covered) !== view.getUint32(10, true)) refuse("DAMAGED");
  if (bytes[14] !== 0) refuse("UNKNOWN_NEEDS");
  if (bytes[4] > 2) refuse("UNKNOWN_START");
  if (bytes[4] === 2 && codeLength > 0) refuse("PING_WITH_CODE");
  const code = bytes.subarray(headerLength);
  const broken = verify(code, kit.sensors.length, kit.actuators.length);
  if (broken !== null) refuse(`${broken.rule} ${broken.at}`);
  if (devicesOf(code, kit) !== view.getUint16(6, true)) refuse("OTHER_KIT");
  return code;
}
