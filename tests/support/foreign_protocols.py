"""The first bytes of clients of other protocols: HTTP, TLS, STUN."""

from __future__ import annotations

import contextlib
import ssl


def tls_hello() -> bytes:
    """Return the first bytes of a browser for https."""
    incoming, outgoing = ssl.MemoryBIO(), ssl.MemoryBIO()
    tls = ssl.create_default_context().wrap_bio(incoming, outgoing, server_hostname="localhost")
    with contextlib.suppress(ssl.SSLWantReadError):
        tls.do_handshake()
    return outgoing.read()


STUN = bytes.fromhex("2112a442") + bytes(range(1, 13))  # magic cookie and transaction id
FOREIGN_GREETINGS = {
    "get": b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n",
    "get of old": b"GET /\r\n",
    "post": b"POST /any?a=b HTTP/1.1\r\nContent-Length: 5\r\n\r\n",
    "lower case": b"post / http/1.1\r\n",
    "options": b"OPTIONS * HTTP/1.1\r\n",
    "head": b"HEAD / HTTP/1.0\n",
    "connect": b"CONNECT localhost:80 HTTP/1.1\r\n",
    "proxy": b"GET http://localhost/ HTTP/1.1\r\n",
    "any method": b"PING| / HTTP/1.1\r\n",
    "a method like a program": b"SI|F / HTTP/1.1\r\n",
    "http 2": b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
    "tabs": b"POST\t/\tHTTP/1.1\r\n",
    "empty lines": b"\r\n\r\nPOST / HTTP/1.1\r\n",
    "after a zero": b"\0POST / HTTP/1.1\r\n",
    "a long address": b"ANY /" + b"a" * 10_000 + b" HTTP/1.1\r\n",
    "tls": tls_hello(),
    "ssl 3": b"\x16\x03\x00\x00\x50\x01",
    "stun": b"\0\1\0\x14" + STUN,
    "turn": b"\0\3\0\x08" + STUN,
    "framed stun": b"\0\x28\0\1\0\x14" + STUN,
    "long framed stun": b"\2\x28\0\1\2\x14" + STUN,
}
