"""Finds the SHOW of a text that has shown a value, and its name."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import pytest

from tests.support.source_maps import compile_right_text, make_source_map
from tiniscript.base import files
from tiniscript.bytecode.disassembly import rows
from tiniscript.bytecode.image import checksum
from tiniscript.library import source_map
from tiniscript.library.shows import Show, ShowFinder, Shows
from tiniscript.library.source_map import MapLocation, SourceMap
from tiniscript.link.outcomes import ShownEvent


def list_shows(text: str) -> list[Show | None]:
    """Return the SHOW of each instruction that shows, in the order of the code."""
    compilation = compile_right_text(text)
    shows = Shows(make_source_map(compilation))
    return [
        shows.show_at(row.offset) for row in rows(compilation.code) if row.text.startswith("SHOW")
    ]


def names(text: str) -> list[str]:
    return ["" if show is None else show.text for show in list_shows(text)]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("SHOW(DISTANCE)", "DISTANCE"),
        ("show( light_r-light_l )", "LIGHT_R - LIGHT_L"),
        ("X = 1; SHOW(-X)", "-X"),
        ("SHOW((DISTANCE + 1) * 2)", "(DISTANCE + 1) * 2"),
        ("SHOW(NOT(DISTANCE < 10) AND TRUE)", "NOT (DISTANCE < 10) AND TRUE"),
        ("SHOW(MAX(LIGHT_L,.5))", "MAX(LIGHT_L, 0.5)"),
        ("SHOW(// how far\n  DISTANCE // or near\n  + 1)", "DISTANCE + 1"),
        ("// café\r\nSHOW(TIME)", "TIME"),
        # Expressions whose name would only repeat the value.
        ("SHOW(12.5)", ""), ("SHOW(-3)", ""), ("SHOW(.5)", ""), ("SHOW(TRUE)", ""),
        ("SHOW(5-3)", "5 - 3"), ("SHOW(((2)))", "((2))"), ("SHOW(NOT TRUE)", "NOT TRUE"),
    ],
)  # fmt: skip
def test_a_value_is_named_by_the_expression_of_its_show(text: str, expected: str) -> None:
    assert names(text) == [expected]


def test_each_show_has_its_own_instruction_between_others() -> None:
    text = "SI|SHOW(1); SHOW(DISTANCE); X = 2; SHOW(7); IF(X > 1); SHOW(X * 2); ENDIF; SHOW(TIME)"
    assert names(text) == ["", "DISTANCE", "", "X * 2", "TIME"]


def test_shows_of_one_expression_are_told_apart_by_their_lines() -> None:
    found_shows = list_shows(
        "SHOW(TIME)\nSHOW( time ); SHOW(LIGHT_L); SHOW(LIGHT_L)\nSHOW(LIGHT_R)"
    )
    assert found_shows == [
        Show("TIME", 1, 1, shares_text=True),
        Show("TIME", 2, 1, shares_text=True),
        Show("LIGHT_L", 2, 15, shares_text=True, shares_line=True),
        Show("LIGHT_L", 2, 30, shares_text=True, shares_line=True),
        Show("LIGHT_R", 3, 1),
    ]


def test_the_copies_of_a_def_are_one_show() -> None:
    tasks = "TASK; TELL(2); END_TASK\nTASK; TELL(3); END_TASK"
    text = f"DEF TELL(X); SHOW(X); END_DEF\nTELL(1)\n{tasks}"
    assert list_shows(text) == [Show("X", 1, 14)] * 3


def test_a_map_of_another_text_names_nothing() -> None:
    places = tuple(MapLocation(k, *span) for k, span in enumerate(
        [(9, 1, 9, 5), (1, 1, 0, 0), (1, 1, 1, 5), (1, 6, 1, 9), (1, 1, 2, 3), (1, 90, 1, 99)]
    ))  # fmt: skip
    shows = Shows(SourceMap("", ("SHOW(X; é", "SHOW"), places))
    assert [shows.show_at(k) for k in range(len(places) + 1)] == [None] * (len(places) + 1)
    assert Shows(SourceMap("", (), ())).show_at(0) is None


# -- of which program -----------------------------------------------------------------------------


def event(program: int, offset: int, run_number: int = 1) -> ShownEvent:
    return ShownEvent(1000, 0, run_number, program, offset)


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "cache_folder", lambda: tmp_path)


@pytest.mark.usefixtures("cache")
def test_a_program_is_found_by_checksum_only() -> None:
    first, second = compile_right_text("SHOW(DISTANCE)"), compile_right_text("SHOW(LIGHT_R)")
    offset = rows(first.code)[-1].offset
    finder = ShowFinder({checksum(first.image): make_source_map(first)})
    assert finder.show_of(event(checksum(first.image), offset)) == Show("DISTANCE", 1, 1)
    second_event = event(checksum(second.image), offset, run_number=2)
    assert finder.show_of(second_event) is None, "nobody here has it"
    source_map.remember(second.image, make_source_map(second))
    assert finder.show_of(second_event) == Show("LIGHT_R", 1, 1), "it came into the cache later"
    assert finder.show_of(event(checksum(first.image), offset, run_number=3)) == Show(
        "DISTANCE", 1, 1
    )
    assert finder.show_of(event(checksum(first.image), -1)) is None
    assert ShowFinder().show_of(ShownEvent(1000, 0)) is None, "of an older robot"


@pytest.mark.usefixtures("cache")
def test_equal_code_is_named_by_its_own_text() -> None:
    first, second = (
        compile_right_text("NEAR = TIME; SHOW(NEAR)"),
        compile_right_text("FAR = TIME; SHOW(FAR)"),
    )
    assert first.image == second.image
    program, offset = checksum(first.image), rows(first.code)[-1].offset
    maps = {program: make_source_map(first)}
    finder = ShowFinder(maps)
    names = [finder.show_of(event(program, offset))]
    maps[program] = make_source_map(second)
    names += [
        finder.show_of(event(program, offset)),
        finder.show_of(event(program, offset, run_number=2)),
    ]
    assert [show and show.text for show in names] == ["NEAR", "NEAR", "FAR"], "until its next run"


@pytest.mark.usefixtures("cache")
def test_the_name_of_a_value_does_not_depend_on_earlier_values() -> None:
    """This also holds after a reset of the robot, which restarts its run numbers."""
    programs = [compile_right_text(f"SHOW({name})") for name in ("DISTANCE", "LIGHT_R", "TIME")]
    offset = rows(programs[0].code)[-1].offset
    map_by_checksum = {
        checksum(program.image): make_source_map(program) for program in programs[:2]
    }
    events = [
        event(checksum(program.image), offset, run_number)
        for program in programs
        for run_number in (1, 2)
    ]
    for earlier_events in product(events, repeat=2):
        for shown_last in events:
            finder = ShowFinder(map_by_checksum)
            for shown_before in earlier_events:
                finder.show_of(shown_before)
            assert finder.show_of(shown_last) == ShowFinder(map_by_checksum).show_of(shown_last), (
                earlier_events,
                shown_last,
            )


@pytest.mark.usefixtures("cache")
def test_a_run_keeps_the_text_that_it_began_with() -> None:
    """Its first value may be late, and its number may be that of another run."""
    texts = [
        compile_right_text(f"{name} = TIME; SHOW({name})") for name in ("NEAR", "FAR", "THIRD")
    ]
    program, offset = checksum(texts[0].image), rows(texts[0].code)[-1].offset
    maps: dict[int, SourceMap] = {}
    finder = ShowFinder(maps)
    for run_number, compilation in enumerate(texts):
        maps[program] = make_source_map(compilation)
        finder.begin(run_number % 2, program)
    names = [finder.show_of(event(program, offset, run_number)) for run_number in (1, 0, 1)]
    assert [show and show.text for show in names] == ["FAR", "THIRD", "FAR"]
    finder.begin(1, program + 1)
    assert finder.show_of(event(program + 1, offset, 1)) is None
