"""`tsc undo`: what a person is told when the program before comes back, or cannot.

The robot is the firmware in C++, `tsc` a process of its own.
"""

from __future__ import annotations

import json

import pytest

from tests.support.command import process
from tests.support.pty_robot import PtyRobot, on, uploading

FIRST, SECOND = "SB|F(0.1, 50)", "SB|F(0.1, 60)"


def with_two(pty_robot: PtyRobot) -> list[str]:
    """Send two programs; return their checksums."""
    done = [on(pty_robot, "upload", "--json", "-e", text) for text in (FIRST, SECOND)]
    assert [each.code for each in done] == [0, 0]
    return [json.loads(each.out.splitlines()[0])["checksum"] for each in done]


@pytest.mark.parametrize(
    ("language", "said", "saved"),
    [
        ("en", "it holds the previous program again, checksum", "Saved in slot 0."),
        ("es", "vuelve a tener el programa anterior, suma", "Guardado en el lugar 0."),
    ],
)
def test_it_is_told_which_program_is_back_and_that_it_is_saved(
    pty_robot: PtyRobot, language: str, said: str, saved: str
) -> None:
    first, second = with_two(pty_robot)
    done = on(pty_robot, "undo", "--lang", language)
    assert (done.code, done.err) == (0, "")
    lines = done.out.splitlines()
    assert f"{said} {first}" in lines[0] and "tsc undo" in lines[0]
    assert lines[1:] == [saved]
    pty_robot.switch_off()
    pty_robot.switch_on()
    assert json.loads(on(pty_robot, "info", "--json").out)["program"] == first
    assert f"{second} " in on(pty_robot, "undo", "--lang", "en").out.replace(".", " ")


def test_the_file_of_the_program_is_named_where_it_is_known(
    pty_robot: PtyRobot, tmp_path_factory: pytest.TempPathFactory
) -> None:
    name = tmp_path_factory.mktemp("programs") / "square.ts"
    name.write_text(FIRST + "\n", encoding="utf-8")
    assert on(pty_robot, "upload", name).code == 0
    assert on(pty_robot, "upload", "-e", SECOND).code == 0
    assert "square.ts)" in on(pty_robot, "undo").out


def test_as_data_it_is_a_receipt_and_that_it_is_saved(pty_robot: PtyRobot) -> None:
    first, _ = with_two(pty_robot)
    done = on(pty_robot, "undo", "--json")
    receipt, saved = map(json.loads, done.out.splitlines())
    assert receipt["event"] == "RECEIPT" and receipt["checksum"] == first
    assert receipt["saved"] == "SAVING" and receipt["slot"] is None
    assert saved["event"] == "SAVED" and saved["slot"] == 0


@pytest.mark.parametrize(
    ("language", "said", "advice"),
    [
        ("en", "no program from before that it can run", "Send the program that you want"),
        ("es", "ningún programa anterior que pueda", "Envía el programa que quieras"),
    ],
)
def test_where_there_is_none_before_the_next_step_is_said(
    pty_robot: PtyRobot, language: str, said: str, advice: str
) -> None:
    assert on(pty_robot, "upload", "-e", FIRST).code == 0
    done = on(pty_robot, "undo", "--lang", language)
    assert done.code == 3 and not done.out
    assert said in done.err and advice in done.err
    assert json.loads(on(pty_robot, "info", "--json").out)["saved"] == "STORED"


def test_while_another_terminal_drives_its_program_ends(pty_robot: PtyRobot) -> None:
    with_two(pty_robot)
    command = uploading(pty_robot)
    done = on(pty_robot, "undo")
    assert done.code == 0, done.err
    assert done.out.splitlines()[-1].startswith("Saved in slot")
    assert not pty_robot.moves
    assert command.ended().code in (0, 3)


@pytest.mark.parametrize(
    ("language", "said"), [("en", "Nothing is lost"), ("es", "No se pierde nada")]
)
def test_with_weak_batteries_it_is_told_that_nothing_is_lost(
    pty_robot: PtyRobot, language: str, said: str
) -> None:
    first, second = with_two(pty_robot)
    pty_robot.ask(lambda robot: robot.supply(is_low=True))
    done = on(pty_robot, "undo", "--lang", language)
    assert done.code == 3 and said in done.err and first in done.out
    pty_robot.ask(lambda robot: robot.supply(is_low=False))
    pty_robot.switch_off()
    pty_robot.switch_on()
    assert json.loads(on(pty_robot, "info", "--json").out)["program"] in (first, second)


def test_ports_and_options_are_those_of_the_other_verbs() -> None:
    for words in (("--port", "/dev/no-such-port"), ("--virtual",)):
        done = process("undo", *words)
        assert done.code == 3 and done.err.startswith("tsc: ") and not done.out
    assert process("undo", "--all", "--port", "X").code == 2
    assert process("undo", "what").code == 2
