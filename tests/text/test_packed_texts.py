"""The texts that a robot says, packed and unpacked again."""

from __future__ import annotations

import pytest

from tools.generate.packed_texts import (
    END_CODE,
    FIRST_LETTER,
    MAX_NESTED_PAIRS,
    Pair,
    pack_texts,
    unpack_texts,
)
from tools.generate.remark_tables import rows


@pytest.mark.parametrize("is_small", [False, True])
@pytest.mark.parametrize("language", ["en", "es"])
def test_packed_robot_texts_unpack_unchanged(language: str, is_small: bool) -> None:
    texts = rows(language, is_small)
    data = pack_texts(texts)
    assert unpack_texts(data) == texts
    assert data.size < 0.75 * sum(len(text) + 1 for text in texts)


def test_unused_texts_are_omitted_on_small_robots() -> None:
    """All that it says keeps its number."""
    all_texts, small_texts = rows("en"), rows("en", is_small=True)
    unsaid_texts = [
        text
        for text, packed_text in zip(all_texts, small_texts, strict=True)
        if text != packed_text
    ]
    assert unsaid_texts == [
        "Not in a block", "Only one task may call this DEF", ", text mega", ", text esp32",
        "No program reads keys", "STUCK", "STUCK_LEFT", "STUCK_RIGHT",
    ]  # fmt: skip
    assert set(small_texts) == {*all_texts, ""} - {*unsaid_texts}


@pytest.mark.parametrize(
    "texts",
    [[""], ["", "A", ""], ["AAAAAAA", "AAA"], ["~"], ["abc" * 20, "bcab" * 9], ["x" * 200, "|}"]],
)
def test_packed_texts_unpack_unchanged(texts: list[str]) -> None:
    assert unpack_texts(pack_texts(texts)) == texts


@pytest.mark.parametrize("language", ["en", "es"])
def test_nested_pairs_are_not_too_deep(language: str) -> None:
    """The robot's stack holds a call for each. No pair has an end."""
    data = pack_texts(rows(language))

    def depth(code: int) -> int:
        return 0 if code >= FIRST_LETTER else 1 + max(map(depth, pair_of(code)))

    def pair_of(code: int) -> Pair:
        return data.pairs[code - 1]

    assert max(map(depth, range(1, 1 + len(data.pairs)))) <= MAX_NESTED_PAIRS
    assert END_CODE not in {code for pair in data.pairs for code in pair}
    assert len(data.pairs) < FIRST_LETTER
