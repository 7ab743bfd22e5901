"""What the words of one program mean: those of the language, of the kit, and its own names.

Knows which names a wrong program gives to variables and DEFs, by a look at its tokens. So a word of
another language is translated only where it is no name.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise

from tiniscript.kit import Kit
from tiniscript.source import Source
from tiniscript.syntax.cursor import AT_END
from tiniscript.syntax.devices import actuator_word
from tiniscript.syntax.lexer import NUMBER, WORD, Token
from tiniscript.words import NUMBER_WORDS, WORDS, Word, meant_by

LONGEST_NAME = 4  # words of a name of a DEF
_LINES = 8  # of a name that a message lists
_FARTHEST = 2000  # tokens in which a call of it is looked for
_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


class Vocabulary:
    def __init__(self, tokens: Sequence[Token], kit: Kit | None) -> None:
        self._tokens = tokens
        self.kit = kit

    @cached_property
    def _sensors(self) -> frozenset[str]:
        return frozenset(each.name for each in self.kit.sensors) if self.kit else frozenset()

    @cached_property
    def _names(self) -> frozenset[str]:
        pairs = pairwise(self._tokens)
        found = set()
        for k, (first, name) in enumerate(pairs):
            if first.text == "DEF" and name.kind == "(":  # `DEF(DANCE)`
                found.add(self._tokens[min(k + 2, len(self._tokens) - 1)].text)
            elif first.text == "DEF":
                words = name_at(self._tokens, k + 1)
                found.add("_".join(words) or name.text)
        actuators = self.kit.actuators if self.kit else ()
        return frozenset(found | self._sensors | {each.name for each in actuators})

    @cached_property
    def _variables(self) -> frozenset[str]:
        pairs = pairwise(self._tokens)
        return frozenset(
            name.text for name, sign in pairs if name.kind is WORD and sign.kind == "="
        )

    @cached_property
    def first_set(self) -> dict[str, int]:
        """Where each variable is set first, in an instruction of its own."""
        found: dict[str, int] = {}
        for before, (name, sign) in zip(
            (None, *self._tokens), pairwise(self._tokens), strict=False
        ):
            is_first = before is None or before.kind != "="
            if is_first and name.kind is WORD and sign.kind == "=":
                found.setdefault(name.text, name.start)
        return found

    def lines_of(self, name: str, source: Source) -> str:
        """Return the lines in which a word is a variable, `1, 2, 4`; nothing for one line alone."""
        depth = 0
        found: dict[int, None] = {}
        is_value = WORDS[name].role == "value"
        for token, after in pairwise(self._tokens):
            depth = 0 if token.kind == ";" else depth + (token.kind == "(") - (token.kind == ")")
            if token.text == name and (is_value or depth > 0 or after.kind == "="):
                found[source.position(token.start)[0]] = None
            if len(found) > _LINES:
                return ""
        return ", ".join(map(str, found)) if len(found) > 1 else ""

    def add(self, name: str) -> None:
        """Know a DEF that is written without its word."""
        self.__dict__["_names"] = self._names | {name}

    def is_number(self, word: str) -> bool:
        """Whether a sensor of the kit, or what means one, gives a number."""
        name = self.value(word)
        sensors = self.kit.sensors if self.kit else ()
        return any(each.name == name and not each.is_yes_no for each in sensors)

    def is_name(self, word: str) -> bool:
        """Whether the kit or a DEF anywhere in the text has this name."""
        return word in self._names

    def is_def(self, word: str) -> bool:
        """Whether a DEF anywhere in the text has this name."""
        devices = (*self.kit.sensors, *self.kit.actuators) if self.kit else ()
        return word in self._names and all(each.name != word for each in devices)

    def is_own(self, word: str) -> bool:
        """Whether the kit or the program gives this name to something."""
        return word in self._names or word in self._variables

    def command(self, word: str) -> Word | None:
        """Return the word of the language, or the actuator, that an instruction means."""
        known = WORDS.get(word)
        if known is not None:
            return known
        for device in self.kit.actuators if self.kit else ():
            if device.name == word:
                return actuator_word(device)
        return None if self.is_own(word) else WORDS.get(meant_by(word) or "")

    def value(self, word: str) -> str:
        """Return the name of a value: `DISTANCE` for `DISTANCIA`, `TRUE` for `VERDADERO`."""
        if word.upper() in NUMBER_WORDS and not self.is_own(word.upper()):
            return NUMBER_WORDS[word.upper()]
        meant = meant_by(word.upper())
        if meant is None or word.upper() in WORDS or self.is_own(word.upper()):
            return word
        is_value = meant in WORDS and WORDS[meant].role in ("value", "function", "forever")
        return meant if is_value or meant in self._sensors else word

    def translated(self, text: str) -> str:
        """Return a piece of program with its values in the words of the language."""
        return _WORD.sub(lambda match: self.value(match[0]), text)


def name_at(tokens: Sequence[Token], start: int) -> list[str]:
    """Return the words of a DEF's name at `start`: `MY TURN`, `PASO-1`, `a b`; or of one alone.

    A number behind a space belongs to it where it is called so, too.
    """
    if tokens[start].kind is not WORD or tokens[start].text in WORDS:
        return []
    words, k = [tokens[start].text], start + 1
    while tokens[k].kind not in AT_END:
        is_hyphen = tokens[k].kind == "-"
        k += is_hyphen
        if not _is_part_of_name(tokens[k]) or len(words) == LONGEST_NAME:
            return words[:1]
        if tokens[k].kind is NUMBER and not (is_hyphen or _is_called(tokens, start, k)):
            return words[:1]
        words.append(tokens[k].text)
        k += 1
    if not _is_called(tokens, start, k - 1) and _is_called(tokens, start, start):
        return words[:1]  # `DEF JUMP my jump … JUMP`
    return words


def _is_part_of_name(token: Token) -> bool:
    known = WORDS.get(token.text)
    is_own = known is None or bool(known.is_instruction and known.arguments)
    return token.kind in (WORD, NUMBER) and is_own


def _is_called(tokens: Sequence[Token], start: int, end: int) -> bool:
    """Whether the words from `start` to `end` stand alone further down."""
    row = [token.text for token in tokens[start : end + 1]]
    count = len(row)
    return any(
        [token.text for token in tokens[k : k + count]] == row and tokens[k + count].kind in AT_END
        for k in range(end + 1, min(len(tokens) - count, end + _FARTHEST))
    )
