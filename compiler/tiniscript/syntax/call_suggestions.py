"""Suggests what a beginner probably meant to put into brackets.

Knows how to separate values if commas, points or brackets are misplaced.
Looks at what was written, in spans or tokens, and gives texts to suggest. Recovery asks for
functions and headers, the checker for commands.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.source import Source, Span
from tiniscript.syntax.lexer import NEWLINE, NUMBER, ODD, QUOTES, WORD, Token
from tiniscript.syntax.ranges import range_in
from tiniscript.syntax.units import converted
from tiniscript.words import NOTE_WORDS, UNITS, WORDS, Word, meant_by

LONGEST = 60  # tokens of which a suggestion is made
LONG_TIME_S = 20  # a longer move is rarely meant: so much is a power, degrees or steps
LOWEST_HERTZ = 30
_MOST_POWER = 100
_MOST_TONES = 9  # of a BEEP that gets one for each
_TIME_AND_POWER = (0, 1)  # their places
_HAS_DECIMALS = ("s",)  # units whose values are often no whole numbers
_NUMBER = re.compile(r"[0-9]+(\.[0-9]+)?|\.[0-9]+")
_DIVIDED = re.compile(r"([0-9]+)(?:\s*[-/]\s*|\.(?=[6-9]0|100))([0-9]{2}|100)(?<=0)")  # `2.80`
_POWER = re.compile("[2-9]0|100")
_UNTIL = re.compile(r"(?i)\s*\bUNTIL\b.*")  # with its question
_ASKS = re.compile(r"[<>=]")  # a comparison, which no number has
_WORDS_FOR_YES_NO = {
    "ON": "TRUE", "YES": "TRUE", "1": "TRUE", "ENCENDIDO": "TRUE", "PRENDIDO": "TRUE",
    "OFF": "FALSE", "NO": "FALSE", "0": "FALSE", "APAGADO": "FALSE",
}  # fmt: skip


def count_diagnostic(
    source: Source, word: Word, arguments: Sequence[Span], span: Span
) -> Diagnostic:
    """Return the diagnostic of `word` with these arguments; `span` is the place to point at."""
    texts = [source[each] for each in arguments]
    fixed = _with_points(texts, arguments, word)
    if word.role == "wait" and _POWER.fullmatch(texts[-1] if texts else "") and texts[0] != "0":
        fixed = None  # `W(2,80)`: as F has it
    if word.role == "wait" and texts and texts[0].isdecimal() and float(texts[0]) >= LONG_TIME_S:
        fixed = None  # `W(80,2)`
    if fixed is not None:
        return Diagnostic(codes.DECIMAL_COMMA, span, {"fix": _call(word, fixed)})
    wanted = len(word.arguments)
    goes_on = source.text[span.end : span.end + 9].lstrip(" ,")[:1] == "("  # `F(2)(80)`
    fix = "" if goes_on else _filled(texts, word)
    if len(texts) > wanted == 1 and word.arguments[0].name == "c":
        fix = _call(word, [" AND ".join(texts)])
    if word.role == "motors" and len(texts) == wanted + 1:
        fix = _timed_motors(texts, word)
    if word.role == "beep" and len(texts) > wanted:
        fix = _melody(texts, word)
    shown = [text for text in texts if text[:1] not in QUOTES]
    if word.role == "show" and len(shown) == 1 < len(texts):  # `SHOW("far", DISTANCE)`
        fix = _call(word, shown)
    if word.role == "show" and len(texts) > 1 and len(shown) == len(texts):
        fix = ";".join(_call(word, [text]) for text in texts)
    if word.role == "move" and len(texts) == wanted + 1 and _ASKS.search(texts[-1]):
        fix = f"{_call(word, texts[:-1])} UNTIL({texts[-1]})"
    if word.role == "move" and len(texts) == wanted + 1 and meant_by(texts[0].upper()) == word.text:
        fix = _call(word, texts[1:])  # `R(derecha, 2, 80)`
    until = _UNTIL.search(source[span])
    if fix and until is not None and "UNTIL" not in fix:
        fix += until[0]  # `F(5.60) UNTIL(DISTANCE < 15)`
    values = {
        "word": word.text,
        "usage": word.usage,
        "fix": fix,
        "example": "" if texts else word.example,
        **_said_of_count(texts, word, until),
        "wanted": str(wanted),
        "found": str(len(arguments)),
    }
    return Diagnostic(codes.ARGUMENT_COUNT, span, values)


def _melody(texts: Sequence[str], word: Word) -> str:
    """`BEEP(0.2, 440, 660, 880)`: return a BEEP for each tone."""
    if len(texts) > _MOST_TONES or not all(_NUMBER.fullmatch(text) for text in texts):
        return ""
    time, *tones = texts
    if float(time) >= LONG_TIME_S or any(float(tone) <= LOWEST_HERTZ for tone in tones):
        return ""
    return ";".join(_call(word, [time, tone]) for tone in tones)


def _timed_motors(texts: Sequence[str], word: Word) -> str:
    """`M(2, 80, 80)`, `M(80, 80, 2)`: return M with the powers, a wait of that time, and S."""
    if not all(_NUMBER.fullmatch(text) for text in texts):
        return ""
    for time, powers in ((texts[0], texts[1:]), (texts[-1], texts[:-1])):
        are_powers = all(LONG_TIME_S <= float(each) <= _MOST_POWER for each in powers)
        if are_powers and 0 < float(time) < LONG_TIME_S:
            return f"{_call(word, powers)};W({time});S"
    return ""


def _said_of_count(texts: Sequence[str], word: Word, until: re.Match[str] | None) -> dict[str, str]:
    """Return what is said of a wrong number of values: `power` of F(80), `spare` of F(2, 80, 5).

    `kept` is W(2) for W(2, 80): a wait has no power. With UNTIL the time may be FOREVER.
    """
    numbers = [float(text) if _NUMBER.fullmatch(text) else -1 for text in texts]
    said = {"power": "", "spare": "", "kept": ""}
    if word.role == "move" and len(texts) == 1 and LONG_TIME_S <= numbers[0] <= _MOST_POWER:
        said["power"] = f"{word.text}( , {texts[0]})"
        if until is not None:
            said["endless"] = f"{word.text}(FOREVER, {texts[0]}){until[0]}"
        said["number"] = texts[0]
    elif len(texts) > len(word.arguments) and min(numbers) >= 0:
        is_sound = word.role == "beep" and numbers[1] > LOWEST_HERTZ
        if is_sound or len(word.arguments) == 1:
            said["spare"] = _call(word, texts[: len(word.arguments)])
        if word.role == "move" and numbers[0] < LONG_TIME_S <= numbers[1] <= _MOST_POWER:
            said["spare"] = _call(word, texts[:2])
        is_timed = word.role == "wait" and len(texts) == len(_TIME_AND_POWER)
        for first, second in (_TIME_AND_POWER, _TIME_AND_POWER[::-1]):
            if is_timed and 0 <= numbers[first] < LONG_TIME_S <= numbers[second] <= _MOST_POWER:
                said["kept"] = _call(word, [texts[first]])
    return said


def call_of(source: Source, word: Word, arguments: Sequence[Span]) -> str:
    """Return `word` with these arguments, an example where there are none, "" where none fits."""
    texts = [source[each] for each in arguments]
    if not word.arguments:
        return word.text
    if len(texts) == len(word.arguments) and not any(text[:1] in QUOTES for text in texts):
        return _call(word, texts)
    fixed = _with_points(texts, arguments, word)
    if fixed or texts:
        return _call(word, fixed) if fixed else _filled(texts, word)
    return word.example


def call_in(word: Word, tokens: Sequence[Token]) -> str:
    """Return the call that the tokens after `word` were meant to be, "" where that is not sure.

    `2 80` for F is `F(2, 80)`, `0,5` for W is `W(0.5)`; nothing at all is an example.
    """
    said = range_in(" ".join(token.text for token in tokens[:LONGEST]))
    if word.text == "RANDOM" and said:
        return _call(word, said)
    values = _values(tokens[:LONGEST])
    if word.role == "show":  # `SHOW DISTANCE cm`
        values = [each for k, each in enumerate(values) if not k or each[0].text not in UNITS]
    texts = [written(value) for value in values]
    units = [_in_our_unit(value, word, k) for k, value in enumerate(values)]
    if None in units:
        return ""
    texts = [unit or text for unit, text in zip(units, texts, strict=True)]
    if word.role == "actuator" and word.example.endswith("(TRUE)"):
        texts = [_WORDS_FOR_YES_NO.get(text, text) for text in texts]
    if not tokens:
        return word.example
    if len(tokens) > LONGEST:
        return ""
    if word.role == "show" and len(texts) > 1:
        return ";".join(_call(word, [text]) for text in texts)
    if len(texts) != len(word.arguments):
        spans = [Span(value[0].start, value[-1].end) for value in values]
        commas = {token.start for token in tokens if token.kind == ","}
        fixed = _with_points(texts, spans, word, commas)
        if len(texts) == 1 and units[0] and word.arguments[0].unit == "s":
            return _call(word, [*texts, *(each.sample for each in word.arguments[1:])])
        return _call(word, fixed) if fixed else _filled(texts, word)
    return _call(word, texts)


def glued_call(word: str, rest: Sequence[Token] = ()) -> str | None:
    """`F2,80` or `W1`: return `F(2, 80)` or `W(1)`, None where the word is none with a number."""
    head = word.rstrip("0123456789")
    known = WORDS.get(head)
    if head == word or known is None or known.role not in ("move", "wait", "motors", "beep"):
        return None
    end = rest[0].start if rest else 0
    return call_in(known, [Token(NUMBER, word[len(head) :], end - 1, end), *rest[:LONGEST]])


def written(tokens: Sequence[Token]) -> str:
    """Return the tokens of an expression as the language writes them, with brackets in pairs."""
    row: list[str] = []
    opened = 0
    before: Token | None = None
    was_minus = False  # right before: one that belongs to what follows
    for token in tokens:
        kind = token.kind
        if kind is NEWLINE or kind is ODD or (kind == ")" and not opened):
            continue
        opened += (kind == "(") - (kind == ")")
        is_call = kind == "(" and before is not None and before.kind is WORD and (
            before.text not in WORDS or WORDS[before.text].role == "function"
        )  # fmt: skip
        if before and not (was_minus or is_call or before.kind == "(" or kind in (")", ",")):
            row.append(" ")
        row.append(token.text)
        was_minus = kind == "-" and not ends_value(before)
        before = token
    return "".join(row) + ")" * opened


def ends_value(token: Token | None) -> bool:
    """Whether a value may end with this token."""
    if token is None:
        return False
    return token.kind is NUMBER or token.kind == ")" or is_value_word(token)


def starts_value(token: Token) -> bool:
    """Whether a value may begin with this token (which a `-` may not: it is a sign first)."""
    return token.kind is NUMBER or token.kind == "(" or is_value_word(token)


def is_value_word(token: Token) -> bool:
    if token.kind is not WORD:
        return False
    word = WORDS.get(token.text)
    return word is None or word.role in ("value", "function", "forever")


def _values(tokens: Sequence[Token]) -> list[list[Token]]:
    """Return the values that follow one another in `tokens`, with commas or without.

    The unit of a number is the last token of its value.
    """
    found: list[list[Token]] = [[]]
    depth = 0
    before: Token | None = None
    tokens = _without_angles(tokens)
    for k, token in enumerate(tokens):
        kind = token.kind
        if kind is NEWLINE or kind is ODD or (kind == ")" and not depth):
            continue
        if _is_unit_of(before, tokens, k):
            found[-1].append(token)
            continue
        if not depth:
            if kind == ",":
                found.append([])
                before = None
                continue
            is_call = kind == "(" and before is not None and before.kind is WORD
            is_loose_minus = (
                kind == "-"
                and before is not None
                and token.start > before.end
                and k + 1 < len(tokens)
                and tokens[k + 1].start == token.end
            )
            if ends_value(before) and (is_loose_minus or (starts_value(token) and not is_call)):
                found.append([])
        depth += (kind == "(") - (kind == ")")
        found[-1].append(token)
        before = token
    return [value for value in found if value]


def _without_angles(tokens: Sequence[Token]) -> Sequence[Token]:
    """Return `2, 80` for the `< 2, 80 >` that someone put there for brackets."""
    is_framed = len(tokens) > 2 and (tokens[0].kind, tokens[-1].kind) in (("<", ">"), ("/", "/"))
    return tokens[1:-1] if is_framed else tokens


def _is_unit_of(before: Token | None, tokens: Sequence[Token], k: int) -> bool:
    """Whether the token at `k` is the unit of the number before it."""
    token = tokens[k]
    if before is None or before.kind is not NUMBER or token.text not in UNITS:
        return False
    return token.text not in WORDS and (token.kind != "%" or _ends(tokens, k + 1))


def _in_our_unit(value: Sequence[Token], word: Word, k: int) -> str | None:
    """Return a number with a unit as the argument `k` of `word` takes it.

    Nothing where it has no unit, None where the unit does not belong there.
    """
    number, unit = value[0], value[-1]
    if len(value) != 2 or number.kind is not NUMBER or unit.text not in UNITS:
        return ""
    its = word.arguments[k].unit if k < len(word.arguments) else ""
    return converted(number.text, unit.text) if UNITS[unit.text][0] == its else None


def _filled(texts: Sequence[str], word: Word) -> str:
    """Return the call of `word` with the value that is missing, "" where that is not sure.

    `F(5)` lacks its power. `F(2.80)` has a point in place of its comma: no other decimal ends
    with a 0. `F(80)` may lack either, and `R(90)` is meant in degrees.
    """
    if len(texts) != 1 or len(word.arguments) != 2:
        return ""
    (text,) = texts
    name = text.upper()
    if word.role == "beep" and name in NOTE_WORDS:
        return _call(word, [word.arguments[0].sample, NOTE_WORDS[name]])
    if word.role == "move" and name.isidentifier() and name not in WORDS:
        if name.startswith(("VEL", "SPEED", "POT", "POW", "FUERZA")):
            return _call(word, [word.arguments[0].sample, text])
        if name.startswith(("TIEM", "TIME", "SEG", "SEC")):
            return _call(word, [text, word.arguments[1].sample])
    number = float(text) if _NUMBER.fullmatch(text) else None
    first = word.arguments[0]
    if word.role == "motors":
        return _call(word, [text, text]) if number is not None else ""
    if word.text == "ROUND":
        return _call(word, [text, "0"])
    if word.text == "RANDOM":
        if range_in(text):
            return _call(word, range_in(text))
        return _call(word, ["1", text]) if text.isdecimal() and text not in ("0", "1") else ""
    if first.unit != "s":
        return ""
    divided = _DIVIDED.fullmatch(text)
    if divided:
        return _call(word, [divided[1], divided[2]])
    if "." in text and text.endswith("0"):
        return ""  # `F(1.50)` may be 1 and 50
    if number is None or number >= LONG_TIME_S:
        is_pitch = word.role == "beep" and number is not None and number > LOWEST_HERTZ
        return _call(word, [first.sample, text]) if is_pitch else ""
    return _call(word, [text, word.arguments[1].sample])


def _ends(tokens: Sequence[Token], k: int) -> bool:
    """Whether the value before `k` is over there."""
    return k >= len(tokens) or tokens[k].kind == ","


def _call(word: Word, texts: Sequence[str]) -> str:
    return f"{word.text}({', '.join(texts)})"


def _with_points(
    texts: Sequence[str], places: Sequence[Span], word: Word, commas: set[int] | None = None
) -> list[str] | None:
    """Return the values of `1,5, 80` where two are wanted: `1.5`, `80`. None where not meant.

    `commas` are the places of commas, where other signs may stand between values: `1 50 70`.
    """
    spare = len(texts) - len(word.arguments)
    if spare <= 0 or not word.arguments or (commas is not None and texts[-1] == "0"):
        return None
    touches = [
        place.end + 1 == after.start and (commas is None or place.end in commas)
        for place, after in pairwise(places)
    ]
    some_are_loose = not all(touches)
    merged: list[str] = []
    k = 0
    while k < len(texts) and len(merged) < len(word.arguments):
        its = word.arguments[len(merged)]
        is_meant = its.unit in _HAS_DECIMALS or (its.name in ("value", "a", "c") and (
            some_are_loose or (len(word.arguments) == 1 and word.role != "actuator")
        ))  # fmt: skip
        joins = (
            (is_meant or (some_are_loose and its.name != "n" and word.role != "actuator"))
            and spare > 0
            and k + 1 < len(texts)
            and _ends_whole(texts[k], len(word.arguments) == 1)
            and texts[k + 1].isdecimal()
            and texts[k + 1] not in ("000", "0")  # `1,000` is a thousand; `2,8 0` is no 2.8
            and (len(word.arguments) == 1 or texts[k + 1][-1:] != "0")  # nor is `2,80,60` 2.8
            and touches[k]
        )
        merged.append(f"{texts[k]}.{texts[k + 1]}" if joins else texts[k])
        spare -= joins
        k += 2 if joins else 1
    return merged if spare == 0 and k == len(texts) else None


def _ends_whole(text: str, may_be_more: bool) -> bool:
    """Whether a value is a whole number, or may be a calculation that ends with one."""
    number = text.lstrip("-")
    if may_be_more:
        number = text[len(text.rstrip("0123456789")) :]
        before = text[: len(text) - len(number)]
        return bool(number) and (not before or before[-1] in " +-*/(<>=")
    return number.isdecimal()
