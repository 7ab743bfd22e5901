"""Candidates: whole programs that a wrong one may have been meant to be, and which one counts.

The judge is who asks: the parser and the checker. A candidate has no mistakes, or fewer where a
part of the text cannot be read; numbers, names and commands change by a row alone.
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
from tiniscript.recovery.blocks import Edit, Line, Matching
from tiniscript.recovery.lines import BRACES, SURE_MARGIN, Reading, Step, is_right
from tiniscript.recovery.meanings import (
    NEAR,
    WORD_OF_END,
    Lexeme,
    Names,
    lexemes,
    lexicon_meaning,
    made,
    plain,
    texts,
    words_of,
)
from tiniscript.recovery.moved import Moved, ordered
from tiniscript.recovery.writing import (
    PLAIN_SIGNS,
    as_written,
    is_guessed,
    laid_out,
    with_signs,
    without_note,
)
from tiniscript.syntax.outline import Failure

MOST_UNREAD_LINES = 5  # lines that nobody can read, after which others are read quickly
MOST_ALTERNATIVES = 12  # readings of a line that are tried beside the cheapest ones
# A line that begins a block whose condition comes at its end, and its last line.
_LONE_LOOP_START = re.compile(
    rf"\s*(?:S[IB]\s*\|\s*)?(?:LOOP|{words_of('repeat', 'make')})\b\s*\{{?\s*$"
)
_END_UNTIL = re.compile(rf"\b{words_of('end')}[ _]?{words_of('until')}\b")
_SETUP_AT_START = re.compile(r"^\s*SI\s*\|\s*(?=\w)", re.IGNORECASE)
_WHEN_AT_START = re.compile(rf"\s*(S[IB]\s*\|)?\s*{words_of('whenever')}\b")

# What begins a block or ends one, as far as a word says it.
_BLOCK_WORDS = frozenset((*BLOCK_ENDS, *WORD_OF_END, "ELSE", "ELSEIF", "FOREVER", "UNTIL"))
_BLOCK_START_KINDS = ("count", "each", "every", "unless", "when", "end", "repeat", "main")

Mistakes = Callable[[str], Sequence[Code]]  # the codes of a program's mistakes


class Change(NamedTuple):
    """What lines become by their rewrites, `first` to `last`, from 0: `text`; most stay as is."""

    first: int
    last: int
    text: str
    steps: Sequence[Step]
    is_sure: bool  # else it is a guess


class Candidate(NamedTuple):
    """A program that may have been meant. `is_applied`: it may be made without asking.

    `is_whole`: it has no mistakes; else fewer than the text. `changes` are of all lines, none
    where a DEF is moved: `move`.
    """

    text: str
    is_applied: bool
    is_whole: bool
    changes: Sequence[Change]
    has_sure_blocks: bool = True
    move: Moved | None = None


_UNREAD_LINE = Reading(0, [], (), True, False)


class _Text:
    """A line on its way: what was written, and the readings of it."""

    def __init__(self, source: str, at: int) -> None:
        self.source = source
        self.first = self.last = at
        self.body, self.note = without_note(source)
        self.steps: list[Step] = []
        self.is_sure = True
        self.reading = _UNREAD_LINE
        self.rivals: list[Reading] = []

    @property
    def indent(self) -> int:
        return len(self.source) - len(self.source.lstrip(" \t"))


class Recovery:
    """What may have been meant by a wrong program; each line of it is read once.

    What a line may be read as (`choices`) gets its blocks and is asked about (`candidate`), until
    `whole` has a program without mistakes.
    """

    def __init__(self, program: str, kit: Kit, mistakes: Mistakes) -> None:
        self.program = program
        self.kit = kit
        self.mistakes = mistakes
        self.count = len(mistakes(program))
        self.ends = _count_ends(program)
        self.unread = 0
        self.lines = [_Text(line, k) for k, line in enumerate(program.split("\n"))]
        self.drop_setups()
        self.read_signs()
        self.join_until()
        self.names = Names([lexemes(text.body) for text in self.lines], kit)
        self._reading = self._read_lines()

    def sure(self) -> Candidate | None:
        """Return the program that is meant wholly and surely: soon, where a line is not read so."""
        if not self.count or not all(self._reading):
            return None
        meant = self.whole
        return meant if meant and meant.is_whole and meant.is_applied else None

    def best(self) -> Candidate | None:
        """Return the program that was meant, or None; a right one has no other."""
        if not self.count:
            return None
        for _ in self._reading:
            pass
        return self.whole

    def _read_lines(self) -> Iterator[bool]:
        """Read each line, and give whether it is read surely."""
        for line in self.lines:
            self.read_line(line)
            yield line.reading.items is not None and line.reading.is_sure
        rows_of = ([lexemes(text.body), text.reading.tokens] for text in self.lines)
        new_names, names = Names([*chain(*rows_of)], self.kit), self.names
        if new := (new_names.variables | new_names.defs) - names.variables - names.defs:
            self.names = new_names
            for line in self.lines:
                if line.reading.items is None and new & {*texts(lexemes(line.body))}:
                    self.read_line(line)

    def read_signs(self) -> None:
        """Make the rewrites of signs, in the lines that have them.

        But none that loses a DEF, or opens a bracket that was closed: `F(2;80) R(1;50)` has no list
        of `80)`.
        """
        names = Names([lexemes(text.body) for text in self.lines], self.kit)
        for line in self.lines:
            if (dictated := with_signs(line.body)) != line.body:
                before, after = lexemes(line.body), lexemes(dictated)
                line.steps.append(Step(codes.OTHER_SIGN, before, after))
                line.is_sure = not is_guessed(line.body)
                line.body = dictated
            body = line.body.translate(PLAIN_SIGNS)
            if body == line.body and is_right(lexemes(body), names):
                continue
            for row in rewrites.of_signs():
                for _ in row.pattern.findall(body):  # a step each, which is told at its place
                    new = row.pattern.sub(row.replacement, body, count=1)
                    before, after = lexemes(body), lexemes(new)
                    lost_defs = names.defs & ({*texts(before)} - {*texts(after)})
                    if (
                        new != body
                        and not lost_defs
                        and _open_brackets(after) <= _open_brackets(before)
                    ):
                        line.steps.append(Step(row.code, before, after))
                        line.is_sure = line.is_sure and not row.is_offered
                        body = new
            line.body, note = without_note(body)
            line.note = note + line.note

    def has_signs(self, start: int) -> bool:
        """Whether rewrites of signs alone make the line right that a place is in."""
        at = self.program.count("\n", 0, start)
        lines_near = (line for line in self.lines if line.steps and line.first <= at <= line.last)
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
        texts: list[_Text] = []
        until_pattern = re.compile(rf"^\s*{words_of('until')}\b", re.MULTILINE)
        text = plain(self.program)
        if not until_pattern.search(text) or _END_UNTIL.search(text):
            return  # there is none, or it is taken for a block
        is_do_line = False
        for line in self.lines:
            text_above = next((text for text in reversed(texts) if text.body.strip()), None)
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
                text_above.last = line.last
                text_above.steps.append(
                    Step(codes.UNTIL_ALONE, lexemes(line.body), lexemes(text_above.body))
                )
            else:
                texts.append(line)
            is_do_line = is_do_line or _LONE_LOOP_START.match(plain(line.body)) is not None
        self.lines = texts

    def read_line(self, line: _Text) -> None:
        """Find the cheapest reading of a line, sure if no rival costs about as much; else parts."""
        tokens, names = lexemes(line.body), self.names
        items = lines.right(tokens, names)
        if not isinstance(items, Failure):
            line.reading = Reading(0, tokens, (), True, False, items)
            return
        readings = lines.read(tokens, names, is_quick=self.unread > MOST_UNREAD_LINES)
        if not readings:
            self.unread += 1
            line.reading = self.parts(tokens, names)
            return
        first = readings[0]
        line.rivals = [reading for reading in readings[1:] if reading.text_read != first.text_read]
        has_close_rival = any(
            rival.is_sure
            and rival.cost < first.cost + SURE_MARGIN
            and _count_kept(rival) >= _count_kept(first)
            for rival in line.rivals
        )
        is_sure = first.is_sure and not has_close_rival and not _is_key(tokens, first.tokens)
        line.reading = first._replace(is_sure=is_sure)

    def parts(self, tokens: list[Lexeme], names: Names) -> Reading:
        """Read each instruction of a line alone, where one cannot be read, if it is sure."""
        steps: list[Step] = []
        ends = [k for k, lexeme in enumerate([*tokens, made(";")]) if lexeme.text == ";"]
        ends = [k for k in ends if k == len(tokens) or not _open_brackets(tokens[:k])]
        for start, end in [*pairwise((-1, *ends))][::-1]:
            head, part, tail = tokens[: start + 1], tokens[start + 1 : end], tokens[end:]
            readings = lines.read(part, names, is_quick=True)[:1]
            for reading in readings if readings and readings[0].is_sure else ():
                tokens = [*head, *reading.tokens, *tail]
                steps += [
                    Step(code, [*head, *before, *tail], [*head, *after, *tail])
                    for code, before, after in reading.steps
                ]
        return Reading(0, tokens, tuple(steps), True, False) if steps else _UNREAD_LINE

    @cached_property
    def whole(self) -> Candidate | None:
        """Return the first sure program without mistakes; else an unsure one; else a part."""
        best: Candidate | None = None
        for readings, has_blocks in self.choices():
            if best is not None and best.is_applied and best.is_whole:
                break
            if best is not None and has_blocks and all(it.items is not None for it in readings):
                continue
            candidate = self.candidate(readings, has_blocks)
            if candidate and (best is None or _rank(candidate) > _rank(best)):
                best = candidate
        return best

    @cached_property
    def others(self) -> Sequence[Candidate]:
        """Return programs that may have been meant as well: each costs about the same."""
        if not (self.whole and self.whole.is_whole) or self.whole.is_applied:
            return ()
        candidates = {self.whole.text: self.whole}
        for cost, k, rival in self.rivals()[:MOST_ALTERNATIVES]:
            readings = [rival if it is self.lines[k] else it.reading for it in self.lines]
            other = self.candidate(readings, True) if cost < SURE_MARGIN else None
            if other and other.is_whole:
                candidates.setdefault(other.text, other)
        return [*candidates.values()][1:]

    def candidate(self, readings: list[Reading], has_blocks: bool) -> Candidate | None:
        """Return the program of some readings, None where it is no better than the text."""
        blocks = self.matched(readings if has_blocks else ())
        if blocks is None:
            return None
        changes = self.changes(readings, blocks)
        has_sure_blocks, move = blocks.is_sure, None
        is_sure = has_sure_blocks and all(change.is_sure for change in changes)
        text = "\n".join(change.text for change in changes)
        mistakes_left = self.mistakes(text)
        if mistakes_left and set(mistakes_left) & rows.MISPLACED:
            for moved_program in ordered(text):
                if mistakes_left and not self.mistakes(moved_program.text):
                    text, mistakes_left, changes, move = moved_program.text, [], [], moved_program
        is_better_alone = has_sure_blocks and _count_ends(text) == self.ends
        if mistakes_left and not ((is_sure or is_better_alone) and len(mistakes_left) < self.count):
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
        return sorted(costlier_readings, key=lambda it: it[0])

    def choices(self) -> Iterator[tuple[list[Reading], bool]]:
        """Give what each line may be read as; at last without the blocks of a program."""
        cheapest = [line.reading for line in self.lines]
        yield cheapest, True
        for _, k, rival in self.rivals()[:MOST_ALTERNATIVES]:
            yield [*cheapest[:k], rival, *cheapest[k + 1 :]], True
        sure_readings = [reading if reading.is_sure else _UNREAD_LINE for reading in cheapest]
        unread = (
            one
            for one, reading in zip(self.lines, sure_readings, strict=True)
            if reading.items is None
        )
        if not any(map(self.may_be_of_block, unread)):  # they are instructions in their blocks
            yield sure_readings, True
        yield sure_readings, False
        has_blocks = [
            any(it.kind != "do" for it in reading.items or ()) for reading in sure_readings
        ]
        without_blocks = [
            _UNREAD_LINE if has_block else reading
            for reading, has_block in zip(sure_readings, has_blocks, strict=True)
        ]
        if without_blocks != sure_readings:
            yield without_blocks, False

    def may_be_of_block(self, line: _Text) -> bool:
        """Whether a line that nobody can read may begin a block, or end one."""
        return any(
            word in BRACES
            or lexicon_meaning(word, *_BLOCK_START_KINDS)
            or self.names.meant(word, NEAR) in _BLOCK_WORDS
            for word in texts(lexemes(line.body))
        )

    def matched(self, readings: Sequence[Reading]) -> Matching | None:
        """Return what all blocks of the lines need, or None where they fit in no way."""
        read = [
            Line(line.indent, _WHEN_AT_START.match(line.source.upper()) is not None, reading)
            for line, reading in zip(self.lines, readings, strict=False)
        ]
        matching = Matching(read)
        return matching if matching.run() else None

    def changes(self, readings: Sequence[Reading], blocks: Matching) -> list[Change]:
        changes = []
        for k, (line, reading) in enumerate(zip(self.lines, readings, strict=True)):
            text = line.source
            if reading is not _UNREAD_LINE:
                edits, tails = blocks.edits.get(k, []), blocks.tails.get(k, [])
                text = _line(line, reading, edits, tails) + line.note
            text = "\n".join((text, *blocks.behind.get(k, [])))
            steps, is_sure = (*line.steps, *reading.steps), line.is_sure and reading.is_sure
            changes.append(Change(line.first, line.last, text, steps, is_sure))
        return changes


def _is_key(old: Sequence[Lexeme], new: Sequence[Lexeme]) -> bool:
    """Whether a digit may be meant for the bracket that is missing after it: `DISTANCE < 209`."""
    text = texts(old)
    return text.count("(") > text.count(")") and any(
        sign.text == ")" and sign.source is None and re.fullmatch(f".+{rows.CLOSE_KEY}", one.text)
        for one, sign in pairwise(new)
    )


def _open_brackets(tokens: Sequence[Lexeme]) -> int:
    """Return how many brackets are not closed."""
    depth = 0
    for sign in texts(tokens):
        depth = depth + 1 if sign == "(" else max(0, depth - (sign == ")"))
    return depth


def _count_ends(text: str) -> int:
    return sum(lexeme.text in WORD_OF_END for lexeme in lexemes(text))


def _rank(candidate: Candidate) -> tuple[bool, bool]:
    return candidate.is_whole, candidate.is_applied


def _count_kept(reading: Reading) -> int:
    """Return how many tokens of the text are in a reading: one with fewer is no equal rival."""
    return sum(token.source is not None for token in reading.tokens)


def _line(line: _Text, reading: Reading, edits: Sequence[Edit], tails: Sequence[str]) -> str:
    tokens = list(reading.tokens)
    for edit in sorted(edits, key=lambda edit: -edit.at):
        tokens[edit.at : edit.at + edit.old] = edit.new
    tokens = _without_empty(tokens) if edits else tokens
    if not reading.steps and not edits and not tails and line.body.isascii():
        return line.body
    for word in tails:
        tokens += [made(";"), made(word)]
    if reading.is_new_line or tails or any(len(edit.new) > 1 for edit in edits):
        text = line.source[: line.indent] + laid_out(_without_empty(tokens))
        return text if tails or len(reading.items or ()) > 1 else text.rstrip("; ")
    text = as_written(tokens).strip()
    if "| " not in line.body:
        text = text.replace("| ", "|", 1)  # a word that is gone leaves no blank
    return line.source[: line.indent] + text


def _without_empty(tokens: Sequence[Lexeme]) -> list[Lexeme]:
    """Drop separators with nothing between them."""
    lexemes: list[Lexeme] = []
    for token in tokens:
        if token.text != ";" or (lexemes and lexemes[-1].text not in (";", "|")):
            lexemes.append(token)
    return lexemes
