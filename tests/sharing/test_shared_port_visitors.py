"""Visitors of a shared port, and the small effect of bad ones."""

from __future__ import annotations

import json
import socket
import stat
from contextlib import ExitStack
from pathlib import Path
from typing import Any, cast

import pytest

from tests.support.command import Command, Tsc
from tests.support.pty_robot import PtyRobot, on, start_endless_upload
from tests.support.shared_pty_robot import SharedLine
from tests.support.waiting import HANG_LIMIT_S
from tiniscript import __version__
from tiniscript.link.outcomes import ShownEvent
from tiniscript.link.payloads import DoneEvent
from tiniscript.link.sharing import protocol, registry
from tiniscript.link.sharing.registry import Registration
from tiniscript.link.sharing.server import FULL_BYTES, MAX_CLIENTS


def greeting(registration: Registration, **changes: object) -> bytes:
    message = {"tsc": __version__, "token": registration.token, "verb": "upload"}
    return protocol.encode_message({**message, **changes})


def visitor(registration: Registration) -> socket.socket:
    return socket.create_connection((protocol.HOST, registration.number), HANG_LIMIT_S)


def is_let_go(peer: socket.socket) -> bool:
    """Return whether a server closes a connection without a message."""
    try:
        return peer.recv(100) == b""
    except ConnectionError:
        return True


def test_too_many_silent_visitors_drop_the_oldest(monkeypatch: pytest.MonkeyPatch) -> None:
    """Long before the time for their greeting is over."""
    monkeypatch.setattr("tiniscript.link.sharing.server.GREETING_S", 600.0)
    with SharedLine() as (_, registration), ExitStack() as opened_exit_stack:
        silent_peers = [
            opened_exit_stack.enter_context(visitor(registration)) for _ in range(MAX_CLIENTS + 10)
        ]
        assert all(is_let_go(peer) for peer in silent_peers[:10])
        silent_peers[10].settimeout(0.2)
        with pytest.raises(TimeoutError):
            silent_peers[10].recv(1)


def test_only_the_user_is_admitted(pty_robot: PtyRobot, link: Command) -> None:
    registration = registry.find_registration(pty_robot.port)
    assert registration is not None
    folder = registry._folder()
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    for path in folder.iterdir():
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
    command = start_endless_upload(pty_robot)
    for wrong_fields in ({"token": "0" * 32}, {"token": 5}, {"verb": "x" * 99}):
        with visitor(registration) as peer:
            peer.sendall(greeting(registration, **wrong_fields))
            assert is_let_go(peer)
    assert pty_robot.moves
    silent_peers = [visitor(registration) for _ in range(100)]
    assert on(pty_robot, "stop").code == 0
    assert command.wait_for_result().code == 3
    for peer in silent_peers:
        assert is_let_go(peer)
        peer.close()


def test_wrong_messages_of_a_client_end_only_its_connection() -> None:
    """`test_requests.py` lists the wrong messages."""
    with SharedLine() as (pty_robot, registration):
        for wrong_message in (
            {"do": "fly"},
            {"do": "name", "name": "zz"},
            {"do": "ping", "id": "1"},
        ):
            with visitor(registration) as peer:
                request = protocol.encode_message({"id": 1, "limit_ms": 100, **wrong_message})
                peer.sendall(greeting(registration) + request)
                reply = b""
                while part := _receive_rest(peer):
                    reply += part
            answer = {"tsc": __version__, "answer": registration.answer}
            assert reply == protocol.encode_message(answer), wrong_message
        assert "SHOW 1" in on(pty_robot, "live", "SHOW(1)").out


def _receive_rest(peer: socket.socket) -> bytes:
    try:
        return peer.recv(65536)
    except ConnectionError:
        return b""


def test_a_slow_reader_misses_values_and_delays_nobody() -> None:
    shared_port = SharedLine()
    with shared_port as (pty_robot, registration), visitor(registration) as peer:
        peer.sendall(greeting(registration))
        reader = protocol.MessageReader(protocol.LINE_BYTES)
        messages = reader.read_messages(peer.recv(65536))
        count = 50 * FULL_BYTES // 60
        for k in range(count):
            shared_port.server._on_events([(k, ShownEvent(k, 0))])
        shared_port.server._on_events([(count, DoneEvent(9))])
        assert "SHOW 1" in on(pty_robot, "live", "SHOW(1)").out
        while not any(message.get("event") == "DONE" for message in messages):
            data = peer.recv(65536)
            assert data, "it was let go"
            messages += reader.read_messages(data)
        messages = messages[: [message.get("event") for message in messages].index("DONE")]
        missed = [message for message in messages if message.get("event") == "MISSED"]
        show_count = sum(message.get("event") == "SHOW" for message in messages)
        assert missed
        assert (
            sum(int(protocol.read_values(message)["count"]) for message in missed) + show_count
            == count
        )


def test_nothing_is_shared_without_a_writable_folder(
    tsc: Tsc, pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    blocked_path = tmp_path / "file"
    blocked_path.write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(blocked_path))
    assert tsc("upload", "-e", "SI|F(0.1, 30)", "--port", pty_robot.port).code == 0
    tsc("monitor", "--hold", "--port", pty_robot.port).gives(3, "cannot be shared")


def test_an_invalid_file_is_not_a_server(pty_robot: PtyRobot) -> None:
    with SharedLine() as (shared_robot, registration):
        path = registry._path(shared_robot.port)
        for text in ("", "{", "[]", "{}", '{"port": 5}', "[" * 5000, "\0"):
            path.write_text(text)
            assert registry.find_registration(shared_robot.port) is None, text[:20]
            assert registry.find_all() == []
    path.write_text(json.dumps(registration._replace(port=pty_robot.port)._asdict()))
    assert registry.find_registration(shared_robot.port) is None


def test_somebody_else_at_the_number_of_a_crashed_server_is_not_a_server(
    pty_robot: PtyRobot,
) -> None:
    with socket.create_server((protocol.HOST, 0)) as stranger:
        number = stranger.getsockname()[1]
        registry.write(Registration(pty_robot.port, number, "a", "b", "monitor", 9600, 1))
        command = Command("doctor", "--identify", "--port", pty_robot.port)
        peer, _ = stranger.accept()
        with peer:
            peer.recv(1000)
            peer.sendall(protocol.encode_message({"tsc": __version__, "answer": "c"}))
            result = command.wait_for_result()
    assert (result.code, result.err) == (0, "")
    assert registry.find_registration(pty_robot.port) is None


def test_an_internal_error_in_a_thread_is_raised_in_its_waiter() -> None:
    for part in ("session", "server"):
        shared_port = SharedLine()
        with shared_port as (_, registration), visitor(registration) as peer:
            if part == "session":
                shared_port.line.session._queue.append(cast("Any", None))
            else:
                shared_port.server._orphaned_requests.append(cast("Any", None))
            with pytest.raises(AttributeError):
                while True:
                    shared_port.line.event()
            peer.settimeout(HANG_LIMIT_S)
            assert is_let_go(peer)


def test_a_released_lock_leaves_no_file(tmp_path: Path) -> None:
    path = tmp_path / "port.lock"
    lock = registry._try_lock(path)
    assert lock is not None and path.exists()
    assert registry._try_lock(path) is None, "another one has it"
    assert path.exists()
    lock.close()
    assert not path.exists()
