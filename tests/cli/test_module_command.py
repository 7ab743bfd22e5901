"""`tsc doctor --module` with a module on a port: the output matches the module's settings."""

from __future__ import annotations

import json
import signal
from collections.abc import Iterator
from contextlib import closing, nullcontext

import pytest

from tests.support.command import Command, Tsc
from tests.support.pty_end import PtyEnd
from tests.support.simulated_modules import Bt05, Hc05, Hc06, Hc06New, Hm10
from tests.support.simulated_modules import SimulatedModule as Simulated
from tests.support.waiting import until
from tiniscript.cli.texts.causes import sentences_of
from tiniscript.doctor.findings import CAUSES, WRONG, sure_finding
from tiniscript.link.modules import set_up, talk
from tiniscript.link.ports import open_port

MESSAGES_BY_CAUSE = {
    set_up.DONE: ("module_done", "module_done_baud", "module_done_later"),
    set_up.UNSEEN: ("module_unseen",), set_up.REFUSED: ("module_refused",),
    set_up.SILENT: ("module_lost_midway",), set_up.DIFFERS: ("module_differs",),
    set_up.ELSEWHERE: ("module_elsewhere",), set_up.LOST: ("module_lost",),
}  # fmt: skip
UNSEEN_LINES = [
    "       Seen: it cannot confirm the value",
    "       Try:  Pair the module, and see whether it has the new value.",
]


@pytest.fixture
def module() -> Iterator[Simulated]:
    """An HC-06 with firmware 3.0, which answers at once."""
    end = Hc06New()
    with PtyEnd(end) as pty_end:
        end.port = pty_end.port  # type: ignore[attr-defined]
        yield end


def port_of(module: Simulated) -> str:
    return str(module.port)  # type: ignore[attr-defined]


def test_a_module_gets_name_pin_and_speed(tsc: Tsc, module: Simulated) -> None:
    result = tsc("doctor", "--module", "--port", port_of(module), "--name", "ANA", "--pin", "4711",
               "--baud", "57600").gives(0, "")  # fmt: skip
    assert (module.name, module.pin, module.baud) == ("ANA", "4711", 57600)
    assert result.out.splitlines() == [
        f"HC-06 3.x on {port_of(module)}, version 3.0-20170609; it listens at 9600 baud.",
        "?      name ANA: the module reports that it has done this",
        *UNSEEN_LINES,
        "?      PIN 4711: the module reports that it has done this",
        *UNSEEN_LINES,
        "ok     57600 baud: done; the module responds at this speed",
        "Now switch the module off, connect it to the robot as before, switch it on and"
        " pair it again.",
    ]


@pytest.mark.parametrize("end", [Hc05(57600), Hc06()])
def test_quick_and_slow_modules_are_set_behind_a_real_port(tsc: Tsc, end: Simulated) -> None:
    """Tests the port's timeout. All kinds of modules are in `tests/modules/`."""
    pin = "471123"[: len(end.pin)]
    with PtyEnd(end) as pty_end:
        result = tsc("doctor", "--module", "--port", pty_end.port, "--id", "12347f3a", "--pin", pin,
                   "--baud", "19200", "--lang", "es")  # fmt: skip
    assert (result.code, result.err) == (0, "")
    assert (end.name, end.pin, end.data_baud) == ("Tini-7F3A", pin, 19200)
    assert ("suelta su botón" in result.out) == isinstance(end, Hc05)


def test_a_dry_run_shows_the_commands_and_changes_nothing(tsc: Tsc, module: Simulated) -> None:
    result = tsc("doctor", "--module", "--port", port_of(module), "--name", "ANA",
                 "--baud", "115200", "--dry-run")  # fmt: skip
    assert result.code == 0
    assert "would send:  AT+NAME:ANA, or else AT+NAME=ANA\n" in result.out
    assert "115200 baud: would send:  AT+UART=115200,0,0" in result.out
    assert (module.name, module.baud) == ("HC-06", 9600)
    assert not any("ANA" in command or "UART" in command for command in module.commands)


def test_without_settings_the_found_module_is_reported(tsc: Tsc) -> None:
    with PtyEnd(Bt05(38400)) as pty_end:
        result = tsc("doctor", "--module", "--port", pty_end.port)
    assert result.code == 0
    assert "MLT-BT05 on" in result.out and "listens at 38400 baud" in result.out
    assert "It now has: name BT05, 38400 baud." in result.out
    assert "--pin 123456" in result.out


def test_a_silent_port_is_reported(tsc: Tsc, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(talk, "SLOW_ANSWER_MS", 20)
    monkeypatch.setattr(talk, "ANSWER_MS", 20)
    end = Hc06New()
    end.is_on = False
    with PtyEnd(end) as pty_end:
        result = tsc("doctor", "--module", "--port", pty_end.port, "--name", "ANA")
    assert result.code == 3
    silent_sentences = sentences_of(sure_finding("module_silent"), "en")
    assert (
        f"WRONG  module: {silent_sentences.finding}\n" in result.out
        and silent_sentences.advice in result.out
    )
    assert result.err == ""


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--name", "A" * 21], "at most 20"),
        (["--name", ""], "at most 20"),
        (["--name", "ÑU"], "ÑU does not fit"),
        (["--pin", "12"], "PIN of this kind of module has"),
        (["--baud", "300"], "9600, 19200, 38400, 57600, 115200, not 300"),
        (["--id", "xyz"], "takes the id"),
        (["--id", "123456789"], "takes the id"),
        (["--id", "1", "--name", "A"], "Leave one"),
    ],
)
def test_settings_no_module_supports_are_refused_before_a_port_is_opened(
    tsc: Tsc, words: list[str], message: str
) -> None:
    tsc("doctor", "--module", "--port", "/dev/not-there", *words).gives(2, message)


def test_settings_this_module_lacks_are_refused_before_any_change(tsc: Tsc) -> None:
    end = Bt05()
    with PtyEnd(end) as pty_end:
        result = tsc("doctor", "--module", "--port", pty_end.port, "--name", "ANA", "--pin", "1234")
    assert result.code == 2
    assert "6 digits (MLT-BT05)" in result.err
    assert end.name == "BT05"


def test_invalid_ports_are_refused(tsc: Tsc) -> None:
    assert "tsc doctor --module --port P" in tsc("doctor", "--module").err
    assert tsc("doctor", "--module", "--port", "").code == 2
    for port in ("/dev/rfcomm7", "socket://127.0.0.1:9"):
        tsc("doctor", "--module", "--port", port).gives(2, "only over a cable")


@pytest.mark.parametrize("is_locked", [False, True])
def test_an_unopenable_port_has_the_same_message_as_in_the_doctor(
    tsc: Tsc, module: Simulated, is_locked: bool
) -> None:
    port = port_of(module) if is_locked else "/dev/not-there"
    with closing(open_port(port, 9600)) if is_locked else nullcontext():
        (finding,) = json.loads(tsc("doctor", "--port", port, "--json").out)["findings"]
        module_output = tsc("doctor", "--module", "--port", port, "--name", "ANA").gives(3, "").out
    assert module_output.splitlines() == [
        f"WRONG  module: {finding['said']}",
        f"       Seen: {finding['seen']}",
        f"       Try:  {finding['next']}",
    ]
    assert module.name != "ANA"


def test_each_outcome_of_a_step_is_a_cause_of_the_doctors_table() -> None:
    """No other cause concerns a setting."""
    outcome_by_cause = {
        cause: outcome for outcome, causes in MESSAGES_BY_CAUSE.items() for cause in causes
    }
    assert {*outcome_by_cause} == {cause for cause, row in CAUSES.items() if row.part == "setting"}
    assert {
        cause for cause, outcome in outcome_by_cause.items() if outcome not in set_up.GOOD_OUTCOMES
    } == {cause for cause in outcome_by_cause if CAUSES[cause].verdict == WRONG}


def test_a_module_that_fails_gives_an_exit_code(tsc: Tsc, module: Simulated) -> None:
    module.breaks_after = 4
    result = tsc(
        "doctor", "--module", "--port", port_of(module), "--name", "ANA", "--baud", "115200"
    )
    assert result.code == 3
    assert "WRONG  115200 baud: the module" in result.out
    assert "try again" in result.out


@pytest.mark.parametrize(("is_on", "is_pulled", "code", "expected"), [
    (True, True, 3, "The module was being set to 115200 baud"),
    (True, False, 2, "The module was being set to 115200 baud: it has that speed or the old one."),
    (False, False, 2, "tsc: stopped. The module's speed has not changed."),
])  # fmt: skip
def test_a_pulled_cable_and_ctrl_c_report_the_possible_speeds(
    is_on: bool, is_pulled: bool, code: int, expected: str
) -> None:
    end = Hm10()
    end.is_on = is_on
    with PtyEnd(end) as pty_end:
        command = Command("doctor", "--module", "--port", pty_end.port, "--baud", "115200")
        until(lambda: (b"AT+BAUD4" if is_on else b"AT") in pty_end.received, "it is asked")
        if is_pulled:
            pty_end.pull()
        else:
            command.signal(signal.SIGINT)
        result = command.wait_for_result()
    assert result.code == code
    assert expected in (result.out if is_pulled else result.err)
    assert ("WRONG  module: The port disappeared" in result.out) == is_pulled
