// Light or dark: as the system has it, until somebody chooses, which this device keeps.

import { element } from './elements.js';
import { keepsNothing } from '../programs/work.js';

const PLACE = 'tiniscript.theme';
const SYSTEM = matchMedia('(prefers-color-scheme: dark)');
const button = element('theme', HTMLButtonElement);

export function beginTheme() {
  SYSTEM.addEventListener('change', show);
  addEventListener('storage', show); // another tab has chosen
  button.addEventListener('click', () => {
    try {
      if (!keepsNothing()) localStorage.setItem(PLACE, isDark() ? 'light' : 'dark');
    } catch {
      // no storage here: as the system has it
    }
    show();
  });
  show();
}

function isDark() {
  let chosen = null;
  try {
    chosen = localStorage.getItem(PLACE);
  } catch {
    // no storage here
  }
  return chosen === 'dark' || (chosen !== 'light' && SYSTEM.matches);
}

function show() {
  document.documentElement.toggleAttribute('data-dark', isDark());
  button.setAttribute('aria-pressed', String(isDark()));
}
