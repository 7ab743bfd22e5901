"""The calculations of the bytecode, written from the words of `bytecode_spec.md` alone.

Values are integers that count thousandths; shares nothing with the package.
"""

from __future__ import annotations

from collections.abc import Callable

WRAP = 2**32

COMPARISONS: dict[str, Callable[[int, int], bool]] = {
    "EQ": lambda a, b: a == b,
    "NE": lambda a, b: a != b,
    "LT": lambda a, b: a < b,
    "LE": lambda a, b: a <= b,
    "GT": lambda a, b: a > b,
    "GE": lambda a, b: a >= b,
}


class Fault(Exception):
    """OVERFLOW, DIVIDE_BY_ZERO or NO_POWER."""


def divide(number: int, by: int) -> int:
    """The nearest integer to a quotient, half away from zero."""
    size = (abs(number) * 2 + abs(by)) // (2 * abs(by))
    return size if (number < 0) == (by < 0) else -size


def nearest_whole(value: int) -> int:
    """The nearest whole number."""
    return divide(value, 1000)


def result_or_fault(value: int) -> int:
    """A result, or the fault."""
    if not -(2**31) <= value < 2**31:
        raise Fault("OVERFLOW")
    return value


def nearest_in_range(value: int, low: int, high: int) -> int:
    """The nearest one in the range."""
    return min(max(value, low), high)


def print_number(value: int) -> str:
    """The shortest decimal."""
    sign, size = "-" * (value < 0), abs(value)
    return (f"{sign}{size // 1000}." + f"{size % 1000:03d}").rstrip("0").rstrip(".")


def answer(value: int) -> str:
    """Return the printed form of a yes-no value."""
    return "TRUE" if value != 0 else "FALSE"


def time8(operand: int) -> int:
    """The milliseconds of an operand: hundredths, tenths and seconds of a second."""
    if operand < 100:
        return 10 * operand
    return 1000 + 100 * (operand - 100) if operand < 200 else 11_000 + 1000 * (operand - 200)


def next_state(state: int) -> int:
    """The next state of RANDOM."""
    state ^= state << 13 & (WRAP - 1)
    state ^= state >> 17
    return state ^ (state << 5 & (WRAP - 1))


def random_between(a: int, b: int, state: int) -> int:
    """RANDOM, with a state that has been stepped."""
    low, high = sorted((nearest_whole(a), nearest_whole(b)))
    return result_or_fault(1000 * (low + state % (high - low + 1)))


def calculate(name: str, a: int, b: int = 0) -> int:
    """The rows of the table that have an `a` and perhaps a `b`."""
    if name in ("DIV", "MOD") and b == 0:
        raise Fault("DIVIDE_BY_ZERO")
    match name:
        case "ADD":
            return result_or_fault(a + b)
        case "SUB":
            return result_or_fault(a - b)
        case "MUL":
            return result_or_fault(divide(a * b, 1000))
        case "DIV":
            return result_or_fault(divide(a * 1000, b))
        case "MOD":
            return a - b * (a // b)
        case "NEG":
            return result_or_fault(-a)
        case "ABS":
            return result_or_fault(abs(a))
        case "MIN" | "MAX":
            return min(a, b) if name == "MIN" else max(a, b)
        case "ROUND":
            places = nearest_whole(b)
            unit = 10 ** min(max(3 - places, 0), 11)  # half of this is larger than any value
            return a if places >= 3 else result_or_fault(divide(a, unit) * unit)
        case "AND":
            return int(a != 0 and b != 0)
        case "OR":
            return int(a != 0 or b != 0)
        case "NOT":
            return int(a == 0)
        case _ if name in COMPARISONS:
            return int(COMPARISONS[name](a, b))
    raise AssertionError(f"the page does not say what {name} does")
