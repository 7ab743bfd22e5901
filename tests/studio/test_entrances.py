"""Access to the robots of `tsc studio`: the user who started it, not someone who reads the address
on a command line.
"""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.support import page_server
from tests.support.page_server import serves
from tests.support.socket_pairs import connected_pair
from tests.support.waiting import HANG_LIMIT_S, until
from tiniscript.link.sharing import peers
from tiniscript.studio import serving
from tiniscript.studio.entrances import OPEN_TIMEOUT_S, Entrances

NOBODY_UID = 65534
# Stands for a browser: another user reads its command line while it runs.
FAKE_BROWSER_SCRIPT = """#!/bin/sh
echo $$ "$@" > {folder}/opened.new
mv {folder}/opened.new {folder}/opened
while [ ! -e {folder}/closed ]; do sleep 0.1; done
"""
# Finds the address on the command line of a process, as another user, and sends its page's
# requests.
STRANGER_SCRIPT = """
import encodings.idna, http.client, json, os, sys
os.setgid(65534); os.setuid(65534)
own, token, code, *pids = sys.argv[1:]
words = " ".join(open("/proc/%s/cmdline" % each, "rb").read().decode() for each in pids)
assert "http://%s/" % own in words, "the browser's command line is not read"
shown = words.rpartition("#code=")[2][:32]
assert shown == code, (shown, code)

def post(token, request, path="/robots"):
    connection = http.client.HTTPConnection(own, timeout=60)
    connection.request("POST", path, json.dumps(request),
                       {"Origin": "http://" + own, "X-TiniScript-Token": token})
    answer = connection.getresponse()
    return [answer.status, answer.read().decode()]

print(json.dumps([post("", {"code": shown}, "/enter"), post(token, {"do": "ports"}),
                  token in words]))
"""


class Clock:
    now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture
def peer() -> Iterator[socket.socket]:
    """A connection of this user."""
    own_end, other_end = connected_pair()
    with own_end, other_end:
        yield own_end


@pytest.fixture
def of_another(monkeypatch: pytest.MonkeyPatch) -> None:
    """All connections within this computer are of another user."""
    monkeypatch.setattr(peers, "tells_users", lambda: True)
    monkeypatch.setattr(
        peers, "_socket_owner", lambda peer, own_address: peers.SocketOwner(NOBODY_UID, 1)
    )
    monkeypatch.setattr(os, "geteuid", lambda: 1234, raising=False)


def test_a_code_gives_the_token_once(peer: socket.socket) -> None:
    doors = Entrances()
    code = doors.new_code()
    assert doors.is_unused(code)
    assert doors.token_for(code, peer) == doors.token
    assert not doors.is_unused(code) and doors.token_for(code, peer) == ""
    assert doors.token_for("0" * 32, peer) == doors.token_for("", peer) == ""
    assert doors.is_owner(doors.token, peer) and not doors.is_owner(code, peer)


def test_the_code_of_a_browser_is_valid_for_a_limited_time(peer: socket.socket) -> None:
    clock = Clock()
    doors = Entrances(clock)
    early_code, late_code, printed_text = (
        doors.new_code(True),
        doors.new_code(True),
        doors.new_code(),
    )
    clock.now_s = OPEN_TIMEOUT_S
    assert doors.token_for(early_code, peer) == doors.token
    clock.now_s = OPEN_TIMEOUT_S + 1
    assert doors.token_for(late_code, peer) == ""
    assert doors.token_for(printed_text, peer) == doors.token


def test_a_reused_code_revokes_its_token(
    peer: socket.socket, monkeypatch: pytest.MonkeyPatch
) -> None:
    """If no system identifies the user, another one may have been faster than the browser."""
    doors = Entrances()
    monkeypatch.setattr(peers, "tells_users", lambda: False)
    code = doors.new_code(True)
    stolen_text = doors.token_for(code, peer)
    assert doors.is_owner(stolen_text, peer)
    assert doors.token_for(code, peer) == ""  # the browser
    assert not doors.is_owner(stolen_text, peer)
    monkeypatch.setattr(peers, "tells_users", lambda: True)
    second_code = doors.new_code()
    first_token = doors.token_for(second_code, peer)
    assert doors.token_for(second_code, peer) == "" and doors.token == first_token


@pytest.mark.usefixtures("of_another")
def test_another_user_gets_neither_code_nor_token(peer: socket.socket) -> None:
    doors = Entrances()
    for is_for_here in (True, False):
        code = doors.new_code(is_for_here)
        assert doors.token_for(code, peer) == "" and doors.is_unused(code)
    assert not doors.is_owner(doors.token, peer)


def test_a_browsers_code_is_local_and_the_printed_one_is_not(
    peer: socket.socket, monkeypatch: pytest.MonkeyPatch
) -> None:
    doors = Entrances()
    shown_text, printed_text = doors.new_code(True), doors.new_code()
    monkeypatch.setattr(peers, "is_on_this_computer", lambda peer: False)
    monkeypatch.setattr(peers, "is_of_this_user", lambda peer: False)
    assert doors.token_for(shown_text, peer) == "" and doors.is_unused(shown_text)
    assert doors.token_for(printed_text, peer) == doors.token  # the teacher's tablet
    assert doors.is_owner(doors.token, peer)


def test_local_addresses_are_recognized(peer: socket.socket) -> None:
    assert peers.is_on_this_computer(peer)

    class Elsewhere:
        def getpeername(self) -> tuple[str, int]:
            return "198.51.100.1", 5

    assert not peers.is_on_this_computer(Elsewhere())  # type: ignore[arg-type]


@pytest.mark.usefixtures("of_another")
def test_the_server_answers_no_other_user(tmp_path: Path) -> None:
    (tmp_path / "index.html").write_text("<!doctype html>")
    requests: list[object] = []

    def answer(request: dict[str, Any]) -> dict[str, Any]:
        requests.append(request)
        return {}

    new_server = serving.Server(serving.files(tmp_path), 0, answer)
    with serves(new_server) as server:
        server_host = f"{serving.HOST}:{server.server_port}"
        code = server.entrance(is_for_this_computer=True).rpartition("=")[2]
        assert enter(server_host, code) == (200, {"failure": "host_used"})
        assert post(server_host, server.entrances.token, {"do": "ports"})[0] == 403
    assert requests == []


def enter(server_host: str, code: str) -> tuple[int, Any]:
    return post(server_host, "", {"code": code}, serving.ENTER_PATH)


def post(
    server_host: str, token: str, request: object, path: str = serving.ROBOTS_PATH
) -> tuple[int, Any]:
    status, data = page_server.post(server_host, token, json.dumps(request).encode(), path)
    return status, json.loads(data) if status == 200 else data.decode()


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells the user")
@pytest.mark.root
@pytest.mark.parametrize("is_class", [False, True])
def test_the_browsers_command_line_gives_another_user_no_access(
    tmp_path: Path, is_class: bool
) -> None:
    browser = tmp_path / "browser"
    browser.write_text(FAKE_BROWSER_SCRIPT.format(folder=tmp_path))
    browser.chmod(0o755)
    (tmp_path / "page").mkdir()
    (tmp_path / "page" / "index.html").write_text('<html lang="en">')
    start = ("import sys; from pathlib import Path; from tiniscript.studio import serving; "
             f"serving.PAGE = Path({str(tmp_path / 'page')!r}); from tiniscript.cli import main; "
             "sys.exit(main(sys.argv[1:]))")  # fmt: skip
    options = ("--class", "--address", "127.0.0.2") if is_class else ()
    words = [sys.executable, "-c", start, "studio", "--listen", "0", "--lang", "en", *options]
    command = subprocess.Popen(
        words, env={**os.environ, "BROWSER": f"{browser} %s &"},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        assert command.stdout and command.stderr
        printed_text = command.stdout.readline().strip()
        until(lambda: (tmp_path / "opened").exists(), "the browser is opened")
        pid, opened_text = (tmp_path / "opened").read_text().split()
        address, _, code = opened_text.partition("#code=")
        server_host = address.removeprefix("http://").rstrip("/")
        assert printed_text.startswith(f"{address}#code=") and code not in printed_text

        # The token is not on any command line, so it is taken from another page.
        token = enter(server_host, printed_text.rpartition("=")[2])[1]["token"]
        stranger = [
            sys.executable,
            "-I",
            "-c",
            STRANGER_SCRIPT,
            server_host,
            token,
            code,
            pid,
            str(command.pid),
        ]
        completed = subprocess.run(stranger, capture_output=True, text=True, timeout=HANG_LIMIT_S)
        assert completed.returncode == 0, completed.stderr
        entering, asking, is_shown = json.loads(completed.stdout)
        assert entering == [200, '{"failure": "host_used"}']
        assert asking[0] == 403 and not is_shown

        assert enter(server_host, code) == (200, {"token": token})
        assert enter(server_host, code) == (200, {"failure": "host_used"})
        assert post(server_host, token, {"do": "ports"})[0] == 200
        next_address = command.stdout.readline().strip()  # the printed address was opened
        assert next_address.startswith(f"{address}#code=") and next_address != printed_text
    finally:
        (tmp_path / "closed").touch()
        command.terminate()
        command.communicate(timeout=HANG_LIMIT_S)
