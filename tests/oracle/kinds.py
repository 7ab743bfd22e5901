"""Finds the kind of each value of a DEF from its first call, by looking at the tokens."""

from __future__ import annotations

from typing import NamedTuple

from tests.oracle.lexer import Token
from tests.oracle.words import COMPARATORS

_YES_NO = {*COMPARATORS, "AND", "OR", "NOT", "TRUE", "FALSE"}


class Def(NamedTuple):
    """The name of a DEF, and the names in its brackets."""

    name: str
    values: tuple[str, ...]


NOWHERE = Def("", ())


class Text:
    """The tokens of a program, and the DEF of each."""

    def __init__(self, tokens: list[Token], yes_no_sensors: set[str]) -> None:
        self.tokens = tokens
        self.sensors = yes_no_sensors
        self.around: list[Def] = []
        self.defs: dict[str, Def] = {}
        current_def = NOWHERE
        for index, token in enumerate(tokens):
            if token.text == "DEF" and index + 1 < len(tokens):
                current_def = Def(tokens[index + 1].text, self.names_after(index + 2))
                self.defs.setdefault(current_def.name, current_def)
            self.around.append(current_def)
            if token.text in ("END_DEF", "ENDDEF"):
                current_def = NOWHERE

    def names_after(self, index: int) -> tuple[str, ...]:
        """The names in the brackets that begin here, none if there are none."""
        names = []
        rest = self.tokens[index:]  # nothing, if the text ends at DEF
        if rest and rest[0].text == "(":
            for token in rest:
                if token.text in (")", "") or token.kind == "newline":
                    break
                if token.kind == "word":
                    names.append(token.text)
        return tuple(names)

    def begins(self, index: int) -> bool:
        """Return whether an instruction begins with this token."""
        return (
            index == 0
            or self.tokens[index - 1].kind == "newline"
            or self.tokens[index - 1].text in ";|"
        )

    def gives_way(self, name: str) -> bool:
        """Return whether a word of the remote control is a name of the program, by its first
        place.
        """
        index = next((k for k, token in enumerate(self.tokens) if token.text == name), None)
        if index is None:
            return False
        if self.tokens[index - 1].text == "DEF" and index > 0:
            return True
        if name in self.around[index].values:  # the name is in the brackets before the body
            return True
        is_set = self.begins(index) and self.tokens[index + 1].text == "="
        value = self.tokens[index + 2 : self.end(index + 2)] if is_set else []
        return is_set and all(token.text != name for token in value)

    def assigned_outside(self, name: str) -> bool:
        """Return whether a variable of the whole program has this name."""
        return any(
            token.text == name and self.tokens[index + 1].text == "=" and self.begins(index)
            and name not in self.around[index].values
            for index, token in enumerate(self.tokens[:-1])
        )  # fmt: skip

    def is_yes_no(self, name: str, around: Def, names: tuple[tuple[str, str], ...] = ()) -> bool:
        """Return whether a name is a yes-no value inside this DEF."""
        is_local = name in around.values
        key = (name, around.name if is_local else "")
        if key in names:
            return False
        for index, token in enumerate(self.tokens[:-1]):
            if not self.begins(index):
                continue
            text_after = self.tokens[index + 1].text
            if is_local and token.text == around.name and text_after == "(":
                places = self.arguments(index + 1)
                k = around.values.index(name)
                return k < len(places) and self.answers(*places[k], (*names, key))
            is_set = token.text == name and text_after == "="
            if not is_local and is_set and name not in self.around[index].values:
                return self.answers(index + 2, self.end(index + 2), (*names, key))
        return name in self.sensors

    def answers(self, start: int, end: int, names: tuple[tuple[str, str], ...]) -> bool:
        """Return whether the expression from `start` to `end` is a yes-no value."""
        depth = 0
        while (
            end - start > 2
            and self.tokens[start].text == "("
            and self.closing_index(start) == end - 1
        ):
            start, end = start + 1, end - 1
        for index in range(start, end):
            text = self.tokens[index].text
            depth += {"(": 1, ")": -1}.get(text, 0)
            if depth == 0 and text in _YES_NO:
                return True
        is_name = end - start == 1 and self.tokens[start].kind == "word"
        return is_name and self.is_yes_no(self.tokens[start].text, self.around[start], names)

    def closing_index(self, index: int) -> int:
        """Return the index of the closing bracket."""
        depth = 0
        for place in range(index, len(self.tokens)):
            depth += {"(": 1, ")": -1}.get(self.tokens[place].text, 0)
            if depth == 0:
                return place
        return len(self.tokens) - 1

    def end(self, index: int) -> int:
        """Return the end of the instruction around this token."""
        while self.tokens[index].kind not in ("newline", "end") and self.tokens[index].text != ";":
            index += 1
        return index

    def arguments(self, index: int) -> list[tuple[int, int]]:
        """Return the ranges of the values in the brackets that begin here."""
        end, spans, depth = self.closing_index(index), [], 0
        start = index + 1
        for place in range(index + 1, end):
            text = self.tokens[place].text
            depth += {"(": 1, ")": -1}.get(text, 0)
            if text == "," and depth == 0:
                spans.append((start, place))
                start = place + 1
        return [*spans, (start, end)] if start < end else spans
