"""`tsc stop` as people use it: twice, at the same time, and without an answer."""

from __future__ import annotations

import json
import re
import signal
from typing import cast
from unittest import mock

import pytest

from tests.support.command import FOREVER, Command, run_subprocess
from tests.support.pty_robot import PtyRobot, on, start_endless_upload
from tests.support.waiting import until
from tiniscript.cli.texts import text
from tiniscript.library import opening
from tiniscript.library.errors import RobotError
from tiniscript.link import holders
from tiniscript.link.port_connection import PortConnection
from tiniscript.link.sharing import registry
from tiniscript.link.transmission import CONFIRM_MS


def takes_no_wait(pty_robot: PtyRobot, *arguments: str) -> bool:
    """Run `tsc` on the robot's port; return whether it took less than a stop is waited for."""
    start_ms = pty_robot.robot_ms
    assert on(pty_robot, *arguments).code == 0
    return pty_robot.robot_ms - start_ms < CONFIRM_MS


@pytest.mark.parametrize("is_shared", [False, True])
def test_a_second_stop_is_confirmed_like_the_first(
    pty_robot: PtyRobot, is_shared: bool, request: pytest.FixtureRequest
) -> None:
    if is_shared:
        request.getfixturevalue("link")
    assert on(pty_robot, "upload", "-e", FOREVER, "--detach").code == 0
    assert pty_robot.moves
    for _ in range(3):
        assert takes_no_wait(pty_robot, "stop")
        assert not pty_robot.moves
    assert on(pty_robot, "doctor").code == 0


def test_a_robot_that_its_button_has_started_again_is_stopped(pty_robot: PtyRobot) -> None:
    assert on(pty_robot, "upload", "-e", "SB|F(60, 80)").code == 0
    for _ in range(2):
        assert on(pty_robot, "stop").code == 0
        pty_robot.push()
        pty_robot.until(lambda: pty_robot.moves, "its button starts it")
        assert on(pty_robot, "stop").code == 0
        assert not pty_robot.moves


@pytest.mark.parametrize("is_shared", [False, True])
def test_simultaneous_stops_are_all_confirmed(pty_robot: PtyRobot, is_shared: bool) -> None:
    server = start_endless_upload(pty_robot) if is_shared else None
    stops = [Command("stop", "--port", pty_robot.port) for _ in range(3)]
    results = [command.wait_for_result() for command in stops]
    assert [(result.code, result.err) for result in results] == [(0, "")] * 3
    assert not pty_robot.moves
    if server is not None:
        assert server.wait_for_result().code == 3


def test_an_unconfirmed_stop_delays_nobody_for_long(pty_robot: PtyRobot, link: Command) -> None:
    pty_robot.switch_off()
    on(pty_robot, "stop").gives(3, "has not confirmed")
    pty_robot.switch_on()
    link.until("is back")
    assert takes_no_wait(pty_robot, "doctor")
    assert on(pty_robot, "stop").code == 0


@pytest.mark.parametrize(("verb", "is_patient"), [("stop", True), ("start", False)])
def test_a_stop_waits_for_a_port_longer_than_others(
    verb: str, is_patient: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another command has it that looks for a silent robot for 8.5 s, and does not share it."""
    now_s = [0.0]
    monkeypatch.setattr(opening, "monotonic", lambda: now_s[0])
    monkeypatch.setattr(opening, "sleep", lambda wait_s: now_s.append(now_s.pop() + wait_s))
    line = cast(PortConnection, object())

    def open_line(*_: object) -> PortConnection:
        if now_s[0] < 8.5:
            raise RobotError("port_busy", "en", {"port": "/dev/ttyUSB7", "why": ""})
        return line

    monkeypatch.setattr(opening, "_open_connection", open_line)
    if is_patient:
        assert opening.connection_to("/dev/ttyUSB7", verb, 9600, 1) is line
    else:
        with pytest.raises(RobotError):
            opening.connection_to("/dev/ttyUSB7", verb, 9600, 1)


@pytest.mark.parametrize("language", ["en", "es"])
def test_no_message_suggests_the_button_of_a_robot_that_may_be_stopped(language: str) -> None:
    sentence = text("not_confirmed", language)
    assert not re.search(r"(?<!not )press its button|pulsa su botón", sentence)
    assert re.search(r"batter|pilas", sentence)


def test_the_doctor_reports_uart_errors(pty_robot: PtyRobot) -> None:
    fields = json.loads(on(pty_robot, "doctor", "--json").out)["robot"]
    assert (fields["framing"], fields["overrun"]) == (0, 0)
    assert "framing" not in on(pty_robot, "doctor").out
    fields = json.loads(on(pty_robot, "doctor", "--json", "--count", "1").out)["robot"]
    assert (fields["framing"], fields["overrun"]) == (0, 0)


# -- past a holder that does not answer -----------------------------------------------------------


def suspend(command: Command) -> Command:
    """Return a command after Ctrl-Z."""
    command.signal(signal.SIGSTOP)
    until(lambda: holders.is_suspended(command.process.pid), "it is suspended")
    return command


# A reader is woken for bytes and reads them a little later, when another one may have taken them.
TOLD_SCRIPT = """
import select, sys, time
from tiniscript.cli import main
waited = select.select
def told(readers, *others):
    found = waited(readers, *others)
    if found[0]:
        time.sleep(0.3)
    return found
select.select = told
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.parametrize("code", ["", TOLD_SCRIPT], ids=["anywhere", "before it reads"])
@pytest.mark.parametrize("verb", ["monitor", "monitor --hold"])
def test_a_stop_gets_through_beside_a_suspended_tsc(
    pty_robot: PtyRobot, verb: str, code: str
) -> None:
    assert on(pty_robot, "upload", "-e", FOREVER, "--detach").code == 0
    pty_robot.received = b""
    holder = Command(*verb.split(), "--port", pty_robot.port, code=code)
    until(lambda: registry.find_registration(pty_robot.port) is not None, "it shares its port")
    pty_robot.until(lambda: b"\x04" in pty_robot.received, "it talks to the robot")
    suspend(holder)
    assert pty_robot.moves
    for _ in range(2):
        on(pty_robot, "stop").gives(0, "", out="has confirmed the stop")
        assert not pty_robot.moves
    assert holders.is_suspended(holder.process.pid)
    holder.signal(signal.SIGCONT)
    # It shares the port as before. Requests made before it learned of the stop are answered so.
    until(lambda: "SHOW 4" in on(pty_robot, "live", "SHOW(4)").out, "others drive")
    holder.signal(signal.SIGINT)
    assert holder.wait_for_result().code == 0


LOCK_SCRIPT = """
import fcntl, os, sys, time
port = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY)
fcntl.flock(port, fcntl.LOCK_EX)
print("locked", flush=True)
time.sleep(1000)
"""


def test_a_stop_gets_past_the_lock_of_another_suspended_program(pty_robot: PtyRobot) -> None:
    """A running command may be writing firmware, so it is named."""
    assert on(pty_robot, "upload", "-e", FOREVER, "--detach").code == 0
    holder = Command(pty_robot.port, code=LOCK_SCRIPT)
    holder.until("locked")
    heard_bytes = pty_robot.received
    with mock.patch.object(opening, "STOP_BUSY_TIMEOUT_S", 0.2):
        on(pty_robot, "stop").gives(3, f"(process {holder.process.pid})", "lift it")
    assert pty_robot.received == heard_bytes and pty_robot.moves
    suspend(holder)
    on(pty_robot, "start").gives(3, "another program is using")
    on(pty_robot, "stop").gives(0, "", out="has confirmed the stop")
    assert not pty_robot.moves
    holder.kill()


BRIDGE = """
import socket, sys, threading, serial
tcp = socket.create_server(("127.0.0.1", 0))
print(tcp.getsockname()[1], flush=True)
device = serial.Serial(sys.argv[1], timeout=0.005)
peers = []
def back():
    while True:
        data = device.read(200)
        for peer in list(peers):
            peer.sendall(data)
threading.Thread(target=back, daemon=True).start()
peer, _ = tcp.accept()
peers.append(peer)
while data := peer.recv(1000):
    device.write(data)
"""


def test_the_suspended_holder_of_an_address_is_woken(pty_robot: PtyRobot) -> None:
    """No other command can reach the robot."""
    assert on(pty_robot, "upload", "-e", FOREVER, "--detach").code == 0
    bridge = Command(pty_robot.port, code=BRIDGE)
    assert bridge.process.stdout
    address = f"socket://127.0.0.1:{int(bridge.process.stdout.readline())}"
    holder = Command("monitor", "--port", address)
    until(lambda: registry.find_registration(address) is not None, "it shares the address")
    suspend(holder)
    run_subprocess("stop", "--port", address).gives(0, "", out="has confirmed the stop")
    assert not pty_robot.moves
    holder.kill()
    bridge.kill()


@pytest.mark.parametrize("is_known", [True, False])
def test_the_process_that_delays_a_stop_is_named(
    is_known: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    now_s = [0.0]
    monkeypatch.setattr(opening, "monotonic", lambda: now_s[0])
    monkeypatch.setattr(opening, "sleep", lambda wait_s: now_s.append(now_s.pop() + wait_s))
    woken = []

    class Asleep(holders.Holder):
        is_suspended = True

        def wake(self) -> bool:
            woken.append(self.pid)
            return False

    sleeper = Asleep(77, "tsc monitor") if is_known else None
    monkeypatch.setattr(holders, "find_holder", lambda *_: sleeper)

    def busy(*_: object, **__: object) -> PortConnection:
        raise RobotError("port_busy", "en", {"port": "/dev/ttyUSB7", "why": ""})

    monkeypatch.setattr(opening, "_open_connection", busy)
    with pytest.raises(RobotError) as exception_info:
        opening.connection_to("/dev/ttyUSB7", "stop", 9600, 1)
    message = str(exception_info.value)
    assert ("tsc monitor (process 77)" in message) == is_known
    assert "lift it" in message and "batteries" in message
    assert bool(woken) == is_known


def test_a_process_that_has_ended_holds_nothing() -> None:
    command = Command("--version")
    pid = command.process.pid
    command.wait_for_result()
    assert not holders.is_suspended(pid)
    assert holders.find_holder("/nowhere", pid) is None
