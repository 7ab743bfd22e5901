// Why a program was where it was at a moment: the conditions around the instruction with the values that were read, and
// whose motors they were. Knows no page.

/** @typedef {import('../python.js').CheckResult['places']} Places */
/** @typedef {{line: number, condition: string, values: string, is: boolean | null}} Condition `is` null: it goes on being asked */

const BLOCK_WORD = /\b(?:IF|WHILE|WHEN|ELSEIF|ELSE|END_?(?:IF|WHILE|WHEN))\b/gi;
const UNTIL_WORD = /\bUNTIL\b/gi;
const NAME = /[A-Z_]\w*/gi;
const COMMENT = /\/\/.*/g;

/**
 * @param {string} text of the program
 * @param {Places} places
 * @param {number} offset an offset in its code
 * @param {(name: string) => string | undefined} valueOf of a sensor or a variable, as it was
 * @returns {Condition[]} from the outermost to the innermost one
 */
export function conditionsAt(text, places, offset, valueOf) {
  const plainText = text.replace(COMMENT, (comment) => ' '.repeat(comment.length));
  const lines = plainText.split('\n');
  const place = places.findLast(([from]) => from <= offset);
  if (!place) return [];
  const [, line, column, endLine, endColumn] = place;
  const start = lines.slice(0, line - 1).reduce((sum, textLine) => sum + textLine.length + 1, 0) + column - 1;
  /** @type {Condition[]} */
  const conditions = [];
  const addCondition = (/** @type {number} */ headOffset, /** @type {boolean | null} */ isTrue) => {
    const condition = bracketContent(plainText, headOffset);
    const values = condition.replace(NAME, (name) => valueOf(name.toUpperCase()) ?? name);
    if (condition) conditions.push({ line: plainText.slice(0, headOffset).split('\n').length, condition, values, is: isTrue });
  };
  for (const heads of openBlocksAt(plainText, start)) heads.forEach((headOffset, index) => addCondition(headOffset, index === heads.length - 1));
  const statement = (lines[line - 1] ?? '').slice(column - 1, endLine > line ? undefined : endColumn - 1);
  if (/^(?:IF|ELSEIF|WHILE|WHEN)\b/i.test(statement)) addCondition(start, null);
  for (const { index } of statement.matchAll(UNTIL_WORD)) addCondition(start + index, null);
  return conditions;
}

/** The blocks that are open at a place, each by its heads until there: an IF and its ELSEIFs and ELSE. @param {string} text @param {number} offset */
function openBlocksAt(text, offset) {
  /** @type {number[][]} */
  const openBlocks = [];
  for (const { 0: word, index } of text.slice(0, offset).matchAll(BLOCK_WORD)) {
    if (/^END/i.test(word)) openBlocks.pop();
    else if (/^ELSE/i.test(word)) openBlocks.at(-1)?.push(index);
    else openBlocks.push([index]);
  }
  return openBlocks;
}

/** What is in the brackets after a word. @param {string} text @param {number} offset */
function bracketContent(text, offset) {
  const opening = /^\w+\s*\(/.exec(text.slice(offset));
  if (!opening) return '';
  let depth = 1, end = offset + opening[0].length;
  for (; depth && end < text.length; end += 1) depth += text[end] === '(' ? 1 : text[end] === ')' ? -1 : 0;
  return text.slice(offset + opening[0].length, end - 1).replace(/\s+/g, ' ').trim();
}

/** @typedef {{line: number, has: (at: number, isBody?: boolean) => boolean}} CodeBlock whether an offset of the code is in it, or in what comes after its head */

/**
 * The blocks of a program that begin with a word.
 * @param {string} text
 * @param {Places} places
 * @param {RegExp} word
 * @returns {CodeBlock[]}
 */
export function blocksOf(text, places, word) {
  const lines = text.split('\n');
  const blockPlaces = places.filter(([, line, column]) => word.test((lines[line - 1] ?? '').slice(column - 1)));
  return blockPlaces.map(([, line, column, endLine, endColumn]) => ({
    line,
    has: (offset, isBody = false) => {
      const place = places.findLast(([from]) => from <= offset);
      if (!place) return false;
      const isHead = line === place[1] && column === place[2];
      const isAfter = line < place[1] || (line === place[1] && column <= place[2]);
      return isAfter && (endLine > place[3] || (endLine === place[3] && endColumn >= place[4])) && !(isBody && isHead);
    },
  }));
}
