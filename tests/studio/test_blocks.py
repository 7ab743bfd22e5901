"""Blocks and text: each keeps all content of the other. In Python alone, as the page asks it."""

from __future__ import annotations

import json
import random
import re

import pytest

from tests.oracle import programs as oracle_programs
from tests.pupils import corpus
from tests.studio.programs import Program, programs
from tests.support.block_agreement import check_blocks, comment_words, touched_form
from tests.support.block_words import program_with_word
from tests.support.kits import KITS
from tests.support.new_word import HORN
from tests.support.rows import each_row
from tiniscript import compile_text, robots
from tiniscript.base.kit import Kit
from tiniscript.base.source import Source
from tiniscript.base.words import ALIASES, UNIT_OF, WORDS
from tiniscript.studio.block_form import (
    LEFT_OUT,
    Block,
    Form,
    data_of,
    first_blocks,
    from_data,
    in_order,
    size_of,
)
from tiniscript.studio.block_kinds import KINDS
from tiniscript.studio.block_printing import format_blocks
from tiniscript.studio.block_reading import read_blocks
from tiniscript.studio.worker import MAX_BLOCKS, answer
from tiniscript.syntax.formatter import format_source

TINIBOT = robots.load("tinibot").kit


def kinds(text: str, kit: Kit = TINIBOT) -> list[str]:
    return [block.kind for block in in_order(read_blocks(text, kit).body)]


def words(text: str) -> list[str]:
    """Return the words and numbers of a text, comments included, in any order."""
    letters = "".join(
        letter if letter.isalnum() or letter == "_" else " " for letter in text.upper()
    )
    return sorted(ALIASES.get(word, word) for word in letters.split())


@each_row("program", programs())
def test_every_program_survives_conversion_to_blocks(program: Program) -> None:
    """Programs of the paper, of all documents and cases, and the examples."""
    kit = robots.load(program.robot).kit
    if compile_text(program.text, kit).is_right:
        check_blocks(program.text, kit)
    else:
        format_blocks(read_blocks(program.text, kit))


@pytest.mark.sampled("first_seed")
@pytest.mark.parametrize("first_seed", range(0, 1000, 250))
def test_random_programs_survive_conversion_to_blocks(first_seed: int) -> None:
    for seed in range(first_seed, first_seed + 250):
        oracle_kit, kit = KITS[seed % len(KITS)]
        check_blocks(oracle_programs.program(random.Random(seed), oracle_kit), kit)


@pytest.mark.parametrize("first_seed", range(0, 500, 250))
def test_no_part_of_a_broken_text_is_lost(first_seed: int) -> None:
    for seed in range(first_seed, first_seed + 250):
        rng = random.Random(seed)
        oracle_kit, kit = KITS[seed % len(KITS)]
        text = oracle_programs.break_text(rng, oracle_programs.program(rng, oracle_kit))
        if re.search(r"[~.]|\b0\d", text):  # checksums are made anew, and numbers are shorter
            format_blocks(read_blocks(text, kit))
        else:
            assert words(format_blocks(read_blocks(text, kit)).text) == words(text), text


def test_pupils_programs_become_blocks_and_text() -> None:
    for text in sorted({entry.program for entry in corpus.entries()}):
        form = read_blocks(text, TINIBOT)
        round_tripped = format_blocks(read_blocks(format_blocks(form).text, TINIBOT)).text
        assert format_blocks(read_blocks(round_tripped, TINIBOT)).text == round_tripped, text
        assert not text.strip() or form.body or form.start or ";" in text, text


# -- every word has a block ------------------------------------------------------------------------


@each_row("word", [name for name, word in WORDS.items() if word.role.name != "later"])
def test_every_word_of_the_language_is_in_blocks(word: str) -> None:
    text = program_with_word(word)
    check_blocks(text, TINIBOT)
    printed_text = format_blocks(read_blocks(text, TINIBOT)).text
    assert ALIASES.get(word, word) in words(text.upper()) or word == "CHECK_CONNECTION"
    assert sorted(words(printed_text)) == sorted(words(text))


@pytest.mark.parametrize("word", ["F", "B", "L", "R", "W"])
def test_moves_and_waits_can_have_an_until(word: str) -> None:
    arguments = "FOREVER" if word == "W" else "FOREVER, 80"
    check_blocks(f"{word}({arguments}) UNTIL(DISTANCE < 10)", TINIBOT)


@pytest.mark.parametrize(("word", "unit"), UNIT_OF.items())
def test_a_way_is_a_move_with_another_unit(word: str, unit: str) -> None:
    move = f"{word}(X * 2 {unit}, 60)"
    for until_text, kind in (("", "move"), (" UNTIL(DISTANCE < 10)", "move_until")):
        check_blocks(f"X = 20;{move}{until_text}", TINIBOT)
        (block,) = read_blocks(move + until_text, TINIBOT).body
        assert (block.kind, block.word) == (kind, f"{word} {unit}")
    assert kinds(move.replace(unit, {"CM": "DEG", "DEG": "CM"}[unit])) == ["grey"]


def test_every_word_of_a_kit_is_in_blocks() -> None:
    for name in robots.names():
        kit = robots.load(name).kit
        for sensor in kit.sensors:
            assert kinds(sensor.name, kit) == ["read"]
            check_blocks(f"{sensor.name};SHOW({sensor.name})", kit)
        for actuator in kit.actuators:
            assert kinds(f"{actuator.name}(1)", kit) == ["set"]
            check_blocks(f"{actuator.name}({'TRUE' if actuator.is_yes_no else 1})", kit)


def test_the_shape_of_each_kind_matches_the_reader(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(WORDS, HORN.text, HORN)
    omitted_roles = ("later", "setup", "alias")
    text = ";".join(
        program_with_word(word) for word in WORDS if WORDS[word].role.name not in omitted_roles
    )
    text += ";F(1, 2) UNTIL(TRUE)"
    text += ";X = 1;HOP;LED(TRUE);DISTANCE;LOOP(FOREVER);END_LOOP\n// note\nF("
    blocks = in_order(read_blocks(text, TINIBOT).body)
    assert {block.kind for block in blocks} == {
        kind.name for kind in KINDS.values() if not kind.gives
    }
    for block in blocks:
        if block.kind != "if":
            kind = KINDS[block.kind]
            assert (len(block.values), len(block.bodies)) == (len(kind.values), kind.bodies), block


# -- by hand ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "printed_text"),
    [
        ("", ""),
        ("si|", "SI|\n"),
        ("SI|F(2,80)", "SI|F(2, 80)\n"),
        ("SB|F(1,60);W(0.5);B(1,60) // go", "SB|F(1, 60);W(0.5);B(1, 60)  // go\n"),
        ("SI|F(1, 60)\nS", "SI|F(1, 60);\nS;\n"),
        ("//first\nSI|\nF(1, 60)//go\n\nS", "// first\nSI|F(1, 60);  // go\n\nS;\n"),
        ("SI| // start\nS;STOP", "SI|  // start\nS;\nSTOP;\n"),
        ("PING|check_connection //?", "PING|CHECK_CONNECTION  // ?\n"),
        ("F((2), (800))", "F((2), (800))\n"),
        ("X = -(5) - -5 - (3 - 2) * (A = (P < C))",
         "X = -(5) - -5 - (3 - 2) * (A = (P < C))\n"),
        ("X = (NOT A) AND NOT (P OR Q) OR NOT D = E", "X = NOT A AND NOT (P OR Q) OR NOT D = E\n"),
        ("X = -(-A) % -MIN(1, -(P + C))", "X = -(-A) % -MIN(1, -(P + C))\n"),
        ("IF(TRUE) // a\nS\nELSE // b\nENDIF // c\nS // d",
         "IF(TRUE);  // a\n  S;\nELSE;\n// b\nENDIF;\n// c\nS;  // d\n"),
        ("/////\n// /x\n//\n//  two", "/////\n// /x\n//\n//  two\n"),
        ("F(1, // fast\n 80)", "F(1, 80)  // fast\n"),
    ],
)  # fmt: skip
def test_blocks_are_printed_as_text(text: str, printed_text: str) -> None:
    assert format_blocks(touched_form(read_blocks(text, TINIBOT))).text == printed_text


def test_changing_a_block_changes_only_its_line() -> None:
    text = (
        "IF(1.50 > (X));  // a\n  F((1), 080);\nELSEIF((X) > 2);  // b\n  S;\n"
        "ELSE;  // c\nENDIF;  // d\n"
    )
    data = json.loads(json.dumps(data_of(read_blocks(text, TINIBOT))))
    block = data["body"][0]
    block["bodies"][0][0]["values"][0] = [["NUMBER", "3"]]
    block["bodies"][0][0]["said"] = []
    block["said"] = [block["said"][0], "", block["said"][2]]
    assert format_blocks(from_data(data)).text == (
        "IF(1.50 > (X));  // a\n  F(3, 80);\nELSEIF(X > 2);  // b\n  S;\n"
        "ELSE;  // c\nENDIF;  // d\n"
    )


def test_a_line_that_does_not_parse_is_a_grey_block() -> None:
    text = "SI|F(2, 80)\nF(1; 80)\n  ¿qué? // hm\nIF(DISTANCE < 10)\nS\nENDIF\n"
    form = read_blocks(text, TINIBOT)
    assert [(block.kind, block.word) for block in form.body if block.kind == "grey"] == [
        ("grey", "F(1; 80)"), ("grey", "¿qué? // hm")
    ]  # fmt: skip
    assert [block.kind for block in form.body] == ["move", "grey", "grey", "if"]
    printed_form = format_blocks(form)
    assert printed_form.text == (
        "SI|F(2, 80);\nF(1; 80)\n¿qué? // hm\nIF(DISTANCE < 10);\n  S;\nENDIF;\n"
    )
    assert printed_form.places[:3] == ((1, 4, 1, 12), (2, 1, 2, 9), (3, 1, 3, 12))
    assert format_blocks(read_blocks(printed_form.text, TINIBOT)).text == printed_form.text


@pytest.mark.parametrize("text", ["F(1)", "S(2)", "S UNTIL(TRUE)", "HOP(1, 2)", "F(1, 2, 3)"])
def test_unsupported_instructions_become_grey_blocks(text: str) -> None:
    assert kinds(text) == ["grey"]
    printed_text = format_blocks(read_blocks(f"{text} // no", TINIBOT)).text
    assert printed_text.split() == [*text.split(), "//", "no"]


def test_a_header_that_is_never_closed_keeps_its_lines() -> None:
    text = "LOOP(3)\n  F(1, 80)\nIF(TRUE)\n  S\n"
    assert kinds(text) == ["grey", "move", "grey", "stop"]
    assert kinds("ENDIF\nS") == ["grey", "stop"]


def test_loose_blocks_are_kept() -> None:
    text = (
        "SI|S\n\n/// F(1, 80);  // later\n/// IF(DISTANCE < 10);\n///   S;\n/// ENDIF;\n///\n"
        "/// = DISTANCE < 10\n///\n/// X = 5\n"
    )
    form = read_blocks(text, TINIBOT)
    assert [block.kind for block in form.body] == ["stop"]
    assert [[block.kind for block in stack.body] for stack in form.loose] == [
        ["move", "if"], [], ["assign"]
    ]  # fmt: skip
    assert form.loose[1].value == (("SENSOR", "DISTANCE"), ("NUMBER", "10"), ("LT", ""))
    assert format_blocks(form).text == text.replace("SI|S\n", "SI|S\n")
    assert format_source(Source(text)) == text


@pytest.mark.parametrize("text", ["/// 5 of them", "/// SI|S", "///\n/// F(1", "/// S\nF(1, 80)"])
def test_other_comments_with_three_signs_stay_comments(text: str) -> None:
    form = read_blocks(text, TINIBOT)
    assert form.loose == () and form.body[0].kind == "comment"
    assert comment_words(format_blocks(form).text) == comment_words(text)


def test_text_typed_into_a_field_stays_in_its_line() -> None:
    body = (Block("comment", "a\r\nS"), Block("assign", "X\n", ((("NUMBER", "1"),),)),
            Block("stop", "S", note="b\nF(1, 80)\0"), Block("grey", "  \n "),
            Block("grey", "a\nb"))  # fmt: skip
    assert format_blocks(Form("SI", "", False, body, ())).text == (
        "// a S\nSI|X  = 1;\nS;  // b F(1, 80)\n//\na b\n"
    )


def test_empty_places_are_reported_by_the_compiler() -> None:
    nothing = (("NOTHING", ""),)
    body = (Block("if", "", (nothing,), ((),)), Block("move", "F", (nothing, nothing)))
    text = format_blocks(Form("SI", "", False, body, ())).text
    assert text == "SI|IF();\nENDIF;\nF(, );\n"
    assert compile_text(text, TINIBOT).diagnostics


def test_the_page_requests_blocks_and_text() -> None:
    text = "SI|GRIPPER(90); // ¡abre!\nHOP"
    form = json.loads(answer('{"do": "blocks", "robot": "grabber"}', text.encode()))
    assert form["body"][0]["note"] == "¡abre!"
    printed = json.loads(answer(json.dumps({"do": "text", "form": form})))
    assert printed["text"] == "SI|GRIPPER(90);  // ¡abre!\nHOP;\n"
    assert printed["places"] == [[1, 4, 1, 15], [2, 1, 2, 4]]


def test_a_very_long_program_stays_text() -> None:
    request_text = '{"do": "blocks", "robot": "tinibot"}'
    short_program, long_program = (b"S;" * count for count in (MAX_BLOCKS, MAX_BLOCKS + 1))
    assert len(json.loads(answer(request_text, short_program))["body"]) == MAX_BLOCKS
    assert json.loads(answer(request_text, long_program)) == {"size": MAX_BLOCKS + 1}
    deep_program = f"X = {'(' * 5000}1{')' * 5000}{' + 1' * MAX_BLOCKS}"
    assert json.loads(answer(request_text, deep_program.encode())) == {"size": 2 * MAX_BLOCKS + 2}
    assert size_of(read_blocks("/// F(1, 2)", TINIBOT)) == 3


@each_row("program", programs())
def test_the_beginning_of_a_program_shows_its_first_blocks(program: Program) -> None:
    form = read_blocks(program.text, robots.load(program.robot).kit)
    all_blocks = in_order(form.body)
    for max_blocks in (1, 2, 7, 40, size_of(form)):
        beginning = first_blocks(form, max_blocks)
        assert size_of(beginning) <= max_blocks
        first = in_order(beginning.body)
        if size_of(form) <= max_blocks:
            assert beginning == form
            continue
        assert first.pop() == LEFT_OUT and beginning.loose == ()
        assert [(block.kind, block.word) for block in first] == [
            (block.kind, block.word) for block in all_blocks[: len(first)]
        ]
        assert [len(block.bodies) for block in first] == [
            len(block.bodies) for block in all_blocks[: len(first)]
        ]


def test_the_page_requests_the_beginning() -> None:
    text = ";".join(["SHOW(1)"] * (2 * MAX_BLOCKS))
    request = {"do": "blocks", "robot": "tinibot"}
    assert set(json.loads(answer(json.dumps(request), text.encode()))) == {"size"}
    form = json.loads(answer(json.dumps({**request, "first": 150}), text.encode()))
    assert form["size"] == 149 and form["body"][-1]["word"] == "…"
