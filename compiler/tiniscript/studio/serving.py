"""Gives the built page to a browser of this computer, or to those of a class, and to no one else.

Knows which requests it answers. All of the page is read before: an update of the package does not
change a page that is open. What a page asks of robots goes to `hosting`, if it shows the token of
this run: a page gets it for the code that is in the address which `tsc studio` opens, after a #,
which no browser sends (`entrances`). With `--class` the address is one of the room's network, the
token is the teacher's, and pupils have tokens of their own (`classroom`). What the page may do in a
browser is its Content-Security-Policy. Knows no robots.
"""

from __future__ import annotations

import gzip
import hashlib
import json
import socket
import sys
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from io import BufferedIOBase
from pathlib import Path
from threading import Lock
from typing import Any, NamedTuple, Protocol, cast
from urllib.parse import urlsplit

from tiniscript.flash import ready
from tiniscript.link.sharing.protocol import BadMessage, message_of
from tiniscript.studio import building
from tiniscript.studio.entrances import Entrances
from tiniscript.studio.robot_link import BadRequest, Json

# Nothing comes from elsewhere and nothing goes there. Python is WebAssembly, compiled here.
_DIRECTIVES = (
    "default-src 'none'",
    "script-src 'self' 'wasm-unsafe-eval'",
    "style-src 'self'",
    "img-src 'self' blob:",  # a blob is made by the page: its picture of blocks
    "connect-src 'self'",
    "worker-src 'self'",
    "manifest-src 'self'",
    "base-uri 'none'",
    "form-action 'none'",
)
POLICY = "; ".join(_DIRECTIVES)  # a page can say so of itself
HEADERS = {
    "Content-Security-Policy": f"{POLICY}; frame-ancestors 'none'",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-cache",
}
# A browser complains of this one at an address that is neither https nor of its own computer.
SECURE_ONLY = "Cross-Origin-Opener-Policy"
TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".mjs": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
    ".cur": "image/x-icon",
    ".wasm": "application/wasm",
    ".zip": "application/zip",
    ".txt": "text/plain; charset=utf-8",
    ".hex": "text/plain; charset=utf-8",
    ".bin": "application/octet-stream",
    ".json": "application/json",
    ".webmanifest": "application/manifest+json",
}


PAGE = Path(__file__).with_name("page")
FIRST = "index.html"
WORKER = "service_worker.js"
FIRMWARE = "firmware.json"  # which files of firmware there are
HOST = "127.0.0.1"
NAMES = (HOST, "localhost")  # by which a browser here may call it
HTTP_PORT = 80
SILENT_S = 10  # after which a client that asks nothing is left
ROBOTS = "/robots"  # where a page asks for robots
ENTER = "/enter"  # where it gets the token for its code
TOKEN = "X-TiniScript-Token"
BEFORE_CODE = "#code="
ENTER_BYTES = 200  # of a request with a code
HEAD_BYTES = 16_384  # of a request
REQUEST_BYTES = 200_000  # the largest program has 32,781 bytes, and two digits for each
# At a time; one more, and one is closed, of the address that has most. A browser has six.
CONNECTIONS = 64
CLASS_CONNECTIONS = 400
HTML = b'<html lang="en"'

Robots = Callable[[Json], Json]  # raises BadRequest


class Pupils(Protocol):
    """Who asks with a token that is not that of the run."""

    def most_bytes(self, token: str) -> int:
        """Return how large a request with this token may be; 0: nobody has it."""

    def answer(self, token: str, address: str, request: Json) -> Json:
        """Return the answer; `address` is that of the asking computer. Raises BadRequest."""


class File(NamedTuple):
    """`tag` changes with the data; `packed` is the data gzipped, or empty."""

    data: bytes
    kind: str
    tag: str = ""
    packed: bytes = b""


def is_built() -> bool:
    """Whether this installation has the page."""
    return (PAGE / FIRST).is_file()


def files(folder: Path | None = None) -> dict[str, File]:
    """Return the files of the page, which is built, by their names."""
    folder = folder or PAGE
    return {
        path.name: _with_etag(path.read_bytes(), TYPES[path.suffix])
        for path in folder.iterdir()
        if path.suffix in TYPES and path.name != building.STAMP
    }


def with_firmware(page: dict[str, File]) -> dict[str, File]:
    """Return the page with the firmware that the package brings, for boards at its browser."""
    result = dict(page)
    brought = [*ready.files(), *ready.images()]
    for item in brought:
        result[item.path.name] = _with_etag(item.path.read_bytes(), TYPES[item.path.suffix])
    rows = [{"title": item.title, "board": item.board, "file": item.path.name} for item in brought]
    result[FIRMWARE] = _with_etag(json.dumps(rows).encode(), TYPES[".json"])
    return result


def for_class(page: dict[str, File]) -> dict[str, File]:
    """Return the page as thirty tablets on one radio fetch it: packed, and marked as a class's."""
    result = {}
    for name, file in page.items():
        data = file.data
        if name == FIRST:
            data = data.replace(HTML, HTML + b" data-class", 1)
        packed = gzip.compress(data, 6, mtime=0)
        result[name] = _with_etag(data, file.kind, packed if len(packed) < len(data) else b"")
    return result


def _with_etag(data: bytes, kind: str, packed: bytes = b"") -> File:
    return File(data, kind, f'"{hashlib.sha256(data).hexdigest()[:32]}"', packed)


# For a browser that asks for a worker which this server has not: it is of a server that had this
# address before, and goes.
_GONE = File(
    b"addEventListener('install', () => skipWaiting());\n"
    b"addEventListener('activate', () => registration.unregister());\n",
    TYPES[".js"],
)
_FOREIGN = File(b"This page is for this computer alone.\n", TYPES[".txt"])
_MISSING = File(b"There is no such file.\n", TYPES[".txt"])
_NO_REQUEST = File(b"That is no request.\n", TYPES[".txt"])


class _Client(NamedTuple):
    address: str
    is_known: bool  # it has shown a token


class Server(ThreadingHTTPServer):
    """A server of the page; `port` 0 is any that is free. Raises OSError.

    `robots` answers what a page asks with the token of the run; without it there are none.
    `host` is the one address at which it listens, `pupils` who else may ask there.
    """

    daemon_threads = True
    # On Windows two studios on one port would share it. Elsewhere the port would stay taken for a
    # minute after a studio that ended before its page.
    allow_reuse_address = sys.platform != "win32"
    request_queue_size = 128

    def __init__(
        self, page: dict[str, File], port: int, robots: Robots | None = None,
        pupils: Pupils | None = None, host: str = HOST,
    ) -> None:  # fmt: skip
        super().__init__((host, port), _Handler)
        self.page = page
        self.robots = robots
        self.pupils = pupils
        names = NAMES if host == HOST else (host,)
        self.own = {f"{name}:{self.server_port}" for name in names}
        if self.server_port == HTTP_PORT:
            self.own |= set(names)  # a browser leaves it out
        self.address = f"http://{host}:{self.server_port}/"
        self.headers = {
            name: value for name, value in HEADERS.items() if host == HOST or name != SECURE_ONLY
        }
        self.entrances = Entrances()
        self.most_connections = CONNECTIONS if pupils is None else CLASS_CONNECTIONS
        self._lock = Lock()
        # Which has asked last is the last.
        self._connections: dict[socket.socket, _Client] = {}

    def entrance(self, is_for_here: bool = False) -> str:
        """Return a new address by which the user's page reaches the robots, the first time."""
        if self.robots is None:
            return self.address
        return f"{self.address}{BEFORE_CODE}{self.entrances.code(is_for_here)}"

    def is_unused(self, entrance: str) -> bool:
        """Whether nobody has opened such an address."""
        return self.entrances.is_unused(entrance.rpartition(BEFORE_CODE)[2])

    def enter(self, request: Json, peer: socket.socket) -> Json:
        """Return the token of the run for a code that gives it."""
        given = self.entrances.token_for(str(request.get("code")), peer)
        return {"token": given} if given else {"failure": "host_used"}

    def most_bytes(self, token: str, peer: socket.socket) -> int:
        """Return how large a request with this token may be; 0: it is refused."""
        if self.entrances.is_owner(token, peer):
            return REQUEST_BYTES
        return self.pupils.most_bytes(token) if self.pupils else 0

    def answer(self, token: str, peer: socket.socket, address: str, request: Json) -> Json:
        """Return the answer to a request whose token is known. Raises BadRequest."""
        if self.entrances.is_owner(token, peer):
            assert self.robots is not None
            return self.robots(request)
        assert self.pupils is not None
        return self.pupils.answer(token, address, request)

    def trust(self, client: socket.socket) -> None:
        """A client has shown a token: others are closed before it."""
        with self._lock:
            result = self._connections.pop(client, None)
            if result is not None:
                self._connections[client] = result._replace(is_known=True)

    def process_request(self, request: Any, client_address: Any) -> None:
        closed = None
        with self._lock:
            if len(self._connections) >= self.most_connections:
                closed = self._idle()
                del self._connections[closed]
            self._connections[request] = _Client(client_address[0], False)
        if closed is not None:
            with suppress(OSError):  # it has gone
                closed.shutdown(socket.SHUT_RDWR)
        super().process_request(request, client_address)

    def _idle(self) -> socket.socket:
        """Return the connection that has asked nothing for longest: of those without a token, if
        there are any, and of the address that has most of these."""
        found = {
            connection: client
            for connection, client in self._connections.items()
            if not client.is_known
        }
        found = found or self._connections
        [(most, _)] = Counter(client.address for client in found.values()).most_common(1)
        return next(connection for connection, client in found.items() if client.address == most)

    def shutdown_request(self, request: Any) -> None:
        with self._lock:
            self._connections.pop(request, None)
        super().shutdown_request(request)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A client that has gone is no news."""


class _HeadTooLarge(Exception):
    pass


class _Reader:
    """What a client sends; the lines of a head are no more than HEAD_BYTES in all."""

    def __init__(self, stream: BufferedIOBase) -> None:
        self._stream = stream
        self._left = HEAD_BYTES
        self.read = stream.read
        self.close = stream.close

    def begin(self) -> None:
        self._left = HEAD_BYTES

    def readline(self, size: int) -> bytes:
        line = self._stream.readline(min(size, self._left + 1))
        self._left -= len(line)
        if self._left < 0:
            raise _HeadTooLarge
        return line


class _Handler(BaseHTTPRequestHandler):
    server: Server
    protocol_version = "HTTP/1.1"
    server_version = "tsc"
    sys_version = ""
    timeout = SILENT_S
    disable_nagle_algorithm = True  # else the body of an answer waits 40 ms behind its head

    def setup(self) -> None:
        super().setup()
        self._reader = _Reader(self.rfile)
        self.rfile = cast(Any, self._reader)

    def handle_one_request(self) -> None:
        self._reader.begin()
        try:
            super().handle_one_request()
        except _HeadTooLarge:
            self.close_connection = True
            status = HTTPStatus.REQUEST_HEADER_FIELDS_TOO_LARGE
            head = f"HTTP/1.1 {status.value} {status.phrase}\r\nConnection: close\r\n\r\n"
            self.wfile.write(head.encode())

    def do_POST(self) -> None:
        server = self.server
        origins = self.headers.get_all("Origin", [])
        if server.robots is None or self.path not in (ROBOTS, ENTER):
            self._send(HTTPStatus.NOT_FOUND, _MISSING)
            return
        # A browser says of each POST where it is from.
        tokens = self.headers.get_all(TOKEN, [])
        token = tokens[0] if len(tokens) == 1 else ""
        most = server.most_bytes(token, self.connection) if len(tokens) < 2 else 0
        if self.path == ENTER:
            most = ENTER_BYTES
        if not self._is_own() or len(origins) != 1 or not most:
            self._send(HTTPStatus.FORBIDDEN, _FOREIGN)
            return
        try:
            asked = self._request(most)
            if self.path == ENTER:
                answer = server.enter(asked, self.connection)
            else:
                answer = server.answer(token, self.connection, self.client_address[0], asked)
        except (BadRequest, OSError):
            self._send(HTTPStatus.BAD_REQUEST, _NO_REQUEST)
            return
        if token:
            server.trust(self.connection)
        self._send(HTTPStatus.OK, File(json.dumps(answer).encode(), TYPES[".json"]))

    def _request(self, most: int) -> Json:
        """Return the object of JSON in the body, of `most` bytes. Raises BadRequest, OSError."""
        lengths = self.headers.get_all("Content-Length", [])
        if len(lengths) != 1 or not lengths[0].isascii() or not lengths[0].isdigit():
            raise BadRequest
        length = int(lengths[0][:9])
        if length > most or self.headers.get("Transfer-Encoding") is not None:
            raise BadRequest
        data = self.rfile.read(length)
        try:
            return message_of(data)
        except BadMessage:
            raise BadRequest from None

    def do_GET(self) -> None:
        if not self._is_own():
            self._send(HTTPStatus.FORBIDDEN, _FOREIGN)
            return
        name = urlsplit(self.path).path.removeprefix("/") or FIRST
        file = self.server.page.get(name)
        if self.headers.get("Service-Worker") == "script" and name != WORKER:
            self._send(HTTPStatus.OK, _GONE)
        elif file is None:
            self._send(HTTPStatus.NOT_FOUND, _MISSING)
        elif file.tag in self.headers.get_all("If-None-Match", []):
            self._send(HTTPStatus.NOT_MODIFIED, file._replace(data=b"", packed=b""))
        elif file.packed and "gzip" in self.headers.get("Accept-Encoding", ""):
            self._send(HTTPStatus.OK, file._replace(data=file.packed), "gzip")
        else:
            self._send(HTTPStatus.OK, file)

    def do_HEAD(self) -> None:
        self.do_GET()  # sends all but the file

    def _is_own(self) -> bool:
        """Whether the request is for a page of this address: a name that somebody else has made for
        this computer is not (DNS rebinding), nor is a page from elsewhere."""
        if self.headers.get_all("Host", []) not in [[name] for name in self.server.own]:
            return False
        origins = self.headers.get_all("Origin", [])
        return all(origin in {f"http://{name}" for name in self.server.own} for origin in origins)

    def _send(self, status: HTTPStatus, file: File, coding: str = "") -> None:
        self.send_response(status)
        self.send_header("Content-Type", file.kind)
        if status is not HTTPStatus.NOT_MODIFIED:
            self.send_header("Content-Length", str(len(file.data)))
        if coding:
            self.send_header("Content-Encoding", coding)
        if file.packed:
            self.send_header("Vary", "Accept-Encoding")
        if file.tag:
            self.send_header("ETag", file.tag)
        for name, value in self.server.headers.items():
            self.send_header(name, value)
        if status not in (HTTPStatus.OK, HTTPStatus.NOT_MODIFIED):
            self.send_header("Connection", "close")
            self.close_connection = True
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(file.data)

    def log_message(self, format: str, *arguments: Any) -> None:
        """What a browser fetches is no news."""
