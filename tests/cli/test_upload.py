"""`tsc upload` and a robot: real processes, a real port, the whole firmware behind it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.support.command import LONG, OBSTACLE, Command, inside
from tests.support.pty_robot import PtyRobot, on
from tests.support.terminal import Terminal
from tiniscript import compile_text, robots

KIT = robots.load("tinibot").kit


def test_upload_runs_the_program_and_stays_until_it_ends(
    pty_robot: PtyRobot, tmp_path: Path
) -> None:
    program = tmp_path / "drive.ts"
    program.write_text("SI|F(0.2, 80)\nSHOW(DISTANCE + 1.5); SHOW(TRUE)\n", encoding="utf-8")
    pty_robot.ask(lambda robot: robot.sense(0, 0, 42_000))
    done = on(pty_robot, "upload", program)
    assert (done.code, done.err) == (0, "")
    receipt, *rest = done.out.splitlines()
    image = compile_text(program.read_text(encoding="utf-8"), KIT).image
    assert receipt.startswith(f"{program} -> tinibot ({pty_robot.port})   {len(image)} bytes")
    assert f"checksum {int.from_bytes(image[10:14], 'little'):08x}" in receipt
    assert receipt.endswith("saving   SI: running")
    assert rest == ["SHOW 43.5", "SHOW TRUE", "Done.", "Saved in slot 0."]
    assert pty_robot.did == ["MOTORS 80 80", "MOTORS 0 0", "FINISHED"]


def test_a_program_goes_on_without_tsc(pty_robot: PtyRobot) -> None:
    done = on(pty_robot, "upload", "-e", OBSTACLE, "--detach")
    assert done.code == 0 and done.out.endswith("SI: running without tsc\n")
    pty_robot.ask(lambda robot: robot.wait(7000))
    assert pty_robot.did[:3] == ["MOTORS 80 80", "MOTORS 0 0", "MOTORS 60 -60"]


def test_a_program_that_waits_ends_with_its_receipt(pty_robot: PtyRobot) -> None:
    done = on(pty_robot, "upload", "-e", "SB|F(0.1, 80)")
    assert (done.code, pty_robot.did) == (0, [])
    assert "SB: waits for the button or tsc start\nSaved in slot" in done.out
    pty_robot.push()
    pty_robot.until(lambda: "FINISHED" in pty_robot.did, "the button starts it")
    done = on(pty_robot, "start")
    assert done.code == 0
    assert done.out.endswith("Done.\n")
    assert pty_robot.did.count("FINISHED") == 2


def test_a_longer_program_goes_in_pieces_and_comes_back(
    pty_robot: PtyRobot, tmp_path: Path
) -> None:
    """Noise on the line costs time and nothing else."""
    ours, theirs = tmp_path / "ours.bin", tmp_path / "theirs.bin"
    ours.write_bytes(compile_text(LONG, KIT).image)
    for damages in (0, 211):
        pty_robot.damages = damages
        done = on(pty_robot, "upload", ours, "--no-run", "--no-save")
        assert (done.code, pty_robot.did) == (0, [])
        assert "in RAM only   SI: waits" in done.out
        assert on(pty_robot, "fetch", "-o", theirs).code == 0
        assert theirs.read_bytes() == ours.read_bytes()
        fields = json.loads(on(pty_robot, "info", "--json").out)
        assert bool(fields["damaged"]) == bool(damages)
    listing = on(pty_robot, "fetch").out
    assert listing.split("\n", 1)[1] == inside("show", ours).out.split("\n", 1)[1]


def test_the_receipt_is_data_too(pty_robot: PtyRobot) -> None:
    text = "SI|SHOW(0.5);SHOW(2);SHOW(FALSE);X = 0;SHOW(1 / X)"
    done = on(pty_robot, "upload", "-e", text, "--json")
    assert done.code == 1
    lines = [json.loads(line) for line in done.out.splitlines()]
    kinds = [line["event"] for line in lines]
    assert kinds == ["RECEIPT", "SHOW", "SHOW", "SHOW", "FAULT", "SAVED"]
    assert [line["value"] for line in lines[1:4]] == [0.5, 2, False]
    assert (lines[0]["start"], lines[0]["is_running"], lines[0]["saved"]) == ("SI", True, "SAVING")
    assert lines[0]["is_pushed"] is False
    assert (lines[4]["fault"], lines[4]["line"]) == ("DIVIDE_BY_ZERO", 1)


def test_a_fault_names_its_line(pty_robot: PtyRobot, tmp_path: Path) -> None:
    program = tmp_path / "divide.ts"
    program.write_text("SI|F(0.1, 50)\nX = 0\nSHOW(1 / X)\n", encoding="utf-8")
    done = on(pty_robot, "upload", program, "--lang", "es")
    assert done.code == 1
    assert "falla DIVIDE_BY_ZERO" in done.err
    assert "línea 3:  SHOW(1 / X)" in done.err
    assert not pty_robot.moves
    done = on(pty_robot, "info")  # the text is in the cache
    assert "divide.ts, line 3:  SHOW(1 / X)" in done.out
    assert on(pty_robot, "start").code == 1


def test_mistakes_keep_the_program_off_the_robot(pty_robot: PtyRobot) -> None:
    done = on(pty_robot, "upload", "-e", "F(2 80)")
    assert done.code == 1
    assert "TS017" in done.err
    assert pty_robot.heard == b""


def test_what_does_not_fit_is_said_with_numbers(pty_robot: PtyRobot, tmp_path: Path) -> None:
    target = tmp_path / "a.bin"
    target.write_bytes(compile_text("SHOW(TIME * 1.234);" * 90, robots.load("grabber").kit).image)
    done = on(pty_robot, "upload", target)
    assert done.code == 1
    assert "540 bytes of code, 151 more than the robot has room for (389)" in done.err
    done = on(pty_robot, "upload", "-e", "SHOW(LINE_L)", "--robot", "liner")
    assert done.code == 3
    assert "--robot tinibot" in done.err
    done = on(pty_robot, "start")
    assert done.code == 3
    assert "tsc upload" in done.err


def test_a_long_way_has_a_bar_that_is_gone_at_the_end() -> None:
    with PtyRobot(KIT, bytes_per_ms=1) as pty_robot:
        words = ("upload", "-e", LONG, "--no-run", "--no-save", "--port", pty_robot.port)
        terminal = Terminal(*words, size=(200, 5), types=False)
        assert terminal.end() == 0
    assert b"sending [" in terminal.written
    assert terminal.lines()[0].startswith("-e -> tinibot")
    assert "sending" not in "".join(terminal.lines())


@pytest.mark.parametrize("is_many", [False, True])
def test_a_reset_during_a_run_is_no_success(pty_robot: PtyRobot, is_many: bool) -> None:
    """Power off and on under a program: it has not ended by itself, whoever has it run."""
    other = ("--port", "/dev/none") if is_many else ()
    command = Command("upload", "-e", "SI|F(200, 80)", "--port", pty_robot.port, *other)
    pty_robot.until(lambda: pty_robot.moves, "it drives")
    pty_robot.switch_off()
    pty_robot.switch_on()
    done = command.ended()
    assert done.code == 3 and "Done." not in done.out + done.err
    assert "was restarted" in done.out + done.err, done
