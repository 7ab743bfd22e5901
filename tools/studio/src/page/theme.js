// Light or dark: as the system has it, until somebody chooses, which this device keeps.

import { element } from './elements.js';
import { keepAt, kept } from './kept.js';

const PLACE = 'tiniscript.theme';
const SYSTEM = matchMedia('(prefers-color-scheme: dark)');
const button = element('theme', HTMLButtonElement);

export function beginTheme() {
  SYSTEM.addEventListener('change', show);
  addEventListener('storage', show); // another tab has chosen
  button.addEventListener('click', () => {
    keepAt(PLACE, isDark() ? 'light' : 'dark');
    show();
  });
  show();
}

function isDark() {
  const chosen = kept(PLACE);
  return chosen === 'dark' || (chosen !== 'light' && SYSTEM.matches);
}

function show() {
  document.documentElement.toggleAttribute('data-dark', isDark());
  button.setAttribute('aria-pressed', String(isDark()));
}
