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

    def __init__(self, chance: random.Random, old_frames: list[bytes]) -> None:
        self.chance = chance
        self.old = old_frames
        self.sent: list[bytes] = []  # frames under the current seal
        self.replies: list[bytes] = []

    def frame(self, epoch: int, seq: int) -> tuple[str, bytes]:
        chance = self.chance
        attack = chance.choice(
            ("replayed", "reflected", "other session", "cut", "changed", "unsealed", "moved",
             "forged", "sealed by another key")
        )  # fmt: skip
        own_frame = chance.choice(self.sent)
        frame = decode_frame(own_frame)
        assert frame
        if attack == "replayed":
            return attack, own_frame
        if attack == "reflected":
            reply = decode_frame(chance.choice(self.replies))
            return attack, encoded(reply._replace(is_reply=False)) if reply else own_frame
        if attack == "other session":
            return attack, chance.choice(self.old)
        if attack == "cut":
            return attack, encoded(
                frame._replace(payload=frame.payload[: -chance.randrange(1, 13)])
            )
        if attack == "changed":
            changed_bytes = bytearray(frame.payload)
            changed_bytes[chance.randrange(len(changed_bytes))] ^= 1 << chance.randrange(8)
            return attack, encoded(frame._replace(payload=bytes(changed_bytes)))
        if attack == "unsealed":
            payload = frame.payload[5:-8]
            return attack, encoded(frame._replace(payload=payload, seq=seq, is_sealed=False))
        if attack == "moved":  # changes the number of the request, the message or the counter
            count = chance.choice((seq, chance.randrange(256))) if chance.random() < 0.5 else 0
            rising = frame.payload[:1] + (2**32 - 1).to_bytes(4, "little") + frame.payload[5:]
            number = chance.choice((frame.number, 7, 8, 9, 19))
            payload = chance.choice((frame.payload, rising))
            return attack, encoded(frame._replace(payload=payload, seq=count, number=number))
        acting = [
            message for message in MESSAGES if 6 <= message.number < 32 and message.number != 17
        ]
        message = chance.choice(acting)
        min_bytes = sum(field.least_bytes for field in message.request)
        max_bytes = min(sum(field.most_bytes for field in message.request), SEALED_PAYLOAD_BYTES)
        asked_frame = Frame(
            message.number, seq, epoch, chance.randbytes(chance.randint(min_bytes, max_bytes))
        )
        if attack == "forged":
            counter = chance.choice((1, 1000, 2**32 - 1)).to_bytes(4, "little")
            forged_payload = b"\0" + counter + asked_frame.payload + chance.randbytes(8)
            return attack, encoded(asked_frame._replace(payload=forged_payload, is_sealed=True))
        seal = Seal(chance.randbytes(16))
        seal.sent_counter = 10_000
        return attack, encoded(seal.seal_frame(asked_frame))


def encoded(frame: Frame) -> bytes:
    return encode_frame(frame)[:-1]
