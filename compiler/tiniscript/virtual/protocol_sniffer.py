"""Decides by the first bytes of a connection whether its client may be meant for a robot.

A web page can make a browser of this computer connect to any of its ports: with HTTP (WebSockets
begin as HTTP), with TLS, and with STUN, which WebRTC uses. The page chooses what follows, so
nothing of such a connection may reach a robot. Knows no socket.
"""

from __future__ import annotations

import re

from tiniscript.link.messages import TEXT_FROM

LONGEST = 2048  # bytes of a first line that is still open

_TOKEN = rb"[!#$%&'*+.^_`|~0-9A-Za-z-]+"  # of RFC 9110: any method
_METHOD = re.compile(_TOKEN)
# a whole first line
_REQUEST = re.compile(_TOKEN + rb"[ \t]+[^\x00-\x20]+[ \t]+HTTP/", re.IGNORECASE)
# the beginning of one, and the whole first line of HTTP/0.9
_KNOWN = re.compile(
    rb"(?:GET|HEAD|POST|PUT|DELETE|CONNECT|OPTIONS|TRACE|PATCH|PRI)[ \t]+(?:[/*]|https?:)",
    re.IGNORECASE,
)
_LINE_END = re.compile(rb"[\r\n\0]")
# a typed stop, if its line ended here: `link/typed_stop.h` says where one begins
_STOP = re.compile(
    rb"(?:\A|[\0-\x08\n-\x1f\x7f](?:(?<=\x1b)[\[O][0-?]*[@-\x7f])?)[ \t;]*S(?:TOP)?[ \t;]*\Z",
    re.IGNORECASE,
)
_EMPTY_LINES = re.compile(rb"[\r\n]+(?=[A-Za-z]|\Z)")  # servers of HTTP skip them


def is_for_robot(data: bytes) -> bool | None:
    """Return whether bytes that begin like this may reach a robot; None: not known yet.

    Waiting costs nothing: a robot acts only when a frame or a line of text has ended, and
    `is_at_stop` finds the typed stop that silence ends.
    """
    rest = data.lstrip(b"\0")
    if len(data) - len(rest) > 1:
        return True  # the stop sequence: zeros alone do nothing else
    empty = _EMPTY_LINES.match(rest)
    rest = rest[empty.end() :] if empty else rest
    if not rest:
        return None
    return _is_frame(rest) if rest[0] < TEXT_FROM else _is_text(rest)


def is_at_stop(data: bytes) -> bool:
    """Return whether bytes end with a line that is a typed stop if nothing more comes."""
    return _STOP.search(data) is not None


def _is_frame(data: bytes) -> bool | None:
    """A frame has eight bytes and more without a zero, and a type that is not 0: no 0x01 first."""
    if data[0] == 1 or 0 in data[:3]:
        return False  # STUN, bare or framed
    if len(data) < 3:
        return None
    return data[:2] != b"\x16\x03"  # TLS; a STATUS that is so long does not exist


def _is_text(data: bytes) -> bool | None:
    line = _LINE_END.split(data, 1)[0]
    if _REQUEST.match(line) or _KNOWN.match(line):
        return False
    method = _METHOD.match(line)
    if method is None or (method.end() < len(line) and line[method.end()] not in b" \t"):
        return True  # `F(`: no method
    target = line[method.end() :].lstrip(b" \t")
    if target[:1] == b"=":
        return True  # `X = 5`: no target
    if len(line) < len(data):
        return True  # the line has ended, and is no request
    return None if len(data) <= LONGEST else False
