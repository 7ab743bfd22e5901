"""Actions of a person on the page during a fault between the page, `tsc studio` and the robot: each
ends, is reported once, and the next try works.

`python -m tests.studio.test_page_between 1 --seed 1` tries each action with each fault, and prints
how long the page was silent, and how long it took; `--taught` does so in a class.
"""

from __future__ import annotations

import re
import signal
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from itertools import pairwise
from random import Random
from typing import TYPE_CHECKING, NamedTuple

import pytest

from tests.between.lines import FAULTS, BadLine, Fault
from tests.between.telling import CLOCK, own_folders
from tests.support import sampling, studio
from tests.support.campaign import make_options
from tests.support.command import FOREVER, Command
from tests.support.network import Network
from tests.support.studio import Pages, write
from tiniscript.link import known_ports
from tiniscript.studio.attending import LATCH_S

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

LONGEST_SILENCE_S, TOLERANCE_S = 3.0, 0.5
LONGEST_END_S = 40.0  # the longest request, and a stop
NEXT_TRY_S = 40.0  # time until the next try succeeds
OBSERVER_SCRIPT = """(place) => {
  const line = document.querySelector(place);
  window.told = [];
  window.listens?.disconnect();
  const tell = () => window.told.push([performance.now(), line.textContent]);
  window.listens = new MutationObserver(tell);
  window.listens.observe(line, { childList: true, characterData: true, subtree: true });
  return performance.now();
}"""
UNFINISHED_MESSAGE = re.compile(r"…|^Stopping|STOP: 0 of 1")  # texts of something still going on
CONNECTED_PREFIX = "Connected: "
CONFIRMED_STOP = "has (?:now )?confirmed the stop"
UNCONFIRMED_STOP = "has not confirmed the stop"


class LineFaults(NamedTuple):
    """Faults between the page and `tsc studio`: pieces are late, or lost with their connection; for
    a while none get through, or `tsc studio` is suspended.
    """

    name: str
    late_s: float = 0.0
    loss_rate: float = 0.0
    held_s: float = 0.0
    is_cut: bool = False
    is_suspended: bool = False


NETWORK_FAULTS = (
    LineFaults("page and studio: late", late_s=0.3),
    LineFaults("page and studio: loses", loss_rate=0.2),
    LineFaults("page and studio: stalls", held_s=4.0),
    LineFaults("page and studio: stalls long", held_s=12.0),
    LineFaults("page and studio: cut for a while", held_s=4.0, is_cut=True),
    LineFaults("studio suspended", held_s=4.0, is_suspended=True),
    LineFaults("studio suspended long", held_s=12.0, is_suspended=True),
)
LINES = tuple(fault for fault in FAULTS if not fault.pulls and not fault.suspends)
MESSAGE_PLACE = "#link_said"
ACTIONS = ("connect", "run", "stop", "identify", "leave")
END_PATTERNS = {
    "connect": r"^(?!Connecting|Choose)",
    "run": r"^(?!Sending)",
    "stop": f"{CONFIRMED_STOP}|{UNCONFIRMED_STOP}",
    "identify": "blinks|^(?!Waiting)",
    "leave": "Disconnected",
}
BUTTONS = {"connect": "#link_connect", "run": "#link_upload", "stop": "#stop",
           "identify": "#link_identify", "leave": "#link_leave"}  # fmt: skip


class BadNetwork(Network):
    """A bad network that looks like the server to the browser: it replaces the port in requests."""

    def __init__(self, target: int, rng: Random) -> None:
        self.fault = LineFaults("nothing")
        self.fault_start_s = 0.0
        self._rng = rng
        super().__init__(target)
        self._own_port, self._server_port = (f":{port}".encode() for port in (self.port, target))
        assert len(self._own_port) == len(self._server_port)

    def begin(self, fault: LineFaults) -> None:
        self.fault, self.fault_start_s = fault, CLOCK.now_s
        if fault.is_cut:
            self.cut()

    def mend(self) -> None:
        self.fault = LineFaults("nothing")

    @property
    def is_held(self) -> bool:
        fault = self.fault
        return not fault.is_suspended and CLOCK.now_s < self.fault_start_s + fault.held_s

    def pass_on(self, data: bytes, is_back: bool, number: int) -> bytes | None:
        if self.fault.is_cut and self.is_held:
            return None
        while self.is_held:
            time.sleep(0.02)
        time.sleep(self.fault.late_s)
        if self._rng.random() < self.fault.loss_rate:
            return None
        return data if is_back else data.replace(self._own_port, self._server_port)


class TriedAction(NamedTuple):
    action: str
    fault: str
    silence_s: float
    duration_s: float
    errors: tuple[str, ...]
    messages: tuple[str, ...]


class Scene:
    """A page, a process of `tsc studio`, a robot, and the connections between them."""

    def __init__(self, browser: Browser, rng: Random, stack: ExitStack) -> None:
        self._folders = own_folders(stack.enter_context(tempfile.TemporaryDirectory()))
        self._rng = rng
        self._stack = stack
        self.line = BadLine(Fault("nothing"), rng, 0)
        stack.callback(lambda: self.line.clear_away())
        self.studio = Command("studio", "--listen", "0", "--no-browser", env=self._folders)
        stack.callback(self.studio.kill)
        assert self.studio.process.stdout
        entrance = self.studio.process.stdout.readline().decode().strip()
        target = int(re.findall(r":(\d+)/", entrance)[0])
        self.network = BadNetwork(target, rng)
        stack.callback(self.network.close)
        address = f"http://127.0.0.1:{self.network.port}/"
        self.pages = Pages(browser, address, entrance=lambda: entrance.replace(
            f":{target}/", f":{self.network.port}/"))  # fmt: skip
        stack.callback(self.pages.close)
        self.page: Page = self.pages.open(is_alone=True)
        write(self.page, FOREVER)
        self.page.click("#side_real")

    def try_action(self, action: str, fault: Fault | LineFaults) -> TriedAction:
        """Do something while there is a fault, then all of it without."""
        self._prepare(action, fault)
        page, place = self._place(action)
        start_ms = page.evaluate(OBSERVER_SCRIPT, place)
        self._begin(fault)
        page.click(BUTTONS[action])
        has_ended = self._until(END_PATTERNS[action], LONGEST_END_S, page)
        errors = [] if has_ended else ["it has no end"]
        page.wait_for_timeout(500)
        self._mend(fault)
        timed_messages: list[tuple[float, str]] = page.evaluate("window.told")
        texts = [text for _, text in timed_messages]
        errors += [
            f"said twice: {text}" for text, next_text in pairwise(texts) if text == next_text
        ]
        errors += self._next_try()
        times = [start_ms, *(time_ms for time_ms, _ in timed_messages)]
        gaps = [(end_ms - start_ms) / 1000 for k, (start_ms, end_ms) in enumerate(pairwise(times))
                if not k or not UNFINISHED_MESSAGE.search(texts[k - 1])]  # fmt: skip
        end_times_ms = [
            time_ms for time_ms, text in timed_messages if re.search(END_PATTERNS[action], text)
        ]
        duration_s = (
            (end_times_ms[0] if end_times_ms else start_ms + 1000 * LONGEST_END_S) - start_ms
        ) / 1000
        return TriedAction(action, fault.name, gaps[0] if gaps else LONGEST_END_S, duration_s,
                           tuple(errors), tuple(texts))  # fmt: skip

    def _prepare(self, action: str, fault: Fault | LineFaults) -> None:
        if isinstance(fault, Fault):
            self._leave()
            self.line.clear_away()
            self.line = BadLine(Fault("nothing"), self._rng, 0)
        if action == "connect":
            self._leave()
            self._choose()
        else:
            assert self._connect() == "", self._link_text()
        if action == "stop":
            assert self._run() == "", self._link_text()

    def _begin(self, fault: Fault | LineFaults) -> None:
        if isinstance(fault, Fault):
            self.line.begin(fault)
        else:
            self.network.begin(fault)
            if fault.is_suspended:
                self.studio.signal(signal.SIGSTOP)

    def _mend(self, fault: Fault | LineFaults) -> None:
        if isinstance(fault, LineFaults):
            left_s = self.network.fault_start_s + fault.held_s - CLOCK.now_s
            self.page.wait_for_timeout(1000 * max(0.0, left_s))
            self.studio.signal(signal.SIGCONT)
            self.network.mend()
        else:
            self.line.mend()
        self.page.wait_for_timeout(500)

    def _next_try(self) -> list[str]:
        """Connect if that is needed, run, and stop; return the failures."""
        failure = self._connect() or self._run() or self._stop()
        return [f"the next try: {failure}"] if failure else []

    def _link_text(self) -> str:
        return self.page.locator("#link_said").inner_text()

    def _place(self, action: str) -> tuple[Page, str]:
        """Return the page with the button, and the element with its result."""
        return self.page, MESSAGE_PLACE

    def _until(self, pattern: str, timeout_s: float, page: Page | None = None) -> bool:
        end_s, page = CLOCK.now_s + timeout_s, page or self.page
        while CLOCK.now_s < end_s:
            timed_messages = page.evaluate("window.told")
            if any(re.search(pattern, text) for _, text in timed_messages):
                return True
            page.wait_for_timeout(50)
        return False

    def _choose(self) -> None:
        """Choose the robot's port in the list."""
        page = self.page
        with pytest.MonkeyPatch.context() as patch:
            for name, value in self._folders.items():
                patch.setenv(name, value)
            known_ports.remember(self.line.port, "TINI")
        page.click("#link_look")
        option = page.locator("#link_port option", has_text=self.line.port)
        option.first.wait_for(state="attached")
        page.select_option("#link_port", value=option.first.get_attribute("value"))

    def _connect(self) -> str:
        page = self.page
        end_s = CLOCK.now_s + NEXT_TRY_S
        while not page.locator("html[data-robot=connected]").count():
            if CLOCK.now_s > end_s:
                return f"no connection: {self._link_text()}"
            if (
                page.locator("#link_connect").is_visible()
                and page.locator("#link_connect").is_enabled()
            ):
                self._choose()
                page.evaluate(OBSERVER_SCRIPT, MESSAGE_PLACE)
                page.click("#link_connect")
                self._until(r"^(?!Connecting)", NEXT_TRY_S)
            page.wait_for_timeout(100)
        return ""

    def _run(self) -> str:
        self.page.evaluate(OBSERVER_SCRIPT, MESSAGE_PLACE)
        self.page.click("#link_upload")
        if not self._until("The robot has the program|stopped", NEXT_TRY_S):
            return f"no run: {self._link_text()}"
        end_s = CLOCK.now_s + NEXT_TRY_S
        while not self.line.moves:
            if CLOCK.now_s > end_s:
                return f"it does not drive: {self._link_text()}"
            self.page.wait_for_timeout(50)
        return ""

    def _stop(self) -> str:
        self.page.evaluate(OBSERVER_SCRIPT, MESSAGE_PLACE)
        self.page.click("#stop")
        if not self._until(CONFIRMED_STOP, NEXT_TRY_S):
            return f"no stop: {self._link_text()}"
        return "it moves" if self.line.moves else ""

    def _leave(self) -> None:
        if self.page.locator("#link_leave").is_visible():
            self.page.click("#link_leave")
            self.page.locator("html:not([data-robot=connected])").wait_for(state="attached")


class ClassScene(Scene):
    """A scene of a class: a pupil, a teacher, and the class's robot on the bad line."""

    def __init__(self, browser: Browser, rng: Random, stack: ExitStack) -> None:
        patch = stack.enter_context(pytest.MonkeyPatch.context())
        for name, value in own_folders(stack.enter_context(tempfile.TemporaryDirectory())).items():
            patch.setenv(name, value)
        self._rng = rng
        self.line = BadLine(Fault("nothing"), rng, 0)
        stack.callback(self.line.clear_away)
        class_ = stack.enter_context(studio.serve_class([self.line.port]))
        self.pages = Pages(browser, class_.server.address)
        stack.callback(self.pages.close)
        self.teacher = self.pages.visit(class_.server.entrance(), "wall", is_alone=True)
        self.page = self.pages.open(is_alone=True)
        write(self.page, FOREVER)
        self.page.click("#side_real")
        for field_index, text in enumerate((class_.room.code, "Ana")):
            self.page.locator("#class_pupil input").nth(field_index).fill(text)
        self.page.click("[data-text=class_join]")
        self.page.locator(ASK_BUTTON).wait_for()

    def _place(self, action: str) -> tuple[Page, str]:
        return (self.teacher, "#stops") if action == "stop all" else (self.page, MESSAGE_PLACE)

    def _prepare(self, action: str, fault: Fault | LineFaults) -> None:
        if action == "ask":
            self._leave()
            self.page.locator(ASK_BUTTON).wait_for()
            return
        assert self._connect() == "", self._link_text()
        if action in ("stop", "stop all"):
            assert self._run() == "", self._link_text()

    def _mend(self, fault: Fault | LineFaults) -> None:
        super()._mend(fault)
        self.line.begin(Fault("nothing"))
        self.page.wait_for_timeout(1000 * LATCH_S)  # no page drives after a teacher's stop

    def _connect(self) -> str:
        page, end_s = self.page, CLOCK.now_s + NEXT_TRY_S
        while not page.locator("html[data-robot=connected]").count():
            if CLOCK.now_s > end_s:
                return f"no connection: {self._link_text()}"
            for button in (ASK_BUTTON, "#class_pupil [data-text=link_connect]"):
                if page.locator(button).is_visible() and page.locator(button).is_enabled():
                    page.click(button)
            page.wait_for_timeout(200)
        return ""


ASK_BUTTON = "[data-text=class_ask]"
BUTTONS |= {"ask": ASK_BUTTON, "stop all": "#stop"}
END_PATTERNS |= {
    "ask": r"^(?!Connecting|Choose|$)",
    "stop all": "STOP: 1 of 1|Not confirmed|did not reach",
}
CLASS_ACTIONS = ("ask", "run", "stop", "stop all", "leave")
CLASS_LINES = tuple(line for line in LINES if line.name in (
    "loses", "very late", "stalls long", "computer hears nothing"))  # fmt: skip


@contextmanager
def class_scene(browser: Browser, rng: Random) -> Iterator[ClassScene]:
    with ExitStack() as stack:
        yield ClassScene(browser, rng, stack)


@contextmanager
def scene(browser: Browser, rng: Random) -> Iterator[Scene]:
    with ExitStack() as stack:
        yield Scene(browser, rng, stack)


def list_faults(tried_action: TriedAction, room_s: float = TOLERANCE_S) -> list[str]:
    is_silent = tried_action.silence_s > LONGEST_SILENCE_S + room_s
    return [
        *tried_action.errors,
        *([f"silent for {tried_action.silence_s:.1f} s"] if is_silent else []),
    ]


def print_table(tried_actions: Sequence[TriedAction]) -> None:
    rows: dict[str, list[TriedAction]] = defaultdict(list)
    for tried_action in tried_actions:
        rows[tried_action.action].append(tried_action)
    print("| page | tries | longest silence, s | to its end, s |\n|---|---:|---:|---:|")
    for action, page_actions in rows.items():
        quietest = max(page_actions, key=lambda tried_action: tried_action.silence_s)
        slowest = max(page_actions, key=lambda tried_action: tried_action.duration_s)
        print(f"| {action} | {len(page_actions)} | {quietest.silence_s:.1f} ({quietest.fault}) |"
              f" {slowest.duration_s:.1f} ({slowest.fault}) |")  # fmt: skip


def test_a_sample_of_button_presses_keeps_the_laws(
    request: pytest.FixtureRequest, browser: Browser
) -> None:
    rng = Random(sampling.seed(request.config))
    with scene(browser, rng) as opened_scene:
        faults: list[Fault | LineFaults] = [*NETWORK_FAULTS[:5], *LINES[:6]]
        tried_action = opened_scene.try_action(rng.choice(ACTIONS), rng.choice(faults))
        assert not list_faults(tried_action, 3.0), tried_action


@pytest.mark.long
def test_a_sample_of_button_presses_in_a_class_keeps_the_laws(
    request: pytest.FixtureRequest, browser: Browser
) -> None:
    rng = Random(sampling.seed(request.config))
    with class_scene(browser, rng) as scene:
        tried_action = scene.try_action(rng.choice(CLASS_ACTIONS), rng.choice(CLASS_LINES))
        assert not list_faults(tried_action, 3.0), tried_action


if __name__ == "__main__":
    options = make_options(1, 1, "network", "line", "taught")
    all_found = []
    with studio.driver() as driver, studio.browser(driver) as browser:
        for seed in range(options.seed, options.seed + options.count * options.taught):
            with class_scene(browser, Random(seed)) as taught_class_scene:
                for line in CLASS_LINES:
                    for action in CLASS_ACTIONS:
                        all_found.append(taught_class_scene.try_action(action, line))
                        tried_action = all_found[-1]
                        print(
                            *tried_action[:4],
                            list_faults(tried_action),
                            tried_action.messages,
                            sep="; ",
                            flush=True,
                        )
        for seed in range(options.seed, options.seed + options.count * (not options.taught)):
            with scene(browser, Random(seed)) as opened_scene:
                faults: list[Fault | LineFaults] = [*NETWORK_FAULTS * (not options.line),
                                                 *LINES * (not options.network)]  # fmt: skip
                for fault in faults:
                    for action in ACTIONS:
                        all_found.append(opened_scene.try_action(action, fault))
                        tried_action = all_found[-1]
                        print(
                            *tried_action[:4],
                            list_faults(tried_action),
                            tried_action.messages,
                            sep="; ",
                            flush=True,
                        )
    print_table(all_found)
    sys.exit(any(map(list_faults, all_found)))
