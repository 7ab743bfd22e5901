"""Arithmetic, against the decimal module of the standard library."""

from __future__ import annotations

import random
from collections.abc import Callable
from decimal import ROUND_HALF_UP, Context, Decimal

import pytest

from tiniscript.base import fixed_point as t
from tiniscript.base.fixed_point import HIGHEST, LOWEST, Fault

EXACT_CONTEXT = Context(prec=60, rounding=ROUND_HALF_UP)  # half away from zero
MILLI = Decimal("0.001")


def units(value: int) -> Decimal:
    return Decimal(value).scaleb(-3, EXACT_CONTEXT)


def milli(value: Decimal) -> int:
    """Return a result rounded to thousandths, or the fault if it does not fit."""
    result = int(value.quantize(MILLI, context=EXACT_CONTEXT).scaleb(3, EXACT_CONTEXT))
    if not LOWEST <= result <= HIGHEST:
        raise Fault("OVERFLOW")
    return result


def remainder(a: Decimal, b: Decimal) -> Decimal:
    """Return a - b * floor(a / b)."""
    rest = EXACT_CONTEXT.remainder(a, b)  # has the sign of a
    return rest + b if rest and (rest < 0) != (b < 0) else rest


def round_decimal(a: Decimal, places: Decimal) -> Decimal:
    decimals = int(places.quantize(Decimal(1), context=EXACT_CONTEXT))
    if decimals >= 3:
        return a
    return a.quantize(Decimal(1).scaleb(-max(decimals, -20)), context=EXACT_CONTEXT)


def check_divisor(
    operation: Callable[[Decimal, Decimal], Decimal],
) -> Callable[[Decimal, Decimal], Decimal]:
    def operate(a: Decimal, b: Decimal) -> Decimal:
        if b == 0:
            raise Fault("DIVIDE_BY_ZERO")
        return operation(a, b)

    return operate


OPERATIONS: dict[str, tuple[Callable[[int, int], int], Callable[[Decimal, Decimal], Decimal]]] = {
    "+": (t.add, EXACT_CONTEXT.add),
    "-": (t.subtract, EXACT_CONTEXT.subtract),
    "*": (t.multiply, EXACT_CONTEXT.multiply),
    "/": (t.divide, check_divisor(EXACT_CONTEXT.divide)),
    "%": (t.modulo, check_divisor(remainder)),
    "ROUND": (t.round_to, round_decimal),
}

EDGES = (LOWEST, LOWEST + 1, -(2**31 // 1000), -1_000_000, -1001, -1000, -999, -501, -500, -499, -2,
         -1, 0, 1, 2, 499, 500, 501, 999, 1000, 1001, 1999, 2000, 46_340, 46_341, 1_465_331,
         1_000_000, HIGHEST - 1, HIGHEST)  # fmt: skip


def outcome(function: Callable[[], int]) -> int | str:
    try:
        return function()
    except Fault as fault:
        return fault.name


@pytest.mark.parametrize("name", OPERATIONS)
def test_agrees_with_decimal(name: str) -> None:
    """All pairs of edges, and 20,000 random pairs of every size: more than 10^5 in all."""
    operation, decimal_operation = OPERATIONS[name]
    rng = random.Random(f"arithmetic {name}")
    pairs = [(a, b) for a in EDGES for b in EDGES]
    for _ in range(20_000):
        a, b = (rng.randint(-(2**bits), 2**bits - 1) for bits in rng.choices(range(1, 32), k=2))
        pairs.append((a, rng.randrange(-12_000, 12_000) if name == "ROUND" else b))
    for a, b in pairs:
        expected = outcome(lambda a=a, b=b: milli(decimal_operation(units(a), units(b))))  # type: ignore[misc]
        assert outcome(lambda a=a, b=b: operation(a, b)) == expected, (a, name, b)  # type: ignore[misc]


@pytest.mark.parametrize("value", EDGES)
def test_unary_operations_agree(value: int) -> None:
    assert outcome(lambda: t.negate(value)) == outcome(lambda: milli(-units(value)))
    assert outcome(lambda: t.absolute(value)) == outcome(lambda: milli(abs(units(value))))
    assert t.round_to_whole(value) == int(units(value).quantize(Decimal(1), context=EXACT_CONTEXT))


def test_text_and_literals_agree_with_decimal() -> None:
    rng = random.Random("literals")
    for value in [*EDGES, *(rng.randint(LOWEST, HIGHEST) for _ in range(5000))]:
        text = t.as_text(value)
        assert Decimal(text) == units(value)
        assert not ("." in text and text.endswith("0"))
        literal, exact = t.read_literal(text.removeprefix("-"))
        assert (literal, exact) == (abs(value), True)
    for _ in range(5000):
        text = (
            f"{rng.randint(0, 10 ** rng.randint(0, 9))}.{rng.randint(0, 10 ** rng.randint(1, 9))}"
        )
        literal, exact = t.read_literal(text)
        rounded_text = Decimal(text).quantize(MILLI, context=EXACT_CONTEXT)
        assert literal == int(rounded_text.scaleb(3, EXACT_CONTEXT))
        assert exact == (rounded_text == Decimal(text))


def test_enormous_literals_are_out_of_range() -> None:
    assert t.read_literal("9" * 100_000)[0] > HIGHEST
    assert t.read_literal("0" * 100_000 + "7") == (7000, True)
    assert t.read_literal("." + "0" * 100_000 + "7") == (0, False)


def test_random_is_xorshift32() -> None:
    """The state after 1 is in Marsaglia's recurrence: 13 left, 17 right, 5 left."""
    state = 1
    for _ in range(1000):
        expected = state
        expected = (expected ^ expected << 13) % 2**32
        expected ^= expected >> 17
        expected = (expected ^ expected << 5) % 2**32
        state = t.next_random(state)
        assert state == expected != 0
    assert t.next_random(1) == 270369


def test_random_reaches_both_ends_and_nothing_else() -> None:
    state, values = 1, set()
    for _ in range(1000):
        state = t.next_random(state)
        values.add(t.random_between(6400, 600, state))
    assert values == {1000 * n for n in range(1, 7)}
    assert outcome(lambda: t.random_between(HIGHEST, HIGHEST, 1)) == "OVERFLOW"
    assert outcome(lambda: t.random_between(LOWEST, LOWEST, 1)) == "OVERFLOW"
