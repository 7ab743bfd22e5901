"""Rewrites: the rows of the tables, compiled, and what a line becomes by them.

Knows the language of the patterns, which `rows` explains. Knows no row.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, partial
from itertools import chain, product
from typing import NamedTuple

from tiniscript.base.words import BLOCK_ENDS, WORDS, lexicon_concept, lexicon_meaning
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import CODES, Code
from tiniscript.recovery import rows
from tiniscript.recovery.meanings import (
    ANY_LABELS,
    NEAR,
    SEPARATOR,
    WORD_OF_END,
    Lexeme,
    Names,
    closed,
    joined_name,
    made,
    number_text,
    texts,
)
from tiniscript.syntax.lexer import NUMBER, WORD
from tiniscript.syntax.operators import COMPARISONS, OPPOSITES

_ATOM = re.compile(r"'[^']*'|@\w+|[a-z]{2,}|[A-Z_0-9]+|\$|[^\w|'@\s$]+")
_CAPTURE = re.compile(r"([a-z])=(?=.)")
_PART_REFERENCE = re.compile(r"<(\w+)>")
_CONTINUATION = re.compile(r"\n    ")
# Where an instruction begins and ends, by the labels around it; and a line.
_EDGE_PATTERNS = {
    "^": rf"(?:\A|(?<=\x01\|{re.escape(SEPARATOR)}\|\x02)|(?<=\x01\|s[{{}}]\|\x02))",
    "$": r"(?:\Z|(?=\x01\|s[;}]\|))",
    "^^": r"\A",
    "$$": r"\Z",
}
_EDGE = re.compile(r"\\.|\[\^?\]?(?:\\.|[^]\\])*\]|[$^]")  # or what has none: `\$`, `[^;]`
_MOST_NESTED_BRACKETS = 3  # brackets in a body: `F(RANDOM(1, (X + 1)), 60)`
_NUMBER_LABEL = re.compile(r"@(?:dec|cat|own|ms|mmss|xn|same)\b|(?<![\w@])\d")
_BEFORE_VALUE = COMPARISONS | frozenset("(,+-*/%")
_HEADER_OF = {"FOREVER": "LOOP", "ELSEIF": "IF"}


class Row(NamedTuple):
    """A row of the table of tokens. `is_first`: made before anything else is tried.

    `may_lose_numbers`: it is only shown, or says itself what becomes of them.
    """

    pattern: Pattern
    replacement: tuple[str, ...]
    cost: float
    code: Code
    is_first: bool
    is_offered: bool
    may_lose_numbers: bool
    example: tuple[str, str]


class SignRow(NamedTuple):
    """A row of the table of signs: a pattern of characters, of which no token is made."""

    pattern: re.Pattern[str]
    replacement: str
    code: Code
    is_offered: bool
    example: tuple[str, str]


def cells(table: str) -> Iterator[list[str]]:
    """Give the cells of each row, which indented lines go on with; of one with choices, of each."""
    for row in _CONTINUATION.sub(" ", table.strip("\n")).split("\n"):
        if row.strip() and not row.startswith("# "):
            parts = [part.split("¦") for part in re.split("[⟨⟩]", row)]
            assert len({*map(len, parts)} - {1}) < 2, row
            for k in range(max(map(len, parts))):
                one = "".join(part[k % len(part)] for part in parts)
                yield [cell.strip() for cell in re.split(r"\s\|(?=\s|$)", one, maxsplit=5)]


@cache
def of_tokens() -> tuple[Row, ...]:
    token_rows = []
    for pattern, replacement, cost, code, how, example in cells(rows.TOKENS):
        parts = tuple(_expanded(replacement, rows.PARTS).split())
        is_offered = "offered" in how
        may_lose = is_offered or bool(_NUMBER_LABEL.search(f"{pattern} {replacement}"))
        row = Row(compiled(pattern, rows.PARTS), parts, float(cost), CODES[code], "first" in how,
                  is_offered, may_lose, _texts(example))  # fmt: skip
        token_rows.append(row)
    return tuple(token_rows)


@cache
def _index_of(is_first: bool) -> RowIndex:
    return places({k: row.pattern for k, row in enumerate(of_tokens()) if row.is_first is is_first})


def rows_to_try(line: Encoded, is_first: bool) -> Iterator[Row]:
    """Give the rows that may match a line, in the order of the table."""
    return (of_tokens()[k] for k in line.candidate_rows(_index_of(is_first)))


@cache
def of_signs() -> tuple[SignRow, ...]:
    return tuple(
        SignRow(
            re.compile(_anchored(pattern), re.I),
            replacement[1:-1],
            CODES[code],
            how == "offered",
            _texts(it),
        )
        for pattern, replacement, code, how, it in cells(rows.SIGNS)
    )


def _anchored(pattern: str) -> str:
    """Return a pattern of characters whose `^` and `$` are where an instruction begins and ends."""
    edges = {"^": r"(?:\A|(?<=[;{}])|(?<=S[IB]\|))", "$": r"(?=\s*(?:[;}]|\Z))"}
    return _EDGE.sub(lambda match: edges.get(match[0], match[0]), pattern)


def _texts(example: str) -> tuple[str, str]:
    """Return the program of an example, and what becomes of it."""
    wrong, _, right = example.replace("⏎", "\n").rpartition(" => ")
    return wrong.strip(" "), right


class Pattern(NamedTuple):
    """A row's pattern as one of labels, as `Names.label` writes them.

    No line matches that has none of each of `needed`, which is fast to see.
    """

    of_labels: re.Pattern[str]
    needed: tuple[frozenset[str], ...]


def compiled(pattern: str, pieces: Mapping[str, str]) -> Pattern:
    """Return a row's pattern, in which `pieces` stand for its `<parts>`."""
    atoms = [_atom(word) for word in _expanded(pattern, pieces).split()]
    needed = tuple(labels for _, labels in atoms if labels and not labels & {*ANY_LABELS, "s|"})
    return Pattern(re.compile("".join(text for text, _ in atoms)), needed)


def _expanded(pattern: str, pieces: Mapping[str, str]) -> str:
    """Return a pattern with its `<parts>` written out."""
    while _PART_REFERENCE.search(pattern):
        pattern = _PART_REFERENCE.sub(lambda match: pieces[match[1]], pattern)
    return pattern


def _atom(atom: str) -> tuple[str, frozenset[str]]:
    """Return the pattern of one token, and labels of which there is one, none where it may miss."""
    if atom in _EDGE_PATTERNS:
        return _EDGE_PATTERNS[atom], frozenset()
    capture = _CAPTURE.match(atom) if len(atom) > 2 else None
    name, atom = (capture[1], atom[2:]) if capture else ("", atom)
    often = ""
    if len(atom) > 1 and atom[-1] in "?*+" and (atom[-2].isalnum() or atom[-2] in "':,;()"):
        atom, often = atom[:-1], atom[-1]
    result = _ATOM.findall(atom)
    labels = [
        item if item[0] in "@_" or item[0].isalnum() else "s" + item.strip("'")
        for item in result
        if item != "$"
    ]
    if labels in (["@all"], ["@cond"]) and often:  # the brackets in it are closed in it
        inner = body = _closing_pattern(["@flat"])
        if labels == ["@cond"]:  # or stand alone
            group = rf"{_token(['s('])}{inner}*?{_token(['s)'])}"
            body = rf"(?:{group}|(?!{group}){_token(labels)})"
        body = f"(?:{body}{often}?)"
        return f"(?P<{name}>{body})" if name else body, frozenset()
    one = _token(labels)
    choices = [*([one] if labels else []), *([_EDGE_PATTERNS["$"]] if "$" in result else [])]
    body = f"(?:{'|'.join(choices)}){often}{'?' if often and often in '+*' else ''}"
    is_needed = often in ("", "+") and "$" not in result
    return f"(?P<{name}>{body})" if name else body, frozenset(labels if is_needed else ())


def _closing_pattern(labels: Sequence[str]) -> str:
    """Return the pattern of a token of these labels, or of brackets that such tokens are in."""
    body = _token(labels)
    for _ in range(_MOST_NESTED_BRACKETS):
        body = rf"(?:{_token(labels)}|{_token(['s('])}{body}*{_token(['s)'])})"
    return body


def _token(labels: Sequence[str]) -> str:
    """Return the pattern of a token that has one of these labels."""
    return rf"\x01[^\x02]*\|(?:{'|'.join(map(re.escape, labels))})\|[^\x02]*\x02"


RowIndex = Mapping[str, Sequence[int]]


def places(patterns: Mapping[int, Pattern]) -> RowIndex:
    """Return where the patterns of a table stand that only lines with a label match.

    It is the label that the fewest patterns need, "" for one that any line may match.
    """
    many = Counter(label for it in patterns.values() for label in chain(*it.needed))
    places: dict[str, list[int]] = {}
    for k, pattern in patterns.items():
        rarest = min(pattern.needed, key=lambda it: sum(many[item] for item in it), default=("",))
        for label in rarest:
            places.setdefault(label, []).append(k)
    return places


class Encoded:
    """The labels of a line as one text, and which token ends where in it."""

    def __init__(
        self, tokens: Sequence[Lexeme], names: Names, labels: Sequence[str] | None = None
    ) -> None:
        self.tokens = list(tokens)
        self.names = names
        parts = labels or [names.label(token) for token in tokens]
        self.text = "".join(parts)
        self._labels = frozenset(("", *self.text.split("|")))
        self.index = {0: 0}
        end = 0
        for k, part in enumerate(parts):
            end += len(part)
            self.index[end] = k + 1

    def matches(self, pattern: Pattern) -> Iterator[re.Match[str]]:
        for labels in pattern.needed:
            if self._labels.isdisjoint(labels):
                return iter(())
        return pattern.of_labels.finditer(self.text)

    def candidate_rows(self, table: RowIndex) -> list[int]:
        """Return where the patterns of a table stand that the line may match, in their order."""
        return sorted({k for label in self._labels & table.keys() for k in table[label]})

    def span(self, match: re.Match[str], name: str | int = 0) -> tuple[int, int]:
        """Return the tokens of a match, or of a part of it that it has captured."""
        start, end = match.span(name)
        return (self.index[start], self.index[end]) if start >= 0 else (0, 0)

    def rewritten(self, row: Row, match: re.Match[str]) -> list[Lexeme] | None:
        """Return the line after a row, or None where it does not hold here."""
        new: list[Lexeme] = []
        for part in row.replacement:
            sources = self._replacement(part, match)
            if sources is None:
                return None
            if new and sources and new[-1].source is None and sources[0].space == "":
                sources = [sources[0]._replace(space=None), *sources[1:]]
            new += sources
        new = _without_double_brackets(new)
        start, end = self.span(match)
        is_assignment = row.code is codes.OTHER_ASSIGNMENT
        if is_assignment and start and self.tokens[start - 1].text in _BEFORE_VALUE:
            return None  # in brackets it would be a condition
        if new and new[-1].text == ";" and end < len(self.tokens) and self.tokens[end].text == ";":
            new.pop()
        old = self.tokens[start:end]
        if texts(new) == texts(old):
            return None
        if not row.may_lose_numbers and _numbers(old) - _numbers(new):
            return None
        return self.tokens[:start] + new + self.tokens[end:]

    def _replacement(self, part: str, match: re.Match[str]) -> list[Lexeme] | None:
        def captured(name: str) -> list[Lexeme]:
            start, end = self.span(match, name)
            return self.tokens[start:end]

        if part[0] == "$" and len(part) == 2:
            return captured(part[1])
        if part[0] == "&" and len(part) == 2:
            return [self.translated(lexeme) for lexeme in captured(part[1])]
        if part[0] != "@":
            return [made(part.strip("'"))]
        function, *names = part[1:].split(":")
        place = _Place(self, [captured(item) for item in names], self.span(match)[0])
        return _FUNCTIONS[function](place)

    def translated(self, token: Lexeme) -> Lexeme:
        meant = self.names.meant(token.text, NEAR) if token.kind is WORD else ""
        meant = meant or "".join(lexicon_meaning(token.text, "number"))
        return made(meant) if meant not in ("", token.text) else token


def _numbers(tokens: Sequence[Lexeme]) -> Counter[str]:
    return Counter(token.text for token in tokens if token.kind is NUMBER)


class _Place(NamedTuple):
    """What a function of the table gets: the line, its captures, and where the match begins."""

    line: Encoded
    captured: list[list[Lexeme]]
    start: int


_Made = list[Lexeme] | None


def negated(condition: Sequence[Lexeme]) -> list[Lexeme]:
    """Return the condition that is TRUE where `condition` is not."""
    signs = [k for k, lexeme in enumerate(condition) if lexeme.text in COMPARISONS]
    if len(signs) == 1 and not any(lexeme.text in ("AND", "OR", "NOT") for lexeme in condition):
        k = signs[0]
        return [*condition[:k], made(OPPOSITES[condition[k].text]), *condition[k + 1 :]]
    return [made("NOT"), made("("), *condition, made(")")]


def _end_of(place: _Place) -> _Made:
    word = place.line.translated(place.captured[0][0]).text
    word = "LOOP" if lexicon_meaning(word, "count") else _HEADER_OF.get(word, word)
    end = BLOCK_ENDS.get(word, word if word in WORD_OF_END else "")
    return [made(end)] if end else None


def _decimal(place: _Place) -> _Made:
    """`1,5` is 1.5 where nobody takes it for two values."""
    (whole_part,), (comma,), (decimals,) = place.captured
    before = place.line.tokens[place.start - 1].text if place.start else ""
    longest = 3 if whole_part.text == "0" else 2 if before == "=" else 1
    is_value_list = decimals.text == "0" or (len(whole_part.text) > 1 and decimals.text != "5")
    has_space = bool(comma.space or decimals.space)
    if (
        "." in whole_part.text + decimals.text
        or is_value_list
        or len(decimals.text) > longest
        or has_space
    ):
        return None
    text = f"{whole_part.text}.{decimals.text}"
    return [whole_part._replace(text=text, source=text)]


def _zero_after(place: _Place) -> _Made:
    """`8 0` is 80."""
    (number,), (zero,) = place.captured
    is_one = zero.space == " " and "." not in number.text
    return [made(number.text + "0")] if is_one else None


def _minutes(place: _Place) -> _Made:
    """`1:30` is 90 seconds."""
    (minutes,), (seconds,) = place.captured
    text = seconds.text
    is_time = "." not in minutes.text + text and len(text) == 2 and int(text) < 60
    if not is_time or minutes.text == "0":
        return None
    return [made(str(int(minutes.text) * 60 + int(text)))]


def _times(place: _Place) -> _Made:
    """`x4` is 4, where no variable is called so."""
    word = place.captured[0][0].text
    return None if place.line.names.is_name(word) else [made(word[1:])]


def _equal_number(place: _Place) -> _Made:
    """The second of two numbers, where they are the same."""
    (one,), (two,) = place.captured
    return [two] if one.text == two.text else None


def _label(place: _Place) -> _Made:
    """A name after the end of its DEF says which one ends, where something else calls it."""
    return [] if place.captured[0][0].text in place.line.names.called else None


def _limit(is_high: bool, place: _Place) -> _Made:
    """The end of what an actuator takes."""
    (device,) = place.captured[0]
    known = place.line.names.actuators[place.line.translated(device).text]
    most = known.high if is_high else known.low
    return None if known.is_yes_no else [made(f"{most / 1000:g}")]


def _seconds(place: _Place) -> _Made:
    """So many milliseconds, in seconds."""
    (token,) = place.captured[0]
    return [made(f"{float(token.text) / 1000:g}")]


def _converted_number(place: _Place) -> _Made:
    """A number with its unit, in the unit that values have: `500 ms` is 0.5, `1 m` is 100."""
    (number,), (unit,) = place.captured
    text = lexicon_meaning(unit.text, "unit") or ("", "1000")
    return [
        number if text[1] == "1000" else made(number_text(float(number.text) * int(text[1]) / 1000))
    ]


_FUNCTIONS: dict[str, Callable[[_Place], _Made]] = {
    "not": lambda it: negated(it.captured[0]), "endof": _end_of, "dec": _decimal, "xn": _times,
    "cat": _zero_after, "mmss": _minutes, "same": _equal_number, "label": _label,
    "ms": _seconds, "own": _converted_number,
    "most": partial(_limit, True), "least": partial(_limit, False),
}  # fmt: skip


def _without_double_brackets(tokens: list[Lexeme]) -> list[Lexeme]:
    """Drop a pair of brackets of a row right around one of the text."""
    for k in range(len(tokens) - 1):
        if tokens[k].text == "(" == tokens[k + 1].text and tokens[k].source is None:
            end = closed(tokens, k + 1)
            after = tokens[end : end + 1] if end else []
            if after and after[0].text == ")" and after[0].source is None:
                return tokens[:k] + tokens[k + 1 : end] + tokens[end + 1 :]
    return tokens


def one_word(tokens: Sequence[Lexeme], names: Names) -> tuple[list[Lexeme], bool] | None:
    """Return a line in which words that are one are one: `FIN SI`, `POR SIEMPRE`, `mi vel`.

    The other value says whether that is a name of the program.
    """
    tokens = list(tokens)
    for row in names.rows:
        for k in range(len(tokens) - len(row) + 1):
            if texts(tokens[k : k + len(row)]) == row:
                name = made(joined_name(row))._replace(space=tokens[k].space)
                return [*tokens[:k], name, *tokens[k + len(row) :]], True
    for k in range(len(tokens)):
        if sided := _sensor_of_side(tokens, k, names):
            sensor, count = sided
            word = made(sensor)._replace(space=tokens[k].space)
            is_sensor_name = joined_name(texts(tokens[k : k + count])) == sensor  # `LIGHT-L`
            return [*tokens[:k], word, *tokens[k + count :]], is_sensor_name
    for k, count in product(range(len(tokens)), (3, 2)):
        row = texts(tokens[k : k + count])
        if len(row) < count or any(token.kind is not WORD for token in tokens[k : k + count]):
            continue
        text = "_".join(row)
        after = tokens[k + count].text if k + count < len(tokens) else ""
        if lexicon_concept(text) == "ELSE" and (
            lexicon_meaning(after, "is") or lexicon_meaning(after, "there")
        ):
            continue  # `si no hay pared`
        if lexicon_concept(text) == "ELSE" and after == "(" and tokens[k + count].space == "":
            continue  # `SE NÃO(DISTANCE < 10)`
        if lexicon_concept(text) or (text in WORDS and row[0] == "END"):
            meanings = names.meanings(text)  # `END IF` ends any block
            word = made(meanings[0].concept if meanings else text)._replace(space=tokens[k].space)
            return [*tokens[:k], word, *tokens[k + count :]], False
    return None


def _sensor_of_side(tokens: Sequence[Lexeme], k: int, names: Names) -> tuple[str, int] | None:
    """Return the sensor of a side from a token on, and of how many: `LIGHT L`, `luz(izquierda)`."""
    if not lexicon_meaning(tokens[k].text, "stem", "sensing") or names.is_name(tokens[k].text):
        return None
    signs = texts(tokens[k + 1 : k + 4])
    at = 1 if signs[:1] in (("(",), ("[",), ("-",), (".",)) else 0
    is_closed = signs[:1] not in (("(",), ("[",)) or signs[2:3] in ((")",), ("]",))
    name = "_".join((tokens[k].text, *signs[at : at + 1]))
    sensor = name if name in names.sensors else names.meant(name)
    count = 2 if not at else 4 if signs[0] in "([" else 3
    is_call = not at and signs[1:2] == ("(",)  # an order after it: `IF LIGHT L(1, 60)`
    is_complete = is_closed and signs[at:] and not is_call
    return (sensor, count) if is_complete and sensor in names.sensors else None
