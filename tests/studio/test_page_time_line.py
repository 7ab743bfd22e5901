"""The line under the world: a person looks back at a run, and goes on from where it is."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest

from tests.support.page_robot import running, value
from tests.support.studio import speak, wait_for, wait_for_blocks, wait_for_phase, write
from tools.builds.page_texts import page_texts

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.sampled(files="sides of the page", keep=3)
sampled = pytest.mark.sampled(of="looks back at a run", keep=2)

# The number of points of the line that have the color of a WHEN.
MARKED_SCRIPT = """() => {
  const paper = () => document.createElement('canvas').getContext('2d', {willReadFrequently: true});
  const pen = paper(), colored = paper();
  Object.assign(pen.canvas, {width: time_marks.width, height: time_marks.height});
  pen.drawImage(time_marks, 0, 0);
  colored.fillStyle = getComputedStyle(time_marks).getPropertyValue('--said-right');
  colored.fillRect(0, 0, 1, 1);
  const [red, green, blue] = colored.getImageData(0, 0, 1, 1).data;
  const { data } = pen.getImageData(0, 0, time_marks.width, time_marks.height);
  let count = 0;
  for (let k = 0; k < data.length; k += 4) {
    count += data[k] === red && data[k + 1] === green && data[k + 2] === blue && data[k + 3] > 0;
  }
  return count;
}"""
COUNTING_PROGRAM = "SI|X = 0;\nLOOP(3);\nX = X + 1;\nSHOW(X);\nF(0.5, 60);\nEND_LOOP"


def start_run(page: Page, text: str) -> None:
    write(page, text)
    page.click("#run")


def status_text(page: Page) -> str:
    return page.locator("#doing").text_content() or ""


def seconds(page: Page) -> float:
    return float(value(page, "Time").split()[0])


@sampled
def test_events_can_be_stepped_backward_and_forward(page: Page) -> None:
    start_run(page, COUNTING_PROGRAM)
    wait_for_phase(page, "ended")
    page.focus("#time_at")
    end_s, pose = seconds(page), page.locator("#where").text_content()
    times, shown_values = [end_s], []
    while times[-1] > 0:
        page.keyboard.press("ArrowLeft")
        assert status_text(page).startswith(
            f"Looking back at {seconds(page):.1f} s: line 5 ran, F(0.5, "
        )
        assert seconds(page) < times[-1] or seconds(page) == times[-1] == 0
        if seconds(page) == times[-1]:
            break
        times.append(seconds(page))
        shown_values.append(value(page, "X"))
    assert shown_values[0] == "3" and shown_values[-1] in ("0", "1")
    for time_s in times[-2::-1]:
        page.keyboard.press("ArrowRight")
        assert seconds(page) == time_s
    assert page.locator("#where").text_content() == pose
    page.keyboard.press("Home")
    assert seconds(page) == 0


@pytest.mark.sampled("button")
@pytest.mark.parametrize("button", ["pause", "step", "stop"])
def test_a_run_pauses_while_rewound_and_resumes_from_the_present(page: Page, button: str) -> None:
    start_run(page, "SI|X = 0;\nLOOP(999);\nX = X + 1;\nSHOW(X);\nF(0.3, 60);\nEND_LOOP")
    wait_for_phase(page, "running")
    page.locator("#trace", has_text="SHOW 3").wait_for(state="attached")
    page.focus("#time_at")
    page.keyboard.press("ArrowLeft")
    wait_for_phase(page, "paused")
    page.keyboard.press("Home")
    assert value(page, "X") == value(page, "SHOW(X)") == "1"
    assert running(page) == "F(0.3, 60)"
    page.click(f"#{button}")
    page.locator("#doing", has_not_text="Looking back").wait_for()
    # The program may run meanwhile.
    assert value(page, "X") != "1" and value(page, "SHOW(X)") != "1"
    wait_for_phase(page, {"pause": "running", "step": "paused", "stop": "ended"}[button])


@sampled
def test_shift_steps_through_each_executed_part(page: Page) -> None:
    start_run(page, "SI|F(0.3, 60);\nW(0.3);\nB(0.3, 60)")
    wait_for_phase(page, "ended")
    page.focus("#time_at")
    page.keyboard.press("Home")
    parts = []
    for _ in range(3):
        parts.append(running(page))
        page.keyboard.press("Shift+ArrowRight")
    assert parts == ["F(0.3, 60)", "W(0.3)", "B(0.3, 60)"]


@sampled
def test_a_new_run_has_its_own_time_line(page: Page) -> None:
    start_run(page, COUNTING_PROGRAM)
    wait_for_phase(page, "ended")
    page.focus("#time_at")
    page.keyboard.press("Home")
    start_run(page, "SI|W(0.4)")
    page.locator("#trace", has_text="DONE", has_not_text="SHOW").wait_for(state="attached")
    wait_for_phase(page, "ended")
    assert status_text(page) == "It has ended."
    start_ms, end_ms, shown_ms = (
        float(page.evaluate(f"time_at.{end}")) for end in ("min", "max", "value")
    )
    assert end_ms - start_ms < 1000 and shown_ms == end_ms


@sampled
def test_the_executed_part_is_shown_with_its_values(page: Page) -> None:
    start_run(page, "SI|NEAR = 30;\nF(1, 60) UNTIL(DISTANCE < NEAR)")
    wait_for_phase(page, "ended")
    page.focus("#time_at")
    page.keyboard.press("Home")
    part, *values = status_text(page).split(" · ")
    assert part == "Looking back at 0.0 s: line 2 ran, F(1, 60) UNTIL(DISTANCE < NEAR)"
    assert values[0].startswith("DISTANCE ") and values[1:] == ["NEAR 30"]


# Texts for users of text only: a word of the language, or a line number.
CODE_PATTERN = r"\b[A-Z]{2,}\b|\b[FWT]\(|[Ll](ine|ínea|inha) \d"


@sampled
def test_the_time_line_keeps_its_length(page: Page) -> None:
    """Else what a finger drags, or presses a second time, runs away under it."""
    start_run(page, "F(0.4, 60)")
    wait_for_phase(page, "ended")
    box = page.locator("#time_at").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + box["width"] - 8, box["y"] + box["height"] / 2)
    page.mouse.down()
    for part in (0.8, 0.5):
        page.mouse.move(box["x"] + part * box["width"], box["y"] + box["height"] / 2)
        page.locator("#doing", has_text="Looking back").wait_for()
        assert page.locator("#time_at").bounding_box() == box
    page.mouse.up()
    assert page.locator("#why").is_enabled()
    assert page.locator("#time_at").bounding_box() == box


@sampled
def test_why_explains_the_condition_and_its_readings(page: Page) -> None:
    """It also names the task that had the motors. No extra click is needed at each place."""
    task = "LOOP(3);\nIF(DISTANCE > 3);\nF(0.4, 60);\nENDIF;\nW(0.1);\nEND_LOOP"
    start_run(page, f"SI|TASK;\n{task};\nEND_TASK;\nW(2)")
    wait_for_phase(page, "ended")
    assert page.locator("#why").is_disabled()
    page.focus("#time_at")
    page.keyboard.press("Home")
    page.keyboard.press("ArrowRight")
    assert "Line 3" not in status_text(page)
    page.click("#why")
    page.focus("#time_at")
    read_names = set()
    explanation_pattern = (
        r"Line 3 checked DISTANCE > 3\. DISTANCE was ([\d.]+)\. The answer was yes\."
    )
    for _ in range(5):
        if match := re.search(explanation_pattern, status_text(page)):
            assert status_text(page).endswith("The task on line 1 was using the motors."), (
                status_text(page)
            )
            read_names.add(match[1])
        page.keyboard.press("ArrowRight")
    assert len(read_names) > 1
    page.keyboard.press("Home")
    page.click("#why")
    assert "Line 3" not in status_text(page) and "motors" not in status_text(page)


@sampled
def test_why_says_that_the_robot_has_bumped_while_it_looks_so(page: Page) -> None:
    start_run(page, "F(6, 100)")
    wait_for_phase(page, "ended")
    page.focus("#time_at")
    page.keyboard.press("ArrowLeft")
    page.click("#why")
    page.focus("#time_at")
    bump_text = str(page_texts("en")["where_bump_front"])
    wait_for(page, lambda: bump_text in status_text(page), "it stands at the wall")
    page.keyboard.press("Home")
    wait_for(page, lambda: bump_text not in status_text(page), "it stands free")
    page.click("#why")


@sampled
@pytest.mark.parametrize("language", ["en", "es", "pt"])
def test_block_users_get_messages_about_blocks(page: Page, language: str) -> None:
    """At each moment of a run: no code and no line; users of text are told about text."""
    loop = "LOOP(3)\nIF(DISTANCE > 3)\nF(0.4, 60) UNTIL(DISTANCE < 2)\nENDIF\nW(0.1)\nEND_LOOP"
    start_run(
        page, f"SI|WHEN(DISTANCE > 3)\n{loop}\nEND_WHEN\nW(2)\nSHOW(1 / (DISTANCE - DISTANCE))"
    )
    wait_for_phase(page, "ended")
    speak(page, language)
    assert re.search(CODE_PATTERN, status_text(page))
    page.click("#view_blocks")
    wait_for_blocks(page)
    page.focus("#time_at")
    page.keyboard.press("Home")
    page.click("#why")
    page.focus("#time_at")
    status_texts = set()
    for _ in range(12):
        wait_for(page, lambda: not re.search(CODE_PATTERN, status_text(page)), "no code")
        status_texts.add(status_text(page))
        page.keyboard.press("ArrowRight")
    was = str(page_texts(language)["why_value"]).format(name="[^.]+", value="[0-9]")
    assert any(re.search(was, text) for text in status_texts)
    assert not any(re.search(r"\. [^\W\dA-ZÀ-Ý]", text) for text in status_texts), (
        "a small first letter"
    )
    page.click("#why")
    page.click("#view_text")
    wait_for(page, lambda: re.search(CODE_PATTERN, status_text(page)), "code")
    speak(page, "en")


@sampled
def test_a_starting_when_is_marked_on_the_time_line(page: Page) -> None:
    for begins_s, is_marked in ((0.5, True), (90, False)):
        body = "W(0.3);\nW(9);\nEND_WHEN;\nSHOW(1);\nW(1.5);\nSHOW(2)"
        start_run(page, f"SI|WHEN(TIME > {begins_s});\n{body}")
        page.locator("#trace", has_text="SHOW 2").wait_for(state="attached")
        page.click("#stop")
        wait_for_phase(page, "ended")
        assert (page.evaluate(MARKED_SCRIPT) > 0) is is_marked
