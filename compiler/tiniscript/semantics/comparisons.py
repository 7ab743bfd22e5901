"""Knows comparisons of a sensor, and which conditions can come true after UNTIL of a move.

Going forward a distance gets smaller, going back it gets bigger.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from tiniscript.base.fixed_point import HIGHEST, as_text
from tiniscript.base.kit import NUMBER, REMOTE, Device, Kit
from tiniscript.base.words import OPPOSITE_MOVES, lexicon_concept
from tiniscript.semantics.ir import Expression, Term
from tiniscript.syntax.operators import SIGN_OF

MANY_VALUES = 100_000  # thousandths: a sensor with such a range rarely reads exactly one of them
TIME = Device("TIME", NUMBER, "s", 0, HIGHEST)
_MIRRORED = {"LT": "GT", "LE": "GE", "GT": "LT", "GE": "LE", "EQ": "EQ", "NE": "NE"}
_LESS_OPS, _MORE_OPS = ("LT", "LE"), ("GT", "GE")
# Comparisons that become true, by direction of the move.
_OUTCOMES_BY_MOVE = {"F": _LESS_OPS, "B": _MORE_OPS}


class Comparison(NamedTuple):
    """A sensor, the name of the comparator after it, and a number."""

    device: Device
    op: str
    number: int

    def __str__(self) -> str:
        return f"{self.device.name} {SIGN_OF[self.op]} {as_text(self.number)}"


def comparison_of(condition: Expression, kit: Kit) -> Comparison | None:
    """Return `DISTANCE < 10` for a condition that is just that, whichever side is first."""
    if len(condition) != 3 or condition[2].op not in _MIRRORED:
        return None
    left, right, op = condition[0], condition[1], condition[2].op
    if left.op == "NUMBER":
        left, right, op = right, left, _MIRRORED[op]
    if left.op not in ("SENSOR", "TIME") or right.op != "NUMBER":
        return None
    device = TIME if left.op == "TIME" else kit.readings[left.value]
    return Comparison(device, op, right.value)


def is_distance(device: Device) -> bool:
    return device.unit in ("cm", "mm", "m")


def looks_ahead(device: Device) -> bool:
    """Return whether a sensor measures a distance that shrinks as the robot drives forward.

    Its name says so: `DISTANCE`, `DISTANCE_FRONT`, but not `TRAVEL` or `DISTANCE_BACK`.
    """
    kind, _, suffix = device.name.partition("_")
    return is_distance(device) and kind == "DISTANCE" and not is_aside(suffix)


def is_aside(suffix: str) -> bool:
    """Return whether a word means a direction other than ahead: R, LEFT, ATRAS."""
    words = (suffix, lexicon_concept(suffix)) if suffix else ()
    return not OPPOSITE_MOVES.keys().isdisjoint({*words} - {"F", None})


def is_one_of_many(device: Device, number: int) -> bool:
    """Return whether a number is one of very many readings of a sensor, and not the last.

    A stick that nobody holds reads 0.
    """
    has_many_values = not device.is_yes_no and device.high - device.low >= MANY_VALUES
    is_at_rest = number == 0 and device in REMOTE
    return has_many_values and device.low < number < device.high and not is_at_rest


def answer_of(comparison: Comparison) -> str:
    """Return the answer that a comparison always has, as a term; nothing if it may change."""
    device, op, number = comparison
    if device.is_yes_no:
        return ""
    is_never = {
        "LT": number <= device.low,
        "LE": number < device.low,
        "GT": number >= device.high,
        "GE": number > device.high,
        "EQ": not device.low <= number <= device.high,
    }
    is_always = {
        "LT": number > device.high,
        "LE": number > device.high,
        "GT": number < device.low,
        "GE": number < device.low,
    }
    if is_never.get(op):
        return "answer_no"
    return "answer_yes" if is_always.get(op) else ""


def answer_of_both(condition: Expression, kit: Kit) -> tuple[str, str]:
    """Return the answer that `DISTANCE < 10 AND DISTANCE > 40` always has, and what was meant.

    Return two empty texts unless two comparisons of a sensor exclude each other or cover
    everything.
    """
    op = condition[-1].op if len(condition) == 8 else ""
    first_comparison, second_comparison = (comparison_of(condition[k : k + 3], kit) for k in (0, 4))
    if (
        op not in ("AND", "OR")
        or not first_comparison
        or not second_comparison
        or first_comparison.device is not second_comparison.device
    ):
        return "", ""
    upper_bound, lower_bound = (
        (first_comparison, second_comparison)
        if first_comparison.op in _LESS_OPS
        else (second_comparison, first_comparison)
    )
    if upper_bound.op not in _LESS_OPS or lower_bound.op not in _MORE_OPS:
        return "", ""
    is_exact = upper_bound.op == "LE" and lower_bound.op == "GE"
    if op == "AND":
        is_constant = upper_bound.number < lower_bound.number or (
            upper_bound.number == lower_bound.number and not is_exact
        )
        return (
            ("answer_no", f"{first_comparison} OR {second_comparison}") if is_constant else ("", "")
        )
    is_constant = lower_bound.number < upper_bound.number or (
        lower_bound.number == upper_bound.number and "E" in upper_bound.op + lower_bound.op
    )
    return (
        ("answer_yes", f"{first_comparison} AND {second_comparison}") if is_constant else ("", "")
    )


def is_usable_in_until(condition: Expression, direction: str, kit: Kit) -> bool | None:
    """Return whether a condition is one for the UNTIL of a move; None if that is not known.

    It is none where a distance changes the other way, where it asks for exactly one of very many
    numbers, and where its answer is always the same.
    """
    distances_left = sum(
        term.op == "SENSOR" and is_distance(kit.readings[term.value]) for term in condition
    )
    is_sure = all(term.op != "NOT" for term in condition)
    for comparison in comparisons_in(condition, kit):
        if answer_of(comparison) or (comparison.op == "EQ" and is_one_of_many(*comparison[::2])):
            return False
        if is_distance(comparison.device):
            distances_left -= looks_ahead(comparison.device)
            if is_sure and looks_ahead(comparison.device):
                if comparison.op not in _OUTCOMES_BY_MOVE.get(direction, (comparison.op,)):
                    return False
    return True if is_sure and (not distances_left or direction not in _OUTCOMES_BY_MOVE) else None


def asks_if_near(condition: Expression, kit: Kit) -> bool:
    """Return whether a condition contains `DISTANCE < 20` for a sensor that looks ahead."""
    return any(
        looks_ahead(comparison.device) and comparison.op in _LESS_OPS
        for comparison in comparisons_in(condition, kit)
    )


def comparisons_in(condition: Expression, kit: Kit) -> Iterator[Comparison]:
    """Yield the comparisons within a condition; a variable is taken for a number amid the range."""
    for k in range(len(condition) - 2):
        terms = condition[k : k + 3]
        middle_value = next(((device.low + device.high) // 2 for device in _devices(terms, kit)), 0)
        likely_terms = tuple(
            Term("NUMBER", middle_value) if term.op == "VARIABLE" else term for term in terms
        )
        comparison = comparison_of(likely_terms, kit)
        if comparison is not None:
            yield comparison


def _devices(terms: Expression, kit: Kit) -> Iterator[Device]:
    for term in terms:
        if term.op in ("SENSOR", "TIME"):
            yield TIME if term.op == "TIME" else kit.readings[term.value]
