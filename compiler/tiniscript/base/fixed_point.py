"""The numbers of TiniScript: signed 32-bit counts of thousandths.

Knows arithmetic, its rounding and its faults. It knows nothing of programs. The machine and the
optimiser both calculate with these functions, so that folding cannot change a result. Every
argument and result is a count of thousandths unless a name says otherwise.
"""

from __future__ import annotations

ONE = 1000
LOWEST = -(2**31)
HIGHEST = 2**31 - 1


class Fault(Exception):
    """A calculation that has no result; its `name` is in the fault table of `bytecode`."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.name = name


def in_range(value: int) -> int:
    """Return `value`, or raise the fault OVERFLOW where 32 bits do not hold it."""
    if LOWEST <= value <= HIGHEST:
        return value
    raise Fault("OVERFLOW")


def rounded_quotient(numerator: int, denominator: int) -> int:
    """Return the quotient of two integers rounded half away from zero."""
    if denominator < 0:
        numerator, denominator = -numerator, -denominator
    if numerator < 0:
        return -((denominator - 2 * numerator) // (2 * denominator))
    return (2 * numerator + denominator) // (2 * denominator)


def add(a: int, b: int) -> int:
    return in_range(a + b)


def subtract(a: int, b: int) -> int:
    return in_range(a - b)


def multiply(a: int, b: int) -> int:
    return in_range(round_to_whole(a * b))  # thousandths times thousandths are millionths


def divide(a: int, b: int) -> int:
    if b == 0:
        raise Fault("DIVIDE_BY_ZERO")
    return in_range(rounded_quotient(a * ONE, b))


def modulo(a: int, b: int) -> int:
    """Return the exact remainder; it takes the sign of `b`."""
    if b == 0:
        raise Fault("DIVIDE_BY_ZERO")
    return a % b


def negate(a: int) -> int:
    return in_range(-a)


def absolute(a: int) -> int:
    return in_range(abs(a))


def round_to_whole(a: int) -> int:
    """Return the nearest whole number (not thousandths), half away from zero. It never faults."""
    return (a + 500) // ONE if a >= 0 else -((500 - a) // ONE)


def round_to(a: int, decimal_count: int) -> int:
    """ROUND(a, decimals): their count is rounded to a whole number first; 3 or more keep `a`."""
    decimals = round_to_whole(decimal_count)
    if decimals >= 3:
        return a
    if decimals < -6:  # half of 10**7 is more than any number
        return 0
    unit: int = 10 ** (3 - decimals)
    return in_range(rounded_quotient(a, unit) * unit)


def clamp(value: int, low: int, high: int) -> int:
    """Return the number nearest to `value` from `low` to `high`."""
    return low if value < low else high if value > high else value


def read_literal(text: str) -> tuple[int, bool]:
    """Return the thousandths of `5`, `0.5` or `.5`, and whether they are exact.

    The result is not limited to 32 bits: the parser decides whether a minus belongs to it. More
    than ten digits before the point are far out of range, whatever their values.
    """
    digits, _, decimals = text.partition(".")
    digits = digits.lstrip("0")
    value = int(digits[:11] or "0") * ONE + int((decimals + "000")[:3])
    extra_digits = decimals[3:]
    if extra_digits and extra_digits[0] >= "5":
        value += 1
    return value, not extra_digits.strip("0")


def as_text(value: int) -> str:
    """Return the shortest decimal: `12.5`, `-0.001`, `7`."""
    sign = "-" if value < 0 else ""
    units, fraction = divmod(abs(value), ONE)
    return f"{sign}{units}.{fraction:03d}".rstrip("0") if fraction else f"{sign}{units}"


def value_text(value: int, is_yes_no: bool) -> str:
    """Return a value as a run prints it, and as a program may have it."""
    return ("TRUE" if value else "FALSE") if is_yes_no else as_text(value)


def value_of(value: int, is_yes_no: bool) -> float | bool:
    """Return thousandths as a Python value: a bool, an int if it is whole, or a float."""
    if is_yes_no:
        return bool(value)
    return value // ONE if value % ONE == 0 else value / ONE


# xorshift32, shifts 13, 17, 5 (Marsaglia 2003): the state is never 0.
def next_random(state: int) -> int:
    state ^= state << 13 & 0xFFFFFFFF
    state ^= state >> 17
    return state ^ (state << 5 & 0xFFFFFFFF)


def random_between(low: int, high: int, state: int) -> int:
    """Return a whole number from `low` to `high`, for a `state` that has just been stepped."""
    lowest, highest = sorted((round_to_whole(low), round_to_whole(high)))
    return in_range((lowest + state % (highest - lowest + 1)) * ONE)
