"""A server like that of the studio's page, in a thread of the test, and its client."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from http.client import HTTPConnection, HTTPResponse
from socketserver import BaseServer
from threading import Thread
from typing import TypeVar

from tests.support.waiting import HANG_LIMIT_S
from tiniscript.studio import serving

Served = TypeVar("Served", bound=BaseServer)


@contextmanager
def serves(served: Served) -> Iterator[Served]:
    thread = Thread(target=served.serve_forever, args=(0.02,), daemon=True)
    thread.start()
    try:
        yield served
    finally:
        served.shutdown()
        served.server_close()
        thread.join()


def ask(
    host: str, path: str = "/", method: str = "GET", body: bytes | None = None,
    headers: Mapping[str, str | None] | None = None,
) -> tuple[HTTPResponse, bytes]:  # fmt: skip
    """Ask the server at `host`, a name and its port. A header with the value None is left out."""
    sent_headers = {name: value for name, value in (headers or {}).items() if value is not None}
    connection = HTTPConnection(host, timeout=HANG_LIMIT_S)
    try:
        connection.request(method, path, body, sent_headers)
        response = connection.getresponse()
        return response, response.read()
    finally:
        connection.close()


def post(
    host: str, token: str, body: bytes, path: str = serving.ROBOTS_PATH,
    headers: Mapping[str, str | None] | None = None,
) -> tuple[int, bytes]:  # fmt: skip
    """Post as the page at `host` does, but for some headers; return the status and the answer."""
    page_headers = {
        "Host": host,
        "Origin": f"http://{host}",
        serving.TOKEN_HEADER: token,
        **(headers or {}),
    }
    response, data = ask(host, path, "POST", body, page_headers)
    return response.status, data
