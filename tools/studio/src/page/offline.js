// After the first visit the page needs no server, but for other languages. A newer page is taken once
// no tab has the old one.

export function whenOffline() {
  if (!('serviceWorker' in navigator)) return; // an address that is neither https nor localhost
  navigator.serviceWorker.register('./service_worker.js').catch(() => {
    // A browser that forbids it still shows the page.
  });
}

/** Keeps a language, too. @param {string} language */
export function needLanguage(language) {
  navigator.serviceWorker?.ready.then(({ active }) => active?.postMessage(language));
}
