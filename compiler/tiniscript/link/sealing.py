"""Decides which requests of a session are sealed, and which frames of the robot are trusted.

Knows no exchange. `seal` knows the bytes of a sealed frame.
"""

from __future__ import annotations

from tiniscript.link.authority import NOT_OWNER
from tiniscript.link.frames import Frame
from tiniscript.link.messages import AUTHORITY_MS, FIRST_EVENT
from tiniscript.link.requests import OK, Request
from tiniscript.link.seal import Seal
from tiniscript.link.transmission import Transmission

UNSEALED_MESSAGES = ("HELLO", "AUTHENTICATE")  # the seal is made from their contents
REFUSED_TRIES = 3  # sendings of a tag before a refusal counts, which anybody may have written
KEYLESS_MESSAGES = (*UNSEALED_MESSAGES, "PING", "STATUS", "STOP", "CLAIM", "IDENTIFY")
SEALED_ONLY_MESSAGES = ("WIFI",)  # these contain a password, so they must be sealed


class Sealing:
    """`seal` seals requests; `sealed_ms` is the time of the last sealed one."""

    def __init__(self) -> None:
        self.seal: Seal | None = None
        self.sealed_ms = 0
        self._seq: int | None = None

    def seal_for(self, request: Request) -> Seal | None:
        """Return the seal for a request. HELLO and AUTHENTICATE end a seal."""
        if request.name not in UNSEALED_MESSAGES:
            return self.seal
        self.seal = request.seal
        return None

    def next_number(self, seq: int) -> int:
        """Return the number of a sealed request: not that of the last one, or it would be that."""
        self._seq = (seq + (seq == self._seq)) & 0xFF
        return self._seq

    def open_frame(self, frame: Frame, transmission: Transmission, now_ms: int) -> Frame | None:
        """Return the content of a frame, or None if it may not be the robot's.

        A robot that has not heard our seal for some time has dropped it, and says so without one.
        Nor can it seal the answer that a tag is wrong, so the tag is sent again first, to get a
        sealed reply.
        """
        if frame.is_sealed:
            return self.seal.open_frame(frame) if self.seal else None
        if not frame.is_reply or self.seal is None:
            return frame
        if frame.number >= FIRST_EVENT:
            is_believed = now_ms - self.sealed_ms >= AUTHORITY_MS
        elif transmission.is_answered_by(frame):
            status = frame.payload[0] if frame.payload else OK
            has_waited = status != OK and transmission.tries >= REFUSED_TRIES
            is_believed = status == NOT_OWNER if transmission.seal else has_waited
        else:
            is_believed = True  # a second, unsealed answer has no effect
        return frame if is_believed else None
