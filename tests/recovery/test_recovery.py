"""Recovery: its rows, and right programs."""

from __future__ import annotations

import random
import re
from functools import partial
from itertools import count

import pytest

from tests.oracle import programs as written
from tests.oracle.words import PAPER_KIT
from tests.oracle.words import Kit as OracleKit
from tests.pupils.corpus import entries
from tests.support.damaged_programs import programs
from tests.support.rows import each_row
from tiniscript import robots
from tiniscript.base import languages
from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Span
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import CODES, Code
from tiniscript.lessons import catalogue
from tiniscript.library.compiling import analyze, check_text
from tiniscript.recovery import lines, rewrites, rows, slips
from tiniscript.recovery.explanation import explain_candidate
from tiniscript.recovery.meanings import Lexeme, Names, lexemes
from tiniscript.recovery.search import Candidate, Recovery
from tiniscript.syntax.outline import Failure

KITS = [robots.load(name).kit for name in ("tinibot", "grabber", "liner")]
KIT = robots.load(robots.DEFAULT).kit
_F, _MOVE = "F(time, power)", "F(2, 80)"
ROWS: list[rewrites.SignRow | rewrites.TokenRow] = [*rewrites.sign_rows(), *rewrites.token_rows()]


@each_row("row", [pytest.param(row, id=row.example[0][:50]) for row in ROWS])
def test_the_example_of_a_row_is_read_as_stated(row: rewrites.TokenRow | rewrites.SignRow) -> None:
    wrong_text, right_text = row.example
    readings = []
    for kit in KITS:
        candidate = Recovery(wrong_text, kit, partial(mistakes, kit)).best_candidate()
        readings.append(candidate and candidate.text)
        if readings[-1] == right_text:
            return
    assert readings == [right_text]


def find_meant_program(text: str) -> Candidate | None:
    return Recovery(text, KIT, partial(mistakes, KIT)).best_candidate()


def mistakes(kit: Kit, text: str) -> list[Code]:
    return [
        diagnostic.code for diagnostic in analyze(text, kit).diagnostics if diagnostic.is_mistake
    ]


def right_programs() -> list[str]:
    folders = catalogue.folders()
    answers = [answer.program for folder in folders for answer in catalogue.answers(folder)[0]]
    programs_right = [entry.program for entry in entries() if not entry.messages]
    return [
        program
        for program in (*programs(), *answers, *programs_right)
        if not mistakes(KIT, program)
    ]


def test_a_right_program_is_read_without_a_rewrite() -> None:
    for program in right_programs():
        assert find_meant_program(program) is None, program
        tokens = [lexemes(line.partition("//")[0]) for line in program.split("\n")]
        names = Names(tokens, KIT)
        if all(map(is_whole, tokens)) and program.isascii():
            for line in tokens:
                assert not isinstance(lines.parse_line(line, names), Failure), program


def is_whole(line: list[Lexeme]) -> bool:
    """Return whether all brackets of a line close on it, and no `=` compares after another."""
    signs = [lexeme.text for lexeme in line]
    return signs.count("(") == signs.count(")") and signs[3:4] != ["="]


@pytest.mark.parametrize(
    ("wrong_text", "code", "values", "edit"),
    [
        ("F(2 80)", "TS017", {"usage": _F, "fix": _MOVE}, Edit(Span(3, 3), ",")),
        ("S\navanzar(2, 80)", "TS102",
         {"found": "avanzar", "right": "F", "usage": _F, "takes": "", "fix": _MOVE},
         Edit(Span(2, 9), "F")),
        ("SI|robot.forward(2, 80)", "TS102",
         {"found": "robot.forward", "right": "F", "usage": _F, "takes": "", "fix": _MOVE},
         Edit(Span(3, 16), "F")),
        ("F(2, 80 %)", "TS049", {"found": "80 %", "right": _MOVE, "fix": _MOVE},
         Edit(Span(7, 9), "")),
    ],
)  # fmt: skip
def test_an_explanation_has_a_slip_and_its_edits(
    wrong_text: str, code: str, values: dict[str, str], edit: Edit
) -> None:
    candidate = find_meant_program(wrong_text)
    assert candidate is not None
    (explanation,) = explain_candidate(wrong_text, candidate)
    assert (explanation.code, explanation.edits) == (CODES[code], [edit])
    assert explanation.values_as(explanation.code) == {**values, "whole": "", "ends": ""}


# Values removed by `dedupe`.
DEDUPED_GAPS = {codes.BAD_NAME: {"found"}, codes.NAME_WITH_SPACE: {"found"}}
# the checker, or the block: some of it
CODES_SAID_ELSEWHERE = (codes.ARGUMENT_COUNT, codes.WRONG_END)
BLOCK_GAPS = {"whole", "line", "lines", "times", "ends"}


@each_row("code", [pytest.param(code, id=code.number) for code in slips.NAMES_OF_CODE])
def test_a_message_contains_only_facts_of_its_slip(code: Code) -> None:
    """Each value of a slip is used by a text, and every used value exists."""
    names = {*slips.NAMES_OF_CODE[code]}
    gap_sets = []
    for part in ("message", "try"):
        text = languages.find_text("messages", f"{code.number}/{part}", "en")
        for k in count(2):
            if text is None:
                break
            gap_sets.append({*re.findall(r"\{@?(\w+)\}", text)})
            text = languages.find_text("messages", f"{code.number}/{part}/{k}", "en")
    assert names <= set().union(*gap_sets) | DEDUPED_GAPS.get(code, set())
    own_gaps = {"found", "right", "before", "word", "usage", "fix", "letter", "takes"}
    whole = [names & own_gaps for names in gap_sets if names <= own_gaps | BLOCK_GAPS]
    assert code in CODES_SAID_ELSEWHERE or set().union(*whole) <= names


def test_a_line_is_searched_only_once_for_the_same_names() -> None:
    line = lexemes("F(2 80)")
    first_names, same_names, other_names = (
        Names([lexemes(text)], KIT) for text in ("", "", "X = 1")
    )
    readings = lines.read(line, first_names)
    assert lines.read(line, same_names) is readings
    assert lines.read(line, other_names) is not readings


def test_the_parser_reports_where_it_cannot_continue() -> None:
    names = Names([], KIT)
    assert lines.parse_line(lexemes("S; F(2 80)"), names) == Failure(2, 5)
    assert lines.parse_line(lexemes("F(2, 80) B(1, 50)"), names) == Failure(0, 6)
    assert lines.parse_line(lexemes("F(2)"), names) == Failure(0, 4)
    assert lines.parse_line(lexemes("FAST"), names) == Failure(0, 0)


@pytest.mark.parametrize(
    "wrong_text",
    [
        "X == 6",
        "X = 3\nX = X = 5",
        "F(2,80) 5 seg",
        "F(2, 8 S)",
        "F 80 2",  # 80 s, or a power
        "F -1 80",
        "move(50, 50)",
        "F.1.5",
        "M(1,-50,80,0)",
        "LOOP(4) {",
        "S\n,,",
    ],
)
def test_ambiguous_repairs_are_only_suggested(wrong_text: str) -> None:
    candidate = find_meant_program(wrong_text)
    assert candidate is None or not candidate.is_applied


@pytest.mark.parametrize(
    ("wrong_text", "right_text"),
    [
        ("MIENTRAS(DISTANCE > 20)\nS\nEND_LOOP", "WHILE(DISTANCE > 20)\nS\nEND_WHILE"),
        ("LOOP(4){F(1, 80); S", "LOOP(4);F(1, 80);S;END_LOOP"),
        ("W(doscientos cinco segundos)", "W(205)"),
        ("DEF F2\nS\nEND_DEF\nF2 3", "DEF F2\nS\nEND_DEF\nLOOP(3);F2;END_LOOP"),
        ("stopMotors()", "S"),
        ("SHOW -2.5", "SHOW(-2.5)"),
        ("SI|V = 50, F(2, V)", "SI|V = 50; F(2, V)"),
        ("SHOW(ABSS(-3))", "SHOW(ABS(-3))"),  # no other word has brackets in a value
    ],
)
def test_repairs_with_one_reading_are_applied(wrong_text: str, right_text: str | None) -> None:
    candidate = find_meant_program(wrong_text)
    assert (candidate.text if candidate and candidate.is_applied else None) == right_text


@pytest.mark.parametrize(
    ("wrong_text", "kit", "right_text"),
    [
        ("PINZA(90)", "grabber", "GRIPPER(90)"),
        ("ABRIR PINZA", "grabber", "GRIPPER(180)"),
        ("LED(PRENDIDO)", "liner", "LED(TRUE)"),
        ("LED(ON)", "grabber", "LED(TRUE)"),
        ("SHOW(BATERIA)", "liner", "SHOW(BATTERY)"),
        ("IF(TEMPERATURA > 30)\nS\nENDIF", "grabber", "IF(TEMPERATURE > 30)\nS\nENDIF"),
        ("PINZA(90)", "tinibot", None),
        ("SHOW(BATERIA)", "grabber", None),
    ],
)
def test_words_of_a_kit_are_recognized_only_on_its_robots(
    wrong_text: str, kit: str, right_text: str | None
) -> None:
    own_kit = robots.load(kit).kit
    candidate = Recovery(wrong_text, own_kit, partial(mistakes, own_kit)).best_candidate()
    assert (candidate.text if candidate and candidate.is_applied else None) == right_text


@pytest.mark.parametrize(
    ("wrong_text", "question_text"),
    [
        ("X == 6", "X = 6"),
        ("F(1, 50)\nREPITE", None),  # no empty block is offered
    ],
)
def test_possible_meanings_become_a_question(wrong_text: str, question_text: str | None) -> None:
    candidate = find_meant_program(wrong_text)
    assert (candidate and candidate.text, bool(candidate and candidate.is_applied)) == (
        question_text,
        False,
    )


@pytest.mark.parametrize(("treatment", "is_made"), [("applied", False), ("offered", True)])
def test_automatically_applied_rows_lose_no_number(
    monkeypatch: pytest.MonkeyPatch, treatment: str, is_made: bool
) -> None:
    monkeypatch.setattr(rows, "TOKENS", f"^ S @num $ | S | 1 | TS044 | {treatment} | S 5 => S")
    (row,) = rewrites.token_rows.__wrapped__()
    line = rewrites.EncodedLine(lexemes("S 5"), Names([], KIT))
    (match,) = line.matches(row.pattern)
    assert (line.apply_row(row, match) is not None) is is_made


@pytest.mark.parametrize("kit", [PAPER_KIT, written.WIDE_KIT], ids=["paper", "wide"])
def test_a_program_for_another_robot_gets_messages(kit: OracleKit) -> None:
    """Its words are unknown wherever they are, at the begin of a line within brackets too."""
    for seed in range(40, 60):
        text = written.program(random.Random(seed), kit)
        assert any(check_text(text, kit).diagnostics for kit in KITS), seed
