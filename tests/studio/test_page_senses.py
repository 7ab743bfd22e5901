"""The page and a connected robot: its readings without a program, and its actions."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING

import pytest

from tests.support.page_link import KIT, connect, upload_until_it_runs, wait_for_message
from tests.support.page_runs import run_names
from tests.support.pty_robot import PtyRobot
from tests.support.studio import Pages, axe, start_drive, write
from tiniscript import robots
from tiniscript.link import known_ports
from tiniscript.link.frames import decode_frame
from tiniscript.link.messages import BY_NAME
from tiniscript.link.receiver import Receiver
from tiniscript.studio import serving

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

    from tests.machines.host_firmware import HostFirmware

pytestmark = pytest.mark.usefixtures("no_page_timeouts")
sampled = pytest.mark.sampled(of="details of the senses", keep=2)

SENSED_READINGS = ((12, 1, 250), (1023, 0, 7), (512, 88, 0), (12, 1, 250))
MEASURED_COUNT = 40  # values
FOREVER_SHOW = "LOOP(FOREVER);SHOW(7);W(0.1);END_LOOP"


class MeteredRobot(PtyRobot):
    """A robot that records the times and sizes of the values it sends."""

    def __init__(self, name: str) -> None:
        self.values: list[tuple[int, int]] = []
        self._receiver = Receiver()
        super().__init__(robots.load(name).kit, bytes_per_ms=1)  # 9600 baud

    def advance_ms(self, milliseconds: int, data: bytes = b"") -> bytes:
        sent_bytes = super().advance_ms(milliseconds, data)
        for byte in sent_bytes:
            self._receiver.put(byte, self.robot_ms)
            packet = self._receiver.take()
            frame = decode_frame(packet.data) if packet and not packet.is_text else None
            if packet and frame and frame.number == BY_NAME["SHOW"].number:
                self.values.append((self.robot_ms, len(packet.data) + 1))
        return sent_bytes


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
    """A page of many tests that has met its robot, and has never read a sensor."""
    pages, current_page = open_page
    current_page.evaluate("localStorage.removeItem('tiniscript.watches')")
    connect(current_page, robot)
    yield current_page
    current_page.click("#side_real")
    current_page.locator("#link_leave").dispatch_event("click")
    current_page.locator("html:not([data-robot=connected])").wait_for(state="attached")
    errors, pages.errors[:] = pages.errors[:], []
    assert not errors


def wait_for_action(page: Page, action: str) -> None:
    """Wait until the page says that the robot does so."""
    page.locator(f"#link_doing[data-does={action}]").wait_for()


def set_and_await_readings(page: Page, robot: PtyRobot, *values: int) -> None:
    """Set the sensors, and wait until the gauges show the values."""
    robot.ask(lambda robot: robot.set_readings(*(1000 * value for value in values)))
    for row, value in enumerate(values):
        gauge = page.locator(f"#gauges > div:nth-child({row + 1}) > dd")
        gauge.filter(has_text=re.compile(rf"^{value}\b")).wait_for()


def set_distance(distance: int, robot: HostFirmware) -> None:
    robot.set_readings(3000, 4000, 1000 * distance)


def watch_senses(page: Page) -> None:
    page.click("#link_watch")
    page.locator("#link_watch[aria-pressed=true]").wait_for()
    page.locator("#senses:not(.past)").wait_for()
    wait_for_action(page, "senses")


def wait_for_no_reading(page: Page) -> None:
    """Wait until no reading comes any more."""
    page.locator("#link_watch[aria-pressed=false]").wait_for()
    page.locator("#senses:not(.past):visible").wait_for(state="detached")


def seen_runs(page: Page) -> list[str]:
    """Return the names of the stored runs."""
    page.click("#side_virtual")
    runs = run_names(page)
    page.click("#runs_close")
    page.click("#side_real")
    return runs


def test_gauges_show_sensor_values_without_announcing_them(page: Page, robot: PtyRobot) -> None:
    """No motor turns, no value is shown as a program's, and no run is kept."""
    count_before = len(robot.actions)
    runs = seen_runs(page)
    watch_senses(page)
    for values in SENSED_READINGS:
        set_and_await_readings(page, robot, *values)
    assert not [line for line in robot.actions[count_before:] if line.startswith(("BEEP", "SET"))]
    assert not robot.moves
    assert page.locator("#link_shown").inner_text() == ""
    wait_for_message(page, "Connected: ")
    assert page.locator("[aria-live], [role=status], [role=log]").locator("#gauges").count() == 0
    assert axe(page, within="#link") == []
    assert seen_runs(page) == runs


def test_during_a_run_gauges_show_the_programs_readings(page: Page, robot: PtyRobot) -> None:
    """Other sensors are not shown."""
    watch_senses(page)
    set_and_await_readings(page, robot, 3, 4, 5)
    write(page, "LOOP(FOREVER);X = DISTANCE;W(0.1);END_LOOP")
    upload_until_it_runs(page)
    wait_for_action(page, "own")
    for distance in (12, 345):
        robot.ask(partial(set_distance, distance))
        page.locator("#gauges dd").last.filter(has_text=re.compile(rf"^{distance}\b")).wait_for()
    assert page.locator("#senses:not(.past)").count() == 1
    assert page.locator("#gauges dd").first.inner_text() == ""


@sampled
def test_a_program_takes_precedence_over_the_gauges(page: Page, robot: PtyRobot) -> None:
    watch_senses(page)
    write(page, "SHOW(5);\nF(0.3, 80);\nSHOW(6)")
    upload_until_it_runs(page)
    wait_for_message(page, "Done.")
    assert page.locator("#link_shown").inner_text().split() == ["5", "6"]
    wait_for_action(page, "senses")
    set_and_await_readings(page, robot, 3, 4, 5)
    write(page, FOREVER_SHOW)
    upload_until_it_runs(page)
    wait_for_action(page, "own")
    wait_for_no_reading(page)
    page.locator("#link_shown").filter(has_text=re.compile(r"^(7\n){5}")).wait_for()
    page.click("#link_watch")
    wait_for_message(page, "You will see the sensors when it has ended.")
    assert set(page.locator("#link_shown").inner_text().split()) == {"7"}


@pytest.mark.sampled("button_mode", "runs_before", keep=2)
@pytest.mark.parametrize("runs_before", [False, True])
@pytest.mark.parametrize("button_mode", ["waits for it", "is sent only"])
def test_a_program_that_waits_for_the_robots_button_gets_it(
    page: Page, robot: PtyRobot, button_mode: str, runs_before: bool
) -> None:
    """The first press starts it, even if sensors were read before, or another program ran, whose
    end it reports.
    """
    watch_senses(page)
    if runs_before:
        write(page, FOREVER_SHOW)
        upload_until_it_runs(page)
        wait_for_action(page, "own")
    write(
        page, "SB|LOOP(FOREVER);F(9, 80);END_LOOP" if button_mode == "waits for it" else "F(9, 80)"
    )
    page.click("#link_upload" if button_mode == "waits for it" else "#link_send")
    wait_for_message(page, re.compile("The robot has the program.|Done."))
    wait_for_no_reading(page)
    page.wait_for_timeout(1500)  # no run may start by itself in this time
    robot.push()
    robot.until(lambda: robot.moves, "it drives")
    wait_for_action(page, "own")


@sampled
def test_the_robots_button_ends_the_gauges_and_then_starts_its_program(
    page: Page, robot: PtyRobot
) -> None:
    write(page, "LOOP(FOREVER);F(9, 80);END_LOOP")
    page.click("#link_send")
    wait_for_message(page, "The robot has the program.")
    watch_senses(page)
    robot.push()
    wait_for_message(page, "The robot’s button ended “Watch the sensors”.")
    wait_for_no_reading(page)
    robot.push()
    robot.until(lambda: robot.moves, "it drives")


def test_a_stop_also_stops_the_gauges_until_requested(page: Page, robot: PtyRobot) -> None:
    for start in (watch_senses, lambda page: start_drive(page, robot)):
        start(page)
        page.click("#stop")
        wait_for_message(page, "Stopped: the robot has confirmed the stop.")
        wait_for_no_reading(page)
        page.wait_for_timeout(1500)  # no run may start by itself in this time
        wait_for_action(page, "stopped")
    watch_senses(page)
    set_and_await_readings(page, robot, 9, 8, 7)


@sampled
def test_requested_gauges_return_automatically(page: Page, robot: PtyRobot) -> None:
    watch_senses(page)
    page.click("#link_leave")
    page.locator("html:not([data-robot=connected])").wait_for(state="attached")
    connect(page, robot)
    set_and_await_readings(page, robot, 6, 5, 4)
    for ask, word in (("#link_identify", "blinks and plays its tune"), ("#side_virtual", "")):
        page.click(ask)
        if word:
            wait_for_message(page, word)
        else:
            page.locator("#link_watch[aria-pressed=false]").wait_for(state="attached")
            page.click("#side_real")
        wait_for_action(page, "senses")
    page.click("#link_watch")
    wait_for_no_reading(page)
    wait_for_action(page, "still")
    page.click("#link_leave")
    page.locator("html:not([data-robot=connected])").wait_for(state="attached")
    connect(page, robot)
    page.wait_for_timeout(1500)
    assert not page.locator("#senses").is_visible()


@sampled
def test_the_robots_action_is_described_without_numbers(page: Page, robot: PtyRobot) -> None:
    """The text is in the chosen language, for every action."""
    wait_for_action(page, "still")
    start_drive(page, robot)
    wait_for_action(page, "own")
    page.fill("#link_line", "W(9)")
    page.press("#link_line", "Enter")
    wait_for_action(page, "line")
    write(page, "X = 0; SHOW(1 / X)")
    page.click("#link_upload")
    wait_for_action(page, "fault")
    write(page, "SHOW(1)")
    page.click("#link_upload")
    wait_for_action(page, "done")
    assert not re.search(r"\d", page.locator("#link_doing").inner_text())
    assert not re.search(r"\d", page.locator("#link_said").inner_text())


def test_a_silent_port_is_reported_within_three_seconds(
    open_page: tuple[Pages, Page], robot: PtyRobot
) -> None:
    page = open_page[0].blank()
    page.clock.install()
    open_page[0].watch(page)
    page.goto(open_page[0].entrance())
    page.locator("html[data-state=checked]").wait_for(state="attached")
    robot.switch_off()
    page.click("#start_robot")
    page.click("#link_look")
    page.locator("#link_port option:first-of-type", has_text=robot.port).wait_for(state="attached")
    page.click("#link_connect")
    wait_for_message(page, "Connecting")
    page.clock.run_for(2900)
    assert "There is no response on this port yet." in page.locator("#link_said").inner_text()
    page.close()


@sampled
@pytest.mark.parametrize("name", ["tinibot", "liner"])
def test_the_readings_take_a_third_of_the_line_at_most(
    open_page: tuple[Pages, Page], name: str
) -> None:
    """On the slowest line of a robot, at 9600 baud."""
    page, robot = open_page[0].open(), MeteredRobot(name)
    with robot:
        known_ports.remember(robot.port, "TINI")
        connect(page, robot)
        watch_senses(page)
        robot.until(lambda: len(robot.values) > MEASURED_COUNT, "values have come")
        (first_ms, _), *later_values = robot.values
        passed_ms = later_values[-1][0] - first_ms
        assert 3 * sum(size for _, size in later_values) <= passed_ms
        page.click("#link_leave")
        page.locator("html:not([data-robot=connected])").wait_for(state="attached")
    page.close()
