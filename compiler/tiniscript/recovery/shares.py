"""Shares of a sensor's range, `LIGHT_L > 80%`: each sensor has its own maximum.

The number that the share is and the number without its sign are both shown, and neither is applied.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import accumulate

from tiniscript.base.fixed_point import ONE
from tiniscript.base.kit import Device, Kit
from tiniscript.base.source import Edit, Source, Span
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.recovery.meanings import (
    NEAR_COST,
    Lexeme,
    Names,
    lexemes,
    lexicon_meaning,
    number_text,
)
from tiniscript.recovery.trailing_tokens import token_width
from tiniscript.recovery.worded import sensors_of
from tiniscript.recovery.writing import split_note
from tiniscript.syntax.lexer import NUMBER, WORD
from tiniscript.syntax.operators import COMPARISONS

_HUNDRED_PERCENT = 100
_COMPARING_KINDS = ("less", "more", "than", "is", "equal", "to", "extra", "or", "one")


def find_shares(source: Source, kit: Kit) -> tuple[list[Diagnostic], list[Edit]]:
    """Return the diagnostics for sensors compared with a percentage.

    The rest is read with the shares.
    """
    bodies = [split_note(line)[0] for line in source.text.split("\n")]
    names = Names([lexemes(body) for body in bodies], kit)
    findings: list[tuple[Diagnostic, Edit]] = []
    line_start = 0
    for body, line in zip(bodies, source.text.split("\n"), strict=True):
        findings += _shares_of(body, line_start, names)
        line_start += len(line) + 1
    return [diagnostic for diagnostic, _ in findings], [edit for _, edit in findings]


def _shares_of(body: str, line_start: int, names: Names) -> Iterator[tuple[Diagnostic, Edit]]:
    tokens = lexemes(body)
    ends = [*accumulate(map(token_width, tokens))]
    for k, token in enumerate(tokens):
        percent_count = _percent_token_count(tokens, k + 1, names) if token.kind is NUMBER else 0
        sensor_index = (
            _compared_index(tokens, k)
            if percent_count and float(token.text) <= _HUNDRED_PERCENT
            else -1
        )
        side = (
            "".join(lexicon_meaning(tokens[sensor_index].text, "left", "right"))
            if sensor_index > 0
            else ""
        )
        sensor_index -= bool(side)  # `luz izquierda`
        sensor_word = "_".join((tokens[sensor_index].text, *([side[0].upper()] if side else [])))
        sensor = _sensor(sensor_word, names) if sensor_index >= 0 else None
        if sensor is None or sensor.low:
            continue
        start, end = ends[k] - len(token.source or ""), ends[k + percent_count]
        name_start = ends[sensor_index] - len(tokens[sensor_index].source or "")
        comparison = (
            body[name_start:start] if tokens[sensor_index].text in names.number_readings else ""
        )
        share = number_text(round(sensor.high * float(token.text) / _HUNDRED_PERCENT, -3) / ONE)
        values = {
            "sensor": body[name_start : ends[sensor_index]],
            "low": "0",
            "high": f"{sensor.high / ONE:g}",
            "found": body[start:end],
            "number": token.text,
            "share": comparison + share,
            "kept": comparison + token.text,
        }
        span = Span(line_start + start, line_start + end)
        yield Diagnostic(codes.UNIT, span, values), Edit(span, share)


def _percent_token_count(tokens: Sequence[Lexeme], k: int, names: Names) -> int:
    """Return the number of tokens that mean percent, or 0 for a remainder such as `7 % 2`."""
    text, next_text = (tokens[n].text if n < len(tokens) else "" for n in (k, k + 1))
    if lexicon_meaning(text, "by") and lexicon_meaning(next_text, "number") == ("100",):
        return 2
    if text != "%":
        return int(lexicon_meaning(text, "unit")[:1] == ("%",))
    is_value = next_text[:1].isdigit() or next_text in ("(", "-") or names.is_name(next_text)
    return int(not is_value)


def _compared_index(tokens: Sequence[Lexeme], k: int) -> int:
    """Return the place of the word that is compared with the number at a place, or -1."""
    index = k - 1
    while index >= 0 and (
        tokens[index].text in COMPARISONS or lexicon_meaning(tokens[index].text, *_COMPARING_KINDS)
    ):
        index -= 1
    return index if index < k - 1 and tokens[index].kind is WORD else -1


def _sensor(word: str, names: Names) -> Device | None:
    """Return the sensor that a word names, or one of those that it may mean."""
    candidates = [word, names.find_meaning(word, NEAR_COST)]
    candidates += sensors_of(word, names) if lexicon_meaning(word, "stem", "ahead") else []
    return next(
        (names.number_readings[name] for name in candidates if name in names.number_readings), None
    )
