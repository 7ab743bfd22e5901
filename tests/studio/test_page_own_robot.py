"""A person's own robot: its colour, its name, and the extras from lessons."""

from __future__ import annotations

import json
from itertools import product
from typing import TYPE_CHECKING

import pytest

from tests.support import studio
from tests.support.class_pages import join_class, open_teacher_page
from tests.support.noted_effects import NOTE_EFFECTS
from tests.support.page_lessons import check_answer, choose_lesson
from tests.support.studio import (
    Pages,
    axe,
    colors_of,
    enter,
    speak,
    wait_for,
    wait_for_phase,
    write,
)
from tiniscript.lessons import catalogue
from tiniscript.virtual import worlds as shipped_worlds
from tiniscript.virtual.score import MAX_STARS

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

OWN_ROBOT_KEY, STARS_KEY, LESSONS_KEY = (
    "tiniscript.own_robot",
    "tiniscript.stars",
    "tiniscript.lessons",
)
GREEN_COLOUR, PINK_COLOUR = "42,157,111", "208,70,143"  # the first colour, and the fourth
CONFETTI = "window.fell = 0; new MutationObserver((all) => { for (const {addedNodes} of all)" \
    " for (const each of addedNodes) if (each.className === 'confetti') window.fell += 1; })" \
    ".observe(document.body, {childList: true})"  # fmt: skip


def name_robot(page: Page, name: str, colour: int) -> None:
    """Enter a name and choose a colour, as a person does."""
    page.click("#home")
    page.click("#start_own")
    page.fill("#own_name", name)
    page.locator("#own [role=radiogroup] label").nth(colour).click()
    page.get_by_role("button", name="Close").click()


def store(page: Page, place: str, value: object) -> None:
    page.evaluate(
        "([place, what]) => localStorage.setItem(place, what)", [place, json.dumps(value)]
    )


@pytest.mark.sampled(of="pages of their own", keep=2)
def test_colour_and_name_of_a_robot_are_shown_everywhere_and_kept(pages: Pages) -> None:
    page = pages.open()
    assert GREEN_COLOUR in colors_of(page, "#arena")
    text_before = page.inner_text("#doing")
    name_robot(page, "  Pip ", 3)
    drawn_colour = page.evaluate(
        "getComputedStyle(document.querySelector('#drawn_robot path')).fill"
    )
    assert drawn_colour == f"rgb({PINK_COLOUR.replace(',', ', ')})"
    assert page.inner_text("#start_own").split() == ["Your", "robot", "Pip"]
    page.click("#start_own")
    assert axe(page, within="#own") == []
    page.keyboard.press("ArrowRight")  # the choice is one of the keyboard, too
    page.keyboard.press("Escape")
    page.reload()
    enter(page, page.url)
    assert page.inner_text("#doing") == f"Pip: {text_before}"
    colors = colors_of(page, "#arena")
    assert PINK_COLOUR in colors and GREEN_COLOUR not in colors


@pytest.mark.sampled("value")
@pytest.mark.parametrize(
    "value",
    [
        5,
        "x",
        None,
        [1],
        {"name": {}, "colour": "x"},
        {"name": "\u202e\n", "colour": 999},
        {"<b>": 1},
    ],
)
def test_damaged_stored_data_does_no_harm(pages: Pages, value: object) -> None:
    page = pages.open("start")
    for place in (OWN_ROBOT_KEY, STARS_KEY):
        store(page, place, value)
    store(page, LESSONS_KEY, [])
    page.reload()
    enter(page, page.url)
    assert GREEN_COLOUR in colors_of(page, "#arena")
    assert ":" not in page.inner_text("#doing")
    page.click("#home")
    assert not page.locator("#start_badge").is_visible()


@pytest.mark.sampled(of="pages of their own", keep=2)
def test_name_and_face_do_not_affect_a_run(pages: Pages) -> None:
    page = pages.open()
    traces = []
    for name in ("", "Pip"):
        name_robot(page, name, len(name))
        enter(page, page.url)
        page.click("#view_text")
        write(page, "F(0.5, 80);R(0.3, 50);SHOW(DISTANCE)")
        page.click("#run")
        wait_for_phase(page, "ended")
        traces.append(page.locator("#trace").text_content())
    assert traces[0] == traces[1] and "SHOW" in str(traces[0])


# Parts of a button that are squeezed, stick out of it, or lie over another one.
PARTS_SCRIPT = """all => {
  const boxes = all.map((each) => each.getBoundingClientRect());
  const whole = all[0].parentElement.getBoundingClientRect();
  return all.filter((each, k) => {
    const { left, right, top, bottom, width } = boxes[k];
    const isOver = boxes.some((other, n) => n > k && left < other.right && other.left < right
      && top < other.bottom && other.top < bottom);
    return isOver || left < whole.left || right > whole.right || top < whole.top
      || bottom > whole.bottom || (each.matches('svg') && width < 40)
      || each.scrollWidth > each.clientWidth + 1;
  }).map((each) => each.outerHTML.slice(0, 60));
}"""


def has_task(name: str) -> bool:
    world = shipped_worlds.load(name)
    return bool(world.flags or (world.rings and world.rivals))


@pytest.mark.sampled(of="pages of their own", keep=2)
@pytest.mark.parametrize("motion", ["seen and heard", "muted", "still"])
def test_a_solved_lesson_is_celebrated(pages: Pages, motion: str) -> None:
    """The stars of all lessons are added up, once each; those of a lesson that is no more do not
    count.
    """
    page = pages.open(reduced_motion="reduce" if motion == "still" else "no-preference")
    store(page, LESSONS_KEY, ["01_first_line"])
    store(page, STARS_KEY, {"01_first_line": 1, "04_none": 2})
    page.evaluate(NOTE_EFFECTS)
    page.evaluate(CONFETTI)
    if motion == "muted":
        page.click("#sound")
    page.select_option("#speed", "20")
    page.click("#side_lessons")
    folder = catalogue.folders()[1]
    right_answers, _ = catalogue.answers(folder)
    worlds = catalogue.load(folder).world_count
    for _ in range(2):
        choose_lesson(page, 2)
        assert check_answer(page, right_answers[0].program)[0] == "passed"
        assert f"You have {1 + worlds} stars." in page.inner_text("#lesson_said")
    assert page.evaluate("window.fell") == (0 if motion == "still" else 2)
    tune = [523, 659, 784, 1047]
    assert page.evaluate("window.heard").count(tune[-1]) == (0 if motion == "muted" else 2)
    page.locator(".confetti").wait_for(state="detached")
    page.click("#home")
    badge = page.locator("#start_badge")
    badge.filter(has_text=f"✓ 2/{len(catalogue.folders())}  ★ {1 + worlds}/").wait_for()
    lessons = [catalogue.load(each).world_count for each in catalogue.folders()]
    max_stars = sum(lessons) + MAX_STARS * sum(has_task(name) for name in shipped_worlds.names())
    expected_text = f"Lessons done: 2 of {len(lessons)}. Stars: {1 + worlds} of {max_stars}."
    assert expected_text in (badge.text_content() or "")
    for language, width in product(("en", "es", "pt"), (1366, 1024, 390, 320)):
        page.set_viewport_size({"width": width, "height": 768})
        speak(page, language)
        parts = page.locator("#start_lessons > :visible").evaluate_all(PARTS_SCRIPT)
        assert parts == [], (language, width)
    page.set_viewport_size({"width": 1366, "height": 768})
    speak(page, "en")
    assert axe(page, within="#start") == []
    page.reload()
    badge.filter(has_text=f"✓ 2/{len(catalogue.folders())}  ★ {1 + worlds}/").wait_for()


@pytest.mark.sampled(of="pages of their own", keep=2)
def test_the_teacher_sees_whose_robot_is_whose(browser: Browser) -> None:
    with studio.serve_class([]) as class_:
        pages = Pages(browser, class_.server.address)
        teacher, pupil = open_teacher_page(pages, class_), join_class(pages, class_, "Ana")
        pupil.click("#class_pupil [data-text=own_robot]")
        pupil.fill("#own_name", "<b>Pip")
        pupil.locator("#own [role=radiogroup] label").nth(3).click()
        tile = teacher.locator("#wall li").filter(has_text="Ana · <b>Pip")
        tile.wait_for()
        style_script = (
            "getComputedStyle(document.querySelector('#wall .own_robot')).getPropertyValue"
        )
        wait_for(
            teacher,
            lambda: teacher.evaluate(f"{style_script}('--robot')") == "#d0468f",
            "it has its colour",
        )
        assert tile.locator("b").count() == 0
        pages.close()
