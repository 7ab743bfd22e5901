"""Words that say how much and are no number: `W(mas)`, `F(2, muy rapido)`, `LOOP(varias veces)`."""

from __future__ import annotations

import re

from tiniscript.source import Span
from tiniscript.syntax.near import ASKING
from tiniscript.words import AMOUNT_WORDS, POWER_WORDS, WORDS, meant_by

_NEAR = 80  # characters around a value in which its call is looked for
_BEFORE = re.compile(r"([A-Za-z]+)[ \t]*\(([^()\r\n;]*)\Z")
_AFTER = re.compile(r"[^()\r\n;]*\)")
_ASKED = re.compile(r"[ \t]*(\w+)[ \t]*(<=?|>=?)[ \t]*")  # up to what it is compared with
_SAMPLES = {"n": "3", "seconds": "2", "power": "50"}


def is_amount(*words: str) -> bool:
    return any(each in AMOUNT_WORDS for each in words)


def with_number(text: str, span: Span) -> dict[str, str]:
    """Return how the call around a value is written with a number, nothing where there is none."""
    before = _BEFORE.search(text[max(0, span.start - _NEAR) : span.start])
    after = _AFTER.match(text[span.end : span.end + _NEAR])
    word = WORDS.get(before[1].upper()) if before else None
    if before is None or after is None or word is None:
        return {}
    asked = _ASKED.fullmatch(before[2])
    if word.text in ASKING and asked is not None and after[0] == ")":
        sensor = meant_by(asked[1].upper()) or asked[1].upper()
        sample = "20" if sensor == "DISTANCE" else "500"
        example = f"{word.text}({sensor} {asked[2]} {sample})"
        return {"amount": text[slice(*span)], "example": example}
    place = before[2].count(",")
    if place >= len(word.arguments) or not (word.is_call or word.text == "LOOP"):
        return {}
    its = word.arguments[place]
    amount = text[slice(*span)]
    said = [POWER_WORDS[each] for each in amount.upper().split() if each in POWER_WORDS]
    sample = said[0] if said and its.unit == "%" else _SAMPLES.get(its.name, its.sample)
    return {"amount": amount, "example": f"{before[0].lstrip()}{sample}{after[0]}"}
