"""Values have the names of their SHOWs, wherever a command prints, draws or writes them."""

from __future__ import annotations

import csv
import json
import signal
from pathlib import Path

import pytest

from tests.support.command import Command
from tests.support.pty_robot import PtyRobot, on
from tests.support.source_maps import compile_right_text, make_source_map
from tiniscript.base import files
from tiniscript.bytecode.disassembly import rows
from tiniscript.bytecode.image import checksum
from tiniscript.cli.robot.event_printer import EventPrinter
from tiniscript.cli.terminal.plot import STYLES, Plot
from tiniscript.library.events import EventReader
from tiniscript.link.outcomes import ShownEvent

LOOPS = "LOOP(FOREVER); SHOW({}); W(0.05); END_LOOP"


def list_names(json_output: str) -> list[str]:
    """Return the names of the values in JSON lines, or an empty text for a value without one."""
    events = [json.loads(line) for line in json_output.splitlines()]
    return [event.get("name", "") for event in events if event["event"] == "SHOW"]


def forget_maps() -> None:
    for path in (files.cache_folder() / "maps").glob("*.json"):
        path.unlink()


def test_upload_names_the_values_of_its_program(pty_robot: PtyRobot) -> None:
    pty_robot.ask(lambda robot: robot.set_readings(20_000, 60_000, 12_500))
    text = "SI|SHOW(DISTANCE); SHOW(light_r-light_l)\nSHOW(7)\nSHOW(DISTANCE)"
    result = on(pty_robot, "upload", "-e", text).gives(0)
    assert result.out.splitlines()[1:5] == [
        "DISTANCE (line 1) 12.5", "LIGHT_R - LIGHT_L -40", "SHOW 7", "DISTANCE (line 3) 12.5",
    ]  # fmt: skip
    result = on(pty_robot, "upload", "-e", text, "--lang", "es").gives(0)
    assert "DISTANCE (línea 3) 12.5\n" in result.out
    result = on(pty_robot, "upload", "-e", text, "--json").gives(0)
    events = [json.loads(line) for line in result.out.splitlines()]
    assert [event for event in events if event["event"] == "SHOW"] == [
        {"event": "SHOW", "value": 12.5, "name": "DISTANCE", "line": 1, "column": 4},
        {"event": "SHOW", "value": -40, "name": "LIGHT_R - LIGHT_L", "line": 1, "column": 20},
        {"event": "SHOW", "value": 7},
        {"event": "SHOW", "value": 12.5, "name": "DISTANCE", "line": 3, "column": 1},
    ]


def test_monitor_knows_a_program_by_its_checksum(pty_robot: PtyRobot, tmp_path: Path) -> None:
    """Also in the middle of a run; programs from elsewhere have no names.

    Values that the robot sends for an earlier client have no names until it has answered this one.
    """
    upload = ("upload", "-e", "SI|" + LOOPS.format("TIME > 1"), "--detach")
    on(pty_robot, *upload).gives(0)
    sheet = tmp_path / "rows.csv"
    result = on(pty_robot, "monitor", "--json", "--csv", sheet, "--max-time", "1").gives(0)
    names = list_names(result.out)
    known_names = names[names.index("TIME > 1") :]
    assert (
        len(known_names) > 5
        and set(known_names) == {"TIME > 1"}
        and not any(names[: -len(known_names)])
    )
    with sheet.open(encoding="utf-8", newline="") as file:
        head, *table = csv.reader(file)
    assert head == ["ms", "event", "value", "name"]
    assert [row[3] for row in table if row[1] == "SHOW"] == names
    forget_maps()
    result = on(pty_robot, "monitor", "--max-time", "1").gives(0)
    values = {line.split(" ", 1)[1] for line in result.out.splitlines()}
    assert values == {"SHOW TRUE"}
    on(pty_robot, "stop").gives(0)


def test_monitor_follows_the_program_of_the_button_and_one_that_replaces_it(
    pty_robot: PtyRobot,
) -> None:
    on(pty_robot, "upload", "-e", "SB|SHOW(LIGHT_R + 1); W(1)").gives(0)
    monitor = Command("monitor", "--port", pty_robot.port, "--json")
    assert monitor.process.stderr
    monitor.process.stderr.readline()  # waits until it watches
    pty_robot.push()
    monitor.until('"name": "LIGHT_R + 1"')
    for expression in ("LIGHT_L + 2", "DISTANCE + 3"):
        assert expression in on(pty_robot, "live", f"SHOW({expression})").gives(0).out
        monitor.until(f'"name": "{expression}"')
    monitor.signal(signal.SIGINT)
    monitor.wait_for_result().gives(0)


def event(text: str, number: int, program: int | None = None) -> ShownEvent:
    """Return the event of a SHOW of a text, by its place among them."""
    compilation = compile_right_text(text)
    places = [row.offset for row in rows(compilation.code) if row.text.startswith("SHOW")]
    return ShownEvent(
        2000, 0, 1, checksum(compilation.image) if program is None else program, places[number]
    )


def test_two_values_of_one_line_are_told_apart_in_a_table() -> None:
    text = "X = 1; SHOW(-X); SHOW(-X)"
    shown_names: list[str] = []
    table: list[tuple[object, ...]] = []
    compilation = compile_right_text(text)
    printer = EventPrinter(
        "en", program_map=make_source_map(compilation), checksum=checksum(compilation.image),
        print_line=shown_names.append, add_row=lambda *cells: table.append(cells),
    )  # fmt: skip
    for number in range(2):
        printer.print_event(0, event(text, number))
    printer.print_event(0, event(text, 0, program=1))
    assert shown_names == ["-X (line 1) 2", "-X (line 1) 2", "SHOW 2"]
    assert [row[3] for row in table] == ["'-X (line 1:8)", "'-X (line 1:18)", ""]


def test_the_library_names_values() -> None:
    compilation = compile_right_text("SHOW(DISTANCE)")
    reader = EventReader()
    robot_event = reader.to_robot_event(0, event("SHOW(DISTANCE)", 0, program=5))
    assert robot_event and dict(robot_event.values) == {"value": 2}
    reader.map_by_checksum[checksum(compilation.image)] = make_source_map(compilation)
    robot_event = reader.to_robot_event(0, event("SHOW(DISTANCE)", 0))
    assert robot_event and dict(robot_event.values) == {
        "value": 2,
        "name": "DISTANCE",
        "line": 1,
        "column": 1,
    }


def test_each_name_has_a_curve_of_its_own() -> None:
    plot = Plot()
    for k in range(40):
        plot.add_value(k * 100, 1000 * k, False, "DISTANCE")
        plot.add_value(k * 100, 500, False, "LIGHT_R - LIGHT_L")
    lines = plot.lines(90, 12, 4000)
    assert lines[0].plain.startswith("── DISTANCE 39  LIGHT_R - LIGHT_L 0.5 ──")
    assert lines[0].cell_len <= 88
    styles = {str(span.style) for line in lines[1:] for span in line.spans}
    assert {"cyan", "magenta"} <= styles
    plot.add_value(4000, 0, False)
    assert "SHOW 0" in plot.lines(90, 12, 4000)[0].plain


@pytest.mark.parametrize("width", [3, 20, 79])
def test_there_are_no_more_curves_than_colours(width: int) -> None:
    """The curve whose last value is oldest ends first; the others keep their colours."""
    plot = Plot()
    names = [f"X + {k}" for k in range(len(STYLES))]
    for k, name in enumerate(names):
        plot.add_value(k, 1000, False, name)
    style_by_name_before = dict(plot.style_by_name)
    plot.add_value(100, 1000, False, names[0])
    plot.add_value(200, 1000, True, "TIME > 1")
    assert [*plot.values_by_name] == [names[0], *names[2:], "TIME > 1"]
    assert plot.style_by_name["TIME > 1"] == style_by_name_before[names[1]]
    assert {name: plot.style_by_name[name] for name in names[2:]} == {
        n: style_by_name_before[n] for n in names[2:]
    }
    assert all(line.cell_len <= width for line in plot.lines(width, 9, 300))
