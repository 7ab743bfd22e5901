// Light or dark: as the system has it, until somebody chooses, which this device keeps.

import { element } from './elements.js';
import { storeText, loadText } from './kept.js';

const STORAGE_KEY = 'tiniscript.theme';
const DARK_QUERY = matchMedia('(prefers-color-scheme: dark)');
const themeButton = element('theme', HTMLButtonElement);

export function startTheme() {
  DARK_QUERY.addEventListener('change', showTheme);
  addEventListener('storage', showTheme); // another tab has chosen
  themeButton.addEventListener('click', () => {
    storeText(STORAGE_KEY, isDark() ? 'light' : 'dark');
    showTheme();
  });
  showTheme();
}

function isDark() {
  const chosenTheme = loadText(STORAGE_KEY);
  return chosenTheme === 'dark' || (chosenTheme !== 'light' && DARK_QUERY.matches);
}

function showTheme() {
  document.documentElement.toggleAttribute('data-dark', isDark());
  themeButton.setAttribute('aria-pressed', String(isDark()));
}
