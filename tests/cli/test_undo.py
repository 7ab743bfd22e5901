"""`tsc undo`: what a person is told when the program before comes back, or cannot.

The robot is the firmware in C++.
"""

from __future__ import annotations

import json
from pathlib import Path

from tests.support.command import inside
from tests.support.pty_robot import PtyRobot, on, uploading

FIRST, SECOND = "SB|F(0.1, 50)", "SB|F(0.1, 60)"


def with_two(pty_robot: PtyRobot) -> list[str]:
    """Send two programs; return their checksums."""
    done = [on(pty_robot, "upload", "--json", "-e", text) for text in (FIRST, SECOND)]
    assert [each.code for each in done] == [0, 0]
    return [json.loads(each.out.splitlines()[0])["checksum"] for each in done]


def test_it_is_told_which_program_is_back_and_that_it_is_saved(pty_robot: PtyRobot) -> None:
    """As data it is a receipt."""
    first, second = with_two(pty_robot)
    for language, checksum, said, saved in (
        ("en", first, "it holds the previous program again, checksum", "Saved in slot 0."),
        ("es", second, "vuelve a tener el programa anterior, suma", "Guardado en el lugar 1."),
    ):
        done = on(pty_robot, "undo", "--lang", language)
        assert (done.code, done.err) == (0, "")
        lines = done.out.splitlines()
        assert f"{said} {checksum}" in lines[0] and "tsc undo" in lines[0]
        assert lines[1:] == [saved]
        pty_robot.switch_off()
        pty_robot.switch_on()
        assert json.loads(on(pty_robot, "info", "--json").out)["program"] == checksum
    receipt, kept = map(json.loads, on(pty_robot, "undo", "--json").out.splitlines())
    assert receipt["event"] == "RECEIPT" and receipt["checksum"] == first
    assert receipt["saved"] == "SAVING" and receipt["slot"] is None
    assert kept["event"] == "SAVED" and kept["slot"] == 0


def test_the_file_of_the_program_is_named_where_it_is_known(
    pty_robot: PtyRobot, tmp_path: Path
) -> None:
    name = tmp_path / "square.ts"
    name.write_text(FIRST + "\n", encoding="utf-8")
    assert on(pty_robot, "upload", name).code == 0
    assert on(pty_robot, "upload", "-e", SECOND).code == 0
    assert "square.ts)" in on(pty_robot, "undo").out


def test_where_there_is_none_before_the_next_step_is_said(pty_robot: PtyRobot) -> None:
    assert on(pty_robot, "upload", "-e", FIRST).code == 0
    for language, said, advice in (
        ("en", "no program from before that it can run", "Send the program that you want"),
        ("es", "ningún programa anterior que pueda", "Envía el programa que quieras"),
    ):
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


def test_with_weak_batteries_it_is_told_that_nothing_is_lost(pty_robot: PtyRobot) -> None:
    first, second = with_two(pty_robot)
    pty_robot.ask(lambda robot: robot.supply(is_low=True))
    for language, said in (("en", "Nothing is lost"), ("es", "No se pierde nada")):
        done = on(pty_robot, "undo", "--lang", language)
        assert done.code == 3 and said in done.err and first in done.out
        assert on(pty_robot, "undo").code == 0, "the second one is saved already"
    on(pty_robot, "undo")
    pty_robot.ask(lambda robot: robot.supply(is_low=False))
    pty_robot.switch_off()
    pty_robot.switch_on()
    assert json.loads(on(pty_robot, "info", "--json").out)["program"] in (first, second)


def test_ports_and_options_are_those_of_the_other_verbs() -> None:
    for words in (("--port", "/dev/no-such-port"), ("--virtual",)):
        done = inside("undo", *words)
        assert done.code == 3 and done.err.startswith("tsc: ") and not done.out
    assert inside("undo", "--all", "--port", "X").code == 2
    assert inside("undo", "what").code == 2
