"""The seal of a session: both halves agree on the same bytes, and reject others.

The bytes are derived here independently from `docs/develop/owners.md`, with only SipHash-2-4, which
is tested with its authors' vectors.
"""

from __future__ import annotations

import random

import pytest

from tests.machines.link import cpp_link
from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.messages import BY_NAME, SEALED_PAYLOAD_BYTES
from tiniscript.link.receiver import Receiver
from tiniscript.link.seal import LAST_COUNTER, Seal, session_key, siphash

KEY = bytes(range(16))
CHALLENGE = bytes.fromhex("a1a2a3a4a5a6a7a8")
NONCE, ROBOT_NONCE, EPOCH, KEY_KIND = 0x01020304, 0x08070605, 10, 0
NUMBERS = [
    number for number in range(1, 64) if number != BY_NAME["WIFI"].number
]  # that is covered, too
ORIGIN = CHALLENGE + bytes.fromhex("04030201 05060708 0a 00")
# For the messages 00, 00 01, 00 01 02 ..., one for each length of a last block, beginning with the
# empty one.
VECTORS = [
    "310e0edd47db6f72",
    "fd67dc93c539f874",
    "5a4fa9d909806c0d",
    "2d7efbd796666785",
    "b7877127e09427cf",
    "8da699cd64557618",
    "cee3fe586e46c9cb",
    "37d1018bf50002ab",
    "6224939a79f5f593",
    "b0e4a90bdf82009e",
    "f3b9dd94c5bb5d7a",
    "a7ad6b22462fb3f4",
    "fbe50e86bc8f1e75",
    "903d84c02756ea14",
    "eef27a8e90ca23f7",
    "e545be4961ca29a1",
    "db9bc2577fcc2a3f",
]


def whole_frame(frame: Frame) -> bytes:
    kind = frame.number | 0x80 * frame.is_reply | 0x40 * frame.is_sealed
    return bytes((kind, frame.seq, frame.epoch)) + frame.payload


def sealed_by_hand(frame: Frame, counter: int) -> bytes:
    """Return a sealed frame as the document says it, up to its MAC."""
    key = siphash(KEY, b"\1" + ORIGIN) + siphash(KEY, b"\2" + ORIGIN)
    kind = frame.number | 0x40 | 0x80 * frame.is_reply
    head = bytes((kind, frame.seq, frame.epoch, 0)) + counter.to_bytes(4, "little")
    return head + frame.payload + siphash(key, head + frame.payload)


def seal(heard_counter: int = 0, sent_counter: int = 0) -> Seal:
    made_seal = Seal(session_key(KEY, CHALLENGE, NONCE, ROBOT_NONCE, EPOCH, KEY_KIND))
    made_seal.heard_counter, made_seal.sent_counter = heard_counter, sent_counter
    return made_seal


def frame_of(data: bytes) -> Frame:
    kind, seq, epoch = data[:3]
    return Frame(kind & 0x3F, seq, epoch, data[3:], bool(kind & 0x80), bool(kind & 0x40))


def random_frame(rng: random.Random, is_reply: bool) -> Frame:
    payload = rng.randbytes(rng.randrange(SEALED_PAYLOAD_BYTES + 1))
    number, seq, epoch = rng.choice(NUMBERS), rng.randrange(256), rng.randrange(256)
    return Frame(number, seq, epoch, payload, is_reply)


def counters(rng: random.Random) -> int:
    return rng.choice(
        (1, 2, 0xFF, 0x100, LAST_COUNTER - 1, LAST_COUNTER, rng.randrange(1, LAST_COUNTER))
    )


def test_the_hash_matches_the_authors_test_vectors() -> None:
    assert [siphash(KEY, bytes(range(n))).hex() for n in range(len(VECTORS))] == VECTORS


def test_the_robot_computes_the_same_hash() -> None:
    rng = random.Random(1)
    for _ in range(500):
        key, message = rng.randbytes(16), rng.randbytes(rng.randrange(200))
        assert cpp_link().siphash(key, message) == siphash(key, message)


def test_the_robot_opens_only_fresh_seals_of_the_computer() -> None:
    rng = random.Random(1)
    for _ in range(300):
        frame, counter = random_frame(rng, False), counters(rng)
        sealed_bytes = sealed_by_hand(frame, counter)
        assert whole_frame(seal(sent_counter=counter - 1).seal_frame(frame)) == sealed_bytes
        assert cpp_link().opens(KEY, ORIGIN, counter - 1, sealed_bytes)
        assert not cpp_link().opens(KEY, ORIGIN, counter, sealed_bytes)


def test_the_computer_opens_only_fresh_seals_of_the_robot() -> None:
    rng = random.Random(2)
    for _ in range(300):
        frame, counter = random_frame(rng, True), counters(rng)
        marked_frame, sealed_bytes = (
            whole_frame(frame._replace(is_sealed=True)),
            sealed_by_hand(frame, counter),
        )
        assert cpp_link().seal(KEY, ORIGIN, 0, counter - 1, marked_frame) == sealed_bytes
        robot_seal = seal(heard_counter=counter - 1)
        assert robot_seal.open_frame(frame_of(sealed_bytes)) == frame._replace(is_sealed=True)
        assert robot_seal.open_frame(frame_of(sealed_bytes)) is None  # once
        assert seal(heard_counter=counter).open_frame(frame_of(sealed_bytes)) is None


def test_each_bit_and_each_length_counts() -> None:
    frame = Frame(8, 3, 10, bytes.fromhex("10448c50"))
    to_robot, to_computer = (
        sealed_by_hand(frame, 7),
        sealed_by_hand(frame._replace(is_reply=True), 7),
    )
    assert seal(6).open_frame(frame_of(to_computer))
    assert cpp_link().opens(KEY, ORIGIN, 6, to_robot)
    for bit in range(8 * len(to_robot)):
        change = 1 << bit % 8
        for data in (to_robot, to_computer):
            changed_data = bytearray(data)
            changed_data[bit // 8] ^= change
            assert seal(0).open_frame(frame_of(bytes(changed_data))) is None
            assert not cpp_link().opens(KEY, ORIGIN, 0, bytes(changed_data))
    for length in range(3, len(to_robot)):
        assert seal(0).open_frame(frame_of(to_computer[:length])) is None
        assert not cpp_link().opens(KEY, ORIGIN, 0, to_robot[:length])


def test_a_different_origin_gives_a_different_key() -> None:
    sealed_bytes = sealed_by_hand(Frame(7, 1, 10, b"\0"), 1)
    assert cpp_link().opens(KEY, ORIGIN, 0, sealed_bytes)
    keys = {session_key(KEY, CHALLENGE, NONCE, ROBOT_NONCE, EPOCH, KEY_KIND)}
    for index in range(len(ORIGIN)):
        other_origin = bytearray(ORIGIN)
        other_origin[index] ^= 1
        assert not cpp_link().opens(KEY, bytes(other_origin), 0, sealed_bytes)
        nonces = (int.from_bytes(other_origin[offset : offset + 4], "little") for offset in (8, 12))
        keys.add(session_key(KEY, bytes(other_origin[:8]), *nonces, *other_origin[16:]))
    assert len(keys) == len(ORIGIN) + 1


def test_an_exhausted_counter_seals_nothing_more() -> None:
    full_seal = seal(sent_counter=LAST_COUNTER - 1)
    assert not full_seal.is_spent
    full_seal.seal_frame(Frame(2, 1, 1))
    assert full_seal.is_spent
    with pytest.raises(AssertionError):
        full_seal.seal_frame(Frame(2, 1, 1))
    marked_frame = whole_frame(Frame(2, 1, 1, is_reply=True, is_sealed=True))
    assert cpp_link().seal(KEY, ORIGIN, 0, LAST_COUNTER - 1, marked_frame)
    assert cpp_link().seal(KEY, ORIGIN, 0, LAST_COUNTER, marked_frame) == b""
    assert not cpp_link().opens(
        KEY, ORIGIN, LAST_COUNTER, sealed_by_hand(Frame(2, 1, 1), LAST_COUNTER)
    )


def test_no_sealed_frame_can_be_a_line_of_text() -> None:
    """Its 0 comes early: so it begins with a byte up to 4."""
    rng = random.Random(5)
    for _ in range(2000):
        wire = encode_frame(
            seal(sent_counter=counters(rng) - 1).seal_frame(random_frame(rng, False))
        )
        assert wire[0] <= 4
        receiver = Receiver()
        for byte in b"\0" + wire:
            receiver.put(byte, 0)
        assert receiver.packet and not receiver.packet.is_text


def test_a_key_appears_in_no_text() -> None:
    texts = f"{seal()!r} {seal()}"
    assert KEY.hex() not in texts and "key" not in texts
