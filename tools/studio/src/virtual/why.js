// Why a program was where it was at a moment: the conditions around the instruction with the values that were read, and
// whose motors they were. Knows no page.

/** @typedef {import('../python.js').Checked['places']} Places */
/** @typedef {{line: number, condition: string, values: string, is: boolean | null}} Condition `is` null: it goes on being asked */

const BLOCK = /\b(?:IF|WHILE|WHEN|ELSEIF|ELSE|END_?(?:IF|WHILE|WHEN))\b/gi;
const UNTIL = /\bUNTIL\b/gi;
const NAME = /[A-Z_]\w*/gi;
const COMMENT = /\/\/.*/g;

/**
 * @param {string} text of the program
 * @param {Places} places
 * @param {number} at an offset in its code
 * @param {(name: string) => string | undefined} valueOf of a sensor or a variable, as it was
 * @returns {Condition[]} from the outermost to the innermost one
 */
export function conditionsAt(text, places, at, valueOf) {
  const plain = text.replace(COMMENT, (comment) => ' '.repeat(comment.length));
  const lines = plain.split('\n');
  const here = places.findLast(([from]) => from <= at);
  if (!here) return [];
  const [, line, column, endLine, endColumn] = here;
  const from = lines.slice(0, line - 1).reduce((sum, each) => sum + each.length + 1, 0) + column - 1;
  /** @type {Condition[]} */
  const found = [];
  const add = (/** @type {number} */ head, /** @type {boolean | null} */ is) => {
    const condition = insideOf(plain, head);
    const values = condition.replace(NAME, (name) => valueOf(name.toUpperCase()) ?? name);
    if (condition) found.push({ line: plain.slice(0, head).split('\n').length, condition, values, is });
  };
  for (const heads of openAt(plain, from)) heads.forEach((head, k) => add(head, k === heads.length - 1));
  const own = (lines[line - 1] ?? '').slice(column - 1, endLine > line ? undefined : endColumn - 1);
  if (/^(?:IF|ELSEIF|WHILE|WHEN)\b/i.test(own)) add(from, null);
  for (const { index } of own.matchAll(UNTIL)) add(from + index, null);
  return found;
}

/** The blocks that are open at a place, each by its heads until there: an IF and its ELSEIFs and ELSE. @param {string} text @param {number} until */
function openAt(text, until) {
  /** @type {number[][]} */
  const open = [];
  for (const { 0: word, index } of text.slice(0, until).matchAll(BLOCK)) {
    if (/^END/i.test(word)) open.pop();
    else if (/^ELSE/i.test(word)) open.at(-1)?.push(index);
    else open.push([index]);
  }
  return open;
}

/** What is in the brackets after a word. @param {string} text @param {number} from */
function insideOf(text, from) {
  const open = /^\w+\s*\(/.exec(text.slice(from));
  if (!open) return '';
  let depth = 1, end = from + open[0].length;
  for (; depth && end < text.length; end += 1) depth += text[end] === '(' ? 1 : text[end] === ')' ? -1 : 0;
  return text.slice(from + open[0].length, end - 1).replace(/\s+/g, ' ').trim();
}

/** @typedef {{line: number, has: (at: number, isBody?: boolean) => boolean}} Block whether an offset of the code is in it, or in what comes after its head */

/**
 * The blocks of a program that begin with a word.
 * @param {string} text
 * @param {Places} places
 * @param {RegExp} word
 * @returns {Block[]}
 */
export function blocksOf(text, places, word) {
  const lines = text.split('\n');
  const begun = places.filter(([, line, column]) => word.test((lines[line - 1] ?? '').slice(column - 1)));
  return begun.map(([, line, column, endLine, endColumn]) => ({
    line,
    has: (at, isBody = false) => {
      const here = places.findLast(([from]) => from <= at);
      if (!here) return false;
      const isHead = line === here[1] && column === here[2];
      const isAfter = line < here[1] || (line === here[1] && column <= here[2]);
      return isAfter && (endLine > here[3] || (endLine === here[3] && endColumn >= here[4])) && !(isBody && isHead);
    },
  }));
}
