"""Programs with tasks sent to a robot: one without tasks refuses them with a message."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

import tiniscript
from tests.support.command import CommandResult, run_in_process
from tiniscript import robots
from tiniscript.studio import checking, page_lessons, playing, recordings, robot_link

ROBOT = "liner"  # on a Nano
TEXT = "SHOW(1)\nWHEN(BUTTON)\n  S\nEND_WHEN\n"
WORDS = {"en": "does not support TASK and WHEN", "es": "no tiene TASK ni WHEN"}


@pytest.fixture
def program(tmp_path: Path) -> Path:
    path = tmp_path / "two.ts"
    path.write_text(TEXT, encoding="utf-8")
    return path


def reports_no_tasks(result: CommandResult, language: str = "en", advice: str = "tsc run") -> bool:
    output = result.out + result.err
    return result.code == 1 and WORDS[language] in output and advice in output


@pytest.mark.parametrize("verb", [("upload",), ("compile", "--text")])
def test_a_text_is_refused_at_its_task(program: Path, verb: tuple[str, ...]) -> None:
    result = run_in_process(*verb, program, "--robot", ROBOT, "--lang", "es")
    assert reports_no_tasks(result, "es", "tinibot") and "línea 2:" in result.out + result.err


def test_a_reader_without_tasks_is_distinguished_from_a_robot_without_them(program: Path) -> None:
    """An Uno runs compiled programs."""
    result = run_in_process("check", "--text-level", "uno", program, "--robot", ROBOT)
    output = result.out + result.err
    assert (result.code, "TS313" in output, output.count("[TS308]")) == (1, False, 1)
    assert "line 2:" in output and "tsc upload" in output
    for level in ("mega", "esp32"):
        assert run_in_process("check", "--text-level", level, program, "--robot", ROBOT).code == 0
    assert run_in_process("check", program, "--robot", ROBOT).code == 0


def test_an_image_and_a_live_line_are_refused(program: Path) -> None:
    compiled = program.with_suffix(".bin")
    assert run_in_process("compile", program, "--robot", ROBOT, "-o", compiled).code == 0
    assert reports_no_tasks(
        run_in_process("upload", compiled, "--robot", ROBOT, "--lang", "es"), "es"
    )
    assert reports_no_tasks(run_in_process("live", "TASK;S;END_TASK", "--robot", ROBOT))


def test_commands_that_send_nothing_accept_tasks(program: Path) -> None:
    for verb in (("check",), ("fmt",), ("show",), ("run", "--max-time", "0.01")):
        result = run_in_process(*verb, program, *(() if verb == ("fmt",) else ("--robot", ROBOT)))
        assert (result.code, WORDS["en"] in result.err) == (0, False)


def test_the_library_sends_no_tasks() -> None:
    program = tiniscript.compile(TEXT, ROBOT)
    with tiniscript.virtual_robot(ROBOT, hurry=math.inf) as robot:
        for send in (robot.upload, robot.live):
            for form in (program, TEXT, program.image):
                if send == robot.upload or isinstance(form, str):
                    with pytest.raises(tiniscript.RobotError) as error_info:
                        send(cast("str", form))
                    assert error_info.value.reason == "UNKNOWN_NEEDS"
                    assert "tsc run" in str(error_info.value)
        robot.upload("SHOW(2)")  # the others had no effect
        assert [event.values for event in robot.events() if event.name == "SHOW"] == [{"value": 2}]


@pytest.mark.parametrize("robot_name", ["tinibot", "grabber", "tinibot32"])
@pytest.mark.parametrize("sent", ["upload", "live"])
def test_robots_with_tasks_run_them(sent: str, robot_name: str) -> None:
    """A stop ends all tasks; and the robot has the image that the compiler makes."""
    text = "SHOW(7);TASK;SHOW(8);F(FOREVER, 60);END_TASK;WHEN(FALSE);END_WHEN"
    with tiniscript.virtual_robot(robot_name, hurry=math.inf) as robot:
        receipt = getattr(robot, sent)(text)
        assert receipt.checksum == tiniscript.compile(text, robot_name).checksum
        shown_values = []
        for event in robot.events(timeout=60):
            shown_values += [event.values["value"]] if event.name == "SHOW" else []
            if shown_values == [7, 8]:
                robot.stop()
        assert (shown_values, robot.wait().name) == ([7, 8], "STOPPED")
        getattr(robot, sent)("W(0.1);SHOW(1 / (TIME - TIME));WHEN(TRUE);S;END_WHEN")
        fault = robot.wait().fault
        assert fault is not None and (fault.name, fault.column) == ("DIVIDE_BY_ZERO", 8)


def test_the_studio_neither_sends_nor_simulates_tasks() -> None:
    result = checking.check(TEXT.encode(), ROBOT, "es")
    assert result.image == b""
    message = result.findings[-1].message
    assert WORDS["es"] in message.message and (message.code, message.line) == ("TS313", 2)
    line = checking.line_for_robot(TEXT.encode(), ROBOT, "es")
    assert not isinstance(line, str) and (line.code, line.line) == ("TS308", 2)
    check = page_lessons.LessonCheck(1, TEXT.encode(), "es")
    assert check.advance(1000)["verdict"] == page_lessons.MISTAKES


@pytest.mark.parametrize("do", ["upload", "live"])
def test_an_image_with_tasks_sent_by_a_page_is_refused(do: str) -> None:
    kit = robots.load(ROBOT).kit.fingerprint
    robot = SimpleNamespace(kit=kit)
    connection: Any = SimpleNamespace(
        robot=robot,
        boot=0,
        holder_verb="",
        enable_place_events=lambda: None,
        event=lambda limit_s=0: None,
    )
    link = robot_link.RobotLink(connection, "en")
    data = tiniscript.compile(TEXT, ROBOT).image.hex()
    link.ask({"id": 1, "do": do, "robot": ROBOT, "image": data})
    assert [item["failure"] for item in link.news()] == ["UNKNOWN_NEEDS"]


def test_a_recording_with_tasks_is_not_played() -> None:
    """No robot has run it."""
    checksum = tiniscript.compile(TEXT, ROBOT).checksum
    head = recordings.header_line(recordings.REAL, TEXT, robots.load(ROBOT), checksum)
    recording = recordings.decode(recordings.encode(head, (), 1).encode())
    with pytest.raises(recordings.BadRecording, match="other_program"):
        playing.prepare(recording)
