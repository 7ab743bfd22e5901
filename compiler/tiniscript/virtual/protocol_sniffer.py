"""Decides by the first bytes of a connection whether its client may be meant for a robot.

A web page can make a browser of this computer connect to any of its ports: with HTTP (WebSockets
begin as HTTP), with TLS, and with STUN, which WebRTC uses. The page chooses what follows, so
nothing of such a connection may reach a robot. Knows no socket.
"""

from __future__ import annotations

import re

MAX_LINE_BYTES = 2048  # bytes of a first line that is still open

_TOKEN = rb"[!#$%&'*+.^_`|~0-9A-Za-z-]+"  # a token of RFC 9110: any method
_METHOD = re.compile(_TOKEN)
# a whole first line
_REQUEST = re.compile(_TOKEN + rb"[ \t]+[^\x00-\x20]+[ \t]+HTTP/", re.IGNORECASE)
# the beginning of one, and the whole first line of HTTP/0.9
_HTTP_METHOD_AND_TARGET = re.compile(
    rb"(?:GET|HEAD|POST|PUT|DELETE|CONNECT|OPTIONS|TRACE|PATCH|PRI)[ \t]+(?:[/*]|https?:)",
    re.IGNORECASE,
)
_LINE_END = re.compile(rb"[\r\n\0]")
_TEXT_START = re.compile(rb"[ -~]{2}")  # start of a line, which no frame has


def sniff_robot_client(data: bytes) -> bool | None:
    """Return whether bytes that begin like this may reach a robot; None: not known yet.

    A client of frames begins with a 0x00. Waiting costs nothing: a robot acts only when a frame or
    a line of text has ended, and `is_at_stop` finds the typed stop that silence ends.
    """
    if data[:2] == b"\0\0":
        return True  # the stop sequence: zeros alone have no other effect
    if data[:1] < b" ":
        if 0 in data[1:3] or data[:2] in (b"\0\1", b"\x16\x03"):
            return False  # STUN, which may begin with its length, and TLS
        if len(data) < 3:
            return None
    is_framed = data[0] == 0
    if is_framed and not _TEXT_START.match(data, 1):
        return True
    return _sniff_text(data[is_framed:])


def _sniff_text(data: bytes) -> bool | None:
    line, *later_lines = _LINE_END.split(
        data.lstrip(b"\r\n"), 1
    )  # servers of HTTP skip empty lines
    if _REQUEST.match(line) or _HTTP_METHOD_AND_TARGET.match(line):
        return False
    method = _METHOD.match(line)
    if line and (method is None or line[method.end() : method.end() + 1] not in b" \t"):
        return True  # `F(`: no method
    target = line[method.end() :].lstrip(b" \t") if method else b""
    if target[:1] == b"=" or later_lines:
        return True  # `X = 5`: no target; and a line that has ended, and is no request
    return None if len(data) <= MAX_LINE_BYTES else False
