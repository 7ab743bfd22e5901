"""The number that is typed into a block, with the decimal sign of the person who types."""

from __future__ import annotations

import json
import random
from pathlib import Path

from tests.support.node import in_node, page_data

__all__ = ["page_data"]

SCRIPT = Path(__file__).with_name("number_field_in_node.mjs")


def test_commas_and_points_are_accepted_as_decimal_and_group_separators(
    page_data: Path,
) -> None:
    rng = random.Random(1)
    rows: list[tuple[str, float]] = []
    for _ in range(2000):
        decimal_count = rng.randint(0, 3)
        number = round(rng.choice([1, 100, 1_000_000]) * rng.uniform(-2, 2), decimal_count)
        number_text = f"{number:.{decimal_count}f}"
        rows += [(number_text, number), (f" {number:,.{decimal_count}f}", number)]
        if decimal_count in (1, 2) or abs(number) < 1:
            rows.append((number_text.replace(".", ","), number))
    input_lines = "".join(f"{json.dumps(number_text)}\n" for number_text, _ in rows)
    for (number_text, number), row in zip(
        rows, in_node(SCRIPT, str(page_data), input_text=input_lines), strict=True
    ):
        value, text = json.loads(row)
        assert value == number and float(text) == number, number_text


def test_anything_but_a_number_changes_nothing(page_data: Path) -> None:
    typed_texts = ["1.2.3", "1,2,3", "1,000,5", "2,5.5", "dos", "1.5,0", "--1", "1,00,000"]
    input_lines = "".join(f"{json.dumps(text)}\n" for text in typed_texts)
    for text, row in zip(
        typed_texts, in_node(SCRIPT, str(page_data), input_text=input_lines), strict=True
    ):
        assert json.loads(row)[0] == 7, text
