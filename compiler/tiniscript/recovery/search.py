"""Candidates: whole programs that a wrong one may have been meant to be, and which one counts.

The parser and the checker decide. A candidate has no mistakes, or fewer where a part of the text
cannot be read; numbers, names and commands change by a row alone.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from itertools import chain, pairwise
from typing import NamedTuple

from tiniscript.base.kit import Kit
from tiniscript.base.words import BLOCK_ENDS
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code
from tiniscript.recovery import lines, rewrites, rows
from tiniscript.recovery.blocks import Line, Matching, TokenEdit
from tiniscript.recovery.lines import BRACES, SURE_MARGIN, Reading, Step, is_right
from tiniscript.recovery.meanings import (
    NEAR_COST,
    Lexeme,
    Names,
    lexemes,
    lexicon_meaning,
    make_token,
    plain,
    texts,
    words_of,
)
from tiniscript.recovery.moved import MovedProgram, reorder_defs
from tiniscript.recovery.writing import (
    PLAIN_SIGNS,
    as_written,
    format_line,
    has_ambiguous_sign,
    split_note,
    with_signs,
)
from tiniscript.syntax.blocks import WORD_OF_END
from tiniscript.syntax.outline import Failure

MAX_UNREAD_LINES = 5  # unreadable lines after which others are read quickly
MAX_ALTERNATIVES = 12  # readings of a line that are tried besides the cheapest ones
# First and last line of a block whose condition is at its end.
_LONE_LOOP_START = re.compile(
    rf"\s*(?:S[IB]\s*\|\s*)?(?:LOOP|{words_of('repeat', 'make')})\b\s*\{{?\s*$"
)
_END_UNTIL = re.compile(rf"\b{words_of('end')}[ _]?{words_of('until')}\b")
_SETUP_AT_START = re.compile(r"^\s*SI\s*\|\s*(?=\w)", re.IGNORECASE)
_WHEN_AT_START = re.compile(rf"\s*(S[IB]\s*\|)?\s*{words_of('whenever')}\b")

# Words that begin or end a block.
_BLOCK_WORDS = frozenset((*BLOCK_ENDS, *WORD_OF_END, "ELSE", "ELSEIF", "FOREVER", "UNTIL"))
_BLOCK_START_KINDS = ("count", "each", "every", "unless", "when", "end", "repeat", "main")

Mistakes = Callable[[str], Sequence[Code]]  # the codes of a program's mistakes


class LineChange(NamedTuple):
    """The rewritten form of lines `first_line` to `last_line`, counted from 0; most stay
    unchanged.
    """

    first_line: int
    last_line: int
    text: str
    steps: Sequence[Step]
    is_sure: bool  # otherwise it is a guess


class Candidate(NamedTuple):
    """A program that may have been meant. `is_applied`: it may be made without asking.

    `is_whole`: it has no mistakes; otherwise it has fewer than the text. `changes` has those of all
    lines; it is empty if a DEF is moved: `move`.
    """

    text: str
    is_applied: bool
    is_whole: bool
    changes: Sequence[LineChange]
    has_sure_blocks: bool = True
    move: MovedProgram | None = None


_UNREAD_LINE = Reading(0, [], (), True, False)


class _TextLine:
    """A line in progress: its original text, and its readings."""

    def __init__(self, source: str, line_number: int) -> None:
        self.source = source
        self.first_line = self.last_line = line_number
        self.body, self.note = split_note(source)
        self.steps: list[Step] = []
        self.is_sure = True
        self.reading = _UNREAD_LINE
        self.rivals: list[Reading] = []

    @property
    def indent(self) -> int:
        return len(self.source) - len(self.source.lstrip(" \t"))


class Recovery:
    """The possible meanings of a wrong program; each line of it is read once.

    The possible readings of a line (`choices`) get their blocks and are checked (`candidate`),
    until `chosen_candidate` has a program without mistakes.
    """

    def __init__(self, program: str, kit: Kit, mistakes: Mistakes) -> None:
        self.program = program
        self.kit = kit
        self.mistakes = mistakes
        self.mistake_count = len(mistakes(program))
        self.end_count = _count_ends(program)
        self.unread_count = 0
        self.lines = [_TextLine(line, k) for k, line in enumerate(program.split("\n"))]
        self.drop_setups()
        self.read_signs()
        self.join_until()
        self.names = Names([lexemes(text.body) for text in self.lines], kit)
        self._reading = self._read_lines()

    def sure_candidate(self) -> Candidate | None:
        """Return the program if it is meant completely and certainly; stop early at a line that is
        not."""
        if not self.mistake_count or not all(self._reading):
            return None
        candidate = self.chosen_candidate
        return candidate if candidate and candidate.is_whole and candidate.is_applied else None

    def best_candidate(self) -> Candidate | None:
        """Return the program that was meant, or None for a correct one."""
        if not self.mistake_count:
            return None
        for _ in self._reading:
            pass
        return self.chosen_candidate

    def _read_lines(self) -> Iterator[bool]:
        """Read each line, and return whether the reading is certain."""
        for line in self.lines:
            self.read_line(line)
            yield line.reading.items is not None and line.reading.is_sure
        token_lists = ([lexemes(text.body), text.reading.tokens] for text in self.lines)
        new_names, names = Names([*chain(*token_lists)], self.kit), self.names
        if new_name_set := (new_names.variables | new_names.defs) - names.variables - names.defs:
            self.names = new_names
            for line in self.lines:
                if line.reading.items is None and new_name_set & {*texts(lexemes(line.body))}:
                    self.read_line(line)

    def read_signs(self) -> None:
        """Make the rewrites of signs, in the lines that have them.

        It excludes readings that lose a DEF, or open a bracket that was closed: `F(2;80) R(1;50)`
        has no list of `80)`.
        """
        names = Names([lexemes(text.body) for text in self.lines], self.kit)
        for line in self.lines:
            if (dictated_text := with_signs(line.body)) != line.body:
                old_tokens, new_tokens = lexemes(line.body), lexemes(dictated_text)
                line.steps.append(Step(codes.OTHER_SIGN, old_tokens, new_tokens))
                line.is_sure = not has_ambiguous_sign(line.body)
                line.body = dictated_text
            body = line.body.translate(PLAIN_SIGNS)
            if body == line.body and is_right(lexemes(body), names):
                continue
            for row in rewrites.sign_rows():
                for _ in row.pattern.findall(body):  # one step for each, reported at its place
                    new_body = row.pattern.sub(row.replacement, body, count=1)
                    old_tokens, new_tokens = lexemes(body), lexemes(new_body)
                    lost_defs = names.defs & ({*texts(old_tokens)} - {*texts(new_tokens)})
                    if (
                        new_body != body
                        and not lost_defs
                        and _open_brackets(new_tokens) <= _open_brackets(old_tokens)
                    ):
                        line.steps.append(Step(row.code, old_tokens, new_tokens))
                        line.is_sure = line.is_sure and not row.is_offered
                        body = new_body
            line.body, note = split_note(body)
            line.note = note + line.note

    def has_signs(self, offset: int) -> bool:
        """Return whether rewriting only signs makes the line at an offset right."""
        line_number = self.program.count("\n", 0, offset)
        lines_near = (
            line
            for line in self.lines
            if line.steps and line.first_line <= line_number <= line.last_line
        )
        return any(is_right(lexemes(text.body), self.names) for text in lines_near)

    def drop_setups(self) -> None:
        """Drop a `SI|` below the first line."""
        for line in [text for text in self.lines if text.body.strip()][1:]:
            body = _SETUP_AT_START.sub("", line.body)
            if body != line.body:
                line.steps.append(Step(codes.SETUP_TWICE, lexemes(line.body), lexemes(body)))
                line.body = body

    def join_until(self) -> None:
        """Put an UNTIL on a line of its own after the instruction before it."""
        joined_lines: list[_TextLine] = []
        until_pattern = re.compile(rf"^\s*{words_of('until')}\b", re.MULTILINE)
        text = plain(self.program)
        if not until_pattern.search(text) or _END_UNTIL.search(text):
            return  # there is no candidate, or the words are read as a block
        is_do_line = False
        for line in self.lines:
            text_above = next(
                (line_before for line_before in reversed(joined_lines) if line_before.body.strip()),
                None,
            )
            body = (
                text_above.body.rstrip().rstrip(";")
                if text_above and not text_above.note.strip()
                else ""
            )
            if (
                text_above
                and body.endswith(")")
                and not is_do_line
                and until_pattern.match(plain(line.body))
            ):
                text_above.body, text_above.note = f"{body} {line.body.strip()}", line.note
                text_above.last_line = line.last_line
                text_above.steps.append(
                    Step(codes.UNTIL_ALONE, lexemes(line.body), lexemes(text_above.body))
                )
            else:
                joined_lines.append(line)
            is_do_line = is_do_line or _LONE_LOOP_START.match(plain(line.body)) is not None
        self.lines = joined_lines

    def read_line(self, line: _TextLine) -> None:
        """Find the cheapest reading of a line, sure if no rival costs about as much; otherwise of
        its parts."""
        tokens, names = lexemes(line.body), self.names
        items = lines.parse_line(tokens, names)
        if not isinstance(items, Failure):
            line.reading = Reading(0, tokens, (), True, False, items)
            return
        readings = lines.read(tokens, names, is_quick=self.unread_count > MAX_UNREAD_LINES)
        if not readings:
            self.unread_count += 1
            line.reading = self.read_parts(tokens, names)
            return
        cheapest_readings = readings[0]
        line.rivals = [
            reading
            for reading in readings[1:]
            if reading.normal_text != cheapest_readings.normal_text
        ]
        has_close_rival = any(
            rival.is_sure
            and rival.cost < cheapest_readings.cost + SURE_MARGIN
            and _count_kept(rival) >= _count_kept(cheapest_readings)
            for rival in line.rivals
        )
        is_sure = (
            cheapest_readings.is_sure
            and not has_close_rival
            and not _may_be_mistyped_bracket(tokens, cheapest_readings.tokens)
        )
        line.reading = cheapest_readings._replace(is_sure=is_sure)

    def read_parts(self, tokens: list[Lexeme], names: Names) -> Reading:
        """Read each instruction of a line alone, where one cannot be read, if it is sure."""
        steps: list[Step] = []
        ends = [k for k, token in enumerate([*tokens, make_token(";")]) if token.text == ";"]
        ends = [k for k in ends if k == len(tokens) or not _open_brackets(tokens[:k])]
        for start, end in [*pairwise((-1, *ends))][::-1]:
            head, instruction, tail = tokens[: start + 1], tokens[start + 1 : end], tokens[end:]
            readings = lines.read(instruction, names, is_quick=True)[:1]
            for reading in readings if readings and readings[0].is_sure else ():
                tokens = [*head, *reading.tokens, *tail]
                steps += [
                    Step(code, [*head, *tokens_before, *tail], [*head, *tokens_after, *tail])
                    for code, tokens_before, tokens_after in reading.steps
                ]
        return Reading(0, tokens, tuple(steps), True, False) if steps else _UNREAD_LINE

    @cached_property
    def chosen_candidate(self) -> Candidate | None:
        """Return the first sure program without mistakes, or else an unsure one, or else a part."""
        best_candidate: Candidate | None = None
        for readings, has_blocks in self.choices():
            if best_candidate is not None and best_candidate.is_applied and best_candidate.is_whole:
                break
            if (
                best_candidate is not None
                and has_blocks
                and all(reading.items is not None for reading in readings)
            ):
                continue
            candidate = self.candidate(readings, has_blocks)
            if candidate and (
                best_candidate is None or _rank_of(candidate) > _rank_of(best_candidate)
            ):
                best_candidate = candidate
        return best_candidate

    @cached_property
    def other_candidates(self) -> Sequence[Candidate]:
        """Return programs that may have been meant as well: each costs about the same."""
        if (
            not (self.chosen_candidate and self.chosen_candidate.is_whole)
            or self.chosen_candidate.is_applied
        ):
            return ()
        candidates = {self.chosen_candidate.text: self.chosen_candidate}
        for cost, k, rival in self.rivals()[:MAX_ALTERNATIVES]:
            readings = [rival if line is self.lines[k] else line.reading for line in self.lines]
            candidate = self.candidate(readings, True) if cost < SURE_MARGIN else None
            if candidate and candidate.is_whole:
                candidates.setdefault(candidate.text, candidate)
        return [*candidates.values()][1:]

    def candidate(self, readings: list[Reading], has_blocks: bool) -> Candidate | None:
        """Return the program of some readings, None if it is no better than the text."""
        matching = self.match_blocks(readings if has_blocks else ())
        if matching is None:
            return None
        changes = self.make_changes(readings, matching)
        has_sure_blocks, move = matching.is_sure, None
        is_sure = has_sure_blocks and all(change.is_sure for change in changes)
        text = "\n".join(change.text for change in changes)
        mistakes_left = self.mistakes(text)
        if mistakes_left and set(mistakes_left) & rows.MISPLACED_CODES:
            for moved_program in reorder_defs(text):
                if mistakes_left and not self.mistakes(moved_program.text):
                    text, mistakes_left, changes, move = moved_program.text, [], [], moved_program
        is_better_alone = has_sure_blocks and _count_ends(text) == self.end_count
        if mistakes_left and not (
            (is_sure or is_better_alone) and len(mistakes_left) < self.mistake_count
        ):
            return None
        is_applied = is_sure and bool(text.strip(" ;\n")) and not (move and move.is_guess)
        return Candidate(text, is_applied, not mistakes_left, changes, has_sure_blocks, move)

    def rivals(self) -> list[tuple[float, int, Reading]]:
        """Return readings that are not the cheapest ones: how much more they cost, and the line."""
        costlier_readings = [
            (rival.cost - text.reading.cost, k, rival)
            for k, text in enumerate(self.lines)
            for rival in text.rivals
        ]
        return sorted(costlier_readings, key=lambda costlier_reading: costlier_reading[0])

    def choices(self) -> Iterator[tuple[list[Reading], bool]]:
        """Yield the readings of each line; finally those without the program's blocks."""
        cheapest_readings = [line.reading for line in self.lines]
        yield cheapest_readings, True
        for _, k, rival in self.rivals()[:MAX_ALTERNATIVES]:
            yield [*cheapest_readings[:k], rival, *cheapest_readings[k + 1 :]], True
        sure_readings = [
            reading if reading.is_sure else _UNREAD_LINE for reading in cheapest_readings
        ]
        unread_lines = (
            line
            for line, reading in zip(self.lines, sure_readings, strict=True)
            if reading.items is None
        )
        if not any(map(self.may_be_of_block, unread_lines)):  # they are instructions inside blocks
            yield sure_readings, True
        yield sure_readings, False
        has_blocks = [
            any(item.kind != "do" for item in reading.items or ()) for reading in sure_readings
        ]
        without_blocks = [
            _UNREAD_LINE if has_block else reading
            for reading, has_block in zip(sure_readings, has_blocks, strict=True)
        ]
        if without_blocks != sure_readings:
            yield without_blocks, False

    def may_be_of_block(self, line: _TextLine) -> bool:
        """Return whether an unreadable line may begin or end a block."""
        return any(
            word in BRACES
            or lexicon_meaning(word, *_BLOCK_START_KINDS)
            or self.names.find_meaning(word, NEAR_COST) in _BLOCK_WORDS
            for word in texts(lexemes(line.body))
        )

    def match_blocks(self, readings: Sequence[Reading]) -> Matching | None:
        """Return the ends that all blocks of the lines need, or None if they never fit."""
        read_lines = [
            Line(line.indent, _WHEN_AT_START.match(line.source.upper()) is not None, reading)
            for line, reading in zip(self.lines, readings, strict=False)
        ]
        matching = Matching(read_lines)
        return matching if matching.run() else None

    def make_changes(self, readings: Sequence[Reading], blocks: Matching) -> list[LineChange]:
        changes = []
        for k, (line, reading) in enumerate(zip(self.lines, readings, strict=True)):
            text = line.source
            if reading is not _UNREAD_LINE:
                edits, tails = blocks.edits_by_line.get(k, []), blocks.ends_on_line.get(k, [])
                text = _rewritten_line(line, reading, edits, tails) + line.note
            text = "\n".join((text, *blocks.ends_below.get(k, [])))
            steps, is_sure = (*line.steps, *reading.steps), line.is_sure and reading.is_sure
            changes.append(LineChange(line.first_line, line.last_line, text, steps, is_sure))
        return changes


def _may_be_mistyped_bracket(old_tokens: Sequence[Lexeme], new_tokens: Sequence[Lexeme]) -> bool:
    """Return whether a digit may be a mistyped bracket: `DISTANCE < 209`."""
    old_texts = texts(old_tokens)
    return old_texts.count("(") > old_texts.count(")") and any(
        sign.text == ")"
        and sign.source is None
        and re.fullmatch(f".+{rows.CLOSE_KEY}", previous_sign.text)
        for previous_sign, sign in pairwise(new_tokens)
    )


def _open_brackets(tokens: Sequence[Lexeme]) -> int:
    """Return the number of unclosed brackets."""
    depth = 0
    for sign in texts(tokens):
        depth = depth + 1 if sign == "(" else max(0, depth - (sign == ")"))
    return depth


def _count_ends(text: str) -> int:
    return sum(token.text in WORD_OF_END for token in lexemes(text))


def _rank_of(candidate: Candidate) -> tuple[bool, bool]:
    return candidate.is_whole, candidate.is_applied


def _count_kept(reading: Reading) -> int:
    """Return the number of the text's tokens in a reading; one with fewer is no equal rival."""
    return sum(token.source is not None for token in reading.tokens)


def _rewritten_line(
    line: _TextLine, reading: Reading, edits: Sequence[TokenEdit], tails: Sequence[str]
) -> str:
    tokens = list(reading.tokens)
    for edit in sorted(edits, key=lambda edit: -edit.start):
        tokens[edit.start : edit.start + edit.old_count] = edit.new_tokens
    tokens = _drop_empty_instructions(tokens) if edits else tokens
    if not reading.steps and not edits and not tails and line.body.isascii():
        return line.body
    for word in tails:
        tokens += [make_token(";"), make_token(word)]
    if reading.is_new_line or tails or any(len(edit.new_tokens) > 1 for edit in edits):
        text = line.source[: line.indent] + format_line(_drop_empty_instructions(tokens))
        return text if tails or len(reading.items or ()) > 1 else text.rstrip("; ")
    text = as_written(tokens).strip()
    if "| " not in line.body:
        text = text.replace("| ", "|", 1)  # a removed word leaves no blank
    return line.source[: line.indent] + text


def _drop_empty_instructions(tokens: Sequence[Lexeme]) -> list[Lexeme]:
    """Drop separators with nothing between them."""
    lexemes: list[Lexeme] = []
    for token in tokens:
        if token.text != ";" or (lexemes and lexemes[-1].text not in (";", "|")):
            lexemes.append(token)
    return lexemes
