"""Writes random values: literals of every kind, expressions, conditions."""

from __future__ import annotations

import random
import re

from tests.oracle.words import Kit

Tokens = list[str]

VARIABLES = ("X", "Y", "Z", "COUNT", "SPEED", "D", "A1", "T_2", "NEAR", "FOUND", "I", "OLD__D_")
VALUES = ("SIZE", "POWER", "K", "ON", "HOW_OFTEN", "W1")  # names of DEF parameters
PROCEDURES = ("TURN", "LOOK", "DANCE", "SQUARE", "P1", "GO_ON", "BACK_OFF", "TELL", "Q")

TIMES = ("0", "0.02", "0.05", ".1", "0.25", "0.033", "0.5", "1", "1.5", "0.001", "2.0")
SMALL_NUMBERS = (
    "0",
    "1",
    "2",
    "3",
    "4",
    "5",
    "7",
    "10",
    "0.5",
    ".25",
    "1.5",
    "2.75",
    "0.1",
    "0.2",
    "0.3",
)
WIDE_RANGE_NUMBERS = (
    "9",
    "20",
    "50",
    "100",
    "128.5",
    "400",
    "500",
    "1000",
    "1023",
    "12.345",
    "0.001",
    "007",
)
LONG_DECIMALS = ("0.0005", "1.2345", "2.71828", "3.00049", "99.9995", "0.33333333333333")
BIG_NUMBERS = ("2147483.647", "2147483", "2000000", "1073741.824", "46340.95", "999999.999")
MIN_NUMBER = "-2147483.648"

_PLAIN = re.compile(r"-?[0-9.]+")


def is_single_number(tokens: Tokens) -> bool:
    """Return whether an argument is a single number, with or without a minus."""
    return _PLAIN.fullmatch("".join(tokens)) is not None


class ValueAuthor:
    """Writes the values of a program: numbers, yes/no values and conditions of random shape."""

    def __init__(self, rng: random.Random, kit: Kit, ways: bool = False) -> None:
        self.ways = ways
        self.rng = rng
        self.kit = kit
        self.page: list[Tokens] = []
        self.instructions_left = 0  # instructions still to write
        used_names = {device.name for device in (*kit.readings, *kit.actuators)}
        remote = [device.name for device in kit.readings[len(kit.sensors) :]]
        own_names = rng.sample(remote, min(len(remote), rng.choice((0, 0, 0, 1, 2, 4))))  # give way
        self.sensors = [device for device in kit.readings if device.name not in own_names]
        self.names = [name for name in VARIABLES if name not in used_names] + own_names[::3]
        self.free_defs = [name for name in PROCEDURES if name not in used_names] + own_names[1::3]
        self.values = [*VALUES, *own_names[2::3]]
        self.taken = used_names | set(VARIABLES) | set(PROCEDURES)
        self.variables: dict[str, bool] = {}
        self.counters: set[str] = set()
        self.defs: dict[str, tuple[int, int]] = {}  # blocks and DEFs open in it at once
        self.kinds: dict[str, tuple[bool, ...]] = {}  # the values of each: is it a yes/no value
        self.given = 0  # values of all DEFs
        self.depth = 0  # blocks open here
        self.deepest = 0
        self.called = 0
        self.loops = 0
        self.in_def = False
        self.constant = False  # expressions have only literals for leaves

    def chance(self, probability: float) -> bool:
        return self.rng.random() < probability

    def say(self, *tokens: str) -> None:
        self.page.append(list(tokens))
        self.instructions_left -= 1

    # Expressions

    def literal(self) -> Tokens:
        roll = self.rng.random()
        if roll < 0.55:
            return [self.rng.choice(SMALL_NUMBERS)]
        if roll < 0.85:
            return [self.rng.choice(WIDE_RANGE_NUMBERS)]
        if roll < 0.92:
            return [f"{self.rng.uniform(0, 200):.{self.rng.randint(1, 3)}f}"]
        if roll < 0.97:
            return [self.rng.choice(LONG_DECIMALS)]
        return [self.rng.choice(BIG_NUMBERS)] if self.chance(0.7) else [MIN_NUMBER]

    def choose_name(self, is_yes_no: bool) -> Tokens | None:
        """A variable or a sensor of the kind, if there is one."""
        variables = [name for name, kind in self.variables.items() if kind == is_yes_no]
        sensors = [sensor.name for sensor in self.sensors if sensor.is_yes_no == is_yes_no]
        names = variables if variables and (self.chance(0.5) or not sensors) else sensors
        return [self.rng.choice(names)] if names else None

    def leaf(self) -> Tokens:
        if not self.constant and self.chance(0.55):
            if self.chance(0.12):
                return ["TIME"]
            return self.choose_name(False) or self.literal()
        return self.literal()

    def number(self, size: int = 2) -> Tokens:
        roll = self.rng.random()
        if size <= 0 or roll < 0.3:
            return self.leaf()
        if roll < 0.36:
            return ["-", *self.number(size - 1)]
        if roll < 0.46:
            return ["(", *self.number(size - 1), ")"]
        if roll < 0.78:
            sign = self.rng.choice("++---**/%")
            right = self.number(size - 1)
            if sign in "/%" and self.chance(0.7):
                right = [self.rng.choice(("2", "3", "0.5", "7", "1.001", "10"))]
                right = ["-", *right] if self.chance(0.2) else right
            return [*self.number(size - 1), sign, *right]
        name = self.rng.choice(("ROUND", "ABS", "MIN", "MAX", "RANDOM"))
        first, second = self.number(size - 1), self.number(size - 1)
        if name == "ABS":
            return [name, "(", *first, ")"]
        if name == "ROUND" and self.chance(0.7):
            second = self.rng.choice((["0"], ["1"], ["2"], ["-", "1"], ["-", "2"], ["1.5"], ["3"]))
        if name == "RANDOM" and self.chance(0.6):
            first, second = ["1"], [self.rng.choice(("2", "6", "10", "0", "100.5"))]
        return [name, "(", *first, ",", *second, ")"]

    def yes_no(self, size: int = 2) -> Tokens:
        roll = self.rng.random()
        if size <= 0 or roll < 0.12:
            names = None if self.constant or self.chance(0.3) else self.choose_name(True)
            return names or [self.rng.choice(("TRUE", "FALSE"))]
        if roll < 0.2:
            return ["NOT", *self.yes_no(size - 1)]
        if roll < 0.27:
            return ["(", *self.yes_no(size - 1), ")"]
        if roll < 0.45:
            word = self.rng.choice(("AND", "OR"))
            return [*self.yes_no(size - 1), word, *self.yes_no(size - 1)]
        if roll < 0.5:
            sides = [self.yes_no(size - 1) for _ in range(2)]
            left, right = (side if len(side) == 1 else ["(", *side, ")"] for side in sides)
            return [*left, self.rng.choice(("=", "<>")), *right]
        comparator = self.rng.choice(("=", "<", ">", "<=", ">=", "<>", "<", ">"))
        return [*self.number(size - 1), comparator, *self.number(size - 1)]

    def condition(self) -> Tokens:
        """A yes/no value in parentheses."""
        self.constant = self.chance(0.06)
        tokens = self.yes_no(self.rng.choice((1, 1, 2, 2, 3)))
        self.constant = False
        return ["(", *tokens, ")"]

    def write_computed_number(self) -> Tokens:
        """A number that is not checked against a range before the program runs."""
        self.constant = self.chance(0.15)
        tokens = self.number(self.rng.choice((1, 2, 2, 3)))
        self.constant = False
        return ["(", *tokens, ")"] if is_single_number(tokens) else tokens

    def within(self, low: int, high: int) -> Tokens:
        """A lone number from low to high, or something computed."""
        if self.chance(0.3):
            return self.write_computed_number()
        value = self.rng.choice((low, high, *(self.rng.randint(low, high) for _ in range(6))))
        if self.chance(0.1) and low < value < high:
            return [*(["-"] if value < 0 else []), f"{abs(value)}.{self.rng.randint(1, 999):03}"]
        return [*(["-"] if value < 0 else []), str(abs(value))]

    def seconds(self) -> Tokens:
        """A time, mostly short."""
        roll = self.rng.random()
        if roll < 0.8:
            return [self.rng.choice(TIMES)]
        if roll < 0.88:
            return ["MIN", "(", *self.number(1), ",", self.rng.choice(TIMES), ")"]
        if roll < 0.96:
            return ["(", *self.number(1), ")", "/", "100"]
        return self.write_computed_number()
