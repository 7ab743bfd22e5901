"""An invisible sign is named by its number, in any place."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check


@pytest.mark.parametrize("sign", ["\u2028", "\u2029", "\u200e", "\u2060", "\u0085", "\u00ad"])
@pytest.mark.parametrize("text", ["{}SI|F(1, 50)", "SI|{}F(1, 50)", "F(1, 50){}", "F(1,{} 50);S"])
def test_an_invisible_character_is_named(text: str, sign: str) -> None:
    (diagnostic,) = check(text.format(sign))
    assert diagnostic.values["found"] == f"U+{ord(sign):04X}"
    assert diagnostic.code.number == "TS005"
