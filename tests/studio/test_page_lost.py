"""The page, with requests to `tsc studio` that are lost, refused on the way, or late."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING, Any

import pytest

from tests.support.command import FOREVER
from tests.support.page_link import KIT, connect, wait_for_message
from tests.support.pty_robot import PtyRobot
from tests.support.studio import Pages, hang, start_drive, wait_for, wait_until_checked, write
from tests.support.torn_requests import lose_answer, refuse, tear_requests
from tiniscript.link import known_ports
from tiniscript.studio import serving
from tiniscript.studio.attending import LEFT_S

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, Route

sampled = pytest.mark.sampled(of="lost requests", keep=3)

CONFIRMED_MESSAGE = "Stopped: the robot has confirmed the stop."
HIDDEN_MESSAGE = "The robot was stopped because this page was hidden. Come back here to drive it."
SILENT_MESSAGE = (
    "The robot has not confirmed the stop."
    " If it moves, lift it and remove its batteries or unplug it."
)
LATE_MESSAGE = "The robot has now confirmed the stop: it is standing still."
# Records the messages below the buttons from now on.
OBSERVER_SCRIPT = """() => {
  const line = document.querySelector('#link_said');
  window.told = [];
  window.listens?.disconnect();
  window.listens = new MutationObserver(() => window.told.push(line.textContent));
  window.listens.observe(line, { childList: true, characterData: true, subtree: true });
}"""
VISIBILITY_SCRIPT = """(state) => {
  Object.defineProperty(document, 'visibilityState', { value: state, configurable: true });
  document.dispatchEvent(new Event('visibilitychange'));
}"""


@pytest.fixture(scope="module")
def open_page(browser: Browser, server: serving.Server) -> Iterator[tuple[Pages, Page]]:
    pages = Pages(browser, server.address, entrance=server.entrance)
    yield pages, pages.open()
    pages.close()


@pytest.fixture
def robot() -> Iterator[PtyRobot]:
    with PtyRobot(KIT) as pty_robot:
        known_ports.remember(pty_robot.port, "TINI")
        yield pty_robot


@pytest.fixture
def page(open_page: tuple[Pages, Page], robot: PtyRobot) -> Iterator[Page]:
    """A page of many tests, which has not connected yet."""
    pages, current_page = open_page
    yield current_page
    current_page.unroute_all(behavior="ignoreErrors")
    current_page.evaluate("delete document.visibilityState")
    if current_page.locator("#link_leave").is_visible():
        current_page.click("#link_leave")
    pages.errors.clear()  # a browser complains of each lost request


def test_a_lost_stop_is_delivered_with_the_next_heartbeat(page: Page, robot: PtyRobot) -> None:
    connect(page, robot)
    for _ in range(2):
        start_drive(page, robot)
        torn_requests = tear_requests(page, "stop", lambda route: route.abort(), times=9)
        page.click("#stop")
        wait_for(page, lambda: not robot.moves, "it stands")
        wait_for_message(page, CONFIRMED_MESSAGE)
        assert torn_requests
        page.unroute_all(behavior="wait")


@sampled
def test_a_transport_error_ends_no_connection(page: Page, robot: PtyRobot) -> None:
    connect(page, robot)
    start_drive(page, robot)
    torn_requests = tear_requests(page, "beat", refuse, times=2)
    wait_for(page, lambda: len(torn_requests) == 2, "they are refused")
    page.wait_for_timeout(300)
    assert page.locator("html[data-robot=connected]").count() and robot.moves
    torn_requests = tear_requests(
        page, "beat", refuse, times=1000
    )  # a failure that lasts is reported
    wait_for_message(page, "tsc studio has stopped responding")
    assert torn_requests


@pytest.mark.sampled("tear")
@pytest.mark.parametrize("tear", [lose_answer, refuse, lambda route: route.abort()])
def test_a_lost_connect_is_retried(
    page: Page, robot: PtyRobot, tear: Callable[[Route], None]
) -> None:
    torn_requests = tear_requests(page, "connect", tear)
    connect(page, robot)
    assert len(torn_requests) == 1
    start_drive(page, robot)


@sampled
def test_a_connect_after_lost_ones_takes_over_their_connection(page: Page, robot: PtyRobot) -> None:
    tear_requests(page, "connect", lose_answer, times=3)
    page.click("#side_real")
    page.click("#link_look")
    page.locator("#link_port option:first-of-type", has_text=robot.port).wait_for(state="attached")
    page.click("#link_connect")
    wait_for_message(page, "tsc studio has stopped responding")
    page.evaluate(OBSERVER_SCRIPT)
    page.click("#link_connect")
    wait_for_message(page, "Connected: ")
    messages = page.evaluate("window.told")
    assert [message.split("…")[0].split(":")[0] for message in messages] == [
        "Connecting",
        "Connected",
    ]


# -- reports of a stop


class EventFilter:
    """A filter that keeps a stop's event from a page until it is released."""

    def __init__(self, page: Page, *kinds: str) -> None:
        self.withheld_stops: list[dict[str, Any]] = []
        self.is_open = False
        self._kinds = kinds
        page.route("**/robots", self._handle)

    def keeps(self, is_any: bool) -> bool:
        return bool(self.withheld_stops) == is_any

    def _handle(self, route: Route) -> None:
        response = route.fetch()
        answer = response.json()
        news = answer.get("news", [])
        stops = [item for item in news if item.get("event") in self._kinds]
        answer["news"] = [item for item in news if item not in stops]
        self.withheld_stops += [{k: stop[k] for k in stop if k != "number"} for stop in stops]
        if self.is_open:
            answer["news"] += self.withheld_stops
            self.withheld_stops = []
        route.fulfill(response=response, json=answer)


@pytest.mark.sampled("stop_action")
@pytest.mark.parametrize("stop_action", ["button", "hidden"])
def test_only_the_outcome_of_a_stop_is_reported_once(
    page: Page, robot: PtyRobot, stop_action: str
) -> None:
    connect(page, robot)
    start_drive(page, robot)
    page.evaluate(OBSERVER_SCRIPT)
    mute = EventFilter(page, "STOPPED")

    def stop() -> None:
        if stop_action == "button":
            page.click("#stop")
        else:
            page.evaluate(VISIBILITY_SCRIPT, "hidden")

    stop()
    wait_for(page, lambda: mute.withheld_stops, "it has stopped")
    assert page.evaluate("window.told") == ["Stopping…"]
    mute.is_open = True
    wait_for_message(page, HIDDEN_MESSAGE if stop_action == "hidden" else CONFIRMED_MESSAGE)
    page.evaluate(VISIBILITY_SCRIPT, "visible")
    start_drive(page, robot)
    mute.is_open = False
    page.evaluate(OBSERVER_SCRIPT)
    stop()
    page.keyboard.press("Escape")  # this is the same stop
    wait_for_message(page, SILENT_MESSAGE)
    mute.is_open = True
    wait_for_message(page, LATE_MESSAGE)
    assert page.evaluate("window.told") == ["Stopping…", SILENT_MESSAGE, LATE_MESSAGE]


@sampled
def test_two_presses_of_stop_are_reported_once(page: Page, robot: PtyRobot) -> None:
    connect(page, robot)
    for _ in range(2):  # the second round is another stop
        start_drive(page, robot)
        mute = EventFilter(page, "STOPPED")
        page.evaluate(OBSERVER_SCRIPT)
        page.dblclick("#stop")
        wait_for(page, partial(mute.keeps, True), "it has stopped")
        page.wait_for_timeout(300)  # waits for a second stop request, if there is one
        mute.is_open = True
        wait_for_message(page, CONFIRMED_MESSAGE)
        wait_for(page, partial(mute.keeps, False), "all is told")
        page.wait_for_timeout(300)
        page.unroute_all(behavior="wait")
        assert page.evaluate("window.told") == ["Stopping…", CONFIRMED_MESSAGE]


@sampled
def test_five_presses_of_stop_are_reported_once(page: Page, robot: PtyRobot) -> None:
    """This holds even if every request of it is lost; and none of them stops the next run."""
    connect(page, robot)
    start_drive(page, robot)
    torn_requests = tear_requests(page, "stop", lambda route: route.abort(), times=99)
    page.evaluate(OBSERVER_SCRIPT)
    page.evaluate("() => { for (let k = 0; k < 5; k++) document.querySelector('#stop').click(); }")
    wait_for_message(page, CONFIRMED_MESSAGE)
    wait_for(page, lambda: torn_requests, "they are lost")
    page.wait_for_timeout(300)
    assert page.evaluate("window.told") == ["Stopping…", CONFIRMED_MESSAGE]
    page.unroute_all(behavior="wait")
    start_drive(page, robot)
    page.wait_for_timeout(700)  # beats have arrived since
    assert robot.moves


def test_a_page_reloaded_before_its_stop_is_answered_stops_its_robot(
    page: Page, robot: PtyRobot
) -> None:
    for has_come in (False, True):
        connect(page, robot)
        start_drive(page, robot)
        tear_requests(
            page, "stop", lose_answer if has_come else lambda route: route.abort(), times=99
        )
        page.click("#stop")
        page.reload()
        wait_for(page, lambda: not robot.moves, "it stands")
        page.unroute_all(behavior="wait")
        wait_until_checked(page)
        page.click("#side_real")


def test_a_silent_robot_is_reported_once(page: Page, robot: PtyRobot) -> None:
    connect(page, robot)
    start_drive(page, robot)
    robot.switch_off()
    page.evaluate(OBSERVER_SCRIPT)
    page.click("#stop")
    wait_for_message(page, SILENT_MESSAGE)
    page.wait_for_timeout(2500)  # the link is given up, too
    assert page.evaluate("window.told") == ["Stopping…", SILENT_MESSAGE]


@sampled
def test_a_lost_robot_is_reported_once(page: Page, robot: PtyRobot) -> None:
    """Its requests and the link end. A slow page, which is not heard for a while, first stops the
    run under way, and reports that, too.
    """
    connect(page, robot)
    robot.switch_off()
    page.evaluate(OBSERVER_SCRIPT)
    write(page, FOREVER)
    page.click("#link_upload")
    wait_for_message(page, "The robot has stopped responding")
    page.wait_for_timeout(4000)
    texts = [sentence.split(";")[0] for sentence in page.evaluate("window.told")]
    assert texts[0] == "Sending…"
    assert [text for text in texts if text == "The robot has stopped responding"] == texts[-1:]


@sampled
def test_a_request_to_a_silent_robot_is_reported_as_waiting(page: Page, robot: PtyRobot) -> None:
    connect(page, robot)
    EventFilter(page, "LOST")
    robot.switch_off()
    page.evaluate(OBSERVER_SCRIPT)
    page.click("#link_identify")
    wait_for_message(page, "The robot has stopped responding")
    assert page.evaluate("window.told")[0] == "Waiting for the robot…"


@sampled
def test_a_timed_out_page_gets_the_reason_for_its_disconnection(
    page: Page, robot: PtyRobot
) -> None:
    connect(page, robot)
    torn_requests = tear_requests(page, "beat", lambda route: route.abort(), times=1)
    wait_for(page, lambda: torn_requests, "a beat is lost")
    page.unroute_all(behavior="wait")
    hang(page, round(1000 * LEFT_S) + 500)
    wait_for_message(page, "tsc studio heard nothing from this page for a while")


@sampled
def test_a_disconnection_before_confirmation_reports_an_unconfirmed_stop(
    page: Page, robot: PtyRobot
) -> None:
    connect(page, robot)
    start_drive(page, robot)
    EventFilter(page, "STOPPED", "LOST")
    page.evaluate(OBSERVER_SCRIPT)
    page.click("#stop")
    page.click("#link_leave")
    wait_for_message(page, f"Disconnected. {SILENT_MESSAGE}")
    assert page.evaluate("window.told") == ["Stopping…", f"Disconnected. {SILENT_MESSAGE}"]
