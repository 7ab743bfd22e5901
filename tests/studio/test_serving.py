"""Who gets the page from `tsc studio`, and what is sent with it."""

from __future__ import annotations

import signal
import socket
from collections.abc import Iterator
from http.client import HTTPConnection, HTTPResponse
from pathlib import Path

import pytest

from tests.support.command import Command, Tsc
from tests.support.page_server import serves
from tests.support.waiting import HANGS_S
from tiniscript.studio import serving
from tiniscript.studio.serving import POLICY


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A page of two files, and what is none of it."""
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
    with serves(serving.Server(serving.files(folder), 0)) as made:
        yield made


def ask(
    server: serving.Server, path: str, method: str = "GET", headers: dict[str, str] | None = None
) -> tuple[HTTPResponse, bytes]:
    connection = HTTPConnection(serving.HOST, server.server_port, timeout=HANGS_S)
    try:
        connection.request(method, path, headers=headers or {})
        response = connection.getresponse()
        return response, response.read()
    finally:
        connection.close()


def test_the_next_studio_has_the_port_as_soon_as_the_last_one_has_ended(folder: Path) -> None:
    page = serving.files(folder)
    with serves(serving.Server(page, 0)) as first:
        with pytest.raises(OSError):
            serving.Server(page, first.server_port)
        with socket.create_connection((serving.HOST, first.server_port), HANGS_S) as browser:
            browser.sendall(b"GET / HTTP/1.0\r\n\r\n")
            while browser.recv(4096):  # the server is the first that closes
                pass
    serving.Server(page, first.server_port).server_close()


def test_the_page_comes_with_its_policy(server: serving.Server) -> None:
    response, data = ask(server, "/?anything=1")
    assert (response.status, data) == (200, b"<!doctype html>")
    policy = response.getheader("Content-Security-Policy") or ""
    assert policy.startswith(POLICY) and "frame-ancestors 'none'" in policy
    assert "unsafe-inline" not in policy and "unsafe-eval'" not in policy.replace("wasm-unsafe", "")
    assert response.getheader("X-Content-Type-Options") == "nosniff"
    assert response.getheader("Access-Control-Allow-Origin") is None
    response, data = ask(server, "/main.js")
    assert response.getheader("Content-Type") == "text/javascript; charset=utf-8"
    response, data = ask(server, "/main.js", "HEAD")
    assert (response.status, data, response.getheader("Content-Length")) == (200, b"", "1")


@pytest.mark.parametrize(
    "path",
    ["/../secret.txt", "/%2e%2e/secret.txt", "//etc/passwd", "/inside/deep.js", "/build.json",
     "/notes.unknown", "/nothing", "/..\\secret.txt"],
)  # fmt: skip
def test_nothing_but_the_page_is_given(server: serving.Server, path: str) -> None:
    response, data = ask(server, path)
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
def test_another_page_gets_nothing(server: serving.Server, headers: dict[str, str]) -> None:
    filled = {
        name: value.replace("PORT", str(server.server_port)) for name, value in headers.items()
    }
    response, data = ask(server, "/", headers=filled)
    assert response.status == 403 and b"doctype" not in data


@pytest.mark.parametrize("name", ["127.0.0.1", "localhost"])
def test_its_own_page_gets_it(server: serving.Server, name: str) -> None:
    own = f"{name}:{server.server_port}"
    response, _ = ask(server, "/", headers={"Host": own, "Origin": f"http://{own}"})
    assert response.status == 200


@pytest.mark.parametrize("method", ["PUT", "DELETE", "OPTIONS", "TRACE"])
def test_nothing_can_be_sent_to_it(server: serving.Server, method: str) -> None:
    assert ask(server, "/", method)[0].status == 501


def test_two_names_of_a_host_are_none(server: serving.Server) -> None:
    own = f"127.0.0.1:{server.server_port}"
    with socket.create_connection((serving.HOST, server.server_port), timeout=HANGS_S) as client:
        client.sendall(f"GET / HTTP/1.1\r\nHost: {own}\r\nHost: evil.example\r\n\r\n".encode())
        assert client.recv(100).startswith(b"HTTP/1.1 403")


def test_it_listens_on_this_computer_alone(server: serving.Server) -> None:
    assert server.server_address[0] == "127.0.0.1"


def test_it_goes_on_until_it_is_ended(folder: Path) -> None:
    code = (
        "import sys; from pathlib import Path; from tiniscript.studio import serving; "
        f"serving.PAGE = Path({str(folder)!r}); from tiniscript.cli import main; "
        "sys.exit(main(['studio', '--listen', '0', '--no-browser']))"
    )
    command = Command(code=code)
    command.until("http://127.0.0.1:")
    command.signal(signal.SIGTERM)
    assert command.ended().code == 0


def test_a_port_that_is_taken_is_a_sentence(
    tsc: Tsc, server: serving.Server, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(serving, "PAGE", folder)
    done = tsc("studio", "--listen", str(server.server_port), "--no-browser")
    assert done.code == 3
    assert server.address in done.err and "--listen" in done.err
