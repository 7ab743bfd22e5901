"""Recovery of units, because TiniScript writes numbers without units.

Knows which unit an argument has and which one was written behind its number. A repair is offered
only if the unit can be converted: seconds cannot become degrees.
"""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.syntax.ast import Argument
from tiniscript.syntax.reporter import Reporter
from tiniscript.syntax.units import converted
from tiniscript.words import UNITS, Word
from tiniscript.words import Argument as WordArgument

_NAMES = {"s": "seconds", "cm": "centimetres", "Hz": "hertz", "%": "percent", "V": "volts"}


def fit_units(reporter: Reporter, word: Word, arguments: Sequence[Argument]) -> None:
    """Say of each unit among the arguments of `word` whether it is the one that belongs there."""
    for k, diagnostic in enumerate(reporter.diagnostics):
        if diagnostic.code is codes.UNIT:
            for argument, its in _pairs(diagnostic, word, arguments):
                if argument.span.start <= diagnostic.span.start <= argument.span.end and its.unit:
                    reporter.change(k, _fitted(diagnostic, word, its.name, its.unit))


def _pairs(
    diagnostic: Diagnostic, word: Word, arguments: Sequence[Argument]
) -> list[tuple[Argument, WordArgument]]:
    """Return what each argument is, as far as that is sure: `F(80%)` lacks its time."""
    if len(arguments) == len(word.arguments):
        return list(zip(arguments, word.arguments, strict=True))
    unit = UNITS[diagnostic.values["unit"]][0]
    fitting = [each for each in word.arguments if each.unit == unit] or list(word.arguments[:1])
    return [(argument, fitting[0]) for argument in arguments if fitting]


def _fitted(diagnostic: Diagnostic, word: Word, name: str, wanted: str) -> Diagnostic:
    unit, number = diagnostic.values["unit"], diagnostic.values["number"]
    found, _ = UNITS[unit]
    if found == wanted:
        right = converted(number, unit) if diagnostic.values["right"] else ""
        return diagnostic._replace(values={**diagnostic.values, "right": right})
    values = {
        "word": word.text,
        "name": "@" + name,
        "wanted": _named(wanted),
        "unit": "@metres" if UNITS[unit] == UNITS["METRO"] else _named(found),
        "usage": word.usage,
    }
    return Diagnostic(codes.OTHER_UNIT, diagnostic.span, values)


def _named(unit: str) -> str:
    """Return the term of a unit, as messages say it."""
    return "@" + _NAMES.get(unit, unit)
