"""Suggestions: messages about words that no repair reads with certainty.

Reads each instruction of a line with the words after it, and words without one, by the rows of
`suggestion_rows`; `matching_rows` finds them, for `usage`, too. Knows no row and no sentence of any
language.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cache
from itertools import islice
from typing import NamedTuple, Protocol

from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Span, edits_overlap
from tiniscript.base.spelling import nearest
from tiniscript.base.words import BLOCK_ENDS, OPPOSITE_MOVES, UNIT_OF, WORDS
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import CODES, Code, Diagnostic
from tiniscript.recovery import lines, rewrites, suggestion_rows
from tiniscript.recovery.instructions import (
    SpokenInstruction,
    condition_in,
    instructions_text,
    samples_text,
    spoken_instructions,
)
from tiniscript.recovery.meanings import (
    ASKING_WORDS,
    NEAR_COST,
    Lexeme,
    Names,
    lexemes,
    lexicon_meaning,
    make_token,
    plain,
)
from tiniscript.recovery.slots import fill_call
from tiniscript.recovery.trailing_tokens import (
    LineContext,
    TrailingTokens,
    instruction_length,
    token_width,
    words_set,
)
from tiniscript.recovery.worded import condition_values, sensors_of
from tiniscript.recovery.writing import format_line, shorten, split_note
from tiniscript.syntax.blocks import WORD_OF_END
from tiniscript.syntax.free_names import free_number_name
from tiniscript.syntax.lexer import QUOTES, WORD
from tiniscript.syntax.operators import COMPARISONS

MAX_WORDS = 24  # words after an instruction that are read
MAX_INSTRUCTIONS = 1_000  # instructions of a text that are read
# Codes of words that a repair may read better.
_SECONDARY_CODES = (codes.REPEATED, codes.WORDS_AFTER)
_NOTE_CODES = (codes.WORDS_AFTER, codes.SEVERAL_INSTRUCTIONS)
_UNIT_MEANINGS = (("s",), ("cm",), ("°",), ("%",), ("Hz",))
_PROSE_SIGNS = frozenset((",", ".", ":", "!", "\u00a1", *QUOTES))
_MAX_REPEATED = 8  # instructions that an example repeats
_MAX_LINES_BACK = 40  # lines and instructions that are searched for repetitions
_BODY_STARTS = (*BLOCK_ENDS, "ELSE", "ELSEIF")
# An instruction of a line, and the bar of a `SI|`.
_INSTRUCTION_AND_BAR = re.compile(r"((?:[^;{}|]|\|\|)+)(\|?)")
_REPEATED_INSTRUCTIONS = re.compile(r"(.+?;)\1*")  # instructions that the others repeat
_CHOICE_CALL = re.compile(r"\s*(\w+)\s*(\([0-9., ]*\))?\s*")
_LINE_COUNT = re.compile(r"^\s*\d{1,2}\s*[.)]\s*(?=[A-Za-z])")
_SHORTEST_WORD = 3  # letters: X is rather a variable
_NEEDLESS_SIGNS = ".:,\\* \"'`´“”‘’«»"  # signs that a note needs not


class SuggestionRow(NamedTuple):
    """A row: its code is None if it extends the original message, and `conditions` limit its
    places.
    """

    pattern: rewrites.Pattern
    code: Code | None
    conditions: Sequence[str]
    values: dict[str, str]
    example: tuple[str, str]


class Subject(Protocol):
    """The subject of rows: the first word, and the `row_tokens` after it."""

    text: str
    names: Names

    @property
    def row_tokens(self) -> Sequence[Lexeme]: ...

    @property
    def spans(self) -> Sequence[Span]: ...

    @property
    def gap_functions(self) -> Mapping[str, Callable[[Gaps], str]]: ...

    def labels(self) -> list[str]: ...

    def values(self) -> dict[str, str]: ...

    def several_values(self, name: str, gaps: Gaps) -> Mapping[str, str]: ...


class Suggestion(NamedTuple):
    """A suggestion, and the words to skip so that the rest can be read."""

    diagnostic: Diagnostic
    blanking_edit: Edit


@cache
def rows() -> tuple[SuggestionRow, ...]:
    compiled_rows = []
    for pattern, code, values, example in rewrites.cells(suggestion_rows.SUGGESTIONS):
        named_values = dict(
            assignment.split("=", 1) for assignment in values.split("; ") if assignment
        )
        wrong_text, _, right_text = example.replace("⏎", "\n").rpartition(" => ")
        compiled_pattern = rewrites.compile_pattern(pattern, suggestion_rows.PARTS)
        code_number, *conditions = code.split()
        compiled_rows.append(
            SuggestionRow(
                compiled_pattern,
                CODES.get(code_number),
                conditions,
                named_values,
                (wrong_text, right_text),
            )
        )
    return tuple(compiled_rows)


@cache
def _row_index() -> rewrites.RowIndex:
    return rewrites.index_rows({k: row.pattern for k, row in enumerate(rows())})


def find_suggestions(text: str, kit: Kit) -> list[Suggestion]:
    """Return the suggestions for words after or instead of instructions."""
    bodies = [split_note(line)[0] for line in text.split("\n")]
    names = Names([lexemes(body) for body in bodies], kit)
    suggestions: list[Suggestion] = []
    instructions_above: list[str | None] = []
    line_start = depth = 0
    instructions_left = MAX_INSTRUCTIONS
    for body, line in zip(bodies, text.split("\n"), strict=True):
        suggestions_of_line: list[Suggestion] = []
        tokens = lexemes(body)
        is_right = lines.is_right(tokens, names)
        if "~" not in body and not is_right:
            for trailing_words in islice(
                _trailing_words(
                    body, line_start, LineContext(text, names, depth, instructions_above)
                ),
                instructions_left,
            ):
                instructions_left -= 1
                suggestion = _suggestion_for(trailing_words)
                if suggestion and not (
                    suggestions_of_line
                    and edits_overlap(
                        [suggestions_of_line[-1].blanking_edit], [suggestion.blanking_edit]
                    )
                ):
                    suggestions_of_line.append(suggestion)
        suggestions += suggestions_of_line
        if body.strip() and not any(
            suggestion.diagnostic.code is codes.SAME_AGAIN for suggestion in suggestions_of_line
        ):
            uncounted_text = _LINE_COUNT.sub("", body)  # `2. S`
            is_right = is_right or (
                uncounted_text != body and lines.is_right(lexemes(uncounted_text), names)
            )
            instructions_above.append(
                _as_instructions(uncounted_text.partition("|")[2] or uncounted_text, is_right)
            )
        depth += sum((token.text in BLOCK_ENDS) - (token.text in WORD_OF_END) for token in tokens)
        line_start += len(line) + 1
    return suggestions


def _as_instructions(line: str, is_right: bool) -> str | None:
    """Return a line of instructions, "" for another one, None for one that begins a block."""
    first_words = [tokens[0].text for tokens in map(lexemes, line.split(";")) if tokens]
    if first_words and first_words[-1] in _BODY_STARTS:
        return None
    is_right = is_right and not {*first_words} & {*_BODY_STARTS, *WORD_OF_END}
    return line.strip().rstrip(" ;") if is_right else ""


def _trailing_words(body: str, start: int, line_context: LineContext) -> Iterator[_TrailingWords]:
    """Yield each instruction of a line with the words after it, and words without one."""
    names = line_context.names
    instructions_before: list[str | None] = []
    for match in _INSTRUCTION_AND_BAR.finditer(body):
        tokens, start_offset = lexemes(match[1]), start + match.start()
        if not tokens or match[2]:
            continue
        is_block = tokens[0].text in (*_BODY_STARTS, *WORD_OF_END)
        while 0 < len(tokens) <= lines.MAX_TOKENS:
            instruction_size = instruction_length(tokens, names)
            tokens_after = tokens[instruction_size:]
            if not instruction_size and (spoken_call := _spoken_call(tokens, names)):
                yield _TrailingWords(
                    line_context,
                    start_offset,
                    tokens,
                    spoken_call[0],
                    instructions_before,
                    spoken_call[1],
                )
                break
            if not instruction_size or not tokens_after:
                yield _TrailingWords(line_context, start_offset, tokens, 0, instructions_before)
                break
            if any(token.text in ASKING_WORDS for token in tokens[:instruction_size]):
                has_only_then = all(
                    lexicon_meaning(item.text, "do") for item in tokens_after
                )  # the condition ends at a THEN
                yield _TrailingWords(
                    line_context,
                    start_offset,
                    tokens if has_only_then else tokens[:instruction_size],
                    0,
                    instructions_before,
                )
            if not instruction_length(tokens_after, names) or tokens_after[0].text in (
                "IF",
                "WHILE",
            ):
                yield _TrailingWords(
                    line_context, start_offset, tokens, instruction_size, instructions_before
                )
                break
            start_offset += sum(map(token_width, tokens[:instruction_size]))
            tokens = tokens_after
        instructions_before = [*instructions_before, None if is_block else match[1].strip()]


def matching_rows(subject: Subject) -> Iterator[tuple[SuggestionRow, Gaps]]:
    """Yield the rows that apply at a place, with the values of their gaps, in table order."""
    encoded_line = rewrites.EncodedLine(
        [make_token(";"), *subject.row_tokens], subject.names, subject.labels()
    )
    for k in encoded_line.candidate_rows(_row_index()):
        row = rows()[k]
        if match := next(encoded_line.matches(row.pattern), None):
            gaps = Gaps(subject, encoded_line, match)
            with suppress(UnfillableGap):
                gaps.fill(row)
                yield row, gaps


def _suggestion_for(trailing_words: _TrailingWords) -> Suggestion | None:
    if len(trailing_words.row_tokens) > MAX_WORDS or not trailing_words.may_say_something():
        return None
    for row, gaps in matching_rows(trailing_words):
        is_aside = (
            row.code in _SECONDARY_CODES
            and trailing_words.tokens
            and _is_read_surely(trailing_words)
        )
        return None if is_aside else _suggestion(row, gaps)
    return None


def _is_read_surely(trailing_tokens: TrailingTokens) -> bool:
    """Return whether a repair of the whole instruction is unambiguous."""
    if trailing_tokens.command == "DEF":
        return False  # the first word may be a name of its own
    readings = lines.read(
        [*trailing_tokens.tokens, *trailing_tokens.row_tokens], trailing_tokens.names, is_quick=True
    )
    return bool(readings) and readings[0].is_sure and len(readings[0].items or ()) == 1


class _TrailingWords(TrailingTokens):
    """Words after an instruction, or without one, as a place of rows."""

    def __init__(
        self, line_context: LineContext, start: int, tokens: Sequence[Lexeme],
        instruction_size: int, instructions_before: Sequence[str | None], spoken_call: str = "",
    ) -> None:  # fmt: skip
        super().__init__(
            line_context, start, tokens, instruction_size, instructions_before, spoken_call
        )
        self.gap_functions = _GAP_FUNCTIONS

    def values(self) -> dict[str, str]:
        return {"before": shorten(self.call_text), "words": shorten(self.words_text), "fix": ""}

    def several_values(self, name: str, gaps: Gaps) -> Mapping[str, str]:
        return _condition_gaps(gaps)


def _suggestion(row: SuggestionRow, gaps: Gaps) -> Suggestion:
    trailing_tokens, group_names, values = (
        gaps.trailing_tokens,
        row.pattern.label_pattern.groupindex,
        gaps.filled_values,
    )
    fix_span = trailing_tokens.whole_span if values["fix"] else None
    is_right = lines.is_right(trailing_tokens.tokens, trailing_tokens.names)
    if fix_span and not is_right and values["fix"].startswith(trailing_tokens.call_text):
        fix_span = trailing_tokens.words_span  # the call has a mistake of its own
        values["fix"] = values["fix"][len(trailing_tokens.call_text) :].lstrip(" ")
    start, end = gaps.span("s") if "s" in group_names else (1, len(trailing_tokens.spans))
    span = Span(trailing_tokens.spans[start].start, trailing_tokens.spans[end - 1].end)
    code = row.code
    assert code is not None
    has_other_values = any(values[gap] for gap in values if gap not in ("before", "words", "order"))
    has_note = "//" in values["fix"] or not has_other_values
    if code in _NOTE_CODES and trailing_tokens.tokens and not has_note:
        # A change without effect on movement comes first.
        values = {**values, **_note_values(trailing_tokens)}
    if code is codes.OTHER_LANGUAGE and values["found"].upper() == values["right"]:
        code, values = codes.MISSING_OPEN, {**values, "word": values["right"], "words": ""}
    diagnostic = Diagnostic(code, span, values, fix_span)
    if "h" in group_names:
        fix_span = Span(
            trailing_tokens.spans[gaps.span("h")[0]].start, trailing_tokens.words_span.end
        )
        condition = values.get("asked") or values.get("question") or "TRUE"
        return Suggestion(diagnostic, Edit(fix_span, f"{gaps['head']}({condition})"))
    if trailing_tokens.is_spoken:
        return Suggestion(
            diagnostic, Edit(trailing_tokens.whole_span, values["fix"] or trailing_tokens.call_text)
        )
    fix = "" if trailing_tokens.tokens else values["fix"]
    return Suggestion(
        diagnostic,
        Edit(
            trailing_tokens.words_span,
            fix or " " * (trailing_tokens.words_span.end - trailing_tokens.words_span.start),
        ),
    )


def _spoken_call(tokens: Sequence[Lexeme], names: Names) -> tuple[int, str] | None:
    """Return the call that words before a condition say, and how many they are."""
    concepts = [names.find_meaning(token.text, NEAR_COST) for token in tokens]
    condition_index = next((k for k in range(1, len(tokens)) if concepts[k] in ("IF", "WHILE")), 0)
    has_until = concepts[condition_index] == "WHILE"
    call = (
        fill_call(tokens[:condition_index], names, has_until, is_instruction=True)
        if condition_index
        else None
    )
    return (condition_index, format_line(call.tokens)) if call and not call.times else None


class UnfillableGap(Exception):
    """A gap of a row cannot be filled."""


class Gaps(dict[str, str]):
    """Fills the gaps of a row: captures, and the functions of its place.

    `filled_values` are the values so far: a gap may speak of those before it.
    """

    def __init__(
        self, subject: Subject, encoded_words: rewrites.EncodedLine, match: re.Match[str]
    ) -> None:
        self.subject = subject
        self.filled_values: dict[str, str] = {}
        self._line = encoded_words
        self._match = match

    @property
    def trailing_tokens(self) -> TrailingTokens:
        assert isinstance(self.subject, TrailingTokens)
        return self.subject

    def fill(self, row: SuggestionRow) -> None:
        self.filled_values = self.subject.values()
        for name, template in row.values.items():
            if name == "*":
                self.filled_values |= self.subject.several_values(template, self)
            else:
                self.filled_values[name] = template.format_map(self)
        self.filled_values.pop("?", None)

    def __missing__(self, name: str) -> str:
        gap = name.rstrip("?")
        text = (
            self.subject.gap_functions[gap](self)
            if gap in self.subject.gap_functions
            else self.captured_text(gap)
        )
        if not text and gap == name:
            raise UnfillableGap
        return text

    def span(self, name: str) -> tuple[int, int]:
        """Return the token range of a capture."""
        return self._line.span(self._match, name)

    def tokens(self, name: str) -> Sequence[Lexeme]:
        start, end = self.span(name)
        return self.trailing_tokens.row_tokens[start - 1 : end - 1]

    def tokens_from(self, name: str) -> Sequence[Lexeme]:
        """Return the words from a capture on."""
        return self.trailing_tokens.row_tokens[self.span(name)[0] - 1 :]

    def meant_word(self, name: str) -> str:
        """Return the word of the language that a capture begins with."""
        return self.trailing_tokens.meant_word(self.tokens_from(name)[0].text)

    def captured_text(self, name: str) -> str:
        start, end = self.span(name)
        if start == end:
            return ""
        if start == 0:
            return self.trailing_tokens.call_text
        if name == "n":
            return self.number_at(start - 1)
        spans = self.trailing_tokens.spans
        return self.trailing_tokens.text[spans[start].start : spans[end - 1].end]

    def number_at(self, k: int) -> str:
        """Return the number at a place in the unit of an instruction: `0.5` for `500 ms`."""
        number = self.trailing_tokens.number(k) or ""
        unit_meaning = (
            lexicon_meaning(self.trailing_tokens.row_tokens[k + 1].text, "unit")
            if k + 1 < len(self.trailing_tokens.row_tokens)
            else ()
        )
        if unit_meaning[:1] == ("s",) and unit_meaning[1] != "1000":
            return f"{float(number) * int(unit_meaning[1]) / 1000:g}"
        return number


def _loop_over_all(gaps: Gaps, times: str) -> str:
    """The loop that repeats everything before it that many times, or nothing if that is long."""
    trailing_tokens, lines_before = (
        gaps.trailing_tokens,
        [line for line in gaps.trailing_tokens.instructions_before if line],
    )
    has_all_instructions = (
        len(lines_before) == len(trailing_tokens.instructions_before) <= _MAX_LINES_BACK
    )
    if not has_all_instructions or trailing_tokens.is_in_block or times in ("", "0", "1"):
        return ""
    instructions = [
        instruction.strip()
        for line in (*lines_before, trailing_tokens.call_text)
        for instruction in line.split(";")
    ]
    repeated_instructions = [
        instruction for instruction in instructions if instruction.upper() not in ("", "START")
    ]
    text = "".join(f"{instruction};" for instruction in repeated_instructions)
    if repeated_match := _REPEATED_INSTRUCTIONS.fullmatch(
        "".join(text.split()).upper()
    ):  # F and L of `F; L; F; L`
        repeated_instructions = repeated_instructions[: repeated_match[1].count(";")]
    if not 0 < len(repeated_instructions) <= _MAX_REPEATED:
        return ""
    return ";".join((f"LOOP({times})", *repeated_instructions, BLOCK_ENDS["LOOP"]))


def _condition_gaps(gaps: Gaps) -> dict[str, str]:
    """Return the values of a condition in words."""
    tokens, names = gaps.tokens("s"), gaps.trailing_tokens.names
    is_bare = [token.text for token in gaps.tokens_from("s")[len(tokens) :][:1]] != [")"]
    is_for_instruction = is_bare and gaps["head"] == "UNTIL" and not gaps.trailing_tokens.tokens
    is_for_instruction |= is_bare and any("|@start|" in names.label(token) for token in tokens)
    has_other_reader = is_for_instruction or bool(_condition_tokens(gaps, "s"))
    values = None if has_other_reader else condition_values(tokens, names)
    if values is None:
        raise UnfillableGap
    return values


def _sensor(gaps: Gaps, k: int) -> str:
    """Return a sensor that a word may mean."""
    return "".join(sensors_of(plain(gaps["l"]), gaps.trailing_tokens.names)[k : k + 1])


def _measured_condition(gaps: Gaps) -> str:
    """Return the condition of words with a number of their own: `la pared a 30 cm`."""
    words = gaps.tokens("l")
    has_word = any(
        word.kind is WORD and not lexicon_meaning(word.text, "unit", "in") for word in words
    )
    return (
        (condition_values(words, gaps.trailing_tokens.names) or {}).get("asked", "")
        if has_word
        else ""
    )


def _sensor_on_side(gaps: Gaps) -> str:
    """Return the sensor on the side of an L or R that is not a name."""
    word, part = gaps["s"].upper(), gaps.trailing_tokens
    return "" if word in words_set(part.text) else part.names.sensor_on_side(word)


def _lone_condition(gaps: Gaps) -> str:
    """A condition on its own, without an effect."""
    texts = {token.text for token in gaps.tokens("s")}
    return format_line(_condition_tokens(gaps, "s")) if texts & {*COMPARISONS} - {"="} else ""


def _consequence(gaps: Gaps) -> str:
    """Return the consequence: the words from a capture on if correct, or their meaning."""
    words, names = gaps.tokens_from("w"), gaps.trailing_tokens.names
    return (
        _rest_of_words(gaps, "w")
        if lines.is_right(words, names)
        else instructions_text(spoken_instructions(words, names))
    )


def _free_name(gaps: Gaps) -> str:
    """Return an unused name for the value before it."""
    names, name = gaps.trailing_tokens.names, plain(gaps["x"])
    is_name = all(token.kind is WORD for token in gaps.tokens("v"))
    is_taken = name in names.sensors or name in names.defs or name in names.actuators
    return "" if is_name or is_taken else name


def _choice(gaps: Gaps, is_exact: bool = False) -> str:
    """An IF that asks RANDOM which of some instructions is done; `is_exact`: by no example."""
    text = f"{gaps.trailing_tokens.call_text},{gaps['l']}".lstrip(",")
    spoken_instructions = []
    for match in map(_CHOICE_CALL.fullmatch, re.split(r",(?![^(]*\))", text)):
        word = WORDS.get(gaps.trailing_tokens.meant_word(plain(match[1]))) if match else None
        if match is None or word is None or not word.role.is_instruction:
            return ""
        if is_exact and word.arguments and not match[2]:
            return ""
        spoken_instructions.append(word.text + match[2] if match[2] else word.example)
    name, count = free_number_name(gaps.trailing_tokens.text), len(spoken_instructions)
    draw, conditions = f"{name} = RANDOM(1, {count}); ", [f"{name} = {k}" for k in range(1, count)]
    if count == 2:
        draw, conditions = "", ["RANDOM(1, 2) = 1"]
    arms = [
        f"ELSEIF({condition}); {instruction}; "
        for condition, instruction in zip(conditions, spoken_instructions, strict=False)
    ]
    return f"{draw}{''.join(arms)[4:]}ELSE; {spoken_instructions[-1]}; ENDIF" if arms else ""


def _loop(gaps: Gaps) -> str:
    number = gaps["n"]
    is_often = number.isdecimal() and number not in ("0", "1")
    return (
        f"LOOP({number});{gaps.trailing_tokens.call_text};{BLOCK_ENDS['LOOP']}" if is_often else ""
    )


def _with_value(gaps: Gaps, match: re.Match[str] | None, template: str) -> str:
    """Return the call with another value that contains the old one; "" if it is the same."""
    template = match.expand(template) if match else ""
    if match is None or match[1] == template:
        return ""
    call_text = gaps.trailing_tokens.call_text
    return f"{call_text[: match.start(1)]}{template}{call_text[match.end(1) :]}"


def _with_power(gaps: Gaps) -> str:
    """The call with another power."""
    number = gaps["n"]
    return (
        _with_value(gaps, gaps.trailing_tokens.power_match, number)
        if 9 < float(number) <= 100
        else ""
    )


def _condition_tokens(gaps: Gaps, name: str = "q") -> list[Lexeme]:
    """The condition that the words express, in the language; nothing if they express none."""
    return (
        []
        if gaps.trailing_tokens.has_until
        else condition_in(gaps.tokens(name), gaps.trailing_tokens.names)
    )


def _shown_word(gaps: Gaps) -> str:
    """Return a word to show, which is neither a letter nor similar to a name of the program."""
    word = gaps["s"]
    names = gaps.trailing_tokens.names
    is_name = len(word) < _SHORTEST_WORD or nearest(plain(word), names.known_names.values)
    return "" if is_name or plain(word) in names.in_brackets else word


def _rest_of_words(gaps: Gaps, name: str) -> str:
    """The words from a capture on."""
    start, end = gaps.span(name)
    return (
        gaps.trailing_tokens.text[
            gaps.trailing_tokens.spans[start].start : gaps.trailing_tokens.whole_span.end
        ]
        if start < end
        else ""
    )


def _stated_instructions(part: TrailingTokens) -> list[SpokenInstruction]:
    """The instructions that the words describe, or nothing if a turn among them lacks a
    direction."""
    found_instructions = spoken_instructions(part.row_tokens, part.names)
    return (
        []
        if any(
            instruction.is_side_free or instruction.is_repeated
            for instruction in found_instructions
        )
        else found_instructions
    )


def _call_and_instructions(gaps: Gaps) -> str:
    """The instruction, and those that the words after it say."""
    found_instructions = _stated_instructions(gaps.trailing_tokens)
    return (
        f"{gaps.trailing_tokens.call_text};{instructions_text(found_instructions)}"
        if found_instructions
        else ""
    )


def _call_with_note(gaps: Gaps) -> str:
    trailing_tokens = gaps.trailing_tokens
    return (
        f"{trailing_tokens.call_text} // {trailing_tokens.words_text.strip(_NEEDLESS_SIGNS)}"
        if _is_last(trailing_tokens)
        else ""
    )


def _is_last(trailing_tokens: TrailingTokens) -> bool:
    """Return whether only a note follows the words on their line."""
    text_behind = (
        trailing_tokens.text[trailing_tokens.whole_span.end :].split("\n")[0].lstrip(" \t;\r")
    )
    return not text_behind or text_behind.startswith("//")


def _note_values(trailing_tokens: TrailingTokens) -> dict[str, str]:
    """Return the message values that turn the words after an instruction into a note, or {} if they
    may belong to it.

    Words with a number, a sign or a word of a program, and words joined to the instruction, may.
    """
    is_joined = lexicon_meaning(
        trailing_tokens.row_tokens[0].text, "then", "and", "or"
    ) or trailing_tokens.row_tokens[0].text in (
        "AND",
        "OR",
    )
    is_prose = all(
        token.kind is WORD or token.text in _PROSE_SIGNS for token in trailing_tokens.row_tokens
    )
    words = trailing_tokens.words_text.strip(_NEEDLESS_SIGNS)
    if (
        is_joined
        or not is_prose
        or not words
        or not lines.is_right(trailing_tokens.tokens, trailing_tokens.names)
    ):
        return {}
    is_instruction = any(
        token.text in WORDS and token.source == token.text for token in trailing_tokens.row_tokens
    )
    is_instruction |= any(
        lexicon_meaning(token.text, "unit")[:1] in _UNIT_MEANINGS
        for token in trailing_tokens.row_tokens
    )
    if is_instruction:
        return {}
    note = f"// {words}"
    return (
        {"note": f"{trailing_tokens.call_text} {note}"}
        if _is_last(trailing_tokens)
        else {"last_note": note}
    )


_GAP_FUNCTIONS: dict[str, Callable[[Gaps], str]] = {
    "above": lambda gaps: ["", *gaps.trailing_tokens.instructions_before][-1] or "",
    "all": lambda gaps: _loop_over_all(gaps, gaps["n?"]),
    "often": lambda gaps: _loop_over_all(gaps, "4"),
    "endless": lambda gaps: _loop_over_all(gaps, "FOREVER"),
    "more": lambda gaps: _loop_over_all(gaps, str(int(gaps["n"]) + 1)),
    "said": lambda gaps: gaps.trailing_tokens.words_text.strip(" ,:"),
    "head": lambda gaps: gaps.meant_word("h"), "called": lambda gaps: gaps.meant_word("w"),
    "block": lambda gaps: gaps.meant_word("g"),
    "usage": lambda gaps: WORDS[gaps.meant_word("w")].usage,
    "choice": lambda gaps: _choice(gaps, is_exact=True).replace("; ", ";"),
    "choices": _choice, "number": lambda gaps: free_number_name(gaps.trailing_tokens.text),
    "example": lambda gaps: WORDS[plain(gaps["w"])].example,
    "reading": _sensor_on_side,
    "next": lambda gaps: WORDS[plain(gaps["s"])].example,
    "one": lambda gaps: _sensor(gaps, 0), "two": lambda gaps: _sensor(gaps, 1),
    "measured": _measured_condition, "alone": _lone_condition, "then": _consequence,
    "free": _free_name,
    "loop": _loop,
    "by_way": lambda gaps:
        _with_value(gaps, gaps.trailing_tokens.time_match,
                    rf"\1 {UNIT_OF[gaps.trailing_tokens.command]}"),
    "text": lambda gaps:
        shorten(gaps.trailing_tokens.text[slice(*gaps.trailing_tokens.whole_span)]),
    "words": lambda gaps: shorten(gaps.trailing_tokens.words_text),
    "end": lambda gaps: "" if _condition_tokens(gaps, "s") else BLOCK_ENDS[gaps.meant_word("g")],
    "shown": _shown_word, "note": _call_with_note,
    "other": lambda gaps:
        re.sub(r"^\w+", OPPOSITE_MOVES[gaps.trailing_tokens.command],
               gaps.trailing_tokens.call_text),
    "once": lambda gaps: gaps.trailing_tokens.call_text if gaps["n"] == "1" else "",
    "longer": lambda gaps: _with_value(gaps, gaps.trailing_tokens.time_match, gaps["n"]),
    "paced": _with_power,
    "question": lambda gaps: format_line(_condition_tokens(gaps)),
    "contrary": lambda gaps:
        format_line(rewrites.negate(it)) if (it := _condition_tokens(gaps)) else "",
    "made_up": lambda gaps: samples_text(_stated_instructions(gaps.trailing_tokens)),
    "until": lambda gaps: f" {_rest_of_words(gaps, 't')}".rstrip(),
    "behind": lambda gaps: _rest_of_words(gaps, "w"), "orders": _call_and_instructions,
    "sensors": lambda gaps: ", ".join(gaps.trailing_tokens.names.sensor_names),
    "distance": lambda gaps: "DISTANCE" if "DISTANCE" in gaps.trailing_tokens.names.sensors else "",
}  # fmt: skip
