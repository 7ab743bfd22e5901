"""Beginnings of programs in words, with names of signs, or with text above `SI|`."""

from __future__ import annotations

from itertools import product

import pytest

from tests.pupils.corpus import check
from tiniscript import compile
from tiniscript.base.source import Source, apply_edits
from tiniscript.diagnostics.fixing import edits_of, repair_program
from tiniscript.diagnostics.rendering import message

HEADS = ("SI", "Sí", "si", "SB")
ORDERS = {
    "forward two seconds at eighty percent then turn right one second at fifty percent then stop":
        "F(2, 80);R(1, 50);STOP",
    "adelante 3 segundos al 40 por ciento": "F(3, 40)",
    "avance 3 segundos a 40 por cento e depois pare": "F(3, 40);S",
    "turn left 2 seconds at 30 percent": "L(2, 30)",
}  # fmt: skip
# Names of signs: open, close, comma, separator, bar, and of letters.
SPOKEN = (
    ("abre paréntesis", "cierra paréntesis", "coma", "punto y coma", "barra", "efe", "erre"),
    ("paréntesis", "paréntesis", "coma", "punto y coma", "barra", "efe", "ere"),
    ("paréntesis", "", "coma", "punto y coma", "barra", "efe", "erre"),
    ("abre parêntese", "fecha parêntese", "vírgula", "ponto e vírgula", "barra", "efe", "erre"),
    ("open bracket", "close bracket", "comma", "semicolon", "bar", "ef", "ar"),
    ("bracket", "bracket", "comma", "semicolon", "bar", "ef", "are"),
)
VALUES = (("2, 60", ["F", "B"]), ("1, 440", ["BEEP"]), ("-30, 40", ["M"]), ("2", ["W"]))


@pytest.mark.parametrize("head", HEADS)
@pytest.mark.parametrize("words", ORDERS)
def test_si_before_verbal_commands_is_not_a_condition(head: str, words: str) -> None:
    for text in (f"{head} {words}", f"{head}, {words}", f"{head} {words}\nS", f"{head} {words};"):
        diagnostic = check(text)[0]
        start_word = "SB" if head == "SB" else "SI"
        assert diagnostic.code.number == "TS036", text
        assert diagnostic.values["fix"] == f"{start_word}|{ORDERS[words]}", text


@pytest.mark.parametrize(
    "words", ["hay una pared, para", "DISTANCE < 10 avanza", "see a wall stop"]
)
def test_si_before_a_question_is_a_condition(words: str) -> None:
    assert not any(diagnostic.code.number == "TS036" for diagnostic in check(f"si {words}"))


@pytest.mark.parametrize("signs", SPOKEN)
def test_named_symbols_are_replaced_by_the_symbols(signs: tuple[str, ...]) -> None:
    opened_text, closed_text, comma, separator, bar, forward, right_symbol = signs
    call = f"{forward} {opened_text} 2 {comma} 80 {closed_text}".strip()
    turn = f"{right_symbol} {opened_text} 1 {comma} 50 {closed_text}".strip()
    meant = {f"{call} {separator} {turn}": "F(2, 80);R(1, 50)", call: "F(2, 80)"}
    for (words, line), place in product(
        meant.items(), ("{}", "W(1)\n{}\nS", "IF(DISTANCE < 9)\n{}\nENDIF")
    ):
        text = place.format(words)
        diagnostic = check(text)[0]
        assert (diagnostic.code.number, diagnostic.values.get("fix")) == ("TS010", line), text
        assert diagnostic.values["spoken"], text
    text = f"Si {bar} {call}"
    assert check(text)[0].values["fix"] == "SI|F(2, 80)"
    assert repair_program(text, check).text == text  # a letter's name may be a word


@pytest.mark.parametrize("kind", ["int ", "float ", "let ", "const int ", "variable "])
@pytest.mark.parametrize("head", ["SI|", "SB|", "si |"])
def test_a_typed_variable_before_si_is_moved_after_it(kind: str, head: str) -> None:
    for end, note, declaration in product((";", ""), ("", " // fast"), ("", "int t = 2\n")):
        wrong_text = f"{kind}vel = 70{end}{note}\n{declaration}{head}F(2, vel)"
        start_word = "".join(head.split()).upper()
        right_text = f"{start_word}vel = 70{end}{note}\n{declaration.replace('int ', '')}F(2, vel)"
        assert (
            apply_edits(
                wrong_text,
                [name for diagnostic in check(wrong_text) for name in edits_of(diagnostic) or []],
            )
            == right_text
        )
        assert repair_program(wrong_text, check).text == right_text


@pytest.mark.parametrize(
    "place", ["SI|{}", "SB|{}", "W(1);{}", "{};S", "IF(DISTANCE < 9);{};ENDIF"]
)
@pytest.mark.parametrize(("values", "words"), VALUES)
def test_values_without_a_word_get_a_matching_word(
    values: str, words: list[str], place: str
) -> None:
    text = place.format(f"({values})")
    (diagnostic,) = [diagnostic for diagnostic in check(text) if diagnostic.is_mistake]
    offered_texts = [diagnostic.values["one"], diagnostic.values.get("another")]
    assert [offered_text for offered_text in offered_texts if offered_text] == [
        f"{word}({values})" for word in words
    ], text
    for language in ("en", "es", "pt"):
        full_message = message(diagnostic, Source(text), language)
        assert f"({values})" in full_message.message and ("SB|" in full_message.message) is (
            place == "SB|{}"
        )


STARTS = ("start", "begin,", "empieza y", "comienza,", "comece e", "Start and")
BUTTONS = (
    "when the button is pressed", "wait for the button press, then", "press the button and",
    "al apretar el botón", "cuando se pulse el botón", "espera el botón pulsado y luego",
    "quando o botão for apertado", "ao apertar o botão",
)  # fmt: skip


@pytest.mark.parametrize("words", ORDERS)
@pytest.mark.parametrize("head", STARTS + BUTTONS)
def test_words_determine_how_a_program_starts(head: str, words: str) -> None:
    start_word = "SB" if head in BUTTONS else "SI"
    for text in (f"{head} {words}", f"{head} {words};", f"{head} {words}\nS"):
        (diagnostic,) = check(text)
        assert diagnostic.code.number == "TS036", text
        assert diagnostic.values["fix"] == f"{start_word}|{ORDERS[words]}", text
        assert repair_program(text, check).text == text


@pytest.mark.parametrize("head", BUTTONS[:2])
def test_a_made_up_value_is_called_an_example(head: str) -> None:
    (diagnostic,) = check(f"{head} go forward")
    full_message = message(diagnostic, Source(""), "en")
    assert "SB|F(2, 80)" in full_message.fix
    assert full_message.fix.endswith("examples: 2 s, 80 %")


@pytest.mark.parametrize(
    "text",
    (
        "si se aprieta el botón, para",
        "if the button is pressed, stop",
        *(
            f"{act} until the button is pressed, then turn left"
            for act in ("drive", "stop", "repeat")
        ),
        *(f"{act} hasta pulsar el botón y luego retrocede" for act in ("avanza", "gira", "repite")),
    ),
)
def test_a_button_that_stops_starts_nothing(text: str) -> None:
    assert all("button" not in diagnostic.values for diagnostic in check(text))


FRAMES = ("void setup()", "setup()", "void  SETUP ( )", "def inicio()")
BODIES = ("F(1, 80);", "SI|F(1, 80);", "SI\nF(1, 80)", "F(1, 80); // }", "SB", "", "W(1)\nS")


@pytest.mark.parametrize("frame", FRAMES)
@pytest.mark.parametrize("body", BODIES)
def test_the_setup_of_a_sketch_begins_the_program(body: str, frame: str) -> None:
    start_word, bare = ("SB", body[2:]) if body[:2] == "SB" else ("SI", body.removeprefix("SI"))
    right_text = f"{start_word}|{bare.lstrip('|').lstrip()}"
    rests = {"": "", "void loop() {\n  R(1, 60);\n}": "LOOP(FOREVER);\n  R(1, 60);\nEND_LOOP"}
    gaps = ("\n",) if "//" in body or not body else (" ", "\n  ")
    for (rest, loop), gap, brace in product(rests.items(), gaps, (" {", "\n{")):
        text = f"{frame}{brace}{gap}{body}{gap.rstrip(' ') or ' '}}}\n{rest}"
        repaired_text = apply_edits(text, edits_of(check(text)[0]) or [])
        repaired_text = repair_program(repaired_text, check).text
        assert compile(repaired_text).code == compile(f"{right_text}\n{loop}").code, text
        assert repaired_text.startswith(f"{start_word}|"), text


@pytest.mark.parametrize("marks", ["\u201c\u201d", '""', "''", "\u00ab\u00bb"])
@pytest.mark.parametrize("line", ["SB|F(2, 80)", "SI|F(2, 80);S", "F(2, 80)"])
def test_a_quoted_line_is_suggested_with_its_start(line: str, marks: str) -> None:
    wrong_text = f"{marks[0]}{line}{marks[1]}"
    (diagnostic,) = check(wrong_text)
    assert diagnostic.values["fix"] == line, wrong_text
    assert repair_program(wrong_text, check).text.replace(" ", "") == line.replace(" ", "")
