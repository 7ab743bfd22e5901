"""The readings of one line: a best-first search over rewrites, calls from words, and slips.

It tries only rewrites that touch the place where the grammar cannot continue. Knows no other line.
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
    KNOWN_COST,
    LONG_TIME_S,
    NEAR_COST,
    REMEMBERED_LINES,
    Lexeme,
    Meaning,
    Names,
    brackets_end,
    make_token,
    texts,
)
from tiniscript.recovery.slots import MIN_MILLISECONDS, fill_call
from tiniscript.syntax.lexer import DEGREES, NUMBER, WORD
from tiniscript.syntax.operators import SIGNS
from tiniscript.syntax.outline import Failure, Item, outline

MAX_STATES = 80  # most states of a line that are explored
MAX_SLIP_STATES = 40
MAX_QUICK_STATES = 8
RIVAL_MARGIN = 1.05  # factor within which a rival's cost is close to the cheapest reading
SURE_MARGIN = 0.15  # difference in cost that makes the cheapest reading certain
SLIP_MARGIN = 0.3
MAX_RIVALS = 4
MAX_TOKENS = 300  # tokens of a line
ANY_END = "?"  # the word of an end that names no block: END, FIN
BRACES = ("{", "}")
MAX_TOKENS_WITH_SLIPS = 80
_MAX_FIRST_STEPS = 30
_CALCULATION_SIGNS = SIGNS | {"°"}  # without the degree sign, another number would be meant
_NEEDLESS_BRACKETS = re.compile(r"(?<=[(,=<>+*/-] )\( ([^() ]+) \)|\( (\( [^()]* \)) \)")
_MAX_PLAIN_DIGITS = 4
_WORDS_AT_END = ("LOOP", "IF", "WHILE", "DEF", "ELSEIF", "UNTIL")
_EDGE_WORDS = {word for word in WORDS if WORDS[word].role.belongs_to_blocks} | {
    ";",
    "UNTIL",
    *BRACES,
}


class Step(NamedTuple):
    """A rewrite that was made: its purpose, and the line before and after it."""

    code: Code
    old_tokens: Sequence[Lexeme]
    new_tokens: Sequence[Lexeme]


class Reading(NamedTuple):
    """A possible meaning of a line. `items` is None until the line is right.

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
    def token_texts(self) -> tuple[str, ...]:
        return texts(self.tokens)

    @property
    def normal_text(self) -> str:
        """The tokens without those that change nothing: separators, brackets around one value."""
        text = " ".join(token_text for token_text in self.token_texts if token_text != ";")
        while (simpler_text := _NEEDLESS_BRACKETS.sub(r"\1\2", text)) != text:
            text = simpler_text
        return text


def parse_line(tokens: Sequence[Lexeme], names: Names) -> Sequence[Item] | Failure:
    """Return the items of a line, or where it is wrong. Braces and bare ends are items, too."""
    return _parse_items(tuple(map(_normalize, tokens)), names)


def is_right(tokens: Sequence[Lexeme], names: Names) -> bool:
    return not isinstance(parse_line(tokens, names), Failure)


def _normalize(token: Lexeme) -> tuple[str, str]:
    """Return a token as the lexer has it; numbers that every instruction reads in the same way
    become one."""
    text = token.text
    if text in DEGREES:
        return (WORD, "DEG")
    is_plain = text.isdecimal() and text[0] != "0" and len(text) <= _MAX_PLAIN_DIGITS
    return token.kind, "1" if is_plain else text


@lru_cache(REMEMBERED_LINES)
def _parse_items(tokens: tuple[tuple[str, str], ...], names: Names) -> Sequence[Item] | Failure:
    items: list[Item] = []
    start = 0
    padded_texts = [";", *(text for _, text in tokens), BRACES[1], ";"]
    for k, (previous_text, text, following_text) in enumerate(
        zip(padded_texts, padded_texts[1:], padded_texts[2:], strict=False)
    ):
        is_separate = {previous_text, following_text} <= {";", "|", *BRACES}
        is_end = is_separate and bool(lexicon_meaning(text, "end")) and not names.is_name(text)
        if text not in BRACES and not is_end:
            continue
        items_of_part = outline(tokens[start:k], names.readable_names)
        if isinstance(items_of_part, Failure):
            return Failure(items_of_part.start + start, items_of_part.failed_at + start)
        if joined_name := _joining_word_index(tokens[start:k]):
            return Failure(start, joined_name + start)
        items += [
            item._replace(start=item.start + start, end=item.end + start) for item in items_of_part
        ]
        if k < len(tokens):
            items.append(Item("end" if is_end else text, ANY_END if is_end else text, k, k + 1))
        start = k + 1
    return items


def _joining_word_index(tokens: Sequence[tuple[str, str]]) -> int:
    """Return the index of a word that joins the names of a DEF, or 0: `DEF SIDE(X and Y)`."""
    is_in_brackets = is_def = False
    for k, (kind, text) in enumerate(tokens[1:-1], 1):
        is_def = (is_def or tokens[k - 1][1] == "DEF") and text != ";"
        is_in_brackets = is_def and (is_in_brackets or text == "(") and text != ")"
        neighbour_kinds = {tokens[k - 1][0], tokens[k + 1][0]}
        if (
            is_in_brackets
            and kind == WORD
            and neighbour_kinds == {WORD}
            and lexicon_meaning(text, "then")
        ):
            return k
    return 0


def read(tokens: Sequence[Lexeme], names: Names, is_quick: bool = False) -> list[Reading]:
    """Return the cheapest readings of a line, which callers must not change: they are cached.

    `is_quick`: those that few rows lead to.
    """
    return _read(tuple(tokens), names, is_quick)


@lru_cache(REMEMBERED_LINES)
def _read(tokens: tuple[Lexeme, ...], names: Names, is_quick: bool) -> list[Reading]:
    setup = meanings.setup_of(tokens)
    readings = _Search(names).read(list(tokens[len(setup) :]), is_quick)
    whole_readings = [reading._replace(tokens=[*setup, *reading.tokens]) for reading in readings]
    readings_and_items = (
        (reading, parse_line(reading.tokens, names)) for reading in whole_readings
    )
    return [
        reading._replace(items=items)
        for reading, items in readings_and_items
        if not isinstance(items, Failure)
    ]


_Successors = Callable[[Reading, Failure], Iterator[Reading]]


class _Search:
    """Reads a line with the result of `rewrite`, or by slips if that cannot be read."""

    def __init__(self, names: Names) -> None:
        self.names = names

    def read(self, tokens: list[Lexeme], is_quick: bool) -> list[Reading]:
        first_reading = self.apply_first_rewrites(Reading(0, tokens, (), True, False))
        readings = self.search(
            first_reading, MAX_QUICK_STATES if is_quick else MAX_STATES, self.rewrite
        )
        has_word_or_number = any(token.kind in (WORD, NUMBER) for token in tokens)
        if (
            not is_quick
            and not readings
            and has_word_or_number
            and len(tokens) < MAX_TOKENS_WITH_SLIPS
        ):
            found_readings = self.search(first_reading, MAX_SLIP_STATES, self.undo_slips)
            found_readings = [
                reading
                for reading in found_readings
                if reading.items and reading.cost < found_readings[0].cost + SLIP_MARGIN
            ]
            is_only_reading = len({reading.normal_text for reading in found_readings}) == 1
            readings = [
                reading._replace(is_sure=reading.is_sure and is_only_reading)
                for reading in found_readings
            ]
        return readings

    def search(
        self, first_reading: Reading, most_states: int, successors: _Successors
    ) -> list[Reading]:
        """Return the cheapest right readings, which are few, of `most_states` lines at most."""
        order = count()
        heap = [(first_reading.cost, next(order), first_reading)]
        seen_texts: set[tuple[str, ...]] = set()
        readings: list[Reading] = []
        while heap and len(seen_texts) < most_states:
            cost, _, reading = heapq.heappop(heap)
            if readings and (cost > readings[0].cost + RIVAL_MARGIN or len(readings) >= MAX_RIVALS):
                break
            texts = reading.token_texts
            if texts in seen_texts:
                continue
            seen_texts.add(texts)
            items = parse_line(reading.tokens, self.names)
            if not isinstance(items, Failure):
                if not self.repeats_instruction(reading, items, first_reading):
                    readings.append(reading._replace(items=items))
                continue
            for successor in successors(reading, items):
                if len(successor.tokens) < MAX_TOKENS:
                    heapq.heappush(heap, (successor.cost, next(order), successor))
        return readings

    @staticmethod
    def repeats_instruction(
        reading: Reading, items: Sequence[Item], first_reading: Reading
    ) -> bool:
        """Return whether two parts of the line became the same instruction, which nobody wrote."""
        instruction_texts = [texts(reading.tokens[item.start : item.end]) for item in items]
        for instruction, next_instruction, item in zip(
            instruction_texts, instruction_texts[1:], items, strict=False
        ):
            if item.kind == "do" and instruction[0] == next_instruction[0]:
                if instruction == next_instruction and instruction[0] in ("S", "STOP", "SHOW"):
                    return first_reading.token_texts.count(
                        instruction[0]
                    ) < instruction_texts.count(instruction)
                if (
                    not reading.is_sure
                    and instruction
                    == next_instruction
                    == first_reading.token_texts[: len(instruction)]
                ):
                    return True
        return False

    def apply_first_rewrites(self, reading: Reading) -> Reading:
        """Make the rewrites that come before all others, and make words one that are one."""
        for _ in range(_MAX_FIRST_STEPS):
            joined_name = rewrites.join_one_name(reading.tokens, self.names)
            if joined_name is not None:
                tokens, is_sensor_name = joined_name
                code = codes.NAME_WITH_SPACE if is_sensor_name else codes.OTHER_LANGUAGE
                reading = reading.with_change(tokens, 1.0 if is_sensor_name else 0.5, code)
                continue
            successor = next(self._apply_patterns(reading, None), None)
            if successor is None:
                break
            reading = successor
        return reading

    def rewrite(self, reading: Reading, failure: Failure) -> Iterator[Reading]:
        """Yield the rewrites of a reading if it fails: by rows, calls in words, meanings."""
        rewriters = (self._apply_patterns, self._fill_slots, self._translate_word)
        return map(
            self.apply_first_rewrites,
            chain(*(rewriter(reading, failure) for rewriter in rewriters)),
        )

    def _apply_patterns(self, reading: Reading, failure: Failure | None) -> Iterator[Reading]:
        """Apply the rows that touch a place; without a place, those that come before all others."""
        encoded_words = rewrites.EncodedLine(reading.tokens, self.names)
        for row in rewrites.rows_to_try(encoded_words, is_first=failure is None):
            for match in encoded_words.matches(row.pattern):
                start, end = encoded_words.span(match)
                if failure and not _is_near(failure, start, end):
                    continue
                tokens = encoded_words.apply_row(row, match)
                if tokens is not None:
                    is_new_line = ";" in row.replacement
                    yield reading.with_change(
                        tokens, row.cost, row.code, not row.is_offered, is_new_line
                    )
                    break

    def _fill_slots(self, reading: Reading, failure: Failure) -> Iterator[Reading]:
        tokens = reading.tokens
        for start, end in _call_ranges(tokens):
            words = tokens[start:end]
            if not _is_near(failure, start, end):
                continue
            has_until = end < len(tokens) and tokens[end].text == "UNTIL"
            call = fill_call(words, self.names, has_until)
            if call is None or call.times or texts(call.tokens) == texts(words):
                continue
            new_tokens = [*tokens[:start], *call.tokens, *tokens[end:]]
            yield reading.with_change(new_tokens, call.cost, _code_of_call(words), call.is_sure)

    def _translate_word(self, reading: Reading, failure: Failure) -> Iterator[Reading]:
        """Translate the first word outside the language."""
        tokens, padded_texts = reading.tokens, ("", *reading.token_texts, "")
        for k, token in enumerate(tokens[: failure.failed_at + 2]):
            if token.kind is not WORD or (token.text in WORDS and token.text != "SI"):
                continue
            is_function = padded_texts[k] in ("(", ",", *SIGNS) and padded_texts[k + 2] == "("
            is_misspelt = is_function and not lexicon_concept(token.text)
            suggestion = nearest(token.text, FUNCTIONS) if is_misspelt else None
            guesses = (Meaning(suggestion, KNOWN_COST),) if suggestion else ()
            word_meanings = guesses or self.names.meanings(token.text)
            if _has_unlikely_time(tokens, k, word_meanings[0].concept if word_meanings else ""):
                continue
            for concept, cost in word_meanings:
                cost = NEAR_COST if token.text[-1].isdigit() else cost
                if (
                    concept == "TIME"
                    and k > 1
                    and padded_texts[k] == "("
                    and padded_texts[k - 1] in CALL_WORDS
                ):
                    continue  # the unit is for the first value of a call: `F(tiempo, 80)`
                is_sure = cost < 2 and concept != "TIME"
                new_tokens = [
                    *tokens[:k],
                    make_token(concept)._replace(space=token.space),
                    *tokens[k + 1 :],
                ]
                yield reading.with_change(new_tokens, cost, codes.OTHER_LANGUAGE, is_sure)
            if word_meanings:
                break

    def undo_slips(self, reading: Reading, failure: Failure) -> Iterator[Reading]:
        """Yield corrections of one wrong, missing, superfluous or exchanged sign where the line
        fails.
        """
        tokens, (start, failure_index) = reading.tokens, failure
        for k in reversed(range(max(0, start - 1), min(len(tokens) + 1, failure_index + 2))):
            tokens_before, tokens_after = tokens[:k], tokens[k + 1 :]
            for sign, code in rows.CODE_OF_MISSING_SIGN.items():
                yield reading.with_change(
                    [*tokens_before, make_token(sign), *tokens[k:]], rows.MISSING_COST, code
                )
            if k == len(tokens):
                continue
            token = tokens[k]
            is_sign, is_bracket = token.kind not in (WORD, NUMBER), token.text in ("(", ")")
            neighbour_texts = texts((*tokens_before[-1:], *tokens_after[:1]))
            for sign in rows.SIGNS_MEANT_BY.get(token.text, ""):
                code = codes.MISSING_SEPARATOR if sign == ";" else codes.OTHER_CALL
                new_tokens = [*tokens_before, make_token(sign), *tokens_after]
                yield reading.with_change(
                    new_tokens, rows.CONFUSED_COST, code, sign not in neighbour_texts
                )
            is_needed = _CALCULATION_SIGNS & {
                token.text,
                *texts(tokens_after[:1]),
            } or _is_grouping_bracket(tokens, k)
            if is_sign and not is_needed and category(token.text[0]) != "Sm":
                code = codes.EXTRA_CLOSE if token.text == ")" else codes.OTHER_CALL
                yield reading.with_change(
                    [*tokens_before, *tokens_after], rows.EXTRA_COST, code, is_bracket
                )
            if tokens_after and (is_bracket or tokens_after[0].text in ("(", ")")):
                if not is_sign or tokens_after[0].kind in (WORD, NUMBER):
                    new_tokens = [*tokens_before, tokens_after[0], token, *tokens_after[1:]]
                    yield reading.with_change(new_tokens, rows.SWAPPED_COST, codes.MISSING_OPEN)


def _is_grouping_bracket(tokens: Sequence[Lexeme], k: int) -> bool:
    """Return whether a bracket groups a part of a sum, whose value depends on it."""
    previous_text = tokens[k - 1].text if k else ""
    texts_after = [token.text for token in tokens[k + 1 :]]
    return (
        tokens[k].text == "("
        and previous_text in ("=", *SIGNS)
        and bool(_CALCULATION_SIGNS & {*texts_after})
    )


def _code_of_call(words: Sequence[Lexeme]) -> Code:
    """Return the code for words that are not a call as written."""
    signs = texts(words)
    if signs[0] not in WORDS:
        return codes.OTHER_LANGUAGE
    if "(" not in signs:
        return codes.MISSING_OPEN
    if "=" in signs:
        return codes.NAMED_ARGUMENT
    argument_tokens = words[signs.index("(") :]
    if any(
        lexicon_meaning(token.text, "unit") and token.text not in (*EXTENTS, "°", "º")
        for token in argument_tokens
    ):
        return codes.UNIT
    return codes.OTHER_CALL


def _is_near(failure: Failure, start: int, end: int) -> bool:
    return start <= failure.failed_at + 1 and end >= failure.start - 1


def _has_unlikely_time(tokens: Sequence[Lexeme], k: int, concept: str) -> bool:
    """Return whether a number after a translated word rarely means seconds: `move(50, 50)`."""
    numbers = [token for token in tokens[k + 1 : k + 3] if token.kind is NUMBER]
    least_time = LONG_TIME_S if concept in (*MOVES, "BEEP") else MIN_MILLISECONDS
    is_timed = concept in (*MOVES, "BEEP", "W")
    return is_timed and bool(numbers) and float(numbers[0].text) >= least_time


def _call_ranges(tokens: Sequence[Lexeme]) -> Iterator[tuple[int, int]]:
    """Yield the parts of a line that may contain a call: between separators and headers."""
    start = 0
    for k, token in enumerate([*tokens, make_token(";")]):
        is_edge = token.text in _EDGE_WORDS
        is_next_call = k > 0 and tokens[k - 1].text == ")" and token.text in CALL_WORDS
        if (is_edge or is_next_call) and start < k:
            yield start, k
            start = k
        if is_edge:
            start = max(start, k + 1)
        if token.text in _WORDS_AT_END:
            start = max(start, brackets_end(tokens, k + 1) or k + 2)
