"""The virtual robot in the page: it drives as it does without one, and STOP stops it."""

from __future__ import annotations

import re
from itertools import product
from typing import TYPE_CHECKING, Any

import pytest

from tests.support.casefile import ROOT
from tests.support.page_robot import (
    running,
    value,
    wait_for_nothing_running,
    wait_for_running,
)
from tests.support.page_screens import SCREENS
from tests.support.rows import each_row
from tests.support.studio import (
    SETTLED_SCRIPT,
    ask_worker,
    colors_of,
    dance_like_the_command,
    speak,
    turn,
    wait_for_phase,
    wait_until_checked,
    write,
)
from tiniscript import compile
from tiniscript.studio.simulation import Simulation
from tiniscript.virtual import worlds

if TYPE_CHECKING:
    from playwright.sync_api import Page

FOREVER = "LOOP(FOREVER);\n  F(1, 80);\n  R(1, 60);\nEND_LOOP"


@pytest.mark.sampled("name", "robot", "world")
@pytest.mark.parametrize(
    ("name", "robot", "world"),
    [
        ("obstacle", "tinibot", "obstacles"),
        ("obstacle_until", "tinibot", "obstacles"),
        ("light", "tinibot", "light"),
        ("line", "liner", "line"),
    ],
)
def test_a_run_on_the_page_equals_one_without(
    page: Page, name: str, robot: str, world: str
) -> None:
    """The browser's WebAssembly and floating point, and Python's in wasmtime: to the last digit."""
    text = (ROOT / "examples" / f"{name}.ts").read_text(encoding="utf-8")
    image = compile(text, robot).image
    requests: list[dict[str, Any]] = [
        {"do": "power_on", "robot": robot, "world": world},
        *({"do": "go", "duration_ms": 400} for _ in range(20)),
        {"do": "stop"},
    ]
    answers = ask_worker(page, [{**request, "image": image.hex()} for request in requests])
    simulation = Simulation(robot, worlds.load(world), image)
    for request, answer in zip(requests, answers, strict=True):
        if request["do"] == "go":
            simulation.advance(400)
        elif request["do"] == "stop":
            simulation.stop()
        expected = simulation.state()
        expected["events"] = [list(event) for event in expected["events"]]
        assert answer == expected


def test_the_trace_list_matches_the_command(page: Page) -> None:
    expected_texts = dance_like_the_command(page)
    assert page.inner_text("#doing") == "It has ended."
    page.click("#seen_trace")
    with page.expect_download() as download_info:
        page.click("#save_trace")
    assert download_info.value.path().read_text().splitlines() == expected_texts
    page.click("#seen_arena")


@each_row(
    "stop_way, is_paused", product(("button", "Escape", "Escape in the editor"), (False, True))
)
def test_stop_stops_the_run(page: Page, stop_way: str, is_paused: bool) -> None:
    write(page, FOREVER)
    page.click("#run")
    wait_for_running(page)
    if is_paused:
        page.dblclick("#pause")
        wait_for_phase(page, "paused")
    assert value(page, "Motors").split() != ["0", "%", "0", "%"]
    if stop_way == "button":
        page.click("#stop")
    else:
        if stop_way != "Escape":
            page.locator(".cm-content").focus()
        page.keyboard.press("Escape")
    page.locator("#doing").filter(has_text="Stopped.").wait_for()
    assert value(page, "Motors").split() == ["0", "%", "0", "%"]
    wait_for_phase(page, "ended")
    assert (page.locator("#trace").text_content() or "").endswith(" STOP")
    assert running(page) == ""


def test_step_goes_to_the_next_part_of_the_program(page: Page) -> None:
    write(page, "F(1, 80);\nR(0.5, 60);\nB(1, 70)")
    page.click("#step")
    wait_for_phase(page, "paused")
    for part in ("F(1, 80)", "R(0.5, 60)", "B(1, 70)"):
        wait_for_running(page, part)
        assert running(page) == part
        page.click("#step")
    wait_for_phase(page, "ended")
    assert value(page, "Time") == "2.5 s"
    write(page, "W(50);\nS")  # STOP works in the middle of a long step
    page.click("#step")
    wait_for_phase(page, "paused")
    wait_for_running(page)
    page.click("#step")
    page.click("#stop")
    page.locator("#doing").filter(has_text="Stopped.").wait_for()
    assert float(value(page, "Time").split()[0]) < 49


def test_an_edit_removes_the_mark(page: Page) -> None:
    write(page, FOREVER)
    page.click("#step")
    wait_for_running(page)
    page.locator(".cm-content").focus()
    page.keyboard.type(" ")
    wait_until_checked(page)
    assert running(page) == ""


# All in one turn: no compilation has happened when the buttons are pressed.
PASTED_AND_PRESSED = (
    "(editor, [text, ...buttons]) => { const data = new DataTransfer();"
    " data.setData('text/plain', text);"
    " editor.dispatchEvent(new ClipboardEvent('paste',"
    " {clipboardData: data, bubbles: true, cancelable: true}));"
    " for (const each of buttons) document.querySelector(each).click(); }"
)


def test_run_waits_for_the_compiler(page: Page) -> None:
    """A fast user gets no advice to repair a correct program: the newest text runs."""
    write(page, "F(1, ")
    page.select_option("#speed", "20")
    page.locator(".cm-content").focus()
    page.keyboard.press("Control+A")
    page.evaluate(
        "() => { const doing = document.querySelector('#doing'); window.said = [];"
        " new MutationObserver(() => window.said.push(doing.textContent))"
        ".observe(doing, {childList: true, characterData: true, subtree: true}); }"
    )
    page.locator(".cm-content").evaluate(PASTED_AND_PRESSED, ["SHOW(5)", "#run"])
    wait_for_phase(page, "ended")
    assert "SHOW 5" in (page.locator("#trace").text_content() or "")
    text = page.evaluate("() => window.said")
    assert "The compiler is still working…" in text
    assert "Fix the program first." not in text


def test_stop_ends_the_waiting_for_the_compiler(page: Page) -> None:
    write(page, "F(1, ")
    page.locator(".cm-content").focus()
    page.keyboard.press("Control+A")
    page.locator(".cm-content").evaluate(PASTED_AND_PRESSED, ["F(9, 80)", "#run", "#stop"])
    wait_until_checked(page)
    page.wait_for_timeout(300)
    assert page.locator("html[data-phase=running]").count() == 0
    assert page.locator("#doing", has_text="still working").count() == 0


def test_a_program_waits_for_its_button(page: Page) -> None:
    write(page, "SB|F(1, 80)")
    page.select_option("#speed", "4")
    page.click("#run")
    page.locator("#push").click()
    wait_for_phase(page, "ended")
    assert re.fullmatch(r"[\d.]+ cm", value(page, "distance sensor"))
    assert re.fullmatch(r"\d+ of 1023", value(page, "right light sensor"))
    assert (page.locator("#trace").text_content() or "").split("\n")[-1] == "1000 DONE"


# The parts of the run's display; messages contain their own words.
PLACES_SCRIPT = """() =>
  'arena controls told run pause step speed world values'.split(' ').map((id) => {
    const { x, y, width, height } = document.getElementById(id).getBoundingClientRect();
    return [id, x, y, width, height];
  })"""


@pytest.mark.sampled("screen")
@pytest.mark.parametrize("screen", SCREENS, ids=lambda screen: "x".join(map(str, screen)))
def test_the_layout_does_not_shift_when_a_run_begins(page: Page, screen: tuple[int, int]) -> None:
    """Nor does anything jump when it ends; a task's sentence is the longest one above the values.

    Next to a program, the first run in a world makes room for the robot and keeps it.
    """
    page.set_viewport_size({"width": screen[0], "height": screen[1]})
    turn(page, "program")
    write(page, f"SB|X = 1\n{FOREVER}")
    turn(page, "robot")
    for language, world in (("es", "obstacles"), ("es", "maze"), ("en", "maze")):
        speak(page, language)
        page.select_option("#world", world)  # no program has run in this world
        if not page.locator("html[data-phone]").count():
            page.click("#run")
            page.locator("#push").wait_for()
            page.click("#stop")
            wait_for_phase(page, "ended")
        page.evaluate(SETTLED_SCRIPT)
        places_before = page.evaluate(PLACES_SCRIPT)
        page.click("#run")
        page.locator("#push").wait_for()
        assert page.evaluate(PLACES_SCRIPT) == places_before
        page.click("#push")
        wait_for_running(page)
        page.locator("#values").get_by_text("X", exact=True).wait_for()
        assert page.evaluate(PLACES_SCRIPT) == places_before
        page.click("#stop")
        wait_for_phase(page, "ended")
        assert page.evaluate(PLACES_SCRIPT) == places_before
    page.set_viewport_size({"width": 1366, "height": 768})


def test_a_fault_is_shown_at_its_place(page: Page) -> None:
    write(page, "X = 0;\nSHOW(1 / X)")
    page.select_option("#speed", "20")
    page.click("#run")
    page.locator("#doing").filter(has_text="Line 2: the program divided by 0.").wait_for()
    assert running(page) == "SHOW(1 / X)"
    write(page, "X = 0;\nSHOW(1 / Y)")
    wait_for_nothing_running(page)


def test_changing_the_world_or_robot_restarts(page: Page) -> None:
    write(page, FOREVER)
    page.click("#run")
    wait_for_running(page)
    page.select_option("#world", "line")
    page.locator("#doing").filter(has_text="Collect the flags").wait_for()
    page.click("#run")
    wait_for_running(page)
    page.select_option("#robot", "liner")
    wait_until_checked(page)
    assert value(page, "left line sensor") == "–"
    assert len(colors_of(page, "#arena")) > 5  # floor, border, line


def test_running_a_wrong_program_stops_the_current_run(page: Page) -> None:
    write(page, FOREVER)
    page.click("#run")
    wait_for_phase(page, "running")
    write(page, "F(1, 80")
    assert page.locator("html").get_attribute("data-phase") == "running"
    page.click("#run")
    wait_for_phase(page, "ended")
    page.locator("#doing").filter(has_text="Fix the program first.").wait_for()
