"""Lessons next to the simulator: step by step, checked as by the command, kept on the device."""

from __future__ import annotations

import json
from itertools import product
from typing import TYPE_CHECKING

import pytest

from tests.support.page_lessons import check_answer, choose_lesson
from tests.support.page_programs import list_programs
from tests.support.page_robot import wait_for_nothing_running, wait_for_running
from tests.support.sampling import sample_of
from tests.support.studio import (
    SETTLED_SCRIPT,
    Pages,
    axe,
    colors_of,
    speak,
    turn,
    wait_for,
    wait_for_note,
    wait_for_phase,
    wait_until_checked,
    write,
)
from tiniscript.lessons import catalogue

if TYPE_CHECKING:
    from playwright.sync_api import Page

FOLDERS = catalogue.folders()
sampled = pytest.mark.sampled(of="details of lessons", keep=3)

NIGHT_COLOUR = "39,50,75"
BUSY_PROGRAM = "SI|LOOP(FOREVER);SHOW(1);END_LOOP"  # thousands of actions in a second


@pytest.fixture
def page(page: Page) -> Page:
    page.select_option("#speed", "20")
    page.evaluate("localStorage.removeItem('tiniscript.lesson_programs')")
    page.click("#side_lessons")
    page.locator("#lesson:enabled").wait_for()
    return page


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(6))
def test_each_lesson_judges_wrong_answers_like_the_command(page: Page, part: int) -> None:
    """The results of `tsc lesson check` are tested with the lessons."""
    for number, folder in list(enumerate(FOLDERS, 1))[part::6]:
        _, wrong_answers = catalogue.answers(folder)
        choose_lesson(page, number)
        verdict = check_answer(page, wrong_answers[0].program)
        assert verdict == (
            "failed",
            [wrong_answers[0].sentence_by_language["en"], *later_sentences(page)],
        ), number
        assert page.inner_text("#lesson_said").startswith("Not yet"), number


@pytest.mark.sampled("number")
@pytest.mark.parametrize("number", range(1, len(FOLDERS) + 1))
def test_a_lesson_is_solved_by_its_answer(page: Page, number: int) -> None:
    right_answers, _ = catalogue.answers(FOLDERS[number - 1])
    choose_lesson(page, number)
    assert check_answer(page, right_answers[0].program) == ("passed", [])
    lesson = catalogue.load(FOLDERS[number - 1])
    worlds = f", in {lesson.world_count} worlds" if lesson.world_count > 1 else ""
    expected_text = f"Done! You solved lesson {number}{worlds}."
    assert page.inner_text("#lesson_said").startswith(f"{expected_text} You have ")
    assert page.inner_text("#lesson_stars") == "★" * lesson.world_count


def later_sentences(page: Page) -> list[str]:
    """Return the sentences after the first one, if any."""
    return page.locator("#lesson_findings li").all_inner_texts()[1:]


@sampled
def test_any_program_can_be_checked(page: Page) -> None:
    choose_lesson(page, 1)
    for program, verdict in (
        ("", "failed"), ("FF(2, 80)", "mistakes"), ("PING|F(1, 80)", "mistakes"),
        ("\0🤖<b>", "mistakes"), ("SI|SHOW(1 / 0 * DISTANCE)", "failed"),
        ("X = 0; SHOW(1 / X)", "failed"),
    ):  # fmt: skip
        shown_verdict, sentences = check_answer(page, program)
        assert (shown_verdict, len(sentences)) == (verdict, verdict == "failed"), program


@sampled
def test_a_check_can_be_ended(page: Page) -> None:
    choose_lesson(page, 9)
    write(page, BUSY_PROGRAM)
    page.click("#lesson_check")
    page.locator("#lesson_said", has_text="World 1 of 5").wait_for()
    page.click("#lesson_end")
    assert page.inner_text("#lesson_said") == "You stopped the check, so there is no result."
    assert page.evaluate("document.activeElement.id") == "lesson_check"
    choose_lesson(page, 1)
    right_answers, _ = catalogue.answers(FOLDERS[0])
    # The verdict is not that of the other check.
    assert check_answer(page, right_answers[0].program) == ("passed", [])


@sampled
def test_the_judged_run_is_shown_until_it_fails(page: Page) -> None:
    """The robot stays at the wall that it touched; then the answer appears."""
    choose_lesson(page, 1)
    write(page, "SI|F(5, 80)")
    page.select_option("#speed", "1")
    page.click("#lesson_check")
    page.locator("#lesson_said", has_text="Watch what the robot does").wait_for(state="attached")
    wait_for_phase(page, "running")
    assert page.locator("#arena").is_visible()
    assert page.locator("#lesson_said[data-verdict]").count() == 0
    page.locator("#lesson_said[data-verdict=failed]").wait_for()
    values = page.locator("#values dd")
    assert (values.nth(0).inner_text(), values.nth(2).inner_text()) == ("3.0 s", "1")
    assert page.locator("html[data-phase=ended]").count() == 1


@sampled
def test_the_shown_run_can_be_skipped_to_the_verdict(page: Page) -> None:
    choose_lesson(page, 2)
    write(page, "F(3, 80); W(9)")
    page.select_option("#speed", "1")
    for button in ("#lesson_end", "#stop"):
        page.click("#lesson_check")
        page.locator("#lesson_end", has_text="Skip").wait_for()
        page.click(button)
        page.locator("#lesson_said[data-verdict=failed]").wait_for()
        assert page.locator("#lesson_end").is_hidden()


def test_no_highlight_remains_after_a_run(page: Page, pytestconfig: pytest.Config) -> None:
    """It may have ended, or was skipped or stopped."""
    choose_lesson(page, 4)
    write(page, "SI|LOOP(FOREVER)\n  F(0.3, 30)\n  L(0.3, 60)\nEND_LOOP\n")
    page.select_option("#speed", "1")
    view_ends = [*product(("#view_blocks", "#view_text"), ("#lesson_end", "#stop", ""))]
    for view, end in sample_of(pytestconfig, "ends of a run", view_ends, 2):
        page.click(view)
        page.click("#lesson_check")
        page.locator("#lesson_end", has_text="Skip").wait_for()
        wait_for_running(page)
        page.locator("#doing", has_text="times as fast").wait_for()  # than the speed that is chosen
        if end:
            page.click(end)
        page.locator("#lesson_said[data-verdict=failed]").wait_for()
        wait_for_nothing_running(page)
        page.locator(".blocklyBlockCanvas .running").wait_for(state="detached", timeout=10_000)


# Names of lessons that the list does not show whole, if they are chosen.
CUT_NAMES_SCRIPT = """() => {
  const shown = document.querySelector('#lesson selectedcontent span');
  const was = shown.textContent;
  const names = [...document.querySelectorAll('#lesson option')].map((each) => each.textContent);
  const found = names.filter((name) => {
    shown.textContent = name;
    return shown.scrollWidth > shown.clientWidth + 1 || shown.scrollHeight > shown.clientHeight + 1;
  });
  shown.textContent = was;
  return found;
}"""


@sampled
def test_a_lesson_is_one_step_at_a_time(page: Page) -> None:
    for language, word in (("es", "Detente"), ("pt", "Pare antes"), ("en", "Stop before")):
        speak(page, language)
        page.locator("#lesson option", has_text=word).wait_for(state="attached")
        assert page.evaluate(CUT_NAMES_SCRIPT) == []
    choose_lesson(page, 2)
    assert page.locator("#lesson selectedcontent svg").is_visible()
    steps = page.locator("#lesson_steps button")
    steps.first.click()
    assert "several instructions" in page.inner_text("#lesson_page")
    assert page.locator("#lesson_check").is_hidden() and page.locator("#lesson_hint").is_hidden()
    for k in range(steps.count() - 1):
        assert steps.nth(k).get_attribute("aria-current") == "step"
        page.dblclick("#lesson_next")
    assert page.locator("#lesson_next").is_hidden()
    page.click("#lesson_hint summary")
    assert "Three instructions" in page.inner_text("#lesson_hint_said")
    right_answers, _ = catalogue.answers(FOLDERS[1])
    assert check_answer(page, right_answers[0].program)[0] == "passed"
    page.get_by_role("button", name="Next lesson").click()
    page.locator("#lesson_page", has_text="behind a block of houses").wait_for()
    assert page.input_value("#lesson") == "3"
    assert steps.first.get_attribute("aria-current") == "step"
    label = page.locator("#world option:checked").text_content()
    assert label == "Lesson 3"


# The minimum height of a page of a step, by the size of the screen.
PAGES = {
    (1366, 768): 500, (1024, 600): 280, (390, 844): 260, (320, 640): 150, (844, 390): 150,
}  # fmt: skip


@pytest.mark.long
@pytest.mark.sampled("size")
@pytest.mark.parametrize("size", PAGES, ids=lambda size: "x".join(map(str, size)))
def test_a_step_and_the_robot_are_visible_together(page: Page, size: tuple[int, int]) -> None:
    """On a laptop each step is fully visible, elsewhere six lines of it."""
    page.set_viewport_size({"width": size[0], "height": size[1]})
    turn(page, "robot")
    for number in range(1, len(FOLDERS) + 1) if size[0] == 1366 else (1,):
        page.select_option("#lesson", str(number))
        page.locator(f"#lesson_page[data-lesson='{number}']").wait_for()
        for button in page.locator("#lesson_steps button").all():
            button.click()
            height, total_height = page.evaluate(
                "(({clientHeight, scrollHeight}) => [clientHeight, scrollHeight])"
                "(document.querySelector('#lesson_page'))"
            )
            assert height >= min(PAGES[size], total_height), (number, button.inner_text())
            assert size[0] != 1366 or height == total_height
            if page.locator("#lesson_hint").is_visible() and size == (1024, 600):
                page.click("#lesson_hint summary")
                height = page.evaluate("document.querySelector('#lesson_page').clientHeight")
                assert height >= 100, "what is to be done, beside a hint"
                page.click("#lesson_hint summary")
    for number in (1, 7):  # the name is shown in full, next to its number or above the step
        page.select_option("#lesson", str(number))
        page.locator(f"#lesson_page[data-lesson='{number}']").wait_for()
        is_phone = page.locator("html[data-phone]").count()
        name = page.locator("#lesson_name" if is_phone else "#lesson selectedcontent span")
        title = catalogue.load(FOLDERS[number - 1]).title("en")
        assert name.inner_text().removeprefix(f"{number}. ").split(" ★")[0] == title
        assert name.evaluate("e => e.scrollHeight <= e.clientHeight + 1"), number
    box = page.locator("#arena").bounding_box()
    assert box and box["height"] >= 110 and box["y"] + box["height"] <= size[1]
    page.set_viewport_size({"width": 1366, "height": 768})


def test_a_verdict_applies_to_the_current_program(page: Page) -> None:
    choose_lesson(page, 1)
    right_answers, _ = catalogue.answers(FOLDERS[0])
    assert check_answer(page, right_answers[0].program)[0] == "passed"
    page.locator(".cm-content").focus()
    page.keyboard.type(" ")
    page.locator("#lesson_said[data-verdict=before]").wait_for()
    page.keyboard.press("Backspace")
    page.locator("#lesson_said[data-verdict=passed]").wait_for()
    write(page, BUSY_PROGRAM)
    page.dblclick("#lesson_check")  # the second click must not hit the button that takes its place
    page.locator("#lesson_end").wait_for()
    write(page, "SI|S")
    page.locator("#lesson_check").wait_for()
    assert page.locator("#lesson_said[data-verdict]").count() == 0


@sampled
def test_the_world_of_a_failure_is_shown(page: Page) -> None:
    choose_lesson(page, 12)
    _, wrong_answers = catalogue.answers(FOLDERS[11])
    assert check_answer(page, wrong_answers[0].program)[0] == "failed"
    message = page.inner_text("#lesson_said")
    assert page.input_value("#robot") == "liner"
    label = page.locator("#world option:checked").inner_text()
    seed = label.rpartition(" ")[2]
    assert label.startswith("Lesson 12, world ") and seed in message
    assert page.inner_text("#lesson_stars").count("★") == int(seed) - 1
    speak(page, "es")
    assert page.locator("#world option:checked").inner_text().startswith("Lección 12, mundo ")
    wait_until_checked(page)
    page.click("#step")
    wait_for_phase(page, "paused")
    page.locator("#values dd").first.filter(has_text=" s").wait_for()
    page.keyboard.press("Escape")
    page.click("#side_virtual")
    page.select_option("#world", "obstacles")
    assert page.locator("#world option", has_text="12").count() == 0
    page.click("#side_lessons")
    page.locator("#world option:checked", has_text="12").wait_for(state="attached")


@sampled
def test_a_lesson_page_is_available_in_spanish_with_usable_programs(page: Page) -> None:
    choose_lesson(page, 4)
    page.locator("#lesson_steps button").nth(1).click()
    speak(page, "es")
    page.locator("#lesson_page", has_text="repite cuatro veces").wait_for()
    assert page.locator("#controls").evaluate("e => e.clientHeight") < 60  # all in one row
    assert page.locator("#lesson option").nth(3).inner_text().startswith("4. Un cuadrado con LOOP")
    assert page.locator("#lesson_page code", has_text="LOOP(4)").count() == 1
    assert "`" not in page.inner_text("#lesson_page") and "**" not in page.inner_text(
        "#lesson_page"
    )
    page.get_by_role("button", name="Ponerlo en el programa").first.click()
    wait_for_note(page, "Ya está en el programa")
    assert page.locator(".cm-content").inner_text().startswith("SI|LOOP(4)\n  F(1, 60)")


def test_lessons_can_be_loaded_later_and_progress_is_kept(
    pages: Pages, pytestconfig: pytest.Config
) -> None:
    page = pages.open()
    page.route("**/lessons.zip", lambda route: route.abort())
    page.click("#side_lessons")
    page.locator("#lesson_said", has_text="did not load").wait_for()
    assert page.locator("#lesson_next").is_disabled()
    page.unroute("**/lessons.zip")
    pages.errors.clear()
    page.click("#side_lessons")
    page.locator("#lesson_next:enabled").wait_for()
    right_answers, _ = catalogue.answers(FOLDERS[1])
    kept_state = (json.dumps(["01_first_line", 5, "<b>", "x" * 500, None]), '"x"', "no JSON", "[]")
    locator = page.locator("#lesson option", has_text="✓")
    for k, lesson in enumerate(kept_state):
        page.evaluate("kept => localStorage.setItem('tiniscript.lessons', kept)", lesson)
        speak(page, "es")
        page.locator("#lesson option", has_text="línea").first.wait_for(state="attached")
        speak(page, "en")
        page.locator("#lesson option", has_text="first line").wait_for(state="attached")
        assert locator.count() == int(k == 0)
    choose_lesson(page, 2)
    page.select_option("#speed", "20")
    assert check_answer(page, right_answers[0].program)[0] == "passed"
    assert page.locator("#lesson option:checked").inner_text().endswith(" ★ 1/1 ✓ done")
    assert check_answer(page, "SI|F(1, 80)")[0] == "failed"
    assert "it stays solved" in page.inner_text("#lesson_said")
    counts = (0, 2, len(FOLDERS))
    for count in sample_of(
        pytestconfig, "lessons done", counts
    ):  # continues with the first unfinished one
        names = json.dumps([folder.name for folder in FOLDERS[:count]])
        page.evaluate("names => localStorage.setItem('tiniscript.lessons', names)", names)
        page.click("#side_virtual")
        page.evaluate("sessionStorage.removeItem('tiniscript.lesson_place')")  # as in another tab
        page.reload()
        wait_until_checked(page)
        page.click("#side_lessons")
        number = count % len(FOLDERS) + 1
        page.locator(f"#lesson_page[data-lesson='{number}']").wait_for()
        assert locator.count() == count


def test_arrow_keys_go_where_they_point_among_the_pictures_of_lessons(page: Page) -> None:
    page.select_option("#lesson", "5")
    page.locator("#lesson_page[data-lesson='5']").wait_for()
    page.locator("#lesson").focus()
    page.keyboard.press("Enter")
    focused = page.locator("#lesson option:focus")
    for key, number in (("Down", 8), ("Right", 9), ("Up", 6), ("Up", 3), ("Up", 3), ("Left", 2)):
        focused.wait_for()
        page.keyboard.press(f"Arrow{key}")
        assert focused.get_attribute("value") == str(number), key
    page.keyboard.press("Enter")
    page.locator("#lesson_page[data-lesson='2']").wait_for()


def test_the_keyboard_alone_leads_from_the_start_to_a_checked_lesson(pages: Pages) -> None:
    page = pages.open("start")
    axe_of = [axe(page)]

    def press(selector: str, max_presses: int = 3) -> None:
        """Go on with Tab to an element, past few others, and press Enter."""
        for _ in range(max_presses):
            if page.evaluate("where => document.activeElement.matches(where)", selector):
                return page.keyboard.press("Enter")
            page.keyboard.press("Tab")
        raise AssertionError(f"Tab does not lead to {selector}")

    press("#start_lessons", 16)
    page.locator("#lesson_next:enabled").wait_for()
    axe_of.append(axe(page))
    press("#lesson_page .program button")
    wait_for_note(page, "It is in the program now")
    for k in range(1, page.locator("#lesson_steps button").count()):
        press("#lesson_next")
        page.locator(f"#lesson_steps li:nth-child({k + 1}) [aria-current]").wait_for()
    press("#lesson_check")
    page.locator("#lesson_said[data-verdict=failed]").wait_for()
    assert page.evaluate("document.activeElement.id") == "lesson_check"
    assert "54 cm" in page.inner_text("#lesson_findings[aria-live=polite]")
    assert axe_of == [[], []]


@sampled
def test_the_start_screen_leads_to_the_lessons_from_anywhere(page: Page) -> None:
    """Also from a page with a drawn floor, and with Back from a panel in front of it."""
    page.click("#side_virtual")
    page.click("#world_draw:enabled")
    page.click("#my_programs")
    page.go_back()
    page.click("#start_lessons")
    page.locator("#lesson:enabled").wait_for()
    assert page.locator("#writing").is_visible()


@pytest.mark.parametrize("number", [1, 11])
def test_a_lesson_starts_correctly_whatever_robot_was_selected(page: Page, number: int) -> None:
    """It brings its own robot and an empty program; the other program returns after the lesson."""
    robot, program = (
        ("liner", "SI|IF(LINE_L);S;END_IF") if number == 1 else ("tinibot", "SI|SHOW(DISTANCE)")
    )
    page.click("#side_virtual")
    page.select_option("#robot", robot)
    write(page, program)
    page.click("#side_lessons")
    choose_lesson(page, 2)
    choose_lesson(page, number)
    lesson = catalogue.load(FOLDERS[number - 1])
    wait_for_note(page, "Your program is kept, and comes back after the lesson.")
    page.locator("#lesson:enabled").wait_for()
    wait_for(page, lambda: page.input_value("#robot") == lesson.robot, "its robot")
    page.locator(".cm-content", has_text=program).wait_for(state="detached")
    wait_until_checked(page)
    assert page.locator("#messages li").count() == 0
    page.click("#side_virtual")  # without work, there is nothing to lose
    page.locator(".cm-content", has_text=program).wait_for()
    assert page.input_value("#robot") == robot
    page.click("#side_lessons")
    wait_for_note(page, "Your program is kept, and comes back after the lesson.")
    write(page, "SI|F(1, 80)")
    page.click("#side_virtual")
    wait_until_checked(page)
    assert "F(1, 80)" in page.inner_text(".cm-content")  # the lesson continues
    page.click("#home")
    page.click("#start_write")
    page.locator(".cm-content", has_text=program).wait_for()
    assert page.input_value("#robot") == robot
    assert page.locator("#world option", has_text="Lesson").count() == 0
    page.click("#my_programs")
    names = page.locator("#versions strong").all_inner_texts()
    page.click("#programs_close")
    assert lesson.title("en").replace(":", "") in names


@sampled
def test_a_check_ends_with_the_lesson_and_with_the_language(page: Page) -> None:
    """The start page shows no verdict, and after a change of language the reason is translated."""
    choose_lesson(page, 7)
    write(page, BUSY_PROGRAM)
    page.click("#lesson_check")
    page.locator("#lesson_said", has_text="World 1 of 5").wait_for()
    speak(page, "es")
    page.locator("#lesson_said", has_text="No hay resultado").wait_for()
    speak(page, "en")
    choose_lesson(page, 1)
    right_answers, _ = catalogue.answers(FOLDERS[0])
    write(page, right_answers[0].program)
    page.select_option("#speed", "1")
    page.click("#lesson_check")
    wait_for_phase(page, "running")
    page.click("#home")
    page.locator("html[data-screen=start]").wait_for(state="attached")
    page.evaluate(SETTLED_SCRIPT)
    assert page.locator("#lesson_said[data-verdict]").count() == 0
    assert page.locator(".confetti").count() == 0
    page.click("#start_write")


@sampled
def test_switching_lessons_reports_where_the_previous_program_is(page: Page) -> None:
    """Programs of lessons are in the list; the person's own program returns."""
    program, of_lesson = "SI|F(1, 70)", "SI|SHOW(DISTANCE)"
    write(page, program)
    choose_lesson(page, 1)
    page.locator("#lesson_steps button").first.click()
    page.locator("#lesson_page .program button").first.click()
    wait_for_note(page, "It is in the program now. Your own program is in My programs")
    write(page, "SI|F(3, 70)")
    page.locator("#lesson_page .program button").first.click()
    wait_for_note(page, "It is in the program now. The one before is in My programs.")
    page.locator("#lesson_steps button").last.click()
    assert not page.locator("#note").is_visible()  # the previous step announced it
    page.click("#side_virtual")
    wait_for_note(page, "This is your program for the lesson. Your own program is in My programs.")
    write(page, of_lesson)
    page.click("#side_lessons")
    choose_lesson(page, 11)
    wait_for_note(page, "The program of the previous lesson is in My programs.")
    page.click("#home")
    page.click("#start_write")
    page.locator(".cm-content", has_text=program).wait_for()
    page.click("#my_programs")
    versions = page.locator("#versions button", has_text=catalogue.load(FOLDERS[0]).title("en"))
    versions.first.click()  # a slow page may also have kept the earlier text
    page.locator(".cm-content", has_text=of_lesson).wait_for()


@sampled
def test_returning_to_a_lesson_restores_its_program(page: Page) -> None:
    """After another lesson, the start screen, or a reload; the own program returns later."""
    own_text, first_text, second_text = "SI|F(1, 70)", "SI|SHOW(1)", "SI|SHOW(2)"
    editor = page.locator(".cm-content")
    write(page, own_text)
    choose_lesson(page, 1)
    page.locator("#lesson_steps button").first.click()
    page.locator("#lesson_page .program button").first.click()
    write(page, first_text)
    choose_lesson(page, 2)
    write(page, second_text)  # in the existing program
    page.select_option("#lesson", "1")
    wait_for_note(page, "Here is your program for this lesson again.")
    assert editor.inner_text() == first_text
    choose_lesson(page, 3)
    assert not page.locator("#note").is_visible()  # the program has no note yet
    page.click("#home")
    page.click("#start_write")
    editor.filter(has_text=own_text).wait_for()
    page.click("#home")
    page.click("#start_lessons")
    choose_lesson(page, 1)
    editor.filter(has_text=first_text).wait_for()
    choose_lesson(page, 2)
    editor.filter(has_text=second_text).wait_for()
    for step in (2, 0):
        page.locator("#lesson_steps button").nth(step).click()
        page.reload()
        wait_until_checked(page)
        assert editor.inner_text() == second_text
        page.locator("#lesson_page[data-lesson='2']").wait_for()
        page.locator(f"#lesson_steps li:nth-child({step + 1}) [aria-current]").wait_for()
    page.click("#side_virtual")
    page.reload()
    wait_until_checked(page)
    assert not page.locator("#lesson_page").is_visible()
    page.click("#side_lessons")
    page.locator("#lesson_page[data-lesson='2']").wait_for()
    choose_lesson(page, 1)
    editor.filter(has_text=first_text).wait_for()
    page.click("#home")
    page.click("#start_write")
    editor.filter(has_text=own_text).wait_for()


# The names of the buttons nearer than 24 pixels to the one that begins a lesson again, at the end
# of its page.
NEAR_SCRIPT = """() => {
  const button = document.querySelector('#lesson_anew');
  const page = document.querySelector('#lesson_page');
  page.scrollTop = page.scrollHeight;
  const own = button.getBoundingClientRect();
  const others = document.querySelectorAll('button, select, summary');
  return [...others].filter((each) => {
    if (each === button || !each.checkVisibility()) return false;
    const box = each.getBoundingClientRect();
    const aside = Math.max(box.left - own.right, own.left - box.right, 0);
    const above = Math.max(box.top - own.bottom, own.top - box.bottom, 0);
    return Math.hypot(aside, above) < 24;
  }).map((each) => each.id || each.textContent);
}"""


@sampled
def test_a_solved_lesson_can_be_started_again(page: Page) -> None:
    """Its program is kept before, and undo brings it back; the lesson stays solved."""
    page.evaluate("localStorage.removeItem('tiniscript.lessons')")
    anew = page.locator("#lesson_anew")
    editor = page.locator(".cm-content")
    solution = catalogue.answers(FOLDERS[0])[0][0].program
    choose_lesson(page, 1)
    page.locator("#lesson_steps button").first.click()
    page.locator("#lesson_page .program button").first.click()
    page.locator("#lesson_steps button").last.click()
    write(page, solution)
    assert not anew.is_visible()  # it is not solved
    assert check_answer(page, solution)[0] == "passed"
    for size in PAGES:
        page.set_viewport_size({"width": size[0], "height": size[1]})
        turn(page, "robot")
        assert page.evaluate(NEAR_SCRIPT) == [], size
    page.set_viewport_size({"width": 1366, "height": 768})
    for is_again in (False, True):
        anew.click()
        wait_for_note(page, "The lesson starts again. Your program is in My programs")
        wait_until_checked(page)
        assert editor.inner_text().strip() == "" and not anew.is_visible()
        page.locator("#lesson_steps li:first-child [aria-current]").wait_for()
        assert page.locator("#lesson_said[data-verdict]").count() == 0
        assert page.locator("#lesson option:checked").inner_text().endswith(" ✓ done")
        if not is_again:
            page.click("#undo")
            editor.filter(has_text=solution.splitlines()[0]).wait_for()
            anew.wait_for()
    page.click("#home")
    page.click("#start_lessons")
    page.locator("#lesson:enabled").wait_for()
    page.click("#my_programs")
    title = catalogue.load(FOLDERS[0]).title("en")
    assert any(name.startswith(title) for name in list_programs(page))  # also of other tests
    page.click("#programs_close")
    choose_lesson(page, 2)
    choose_lesson(page, 1)
    assert solution.splitlines()[0] not in editor.inner_text()


def test_a_program_that_suits_the_lesson_is_kept(page: Page) -> None:
    """Wrong programs stay unchanged too, and so do those that name their robot."""
    for program in ("SI|F(1, 80)", "SI|LINE_L(", "// robot: tinibot\nSI|SHOW(DISTANCE)"):
        write(page, program)
        for number in (1, 11):
            choose_lesson(page, number)
            if number == 11 and "LINE_L" not in program and "robot:" not in program:
                label = page.locator("#robot option:checked").inner_text()
                wait_for_note(page, f"This lesson’s robot is {label}.")
        assert page.inner_text(".cm-content").splitlines()[-1] == program.splitlines()[-1]


def test_a_room_that_a_lesson_calls_dark_is_dark(page: Page) -> None:
    choose_lesson(page, 13)
    page.locator("#world option:checked", has_text="13").wait_for(state="attached")
    assert NIGHT_COLOUR in colors_of(page, "#arena")
