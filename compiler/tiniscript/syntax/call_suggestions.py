"""Suggests what a beginner probably meant to put into brackets.

Knows how to separate values if commas, points or brackets are misplaced.
Looks at what was written, in spans or tokens, and gives texts to suggest. Recovery asks for
functions and headers, the checker for commands.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.fixed_point import as_text
from tiniscript.kit import Device
from tiniscript.source import Source, Span
from tiniscript.syntax.lexer import NEWLINE, NUMBER, ODD, QUOTES, WORD, Token
from tiniscript.words import UNITS, WORDS, Argument, Word

LONGEST = 60  # tokens of which a suggestion is made
_HAS_DECIMALS = ("s",)  # units whose values are often no whole numbers
_WORDS_FOR_YES_NO = {
    "ON": "TRUE", "YES": "TRUE", "1": "TRUE", "ENCENDIDO": "TRUE", "PRENDIDO": "TRUE",
    "OFF": "FALSE", "NO": "FALSE", "0": "FALSE", "APAGADO": "FALSE",
}  # fmt: skip


def actuator_word(device: Device) -> Word:
    """Return an actuator of a kit as a word that takes one value."""
    middle = device.low + (device.high - device.low) // 2000 * 1000
    sample = "TRUE" if device.is_yes_no else as_text(middle)
    return Word(
        device.name,
        "actuator",
        (Argument("value", device.unit, device.low, device.high, sample),),
    )


def count_diagnostic(
    source: Source, word: Word, arguments: Sequence[Span], span: Span
) -> Diagnostic:
    """Return the diagnostic of `word` with these arguments; `span` is the place to point at."""
    texts = [source[each] for each in arguments]
    fixed = _with_points(texts, arguments, word)
    if fixed is not None:
        return Diagnostic(codes.DECIMAL_COMMA, span, {"fix": _call(word, fixed)})
    wanted = len(word.arguments)
    fix = _call(word, _filled_up(texts, word)) if texts else word.example
    if len(texts) > wanted == 1:
        is_asked = word.arguments[0].name == "c"
        fix = _call(word, [" AND ".join(texts)] if is_asked else texts[:1])
    values = {
        "word": word.text,
        "usage": word.usage,
        "fix": fix,
        "wanted": str(wanted),
        "found": str(len(arguments)),
    }
    return Diagnostic(codes.ARGUMENT_COUNT, span, values)


def call_of(source: Source, word: Word, arguments: Sequence[Span]) -> str:
    """Return `word` with these arguments where they fit, else an example of it."""
    texts = [source[each] for each in arguments]
    if not word.arguments:
        return word.text
    if len(texts) == len(word.arguments) and not any(text[:1] in QUOTES for text in texts):
        return _call(word, texts)
    fixed = _with_points(texts, arguments, word) or _filled_up(texts, word)
    return _call(word, fixed) if fixed else word.example


def call_in(word: Word, tokens: Sequence[Token]) -> str:
    """Return the call that the tokens after `word` were meant to be, else an example of it.

    `2 80` for F is `F(2, 80)`, `0,5` for W is `W(0.5)`.
    """
    values = _values(tokens[:LONGEST])
    texts = [written(value) for value in values]
    if word.role == "actuator" and word.example.endswith("(TRUE)"):
        texts = [_WORDS_FOR_YES_NO.get(text, text) for text in texts]
    if len(texts) != len(word.arguments):
        spans = [Span(value[0].start, value[-1].end) for value in values]
        texts = _with_points(texts, spans, word) or _filled_up(texts, word)
    if len(tokens) > LONGEST or not texts:
        return word.example
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
    """Return the values that follow one another in `tokens`, with commas or without."""
    found: list[list[Token]] = [[]]
    depth = 0
    before: Token | None = None
    for k, token in enumerate(tokens):
        kind = token.kind
        if kind is NEWLINE or kind is ODD or (kind == ")" and not depth):
            continue
        if before is not None and before.kind is NUMBER and token.text in UNITS:
            if token.text not in WORDS and (kind != "%" or _ends(tokens, k + 1)):
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


def _filled_up(texts: Sequence[str], word: Word) -> list[str]:
    """Return the values of `F(5)` with those that are missing: `5`, `80`. None where not meant.

    `F(2.80)` has a point in place of its comma: no other decimal ends with a 0.
    """
    if len(texts) == 1 < len(word.arguments) == 2 and word.arguments[0].unit == "s":
        whole, _, part = texts[0].partition(".")
        if whole.isdecimal() and part.isdecimal() and part[-1] == "0" and len(part) > 1:
            return [whole, part]
    missing = word.arguments[len(texts) :]
    if word.role == "motors" and len(texts) == 1:
        return [*texts, *texts]
    if not texts or not missing or any(text[:1] in QUOTES for text in texts):
        return []
    return [*texts, *(its.sample for its in missing)]


def _ends(tokens: Sequence[Token], k: int) -> bool:
    """Whether the value before `k` is over there."""
    return k >= len(tokens) or tokens[k].kind == ","


def _call(word: Word, texts: Sequence[str]) -> str:
    return f"{word.text}({', '.join(texts)})"


def _with_points(texts: Sequence[str], places: Sequence[Span], word: Word) -> list[str] | None:
    """Return the values of `1,5, 80` where two are wanted: `1.5`, `80`. None where not meant."""
    spare = len(texts) - len(word.arguments)
    if spare <= 0 or not word.arguments:
        return None
    touches = [place.end + 1 == after.start for place, after in pairwise(places)]
    some_are_loose = not all(touches)
    merged: list[str] = []
    k = 0
    while k < len(texts) and len(merged) < len(word.arguments):
        its = word.arguments[len(merged)]
        is_meant = its.unit in _HAS_DECIMALS or (its.name in ("value", "a") and (
            some_are_loose or (len(word.arguments) == 1 and word.role != "actuator")
        ))  # fmt: skip
        joins = (
            (is_meant or (some_are_loose and its.name != "n" and word.role != "actuator"))
            and spare > 0
            and k + 1 < len(texts)
            and _ends_whole(texts[k], len(word.arguments) == 1)
            and texts[k + 1].isdecimal()
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
