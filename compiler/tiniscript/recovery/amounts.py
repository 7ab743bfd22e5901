"""Words that say how much and are no number: `W(mas)`, `F(2, muy rapido)`, `LOOP(varias veces)`."""

from __future__ import annotations

import re
from collections.abc import Container, Sequence

from tiniscript.base.source import Span
from tiniscript.base.words import WORDS, lexicon_meaning
from tiniscript.recovery.meanings import certain_concept, plain

_CALL_REACH = 80  # characters around a value in which its call is looked for
_CALL_START = re.compile(r"([A-Za-z]+)[ \t]*\(([^()\r\n;]*)\Z")
_CALL_END = re.compile(r"[^()\r\n;]*\)")
_COMPARED_WORD = re.compile(r"([A-Za-z_]\w*)[ \t]*(?:<>|[<>]=?|=)[ \t]*\Z")
_SAMPLES = {"n": "3", "seconds": "2", "power": "50"}
_SAMPLE_CM, _SAMPLE_NUMBER = "10", "50"  # examples of a sensor's value, and of a variable


def is_amount(*words: str) -> bool:
    return any(lexicon_meaning(plain(word), "amount") for word in words)


def amount_values(text: str, span: Span, own_names: Container[str] = ()) -> dict[str, str]:
    """Return the call around a value with numbers as values; none if there is no call.

    All its values in words get one, but for the program's `own_names` names. `DISTANCE < poco` and
    `X = mucho` are shown alone.
    """
    text_before = text[max(0, span.start - _CALL_REACH) : span.start]
    amount = text[slice(*span)]
    if match := _COMPARED_WORD.search(text_before):
        name = certain_concept(match[1].upper()) or match[1].upper()
        sample = _SAMPLE_CM if name == "DISTANCE" else _SAMPLE_NUMBER
        return {"amount": amount, "example": f"{name}{match[0][len(match[1]) :]}{sample}"}
    call_start, call_end = (
        _CALL_START.search(text_before),
        _CALL_END.match(text[span.end : span.end + _CALL_REACH]),
    )
    word = WORDS.get(call_start[1].upper()) if call_start else None
    if call_start is None or call_end is None or word is None:
        return {}
    value_index = call_start[2].count(",")
    values = f"{call_start[2]}{amount}{call_end[0][:-1]}".split(",")
    amount = values[value_index].strip()
    is_comparison = any(sign in amount for sign in "<>=")  # a part of it is not a number
    if is_comparison or not any(is_amount(*value.split()) for value in values):
        return {}
    for k, (value, argument) in enumerate(zip(values, word.arguments, strict=False)):
        words = [word for word in plain(value).split() if word not in own_names]
        powers = [
            lexicon_meaning(word, "power")[0] for word in words if lexicon_meaning(word, "power")
        ]
        if powers or is_amount(*words) or k == value_index:
            sample = (
                powers[0]
                if powers and argument.unit == "%"
                else _SAMPLES.get(argument.name, argument.sample)
            )
            sample = _own_number(words, argument.unit) or sample
            values[k] = f"{' ' * (k > 0)}{sample}"
    head = call_start[0][: len(call_start[0]) - len(call_start[2])]
    return {"amount": amount, "example": f"{head.lstrip()}{','.join(values)})"}


def _own_number(words: Sequence[str], unit: str) -> str:
    """Return the number that words for an amount say in its unit: `muy lento 5 segundos`."""
    units = {lexicon_meaning(word, "unit")[0] for word in words if lexicon_meaning(word, "unit")}
    numbers = [(lexicon_meaning(word, "number") or (word,))[0] for word in words]
    fitting_numbers = [
        number
        for number in numbers
        if number.replace(".", "", 1).isdecimal() and (units or number != "1")
    ]
    return fitting_numbers[0] if len(fitting_numbers) == 1 and units <= {unit} else ""
