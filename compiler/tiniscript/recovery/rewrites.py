"""Rewrites: the rows of the tables, compiled, and the lines that result.

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
    NEAR_COST,
    SEPARATOR_LABELS,
    WILDCARD_LABELS,
    Lexeme,
    Names,
    brackets_end,
    joined_name,
    make_token,
    number_text,
    texts,
)
from tiniscript.syntax.blocks import WORD_OF_END
from tiniscript.syntax.lexer import NUMBER, WORD
from tiniscript.syntax.operators import COMPARISONS, OPPOSITES

_ATOM = re.compile(r"'[^']*'|@\w+|[a-z]{2,}|[A-Z_0-9]+|\$|[^\w|'@\s$]+")
_CAPTURE = re.compile(r"([a-z])=(?=.)")
_PART_REFERENCE = re.compile(r"<(\w+)>")
_CONTINUATION = re.compile(r"\n    ")
# Where an instruction begins and ends, including the labels around it, and its line.
_EDGE_PATTERNS = {
    "^": rf"(?:\A|(?<=\x01\|{re.escape(SEPARATOR_LABELS)}\|\x02)|(?<=\x01\|s[{{}}]\|\x02))",
    "$": r"(?:\Z|(?=\x01\|s[;}]\|))",
    "^^": r"\A",
    "$$": r"\Z",
}
# A part of a pattern without a word edge: `\$`, `[^;]`.
_EDGE = re.compile(r"\\.|\[\^?\]?(?:\\.|[^]\\])*\]|[$^]")
_MAX_BRACKET_DEPTH = 3  # brackets in a body: `F(RANDOM(1, (X + 1)), 60)`
_NUMBER_LABEL = re.compile(r"@(?:dec|cat|own|ms|mmss|xn|same)\b|(?<![\w@])\d")
_BEFORE_VALUE = COMPARISONS | frozenset("(,+-*/%")
_HEADER_OF = {"FOREVER": "LOOP", "ELSEIF": "IF"}


class TokenRow(NamedTuple):
    """A row of the table of tokens. `is_first`: applied before all others.

    `may_lose_numbers`: it is only shown, or describes itself what becomes of them.
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
    """A row of the table of signs: a pattern of characters that form no token."""

    pattern: re.Pattern[str]
    replacement: str
    code: Code
    is_offered: bool
    example: tuple[str, str]


def cells(table: str) -> Iterator[list[str]]:
    """Yield the cells of each row, including its indented lines; rows with choices yield each."""
    for row in _CONTINUATION.sub(" ", table.strip("\n")).split("\n"):
        if row.strip() and not row.startswith("# "):
            parts = [part.split("¦") for part in re.split("[⟨⟩]", row)]
            assert len({*map(len, parts)} - {1}) < 2, row
            for k in range(max(map(len, parts))):
                cell_row = "".join(part[k % len(part)] for part in parts)
                yield [cell.strip() for cell in re.split(r"\s\|(?=\s|$)", cell_row, maxsplit=5)]


@cache
def token_rows() -> tuple[TokenRow, ...]:
    compiled_rows = []
    for pattern, replacement, cost, code, modes, example in cells(rows.TOKENS):
        parts = tuple(_expand_parts(replacement, rows.PARTS).split())
        is_offered = "offered" in modes
        may_lose = is_offered or bool(_NUMBER_LABEL.search(f"{pattern} {replacement}"))
        row = TokenRow(compile_pattern(pattern, rows.PARTS), parts, float(cost), CODES[code],
                  "first" in modes, is_offered, may_lose, _example_texts(example))  # fmt: skip
        compiled_rows.append(row)
    return tuple(compiled_rows)


@cache
def _index_of(is_first: bool) -> RowIndex:
    return index_rows(
        {k: row.pattern for k, row in enumerate(token_rows()) if row.is_first is is_first}
    )


def rows_to_try(line: EncodedLine, is_first: bool) -> Iterator[TokenRow]:
    """Yield the rows that may match a line, in the order of the table."""
    return (token_rows()[k] for k in line.candidate_rows(_index_of(is_first)))


@cache
def sign_rows() -> tuple[SignRow, ...]:
    return tuple(
        SignRow(
            re.compile(_anchor_edges(pattern), re.I),
            replacement[1:-1],
            CODES[code],
            mode == "offered",
            _example_texts(example),
        )
        for pattern, replacement, code, mode, example in cells(rows.SIGNS)
    )


def _anchor_edges(pattern: str) -> str:
    """Return a pattern of characters whose `^` and `$` match the beginning and the end of an
    instruction."""
    edges = {"^": r"(?:\A|(?<=[;{}])|(?<=S[IB]\|))", "$": r"(?=\s*(?:[;}]|\Z))"}
    return _EDGE.sub(lambda match: edges.get(match[0], match[0]), pattern)


def _example_texts(example: str) -> tuple[str, str]:
    """Return the program of an example, and the expected result."""
    wrong_text, _, right_text = example.replace("⏎", "\n").rpartition(" => ")
    return wrong_text.strip(" "), right_text


class Pattern(NamedTuple):
    """A row's pattern as one of labels, as `Names.label` writes them.

    A line can match only if it has one of each of `needed_labels`, which is quick to check.
    """

    label_pattern: re.Pattern[str]
    needed_labels: tuple[frozenset[str], ...]


def compile_pattern(pattern: str, pieces: Mapping[str, str]) -> Pattern:
    """Return a row's pattern, in which `pieces` stand for its `<parts>`."""
    atoms = [_atom(word) for word in _expand_parts(pattern, pieces).split()]
    needed_labels = tuple(
        labels for _, labels in atoms if labels and not labels & {*WILDCARD_LABELS, "s|"}
    )
    return Pattern(re.compile("".join(text for text, _ in atoms)), needed_labels)


def _expand_parts(pattern: str, pieces: Mapping[str, str]) -> str:
    """Return a pattern with its `<parts>` written out."""
    while _PART_REFERENCE.search(pattern):
        pattern = _PART_REFERENCE.sub(lambda match: pieces[match[1]], pattern)
    return pattern


def _atom(atom: str) -> tuple[str, frozenset[str]]:
    """Return the pattern of one token, and its alternative labels; empty if it is optional."""
    if atom in _EDGE_PATTERNS:
        return _EDGE_PATTERNS[atom], frozenset()
    capture = _CAPTURE.match(atom) if len(atom) > 2 else None
    name, atom = (capture[1], atom[2:]) if capture else ("", atom)
    quantifier = ""
    if len(atom) > 1 and atom[-1] in "?*+" and (atom[-2].isalnum() or atom[-2] in "':,;()"):
        atom, quantifier = atom[:-1], atom[-1]
    parts = _ATOM.findall(atom)
    labels = [
        part if part[0] in "@_" or part[0].isalnum() else "s" + part.strip("'")
        for part in parts
        if part != "$"
    ]
    if labels in (["@all"], ["@cond"]) and quantifier:  # the brackets in it are closed in it
        body = body = _closing_pattern(["@flat"])
        if labels == ["@cond"]:  # the condition may be alone
            group = rf"{_token_pattern(['s('])}{body}*?{_token_pattern(['s)'])}"
            body = rf"(?:{group}|(?!{group}){_token_pattern(labels)})"
        body = f"(?:{body}{quantifier}?)"
        return f"(?P<{name}>{body})" if name else body, frozenset()
    token_pattern = _token_pattern(labels)
    choices = [
        *([token_pattern] if labels else []),
        *([_EDGE_PATTERNS["$"]] if "$" in parts else []),
    ]
    body = f"(?:{'|'.join(choices)}){quantifier}{'?' if quantifier and quantifier in '+*' else ''}"
    is_needed = quantifier in ("", "+") and "$" not in parts
    return f"(?P<{name}>{body})" if name else body, frozenset(labels if is_needed else ())


def _closing_pattern(labels: Sequence[str]) -> str:
    """Return the pattern of a token of these labels, or of brackets that such tokens are in."""
    body = _token_pattern(labels)
    for _ in range(_MAX_BRACKET_DEPTH):
        body = (
            rf"(?:{_token_pattern(labels)}|{_token_pattern(['s('])}{body}*{_token_pattern(['s)'])})"
        )
    return body


def _token_pattern(labels: Sequence[str]) -> str:
    """Return the pattern of a token that has one of these labels."""
    return rf"\x01[^\x02]*\|(?:{'|'.join(map(re.escape, labels))})\|[^\x02]*\x02"


RowIndex = Mapping[str, Sequence[int]]


def index_rows(patterns: Mapping[int, Pattern]) -> RowIndex:
    """Return the indexes of patterns by the labels that a matching line must have.

    It is the label that the fewest patterns need, "" for one that any line may match.
    """
    count_of_label = Counter(
        label for pattern in patterns.values() for label in chain(*pattern.needed_labels)
    )
    rows_by_label: dict[str, list[int]] = {}
    for k, pattern in patterns.items():
        rarest_labels = min(
            pattern.needed_labels,
            key=lambda labels: sum(count_of_label[label] for label in labels),
            default=("",),
        )
        for label in rarest_labels:
            rows_by_label.setdefault(label, []).append(k)
    return rows_by_label


class EncodedLine:
    """The labels of a line as one text, and which token ends where in it."""

    def __init__(
        self, tokens: Sequence[Lexeme], names: Names, labels: Sequence[str] | None = None
    ) -> None:
        self.tokens = list(tokens)
        self.names = names
        parts = labels or [names.label(token) for token in tokens]
        self.text = "".join(parts)
        self._labels = frozenset(("", *self.text.split("|")))
        self.token_at_offset = {0: 0}
        end = 0
        for k, part in enumerate(parts):
            end += len(part)
            self.token_at_offset[end] = k + 1

    def matches(self, pattern: Pattern) -> Iterator[re.Match[str]]:
        for labels in pattern.needed_labels:
            if self._labels.isdisjoint(labels):
                return iter(())
        return pattern.label_pattern.finditer(self.text)

    def candidate_rows(self, table: RowIndex) -> list[int]:
        """Return the indexes of patterns that the line may match, in order."""
        return sorted({k for label in self._labels & table.keys() for k in table[label]})

    def span(self, match: re.Match[str], name: str | int = 0) -> tuple[int, int]:
        """Return the tokens of a match, or of a part of it that it has captured."""
        start, end = match.span(name)
        return (self.token_at_offset[start], self.token_at_offset[end]) if start >= 0 else (0, 0)

    def apply_row(self, row: TokenRow, match: re.Match[str]) -> list[Lexeme] | None:
        """Return the line after a row, or None if it does not apply here."""
        new_tokens: list[Lexeme] = []
        for part in row.replacement:
            replacement = self._replacement(part, match)
            if replacement is None:
                return None
            if (
                new_tokens
                and replacement
                and new_tokens[-1].source is None
                and replacement[0].space == ""
            ):
                replacement = [replacement[0]._replace(space=None), *replacement[1:]]
            new_tokens += replacement
        new_tokens = _without_double_brackets(new_tokens)
        start, end = self.span(match)
        is_assignment = row.code is codes.OTHER_ASSIGNMENT
        if is_assignment and start and self.tokens[start - 1].text in _BEFORE_VALUE:
            return None  # in brackets it would be a condition
        if (
            new_tokens
            and new_tokens[-1].text == ";"
            and end < len(self.tokens)
            and self.tokens[end].text == ";"
        ):
            new_tokens.pop()
        old_tokens = self.tokens[start:end]
        if texts(new_tokens) == texts(old_tokens):
            return None
        if not row.may_lose_numbers and _numbers(old_tokens) - _numbers(new_tokens):
            return None
        return self.tokens[:start] + new_tokens + self.tokens[end:]

    def _replacement(self, part: str, match: re.Match[str]) -> list[Lexeme] | None:
        def tokens_of(name: str) -> list[Lexeme]:
            start, end = self.span(match, name)
            return self.tokens[start:end]

        if part[0] == "$" and len(part) == 2:
            return tokens_of(part[1])
        if part[0] == "&" and len(part) == 2:
            return [self.translate(token) for token in tokens_of(part[1])]
        if part[0] != "@":
            return [make_token(part.strip("'"))]
        function, *names = part[1:].split(":")
        match_here = _Match(self, [tokens_of(name) for name in names], self.span(match)[0])
        return _FUNCTIONS[function](match_here)

    def translate(self, token: Lexeme) -> Lexeme:
        concept = self.names.find_meaning(token.text, NEAR_COST) if token.kind is WORD else ""
        concept = concept or "".join(lexicon_meaning(token.text, "number"))
        return make_token(concept) if concept not in ("", token.text) else token


def _numbers(tokens: Sequence[Lexeme]) -> Counter[str]:
    return Counter(token.text for token in tokens if token.kind is NUMBER)


class _Match(NamedTuple):
    """The argument of a table's function: the line, its captures, and the start of the match."""

    line: EncodedLine
    captures: list[list[Lexeme]]
    start: int


_Replacement = list[Lexeme] | None


def negate(condition: Sequence[Lexeme]) -> list[Lexeme]:
    """Return the condition that is TRUE where `condition` is not."""
    signs = [k for k, token in enumerate(condition) if token.text in COMPARISONS]
    if len(signs) == 1 and not any(token.text in ("AND", "OR", "NOT") for token in condition):
        k = signs[0]
        return [*condition[:k], make_token(OPPOSITES[condition[k].text]), *condition[k + 1 :]]
    return [make_token("NOT"), make_token("("), *condition, make_token(")")]


def _end_of(match: _Match) -> _Replacement:
    word = match.line.translate(match.captures[0][0]).text
    word = "LOOP" if lexicon_meaning(word, "count") else _HEADER_OF.get(word, word)
    end = BLOCK_ENDS.get(word, word if word in WORD_OF_END else "")
    return [make_token(end)] if end else None


def _decimal(match: _Match) -> _Replacement:
    """`1,5` is 1.5 if it cannot be two values."""
    (whole_token,), (comma_token,), (decimals_token,) = match.captures
    text_before = match.line.tokens[match.start - 1].text if match.start else ""
    most_decimals = 3 if whole_token.text == "0" else 2 if text_before == "=" else 1
    is_value_list = decimals_token.text == "0" or (
        len(whole_token.text) > 1 and decimals_token.text != "5"
    )
    has_space = bool(comma_token.space or decimals_token.space)
    if (
        "." in whole_token.text + decimals_token.text
        or is_value_list
        or len(decimals_token.text) > most_decimals
        or has_space
    ):
        return None
    text = f"{whole_token.text}.{decimals_token.text}"
    return [whole_token._replace(text=text, source=text)]


def _joined_tens(match: _Match) -> _Replacement:
    """`8 0` is 80."""
    (number_token,), (zero_token,) = match.captures
    is_one_number = zero_token.space == " " and "." not in number_token.text
    return [make_token(number_token.text + "0")] if is_one_number else None


def _seconds_of_minutes(match: _Match) -> _Replacement:
    """`1:30` is 90 seconds."""
    (minutes_token,), (seconds_token,) = match.captures
    seconds_text = seconds_token.text
    is_time = (
        "." not in minutes_token.text + seconds_text
        and len(seconds_text) == 2
        and int(seconds_text) < 60
    )
    if not is_time or minutes_token.text == "0":
        return None
    return [make_token(str(int(minutes_token.text) * 60 + int(seconds_text)))]


def _times_number(match: _Match) -> _Replacement:
    """`x4` is 4, if no variable is called so."""
    word = match.captures[0][0].text
    return None if match.line.names.is_name(word) else [make_token(word[1:])]


def _equal_number(match: _Match) -> _Replacement:
    """The second of two numbers, where they are the same."""
    (first_token,), (second_token,) = match.captures
    return [second_token] if first_token.text == second_token.text else None


def _label(match: _Match) -> _Replacement:
    """A name after the end of a DEF is a label if the DEF is called elsewhere."""
    return [] if match.captures[0][0].text in match.line.names.called_defs else None


def _limit(is_high: bool, match: _Match) -> _Replacement:
    """The limit of an actuator's range."""
    (device_token,) = match.captures[0]
    actuator = match.line.names.actuators[match.line.translate(device_token).text]
    limit = actuator.high if is_high else actuator.low
    return None if actuator.is_yes_no else [make_token(f"{limit / 1000:g}")]


def _seconds(match: _Match) -> _Replacement:
    """Convert milliseconds into seconds."""
    (token,) = match.captures[0]
    return [make_token(f"{float(token.text) / 1000:g}")]


def _converted_number(match: _Match) -> _Replacement:
    """A number with its unit, in the unit that values have: `500 ms` is 0.5, `1 m` is 100."""
    (number_token,), (unit_token,) = match.captures
    meaning = lexicon_meaning(unit_token.text, "unit") or ("", "1000")
    return [
        number_token
        if meaning[1] == "1000"
        else make_token(number_text(float(number_token.text) * int(meaning[1]) / 1000))
    ]


_FUNCTIONS: dict[str, Callable[[_Match], _Replacement]] = {
    "not": lambda match: negate(match.captures[0]), "endof": _end_of, "dec": _decimal,
    "xn": _times_number,
    "cat": _joined_tens, "mmss": _seconds_of_minutes, "same": _equal_number, "label": _label,
    "ms": _seconds, "own": _converted_number,
    "most": partial(_limit, True), "least": partial(_limit, False),
}  # fmt: skip


def _without_double_brackets(tokens: list[Lexeme]) -> list[Lexeme]:
    """Drop a pair of brackets of a row right around one of the text."""
    for k in range(len(tokens) - 1):
        if tokens[k].text == "(" == tokens[k + 1].text and tokens[k].source is None:
            end = brackets_end(tokens, k + 1)
            token_after = tokens[end : end + 1] if end else []
            if token_after and token_after[0].text == ")" and token_after[0].source is None:
                return tokens[:k] + tokens[k + 1 : end] + tokens[end + 1 :]
    return tokens


def join_one_name(tokens: Sequence[Lexeme], names: Names) -> tuple[list[Lexeme], bool] | None:
    """Return a line in which words that are one are one: `FIN SI`, `POR SIEMPRE`, `mi vel`.

    The other value says whether that is a name of the program.
    """
    tokens = list(tokens)
    for name_words in names.spaced_names:
        for k in range(len(tokens) - len(name_words) + 1):
            if texts(tokens[k : k + len(name_words)]) == name_words:
                name = make_token(joined_name(name_words))._replace(space=tokens[k].space)
                return [*tokens[:k], name, *tokens[k + len(name_words) :]], True
    for k in range(len(tokens)):
        if sensor_and_count := _sensor_of_side(tokens, k, names):
            sensor, count = sensor_and_count
            word = make_token(sensor)._replace(space=tokens[k].space)
            is_sensor_name = joined_name(texts(tokens[k : k + count])) == sensor  # `LIGHT-L`
            return [*tokens[:k], word, *tokens[k + count :]], is_sensor_name
    for k, count in product(range(len(tokens)), (3, 2)):
        name_words = texts(tokens[k : k + count])
        if len(name_words) < count or any(
            token.kind is not WORD for token in tokens[k : k + count]
        ):
            continue
        text = "_".join(name_words)
        next_text = tokens[k + count].text if k + count < len(tokens) else ""
        if lexicon_concept(text) == "ELSE" and (
            lexicon_meaning(next_text, "is") or lexicon_meaning(next_text, "there")
        ):
            continue  # `si no hay pared`
        if lexicon_concept(text) == "ELSE" and next_text == "(" and tokens[k + count].space == "":
            continue  # `SE NÃO(DISTANCE < 10)`
        if lexicon_concept(text) or (text in WORDS and name_words[0] == "END"):
            meanings = names.meanings(text)  # `END IF` ends any block
            word = make_token(meanings[0].concept if meanings else text)._replace(
                space=tokens[k].space
            )
            return [*tokens[:k], word, *tokens[k + count :]], False
    return None


def _sensor_of_side(tokens: Sequence[Lexeme], k: int, names: Names) -> tuple[str, int] | None:
    """Return the sensor of a side from a token on, and of how many: `LIGHT L`, `luz(izquierda)`."""
    if not lexicon_meaning(tokens[k].text, "stem", "sensing") or names.is_name(tokens[k].text):
        return None
    signs = texts(tokens[k + 1 : k + 4])
    side_index = 1 if signs[:1] in (("(",), ("[",), ("-",), (".",)) else 0
    is_closed = signs[:1] not in (("(",), ("[",)) or signs[2:3] in ((")",), ("]",))
    name = "_".join((tokens[k].text, *signs[side_index : side_index + 1]))
    sensor = name if name in names.sensors else names.find_meaning(name)
    count = 2 if not side_index else 4 if signs[0] in "([" else 3
    is_call = not side_index and signs[1:2] == (
        "(",
    )  # an instruction after it: `IF LIGHT L(1, 60)`
    is_complete = is_closed and signs[side_index:] and not is_call
    return (sensor, count) if is_complete and sensor in names.sensors else None
