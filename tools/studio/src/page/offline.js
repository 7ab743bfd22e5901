// After the first visit the page needs no server, but for other languages. A newer page is taken once
// no tab has the old one.
//
// An address such as 127.0.0.1:7070 is not one person's alone: another user's server may have had it
// before, and have left a service worker, which reads all that a page asks from then on.

const WORKER_URL = './service_worker.js';

export function registerServiceWorker() {
  if (!('serviceWorker' in navigator)) return; // an address that is neither https nor localhost
  navigator.serviceWorker.register(WORKER_URL).catch(() => {
    // A browser that forbids it still shows the page.
  });
}

/** Keeps a language, too. @param {string} language */
export function storeLanguage(language) {
  navigator.serviceWorker?.ready.then(({ active }) => active?.postMessage(language));
}

/**
 * Takes every service worker away that is not the one that this server has, to the byte, and all that
 * such a one may have kept; returns whether there was one. It goes with the page: that must be loaded again.
 * @returns {Promise<boolean>}
 */
export async function removeForeignWorkers() {
  const registrations = (await navigator.serviceWorker?.getRegistrations()) ?? [];
  const areOwn = await Promise.all(registrations.map(isOwnWorker));
  if (areOwn.every(Boolean)) return false;
  await Promise.all(registrations.map((registration, index) => areOwn[index] || registration.unregister()));
  for (const name of await caches.keys()) await caches.delete(name);
  return true;
}

/** Whether the server has what runs. Its worker is asked for past all workers, and compared by the browser. @param {ServiceWorkerRegistration} registration */
async function isOwnWorker(registration) {
  const getNewestWorker = () => registration.installing ?? registration.waiting ?? registration.active;
  const runningWorker = registration.active ?? getNewestWorker();
  if (runningWorker !== getNewestWorker() || runningWorker?.scriptURL !== new URL(WORKER_URL, location.href).href) return false;
  if (registration.updateViaCache !== 'imports') return false; // it would be compared with what a browser has kept
  try {
    await registration.update();
  } catch {
    return false;
  }
  return runningWorker === getNewestWorker();
}
