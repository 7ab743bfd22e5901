// Why a program was where it was at a moment: the conditions around the instruction with the values that were read and
// the answers, and whose motors they were. Knows no page.

/** @typedef {import('../python.js').CheckResult['places']} Places */
/** @typedef {{line: number, condition: string, values: [string, string][], isTrue: boolean | null}} Condition `values` of what it names, `isTrue` null: nobody knows */
/** @typedef {(name: string) => string | undefined} ValueOf of a sensor or a variable, as it was */

const BLOCK_WORD = /\b(?:IF|WHILE|WHEN|ELSEIF|ELSE|END_?(?:IF|WHILE|WHEN))\b/gi;
const UNTIL_WORD = /\bUNTIL\b/gi;
const NAME = /[A-Z_]\w*/gi;
const COMMENT = /\/\/.*/g;
const TOKEN = /\d+(?:\.\d+)?|[A-Z_]\w*|<>|<=|>=|\S/gi;
/** @typedef {(left: number, right: number) => number | boolean} Operation */
/** From what binds least to what binds most; NOT is between AND and the comparisons. @type {Record<string, Operation>[]} */
const BINARY_OPERATIONS = [
  { '=': (a, b) => a === b, '<>': (a, b) => a !== b, '<': (a, b) => a < b, '<=': (a, b) => a <= b, '>': (a, b) => a > b, '>=': (a, b) => a >= b },
  { '+': (a, b) => a + b, '-': (a, b) => a - b },
];
/** @type {Record<string, (...values: number[]) => number>} */
const FUNCTIONS = { ABS: Math.abs, MIN: Math.min, MAX: Math.max };

/**
 * @param {string} text of the program
 * @param {Places} places
 * @param {number} offset an offset in its code
 * @param {ValueOf} valueOf
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
    if (!condition) return;
    const answer = evaluateCondition(condition, valueOf);
    const names = [...new Set(condition.toUpperCase().match(NAME))];
    // Other values than those that it was answered with say nothing of the answer: they were read later.
    const isLater = isTrue !== null && answer !== null && answer !== isTrue;
    const values = isLater ? [] : names.flatMap((name) => { const value = valueOf(name); return value === undefined ? [] : [/** @type {[string, string]} */ ([name, value])]; });
    conditions.push({ line: plainText.slice(0, headOffset).split('\n').length, condition, values, isTrue: isTrue ?? answer });
  };
  for (const headOffsets of openBlocksAt(plainText, start)) headOffsets.forEach((headOffset, index) => addCondition(headOffset, index === headOffsets.length - 1));
  const statement = (lines[line - 1] ?? '').slice(column - 1, endLine > line ? undefined : endColumn - 1);
  if (/^(?:IF|ELSEIF|WHILE|WHEN)\b/i.test(statement)) addCondition(start, null);
  for (const { index } of statement.matchAll(UNTIL_WORD)) addCondition(start + index, null);
  return conditions;
}

/** What values make of a condition, counted in thousandths as the robot does. Null if that is not known: of RANDOM, and of what is rounded. @param {string} condition @param {ValueOf} valueOf @returns {boolean | null} */
function evaluateCondition(condition, valueOf) {
  const tokens = condition.toUpperCase().match(TOKEN) ?? [];
  const acceptToken = (/** @type {string} */ wanted) => tokens[0] === wanted && Boolean(tokens.shift());
  /** @typedef {number | boolean | null} Answer */
  const isTrue = (/** @type {Answer} */ value) => (value === null ? null : Boolean(value));
  /** @returns {Answer} */
  const parseOr = () => {
    let value = parseAnd();
    while (acceptToken('OR')) {
      const left = isTrue(value), right = isTrue(parseAnd());
      value = left || right || (left === null || right === null ? null : false);
    }
    return value;
  };
  /** @returns {Answer} */
  const parseAnd = () => {
    let value = parseNot();
    while (acceptToken('AND')) {
      const left = isTrue(value), right = isTrue(parseNot());
      value = left === false || right === false ? false : left === null || right === null ? null : true;
    }
    return value;
  };
  /** @returns {Answer} */
  const parseNot = () => {
    if (!acceptToken('NOT')) return parseBinary(0);
    const value = isTrue(parseNot());
    return value === null ? null : !value;
  };
  /** @param {number} level @returns {Answer} */
  const parseBinary = (level) => {
    const operations = BINARY_OPERATIONS[level];
    if (!operations) return parsePrimary();
    let value = parseBinary(level + 1);
    for (let operation = operations[tokens[0] ?? '']; operation; operation = operations[tokens[0] ?? '']) {
      tokens.shift();
      const right = parseBinary(level + 1);
      value = value === null || right === null ? null : operation(Number(value), Number(right));
    }
    return value;
  };
  /** @returns {Answer} */
  const parsePrimary = () => {
    const token = tokens.shift() ?? '';
    if (token === '-') {
      const value = parsePrimary();
      return value === null ? null : -value;
    }
    if (token === '(') {
      const value = parseOr();
      acceptToken(')');
      return value;
    }
    if (acceptToken('(')) {
      const values = [parseOr()];
      while (acceptToken(',')) values.push(parseOr());
      acceptToken(')');
      return values.includes(null) ? null : FUNCTIONS[token]?.(...values.map(Number)) ?? null;
    }
    const valueText = valueOf(token) ?? token;
    if (valueText === 'TRUE' || valueText === 'FALSE') return valueText === 'TRUE';
    const thousandths = Math.round(1000 * Number(valueText));
    return Number.isFinite(thousandths) ? thousandths : null;
  };
  const answer = parseOr();
  return tokens.length ? null : isTrue(answer);
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

/** @typedef {{line: number, hasOffset: (at: number, isBody?: boolean) => boolean}} CodeBlock whether an offset of the code is in it, or in what comes after its head */

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
    hasOffset: (offset, isBody = false) => {
      const place = places.findLast(([from]) => from <= offset);
      if (!place) return false;
      const isHead = line === place[1] && column === place[2];
      const isAfter = line < place[1] || (line === place[1] && column <= place[2]);
      return isAfter && (endLine > place[3] || (endLine === place[3] && endColumn >= place[4])) && !(isBody && isHead);
    },
  }));
}
