"""Frames of a robot as a session gets them."""

from __future__ import annotations

from tests.support.link_cases import KIT
from tiniscript.bytecode.image import pack, unpack
from tiniscript.bytecode.opcodes import ISA_MAJOR, ISA_MINOR
from tiniscript.link import messages
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import BY_NAME
from tiniscript.link.session import Session

FORWARD = bytes.fromhex("448c50")  # F(5,80)
DESCRIPTION: dict[str, int | bytes] = {
    "major": messages.MAJOR, "minor": 0, "isa_major": ISA_MAJOR, "isa_minor": ISA_MINOR, "kit": KIT,
    "id": 7, "nonce": 8,
    "largest": 63, "window": 1, "features": 0, "room": 389, "state": 0, "run": 0, "program": 0,
    "length": 0, "slot": 0, "saved": 0, "fault": 0, "fault_at": 0, "fault_program": 0,
    "reset": 1, "name": b"Tini",
}  # fmt: skip


def answer(
    sent_bytes: bytes, values: dict[str, int | bytes], status: int = 0, epoch: int = 10
) -> bytes:
    """Return a robot's answer to a session's request."""
    frame = decode_frame(sent_bytes.strip(b"\0"))
    assert frame
    payload = bytes((status, 0, 0))
    if not status:
        payload = b"\0" + messages.encode_payload(messages.BY_NUMBER[frame.number].reply, values)
    return b"\0" + encode_frame(Frame(frame.number, frame.seq, epoch, payload, is_reply=True))


def event(name: str, seq: int, values: dict[str, int | bytes], epoch: int = 11) -> bytes:
    message = BY_NAME[name]
    payload = messages.encode_payload(message.reply, values)
    return b"\0" + encode_frame(Frame(message.number, seq, epoch, payload, is_reply=True))


def greet(baud: int = 9600, now_ms: int = 0, features: int = 0) -> Session:
    """Return a session that has said HELLO."""
    session = Session(1, baud, KIT)
    session.hello()
    session.receive(answer(session.poll(now_ms), {**DESCRIPTION, "features": features}), now_ms)
    assert session.robot and session.robot.name == "Tini" and session.robot.room == 389
    return session


def receipt(run: int, code: bytes = FORWARD) -> dict[str, int | bytes]:
    checksum = unpack(pack("SI", 0, code)).checksum
    return {"program": checksum, "run": run, "slot": 0, "saved": 1}
