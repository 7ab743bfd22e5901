"""When the reader of tsc's output has gone, there is one exit code, and no robot drives unseen."""

from __future__ import annotations

import fcntl
import os
import signal
import subprocess
import sys
import termios
from argparse import Namespace
from array import array
from contextlib import suppress
from pathlib import Path
from time import sleep
from typing import Any

import pytest

from tests.support.command import FOREVER, PROGRAM, TSC, Command, run_in_process
from tests.support.pty_robot import PtyRobot, on
from tests.support.robot_fleet import RobotFleet
from tests.support.waiting import HANG_LIMIT_S, until
from tiniscript import robots
from tiniscript.cli import EXIT_OF_CLOSED_PIPE, streams
from tiniscript.cli.robot import connect, fleet
from tiniscript.library import opening
from tiniscript.link.messages import STATUSES, STOP_ZEROS
from tiniscript.link.payloads import SentReply
from tiniscript.link.requests import Reply, reply_of

SHOW_PROGRAM = "SI|LOOP(FOREVER);F(0.1, 80);SHOW(1);END_LOOP"


def after_lines(count: int, *words: str, joins_err: bool = False) -> tuple[int, str]:
    """Read so many lines of a command, close its output; return its exit code and its errors."""
    err = subprocess.STDOUT if joins_err else subprocess.PIPE
    with subprocess.Popen([*TSC, *words], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=err) as process:  # fmt: skip
        assert process.stdout
        for _ in range(count):
            assert process.stdout.readline()
        process.stdout.close()
        err_text = process.stderr.read().decode() if process.stderr else ""
        return process.wait(HANG_LIMIT_S), err_text


@pytest.mark.parametrize(("lines", "extra_options"), [(0, []), (1, ["--json"]), (3, [])])
def test_upload_into_a_pipe_that_closes_stops_the_robot(
    pty_robot: PtyRobot, lines: int, extra_options: list[str]
) -> None:
    code, err = after_lines(
        lines, "upload", "-e", SHOW_PROGRAM, "--port", pty_robot.port, *extra_options
    )
    assert code == EXIT_OF_CLOSED_PIPE
    assert err.count("\n") == 1 and "stopped the robot" in err
    pty_robot.until(lambda: not pty_robot.moves, "it stands")


def test_a_program_that_prints_nothing_is_also_stopped(pty_robot: PtyRobot) -> None:
    """The program is endless, and tsc has no output whose writing could fail."""
    port_option = ("--port", pty_robot.port)
    for words in (("upload", "-e", FOREVER), ("start",)):
        code, err = after_lines(1, *words, *port_option)
        assert code == EXIT_OF_CLOSED_PIPE
        assert err.count("\n") == 1 and "stopped the robot" in err
        assert not pty_robot.moves
    code, err = after_lines(0, "live", FOREVER.removeprefix("SI|"), *port_option)
    assert code == EXIT_OF_CLOSED_PIPE and "stopped the robot" in err


def test_many_robots_whose_programs_print_nothing_are_stopped() -> None:
    with RobotFleet([robots.load("tinibot").kit] * 2) as room:
        port_options = [word for pupil in room.pupils for word in ("--port", pupil.port)]
        code, _ = after_lines(0, "upload", "-e", FOREVER, *port_options)
        assert code == EXIT_OF_CLOSED_PIPE
        room.until(lambda: not any(pupil.moves for pupil in room.pupils), "all stand")


def test_a_slow_reader_and_a_file_do_not_count_as_a_closed_pipe(
    pty_robot: PtyRobot, tmp_path: Path
) -> None:
    words = ["upload", "-e", "SI|F(1, 80)", "--port", pty_robot.port]
    with (tmp_path / "said").open("wb") as file:
        assert subprocess.run([*TSC, *words], stdout=file, timeout=HANG_LIMIT_S).returncode == 0
    with subprocess.Popen([*TSC, *words], stdout=subprocess.PIPE) as process:
        assert process.wait(HANG_LIMIT_S) == 0
        assert process.stdout and b"Done." in process.stdout.read()


def test_a_save_is_finished_before_the_stop(pty_robot: PtyRobot) -> None:
    """The program drives without a pause, so saving waits for the stop."""
    moves = "".join(f"M({k}, 50);W(0.01);" for k in range(1, 50))
    words = ["upload", "-e", f"SI|LOOP(FOREVER);{moves}SHOW(1);END_LOOP", "--port", pty_robot.port]
    code, err = after_lines(1, *words)
    assert code == EXIT_OF_CLOSED_PIPE and err.count("\n") == 1 and "stopped the robot" in err
    pty_robot.power_cycle()
    on(pty_robot, "show").gives(0, out="SHOW")


def test_start_live_and_both_streams(pty_robot: PtyRobot) -> None:
    port_option = ("--port", pty_robot.port)
    assert after_lines(1, "upload", "-e", SHOW_PROGRAM, *port_option, joins_err=True) == (
        EXIT_OF_CLOSED_PIPE,
        "",
    )
    pty_robot.until(lambda: not pty_robot.moves, "it stands")
    code, err = after_lines(2, "start", *port_option)
    assert code == EXIT_OF_CLOSED_PIPE and "stopped the robot" in err
    code, err = after_lines(1, "live", "LOOP(FOREVER);F(0.1, 80);SHOW(1);END_LOOP", *port_option)
    assert code == EXIT_OF_CLOSED_PIPE and "stopped the robot" in err
    pty_robot.until(lambda: not pty_robot.moves, "it stands")


def test_detached_programs_continue(pty_robot: PtyRobot) -> None:
    port_option = ("--port", pty_robot.port)
    code, err = after_lines(0, "upload", "-e", SHOW_PROGRAM, "--detach", *port_option)
    assert (code, err) == (EXIT_OF_CLOSED_PIPE, "")
    assert pty_robot.moves
    code, err = after_lines(0, "doctor", *port_option)
    assert (code, err) == (EXIT_OF_CLOSED_PIPE, "")
    assert pty_robot.moves
    code, err = after_lines(2, "monitor", *port_option)
    assert code == EXIT_OF_CLOSED_PIPE and "stopped" not in err
    pty_robot.until(lambda: pty_robot.moves, "it drives on")


def test_many_robots_are_stopped() -> None:
    """All stop at once, not only by their timers a second later."""
    with RobotFleet([robots.load("tinibot").kit] * 3) as room:
        port_options = [word for pupil in room.pupils for word in ("--port", pupil.port)]
        code, _ = after_lines(4, "upload", "-e", SHOW_PROGRAM, *port_options)
        assert code == EXIT_OF_CLOSED_PIPE
        room.until(lambda: not any(pupil.moves for pupil in room.pupils), "all stand")
        for pupil in room.pupils:
            assert any(line.startswith("MOTORS") for line in pupil.actions)
            assert bytes(STOP_ZEROS) in pupil.received


@pytest.mark.parametrize(("verb", "is_detached", "is_stopped"), [
    ("upload", False, True), ("upload", True, False), ("doctor", False, False),
])  # fmt: skip
def test_only_robots_that_a_command_drives_are_stopped(
    monkeypatch: pytest.MonkeyPatch, verb: str, is_detached: bool, is_stopped: bool
) -> None:
    """`tsc doctor --all | head` leaves running robots alone."""
    stopped_ports: list[str] = []

    def break_pipe(self: fleet.Fleet, table: object) -> None:
        raise BrokenPipeError

    monkeypatch.setattr(fleet.Fleet, "start_work", lambda self, work: None)
    monkeypatch.setattr(fleet.Fleet, "print_until_done", break_pipe)
    monkeypatch.setattr(fleet.Fleet, "interrupt_robots", lambda self: stopped_ports.append(verb))
    monkeypatch.setattr(opening, "CONFIRM_TIMEOUT_S", 0.0)
    options = Namespace(verb=verb, detach=is_detached, json=True, ports=["/x", "/y"], all=False)
    with pytest.raises(BrokenPipeError):
        fleet.run_together(options, robots.load("tinibot"), "en", lambda *_: pytest.fail("begun"))
    assert bool(stopped_ports) == is_stopped


def test_a_full_disk_also_stops_the_robot(pty_robot: PtyRobot) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("this system has no full device")
    with Path("/dev/full").open("wb") as full:
        completed = subprocess.run([*TSC, "upload", "-e", SHOW_PROGRAM, "--port", pty_robot.port],
                                   stdout=full, stderr=subprocess.PIPE,
                                   timeout=HANG_LIMIT_S)  # fmt: skip
    assert completed.returncode == 2
    err = completed.stderr.decode()
    assert "stopped the robot" in err and "cannot write the output" in err
    assert "Traceback" not in err


@pytest.mark.parametrize(
    "words",
    [["check", "--explain"], ["--help"], ["compile", "-e", PROGRAM, "-o", "-"],
     ["check", "-e", "F(1"], ["complie"]],
)  # fmt: skip
def test_each_kind_of_output_has_the_same_exit_code(words: list[str]) -> None:
    """None of its output is read: text, bytes, or mistakes."""
    read_end, write_end = os.pipe()
    os.close(read_end)
    try:
        completed = subprocess.run([*TSC, *words], stdin=subprocess.DEVNULL, stdout=write_end,
                              stderr=write_end, timeout=HANG_LIMIT_S)  # fmt: skip
    finally:
        os.close(write_end)
    assert completed.returncode == EXIT_OF_CLOSED_PIPE


# -- a port that vanishes -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "request_number"), [(["set", "name", "TINI"], 1), (["set", "trim", "--reset"], 2)]
)
def test_a_port_that_vanishes_is_not_reported_as_a_bug(
    pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch, words: list[str], request_number: int
) -> None:
    """The cable is pulled before the robot has confirmed a save."""
    real_call = connect.Connection.begin_request
    requests = []

    def ask_and_pull(
        self: connect.Connection, make_request: Any, limit_ms: int | None = None
    ) -> Any:
        if limit_ms is None:  # a request after HELLO
            requests.append(make_request)
        if len(requests) == request_number:
            pty_robot.pull()
        return real_call(self, make_request, limit_ms)

    monkeypatch.setattr(connect.Connection, "begin_request", ask_and_pull)
    result = run_in_process(*words, "--port", pty_robot.port)
    assert len(requests) == request_number
    assert result.code == 3
    assert "is gone" in result.err


def test_a_robot_that_is_busy_for_too_long_is_not_lost(
    pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The user is told that it is saving, and the next step."""

    def busy(name: str, payload: bytes) -> Reply[SentReply] | None:
        reply = reply_of(name, payload)
        return Reply(STATUSES["BUSY"]) if name in ("PROGRAM", "START") else reply

    monkeypatch.setattr("tiniscript.link.session.reply_of", busy)
    monkeypatch.setattr("tiniscript.library.client.REQUEST_TIMEOUT_MS", 600)
    for language, expected in (("en", "still saving"), ("es", "está guardando")):
        for words in (["upload", "-e", PROGRAM], ["start"]):
            result = run_in_process(*words, "--port", pty_robot.port, "--lang", language).gives(3)
            assert (
                expected in result.err and "lost" not in result.err and "perdió" not in result.err
            )


# -- an output without a reader --------------------------------------------------------------------

TALKING_PROGRAM = "SI|LOOP(FOREVER);M(40, 40);SHOW(12345);W(0.01);END_LOOP"
PIPE_BYTES = 4096
BUFFERED = {"PYTHONUNBUFFERED": ""}  # as users have it: without a buffer no last flush waits


def start_unread_command(*words: str, data: bytes = b"") -> Command:
    """Return a command whose pipe is full."""
    command = Command(*words, data=data, env=BUFFERED)
    fill_pipe(command)
    return command


def fill_pipe(command: Command) -> None:
    """Read no more of what a command prints, until it waits for the reader of a full pipe."""
    pipe = command.process.stdout
    assert pipe
    fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, PIPE_BYTES)
    counts = [0]

    def is_stuck() -> bool:
        count = array("i", [0])
        fcntl.ioctl(pipe, termios.FIONREAD, count)
        counts.append(count[0])
        sleep(0.1)
        return counts[-1] > PIPE_BYTES - 100 and counts[-3:] == 3 * counts[-1:]

    until(is_stuck, "it waits")


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux says how large a pipe is")
@pytest.mark.parametrize("extra_options", [[], ["--json"]])
def test_a_fleet_with_unread_output_ends_with_ctrl_c(extra_options: list[str]) -> None:
    with RobotFleet([robots.load("tinibot").kit] * 3) as room:
        port_options = [word for pupil in room.pupils for word in ("--port", pupil.port)]
        command = start_unread_command(
            "upload", "-e", TALKING_PROGRAM, *port_options, *extra_options
        )
        assert any(pupil.moves for pupil in room.pupils)
        command.signal(signal.SIGINT)
        assert command.process.wait(HANG_LIMIT_S) == 2
        room.until(lambda: not any(pupil.moves for pupil in room.pupils), "all stand")
        assert all(bytes(STOP_ZEROS) in pupil.received for pupil in room.pupils)
        result = command.wait_for_result()
        assert result.out and "Traceback" not in result.err


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux says how large a pipe is")
@pytest.mark.parametrize("verb", ["upload", "start", "live", "monitor", "monitor --hold"])
def test_a_command_with_unread_output_ends_with_ctrl_c(pty_robot: PtyRobot, verb: str) -> None:
    if verb not in ("upload", "live"):
        assert on(pty_robot, "upload", "-e", TALKING_PROGRAM, "--detach").code == 0
    words = [*verb.split(), "--port", pty_robot.port]
    if verb == "upload":
        words += ["-e", TALKING_PROGRAM]
    line = TALKING_PROGRAM.removeprefix("SI|").encode() + b"\n"
    command = start_unread_command(*words, data=line if verb == "live" else b"")
    command.signal(signal.SIGINT)
    assert command.process.wait(HANG_LIMIT_S) in (0, 2)
    if "monitor" not in verb:
        pty_robot.until(lambda: not pty_robot.moves, "it stands")
    assert "Traceback" not in command.wait_for_result().err


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux says how large a pipe is")
@pytest.mark.parametrize("signal_number", [signal.SIGINT, signal.SIGTERM])
def test_a_virtual_robot_with_unread_output_ends(signal_number: signal.Signals) -> None:
    command = Command("robot", env=BUFFERED)
    assert command.process.stdout
    address = command.process.stdout.readline().decode().strip()
    on_robot = ("upload", "-e", TALKING_PROGRAM, "--detach", "--port", address)
    assert run_in_process(*on_robot).code == 0
    fill_pipe(command)
    command.signal(signal_number)
    assert command.process.wait(HANG_LIMIT_S) == 0
    assert "Traceback" not in command.wait_for_result().err


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such pipes")
@pytest.mark.parametrize("reader", ["reads", "is slow", "has gone"])
@pytest.mark.parametrize("stream", ["stdout", "stderr"])
def test_an_interrupted_command_leaves_a_shared_pipe_as_it_was(
    monkeypatch: pytest.MonkeyPatch, stream: str, reader: str
) -> None:
    """In `(tsc upload prog; echo done) | less`, the next command may wait for the reader."""
    monkeypatch.setattr(streams, "READER_TIMEOUT_S", 0.0)
    end, pipe = os.pipe()
    shared_pipe = os.dup(pipe)
    if reader == "is slow":
        os.set_blocking(pipe, False)
        with suppress(BlockingIOError):
            while True:
                os.write(pipe, bytes(4096))
        os.set_blocking(pipe, True)
    with os.fdopen(pipe, "w") as file:
        monkeypatch.setattr(sys, stream, file)
        if reader == "has gone":
            os.close(end)
        for _ in range(2):
            streams.drop_unread_output()
            assert os.get_blocking(shared_pipe) and os.get_blocking(pipe)
        monkeypatch.undo()
    os.close(shared_pipe)
    if reader != "has gone":
        os.close(end)
