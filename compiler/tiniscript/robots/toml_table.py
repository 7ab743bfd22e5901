"""Reads the keys of a TOML table one by one and collects every complaint.

Knows TOML's types and the precision of numbers. Does not know the keys of a profile: `reader` and
`board_reader` ask for them. A missing or wrong key adds a complaint and gives a placeholder, so
that reading continues; `root_of` refuses the file at the end.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager

from tiniscript.base.fixed_point import HIGHEST, LOWEST, as_text, read_literal
from tiniscript.base.spelling import nearest
from tiniscript.robots.profile import ProfileRefused, Reason
from tiniscript.robots.refusals import printable_value


class DecimalText(str):
    """A decimal as written in the file: a float would not keep it exactly."""


def parse_toml(text: str) -> dict[str, object] | Reason:
    """Return the keys of a TOML text, with decimals as Written, or the reason it is not TOML."""
    if sys.version_info >= (3, 11):
        import tomllib
    else:
        import tomli as tomllib

    try:
        return tomllib.loads(text, parse_float=DecimalText)
    except (ValueError, RecursionError) as error:  # ValueError: also for a very long integer
        message = str(error)
        line = message.rpartition("at line ")[2].partition(",")[0]
        line_number = line if line.isdigit() else str(text.count("\n") + 1)
        is_twice = message.startswith(("Cannot ", "Duplicate "))
        return "key_twice" if is_twice else "not_toml", {"line": line_number}


@contextmanager
def root_of(text: str, refusal_type: type[ProfileRefused]) -> Iterator[Table]:
    """Yield the table of a whole file. Raises `refusal_type` with all complaints."""
    parsed_fields = parse_toml(text)
    if isinstance(parsed_fields, tuple):
        raise refusal_type(parsed_fields)
    root = Table(parsed_fields, "", [])
    yield root
    root.finish()
    if root.reasons:
        raise refusal_type(*root.reasons)


class Table:
    """A table of a TOML file at `path`. `finish` complains about keys that were never read."""

    def __init__(self, values: Mapping[str, object], path: str, reasons: list[Reason]) -> None:
        self.path = path
        self.reasons = reasons
        self._values = values
        self._known_keys: list[str] = []

    def path_of(self, key: str) -> str:
        """Return the path of a key in the file, such as `board.motors`."""
        return f"{self.path}.{printable_value(key)}" if self.path else printable_value(key)

    def complain(self, code: str, key: str, **values: str) -> None:
        self.reasons.append((code, {"path": self.path_of(key), **values}))

    def check_for(self, key: str) -> bool:
        """Return whether a key is present, and count it as known."""
        self._known_keys.append(key)
        return key in self._values

    def set_value(self, key: str, value: object) -> None:
        """Replace the value at `key`, whatever is written there."""
        self._values = {**self._values, key: value}

    def key_names(self) -> Iterable[str]:
        return self._values.keys()

    def get(self, key: str, example: str) -> object:
        """Return the value at `key`. If it is missing, complain and suggest `example`, if any."""
        if self.check_for(key):
            return self._values[key]
        if example:
            self.complain("missing", key, example=example)
        return None

    def text(self, key: str, example: str = "") -> str | None:
        value = self.get(key, example)
        if type(value) is str:
            return value
        self.expect("text", key, value)
        return None

    def label(self, key: str, most_characters: int, example: str = "") -> str | None:
        """Return a text for people, at most `most_characters` characters long."""
        value = self.text(key, example)
        if value is not None and not (
            value.strip() and len(value) <= most_characters and value.isprintable()
        ):
            self.complain("label_bad", key, most=str(most_characters))
        return value

    def choice(self, key: str, choices: Sequence[str], code: str = "not_one_of") -> str:
        """Return one of `choices`, or an empty text."""
        value = self.text(key, f'{key} = "{choices[0]}"')
        if value is None or value in choices:
            return value or ""
        self.complain(code, key, found=printable_value(value), choices=", ".join(choices))
        return ""

    def yes_no(self, key: str, default: bool) -> bool:
        value = self.get(key, "")
        if isinstance(value, bool):
            return value
        self.expect("yes_no", key, value)
        return default

    def whole_number(
        self, key: str, low: int, high: int, example: str = "", default: int = 0
    ) -> int:
        """Return a whole number (not thousandths) from `low` to `high`."""
        value = self.get(key, example)
        if type(value) is not int:
            self.expect("whole", key, value)
        elif low <= value <= high:
            return value
        else:
            self.complain(
                "out_of_range", key, found=printable_value(value), low=str(low), high=str(high)
            )
        return default

    def number(self, key: str, low: int, high: int, example: str = "", default: int = 0) -> int:
        """Return thousandths from `low` to `high`."""
        value = self.get(key, example)
        if value is None:
            return default
        return self._thousandths(key, value, low, high)

    def pair(self, key: str, example: str) -> tuple[int, int]:
        """Return the thousandths of `[low, high]`."""
        value = self.get(key, example)
        if not isinstance(value, list) or len(value) != 2:
            self.expect("pair", key, value)
            return 0, 0
        first, second = (self._thousandths(key, number, LOWEST, HIGHEST) for number in value)
        return first, second

    def pairs(self, key: str, low: int, high: int, example: str) -> list[tuple[int, int]] | None:
        """Return the thousandths of `[[x, y], ...]`, each from `low` to `high`; None: no list."""
        value = self.get(key, example)
        if not isinstance(value, list) or not all(
            isinstance(pair, list) and len(pair) == 2 for pair in value
        ):
            self.expect("pairs", key, value)
            return None
        pairs = []
        for number, (x, y) in enumerate(value, start=1):
            path = f"{key}[{number}]"
            x_value = self._thousandths(path, x, low, high)
            pairs.append((x_value, self._thousandths(path, y, low, high)))
        return pairs

    def table(self, key: str, example: str = "") -> Table:
        """Return the table at `key`. A missing key or another type gives an empty table.

        If a required table is missing, its missing keys add no further complaints.
        """
        value = self.get(key, example)
        if isinstance(value, dict):
            return Table(value, self.path_of(key), self.reasons)
        self.expect("table", key, value)
        is_expected = bool(example) or value is not None
        return Table({}, self.path_of(key), [] if is_expected else self.reasons)

    def tables(self, key: str) -> list[Table]:
        """Return the tables at `[[key]]`; their paths count from 1."""
        value = self.get(key, "")
        if value is None:
            return []
        if not isinstance(value, list):
            self.expect("tables", key, value)
            return []
        tables = []
        for number, entry in enumerate(value, start=1):
            path = f"{key}[{number}]"
            if isinstance(entry, dict):
                tables.append(Table(entry, self.path_of(path), self.reasons))
            else:
                self.expect("table", path, entry)
        return tables

    def expect(self, expected_type: str, key: str, value: object) -> None:
        """Complain that `value` has the wrong type; a missing value has its own complaint."""
        if value is not None:
            self.complain("wrong_type", key, wanted=expected_type, found=_type_of(value))

    def complain_not_in_kit(self, key: str, known_names: Sequence[str]) -> None:
        suggestion = nearest(key.upper(), list(known_names)) or ""
        self.complain("not_in_kit", key, name=printable_value(key), near=suggestion)

    def finish(self) -> None:
        """Complain about every key that was never read."""
        for key in self._values:
            if key not in self._known_keys:
                suggestion = nearest(key, self._known_keys) or ""
                self.complain(
                    "unknown_key", key, near=suggestion, known=", ".join(self._known_keys)
                )

    def _thousandths(self, key: str, value: object, low: int, high: int) -> int:
        if isinstance(value, DecimalText):
            digits = value.lstrip("+-").replace("_", "")
            if not digits.replace(".", "").isdigit():  # 1e3, inf, nan
                self.complain("number_odd", key, found=printable_value(value))
                return 0
            number, is_exact = read_literal(digits)
            if value.startswith("-"):
                number = -number
            if not is_exact:
                self.complain("too_precise", key, found=printable_value(value))
                return 0
        elif type(value) is int:
            number = value * 1000
        else:
            self.expect("number", key, value)
            return 0
        if not low <= number <= high:
            limits = {"low": as_text(low), "high": as_text(high)}
            self.complain("out_of_range", key, found=printable_value(value), **limits)
            return 0
        return number


def _type_of(value: object) -> str:
    if isinstance(value, DecimalText):
        return "decimal"
    names = {str: "text", bool: "yes_no", int: "number", list: "list", dict: "table"}
    return names.get(type(value), "date")
