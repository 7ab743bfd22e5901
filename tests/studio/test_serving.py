"""Access to the page of `tsc studio`, and the headers sent with it."""

from __future__ import annotations

import signal
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.command import Command, Tsc
from tests.support.page_server import ask, serves
from tests.support.waiting import HANG_LIMIT_S
from tiniscript.studio import serving
from tiniscript.studio.serving import POLICY


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a page of two files, and others that do not belong to it."""
    page = tmp_path / "page"
    (page / "inside").mkdir(parents=True)
    (page / "index.html").write_text("<!doctype html>")
    (page / "main.js").write_text("0")
    (page / "build.json").write_text("{}")
    (page / "notes.unknown").write_text("not a file of the page")
    (page / "inside" / "deep.js").write_text("0")
    (tmp_path / "secret.txt").write_text("secret")
    return page


@pytest.fixture
def server(folder: Path) -> Iterator[serving.Server]:
    with serves(serving.Server(serving.files(folder), 0)) as server:
        yield server


def test_the_next_studio_has_the_port_as_soon_as_the_last_one_has_ended(folder: Path) -> None:
    page = serving.files(folder)
    with serves(serving.Server(page, 0)) as first_server:
        with pytest.raises(OSError):
            serving.Server(page, first_server.server_port)
        with socket.create_connection(
            (serving.HOST, first_server.server_port), HANG_LIMIT_S
        ) as browser:
            browser.sendall(b"GET / HTTP/1.0\r\n\r\n")
            while browser.recv(4096):  # the server is the first that closes
                pass
    serving.Server(page, first_server.server_port).server_close()


def test_the_page_is_served_with_its_policy(server_host: str) -> None:
    response, data = ask(server_host, "/?anything=1")
    assert (response.status, data) == (200, b"<!doctype html>")
    policy = response.getheader("Content-Security-Policy") or ""
    assert policy.startswith(POLICY) and "frame-ancestors 'none'" in policy
    assert "unsafe-inline" not in policy and "unsafe-eval'" not in policy.replace("wasm-unsafe", "")
    assert response.getheader("X-Content-Type-Options") == "nosniff"
    assert response.getheader("Access-Control-Allow-Origin") is None
    response, data = ask(server_host, "/main.js")
    assert response.getheader("Content-Type") == "text/javascript; charset=utf-8"
    response, data = ask(server_host, "/main.js", "HEAD")
    assert (response.status, data, response.getheader("Content-Length")) == (200, b"", "1")
    with socket.create_connection(
        (serving.HOST, int(server_host.rpartition(":")[2])), HANG_LIMIT_S
    ) as browser:
        browser.sendall(f"HEAD /main.js HTTP/1.0\r\nHost: {server_host}\r\n\r\n".encode())
        reply = b"".join(iter(lambda: browser.recv(4096), b""))
    assert b" 200 " in reply and reply.endswith(b"\r\n\r\n")  # the answer has no body


@pytest.mark.parametrize(
    "path",
    ["/../secret.txt", "/%2e%2e/secret.txt", "//etc/passwd", "/inside/deep.js", "/build.json",
     "/notes.unknown", "/nothing", "/..\\secret.txt"],
)  # fmt: skip
def test_only_the_page_is_served(server_host: str, path: str) -> None:
    response, data = ask(server_host, path)
    assert response.status == 404 and b"secret" not in data


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example"},
        {"Host": "127.0.0.1"},
        {"Host": "127.0.0.1:1"},
        {"Host": "127.0.0.1.evil.example:PORT"},
        {"Origin": "https://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://127.0.0.1:1"},
    ],
)
def test_requests_of_other_origins_are_refused(server_host: str, headers: dict[str, str]) -> None:
    port = server_host.partition(":")[2]
    filled = {name: value.replace("PORT", port) for name, value in headers.items()}
    response, data = ask(server_host, "/", headers=filled)
    assert response.status == 403 and b"doctype" not in data


def test_requests_of_the_own_origin_are_answered(server_host: str) -> None:
    for name in (server_host, server_host.replace(serving.HOST, "localhost")):
        response, _ = ask(server_host, headers={"Host": name, "Origin": f"http://{name}"})
        assert response.status == 200, name


def test_the_server_accepts_no_uploads(server: serving.Server, server_host: str) -> None:
    """It listens on this computer only."""
    for method in ("PUT", "DELETE", "OPTIONS", "TRACE"):
        assert ask(server_host, "/", method)[0].status == 501, method
    assert server.server_address[0] == "127.0.0.1"


def test_two_host_headers_are_refused(server: serving.Server, server_host: str) -> None:
    with socket.create_connection(
        (serving.HOST, server.server_port), timeout=HANG_LIMIT_S
    ) as client:
        client.sendall(
            f"GET / HTTP/1.1\r\nHost: {server_host}\r\nHost: evil.example\r\n\r\n".encode()
        )
        assert client.recv(100).startswith(b"HTTP/1.1 403")


def test_the_server_runs_until_it_is_ended(folder: Path) -> None:
    code = (
        "import sys; from pathlib import Path; from tiniscript.studio import serving; "
        f"serving.PAGE = Path({str(folder)!r}); from tiniscript.cli import main; "
        "sys.exit(main(['studio', '--listen', '0', '--no-browser']))"
    )
    command = Command(code=code)
    command.until("http://127.0.0.1:")
    command.signal(signal.SIGTERM)
    assert command.wait_for_result().code == 0


def test_an_occupied_port_gives_a_message(
    tsc: Tsc, server: serving.Server, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(serving, "PAGE", folder)
    result = tsc("studio", "--listen", str(server.server_port), "--no-browser")
    assert result.code == 3
    assert server.address in result.err and "--listen" in result.err
