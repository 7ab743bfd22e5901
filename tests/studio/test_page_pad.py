"""The page's remote control in a browser: fingers and keys drive a virtual robot and a real one."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TYPE_CHECKING

import pytest

from tests.support.casefile import ROOT
from tests.support.page_link import connect, wait_for_message
from tests.support.pty_robot import PtyRobot
from tests.support.studio import (
    UPLOADS,
    Pages,
    axe,
    speak,
    turn,
    wait_for,
    wait_for_blocks,
    wait_for_phase,
    write,
)
from tiniscript import robots
from tiniscript.base.kit import YES_NO, Device, Kit
from tiniscript.link import known_ports

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.usefixtures("no_page_timeouts")
sampled = pytest.mark.sampled(of="details of the remote control", keep=1)

STICK_PROGRAM = "LOOP(FOREVER);\nM(PAD_Y, PAD_Y);\nW(0.02);\nEND_LOOP;\n"
KEYS = "LOOP(FOREVER);\nIF(KEY_UP);\nM(60, 60);\nELSE;\nM(0, 0);\nENDIF;\nW(0.02);\nEND_LOOP;\n"
PROGRAM_OR_STOP_MESSAGE = re.compile("The robot has the program|Stopped: ")
PHONE, DESK = {"width": 390, "height": 844}, {"width": 1366, "height": 768}


@pytest.fixture
def pages(hosted_pages: Pages) -> Pages:
    return hosted_pages


def read_motor_powers(page: Page) -> str:
    """Return the power of the virtual robot's motors, as its trace has it."""
    powers = [line.partition(" MOTORS ")[2] for line in trace(page) if " MOTORS " in line]
    return powers[-1] if powers else ""


def trace(page: Page) -> list[str]:
    return (page.locator("#trace").text_content() or "").split("\n")


class Fingers:
    """Fingers on the screen of a page."""

    def __init__(self, page: Page) -> None:
        self._session = page.context.new_cdp_session(page)

    def touch(self, kind: str, *points: tuple[float, float]) -> None:
        touches = [{"x": x, "y": y, "id": k} for k, (x, y) in enumerate(points)]
        self._session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": touches})


def middle(page: Page, place: str) -> tuple[float, float]:
    box = page.locator(place).bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


@pytest.mark.sampled("size")
@pytest.mark.parametrize("size", [PHONE, DESK], ids=["phone", "desk"])
def test_a_start_picture_can_be_driven_at_once(pages: Pages, size: dict[str, int]) -> None:
    """One finger drives, another one may hold A; releasing it stops the robot."""
    page = pages.visit(pages.entrance(), "start", viewport=size, has_touch=True)
    page.click("[data-begin=drive]")
    wait_for_phase(page, "running")
    page.locator("#pad_stick").wait_for()
    assert page.locator("#pad button:visible").all_inner_texts() == ["A"]
    for place in ("#pad_stick", "#pad button:visible", "#arena", "#stop"):
        box = page.locator(place).bounding_box()
        assert box and box["y"] >= 0 and box["y"] + box["height"] <= size["height"], place
    assert axe(page) == []
    x, y = middle(page, "#pad_stick")
    a = middle(page, "#pad button:visible")
    fingers = Fingers(page)
    fingers.touch("touchStart", (x, y))
    fingers.touch("touchMove", (x, y - 200))
    wait_for(page, lambda: read_motor_powers(page) == "100 100", "it drives")
    fingers.touch("touchStart", (x, y - 200), a)
    wait_for(page, lambda: any("BEEP 440" in line for line in trace(page)), "it beeps")
    fingers.touch("touchEnd")
    wait_for(page, lambda: read_motor_powers(page) == "0 0", "it stands")
    page.keyboard.down("ArrowUp")
    wait_for(page, lambda: read_motor_powers(page) == "100 100", "it drives by a key")
    page.keyboard.down("ArrowRight")
    wait_for(page, lambda: read_motor_powers(page) in ("142 0", "100 0"), "it turns")
    page.evaluate("dispatchEvent(new Event('blur'))")
    wait_for(page, lambda: read_motor_powers(page) == "0 0", "nobody presses it")
    turn(page, "program")
    wait_for_blocks(page)
    page.click("#stop")
    wait_for_phase(page, "ended")
    assert not page.locator("#pad").is_visible()


@sampled
def test_the_picture_opens_the_example(pages: Pages) -> None:
    page = pages.visit(pages.entrance(), "start")
    page.click("[data-begin=drive]")
    wait_for_blocks(page)
    example = (ROOT / "examples" / "remote.ts").read_text("utf-8")
    page.click("#view_text")
    opened_text = page.locator(".cm-content").inner_text()
    assert opened_text.split() == re.sub(r"//.*", "", example).split()


@sampled
def test_a_resumed_or_restarted_run_reads_the_currently_held_keys(pages: Pages) -> None:
    page = pages.open()
    write(page, STICK_PROGRAM)
    page.click("#run")
    wait_for_phase(page, "running")
    page.locator("#pad_stick").wait_for()
    page.keyboard.down("ArrowUp")
    wait_for(page, lambda: read_motor_powers(page) == "100 100", "it drives")
    page.click("#pause")
    wait_for_phase(page, "paused")
    page.keyboard.up("ArrowUp")
    page.click("#pause")
    wait_for_phase(page, "running")
    wait_for(
        page, lambda: read_motor_powers(page) == "0 0", "what was let go meanwhile is not held"
    )
    page.keyboard.down("ArrowUp")
    wait_for(page, lambda: read_motor_powers(page) == "100 100", "it drives")
    page.click("#stop")
    wait_for_phase(page, "ended")
    page.click("#run")
    wait_for_phase(page, "running")
    page.locator("#pad_stick").wait_for()
    wait_for(page, lambda: read_motor_powers(page) == "0 0", "it is pressed anew first")
    page.keyboard.up("ArrowUp")
    page.keyboard.down("ArrowUp")
    wait_for(page, lambda: read_motor_powers(page) == "100 100", "it drives")
    page.select_option("#speed", "20")
    held_cm = trace(page)[-1]
    wait_for(page, lambda: held_cm not in trace(page), "it goes on, at each speed")
    assert not any(line.endswith("MOTORS 0 0") for line in trace(page))
    page.keyboard.up("ArrowUp")
    wait_for(page, lambda: read_motor_powers(page) == "0 0", "it stands")


@sampled
def test_a_robot_without_key_support_gets_none_and_the_page_reports_it(pages: Pages) -> None:
    sensors = tuple(Device(f"S{k}", YES_NO, "", 0, 1) for k in range(9))
    with PtyRobot(Kit(sensors)) as robot:
        known_ports.remember(robot.port, "OLDER")
        page = pages.open()
        connect(page, robot)
        assert not page.locator("#pad").is_visible()
        write(page, KEYS)
        page.locator("#pad_said", has_text="This robot has no remote control").wait_for()
        assert page.locator("#pad button:visible").count() == 0
        speak(page, "es")
        page.locator("#pad_said", has_text="Este robot no tiene control remoto").wait_for()
        speak(page, "en")
        write(page, "F(1, 50)")
        page.locator("#pad").wait_for(state="hidden")
        write(page, KEYS)
        page.locator("#pad_said").wait_for()
        assert axe(page) == []


@sampled
def test_the_controls_of_a_real_robot_are_accessible(pages: Pages) -> None:
    with PtyRobot(robots.load("tinibot").kit) as robot:
        known_ports.remember(robot.port, "TINI")
        page = pages.open()
        connect(page, robot)
        write(page, KEYS)
        page.locator("[data-key=KEY_UP]").wait_for()
        assert page.locator("#pad button:visible").count() == 1
        assert axe(page) == []


@sampled
def test_a_judged_run_accepts_no_other_keys(pages: Pages) -> None:
    page = pages.open()
    write(page, f"// robot: tinibot\n{KEYS}")
    page.click("#side_lessons")
    page.locator("#lesson_next:enabled").wait_for()
    lesson_name = page.locator("#lesson_name").text_content()
    page.select_option("#lesson", index=17)
    page.locator("#lesson_name").filter(has_not_text=lesson_name or "?").wait_for(state="attached")
    page.locator("#lesson_steps button").last.click()
    page.click("#run")  # the own run
    wait_for_phase(page, "running")
    page.locator("[data-key=KEY_UP]").wait_for()
    page.click("#lesson_check")
    wait_for(page, lambda: read_motor_powers(page) == "60 60", "the judge presses")
    assert not page.locator("#pad").is_visible()
    page.locator("#lesson_said[data-verdict]").wait_for()
    assert "KEY_RIGHT" in page.locator("#lesson_findings").inner_text()
    wait_for_phase(page, "ended")
    assert not page.locator("#pad").is_visible()


def press_until_driven(
    page: Page, robot: PtyRobot, press: Callable[[], None], let_go: Callable[[], None],
    min_ms: int = 0,
) -> None:  # fmt: skip
    """Press until the robot has driven for so long, of its own time.

    A busy computer can keep a page silent for so long that its robot is stopped. Then the page
    sends the program again, and the hand presses anew.
    """
    word = page.locator("#link_said")
    for _ in range(UPLOADS):
        press()

        def is_over(start_ms: int = robot.robot_ms) -> bool:
            has_driven = robot.moves and robot.robot_ms >= start_ms + min_ms
            return has_driven or "Stopped: " in word.inner_text()

        wait_for(page, is_over, "it drives or is stopped")
        if "Stopped: " not in word.inner_text():
            return
        let_go()
        page.click("#link_upload")
        word.filter(has_text=PROGRAM_OR_STOP_MESSAGE).wait_for()
    raise AssertionError(f"stopped {UPLOADS} times")


def test_a_real_robot_is_driven_and_stops_when_the_page_is_hidden(pages: Pages) -> None:
    with PtyRobot(robots.load("tinibot").kit) as robot:
        known_ports.remember(robot.port, "TINI")
        page = pages.open(has_touch=True)
        connect(page, robot)
        write(page, KEYS)
        page.click("#link_upload")
        page.locator("#link_said").filter(has_text=PROGRAM_OR_STOP_MESSAGE).wait_for()
        fingers = Fingers(page)

        def touch() -> None:
            fingers.touch("touchStart", middle(page, "[data-key=KEY_UP]"))

        def lift() -> None:
            fingers.touch("touchEnd")

        def press() -> None:
            page.keyboard.down("ArrowUp")

        def release_key() -> None:
            page.keyboard.up("ArrowUp")

        press_until_driven(page, robot, touch, lift, min_ms=2000)
        lift()
        wait_for(page, lambda: not robot.moves, "it stands")
        press_until_driven(page, robot, press, release_key)
        page.keyboard.press("Escape")
        wait_for(page, lambda: not robot.moves, "it is stopped")
        wait_for_message(page, "Stopped")
        page.click("#link_start")
        wait_for_message(page, "It is running")
        since_ms = robot.robot_ms
        wait_for(page, lambda: robot.robot_ms > since_ms + 700, "time goes by")
        assert not robot.moves, "it is pressed anew first"
        release_key()
        press_until_driven(page, robot, press, release_key)
        page.click("#link_leave")
        wait_for(page, lambda: not robot.moves, "nobody is there")
        assert not page.locator("#pad").is_visible()
