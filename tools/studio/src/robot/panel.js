// The part of the page with a real robot: how it is reached, what it is told, and what it says.
// Everything that a robot says is put there as text, never as markup.

import { sentenceAtPlace } from '../blocks/said.js';
import { element } from '../page/elements.js';
import { onEscapeKey } from '../page/escape.js';
import { faultSentence } from '../page/faults.js';
import { readBytes, onFileChosen } from '../page/files.js';
import { chooseDevice, BluetoothPort, hasBluetooth } from './bluetooth.js';
import { Debugging } from './debugging.js';
import { ActivityLine } from './doing.js';
import { DirectRobot } from './direct.js';
import { hasHost, fetchPorts, HostRobot, isPupil, isTeacher } from './host.js';
import { Flashing } from './flashing.js';
import { readTrim, showTrim } from './trim.js';
import { choosePort, hasSerial, listKnownPorts, SerialPort } from './serial.js';
import { refusalText, asPlainText } from './plain_text.js';
import { stopAll } from './stops.js';
import { StopNotice } from './stopping.js';
import { Speech } from './speech.js';
import { ConnectionFailure } from './transport.js';
import { SensorWatch } from './watching.js';
import { storeText, loadText } from '../page/kept.js';
import { makeSymbolPicture, replaceOptions, makePictureOption } from '../page/pictures.js';
import { pageState } from '../page/page_state.js';
import { setStopNeeded } from '../page/stop_place.js';
import { labelOf, currentLanguage, text } from '../page/texts.js';
import { isRobot, LINK, robotOf } from '../page/words.js';
import { messageWithFix } from '../writing/messages.js';
import { shownName, findShow } from '../writing/shows.js';

/** @typedef {import('../python.js').CheckResult} CheckResult */
/** @import { RobotInfo, Answer, RobotEvent, Transport } from './transport.js' */
/** @typedef {RobotEvent & {number: number, nth?: number, robot?: string}} GroupRobotEvent of the group's robot: the number among all news, and that of a value in its run */
/** @typedef {{label: string, symbolId: string, connect: () => Promise<void>, serialPort?: any}} ConnectionChoice */

/**
 * @typedef {object} Page what the panel uses of the page
 * @property {import('../python.js').Python} python
 * @property {(place: import('../writing/editor.js').Range) => void} goTo
 * @property {import('./recorder.js').Recorder} recorder of what the robot tells
 * @property {import('./place.js').RunningPlace} place where its program is
 * @property {import('../remote/pad.js').Pad} pad
 */

// The keys of robots that this browser keeps: the text of a file of keys, as `tsc set owner --list` writes it. Who uses
// this browser uses them; the page gives them to no one but the robot's session.
const KEYS_STORAGE_KEY = 'tiniscript.link.keys';
const MAX_KNOWN_PROGRAMS = 20;
const PORT_NOTICE_MS = 2500; // after which it is said that nothing answers at a port yet
const ANSWER_NOTICE_MS = 2000; // after which it is said that the robot has not answered yet

export class RobotPanel {
  #page;
  /** @type {Transport | null} */
  #transport = null;
  /** @type {RobotInfo | null} */
  #robotInfo = null;
  #isBusy = false;
  #stopCount = 0; // that were pressed
  /** @type {ConnectionChoice[]} */
  #choices = [];
  /** Words of a remote control that the newest program reads. @type {string[]} */
  #remoteWords = [];
  /** @type {CheckResult | null} */
  #sentProgram = null;
  /** The newest programs and lines that were sent, by checksum: what they show is named. @type {Map<string, CheckResult>} */
  #knownPrograms = new Map();
  /** The text of what runs, as it was when that began: another one may have the same code. @type {CheckResult | undefined} */
  #runningProgram;
  #speech = new Speech();
  #stopNotice = new StopNotice(this.#speech);
  #debugging;
  #activityLine = new ActivityLine();
  #sensorWatch;
  /** @type {Flashing} */
  #flashing;
  #resolveDisconnection = () => {};
  #lineChecksum = ''; // the checksum of the newest line
  #isWitness = false; // of a run on the robot of the group, which another page drives
  #valueCount = 0; // of that run, until now
  #portSelect = element('link_port', HTMLSelectElement);
  #lineInput = element('link_line', HTMLInputElement);

  /** @param {Page} page */
  constructor(page) {
    this.#page = page;
    this.#debugging = new Debugging({
      ask: (request, onDone, isQuiet) => {
        if (request['do'] === 'resume') this.#activityLine.showResumed();
        return this.#ask(request, onDone, isQuiet);
      },
      uploadPaused: () => this.#upload(true, true),
      say: (key) => this.#speech.say(key),
      sayAnew: (makeSentence, name) => this.#speech.sayAnew(makeSentence, name),
      place: page.place,
      recorder: page.recorder,
      canGetHaltingFirmware: () => this.#flashing.canOfferHaltingFirmware(),
      getHaltingFirmware: () => this.#getHaltingFirmware(),
    });
    this.#sensorWatch = new SensorWatch({
      python: page.python,
      ask: (request, isQuiet) => this.#askNow(request, () => {}, isQuiet),
      say: (key) => this.#speech.say(key),
      onWatchingChange: (isOn) => this.#activityLine.showWatching(isOn),
    });
    for (const [id, onClick] of /** @type {[string, () => void][]} */ ([
      ['link_look', () => this.#listChoices()],
      ['link_connect', () => this.#choices[this.#portSelect.selectedIndex]?.connect()],
      ['link_serial', () => this.#connectBySerial(choosePort())],
      ['link_bluetooth', () => this.#connectByBluetooth()],
      ['link_leave', () => this.#transport?.leave()],
      ['link_identify', () => this.#ask({ do: 'identify' }, () => this.#speech.say('say_identify', { name: this.#robotName }))],
      ['link_upload', () => this.#upload(true)],
      ['link_send', () => this.#upload(false)],
      ['link_start', () => this.#debugging.startAgain()],
      ['link_rename', () => this.#rename()],
      ['trim_set', () => this.#sendTrim()],
      ['trim_try', () => this.#runLine('F(2, 60)')],
      ['keys_claim', () => this.#claim()],
      ['keys_import', () => element('keys_file', HTMLInputElement).click()],
    ])) element(id, HTMLButtonElement).addEventListener('click', onClick);
    element('link_live', HTMLFormElement).addEventListener('submit', (event) => {
      event.preventDefault();
      this.#runLine(this.#lineInput.value);
    });
    onFileChosen('keys_file', (file) => this.#importKeys(file));
    this.#flashing = new Flashing({
      speech: this.#speech,
      getChosenPort: () => this.#choices[this.#portSelect.selectedIndex]?.serialPort,
      isFree: () => this.isFree,
      setBusy: (isBusy) => {
        this.#isBusy = isBusy;
        this.#show();
      },
      connect: (port) => this.#connectBySerial(Promise.resolve(port)),
    });
    element('stop', HTMLButtonElement).addEventListener('click', () => this.stop());
    onEscapeKey(() => this.stop());
    document.addEventListener('visibilitychange', () => {
      if (document.visibilityState === 'hidden') this.#onPageHidden();
    });
    for (const eventName of ['pagehide', 'freeze']) addEventListener(eventName, () => this.#transport?.leave());
    pageState.language.subscribe(() => this.#show());
    pageState.checkResult.subscribe((checkResult) => {
      if (pageState.groupName.value && checkResult?.image) this.#expectProgram(checkResult); // whoever of the group runs it
      this.#offerRemote();
    });
    this.#show();
    this.#listChoices();
  }

  get #robotName() {
    const robotInfo = this.#robotInfo;
    if (!robotInfo) return '';
    return asPlainText(robotInfo.name) || labelOf(robotOf(robotInfo.robot ?? '')?.labels ?? {}) || robotInfo.id;
  }

  /** Sends the program and runs it, or says that no robot is there. */
  run() {
    if (this.#transport) this.#upload(true);
    else if (!this.#isBusy) this.#speech.say('say_no_robot');
  }

  get isFree() { return !this.#isBusy && !this.#transport; }

  /** Stops the robot; a page without one, or a teacher's, stops all that its `tsc studio` has. */
  stop() {
    if (hasHost && (isTeacher || !this.#transport)) stopAll();
    this.#stop();
  }

  /** @param {string} [confirmedKey] a text, once it is */
  #stop(confirmedKey = '') {
    if (!this.#transport) return;
    this.#stopCount += 1;
    this.#debugging.stop();
    this.#sensorWatch.stop();
    this.#transport.stop();
    this.#stopNotice.begin(confirmedKey);
  }

  #onPageHidden() {
    if (!this.#transport) return;
    this.stop();
    this.#stopNotice.begin('say_hidden');
  }

  // -- connecting ---------------------------------------------------------------------------------

  /** Lists what can be reached, and opens nothing. */
  async #listChoices() {
    if (isPupil) return; // whose robot is the one of the turn
    /** @type {ConnectionChoice[]} */
    const choices = [];
    let failure = null;
    if (hasHost) {
      try {
        for (const { port: portId, name, description, virtual } of await fetchPorts()) {
          const details = virtual === null ? description : `${text('virtual_known')} ${virtual}`;
          const label = asPlainText([name, details, portId].filter(Boolean).join(' · '));
          choices.push({ label, symbolId: virtual === null ? 'drawn_plug' : 'drawn_robot', connect: () => this.connectByHost(portId) });
        }
      } catch (error) {
        failure = error;
      }
    }
    for (const [portIndex, port] of (await listKnownPorts()).entries()) {
      choices.push({ label: text('serial_known', { number: portIndex + 1 }), symbolId: 'drawn_plug', connect: () => this.#connectBySerial(Promise.resolve(port)), serialPort: port });
    }
    this.#choices = choices;
    replaceOptions(this.#portSelect, choices.map(({ label, symbolId }) => makePictureOption(label, label, makeSymbolPicture(symbolId))));
    this.#show();
    if (this.#transport) return;
    if (failure instanceof ConnectionFailure) this.#speech.sayFailure(failure);
    else if (choices.length) this.#speech.say('say_choose');
    else if (hasHost) this.#speech.say('say_none');
    else this.#speech.say(hasSerial || hasBluetooth ? 'say_ways' : 'say_no_way');
  }

  /** Connects through `tsc studio`; a pupil's port is that of the turn. @param {string} portId */
  connectByHost(portId = 'turn') {
    return this.#connect(async (listener) => {
      const transport = new HostRobot(listener);
      return { transport, connecting: transport.connect(portId, pageState.robotName.value, currentLanguage()) };
    });
  }

  /** @param {Promise<any>} choosingPort */
  #connectBySerial(choosingPort) {
    return this.#connect(async (listener) => this.#openDirect(new SerialPort(await choosingPort, this.#baud), listener));
  }

  #connectByBluetooth() {
    const choosingDevice = chooseDevice();
    return this.#connect(async (listener) => this.#openDirect(new BluetoothPort(await choosingDevice, this.#baud), listener));
  }

  get #baud() {
    return robotOf(pageState.robotName.value)?.baud ?? 9600;
  }

  /** @param {import('./direct.js').Port} port @param {import('./transport.js').RobotListener} listener */
  #openDirect(port, listener) {
    const keyStore = { load: () => loadText(KEYS_STORAGE_KEY), store: (/** @type {string} */ keys) => storeText(KEYS_STORAGE_KEY, keys) };
    const transport = new DirectRobot(this.#page.python, port, listener, keyStore);
    return { transport, connecting: transport.connect(pageState.robotName.value, currentLanguage()) };
  }

  /** @param {(listener: import('./transport.js').RobotListener) => Promise<{transport: Transport, connecting: Promise<RobotInfo>}>} openTransport */
  async #connect(openTransport) {
    if (this.#isBusy || this.#transport) return;
    this.#isBusy = true;
    this.endWitness();
    this.#speech.say('say_connecting');
    this.#show();
    const noticeTimer = setTimeout(() => this.#speech.say('say_nothing_yet'), PORT_NOTICE_MS);
    /** @type {Transport | null} */
    let transport = null;
    const listener = {
      onEvent: (/** @type {RobotEvent} */ event) => this.#onRobotEvent(event),
      onEnd: (/** @type {ConnectionFailure} */ failure) => {
        if (this.#transport && this.#transport === transport) this.#onDisconnected(failure);
      },
    };
    try {
      const connection = await openTransport(listener);
      transport = this.#transport = connection.transport; // STOP reaches it from now on
      this.#show();
      const robotInfo = await connection.connecting;
      this.#robotInfo = robotInfo;
      this.#onConnected(robotInfo);
    } catch (error) {
      if (this.#transport === transport) this.#onDisconnected(error instanceof ConnectionFailure ? error : new ConnectionFailure('bug', String(error))); // else it was told
    } finally {
      clearTimeout(noticeTimer);
      this.#isBusy = false;
      this.#show();
    }
  }

  /** @param {RobotInfo} robotInfo */
  #onConnected(robotInfo) {
    this.#speech.clear();
    this.#debugging.onRobotChange(robotInfo);
    this.#activityLine.onRobotChange(robotInfo);
    const isOtherRobot = robotInfo.robot !== null && robotInfo.robot !== pageState.robotName.value;
    if (robotInfo.robot !== null && isOtherRobot) pageState.robotName.set(robotInfo.robot);
    if (robotInfo.owner === 'other') this.#speech.say('say_owned', { name: this.#robotName });
    else if (isOtherRobot) this.#speech.say('say_other_kit', { name: this.#robotName, robot: String(robotInfo.robot) });
    else this.#speech.say('say_connected', { name: this.#robotName });
    element('link_rename_to', HTMLInputElement).value = asPlainText(robotInfo.name);
    this.#sensorWatch.onRobotChange(robotInfo);
    this.#page.recorder.onRobotChange(robotInfo);
    this.#transport?.ask({ do: 'trim' }).then(({ trim }) => trim && showTrim(trim)).catch(() => {});
  }

  /** @param {ConnectionFailure} failure */
  #onDisconnected(failure) {
    this.#transport = null;
    this.#robotInfo = null;
    this.#sentProgram = null;
    this.#runningProgram = undefined;
    this.#page.recorder.end('LOST');
    this.#page.place.end();
    this.#debugging.onRobotChange(null);
    this.#activityLine.onRobotChange(null);
    this.#sensorWatch.onRobotChange(null);
    const stopSentence = this.#stopNotice.end();
    this.#speech.sayFailure(failure, stopSentence);
    this.#show();
    this.#resolveDisconnection();
  }

  // -- what the robot is told ---------------------------------------------------------------------

  /**
   * @param {Record<string, unknown>} request
   * @param {(answer: Answer) => void} [onDone]
   * @param {boolean} [isQuiet] about how it fails
   * @returns {Promise<Answer | null>} null if it failed
   */
  async #ask(request, onDone = () => {}, isQuiet = false) {
    const transport = this.#transport, pausing = this.#robotInfo && this.#sensorWatch.pauseFor(request);
    if (pausing) await pausing;
    if (transport !== this.#transport) return null; // it was asked of the robot before
    const answer = await this.#askNow(request, onDone, isQuiet);
    this.#sensorWatch.resumeAfter(request);
    return answer;
  }

  /**
   * @param {Record<string, unknown>} request
   * @param {(answer: Answer) => void} onDone
   * @param {boolean} isQuiet
   * @returns {Promise<Answer | null>}
   */
  async #askNow(request, onDone, isQuiet) {
    if (!this.#transport || !this.#robotInfo) return null;
    if (request['do'] === 'live') this.#debugging.onLineSent();
    const isUnannounced = isQuiet || request['do'] === 'upload' || request['do'] === 'claim'; // what it waits for
    const noticeTimer = isUnannounced ? 0 : setTimeout(() => this.#speech.say('say_waits'), ANSWER_NOTICE_MS);
    try {
      const answer = await this.#transport.ask(request);
      if (answer.ok) onDone(answer);
      else if (!isQuiet) this.#speech.sayFailure(new ConnectionFailure(answer.failure ?? 'bug', refusalText(answer)));
      return answer.ok ? answer : null;
    } catch {
      return null; // it is over, and that was said
    } finally {
      clearTimeout(noticeTimer);
    }
  }

  /** @param {boolean} isStarted @param {boolean} isPaused before its first instruction */
  #upload(isStarted, isPaused = false) {
    const program = pageState.checkResult.value;
    if (!program?.image) {
      this.#page.python.tryAgain(currentLanguage());
      this.#speech.say(program ? 'first_repair' : 'press_again'); // a robot does not start late by itself
      if (isStarted && program) this.#stop('say_broken'); // what runs is not what is seen
      return;
    }
    this.#speech.begin('say_sending');
    this.#expectProgram(program);
    const startHalting = this.#debugging.onUpload(program, isPaused);
    this.#ask({ do: 'upload', image: program.image, robot: pageState.robotName.value, runs: isStarted && !startHalting }, (answer) => {
      const { program: checksum = '', saved: storageKind = 'MEMORY' } = answer;
      this.#sentProgram = program;
      this.#offerRemote();
      if (isStarted && program.start === 'SB') this.#page.recorder.awaitButton(checksum);
      if (program.start === 'SB') this.#activityLine.showWaiting();
      this.#speech.say('say_receipt', {}, `saved_${storageKind}`);
      startHalting?.(isStarted && program.start === 'SI');
    });
  }

  /** A robot is driven by hand where the program that it has from here, or that is seen, reads a remote control. */
  #offerRemote() {
    const remoteWords = this.#sentProgram?.remote.length ? this.#sentProgram.remote : pageState.checkResult.value?.remote ?? this.#remoteWords;
    this.#remoteWords = remoteWords;
    const robotInfo = this.#robotInfo;
    this.#page.pad.offerRobot('link', robotInfo && remoteWords.length ? {
      remoteWords,
      lacksRemote: !robotInfo.has_remote,
      sendControls: (controls) => this.#sendControls(controls),
    } : null);
  }

  /** @param {import('../remote/held.js').HeldControls} controls */
  async #sendControls(controls) {
    const answer = await this.#transport?.press(controls).catch(() => null); // it is over, and that was said
    if (!answer?.said) return; // it has heard it, or the next word
    this.#page.pad.releaseAll(); // it is not asked again and again
    this.#speech.sayFailure(new ConnectionFailure(answer.failure ?? 'bug', refusalText(answer)));
  }

  /** Runs a line now. @param {string} line */
  async #runLine(line) {
    if (!line.trim() || !this.#robotInfo) return;
    const stopCount = this.#stopCount, transport = this.#transport;
    const robotName = pageState.robotName.value;
    const lineText = `SI|${line}`;
    /** @type {CheckResult} */
    const checkResult = { ...await this.#page.python.ask({ do: 'check', robot: robotName, language: currentLanguage() }, new TextEncoder().encode(lineText)), text: lineText };
    if (stopCount !== this.#stopCount || transport !== this.#transport) return; // STOP was pressed since, or this is another robot
    const mistake = checkResult.findings.find((finding) => finding.severity === 'mistake');
    if (mistake) {
      this.#speech.saySentence(messageWithFix(mistake));
      return;
    }
    this.#rememberProgram(checkResult);
    this.#lineChecksum = checkResult.program;
    await this.#ask({ do: 'live', image: checkResult.image, robot: robotName }, () => this.#speech.say('say_line'));
  }

  #rename() {
    const name = element('link_rename_to', HTMLInputElement).value.trim();
    if (!name || new TextEncoder().encode(name).length > LINK.name_bytes) return;
    this.#ask({ do: 'name', name }, () => {
      if (this.#robotInfo) this.#robotInfo = { ...this.#robotInfo, name };
      this.#speech.say('say_named', { name: asPlainText(name) });
      this.#show();
    });
  }

  #sendTrim() {
    this.#ask({ do: 'trim', trim: readTrim() }, ({ trim }) => {
      if (trim) showTrim(trim);
      this.#speech.say('say_trimmed');
    });
  }

  /** Its firmware is to be one with breakpoints: the port has to be free. */
  async #getHaltingFirmware() {
    const disconnection = new Promise((resolve) => { this.#resolveDisconnection = () => resolve(null); });
    this.#transport?.leave();
    if (this.#transport) await disconnection;
    await this.#flashing.offerHaltingFirmware();
    this.#speech.say('say_halting_firmware');
  }

  #claim() {
    this.#speech.say('say_claiming');
    const isHostRobot = this.#transport instanceof HostRobot;
    this.#ask({ do: 'claim' }, () => this.#speech.say(isHostRobot ? 'say_claimed_here' : 'say_claimed'));
  }

  /** @param {File} file with keys */
  async #importKeys(file) {
    if (this.#transport instanceof HostRobot) {
      this.#speech.say('say_keys_host');
      return;
    }
    try {
      const data = await readBytes(file);
      let storedKeys, importResult;
      do {
        storedKeys = loadText(KEYS_STORAGE_KEY);
        importResult = await this.#page.python.ask({ do: 'import_keys', kept: storedKeys }, data);
      } while (loadText(KEYS_STORAGE_KEY) !== storedKeys); // another tab has stored keys meanwhile, or the robot's session
      if (importResult.count) storeText(KEYS_STORAGE_KEY, importResult.keys);
      this.#speech.say(importResult.count ? 'say_keys' : 'say_no_keys', { count: importResult.count });
    } catch {
      this.#speech.say('say_no_keys');
    }
  }

  // -- what the robot says ------------------------------------------------------------------------

  /** @param {RobotEvent} event */
  #onRobotEvent(event) {
    const isTyped = event.program === this.#lineChecksum;
    if (this.#sensorWatch.onEvent(event, isTyped)) return;
    this.#page.recorder.onEvent(event);
    this.#page.place.onEvent(event);
    this.#activityLine.onEvent(event, isTyped, this.#programOf(event.program) !== undefined);
    this.#showEvent(event);
    this.#debugging.onEvent(event);
  }

  /** @param {RobotEvent} event */
  #showEvent(event) {
    if (event.event === 'SHOW') this.#speech.addLine([this.#shownValueName(event), event.value].filter(Boolean).join(' '));
    else if (event.event === 'TEXT') this.#speech.addLine(text('say_text', { said: asPlainText(String(event.text)) }));
    else if (event.event === 'MISSED') this.#speech.addLine(text('say_missed', { count: Number(event.count) }));
    else if (event.event === 'DONE') this.#speech.say('say_done');
    else if (event.event === 'FAULT') this.#showFault(event, this.#sentProgram, true);
    else if (event.event === 'LOST') this.#onLinkLost();
    else if (event.event === 'STARTED') {
      this.#stopNotice.forget();
      this.#runningProgram = this.#programOf(event.program);
    } else if (event.event === 'STOPPING') this.#stopNotice.begin();
    else if (event.event === 'RESTARTED') this.#speech.say('why_restarted');
    else if (event.event === 'STOPPED') {
      this.#page.pad.releaseAll();
      // A page that is hidden keeps the words why it stopped the robot.
      if (this.#stopNotice.isOpen || document.visibilityState !== 'hidden') this.#stopNotice.confirm(String(event.cause));
    }
  }

  // -- what the robot of the group says -----------------------------------------------------------

  /** The robot of the group, which another page drives, has told this. @param {GroupRobotEvent} event */
  onGroupEvent(event) {
    if (this.#transport || this.#isBusy) return;
    const { event: eventName, program: checksum, robot: robotName = '', nth: valueNumber } = event;
    if (eventName === 'ROBOT') {
      if (isRobot(robotName) && robotName !== pageState.robotName.value) pageState.robotName.set(robotName);
      return;
    }
    if (eventName === 'STARTED') {
      const checkResult = pageState.checkResult.value;
      if (checkResult?.image && checkResult.program === checksum) this.#expectProgram(checkResult);
      this.#isWitness = true;
      this.#valueCount = 0;
      this.#speech.begin('group_runs');
      this.#show();
    }
    if (valueNumber) {
      const missedCount = valueNumber - this.#valueCount - 1;
      this.#valueCount = valueNumber;
      if (missedCount > 0) this.#showGroupEvent({ event: 'MISSED', count: missedCount });
    }
    this.#showGroupEvent(event);
  }

  /** @param {RobotEvent} event */
  #showGroupEvent(event) {
    this.#page.recorder.onEvent(event);
    this.#page.place.onEvent(event);
    if (event.event === 'OVER') this.#speech.say('group_run_over');
    else if (event.event === 'STOPPED') this.#stopNotice.confirm(String(event.cause));
    else if (event.event === 'FAULT') this.#showFault(event, this.#programOf(event.program), false);
    else this.#showEvent(event);
  }

  /** Nobody tells this page of the group's robot any more. */
  endWitness() {
    if (!this.#isWitness) return;
    this.#isWitness = false;
    this.#page.recorder.end('LOST');
    this.#page.place.end();
    this.#show();
  }

  /** @param {CheckResult} program that the robot may run as the page's own */
  #expectProgram(program) {
    this.#rememberProgram(program);
    this.#page.recorder.addProgram(program);
  }

  /** @param {CheckResult} program before its robot may show anything */
  #rememberProgram(program) {
    this.#knownPrograms.delete(program.program);
    this.#knownPrograms.set(program.program, program);
    for (const [oldestChecksum] of this.#knownPrograms) if (this.#knownPrograms.size > MAX_KNOWN_PROGRAMS) this.#knownPrograms.delete(oldestChecksum);
  }

  /** The text of a program, if it is one of this page. @param {string} [checksum] */
  #programOf(checksum = '') {
    const checkResult = pageState.checkResult.value;
    return this.#knownPrograms.get(checksum) ?? (checksum && checkResult?.program === checksum ? checkResult : undefined);
  }

  /** The name of a value; nothing where its program is not one of this page. @param {RobotEvent} event */
  #shownValueName({ program: checksum, at: offset }) {
    if (!checksum) return '';
    if (this.#runningProgram?.program !== checksum) this.#runningProgram = this.#programOf(checksum);
    const show = this.#runningProgram && findShow(this.#runningProgram, offset);
    return show ? shownName(this.#runningProgram?.shows ?? [], show, show[1], false) : '';
  }

  /** The robot is silent. */
  #onLinkLost() {
    if (this.#stopNotice.isOpen) this.#stopNotice.showUnconfirmed();
    else this.#speech.say('why_link_lost');
  }

  /** @param {RobotEvent} event @param {CheckResult | null | undefined} program a program @param {boolean} movesCaret whether the caret goes there */
  #showFault(event, program, movesCaret) {
    const sentence = faultSentence(event.fault);
    const place = program?.program === event.program ? program?.places.findLast(([offset]) => offset <= Number(event.at)) : undefined;
    if (!place) {
      this.#speech.saySentence(sentence);
      return;
    }
    const [, line, column, end_line, end_column] = place;
    this.#speech.saySentence(sentenceAtPlace('say_fault', 'say_fault_block', program?.text ?? '', { line, column }, { what: sentence }));
    if (movesCaret && pageState.checkResult.value === program) this.#page.goTo({ line, column, end_line, end_column });
  }

  #show() {
    const isConnected = this.#robotInfo !== null;
    element('link_ways', HTMLElement).hidden = this.#transport !== null;
    element('link_drive', HTMLElement).hidden = !isConnected && !this.#isWitness;
    element('link_drive', HTMLElement).classList.toggle('witness', !isConnected);
    element('link_connected', HTMLElement).hidden = this.#transport === null;
    setStopNeeded('link', this.#transport !== null);
    element('link_name', HTMLElement).textContent = this.#robotName;
    element('link_serial', HTMLButtonElement).hidden = !hasSerial;
    element('link_bluetooth', HTMLButtonElement).hidden = !hasBluetooth;
    element('link_ports', HTMLElement).hidden = !hasHost && !this.#choices.length;
    element('link_identify', HTMLButtonElement).hidden = !isConnected;
    element('link_settings', HTMLElement).hidden = !isConnected;
    element('flash', HTMLElement).classList.toggle('away', this.#transport !== null);
    for (const id of ['link_connect', 'link_serial', 'link_bluetooth', 'flash_write', 'flash_open']) element(id, HTMLButtonElement).disabled = this.#isBusy;
    this.#offerRemote();
    document.documentElement.dataset['robot'] = isConnected ? 'connected' : this.#isBusy ? 'connecting' : 'none';
  }
}
