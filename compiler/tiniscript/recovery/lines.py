"""The readings of one line: a best-first search over rewrites, calls from words, and slips.

Tries only what touches the place where the grammar cannot go on. Knows no other line.
"""

from __future__ import annotations

import heapq
import re
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from itertools import chain, count
from typing import NamedTuple
from unicodedata import category

from tiniscript.base.spelling import nearest
from tiniscript.base.words import EXTENTS, FUNCTIONS, MOVES, WORDS, lexicon_concept, lexicon_meaning
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code
from tiniscript.recovery import meanings, rewrites, rows
from tiniscript.recovery.meanings import (
    CALL_WORDS,
    KNOWN,
    LONG_TIME_S,
    NEAR,
    REMEMBERED_LINES,
    Lexeme,
    Meaning,
    Names,
    closed,
    made,
    texts,
)
from tiniscript.recovery.slots import MILLISECONDS_FROM, filled
from tiniscript.syntax.lexer import DEGREES, NUMBER, WORD
from tiniscript.syntax.operators import SIGNS
from tiniscript.syntax.outline import Failure, Item, outline

MOST_STATES = 80  # of one line that are looked at
MOST_SLIP_STATES = 40
MOST_QUICK_STATES = 8
RIVAL_MARGIN = 1.05  # what a rival may cost more than the cheapest reading
SURE_MARGIN = 0.15  # what it has to cost more, for the cheapest to be sure
SLIP_MARGIN = 0.3
MOST_RIVALS = 4
MOST_TOKENS = 300  # tokens of a line
ANY_END = "?"  # the word of an end that names no block: END, FIN
BRACES = ("{", "}")
MOST_TOKENS_WITH_SLIPS = 80
_MOST_FIRST_STEPS = 30
_CALCULATION_SIGNS = SIGNS | {"°"}  # without it another number would be meant
_NEEDLESS_BRACKETS = re.compile(r"(?<=[(,=<>+*/-] )\( ([^() ]+) \)|\( (\( [^()]* \)) \)")
_MOST_PLAIN_DIGITS = 4
_WORDS_AT_END = ("LOOP", "IF", "WHILE", "DEF", "ELSEIF", "UNTIL")
_EDGE_WORDS = {word for word in WORDS if WORDS[word].role.is_of_blocks} | {";", "UNTIL", *BRACES}


class Step(NamedTuple):
    """A rewrite that was made: what it was for, and the line before and after it."""

    code: Code
    before: Sequence[Lexeme]
    after: Sequence[Lexeme]


class Reading(NamedTuple):
    """What a line may mean. `items` is None while it is not right yet.

    `is_sure`: no step was a guess, and `search` takes that back where a rival costs about the same.
    """

    cost: float
    tokens: list[Lexeme]
    steps: tuple[Step, ...]
    is_sure: bool
    is_new_line: bool
    items: Sequence[Item] | None = None

    def with_change(
        self, tokens: list[Lexeme], cost: float, code: Code, is_sure: bool = True,
        is_new_line: bool = False,
    ) -> Reading:  # fmt: skip
        steps = (*self.steps, Step(code, self.tokens, tokens))
        is_still_sure, has_new_line = self.is_sure and is_sure, self.is_new_line or is_new_line
        return Reading(self.cost + cost, tokens, steps, is_still_sure, has_new_line)

    @property
    def text(self) -> tuple[str, ...]:
        return texts(self.tokens)

    @property
    def text_read(self) -> str:
        """The tokens without those that change nothing: separators, brackets around one value."""
        text = " ".join(item for item in self.text if item != ";")
        while (bare := _NEEDLESS_BRACKETS.sub(r"\1\2", text)) != text:
            text = bare
        return text


def right(tokens: Sequence[Lexeme], names: Names) -> Sequence[Item] | Failure:
    """Return the items of a line, or where it is wrong. Braces and bare ends are items, too."""
    return _parse_items(tuple(map(_normalized, tokens)), names)


def is_right(tokens: Sequence[Lexeme], names: Names) -> bool:
    return not isinstance(right(tokens, names), Failure)


def _normalized(token: Lexeme) -> tuple[str, str]:
    """Return a token as the lexer has it; all numbers that any instruction reads alike are one."""
    text = token.text
    if text in DEGREES:
        return (WORD, "DEG")
    is_plain = text.isdecimal() and text[0] != "0" and len(text) <= _MOST_PLAIN_DIGITS
    return token.kind, "1" if is_plain else text


@lru_cache(REMEMBERED_LINES)
def _parse_items(tokens: tuple[tuple[str, str], ...], names: Names) -> Sequence[Item] | Failure:
    items: list[Item] = []
    start = 0
    padded_texts = [";", *(text for _, text in tokens), BRACES[1], ";"]
    for k, (before, text, after) in enumerate(
        zip(padded_texts, padded_texts[1:], padded_texts[2:], strict=False)
    ):
        is_separate = {before, after} <= {";", "|", *BRACES}
        is_end = is_separate and bool(lexicon_meaning(text, "end")) and not names.is_name(text)
        if text not in BRACES and not is_end:
            continue
        part = outline(tokens[start:k], names.read_as)
        if isinstance(part, Failure):
            return Failure(part.start + start, part.at + start)
        if joined_name := _joined_names(tokens[start:k]):
            return Failure(start, joined_name + start)
        items += [item._replace(start=item.start + start, end=item.end + start) for item in part]
        if k < len(tokens):
            items.append(Item("end" if is_end else text, ANY_END if is_end else text, k, k + 1))
        start = k + 1
    return items


def _joined_names(tokens: Sequence[tuple[str, str]]) -> int:
    """Return where a word joins the names of a DEF, 0 for nowhere: `DEF SIDE(X and Y)`."""
    is_in_brackets = is_def = False
    for k, (kind, text) in enumerate(tokens[1:-1], 1):
        is_def = (is_def or tokens[k - 1][1] == "DEF") and text != ";"
        is_in_brackets = is_def and (is_in_brackets or text == "(") and text != ")"
        neighbours = {tokens[k - 1][0], tokens[k + 1][0]}
        if (
            is_in_brackets
            and kind == WORD
            and neighbours == {WORD}
            and lexicon_meaning(text, "then")
        ):
            return k
    return 0


def read(tokens: Sequence[Lexeme], names: Names, is_quick: bool = False) -> list[Reading]:
    """Return the cheapest readings of a line, which nobody may change: they are kept.

    `is_quick`: those that few rows lead to.
    """
    return _read(tuple(tokens), names, is_quick)


@lru_cache(REMEMBERED_LINES)
def _read(tokens: tuple[Lexeme, ...], names: Names, is_quick: bool) -> list[Reading]:
    setup = meanings.setup_of(tokens)
    readings = _Search(names).read(list(tokens[len(setup) :]), is_quick)
    whole_readings = [reading._replace(tokens=[*setup, *reading.tokens]) for reading in readings]
    message = ((reading, right(reading.tokens, names)) for reading in whole_readings)
    return [reading._replace(items=its) for reading, its in message if not isinstance(its, Failure)]


_Successors = Callable[[Reading, Failure], Iterator[Reading]]


class _Search:
    """Reads a line by what `rewritten` makes of it, and where that reads nothing by slips."""

    def __init__(self, names: Names) -> None:
        self.names = names

    def read(self, tokens: list[Lexeme], is_quick: bool) -> list[Reading]:
        first = self.at_once(Reading(0, tokens, (), True, False))
        readings = self.search(
            first, MOST_QUICK_STATES if is_quick else MOST_STATES, self.rewritten
        )
        has_word_or_number = any(token.kind in (WORD, NUMBER) for token in tokens)
        if (
            not is_quick
            and not readings
            and has_word_or_number
            and len(tokens) < MOST_TOKENS_WITH_SLIPS
        ):
            readings_found = self.search(first, MOST_SLIP_STATES, self.with_slips)
            readings_found = [
                reading
                for reading in readings_found
                if reading.items and reading.cost < readings_found[0].cost + SLIP_MARGIN
            ]
            is_only_reading = len({reading.text_read for reading in readings_found}) == 1
            readings = [
                reading._replace(is_sure=reading.is_sure and is_only_reading)
                for reading in readings_found
            ]
        return readings

    def search(self, first: Reading, states: int, successors: _Successors) -> list[Reading]:
        """Return up to RIVALS right readings, the cheapest first, after `states` lines at most."""
        order = count()
        heap = [(first.cost, next(order), first)]
        texts_seen: set[tuple[str, ...]] = set()
        readings: list[Reading] = []
        while heap and len(texts_seen) < states:
            cost, _, reading = heapq.heappop(heap)
            if readings and (
                cost > readings[0].cost + RIVAL_MARGIN or len(readings) >= MOST_RIVALS
            ):
                break
            text = reading.text
            if text in texts_seen:
                continue
            texts_seen.add(text)
            items = right(reading.tokens, self.names)
            if not isinstance(items, Failure):
                if not self.says_twice(reading, items, first):
                    readings.append(reading._replace(items=items))
                continue
            for after in successors(reading, items):
                if len(after.tokens) < MOST_TOKENS:
                    heapq.heappush(heap, (after.cost, next(order), after))
        return readings

    @staticmethod
    def says_twice(reading: Reading, items: Sequence[Item], first: Reading) -> bool:
        """Whether one instruction of the line became the same one twice, which nobody wrote."""
        messages = [texts(reading.tokens[item.start : item.end]) for item in items]
        for one, other, item in zip(messages, messages[1:], items, strict=False):
            if item.kind == "do" and one[0] == other[0]:
                if one == other and one[0] in ("S", "STOP", "SHOW"):
                    return first.text.count(one[0]) < messages.count(one)
                if not reading.is_sure and one == other == first.text[: len(one)]:
                    return True
        return False

    def at_once(self, reading: Reading) -> Reading:
        """Make the rewrites that come before all others, and make words one that are one."""
        for _ in range(_MOST_FIRST_STEPS):
            one = rewrites.one_word(reading.tokens, self.names)
            if one is not None:
                tokens, is_sensor_name = one
                code = codes.NAME_WITH_SPACE if is_sensor_name else codes.OTHER_LANGUAGE
                reading = reading.with_change(tokens, 1.0 if is_sensor_name else 0.5, code)
                continue
            after = next(self._apply_patterns(reading, None), None)
            if after is None:
                break
            reading = after
        return reading

    def rewritten(self, reading: Reading, failure: Failure) -> Iterator[Reading]:
        """Give what a reading becomes where it fails: by rows, calls in words, meanings."""
        ways = (self._apply_patterns, self._fill_slots, self._translate_word)
        return map(self.at_once, chain(*(way(reading, failure) for way in ways)))

    def _apply_patterns(self, reading: Reading, failure: Failure | None) -> Iterator[Reading]:
        """Make the rows that touch a place; for none those that come before all others."""
        line = rewrites.Encoded(reading.tokens, self.names)
        for row in rewrites.rows_to_try(line, is_first=failure is None):
            for match in line.matches(row.pattern):
                start, end = line.span(match)
                if failure and not _is_near(failure, start, end):
                    continue
                tokens = line.rewritten(row, match)
                if tokens is not None:
                    is_new = ";" in row.replacement
                    yield reading.with_change(
                        tokens, row.cost, row.code, not row.is_offered, is_new
                    )
                    break

    def _fill_slots(self, reading: Reading, failure: Failure) -> Iterator[Reading]:
        tokens = reading.tokens
        for start, end in _calls(tokens):
            words = tokens[start:end]
            if not _is_near(failure, start, end):
                continue
            has_until = end < len(tokens) and tokens[end].text == "UNTIL"
            call = filled(words, self.names, has_until)
            if call is None or call.times or texts(call.tokens) == texts(words):
                continue
            line = [*tokens[:start], *call.tokens, *tokens[end:]]
            yield reading.with_change(line, call.cost, _code_of_call(words), call.is_sure)

    def _translate_word(self, reading: Reading, failure: Failure) -> Iterator[Reading]:
        """Translate the first word that is none of the language."""
        tokens, padded_texts = reading.tokens, ("", *reading.text, "")
        for k, token in enumerate(tokens[: failure.at + 2]):
            if token.kind is not WORD or (token.text in WORDS and token.text != "SI"):
                continue
            is_function = padded_texts[k] in ("(", ",", *SIGNS) and padded_texts[k + 2] == "("
            is_misspelt = is_function and not lexicon_concept(token.text)
            suggestion = nearest(token.text, FUNCTIONS) if is_misspelt else None
            guess = (Meaning(suggestion, KNOWN),) if suggestion else ()
            meanings = guess or self.names.meanings(token.text)
            if _is_long(tokens, k, meanings[0].concept if meanings else ""):
                continue
            for concept, cost in meanings:
                cost = NEAR if token.text[-1].isdigit() else cost
                if (
                    concept == "TIME"
                    and k > 1
                    and padded_texts[k] == "("
                    and padded_texts[k - 1] in CALL_WORDS
                ):
                    continue  # for the first value of a call: `F(tiempo, 80)`
                is_sure = cost < 2 and concept != "TIME"
                line = [*tokens[:k], made(concept)._replace(space=token.space), *tokens[k + 1 :]]
                yield reading.with_change(line, cost, codes.OTHER_LANGUAGE, is_sure)
            if meanings:
                break

    def with_slips(self, reading: Reading, failure: Failure) -> Iterator[Reading]:
        """One sign wrong, missing, too much or after its neighbour, where the line fails."""
        tokens, (start, at) = reading.tokens, failure
        for k in reversed(range(max(0, start - 1), min(len(tokens) + 1, at + 2))):
            head, rest = tokens[:k], tokens[k + 1 :]
            for sign, code in rows.MISSING.items():
                yield reading.with_change([*head, made(sign), *tokens[k:]], rows.MISSING_COST, code)
            if k == len(tokens):
                continue
            token = tokens[k]
            is_sign, is_bracket = token.kind not in (WORD, NUMBER), token.text in ("(", ")")
            neighbours = texts((*head[-1:], *rest[:1]))
            for sign in rows.CONFUSED.get(token.text, ""):
                code = codes.MISSING_SEPARATOR if sign == ";" else codes.OTHER_CALL
                line = [*head, made(sign), *rest]
                yield reading.with_change(line, rows.CONFUSED_COST, code, sign not in neighbours)
            is_needed = _CALCULATION_SIGNS & {token.text, *texts(rest[:1])} or _is_group(tokens, k)
            if is_sign and not is_needed and category(token.text[0]) != "Sm":
                code = codes.EXTRA_CLOSE if token.text == ")" else codes.OTHER_CALL
                yield reading.with_change([*head, *rest], rows.EXTRA_COST, code, is_bracket)
            if rest and (is_bracket or rest[0].text in ("(", ")")):
                if not is_sign or rest[0].kind in (WORD, NUMBER):
                    line = [*head, rest[0], token, *rest[1:]]
                    yield reading.with_change(line, rows.SWAPPED_COST, codes.MISSING_OPEN)


def _is_group(tokens: Sequence[Lexeme], k: int) -> bool:
    """Whether a bracket groups a part of a sum: without it the sum is another one."""
    before = tokens[k - 1].text if k else ""
    rest = [token.text for token in tokens[k + 1 :]]
    return tokens[k].text == "(" and before in ("=", *SIGNS) and bool(_CALCULATION_SIGNS & {*rest})


def _code_of_call(words: Sequence[Lexeme]) -> Code:
    """Return with which code it is told that these words are no call as it is written."""
    signs = texts(words)
    if signs[0] not in WORDS:
        return codes.OTHER_LANGUAGE
    if "(" not in signs:
        return codes.MISSING_OPEN
    if "=" in signs:
        return codes.NAMED_ARGUMENT
    inside = words[signs.index("(") :]
    if any(
        lexicon_meaning(it.text, "unit") and it.text not in (*EXTENTS, "°", "º") for it in inside
    ):
        return codes.UNIT
    return codes.OTHER_CALL


def _is_near(failure: Failure, start: int, end: int) -> bool:
    return start <= failure.at + 1 and end >= failure.start - 1


def _is_long(tokens: Sequence[Lexeme], k: int, concept: str) -> bool:
    """Whether the number after a translated word is rarely meant for seconds: `move(50, 50)`."""
    numbers = [token for token in tokens[k + 1 : k + 3] if token.kind is NUMBER]
    least = LONG_TIME_S if concept in (*MOVES, "BEEP") else MILLISECONDS_FROM
    is_timed = concept in (*MOVES, "BEEP", "W")
    return is_timed and bool(numbers) and float(numbers[0].text) >= least


def _calls(tokens: Sequence[Lexeme]) -> Iterator[tuple[int, int]]:
    """Give the pieces of a line in which a call may be told: between separators and headers."""
    start = 0
    for k, token in enumerate([*tokens, made(";")]):
        is_edge = token.text in _EDGE_WORDS
        is_next_call = k > 0 and tokens[k - 1].text == ")" and token.text in CALL_WORDS
        if (is_edge or is_next_call) and start < k:
            yield start, k
            start = k
        if is_edge:
            start = max(start, k + 1)
        if token.text in _WORDS_AT_END:
            start = max(start, closed(tokens, k + 1) or k + 2)
