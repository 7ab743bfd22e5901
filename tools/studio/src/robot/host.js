// A robot at a port of this computer, which `tsc studio` has. It is asked by POST with the token of
// its run. The address that it opens has a code behind the #, for which a page gets the token once. In
// a class the token is the teacher's, and pupils get tokens of their own.
//
// The main thread asks many times a second; when it hangs or the page sleeps, `tsc studio` hears
// nothing, and stops the robot.

/** @import { Answer, About } from './transport.js' */

import { Asking, Failed } from './transport.js';
import { keepAt, kept } from '../page/kept.js';
import { leaveForeignWorkers } from '../page/offline.js';

/** @typedef {{port: string, name: string, description: string, virtual: string | null}} Port */

const PLACE = 'tiniscript.token';
const LOADED_PLACE = 'tiniscript.loaded'; // the code for which the page was loaded again
const BEAT_MS = 100;
const SILENT_MS = 3000; // without an answer
const ASK_MS = 2000;

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
  if (!answer.ok) throw new Failed('bad_request');
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


export class HostRobot extends Asking {
  #page = [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, '0')).join('');
  #seen = 0;
  #isAsking = false;
  #heardAt = 0;
  /** @type {(about: About) => void} */
  #met = () => {};
  /** @type {(why: Error) => void} */
  #fails = () => {};
  #stops = 0; // what was asked before one, and arrives after it, is void

  /**
   * Connects; rejects with a Failed.
   * @param {string} port
   * @param {string} robot
   * @param {string} language
   * @returns {Promise<About>}
   */
  async connect(port, robot, language) {
    let answer;
    try {
      answer = await post({ do: 'connect', page: this.#page, port, robot, language });
    } catch (why) {
      throw why instanceof Failed ? why : new Failed('host_gone');
    }
    if (answer.failure) throw new Failed(answer.failure);
    /** @type {Promise<About>} */
    const met = new Promise((resolve, reject) => {
      this.#met = resolve;
      this.#fails = reject;
    });
    this.#heardAt = performance.now();
    this.go();
    return met;
  }

  /** @param {Record<string, unknown>} request @returns {Promise<Answer>} */
  ask(request) {
    return super.ask({ ...request, stops: this.#stops });
  }

  /** Stops the robot; that waits for nothing. */
  stop() {
    if (this.isOver) return;
    this.#stops += 1;
    post({ do: 'stop', page: this.#page, seen: this.#seen, stops: this.#stops }, { keepalive: true }).catch(() => {});
  }

  /** Stops what this page has started, and leaves the robot. */
  leave() {
    if (this.isOver) return;
    post({ do: 'leave', page: this.#page, seen: this.#seen }, { keepalive: true }).catch(() => {});
    this.end(new Failed('left'));
  }

  async go() {
    if (this.isOver || this.#isAsking) return;
    this.#isAsking = true;
    clearTimeout(this.timer);
    const asked = this.asked.splice(0, 8);
    try {
      const answer = await post({ do: 'beat', page: this.#page, seen: this.#seen, asked });
      this.#heardAt = performance.now();
      for (const each of answer.news) {
        this.take(each);
        await undefined; // who has asked hears its answer before what comes next
      }
    } catch (why) {
      if (why instanceof Failed) this.end(why);
      else {
        this.asked.unshift(...asked); // it has not arrived, or has: an id is answered once
        if (performance.now() - this.#heardAt > SILENT_MS) this.end(new Failed('host_gone'));
      }
    } finally {
      this.#isAsking = false;
    }
    if (!this.isOver) this.timer = window.setTimeout(() => this.go(), this.asked.length ? 0 : BEAT_MS);
  }

  /** @param {any} news */
  take(news) {
    if (this.isOver || (news.number && news.number <= this.#seen)) return;
    this.#seen = Math.max(this.#seen, news.number ?? 0);
    if (news.stops) this.#stops = Math.max(this.#stops, news.stops);
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
