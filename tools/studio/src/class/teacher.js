// The teacher's page of a class: its code, all pupils and robots, and what a teacher may do with them.
// Everything that pupils and robots have written is put there as text, never as markup.

import { button, labelled, made } from './made.js';
import { element } from '../elements.js';
import { hostPorts, post } from '../robot/host.js';
import { shown } from '../robot/said.js';
import { text } from '../texts.js';

/** @typedef {{number: number, name: string, silent_s: number, place: number, robot: string, characters: number}} PupilRow */
/** @typedef {{port: string, name: string, pupil: string, left_s: number}} RobotRow */
/** @typedef {{code: string, turn_s: number, places: number, over: string, pupils: PupilRow[], robots: RobotRow[]}} State */
/** @typedef {{item: HTMLElement, said: HTMLElement, name: HTMLElement}} Row */

const LOOK_MS = 1000;
const SURE_MS = 5000;
const SILENT_S = 5;
const OF_A_TURN = '[data-text=stop], [data-text=class_next]'; // what a pupil without a robot needs not

export class Teacher {
  #code = made('strong');
  #said = made('p');
  #pupils = made('ul');
  #robots = made('ul');
  #program = made('pre');
  #ports = made('select');
  #minutes = made('input');
  #places = made('input');
  #erases = made('input');
  #end = button('class_end', () => this.#finish());
  /** @type {Map<string, Row>} */
  #rows = new Map();
  #isSure = false;
  #timer = 0;

  constructor() {
    const side = element('side_class', HTMLButtonElement);
    side.hidden = false;
    this.#said.setAttribute('role', 'status');
    this.#program.tabIndex = 0;
    this.#program.hidden = true;
    this.#minutes.type = 'number';
    this.#minutes.min = '1';
    this.#minutes.max = '60';
    this.#minutes.addEventListener('change', () => this.#ask({ do: 'class_turn', seconds: 60 * Math.min(60, Math.max(1, Math.round(Number(this.#minutes.value)) || 1)) }));
    this.#places.type = 'number';
    this.#places.min = '1';
    this.#places.max = '60';
    this.#places.addEventListener('change', () => this.#ask({ do: 'class_places', places: Math.min(60, Math.max(1, Math.round(Number(this.#places.value)) || 1)) }));
    this.#erases.type = 'checkbox';
    element('class', HTMLElement).append(made('div', '',
      made('p', '', made('span', 'class_address'), ' ', made('strong', '', location.origin), ' ', made('span', 'class_code'), ' ', this.#code, ' ',
        button('class_new_code', () => this.#ask({ do: 'class_code' }))),
      this.#said,
      made('h2', 'class_pupils'), this.#pupils, this.#program,
      made('h2', 'class_robots'), this.#robots,
      made('p', '', labelled('link_port', this.#ports), button('class_give', () => this.#give()), button('link_look', () => this.#lookForPorts())),
      made('p', '', labelled('class_minutes', this.#minutes)),
      made('p', '', labelled('class_places', this.#places)),
      made('p', '', made('label', '', this.#erases, made('span', 'class_erases')), this.#end),
    ));
    this.#lookForPorts();
    this.#ask({ do: 'class' });
    side.click();
  }

  /** @param {Record<string, unknown>} request */
  async #ask(request) {
    clearTimeout(this.#timer);
    try {
      const state = /** @type {State} */ (await post(request));
      this.#show(state);
      if (state.over) return;
    } catch {
      this.#say('why_host_gone');
    }
    clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => this.#ask({ do: 'class' }), LOOK_MS);
  }

  async #lookForPorts() {
    try {
      const found = await hostPorts();
      this.#ports.replaceChildren(...found.map(({ port, name }) => new Option(shown([name, port].filter(Boolean).join(' · ')), port)));
    } catch {
      this.#say('why_host_gone');
    }
  }

  #give() {
    if (this.#ports.value) this.#ask({ do: 'class_robot', port: this.#ports.value, gives: true });
  }

  /** Ends the class at the second press. */
  #finish() {
    if (this.#isSure) this.#ask({ do: 'class_over', erases: this.#erases.checked });
    this.#sure(!this.#isSure);
  }

  /** @param {boolean} isSure */
  #sure(isSure) {
    this.#isSure = isSure;
    this.#end.dataset['text'] = isSure ? 'class_end_sure' : 'class_end';
    this.#end.textContent = text(String(this.#end.dataset['text']));
    if (isSure) setTimeout(() => this.#sure(false), SURE_MS);
  }

  /** @param {State} state */
  #show({ code, turn_s, places, over, pupils, robots }) {
    this.#code.textContent = code;
    if (document.activeElement !== this.#minutes) this.#minutes.value = String(Math.round(turn_s / 60));
    if (document.activeElement !== this.#places) this.#places.value = String(places);
    if (over) {
      this.#say('class_over');
      element('class', HTMLElement).replaceChildren(this.#said); // nobody is left to do the rest
      return;
    }
    this.#say('class_count', { pupils: pupils.length, robots: robots.length, waiting: pupils.filter(({ place }) => place).length });
    const old = this.#rows;
    this.#rows = new Map();
    for (const each of pupils) this.#showPupil(each, old);
    for (const each of robots) this.#showRobot(each, old);
    for (const [key, row] of old) if (!this.#rows.has(key)) row.item.remove();
  }

  /** @param {PupilRow} pupil @param {Map<string, Row>} old */
  #showPupil({ number, name, silent_s, place, robot }, old) {
    const row = this.#row(`pupil ${number}`, old, this.#pupils, () => [
      button('class_see', () => this.#see(number)),
      button('stop', () => this.#ask({ do: 'class_stop', pupil: number })),
      button('class_next', () => this.#ask({ do: 'class_next', pupil: number })),
      button('class_remove', () => this.#ask({ do: 'class_remove', pupil: number })),
    ]);
    const key = robot ? 'class_drives' : place ? 'class_waits' : silent_s > SILENT_S ? 'class_away' : 'class_writes';
    for (const each of row.item.querySelectorAll(OF_A_TURN)) /** @type {HTMLElement} */ (each).hidden = !robot;
    put(row.name, shown(name));
    put(row.said, text(key, { robot: shown(robot), place }));
  }

  /** @param {RobotRow} robot @param {Map<string, Row>} old */
  #showRobot({ port, name, pupil, left_s }, old) {
    const row = this.#row(`robot ${port}`, old, this.#robots, () => [
      button('class_take', () => this.#ask({ do: 'class_robot', port, gives: false })),
    ]);
    put(row.name, shown([name, port].filter(Boolean).join(' · ')));
    put(row.said, pupil ? text('class_held', { name: shown(pupil), seconds: left_s }) : text('class_free'));
  }

  /**
   * Returns the row that was there, so that a button keeps its focus, or a new one.
   * @param {string} key
   * @param {Map<string, Row>} old
   * @param {HTMLElement} list
   * @param {() => HTMLElement[]} buttons
   */
  #row(key, old, list, buttons) {
    let row = old.get(key);
    if (!row) {
      const name = made('strong');
      const said = made('span');
      row = { name, said, item: made('li', '', name, ' ', said, ' ', ...buttons()) };
      list.append(row.item);
    }
    this.#rows.set(key, row);
    return row;
  }

  /** Shows a pupil's program. @param {number} pupil */
  async #see(pupil) {
    try {
      const answer = await post({ do: 'class_text', pupil });
      this.#program.hidden = false;
      this.#program.textContent = answer.text;
    } catch {
      this.#say('why_host_gone');
    }
  }

  /** @param {string} key @param {Record<string, string | number>} values */
  #say(key, values = {}) {
    put(this.#said, text(key, values));
    document.documentElement.dataset['teacher'] = key;
  }
}

/** @param {HTMLElement} place @param {string} said */
function put(place, said) {
  if (place.textContent !== said) place.textContent = said;
}
