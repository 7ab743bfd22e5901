"""What `tsc` says of what a robot keeps: when it has, and what is in the way of that.

The robot on the desk is the firmware in C++, `tsc` a process of its own.
"""

from __future__ import annotations

import json
import signal
from collections.abc import Iterator

import pytest

from tests.command import Command, Done
from tests.desk import Desk, on, uploading
from tests.machines.tabletop import missing
from tiniscript import robots

pytest.importorskip("pty", reason="Windows has no pseudo-terminals of this kind")
pytestmark = pytest.mark.skipif(bool(missing()), reason=missing() or "there is a compiler")

WAITS = "SI|LOOP(FOREVER);W(1);END_LOOP"


@pytest.fixture
def desk() -> Iterator[Desk]:
    with Desk(robots.load("tinibot").kit) as found:
        yield found


def held(desk: Desk, text: str) -> Command:
    command = Command("upload", "-e", text, "--port", desk.port)
    command.until("running")
    return command


def interrupted(command: Command) -> Done:
    command.signal(signal.SIGINT)
    return command.ended()


def test_a_program_that_stands_is_told_to_be_saved_while_it_runs(desk: Desk) -> None:
    command = held(desk, WAITS)
    command.until("Saved in slot 0.")
    desk.switch_off()
    desk.switch_on()
    command.process.kill()
    command.process.communicate()
    assert json.loads(on(desk, "info", "--json").out)["saved"] == "STORED"


def test_after_ctrl_c_it_is_told_that_it_is_saved(desk: Desk) -> None:
    done = interrupted(uploading(desk))
    assert done.code == 2 and "the robot has confirmed it" in done.err, done.err
    assert "Saved in slot 0." in done.out, done.err
    desk.switch_off()
    desk.switch_on()
    assert json.loads(on(desk, "info", "--json").out)["saved"] == "STORED"


@pytest.mark.parametrize(
    ("language", "said"), [("en", "keeps it as soon as its motors stand"), ("es", "lo guarda en")]
)
def test_a_name_while_it_drives_is_told_to_be_kept_later(
    desk: Desk, language: str, said: str
) -> None:
    command = uploading(desk)
    done = on(desk, "name", "ANA", "--lang", language)
    assert done.code == 3 and said in done.err and not done.out
    assert desk.moves, "nothing has stopped it"
    interrupted(command)
    assert on(desk, "name", "ANA").code == 0
    desk.switch_off()
    desk.switch_on()
    assert json.loads(on(desk, "info", "--json").out)["name"] == "ANA"


def test_a_trim_while_it_drives_is_told_to_be_kept_later(desk: Desk) -> None:
    command = uploading(desk)
    done = on(desk, "trim", "--balance", "5")
    assert done.code == 3 and "keeps it as soon as its motors stand" in done.err
    interrupted(command)
    assert on(desk, "trim", "--balance", "5").code == 0


def test_weak_batteries_are_told(desk: Desk) -> None:
    desk.ask(lambda robot: robot.supply(is_low=True))
    done = on(desk, "upload", "-e", "SI|SHOW(7)")
    assert "SHOW 7" in done.out, "it runs all the same"
    assert done.code == 3 and "Change the batteries and send it again" in done.err
    done = on(desk, "upload", "-e", "SB|SHOW(8)", "--lang", "es")
    assert done.code == 3 and "Cambia las pilas y envíalo otra vez" in done.err
    assert "its batteries are too weak to save it" in on(desk, "info").out
    fields = json.loads(on(desk, "info", "--json").out)
    assert (fields["saved"], fields["slot"]) == ("LOW_SUPPLY", None)
    for words in (("name", "ANA"), ("trim", "--balance", "5")):
        done = on(desk, *words)
        assert done.code == 3 and "Change the batteries" in done.err
        assert "Cambia las pilas" in on(desk, *words, "--lang", "es").err
    desk.ask(lambda robot: robot.supply(is_low=False))
    assert on(desk, "name", "ANA").code == 0
    assert json.loads(on(desk, "info", "--json").out)["saved"] == "STORED"


def test_a_supply_that_is_enough_again_saves_what_runs(desk: Desk) -> None:
    """Somebody plugs the USB cable in."""
    desk.ask(lambda robot: robot.supply(is_low=True))
    command = Command("upload", "-e", WAITS, "--port", desk.port, "--json")
    command.until('"saved": "LOW_SUPPLY"')
    desk.ask(lambda robot: robot.supply(is_low=False))
    command.until('"event": "SAVED"')
    assert interrupted(command).code == 2


def test_what_is_not_to_be_saved_is_told_nothing_of(desk: Desk) -> None:
    desk.ask(lambda robot: robot.supply(is_low=True))
    done = on(desk, "upload", "-e", "SI|SHOW(7)", "--no-save")
    assert done.code == 0 and "batter" not in done.err + done.out


def test_another_program_is_not_taken_for_the_one_that_is_saved(desk: Desk) -> None:
    with_json = on(desk, "upload", "-e", "SI|SHOW(1)", "--json")
    events = [json.loads(line)["event"] for line in with_json.out.splitlines()]
    assert events == ["RECEIPT", "SHOW", "DONE", "SAVED"]
