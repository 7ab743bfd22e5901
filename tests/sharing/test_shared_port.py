"""One port for many commands: its holder lets the others use its session."""

from __future__ import annotations

import json
import signal
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.support.command import FOREVER, LONG_PROGRAM, Command, run_subprocess
from tests.support.pty_robot import PtyRobot, on, start_endless_upload
from tests.support.shared_pty_robot import SharedLine
from tiniscript import __version__, compile_text, robots
from tiniscript.bytecode.image import unpack
from tiniscript.link.frames import decode_frame
from tiniscript.link.messages import STATE_IDLE
from tiniscript.link.sharing import protocol, registry
from tiniscript.link.sharing.registry import Registration
from tiniscript.link.sharing.shared_connection import SharedConnection, join

TRY_COUNT = 8  # tries of a command whose predecessor has just left
# On a busy computer, sharing a newly opened port takes a while.
PATIENT_COMMAND_CODE = (
    "import sys; from tiniscript.cli import main; from tiniscript.library import opening; "
    "opening.BUSY_TIMEOUT_S = 100; sys.exit(main(sys.argv[1:]))"
)


def hellos(pty_robot: PtyRobot) -> int:
    """Return the number of sessions begun, which is that of openings of the port."""
    frames = map(decode_frame, pty_robot.received.split(b"\0"))
    return sum(frame is not None and frame.number == 1 for frame in frames)


# -- others' abilities -----------------------------------------------------------------------------


def test_stop_works_while_another_terminal_is_driving(pty_robot: PtyRobot) -> None:
    command = start_endless_upload(pty_robot)
    result = on(pty_robot, "stop")
    assert (result.code, result.out) == (
        0, f"Stopped: the robot on {pty_robot.port} has confirmed the stop.\n",
    )  # fmt: skip
    assert not pty_robot.moves
    command.wait_for_result().gives(3, out="The robot was stopped from a computer.")
    assert hellos(pty_robot) == 1


def test_commands_share_one_session(pty_robot: PtyRobot, link: Command, tmp_path: Path) -> None:
    result = on(pty_robot, "upload", "-e", "SI|F(0.1, 80);SHOW(1.5)").gives(0, "")
    assert result.out.splitlines()[1:] == ["SHOW 1.5", "Done.", "Saved. The button starts it."]
    assert on(pty_robot, "upload", "-e", "SI|F(0.1, 30)").code == 0
    assert on(pty_robot, "live", "X = 1 / 0").code == 1
    assert "3 round trips" in on(pty_robot, "doctor", "--count", "3").out
    compiled_file, robot_file = tmp_path / "ours.bin", tmp_path / "theirs.bin"
    run_subprocess("compile", "-e", LONG_PROGRAM, "-o", compiled_file)
    assert on(pty_robot, "upload", compiled_file, "--no-run", "--no-save").code == 0
    assert on(pty_robot, "show", "-o", robot_file).code == 0
    assert robot_file.read_bytes() == compiled_file.read_bytes()
    assert (
        json.loads(on(pty_robot, "start", "--previous", "--json").out)["saved"] == "STORED"
    )  # the program was not saved
    assert on(pty_robot, "set", "name", "Ñandú").code == 0
    assert json.loads(on(pty_robot, "doctor", "--json").out)["robot"]["name"] == "Ñandú"
    assert on(pty_robot, "start").out.endswith("Done.\n")
    assert hellos(pty_robot) == 1
    link.signal(signal.SIGINT)
    link.wait_for_result().gives(0, out=("tsc upload: connected.", "SHOW 1.5"))


def test_all_names_of_a_port_lead_to_its_server(
    pty_robot: PtyRobot, link: Command, tmp_path: Path
) -> None:
    link_path = tmp_path / "by-id"
    link_path.symlink_to(pty_robot.port)
    assert run_subprocess("stop", "--port", link_path).code == 0
    assert "SHOW 2" in run_subprocess("live", "SHOW(2)", "--port", link_path).out
    assert hellos(pty_robot) == 1
    rows = json.loads(run_subprocess("doctor", "--ports", "--json").out)
    assert {row["port"]: row["held_by"] for row in rows}[pty_robot.port] == "monitor --hold"
    result = run_subprocess("doctor", "--ports", "--ask", "--port", link_path)
    assert "robot" in result.out and "in use by tsc monitor --hold" in result.out
    run_subprocess("show", "--port", link_path, "--baud", "115200").gives(
        3, "in use by tsc monitor --hold, at 9600 baud"
    )
    run_subprocess("monitor", "--hold", "--port", link_path).gives(
        3, "already shared, by tsc monitor --hold"
    )


BRIDGE = """
import socket, threading, serial
tcp = socket.create_server(("127.0.0.1", 0))
print(tcp.getsockname()[1], flush=True)
peer, _ = tcp.accept()
device = serial.Serial({port!r}, timeout=0.005)
def back():
    while True:
        peer.sendall(device.read(200))
threading.Thread(target=back, daemon=True).start()
while data := peer.recv(1000):
    device.write(data)
"""


@pytest.fixture
def address(pty_robot: PtyRobot) -> Iterator[str]:
    """A network address connected to the robot."""
    bridge = Command(code=BRIDGE.format(port=pty_robot.port))
    assert bridge.process.stdout
    yield f"socket://127.0.0.1:{int(bridge.process.stdout.readline())}"
    bridge.kill()


def test_an_address_is_held_like_a_port(pty_robot: PtyRobot, address: str) -> None:
    command = Command("upload", "-e", FOREVER, "--port", address.replace("127.0.0.1", "localhost"))
    command.until("running")
    assert run_subprocess("stop", "--port", address).code == 0
    assert command.wait_for_result().code == 3
    assert hellos(pty_robot) == 1


def test_a_client_may_use_a_different_robot_profile(pty_robot: PtyRobot) -> None:
    command = Command("monitor", "--port", pty_robot.port, "--robot", "grabber")
    assert command.process.stderr
    command.process.stderr.readline()  # waits until it watches
    pty_robot.ask(lambda robot: robot.set_readings(0, 0, 42_000))
    assert "DISTANCE 42" in on(pty_robot, "live", "SHOW(DISTANCE)").out
    on(pty_robot, "live", "GRIPPER(90)", "--robot", "grabber").gives(3, "--robot tinibot")
    on(pty_robot, "upload", "-e", "SHOW(LINE_L)", "--robot", "liner").gives(3, "--robot tinibot")
    command.signal(signal.SIGINT)
    assert command.wait_for_result().code == 0


def test_monitor_shows_live_events_without_bookkeeping(pty_robot: PtyRobot, link: Command) -> None:
    monitor = Command("monitor", "--port", pty_robot.port, "--json")
    assert monitor.process.stderr
    monitor.process.stderr.readline()
    live_command = Command("live", "--port", pty_robot.port)
    assert live_command.process.stdin and live_command.process.stdout
    live_command.process.stdin.write(b"X = 3; SHOW(X)\nX = X + 1\nSHOW(X)\n")
    result = live_command.wait_for_result()
    assert [line for line in result.out.splitlines() if line != "Done."] == ["X 3", "X 4"]
    assert monitor.process.stdout
    rows = [json.loads(monitor.process.stdout.readline()) for _ in range(5)]
    assert [(row["event"], row.get("value")) for row in rows] == [
        ("SHOW", 3), ("DONE", None), ("DONE", None), ("SHOW", 4), ("DONE", None),
    ]  # fmt: skip
    monitor.signal(signal.SIGINT)
    assert monitor.wait_for_result().out == ""


LIST_IMPORTS_CODE = (
    "import sys; from tiniscript.cli import main; assert main(sys.argv[1:]) == 0; "
    "print(' '.join(sys.modules))"
)
# Commands with a waiting person, and the modules that each must not import.
QUICK_COMMANDS = [
    pytest.param(("upload", "-e", "SI|F(0.1, 30)"), set[str](), id="upload"),
    pytest.param(("stop",), {"csv", "tiniscript.codegen", "tiniscript.semantics"}, id="stop"),
]
UNWANTED_MODULES = {"tomllib", "tomli", "rich", "ssl", "asyncio", "bleak", "zeroconf", "wasmtime",
                    "concurrent.futures", "tiniscript.cli.robot.fleet",
                    "tiniscript.cli.robot.in_reach",
                    "tiniscript.cli.robot.simulator", "tiniscript.diagnostics.rendering",
                    "tiniscript.virtual.transports", "tiniscript.vm.machine"}  # fmt: skip
PORT_MODULES = {"serial", "cobs", "threading", "tiniscript.link.session", "tiniscript.link.ports"}


@pytest.mark.parametrize(("arguments", "unwanted_modules"), QUICK_COMMANDS)
def test_a_command_imports_no_more_than_it_needs(
    pty_robot: PtyRobot, arguments: tuple[str, ...], unwanted_modules: set[str]
) -> None:
    def imported_by(port: str) -> set[str]:
        result = Command(*arguments, "--port", port, code=LIST_IMPORTS_CODE).wait_for_result()
        return set(result.out.splitlines()[-1].split())

    modules = imported_by(pty_robot.port)
    assert sorted((UNWANTED_MODULES | unwanted_modules) & modules) == []
    assert modules >= PORT_MODULES
    with SharedLine() as (shared_robot, _):
        assert (
            sorted(
                (UNWANTED_MODULES | PORT_MODULES | unwanted_modules)
                & imported_by(shared_robot.port)
            )
            == []
        )


# -- the owner of a run ---------------------------------------------------------------------------


def test_a_robot_stops_without_the_command_that_has_started_it(
    pty_robot: PtyRobot, link: Command
) -> None:
    """It stops immediately if the server sees the client leave."""
    for number, within_ms in (
        (signal.SIGKILL, 900), (signal.SIGTERM, 900), (signal.SIGSTOP, 1500),
    ):  # fmt: skip
        command = start_endless_upload(pty_robot)
        left_ms = pty_robot.robot_ms
        command.signal(number)
        pty_robot.until(lambda: not pty_robot.moves, "it stops by itself")
        assert int(pty_robot.timed_actions[-1].split()[0]) <= left_ms + within_ms, number
        on(pty_robot, "upload", "-e", "SI|F(0.1, 30)").gives(0, "")  # others drive
        command.kill()


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGHUP, signal.SIGTERM])
def test_an_upload_of_a_killed_command_starts_and_blocks_nothing(
    pty_robot: PtyRobot, link: Command, number: int, request: pytest.FixtureRequest
) -> None:
    if number != signal.SIGKILL:  # a command that nohup has begun is to outlive SIGHUP
        signal_before = signal.signal(number, signal.SIG_DFL)
        request.addfinalizer(lambda: signal.signal(number, signal_before))
    pty_robot.bytes_per_ms = 1  # a long program takes a while
    for options in ((), ("--detach",)):
        pty_robot.received = b""
        command = Command("upload", "-e", LONG_PROGRAM, *options, "--port", pty_robot.port)
        pty_robot.until(lambda: len(pty_robot.received) > 60, "a part has come")
        command.signal(number)
        command.process.wait()
        on(pty_robot, "live", "SHOW(7)").gives(0, "", out="SHOW 7")
        motor_lines = [line for line in pty_robot.actions if line.startswith("MOTORS")]
        assert set(motor_lines) <= {"MOTORS 0 0"}


def test_a_program_ends_with_its_command_unless_detached(
    pty_robot: PtyRobot, link: Command
) -> None:
    command = start_endless_upload(pty_robot)
    command.signal(signal.SIGINT)
    command.wait_for_result().gives(2, "the robot has confirmed the stop")
    assert not pty_robot.moves
    assert on(pty_robot, "upload", "-e", FOREVER, "--detach").code == 0
    pty_robot.ask(lambda robot: robot.wait(1500))
    assert pty_robot.moves
    assert on(pty_robot, "stop").code == 0
    assert not pty_robot.moves


def test_a_second_program_ends_the_first_whose_command_keeps_the_port(
    pty_robot: PtyRobot,
) -> None:
    """It runs through the first command, whose own work is over."""
    first_command = start_endless_upload(pty_robot)
    second_command = Command(
        "upload", "-e", "SI|LOOP(20);F(0.1, 30);END_LOOP", "--port", pty_robot.port
    )
    second_command.wait_for_result().gives(0, out="Done.")
    result = first_command.wait_for_result().gives(
        3, "another command started a program", "holds the port until the other command has ended."
    )
    assert result.err.index("holds the port") < result.err.index(
        "another command started a program"
    )
    assert hellos(pty_robot) == 1
    assert registry.find_registration(pty_robot.port) is None


def test_a_replaced_command_that_is_interrupted_stops_the_robot(pty_robot: PtyRobot) -> None:
    first_command = start_endless_upload(pty_robot)
    second_command = Command("upload", "-e", FOREVER, "--port", pty_robot.port)
    second_command.until("running")
    first_command.until("holds the port", is_aside=True)
    first_command.signal(signal.SIGINT)
    assert first_command.wait_for_result().code == 2
    pty_robot.until(lambda: not pty_robot.moves, "it stands")
    result = (
        second_command.wait_for_result()
    )  # it hears of the stop, or that the port's holder has ended
    assert result.code == 3
    assert "was stopped from a computer" in result.out or "has ended" in result.err, result


def test_a_stop_ends_a_program_that_a_replaced_command_holds_the_port_for(
    pty_robot: PtyRobot,
) -> None:
    first_command = start_endless_upload(pty_robot)
    second_command = Command("upload", "-e", FOREVER, "--port", pty_robot.port)
    second_command.until("running")
    first_command.until("holds the port", is_aside=True)
    assert on(pty_robot, "stop").code == 0
    assert not pty_robot.moves
    second_command.wait_for_result().gives(3, out="The robot was stopped from a computer.")
    first_command.wait_for_result().gives(3, "another command started a program")


# -- endings of a server --------------------------------------------------------------------------


def test_a_server_that_leaves_stops_the_run_of_its_client(
    pty_robot: PtyRobot, link: Command
) -> None:
    command = start_endless_upload(pty_robot)
    link.signal(signal.SIGINT)
    assert link.wait_for_result().code == 0
    assert not pty_robot.moves
    command.wait_for_result().gives(3, "(tsc monitor --hold) has ended")
    assert registry.find_registration(pty_robot.port) is None
    assert on(pty_robot, "upload", "-e", "SI|F(0.1, 30)").code == 0
    assert hellos(pty_robot) == 2


def test_a_server_that_is_killed_blocks_nobody(pty_robot: PtyRobot, link: Command) -> None:
    command = start_endless_upload(pty_robot)
    link.process.kill()
    command.wait_for_result().gives(3, "(tsc monitor --hold) has ended")
    pty_robot.until(lambda: not pty_robot.moves, "it stops by itself")
    assert registry.find_registration(pty_robot.port) is not None
    rows = json.loads(run_subprocess("doctor", "--ports", "--json").out)
    assert pty_robot.port not in [row["port"] for row in rows if row["held_by"]]
    on(pty_robot, "doctor").gives(0, "", out="LINK_LOST")
    assert registry.find_registration(pty_robot.port) is None


def test_a_stop_gets_through_while_its_server_ends(pty_robot: PtyRobot) -> None:
    """A command that arrives in between opens the port itself."""
    for wait_s in (0, 0.1):
        server = start_endless_upload(pty_robot)
        stop = Command("stop", "--port", pty_robot.port)
        time.sleep(wait_s)
        server.process.kill()
        stop.wait_for_result().gives(0, "")
        assert not pty_robot.moves
        server.process.communicate()
    assert on(pty_robot, "upload", "-e", FOREVER, "--detach").code == 0
    with socket.create_server((protocol.HOST, 0)) as holding:
        registration = Registration(
            pty_robot.port, holding.getsockname()[1], "a", "b", "link", 9600, 1
        )
        registry.write(registration)
        stop = Command("stop", "--port", pty_robot.port)
        peer, _ = holding.accept()
        with peer:
            peer.recv(1000)
            peer.sendall(protocol.encode_message({"tsc": __version__, "answer": "b"}))
            assert b"stop" in peer.recv(1000)
    assert stop.wait_for_result().code == 0
    assert not pty_robot.moves


def test_a_pulled_cable_is_reported_to_all_clients(pty_robot: PtyRobot, link: Command) -> None:
    command = start_endless_upload(pty_robot)
    pty_robot.pull()
    for held_command in (command, link):
        held_command.wait_for_result().gives(3, "is gone")


def test_a_lost_robot_is_found_again(pty_robot: PtyRobot, link: Command) -> None:
    pty_robot.switch_off()
    link.until("Looking for it")
    pty_robot.switch_on()
    link.until("is back")
    assert "SHOW 7" in on(pty_robot, "live", "SHOW(7)").out


@pytest.mark.parametrize("place", ["port", "address"])
def test_one_of_three_competing_commands_gets_the_port(
    pty_robot: PtyRobot, place: str, request: pytest.FixtureRequest
) -> None:
    port = pty_robot.port if place == "port" else request.getfixturevalue("address")
    commands = [Command("monitor", "--hold", "--port", port) for _ in range(3)]
    pty_robot.until(
        lambda: sum(command.process.poll() is not None for command in commands) == 2, "one stays"
    )
    [holder] = [command for command in commands if command.process.poll() is None]
    losers = [command.wait_for_result() for command in commands if command is not holder]
    assert [loser.code for loser in losers] == [3, 3]
    assert all("already shared" in loser.err for loser in losers)
    assert run_subprocess("stop", "--port", port).code == 0
    holder.signal(signal.SIGINT)
    result = holder.wait_for_result()
    assert (result.code, result.err) == (0, "\n")


def test_simultaneous_commands_are_all_served(pty_robot: PtyRobot) -> None:
    """A client is notified when its server leaves, and connects again."""

    def start_command(*words: str) -> Command:
        return Command(*words, "--port", pty_robot.port, code=PATIENT_COMMAND_CODE)

    command_lines = [["doctor", "--identify"]] * 3 + [["upload", "-e", "SB|S"]]
    commands = [start_command(*words) for words in command_lines]
    for words, command in zip(command_lines, commands, strict=True):
        result = command.wait_for_result()
        for _ in range(TRY_COUNT):
            if "has ended; without --detach" in result.err:
                result = start_command(*words).wait_for_result()
        assert (result.code, result.err) == (0, "")


def test_a_tsc_of_another_version_can_be_stopped(pty_robot: PtyRobot) -> None:
    newer_code = "import sys, tiniscript.base.version as own; own.__version__ = '9.1'; " + (
        "from tiniscript.cli import main; sys.exit(main(sys.argv[1:]))"
    )
    command = Command("upload", "-e", FOREVER, "--port", pty_robot.port, code=newer_code)
    command.until("running")
    for language, words in (("en", "another version of tsc, 9.1"), ("es", "otra versión, 9.1")):
        on(pty_robot, "show", "--lang", language).gives(3, words)
    assert on(pty_robot, "stop").code == 0
    assert command.wait_for_result().code == 3


def is_idle_once_released(client: SharedConnection) -> bool:
    client.wait(client.begin(lambda session: session.clear()))
    status = client.wait(client.begin(lambda session: session.status()))
    return bool(status.values.state == STATE_IDLE)


def test_a_run_begun_after_its_client_left_ends_and_blocks_nobody() -> None:
    """The frame that starts it was under way."""
    with SharedLine() as (robot, _), ExitStack() as stack:
        other_client = join(robot.port, "show --port")
        assert other_client is not None
        stack.callback(other_client.close)
        kit = robots.load("tinibot").kit
        image = unpack(compile_text(FOREVER, kit).image)
        for _ in range(5):
            client = join(robot.port, "upload")
            assert client is not None
            robot.received = b""
            client.begin(lambda session: session.upload(image, True, kit=kit.fingerprint))
            robot.until(lambda: len(robot.received) > 10, "a part of it has come")
            client.close()
            robot.until(lambda: is_idle_once_released(other_client) and not robot.moves, "it ends")
