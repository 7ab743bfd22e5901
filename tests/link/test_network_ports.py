"""A robot's port on another computer: `socket://` and `rfc2217://`; and which ports are radios."""

from __future__ import annotations

import socket
import threading
from types import SimpleNamespace

import pytest
import serial
from serial.rfc2217 import PortManager

from tests.support.command import run_subprocess
from tests.support.pty_robot import PtyRobot
from tiniscript import robots
from tiniscript.link import ports


class Modemless(serial.Serial):  # type: ignore[misc]
    """A pseudo-terminal: it has none of the lines of a modem."""

    cts = dsr = ri = cd = False

    def _nothing(self) -> None:
        pass

    _update_dtr_state = _update_rts_state = _update_break_state = _nothing


def serve(tcp: socket.socket, port: str, is_rfc2217: bool) -> None:
    """Pass bytes between one peer and a port, until the peer leaves."""
    peer, _ = tcp.accept()
    device = Modemless(port, 9600, timeout=0.005)
    manager = PortManager(device, SimpleNamespace(write=peer.sendall)) if is_rfc2217 else None
    has_left = threading.Event()

    def send_replies() -> None:
        while not has_left.is_set():
            data = device.read(200)
            if data:
                peer.sendall(b"".join(manager.escape(data)) if manager else data)

    sender = threading.Thread(target=send_replies, daemon=True)
    sender.start()
    while data := peer.recv(1000):
        device.write(b"".join(manager.filter(data)) if manager else data)
    has_left.set()
    sender.join()
    device.close()
    peer.close()


@pytest.mark.parametrize("protocol", ["socket", "rfc2217"])
def test_a_robot_is_reached_over_a_network(protocol: str) -> None:
    with (
        PtyRobot(robots.load("tinibot").kit) as pty_robot,
        socket.create_server(("127.0.0.1", 0)) as tcp,
    ):
        server = threading.Thread(
            target=serve, args=(tcp, pty_robot.port, protocol == "rfc2217"), daemon=True
        )
        server.start()
        address = f"{protocol}://127.0.0.1:{tcp.getsockname()[1]}"
        result = run_subprocess("upload", "-e", "SI|F(0.2, 50);SHOW(1.5)", "--port", address).gives(
            0, ""
        )
        assert result.out.splitlines()[1:3] == ["SHOW 1.5", "Done."]
        assert pty_robot.actions == ["MOTORS 50 50", "MOTORS 0 0", "FINISHED"]
        server.join(10)
        assert run_subprocess("doctor", "--ports").out.count(address) == 1


@pytest.mark.parametrize(("system", "port", "is_radio"), [
    ("linux", "/dev/ttyUSB0", False),
    ("linux", "/dev/rfcomm0", True),
    ("linux", "socket://localhost:1", True),
    ("darwin", "/dev/tty.usbserial-1410", False),
    ("darwin", "/dev/cu.wchusbserial1410", False),
    ("darwin", "/dev/tty.HC-05", True),
    ("win32", "COM3", False),
    ("win32", "COM5", True),
])  # fmt: skip
def test_a_radio_is_recognized_by_its_port(
    system: str, port: str, is_radio: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    wires = [
        SimpleNamespace(device="COM3", description="n/a", hwid="USB VID:PID=1A86:7523"),
        SimpleNamespace(device="COM5", description="n/a", hwid="BTHENUM\\{00001101-0000}"),
    ]
    monkeypatch.setattr("serial.tools.list_ports.comports", lambda: wires)
    monkeypatch.setattr(ports, "sys", SimpleNamespace(platform=system))
    assert ports.is_radio(port) == is_radio
