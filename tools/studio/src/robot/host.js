// A robot at a port of this computer, which `tsc studio` has. It is asked by POST with the token of
// its run. The address that it opens has a code after the #, for which a page gets the token once. In
// a class the token is the teacher's, and pupils get tokens of their own.
//
// The main thread asks many times a second; when it hangs or the page sleeps, `tsc studio` hears
// nothing, and stops the robot. How many times STOP was pressed is in every request, so a lost one is made up for.

/** @import { Answer, RobotInfo } from './transport.js' */

import { RequestQueue, ConnectionFailure, pause } from './transport.js';
import { storeText, loadText } from '../page/kept.js';
import { removeForeignWorkers } from '../page/offline.js';

/** @typedef {{port: string, name: string, description: string, virtual: string | null}} Port */

const TOKEN_KEY = 'tiniscript.token';
const LOADED_CODE_KEY = 'tiniscript.loaded'; // the code for which the page was loaded again
const BEAT_INTERVAL_MS = 100;
const MIN_BEAT_INTERVAL_MS = 30; // between two beats, as between two words of a remote control: a class takes forty requests a second of a pupil
const SILENCE_LIMIT_MS = 3000; // without an answer
const REQUEST_LIMIT_MS = 2000;
const CONNECT_TRIES = 3;
/** What this page calls itself. */
const TAB_ID = [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, '0')).join('');

let token = loadText(TOKEN_KEY, 'sessionStorage');
/** Why the code of the address has given no token, or nothing. */
export const entryFailure = await exchangeCode();

/** Whether this page comes from a `tsc studio`, and may ask it for all that it has. */
export const hasHost = token !== '';
const { dataset } = document.documentElement;
export const isTeacher = 'class' in dataset && hasHost;
export const isPupil = 'class' in dataset && !hasHost;
if (isPupil) dataset['class'] = 'pupil';

/** From now on this page asks as a pupil. @param {string} pupilToken */
export function setToken(pupilToken) {
  token = pupilToken;
}

/** Takes the code out of the address, and gets the token for it, unless somebody else's worker would read it. @returns {Promise<string>} */
async function exchangeCode() {
  const code = /^#code=([0-9a-f]{32})$/.exec(location.hash)?.[1];
  if (!code) return '';
  if (await removeForeignWorkers()) {
    if (loadText(LOADED_CODE_KEY, 'sessionStorage') === code || !storeText(LOADED_CODE_KEY, code, 'sessionStorage')) return 'host_worker';
    location.reload();
    await new Promise(() => {}); // this page does nothing more
  }
  storeText(LOADED_CODE_KEY, '', 'sessionStorage');
  history.replaceState(null, '', location.pathname + location.search);
  token = '';
  try {
    const answer = await post({ code }, {}, './enter');
    if (answer.failure) return answer.failure;
    token = answer.token;
  } catch {
    return 'host_gone';
  }
  storeText(TOKEN_KEY, token, 'sessionStorage'); // without a storage, a reload needs a new address
  return '';
}

/**
 * @param {Record<string, unknown>} request
 * @param {RequestInit} [options]
 * @param {string} [path]
 * @returns {Promise<any>}
 */
export async function post(request, options = {}, path = './robots') {
  const response = await fetch(path, {
    method: 'POST',
    headers: { 'X-TiniScript-Token': token, 'Content-Type': 'application/json' },
    body: JSON.stringify(request),
    signal: AbortSignal.timeout(REQUEST_LIMIT_MS),
    ...options,
  });
  if (response.status === 403) throw new ConnectionFailure('host_other');
  if (response.status === 400) throw new ConnectionFailure('bad_request');
  if (!response.ok) throw new Error(`${response.status}`); // that says no `tsc studio`: it is as good as lost
  return response.json();
}

/** @returns {Promise<Port[]>} */
export async function fetchPorts() {
  try {
    return (await post({ do: 'ports' })).ports;
  } catch (error) {
    throw error instanceof ConnectionFailure ? error : new ConnectionFailure('host_gone');
  }
}

let seenStopCount = 0; // of the group's robot: whatever was pressed before this page hears of another one is void

/** @param {number} stopCount */
export function noteStopCount(stopCount) {
  seenStopCount = Math.max(seenStopCount, stopCount); // an answer may be late
}

let connectionCount = 0; // of this page
let pressCount = 0; // of STOP

export class HostRobot extends RequestQueue {
  #connectionNumber = ++connectionCount;
  #isConnected = false;
  #lastNewsNumber = 0;
  #isAsking = false;
  #lastAnswer_ms = 0;
  #lastBeat_ms = -MIN_BEAT_INTERVAL_MS; // the newest beat
  /** @type {(robotInfo: RobotInfo) => void} */
  #resolveConnect = () => {};
  /** @type {(error: Error) => void} */
  #rejectConnect = () => {};
  #newestPressNumber = 0; // the newest press of this connection

  /**
   * Connects; rejects with a ConnectionFailure.
   * @param {string} portId
   * @param {string} robotName
   * @param {string} language
   * @returns {Promise<RobotInfo>}
   */
  connect(portId, robotName, language) {
    /** @type {Promise<RobotInfo>} */
    const connection = new Promise((resolve, reject) => {
      this.#resolveConnect = resolve;
      this.#rejectConnect = reject;
    });
    this.#open({ port: portId, robot: robotName, language, saw_stops: seenStopCount });
    return connection;
  }

  /** The same connect is done once, however often it comes. @param {Record<string, string | number>} request */
  async #open(request) {
    for (let tryNumber = 1; !this.isOver && !this.#isConnected; tryNumber += 1) {
      try {
        const answer = await this.#post('connect', request);
        if (answer.failure) this.end(new ConnectionFailure(answer.failure));
        this.#isConnected = true;
      } catch (error) {
        if (error instanceof ConnectionFailure) this.end(error);
        else if (tryNumber === CONNECT_TRIES) this.end(new ConnectionFailure('host_gone'));
        else await pause(BEAT_INTERVAL_MS);
      }
    }
    if (this.isOver) return;
    this.#lastAnswer_ms = performance.now();
    this.send();
  }

  /** @param {string} action @param {Record<string, unknown>} [fields] @param {RequestInit} [options] */
  #post(action, fields = {}, options = {}) {
    return post({ do: action, page: TAB_ID, connection: this.#connectionNumber, seen: this.#lastNewsNumber, stops: this.#newestPressNumber, ...fields }, options);
  }

  /** One that was made before a stop, or before this page knew of it, is void. @param {Record<string, unknown>} request @returns {Promise<Answer>} */
  ask(request) {
    return super.ask({ ...request, stops: pressCount, seen: this.#lastNewsNumber });
  }

  /** Stops the robot; that waits for nothing. */
  stop() {
    if (this.isOver) return;
    this.#newestPressNumber = ++pressCount;
    this.#post('stop', {}, { keepalive: true }).catch(() => {}); // each beat says so, too
  }

  /** Stops what this page has started, and leaves the robot. */
  leave() {
    if (this.isOver) return;
    this.#post('leave', {}, { keepalive: true }).catch(() => {});
    this.end(new ConnectionFailure('left'));
  }

  async send() {
    if (this.isOver || this.#isAsking || !this.#isConnected) return;
    clearTimeout(this.sendTimer);
    const early_ms = this.#lastBeat_ms + MIN_BEAT_INTERVAL_MS - performance.now();
    if (early_ms > 0) {
      this.sendTimer = window.setTimeout(() => this.send(), early_ms);
      return;
    }
    this.#isAsking = true;
    this.#lastBeat_ms = performance.now();
    const requests = this.requests.splice(0, 8);
    let isLost = false;
    try {
      const answer = await this.#post('beat', { asked: requests });
      this.#lastAnswer_ms = performance.now();
      for (const news of answer.news) {
        this.handleNews(news);
        await undefined; // who has asked hears its answer before what comes next
      }
    } catch (error) {
      if (error instanceof ConnectionFailure) this.end(error);
      else {
        isLost = true;
        this.requests.unshift(...this.dropKeyRequests(requests)); // it has not arrived, or has: an id is answered once
        if (performance.now() - this.#lastAnswer_ms > SILENCE_LIMIT_MS) this.end(new ConnectionFailure('host_gone'));
      }
    } finally {
      this.#isAsking = false;
    }
    if (!this.isOver) this.sendTimer = window.setTimeout(() => this.send(), this.requests.length && !isLost ? 0 : BEAT_INTERVAL_MS);
  }

  /** @param {any} news */
  handleNews(news) {
    if (this.isOver || (news.number && news.number <= this.#lastNewsNumber)) return;
    this.#lastNewsNumber = Math.max(this.#lastNewsNumber, news.number ?? 0);
    if (news.over) this.end(new ConnectionFailure(news.over, news.said));
    else if (news.connected) this.#resolveConnect(news.connected);
    else super.handleNews(news);
  }

  /** @param {ConnectionFailure} failure */
  end(failure) {
    if (this.isOver) return;
    this.#rejectConnect(failure);
    super.end(failure);
  }
}
