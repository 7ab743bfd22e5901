"""Another user of this computer does not get through to a virtual robot."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.cli.test_virtual_command import robot, visitor
from tests.support.virtual_robot import missing as no_wasm
from tiniscript.sharing import peers
from tiniscript.virtual.transports import Transports

linux = pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells the user")
NOBODY = 65534
LINE = b"SI|F(0.1,50)\r\n"
# Says a line as another user; then hangs up at once, resets the connection, or stays.
STRANGER = """
import encodings.idna, os, socket, struct, sys
os.setgid(65534); os.setuid(65534)
peer = socket.create_connection(("127.0.0.1", int(sys.argv[1])))
if sys.argv[2] == "reset":
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
peer.sendall(bytes.fromhex(sys.argv[3]))
if sys.argv[2] == "stays":
    peer.settimeout(20)
    try:
        print(len(peer.recv(100)))
    except ConnectionError:
        print(0)
peer.close()
"""


def pair() -> tuple[socket.socket, socket.socket]:
    with socket.create_server(("127.0.0.1", 0)) as server:
        there = socket.create_connection(server.getsockname())
        return server.accept()[0], there


@linux
def test_the_end_of_a_connection_has_its_user() -> None:
    here, there = pair()
    with here, there:
        assert peers._other_end(here.getpeername(), here.getsockname()) == (1, os.geteuid())
        assert peers.is_of_this_user(here)
        there.shutdown(socket.SHUT_WR)  # it listens on
        assert os.geteuid() == 0 or peers.is_of_this_user(here)


@linux
def test_whoever_has_hung_up_can_have_been_anybody() -> None:
    here, there = pair()
    with here:
        there.sendall(LINE)
        there.close()
        found = peers._other_end(here.getpeername(), here.getsockname())
        assert found.user == 0 and not found.is_open


@linux
@pytest.mark.parametrize(("state", "user", "is_let_in"), [
    (1, 0, True),  # root has every right
    (5, 0, False),
    (1, NOBODY, False),
    (5, NOBODY, False),
])  # fmt: skip
def test_which_ends_are_let_in(
    monkeypatch: pytest.MonkeyPatch, state: int, user: int, is_let_in: bool
) -> None:
    monkeypatch.setattr(os, "geteuid", lambda: 1234)
    monkeypatch.setattr(peers, "_other_end", lambda there, here: peers.End(state, user))
    here, there = pair()
    with here, there:
        assert peers.is_of_this_user(here) == is_let_in
        monkeypatch.setattr(peers, "_other_end", lambda there, here: peers.End(state, 1234))
        assert peers.is_of_this_user(here)


def test_a_system_that_does_not_tell_lets_in(monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown(there: object, here: object) -> peers.End:
        raise OSError(95, "not supported")

    def gone(there: object, here: object) -> peers.End:
        raise FileNotFoundError(2, "gone")

    here, there = pair()
    with here, there:
        monkeypatch.setattr(peers, "_other_end", unknown)
        assert peers.is_of_this_user(here)
        monkeypatch.setattr(sys, "platform", "linux")
        monkeypatch.setattr(peers, "_other_end", gone)
        assert not peers.is_of_this_user(here)


@linux
@pytest.mark.skipif(os.geteuid() != 0, reason="only root can be another user")
@pytest.mark.skipif(bool(no_wasm()), reason=no_wasm() or "there is wasmtime")
@pytest.mark.parametrize("how", ["stays", "leaves", "reset"])
def test_another_user_moves_nothing(how: str) -> None:
    with robot("--listen", "0") as found:
        words = [
            sys.executable,
            "-I",
            "-c",
            STRANGER,
            found.port.rpartition(":")[2],
            how,
            LINE.hex(),
        ]
        for _ in range(3):
            done = subprocess.run(words, capture_output=True, text=True, timeout=60)
            assert done.returncode == 0, done.stderr
            assert done.stdout.strip() == ("0" if how == "stays" else "")
        time.sleep(1)
        with visitor(found.port) as own:
            own.settimeout(30)
            own.sendall(LINE)
            heard = b""
            while not heard.endswith(b"// DONE\r\n"):
                heard += own.recv(1000)
        assert found.until("DONE")[1:] == ["0 MOTORS 50 50", "100 MOTORS 0 0", "100 DONE"]


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="no pseudo-terminals here")
def test_a_pseudo_terminal_is_for_its_user_alone() -> None:
    transports = Transports(has_terminal=True)
    try:
        assert Path(transports.terminal).stat().st_mode & 0o777 == 0o600
    finally:
        transports.close()
