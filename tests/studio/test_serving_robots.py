"""Access to the robots of this computer through `tsc studio`: only for its own page."""

from __future__ import annotations

import json
import socket
from collections.abc import Iterator
from contextlib import ExitStack, closing
from http.client import HTTPConnection
from pathlib import Path
from threading import active_count
from typing import Any

import pytest

from tests.support.crowd import HALF_A_REQUEST, crowd
from tests.support.page_server import ask, post, serves
from tests.support.waiting import HANG_LIMIT_S
from tiniscript.studio import serving
from tiniscript.studio.robot_link import BadRequest


class Recorder:
    """Robots played by a test: they record their requests."""

    def __init__(self) -> None:
        self.requests: list[dict[str, Any]] = []

    def answer(self, request: dict[str, Any]) -> dict[str, Any]:
        self.requests.append(request)
        if request.get("do") != "ports":
            raise BadRequest
        return {"ports": []}


@pytest.fixture
def robots() -> Recorder:
    return Recorder()


@pytest.fixture
def server(tmp_path: Path, robots: Recorder) -> Iterator[serving.Server]:
    (tmp_path / "index.html").write_text("<!doctype html>")
    with serves(serving.Server(serving.files(tmp_path), 0, robots.answer)) as server:
        yield server


PORTS = b'{"do": "ports"}'


def test_requests_of_the_studios_page_are_answered(
    server: serving.Server, server_host: str, robots: Recorder
) -> None:
    status, data = post(server_host, server.entrances.token, PORTS)
    assert (status, json.loads(data)) == (200, {"ports": []})
    name = f"localhost:{server.server_port}"
    headers = {"Host": name, "Origin": f"http://{name}"}
    assert post(server_host, server.entrances.token, PORTS, headers=headers)[0] == 200
    assert len(robots.requests) == 2


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example"},
        {"Host": "evil.example:80"},
        {"Host": "127.0.0.1"},
        {"Origin": "https://evil.example"},
        {"Origin": "null"},
        {"Origin": None},
        {"Origin": "http://127.0.0.1:1"},
        {serving.TOKEN_HEADER: ""},
        {serving.TOKEN_HEADER: "0" * 32},
        {serving.TOKEN_HEADER: "\xff" * 32},
        {serving.TOKEN_HEADER: None},
    ],
    ids=str,
)
def test_requests_of_other_pages_are_refused(
    server: serving.Server, server_host: str, robots: Recorder, headers: dict[str, str | None]
) -> None:
    assert post(server_host, server.entrances.token, PORTS, headers=headers)[0] == 403
    assert robots.requests == []


@pytest.mark.parametrize(
    "body",
    [b"", b"{", b"[]", b"5", b"\xff", b"[" * 100_000, b'{"do": "fly"}', b'{"do": ["ports"]}',
     b'{"do": "ports"}' + b" " * serving.REQUEST_BYTES],
    ids=lambda body: repr(body[:12]),
)  # fmt: skip
def test_anything_but_a_request_is_refused(
    server: serving.Server, server_host: str, body: bytes
) -> None:
    assert post(server_host, server.entrances.token, body)[0] == 400
    assert post(server_host, server.entrances.token, PORTS)[0] == 200


@pytest.mark.parametrize(
    ("field", "status"),
    [("Content-Length: -1", 400), ("Content-Length: 1e3", 400), ("Content-Length: ٣", 400),
     ("Content-Length: 99999999999999999999", 400), ("Content-Length: ", 400),
     ("Content-Length: 5\r\nContent-Length: 6", 400),
     (f"{serving.TOKEN_HEADER}: x\r\nContent-Length: 5", 403)],
)  # fmt: skip
def test_a_wrong_length_and_two_tokens_are_refused(
    server: serving.Server, server_host: str, robots: Recorder, field: str, status: int
) -> None:
    head = (
        f"POST {serving.ROBOTS_PATH} HTTP/1.1\r\nHost: {server_host}\r\nOrigin: http://{server_host}\r\n"
        f"{serving.TOKEN_HEADER}: {server.entrances.token}\r\n{field}\r\n\r\n"
    )
    with socket.create_connection(
        (serving.HOST, server.server_port), timeout=HANG_LIMIT_S
    ) as client:
        client.sendall(head.encode() + b'{"do"')
        assert client.recv(100).startswith(f"HTTP/1.1 {status}".encode())
    assert robots.requests == []


def test_other_addresses_accept_no_requests(
    server: serving.Server, server_host: str, robots: Recorder
) -> None:
    for path in ("/", "/robots/"):
        assert post(server_host, server.entrances.token, PORTS, path)[0] == 404
    assert robots.requests == []


def test_the_token_differs_each_time_and_is_in_no_file(
    server: serving.Server, server_host: str, tmp_path: Path, robots: Recorder
) -> None:
    assert server.entrances.token not in server.entrance()
    assert len(server.entrances.token) == 32
    other_server = serving.Server(serving.files(tmp_path), 0, robots.answer)
    other_server.server_close()
    assert other_server.entrances.token != server.entrances.token
    response, data = ask(server_host)
    assert server.entrances.token not in data.decode() + str(response.getheaders())


def test_a_server_without_robots_offers_none(tmp_path: Path) -> None:
    (tmp_path / "index.html").write_text("<!doctype html>")
    with serves(serving.Server(serving.files(tmp_path), 0)) as server:
        server_host = f"{serving.HOST}:{server.server_port}"
        assert post(server_host, server.entrances.token, PORTS)[0] == 404
        assert server.entrance() == server.address


def test_a_thousand_connections_block_nobody(server: serving.Server, server_host: str) -> None:
    """They send nothing, or half a request; the page's own connection stays."""
    headers = {"Origin": f"http://{server_host}", serving.TOKEN_HEADER: server.entrances.token}
    page = HTTPConnection(serving.HOST, server.server_port, timeout=HANG_LIMIT_S)

    def ask() -> int:
        page.request("POST", serving.ROBOTS_PATH, PORTS, headers)
        response = page.getresponse()
        response.read()
        return response.status

    assert ask() == 200
    kept_socket = page.sock
    active_count_before = active_count()
    with ExitStack() as strangers:
        for _ in range(10):
            client_crowd = crowd(server.server_port, count=100, packets=(b"", HALF_A_REQUEST))
            strangers.enter_context(client_crowd)
            assert ask() == 200
        assert page.sock is kept_socket
        assert active_count() - active_count_before <= serving.MAX_CONNECTIONS + 30
    page.close()


def test_closed_pages_take_no_place(server: serving.Server, server_host: str) -> None:
    """However many there were: a new one fetches its files over several connections at once."""
    for _ in range(serving.MAX_CONNECTIONS + 2):
        assert post(server_host, server.entrances.token, PORTS)[0] == 200
    with ExitStack() as browser:
        connections = [
            browser.enter_context(
                closing(HTTPConnection(serving.HOST, server.server_port, timeout=HANG_LIMIT_S))
            )
            for _ in range(6)
        ]
        for connection in connections:
            connection.connect()
        for connection in connections:
            connection.request("GET", "/")
            assert connection.getresponse().status == 200


@pytest.mark.parametrize("line", [b"X-More: " + b"x" * 1000 + b"\r\n", b"x" * 70_000, b"X: y\r\n"])
def test_a_request_head_is_limited_to_16_kilobytes(
    server: serving.Server, server_host: str, line: bytes
) -> None:
    """However its bytes are divided into lines, and whether it ends or not."""
    with socket.create_connection(
        (serving.HOST, server.server_port), timeout=HANG_LIMIT_S
    ) as client:
        client.sendall(b"GET / HTTP/1.1\r\n")
        sent_count, heard_bytes = 0, b""
        while not heard_bytes and sent_count < 20 * serving.HEAD_BYTES:
            try:
                client.sendall(line)
                sent_count += len(line)
                client.settimeout(0.01 if sent_count < serving.HEAD_BYTES else HANG_LIMIT_S)
                heard_bytes = client.recv(100)
            except TimeoutError:
                continue
            except ConnectionError:
                break
        # Empty if the connection was reset.
        assert heard_bytes[:12] in (b"HTTP/1.1 431", b""), heard_bytes
        assert sent_count <= serving.HEAD_BYTES + len(line)
    assert post(server_host, server.entrances.token, PORTS)[0] == 200


def test_a_page_asks_on_one_connection_as_often_as_it_wants(
    server: serving.Server, server_host: str
) -> None:
    """Its tenth head may be as long as its first."""
    headers = {"Origin": f"http://{server_host}", serving.TOKEN_HEADER: server.entrances.token}
    headers["X-More"] = "x" * (serving.HEAD_BYTES // 3)
    with closing(
        HTTPConnection(serving.HOST, server.server_port, timeout=HANG_LIMIT_S)
    ) as connection:
        sockets = set()
        for _ in range(10):
            connection.request("POST", serving.ROBOTS_PATH, PORTS, headers)
            response = connection.getresponse()
            assert (response.status, json.loads(response.read())) == (200, {"ports": []})
            sockets.add(connection.sock)
        assert len(sockets) == 1


def test_the_body_of_a_refused_request_is_no_request(
    server: serving.Server, server_host: str
) -> None:
    body = f"GET / HTTP/1.1\r\nHost: {server_host}\r\n\r\n"
    head = f"POST {serving.ROBOTS_PATH} HTTP/1.1\r\nHost: {server_host}\r\nOrigin: http://e\r\n"
    with socket.create_connection(
        (serving.HOST, server.server_port), timeout=HANG_LIMIT_S
    ) as client:
        client.sendall(f"{head}Content-Length: {len(body)}\r\n\r\n{body}".encode())
        heard_bytes = b""
        try:
            while data := client.recv(4096):
                heard_bytes += data
        except ConnectionError:  # it was reset, because its body was not read
            pass
    assert heard_bytes.count(b"HTTP/1.1 ") <= 1 and b" 200 " not in heard_bytes, heard_bytes


def test_the_most_recently_active_page_is_kept(
    server: serving.Server, server_host: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """If all have shown the token, the one idle for longest is closed."""
    monkeypatch.setattr(serving._Handler, "timeout", 10 * HANG_LIMIT_S)  # so silence drops none
    server.most_connections = 2
    headers = {"Origin": f"http://{server_host}", serving.TOKEN_HEADER: server.entrances.token}
    pages = [
        HTTPConnection(serving.HOST, server.server_port, timeout=HANG_LIMIT_S) for _ in range(3)
    ]
    sockets = []
    for k in (0, 1, 0, 2, 0):
        pages[k].request("POST", serving.ROBOTS_PATH, PORTS, headers)
        pages[k].getresponse().read()
        sockets.append(pages[k].sock)
    assert sockets[0] is sockets[2] is sockets[4]
    assert pages[1].sock.recv(1) == b""
    for page in pages:
        page.close()
