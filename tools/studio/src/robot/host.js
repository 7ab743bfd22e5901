// A robot at a port of this computer, which `tsc studio` has. It is asked by POST with the token of
// its run. The address that it opens has a code after the #, for which a page gets the token once. In
// a class the token is the teacher's, and pupils get tokens of their own.
//
// The main thread asks many times a second; when it hangs or the page sleeps, `tsc studio` hears
// nothing, and stops the robot. How often STOP was pressed is in every request, so a lost one is made up for.

/** @import { Answer, About } from './transport.js' */

import { Asking, Failed, pause } from './transport.js';
import { keepAt, kept } from '../page/kept.js';
import { leaveForeignWorkers } from '../page/offline.js';

/** @typedef {{port: string, name: string, description: string, virtual: string | null}} Port */

const PLACE = 'tiniscript.token';
const LOADED_PLACE = 'tiniscript.loaded'; // the code for which the page was loaded again
const BEAT_MS = 100;
const GAP_MS = 30; // between two beats, as between two words of a remote control: a class takes forty requests a second of a pupil
const SILENT_MS = 3000; // without an answer
const ASK_MS = 2000;
const CONNECT_TRIES = 3;
/** What this page calls itself. */
const TAB = [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, '0')).join('');

let token = kept(PLACE, 'sessionStorage');
/** Why the code of the address has given no token, or nothing. */
export const whyOutside = await enter();

/** Whether this page comes from a `tsc studio`, and may ask it for all that it has. */
export const hasHost = token !== '';
const { dataset } = document.documentElement;
export const isTeacher = 'class' in dataset && hasHost;
export const isPupil = 'class' in dataset && !hasHost;
if (isPupil) dataset['class'] = 'pupil';

/** From now on this page asks as a pupil. @param {string} own */
export function askAs(own) {
  token = own;
}

/** Takes the code out of the address, and gets the token for it, unless somebody else's worker would read it. @returns {Promise<string>} */
async function enter() {
  const code = /^#code=([0-9a-f]{32})$/.exec(location.hash)?.[1];
  if (!code) return '';
  if (await leaveForeignWorkers()) {
    if (kept(LOADED_PLACE, 'sessionStorage') === code || !keepAt(LOADED_PLACE, code, 'sessionStorage')) return 'host_worker';
    location.reload();
    await new Promise(() => {}); // this page does nothing more
  }
  keepAt(LOADED_PLACE, '', 'sessionStorage');
  history.replaceState(null, '', location.pathname + location.search);
  token = '';
  try {
    const answer = await post({ code }, {}, './enter');
    if (answer.failure) return answer.failure;
    token = answer.token;
  } catch {
    return 'host_gone';
  }
  keepAt(PLACE, token, 'sessionStorage'); // without a storage, a reload needs a new address
  return '';
}

/**
 * @param {Record<string, unknown>} request
 * @param {RequestInit} [options]
 * @param {string} [where]
 * @returns {Promise<any>}
 */
export async function post(request, options = {}, where = './robots') {
  const answer = await fetch(where, {
    method: 'POST',
    headers: { 'X-TiniScript-Token': token, 'Content-Type': 'application/json' },
    body: JSON.stringify(request),
    signal: AbortSignal.timeout(ASK_MS),
    ...options,
  });
  if (answer.status === 403) throw new Failed('host_other');
  if (answer.status === 400) throw new Failed('bad_request');
  if (!answer.ok) throw new Error(`${answer.status}`); // that says no `tsc studio`: it is as good as lost
  return answer.json();
}

/** @returns {Promise<Port[]>} */
export async function hostPorts() {
  try {
    return (await post({ do: 'ports' })).ports;
  } catch (why) {
    throw why instanceof Failed ? why : new Failed('host_gone');
  }
}

let sawStops = 0; // of the group's robot: whatever was pressed before this page hears of another one is void

/** @param {number} stops */
export function hearStops(stops) {
  sawStops = Math.max(sawStops, stops); // an answer may be late
}

let connections = 0; // of this page
let presses = 0; // of STOP

export class HostRobot extends Asking {
  #connection = ++connections;
  #isThere = false;
  #seen = 0;
  #isAsking = false;
  #heardAt = 0;
  #beganAt = -GAP_MS; // the newest beat
  /** @type {(about: About) => void} */
  #met = () => {};
  /** @type {(why: Error) => void} */
  #fails = () => {};
  #stops = 0; // the newest press of this connection

  /**
   * Connects; rejects with a Failed.
   * @param {string} port
   * @param {string} robot
   * @param {string} language
   * @returns {Promise<About>}
   */
  connect(port, robot, language) {
    /** @type {Promise<About>} */
    const met = new Promise((resolve, reject) => {
      this.#met = resolve;
      this.#fails = reject;
    });
    this.#open({ port, robot, language, saw_stops: sawStops });
    return met;
  }

  /** The same connect is done once, however often it comes. @param {Record<string, string | number>} request */
  async #open(request) {
    for (let tries = 1; !this.isOver && !this.#isThere; tries += 1) {
      try {
        const answer = await this.#post('connect', request);
        if (answer.failure) this.end(new Failed(answer.failure));
        this.#isThere = true;
      } catch (why) {
        if (why instanceof Failed) this.end(why);
        else if (tries === CONNECT_TRIES) this.end(new Failed('host_gone'));
        else await pause(BEAT_MS);
      }
    }
    if (this.isOver) return;
    this.#heardAt = performance.now();
    this.go();
  }

  /** @param {string} what @param {Record<string, unknown>} [more] @param {RequestInit} [options] */
  #post(what, more = {}, options = {}) {
    return post({ do: what, page: TAB, connection: this.#connection, seen: this.#seen, stops: this.#stops, ...more }, options);
  }

  /** One that was made before a stop, or before this page knew of it, is void. @param {Record<string, unknown>} request @returns {Promise<Answer>} */
  ask(request) {
    return super.ask({ ...request, stops: presses, seen: this.#seen });
  }

  /** Stops the robot; that waits for nothing. */
  stop() {
    if (this.isOver) return;
    this.#stops = ++presses;
    this.#post('stop', {}, { keepalive: true }).catch(() => {}); // each beat says so, too
  }

  /** Stops what this page has started, and leaves the robot. */
  leave() {
    if (this.isOver) return;
    this.#post('leave', {}, { keepalive: true }).catch(() => {});
    this.end(new Failed('left'));
  }

  async go() {
    if (this.isOver || this.#isAsking || !this.#isThere) return;
    clearTimeout(this.timer);
    const early_ms = this.#beganAt + GAP_MS - performance.now();
    if (early_ms > 0) {
      this.timer = window.setTimeout(() => this.go(), early_ms);
      return;
    }
    this.#isAsking = true;
    this.#beganAt = performance.now();
    const asked = this.asked.splice(0, 8);
    let isLost = false;
    try {
      const answer = await this.#post('beat', { asked });
      this.#heardAt = performance.now();
      for (const each of answer.news) {
        this.take(each);
        await undefined; // who has asked hears its answer before what comes next
      }
    } catch (why) {
      if (why instanceof Failed) this.end(why);
      else {
        isLost = true;
        this.asked.unshift(...this.withoutKeys(asked)); // it has not arrived, or has: an id is answered once
        if (performance.now() - this.#heardAt > SILENT_MS) this.end(new Failed('host_gone'));
      }
    } finally {
      this.#isAsking = false;
    }
    if (!this.isOver) this.timer = window.setTimeout(() => this.go(), this.asked.length && !isLost ? 0 : BEAT_MS);
  }

  /** @param {any} news */
  take(news) {
    if (this.isOver || (news.number && news.number <= this.#seen)) return;
    this.#seen = Math.max(this.#seen, news.number ?? 0);
    if (news.over) this.end(new Failed(news.over, news.said));
    else if (news.connected) this.#met(news.connected);
    else super.take(news);
  }

  /** @param {Failed} why */
  end(why) {
    if (this.isOver) return;
    this.#fails(why);
    super.end(why);
  }
}
