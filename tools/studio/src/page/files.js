// Files of programs: chosen by a person, and saved as any download. Knows no program.

import { element } from './elements.js';

// One more than the compiler reads: it says that the file is too large.
const MAX_BYTES = 1_000_001;

/** @param {string} id of the input @param {(file: File) => void} onFile with each file that a person chooses there */
export function onFileChosen(id, onFile) {
  const input = element(id, HTMLInputElement);
  input.addEventListener('change', () => {
    const file = input.files?.[0];
    input.value = ''; // the same one can be chosen again
    if (file) onFile(file);
  });
}

/**
 * @param {File} file
 * @returns {Promise<Uint8Array>}
 */
export async function readBytes(file) {
  return new Uint8Array(await file.slice(0, MAX_BYTES).arrayBuffer());
}

/**
 * @param {string} name
 * @param {string} text
 */
export function downloadText(name, text) {
  downloadFile(name, new Blob([text], { type: 'text/plain;charset=utf-8' }));
}

/**
 * @param {string} name
 * @param {Blob} file
 */
export function downloadFile(name, file) {
  const url = URL.createObjectURL(file);
  const link = document.createElement('a');
  link.href = url;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
