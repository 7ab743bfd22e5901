"""A condition in words: `luz mucha`, `hay una pared`, `pared a medio metro`. Knows no row.

Finds which sensor and which sign they mean, as far as they say it. If they lack the number, it is
an example.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from tiniscript.base.fixed_point import ONE
from tiniscript.base.kit import Device
from tiniscript.recovery.meanings import (
    NEAR_COST,
    Lexeme,
    Names,
    lexicon_concept,
    lexicon_meaning,
    make_token,
)
from tiniscript.syntax.lexer import NUMBER
from tiniscript.syntax.operators import COMPARISONS, OPPOSITES

_EMPTY_WORD = make_token("THE")  # a word that asks no question: alone, it may be a name
_KINDS = ("little", "much", "light", "ahead", "none", "no", "without", "left", "right")
_ASKED_KINDS = frozenset(("little", "much", "light", "ahead", "none"))
_SAMPLE_CM = 10  # centimetres, as in every example
_SAMPLE_NUMBER = 50  # a sample value of a variable
_MIRRORED_SIGNS = {"<": ">", ">": "<", "<=": ">=", ">=": "<="}
_ROUND_NUMBERS_FROM = 100  # above it an example is a round number


def condition_values(tokens: Sequence[Lexeme], names: Names) -> dict[str, str] | None:
    """Return the values of a condition in words, or None if it is not understood.

    It is `question` if it has its number, a `question` if a word names the number, and an `example`
    otherwise; `also` and `another` ask the other sensor that may be meant. `joint` joins several,
    and `aside` only looks ahead.
    """
    is_compared = any(token.text == "=" for token in tokens)  # `DISTANCE = NEAR`
    sign = _written_sign(tokens)
    tokens = [token for token in tokens if token.text != "="]
    texts = [token.text for token in tokens]
    if mixed_values := _mixed_condition(tokens, names):
        return mixed_values
    # The language itself has these words.
    is_condition = any(text in ("AND", "OR") for text in texts)
    has_number = any(token.kind is NUMBER for token in tokens)  # `COLOR = 3` is no `> 3`
    if is_condition or (
        is_compared and (has_number or not _mentioned_words(texts, names) & _ASKED_KINDS)
    ):
        return None
    if joint := _joining_word(texts, names):
        return {"question": "", "joint": joint}
    texts, number = _split_number(tokens, names)
    kinds_mentioned = _mentioned_words(texts, names)
    numbers = [text for text in texts if text[0].isdigit() or text[0] == "."]
    own_names = [text for text in texts if names.is_name(text) and text != number]
    if [number] == texts != [tokens[-1].text] or (
        number and not own_names and kinds_mentioned == {"little"}
    ):
        kinds_mentioned.add("ahead")  # `20 cm`, `less than 10`
    if any(names.is_yes_no(text) for text in own_names):
        return None  # it is never compared
    is_bare_name = len(texts) == 1 and not (
        kinds_mentioned & {"light", "ahead"} and not lexicon_meaning(texts[0], "sensor")
    )
    is_button = any(lexicon_concept(text) == "BUTTON" for text in texts)
    if is_bare_name or is_button or (numbers and not kinds_mentioned & {"ahead", "light", "none"}):
        return None
    question = [
        f"{name} {_sign(name, sign if number else '', kinds_mentioned)} "
        f"{number or _example(names.number_readings.get(name), name)}"
        for name in _subjects(own_names, texts, kinds_mentioned, names)
    ]
    if (
        "ahead" in kinds_mentioned
        and kinds_mentioned & {"left", "right"}
        and question[0].startswith("DISTANCE")
    ):
        return {"question": "", "aside": "DISTANCE"}  # the sensor looks ahead
    is_asking = bool(own_names or kinds_mentioned & _ASKED_KINDS)
    gap_names = (
        ("asked", "also") if number else ("question", "another") if is_asking else ("example",)
    )
    return {"question": "", **dict(zip(gap_names, question, strict=False))}


def sensors_of(word: str, names: Names) -> list[str]:
    """Return the sensors that a word for what they see may mean: both lights for `luz`."""
    sensors = _lights(names) if lexicon_meaning(word, "light") else ["DISTANCE"]
    return (
        [] if names.is_name(word) else [name for name in sensors if name in names.number_readings]
    )


def _mentioned_words(texts: Sequence[str], names: Names) -> set[str]:
    other_texts = [text for text in texts if not names.is_name(text)]
    return {kind for kind in _KINDS for text in other_texts if lexicon_meaning(text, kind)}


def _joining_word(texts: Sequence[str], names: Names) -> str:
    """Return AND or OR, if two conditions are joined and each is in words."""
    joints = [lexicon_meaning(text, "and") or lexicon_meaning(text, "or") for text in texts]
    joint_indexes = [k for k, text in enumerate(texts) if joints[k] and not names.is_name(text)]
    pieces = [texts[a + 1 : b] for a, b in pairwise((-1, *joint_indexes, len(texts)))]
    are_asking = all(
        _mentioned_words(piece, names) & {"ahead", "light", "none"} for piece in pieces
    )
    return joints[joint_indexes[0]][0].upper() if joint_indexes and are_asking else ""


def _mixed_condition(tokens: Sequence[Lexeme], names: Names) -> dict[str, str]:
    """Return the condition of words joined with a comparison: `DISTANCE < 10 o hay luz`."""
    joint_indexes = [k for k, token in enumerate(tokens) if _joining_word_of(token.text, names)]
    pieces = [tokens[a + 1 : b] for a, b in pairwise((-1, *joint_indexes, len(tokens)))]
    are_comparisons = [any(token.text in COMPARISONS for token in piece) for piece in pieces]
    if not any(are_comparisons) or all(are_comparisons):
        return {}
    joint = _joining_word_of(tokens[joint_indexes[0]].text, names)
    questions = []
    for piece, is_compared in zip(pieces, are_comparisons, strict=True):
        text = " ".join(names.find_meaning(token.text) or token.text for token in piece)
        values = (
            {"asked": text} if is_compared else condition_values([_EMPTY_WORD, *piece], names) or {}
        )
        questions.append(values.get("asked") or values.get("question", ""))
    if not all(questions):
        return {"question": "", "joint": joint}
    return {"question": f" {joint} ".join(questions)}


def _joining_word_of(text: str, names: Names) -> str:
    """Return AND or OR, where a word joins two questions."""
    meaning = lexicon_meaning(text, "and") or lexicon_meaning(text, "or")
    return "" if not meaning or names.is_name(text) else meaning[0].upper()


def _split_number(tokens: Sequence[Lexeme], names: Names) -> tuple[list[str], str]:
    """Return the words without units, and their number in centimetres or of light, or ""."""
    texts = [token.text for token in tokens]
    is_near = bool(_mentioned_words(texts, names) & {"ahead", "none"})
    for k, text in enumerate(texts):
        unit = lexicon_meaning(texts[k + 1], "unit") if k + 1 < len(texts) else ()
        texts_without_unit = [*texts[: k + 1], *texts[k + 2 :]] if unit else texts
        if tokens[k].kind is NUMBER:
            is_length = not unit or unit[0] == "cm"
            return texts_without_unit, _in_centimetres(text, unit) if is_length else ""
        if unit[:1] == ("cm",) and is_near:
            number_meaning = lexicon_meaning(text, "number") or (
                ("0.5",) if lexicon_meaning(text, "half") else ()
            )
            if number_meaning:
                return [*texts[:k], *texts[k + 2 :]], _in_centimetres(number_meaning[0], unit)
        ends_comparison = k == len(texts) - 1 and k > 1 and lexicon_meaning(texts[k - 1], "than")
        if is_near and text in names.variables and (ends_comparison or unit == ("cm", "1000")):
            return texts_without_unit, text
    return texts, ""


def _in_centimetres(number_text: str, unit: Sequence[str]) -> str:
    return f"{float(number_text) * int(unit[1]) / ONE:g}" if unit else number_text


def _subjects(
    own_names: Sequence[str], texts: Sequence[str], stated_kinds: set[str], names: Names
) -> list[str]:
    """Return the sensors that are asked, or the variable."""
    sensors = [text for text in own_names if text in names.number_readings]
    sensors += [
        concept
        for text in texts
        if (concept := names.find_meaning(text, NEAR_COST)) in names.number_readings
    ]
    subjects = sensors[:1] or list(own_names[:1])
    if not subjects and "light" in stated_kinds and "ahead" not in stated_kinds:
        subjects = _lights(names)[:2]
        sided_sensors = [
            f"LIGHT_{side[0].upper()}" for side in ("left", "right") if side in stated_kinds
        ]
        subjects = [
            name for name in sided_sensors if name in subjects and len(sided_sensors) == 1
        ] or subjects
    return (
        subjects
        or [
            *(name for name in names.number_readings if name == "DISTANCE"),
            *names.number_readings,
            "X",
        ][:1]
    )


def _lights(names: Names) -> list[str]:
    return sorted(
        name for name in names.number_readings if name.partition("_")[0] in ("LIGHT", "LINE")
    )


def _written_sign(tokens: Sequence[Lexeme]) -> str:
    """Return the sign that a sensor is compared with, as it is on the left: `>` of `20 < LUZ`."""
    indexes = [k for k, token in enumerate(tokens) if token.text in COMPARISONS]
    if len(indexes) != 1:
        return ""
    sign = tokens[indexes[0]].text
    is_mirrored = any(token.kind is NUMBER for token in tokens[: indexes[0]])
    return _MIRRORED_SIGNS.get(sign, sign) if is_mirrored else sign


def _sign(name: str, written_sign: str, stated_kinds: set[str]) -> str:
    is_negated = bool(stated_kinds & {"no", "without", "none"})
    if written_sign:
        return OPPOSITES[written_sign] if is_negated else written_sign
    is_below = "little" in stated_kinds or (name == "DISTANCE" and "much" not in stated_kinds)
    return "<" if is_below != is_negated else ">"


def _example(device: Device | None, name: str) -> int:
    if device is None:
        return _SAMPLE_NUMBER
    middle_value = (device.low + device.high) // (2 * ONE)
    return (
        _SAMPLE_CM
        if name == "DISTANCE"
        else round(middle_value, -2)
        if middle_value > _ROUND_NUMBERS_FROM
        else middle_value
    )
