"""Times as people say them: `medio segundo`, `un segundo y medio`, `1 minuto y 30 segundos`.

Knows numbers in words and units. Gives tokens in which each of these is one number and its unit.
"""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript.fixed_point import as_text
from tiniscript.syntax.lexer import NUMBER, WORD, Token
from tiniscript.syntax.units import in_thousandths
from tiniscript.words import NUMBER_WORDS, UNITS

_HALVES = frozenset(("MEDIO", "MEDIA", "HALF"))
_AND = frozenset(("Y", "AND"))
_SMALL = frozenset(("A", "AN", "OF", "UN", "UNA"))


def with_numbers(tokens: Sequence[Token]) -> list[Token]:
    """Return tokens with a number for each time that is said in words."""
    row: list[Token] = []
    k = 0
    while k < len(tokens):
        said = _time_at(tokens, k)
        if said is None:
            row.append(_as_number(tokens, k))
            k += 1
            continue
        end, thousandths = said
        first, last = tokens[k], tokens[end - 1]
        row.append(Token(NUMBER, as_text(thousandths), first.start, last.start))
        row.append(Token(WORD, "SEGUNDOS", *last.span))
        k = end
    return row


def _as_number(tokens: Sequence[Token], k: int) -> Token:
    token = tokens[k]
    if token.kind is not WORD or token.text not in NUMBER_WORDS:
        return token
    is_article = token.text in ("UN", "UNA", "ONE") and _unit(tokens, k + 1) is None
    return token if is_article else token._replace(kind=NUMBER, text=NUMBER_WORDS[token.text])


def _time_at(tokens: Sequence[Token], k: int) -> tuple[int, int] | None:
    """Return the end of a time of more than a number and its unit, and its thousandths."""
    if _text(tokens, k) in _HALVES:
        after = k + 1 + (_text(tokens, k + 1) in _SMALL)
        unit = _unit(tokens, after)
        return None if unit is None else (after + 1, unit // 2)
    number, place = _number(tokens, k), k + 1
    if number is None and _text(tokens, k) in ("SEGUNDO", "MINUTO", "SECOND", "MINUTE"):
        number, place = 1.0, k
    unit = _unit(tokens, place)
    if number is None or unit is None:
        return None
    total, end = round(number * unit), place + 1
    joint = end + (_text(tokens, end) in _AND)
    if joint > end and _text(tokens, joint) in _HALVES:
        return joint + 1, total + unit // 2
    if joint > end and _text(tokens, joint) in _SMALL and _text(tokens, joint + 1) in _HALVES:
        return joint + 2, total + unit // 2
    more, its = _number(tokens, joint), _unit(tokens, joint + 1)
    if more is not None and its is not None and its < unit:
        return joint + 2, total + round(more * its)
    return None


def _text(tokens: Sequence[Token], k: int) -> str:
    return tokens[k].text if k < len(tokens) else ""


def _number(tokens: Sequence[Token], k: int) -> float | None:
    if k >= len(tokens):
        return None
    text = NUMBER_WORDS.get(tokens[k].text, tokens[k].text)
    return float(text) if len(text) < 9 and text.replace(".", "", 1).isdecimal() else None


def _unit(tokens: Sequence[Token], k: int) -> int | None:
    """Return how many thousandths of a second the unit at `k` has."""
    text = _text(tokens, k)
    if text not in UNITS or UNITS[text][0] != "s":
        return None
    return in_thousandths("1", text)
