"""Source locations: each instruction says from which piece of the text it comes."""

from __future__ import annotations

import itertools
import json
import os
import random

import pytest

from tests.oracle import programs
from tests.oracle.interpreter import PAPER_KIT
from tests.oracle.task_programs import task_program
from tests.support.kits import KITS
from tests.support.source_maps import compile_right_text, make_source_map
from tiniscript import compile_text, robots
from tiniscript.bytecode.disassembly import rows
from tiniscript.bytecode.image import GO, TASKS, checksum
from tiniscript.cli import images
from tiniscript.cli.inputs import Input
from tiniscript.library import source_map
from tiniscript.library.source_map import MapLocation
from tiniscript.semantics.ir import Show


def locate_instructions(text: str) -> list[tuple[str, str]]:
    """Return each instruction with the piece of the text that it comes from."""
    compilation = compile_right_text(text)
    pairs = []
    for row in rows(compilation.code):
        place = [
            source_location
            for source_location in compilation.locations
            if source_location.offset <= row.offset
        ][-1]
        pairs.append((row.text.split()[0], compilation.source[place.span]))
    return pairs


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("F(1, 80); S", [("MOVE8_F", "F(1, 80)"), ("STOP", "S")]),
        # A reading belongs to its instruction, and a lone sensor to itself.
        ("SHOW(1 + DISTANCE)", [("READ_2", "SHOW(1 + DISTANCE)"),
                                ("PUSH_NUM_1", "SHOW(1 + DISTANCE)"),
                                ("PUSH_SENSOR_2", "SHOW(1 + DISTANCE)"),
                                ("ADD", "SHOW(1 + DISTANCE)"), ("SHOW", "SHOW(1 + DISTANCE)")]),
        ("DISTANCE; SHOW(1 - DISTANCE)",
         [("READ_2", "DISTANCE"), ("PUSH_NUM_1", "SHOW(1 - DISTANCE)"),
          ("PUSH_SENSOR_2", "SHOW(1 - DISTANCE)"), ("SUB", "SHOW(1 - DISTANCE)"),
          ("SHOW", "SHOW(1 - DISTANCE)")]),
        ("DISTANCE; SHOW(DISTANCE)", [("PUSH_READ_2", "DISTANCE"), ("SHOW", "SHOW(DISTANCE)")]),
        ("DISTANCE; IF(DISTANCE < 9); S; ENDIF",
         [("PUSH_READ_2", "DISTANCE"), ("IF8_LT", "IF(DISTANCE < 9)"), ("STOP", "S")]),
        # the check of a move is part of the move
        ("F(1, 80) UNTIL(DISTANCE < 9)",
         [(name, "F(1, 80) UNTIL(DISTANCE < 9)")
          for name in ("PUSH_NUM_1", "PUSH_NUM_80", "WATCH_F", "PUSH_READ_2", "UNTIL8_LT")]),
        # A condition belongs to its arm, and the jump after an arm to its end.
        ("X = 1\nIF(X = 1); S; ELSEIF(X = 2); W(1); ENDIF",
         [("PUSH_NUM_1", "X = 1"), ("SET_VAR_0", "X = 1"), ("IF_VAR8_EQ", "IF(X = 1)"),
          ("STOP", "S"), ("ELSE", "S"),
          ("IF_VAR8_EQ", "ELSEIF(X = 2)"), ("WAIT8", "W(1)")]),
        # The start of a loop or a DEF, and the jump back, belong to all of it.
        ("LOOP(2); S; END_LOOP", [("LOOP8", "LOOP(2); S; END_LOOP"), ("STOP", "S"),
            ("NEXT", "LOOP(2); S; END_LOOP")]),
        ("X = 1; WHILE(X < 2); S; END_WHILE",
         [("PUSH_NUM_1", "X = 1"), ("SET_VAR_0", "X = 1"), ("WHILE", "WHILE(X < 2); S; END_WHILE"),
          ("IF_VAR8_LT", "WHILE(X < 2); S; END_WHILE"),
          ("STOP", "S"), ("AGAIN", "WHILE(X < 2); S; END_WHILE")]),
        ("LOOP(FOREVER); BREAK; END_LOOP", [("FOREVER", "LOOP(FOREVER); BREAK; END_LOOP"),
                                            ("BREAK", "BREAK"),
                                            ("AGAIN", "LOOP(FOREVER); BREAK; END_LOOP")]),
        ("DEF A; S; END_DEF; A", [("DEF", "DEF A; S; END_DEF"), ("STOP", "S"),
                                  ("RETURN", "S"), ("CALL", "A")]),
    ],
)  # fmt: skip
def test_an_instruction_is_mapped_to_its_source(text: str, expected: list[tuple[str, str]]) -> None:
    assert locate_instructions(text) == expected


def test_instructions_in_far_form_keep_their_source() -> None:
    """A comparing branch that does not reach is four instructions of one place."""
    row = "S;" * 256
    pairs = locate_instructions(f"X = 1; IF(X = 5); {row} ENDIF; W(1)")
    assert pairs[:6] == [("PUSH_NUM_1", "X = 1"), ("SET_VAR_0", "X = 1"),
                         *[(name, "IF(X = 5)") for name in
                           ("PUSH_VAR_0", "PUSH_NUM_5", "EQ", "IF_FAR")]]  # fmt: skip
    assert pairs[6:-1] == [("STOP", "S")] * 256
    assert pairs[-1] == ("WAIT8", "W(1)")


def test_constant_folded_code_has_no_place() -> None:
    assert locate_instructions("IF(1 > 2); S; ENDIF; W(1)") == [("WAIT8", "W(1)")]


def test_places_are_in_order_and_the_first_is_at_the_beginning() -> None:
    text = "DEF A; S; END_DEF; LOOP(3); A; IF(DISTANCE < 5); BREAK; ENDIF; END_LOOP"
    compilation = compile_right_text(text)
    offsets = [place.offset for place in compilation.locations]
    assert offsets == sorted(set(offsets)) and offsets[0] == 0
    assert set(offsets) <= {row.offset for row in rows(compilation.code)}
    spans = [place.span for place in compilation.locations]
    assert all(first != second for first, second in itertools.pairwise(spans))


# -- the map of a program -------------------------------------------------------------------------


def test_an_offset_inside_an_instruction_maps_to_the_instruction() -> None:
    mapping = make_source_map(compile_right_text("S; F(1, 80); W(1)"))
    columns = [None if (place := mapping.location_at(offset)) is None else place.column
               for offset in range(-1, 7)]  # fmt: skip
    assert columns == [None, 1, 4, 4, 4, 14, 14, 14]
    assert (mapping.line(0), mapping.line(1), mapping.line(2)) == ("", "S; F(1, 80); W(1)", "")


def test_a_map_is_written_like_json() -> None:
    text = "".join(map(chr, range(0x180))) + "\u2028\ud800 🤖"
    places = (MapLocation(0, 1, 1, 1, 2), MapLocation(10, 2, 3, 40, 5))
    for mapping in (
        source_map.SourceMap(text, (text, "", "S"), places, (text, "N"), (True, False)),
        source_map.SourceMap("", (), ()),
    ):
        keys = {"locations": "places", "yes_no_flags": "yes_no"}
        values = {keys.get(name, name): value for name, value in mapping._asdict().items()}
        fields = {"version": source_map.VERSION, **values}
        assert source_map.as_json(mapping) == json.dumps(fields, ensure_ascii=False)


@pytest.mark.parametrize(
    "changed_fields",
    [
        {"version": source_map.VERSION + 1},
        {"version": None},
        {"places": 5},
        {"places": [[0, 1, 1]]},
        {"places": [[0, 1, 1, 1, "x"]]},
        {"lines": None},
        {"variables": 5},
        {"yes_no": 5},
    ],
)
def test_an_invalid_map_is_refused(changed_fields: dict[str, object]) -> None:
    fields = json.loads(source_map.as_json(make_source_map(compile_right_text("S"))))
    assert source_map.from_json(json.dumps(fields)).variables == ()
    earlier = {name: fields[name] for name in ("version", "name", "lines", "places")}
    assert source_map.from_json(json.dumps(earlier)) == source_map.from_json(json.dumps(fields))
    with pytest.raises(ValueError):
        source_map.from_json(json.dumps({**fields, **changed_fields}))
    del fields["places"]
    with pytest.raises(ValueError, match="no map"):
        source_map.from_json(json.dumps(fields))


def test_a_variables_type_is_known_at_its_show() -> None:
    """In random programs, and in the copies of a DEF's values that tasks have."""
    kinds = set()
    for seed in range(40):
        oracle_kit, kit = KITS[seed % len(KITS)]
        text = programs.program(random.Random(seed), oracle_kit)
        compilation = compile_text(text, kit)
        for name, is_yes_no in zip(compilation.variables, compilation.yes_no_flags, strict=True):
            show_program = compile_text(f"{text}\nSHOW({name})", kit)
            if show_program.is_right:  # otherwise it is a value of a DEF
                assert show_program.program
                last_statement = show_program.program.body[-1]
                assert isinstance(last_statement, Show) and last_statement.is_yes_no == is_yes_no, (
                    seed,
                    name,
                )
                kinds.add(is_yes_no)
    assert kinds == {True, False}
    compilation = compile_right_text(
        "DEF GO(FAST, SPEED); IF(FAST); F(1, SPEED); ENDIF; END_DEF\n"
        "TASK; GO(TRUE, 50); END_TASK; TASK; GO(DISTANCE < 9, 60); END_TASK; GO(FALSE, 70)"
    )
    assert compilation.variables == ("FAST", "SPEED") * 3
    assert compilation.yes_no_flags == (True, False) * 3


def test_a_map_is_found_by_the_checksum_that_a_robot_reports() -> None:
    """Whatever a program needs, and whether it was compiled now or read from an image."""
    robot, needs_seen = robots.load("tinibot"), set[int]()
    for seed in range(40):
        rng, has_ways = random.Random(seed), seed % 2 == 0
        program_text = task_program(rng, has_ways)[0]
        if seed % 4 < 2:
            program_text = programs.program(rng, PAPER_KIT, has_ways)
        compilation = compile_text(program_text, robot.kit)
        assert compilation.is_right
        program_input = Input("-", program_text.encode(), None)
        ready_program = images.ready_program(program_input, robot, "en")
        assert ready_program is not None
        images.keep_map(ready_program)
        assert source_map.recall(checksum(compilation.image)) == ready_program.program_map
        image_input = Input("-", compilation.image, None)
        assert images.ready_program(image_input, robot, "en") == ready_program
        needs_seen.add(ready_program.image.needs)
    assert needs_seen == {0, TASKS, GO, TASKS | GO}


def test_the_oldest_maps_make_room(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(source_map, "MAX_MAPS", 3)
    programs = [compile_right_text(f"W({k})") for k in range(1, 6)]
    for k, compilation in enumerate(programs):
        source_map.remember(compilation.image, make_source_map(compilation))
        path = source_map._path(checksum(compilation.image))
        os.utime(path, (k + 1, k + 1))
    is_recalled = [source_map.recall(checksum(program.image)) is not None for program in programs]
    assert is_recalled == [False, False, True, True, True]
