"""The page of TiniScript Studio in the system's Chromium, which playwright drives.

A test waits for the state that the page reports (`data-state`), never for a time.
"""

from __future__ import annotations

import os
import re
import shutil
import socket
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any, NamedTuple
from weakref import WeakKeyDictionary

from tests.support.command import FOREVER
from tests.support.needs import need
from tests.support.page_server import serves
from tests.support.waiting import HANG_LIMIT_S
from tiniscript import run
from tiniscript.studio import serving
from tiniscript.studio.attending import LEFT_S
from tiniscript.studio.building import MODULES
from tiniscript.studio.classroom import Classroom
from tiniscript.studio.hosting import Hosting
from tools.builds import studio

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext, Page, Playwright, Request

    from tests.support.pty_robot import PtyRobot

# No sandbox: root cannot use one, and these pages are our own.
BROWSER_OPTIONS: tuple[str, ...] = ("--no-sandbox", "--disable-gpu", "--disable-quic",
                                    "--no-first-run",
                                    "--disable-background-networking", "--disable-component-update",
                                    "--disable-sync")  # fmt: skip
SHARED_MEMORY = Path("/dev/shm")
# A container's shared memory is small.
if not SHARED_MEMORY.is_dir() or shutil.disk_usage(SHARED_MEMORY).free < 1 << 30:
    BROWSER_OPTIONS += ("--disable-dev-shm-usage",)
# Code is compiled once and not again for speed: a page of a test does little. The tabs of a context
# share a renderer and its compiled code.
OPTIONS = (*BROWSER_OPTIONS, "--js-flags=--liftoff-only --no-maglev --no-opt", "--process-per-site")
UPLOADS = 10  # number of consecutive stops that cannot be the computer's fault


def missing() -> str:
    """Return the reason why the studio's page cannot be opened here, or ""."""
    return missing_browser() or studio.unusable_reason()


def missing_browser() -> str:
    """Return the reason why no page at all can be opened here, or ""."""
    if find_spec("playwright") is None:
        return "playwright is not installed: pip install playwright"
    if chromium() is None:
        return "there is no Chromium: apt-get install chromium"
    return ""


def missing_firefox() -> str:
    """Return the reason why no page can be opened in Firefox here, or ""."""
    return missing() or ("" if firefox() else "there is no Firefox: apt-get install firefox-esr")


def firefox() -> str | None:
    return os.environ.get("FIREFOX") or shutil.which("firefox-esr") or shutil.which("firefox")


def chromium() -> str | None:
    """Return the browser that people have."""
    return os.environ.get("CHROMIUM") or shutil.which("chromium")


def headless() -> str | None:
    """Return a browser without windows, which takes half the processor time for a page."""
    return os.environ.get("CHROMIUM") or shutil.which("chromium-headless-shell") or chromium()


@contextmanager
def serve_page(page: dict[str, serving.File] | None = None) -> Iterator[serving.Server]:
    """The built page, or another one, at an address of this computer."""
    with serves(serving.Server(page or serving.files(), 0)) as server:
        yield server


@contextmanager
def serve_robots() -> Iterator[serving.Server]:
    """Serve the page with the robots of this computer, as `tsc studio` does."""
    hosting = Hosting()
    try:
        with serves(serving.Server(serving.files(), 0, hosting.answer)) as server:
            yield server
    finally:
        hosting.close()


def room_address() -> str:
    """Return an address of this computer that is not its own alone, or, without a network, one that
    a browser takes for its own."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as connection:
        try:
            connection.connect(("198.51.100.1", 9))
            return str(connection.getsockname()[0])
        except OSError:
            return "127.0.0.2"


class Class(NamedTuple):
    server: serving.Server
    room: Classroom


@contextmanager
def serve_class(ports: list[str]) -> Iterator[Class]:
    """Serve a class at an address of the network, as `tsc studio --class` does."""
    hosting = Hosting()
    room = Classroom(hosting, ports)
    page = serving.for_class(serving.files())
    try:
        with serves(serving.Server(page, 0, room.teach, room, room_address())) as server:
            yield Class(server, room)
    finally:
        hosting.close()


@contextmanager
def driver(needs_studio: bool = True) -> Iterator[Playwright]:
    """Return the driver of browsers, one per process. Other pages need no studio."""
    need(missing() if needs_studio else missing_browser())
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        yield playwright


@contextmanager
def browser(
    playwright: Playwright, *more_options: str, is_whole: bool = False
) -> Iterator[Browser]:
    """A browser; the complete one is the one that people have. `more_options` are options of it."""
    path, options = (chromium(), BROWSER_OPTIONS) if is_whole else (headless(), OPTIONS)
    browser = playwright.chromium.launch(executable_path=path, args=[*options, *more_options])
    try:
        yield browser
    finally:
        browser.close()


# A tab that stays in a context keeps its renderer, and the WebAssembly of Python compiled in it.
STILL_FILE = "licences.txt"
HOLDING_SCRIPT = """async () => {
  window.held = await WebAssembly.compileStreaming(fetch('./pyodide.asm.wasm'));
}"""
_LEFT_CONTEXTS: WeakKeyDictionary[Browser, list[BrowserContext]] = WeakKeyDictionary()


class Pages:
    """Pages of one server; at the end, none may have reported an error or contacted another server.

    Most visitors get a context that an earlier one has left, without open tabs and stored data. A
    test's changes to a whole context (scripts that begin each page, permissions) stay, so such a
    test requests its own context.
    """

    def __init__(
        self, browser: Browser, address: str, patience_s: int = 90,
        entrance: Callable[[], str] | None = None,
    ) -> None:  # fmt: skip
        """Pages ask at `address` alone; `entrance` makes the one that each is opened with."""
        self.patience_s = patience_s
        self.address = address
        self.entrance = entrance or (lambda: address)
        self.errors: list[str] = []
        self._browser = browser
        self._contexts: list[BrowserContext] = []
        self._to_leave: list[BrowserContext] = []

    def open(self, view: str = "text", **options: Any) -> Page:
        """Open a page of a new visitor, and wait until its program is compiled.

        `view` is `start`, which a new visitor sees, `blocks` after it, or `text`, which most tests
        write; the others are those of `visit`.
        """
        return self.visit(self.entrance(), view, **options)

    def another(self, page: Page) -> Page:
        """Open another tab of the same visitor."""
        new_page: Page = page.context.new_page()
        self.watch(new_page)
        enter(new_page, self.entrance())
        return new_page

    def blank(self, *, is_alone: bool = False, **options: Any) -> Page:
        """Return a tab of a new visitor, without an open page.

        With `is_alone`, or options for Playwright, it is in a context of its own.
        """
        context = self._own(options) if is_alone or options else self._lend_context()
        context.set_default_timeout(1000 * self.patience_s)
        context.on("request", self._note_request)
        page = context.new_page()
        self.watch(page)
        return page

    def visit(self, address: str, view: str = "text", **options: Any) -> Page:
        """Open an address of the page, for a new visitor; the teacher's has the view `wall`.

        `options` are those of `blank`.
        """
        page = self.blank(**options)
        if view == "start":
            page.goto(address)
            # The screen with its texts.
            page.locator("html[data-screen=start]").wait_for(state="attached")
        else:
            enter(page, address)
        if view == "text":
            page.click("#view_text")
        elif view == "blocks":
            wait_for_blocks(page)
        return page

    def _own(self, options: dict[str, Any]) -> BrowserContext:
        settings = {
            "viewport": {"width": 1366, "height": 768},
            "locale": "en-US",
            "service_workers": "block",  # each would fetch everything a second time
            **options,
        }
        self._contexts.append(self._browser.new_context(**settings))
        return self._contexts[-1]

    def _lend_context(self) -> BrowserContext:
        left_contexts = _LEFT_CONTEXTS.setdefault(self._browser, [])
        if left_contexts:
            context = left_contexts.pop()
        else:
            context = self._own({})
            self._contexts.remove(context)
            still_page = context.new_page()
            still_page.goto(self.address + STILL_FILE)
            still_page.evaluate(HOLDING_SCRIPT)
        self._to_leave.append(context)
        return context

    def watch(self, page: Page) -> None:
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.on(
            "console",
            lambda console_message: self._note_message(console_message.type, console_message.text),
        )

    def close(self) -> None:
        """Close the pages; the data of visitors is deleted."""
        for context in self._contexts:
            context.close()
        for context in self._to_leave:
            context.remove_listener("request", self._note_request)
            still_page, *other_pages = context.pages
            for page in other_pages:
                page.close()
            session = context.new_cdp_session(still_page)
            clear_options = {"origin": self.address.rstrip("/"), "storageTypes": "all"}
            session.send("Storage.clearDataForOrigin", clear_options)
            session.detach()
            _LEFT_CONTEXTS[self._browser].append(context)

    def _note_message(self, kind: str, text: str) -> None:
        if kind in ("error", "warning") and "blocked by Playwright" not in text:
            self.errors.append(text)

    def _note_request(self, request: Request) -> None:
        if not request.url.startswith((self.address, "data:", "blob:")):
            self.errors.append(request.url)


def enter(page: Page, address: str) -> None:
    """Open an address, leave the start screen, and wait until the program is compiled."""
    page.goto(address)
    wait_until_checked(page)
    if page.locator("html[data-screen=start]").count():
        page.click("#start_write")


# Actions of a person who starts again: the home button ends a lesson, a drawing and a run.
_START_AGAIN_SCRIPT = """() => {
  const at = (id) => document.getElementById(id);
  for (const each of document.querySelectorAll('dialog[open]')) each.close();
  const pressed = ['stop', 'home', 'start_write', 'view_text', 'seen_arena', 'bar_new'];
  for (const id of pressed) at(id).click();
  for (const id of ['words', 'why']) if (at(id).ariaPressed === 'true') at(id).click();
  for (const [id, value] of [['robot', 'tinibot'], ['world', 'obstacles'], ['speed', '1']]) {
    if (at(id).value === value) continue;
    at(id).value = value;
    at(id).dispatchEvent(new Event('change'));
  }
}"""


def begin_anew(page: Page) -> None:
    """Reset a used page to the state after `Pages.open`, with an empty program.

    In English, for a tinibot among obstacles; no lesson, no drawing and no run goes on. The page
    keeps its stored data: runs, programs, drawn worlds, the open lesson and its step.
    """
    page.bring_to_front()  # another page may have the focus
    page.set_viewport_size({"width": 1366, "height": 768})
    if page.input_value("#language") != "en":
        speak(page, "en")
    page.evaluate(_START_AGAIN_SCRIPT)
    wait_until_checked(page)


# After a new size of the screen has been noticed and drawn.
SETTLED_SCRIPT = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"


def finger(page: Page, points: Sequence[tuple[float, float]]) -> None:
    """Go along a way on the screen with a finger."""
    session = page.context.new_cdp_session(page)
    for k, (x, y) in enumerate(points):
        kind = "touchMove" if k else "touchStart"
        touch = {"type": kind, "touchPoints": [{"x": x, "y": y}]}
        session.send("Input.dispatchTouchEvent", touch)
    session.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    session.detach()


def colors_of(page: Page, canvas: str) -> set[str]:
    """Return the colors of the opaque pixels of a canvas."""
    colors = page.evaluate(
        "(id) => { const c = document.querySelector(id); const d = c.getContext('2d')"
        ".getImageData(0, 0, c.width, c.height).data; const found = new Set();"
        " for (let k = 0; k < d.length; k += 4)"
        " if (d[k + 3] === 255) found.add(d.slice(k, k + 3).join());"
        " return [...found]; }",
        canvas,
    )
    return set(colors)


def turn(page: Page, half: str) -> None:
    """See the `program` or the `robot`, where the page shows one of them at a time."""
    page.evaluate(SETTLED_SCRIPT)
    if page.locator(f"html[data-phone]:not([data-half={half}])").count():
        page.click("#other")


def wait_for_phase(page: Page, phase: str) -> None:
    """Wait until the virtual robot's run is there: `off`, `running`, `paused` or `ended`."""
    page.locator(f"html[data-phase={phase}]").wait_for(state="attached")


def wait_for(page: Page, is_reached: Callable[[], object], description: str) -> None:
    """Wait until something is so that a page tells of while it is waited for."""
    end_s = monotonic() + HANG_LIMIT_S
    while not is_reached():
        assert monotonic() < end_s, f"not after {HANG_LIMIT_S} s: {description}"
        page.wait_for_timeout(20)


def wait_until_checked(page: Page) -> None:
    """Wait until the editor's text is compiled; the page's policy forbids waiting functions."""
    page.locator("html[data-state=checked]").wait_for(state="attached")


def speak(page: Page, language: str) -> None:
    """Choose a language, and wait until its texts are there."""
    page.select_option("#language", language)
    page.locator(f"html[lang={language}]").wait_for(state="attached")


def wait_for_blocks(page: Page) -> None:
    """Wait until the blocks are those of the text, and the text is compiled."""
    page.locator("#blocks[data-state=shown]").wait_for()
    wait_until_checked(page)


def start_drive(page: Page, robot: PtyRobot) -> None:
    """Make a page's robot drive, and wait until it does.

    A busy computer can keep a page silent for so long that its robot is stopped before this thread
    has seen it drive. Then the page asks again.
    """
    write(page, FOREVER)
    locator = page.locator("#link_said")
    for _ in range(UPLOADS):
        page.click("#link_upload")
        locator.filter(has_text=re.compile("The robot has the program|Stopped: ")).wait_for()
        robot.until(lambda: robot.moves or "Stopped: " in locator.inner_text(), "it drives")
        if robot.moves:
            return
    raise AssertionError(f"stopped {UPLOADS} times")


# Longer than any robot goes on without a word, and a second shorter than a page has left after.
LONGEST_HANG_MS = round(1000 * (LEFT_S - 1))


def hang(page: Page, milliseconds: int) -> None:
    """Make the page's main thread hang, from now on."""
    page.evaluate(
        "(hung) => { setTimeout(() => { const end = performance.now() + hung;"
        " while (performance.now() < end); }, 0); }",
        milliseconds,
    )


def wait_for_note(page: Page, text: str) -> None:
    """Wait until the page has said so below the editor."""
    page.locator("#note").filter(has_text=text).wait_for()


def write(page: Page, text: str) -> None:
    """Replace the program as a person does, and wait until it is compiled."""
    content = page.locator(".cm-content")
    assert content.is_visible(), "nobody writes into an editor that is not seen"
    content.focus()
    page.keyboard.press("Control+a")
    page.keyboard.press("Delete")
    if text:
        page.keyboard.insert_text(text)
    wait_until_checked(page)


def axe(page: Page, *rules: str, within: str = "html") -> list[tuple[str, str]]:
    """Return axe's findings in an element, for these rules or all: the rule, the first place.

    The page hangs meanwhile, for seconds where the computer is busy: a robot that it drives is
    stopped, and one to which it is connected is left. So this comes last, if it exists.
    """
    if not page.evaluate("'axe' in window"):
        page.evaluate((MODULES / "axe-core" / "axe.min.js").read_text(encoding="utf-8"))
    problems: list[tuple[str, str]] = page.evaluate(_AXE_SCRIPT, [within, *rules])
    return [(rule, html) for rule, html in problems]


# Passing results are neither described nor sent to Python.
_AXE_SCRIPT = """async ([within, ...rules]) => {
  const only = rules.length ? {runOnly: rules} : {};
  const found = await axe.run(within, {...only, resultTypes: ['violations']});
  return found.violations.map(({id, nodes}) => [id, nodes[0].html]);
}"""


def image(page: Page) -> bytes:
    return bytes.fromhex(str(page.evaluate("document.documentElement.dataset.image")))


# The page's Python, asked as the page asks it: many requests at once. A request's other content is
# the bytes of `text`, or of `image` in hexadecimal digits.
# One worker answers all that a page is asked: Python takes a while to start. After an error it is
# another one.
_ASK_WORKER_SCRIPT = """async (requests) => {
  const worker = window.answers ?? new Worker('./worker.js', {type: 'module'});
  window.answers = undefined;
  const send = (requests) => new Promise((resolve, reject) => {
    const answers = [];
    worker.onmessage = ({data}) => {
      if (data.error) { reject(new Error(data.error)); return; }
      if (data.id) answers.push(JSON.parse(data.answer));
      if (answers.length === requests.length) resolve(answers);
    };
    worker.onerror = (event) => reject(new Error(event.message));
    requests.forEach(({text, image, ...request}, k) => {
      const data = image ? Uint8Array.from(image.match(/../g), (pair) => parseInt(pair, 16))
        : new TextEncoder().encode(text ?? '');
      worker.postMessage({id: k + 1, request: JSON.stringify(request), data});
    });
  });
  const languages = new Set(['en', ...requests.flatMap(({language}) => language ?? [])]);
  await send([...languages].map((language) => ({do: 'learn', language})));
  const answers = await send(requests);
  window.answers = worker;
  return answers;
}"""


def ask_worker(page: Page, requests: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the answers of a worker to requests, in their order."""
    answers: list[dict[str, Any]] = page.evaluate(_ASK_WORKER_SCRIPT, requests)
    return answers


DANCE = "F(1, 80);R(0.5, 60);BEEP(0.1, 440);SHOW(5);B(0.2, 50)"  # reads no sensor


def dance_like_the_command(page: Page) -> list[str]:
    """Run a program to its end: the list is the trace of `tsc run`, which is returned."""
    write(page, DANCE)
    page.select_option("#speed", "20")
    page.click("#run")
    wait_for_phase(page, "ended")
    expected_texts = [f"{event.ms} {event.text}" for event in run(DANCE).events]
    assert (page.locator("#trace").text_content() or "").split("\n") == expected_texts
    return expected_texts
