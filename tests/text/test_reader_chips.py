"""The reader of text on the emulated chips of ESP boards agrees with the one on this computer.

On these chips, a char may be unsigned, and a word must be at an address divisible by four.
"""

from __future__ import annotations

import pytest

from tests.machines.qemu import missing, start_emulator
from tests.machines.text_reader import LARGEST_ROOM, TextReader
from tests.support.casefile import all_cases
from tests.support.kits import KITS
from tests.support.reader_agreement import some_texts
from tools.builds import chips

KIT = KITS[1][1]
CASES = [
    pytest.param(name, marks=pytest.mark.skipif(bool(why), reason=why or "there is a chip"))
    for name in chips.CHIPS
    for why in [missing(name)]
]


def texts() -> list[bytes]:
    codes = [
        case.parts["tiniscript"].encode() for case in all_cases() if "tiniscript" in case.parts
    ]
    return [text for text in codes + some_texts(3000, 1000) if text.strip()]


@pytest.mark.sampled("name")
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("room", [200, 374, LARGEST_ROOM])
def test_the_chip_gives_the_same_answers(name: str, room: int) -> None:
    all_texts = texts()
    reader = TextReader(KIT, room)
    expected = [reader.read(text) for text in all_texts]
    reader.close()
    answers = start_emulator(name).read(all_texts, KIT, room)
    for text, expected_answer, answer in zip(all_texts, expected, answers, strict=True):
        assert answer == expected_answer, text
    assert sum(answer.is_program for answer in answers) > 1000
    assert sum(bool(answer.problem) for answer in answers) > 1000
