"""If an expected event never comes, the page reports that, and ends the wait."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.support import studio
from tests.support.node import in_node
from tests.support.page_link import wait_for_message
from tests.support.silent_serial import SILENT_SERIAL
from tests.support.studio import Pages, enter, wait_for, wait_until_checked
from tiniscript.studio import serving

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Locator, Page, Route

sampled = pytest.mark.sampled(of="held files and ports", keep=2)

SCRIPT = Path(__file__).with_name("progress_in_node.mjs")
FIRMWARE_FILE = "tinibot-uno-digest.hex"
STUCK_PORT_MESSAGE = "The port no longer accepts data."


@pytest.fixture(scope="module")
def server(browser: Browser) -> Iterator[serving.Server]:
    rows = [
        {"title": "tinibot", "board": board, "file": FIRMWARE_FILE} for board in ("uno", "esp32dev")
    ]
    page = {
        **serving.files(),
        serving.FIRMWARE_FILE: serving.File(json.dumps(rows).encode(), "application/json"),
        FIRMWARE_FILE: serving.File(b":01000000FF00\n:00000001FF\n", "text/plain"),
    }
    with studio.serve_page(page) as server:
        yield server


@pytest.fixture
def pages(browser: Browser, server: serving.Server) -> Iterator[Pages]:
    opened_pages = Pages(browser, server.address)
    yield opened_pages
    opened_pages.close()


class HeldRequests:
    """Requests that stay unanswered until they are released; later ones are then answered at
    once."""

    def __init__(self, page: Page, url: str) -> None:
        self.routes: list[Route] = []
        self._has_end = False
        page.context.route(url, self._hold)

    def _hold(self, route: Route) -> None:
        self.routes.append(route)
        if self._has_end:
            route.continue_()

    def has(self, count: int) -> bool:
        return len(self.routes) == count

    def let_go(self) -> None:
        self._has_end = True
        for route in self.routes:
            route.continue_()


def with_serial(pages: Pages, server: serving.Server, has_clock: bool = False) -> Page:
    """Return a page with a port that accepts no bytes, perhaps on a clock of the test."""
    page = pages.blank(is_alone=True)
    page.add_init_script(SILENT_SERIAL)
    if has_clock:
        page.clock.install()
    enter(page, server.address)
    page.click("#side_real")
    page.click("#link_teacher summary")
    page.locator("#flash_board option").first.wait_for(state="attached")
    return page


def test_a_stalled_download_times_out() -> None:
    assert json.loads(in_node(SCRIPT)[0]) == ["TimeoutError 1", "AbortError", "there", "0 false"]


@sampled
def test_a_stalled_firmware_download_is_reported_cancelled_and_given_up(
    pages: Pages, server: serving.Server
) -> None:
    page = with_serial(pages, server, has_clock=True)
    held_robot = HeldRequests(page, f"**/{FIRMWARE_FILE}")
    for count, action in enumerate(("cancel", "nothing"), 1):
        page.click("#flash_write")
        wait_for(page, partial(held_robot.has, count), "it is fetched")
        wait_for_message(page, "Fetching the firmware. Nothing has been written yet.")
        page.clock.fast_forward(4000)
        wait_for_message(page, "The firmware has not arrived.")
        if action == "cancel":
            page.click("#flash_cancel")
            wait_for_message(page, "Cancelled. Nothing was written: the board has not changed.")
        else:
            page.clock.fast_forward(25_000)
            wait_for_message(page, "The firmware did not arrive, so nothing was written")
        assert page.locator("#flash_cancel, #flash_progress").filter(visible=True).count() == 0
    assert page.evaluate("window.port.opened") == 0


@sampled
def test_a_stalled_esp32_flasher_is_reported_and_cancelled(
    pages: Pages, server: serving.Server
) -> None:
    page = with_serial(pages, server, has_clock=True)
    page.select_option("#flash_board", "esp32dev")
    held_robot = HeldRequests(page, "**/esp32-*.js")
    for _ in range(2):
        page.click("#flash_write")
        wait_for(page, lambda: held_robot.routes, "it is fetched")
        wait_for_message(page, "Fetching the firmware. Nothing has been written yet.")
        page.clock.fast_forward(4000)
        wait_for_message(page, "The firmware has not arrived.")
        page.click("#flash_cancel")
        wait_for_message(page, "Cancelled. Nothing was written: the board has not changed.")
    assert page.evaluate("window.port.opened") == 0


@sampled
def test_a_port_that_accepts_no_bytes_is_closed_and_can_be_retried(
    pages: Pages, server: serving.Server
) -> None:
    page = with_serial(pages, server)
    for count in (1, 2):
        page.click("#link_serial")
        wait_for(page, lambda: page.evaluate("window.port.isOpen"), "it is open")
        wait_for_message(page, "Connecting")
        wait_for(page, lambda: page.locator("#link_ways").is_visible(), "it is given up")
        wait_for_message(page, STUCK_PORT_MESSAGE)
        wait_for(page, lambda: not page.evaluate("window.port.isOpen"), "it is closed")
        assert page.evaluate("window.port.opened") == count
    page.click("#flash_write")
    wait_for_message(page, "Writing and verifying the firmware")
    page.click("#flash_cancel")
    wait_for_message(page, "Cancelled. Nothing was written")
    wait_for(page, lambda: not page.evaluate("window.port.isOpen"), "it is closed")


@sampled
def test_a_connect_is_cancelled_while_its_port_opens(pages: Pages, server: serving.Server) -> None:
    page = with_serial(pages, server)
    page.evaluate("() => { window.port.open = () => new Promise(() => {}); }")
    page.click("#link_serial")
    page.click("#link_leave")
    wait_for_message(page, "Disconnected.")
    assert page.locator("#link_serial:enabled").is_visible()


# -- requirements of a run

# The page's message when a request hangs; the browser fetches the pictures and the style itself.
HANGING_MESSAGE = ("#coming, #status:has-text('not load'), #status:has-text('not arrive'), "
                   "#doing:has-text('not load'), #doing:has-text('not arrive')")  # fmt: skip
COMPILER_FILES = ("worker.js", "pyodide.asm.mjs", "pyodide.asm.wasm", "python.zip",
                  "tiniscript.zip", "messages.en.json")  # fmt: skip
BEGIN_BUTTON = "html[data-screen=start] [data-begin=dance]"
OPTIONAL_SUFFIXES = ("style.css", ".svg", ".webmanifest", ".cur")


@pytest.fixture(scope="module")
def hasty(browser: Browser) -> Iterator[serving.Server]:
    """A page that soon names its waits, and soon gives up."""
    page = serving.files()
    for name, file in page.items():
        data = file.data
        if b"nothing comes" in data and name.endswith(".js"):
            assert data.count(b"},3e3)") == data.count(b"),2e4)") == 1
            data = data.replace(b"},3e3)", b"},500)").replace(b"),2e4)", b"),5e3)")
        if name == "style.css":
            assert b"comes 0s 3s" in data
            data = data.replace(b"comes 0s 3s", b"comes 0s .5s")
        if data != file.data:
            page[name] = serving.File(data, file.content_type)
    with studio.serve_page(page) as server:
        yield server


@pytest.fixture
def visits(browser: Browser, hasty: serving.Server) -> Iterator[Pages]:
    opened_pages = Pages(browser, hasty.address)
    yield opened_pages
    opened_pages.errors.clear()  # a browser complains of each file that it has not got
    opened_pages.close()


# Records all messages about the virtual robot, however short.
RECORDING_SCRIPT = """window.told = [];
new MutationObserver(() => {
  const said = document.querySelector('#doing')?.textContent;
  if (said !== window.told.at(-1)) window.told.push(said);
}).observe(document, {subtree: true, childList: true, characterData: true})"""
WAITS_SCRIPT = """window.told
  .map((said) => /waiting(?= for the compiler)|did not load/.exec(said ?? '')?.[0])
  .filter(Boolean).filter((each, k, all) => each !== all[k - 1])"""
TRY_COUNT = 10


def check_dance_goes_on(page: Page) -> None:
    """Check that a requested run continues."""
    page.locator("html[data-phase=running]").wait_for(state="attached")


@pytest.mark.long
def test_any_stalled_file_of_a_run_is_reported_until_it_arrives(
    visits: Pages,
) -> None:
    page = visits.blank(is_alone=True)
    questions: list[str] = []
    page.on("request", lambda request: questions.append(request.url.removeprefix(visits.address)))
    page.goto(visits.address)
    page.click("[data-begin=dance]")
    check_dance_goes_on(page)
    names = sorted({name for name in questions if name and not name.endswith(OPTIONAL_SUFFIXES)})
    assert {*COMPILER_FILES, "main.js", "texts.en.json"} <= {*names}
    for name in names:
        page = visits.blank(is_alone=True)
        held_robot = HeldRequests(page, f"**/{name}")
        page.goto(visits.address, wait_until="commit")
        begin_button, word = page.locator(f"{BEGIN_BUTTON}:visible"), page.locator(HANGING_MESSAGE)
        run_page = page.locator("html:is([data-phase=running], [data-phase=ended])")

        def is_told(begin_button: Locator = begin_button, word: Locator = word) -> bool:
            return word.first.is_visible() or begin_button.count() > 0

        def continues(begin_button: Locator = begin_button, run_page: Locator = run_page) -> bool:
            if begin_button.count():
                begin_button.click()  # a busy page may miss the first one
            return is_told(run_page)

        wait_for(page, is_told, name)
        wait_for(page, continues, name)
        held_robot.let_go()
        if not page.locator("html[data-screen=program]").count():
            page.click(BEGIN_BUTTON)
        elif page.locator("#doing", has_text="did not load").count():
            page.click("#run")  # this computer was slow: it was given up
        check_dance_goes_on(page)
        page.context.close()


@pytest.mark.sampled("name")
@pytest.mark.parametrize("name", COMPILER_FILES)
def test_an_abandoned_compiler_is_loaded_again_by_the_next_run(visits: Pages, name: str) -> None:
    """The first retry fails, the next succeeds."""
    page = visits.blank(is_alone=True)
    page.add_init_script(RECORDING_SCRIPT)
    HeldRequests(page, f"**/{name}")
    page.goto(visits.address)
    page.click("[data-begin=dance]")
    for _ in range(2):
        page.locator("#doing", has_text="The compiler did not load. Press Run to try").wait_for()
        page.click("#run")
        page.locator("#doing", has_not_text="did not load").wait_for()
    assert page.evaluate(WAITS_SCRIPT)[:4] == ["waiting", "did not load"] * 2
    page.context.unroute_all()
    outcome = page.locator("html[data-phase=running], #doing:has-text('did not load')")
    for _ in range(TRY_COUNT):
        outcome.first.wait_for(state="attached")
        if not page.locator("#doing", has_text="did not load").count():
            break
        page.click("#run")  # this computer was slow: it was given up
        page.locator("#doing", has_not_text="did not load").wait_for()
    check_dance_goes_on(page)
    page.click("#stop")
    wait_until_checked(page)


def test_a_stop_while_the_compiler_loads_cancels_the_run(visits: Pages) -> None:
    page = visits.blank(is_alone=True)
    held_robot = HeldRequests(page, "**/pyodide.asm.mjs")
    page.goto(visits.address)
    page.click("[data-begin=dance]")
    page.locator("#doing", has_text="Press STOP to cancel.").wait_for()
    page.click("#stop")
    wait_for(
        page, lambda: "compiler" not in page.locator("#doing").inner_text(), "it waits no more"
    )
    held_robot.let_go()
    wait_until_checked(page)
    page.wait_for_timeout(300)
    assert page.locator("html[data-phase=off]").count()
    page.click("#run")
    check_dance_goes_on(page)


@sampled
def test_a_run_on_a_robot_retries_the_compiler(visits: Pages) -> None:
    page = visits.blank(is_alone=True)
    page.context.route("**/tiniscript.zip", lambda route: route.abort())
    page.goto(visits.address)
    page.locator("html[data-state=failed]").wait_for(state="attached")
    page.context.unroute_all()
    page.evaluate("document.querySelector('#link_upload').click()")
    wait_until_checked(page)


def test_an_unanswered_stop_is_reported_at_once_and_retried(pages: Pages) -> None:
    with studio.serve_robots() as server:
        page = pages.blank(is_alone=True)
        page.clock.install()
        enter(page, server.entrance())
        held_robot = HeldRequests(page, "**/robots")
        page.keyboard.press("Escape")
        wait_for(page, lambda: held_robot.routes, "it is asked")
        page.clock.fast_forward(3100)
        locator = page.locator("#stops")
        locator.filter(has_text="STOP did not reach tsc studio.").wait_for(state="attached")
        page.context.unroute_all()
        wait_for(page, lambda: page.locator("#stops").is_hidden(), "it is heard: there is no robot")
