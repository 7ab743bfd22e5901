"""The text of a sketch: the comments of each line, names, notes, limits."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.machines.sketch_board import build_sketch
from tests.sketch.agreement import sketch as sketch_for
from tests.support.casefile import ROOT, example_robot, sketch_examples
from tests.support.texts import LANGUAGES
from tests.support.texts import catalogue_texts as all_said
from tiniscript import compile_text, robots
from tiniscript.cli.paths import is_foreign
from tiniscript.codegen.sketch.names import (
    IDENTIFIERS,
    LOCALS,
    RESERVED,
    Names,
    counter,
    translated_name,
)


def sketch(text: str, language: str = "en", robot: str = "tinibot") -> str:
    return sketch_for(text, robots.load(robot), language)


def part(text: str, header: str) -> list[str]:
    """Return the body of a function without its comments."""
    body = text.partition(f"\n{header} {{")[2].partition("\n}\n")[0]
    return [re.sub(r"  +//.*", "", row) for row in body.splitlines()[1:]]


def test_each_instruction_has_its_tiniscript_as_a_comment() -> None:
    text = sketch("SI|f( 2 , 80 );\nIF(LIGHT_R > 100); S; ELSE; W(1); ENDIF")
    rows = text.splitlines()
    for code, comment in (
        ("  forward(2, 80);", "f( 2 , 80 )"),
        ("  if (lightR > 100) {", "IF(LIGHT_R > 100)"),
        ("    stopMotors();", "S"),
        ("  } else {", "ELSE"),
        ("    wait(1);", "W(1)"),
    ):
        assert f"{code:<38}  // {comment}" in rows


def test_a_simple_program_has_simple_numbers() -> None:
    text = sketch("SI|LOOP(3);F(0.5, 80);IF(DISTANCE < 10.5);BEEP(0.1, 440);ENDIF;END_LOOP")
    assert "struct " not in text and "Serial." not in text and "float seconds" in text
    assert "for (int i = 0; i < 3; i++) {" in text and "if (distance < 10.5) {" in text


def test_a_large_whole_number_is_itself() -> None:
    """Its thousandths have more digits than a float, which a fraction would be written as."""
    assert "  x = 1000003;" in part(sketch("X = 1000003;SHOW(X)"), "void setup()")


def test_a_variable_that_a_def_copies_from_below_is_a_yes_no() -> None:
    text = sketch("Q = TRUE; DEF LOOK; SEEN = Q; END_DEF; LOOK; SHOW(SEEN)")
    assert "bool q = false;" in text and "bool seen = false;" in text


def test_unused_helpers_are_not_written() -> None:
    text = sketch("SI|F(2, 80)")
    for word in ("tone(int", "analogRead", "beep(", "backward(", "TRIGGER", "Number", "moveLasts"):
        assert word not in text


def test_a_final_loop_becomes_the_loop_function() -> None:
    text = sketch("SI|W(1);LOOP(FOREVER);F(1, 80);END_LOOP")
    assert part(text, "void loop()") == ["  forward(1, 80);"]
    broken_sketch = sketch("SI|LOOP(FOREVER);F(1, 80);BREAK;END_LOOP")
    assert part(broken_sketch, "void loop()") == [] and "  while (true) {" in part(
        broken_sketch, "void setup()"
    )


def test_a_while_takes_its_reading_in_its_condition() -> None:
    text = sketch(
        "SI|WHILE(DISTANCE > 10);W(0.1);END_WHILE;WHILE(DISTANCE > 10 AND TRUE);END_WHILE"
    )
    assert "  while (readDistance() > 10) {" in text
    assert "    if (!(distance > 10 && true)) break;" in text


def test_only_necessary_brackets_are_written() -> None:
    text = sketch(
        "X = 1;X = (X + 2) * 3 - (X - (4 - X));X = 7 / 2;X = --X;X = -(-5);"
        "Y = NOT (X = 1 OR X < 2);"
        "Y = (X < 1) = (X > 2);Y = X < 1 AND (Y OR X > 3) OR Y;X = 2000 * 20.5;"
        "X = X * (X / 3) % 7;X = X / (X * 3)"
    )
    for line in (
        "x = (x + 2) * 3 - (x - (4 - x));", "x = Number(7) / 2;", "x = - -x;", "x = -Number(-5);",
        "y = !(x == 1 || x < 2);", "y = (x < 1) == (x > 2);", "y = (x < 1 && (y || x > 3)) || y;",
        "x = Number(2000) * 20.5;", "x = x * (x / 3) % 7;", "x = x / (x * 3);",
    ):  # fmt: skip
        assert f"  {line}" in part(text, "void setup()"), line


def test_random_is_called_from_left_to_right() -> None:
    text = sketch("X = RANDOM(1, 6) - RANDOM(1, 3);M(RANDOM(1, 2), RANDOM(3, 4))")
    assert "x = (first1 = randomFrom(1, 6), first1 - randomFrom(1, 3));" in text
    assert "motors(limited(first2, -100, 100), limited(randomFrom(3, 4), -100, 100));" in text
    assert "first2 = randomFrom(1, 2);" in text and "Number first1, first2;" in text


def test_comments_keep_their_places() -> None:
    text = sketch(
        "// one\nSI|F(1, 50) // two\nIF(LIGHT_R > 1)\n// three\nS\nENDIF // four\n// five"
    )
    rows = [row.strip() for row in text.splitlines()]
    row_indices = [rows.index(f"// {word}") for word in ("one", "two", "three", "four", "five")]
    assert row_indices == sorted(row_indices)
    assert rows[row_indices[1] + 1].startswith("forward(1, 50);")
    assert rows[row_indices[2] + 1].startswith("stopMotors();")


@pytest.mark.parametrize("comment", ["ends in \\", "??/", "*/ /* */", "ñandú ¿qué? \t x", "\\"])
def test_a_comment_stays_a_comment(comment: str) -> None:
    text = sketch(f"SI|F(1, 50) // {comment}\nS // {comment}")
    assert part(text, "void setup()")[-1] == "  finish();"
    build_sketch(text, "uno")


@pytest.mark.parametrize("block", ["", "LOOP(2)\n"])
def test_a_long_comment_is_broken_where_the_line_ends(block: str) -> None:
    end = "\nEND_LOOP" if block else ""
    text = sketch(f"SI|{block}// " + "x" * 500 + f"\nS{end}")
    assert max(map(len, text.splitlines())) == 100
    assert sum(len(row) == 100 for row in text.splitlines()) >= 5


# -- names


def test_names_are_like_those_of_cpp() -> None:
    names = Names("en")
    own_names = (
        "MY_SPEED",
        "X",
        "OLD__D_",
        "OLD_D",
        "DELAY",
        "FORWARD",
        "I",
        "I2",
        "FIRST1",
        "NUMBER",
    )
    names_in_cpp = [
        "mySpeed",
        "x",
        "oldD",
        "myOldD",
        "myDelay",
        "myForward",
        "myI",
        "myI2",
        "myFirst1",
        "number",
    ]
    assert [names.name_of(word) for word in own_names] == names_in_cpp
    assert (
        Names("en").name_of("COUNTED") == "myCounted" and Names("es").name_of("VALOR") == "miValor"
    )
    assert (
        Names("es").name_of("INT") == "miInt"
        and Names("en").name_of("LIGHT_R", "read") == "readLightR"
    )


def test_no_helper_has_a_reserved_name() -> None:
    for language in LANGUAGES:
        names = {translated_name(identifier, language) for identifier in IDENTIFIERS}
        assert not RESERVED & names - {"read", "leer", "time", "value"}


@pytest.mark.sampled("first", keep=2)
@pytest.mark.parametrize("first", [0, 1, 2, 3, 4, 5])
def test_names_of_cpp_and_of_the_core_can_be_variables(first: int) -> None:
    """Each sixth reserved name, and what looks like a macro of the core."""
    words = sorted(word.upper() for word in RESERVED if word.isalpha())[first::6]
    kit = robots.load("tinibot").kit
    core_names = ("A0", "B1", "PI", "HIGH", "LOW", "PORTB", "ADC", "NULL", "SPEED", "FIRST1",
                  "INPUT")  # fmt: skip
    usable = [word for word in (*core_names, *words) if compile_text(f"{word} = 1", kit).is_right]
    for start in range(0, len(usable), 30):
        program = ";".join(f"{word} = 1" for word in usable[start : start + 30])
        build_sketch(sketch(f"{program};W({usable[start]})"), "uno")


def test_no_name_of_a_helper_is_in_the_other_language() -> None:
    """In Spanish no parameter is English, and combined helpers agree."""
    program = (
        "SI|X = RANDOM(1, 6) / 2 % 3;SHOW(ROUND(ABS(MIN(X, -X)), 1));SHOW(MAX(X, 1) > 2);M(X, X);"
        "BEEP(X, 440);GRIPPER(X);W(TIME) UNTIL(X > 3);F(FOREVER, 50) UNTIL(DISTANCE < 9)"
    )
    sketch_text = sketch(program, "es", "grabber")
    code = re.sub(r"//.*|\"[^\"]*\"", "", sketch_text)
    assert not set(re.findall(r"\w+", code)) & set(LOCALS)
    assert "segundos.milesimas == PARA_SIEMPRE.milesimas" in code
    notes = " ".join(re.findall(r"// (.*)", sketch_text))
    assert not set(re.findall(r"\w+", notes)) & {"low", "high", "first", "last"}
    local = {all_said("es", "sketch")[f"local/{key}"] for key in LOCALS}
    names = {translated_name(identifier, "es") for identifier in IDENTIFIERS}
    assert len(local) == len(LOCALS) and not (local | names) & RESERVED - {"leer"}
    assert local & names == {"valor"}


# -- its own comments


@pytest.mark.parametrize("language", ["en", "es"])
def test_the_first_lines_name_the_limits(language: str) -> None:
    def limits(text: str) -> set[str]:
        first = " ".join(
            row.lstrip("/ ") for row in sketch(text, language).split("#include")[0].splitlines()
        )
        return {
            key.removeprefix("said/")
            for key, text in all_said(language, "sketch").items()
            if key.startswith("said/limit_") and text.split("{")[0].strip() in first
        }

    always = {"limit_link", "limit_watch", "limit_time"}
    assert limits("SB|F(1, 50)") == always
    assert limits("SI|F(1, 50)") == always | {"limit_si"}
    assert limits("SB|SHOW(1)") == always | {"limit_show"}
    assert limits("SB|W(RANDOM(1, 2))") == always | {"limit_random", "limit_fault"}
    assert limits("PING|check_connection") == {"limit_ping"}


def test_texts_exist_in_both_languages() -> None:
    for language in LANGUAGES:
        texts = all_said(language, "sketch")
        names = [text for key, text in texts.items() if key.startswith("name/")]
        assert len(set(names)) == len(names) == len(IDENTIFIERS)
        for key, text in texts.items():
            is_name = key.partition("/")[0] in ("name", "local", "prefix")
            assert not is_name or re.fullmatch(r"[A-Za-z_]\w*", text, re.ASCII), key


@pytest.mark.parametrize("path", sketch_examples(), ids=lambda path: path.stem)
@pytest.mark.parametrize("language", ["en", "es"])
def test_no_line_is_too_long_and_no_gap_stays_open(
    path: Path, language: str, tmp_path: Path
) -> None:
    text = sketch(path.read_text(encoding="utf-8"), language, example_robot(path))
    assert "$" not in text
    assert max(map(len, text.splitlines())) <= 110
    sketch_file = tmp_path / "a.ino"
    sketch_file.write_text(text, encoding="utf-8")
    assert not is_foreign(sketch_file)


@pytest.mark.parametrize("language", ["en", "es"])
def test_the_sketch_on_the_page_is_what_tsc_writes(language: str) -> None:
    page = (ROOT / "docs" / language / "language.md").read_text(encoding="utf-8")
    text_before, _, text_after = page.partition("```cpp\n")
    program = text_before.rpartition("```tiniscript\n")[2].partition("```")[0]
    assert "\n" + text_after.partition("```")[0] in sketch(program, language)


def test_each_nested_loop_has_its_own_counter() -> None:
    assert [counter(depth) for depth in range(6)] == ["i", "j", "k", "i4", "i5", "i6"]
