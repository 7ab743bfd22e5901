"""A thief on the owner's line, who makes frames from recorded ones."""

from __future__ import annotations

import random

from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import MESSAGES, SEALED_PAYLOAD_BYTES
from tiniscript.link.seal import Seal


class Thief:
    """A thief who hears an owner's line, and writes into it. `recorded` has frames of other seals
    too.
    """

    def __init__(self, rng: random.Random, old_frames: list[bytes]) -> None:
        self.rng = rng
        self.old_frames = old_frames
        self.sent_frames: list[bytes] = []  # frames under the current seal
        self.replies: list[bytes] = []

    def frame(self, epoch: int, seq: int) -> tuple[str, bytes]:
        rng = self.rng
        attack = rng.choice(
            ("replayed", "reflected", "other session", "cut", "changed", "unsealed", "moved",
             "forged", "sealed by another key")
        )  # fmt: skip
        own_frame = rng.choice(self.sent_frames)
        frame = decode_frame(own_frame)
        assert frame
        if attack == "replayed":
            return attack, own_frame
        if attack == "reflected":
            reply = decode_frame(rng.choice(self.replies))
            return attack, encoded(reply._replace(is_reply=False)) if reply else own_frame
        if attack == "other session":
            return attack, rng.choice(self.old_frames)
        if attack == "cut":
            return attack, encoded(frame._replace(payload=frame.payload[: -rng.randrange(1, 13)]))
        if attack == "changed":
            changed_bytes = bytearray(frame.payload)
            changed_bytes[rng.randrange(len(changed_bytes))] ^= 1 << rng.randrange(8)
            return attack, encoded(frame._replace(payload=bytes(changed_bytes)))
        if attack == "unsealed":
            payload = frame.payload[5:-8]
            return attack, encoded(frame._replace(payload=payload, seq=seq, is_sealed=False))
        if attack == "moved":  # changes the number of the request, the message or the counter
            count = rng.choice((seq, rng.randrange(256))) if rng.random() < 0.5 else 0
            rising = frame.payload[:1] + (2**32 - 1).to_bytes(4, "little") + frame.payload[5:]
            number = rng.choice((frame.number, 7, 8, 9, 19))
            payload = rng.choice((frame.payload, rising))
            return attack, encoded(frame._replace(payload=payload, seq=count, number=number))
        acting = [
            message for message in MESSAGES if 6 <= message.number < 32 and message.number != 17
        ]
        message = rng.choice(acting)
        min_bytes = sum(field.least_bytes for field in message.request)
        max_bytes = min(sum(field.most_bytes for field in message.request), SEALED_PAYLOAD_BYTES)
        asked_frame = Frame(
            message.number, seq, epoch, rng.randbytes(rng.randint(min_bytes, max_bytes))
        )
        if attack == "forged":
            counter = rng.choice((1, 1000, 2**32 - 1)).to_bytes(4, "little")
            forged_payload = b"\0" + counter + asked_frame.payload + rng.randbytes(8)
            return attack, encoded(asked_frame._replace(payload=forged_payload, is_sealed=True))
        seal = Seal(rng.randbytes(16))
        seal.sent_counter = 10_000
        return attack, encoded(seal.seal_frame(asked_frame))


def encoded(frame: Frame) -> bytes:
    return encode_frame(frame)[:-1]
