// Colors and completion of the editor. Knows which sort of word looks like which; the words
// themselves come from `page/words.js`.

import { HighlightStyle, StreamLanguage, syntaxHighlighting } from '@codemirror/language';
import { tags } from '@lezer/highlight';
import { wordsOf } from '../page/words.js';

const VALUE_ROLES = new Set(['value', 'function', 'sensor', 'forever']);
const KEYWORD_ROLES = new Set(['setup', 'block', 'arm', 'end', 'break', 'operator', 'unit']);

/**
 * @param {string | undefined} role
 * @returns {string}
 */
function tokenOfRole(role) {
  if (role === undefined) return 'variableName';
  if (KEYWORD_ROLES.has(role)) return 'keyword';
  return VALUE_ROLES.has(role) ? 'typeName' : 'atom';
}

/**
 * Returns the language of a robot: its own words count.
 * @param {string} robotName
 */
export function languageOfRobot(robotName) {
  const words = wordsOf(robotName);
  return StreamLanguage.define({
    name: 'tiniscript',
    token(stream) {
      if (stream.eatSpace()) return null;
      if (stream.match(/^\/\/.*/)) return 'comment';
      if (stream.match(/^\d*\.?\d+/)) return 'number';
      const word = stream.match(/^[A-Za-z_]\w*/);
      if (word && word !== true) return tokenOfRole(words.get(word[0].toUpperCase())?.role);
      stream.next();
      return 'punctuation';
    },
    languageData: { commentTokens: { line: '//' } },
  });
}

// Each has at least 4.5 times the contrast of the letters that a page must have.
export const highlighting = syntaxHighlighting(
  HighlightStyle.define([
    { tag: tags.keyword, color: 'var(--said-keyword)', fontWeight: '600' },
    { tag: tags.atom, color: 'var(--said-blue)', fontWeight: '600' },
    { tag: tags.typeName, color: 'var(--said-right)' },
    { tag: tags.number, color: 'var(--said-number)' },
    { tag: tags.comment, color: 'var(--soft)' },
    { tag: tags.variableName, color: 'var(--ink)' },
  ]),
);

/**
 * @param {string} robotName
 * @returns {(context: import('@codemirror/autocomplete').CompletionContext) =>
 *   import('@codemirror/autocomplete').CompletionResult | null}
 */
export function completionsForRobot(robotName) {
  const words = [...wordsOf(robotName).values()];
  return (context) => {
    const word = context.matchBefore(/[A-Za-z_]\w*/);
    if (!word && !context.explicit) return null;
    const lineBefore = context.state.doc.lineAt(context.pos).text.slice(0, (word?.from ?? context.pos) - context.state.doc.lineAt(context.pos).from);
    if (lineBefore.includes('//')) return null;
    const names = new Set(
      [...context.state.doc.toString().matchAll(/\b([A-Za-z]\w*)\s*=(?!=)|\bDEF\s+([A-Za-z]\w*)/gi)]
        .map((match) => String(match[1] ?? match[2]).toUpperCase())
        .filter((name) => name !== word?.text.toUpperCase()),
    );
    return {
      from: word?.from ?? context.pos,
      options: [
        ...words.map((word) => ({
          label: word.text,
          type: tokenOfRole(word.role) === 'typeName' ? 'variable' : 'keyword',
          detail: word.example === word.text ? '' : word.example,
        })),
        ...[...names].map((label) => ({ label, type: 'variable' })),
      ],
      validFor: /^\w*$/,
    };
  };
}
