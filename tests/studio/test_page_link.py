"""The page and a robot through `tsc studio`: the robot's firmware is on a pty."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from itertools import product
from typing import TYPE_CHECKING, Any

import pytest

from tests.support import pty_robot as pty_robots
from tests.support import studio
from tests.support.page_link import (
    KIT,
    connect,
    events,
    first,
    first_robot,
    page,
    pages,
    robot,
    upload_until_it_runs,
    wait_for_message,
)
from tests.support.page_robot import running, wait_for_nothing_running, wait_for_running
from tests.support.page_screens import LOOK_SCRIPT, SCREENS
from tests.support.pty_robot import PtyRobot
from tests.support.sampling import sample_of
from tests.support.studio import (
    LONGEST_HANG_MS,
    Pages,
    axe,
    enter,
    hang,
    speak,
    start_drive,
    turn,
    wait_for,
    wait_for_blocks,
    wait_until_checked,
    write,
)
from tiniscript.link import known_ports
from tiniscript.studio import robot_link, serving

if TYPE_CHECKING:
    from playwright.sync_api import Page, Route

sampled = pytest.mark.sampled(of="details of a link", keep=4)

__all__ = ["first", "first_robot", "page", "pages", "robot"]  # fixtures

RUN_COUNT = 5
VOID_STOP_MESSAGE = "The robot was stopped first, so it"
BLINKING_MESSAGE = "The robot that blinks and plays its tune is"


def test_a_program_and_a_line_are_sent_and_run(page: Page, robot: PtyRobot) -> None:
    text = "SHOW(2.5);\nF(0.2, 80);\nSHOW(1 < 2)"
    write(page, text)
    count_before = len(robot.actions)
    page.click("#link_upload")
    wait_for_message(page, "Done.")
    assert page.locator("#link_shown").inner_text() == "2.5\n1 < 2 TRUE"
    assert "MOTORS 80 80" in robot.actions[count_before:]
    page.click("#link_send")
    wait_for_message(page, "The robot has the program. ")
    page.fill("#link_line", "SHOW(6 * 7)")
    page.keyboard.press("Enter")
    wait_for_message(page, "Done.")
    assert page.locator("#link_shown").inner_text() == "6 * 7 42"
    page.fill("#link_line", "F(2, 500)")
    page.keyboard.press("Enter")
    wait_for_message(page, "Try: ")
    assert not robot.moves
    write(page, "X = 0;\nF(0.1, 50);\nSHOW(1 / X)")
    page.click("#link_upload")
    wait_for_message(page, "Line 3: the program divided by 0.")
    page.locator(".cm-activeLine").filter(has_text="SHOW").wait_for()


def test_a_restart_of_the_robot_is_reported(page: Page, robot: PtyRobot) -> None:
    start_drive(page, robot)
    robot.switch_off()
    robot.switch_on()
    wait_for_message(page, "The robot restarted, which ended its program.")
    assert not robot.moves
    page.click("#link_upload")  # the connection continues
    wait_for_message(page, "The robot has the program")
    page.click("#stop")
    wait_for_message(page, "Stopped: the robot has confirmed the stop.")


def test_stop_stops(page: Page, robot: PtyRobot) -> None:
    """It stops by its button, by a key in the editor, and while the virtual robot is shown."""
    for stop_action in ("button", "Escape", "virtual"):
        start_drive(page, robot)
        if stop_action == "Escape":
            page.locator(".cm-content").focus()
            page.keyboard.press("Escape")
        else:
            page.click("#side_virtual" if stop_action == "virtual" else "#side_real")
            page.click("#stop")
        robot.until(lambda: not robot.moves, f"it stands: {stop_action}")
        page.click("#side_real")
        wait_for_message(page, "Stopped: the robot has confirmed the stop.")


def test_a_hanging_hidden_or_offline_page_stops_its_robot(
    first: tuple[Pages, Page], page: Page, robot: PtyRobot
) -> None:
    start_drive(page, robot)
    start_ms = robot.robot_ms
    hang(page, LONGEST_HANG_MS)
    assert robot.standstill_after_ms(start_ms) < 0.9 * LONGEST_HANG_MS
    wait_for_message(page, "Stopped")  # the page shows it after reconnecting
    start_drive(page, robot)
    page.evaluate(
        "Object.defineProperty(document, 'visibilityState', {value: 'hidden', configurable: true});"
        "document.dispatchEvent(new Event('visibilitychange'))"
    )
    robot.until(lambda: not robot.moves, "it stands")
    wait_for_message(page, "this page was hidden")
    page.evaluate("delete document.visibilityState")
    start_drive(page, robot)
    page.context.set_offline(True)
    robot.until(lambda: not robot.moves, "it stands")
    wait_for_message(page, "tsc studio has stopped responding")
    page.context.set_offline(False)
    errors = first[0].errors
    assert errors and all("ERR_INTERNET_DISCONNECTED" in error for error in errors)
    errors.clear()


@sampled
def test_two_tabs_do_not_compete_for_a_robot(
    first: tuple[Pages, Page], page: Page, robot: PtyRobot
) -> None:
    other_page = first[0].another(page)
    other_page.click("#side_real")
    other_page.locator("#link_port option").first.wait_for(state="attached")
    other_page.click("#link_connect")
    wait_for_message(other_page, "Another tab of this browser is driving this robot.")
    start_drive(page, robot)
    other_page.click("#stop")  # anyone who sees STOP may press it
    robot.until(lambda: not robot.moves, "it stands")
    other_page.close()
    while BLINKING_MESSAGE not in page.locator("#link_said").inner_text():
        page.click("#link_identify")  # refused for a moment after a STOP for all
        wait_for_message(page, re.compile(f"{VOID_STOP_MESSAGE}|{BLINKING_MESSAGE}"))


@sampled
def test_identify_name_and_trim_work(page: Page, robot: PtyRobot) -> None:
    page.click("#link_identify")
    wait_for_message(page, BLINKING_MESSAGE)
    page.click("#link_teacher summary")
    page.fill("#link_rename_to", "Ñandú")
    page.click("#link_rename")
    wait_for_message(page, "The robot is now called Ñandú.")
    assert page.locator("#link_name").inner_text() == "Ñandú"
    page.fill("#trim_balance", "-7")
    page.check("#trim_left")
    page.click("#trim_set")
    wait_for_message(page, "The robot has saved these settings.")
    pace = page.locator("#trim_pace")
    assert pace.inner_text() == "Its speed is estimated from its kit; tsc set trim measures it."
    page.click("#link_leave")
    wait_for_message(page, "Disconnected.")
    time.sleep(0.3)
    measured = ("--speed-40", "20", "--speed-80", "45", "--turn-40", "100", "--turn-80", "212.5")
    assert pty_robots.on(robot, "set", "trim", *measured).code == 0
    time.sleep(0.3)
    page.click("#link_connect")
    wait_for_message(page, "Connected: Ñandú.")
    page.locator("#trim_left:checked").wait_for(state="attached")
    assert page.input_value("#trim_balance") == "-7"
    page.click("#trim_set")  # leaves the pace
    wait_for_message(page, "The robot has saved these settings.")
    assert pace.inner_text() == (
        "It drives 20 cm per second at 40 %, and 45 at 80 %."
        " It turns 100 degrees per second at 40 %, and 212.5 at 80 %."
    )


@sampled
def test_every_element_is_visible_and_axe_finds_nothing(
    page: Page, robot: PtyRobot, pytestconfig: pytest.Config
) -> None:
    screens = sample_of(pytestconfig, "screens of a link", SCREENS, 2)
    for is_connected in (True, False):
        for language, (width, height) in product(("en", "es"), screens):
            page.set_viewport_size({"width": width, "height": height})
            speak(page, language)
            wait_until_checked(page)
            turn(page, "robot")
            assert page.evaluate(LOOK_SCRIPT) == [], (width, language, is_connected)
        if is_connected:
            page.click("#link_leave")
            page.locator("#link_connect").wait_for()
    speak(page, "en")
    connect(page, robot)
    page.click("#link_teacher summary")
    assert axe(page) == []


def test_no_text_of_a_robot_becomes_markup(page: Page, robot: PtyRobot) -> None:
    page.evaluate("window.before = document.querySelectorAll('script, b, img').length")
    robot.say(b"<script>window.taken = 1</script>\r\n<b>\x1b[2J\xe2\x80\xae\r\n")
    page.locator("#link_shown").filter(has_text="<script>").wait_for()
    assert "\x1b" not in page.locator("#link_shown").inner_text()
    page.click("#link_teacher summary")
    page.fill("#link_rename_to", "<b>x</b>")
    page.click("#link_rename")
    wait_for_message(page, "The robot is now called <b>x</b>.")
    assert page.evaluate("document.querySelectorAll('script, b, img').length === window.before")
    assert not page.evaluate("'taken' in window")
    page.click("#link_leave")
    known_ports.remember(robot.port, "<img src=x onerror=1>")
    page.click("#link_look")
    page.locator("#link_port option").filter(has_text="<img").wait_for(state="attached")
    assert page.locator("#link_port option use").first.get_attribute("href") == "#drawn_plug"
    assert page.locator("#link img").count() == 0


def test_the_reason_for_a_failed_connection_is_shown(pages: Pages) -> None:
    with PtyRobot(KIT) as robot:
        known_ports.remember(robot.port, "TINI")
        page = pages.open()
        speak(page, "es")
        robot.switch_off()
        page.click("#side_real")
        page.locator("#link_port option").first.wait_for(state="attached")
        page.click("#link_connect")
        wait_for_message(page, "Nada responde.")
        robot.switch_on()
        page.click("#link_connect")
        wait_for_message(page, "Conectado")
        robot.pull()
        wait_for_message(page, "cable")


@sampled
def test_the_token_is_not_in_the_address(page: Page, server: serving.Server) -> None:
    assert page.evaluate("location.href") == server.address + "#editor"
    page.reload()
    wait_until_checked(page)
    page.click("#side_real")
    assert page.locator("#link_ports").is_visible()  # a tab keeps it


def test_running_a_wrong_program_stops_the_current_run(page: Page, robot: PtyRobot) -> None:
    start_drive(page, robot)
    write(page, "F(2, 80")
    with page.expect_request(lambda request: '"do":"stop"' in (request.post_data or "")):
        page.click("#link_upload")
    robot.until(lambda: not robot.moves, "it stands")
    wait_for_message(page, "The robot was stopped. Fix the program first.")


def test_an_address_grants_access_once_per_run_of_tsc_studio(
    pages: Pages, server: serving.Server, robot: PtyRobot
) -> None:
    """A closed page stops its robot."""
    entrance = server.entrance()
    first, second = pages.visit(entrance), pages.visit(entrance)
    studio.wait_for_note(second, "This address has already been used")
    assert first.locator("#note").inner_text() == ""
    for opened_page, has_robots in ((first, True), (second, False)):
        opened_page.click("#side_real")
        assert opened_page.locator("#link_ports").is_visible() is has_robots
    connect(first, robot)
    start_drive(first, robot)
    start_ms = robot.robot_ms
    first.close()
    assert robot.standstill_after_ms(start_ms) < 0.9 * LONGEST_HANG_MS
    second.evaluate("sessionStorage.setItem('tiniscript.token', '0'.repeat(32))")
    enter(second, server.address)
    second.click("#side_real")
    wait_for_message(second, "tsc studio was restarted")
    assert [error for error in pages.errors if "403" not in error] == []
    pages.errors.clear()


@sampled
def test_values_of_the_robot_have_the_names_of_their_shows(page: Page) -> None:
    """This holds next to another text, too; a line of the same code has its own names."""
    shown_element = page.locator("#link_shown")
    write(page, "X = 3;\nSHOW(X);\nSHOW(DISTANCE < -1);\nSHOW(x);\nW(1)")
    upload_until_it_runs(page)
    write(page, "S")
    wait_for_message(page, "Done.")
    assert shown_element.inner_text() == "X (line 2) 3\nDISTANCE < -1 FALSE\nX (line 4) 3"
    for line in ("NEAR = 4; SHOW(NEAR)", "FAR = 4; SHOW(FAR)"):
        page.fill("#link_line", line)
        page.keyboard.press("Enter")
        wait_for_message(page, "Done.")
        shown_element.filter(has_text=f"{line.split()[0]} 4").wait_for()


@sampled
def test_a_run_keeps_its_names_until_the_next_program_starts(page: Page) -> None:
    """The next one has the same code, and is sent before the last values of the one before come."""
    shown_element = page.locator("#link_shown")
    late_news: list[dict[str, Any]] = []
    has_begun: list[bool] = []

    def hold(route: Route) -> None:
        response = route.fetch()
        answer = response.json()
        news = answer.get("news", [])
        if any(item.get("event") == "STARTED" for item in news):
            news[:0] = late_news
            has_begun.append(True)
        elif not has_begun:
            values = [item for item in news if item.get("event") == "SHOW"]
            answer["news"] = [item for item in news if item not in values]
            late_news.extend(
                {key: value[key] for key in value if key != "number"} for value in values
            )
        route.fulfill(response=response, json=answer)

    write(page, "NEAR = 4;\nLOOP(FOREVER);\nSHOW(NEAR);\nW(0.1);\nEND_LOOP")
    upload_until_it_runs(page)
    shown_element.filter(has_text="NEAR 4").wait_for()
    page.route("**/robots", hold)
    wait_for(page, lambda: len(late_news) > 2, "values are held back")
    write(page, "FAR = 4;\nLOOP(FOREVER);\nSHOW(FAR);\nW(0.1);\nEND_LOOP")
    upload_until_it_runs(page)
    shown_element.filter(has_text="FAR 4").wait_for()
    names = [line.split()[0] for line in shown_element.inner_text().splitlines()]
    assert names[: len(late_news)] == ["NEAR"] * len(late_news), names
    page.unroute_all(behavior="wait")
    page.click("#stop")
    wait_for_message(page, "Stopped: the robot has confirmed the stop")


@sampled
def test_a_line_and_a_lost_link_do_not_change_a_recording(page: Page) -> None:
    write(page, "SHOW(5);\nW(60);\nSHOW(6)")
    upload_until_it_runs(page)
    page.locator("#record_play:visible").wait_for()
    page.click("#stop")
    wait_for_message(page, "stopped")
    page.fill("#link_line", "SHOW(7)")
    page.keyboard.press("Enter")
    wait_for_message(page, "Done.")
    assert events(page) == ["SHOW 5", "STOPPED"]
    upload_until_it_runs(page)
    page.locator("#record_play:visible").wait_for()
    page.click("#link_leave")
    page.locator("#link_ways").wait_for()
    assert events(page) == ["SHOW 5", "LOST"]


@sampled
def test_a_program_of_the_button_is_recorded_from_its_first_event(
    page: Page, robot: PtyRobot
) -> None:
    write(page, "SB|SHOW(5);\nW(0.5);\nSHOW(6)")

    def run() -> None:
        upload_until_it_runs(page)
        page.wait_for_timeout(700)
        robot.push()
        wait_for_message(page, "Done.")

    record_until_same(page, run)
    assert events(page) == ["SHOW 5", "SHOW 6", "DONE"]


def test_a_recording_contains_the_programs_readings(page: Page) -> None:
    """Therefore calculations from it are the same on the virtual robot, in another world."""
    write(page, "X = LIGHT_L + 5;\nSHOW(X);\nSHOW(X + LIGHT_R)")

    def run() -> None:
        upload_until_it_runs(page)
        wait_for_message(page, "Done.")

    record_until_same(page, run)
    recorded = events(page)
    assert sorted(recorded)[:2] == ["DONE", "READ LIGHT_L 0"] and "READ LIGHT_R 0" in recorded
    assert page.locator("#record_lacks").is_hidden()


def test_missing_reading_reports_are_noted_if_the_program_reads_sensors(
    page: Page, robot: PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(robot_link, "READINGS", 0)
    page.click("#link_leave")
    page.locator("#link_ways").wait_for()
    connect(page, robot)
    note = page.locator("#record_lacks")
    for text, is_told in (("SHOW(1)", False), ("X = LIGHT_L;SHOW(X)", True)):
        write(page, text)
        upload_until_it_runs(page)
        wait_for_message(page, "Done.")
        assert note.is_visible() is is_told
        assert [event for event in events(page) if event.startswith("READ")] == []
    assert note.inner_text().startswith("This robot does not report what its program reads")


def record_until_same(page: Page, run: Callable[[], None]) -> None:
    """Record runs until one agrees with the virtual robot: a busy computer hears of some late."""
    doing = page.locator("#doing")
    for _ in range(RUN_COUNT):
        page.click("#side_real")
        run()
        page.click("#record_play")
        doing.filter(has_text=re.compile("Values compared|times differ")).wait_for()
        if "times differ" not in doing.inner_text():
            break
    assert doing.inner_text() == "Both robots did the same. Values compared: 3."


@sampled
def test_a_run_is_recorded_and_replayed_beside_the_virtual_robot(page: Page) -> None:
    write(page, "SHOW(DISTANCE);\nF(0.2, 80);\nSHOW(5);\nW(0.1)")

    def run() -> None:
        page.click("#link_upload")
        wait_for_message(page, "Done.")

    record_until_same(page, run)
    assert events(page)[-2:] == ["SHOW 5", "DONE"]
    write(page, "SHOW(6)")
    page.click("#record_play")  # the recording has its own program
    page.locator(".cm-content", has_text="SHOW(DISTANCE)").wait_for()
    page.locator("#doing", has_text="Values compared: 3.").wait_for()
    page.click("#side_real")


# -- the line and the block that the robot runs now


DRIVE_PROGRAM = "F(3, 80);\nR(3, 60)"  # parts that differ, and longer than a busy page is late


def wait_for_no_mark(page: Page) -> None:
    wait_for_nothing_running(page)
    page.locator("#blocks .running").wait_for(state="detached")


@pytest.mark.usefixtures("no_page_timeouts")
@sampled
def test_the_line_that_runs_is_marked_until_the_end(page: Page) -> None:
    write(page, DRIVE_PROGRAM)
    page.click("#view_blocks")
    wait_for_blocks(page)
    page.click("#link_upload")
    for part in DRIVE_PROGRAM.split(";\n"):
        wait_for_running(page, part)
        assert page.locator("#blocks .blocklyDraggable.running").count() == 1
    page.click("#view_text")
    wait_for_message(page, "Done.")
    wait_for_no_mark(page)


@sampled
def test_an_edit_removes_the_mark_and_its_undo_restores_it(page: Page) -> None:
    write(page, "F(600, 80)")
    page.click("#link_upload")
    wait_for_running(page)
    page.locator(".cm-content").focus()
    page.keyboard.press("Control+End")
    page.keyboard.insert_text(";\nW(1)")
    wait_for_no_mark(page)
    wait_until_checked(page)
    wait_for_no_mark(page)
    page.keyboard.press("Control+z")
    wait_for_running(page)
    page.click("#link_leave")
    wait_for_no_mark(page)


def upload_until_told(page: Page, place: int) -> None:
    """Upload, and wait until the page has been told `place` instead of the robot's place."""
    places: list[int] = []

    def change_places(route: Route) -> None:
        response = route.fetch()
        answer = response.json()
        for item in answer.get("news", []):
            if item.get("event") == "PLACE":
                item["at"] = place
                places.append(item["at"])
        route.fulfill(response=response, json=answer)

    page.route("**/robots", change_places)
    page.click("#link_upload")
    wait_for(page, lambda: places, "a place is told")
    page.unroute_all(behavior="wait")
    page.wait_for_timeout(200)


@sampled
def test_a_place_outside_the_program_marks_nothing(page: Page) -> None:
    write(page, "F(60, 80)")
    upload_until_told(page, 60_000)
    assert running(page) == ""


@sampled
def test_the_robot_whose_side_is_open_is_marked(page: Page) -> None:
    """Both are held at the first line, then one continues, then the other one."""
    first_row, second_row = "W(0.1)", "F(60, 80)"
    write(page, f"{first_row};\n{second_row}")
    page.click("#side_virtual")
    breakpoint = page.locator(".cm-lineNumbers .cm-gutterElement").filter(has_text="1").last
    breakpoint.click()
    page.click("#run")
    page.locator("#doing").filter(has_text="Stopped before line 1.").wait_for()
    page.click("#side_real")
    page.click("#link_upload")
    page.locator("html[data-halt='read']").wait_for()
    wait_for_running(page, first_row)
    page.click("#link_go_on")
    wait_for_running(page, second_row)
    page.click("#side_virtual")
    wait_for_running(page, first_row)
    page.click("#pause")  # continues
    wait_for_running(page, second_row)
    page.click("#stop")
    breakpoint.click()  # no later program is to halt
    page.click("#side_real")
    page.click("#link_upload")
    wait_for_running(page, second_row)
    page.click("#link_leave")
    wait_for_no_mark(page)
