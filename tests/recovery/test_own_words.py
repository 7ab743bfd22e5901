"""Messages show the pupil's own numbers and names, and never one sensor instead of another."""

from __future__ import annotations

import re
from itertools import product

import pytest

from tests.pupils.corpus import check
from tests.support.rows import each_row
from tiniscript.base.languages import languages, read_language_file
from tiniscript.base.source import Edit, Source, apply_edits
from tiniscript.base.spelling import Speller
from tiniscript.base.words import VERSION_OF_WORD, WORDS, lexicon
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.diagnostics.fixing import repair_program
from tiniscript.diagnostics.rendering import message
from tiniscript.syntax.operators import COMPARISONS, OPPOSITES

OWN = "37"  # a number that is in no example
CONDITIONS = (
    "distancia < {}", "distance < {} cm", "a distância < {}", "LUZ > {}", "SOM > {}",
    "TEMPERATURA > {}", "RANDOM(1, {0}) = {0}", "NO DISTANCE < {}", "DISTANCE es menor que {}",
)  # fmt: skip
HEADERS = (
    "{h} {c}\nS\n{e}", "{h}({c})\nS\n{e}", "{h} {c}:\n  forward\n{e}", "W(1);{h} {c};S;{e}",
    "siempre\n{h} {c}\ngira derecha\n{e}", "F(1, 60\n{h} {c}\nS",
)  # fmt: skip
COMPARED = re.compile(r"(?:[<>]=?|=)\s*(\d+)")


def words(meaning: str) -> list[str]:
    """Return the words of all lexicons with a meaning."""
    rows = (
        row
        for language in languages()
        for row in read_language_file(language, "lexicon.txt").split("\n")
    )
    parts = (row.partition("|") for row in rows if not row.startswith("#"))
    return [word for what, _, text in parts if what.strip() == meaning for word in text.split()]


def message_text(diagnostic: Diagnostic, text: str) -> str:
    parts = message(diagnostic, Source(text, ""), "en")
    return " ".join(map(str, parts))


@each_row("header", HEADERS)
@pytest.mark.parametrize("condition", CONDITIONS)
def test_a_condition_is_shown_with_the_written_number(header: str, condition: str) -> None:
    for head, end in (("si", "fin"), ("SE", "FIM"), ("while", "end"), ("MIENTRAS", "FIN MIENTRAS")):
        text = header.format(h=head, c=condition.format(OWN), e=end)
        for diagnostic in check(text):
            shown_text = message_text(diagnostic, text)
            others = {*COMPARED.findall(shown_text)} - {OWN, "1"}
            assert (
                not others or "as in" in shown_text or "with the number that you want" in shown_text
            ), shown_text


def test_a_word_after_a_number_lacks_no_comma() -> None:
    for unit, word in product(words("unit turns 1000"), ("R", "L", "F", "W")):
        text = f"{word}(3 {unit}, 60)" if word != "W" else f"W(3 {unit})"
        (diagnostic,) = check(text)
        assert diagnostic.code.number != "TS017", text
        assert repair_program(text, check).text == text
        is_turn = word in "LR"
        assert (diagnostic.values.get("fix") == f"{word}(1080 DEG, 60)") is is_turn, text


@pytest.mark.parametrize(
    ("wrong_text", "right_text"),
    [
        ("R(HALF TURN, 60)", "R(180 DEG, 60)"),
        ("SI|W(1); L(UNA VUELTA, 60)", "L(360 DEG, 60)"),
        ("R(MEIA VOLTA, 60)", "R(180 DEG, 60)"),
        ("R(un cuarto de vuelta, 60)", "R(90 DEG, 60)"),
        ("R(3/4 vuelta, 60)", "R(270 DEG, 60)"),
    ],
)
def test_a_fraction_of_a_turn_becomes_degrees(wrong_text: str, right_text: str) -> None:
    (diagnostic,) = check(wrong_text)
    assert diagnostic.values["fix"] == right_text
    assert repair_program(wrong_text, check).text == wrong_text


RENAMED = [
    word for word, its in WORDS.items()
    if word not in VERSION_OF_WORD and its.role.name != "setup" and not its.role.belongs_to_blocks
]  # fmt: skip


def rename_word(text: str) -> tuple[str, tuple[Edit, ...]]:
    """Return the name that replaces a word in a message, and the edits for it."""
    return next(
        (diagnostic.values["right"], diagnostic.repair.edits)
        for diagnostic in check(text)
        if diagnostic.code.number == "TS105" and diagnostic.repair
    )


OWN_BLOCKS = (
    "IF(DISTANCE < 9)\nS\nELSEIF(DISTANCE < 8)\nW(1)\nELSE\nB(1, 60)\nENDIF",
    "LOOP(2)\nS\nEND_LOOP", "WHILE(DISTANCE < 9)\nBREAK\nEND_WHILE", "TASK\nS\nEND_TASK",
)  # fmt: skip


@each_row("word", RENAMED)
def test_a_name_is_renamed_in_all_its_uses(word: str) -> None:
    """A DEF: its calls, and no move of its own; a variable: each use, and no instruction."""
    move = WORDS[word].example if WORDS[word].role.is_instruction else "S"
    text = f"DEF {word}\n{move}\nEND_DEF\n{word}\nF(1, 60)\n{word}"
    name, edits = rename_word(text)
    renamed_text = apply_edits(text, edits)
    assert renamed_text == f"DEF {name}\n{move}\nEND_DEF\n{name}\nF(1, 60)\n{name}"


@pytest.mark.parametrize("word", sorted(WORDS))
def test_no_word_becomes_the_name_of_a_def(word: str) -> None:
    """This holds whatever is before and after it; a block there stays as it is under the other
    name."""
    for blocks in OWN_BLOCKS:
        for text_before, text_after in ((blocks, "S"), ("S", blocks), (blocks, blocks)):
            text = f"{text_before}\nDEF {word}(A, K)\nF(A, K)\nEND_DEF\n{text_after}"
            mistakes = [diagnostic for diagnostic in check(text) if diagnostic.is_mistake]
            assert mistakes, text
            if WORDS[word].role.belongs_to_blocks:
                name, edits = rename_word(text)
                assert apply_edits(text, edits) == text.replace(f"DEF {word}", f"DEF {name}")


@each_row("word", [word for word in RENAMED if word != "TIME"])
def test_a_variable_is_renamed_in_its_uses(word: str) -> None:
    text = f"{word} = 2\nF({word}, 60)\nW(1 + {word})\nX = {word} + 1\nS\nF(X, 60)"
    renamed_text = apply_edits(text, rename_word(text)[1])
    assert renamed_text.split("\n")[4] == "S"
    assert not [diagnostic for diagnostic in check(renamed_text) if diagnostic.is_mistake]


@each_row("word", sorted({*words("unsensed")}))
def test_sensors_that_no_kit_has_are_not_suggested(word: str) -> None:
    for text in (f"IF({word} > {OWN});S;ENDIF", f"WHEN({word} = 1)\nS\nEND_WHEN"):
        (diagnostic,) = check(text)
        assert diagnostic.values.get("unsensed", "").upper() == word, text
        assert "DISTANCE" in diagnostic.values["sensors"]
        assert diagnostic.repair is None and not diagnostic.values.get("fix")


@pytest.mark.parametrize(
    ("wrong_text", "fix"),
    [
        ("F(2;80) R(1;50)", "F(2, 80);R(1, 50)"),  # `80)` is no number of a list
        ("IF RANDOM(1,2) = 1\nS\nENDIF", "IF(RANDOM(1, 2) = 1)"),
        ("SE NÃO(DISTANCE < 10)\nS\nFIM", "IF(NOT (DISTANCE < 10))"),
        ("ESPERA(LIGHT_L > 500)", "W(FOREVER) UNTIL(LIGHT_L > 500)"),
        ("S HASTA(DISTANCE > 20)", "S;W(FOREVER) UNTIL(DISTANCE > 20)"),
        ("⬆️ 2 80", "F(2, 80)"),
        ("➡️ 90 grados", "R(90 DEG, 80)"),
        ("M(50, 80, 2 seg)", "M(50, 80);W(2);S"),
    ],
)
def test_suggestions_keep_everything_that_was_written(wrong_text: str, fix: str) -> None:
    values = check(wrong_text)[0].values
    assert values.get("fix", values.get("example")) == fix


@pytest.mark.parametrize(
    ("wrong_text", "question"),
    [
        ("IF(DISTANCE < 37 OR DARK);S;ENDIF", "DISTANCE < 37 OR LIGHT_L < 500"),
        ("IF(hay luz y DISTANCE < 37);S;ENDIF", "LIGHT_L > 500 AND DISTANCE < 37"),
        ("F(5, 60) UNTIL(DISTANCE < 37 o mucha luz)", "DISTANCE < 37 OR LIGHT_L > 500"),
    ],
)
def test_words_beside_a_comparison_become_conditions_beside_it(
    wrong_text: str, question: str
) -> None:
    (diagnostic,) = check(wrong_text)
    assert (diagnostic.code.number, diagnostic.values["question"]) == ("TS135", question)


def test_unreadable_lines_count_as_instructions_of_their_blocks() -> None:
    text = "if distance < 20 then\nturn right 90 degrees\nelse\nforward\nend"
    assert repair_program(text, check).text == (
        "IF(DISTANCE < 20)\nturn right 90 degrees\nelse\nforward\nENDIF"
    )


def test_ends_of_several_blocks_are_separate() -> None:
    text = "LOOP(siempre)\n  IF DISTANCE < 15 cm\n    R(1, 60)\n  ELSE\n    F(1, 80)\nEND"
    assert "END_LOOPIF" not in {diagnostic.values.get("found") for diagnostic in check(text)}


def test_a_bare_end_closes_its_block() -> None:
    text = "forever\nif distance < 20 then\nturn right 90 degrees\nelse\nforward\nend"
    assert (check(text)[-1].code.number, check(text)[-1].values["right"]) == ("TS023", "ENDIF")


@pytest.mark.parametrize(
    ("wrong_text", "expected"),
    [
        ("F(5, 60) HASTA NEGRO", {"question": "LIGHT_L < 500", "another": "LIGHT_R < 500"}),
        ("F(5, 60) hasta la pared", {"question": "DISTANCE < 10"}),
        ("F(5, 60) hasta el final", {"question": "", "example": "DISTANCE < 10"}),
        ("IF BRIGHT THEN STOP", {"question": "LIGHT_L > 500"}),
        ("IF(pared a la derecha);S;ENDIF", {"question": "", "aside": "DISTANCE"}),
        ("IF(COLOR = 37);S;ENDIF", {"question": None}),
    ],
)
def test_words_in_conditions_refer_to_their_sensor(
    wrong_text: str, expected: dict[str, str]
) -> None:
    values = check(wrong_text)[0].values
    assert {name: values.get(name) for name in expected} == expected


@pytest.mark.parametrize(
    ("wrong_text", "right_text"),
    [
        ("IF(SENSOR_LUZ_DERECHA > 37);S;ENDIF", "IF(LIGHT_R > 37);S;ENDIF"),
        ("IF(DISTANCE IS 37);S;ENDIF", "IF(DISTANCE = 37);S;ENDIF"),
        ("F(10, 60) STOP WHEN DISTANCE < 12", "F(10, 60) UNTIL(DISTANCE < 12)"),
        ("REPITA 3x\nS\nFIM REPITA", "LOOP(3)\nS\nEND_LOOP"),
        ("SHOW LIGHT_L + LIGHT_R", "SHOW(LIGHT_L + LIGHT_R)"),
        ("CALL HOP\nDEF HOP\nS\nEND_DEF", "DEF HOP\nS\nEND_DEF\nHOP"),
        ("X = 50\nX = X + 10%\nF(1, X)", "X = 50\nX = X + 10\nF(1, X)"),
        ("SHOW(random.randint(1, 6))", "SHOW(RANDOM(1, 6))"),
        ("ENQUANTO(1) { F(1, 50) }", "WHILE(TRUE);F(1, 50);END_WHILE;"),
        ("LOOP 3 VECES (BEEP(1, 440); W(1))", "LOOP(3);BEEP(1, 440);W(1);END_LOOP"),
        ("repite mientras DISTANCE > 37\nS\nfin", "WHILE(DISTANCE > 37)\nS\nEND_WHILE"),
        ("R(90 GRAUS À DIREITA, 60)", "R(90 DEG, 60)"),
        ("SI F(two, 60)\nR(dos, 60)", "SI|F(2, 60)\nR(2, 60)"),
        ("F(2, 80) vírgula L(1, 50)", "F(2, 80);L(1, 50)"),
        ("F(2, 80)\u2014L(1, 50)", "F(2, 80);L(1, 50)"),
        ("X <- RANDOM(1, 6)\nF(X, 50)", "X = RANDOM(1, 6)\nF(X, 50)"),
        ("LOOP(4)\n_R(90 DEG, 60)_\nEND_LOOP", "LOOP(4)\nR(90 DEG, 60)\nEND_LOOP"),
        ("F(2, 80)\n\U0001f6d1", "F(2, 80)\nS"),
        ("VARIAVEL X = 5\nF(X, 50)", "X = 5\nF(X, 50)"),
    ],
)
def test_unambiguous_repairs_are_applied(wrong_text: str, right_text: str) -> None:
    assert repair_program(wrong_text, check).text == right_text


@pytest.mark.parametrize(
    ("wrong_text", "expected"),
    [
        ("SPIN 360", {"to_left": "L(360 DEG, 60)", "to_right": "R(360 DEG, 60)"}),
        ("gira 2 vueltas", {"to_right": "R(720 DEG, 80)"}),
        ("si luz mucha\nS\nfin mientras", {"right": "END_WHILE"}),
        ("PARA I DE 1 ATE 5\nSHOW(I)\nFIM", {"right": "LOOP"}),
        ("F(2,80) Y IF(DISTANCE<10) S", {"before": "IF(DISTANCE < 10)"}),
        ("M(-50, 50) 2", {"waiting": "M(-50, 50);W(2);S"}),
        ("F(1, 60) VEZES 3", {"fix": "LOOP(3);F(1, 60);END_LOOP"}),
        ("F(SIEMPRE, 60)", {"endless": "F(FOREVER, 60) UNTIL(DISTANCE < 10)"}),
        ("AVANZAR SIEMPRE\nTASK\nS\nEND_TASK", {"fix": "F(FOREVER, 80)"}),
        ("PLAY C FOR 1 SECOND", {"fix": "BEEP(1, 262)"}),
        ("LOOP 3 VUELTAS DE (BEEP(1, 440); W(1))", {"fix": None}),
        ("F(1, 80) then wait 2 then B(1, 80)", {"fix": "F(1, 80);W(2);B(1, 80)"}),
        ("R(90 GRAUS FOO, 60)", {"right": "90 DEG"}),
        ("L(1, 50) 2X", {"fix": "LOOP(2);L(1, 50);END_LOOP"}),
        ("turn(right, 45)", {"right": "R(45 DEG, 60)"}),
        ("VOLTA(2, 80)", {"to_left": "L(2, 80)", "to_right": "R(2, 80)"}),
        ("WHEN DISTANCE < 37 BEEP", {"fix": "WHEN(DISTANCE < 37);BEEP(1, 440);END_WHEN"}),
        ("SE(DISTANCE < 37 E NÃO ESCURO)", {"question": "DISTANCE < 37 AND LIGHT_L > 500"}),
        (
            "IF(DISTANCE < 9)\nS\nELSE DISTANCE < 37\nF(1, 30)\nENDIF",
            {"fix": "ELSEIF(DISTANCE < 37)"},
        ),
        ("si hay un obstaculo para", {"sample": "10 cm"}),
        ("si hay un obstaculo a 37 cm para", {"sample": None}),
        ("F(80,2s)", {"fix": "F(2, 80)"}),
        ("toca 3 pitidos", {"fix": "LOOP(3);BEEP(1, 440);W(1);END_LOOP"}),
        ("ande e pare quando DISTANCE < 37", {"fix": "F(FOREVER, 80) UNTIL(DISTANCE < 37)"}),
        ("DISTANCE < 37 ? S", {"fix": "IF(DISTANCE < 37);S;ENDIF"}),
        ("SPEED = 80;TIME = 2;F(TIME, SPEED)", {"right": "TIME_1", "times": "2"}),
        ("repetir 37\n  mover 10 pasos\n  si toca borde rebotar\nfin", {"usage": "LOOP(37)"}),
        ("servo.write(90)", {"right": None}),
        ("robot.turnLeft(90, 37)", {"usage": "L(90 DEG, 37)"}),
        ("turnLeft(2, 37)", {"usage": "L(time, power)"}),
        ("F(37, FOREVER)", {"fix": "F(FOREVER, 37) UNTIL(DISTANCE < 10)"}),
        ("F(80, 2)\nBEEP(440, 1)", {"fix": "F(2, 80)"}),
        ("S\nsi no\nF(1, 60)\nENDIF", {"right": "ELSE"}),
        ("IF(DISTANCE < 9)\nS\nELSE(DISTANCE ≥ 37)\nS\nENDIF", {"fix": "ELSEIF(DISTANCE >= 37)"}),
        ("IF(!LIGHT_L);S;ENDIF", {"fix": "IF(LIGHT_L = 0)"}),
        ("IF(NOT LIGHT_L);S;ENDIF", {"example": "LIGHT_L > 0"}),
        ("dar a VUELTAS el valor 37\nSHOW(VUELTAS)", {"fix": "VUELTAS = 37"}),
        ("VUELTAS = 1\nsumar a VUELTAS 37", {"fix": "VUELTAS = VUELTAS + 37"}),
        ("F(1, 60)\nvolver al 1", {"endless": "LOOP(FOREVER);F(1, 60);END_LOOP"}),
        ("F(5, 60) HASTA(PARED < 37 CM)", {"fix": "F(5, 60) UNTIL(DISTANCE < 37)"}),
        ("go\nF(2, 80)", {"right": "SI|"}),
        ("vamos\nF(2, 80)", {"right": "SI|"}),
        ("SI|S\ngo", {"right": "F"}),
        ("on button pressed\nF(2, 80)", {"right": "SB|"}),
        ("input.onButtonPressed(Button.A, F(2, 80))", {"begun": "", "asked": "Button"}),
        ("TURBO(3)", {"taught": "TURBO", "often": None}),
        ("#define X 37\nF(1, X)", {"fix": "X = 37"}),
        ("WHILE(DISTANCE > 9)\nS\nEND_LOOP\nEND_WHILE", {"around": "WHILE", "ends": "END_WHILE"}),
        (
            "IF(DISTANCE < 9)\nS\nIF(LIGHT_L > 5)\nS\nENDIF\nF(1, 60)",
            {"begun": "1", "early": "2", "line": "6"},
        ),
    ],
)
def test_no_unintended_number_or_word_is_reported(
    wrong_text: str, expected: dict[str, str]
) -> None:
    diagnostics = check(wrong_text)
    assert any(
        {name: diagnostic.values.get(name) for name in expected} == expected
        for diagnostic in diagnostics
    ), diagnostics


def test_a_word_is_recognized_alone_as_in_a_list() -> None:
    """A pattern of `sounds.txt` reads all words at once, so none may reach into the next line."""
    all_words = [*WORDS, *lexicon()]
    sounds_in_list = Speller(all_words)._word_by_sound
    word_by_sound: dict[tuple[int, str], str] = {}
    for word in all_words:
        for sound in Speller([word])._word_by_sound:
            word_by_sound.setdefault(sound, word)
    assert sounds_in_list == word_by_sound


@pytest.mark.parametrize("sign", sorted(COMPARISONS - {"="}))
def test_the_comparison_of_a_light_without_a_side_is_kept(sign: str) -> None:
    """For `IF LUZ < 20`, no message asks which light is brighter than 20."""
    mirrored_sign = {"<": ">", ">": "<", "<=": ">=", ">=": "<="}.get(sign, sign)
    for word in words("light"):
        for condition, kept_sign in (
            (f"{word} {sign} {OWN}", sign),
            (f"{OWN} {sign} {word}", mirrored_sign),
            (f"NOT {word} {sign} {OWN}", OPPOSITES[sign]),
        ):
            text = f"SI|\nIF {condition}\nS\nENDIF"
            shown_text = " ".join(message_text(diagnostic, text) for diagnostic in check(text))
            signs = set(re.findall(rf"LIGHT_[LR] (\S+) {OWN}", shown_text))
            assert signs == {kept_sign}, (condition, shown_text)
