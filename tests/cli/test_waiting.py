"""A command that waits for a robot or a board says so at a terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.command import Tsc
from tests.support.pty_end import PtyEnd
from tests.support.pty_robot import PtyRobot
from tests.support.simulated_ends import Nobody
from tests.support.waiting import HANGS_S, until
from tiniscript.cli.commands import firmware
from tiniscript.cli.robot import connect
from tiniscript.cli.terminal import progress
from tiniscript.flash import avrdude
from tiniscript.flash.bootloaders import UNO
from tiniscript.flash.ready import Ready
from tiniscript.library import opening
from tiniscript.link.requests import DeviceInfo


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


SILENT_VERBS = [
    ["info"], ["ping"], ["fetch"], ["name", "TINI"], ["trim"], ["start"], ["live", "F(1, 80)"],
    ["upload", "-e", "SI|F(1, 80)"], ["selftest", "--yes"], ["undo"],
]  # fmt: skip


@pytest.mark.parametrize("words", SILENT_VERBS, ids=lambda words: words[0])
def test_a_robot_that_is_silent_behind_hello_is_said_to_be_waited_for_once(
    tsc: Tsc, pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch, words: list[str]
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setattr(progress, "MOMENT_S", HANGS_S)
    monkeypatch.setattr("tiniscript.library.client.PATIENCE_MS", 500)
    real = connect.Connection.meet

    def meet(self: connect.Connection) -> DeviceInfo:
        found = real(self)
        monkeypatch.setattr("tiniscript.link.session.reply_of", lambda *_: None)
        monkeypatch.setattr(progress, "MOMENT_S", 0.0)
        return found

    monkeypatch.setattr(connect.Connection, "meet", meet)
    done = tsc(*words, "--port", pty_robot.port)
    assert done.code in (1, 3)
    assert done.err.count(f"Waiting for the robot on {pty_robot.port} …\n") == 1


def test_a_stop_that_is_not_confirmed_is_waited_for_in_words(
    tsc: Tsc, silent: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    looks_on(monkeypatch)
    monkeypatch.setattr(opening, "CONFIRM_S", 0.3)
    done = tsc("stop", "--port", silent).gives(3, "has not confirmed the stop")
    assert done.err.count(f"Waiting for the robot on {silent} to confirm the stop …\n") == 1


def test_waits_without_news_are_one_silence(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """However short each of them is; an event is news, and so is what a person types."""
    now_s = 0.0
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setattr(progress, "monotonic", lambda: now_s)
    quiet = progress.Quiet("waits", is_seen=True)

    def waits(count: int, each_s: float) -> str:
        nonlocal now_s
        for _ in range(count):
            quiet.begin()
            end_s = now_s + each_s
            while now_s < end_s:
                now_s += 0.1
                quiet.look()
        return capsys.readouterr().err

    assert waits(19, 0.1) == ""
    assert waits(100, 0.3) == "waits\n"
    quiet.note_news()
    assert waits(50, 0.3) == ""  # once
    now_s += 1  # somebody types
    assert waits(1, 1.8) == "" and waits(2, 1.8) == "waits\n"


def test_a_bar_is_not_full_before_all_is_done(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setattr(progress, "BLINK_S", 0.0)
    bar = progress.Progress("en", 200)
    for done in range(201):
        bar.draw(done)
    said = capsys.readouterr().err
    assert " 99 %" in said and "100 %" not in said and "." in said.rpartition("[")[2]
