"""Owners at the command: claim, keys of others, text, the teacher's stop, and a shared port.

The robot is the firmware in C++ on a pseudo-terminal.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from tests.machines.host_firmware import EMPTY_EEPROM
from tests.support.claimed_robots import become_another_computer, claim_with_button
from tests.support.command import FOREVER, Command, run_in_process
from tests.support.pty_robot import PtyRobot, on
from tiniscript.cli import main
from tiniscript.cli.commands import set_owner
from tiniscript.link import connection
from tiniscript.link.keys import KeyFile
from tiniscript.link.messages import KEY_OWNER, KEY_TEACHER
from tiniscript.link.sharing.requests import ClientRequests

DRIVE_PROGRAM = "SI|F(0.2, 80)"


def test_the_robot_has_been_asked_before_hold_is_printed(
    pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The press is over before the command continues."""

    def press_slowly(words: str, file: object = None, flush: bool = False) -> None:
        if file is None:
            return
        assert "2 s" in words
        start_ms = pty_robot.robot_ms
        pty_robot.hold()
        pty_robot.until(lambda: pty_robot.robot_ms > start_ms + 2400, "the press is over")

    monkeypatch.setattr(set_owner, "print", press_slowly, raising=False)
    assert main(["set", "owner", "--port", pty_robot.port]) == 0


def test_only_the_owner_drives_a_claimed_robot(
    pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    assert json.loads(on(pty_robot, "doctor", "--json").out)["robot"]["owner"] == "free"
    claim_with_button(pty_robot).gives(0, out="yours")
    assert on(pty_robot, "upload", "-e", DRIVE_PROGRAM).code == 0
    assert ", yours" in on(pty_robot, "doctor").out
    assert ", yours" in on(pty_robot, "doctor", "--count", "1").out
    assert "(yours)" in on(pty_robot, "doctor", "--ports", "--ask").out
    assert "The robot has an owner" not in on(pty_robot, "doctor").out
    become_another_computer(monkeypatch, tmp_path)
    assert ", owned by somebody else" in on(pty_robot, "doctor").out
    assert "(de otro dueño)" in on(pty_robot, "doctor", "--ports", "--ask", "--lang", "es").out
    on(pty_robot, "upload", "-e", DRIVE_PROGRAM).gives(3, "10 s")
    assert "dueño" in on(pty_robot, "live", "F(1, 80)", "--lang", "es").err
    refused_result = on(pty_robot, "set", "owner")
    assert (
        refused_result.code == 3
        and "10 s" in refused_result.err
        and "2 s" not in refused_result.err
    )
    assert on(pty_robot, "set", "owner", "--give-up").code == 3
    on(pty_robot, "doctor").gives(0, out="The robot has an owner")
    assert on(pty_robot, "doctor", "--identify").code == 0
    pty_robot.until(lambda: any("BEEP" in line for line in pty_robot.actions), "its tune")
    assert on(pty_robot, "stop").code == 0


def test_a_robot_claimed_by_another_computer_is_reported_with_the_next_step(
    pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    assert claim_with_button(pty_robot).code == 0
    all_before = KeyFile().all()
    assert on(pty_robot, "set", "owner", "--give-up").code == 0
    KeyFile().add(all_before)  # like a computer that was not present
    become_another_computer(monkeypatch, tmp_path)
    assert claim_with_button(pty_robot).code == 0
    become_another_computer(monkeypatch, tmp_path, "settings")
    for _ in range(7):  # more times than wrong keys are accepted
        on(pty_robot, "doctor").gives(0, "claimed the robot again.", "10 s")
    assert "lo hizo suyo" in on(pty_robot, "doctor", "--identify", "--lang", "es").err
    assert [key.is_stale for key in KeyFile().all()] == [True]
    on(pty_robot, "upload", "-e", DRIVE_PROGRAM).gives(3, "is not the one that this computer has")
    become_another_computer(monkeypatch, tmp_path)
    result = on(pty_robot, "upload", "-e", DRIVE_PROGRAM)
    assert result.code == 0 and "claimed the robot again." not in result.err


def test_giving_up_a_robot_frees_it(pty_robot: PtyRobot) -> None:
    """A robot with an owner accepts text only if allowed."""
    assert "has no owner to remove" in on(pty_robot, "set", "owner", "--give-up").out
    assert "no owner" in on(pty_robot, "set", "text", "off").out
    assert claim_with_button(pty_robot).code == 0
    assert len(KeyFile().all()) == 1
    assert "until it is switched off" in on(pty_robot, "set", "text", "on").out
    assert "except S" in on(pty_robot, "set", "text", "off").out
    assert on(pty_robot, "set", "text").code == 2
    assert on(pty_robot, "set", "text", "perhaps").code == 2
    assert on(pty_robot, "set", "owner", "--give-up").code == 0
    assert KeyFile().all() == []
    assert ", free" in on(pty_robot, "doctor").out


def test_a_live_line_fits_a_sealed_frame(pty_robot: PtyRobot) -> None:
    """Variables without room to be shown are forgotten; a longer line gets a message about it."""
    longest_line = (
        "W(0.01);" * 10 + "W(0.123);" * 4 + "X = 1"
    )  # 38 bytes, and 46 with the event about X
    result = on(pty_robot, "live", "-", data=f"{longest_line}\nSHOW(X)\n".encode())
    assert result.code == 0 and result.out.count("X 1\n") == 1
    assert claim_with_button(pty_robot).code == 0
    on(pty_robot, "live", "-", data=longest_line.encode()).gives(0, "are not kept", out="")
    on(pty_robot, "live", "SHOW(TIME * 1.234);" * 8).gives(1, "room for 42")
    result = on(pty_robot, "live", "SHOW(TIME * 1.234);" * 8, "--lang", "es")
    assert "42" in result.err


def test_a_claim_without_the_button_names_the_next_step(
    pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """If the key cannot be stored, the robot issues none."""
    monkeypatch.setattr(connection, "CLAIM_TIMEOUT_MS", 700)
    on(pty_robot, "set", "owner").gives(3, "2 s")
    assert KeyFile().all() == []
    path = KeyFile().path
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("broken")
    on(pty_robot, "set", "owner").gives(2, str(path))
    path.unlink()
    assert ", free" in on(pty_robot, "doctor").out


def test_a_teachers_stop_holds_until_the_teacher_or_the_button(
    pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    assert claim_with_button(pty_robot, "--teacher").code == 0
    become_another_computer(monkeypatch, tmp_path, "pupil")
    assert claim_with_button(pty_robot).code == 0
    assert on(pty_robot, "upload", "-e", DRIVE_PROGRAM).code == 0
    assert "teacher's key" in on(pty_robot, "stop", "--teacher").err  # a pupil does not get one
    become_another_computer(monkeypatch, tmp_path, "settings")
    assert "will run again only after" in on(pty_robot, "stop", "--teacher").out
    become_another_computer(monkeypatch, tmp_path, "pupil")
    on(pty_robot, "start").gives(3, "teacher")
    become_another_computer(monkeypatch, tmp_path, "settings")
    assert on(pty_robot, "start").code == 0
    assert {key.kind for key in KeyFile().all()} == {KEY_TEACHER}


def test_a_shared_port_has_authority_but_its_messages_no_key(
    pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    link = Command("monitor", "--hold", "--port", pty_robot.port)
    link.until("share this port")
    assert (
        claim_with_button(pty_robot).code == 0
    )  # the key is made by the command that holds the port
    assert [key.kind for key in KeyFile().all()] == [KEY_OWNER]
    become_another_computer(monkeypatch, tmp_path)  # removes the key from this command
    assert on(pty_robot, "upload", "-e", DRIVE_PROGRAM).code == 0
    assert ", yours" in on(pty_robot, "doctor").out
    driving = Command("upload", "-e", FOREVER, "--port", pty_robot.port)
    driving.until("running")
    assert on(pty_robot, "stop").code == 0
    driving.wait_for_result()
    assert on(pty_robot, "upload", "-e", DRIVE_PROGRAM).code == 0  # also after a stop
    link.kill()
    client: Any = ClientRequests()
    for request in (client.claim(KEY_OWNER), client.disown(KEY_OWNER)):
        assert set(request.message) == {"do", "kind"}


def test_a_different_robot_at_a_known_address_is_refused_until_accepted(
    pty_robot: PtyRobot,
) -> None:
    """An attacker who redirects the connection has a robot, but no key."""
    claim_with_button(pty_robot).gives(0)
    pty_robot.switch_off()
    pty_robot._memory = EMPTY_EEPROM
    pty_robot.switch_on()  # another robot, with its own id
    refused_result = on(pty_robot, "upload", "-e", FOREVER, "--detach")
    refused_result.gives(3, "a different robot", "tsc set owner --accept")
    for words in (
        ["upload", "-e", DRIVE_PROGRAM],
        ["live", "F(0.2, 80)"],
        ["show"],
        ["set", "name", "ANA"],
    ):
        on(pty_robot, *words).gives(3, "a different robot")
    on(pty_robot, "stop").gives(3, "has not confirmed the stop")
    on(pty_robot, "doctor", "--lang", "es").gives(3, out="responde otro robot")
    on(pty_robot, "doctor", "--lang", "pt").gives(3, out="responde outro robô")
    motor_lines = [line for line in pty_robot.actions if line.startswith("MOTORS")]
    assert set(motor_lines) <= {"MOTORS 0 0"}
    [robot] = re.findall("--accept ([0-9a-f]{8})", refused_result.err)
    run_in_process("set", "owner", "--accept", robot.upper()).gives(0, "", out=robot)
    assert on(pty_robot, "upload", "-e", DRIVE_PROGRAM).code == 0
    assert on(pty_robot, "stop").code == 0


def test_claiming_many_robots_at_one_cable_asks_no_questions(pty_robot: PtyRobot) -> None:
    for _ in range(2):
        claim_with_button(pty_robot).gives(0, out="yours")
        assert on(pty_robot, "upload", "-e", DRIVE_PROGRAM).code == 0
        pty_robot.switch_off()
        pty_robot._memory = EMPTY_EEPROM
        pty_robot.switch_on()  # another robot
