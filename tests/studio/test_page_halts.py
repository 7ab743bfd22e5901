"""Breakpoints, steps and values of a real robot in the page: as on the virtual one."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest

from tests.support.page_breakpoints import COUNTING_PROGRAM, press_margin
from tests.support.page_link import (
    connect,
    first,
    first_robot,
    page,
    pages,
    robot,
    wait_for_message,
)
from tests.support.page_robot import running
from tests.support.pty_robot import PtyRobot
from tests.support.silent_serial import SILENT_SERIAL
from tests.support.studio import (
    UPLOADS,
    Pages,
    enter,
    wait_for,
    wait_for_blocks,
    wait_until_checked,
    write,
)
from tiniscript import robots
from tiniscript.flash.ready import title_of
from tiniscript.studio import robot_link
from tiniscript.studio.checking import check
from tiniscript.studio.simulation import Marks, Simulation
from tiniscript.virtual import worlds

if TYPE_CHECKING:
    from playwright.sync_api import Page, Route

pytestmark = pytest.mark.usefixtures("no_page_timeouts")
sampled = pytest.mark.sampled(of="details of halts", keep=2)

__all__ = ["first", "first_robot", "page", "pages", "robot"]  # fixtures
MERGED_PROGRAM = "LOOP(2);\nDISTANCE;\nIF(DISTANCE < 10);\nSTOP;\nENDIF;\nW(0.05);\nEND_LOOP"
# A program, and the lines of its breakpoints.
PROGRAMS = {
    "loop": (COUNTING_PROGRAM, (5,)),
    "first and last": ("N = 2;\nFAR = 3 > N;\nF(0.05, 60);\nSHOW(FAR);\nN = N / 4", (1, 5)),
    "DEF": ("DEF TWICE(A);\nSHOW(A + A);\nEND_DEF;\nX = 4;\nTWICE(X);\nTWICE(X / 8)", (2, 5)),
    "UNTIL": ("K = 0;\nLOOP(3);\nK = K + 1;\nF(0.2, 80) UNTIL(K > 2);\nEND_LOOP;\nSHOW(K)", (4, 6)),
    "joined": (MERGED_PROGRAM, (3, 6)),
    "many": ("".join(f"V{k} = {k} / 8;\n" for k in range(30)) + "SHOW(V3);\nW(0.05)", (32,)),
}


@pytest.fixture(autouse=True)
def at_rest(page: Page, robot: PtyRobot) -> Iterator[None]:
    robot.ask(lambda robot: robot.set_readings(0, 0, 42_000))
    page.click("#view_text")
    yield
    page.click("#stop")
    write(page, "W(0)")


def write_with_breakpoints(page: Page, text: str, lines: tuple[int, ...]) -> None:
    write(page, text)
    for line in lines:
        press_margin(page, line)


def is_halted(page: Page) -> bool:
    """Wait for the next halt, and its message; return False if the program has ended."""
    halt = page.locator("html[data-halt=read]")
    halt.or_(page.locator("html[data-halt=none]")).wait_for(state="attached")
    return halt.count() == 1


def state_of(page: Page, variables: int) -> tuple[str, list[str]]:
    """Return the marked text, and the values of the variables."""
    values = page.locator("#link_values:not(.past) dd").all_inner_texts()
    return running(page), values[:variables]


def list_halts(
    page: Page, start_selector: str, button: str, text: str
) -> list[tuple[str, list[str]]]:
    """Go from halt to halt, to the end; return the state at each. Repeated if a busy computer kept
    the page silent until its robot was stopped.
    """
    variables = len(check(text.encode(), "tinibot", "en").variables)
    for _ in range(UPLOADS):
        wait_for_halt = []
        page.click(start_selector)
        page.locator("html[data-halt=read]").wait_for(state="attached")
        while is_halted(page):
            wait_for_halt.append(state_of(page, variables))
            page.click(button)
        wait_for_message(page, re.compile(r"Done\.|[Ss]topped"))
        if "Done." in page.locator("#link_said").inner_text():
            return wait_for_halt
    raise AssertionError(f"stopped {UPLOADS} times")


def virtual_states(text: str, lines: tuple[int, ...], steps: bool) -> list[tuple[str, list[str]]]:
    """Return the state of the virtual robot in the same form."""
    program = check(text.encode(), "tinibot", "en")
    rows = text.split("\n")
    expected_places = [
        next(place for place in program.places if place.line == line) for line in lines
    ]
    expected_spans = {place[1:3] for place in expected_places}
    break_offsets = tuple(place.offset for place in program.places if place[1:3] in expected_spans)
    parts = tuple(place.offset for place in program.places)
    marks = Marks(parts, break_offsets, len(program.variables), is_held=steps)
    simulation = Simulation("tinibot", worlds.load("obstacles"), program.image, marks)
    wait_for_halt = []
    while simulation.robot.is_running:
        if simulation.held_at is None:
            simulation.advance(1)
            continue
        state = simulation.state()
        place = max(place for place in program.places if place.offset <= state["at"])
        is_block = place.end_line > place.line
        line = rows[place.line - 1]
        part = line[place.column - 1 : None if is_block else place.end_column - 1]
        values = [
            ("TRUE" if value else "FALSE") if variable.is_yes_no else f"{value:g}"
            for variable, value in zip(program.variables, state["variables"], strict=True)
        ]
        wait_for_halt.append((part, values))
        if steps:
            simulation.step(60_000)
        else:
            simulation.go_on()
            simulation.advance(1)
    return wait_for_halt


@pytest.mark.sampled("name")
@pytest.mark.parametrize("name", PROGRAMS)
def test_halts_and_values_match_the_virtual_robot(page: Page, name: str) -> None:
    text, lines = PROGRAMS[name]
    write_with_breakpoints(page, text, lines)
    expected = virtual_states(text, lines, steps=False)
    assert list_halts(page, "#link_upload", "#link_go_on", text) == expected


@pytest.mark.sampled("name")
@pytest.mark.parametrize("name", PROGRAMS)
def test_a_step_goes_to_the_next_part_of_the_program(page: Page, name: str) -> None:
    """It begins at the first part. Two parts joined by the compiler are one step."""
    text, _ = PROGRAMS[name]
    write_with_breakpoints(page, text, ())
    expected = [row for row in virtual_states(text, (), steps=True) if row[0] != "DISTANCE"]
    assert list_halts(page, "#link_step", "#link_step", text) == expected


def wait_for_halt(page: Page, line: int) -> None:
    wait_for_message(page, f"Stopped before line {line}.")
    page.locator("html[data-halt=read]").wait_for(state="attached")


@sampled
def test_a_halt_reports_where_the_other_tasks_are(page: Page) -> None:
    tasks = "TASK;\nW(0.5);\nEND_TASK;\nTASK;\nF(0.5, 50);\nEND_TASK;\n"
    write_with_breakpoints(
        page, tasks + "TASK;\nW(0.05);\nB(1, 60);\nEND_TASK;\nW(0.1);\nN = 3;\nS", (13,)
    )
    page.click("#link_upload")
    wait_for_halt(page, 13)
    assert page.locator("#link_values div").all_inner_texts() == [
        "N\n3",
        "task on line 2\nwaiting",
        "task on line 5\nusing the motors",
        "task on line 9\nwaiting for the motors",
    ]


@sampled
def test_a_halt_and_a_fault_name_blocks_where_they_are_seen(page: Page) -> None:
    """The same ones, whatever has been built since."""
    text = "TASK;\nW(0.5);\nEND_TASK;\nZ = 0;\nW(0.05);\nF(0.05, 60);\nSHOW(2 / Z)"
    write_with_breakpoints(page, text, (6,))
    page.click("#view_blocks")
    wait_for_blocks(page)
    page.click("#link_upload")
    wait_for_message(page, "Stopped before “forward 0.05 s at 60 %”.")
    page.locator("html[data-halt=read]").wait_for(state="attached")
    tasks = page.locator("#link_values div").filter(has_text="task")
    assert tasks.all_inner_texts() == ["task at “wait 0.5 s”\nwaiting"]
    page.click("#view_text")
    wait_for_message(page, "Stopped before line 6.")
    assert tasks.all_inner_texts() == ["task on line 2\nwaiting"]
    write(page, "// a note\n" + text)
    page.click("#view_blocks")
    wait_for_message(page, "Stopped before “forward 0.05 s at 60 %”.")
    page.click("#link_go_on")
    wait_for_message(page, re.compile("^“show …”: "))


LOOP_PROGRAM = "SHOW(1);\nLOOP(FOREVER);\nF(0.05, 80);\nSHOW(2);\nEND_LOOP"


@sampled
def test_a_breakpoint_is_set_and_removed_while_the_robot_runs(page: Page, robot: PtyRobot) -> None:
    """It stays while the text changes; a waiting or restarted program has it too."""
    write_with_breakpoints(page, LOOP_PROGRAM, ())
    page.click("#link_upload")
    robot.until(lambda: robot.moves, "it drives")
    press_margin(page, 4)
    wait_for_halt(page, 4)
    page.locator(".cm-content").focus()
    page.keyboard.press("Control+Home")
    page.keyboard.insert_text("W(0);\n")
    wait_until_checked(page)
    page.click("#link_go_on")
    wait_for_halt(page, 4)  # line of its own text
    press_margin(page, 5)
    page.click("#link_go_on")
    robot.until(lambda: robot.moves, "it drives")
    page.wait_for_timeout(500)
    assert page.locator("html[data-halt=running]").count()
    page.click("#stop")
    wait_for_message(page, "Stopped: ")
    press_margin(page, 5)
    page.click("#link_send")
    wait_for_message(page, "The robot has the program")
    page.click("#link_start")
    wait_for_halt(page, 5)


@sampled
def test_a_line_run_in_between_removes_no_breakpoint(page: Page) -> None:
    write_with_breakpoints(page, "W(0.1);\nSHOW(1);\nSHOW(2)", (3,))
    page.click("#link_upload")
    wait_for_halt(page, 3)
    page.click("#link_go_on")
    wait_for_message(page, "Done.")
    page.fill("#link_line", "SHOW(6 * 7)")
    page.keyboard.press("Enter")
    page.locator("#link_shown").filter(has_text="42").wait_for()
    wait_for_message(page, "Done.")
    page.click("#link_start")
    wait_for_halt(page, 3)


@sampled
def test_a_robot_gets_the_first_four_breakpoints(page: Page) -> None:
    write_with_breakpoints(page, "SHOW(1);\nSHOW(2);\nSHOW(3);\nSHOW(4);\nSHOW(5)", (1, 2, 3, 4, 5))
    page.click("#link_upload")
    note = page.locator("#link_breakpoints")
    assert "at the first 4" in note.inner_text()
    for line in (1, 2, 3, 4):
        wait_for_halt(page, line)
        page.click("#link_go_on")
    wait_for_message(page, "Done.")
    press_margin(page, 1)
    note.wait_for(state="hidden")


@sampled
def test_a_robot_that_cannot_halt_is_reported_and_runs(
    page: Page, robot: PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    note = page.locator("#link_breakpoints")
    with monkeypatch.context() as patch:
        patch.setattr(robot_link, "BREAKPOINTS", 0)
        connect_again(page, robot)
        write(page, "SHOW(1);\nSHOW(2)")
        assert note.is_hidden()
        press_margin(page, 2)
        assert "This robot cannot stop at breakpoints." in note.inner_text()
        page.click("#link_upload")
        wait_for_message(page, "Done.")
        page.click("#link_step")
        wait_for_message(page, "This robot cannot stop at breakpoints.")
    connect_again(page, robot)
    assert note.is_hidden()


HALTING_TITLE = title_of(robots.load("tinibot"), True)
OFFERED_FIRMWARES = [
    ("tinibot", "nano"), ("tinibot", "uno"), (HALTING_TITLE, "uno"),
    ("liner", "nano"),
]  # fmt: skip


@sampled
def test_a_robot_that_cannot_halt_is_offered_a_firmware_that_can(
    page: Page, pages: Pages, robot: PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No breakpoint is set yet. What it leaves out is said before anything is written, and another
    board or robot has no such firmware here."""
    monkeypatch.setattr(robot_link, "BREAKPOINTS", 0)
    leave_link(page)
    other_page = pages.blank(is_alone=True)
    rows = [
        {"title": title, "board": board, "file": f"{title}-{board}-digest.hex"}
        for title, board in OFFERED_FIRMWARES
    ]
    questions: list[str] = []
    other_page.route("**/firmware.json", lambda route: route.fulfill(json=rows))
    other_page.route("**/*.hex", lambda route: route.fulfill(body=":00"))
    other_page.on("request", lambda request: questions.append(request.url.rpartition("/")[2]))
    other_page.add_init_script(SILENT_SERIAL)
    enter(other_page, pages.entrance())
    other_page.click("#view_text")
    connect(other_page, robot)
    write(other_page, "SHOW(1);\nSHOW(2)")
    offered_element = other_page.locator("#link_get_halting")
    assert offered_element.is_hidden()
    press_margin(other_page, 2)
    offered_element.wait_for()
    press_margin(other_page, 2)
    offered_element.wait_for(state="hidden")
    press_margin(other_page, 2)
    offered_element.click()
    wait_for_message(other_page, "but no longer reads typed text")
    assert other_page.locator("html[data-robot=none]").count() == 1
    assert other_page.locator("#flash_halts").is_checked()
    assert other_page.input_value("#flash_board") == "uno"
    assert not [name for name in questions if name.endswith(".hex")]
    other_page.click("#flash_write")
    wait_for_message(other_page, "That is not a complete HEX file")
    assert [name for name in questions if name.endswith(".hex")] == [
        f"{HALTING_TITLE}-uno-digest.hex"
    ]
    other_page.select_option("#flash_board", "nano")
    other_page.locator("#flash_halts").wait_for(state="hidden")
    assert not other_page.locator("#flash_halts").is_checked()
    other_page.select_option("#flash_board", "uno")
    other_page.locator("#flash_halts").wait_for()
    other_page.select_option("#robot", "liner")
    other_page.locator("#flash_halts").wait_for(state="hidden")
    connect(page, robot)


def leave_link(page: Page) -> None:
    page.click("#link_leave")
    page.locator("html[data-robot=none]").wait_for(state="attached")


def connect_again(page: Page, robot: PtyRobot) -> None:
    leave_link(page)
    connect(page, robot)


@pytest.mark.sampled("end_kind", keep=2)
@pytest.mark.parametrize("end_kind", ["stop", "Escape", "button", "restart"])
def test_a_halted_program_ends_like_a_running_one(
    page: Page, robot: PtyRobot, end_kind: str
) -> None:
    write_with_breakpoints(page, LOOP_PROGRAM, (4,))
    page.click("#link_upload")
    wait_for_halt(page, 4)
    if end_kind == "stop":
        page.click("#stop")
    elif end_kind == "Escape":
        page.keyboard.press("Escape")
    elif end_kind == "button":
        robot.push()
    else:
        robot.power_cycle()
    wait_for_message(page, re.compile("Stopped: |was stopped with its button|The robot restarted"))
    page.locator("html[data-halt=none]").wait_for(state="attached")
    assert page.locator("#link_values").is_hidden() and running(page) == ""
    assert page.locator("#link_go_on").is_disabled() and page.locator("#link_step").is_enabled()


@pytest.mark.parametrize("end_kind", ["upload", "break"])
def test_a_program_stopped_during_upload_never_starts(
    page: Page, robot: PtyRobot, end_kind: str
) -> None:
    """Its places come between the program and its start."""
    write_with_breakpoints(page, LOOP_PROGRAM, (4,))
    count_before = len(robot.actions)
    presses: list[bool] = []

    def press(route: Route) -> None:
        questions = [
            request["do"] for request in (route.request.post_data_json or {}).get("asked", [])
        ]
        response = route.fetch()
        if end_kind in questions and not presses:
            presses.append(True)
            page.evaluate("document.getElementById('stop').click()")
        route.fulfill(response=response)

    page.route("**/robots", press)
    page.click("#link_upload")
    wait_for(page, lambda: presses, "it is on its way")
    wait_for_message(page, re.compile("Stopped: |stopped"))
    page.wait_for_timeout(1000)
    page.unroute_all(behavior="wait")
    assert "MOTORS 80 80" not in robot.actions[count_before:]


@pytest.mark.long
def test_a_recording_does_not_include_the_time_of_halts(page: Page) -> None:
    write_with_breakpoints(page, "SHOW(1);\nW(0.3);\nSHOW(2);\nW(0.3);\nSHOW(3)", (3,))
    page.click("#link_upload")
    wait_for_halt(page, 3)
    page.wait_for_timeout(2500)
    page.click("#link_go_on")
    wait_for_message(page, "Done.")
    page.click("#runs_open" if page.locator("#runs_open").is_visible() else "#side_virtual")
    page.click("#runs_open")
    rows = page.locator("#runs_list li").all_inner_texts()
    page.click("#runs_close")
    assert rows and float(re.findall(r"([\d.]+) s", rows[0])[0]) < 2, rows
