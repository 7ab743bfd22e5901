"""The tables of the link keep their word: messages, statuses, sizes."""

from __future__ import annotations

import functools
import operator
import re

import pytest

from tiniscript.bytecode.image import REFUSALS
from tiniscript.bytecode.verify import RULES
from tiniscript.link import messages, statuses
from tiniscript.link.frames import Frame, decoded, encoded
from tiniscript.link.messages import (
    BY_NAME,
    FEATURES,
    FIRST_ACTING,
    FIRST_EVENT,
    FIRST_STATUS,
    LARGEST,
    MESSAGES,
    PAYLOAD_BYTES,
    REPLY,
    SEALED,
    STATUSES,
    TEXT_FROM,
    TEXT_LEVEL,
    TEXT_LEVELS,
    sizes,
)
from tiniscript.link.requests import DATA_BYTES, SHORT_BYTES
from tiniscript.text.levels import LEVELS
from tools.bench import link_size, machine_size


def test_numbers_are_used_once_and_leave_the_bits_alone() -> None:
    numbers = [each.number for each in MESSAGES]
    assert len(set(numbers)) == len(numbers)
    assert all(0 < number < min(REPLY, SEALED) for number in numbers)
    assert len(set(STATUSES.values())) == len(STATUSES)
    assert all(number >= FIRST_STATUS for name, number in STATUSES.items() if name != "OK")
    lower = [number for number, _ in (*REFUSALS.values(), *RULES.values())]
    assert max(lower) < FIRST_STATUS
    for each in MESSAGES:
        assert each.acts == (FIRST_ACTING <= each.number < FIRST_EVENT)


def test_features_share_no_bit_and_levels_have_the_names_of_their_table() -> None:
    every = [bits for bits, *_ in FEATURES]
    assert sum(every) == functools.reduce(operator.or_, every) < 1 << 16
    names = [name.lower() for name, _ in TEXT_LEVELS]
    assert names == ["none", *LEVELS] and len(names) == TEXT_LEVEL + 1


def test_every_payload_fits_a_frame() -> None:
    for each in MESSAGES:
        assert sizes(each.request)[1] <= PAYLOAD_BYTES, each.name
        assert sizes(each.reply)[1] + (each.number < FIRST_EVENT) <= PAYLOAD_BYTES, each.name
    assert (
        sizes(BY_NAME["PROGRAM"].request)[1] == sizes(BY_NAME["DATA"].request)[1] == PAYLOAD_BYTES
    )
    assert (SHORT_BYTES, DATA_BYTES) == (55, 54)


def test_no_frame_begins_like_text() -> None:
    for seq in range(1, 256):
        longest = Frame(1, seq, 1, b"\1" * PAYLOAD_BYTES)
        assert len(encoded(longest)) == LARGEST + 2
        assert encoded(longest)[0] < TEXT_FROM
        assert decoded(encoded(longest)[:-1]) == longest


def test_each_status_has_its_sentences() -> None:
    assert set(statuses.texts()) == {*STATUSES, "IMAGE", "RULE", "OTHER_VERSION"}
    for name, words in statuses.texts().items():
        assert {"en", "es"} <= set(words) <= {"en", "es", "en_try", "es_try"}, name
        assert ("en_try" in words) == ("es_try" in words) == (name != "OK"), name
        gaps = {lang: set(re.findall(r"{(\w+)}", words[lang])) for lang in ("en", "es")}
        assert gaps["en"] == gaps["es"], name
        assert bool(gaps["en"]) == (name in {*messages.DETAILS, "IMAGE", "RULE"}), name


@pytest.mark.parametrize("lang", ["en", "es"])
def test_sentences_have_no_gaps_left(lang: str) -> None:
    for status in range(1, 256):
        said, advice = statuses.sentence(status, 0x1234, lang)
        assert said and advice and "{" not in said + advice


def test_some_sentences() -> None:
    assert statuses.sentence(71, 430, "en").said == (
        "The program is too large: the robot has room for 430 bytes of code."
    )
    assert statuses.sentence(23, 5, "en").said == (
        "The robot's verifier refuses the code at 5: BAD_OPERAND."
    )
    assert "DAMAGED" in statuses.sentence(6, 0, "es").said
    assert "another version" in statuses.sentence(2, 0, "en").said
    assert "0100" not in statuses.sentence(69, 256, "es").said
    assert "1.0" in statuses.sentence(69, 256, "es").said
    assert statuses.sentence(200, 0, "en") == statuses.sentence(64, 0, "en")


@pytest.mark.skipif(
    bool(machine_size.missing(machine_size.AVR)), reason=machine_size.missing(machine_size.AVR)
)
def test_the_link_keeps_to_its_size() -> None:
    """What it takes beside the machine on an ATmega328P, with the flags of Arduino."""
    found = link_size.size()
    assert 2000 < found.flash <= link_size.MUST
    assert 150 < found.ram <= 400
