// The part of the page with a real robot: how it is reached, what it is told, and what it says.
// Everything that a robot says is put there as text, never as markup.

import { element } from '../page/elements.js';
import { whenEscaped } from '../page/escape.js';
import { faultSaid } from '../page/faults.js';
import { bytesOf, whenChosen } from '../page/files.js';
import { chosenDevice, BluetoothPort, hasBluetooth } from './bluetooth.js';
import { Debugging } from './debugging.js';
import { Doing } from './doing.js';
import { DirectRobot } from './direct.js';
import { hasHost, hostPorts, HostRobot, isPupil, isTeacher } from './host.js';
import { Flashing } from './flashing.js';
import { readTrim, showTrim } from './trim.js';
import { chosenPort, hasSerial, knownPorts, SerialPort } from './serial.js';
import { refusal, shown } from './plain_text.js';
import { stopAll } from './stops.js';
import { Stopping } from './stopping.js';
import { Speech } from './speech.js';
import { Failed } from './transport.js';
import { Watching } from './watching.js';
import { keepAt, kept } from '../page/kept.js';
import { drawnPicture, offer, pictured } from '../page/pictures.js';
import { pageState } from '../page/page_state.js';
import { called, currentLanguage, text } from '../page/texts.js';
import { isRobot, LINK, robotOf } from '../page/words.js';
import { whole } from '../writing/messages.js';
import { nameOfShow, showAt } from '../writing/shows.js';

/** @typedef {import('../python.js').Checked} Checked */
/** @import { About, Answer, RobotEvent, Transport } from './transport.js' */
/** @typedef {RobotEvent & {number: number, nth?: number, robot?: string}} Witnessed of the group's robot: the number among all news, and that of a value in its run */
/** @typedef {{label: string, drawn: string, connect: () => Promise<void>, serial?: any}} Choice */

/**
 * @typedef {object} Page what the panel uses of the page
 * @property {import('../python.js').Python} python
 * @property {(place: import('../writing/editor.js').Range) => void} goTo
 * @property {import('./recorder.js').Recorder} recorder of what the robot tells
 * @property {import('./place.js').RobotPlace} place where its program is
 * @property {import('../remote/pad.js').Pad} pad
 */

// The keys of robots that this browser keeps: the text of a file of keys, as `tsc set owner --list` writes it. Who uses
// this browser uses them; the page gives them to no one but the robot's session.
const KEYS = 'tiniscript.link.keys';
const KNOWN = 20;
const PORT_MS = 2500; // after which it is said that nothing answers at a port yet
const WORD_MS = 2000; // after which it is said that the robot has not answered yet

export class RobotPanel {
  #page;
  /** @type {Transport | null} */
  #way = null;
  /** @type {About | null} */
  #about = null;
  #isBusy = false;
  #stops = 0; // that were pressed
  /** @type {Choice[]} */
  #choices = [];
  /** Words of a remote control that the newest program reads. @type {string[]} */
  #reads = [];
  /** @type {Checked | null} */
  #sent = null;
  /** The newest programs and lines that were sent, by checksum: what they show is named. @type {Map<string, Checked>} */
  #known = new Map();
  /** The text of what runs, as it was when that began: another one may have the same code. @type {Checked | undefined} */
  #running;
  #speech = new Speech();
  #stopping = new Stopping(this.#speech);
  #debugging;
  #doing = new Doing();
  #watching;
  /** @type {Flashing} */
  #flashing;
  #whenLeft = () => {};
  #line = ''; // the checksum of the newest line
  #isWitness = false; // of a run on the robot of the group, which another page drives
  #values = 0; // of that run, until now
  #list = element('link_port', HTMLSelectElement);
  #typed = element('link_line', HTMLInputElement);

  /** @param {Page} page */
  constructor(page) {
    this.#page = page;
    this.#debugging = new Debugging({
      ask: (request, done, isQuiet) => {
        if (request['do'] === 'resume') this.#doing.goesOn();
        return this.#ask(request, done, isQuiet);
      },
      uploadPaused: () => this.#upload(true, true),
      say: (key, values) => this.#speech.say(key, values),
      place: page.place,
      recorder: page.recorder,
      canGetHalting: () => this.#flashing.canHalt(),
      getHalting: () => this.#getHalting(),
    });
    this.#watching = new Watching({
      python: page.python,
      ask: (request, isQuiet) => this.#askNow(request, () => {}, isQuiet),
      say: (key) => this.#speech.say(key),
      tell: (isOn) => this.#doing.watch(isOn),
    });
    for (const [id, act] of /** @type {[string, () => void][]} */ ([
      ['link_look', () => this.#look()],
      ['link_connect', () => this.#choices[this.#list.selectedIndex]?.connect()],
      ['link_serial', () => this.#bySerial(chosenPort())],
      ['link_bluetooth', () => this.#byBluetooth()],
      ['link_leave', () => this.#way?.leave()],
      ['link_identify', () => this.#ask({ do: 'identify' }, () => this.#speech.say('say_identify', { name: this.#name }))],
      ['link_upload', () => this.#upload(true)],
      ['link_send', () => this.#upload(false)],
      ['link_start', () => this.#debugging.startAgain()],
      ['link_rename', () => this.#rename()],
      ['trim_set', () => this.#trim()],
      ['trim_try', () => this.#live('F(2, 60)')],
      ['keys_claim', () => this.#claim()],
      ['keys_import', () => element('keys_file', HTMLInputElement).click()],
    ])) element(id, HTMLButtonElement).addEventListener('click', act);
    element('link_live', HTMLFormElement).addEventListener('submit', (event) => {
      event.preventDefault();
      this.#live(this.#typed.value);
    });
    whenChosen('keys_file', (file) => this.#import(file));
    this.#flashing = new Flashing({
      speech: this.#speech,
      port: () => this.#choices[this.#list.selectedIndex]?.serial,
      isFree: () => this.isFree,
      setBusy: (isBusy) => {
        this.#isBusy = isBusy;
        this.#show();
      },
      meet: (port) => this.#bySerial(Promise.resolve(port)),
    });
    element('stop', HTMLButtonElement).addEventListener('click', () => this.stop());
    whenEscaped(() => this.stop());
    document.addEventListener('visibilitychange', () => {
      if (document.visibilityState === 'hidden') this.#hide();
    });
    for (const name of ['pagehide', 'freeze']) addEventListener(name, () => this.#way?.leave());
    pageState.language.subscribe(() => this.#show());
    pageState.checked.subscribe((checked) => {
      if (pageState.group.value && checked?.image) this.#expect(checked); // whoever of the group runs it
      this.#offer();
    });
    this.#show();
    this.#look();
  }

  get #name() {
    const about = this.#about;
    if (!about) return '';
    return shown(about.name) || called(robotOf(about.robot ?? '')?.labels ?? {}) || about.id;
  }

  /** Sends the program and runs it, or says that no robot is there. */
  run() {
    if (this.#way) this.#upload(true);
    else if (!this.#isBusy) this.#speech.say('say_no_robot');
  }

  get isFree() { return !this.#isBusy && !this.#way; }

  /** Stops the robot; a page without one, or a teacher's, stops all that its `tsc studio` has. */
  stop() {
    if (hasHost && (isTeacher || !this.#way)) stopAll();
    this.#stop();
  }

  /** @param {string} [confirmed] a text, once it is */
  #stop(confirmed = '') {
    if (!this.#way) return;
    this.#stops += 1;
    this.#debugging.stop();
    this.#watching.stop();
    this.#way.stop();
    this.#stopping.begin(confirmed);
  }

  #hide() {
    if (!this.#way) return;
    this.stop();
    this.#stopping.begin('say_hidden');
  }

  // -- connecting ---------------------------------------------------------------------------------

  /** Lists what can be reached, and opens nothing. */
  async #look() {
    if (isPupil) return; // whose robot is the one of the turn
    /** @type {Choice[]} */
    const found = [];
    let failed = null;
    if (hasHost) {
      try {
        for (const { port, name, description, virtual } of await hostPorts()) {
          const about = virtual === null ? description : `${text('virtual_known')} ${virtual}`;
          const label = shown([name, about, port].filter(Boolean).join(' · '));
          found.push({ label, drawn: virtual === null ? 'drawn_plug' : 'drawn_robot', connect: () => this.byHost(port) });
        }
      } catch (why) {
        failed = why;
      }
    }
    for (const [k, port] of (await knownPorts()).entries()) {
      found.push({ label: text('serial_known', { number: k + 1 }), drawn: 'drawn_plug', connect: () => this.#bySerial(Promise.resolve(port)), serial: port });
    }
    this.#choices = found;
    offer(this.#list, found.map(({ label, drawn }) => pictured(label, label, drawnPicture(drawn))));
    this.#show();
    if (this.#way) return;
    if (failed instanceof Failed) this.#speech.fail(failed);
    else if (found.length) this.#speech.say('say_choose');
    else if (hasHost) this.#speech.say('say_none');
    else this.#speech.say(hasSerial || hasBluetooth ? 'say_ways' : 'say_no_way');
  }

  /** Connects through `tsc studio`; a pupil's port is that of the turn. @param {string} port */
  byHost(port = 'turn') {
    return this.#connect(async (heard) => {
      const way = new HostRobot(heard);
      return { way, met: way.connect(port, pageState.robotName.value, currentLanguage()) };
    });
  }

  /** @param {Promise<any>} chosen */
  #bySerial(chosen) {
    return this.#connect(async (heard) => this.#direct(new SerialPort(await chosen, this.#baud), heard));
  }

  #byBluetooth() {
    const chosen = chosenDevice();
    return this.#connect(async (heard) => this.#direct(new BluetoothPort(await chosen, this.#baud), heard));
  }

  get #baud() {
    return robotOf(pageState.robotName.value)?.baud ?? 9600;
  }

  /** @param {import('./direct.js').Port} port @param {import('./transport.js').Heard} heard */
  #direct(port, heard) {
    const way = new DirectRobot(this.#page.python, port, heard, (keys) => keepAt(KEYS, keys));
    return { way, met: way.connect(pageState.robotName.value, currentLanguage(), kept(KEYS)) };
  }

  /** @param {(heard: import('./transport.js').Heard) => Promise<{way: Transport, met: Promise<About>}>} open */
  async #connect(open) {
    if (this.#isBusy || this.#way) return;
    this.#isBusy = true;
    this.seeNothing();
    this.#speech.say('say_connecting');
    this.#show();
    const word = setTimeout(() => this.#speech.say('say_nothing_yet'), PORT_MS);
    /** @type {Transport | null} */
    let way = null;
    const heard = {
      event: (/** @type {RobotEvent} */ event) => this.#hear(event),
      over: (/** @type {Failed} */ why) => {
        if (this.#way && this.#way === way) this.#end(why);
      },
    };
    try {
      const opened = await open(heard);
      way = this.#way = opened.way; // STOP reaches it from now on
      this.#show();
      const about = await opened.met;
      clearTimeout(word);
      this.#about = about;
      this.#begin(about);
    } catch (why) {
      if (this.#way === way) this.#end(why instanceof Failed ? why : new Failed('bug', String(why))); // else it was told
    } finally {
      clearTimeout(word);
      this.#isBusy = false;
      this.#show();
    }
  }

  /** @param {About} about */
  #begin(about) {
    this.#speech.clear();
    this.#debugging.meet(about);
    this.#doing.meet(about);
    const isOther = about.robot !== null && about.robot !== pageState.robotName.value;
    if (about.robot !== null && isOther) pageState.robotName.set(about.robot);
    if (about.owner === 'other') this.#speech.say('say_owned', { name: this.#name });
    else if (isOther) this.#speech.say('say_other_kit', { name: this.#name, robot: String(about.robot) });
    else this.#speech.say('say_connected', { name: this.#name });
    element('link_rename_to', HTMLInputElement).value = shown(about.name);
    this.#watching.meet(about);
    this.#page.recorder.meet(about);
    this.#way?.ask({ do: 'trim' }).then(({ trim }) => trim && showTrim(trim)).catch(() => {});
  }

  /** @param {Failed} why */
  #end(why) {
    this.#way = null;
    this.#about = null;
    this.#sent = null;
    this.#running = undefined;
    this.#page.recorder.end('LOST');
    this.#page.place.end();
    this.#debugging.meet(null);
    this.#doing.meet(null);
    this.#watching.meet(null);
    const unconfirmed = this.#stopping.end();
    this.#speech.fail(why, unconfirmed);
    this.#show();
    this.#whenLeft();
  }

  // -- what the robot is told ---------------------------------------------------------------------

  /**
   * @param {Record<string, unknown>} request
   * @param {(answer: Answer) => void} [done]
   * @param {boolean} [isQuiet] about how it fails
   * @returns {Promise<Answer | null>} null if it failed
   */
  async #ask(request, done = () => {}, isQuiet = false) {
    const makesWay = this.#about && this.#watching.before(request);
    if (makesWay) await makesWay;
    const answer = await this.#askNow(request, done, isQuiet);
    this.#watching.after(request);
    return answer;
  }

  /**
   * @param {Record<string, unknown>} request
   * @param {(answer: Answer) => void} done
   * @param {boolean} isQuiet
   * @returns {Promise<Answer | null>}
   */
  async #askNow(request, done, isQuiet) {
    if (!this.#way || !this.#about) return null;
    const isSaid = isQuiet || request['do'] === 'upload' || request['do'] === 'claim'; // what it waits for
    const word = isSaid ? 0 : setTimeout(() => this.#speech.say('say_waits'), WORD_MS);
    try {
      const answer = await this.#way.ask(request);
      clearTimeout(word);
      if (answer.ok) done(answer);
      else if (!isQuiet) this.#speech.fail(new Failed(answer.failure ?? 'bug', refusal(answer)));
      return answer.ok ? answer : null;
    } catch {
      return null; // it is over, and that was said
    } finally {
      clearTimeout(word);
    }
  }

  /** @param {boolean} runs @param {boolean} isPaused before its first instruction */
  #upload(runs, isPaused = false) {
    const program = pageState.checked.value;
    if (!program?.image) {
      this.#page.python.again(currentLanguage());
      this.#speech.say(program ? 'first_repair' : 'press_again'); // a robot does not start late by itself
      if (runs && program) this.#stop('say_broken'); // what runs is not what is seen
      return;
    }
    this.#speech.begin('say_sending');
    this.#expect(program);
    const start = this.#debugging.sends(program, isPaused);
    this.#ask({ do: 'upload', image: program.image, robot: pageState.robotName.value, runs: runs && !start }, (answer) => {
      const { program: sum = '', saved = 'MEMORY' } = answer;
      this.#sent = program;
      this.#offer();
      if (runs && program.start === 'SB') this.#page.recorder.wait(sum);
      if (program.start === 'SB') this.#doing.waits();
      this.#speech.say('say_receipt', {}, `saved_${saved}`);
      start?.(runs && program.start === 'SI');
    });
  }

  /** A robot is driven by hand where the program that it has from here, or that is seen, reads a remote control. */
  #offer() {
    const reads = this.#sent?.remote.length ? this.#sent.remote : pageState.checked.value?.remote ?? this.#reads;
    this.#reads = reads;
    const about = this.#about;
    this.#page.pad.offer('link', about && reads.length ? {
      reads,
      isDeaf: !about.has_remote,
      tell: (held) => this.#press(held),
    } : null);
  }

  /** @param {import('../remote/held.js').Held} held */
  async #press(held) {
    const answer = await this.#way?.press(held).catch(() => null); // it is over, and that was said
    if (!answer?.said) return; // it has heard it, or the next word
    this.#page.pad.letGo(); // it is not asked again and again
    this.#speech.fail(new Failed(answer.failure ?? 'bug', refusal(answer)));
  }

  /** Runs a line now. @param {string} line */
  async #live(line) {
    if (!line.trim() || !this.#about) return;
    const stops = this.#stops;
    const robot = pageState.robotName.value;
    const data = new TextEncoder().encode(`SI|${line}`);
    /** @type {Checked} */
    const found = await this.#page.python.ask({ do: 'check', robot, language: currentLanguage() }, data);
    if (stops !== this.#stops) return; // STOP was pressed since
    const mistake = found.findings.find((each) => each.severity === 'mistake');
    if (mistake) {
      this.#speech.tell(whole(mistake));
      return;
    }
    this.#know(found);
    this.#line = found.program;
    await this.#ask({ do: 'live', image: found.image, robot }, () => this.#speech.say('say_line'));
  }

  #rename() {
    const name = element('link_rename_to', HTMLInputElement).value.trim();
    if (!name || new TextEncoder().encode(name).length > LINK.name_bytes) return;
    this.#ask({ do: 'name', name }, () => {
      if (this.#about) this.#about = { ...this.#about, name };
      this.#speech.say('say_named', { name: shown(name) });
      this.#show();
    });
  }

  #trim() {
    this.#ask({ do: 'trim', trim: readTrim() }, ({ trim }) => {
      if (trim) showTrim(trim);
      this.#speech.say('say_trimmed');
    });
  }

  /** Its firmware is to be one with breakpoints: the port has to be free. */
  async #getHalting() {
    const left = new Promise((resolve) => { this.#whenLeft = () => resolve(null); });
    this.#way?.leave();
    if (this.#way) await left;
    await this.#flashing.offerHalting();
    this.#speech.say('say_halting_firmware');
  }

  #claim() {
    this.#speech.say('say_claiming');
    const isHost = this.#way instanceof HostRobot;
    this.#ask({ do: 'claim' }, () => this.#speech.say(isHost ? 'say_claimed_here' : 'say_claimed'));
  }

  /** @param {File} file with keys */
  async #import(file) {
    if (this.#way instanceof HostRobot) {
      this.#speech.say('say_keys_host');
      return;
    }
    try {
      const found = await this.#page.python.ask({ do: 'import_keys', kept: kept(KEYS) }, await bytesOf(file));
      if (found.count) keepAt(KEYS, found.keys);
      this.#speech.say(found.count ? 'say_keys' : 'say_no_keys', { count: found.count });
    } catch {
      this.#speech.say('say_no_keys');
    }
  }

  // -- what the robot says ------------------------------------------------------------------------

  /** @param {RobotEvent} event */
  #hear(event) {
    const isTyped = event.program === this.#line;
    if (this.#watching.onEvent(event, isTyped)) return;
    this.#page.recorder.onEvent(event);
    this.#page.place.onEvent(event);
    this.#doing.onEvent(event, isTyped, this.#textOf(event.program) !== undefined);
    this.#onEvent(event);
    this.#debugging.onEvent(event);
  }

  /** @param {RobotEvent} event */
  #onEvent(event) {
    if (event.event === 'SHOW') this.#speech.add([this.#nameOf(event), event.value].filter(Boolean).join(' '));
    else if (event.event === 'TEXT') this.#speech.add(text('say_text', { said: shown(String(event.text)) }));
    else if (event.event === 'MISSED') this.#speech.add(text('say_missed', { count: Number(event.count) }));
    else if (event.event === 'DONE') this.#speech.say('say_done');
    else if (event.event === 'FAULT') this.#fault(event, this.#sent, true);
    else if (event.event === 'LOST') this.#lose();
    else if (event.event === 'STARTED') {
      this.#stopping.forget();
      this.#running = this.#textOf(event.program);
    } else if (event.event === 'STOPPING') this.#stopping.begin();
    else if (event.event === 'RESTARTED') this.#speech.say('why_restarted');
    else if (event.event === 'STOPPED') {
      this.#page.pad.letGo();
      // A page that is hidden keeps the words why it stopped the robot.
      if (this.#stopping.isOpen || document.visibilityState !== 'hidden') this.#stopping.confirm(String(event.cause));
    }
  }

  // -- what the robot of the group says -----------------------------------------------------------

  /** The robot of the group, which another page drives, has told this. @param {Witnessed} event */
  witness(event) {
    if (this.#way || this.#isBusy) return;
    const { event: what, program, robot = '', nth } = event;
    if (what === 'ROBOT') {
      if (isRobot(robot) && robot !== pageState.robotName.value) pageState.robotName.set(robot);
      return;
    }
    if (what === 'STARTED') {
      const seen = pageState.checked.value;
      if (seen?.image && seen.program === program) this.#expect(seen);
      this.#isWitness = true;
      this.#values = 0;
      this.#speech.begin('group_runs');
      this.#show();
    }
    if (nth) {
      const count = nth - this.#values - 1;
      this.#values = nth;
      if (count > 0) this.#see({ event: 'MISSED', count });
    }
    this.#see(event);
  }

  /** @param {RobotEvent} event */
  #see(event) {
    this.#page.recorder.onEvent(event);
    this.#page.place.onEvent(event);
    if (event.event === 'OVER') this.#speech.say('group_run_over');
    else if (event.event === 'STOPPED') this.#stopping.confirm(String(event.cause));
    else if (event.event === 'FAULT') this.#fault(event, this.#textOf(event.program), false);
    else this.#onEvent(event);
  }

  /** Nobody tells this page of the group's robot any more. */
  seeNothing() {
    if (!this.#isWitness) return;
    this.#isWitness = false;
    this.#page.recorder.end('LOST');
    this.#page.place.end();
    this.#show();
  }

  /** @param {Checked} program that the robot may run as the page's own */
  #expect(program) {
    this.#know(program);
    this.#page.recorder.sends(program);
  }

  /** @param {Checked} program before its robot may show anything */
  #know(program) {
    this.#known.delete(program.program);
    this.#known.set(program.program, program);
    for (const [oldest] of this.#known) if (this.#known.size > KNOWN) this.#known.delete(oldest);
  }

  /** The text of a program, if it is one of this page. @param {string} [program] */
  #textOf(program = '') {
    const seen = pageState.checked.value;
    return this.#known.get(program) ?? (program && seen?.program === program ? seen : undefined);
  }

  /** The name of a value; nothing where its program is not one of this page. @param {RobotEvent} event */
  #nameOf({ program, at }) {
    if (!program) return '';
    if (this.#running?.program !== program) this.#running = this.#textOf(program);
    const show = this.#running && showAt(this.#running, at);
    return show ? nameOfShow(show, show[1], false) : '';
  }

  /** The robot is silent. */
  #lose() {
    if (this.#stopping.isOpen) this.#stopping.giveUp();
    else this.#speech.say('why_link_lost');
  }

  /** @param {RobotEvent} event @param {Checked | null | undefined} of a program @param {boolean} goes whether the caret goes there */
  #fault(event, of, goes) {
    const what = faultSaid(event.fault);
    const place = of?.program === event.program ? of?.places.findLast(([at]) => at <= Number(event.at)) : undefined;
    if (!place) {
      this.#speech.tell(what);
      return;
    }
    const [, line, column, end_line, end_column] = place;
    this.#speech.tell(text('say_fault', { line, what }));
    // else the places are those of another text
    if (goes && pageState.checked.value === of) this.#page.goTo({ line, column, end_line, end_column });
  }

  #show() {
    const isThere = this.#about !== null;
    element('link_ways', HTMLElement).hidden = this.#way !== null;
    element('link_drive', HTMLElement).hidden = !isThere && !this.#isWitness;
    element('link_drive', HTMLElement).classList.toggle('witness', !isThere);
    element('link_connected', HTMLElement).hidden = this.#way === null;
    element('link_name', HTMLElement).textContent = this.#name;
    element('link_serial', HTMLButtonElement).hidden = !hasSerial;
    element('link_bluetooth', HTMLButtonElement).hidden = !hasBluetooth;
    element('link_ports', HTMLElement).hidden = !hasHost && !this.#choices.length;
    element('link_identify', HTMLButtonElement).hidden = !isThere;
    element('link_settings', HTMLElement).hidden = !isThere;
    element('flash', HTMLElement).classList.toggle('away', this.#way !== null);
    for (const id of ['link_connect', 'link_serial', 'link_bluetooth', 'flash_write', 'flash_open']) element(id, HTMLButtonElement).disabled = this.#isBusy;
    this.#offer();
    document.documentElement.dataset['robot'] = isThere ? 'connected' : this.#isBusy ? 'connecting' : 'none';
  }
}
