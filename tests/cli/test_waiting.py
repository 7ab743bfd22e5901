"""A command that waits for a robot or a board says so at a terminal."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random
from threading import Thread
from typing import Any

import pytest

from tests.between.lines import BadLine, Fault
from tests.support.command import Tsc
from tests.support.pty_end import PtyEnd
from tests.support.pty_robot import PtyRobot, on
from tests.support.simulated_ends import UnpoweredEnd
from tests.support.terminal import Terminal
from tests.support.waiting import HANG_LIMIT_S, until
from tiniscript.cli import main
from tiniscript.cli.commands import firmware, studio
from tiniscript.cli.robot import connect
from tiniscript.cli.terminal import progress
from tiniscript.flash import avrdude
from tiniscript.flash.bootloaders import UNO
from tiniscript.flash.ready import ReadyFile
from tiniscript.library import opening
from tiniscript.library.client import Client
from tiniscript.link.requests import DeviceInfo
from tiniscript.studio import building, serving
from tiniscript.studio.hosting import Hosting


def watch_output(monkeypatch: pytest.MonkeyPatch) -> None:
    """Simulate a person who watches slow operations."""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setattr(progress, "SILENCE_LIMIT_S", 0.0)


@pytest.fixture
def silent_port(monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A port without a robot; the computer soon gives up."""
    monkeypatch.setattr(opening, "LONG_QUIET_S", 0.0)
    monkeypatch.setattr(opening, "CABLE_ANSWER_TIMEOUT_MS", 200)
    with PtyEnd(UnpoweredEnd()) as end:
        yield end.port


def test_waiting_for_a_robot_is_reported(
    tsc: Tsc, silent_port: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A short wait prints nothing, and a program that reads the output sees nothing."""
    watch_output(monkeypatch)
    result = tsc("doctor", "--identify", "--port", silent_port, "--lang", "es").gives(3)
    assert result.err.startswith(f"Esperando al robot en {silent_port} …\n")
    monkeypatch.setattr(progress, "SILENCE_LIMIT_S", HANG_LIMIT_S)
    assert "Waiting" not in tsc("doctor", "--identify", "--port", silent_port).err
    monkeypatch.setattr(progress, "SILENCE_LIMIT_S", 0.0)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: False)
    assert "Waiting" not in tsc("doctor", "--identify", "--port", silent_port).err


def test_waiting_for_a_board_is_reported_until_it_is_written(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    watch_output(monkeypatch)
    output = ""

    def write(*arguments: object) -> avrdude.WriteResult:
        def has_been_printed() -> bool:
            nonlocal output
            output += capsys.readouterr().err
            return "Waiting for the board on /dev/x …\n" in output

        until(has_been_printed, "the sentence")
        return avrdude.WriteResult(avrdude.DONE)

    monkeypatch.setattr(avrdude, "write", write)
    ready_file = ReadyFile("tinibot", "uno", "1", Path("x"))
    assert firmware._write_firmware([], UNO, "/dev/x", ready_file, "en").outcome == avrdude.DONE


SILENT_VERBS = [
    ["doctor", "--identify"], ["show"], ["set", "name", "TINI"], ["set", "trim"], ["start"],
    ["live", "F(1, 80)"], ["upload", "-e", "SI|F(1, 80)"], ["doctor", "--selftest", "--yes"],
    ["start", "--previous"],
]  # fmt: skip


@pytest.mark.parametrize("words", SILENT_VERBS, ids=lambda words: " ".join(words))
def test_waiting_for_a_robot_silent_after_hello_is_reported_once(
    tsc: Tsc, pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch, words: list[str]
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setattr(progress, "SILENCE_LIMIT_S", HANG_LIMIT_S)
    monkeypatch.setattr("tiniscript.library.client.REQUEST_TIMEOUT_MS", 500)
    real_call = connect.Connection.meet

    def meet(self: connect.Connection) -> DeviceInfo:
        device_info = real_call(self)
        monkeypatch.setattr("tiniscript.link.session.reply_of", lambda *_: None)
        monkeypatch.setattr(progress, "SILENCE_LIMIT_S", 0.0)
        return device_info

    monkeypatch.setattr(connect.Connection, "meet", meet)
    result = tsc(*words, "--port", pty_robot.port)
    assert result.code in (1, 3)
    assert result.err.count(f"Waiting for the robot on {pty_robot.port} …\n") == 1


def test_waiting_for_an_unconfirmed_stop_is_reported(
    tsc: Tsc, silent_port: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    watch_output(monkeypatch)
    monkeypatch.setattr(opening, "CONFIRM_TIMEOUT_S", 0.3)
    result = tsc("stop", "--port", silent_port).gives(3, "has not confirmed the stop")
    assert result.err.count(f"Waiting for the robot on {silent_port} to confirm the stop …\n") == 1


def test_waits_without_news_are_one_silence(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """This holds however short each of them is; an event is news, and so is typed input."""
    now_s = 0.0
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setattr(progress, "monotonic", lambda: now_s)
    quiet_notice = progress.RepeatedWaitNotice("waits", is_seen=True)

    def wait_times(count: int, wait_s: float) -> str:
        nonlocal now_s
        for _ in range(count):
            quiet_notice.begin()
            end_s = now_s + wait_s
            while now_s < end_s:
                now_s += 0.1
                quiet_notice.poll()
        return capsys.readouterr().err

    assert wait_times(19, 0.1) == ""
    assert wait_times(100, 0.3) == "waits\n"
    quiet_notice.restart()
    assert wait_times(50, 0.3) == ""  # once
    now_s += 1  # a person types
    assert wait_times(1, 1.8) == "" and wait_times(2, 1.8) == "waits\n"


def test_a_bar_is_not_full_before_all_is_done(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setattr(progress, "DRAW_DELAY_S", 0.0)
    bar = progress.Progress("en", 200)
    for percent in range(201):
        bar.draw(percent)
    output = capsys.readouterr().err
    assert " 99 %" in output and "100 %" not in output and "." in output.rpartition("[")[2]


@pytest.mark.parametrize("seed", range(10))
def test_a_bar_writes_only_changes_and_leaves_nothing(
    seed: int, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """This holds for any amount, also for none, and however often it is drawn and ended."""
    rng, now_s, line = Random(seed), 100.0, ""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setattr(progress, "monotonic", lambda: now_s)
    bar = progress.Progress("en", total := rng.choice((0, 7, 200)))
    newest = ""  # the newest line that is no empty one
    for _ in range(60):
        now_s += rng.choice((0.0, 0.02, 0.1))
        if rng.random() < 0.2:
            bar.end()
            expected_text = ""
        else:
            done_count = rng.randint(0, total)
            bar.draw(done_count)
            percent = f"{min(100 * done_count // total, 99)} %" if total else ""
            is_late = now_s - 100 >= progress.DRAW_DELAY_S and percent != newest
            expected_text = percent if is_late else line
            newest = expected_text or newest
        output = capsys.readouterr().err
        assert bool(output) == (expected_text != line)
        shown_line = output.split("\r")[-1].strip() if output else line
        assert shown_line.rpartition("] ")[2].strip() == expected_text
        line = expected_text


def test_received_bytes_may_come_from_a_late_robot(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is not reported as foreign or silent while it waits for its button."""
    monkeypatch.setattr(opening, "LONG_QUIET_S", 0.0)
    for late_ms in (990, 1300):  # silence of 3 s counts as a lost link
        with BadLine(Fault("late", late_ms=late_ms), Random(1), 0) as line:
            on(line, "doctor", "--identify").gives(0)
            on(line, "set", "owner").gives(
                3, "hold its start button down", "waiting for its button"
            )


def test_a_long_wait_is_reported_once_and_soon_enough(
    tsc: Tsc, pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After HELLO and after the request: a wait continues from one to the other."""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    now_s = 0.0
    monkeypatch.setattr(progress, "monotonic", lambda: now_s)
    real_call = Client.wait
    notices: list[str] = []

    def wait(self: connect.Connection, *arguments: Any) -> Any:
        nonlocal now_s
        reply = real_call(self, *arguments)
        notices.append("wait")
        now_s += 1.5
        if len(arguments) > 1 and arguments[1] is not None:
            arguments[1]()
        return reply

    monkeypatch.setattr(Client, "wait", wait)
    result = tsc("set", "trim", "--show", "--port", pty_robot.port).gives(0)
    assert len(notices) >= 2
    assert result.err.count("Waiting for the robot") == 1  # there were no 3 s of silence
    monkeypatch.setattr(progress, "SILENCE_LIMIT_S", 0.0)
    now_s += 100
    result = tsc("set", "trim", "--show", "--port", pty_robot.port).gives(0)
    # One line for HELLO and the request together.
    assert result.err.count("Waiting for the robot") == 1


def test_a_finished_wait_is_not_reported(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Even where the moment is over at the same time."""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setattr(progress, "SILENCE_LIMIT_S", HANG_LIMIT_S)
    silence = progress.WaitNotice("waits")
    silence.cancel()
    silence._print_wait()
    assert capsys.readouterr().err == "" and not silence.is_told


def test_a_thread_that_begins_late_ends_before_its_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise it might begin while Python exits, and crash it."""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    events: list[str] = []

    def begin_late(run: Callable[[], None], arguments: tuple[()]) -> None:
        def run_late() -> None:
            time.sleep(0.1)
            run()

        Thread(target=run_late).start()

    monkeypatch.setattr(progress, "start_new_thread", begin_late)
    monkeypatch.setattr(progress.WaitNotice, "_print_wait", lambda _: events.append("thread"))
    for _ in range(2):
        with progress.show_wait("studio_stops", "en") as notice:
            notice.cancel()
        events.append("wait")
    assert events == ["thread", "wait"] * 2


def test_a_long_live_line_and_its_warnings_are_reported_once(
    pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    outputs = {}
    for words in (["live", "M(80, 80);W(100);M(0, 0)"], ["live", "F(0.1, 80)"]):
        terminal = Terminal(*words, "--port", pty_robot.port)
        if "100" in words[1]:
            terminal.until("The line is running. Ctrl-C stops the robot.")
            terminal.interrupt()
        code = terminal.end()
        outputs[code] = "\n".join(terminal.whole())
    assert "running" not in outputs[0] and "confirmed" in outputs[2]
    assert outputs[2].count("This takes 100 seconds") == 1


@pytest.mark.parametrize("moment", ["handle_signals", "say_aside"])
def test_the_studio_reports_what_its_shutdown_waits_for(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, moment: str
) -> None:
    """Whenever that is, before its server has begun too."""
    watch_output(monkeypatch)
    output = ""

    class Silent(Hosting):
        def close(self) -> list[str]:
            def has_been_printed() -> bool:
                nonlocal output
                output += capsys.readouterr().err
                return "Waiting for the robots to confirm that they have stopped …\n" in output

            until(has_been_printed, "the sentence")
            return ["/dev/x"]

    def raise_interrupt(*arguments: object, **values: object) -> None:
        monkeypatch.undo()
        watch_output(monkeypatch)
        raise KeyboardInterrupt

    monkeypatch.setattr(studio, "Hosting", Silent)
    monkeypatch.setattr(studio, moment, raise_interrupt)
    monkeypatch.setattr(serving, "is_built", lambda: True)
    monkeypatch.setattr(serving, "files", dict)
    monkeypatch.setattr(building, "is_possible", lambda: False)
    assert main(["studio", "--listen", "0", "--no-browser"]) == 0
    assert "/dev/x has not confirmed the stop" in capsys.readouterr().err
