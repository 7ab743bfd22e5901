"""What `tsc` says of what a robot keeps: when it has, and what is in the way of that.

The robot is the firmware in C++.
"""

from __future__ import annotations

import json
import signal

from tests.support.command import Command, Done
from tests.support.pty_robot import PtyRobot, on, uploading

WAITS = "SI|LOOP(FOREVER);W(1);END_LOOP"


def interrupted(command: Command) -> Done:
    command.signal(signal.SIGINT)
    return command.ended()


def test_a_program_that_stands_is_told_to_be_saved_while_it_runs(pty_robot: PtyRobot) -> None:
    command = Command("upload", "-e", WAITS, "--port", pty_robot.port)
    command.until("Saved in slot 0.")
    pty_robot.switch_off()
    pty_robot.switch_on()
    command.process.kill()
    command.process.communicate()
    assert json.loads(on(pty_robot, "info", "--json").out)["saved"] == "STORED"


def test_after_ctrl_c_it_is_told_that_it_is_saved(pty_robot: PtyRobot) -> None:
    done = interrupted(uploading(pty_robot))
    assert done.code == 2 and "the robot has confirmed it" in done.err, done.err
    assert "Saved in slot 0." in done.out, done.err
    pty_robot.switch_off()
    pty_robot.switch_on()
    assert json.loads(on(pty_robot, "info", "--json").out)["saved"] == "STORED"


def test_a_name_and_a_trim_while_it_drives_are_told_to_be_kept_later(pty_robot: PtyRobot) -> None:
    command = uploading(pty_robot)
    naming, trimming = ("name", "ANA"), ("trim", "--balance", "5")
    for words in (naming, trimming):
        done = on(pty_robot, *words)
        assert done.code == 3 and not done.out
        assert "keeps it as soon as its motors have stopped" in done.err
    assert "lo guarda en" in on(pty_robot, *naming, "--lang", "es").err
    assert pty_robot.moves, "nothing has stopped it"
    interrupted(command)
    for words in (naming, trimming):
        assert on(pty_robot, *words).code == 0
    pty_robot.switch_off()
    pty_robot.switch_on()
    assert json.loads(on(pty_robot, "info", "--json").out)["name"] == "ANA"


def test_weak_batteries_are_told(pty_robot: PtyRobot) -> None:
    pty_robot.ask(lambda robot: robot.supply(is_low=True))
    done = on(pty_robot, "upload", "-e", "SI|SHOW(6)", "--no-save")
    assert done.code == 0 and "batter" not in done.err + done.out, "nothing is to be saved"
    done = on(pty_robot, "upload", "-e", "SI|SHOW(7)")
    assert "SHOW 7" in done.out, "it runs all the same"
    assert done.code == 3 and "Change the batteries and send it again" in done.err
    done = on(pty_robot, "upload", "-e", "SB|SHOW(8)", "--lang", "es")
    assert done.code == 3 and "Cambia las pilas y envíalo otra vez" in done.err
    assert "its batteries are too weak to save it" in on(pty_robot, "info").out
    fields = json.loads(on(pty_robot, "info", "--json").out)
    assert (fields["saved"], fields["slot"]) == ("LOW_SUPPLY", None)
    for words in (("name", "ANA"), ("trim", "--balance", "5")):
        done = on(pty_robot, *words)
        assert done.code == 3 and "Change the batteries" in done.err
        assert "Cambia las pilas" in on(pty_robot, *words, "--lang", "es").err
    pty_robot.ask(lambda robot: robot.supply(is_low=False))
    assert on(pty_robot, "name", "ANA").code == 0
    assert json.loads(on(pty_robot, "info", "--json").out)["saved"] == "STORED"


def test_a_supply_that_is_enough_again_saves_what_runs(pty_robot: PtyRobot) -> None:
    """Somebody plugs the USB cable in."""
    pty_robot.ask(lambda robot: robot.supply(is_low=True))
    command = Command("upload", "-e", WAITS, "--port", pty_robot.port, "--json")
    command.until('"saved": "LOW_SUPPLY"')
    pty_robot.ask(lambda robot: robot.supply(is_low=False))
    command.until('"event": "SAVED"')
    assert interrupted(command).code == 2
