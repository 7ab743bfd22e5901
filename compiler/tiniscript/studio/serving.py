"""Gives the built page to a browser of this computer, and to no one else.

Knows which requests it answers. All of the page is read before: an update of the package does not
change a page that is open. Knows no robots.
"""

from __future__ import annotations

from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import urlsplit

from tiniscript.studio.policy import HEADERS, TYPES

PAGE = Path(__file__).with_name("page")
FIRST = "index.html"
BUILD = "build.json"  # of which sources the page is; a browser does not need it
HOST = "127.0.0.1"
NAMES = (HOST, "localhost")  # by which a browser here may call it
SILENT_S = 10  # after which a client that asks nothing is left


class NotBuilt(Exception):
    """There is no page in this installation."""


class File(NamedTuple):
    data: bytes
    kind: str


def files(folder: Path | None = None) -> dict[str, File]:
    """Return the files of the page by their names. Raises NotBuilt."""
    folder = folder or PAGE
    if not (folder / FIRST).is_file():
        raise NotBuilt
    return {
        path.name: File(path.read_bytes(), TYPES[path.suffix])
        for path in folder.iterdir()
        if path.suffix in TYPES and path.name != BUILD
    }


_FOREIGN = File(b"This page is for this computer alone.\n", TYPES[".txt"])
_MISSING = File(b"There is no such file.\n", TYPES[".txt"])


class Server(ThreadingHTTPServer):
    """A server of the page on this computer; `port` 0 is any that is free. Raises OSError."""

    daemon_threads = True
    # Two studios on one port would share it on some systems.
    allow_reuse_address = False

    def __init__(self, page: dict[str, File], port: int) -> None:
        super().__init__((HOST, port), _Handler)
        self.page = page
        self.own = {f"{name}:{self.server_port}" for name in NAMES}

    @property
    def address(self) -> str:
        return f"http://{HOST}:{self.server_port}/"

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A client that has gone is no news."""


class _Handler(BaseHTTPRequestHandler):
    server: Server
    protocol_version = "HTTP/1.1"
    server_version = "tsc"
    sys_version = ""
    timeout = SILENT_S

    def do_GET(self) -> None:
        self._answer(has_body=True)

    def do_HEAD(self) -> None:
        self._answer(has_body=False)

    def _answer(self, has_body: bool) -> None:
        if not self._is_own():
            self._send(HTTPStatus.FORBIDDEN, _FOREIGN, has_body)
            return
        name = urlsplit(self.path).path.removeprefix("/") or FIRST
        found = self.server.page.get(name)
        if found is None:
            self._send(HTTPStatus.NOT_FOUND, _MISSING, has_body)
        else:
            self._send(HTTPStatus.OK, found, has_body)

    def _is_own(self) -> bool:
        """Whether the request is for a page of this address: a name that somebody else has made for
        this computer is not (DNS rebinding), nor is a page from elsewhere."""
        if self.headers.get_all("Host", []) not in [[name] for name in self.server.own]:
            return False
        origins = self.headers.get_all("Origin", [])
        return all(origin in {f"http://{name}" for name in self.server.own} for origin in origins)

    def _send(self, status: HTTPStatus, file: File, has_body: bool) -> None:
        self.send_response(status)
        self.send_header("Content-Type", file.kind)
        self.send_header("Content-Length", str(len(file.data)))
        for name, value in HEADERS.items():
            self.send_header(name, value)
        if status is not HTTPStatus.OK:
            self.send_header("Connection", "close")
            self.close_connection = True
        self.end_headers()
        if has_body:
            self.wfile.write(file.data)

    def log_message(self, format: str, *arguments: Any) -> None:
        """What a browser fetches is no news."""
