"""Gives the built page to a browser of this computer, and to no one else.

Knows which requests it answers. All of the page is read before: an update of the package does not
change a page that is open. What a page asks of robots goes to `hosting`, if it shows the token of
this run: that is in the address which `tsc studio` opens, behind a #, which no browser sends.
Knows no robots.
"""

from __future__ import annotations

import hmac
import json
import secrets
import socket
from collections.abc import Callable
from contextlib import suppress
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Lock
from typing import Any, NamedTuple
from urllib.parse import urlsplit

from tiniscript.studio.policy import HEADERS, TYPES
from tiniscript.studio.robot_link import BadRequest, Json

PAGE = Path(__file__).with_name("page")
FIRST = "index.html"
BUILD = "build.json"  # of which sources the page is; a browser does not need it
HOST = "127.0.0.1"
NAMES = (HOST, "localhost")  # by which a browser here may call it
SILENT_S = 10  # after which a client that asks nothing is left
ROBOTS = "/robots"  # where a page asks for robots
TOKEN = "X-TiniScript-Token"
TOKEN_BYTES = 16
REQUEST_BYTES = 200_000  # the largest program has 32,781 bytes, and two digits for each
CONNECTIONS = 64  # at a time; one more, and the one that has asked nothing for longest is closed

Robots = Callable[[Json], Json]  # raises BadRequest


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
_NO_REQUEST = File(b"That is no request.\n", TYPES[".txt"])


class Server(ThreadingHTTPServer):
    """A server of the page on this computer; `port` 0 is any that is free. Raises OSError.

    `robots` answers what a page asks of robots; without it there are none.
    """

    daemon_threads = True
    # Two studios on one port would share it on some systems.
    allow_reuse_address = False
    request_queue_size = 128

    def __init__(self, page: dict[str, File], port: int, robots: Robots | None = None) -> None:
        super().__init__((HOST, port), _Handler)
        self.page = page
        self.robots = robots
        self.own = {f"{name}:{self.server_port}" for name in NAMES}
        self.token = secrets.token_hex(TOKEN_BYTES)
        self._lock = Lock()
        # Whether each has shown the token; which has asked last is the last.
        self._connections: dict[socket.socket, bool] = {}

    @property
    def address(self) -> str:
        return f"http://{HOST}:{self.server_port}/"

    @property
    def entrance(self) -> str:
        """The address with the token: whoever opens it reaches the robots of this computer."""
        return f"{self.address}#token={self.token}" if self.robots else self.address

    def trust(self, client: socket.socket) -> None:
        """A client has shown the token: others are closed before it."""
        with self._lock:
            if self._connections.pop(client, None) is not None:
                self._connections[client] = True

    def process_request(self, request: Any, client_address: Any) -> None:
        idle = None
        with self._lock:
            if len(self._connections) >= CONNECTIONS:
                strangers = (each for each, is_known in self._connections.items() if not is_known)
                idle = next(strangers, next(iter(self._connections)))
                del self._connections[idle]
            self._connections[request] = False
        if idle is not None:
            with suppress(OSError):  # it has gone
                idle.shutdown(socket.SHUT_RDWR)
        super().process_request(request, client_address)

    def shutdown_request(self, request: Any) -> None:
        with self._lock:
            self._connections.pop(request, None)
        super().shutdown_request(request)

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

    def do_POST(self) -> None:
        robots = self.server.robots
        origins = self.headers.get_all("Origin", [])
        if robots is None or self.path != ROBOTS:
            self._send(HTTPStatus.NOT_FOUND, _MISSING, True)
            return
        # A browser says of each POST where it is from.
        if not self._is_own() or len(origins) != 1 or not self._has_token():
            self._send(HTTPStatus.FORBIDDEN, _FOREIGN, True)
            return
        try:
            answer = robots(self._request())
        except (BadRequest, OSError):
            self._send(HTTPStatus.BAD_REQUEST, _NO_REQUEST, True)
            return
        self.server.trust(self.connection)
        self._send(HTTPStatus.OK, File(json.dumps(answer).encode(), TYPES[".json"]), True)

    def _has_token(self) -> bool:
        found = self.headers.get_all(TOKEN, [])
        return len(found) == 1 and hmac.compare_digest(
            found[0].encode("utf-8", "replace"), self.server.token.encode()
        )

    def _request(self) -> Json:
        """Return the object of JSON in the body. Raises BadRequest, OSError."""
        lengths = self.headers.get_all("Content-Length", [])
        if len(lengths) != 1 or not lengths[0].isascii() or not lengths[0].isdigit():
            raise BadRequest
        length = int(lengths[0][:9])
        if length > REQUEST_BYTES or self.headers.get("Transfer-Encoding") is not None:
            raise BadRequest
        data = self.rfile.read(length)
        try:
            found = json.loads(data)
        except (ValueError, RecursionError):
            raise BadRequest from None
        if not isinstance(found, dict):
            raise BadRequest
        return found

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
