"""Sounds and sights of a run on the page: the buzzer, a crash, and the pen's drawing."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING

import pytest
from PIL import Image

from tests.support.noted_effects import NOTE_EFFECTS
from tests.support.studio import (
    Pages,
    enter,
    wait_for_blocks,
    wait_for_phase,
    wait_until_checked,
    write,
)
from tests.support.waiting import until

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.sampled(files="sides of the page", keep=3)
sampled = pytest.mark.sampled(of="what is heard and seen", keep=3)

# The computer's sound, noted as often as it is opened. `rest` closes it after a while: the test
# decides when, since a run on a slow computer may take longer.
COUNTING_SCRIPT = """window.opened = []; window.closings = 0; window.rest = null;
const {setTimeout: wait, clearTimeout: forget} = window;
window.setTimeout = (act, ms, ...more) => {
  if (!String(act).includes('suspend')) return wait(act, ms, ...more);
  window.rest = ms > 0 && ms < 10_000 ? act : null;
  return -1;
};
window.clearTimeout = (which) => {
  if (which === -1) window.rest = null;
  else forget(which);
};
window.AudioContext = class extends AudioContext {
  constructor() { super(); window.opened.push(this); }
  suspend() { window.closings += 1; return super.suspend(); }
}"""
CRASH_PROGRAM = "F(9, 100)"  # into the box to the right
WAY_COLOUR, EARLIER_WAY_COLOUR = "2f74c0", "bcd2ea"
COLOUR_TOLERANCE = 20  # tolerance for a color at smooth edges or under a ray


def count(page: Page, color: str) -> int:
    """Return the number of pixels near a color in the picture."""
    picture = Image.open(BytesIO(page.locator("#arena").screenshot())).convert("RGB")
    expected_bytes = bytes.fromhex(color)
    pixels = zip(*(band.tobytes() for band in picture.split()), strict=True)
    return sum(
        all(
            abs(channel - other_value) < COLOUR_TOLERANCE
            for channel, other_value in zip(pixel, expected_bytes, strict=True)
        )
        for pixel in pixels
    )


@pytest.fixture
def heard_page(page: Page) -> Page:
    """A page that records its sound, and draws no path."""
    if not page.evaluate("'heard' in window"):
        page.reload()  # earlier sounds are not recorded
        wait_until_checked(page)
        page.evaluate(NOTE_EFFECTS)
    page.evaluate("window.heard = []; window.shaken = window.started = 0")
    erase(page)
    return page


def erase(page: Page) -> None:
    page.get_by_role("button", name="Erase the paths").click()


def run(page: Page, program: str) -> None:
    write(page, program)
    page.select_option("#speed", "20")
    page.select_option("#world", "obstacles")  # the last run is no longer seen
    wait_for_phase(page, "off")
    page.click("#run")
    wait_for_phase(page, "ended")


@sampled
def test_the_buzzer_is_heard_unless_it_is_muted_or_there_is_none(heard_page: Page) -> None:
    page = heard_page
    run(page, "BEEP(0.1, 440);W(0.1);BEEP(0.2, 880)")
    assert page.evaluate("window.heard") == [440, 880]
    page.get_by_role("button", name="Sound").click()
    assert page.get_attribute("#sound", "aria-pressed") == "false"
    run(page, "BEEP(0.1, 330)")
    assert page.evaluate("window.heard") == [440, 880]
    page.reload()
    wait_until_checked(page)
    assert page.get_attribute("#sound", "aria-pressed") == "false"  # the choice is remembered
    page.click("#sound")
    page.evaluate("() => { window.AudioContext = function () { throw new DOMException('no'); }; }")
    run(page, "BEEP(0.1, 440); SHOW(7)")  # a computer without sound
    assert "SHOW 7" in (page.locator("#trace").text_content() or "")
    page.evaluate(NOTE_EFFECTS)
    run(page, "BEEP(0.1, 550)")
    assert page.evaluate("window.heard") == [550]


def test_each_show_of_a_run_has_its_own_row(page: Page) -> None:
    run(page, "X = 2; SHOW(X * X); X = 3; SHOW(X * X)\nSHOW(7); SHOW(X)")
    rows = page.locator("#values > div").evaluate_all(
        "rows => rows.map((row) => [...row.children].map((cell) => cell.textContent).join(': '))"
    )
    assert rows[4:8] == [
        "SHOW(X * X) (line 1:8): 4", "SHOW(X * X) (line 1:28): 9", "SHOW: 7", "SHOW(X): 3",
    ]  # fmt: skip
    assert "SHOW 9" in (page.locator("#trace").text_content() or ""), "values alone"


def test_values_that_a_program_reads_are_listed_first(page: Page) -> None:
    run(page, "X = DISTANCE; SHOW(X)")
    names = page.locator("#values dt").all_inner_texts()
    assert names[:3] == ["Time", "Motors", "Collisions"]
    assert names[3:6] == ["distance sensor", "X", "SHOW(X)"] and len(names) > 6
    run(page, "SHOW(LIGHT_L)")
    assert page.locator("#values dt").all_inner_texts()[3:5] == [
        "left light sensor",
        "SHOW(LIGHT_L)",
    ]


@pytest.mark.parametrize("text", ["", "SI|", "// F(1)", "SI|;;"])
def test_an_empty_program_is_reported_before_and_after_its_run(page: Page, text: str) -> None:
    sentence = "The program is empty: put a block or a line into it, then press Run."
    write(page, text)
    page.locator("#status", has_text=sentence).wait_for()
    page.click("#run")
    page.locator("#doing", has_text=sentence).wait_for()
    write(page, "SHOW(2)")
    page.locator("#doing", has_text="It has ended.").wait_for()  # no sentence about another text
    run(page, "SHOW(1)")
    assert "It has ended." in page.inner_text("#doing")


@sampled
def test_no_audio_context_is_open_at_rest(pages: Pages) -> None:
    """An open one works all the time, and empties a battery. A page must wait before it closes
    this."""
    page = pages.blank(is_alone=True)
    page.context.add_init_script(COUNTING_SCRIPT)
    enter(page, pages.address)
    wait_for_blocks(page)
    assert page.evaluate("window.opened.length") == 0
    page.click("#view_text")
    for closing_count, program in enumerate(("F(1, 80)", "LOOP(3);BEEP(0.1, 440);W(4);END_LOOP")):
        run(page, program)  # prepares the sound before a picture waits for it
        until(lambda: page.evaluate("window.opened[0].state") == "running", "sound")
        assert page.evaluate("window.opened.length") == 1
        assert page.evaluate("window.closings") == closing_count
        until(lambda: page.evaluate("window.rest !== null"), "rest")
        page.evaluate("window.rest()")
        until(lambda: page.evaluate("window.opened[0].state") == "suspended", "closed")
        assert page.evaluate("window.closings") == closing_count + 1


@sampled
def test_stop_and_pause_silence_the_buzzer(heard_page: Page) -> None:
    page = heard_page
    write(page, "BEEP(30, 440)")
    for button, phase in (("pause", "paused"), ("stop", "ended")):
        stops_before = page.evaluate("window.stopped")
        page.click("#run")
        wait_for_phase(page, "running")
        until(lambda: page.evaluate("window.heard.length"), "a sound")
        page.evaluate("window.heard = []")
        page.click(f"#{button}")
        wait_for_phase(page, phase)
        assert page.evaluate("window.stopped") == stops_before + 1


@sampled
def test_a_crash_is_heard_reported_with_its_place_and_shaken(heard_page: Page) -> None:
    page = heard_page
    noted_text = "[window.heard.length, window.started, window.shaken]"
    page.evaluate(
        "() => { window.told = []; new MutationObserver(([row]) => window.told.push("
        "row.target.textContent)).observe(document.querySelector('#where'), {childList: true}); }"
    )
    run(page, CRASH_PROGRAM)
    assert page.evaluate(noted_text) == [1, 1, 1]
    assert count(page, "ffd84d") > 20  # the star where it touches the box
    first_message, *_, last_message = page.evaluate("window.told")
    bump_text = "The robot has bumped into something ahead of it."
    assert first_message.startswith(f"{bump_text} The robot is ")
    assert last_message.startswith("Collisions: 1. The robot is ") and last_message.endswith(
        "to the right."
    )
    run(page, "W(1)")
    assert page.evaluate(noted_text) == [1, 1, 1]


@sampled
def test_shaking_respects_reduced_motion(heard_page: Page) -> None:
    page = heard_page
    page.emulate_media(reduced_motion="reduce")
    run(page, CRASH_PROGRAM)
    page.emulate_media(reduced_motion="no-preference")
    assert page.evaluate("[window.heard.length, window.shaken]") == [1, 0]
    assert count(page, "ffd84d") > 20


@sampled
def test_paths_stay_until_they_are_erased(heard_page: Page) -> None:
    page = heard_page
    page.select_option("#world", "obstacles")
    assert count(page, WAY_COLOUR) == 0
    run(page, "R(0.1, 60);F(1.5, 80)")  # oblique: both edges of a level line may have that color
    pixels_before = count(page, EARLIER_WAY_COLOUR)
    assert count(page, WAY_COLOUR) > 20
    run(page, "L(0.5, 60);F(0.5, 80)")
    assert count(page, WAY_COLOUR) > 5 and count(page, EARLIER_WAY_COLOUR) > pixels_before + 20
    erase(page)
    assert count(page, WAY_COLOUR) == 0 and count(page, EARLIER_WAY_COLOUR) < 10
    run(page, "F(1, 80)")
    page.select_option("#world", "light")
    assert count(page, WAY_COLOUR) == 0 and count(page, EARLIER_WAY_COLOUR) < 10


TASK = """[floor]
width_cm = 200
height_cm = 100
[start]
x_cm = 40
y_cm = 50
[task]
seconds = 9
[[flags]]
x_cm = 90
y_cm = 50
[[flags]]
x_cm = 140
y_cm = 50
"""


@sampled
def test_flags_points_and_stars_are_shown_and_heard(heard_page: Page) -> None:
    page = heard_page
    page.set_input_files(
        "#world_file", {"name": "task.toml", "mimeType": "", "buffer": TASK.encode()}
    )
    page.locator("#world option:checked", has_text="task").wait_for(state="attached")
    assert page.locator("#doing").inner_text().startswith("Opened")
    write(page, "F(4, 80)")
    page.click("#run")
    wait_for_phase(page, "ended")
    assert page.locator("#score").inner_text() == "⚑ 2/2   230   ★★★"
    assert count(page, "2a9d6f") > 100  # the flags that were taken
    announced_text = page.locator("#where").inner_text()
    assert "Flags: 2 of 2. Points: 230. Stars: 3 of 3." in announced_text
    assert (
        "cm from the left and 50 cm from the bottom, and is facing to the right." in announced_text
    )
    page.select_option("#world", "obstacles")
    assert not page.locator("#score").is_visible()


SLEEPING_RIVAL_WORLD = """[floor]
width_cm = 200
height_cm = 100
border = false
[start]
x_cm = 40
y_cm = 50
[[rings]]
x_cm = 70
y_cm = 50
radius_cm = 48
edge_cm = 5
[[rivals]]
x_cm = 80
y_cm = 50
power_percent = 0
"""
RIVAL_COLOUR, DARK_COLOUR = "9a4fc0", "3b434c"


@sampled
def test_a_bout_and_its_result_are_shown_and_heard(heard_page: Page) -> None:
    page = heard_page
    page.set_input_files(
        "#world_file",
        {"name": "bout.toml", "mimeType": "", "buffer": SLEEPING_RIVAL_WORLD.encode()},
    )
    page.locator("#world option:checked", has_text="bout").wait_for(state="attached")
    assert count(page, RIVAL_COLOUR) > 100 and count(page, DARK_COLOUR) > 1000
    for program, score, message in (
        (
            "// robot: sumo\nSI|F(5, 80)",
            "⇥ 1/1   100   ★★★",
            "The rival was pushed out of the ring.",
        ),
        ("// robot: sumo\nSI|B(2, 80)", "⇥ 0/1   0   ☆☆☆", "The robot fell out of the ring."),
    ):
        write(page, program)
        page.click("#run")
        page.locator("#doing", has_text=message).wait_for()
        wait_for_phase(page, "ended")
        assert page.locator("#score").inner_text() == score
        assert message in page.locator("#where").inner_text()
