"""Pupils of a group in browsers: one program, typed by two at once."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest

from tests.support.class_pages import (
    class_of_many,
    go_to_line,
    join_class,
    join_group,
    lines,
    open_teacher_page,
    type_slowly,
    wait_for_lines,
    wait_for_status,
)
from tests.support.page_link import events
from tests.support.page_robot import wait_for_nothing_running, wait_for_running
from tests.support.pty_robot import PtyRobot
from tests.support.studio import (
    Class,
    Pages,
    image,
    start_drive,
    wait_for_note,
    wait_until_checked,
    write,
)
from tests.support.waiting import until
from tiniscript import compile, robots

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Dialog, Page

pytestmark = pytest.mark.usefixtures("no_page_timeouts")
sampled = pytest.mark.sampled(of="details of groups", keep=2)

PROGRAM = "F(1, 80);\nLOOP(3);\n  B(1, 40);\nEND_LOOP;\nS;\n"
ROWS = [row.strip() for row in PROGRAM.splitlines()]


# When something is seen.
NOTES_WHEN = """(part) => { const root = document.querySelector('#editor').shadowRoot;
  new MutationObserver((_, each) => { if (!root.textContent.includes(part)) return;
    window.seen_ms = Date.now(); each.disconnect(); })
    .observe(root, { childList: true, subtree: true, characterData: true }); }"""


@pytest.fixture(scope="module")
def shared_class(browser: Browser) -> Iterator[Class]:
    with class_of_many() as taught_class:
        yield taught_class


@pytest.fixture(scope="module")
def pages(browser: Browser, shared_class: Class) -> Iterator[Pages]:
    opened_pages = Pages(browser, shared_class.server.address)
    yield opened_pages
    opened_pages.close()
    assert {"ERR_INTERNET_DISCONNECTED" in error for error in opened_pages.errors} <= {True}


@pytest.fixture(scope="module")
def page_pair(pages: Pages, shared_class: Class) -> tuple[Page, Page]:
    ana = join_class(pages, shared_class, "Ana")
    write(ana, PROGRAM)
    luz = join_class(pages, shared_class, "Luz")
    for page in (ana, luz):
        join_group(page)
    return ana, luz


def program_of(class_: Class) -> str:
    """Return the program of the only group, as the teacher sees it."""
    [group] = class_.room.teach({"do": "class"})["groups"]
    return str(class_.room.teach({"do": "class_text", "group": group["key"]})["text"])


def show_program_on_both(two: tuple[Page, Page]) -> None:
    """Let both pages show the program without a caret in it."""
    ana, luz = two
    write(ana, PROGRAM)
    ana.click("#side_class")
    ana.locator(".cm-content").evaluate("(it) => it.blur()")
    for page in (ana, luz):
        wait_for_lines(page, *ROWS)


def test_two_pupils_typing_at_once_get_the_same_program(page_pair: tuple[Page, Page]) -> None:
    ana, luz = page_pair
    show_program_on_both(page_pair)
    go_to_line(ana, "F(1, 80)")
    type_slowly(ana, "\nBEEP(1, 440)")  # her line is locked until she leaves it
    go_to_line(luz, "S;")
    type_slowly(luz, "\nw(2)\n")
    wait_for_lines(
        ana, "F(1, 80);", "BEEP(1, 440)", "LOOP(3);", "B(1, 40);", "END_LOOP;", "S;", "W(2);"
    )
    assert "BEEP" not in "".join(lines(luz))
    type_slowly(ana, "\n")
    all_lines = ("F(1, 80);", "BEEP(1, 440);", "LOOP(3);", "B(1, 40);", "END_LOOP;", "S;", "W(2);")
    for page in page_pair:
        page.locator(".cm-content").evaluate("(it) => it.blur()")
        wait_for_lines(page, *all_lines)
        wait_until_checked(page)
        until(lambda page=page: image(page) == compile("".join(all_lines)).image, "compiled")  # type: ignore[misc]


@sampled
def test_a_half_typed_value_stays_local_and_unchanged(
    page_pair: tuple[Page, Page],
) -> None:
    ana, luz = page_pair
    show_program_on_both(page_pair)
    go_to_line(ana, "B(1, 40)")
    for key in ("ArrowLeft", "ArrowLeft", "Backspace", "Backspace"):
        ana.keyboard.press(key)
    type_slowly(ana, "9")  # B(1, 9), which parses
    go_to_line(luz, "F(1, 80)")
    type_slowly(luz, "\nR(1, 50)\n")
    wait_for_lines(ana, "F(1, 80);", "R(1, 50);", "LOOP(3);", "B(1, 9);", "END_LOOP;", "S;")
    type_slowly(ana, "5")  # the caret is where it was
    assert "B(1, 40);" in [row.strip() for row in lines(luz)]
    ana.keyboard.press("ArrowDown")
    wait_for_lines(luz, "F(1, 80);", "R(1, 50);", "LOOP(3);", "B(1, 95);", "END_LOOP;", "S;")


@sampled
def test_undo_reverts_only_local_changes(page_pair: tuple[Page, Page]) -> None:
    ana, luz = page_pair
    show_program_on_both(page_pair)
    go_to_line(ana, "S;")
    type_slowly(ana, "\nW(7)\n")
    go_to_line(luz, "F(1, 80)")
    type_slowly(luz, "\nR(1, 50)\n")
    wait_for_lines(
        ana, "F(1, 80);", "R(1, 50);", "LOOP(3);", "B(1, 40);", "END_LOOP;", "S;", "W(7);"
    )
    ana.locator(".cm-content").focus()
    ana.keyboard.press("Control+z")
    for page in page_pair:
        wait_for_lines(page, "F(1, 80);", "R(1, 50);", "LOOP(3);", "B(1, 40);", "END_LOOP;", "S;")


@sampled
def test_undo_keeps_later_changes_of_others(page_pair: tuple[Page, Page]) -> None:
    ana, luz = page_pair
    show_program_on_both(page_pair)
    for page, text in ((ana, "95)\n"), (luz, "70)\n")):
        go_to_line(page, "B(1, ")
        for _ in range(4):
            page.keyboard.press("Backspace")
        type_slowly(page, text)
        wait_for_lines(ana, "F(1, 80);", "LOOP(3);", f"B(1, {text[:2]});", "END_LOOP;", "S;")
    go_to_line(ana, "S;")
    type_slowly(ana, "9")  # half typed, and undone as such
    ana.keyboard.press("Control+z")
    wait_for_lines(ana, "F(1, 80);", "LOOP(3);", "B(1, 70);", "END_LOOP;", "S;")
    ana.keyboard.press("Control+z")
    ana.wait_for_timeout(500)  # an older one may be taken back
    assert "B(1, 70);" in [row.strip() for row in lines(ana)]
    show_program_on_both(page_pair)
    go_to_line(ana, "B(1, 40)")
    for _ in range(4):
        ana.keyboard.press("Backspace")
    type_slowly(ana, "8)")
    ana.keyboard.press("ArrowDown")
    wait_for_lines(luz, "F(1, 80);", "LOOP(3);", "B(1, 8);", "END_LOOP;", "S;")
    ana.keyboard.press("Control+z")
    wait_for_lines(luz, "F(1, 80);", "LOOP(3);", "B(1, 40);", "END_LOOP;", "S;")
    ana.keyboard.press("Control+y")
    wait_for_lines(luz, "F(1, 80);", "LOOP(3);", "B(1, 8);", "END_LOOP;", "S;")


@sampled
def test_each_pupil_sees_the_others_cursor(page_pair: tuple[Page, Page]) -> None:
    ana, luz = page_pair
    show_program_on_both(page_pair)
    go_to_line(ana, "B(1, 40)")
    mark = luz.locator(".cm-line", has_text="B(1, 40)").locator(".cm-mate")
    mark.filter(has_text="Ana").wait_for()
    type_slowly(ana, " ")
    mark.filter(has_text="Ana …").wait_for()
    luz.locator("#class_mates", has_text="Ana").wait_for()


@sampled
def test_a_reloaded_page_is_still_in_the_group(
    page_pair: tuple[Page, Page],
) -> None:
    ana, luz = page_pair
    show_program_on_both(page_pair)
    go_to_line(luz, "F(1, 80)")
    type_slowly(luz, "\nBEEP(1, 4")  # the line is unfinished
    go_to_line(ana, "S;")
    type_slowly(ana, "\nW(3)\n")
    wait_for_lines(
        luz, "F(1, 80);", "BEEP(1, 4", "LOOP(3);", "B(1, 40);", "END_LOOP;", "S;", "W(3);"
    )
    luz.reload()
    luz.locator("html[data-group=in]").wait_for(state="attached")
    wait_for_lines(
        luz, "F(1, 80);", "BEEP(1, 4", "LOOP(3);", "B(1, 40);", "END_LOOP;", "S;", "W(3);"
    )
    go_to_line(luz, "BEEP(1, 4")
    type_slowly(luz, "40)\n")
    wait_for_lines(
        ana, "F(1, 80);", "BEEP(1, 440);", "LOOP(3);", "B(1, 40);", "END_LOOP;", "S;", "W(3);"
    )


def test_a_broken_network_loses_nothing(page_pair: tuple[Page, Page]) -> None:
    ana, luz = page_pair
    show_program_on_both(page_pair)
    ana.context.set_offline(True)
    go_to_line(ana, "F(1, 80)")
    type_slowly(ana, "\nW(4)\n")
    ana.locator("#class_group", has_text="is not responding").wait_for()
    go_to_line(luz, "S;")
    type_slowly(luz, "\nW(5)\n")
    ana.context.set_offline(False)
    for page in page_pair:
        wait_for_lines(
            page, "F(1, 80);", "W(4);", "LOOP(3);", "B(1, 40);", "END_LOOP;", "S;", "W(5);"
        )


def test_each_member_drives_and_stops_the_robot_of_the_group(
    page_pair: tuple[Page, Page], shared_class: Class
) -> None:
    ana, luz = page_pair
    show_program_on_both(page_pair)
    with PtyRobot(robots.load("tinibot").kit) as robot:
        shared_class.room.teach({"do": "class_robot", "port": robot.port, "gives": True})
        for page in page_pair:
            page.click("#side_real")
        ana.click("[data-text=class_ask]")
        ana.locator("html[data-robot=connected]").wait_for(state="attached")
        wait_for_status(luz, "Ana is driving ")
        start_drive(ana, robot)
        luz.click("#stop")
        until(lambda: not robot.moves, "the robot stands")
        luz.locator("#class_pupil [data-text=link_connect]").click()
        luz.locator("html[data-robot=connected]").wait_for(state="attached")
        wait_for_status(ana, "Luz is driving ")
        start_drive(luz, robot)
        ana.keyboard.press("Escape")
        until(lambda: not robot.moves, "the robot stands")
        shared_class.room.teach({"do": "class_robot", "port": robot.port, "gives": False})
        for page in page_pair:
            page.locator("html:not([data-robot=connected])").wait_for(state="attached")


def test_all_members_see_the_actions_of_the_groups_robot(
    page_pair: tuple[Page, Page], shared_class: Class
) -> None:
    ana, luz = page_pair
    show_program_on_both(page_pair)
    rows = ("SPEED = 5;", "SHOW(SPEED);", "F(3, 80);", "SHOW(SPEED + 1);", "R(3, 60);")
    with PtyRobot(robots.load("tinibot").kit) as robot:
        shared_class.room.teach({"do": "class_robot", "port": robot.port, "gives": True})
        for page in page_pair:
            page.click("#side_real")
        ana.click("[data-text=class_ask]")
        ana.locator("html[data-robot=connected]").wait_for(state="attached")
        write(ana, "\n".join(rows) + "\n")
        ana.locator(".cm-content").evaluate("(it) => it.blur()")
        for page in page_pair:
            wait_for_lines(page, *rows)
            wait_until_checked(page)
        ana.click("#link_upload")
        for row in ("F(3, 80)", "R(3, 60)"):
            for page in page_pair:
                wait_for_running(page, row)
        assert luz.locator("#link_shown").inner_text() == "SPEED 5\nSPEED + 1 6"
        assert not luz.locator("#link_upload").is_visible()
        ana.click("#stop")
        for page in page_pair:
            wait_for_nothing_running(page)
        luz.locator("#link_said", has_text="stopped").wait_for()
        luz.locator("#record_play:visible").wait_for()
        assert events(luz) == events(ana) == ["SHOW 5", "SHOW 6", "STOPPED"]
        for page in page_pair:
            page.click("#side_real")
        ana.fill("#link_line", "SHOW(7)")  # a line is her own
        ana.keyboard.press("Enter")
        ana.locator("#link_shown", has_text="7").wait_for()
        ana.click("#link_upload")
        wait_for_running(luz, "F(3, 80)")
        assert "7" not in luz.locator("#link_shown").inner_text()
        shared_class.room.teach({"do": "class_robot", "port": robot.port, "gives": False})
        for page in page_pair:
            wait_for_nothing_running(page)


def test_another_program_becomes_the_groups_only_on_request(
    page_pair: tuple[Page, Page],
) -> None:
    ana, luz = page_pair
    show_program_on_both(page_pair)
    questions: list[str] = []

    def answer_dialog(dialog: Dialog) -> None:
        questions.append(dialog.message)
        if len(questions) == 1:
            dialog.dismiss()
        else:
            dialog.accept()

    ana.on("dialog", answer_dialog)
    ana.click("#bar_new")
    until(lambda: len(questions) == 1, "it asks")
    wait_for_lines(ana, *ROWS)
    ana.click("#bar_new")
    wait_for_lines(luz)
    wait_for_lines(ana)
    assert questions == ["This replaces the program for your whole group. Replace it?"] * 2
    ana.remove_listener("dialog", answer_dialog)
    ana.locator(".cm-content").focus()
    ana.keyboard.press("Control+z")
    for page in page_pair:
        wait_for_lines(page, *ROWS)


def test_returned_work_goes_to_my_programs_if_the_pupil_keeps_it_out_of_the_group(
    page_pair: tuple[Page, Page], shared_class: Class
) -> None:
    _, luz = page_pair
    show_program_on_both(page_pair)
    shared_class.room.teach({"do": "class_bring", "name": "Lia", "text": "F(1, 77)", "robot": "",
                       "lessons": []})  # fmt: skip
    state = shared_class.room.teach({"do": "class"})
    [kept_work] = state["kept"]
    number = next(pupil["number"] for pupil in state["pupils"] if pupil["name"] == "Luz")
    with luz.expect_event("dialog") as asked_event_info:
        luz.once("dialog", lambda dialog: dialog.dismiss())
        shared_class.room.teach({"do": "class_give_back", "key": kept_work["key"], "pupil": number})
    assert "whole group" in asked_event_info.value.message
    wait_for_note(luz, "It is in My programs.")
    until(lambda: not shared_class.room.teach({"do": "class"})["kept"], "the class has heard of it")
    luz.reload()
    luz.locator("html[data-group=in]").wait_for(state="attached")
    for page in page_pair:
        wait_for_lines(page, *ROWS)
    luz.click("#my_programs")
    luz.locator("#versions strong", has_text="F(1, 77)").wait_for()
    luz.click("#programs_close")


def test_an_outdated_change_is_reported(page_pair: tuple[Page, Page], shared_class: Class) -> None:
    ana, luz = page_pair
    show_program_on_both(page_pair)
    ana.context.set_offline(True)
    go_to_line(ana, "LOOP(3)")
    for key in ("Home", "Shift+ArrowDown", "Shift+ArrowDown", "Shift+ArrowDown", "Delete"):
        ana.keyboard.press(key)
    ana.keyboard.press("ArrowUp")
    ana.locator("#class_group", has_text="is not responding").wait_for()
    go_to_line(luz, "B(1, 40)")
    type_slowly(luz, "\nBEEP(1, 440)\n")
    luz.locator(".cm-content").evaluate("(it) => it.blur()")
    until(lambda: "BEEP" in program_of(shared_class), "the class has hers")
    ana.context.set_offline(False)
    wait_for_note(ana, "Somebody else changed that part first, so your last change was not made.")
    for page in page_pair:
        wait_for_lines(
            page, "F(1, 80);", "LOOP(3);", "B(1, 40);", "BEEP(1, 440);", "END_LOOP;", "S;"
        )


def test_remote_changes_wait_up_to_two_seconds_for_a_composition(
    page_pair: tuple[Page, Page], shared_class: Class
) -> None:
    ana, luz = page_pair
    show_program_on_both(page_pair)
    ana.evaluate(NOTES_WHEN, "W(6)")
    go_to_line(ana, "F(1, 80)")
    type_slowly(ana, "\n")
    tells = ana.context.new_cdp_session(ana)
    tells.send("Input.imeSetComposition", {"text": "// n", "selectionStart": 4, "selectionEnd": 4})
    go_to_line(luz, "S;")
    type_slowly(luz, "\nW(6)")
    luz.keyboard.press("Enter")
    until(lambda: "W(6)" in program_of(shared_class), "the class has it")
    there_ms = 1000 * time.time()
    until(lambda: ana.evaluate("window.seen_ms !== undefined"), "it comes")
    assert ana.evaluate("window.seen_ms") - there_ms >= 500
    tells.send("Input.insertText", {"text": "// ni"})
    ana.keyboard.press("ArrowDown")
    for page in page_pair:
        wait_for_lines(
            page, "F(1, 80);", "// ni", "LOOP(3);", "B(1, 40);", "END_LOOP;", "S;", "W(6);"
        )


@sampled
def test_a_leaving_pupil_keeps_the_program_without_further_changes(
    page_pair: tuple[Page, Page],
) -> None:
    ana, luz = page_pair
    show_program_on_both(page_pair)
    luz.click("#side_class")  # the page was reloaded
    luz.click("[data-text=group_leave]")
    luz.locator("[data-text=group_join]").wait_for()
    go_to_line(ana, "S;")
    type_slowly(ana, "\nW(8)\n")
    luz.locator("#class_group button", has_text="Red (Ana)").wait_for()
    assert "W(8)" not in "".join(lines(luz))
    luz.reload()  # pages do not rejoin a group by themselves
    luz.click("#side_class")
    luz.locator("#class_group button", has_text="Red (Ana)").wait_for()
    assert luz.locator("html[data-group=in]").count() == 0
    assert "W(8)" not in "".join(lines(luz))
    luz.locator("#class_group button", has_text="Red (Ana)").click()
    wait_for_lines(luz, "F(1, 80);", "LOOP(3);", "B(1, 40);", "END_LOOP;", "S;", "W(8);")


@sampled
def test_the_teacher_sees_a_group_as_one_tile_with_its_history(
    page_pair: tuple[Page, Page], shared_class: Class, browser: Browser
) -> None:
    ana, luz = page_pair
    show_program_on_both(page_pair)
    teacher_pages = Pages(browser, shared_class.server.address)
    teacher = open_teacher_page(teacher_pages, shared_class)
    tile = teacher.locator("#wall li").filter(has_text="Red")
    tile.filter(has_text="Ana, Luz").wait_for()
    assert teacher.locator("#wall li").filter(has_text="Ana").count() == 1
    tile.locator("button.see").click()
    program = teacher.locator("#big_pupil pre").first
    program.filter(has_text="B(1, 40)").wait_for()
    go_to_line(luz, "B(1, 40)")
    for _ in range(4):
        luz.keyboard.press("Backspace")
    type_slowly(luz, "66)")
    luz.keyboard.press("ArrowDown")
    program.filter(has_text="B(1, 66)").wait_for()
    teacher.locator("#big_pupil pre").last.filter(has_text="Luz: → B(1, 66)").wait_for()
    assert ana.locator("#class_mates").inner_text() == "Luz"  # watching teachers are not listed
    teacher_pages.close()


def test_the_teacher_joins_and_leaves_a_group(
    page_pair: tuple[Page, Page], shared_class: Class, browser: Browser
) -> None:
    ana, luz = page_pair
    show_program_on_both(page_pair)
    teacher_pages = Pages(browser, shared_class.server.address)
    teacher = open_teacher_page(teacher_pages, shared_class)
    tile = teacher.locator("#wall li").filter(has_text="Red")
    tile.hover()
    tile.locator("button.join").click()
    teacher.locator("html[data-group=in]").wait_for(state="attached")
    teacher.locator("#note", has_text="You are editing Red’s program together.").wait_for()
    wait_for_lines(teacher, *ROWS)
    teacher.click("#view_text")
    go_to_line(teacher, "S;")
    type_slowly(teacher, "\nW(9)\n")
    for page in (ana, luz, teacher):
        wait_for_lines(page, "F(1, 80);", "LOOP(3);", "B(1, 40);", "END_LOOP;", "S;", "W(9);")
    ana.locator("#class_mates .mate", has_text="Teacher").wait_for()
    go_to_line(teacher, "B(1, 40)")
    type_slowly(teacher, " ")
    ana.locator(".cm-line", has_text="B(1, 40)").locator(".cm-mate-4").wait_for()
    teacher.reload()
    teacher.locator("html[data-group=in]").wait_for(state="attached")
    wait_for_lines(teacher, "F(1, 80);", "LOOP(3);", "B(1, 40);", "END_LOOP;", "S;", "W(9);")
    teacher.click("#run")
    teacher.locator("html[data-robot=none]").wait_for(state="attached")
    teacher.click("#class_leave")
    tile.wait_for()
    assert not teacher.locator("#class_leave").is_visible()
    until(lambda: ana.locator("#class_mates").inner_text() == "Luz", "the teacher has left")
    teacher_pages.close()
