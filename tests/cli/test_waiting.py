"""A command that waits for a robot or a board says so at a terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.command import Tsc
from tests.support.pty_end import PtyEnd
from tests.support.simulated_ends import Nobody
from tests.support.waiting import HANGS_S, until
from tiniscript.cli.commands import firmware
from tiniscript.cli.terminal import progress
from tiniscript.flash import avrdude
from tiniscript.flash.bootloaders import UNO
from tiniscript.flash.ready import Ready
from tiniscript.library import opening


def looks_on(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a person look on, for whom everything takes long."""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setattr(progress, "MOMENT_S", 0.0)


@pytest.fixture
def silent(monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A port on which nobody is; the computer soon gives up."""
    monkeypatch.setattr(opening, "LONG_QUIET_S", 0.0)
    monkeypatch.setattr(opening, "CABLE_ANSWER_MS", 200)
    with PtyEnd(Nobody()) as end:
        yield end.port


def test_who_waits_for_a_robot_is_told(
    tsc: Tsc, silent: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not for a moment, and no program that reads is."""
    looks_on(monkeypatch)
    done = tsc("ping", "--port", silent, "--lang", "es").gives(3)
    assert done.err.startswith(f"Esperando al robot en {silent} …\n")
    monkeypatch.setattr(progress, "MOMENT_S", HANGS_S)
    assert "Waiting" not in tsc("ping", "--port", silent).err
    monkeypatch.setattr(progress, "MOMENT_S", 0.0)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: False)
    assert "Waiting" not in tsc("ping", "--port", silent).err


def test_who_waits_for_a_board_is_told_until_it_is_written(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    looks_on(monkeypatch)
    said = ""

    def write(*given: object) -> avrdude.Ended:
        def is_said() -> bool:
            nonlocal said
            said += capsys.readouterr().err
            return "Waiting for the board on /dev/x …\n" in said

        until(is_said, "the sentence")
        return avrdude.Ended(avrdude.DONE)

    monkeypatch.setattr(avrdude, "write", write)
    made = Ready("tinibot", "uno", "1", Path("x"))
    assert firmware._written([], UNO, "/dev/x", made, "en").how == avrdude.DONE
