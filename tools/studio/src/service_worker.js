// Keeps the files of one build of the page, and answers with them. `tools.builds.studio` puts the
// build's name, its files, and those of each language into VERSION, FILES and LANGUAGES. A language is
// kept when a page shows it, or a build before has kept it.
//
// It does not take over pages of another build: a worker and a page of two builds would not fit.

const CACHE_PREFIX = 'tiniscript-studio-';
const CACHE_NAME = CACHE_PREFIX + VERSION;

/** @param {string[]} names of files */
async function cacheFiles(names) {
  const cache = await caches.open(CACHE_NAME);
  return cache.addAll(names.map((name) => new Request(name, { cache: 'reload' })));
}

/** Whether a build keeps one of these files. @param {string[]} names */
async function isAnyCached(names) {
  return (await Promise.all(names.map((name) => caches.match(name)))).some(Boolean);
}

self.addEventListener('install', (event) => {
  event.waitUntil(
    Promise.all(Object.values(LANGUAGES).map(async (names) => ((await isAnyCached(names)) ? names : [])))
      .then(async (cachedNames) => {
        await caches.delete(CACHE_NAME); // what is there another server of this address may have put there
        await cacheFiles([...new Set([...FILES, ...cachedNames.flat()])]);
      }),
  );
});

self.addEventListener('message', (event) => {
  const names = LANGUAGES[event.data] ?? [];
  event.waitUntil(
    caches
      .open(CACHE_NAME)
      .then((cache) => Promise.all(names.map((name) => cache.match(name))))
      .then((responses) => (responses.every(Boolean) ? undefined : cacheFiles(names))),
  );
});

self.addEventListener('activate', (event) => {
  event.waitUntil(
    caches
      .keys()
      .then((names) =>
        Promise.all(
          names.filter((name) => name.startsWith(CACHE_PREFIX) && name !== CACHE_NAME).map((name) => caches.delete(name)),
        ),
      )
      .then(() => self.clients.claim()),
  );
});

self.addEventListener('fetch', (event) => {
  if (event.request.method !== 'GET') return;
  event.respondWith(
    caches
      .open(CACHE_NAME)
      .then((cache) => cache.match(event.request, { ignoreSearch: true }))
      .then((response) => response ?? fetch(event.request)),
  );
});
