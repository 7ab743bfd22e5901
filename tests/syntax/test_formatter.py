"""The formatter: expected layouts, and laws for every program.

Programs come from the generator of `oracle`; `laid_out_anew` gives their tokens a second, wilder
layout with comments, empty lines and empty instructions wherever the language allows them.
"""

from __future__ import annotations

import random

import pytest

from tests.oracle.interpreter import PAPER_KIT
from tests.oracle.interpreter import Kit as OracleKit
from tests.oracle.programs import WIDE_KIT, break_text, program
from tests.support.checking_work import count_calls
from tiniscript import Compilation, compile_text
from tiniscript.base import kit
from tiniscript.base.source import Source
from tiniscript.base.words import ALIASES
from tiniscript.diagnostics import codes
from tiniscript.syntax.formatter import format_source
from tiniscript.syntax.lexer import END, NEWLINE, scan
from tiniscript.syntax.parser import parse

CHUNK_COUNT = 16
PROGRAMS_PER_CHUNK = 150


def formatted(text: str) -> str:
    return format_source(Source(text))


def has_mistakes(text: str) -> bool:
    return any(diagnostic.is_mistake for diagnostic in parse(Source(text)).diagnostics)


# --- Layouts by hand --------------------------------------------------------------------------

OBSTACLES = """\
SI|LOOP(FOREVER);
  F(1, 80);
  DISTANCE;
  IF(DISTANCE < 10);
    STOP;
    R(1, 60);
  ENDIF;
END_LOOP;
"""

LAYOUTS: dict[str, tuple[str, str]] = {
    "the obstacle program with no layout": (
        "si|\nloop (forever)\nf(1,80)\ndistance\nif(distance<10)\nstop\nr(1,60)\nend_if\nendloop",
        OBSTACLES,
    ),
    "one line with ends and spaces to spare": (
        "\n\n si | ;; loop ( 3 ) ;; f( 2,50 ) ; endloop ; ; //square\n\n",
        "SI|LOOP(3);F(2, 50);END_LOOP  // square\n",
    ),
    "PING with comments around it": (
        "//a\nPING|check_connection //b\n//c",
        "// a\nPING|CHECK_CONNECTION  // b\n// c\n",
    ),
    "nothing": ("", ""),
    "SETUP alone": ("\n sb | ;\n\n", "SB|\n"),
    "operators": (
        "X=1+2*-3/(4-.5)%7\nY=X>=1 and not(X<>2)or(true)=false\nX=-X\nX=- - 5--.5",
        "X = 1 + 2 * -3 / (4 - 0.5) % 7;\n"
        "Y = X >= 1 AND NOT (X <> 2) OR (TRUE) = FALSE;\n"
        "X = -X;\n"
        "X = --5 - -0.5;\n",
    ),
    "minus after words, commas and brackets": (
        "m(-50,-(x))\nx=max(-1,-abs(-x))\nif(not-x<3 and-x>1);endif",
        "M(-50, -(X));\nX = MAX(-1, -ABS(-X));\nIF(NOT -X < 3 AND -X > 1);\nENDIF;\n",
    ),
    "numbers stay as written": ("SHOW(007.500+.5)", "SHOW(007.500 + 0.5)\n"),
    "dashes of a phone": ("X=5\u20133\u2212\u20141 // a\u2013b", "X = 5 - 3 - -1  // a\u2013b\n"),
    "DEF, calls and every end in its spelling": (
        "SI|DEF dance\nloop(2)\nwhile(true)\nif(true)\nbreak\n"
        "end_if\nendwhile\nendloop\nenddef\n\ndance",
        "SI|DEF DANCE;\n"
        "  LOOP(2);\n"
        "    WHILE(TRUE);\n"
        "      IF(TRUE);\n"
        "        BREAK;\n"
        "      ENDIF;\n"
        "    END_WHILE;\n"
        "  END_LOOP;\n"
        "END_DEF;\n"
        "\n"
        "DANCE;\n",
    ),
    "a line with only an empty instruction is no empty line": ("S\n;\nS", "S;\nS;\n"),
    "empty lines and comments": (
        "S\n\n// a\n\n\n// b\nLOOP(3)\n\n// c\n\nS\n\n// d\n\nEND_LOOP\n\n// e\n\n",
        "S;\n\n// a\n\n// b\nLOOP(3);\n  // c\n\n  S;\n\n// d\nEND_LOOP;\n\n// e\n",
    ),
    "a comment between SETUP and the one instruction": (
        "SI|\n//a\nF(1,80)",
        "SI|\n// a\nF(1, 80);\n",
    ),
    "comments above and below one line": (
        "//a\nSI|LOOP(3);F(2,50);END_LOOP //b\n\n//c",
        "// a\nSI|LOOP(3);F(2, 50);END_LOOP  // b\n\n// c\n",
    ),
    "comments everywhere": (
        "//0\n//1\nSI|LOOP(3);//2\n//3\nF(1, //4\n//5\n80)//6\n;//7\n"
        "IF(TRUE);S;S //8\n//9\nELSE//10\nW(1)\n  //11\nENDIF//12\nEND_LOOP//13\n//14",
        "// 0\n"
        "// 1\n"
        "SI|LOOP(3);  // 2\n"
        "  // 3\n"
        "  F(1, 80);  // 4 // 5 // 6\n"
        "  // 7\n"
        "  IF(TRUE);\n"
        "    S;\n"
        "    S;  // 8\n"
        "  // 9\n"
        "  ELSE;  // 10\n"
        "    W(1);\n"
        "  // 11\n"
        "  ENDIF;  // 12\n"
        "END_LOOP;  // 13\n"
        "// 14\n",
    ),
    "spaces of comments": (
        "//a  \n//  b\t\n//\tc\n//\n///// d /////\n// e //\n//¿?",
        "// a\n//  b\n//\tc\n//\n///// d /////\n// e //\n// ¿?\n",
    ),
    "lines end in LF": (
        "SI|F(1,80)\r\n\r\nS // a\r//b\r\nS",
        "SI|F(1, 80);\n\nS;  // a\n// b\nS;\n",
    ),
    "a long line is not wrapped": ("SHOW(" + "1+" * 200 + "1)", "SHOW(" + "1 + " * 200 + "1)\n"),
}


@pytest.mark.parametrize(("text", "layout"), LAYOUTS.values(), ids=LAYOUTS.keys())
def test_the_layout_is_as_expected(text: str, layout: str) -> None:
    """Check that the layout is the expected one, and that formatting it again changes nothing."""
    assert not has_mistakes(text)
    assert formatted(text) == layout
    check(text)


# --- Laws for every program ----------------------------------------------------------------------


def compiler_kit(oracle_kit: OracleKit) -> kit.Kit:
    """Return the compiler's form of the kit."""

    def devices(of_kind: str) -> tuple[kit.Device, ...]:
        return tuple(
            kit.Device(d.name, kit.YES_NO if d.is_yes_no else kit.NUMBER, "", d.low, d.high)
            for d in getattr(oracle_kit, of_kind)
        )

    return kit.Kit(devices("sensors"), devices("actuators"))


def code_of(text: str) -> list[tuple[str, str]]:
    """The tokens, with one spelling for each sign and one `;` between instructions."""
    code: list[tuple[str, str]] = []
    brackets = 0
    for token in scan(text).tokens:
        brackets += (token.kind == "(") - (token.kind == ")")
        if token.kind in (NEWLINE, ";", END):
            if not brackets and code and code[-1][0] not in (";", "|"):
                code.append((";", ";"))
            continue
        shown_text = ALIASES.get(token.text, token.text)
        code.append((token.kind, "0" + shown_text if shown_text.startswith(".") else shown_text))
    return code


def comments_of(text: str) -> str:
    """The comments with one space at least after their `//`, all in one."""
    comments = [comment.text.rstrip() for comment in scan(text).comments]
    return " ".join(
        comment if comment[2:3] in ("", "/") or comment[2].isspace() else f"// {comment[2:]}"
        for comment in comments
    )


def check(text: str) -> str:
    """Return the layout of a text with a correct shape, without the parts that need a kit."""
    layout = formatted(text)
    assert formatted(layout) == layout
    assert not has_mistakes(layout)
    assert code_of(layout) == code_of(text)
    assert comments_of(layout) == comments_of(text)
    assert "\r" not in layout and "\n\n\n" not in layout
    assert not layout or (layout[0] != "\n" and layout[-1] == "\n" and layout[-2] != "\n")
    assert all(line == line.rstrip() for line in layout.split("\n"))
    return layout


def check_compiled(text: str, compiler_kit_: kit.Kit) -> None:
    """Assert that a right program and its layout compile to the same."""
    compilation_before, then = (
        compile_text(text, compiler_kit_),
        compile_text(check(text), compiler_kit_),
    )
    assert compilation_before.is_right and then.is_right
    assert compilation_before.image and then.image == compilation_before.image
    assert len(then.locations) == len(compilation_before.locations)
    assert codes_of(then) == codes_of(compilation_before)


def codes_of(compilation: Compilation) -> list[codes.Code]:
    """Return the codes; those of a note may disappear, because notes are joined."""
    of_notes = (codes.IN_A_NOTE, codes.EMPTY_BLOCK)  # a note alone keeps a block from being empty
    return [
        diagnostic.code for diagnostic in compilation.diagnostics if diagnostic.code not in of_notes
    ]


def with_other_layout(rng: random.Random, text: str) -> str:
    """Return the same tokens with other spaces, lines, comments and empty instructions."""
    newline = rng.choice(("\n", "\n", "\r\n", "\r"))
    calm = rng.choice((0.0, 0.5, 0.9))  # probability of ordinary layout

    def is_odd(chance: float) -> bool:
        return rng.random() >= calm and rng.random() < chance

    def line_end() -> str:
        comment = rng.choice(("//", "// a", "//b  ", "//\tc", "///", " // d // d", "//)", "//;X="))
        return (" " + comment if is_odd(0.3) else rng.choice(("", "", " "))) + newline

    out: list[str] = [line_end() for _ in range(3) if is_odd(0.3)]
    brackets, text_before = 0, ""
    for kind, written_text in code_of(text):
        if kind == ";":
            line_ends = [rng.choice((";", line_end(), line_end()))]
            line_ends += [
                rng.choice((";", " ", line_end(), line_end())) for _ in range(4) if is_odd(0.4)
            ]
            out += line_ends
        else:
            if (text_before[-1:].isalnum() or text_before[-1:] == "_") and written_text[
                0
            ].isalnum():
                out.append(" ")
            out.append(
                rng.choice("-\u2013\u2014\u2212") if written_text == "-" else written_text.lower()
            )
            brackets += (kind == "(") - (kind == ")")
            if brackets and is_odd(0.1):
                out += [line_end() for _ in range(rng.randint(1, 3))]
            elif is_odd(0.3):
                out.append(rng.choice((" ", "  ", "\t", "\u00a0")))
            if kind == "|":
                out += [rng.choice((";", line_end())) for _ in range(3) if is_odd(0.3)]
        text_before = written_text
    return "".join(out)


@pytest.mark.sampled("chunk")
@pytest.mark.parametrize("chunk", range(CHUNK_COUNT))
def test_every_program_stays_the_same_program(chunk: int) -> None:
    """Same image, same comments; as written by the generator and in a wilder layout."""
    rng = random.Random(f"formatter {chunk}")
    for _ in range(PROGRAMS_PER_CHUNK):
        oracle_kit = rng.choice((PAPER_KIT, WIDE_KIT))
        text = program(rng, oracle_kit).removeprefix("\ufeff")
        program_kit = compiler_kit(oracle_kit)
        check_compiled(text, program_kit)
        if "check_connection" not in text.lower():
            check_compiled(with_other_layout(rng, text), program_kit)


def test_a_single_line_stays_single_and_several_stay_several() -> None:
    """However much stands on it. Several lines have one instruction on each."""
    rng = random.Random("lines")
    counts = {True: 0, False: 0}
    for _ in range(500):
        text = program(rng, WIDE_KIT).removeprefix("\ufeff").strip()
        instructions = code_of(text).count((";", ";"))
        is_one_line = "\n" not in text
        if instructions < 2 or (not is_one_line and ";" in text):
            continue
        counts[is_one_line] += 1
        lines = [line.strip() for line in formatted(text).split("\n")]
        code_lines = [line for line in lines if line not in ("", "SI|", "SB|") and line[:2] != "//"]
        assert len(code_lines) == (1 if is_one_line else instructions)
    assert min(counts.values()) > 50


def test_texts_with_other_mistakes_are_also_formatted() -> None:
    """If the shape is right, names, kinds and ranges may be wrong; the formatter never raises."""
    rng = random.Random("broken")
    checked_count = 0
    for _ in range(1000):
        text = break_text(rng, program(rng, WIDE_KIT))
        formatted(text)
        if not has_mistakes(text):
            check(text)
            checked_count += 1
    assert checked_count > 60


@pytest.mark.parametrize(
    "unit",
    ["F(1,80);", "F(1,80)\n", "//\n", "\n", ";", "X=1+2-3//a\nS\n\n", "IF(TRUE)\nENDIF\n"],
)
def test_work_grows_with_the_text_and_no_faster(unit: str) -> None:
    """Four times the text takes about four times as many calls, not sixteen."""

    def calls(size: int) -> int:
        source = Source(unit * (size // len(unit)))
        return count_calls(lambda: format_source(source))

    assert calls(40_000) < 5 * calls(10_000)


@pytest.mark.sampled("inner", keep=2)
@pytest.mark.parametrize("inner", ["(", "-", "NOT ", "ABS(", "1+(", "//a\n"])
def test_deep_nesting_exhausts_nothing(inner: str) -> None:
    """An instruction may hold as much as it likes."""
    count = 20_000
    text = "SHOW(" + inner * count + "1" + ")" * (inner.count("(") * count) + ")"
    assert code_of(formatted(text)) == code_of(text)
    assert formatted(formatted(text)) == formatted(text)
