"""The tables of the link keep their word: messages, statuses, sizes."""

from __future__ import annotations

import functools
import operator
import re

import pytest
from cobs import cobs

from tests.support.rows import each_row
from tests.support.texts import catalogue_texts
from tiniscript.bytecode.image import REFUSALS
from tiniscript.bytecode.verify import RULES
from tiniscript.link import messages, statuses
from tiniscript.link.frames import Frame, checksum, decode_frame, encode_frame
from tiniscript.link.messages import (
    CRC_BYTES,
    FEATURES,
    FIRST_ACTING,
    FIRST_EVENT,
    FIRST_STATUS,
    HEAD_BYTES,
    LARGE_FRAME,
    MESSAGES,
    PAYLOAD_BYTES,
    REPLY,
    RETIRED_NUMBERS,
    SEALED,
    SMALL_FRAME,
    STATUSES,
    TEXT_LEVEL,
    TEXT_LEVELS,
    payload_bytes,
    sizes,
)
from tiniscript.link.requests import MODE_BYTES, OFFSET_BYTES, SHORT_BYTES
from tiniscript.robots.text_levels import LEVELS


def test_message_numbers_are_unique_and_leave_the_flag_bits() -> None:
    numbers = [message.number for message in MESSAGES]
    assert len(set(numbers)) == len(numbers)
    assert all(0 < number < min(REPLY, SEALED) for number in numbers)
    assert len(set(STATUSES.values())) == len(STATUSES)
    assert all(number >= FIRST_STATUS for name, number in STATUSES.items() if name != "OK")
    lower = [number for number, _ in (*REFUSALS.values(), *RULES.values())]
    assert max(lower) < FIRST_STATUS
    for message in MESSAGES:
        assert message.is_action == (FIRST_ACTING <= message.number < FIRST_EVENT)


def test_no_request_number_is_text_or_a_line_end() -> None:
    """Its number is the second byte on the wire where the first may be one of a line.

    A sealed request has a 0 as its fourth byte, so that its first one on the wire is 4 at most.
    """
    for message in MESSAGES:
        assert message.number < 0x20 or message.number >= FIRST_EVENT
        assert message.number not in b"\r\n" and message.number not in RETIRED_NUMBERS
    assert set(b"\r\n") == set(RETIRED_NUMBERS)


def test_features_share_no_bit_and_levels_have_the_names_of_their_table() -> None:
    all_bits = [bits for bits, *_ in FEATURES]
    assert sum(all_bits) == functools.reduce(operator.or_, all_bits) < 1 << 16
    names = [name.lower() for name, _ in TEXT_LEVELS]
    assert names == ["none", *LEVELS] and len(names) == TEXT_LEVEL + 1


def test_every_payload_fits_a_frame() -> None:
    """It fits a small one; a payload that fills a frame can fill a large one, too."""
    large_bytes = payload_bytes(LARGE_FRAME)
    for message in MESSAGES:
        for fields, size_before in (
            (message.request, 0),
            (message.reply, message.number < FIRST_EVENT),
        ):
            fills = any(field.fills_frame for field in fields)
            max_bytes = size_before + sizes(fields)[1]
            assert max_bytes == large_bytes if fills else max_bytes <= PAYLOAD_BYTES, message.name
    assert PAYLOAD_BYTES - MODE_BYTES == SHORT_BYTES == 55
    assert (large_bytes - MODE_BYTES, large_bytes - OFFSET_BYTES) == (241, 240)


@each_row("length", range(PAYLOAD_BYTES - 2, payload_bytes(LARGE_FRAME) + 1))
def test_no_frame_can_be_a_line(length: int) -> None:
    """This holds for frames of a computer or a robot, sealed or not: the receiver looks at two
    bytes."""
    for number in (message.number for message in MESSAGES if message.number < FIRST_EVENT):
        for flags in ((False, False), (True, False), (False, True)):
            payload = b"\0" * flags[1] + b"\1" * (length - flags[1])
            frame = Frame(number, 77, 1, payload, *flags)
            wire = encode_frame(frame)
            is_large = length > PAYLOAD_BYTES
            assert len(wire) == length + HEAD_BYTES + CRC_BYTES + 2 + (is_large and not flags[1])
            assert wire[0] <= (HEAD_BYTES + 1 if is_large or flags[1] else SMALL_FRAME + 1)
            assert 0 not in wire[:-1] and decode_frame(wire[:-1]) == frame
            assert not re.match(rb"[ -~][ -~\r\n]", wire)


@pytest.mark.parametrize("is_sealed", [False, True])
def test_a_large_frame_has_a_zero_after_its_head(is_sealed: bool) -> None:
    """Also where its first byte on the wire is small for another reason: its number is 0."""
    for zero, is_whole in ((0, True), (7, False)):
        body = bytes([2 | SEALED * is_sealed, 0, 1, zero]) + bytes(PAYLOAD_BYTES)
        wire = cobs.encode(body + checksum(body).to_bytes(CRC_BYTES, "little"))
        frame = Frame(2, 0, 1, bytes(PAYLOAD_BYTES + is_sealed), is_sealed=is_sealed)
        assert decode_frame(wire) == (frame if is_whole else None)


def test_each_status_has_its_sentences() -> None:
    texts = catalogue_texts("en", "statuses")
    names = {*STATUSES, "IMAGE", "RULE", "OTHER_VERSION", "UNKNOWN_NEEDS"}
    assert {key.partition("/")[0] for key in texts} == names
    for name in names:
        assert (f"{name}/try" in texts) == (name != "OK"), name
        has_gaps = "{" in texts[f"{name}/said"]
        assert has_gaps == (name in {*messages.DETAILS, "IMAGE", "RULE"}), name


def test_sentences_have_all_gaps_filled() -> None:
    for lang in ("en", "es"):
        for status in range(1, 256):
            sentence, advice = statuses.status_text(status, 0x1234, lang)
            assert sentence and advice and "{" not in sentence + advice, (status, lang)
    too_large_text = "The program is too large: the robot has room for 430 bytes of code."
    assert statuses.status_text(71, 430, "en").message == too_large_text
    refused = "The robot's verifier refuses the code at 5: BAD_OPERAND."
    assert statuses.status_text(23, 5, "en").message == refused
    assert "DAMAGED" in statuses.status_text(6, 0, "es").message
    assert "another version" in statuses.status_text(2, 0, "en").message
    assert "0100" not in statuses.status_text(69, 256, "es").message
    assert "1.0" in statuses.status_text(69, 256, "es").message
    assert statuses.status_text(200, 0, "en") == statuses.status_text(64, 0, "en")
