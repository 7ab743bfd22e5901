"""Which tests begin first where several processes share them."""

from __future__ import annotations

from tests.support.casefile import ROOT
from tests.support.order import LONG, PAGES, spread_names


def test_each_part_begins_with_long_files_whole_and_ends_with_quick_tests() -> None:
    pages = [f"{PAGES}_{k}.py" for k in range(3)]
    quick = [f"tests/text/test_{k}.py" for k in range(200)]
    names = [*quick[:100], *(each for name in (*pages, *LONG) for each in [name] * 2), *quick[100:]]
    for count in (2, 3, 4):
        order = spread_names(names, count)
        assert sorted(order) == list(range(len(names)))
        found = [names[k] for k in order]
        size = len(found) // count
        parts = [found[k * size : (k + 1) * size] for k in range(count)]
        has_page = [part[0] in pages for part in parts]
        assert has_page == [k < (count + 1) // 2 for k in range(count)]
        assert all(
            part[0] in LONG for part, is_page in zip(parts, has_page, strict=True) if not is_page
        )
        assert all(part[-1] in quick for part in parts)
        for name in (*pages, *LONG):
            assert found.index(name) + 1 == len(found) - 1 - found[::-1].index(name)


def test_files_that_take_long_are_there() -> None:
    assert [name for name in LONG if not (ROOT / name).is_file()] == []


def test_what_is_long_alone_is_ordered_too() -> None:
    assert spread_names([LONG[0], LONG[0], LONG[1]], 2) == [0, 1, 2]
    assert spread_names([], 4) == []
