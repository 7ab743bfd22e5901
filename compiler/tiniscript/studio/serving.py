"""Gives the built page to a browser of this computer, or to those of a class, and to no one else.

Knows which requests it answers. All of the page is read before: an update of the package does not
change a page that is open. A page's robot requests go to `hosting`, if it shows the token of this
run: a page gets it for the code that is in the address which `tsc studio` opens, after a #, which
no browser sends (`entrances`). With `--class` the address is one of the room's network, the token
is the teacher's, and pupils have tokens of their own (`classroom`). The Content-Security-Policy
limits what the page may do in a browser. Knows no robots.
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

# Nothing is loaded from other sites or sent there. Python is WebAssembly, compiled here.
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
POLICY = "; ".join(_DIRECTIVES)  # a page can claim this itself
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


PAGE = building.PAGE
WORKER_FILE = "service_worker.js"
FIRMWARE_FILE = "firmware.json"  # list of the firmware files
HOST = "127.0.0.1"
HOST_NAMES = (HOST, "localhost")  # names that a browser on this computer may use
HTTP_PORT = 80
SILENT_S = 10  # idle time after which a client is disconnected
ROBOTS_PATH = "/robots"  # path of requests to robots
ENTER_PATH = "/enter"  # path where a page exchanges its code for a token
TOKEN_HEADER = "X-TiniScript-Token"
CODE_PREFIX = "#code="
ENTER_BYTES = 200  # most bytes of a request with a code
HEAD_BYTES = 16_384  # most bytes of a request's head
REQUEST_BYTES = 200_000  # the largest program has 32,781 bytes, and two digits for each
# At a time; one more, and one is closed, of the address that has most. A browser has six.
MAX_CONNECTIONS = 64
MAX_CLASS_CONNECTIONS = 400
HTML_START = b'<html lang="en"'

Robots = Callable[[Json], Json]  # raises BadRequest


class Pupils(Protocol):
    """The users with a token other than that of the run."""

    def most_bytes(self, token: str) -> int:
        """Return the largest request with this token; 0 for an unknown token."""

    def answer(self, token: str, address: str, request: Json) -> Json:
        """Return the answer; `address` is that of the asking computer. Raises BadRequest."""


class File(NamedTuple):
    """`etag` changes with the data; `gzipped` is the data gzipped, or empty."""

    data: bytes
    content_type: str
    etag: str = ""
    gzipped: bytes = b""


def is_built() -> bool:
    """Return whether this installation has the page."""
    return building.has_page(PAGE)


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
    whole_page = dict(page)
    firmware_files = [*ready.files(), *ready.images()]
    for firmware_file in firmware_files:
        whole_page[firmware_file.path.name] = _with_etag(
            firmware_file.path.read_bytes(), TYPES[firmware_file.path.suffix]
        )
    rows = [
        {
            "title": firmware_file.title,
            "board": firmware_file.board,
            "file": firmware_file.path.name,
        }
        for firmware_file in firmware_files
    ]
    whole_page[FIRMWARE_FILE] = _with_etag(json.dumps(rows).encode(), TYPES[".json"])
    return whole_page


def for_class(page: dict[str, File]) -> dict[str, File]:
    """Return the page as thirty tablets on one radio fetch it: packed, and marked as a class's."""
    class_page = {}
    for name, file in page.items():
        data = file.data
        if name == building.INDEX_FILE:
            data = data.replace(HTML_START, HTML_START + b" data-class", 1)
        gzipped_bytes = gzip.compress(data, 6, mtime=0)
        class_page[name] = _with_etag(
            data, file.content_type, gzipped_bytes if len(gzipped_bytes) < len(data) else b""
        )
    return class_page


def _with_etag(data: bytes, content_type: str, gzipped_bytes: bytes = b"") -> File:
    return File(data, content_type, f'"{hashlib.sha256(data).hexdigest()[:32]}"', gzipped_bytes)


# Replaces the worker of a server that had this address before, and removes it.
_GONE_WORKER = File(
    b"addEventListener('install', () => skipWaiting());\n"
    b"addEventListener('activate', () => registration.unregister());\n",
    TYPES[".js"],
)
_FORBIDDEN_ANSWER = File(b"This page is for this computer alone.\n", TYPES[".txt"])
_MISSING_ANSWER = File(b"There is no such file.\n", TYPES[".txt"])
_BAD_REQUEST_ANSWER = File(b"That is no request.\n", TYPES[".txt"])


class _Client(NamedTuple):
    address: str
    is_known: bool  # whether it has shown a token


class Server(ThreadingHTTPServer):
    """A server of the page; `port` 0 is any that is free. Raises OSError.

    `robots` answers what a page asks with the token of the run; without it there are none. `host`
    is the only address at which it listens, `pupils` the others who may send requests there.
    """

    daemon_threads = True
    # On Windows two studios on one port would share it. On other systems, the port would stay in
    # use for a minute after a studio that ended before its page.
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
        names = HOST_NAMES if host == HOST else (host,)
        self.own_hosts = {f"{name}:{self.server_port}" for name in names}
        if self.server_port == HTTP_PORT:
            self.own_hosts |= set(names)  # a browser leaves it out
        self.address = f"http://{host}:{self.server_port}/"
        self.headers = {
            name: value for name, value in HEADERS.items() if host == HOST or name != SECURE_ONLY
        }
        self.entrances = Entrances()
        self.most_connections = MAX_CONNECTIONS if pupils is None else MAX_CLASS_CONNECTIONS
        self._lock = Lock()
        # The client with the latest request is last.
        self._connections: dict[socket.socket, _Client] = {}

    def entrance(self, is_for_this_computer: bool = False) -> str:
        """Return a new address by which the user's page reaches the robots, the first time."""
        if self.robots is None:
            return self.address
        return f"{self.address}{CODE_PREFIX}{self.entrances.new_code(is_for_this_computer)}"

    def is_unused(self, entrance: str) -> bool:
        """Return whether nobody has opened this address yet."""
        return self.entrances.is_unused(entrance.rpartition(CODE_PREFIX)[2])

    def enter(self, request: Json, peer: socket.socket) -> Json:
        """Return the token of the run for a code that gives it."""
        token = self.entrances.token_for(str(request.get("code")), peer)
        return {"token": token} if token else {"failure": "host_used"}

    def most_bytes(self, token: str, peer: socket.socket) -> int:
        """Return the largest request with this token; 0 if it is refused."""
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
            known_client = self._connections.pop(client, None)
            if known_client is not None:
                self._connections[client] = known_client._replace(is_known=True)

    def process_request(self, request: Any, client_address: Any) -> None:
        closed_connection = None
        with self._lock:
            if len(self._connections) >= self.most_connections:
                closed_connection = self._idlest_connection()
                del self._connections[closed_connection]
            self._connections[request] = _Client(client_address[0], False)
        if closed_connection is not None:
            with suppress(OSError):  # the client has left
                closed_connection.shutdown(socket.SHUT_RDWR)
        super().process_request(request, client_address)

    def _idlest_connection(self) -> socket.socket:
        """Return the connection that has asked nothing for longest: of those without a token, if
        there are any, and of the address that has most of these."""
        candidates = {
            connection: client
            for connection, client in self._connections.items()
            if not client.is_known
        }
        candidates = candidates or self._connections
        [(address, _)] = Counter(client.address for client in candidates.values()).most_common(1)
        return next(
            connection for connection, client in candidates.items() if client.address == address
        )

    def shutdown_request(self, request: Any) -> None:
        with self._lock:
            self._connections.pop(request, None)
        super().shutdown_request(request)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore a client that has left."""


class _HeadTooLarge(Exception):
    pass


class _Reader:
    """A reader of a client's requests; the lines of a head have at most HEAD_BYTES in all."""

    def __init__(self, stream: BufferedIOBase) -> None:
        self._stream = stream
        self._left_bytes = HEAD_BYTES
        self.read = stream.read
        self.close = stream.close

    def begin(self) -> None:
        self._left_bytes = HEAD_BYTES

    def readline(self, size: int) -> bytes:
        line = self._stream.readline(min(size, self._left_bytes + 1))
        self._left_bytes -= len(line)
        if self._left_bytes < 0:
            raise _HeadTooLarge
        return line


class _Handler(BaseHTTPRequestHandler):
    server: Server
    protocol_version = "HTTP/1.1"
    server_version = "tsc"
    sys_version = ""
    timeout = SILENT_S
    disable_nagle_algorithm = True  # otherwise the body of an answer waits 40 ms after its head

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
        if server.robots is None or self.path not in (ROBOTS_PATH, ENTER_PATH):
            self._send(HTTPStatus.NOT_FOUND, _MISSING_ANSWER)
            return
        # A browser sends the origin of each POST.
        tokens = self.headers.get_all(TOKEN_HEADER, [])
        token = tokens[0] if len(tokens) == 1 else ""
        most_bytes = server.most_bytes(token, self.connection) if len(tokens) < 2 else 0
        if self.path == ENTER_PATH:
            most_bytes = ENTER_BYTES
        if not self._is_own() or len(origins) != 1 or not most_bytes:
            self._send(HTTPStatus.FORBIDDEN, _FORBIDDEN_ANSWER)
            return
        try:
            request = self._request(most_bytes)
            if self.path == ENTER_PATH:
                answer = server.enter(request, self.connection)
            else:
                answer = server.answer(token, self.connection, self.client_address[0], request)
        except (BadRequest, OSError):
            self._send(HTTPStatus.BAD_REQUEST, _BAD_REQUEST_ANSWER)
            return
        if token:
            server.trust(self.connection)
        self._send(HTTPStatus.OK, File(json.dumps(answer).encode(), TYPES[".json"]))

    def _request(self, most_bytes: int) -> Json:
        """Return the object of JSON in the body, of `most_bytes`. Raises BadRequest, OSError."""
        lengths = self.headers.get_all("Content-Length", [])
        if len(lengths) != 1 or not lengths[0].isascii() or not lengths[0].isdigit():
            raise BadRequest
        length = int(lengths[0][:9])
        if length > most_bytes or self.headers.get("Transfer-Encoding") is not None:
            raise BadRequest
        data = self.rfile.read(length)
        try:
            return message_of(data)
        except BadMessage:
            raise BadRequest from None

    def do_GET(self) -> None:
        if not self._is_own():
            self._send(HTTPStatus.FORBIDDEN, _FORBIDDEN_ANSWER)
            return
        name = urlsplit(self.path).path.removeprefix("/") or building.INDEX_FILE
        file = self.server.page.get(name)
        if self.headers.get("Service-Worker") == "script" and name != WORKER_FILE:
            self._send(HTTPStatus.OK, _GONE_WORKER)
        elif file is None:
            self._send(HTTPStatus.NOT_FOUND, _MISSING_ANSWER)
        elif file.etag in self.headers.get_all("If-None-Match", []):
            self._send(HTTPStatus.NOT_MODIFIED, file._replace(data=b"", gzipped=b""))
        elif file.gzipped and "gzip" in self.headers.get("Accept-Encoding", ""):
            self._send(HTTPStatus.OK, file._replace(data=file.gzipped), "gzip")
        else:
            self._send(HTTPStatus.OK, file)

    def do_HEAD(self) -> None:
        self.do_GET()  # sends all but the file

    def _is_own(self) -> bool:
        """Return whether the request is for a page of this address. Pages from elsewhere are
        refused, and so are names that others point at this computer (DNS rebinding).
        """
        if self.headers.get_all("Host", []) not in [[name] for name in self.server.own_hosts]:
            return False
        origins = self.headers.get_all("Origin", [])
        return all(
            origin in {f"http://{name}" for name in self.server.own_hosts} for origin in origins
        )

    def _send(self, status: HTTPStatus, file: File, encoding: str = "") -> None:
        self.send_response(status)
        self.send_header("Content-Type", file.content_type)
        if status is not HTTPStatus.NOT_MODIFIED:
            self.send_header("Content-Length", str(len(file.data)))
        if encoding:
            self.send_header("Content-Encoding", encoding)
        if file.gzipped:
            self.send_header("Vary", "Accept-Encoding")
        if file.etag:
            self.send_header("ETag", file.etag)
        for name, value in self.server.headers.items():
            self.send_header(name, value)
        if status not in (HTTPStatus.OK, HTTPStatus.NOT_MODIFIED):
            self.send_header("Connection", "close")
            self.close_connection = True
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(file.data)

    def log_message(self, format: str, *arguments: Any) -> None:
        """Log nothing for a browser's requests."""
