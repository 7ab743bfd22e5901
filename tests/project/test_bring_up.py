"""The list for a real board: the report has its steps, and its typed commands work on robots.

They are the firmware on a pseudo-terminal, alone and in an ESP32; its motor commands show that the
wheels stand still. Bluetooth, WiFi and the manual steps are not tried here.
"""

from __future__ import annotations

import os
import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.casefile import ROOT
from tests.support.command import run_subprocess
from tests.support.esp32_pty_robot import Esp32PtyRobot
from tests.support.pty_robot import PtyRobot, on
from tiniscript.cli.commands.doctor import BLANK_FIELD, FORM_STEPS
from tiniscript.cli.options import Options
from tiniscript.cli.texts.options import command_of
from tools.site.documents import sources

LISTS = {value: ROOT / name for value, name in sources(ROOT, "docs/en/bring-up.md").items()}
each_list = pytest.mark.parametrize(("language", "path"), LISTS.items(), ids=list(LISTS))


@pytest.fixture(params=["tinibot", "tinibot32"])
def board(request: pytest.FixtureRequest) -> Iterator[PtyRobot]:
    if request.param == "tinibot":
        yield request.getfixturevalue("pty_robot")
        return
    with Esp32PtyRobot(request.param) as robot:
        yield robot


def steps(path: Path) -> dict[str, tuple[str, str]]:
    """Return the action and the expected observation of each step, by its name."""
    rows = re.findall(r"^\| \d+ \| (.+?) \| (.+?) \| (.+?) \|$", path.read_text("utf-8"), re.M)
    return {name: (do, expected) for name, do, expected in rows}


def commands(text: str) -> list[list[str]]:
    """Return the commands in a text, each as its words without `tsc`."""
    command_lines = re.findall(r"(?:`|^ {4})tsc ([^`\n]+)", text.replace("\\|", "|"), re.M)
    return [shlex.split(line) for line in command_lines]


def test_both_lists_contain_the_same_commands() -> None:
    english_words = {"PUERTO": "PORT", "RED": "NETWORK", "puesta.txt": "bring-up.txt"}
    english, spanish = (
        [
            [english_words.get(word, word) for word in command]
            for command in commands(path.read_text("utf-8"))
        ]
        for path in LISTS.values()
    )
    assert english == spanish
    assert len(english) > 15


def test_the_report_is_filled_in_as_far_as_possible(pty_robot: PtyRobot, tmp_path: Path) -> None:
    """The report does not name the owner of the robot."""
    report = tmp_path / "bring-up.txt"
    result = on(pty_robot, "doctor", "--yes", "--report", report)
    assert result.code == 0
    form = report.read_text("utf-8").split("\n\n")[-1].splitlines()
    assert re.match(r"robot: tinibot, link \d+\.\d+, machine \d+\.\d+, room for \d+ bytes", form[2])
    assert form[2].endswith("last restart: power on")
    assert "12345678" not in report.read_text("utf-8")
    # a busy computer may be late
    answers = r"1\. It responds: \d+ of 20 pings were answered at once; damaged messages: 0"
    assert re.fullmatch(answers, form[3])
    assert [row.endswith(f": {BLANK_FIELD}") for row in form[6::3]] == [True] * (
        len(FORM_STEPS) - 1
    )
    rows = [(form[k + 1], form[k + 2]) for k in range(3, len(form), 3)]
    shown = [(f"   do: {do}", f"   see: {see}") for do, see in steps(LISTS["en"]).values()]
    assert rows == [(do.replace("\\|", "|"), see.replace("\\|", "|")) for do, see in shown]
    on(pty_robot, "doctor", "--yes", "--report", report, "--lang", "es")
    assert "1. Responde: 20 de 20 llegaron de inmediato" in report.read_text("utf-8")


def test_the_form_is_written_even_without_answers(tmp_path: Path) -> None:
    report = tmp_path / "bring-up.txt"
    assert run_subprocess("doctor", "--port", "/dev/ttyUSB99", "--report", report).code == 3
    form = report.read_text("utf-8").split("\n\n")[-1].splitlines()
    assert form[2:4] == ["robot: none responded", f"1. It responds: {BLANK_FIELD}"]


@pytest.mark.parametrize("text_before", ["", "(\n"])
def test_the_typed_stop_of_the_list_works(board: PtyRobot, text_before: str) -> None:
    typed = re.findall(r"`([^`]+)`", steps(LISTS["en"])["Typed stop"][0].replace("\\|", "|"))
    start, stop, bracket, second_stop = typed
    assert (bracket, second_stop) == ("(", stop)
    port = os.open(board.port, os.O_RDWR | os.O_NOCTTY)
    try:
        os.write(port, f"{start}\n".encode())
        board.until(lambda: board.moves, "it drives")
        os.write(port, f"{text_before}{stop}\n".encode())
        board.until(lambda: not board.moves, "it stands")
        data = b""
        while b"// " not in data:
            data += os.read(port, 4096)
    finally:
        os.close(port)


@each_list
def test_every_command_of_the_list_exists(language: str, path: Path) -> None:
    for verb, *arguments in commands(path.read_text("utf-8")):
        command, words = command_of(verb, arguments)
        assert Options(command, language).read(words) is not None
