"""Usage: a finding with the instruction around it, as a place that rows describe.

The rows of `suggestion_rows` that begin with its code report text that no reader reads. Here are
the classes of such a place, and the gaps of those rows. Knows no row.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import accumulate, dropwhile, pairwise, takewhile
from typing import NamedTuple

from tiniscript.base.fixed_point import ONE, as_text
from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Source, Span
from tiniscript.base.spelling import nearest
from tiniscript.base.words import (
    ALIASES,
    BLOCK_ENDS,
    CONDITION,
    EXTENTS,
    MOVES,
    POWER,
    UNIT_OF,
    VERSION_OF_WORD,
    WORDS,
    Argument,
    Word,
    foreign_word_hints,
)
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.recovery import lines
from tiniscript.recovery.amounts import amount_values
from tiniscript.recovery.calls import likely_word, own_example, usage_of_number
from tiniscript.recovery.ends import candidates_text, possible_last_instructions
from tiniscript.recovery.instructions import (
    SpokenInstruction,
    block,
    condition_in,
    instructions_text,
    samples_text,
    spoken_instructions,
)
from tiniscript.recovery.meanings import (
    ASKING_WORDS,
    INSTRUCTION_WORDS,
    LONG_TIME_S,
    MAX_POWER,
    Lexeme,
    Names,
    brackets_end,
    lexemes,
    lexicon_concept,
    lexicon_meaning,
    make_token,
    plain,
    words_of,
)
from tiniscript.recovery.suggestions import Gaps, SuggestionRow, UnfillableGap, matching_rows
from tiniscript.recovery.trailing_tokens import join_labels, token_width, words_set
from tiniscript.recovery.worded import condition_values
from tiniscript.recovery.writing import (
    format_line,
    instruction_at,
    shorten,
    split_note,
    tokens_of,
)
from tiniscript.syntax.free_names import free_word_name
from tiniscript.syntax.lexer import NUMBER, QUOTES, WORD, Token, scan
from tiniscript.syntax.operators import COMPARISONS
from tiniscript.syntax.outline import Failure

_MEMBER_DOTS = re.compile(
    r"(?i)\b(?P<head>(?P<word>IF|LOOP|WHILE)[ \t]*\([^()\n]*\)"
    r"|DEF[ \t]+(?P<name>\w+)(?:[ \t]*\([^()\n]*\))?)[\s;]*"
    r"(?P<here>(?:\.[ \t]*){2,}|\u2026)[ \t]*\n?[ \t]*(?P<end>END_?\w+|ELSE\w*)?"
)
_UNTIL_BLOCK = re.compile(
    r"(?i)(?P<here>UNTIL)\s*(?P<asked>\([^()\n;]+\))[\s;]*(?P<word>[FBLR])\s*\(\s*"
    rf"(?P<power>[0-9]+)\s*\)[\s;]*(?:{words_of('end')}[ _]?UNTIL\b)?"
)
_UNTIL_END = re.compile(rf"{words_of('end')}_?{words_of('until')}")
_PLAIN_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
_WORDS_WITH_VALUES = (
    "F",
    "B",
    "M",
    "BEEP",
    "W",
)  # order of values: the direction first
_LOW_POWER = 20  # an example of a low power
_MAX_INSTRUCTIONS = 6  # instructions that an example moves into a block
_END_WORD = re.compile(rf"\b{words_of('end')}")
_BLOCK_WORD = re.compile(rf"(?i)(?:{'|'.join((*BLOCK_ENDS, 'END', 'ELSE'))})\b|END_")
_TOP_LEVEL_WORD = re.compile(r"(?i)\s*(?:TASK|DEF|WHEN)\b")
_WORD_CHARACTER = re.compile(r"\w")
_MEMBER_CALL = re.compile(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)+(?=[ \t]*\()")
_CALL_WITH_VALUES = re.compile(r"([^\W\d]\w*)\s*\((?=\W{0,40}\w).*\)", re.DOTALL)
_MAX_HEADER_CHARACTERS = 100  # characters of a DEF before the name of a value
_DEF_AT_END = re.compile(r"(?i)\bDEF\s+(\w+[ \t]*\([^()\n]*)?$")
_OWN_WORD = re.compile(r"(\w{3,})\s*(\(\s*(\d{0,3})\s*\))?")
_ANGLE_AND_POWER = re.compile(r"\(\s*([0-9.]+)\s*,\s*([0-9]+)\s*\)$")
_FOREVER_SECOND = re.compile(r"(?i)([FBLR])\s*\(([^(),]+),\s*FOREVER\s*\)(\s*UNTIL.*)?")
_TURNED_CALL = re.compile(r"(?im)\b[FBLR]\s*\(\s*([0-9.]+)\s*,\s*([0-9]+)\s*\)(?!\s*UNTIL)")
_MAX_CHARACTERS = 120  # characters of a sentence that a message shows
_MAX_DIAGNOSTICS = 30  # diagnostics with further explanations
_VALUE_CODES = (codes.MISSING_COMMA, codes.MISSING_CLOSE, codes.MISSING_VALUE)
_NAME_CODES = (codes.UNKNOWN_NAME, codes.USED_BEFORE_SET)
_DEF_END = re.compile(r"(?i)\bEND_?DEF\b")
_INSTRUCTION_STARTS = (";", "newline", "|")  # tokens after which an instruction begins
_DEF_ENDS = ("END_DEF", "ENDDEF")
_FARTHEST_CM = 400  # more is rather in milliseconds
_NOUN_OF_UNIT = {"s": "seconds", "%": "percent", "Hz": "hertz"}  # noun of each unit
_MAX_END_WORDS = 4  # words: `fin del bucle`
_KINDS_NO_CALL = ("leaves", "again", "etc", "end")
_KINDS_AFTER_NUMBER = (
    "unit",
    "value",
    "number",
    "often",
    "times",
    "to",
    "at",
    "by",
)  # words allowed after a number
_KINDS_NO_NAME = (*_KINDS_NO_CALL, "filler", "same")  # kinds without values


def with_usage(diagnostics: Sequence[Diagnostic], source: Source, kit: Kit) -> list[Diagnostic]:
    """Return the mistakes in a text, with messages that show the right usage."""
    text = _Text(source, kit)
    text.lacks_loop = [
        diagnostic.values["right"]
        for diagnostic in diagnostics
        if diagnostic.code is codes.NOT_OPEN
    ] == ["LOOP"]
    diagnostics = text.with_name(diagnostics)
    results: list[Diagnostic] = []
    for diagnostic in diagnostics[:_MAX_DIAGNOSTICS]:
        results.append(
            (_usage_diagnostic(Usage(text, diagnostic)) if diagnostic.repair is None else None)
            or diagnostic
        )
    parts = [diagnostic for diagnostic in results if diagnostic.values.get("part")]
    if parts and any(
        diagnostic.code is codes.TASK_NOT_TOP for diagnostic in results
    ):  # rather an IF
        part = {"part": parts[0].values["part"]}
        results = [
            diagnostic._replace(values={**diagnostic.values, **part})
            for diagnostic in results
            if diagnostic not in parts
        ]
    if any(
        "usage" in diagnostic.values
        for diagnostic in results
        if diagnostic.code is codes.OUT_OF_RANGE
    ):
        results += text.swapped_moves()
    return [
        diagnostic
        for diagnostic in (*results, *diagnostics[_MAX_DIAGNOSTICS:])
        if not (diagnostic.code in _NAME_CODES and text.is_in_wrong_def(diagnostic, results))
    ]


class _Text:
    def __init__(self, source: Source, kit: Kit) -> None:
        self.source = source
        self.names = Names([*map(tokens_of, source.text.split("\n"))], kit)
        self.setup_word = "".join(re.findall(r"\A\s*(S[IB])\s*\|", source.text.upper()))
        self.lacks_loop = False  # an END_LOOP is left for a header

    @cached_property
    def has_block_ends(self) -> bool:
        """Return whether any block has an end."""
        return _END_WORD.search(plain(self.source.text)) is not None

    def is_in_wrong_def(self, diagnostic: Diagnostic, diagnostics: Sequence[Diagnostic]) -> bool:
        """Return whether a name is in the body of a DEF without parameters."""
        starts = (
            diagnostic_of_def.span.end
            for diagnostic_of_def in diagnostics
            if diagnostic_of_def.code is codes.PARAMETER_NEEDS_NAME
        )
        start = max((start for start in starts if start <= diagnostic.span.start), default=-1)
        return start >= 0 and not _DEF_END.search(self.source.text, start, diagnostic.span.start)

    def swapped_moves(self) -> list[Diagnostic]:
        """Return moves with the power before the time, as another call of the text has them."""
        diagnostics: list[Diagnostic] = []
        for match in _TURNED_CALL.finditer(self.source.text):
            if LONG_TIME_S <= float(match[1]) <= MAX_POWER and 0 < float(match[2]) < LONG_TIME_S:
                fix = f"{match[0][0].upper()}({match[2]}, {match[1]})"
                values = {"time": match[1], "power": match[2], "fix": fix}
                diagnostics.append(Diagnostic(codes.SWAPPED, Span(*match.span()), values))
        return diagnostics

    def innermost_end(self, offset: int) -> str:
        """Return the end of the innermost block that is open at a place, or ""."""
        ends: list[str] = []
        for line in self.source.text[:offset].split("\n"):
            for part in split_note(line)[0].split(";"):
                first_word = next((token.text for token in lexemes(part.rpartition("|")[2])), "")
                concept = {"FOREVER": "LOOP"}.get(
                    self.names.find_meaning(first_word), self.names.find_meaning(first_word)
                )
                if concept in BLOCK_ENDS:
                    ends.append(BLOCK_ENDS[concept])
                elif ends and (
                    concept in BLOCK_ENDS.values() or lexicon_meaning(first_word, "end")
                ):
                    ends.pop()
        return "".join(ends[-1:])

    def with_name(self, diagnostics: Sequence[Diagnostic]) -> Sequence[Diagnostic]:
        """Return diagnostics in which the one DEF without a name has that of an unknown call."""
        nameless_diagnostics = [
            diagnostic for diagnostic in diagnostics if diagnostic.code is codes.DEF_NEEDS_NAME
        ]
        unknown_calls = (
            diagnostic for diagnostic in diagnostics if diagnostic.code is codes.UNKNOWN_WORD
        )
        instructions = (
            (diagnostic, self.source[instruction_at(diagnostic.span, self.source)])
            for diagnostic in unknown_calls
        )
        called_names = (
            diagnostic.values["found"]
            for diagnostic, instruction in instructions
            if len(lexemes(instruction)) == 1
        )
        name = next(called_names, "") if len(nameless_diagnostics) == 1 else ""
        if not name:
            return diagnostics
        nameless_diagnostic, end = nameless_diagnostics[0], nameless_diagnostics[0].span.end
        repair = Repair((Edit(Span(end, end), f" {name}"),), False)
        named_diagnostic = nameless_diagnostic._replace(values={"name": name}, repair=repair)
        return [
            named_diagnostic if diagnostic is nameless_diagnostic else diagnostic
            for diagnostic in diagnostics
            if diagnostic.values.get("found") != name
        ]


def _usage_diagnostic(usage: Usage) -> Diagnostic | None:
    """Return the diagnostic of the first row that applies to a place, or None."""
    return next((usage.diagnostic_of(row, gaps) for row, gaps in matching_rows(usage)), None)


class Usage:
    """A mistake, and the instruction around its place.

    `row_tokens` are the tokens of the instruction; in rows, the finding comes before them.
    """

    def __init__(self, text: _Text, diagnostic: Diagnostic) -> None:
        self.program_text = text
        self.source = text.source
        self.text = text.source.text
        self.names = text.names
        self.diagnostic = diagnostic
        self.instruction_span = instruction_at(diagnostic.span, text.source)
        self.is_begun = self.text[: self.instruction_span.start].strip().upper() == "SB|"
        self.is_first = diagnostic.span.start == self.instruction_span.start
        self.text_after = self.text[diagnostic.span.end :]
        self.row_tokens = lexemes(self.source[self.instruction_span])
        self.words = [token.text for token in self.row_tokens if token.kind is WORD]
        self.token_texts = [token.text for token in self.row_tokens]
        self.number_text = next(
            (token.text for token in self.row_tokens[1:] if token.kind is NUMBER), "1"
        )
        self.gap_functions = GAP_FUNCTIONS
        ends = [
            *accumulate(map(token_width, self.row_tokens), initial=self.instruction_span.start)
        ][1:]
        spans = (
            Span(end - len(token.source or ""), end)
            for token, end in zip(self.row_tokens, ends, strict=True)
        )
        self.spans = [diagnostic.span, *spans]

    def match_here(self, pattern: re.Pattern[str]) -> re.Match[str] | None:
        """Return the match of a pattern whose part `here` begins at the place."""
        matches = pattern.finditer(self.text)
        return next(
            (match for match in matches if match.start("here") == self.diagnostic.span.start), None
        )

    # -- classes ----------------------------------------------------------------------------------

    def labels(self) -> list[str]:
        """Return the classes of what was found, and of each token, as patterns match them."""
        return [self._label_of_found(), *map(self._label_of, range(len(self.row_tokens)))]

    def _label_of_found(self) -> str:
        code, found_text = self.diagnostic.code, self.source[self.diagnostic.span]
        is_strange = code is codes.UNKNOWN_WORD and self.is_first and bool(self.row_tokens)
        is_strange = is_strange and not self.diagnostic.values.get("near")
        words = (*self.words, "_".join(self.words[:2]))  # `turn on the led`, `u turn`
        are_sentence = (
            len(self.words) > 1 and len(self.source[self.instruction_span]) <= _MAX_CHARACTERS
        )
        labels: dict[str, object] = {
            code.number: True,
            "@bare": code is codes.MISSING_OPEN and self.is_first,
            f"@{code.number}_{found_text.upper()}": True,
            "@values": code in _VALUE_CODES,
            "@twice": code is codes.SETUP_TWICE,
        }
        if code is codes.ODD_CHARACTER:
            next_character = self.text_after[:1]
            labels |= {
                "@upside": found_text in "\u00a1\u00bf" and len(self.words) > 1,
                "@negating": found_text == "!" and next_character not in ("", "\n", " "),
                "@brace": found_text in ("{", "}"),
                "@quoted": found_text in QUOTES,
            }
        if code is codes.RESERVED:
            labels["@clocked"] = bool(self.other_name.assignment) and self.other_name.word == "TIME"
        if is_strange:
            labels |= {
                "@strange": True,
                "@pressed": self._is_pressed(),
                "@instead": foreign_word_hints(self.token_texts[0]),
                "@switched": any(lexicon_meaning(word, "on", "off") for word in words),
                "@button": any(map(self.is_button, self.words)) and self.token_texts[1:2] != ["("],
                "@turned": any(lexicon_meaning(word, "turn", "lap") for word in self.words),
                "@sentence": are_sentence and not {*self.token_texts} & {*COMPARISONS, "(", "="},
            }
        return join_labels("\x01", labels)

    def _is_pressed(self) -> bool:
        """Return whether parts of a word mean that a button is pressed: `onButtonPressed(…)`."""
        word_parts = re.findall("[A-Z]?[a-z]+", self.source[self.instruction_span].split("(")[0])
        return len(word_parts) > 1 and any(self.is_button(plain(part)) for part in word_parts)

    def _label_of(self, k: int) -> str:
        text, span = self.row_tokens[k].text, self.spans[k + 1]
        has_meaning = bool(
            self.names.find_meaning(text) or lexicon_meaning(text, "turn", "end", "short")
        )
        labels = {
            "@quote": text in QUOTES,
            "@known": text in WORDS,
            "@loose": not k and not has_meaning,
            "@button": self.is_button(text),
            "@behind": span.start >= self.diagnostic.span.start,
        }
        return join_labels(self.names.label(self.row_tokens[k])[:-2], labels)

    # -- the place of the message
    # --------------------------------------------------------------------

    def diagnostic_of(self, row: SuggestionRow, gaps: Gaps) -> Diagnostic:
        """Return the diagnostic of a row, at the place or at its words."""
        values, fix = gaps.filled_values, gaps.filled_values.get("fix", "")
        span = next(
            (
                _SPAN_FUNCTIONS[condition](self)
                for condition in row.conditions
                if condition in _SPAN_FUNCTIONS
            ),
            self.diagnostic.span,
        )
        code = row.code or self.diagnostic.code
        if row.code is None:
            values = {**self.diagnostic.values, **values}
        place = self.instruction_span if {*row.conditions} & {"offered", "whole"} else None
        repair = (
            Repair((Edit(self.instruction_span, fix),), False)
            if "offered" in row.conditions
            else None
        )
        if "everywhere" in row.conditions:
            edits = (Edit(condition, values["right"]) for condition in self.name_spans())
            repair = Repair(tuple(edits), False)
        diagnostic = Diagnostic(code, span, values, place, repair)
        if "again" not in row.conditions:
            return diagnostic
        return _usage_diagnostic(Usage(self.program_text, diagnostic)) or diagnostic

    def values(self) -> dict[str, str]:
        """Return the values of the message before the row's gaps are filled."""
        return {}

    def several_values(self, name: str, gaps: Gaps) -> Mapping[str, str]:
        """Return values that come together."""
        values = _SEVERAL_FUNCTIONS[name](self, gaps.filled_values.get("word", ""))
        if not values:
            raise UnfillableGap
        return values

    # -- the meaning of its words -----------------------------------------------------------------

    def usage(self, word: str) -> str:
        """Return the usage of an instruction: a block with its end, if the text has none."""
        if word in ASKING_WORDS and (question := self.question(word)):
            return question
        if word in ("L", "R") and (
            angle := _ANGLE_AND_POWER.search(self.source[self.instruction_span])
        ):
            if float(angle[1]) >= LONG_TIME_S:  # `turnLeft(90, 70)`: no seconds
                return f"{word}({angle[1]} DEG, {angle[2]})"
        numbers = [token.text for token in self.row_tokens if token.kind is NUMBER]
        if (
            len(numbers) == 1
            and "(" not in self.token_texts
            and (usage_with_number := usage_of_number(word, numbers[0]))
        ):
            return usage_with_number
        if word == "SHOW" and (
            used_variables := [word for word in self.words if word in self.names.variables]
        ):
            return f"{word}({used_variables[0]})"
        is_ended = word in BLOCK_ENDS and self.program_text.has_block_ends
        if word not in BLOCK_ENDS or (is_ended and word != "LOOP"):
            return _usage(word)
        loop_readings = (
            lines.read(self.row_tokens, self.names) if word == "LOOP" else []
        )  # otherwise it is a guess
        is_head = bool(loop_readings) and [item.kind for item in loop_readings[0].items or ()] == [
            "open"
        ]
        head = format_line(loop_readings[0].tokens).strip("; ") if is_head else _usage(word)
        return head if is_ended else f"{head}; ...; {BLOCK_ENDS[word]}"

    def question(self, word: str) -> str:
        """Return a header with the question that was written, without numbers that were not.

        Return nothing if the text asks for neither a number nor a yes or no.
        """
        tokens = self.question_tokens(word)
        if not any(token.kind is NUMBER or self.names.is_yes_no(token.text) for token in tokens):
            return ""
        text = format_line(condition_in(tokens, self.names))
        return f"{word}({text})" if text else WORDS[word].usage

    def question_tokens(self, word: str) -> list[Lexeme]:
        """Return the tokens of a header up to its body."""
        tokens_behind = [
            *dropwhile(lambda token: self.names.find_meaning(token.text) != word, self.row_tokens)
        ][1:]
        concepts = [self.names.find_meaning(token.text) for token in tokens_behind]
        are_instructions = (
            concept in INSTRUCTION_WORDS
            and (concept not in ("L", "R") or next_token.text == "(")  # `pared a la derecha`
            for concept, next_token in zip(
                concepts, [*tokens_behind, make_token(";")][1:], strict=True
            )
        )
        are_ends = [
            _ends_question(token) or is_instruction
            for token, is_instruction in zip(tokens_behind, are_instructions, strict=True)
        ]
        return tokens_behind[: [*are_ends, True].index(True)]

    def is_button(self, word: str) -> bool:
        return "BUTTON" not in self.names.sensors and lexicon_concept(word) == "BUTTON"

    @cached_property
    def instruction_of_word(self) -> dict[str, str]:
        """The words of no program that mean an instruction, and which."""
        concept_of_word = {
            word: self.names.find_meaning(word) for word in self.words if word not in WORDS
        }
        return {
            item: instruction_word
            for item, instruction_word in concept_of_word.items()
            if instruction_word in WORDS and WORDS[instruction_word].role.is_instruction
        }

    @property
    def instruction_name(self) -> str:
        """The first word that means an instruction; without brackets it is what lacks them."""
        is_bare = self.diagnostic.code is codes.MISSING_OPEN
        return (
            self.diagnostic.values["word"] if is_bare else next(iter(self.instruction_of_word), "")
        )

    @cached_property
    def spoken_instructions(self) -> list[SpokenInstruction]:
        return spoken_instructions(self.row_tokens, self.names) if self.instruction_name else []

    def word_meaning(self, concept: str, default: str) -> str:
        """Return the word that this one means, or `default`."""
        return next(
            (text for text in self.token_texts if self.names.find_meaning(text) == concept != text),
            default,
        )

    @cached_property
    def turn(self) -> _Turn:
        """A turn that says no way, or no number."""
        words = (*self.words, "_".join(self.words[:2]))
        direction = next(
            (
                concept
                for concept in map(self.names.find_meaning, self.words)
                if concept in ("L", "R")
            ),
            "",
        )
        degrees = {"half": "180", "whole": "360"}
        turn_kinds = (
            kind for kind in degrees if any(lexicon_meaning(word, kind) for word in words)
        )
        angle = degrees.get(next(turn_kinds, ""), "")
        is_timed = any(
            lexicon_meaning(word, "unit")[:1] not in ((), ("turns",)) for word in self.words
        )
        numbers = [token.text for token in self.row_tokens if token.kind is NUMBER]
        if len(numbers) == 1 and float(numbers[0]) >= LONG_TIME_S and not is_timed:
            angle = numbers[0]  # `SPIN 360`: no time, and no power
        turns = spoken_instructions(self.row_tokens, self.names)
        values = format_line(self.row_tokens[1:])
        is_call = all(float(number) <= MAX_POWER for number in numbers)
        if angle and not is_timed:
            return _Turn(direction, angle, f"({angle} DEG, 60)")
        has_no_sample_time = len(turns) == 1 and not any(
            sample.endswith(" s") for sample in turns[0].samples
        )
        if has_no_sample_time and turns[0].is_side_free:
            return _Turn(direction, "", turns[0].text[1:])
        if not direction and is_call and lines.is_right(lexemes(f"L{values}"), self.names):
            return _Turn(direction, "", values)  # `VOLTA(2, 80)`
        return _Turn(direction, "", "")

    @cached_property
    def own_word(self) -> _OwnWord:
        """A word of the program's own that is not defined."""
        instruction_text = plain(self.source[self.instruction_span])
        match = _OWN_WORD.fullmatch(instruction_text)
        name, is_call, number = match.groups() if match else ("", "", "")
        given_numbers = re.findall(rf"(?i)\b{name}\s*\(\s*(\d+)\s*\)", self.text) if name else []
        if (
            not name or number or len({*given_numbers}) > 1
        ):  # seconds or repetitions, as the author knows
            call = _CALL_WITH_VALUES.fullmatch(instruction_text)
            is_known_call = call is None or lexicon_meaning(call[1], *_KINDS_NO_CALL)
            is_often = bool(number and self.program_text.lacks_loop)
            return _OwnWord(
                "", "" if is_known_call or call is None else call[1], is_often, 0, False
            )
        if self.names.find_meaning(name):
            return _OwnWord("", "", False, 0, False)  # a function of another language
        lone_uses = re.findall(rf"(?im)(?:^|[;|])[ \t]*{name}[ \t]*(?=;|\r?$)", self.text)
        is_taught = bool(
            is_call or len(lone_uses) > 1 or self.names.defs or lexicon_meaning(name, "taught")
        )
        return _OwnWord(name, "", False, len(lone_uses), is_taught)

    def tokens_before(self) -> list[Lexeme]:
        """Return the tokens of the instruction before the place."""
        return lexemes(self.source[Span(self.instruction_span.start, self.diagnostic.span.start)])

    def header_word(self) -> str:
        """Return the word before the brackets that the place is in, or "" if it asks no
        question."""
        header_concepts = [
            self.names.find_meaning(token.text)
            for token, sign in pairwise(self.tokens_before())
            if sign.text == "("
        ]
        return (
            header_concepts[-1] if header_concepts and header_concepts[-1] in ASKING_WORDS else ""
        )

    @cached_property
    def amount_values(self) -> dict[str, str]:
        """Words that say how much, in the place of a number, and the call with numbers."""
        is_word = self.source[self.diagnostic.span][:1].isalnum()
        return amount_values(self.text, self.diagnostic.span) if is_word else {}

    @cached_property
    def wrong_value(self) -> _WrongValue | None:
        """Return a word after a number that is not a value: another unit, or nothing."""
        tokens_before = self.tokens_before()
        calls = [
            token.text for token, next_token in pairwise(tokens_before) if next_token.text == "("
        ]
        found_text = self.source[self.diagnostic.span]
        word, found_word = WORDS.get("".join(calls[-1:])), plain(found_text)
        is_word = (
            found_word.isidentifier()
            and found_word not in WORDS
            and not self.names.is_name(found_word)
        )
        if (
            word is None
            or not word.arguments
            or tokens_before[-1].kind is not NUMBER
            or not is_word
        ):
            return None
        argument_index = min(
            sum(token.text == "," for token in tokens_before), len(word.arguments) - 1
        )
        argument = word.arguments[argument_index]
        unit = lexicon_meaning(found_word, "unit")
        extent_word = UNIT_OF.get(word.text, "")
        is_extent = bool(extent_word) and unit == (EXTENTS[extent_word].unit, "1000")
        extent_text = f"{tokens_before[-1].text} {extent_word}" if is_extent else ""
        return (
            _WrongValue(
                word,
                argument,
                tokens_before[-1].text,
                found_text,
                unit[0] if unit else "",
                extent_text,
            )
            if (argument.unit in _NOUN_OF_UNIT)
            else None
        )

    def button_values(self) -> dict[str, str]:
        """A button that cannot be read; a program may begin with the one that starts it."""
        asked_text = next(
            (token.source for token in self.row_tokens if self.is_button(token.text)), ""
        )
        setup_text = "SB|" if self.program_text.setup_word == "SB" else ""
        when_text = (
            self.source[self.instruction_span]
            if self.token_texts[:1] == ["WHEN"] and not setup_text
            else ""
        )
        return {"begun": setup_text, "asked": asked_text or "BUTTON", "when": when_text}

    def number_values(self, word: str) -> dict[str, str]:
        """Return the distance of a move with one number that is too large for seconds.

        `forward 50` is a distance as in Logo, or a power; a number that is no power is a distance.
        """
        tokens = [token for token in self.row_tokens[1:] if token.text not in ("(", ")")]
        if UNIT_OF.get(word) != "CM" or not tokens or tokens[0].kind is not NUMBER:
            return {}
        number_token, *tokens_after = tokens
        is_more = bool(tokens_after) and (
            tokens_after[0].kind is not WORD
            or lexicon_meaning(tokens_after[0].text, *_KINDS_AFTER_NUMBER)
        )
        if is_more or not LONG_TIME_S <= float(number_token.text) <= _FARTHEST_CM:
            return {}
        extent_call = f"{word}({number_token.text} CM, {POWER.sample})"
        if float(number_token.text) > MAX_POWER:
            return {"fix": extent_call, "usage": ""}
        return {
            "number": number_token.text,
            "way": extent_call,
            "power": f"{word}(2, {number_token.text})",
        }

    def bound_values(self) -> dict[str, str]:
        """`F(2, MAX)`: the range of a value for MAX or MIN, and a call with numbers."""
        call = _CALL_WITH_VALUES.fullmatch(self.source[self.instruction_span])
        word = WORDS.get(plain(call[1])) if call else None
        values = (
            [value.strip() for value in call[0][call.end(1) :].strip(" ()").split(",")]
            if call
            else []
        )
        bound_word = self.diagnostic.values["word"]
        if word is None or len(values) != len(word.arguments) or bound_word not in ("MAX", "MIN"):
            return {}
        positions = [k for k, value in enumerate(values) if plain(value) == bound_word]
        if not positions or any(word.arguments[k].unit != POWER.unit for k in positions):
            return {}
        number = as_text(POWER.high) if bound_word == "MAX" else str(_LOW_POWER)
        values_text = ", ".join(
            number if k in positions else value for k, value in enumerate(values)
        )
        low = as_text(word.arguments[positions[0]].low)
        bounds = {"low": low, "high": as_text(word.arguments[positions[0]].high)}
        return bounds | {
            "greatest" if bound_word == "MAX" else "slow": f"{word.text}({values_text})"
        }

    def sensor_on_side(self, word: str) -> str:
        """The sensor on the side of an L or R in the place of a value, if it is no name."""
        is_other = self.text_after.lstrip(" ").startswith("(") or word in words_set(self.text)
        return "" if is_other else self.names.sensor_on_side(word)

    def call_if_lamp(self, call: str) -> str:
        """Return a call of the robot's lamp, or "" if it has none."""
        return call if "LED" in self.names.actuators else ""

    def worded_values(self, word: str) -> dict[str, str]:
        """A question in words without brackets: `IF BRIGHT THEN STOP`."""
        values = (
            condition_values([make_token("THE"), *self.question_tokens(word)], self.names) or {}
        )  # only a single word is a question
        return values if values.get("asked") or values.get("question") else {}

    def bracketed_values(self, word: str) -> dict[str, str]:
        """Return a question in words in the brackets of a header, or an example if it is not
        understood."""
        start = next(
            k
            for k, token in enumerate(self.row_tokens)
            if self.names.find_meaning(token.text) == word
        )
        question_tokens = self.row_tokens[start + 2 : brackets_end(self.row_tokens, start + 1) - 1]
        sample = {"example": WORDS[word].arguments[0].sample, "question": ""}
        return condition_values(question_tokens, self.names) or sample

    def dots_values(self) -> dict[str, str]:
        """Dots for what goes inside a block, as the poster has them."""
        match = self.match_here(_MEMBER_DOTS)
        if match is None:
            return {}
        head, end = match["head"], (match["end"] or "").upper()
        end_word = BLOCK_ENDS[(match["word"] or "DEF").upper()]
        values = {"head": head, "right": end_word, "out": "" if end else match["here"].strip()}
        def_name = (match["name"] or "").upper()
        text_below = self.text[match.end() :] if end == end_word else ""
        instructions_below = _short_instructions(text_below) or (
            _instructions_before_blocks(text_below, def_name) if def_name else []
        )
        calls = [
            instruction for instruction in instructions_below if _is_call_of(instruction, def_name)
        ]
        if instructions_inside := [
            instruction for instruction in instructions_below if instruction not in calls
        ]:
            values["example"] = "; ".join((head, *instructions_inside, end_word, *calls))
        return values

    def unended_values(self) -> dict[str, str]:
        """Return the end of a block without one, by its indentation or its line."""
        text_lines = self.text.splitlines()
        line_index = self.source.position(self.diagnostic.span.start)[0] - 1
        first_line = split_note(self.text_after[: len(text_lines[line_index])])[0]
        instructions_after = [
            instruction.strip()
            for instruction in first_line.split("\n")[0].split(";")
            if _WORD_CHARACTER.search(instruction)
        ]
        lines_below = [
            index for index in range(line_index + 1, len(text_lines)) if text_lines[index].strip()
        ]
        if instructions_after and line_index + 1 == len(text_lines):
            block_text = self.source[Span(self.diagnostic.span.start, self.instruction_span.end)]
            candidates = possible_last_instructions(tokens_of(f"{block_text};{first_line}"))
            return {"behind": instructions_after[-1], "places": candidates_text(candidates)}
        if not lines_below:
            return {"head": self.source[self.diagnostic.span]}
        indentations = [len(line) - len(line.lstrip()) for line in text_lines]
        top_level_index = min(
            (index for index in lines_below if _TOP_LEVEL_WORD.match(text_lines[index])), default=0
        )  # ends outside of any block
        lines_inside = [
            *takewhile(
                lambda index: (
                    index < top_level_index
                    if top_level_index
                    else indentations[index] > indentations[line_index]
                ),
                lines_below,
            )
        ]
        if not lines_inside:
            return {}
        return {
            "line": str(lines_inside[-1] + 1),
            "last": split_note(text_lines[lines_inside[-1]])[0].strip(" \t;"),
        }

    @cached_property
    def other_name(self) -> _OtherName:
        """Another name for a word of the language that stands for one."""
        word, text, start = self.diagnostic.values["word"], self.text, self.diagnostic.span.start
        assignment = re.match(r"\s*=\s*([1-9]?)", self.text_after)
        definition = _DEF_AT_END.search(text[max(0, start - _MAX_HEADER_CHARACTERS) : start])
        right = free_word_name(text, word) if assignment or definition else ""
        suggestion = (nearest(word, self.names.variables - {word}) or "") if assignment else ""
        is_clock = bool(assignment and word == "TIME" and not assignment[1])
        is_everywhere = bool(right) and (word in VERSION_OF_WORD or not (suggestion or is_clock))
        return _OtherName(
            word, right, suggestion, definition is not None, assignment, is_everywhere
        )

    def name_spans(self) -> list[Span]:
        """Return each place where a word is meant as a name: S of `F(S, 80)`, not S alone."""
        word, _, _, is_def, _, _ = self.other_name
        tokens = scan(self.text).tokens
        partners = {end if word == head else head for head, end in BLOCK_ENDS.items()
                    if word in (head, end)}  # fmt: skip
        has_block = any(token.text in partners for token in tokens)
        is_older = word in VERSION_OF_WORD and not has_block  # the program than the word
        token_indexes = range(len(tokens)) if is_older else _words_as_names(tokens, word, is_def)
        return [
            tokens[k].span for k in token_indexes
            if tokens[k].text == word and (k == 0 or tokens[k - 1].kind not in (NUMBER, ")"))
        ]  # fmt: skip

    @property
    def found_name(self) -> str:
        return self.diagnostic.values["found"]

    @cached_property
    def name_and_meaning(self) -> tuple[str, str]:
        """A name without letters that names cannot have, and its meaning."""
        right = re.sub(r"^[^A-Za-z]+|\W", "", plain(self.source[self.diagnostic.span]))
        return right, self.names.find_meaning(right)


class _Turn(NamedTuple):
    """A turn: `direction` is L or R, "" if no word says it; `values_text` are those of it."""

    direction: str
    angle: str
    values_text: str


class _OwnWord(NamedTuple):
    """A `name` that is alone `count_alone` times, or a call with values: `call_name`."""

    name: str
    call_name: str
    is_counted: bool
    count_alone: int
    is_taught: bool


class _WrongValue(NamedTuple):
    word: Word
    argument: Argument
    number_text: str
    found_text: str
    unit: str
    extent_text: str


class _OtherName(NamedTuple):
    word: str
    right: str
    suggestion: str
    is_def: bool
    assignment: re.Match[str] | None
    is_everywhere: bool


def _words_as_names(tokens: Sequence[Token], word: str, is_def: bool) -> Iterator[int]:
    """Yield the places where a word of the language is used as the name of a DEF or a variable.

    A DEF is called where its name is alone, or with as many values as the DEF has and the word has
    not, but not in its own body. A word of blocks that is alone belongs to a block.
    """
    depth = parameters = 0
    is_inside = is_value = False
    for k, (previous_token, token, following_token) in enumerate(
        zip([None, *tokens], tokens, tokens[1:], strict=False)
    ):
        depth += (token.kind == "(") - (token.kind == ")")
        is_begun = previous_token is None or (
            not depth and previous_token.kind in _INSTRUCTION_STARTS
        )
        is_value = not is_begun and (is_value or (token.kind == "=" and not depth))
        is_inside = (is_inside or token.text == "DEF") and token.text not in _DEF_ENDS
        if token.text != word:
            continue
        if not is_def:
            is_set = is_begun and following_token.kind == "="
            if is_set or ((depth or is_value) and following_token.kind != "("):
                yield k
        elif previous_token is not None and previous_token.text == "DEF":
            parameters = max(0, _value_count(tokens, k + 1))
            yield k
        elif is_begun and not is_inside:
            count = _value_count(tokens, k + 1)
            has_own_values = count == parameters and count != (len(WORDS[word].arguments) or -1)
            is_alone = following_token.kind in (*_INSTRUCTION_STARTS, "end")
            if has_own_values or (is_alone and not WORDS[word].role.belongs_to_blocks):
                yield k


def _value_count(tokens: Sequence[Token], k: int) -> int:
    """Return the number of values in the brackets that open there, or -1 if none do."""
    depth = commas = 0
    for index in range(k, len(tokens)):
        depth += (tokens[index].kind == "(") - (tokens[index].kind == ")")
        commas += tokens[index].kind == "," and depth == 1
        if not depth:
            return -1 if index == k else commas + (index > k + 1)
    return -1


def _ends_question(token: Lexeme) -> bool:
    """Return whether a question ends before a token."""
    return token.text in (":", "{", ",") or bool(lexicon_meaning(token.text, "do"))


def _short_instructions(text: str) -> list[str]:
    """Return the instructions of a text, or nothing if they are many or contain a block."""
    text_lines = (split_note(line)[0].split(";") for line in text.split("\n"))
    instructions = [
        instruction.strip() for line in text_lines for instruction in line if instruction.strip()
    ]
    is_long = len(instructions) > _MAX_INSTRUCTIONS or any(map(_BLOCK_WORD.match, instructions))
    return [] if is_long else instructions


def _instructions_before_blocks(text: str, name: str) -> list[str]:
    """Return the instructions before the first block of a text, and before a call of a name."""
    text_lines = (split_note(line)[0].split(";") for line in text.split("\n"))
    instructions = (
        instruction.strip() for line in text_lines for instruction in line if instruction.strip()
    )
    instructions_before = [
        *takewhile(
            lambda instruction: (
                not _BLOCK_WORD.match(instruction) and not _is_call_of(instruction, name)
            ),
            instructions,
        )
    ]
    return instructions_before if len(instructions_before) <= _MAX_INSTRUCTIONS else []


def _is_call_of(instruction: str, name: str) -> bool:
    return instruction.upper().partition("(")[0].strip() == name


def _usage(word: str) -> str:
    known_word = WORDS.get(ALIASES.get(word, word))
    is_asking = known_word is not None and [argument.name for argument in known_word.arguments] == [
        CONDITION.name
    ]
    return (known_word.example if is_asking else known_word.usage) if known_word else word


# -- gaps -----------------------------------------------------------------------------------------


def _intended_word(gaps: Gaps) -> str:
    """Return the word meant by the text in its place."""
    return _usage_of(gaps).word_meaning(_offered_word(gaps), _usage_of(gaps).instruction_name)


def _offered_word(gaps: Gaps) -> str:
    """Return the first word of the offer."""
    return re.split("[(;]", gaps.filled_values["fix"])[0]


def _block(gaps: Gaps) -> str:
    """The block that words say."""
    usage = _usage_of(gaps)
    text_below = usage.text[usage.instruction_span.end :].lstrip("; \t\r\n").upper()
    is_open = bool(re.match(r"SI ?NO\b|ELSE", text_below))
    return block(usage.row_tokens, usage.names, is_open)


def _only_instruction(gaps: Gaps) -> str:
    """The one instruction that words say."""
    spoken_instructions = _usage_of(gaps).spoken_instructions
    return (
        spoken_instructions[0].text
        if len(spoken_instructions) == 1 and not spoken_instructions[0].is_side_free
        else ""
    )


def _several_instructions(gaps: Gaps, is_sided: bool) -> str:
    """Return the instructions that words describe; `is_sided`: one has no direction of turn."""
    spoken_instructions = _usage_of(gaps).spoken_instructions
    is_free = any(instruction.is_side_free for instruction in spoken_instructions)
    return (
        instructions_text(spoken_instructions)
        if len(spoken_instructions) > 1 and is_free is is_sided
        else ""
    )


def _other_instruction_words(gaps: Gaps) -> set[str]:
    """Orders next to a turn, which would be lost with the turn alone."""
    instruction_of_word = _usage_of(gaps).instruction_of_word.items()
    return {
        instruction
        for word, instruction in instruction_of_word
        if not lexicon_meaning(word, "right")
    } - {
        "L",
        "R",
        "B",
        "S",
    }


def _forever_word(gaps: Gaps) -> str:
    """The word for FOREVER, where words say no instruction."""
    usage = _usage_of(gaps)
    endless_words = (word for word in usage.words if usage.names.find_meaning(word) == "FOREVER")
    return "" if usage.instruction_name else next(endless_words, "")


def _foreign_word(gaps: Gaps) -> str:
    """The word of another language that begins an instruction, or says one."""
    usage = _usage_of(gaps)
    return next(filter(usage.names.find_meaning, (*usage.words[:1], usage.instruction_name)), "")


def _concept(gaps: Gaps) -> str:
    """The word of the language that it means."""
    usage, word = _usage_of(gaps), _foreign_word(gaps)
    concept = usage.names.find_meaning(word)
    is_instruction = (
        concept in WORDS and WORDS[concept].role.can_start_item and concept != "FOREVER"
    )
    is_among = concept == "S" and {*usage.instruction_of_word.values()} != {
        "S"
    }  # `ve para adelante`
    return concept if is_instruction and concept != word and not is_among else ""


def _concept_alone(gaps: Gaps, is_numbered: bool) -> str:
    """Return the concept of a word without values, alone or with a number that it would lose."""
    concept, tokens = _concept(gaps), _usage_of(gaps).row_tokens
    if not concept or WORDS[concept].arguments:
        return ""
    has_number = any(token.kind is NUMBER for token in tokens)
    return concept if (has_number if is_numbered else len(tokens) == 1) else ""


def _asking_word_or_empty(word: str) -> str:
    return word if word in ASKING_WORDS else ""


def _variable(gaps: Gaps) -> str:
    usage = _usage_of(gaps)
    return next((word for word in usage.words if word in usage.names.variables), "")


def _own_example(gaps: Gaps) -> str:
    """The instruction with its unit where that goes, if that makes it right."""
    usage = _usage_of(gaps)
    example = own_example(usage.source[usage.instruction_span])
    return example if lines.is_right(lexemes(example.split("; ")[-1]), usage.names) else ""


def _loop_of_repeated(gaps: Gaps) -> str:
    """The loop for a repeated word."""
    own_word = _usage_of(gaps).own_word
    return (
        f"LOOP({own_word.count_alone});{own_word.name};END_LOOP" if own_word.count_alone > 1 else ""
    )


def _own_name(gaps: Gaps) -> str:
    own_word = _usage_of(gaps).own_word
    is_no_name = own_word.is_taught or lexicon_meaning(own_word.name, *_KINDS_NO_NAME)
    return "" if is_no_name else own_word.name


def _block_end(gaps: Gaps) -> str:
    """The end that words say, or that of the block which is open."""
    usage = _usage_of(gaps)
    named_ends = (BLOCK_ENDS.get(usage.names.find_meaning(word), "") for word in usage.words[1:])
    return next(named_ends, "") or usage.program_text.innermost_end(usage.instruction_span.start)


def _method_call(gaps: Gaps) -> str:
    """Return the method of an object, if it is called: WRITE of `servo.write`."""
    object_name, _, action = plain(
        gaps.subject.text[slice(*_member_span(_usage_of(gaps)))]
    ).rpartition(".")
    action_word = (
        "" if lexicon_meaning(object_name, "device") else gaps.subject.names.find_meaning(action)
    )
    return action_word if gaps.subject.names.takes_values(action_word) else ""


def _member_span(usage: Usage) -> Span:
    match = _MEMBER_CALL.match(usage.text, usage.diagnostic.span.start)
    return Span(*match.span()) if match else Span(0, 0)


def _unit_behind(gaps: Gaps) -> str:
    """A unit after a calculation: `F(RANDOM(1, 3) sec, 50)`."""
    usage = _usage_of(gaps)
    found_text = usage.source[usage.diagnostic.span]
    end = _end_of_value(usage)
    return (
        found_text
        if lexicon_meaning(plain(found_text), "unit") and usage.text[end - 1] == ")"
        else ""
    )


def _end_of_value(usage: Usage) -> int:
    return len(usage.text[: usage.diagnostic.span.start].rstrip())


def _without_seconds(gaps: Gaps) -> str:
    """The instruction without a word for seconds."""
    usage = _usage_of(gaps)
    span, piece, source = usage.diagnostic.span, usage.instruction_span, usage.source
    if lexicon_meaning(plain(source[span]), "unit") != ("s", "1000"):
        return ""
    return source[Span(piece.start, _end_of_value(usage))] + source[Span(span.end, piece.end)]


def _missing_value(gaps: Gaps, is_unit: bool) -> _WrongValue | None:
    value = _usage_of(gaps).wrong_value
    return value if value and bool(value.unit) is is_unit else None


def _number_said(gaps: Gaps) -> str:
    """A number with a unit that values have, or with that of a way."""
    wrong_value = _missing_value(gaps, is_unit=True)
    is_own = wrong_value is not None and (
        wrong_value.unit == wrong_value.argument.unit or bool(wrong_value.extent_text)
    )
    found_text = _usage_of(gaps).source[_usage_of(gaps).diagnostic.span]
    return f"{wrong_value.number_text} {found_text}" if wrong_value and is_own else ""


def _spoken_direction(gaps: Gaps) -> str:
    wrong_value = _missing_value(gaps, is_unit=True)
    return (
        wrong_value.extent_text
        if wrong_value and wrong_value.unit != wrong_value.argument.unit
        else ""
    )


def _other_robots_word(gaps: Gaps) -> str:
    """Return a word with values that only other robots have, and that the user wants."""
    usage = _usage_of(gaps)
    word = "".join(usage.words[:1])
    is_other = usage.names.find_meaning(word) or usage.names.is_name(word)
    return "" if usage.token_texts[:2] != [word, "("] or is_other else word


def _in_words(gaps: Gaps) -> str:
    """The header with a question in words in its brackets."""
    usage = _usage_of(gaps)
    known_words = {*WORDS, *usage.names.known_names.values} - {"SI"}
    return "" if {*usage.words} <= known_words else usage.header_word()


def _worded_header(gaps: Gaps) -> str:
    """The header of a name that asks something in words: DARK of `X > 5 OR DARK`."""
    usage = _usage_of(gaps)
    name = plain(usage.source[usage.diagnostic.span])
    tokens_before = usage.tokens_before()  # tokens of the same line
    is_compared = bool(tokens_before) and tokens_before[-1].text in COMPARISONS
    return (
        usage.header_word() if lexicon_meaning(name, "light", "ahead") and not is_compared else ""
    )


def _endless_move(gaps: Gaps) -> str:
    """A move with FOREVER as its time, and an UNTIL."""
    usage = _usage_of(gaps)
    is_endless = usage.names.find_meaning(plain(usage.source[usage.diagnostic.span])) == "FOREVER"
    if not is_endless or not usage.token_texts or usage.token_texts[0] not in MOVES:
        return ""
    start, end = (offset - usage.instruction_span.start for offset in usage.diagnostic.span)
    text = usage.source[usage.instruction_span]
    return f"{text[:start]}FOREVER{text[end:]} UNTIL({WORDS['UNTIL'].arguments[0].sample})"


def _swapped_forever(gaps: Gaps) -> str:
    """`F(50, FOREVER)`: FOREVER is a time, and goes first."""
    match = _FOREVER_SECOND.fullmatch(_usage_of(gaps).source[_usage_of(gaps).instruction_span])
    if match is None:
        return ""
    until = match[3] or f" UNTIL({WORDS['UNTIL'].arguments[0].sample})"
    return f"{match[1].upper()}(FOREVER, {match[2].strip()}){until}"


def _until_with_move(gaps: Gaps) -> str:
    """An UNTIL with the move that it lacks."""
    usage = _usage_of(gaps)
    match = re.match(r"\s*(\([^()\n]+\))", usage.text[usage.diagnostic.span.start + 5 :])
    return f"F(2, 80) UNTIL{match[1]}" if match else ""


def _until_block(gaps: Gaps) -> str:
    """An UNTIL that is written as a block around one move, which has but its power."""
    match = _usage_of(gaps).match_here(_UNTIL_BLOCK)
    return re.sub(r"\s*[;\n][\s;]*", "; ", match[0].strip("; \r\n")) if match else ""


def _until_endless(gaps: Gaps) -> str:
    match = _usage_of(gaps).match_here(_UNTIL_BLOCK)
    move = f"{match['word'].upper()}(FOREVER, {match['power']})" if match else ""
    return f"{move} UNTIL{match['asked']}" if match else ""


def _until_end(gaps: Gaps) -> str:
    usage = _usage_of(gaps)
    return (
        usage.token_texts[0]
        if len(usage.row_tokens) == 1 and _UNTIL_END.fullmatch(usage.token_texts[0])
        else ""
    )


def _task_name(gaps: Gaps) -> str:
    """The name of a TASK that is used alone elsewhere, as if to start it there."""
    usage = _usage_of(gaps)
    name = usage.source[usage.diagnostic.span].upper()
    lone_pattern = (
        rf"(?im)(?:^|[;|])[ \t]*{re.escape(name)}[ \t]*(?:\([ \t]*\))?[ \t]*(?=;|//|\r?$)"
    )
    return name if name.isidentifier() and re.search(lone_pattern, usage.text) else ""


def _begun_behind(gaps: Gaps) -> str:
    """The beginning of a program at its end: `F(2, 80)|SB`."""
    match = re.compile(r"(?i)\|\s*(S[IB])\s*\Z").match(
        _usage_of(gaps).text, _usage_of(gaps).diagnostic.span.start
    )
    return match[0].upper().strip() if match else ""


def _else_word(gaps: Gaps) -> str:
    """`si no`, alone."""
    usage = _usage_of(gaps)
    arm = usage.names.find_meaning("_".join(usage.words[:2]))
    return arm if arm == "ELSE" and len(usage.row_tokens) == 2 else ""


def _second_start(gaps: Gaps) -> str:
    """A beginning in the midst of a program, with its bar."""
    usage = _usage_of(gaps)
    is_bar = usage.text_after.lstrip()[:1] == "|"
    return usage.source[usage.diagnostic.span].upper() + "|" * is_bar


def _if_word_or_empty(gaps: Gaps) -> str:
    """IF, where SI has no bar after it."""
    return "IF" if _second_start(gaps) == "SI" else ""


def _saying_button(gaps: Gaps) -> str:
    """A word before the bar that says the button, or looks like it."""
    word = _usage_of(gaps).diagnostic.values["found"]
    return word if word == "S8" or lexicon_concept(word) == "BUTTON" else ""


def _else_in_when_or_empty(gaps: Gaps) -> str:
    """An ELSE in a WHEN."""
    usage = _usage_of(gaps)
    text_before = usage.text[: usage.diagnostic.span.start]
    is_open = re.search(r"(?is)\bWHEN\b(?!.*\bEND_?WHEN\b)", text_before)
    return usage.diagnostic.values["found"] if is_open else ""


def _two_digits(gaps: Gaps) -> str:
    """A colon between digits, and these."""
    start, end = _usage_of(gaps).diagnostic.span
    text_around = _usage_of(gaps).text[max(0, start - 1) : end + 1]
    return text_around if re.fullmatch("[0-9]:[0-9]", text_around) else ""


def _quoted_span(usage: Usage) -> Span:
    """Return the place from a quotation mark to the next one of its line."""
    start, end = usage.diagnostic.span
    closing_match = re.compile(rf"[^\n]*?{usage.text[start:end]}").match(usage.text, end)
    return Span(start, closing_match.end() if closing_match else end)


def _dotted_span(usage: Usage) -> Span:
    match = usage.match_here(_MEMBER_DOTS)
    return Span(*match.span("here")) if match else usage.diagnostic.span


def _lines_of_name(gaps: Gaps) -> list[str]:
    """The lines in which a word is meant as a name."""
    usage = _usage_of(gaps)
    return [str(usage.source.position(span.start)[0]) for span in usage.name_spans()]


def _other_lines(gaps: Gaps) -> list[str]:
    return list(dict.fromkeys(_lines_of_name(gaps)))[1:]


def _later_lines(gaps: Gaps) -> list[str]:
    """The lines with TIME after the first place."""
    usage = _usage_of(gaps)
    offsets = [match.start() for match in re.finditer(r"(?i)\bTIME\b", usage.text)][1:]
    return [str(usage.source.position(offset)[0]) for offset in offsets]


def _only_line(lines: Sequence[str]) -> str:
    return lines[0] if len(lines) == 1 else ""


def _line_list(lines: Sequence[str]) -> str:
    return "" if len(lines) == 1 else ", ".join(lines)


def _times_in_line(gaps: Gaps) -> str:
    lines_of_name = _lines_of_name(gaps)
    return str(len(lines_of_name)) if len(lines_of_name) > 1 and not _other_lines(gaps) else ""


def _words_after(gaps: Gaps) -> str:
    """Return words after an instruction that begin no other; a `;` between them would not help."""
    usage = _usage_of(gaps)
    text = usage.source[_following_span(usage)]
    outline = lines.parse_line(lexemes(text), usage.names)
    return shorten(text) if isinstance(outline, Failure) and outline.failed_at == 0 else ""


def _following_span(usage: Usage) -> Span:
    return Span(usage.diagnostic.span.start, usage.instruction_span.end)


def _unaccented_name(gaps: Gaps) -> str:
    """A name in the letters that a name has, which the language knows."""
    right, concept = _usage_of(gaps).name_and_meaning
    return right if concept in WORDS or _usage_of(gaps).names.is_device_or_end(concept) else ""


def _called_name(gaps: Gaps) -> str:
    usage = _usage_of(gaps)
    word = usage.source[usage.diagnostic.span].upper()
    is_call = usage.text_after.lstrip(" ").startswith("(")
    is_taught = re.search(rf"(?i)\bDEF\s+{re.escape(word)}(?!\w)", usage.text)
    return word if is_call and not is_taught else ""  # a DEF's calls go by its name


def _lamp_here(gaps: Gaps) -> str:
    """A word for a lamp with an accent, where the kit has no lamp."""
    usage = _usage_of(gaps)
    has_lamp = "LED" in usage.names.actuators
    word = usage.source[usage.diagnostic.span].upper()
    return word if usage.is_first and not has_lamp and lexicon_concept(plain(word)) == "LED" else ""


def _lamp_set(gaps: Gaps) -> str:
    """The lamp that words switch on or off."""
    usage = _usage_of(gaps)
    words = (*usage.words, "_".join(usage.words[:2]))
    return usage.call_if_lamp(
        f"LED({'FALSE' if any(lexicon_meaning(word, 'off') for word in words) else 'TRUE'})"
    )


def _leading_filler(gaps: Gaps) -> str:
    """A word without meaning, or the button, at the beginning of an instruction."""
    usage, right = _usage_of(gaps), _usage_of(gaps).name_and_meaning[0]
    is_needless = lexicon_meaning(right, "filler") or usage.is_button(right)
    return right if usage.is_first and is_needless else ""


def _may_be_value_of(argument: Argument, number: float) -> bool:
    is_long = argument.unit == "s" and number >= LONG_TIME_S
    return argument.low <= number * ONE <= argument.high and not is_long


def _calls_taking_values(gaps: Gaps) -> list[str]:
    """The values in brackets that no word is before, after each word that takes such ones."""
    usage = _usage_of(gaps)
    values = [
        value.strip() for value in usage.source[usage.instruction_span].strip("() ").split(",")
    ]
    if not all(_PLAIN_NUMBER.fullmatch(value) for value in values):
        return []
    words = (
        WORDS[word] for word in _WORDS_WITH_VALUES if len(WORDS[word].arguments) == len(values)
    )
    return [
        f"{word.text}({', '.join(values)})"
        for word in words
        if all(
            _may_be_value_of(argument, float(value))
            for argument, value in zip(word.arguments, values, strict=True)
        )
    ]


def _in_capitals(gaps: Gaps) -> str:
    usage, right = _usage_of(gaps), _usage_of(gaps).name_and_meaning[0]
    return right if usage.source[usage.diagnostic.span].isupper() else right.capitalize()


def _amount_span(usage: Usage) -> Span:
    start = usage.text.index(usage.amount_values["amount"], usage.instruction_span.start)
    return Span(start, start + len(usage.amount_values["amount"]))


def _usage_of(gaps: Gaps) -> Usage:
    assert isinstance(gaps.subject, Usage)
    return gaps.subject


def _gap_of(value_of: Callable[[Usage], str | None]) -> Callable[[Gaps], str]:
    return lambda gaps: value_of(_usage_of(gaps)) or ""


# Rows with a place of their own instead of that of the finding.
_SPAN_FUNCTIONS: dict[str, Callable[[Usage], Span]] = {
    "here": lambda usage: usage.instruction_span, "behind": _following_span, "member": _member_span,
    "quoted": _quoted_span,
    "dots": _dotted_span,
    "first": lambda usage:
        Span(usage.instruction_span.start, usage.instruction_span.start + len(usage.words[0])),
    "amount": _amount_span,
}  # fmt: skip
# Values that belong together: of a place, and of the word in question.
_SEVERAL_FUNCTIONS: dict[str, Callable[[Usage, str], Mapping[str, str]]] = {
    "amount": lambda usage, _: usage.amount_values, "bound": lambda usage, _: usage.bound_values(),
    "button": lambda usage, _: usage.button_values(),
    "dots": lambda usage, _: usage.dots_values(),
    "unended": lambda usage, _: usage.unended_values(),
    "instead": lambda usage, _: foreign_word_hints(usage.token_texts[0]),
    "in_words": Usage.worded_values,
    "in_brackets": Usage.bracketed_values, "one_number": Usage.number_values,
    "in_dark": (
        lambda usage, word:
            values if (values := usage.bracketed_values(word)).get("question") else {}
    ),
}  # fmt: skip
GAP_FUNCTIONS: dict[str, Callable[[Gaps], str]] = {
    "said": _gap_of(lambda usage: usage.source[usage.instruction_span]),
    "here": _gap_of(lambda usage: usage.source[usage.diagnostic.span]),
    "first": _gap_of(lambda usage: usage.token_texts[0]),
    "sign": _gap_of(lambda usage: usage.token_texts[1]),
    "step": _gap_of(lambda usage: usage.token_texts[1][0]),
    "number": _gap_of(lambda usage: usage.number_text),
    "found": _gap_of(lambda usage: usage.diagnostic.values["found"]),
    "word": _gap_of(lambda usage: usage.diagnostic.values["word"]),
    "reading": _gap_of(lambda usage: usage.sensor_on_side(usage.diagnostic.values["word"])),
    "lamp": _gap_of(lambda usage: usage.call_if_lamp("LED")),
    "lamp_on": _gap_of(lambda usage: usage.call_if_lamp("LED(TRUE)")),
    "lamp_off": _gap_of(lambda usage: usage.call_if_lamp("LED(FALSE)")),
    "lamp_named": _gap_of(lambda usage: usage.call_if_lamp(usage.source[usage.instruction_span])),
    "lamp_set": _lamp_set,
    "right": _offered_word, "named": _intended_word,
    "named_first": lambda gaps: _usage_of(gaps).word_meaning(_offered_word(gaps),
        _usage_of(gaps).token_texts[0]),
    "usage": lambda gaps: _usage(_offered_word(gaps)),
    "takes": lambda gaps: (
        _usage(_offered_word(gaps)) if _usage_of(gaps).spoken_instructions[0].samples else ""),
    "block": _block, "order": _only_instruction,
    "sided": lambda gaps: _several_instructions(gaps, is_sided=True),
    "several": lambda gaps: _several_instructions(gaps, is_sided=False),
    "made_up": _gap_of(lambda usage: samples_text(usage.spoken_instructions)),
    "endless": _forever_word,
    "others": lambda gaps: ", ".join(_other_instruction_words(gaps)),
    "way": _gap_of(lambda usage: usage.turn.direction),
    "angle": _gap_of(lambda usage: usage.turn.angle),
    "side": _gap_of(lambda usage: {"L": "left", "R": "right"}.get(usage.turn.direction)),
    "turned": _gap_of(lambda usage: usage.turn.values_text),
    "way_usage": _gap_of(lambda usage: _usage(usage.turn.direction)),
    "word_said": _foreign_word, "concept": _concept,
    "asking": lambda gaps: _asking_word_or_empty(_concept(gaps)),
    "concept_alone": lambda gaps: _concept_alone(gaps, is_numbered=False),
    "concept_numbered": lambda gaps: _concept_alone(gaps, is_numbered=True),
    "concept_usage": lambda gaps: _usage_of(gaps).usage(_concept(gaps)), "variable": _variable,
    "often_taught": _gap_of(lambda usage: "LOOP" * usage.own_word.is_counted),
    "taught": _gap_of(lambda usage: usage.own_word.call_name),
    "untaught": _gap_of(lambda usage: usage.own_word.name * usage.own_word.is_taught),
    "often": _loop_of_repeated,
    "likely": _gap_of(lambda usage:
        likely_word(usage.token_texts[0], usage.source[usage.instruction_span])),
    "plus": _gap_of(lambda usage:
        "-" if f"-{usage.number_text}" in "".join(usage.token_texts) else "+"),
    "own_example": _own_example,
    "own": _own_name, "end": _block_end, "done": _method_call,
    "done_usage": lambda gaps: _usage_of(gaps).usage(_method_call(gaps)),
    "member": _gap_of(lambda usage: usage.text[slice(*_member_span(usage))]),
    "bare_asking": _gap_of(lambda usage: _asking_word_or_empty(usage.diagnostic.values["word"])),
    "bare_example": _gap_of(lambda usage: WORDS[usage.instruction_name].example
                        if len(usage.row_tokens) == 1 and usage.instruction_name in WORDS
                        and WORDS[usage.instruction_name].arguments else ""),
    "bare_usage": _gap_of(lambda usage: usage.usage(usage.diagnostic.values["word"])),
    "first_usage": _gap_of(lambda usage: usage.usage(usage.token_texts[0])),
    "unit": _unit_behind, "without_seconds": _without_seconds, "number_said": _number_said,
    "way_said": _spoken_direction,
    "value_name": lambda gaps: it.argument.name if (it := _missing_value(gaps, True)) else "",
    "wanted": lambda gaps: (
        _NOUN_OF_UNIT[it.argument.unit] if (it := _missing_value(gaps, True)) else ""
    ),
    "extra": lambda gaps: it.found_text if (it := _missing_value(gaps, False)) else "",
    "value_found": _gap_of(lambda usage: usage.wrong_value and usage.wrong_value.found_text),
    "value_word": _gap_of(lambda usage: usage.wrong_value and usage.wrong_value.word.text),
    "value_usage": _gap_of(lambda usage: usage.wrong_value and usage.wrong_value.word.usage),
    "foreign": _other_robots_word, "in_words": _in_words, "in_dark": _worded_header,
    "amount": _gap_of(lambda usage: usage.amount_values.get("amount")),
    "until_block": _until_block, "until_endless": _until_endless, "until_end": _until_end,
    "started": _task_name, "button_behind": lambda gaps: "SB" * _begun_behind(gaps).endswith("SB"),
    "begun_behind": _begun_behind,
    "endless_move": _endless_move, "forever_first": _swapped_forever,
    "asked_behind": _until_with_move,
    "arm": _else_word, "begun_again": _second_start, "question_begun": _if_word_or_empty,
    "twice": lambda gaps:
        _second_start(gaps) if _usage_of(gaps).program_text.setup_word == "SB" else "",
    "named_endless": lambda gaps: _usage_of(gaps).word_meaning("LOOP", _forever_word(gaps)),
    "instead": _gap_of(lambda usage: usage.program_text.setup_word),
    "saying_button": _saying_button,
    "part": _else_in_when_or_empty, "two_digits": _two_digits,
    "sign_means": _gap_of(lambda usage: lexicon_concept(usage.source[usage.diagnostic.span])),
    "sign_usage": _gap_of(lambda usage:
        _usage(lexicon_concept(usage.source[usage.diagnostic.span]) or "")),
    "everywhere": _gap_of(lambda usage:
        usage.other_name.right if usage.other_name.is_everywhere else ""),
    "since": _gap_of(lambda usage: VERSION_OF_WORD.get(usage.other_name.word)),
    "name_line": lambda gaps: "".join(_other_lines(gaps)[:1]),
    "name_lines": lambda gaps: _line_list(_other_lines(gaps)), "name_times": _times_in_line,
    "name_right": _gap_of(lambda usage: usage.other_name.suggestion or usage.other_name.right),
    "time_right": _gap_of(lambda usage: usage.other_name.right
                      if usage.other_name.assignment and usage.other_name.assignment[1] else ""),
    "clock": _gap_of(lambda usage: usage.other_name.right
                 if usage.other_name.assignment and not usage.other_name.assignment[1] else ""),
    "time_line": lambda gaps: _only_line(_later_lines(gaps)),
    "time_lines": lambda gaps: _line_list(_later_lines(gaps)),
    "note": _gap_of(lambda usage:
        "/*" if usage.text.startswith("/*", usage.diagnostic.span.start) else ""),
    "sensor": _gap_of(lambda usage:
        usage.found_name if usage.found_name in usage.names.sensors else ""),
    "input": _gap_of(lambda usage:
        usage.found_name if lexicon_meaning(usage.found_name, "input") else ""),
    "words_behind": _words_after,
    "before": _gap_of(lambda usage: usage.diagnostic.values["before"]),
    "plain_letters": _unaccented_name,
    "letters_mean": _gap_of(lambda usage: usage.name_and_meaning[1]),
    "letters_usage": _gap_of(lambda usage: usage.usage(usage.name_and_meaning[1])),
    "called_here": _called_name,
    "taking_one": lambda gaps: "".join(_calls_taking_values(gaps)[:1]),
    "taking_another": lambda gaps: "".join(_calls_taking_values(gaps)[1:2]),
    "waiting": _gap_of(lambda usage:
                   "SB|" if usage.program_text.setup_word == "SB" and usage.is_begun else ""),
    "lamp_here": _lamp_here,
    "said_first": _leading_filler, "cased": _in_capitals,
}  # fmt: skip
