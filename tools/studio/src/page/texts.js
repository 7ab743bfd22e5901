// Every sentence of the page, in the language that is chosen. They come from the catalogue `studio`
// of `languages/`, of which the build makes a file for each language. What is said of programs comes
// from the compiler.

import languages from '../../made/languages.json';
import { storeLanguage } from './offline.js';
import { pageState } from './page_state.js';
import { watchedFetch } from './progress.js';

/** @typedef {Exclude<keyof typeof import('../../made/texts.en.json'), ''>} Key */

/** Code and name of each language. @type {[string, string][]} */
export const LANGUAGES = /** @type {any} */ (languages);

const SOURCE_LANGUAGE = LANGUAGES[0]?.[0] ?? ''; // what others fall back to

let wantedLanguage = '';
/** A text, or its forms for numbers; which form is for which number has no key. @type {Record<string, string | string[]>} */
let texts = {};

/** @returns {string} */
export function currentLanguage() {
  return pageState.language.value;
}

/** @param {unknown} locale such as `pt-BR` @returns {string} the language to begin with */
export function languageOf(locale) {
  const code = String(locale).toLowerCase().split('-')[0];
  return (LANGUAGES.find(([candidate]) => candidate === code) ?? [SOURCE_LANGUAGE])[0];
}

/** @param {string} chosenLanguage @returns {Promise<string>} the language that is seen now: without a connection it may be the one before */
export async function setLanguage(chosenLanguage) {
  let language = '';
  wantedLanguage = chosenLanguage;
  for (const code of [chosenLanguage, ...(currentLanguage() ? [] : LANGUAGES.map(([languageCode]) => languageCode))]) {
    const catalogue = await watchedFetch(`./texts.${code}.json`).then((response) => (response.ok ? response.json() : null)).catch(() => null);
    if (chosenLanguage !== wantedLanguage) return currentLanguage(); // another one was chosen meanwhile
    if (!catalogue) continue;
    texts = catalogue;
    language = code;
    break;
  }
  language ||= currentLanguage(); // as it is now: the same one may have been chosen twice
  storeLanguage(language);
  document.documentElement.lang = language;
  for (const element of document.querySelectorAll('[data-text]')) {
    element.textContent = text(textKey(element.getAttribute('data-text')));
  }
  for (const element of document.querySelectorAll('[data-label]')) {
    const label = text(textKey(element.getAttribute('data-label')));
    element.setAttribute('aria-label', label);
    if (element instanceof HTMLButtonElement) element.title = label;
  }
  pageState.language.set(language);
  return language;
}

/** @param {string} key @returns {key is Key} */
export function hasText(key) {
  return Object.hasOwn(texts, key);
}

/** @param {unknown} key which is made of parts @returns {Key} */
export function textKey(key) {
  if (!hasText(String(key))) throw new Error(`no text ${key}`);
  return /** @type {Key} */ (key);
}

/**
 * @param {Key} key
 * @param {Record<string, string | number>} values
 * @returns {string}
 */
export function text(key, values = {}) {
  const entry = texts[textKey(key)] ?? '';
  const sentence = typeof entry === 'string' ? entry : entry[pluralFormIndex(Number(values['count']))] ?? '';
  return sentence.replace(/\{(\w+)\}/g, (placeholder, name) => (name in values ? String(values[name]) : placeholder));
}

/** @param {number} count @returns {number} which form of a text is for it: rules repeat after a hundred */
function pluralFormIndex(count) {
  return Number(texts['']?.[count < 100 ? count : 100 + (count % 100)]);
}

/** @param {string} prefix of keys @returns {Record<string, string>} its texts as they are, by what follows in their keys */
export function textsOf(prefix) {
  const entries = Object.entries(texts).filter(([key]) => key.startsWith(`${prefix}/`));
  return Object.fromEntries(entries.map(([key, entry]) => [key.slice(prefix.length + 1), String(entry)]));
}

/** @param {Record<string, string>} labels of a world, a robot or a device by language, or none @returns {string} what it is called */
export function labelOf(labels) {
  return labels[currentLanguage()] ?? labels[SOURCE_LANGUAGE] ?? '';
}
