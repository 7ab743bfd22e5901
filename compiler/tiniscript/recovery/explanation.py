"""Explanations: what was wrong with each line of a text, from the rewrites of its candidate.

A line has slips, `slips` says what each of them is; here they get their edits, and messages about a
block move to its beginning. Knows no sentence of any language.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from itertools import accumulate
from typing import NamedTuple

from tiniscript.base.source import Edit, Span
from tiniscript.base.words import BLOCK_ENDS
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code
from tiniscript.recovery import search, slips
from tiniscript.recovery.ends import (
    added_end_index,
    candidates_text,
    header_index,
    possible_last_instructions,
)
from tiniscript.recovery.lines import BRACES, Step
from tiniscript.recovery.meanings import (
    Lexeme,
    certain_concept,
    lexemes,
    lexicon_meaning,
    plain,
    texts,
)
from tiniscript.recovery.search import Candidate
from tiniscript.recovery.slips import (
    BLOCK_WORDS,
    InstructionChange,
    Slip,
    common_lengths,
    instructions,
)
from tiniscript.recovery.writing import (
    format_line,
    in_one_line,
    split_note,
    spoken_signs,
    tokens_of,
)
from tiniscript.syntax.blocks import WORD_OF_END
from tiniscript.syntax.lexer import NUMBER, WORD

_MAX_SIGN_NAMES = 3  # names of signs that a message shows
_CODES_OF_EACH_WORD = (codes.BAD_NAME, codes.EMPTY_BRACKETS, codes.NAME_WITH_SPACE)
# Codes of what belongs to the beginning of its block, where something is wrong with that, too.
_BLOCK_CODES = (codes.NEVER_ENDS, codes.END_ALONE, codes.END_SPLIT, codes.BRACES,
                codes.ASKED_AFTER, codes.OTHER_LANGUAGE)  # fmt: skip
_CODES_SHOWN_WHOLE = frozenset((
    codes.MISSING_SEPARATOR, codes.HEADER_SEPARATOR, codes.MISSING_OPEN, codes.MISSING_CLOSE,
    codes.END_SPLIT, codes.END_ALONE, codes.FOREVER_NOT_HERE, codes.SPANISH_IF,
    codes.BRACES, codes.OTHER_ASSIGNMENT, codes.ASKED_AFTER, codes.GROUPED, codes.OTHER_LANGUAGE,
))  # fmt: skip
_ARM_CODES = (codes.BRACES, codes.OTHER_LANGUAGE, codes.HEADER_SEPARATOR)
_WORD, _WORD_AT_END = re.compile(r"\w+"), re.compile(r"\w+\Z")
_SECOND_WORD = re.compile(r"\W*\w+[\s;]+(\w+)")
_ARMS = ("ELSE", "ELSEIF")
_WORDS_OF_SIGNS = ("BEEP", "SHOW", "S", "STOP")


class SlipDetails(NamedTuple):
    """A slip, with the information from its line and the text around it.

    `right` are names that get their letters, or a note; `needless` is a brace, `early` an end, both
    too many. `spoken` are the names of signs, `digits` and `tones` the words of numbers. An end of
    another block is in the place of `fix`, the end of the `word` on line `line`.
    """

    slip: Slip
    right: str = ""
    needless: str = ""
    early: str = ""
    word: str = ""
    line: str = ""
    fix: str = ""
    spoken: str = ""
    digits: str = ""
    tones: str = ""

    def values(self, code: Code) -> dict[str, str]:
        own_values = {
            name: str(value) for name, value in self._asdict().items() if name != "slip" and value
        }
        return slips.message_values(self.slip, code) | own_values


@dataclass
class UnendedBlock:
    """A block that begins with `word` and lacks its end, `right`.

    Either it has `behind` on its own line, and may end after any of `places`; or it is `begun` on
    another line than that of the place, and line `line`, `last`, is its last one. With `several`
    instructions, the last one may also be after it: then `last` is empty. It may end `early`, on
    the line before one that `begins`.
    """

    word: str
    right: str
    behind: str = ""
    places: str = ""
    begun: str = ""
    line: str = ""
    last: str = ""
    several: str = ""
    early: str = ""
    begins: str = ""

    def values(self, _: Code) -> dict[str, str]:
        return asdict(self)


@dataclass
class Explanation:
    """The explanation of a line: its code, and `details`.

    If more of its block changes, the block becomes `block_text` and ends with `end_word`.

    `fix` replaces the text at `place`; `edits` are all edits that belong to it: ends, braces. It
    begins in change `first_change`, from 0; `last_line` is a change, and how many of its lines
    belong to it; `opening_changes` are the changes in which blocks begin that it ends. `is_sure`:
    none of its changes is a guess.
    """

    code: Code
    place: Span
    span: Span
    details: SlipDetails | UnendedBlock
    edits: list[Edit]
    first_change: int
    last_line: tuple[int, int]
    block_text: str = ""
    end_word: str = ""
    opening_changes: set[int] = field(default_factory=set)
    is_sure: bool = True

    @property
    def slip(self) -> Slip | None:
        return self.details.slip if isinstance(self.details, SlipDetails) else None

    @property
    def fix(self) -> str:
        """Return the repaired instruction; "" if only an end is missing."""
        details = self.details
        return (
            (details.fix or slips.fix_of(details.slip)) if isinstance(details, SlipDetails) else ""
        )

    def values_as(self, code: Code) -> dict[str, str]:
        """Return the values of a message with this code."""
        return self.details.values(code) | {"whole": self.block_text, "ends": self.end_word}


def explain_candidate(program: str, candidate: Candidate) -> list[Explanation]:
    """Return the explanations of each line that a candidate changes, in the order of the text."""
    explainer = _Explainer(program, candidate)
    for k, change in enumerate(candidate.changes):
        explainer.explain_change(k, change)
    for explanation in explainer.explanations:
        explainer.finish(explanation)
    return explainer.explanations


@dataclass
class _ExplainedBlock:
    """An open block: the message about its beginning, which is in change `first_change`.

    `first_words` is the first word of each line of its last arm.
    """

    word: str
    first_change: int
    explanation: Explanation | None = None
    first_words: list[str] = field(default_factory=list)


class _Explainer:
    def __init__(self, program: str, candidate: Candidate) -> None:
        self.program = program
        self.candidate = candidate
        self.changes = candidate.changes
        self.lines = program.split("\n")
        self.line_starts = [0, *accumulate(len(line) + 1 for line in self.lines)]
        self.explanations: list[Explanation] = []
        self.open_blocks: list[_ExplainedBlock] = []

    def finish(self, explanation: Explanation) -> None:
        if explanation.code is not codes.NEVER_ENDS:
            is_shown = self.candidate.is_whole and explanation.last_line > (
                explanation.first_change,
                1,
            )
            explanation.block_text = (
                self.joined_changes(explanation.first_change, explanation.last_line)
                if is_shown
                else ""
            )
        start, end = self.widen_to_words(explanation.edits[0].span)
        while start < end and self.program[start] in "\r\n":
            start += 1
        explanation.span = Span(start, end)
        explanation.is_sure = self.is_sure(explanation)

    def is_sure(self, explanation: Explanation) -> bool:
        """Return whether none of an explanation's changes is a guess."""
        offsets = (offset for edit in explanation.edits for offset in edit.span)
        lines = {self.program.count("\n", 0, offset) for offset in offsets}
        touched_changes = [
            change
            for change in self.changes
            if lines & {*range(change.first_line, change.last_line + 1)}
        ]
        touched_changes += [
            self.changes[k] for k in (explanation.first_change, *explanation.opening_changes)
        ]
        text = " ".join(
            f"{change.text} {self.lines[change.first_line]}" for change in touched_changes
        )
        has_blocks = bool({*re.findall(r"\w+|[{}]", text.upper())} & BLOCK_WORDS)
        is_block_sure = self.candidate.has_sure_blocks or not has_blocks
        return is_block_sure and all(change.is_sure for change in touched_changes)

    def widen_to_words(self, span: Span) -> Span:
        """Return a span with all of the words that it begins and ends in."""
        start, end = span
        if start < end:
            line_start = self.program.rfind("\n", 0, start) + 1
            head_match = _WORD_AT_END.search(self.program, line_start, start + 1)
            tail_match = _WORD.match(self.program, end - 1)
            start -= len(head_match[0]) - 1 if head_match else 0
            end += len(tail_match[0]) - 1 if tail_match else 0
        return Span(start, end)

    def joined_changes(self, first_change: int, last_line: tuple[int, int]) -> str:
        """Return the result of changes as one line, or "" if it is long."""
        *earlier_lines, last_text = (
            change.text for change in self.changes[first_change : last_line[0] + 1]
        )
        return in_one_line("\n".join((*earlier_lines, *last_text.split("\n")[: last_line[1]])))

    def explain_change(self, k: int, change: search.LineChange) -> None:
        old_text = "\n".join(self.lines[change.first_line : change.last_line + 1]).rstrip("\r")
        own_text, *ends = change.text.split("\n")
        enclosing_block = self.open_blocks[-1] if self.open_blocks else None
        old_tokens, new_tokens = tokens_of(old_text), tokens_of(own_text)
        closed_block = self.track_blocks(k, new_tokens)
        instructions_changed = (
            []
            if closed_block or "\n" in old_text
            else self.changed_instructions(k, old_text, own_text, old_tokens, new_tokens)
        )
        for instruction in instructions_changed:
            self.add_explanation(k, instruction, *slips.code_of(instruction))
        if own_text != old_text and not instructions_changed:
            span = Span(
                self.line_starts[change.first_line],
                self.line_starts[change.first_line] + len(old_text),
            )
            edit = trimmed_edit(span.start, old_text, own_text)
            if ends and edit.span.start == span.end:
                edit = Edit(span, own_text)  # missing ends come after all of it
            instruction = InstructionChange(
                span, edit, self.changes[k].steps, old_tokens, new_tokens
            )
            code, step = slips.code_of(instruction)
            is_brace = code is codes.BRACES and old_tokens[0].text in BRACES
            is_arm = bool(new_tokens) and new_tokens[0].text in _ARMS
            has_added_end = code in (_ARM_CODES if is_arm else _BLOCK_CODES) and (
                closed_block or is_brace or is_arm
            )
            explanation = (
                self.add_to_block_start(closed_block or enclosing_block, edit, (k, 1), new_tokens)
                if has_added_end
                else None
            )
            explanation = explanation or self.add_explanation(k, instruction, code, step)
            explanation.opening_changes |= {closed_block.first_change} if closed_block else set()
            if code is codes.WRONG_END and isinstance(details := explanation.details, SlipDetails):
                right = slips.right_text_of(details.slip)
                line = str(
                    self.changes[closed_block.first_change if closed_block else k].first_line + 1
                )
                explanation.details = details._replace(
                    word=WORD_OF_END.get(right, ""), line=line, fix=right
                )
            for block in self.open_blocks:
                if block.first_change == k or is_brace:
                    block.explanation = block.explanation or explanation
        line_end = "\r\n" if "\r" in self.program else "\n"
        for count, end in enumerate(ends, 2):
            self.add_missing_end((k, count), change, end.strip(), line_end + end)

    def changed_instructions(
        self,
        k: int,
        old_text: str,
        own_text: str,
        old_tokens: Sequence[Lexeme],
        new_tokens: Sequence[Lexeme],
    ) -> list[InstructionChange]:
        """Return the instructions of a line that change; or an empty list for one, or for
        others."""
        steps_by_instruction: dict[int, list[Step]] = {}
        for step in self.changes[k].steps:
            instructions_before, instructions_after = (instructions(tokens) for tokens in step[1:])
            if (
                len(instructions_before) != len(instructions_after)
                or step.code is codes.ASKED_AFTER
            ):
                return []
            pairs = enumerate(zip(instructions_before, instructions_after, strict=True))
            n = next(
                (n for n, (a, b) in pairs if texts(a) != texts(b)), len(instructions_before) - 1
            )
            steps_by_instruction.setdefault(n, []).append(
                Step(step.code, instructions_before[n], instructions_after[n])
            )
        old_instructions, new_instructions = instructions(old_tokens), instructions(new_tokens)
        notes = (split_note(line)[1] for line in (old_text, own_text))
        if (
            len(old_instructions) != len(new_instructions)
            or len({*notes}) > 1
            or {*texts(old_tokens)} & {*BRACES}
        ):
            return []
        if _is_closed(old_tokens) and not all(map(_is_closed, old_instructions)):
            return []  # a separator is in brackets
        changes = []
        line_start, end = self.line_starts[self.changes[k].first_line], 0
        for n, (instruction, new_instruction) in enumerate(
            zip(old_instructions, new_instructions, strict=True)
        ):
            text, new_text = slips.text_of(instruction), slips.text_of(new_instruction)
            start = old_text.index(text, end)
            end = start + len(text)
            if text != new_text:
                span = Span(line_start + start, line_start + end)
                edit = trimmed_edit(span.start, text, new_text)
                if edit.span.start == span.end:
                    edit = Edit(span, new_text)  # a missing end comes after all of it
                changes.append(
                    InstructionChange(
                        span, edit, steps_by_instruction.get(n, []), instruction, new_instruction
                    )
                )
                if not steps_by_instruction.get(n) and text.isascii():
                    return []
        has_all_texts = all(change.new_tokens for change in changes)
        is_separate_line = not self.candidate.is_whole and has_all_texts  # others are not read
        return (
            changes if len(changes) > 1 or (len(old_instructions) > 1 and is_separate_line) else []
        )

    def track_blocks(self, k: int, tokens: Sequence[Lexeme]) -> _ExplainedBlock | None:
        """Open and close blocks; return the first one that began in an earlier change."""
        closed_block = None
        if self.open_blocks and tokens:
            block_instructions, head = self.open_blocks[-1].first_words, tokens[0].text
            block_instructions[:] = [] if head in _ARMS else [*block_instructions, head]
        for token in tokens:
            if token.text in BLOCK_ENDS:
                self.open_blocks.append(_ExplainedBlock(token.text, k))
            elif token.text in WORD_OF_END and self.open_blocks:
                ending_blocks = (
                    item for item in self.open_blocks[::-1] if item.word == WORD_OF_END[token.text]
                )
                block = next(ending_blocks, self.open_blocks[-1])  # ends may be crossed
                self.open_blocks.remove(block)
                closed_block = closed_block or (block if block.first_change < k else None)
                if block.explanation and block.explanation.last_line > (block.first_change, 1):
                    block.explanation.last_line = max(block.explanation.last_line, (k, 1))
        return closed_block

    def add_to_block_start(
        self,
        block: _ExplainedBlock | None,
        edit: Edit,
        last_line: tuple[int, int],
        new_tokens: Sequence[Lexeme],
    ) -> Explanation | None:
        """Add an edit to the message about its block's beginning, or return None if too long."""
        explanation = block.explanation if block else None
        if block is None or explanation is None or explanation.code not in _CODES_SHOWN_WHOLE:
            return None
        first_change = min(explanation.first_change, block.first_change)
        if not self.joined_changes(first_change, last_line):
            return None
        explanation.edits.append(edit)
        explanation.first_change, explanation.last_line = (
            first_change,
            max(explanation.last_line, last_line),
        )
        ends = next((token.text for token in new_tokens if token.text in WORD_OF_END), "")
        explanation.end_word = explanation.end_word or ends
        return explanation

    def add_explanation(
        self, k: int, change: InstructionChange, code: Code, step: Step | None
    ) -> Explanation:
        is_end = code is codes.NEVER_ENDS
        if (
            found_spoken_signs := spoken_signs(self.program[slice(*change.span)])
            if change.new_tokens
            else ()
        ):
            code = codes.OTHER_SIGN
            details: SlipDetails | UnendedBlock = SlipDetails(
                slips.slip_of(change, code, step),
                spoken=", ".join(found_spoken_signs[:_MAX_SIGN_NAMES]),
            )
        else:
            details = (
                self.describe_unended(k, change)
                if is_end
                else self.describe_slip(k, change, code, step)
            )
        self.explanations.append(
            Explanation(code, change.span, change.span, details, [change.edit], k, (k, 1))
        )
        return self.explanations[-1]

    def describe_slip(
        self, k: int, change: InstructionChange, code: Code, step: Step | None
    ) -> SlipDetails:
        slip = slips.slip_of(change, code, step)
        if code is codes.BRACES and change.old_tokens and not change.new_tokens:
            return SlipDetails(slip, needless=slips.wrong_text_of(slip))
        if code is codes.OTHER_NOTE:
            return SlipDetails(slip, right=self.changes[k].text.strip())
        if code is codes.EXTRA_WORD and not step:
            arm_match = _SECOND_WORD.match(
                self.program, self.widen_to_words(change.edit.span).start
            )
            second_word = arm_match[1].upper() if arm_match else ""
            is_early_arm = bool({second_word, certain_concept(second_word)} & {*_ARMS})
            return SlipDetails(slip, early=slips.wrong_text_of(slip) if is_early_arm else "")
        if code is codes.OTHER_CALL and (words := _words_of_numbers(change)):
            is_tone = all(lexicon_meaning(plain(word), "note") for word in words)
            return SlipDetails(slip, **{"tones" if is_tone else "digits": ", ".join(words)})
        if code in _CODES_OF_EACH_WORD:  # LIGHT_L and LIGHT_R
            steps = (step for step in self.changes[k].steps if step.code is code)
            pairs = ((texts(step.old_tokens), texts(step.new_tokens)) for step in steps)
            names = [
                name
                for old_texts, new_texts in pairs
                for name in new_texts
                if name not in old_texts
            ]
            if slips.right_text_of(slip) in names:
                return SlipDetails(slip, right=", ".join(dict.fromkeys(names)))
        return SlipDetails(slip)

    def describe_unended(self, k: int, change: InstructionChange) -> UnendedBlock:
        """Return the description of a block without an end, on the line where it begins."""
        new_texts, end_index = (
            texts(change.new_tokens),
            added_end_index(change.old_tokens, change.new_tokens),
        )
        end = (
            next((text for text in new_texts if text in WORD_OF_END), "")
            if end_index is None
            else new_texts[end_index]
        )
        unended_block = UnendedBlock(WORD_OF_END.get(end, ""), end)
        block_instructions = [
            instruction
            for instruction in instructions(change.new_tokens[:end_index])
            if instruction
        ]
        change_above = next(
            (change for change in self.changes[k - 1 :: -1] if change.text.strip()), None
        )
        if end_index is not None and unended_block.word in new_texts[:end_index]:
            unended_block.behind = format_line(block_instructions[-1]) if block_instructions else ""
            unended_block.places = candidates_text(
                possible_last_instructions(
                    change.new_tokens[header_index(change.new_tokens, end_index) : end_index]
                )
            )
        elif k and change_above:  # its indentation shows where it ends
            unended_block.line, unended_block.last = (
                str(change_above.last_line + 1),
                _first_line(change_above),
            )
        return unended_block

    def add_missing_end(
        self, last_line: tuple[int, int], change: search.LineChange, end: str, text: str
    ) -> None:
        """Tell of an end that is missing after a line."""
        block = self.open_blocks.pop() if self.open_blocks else None
        end_offset = self.line_starts[change.last_line] + len(
            self.lines[change.last_line].rstrip("\r")
        )
        edit = Edit(Span(end_offset, end_offset), text)
        if self.add_to_block_start(block, edit, last_line, lexemes(end)):
            return
        first_change, word = (block.first_change, block.word) if block else (last_line[0], "")
        details = UnendedBlock(word, end, line=str(change.last_line + 1), last=_first_line(change))
        whole_text = self.joined_changes(first_change, last_line)
        if block and self.may_end_earlier(block, last_line[0]):
            details.several, details.last, whole_text = details.last, "", ""
            if earlier_change := self.earlier_end(block, last_line[0]):
                details.early, details.begins = (
                    str(earlier_change.last_line + 1),
                    _first_line(earlier_change),
                )
        if first_change < last_line[0]:
            details.begun = str(self.changes[first_change].first_line + 1)
        span = Span(self.line_starts[self.changes[first_change].first_line], end_offset)
        self.explanations.append(
            Explanation(
                codes.NEVER_ENDS,
                span,
                span,
                details,
                [edit],
                first_change,
                (first_change, 1),
                whole_text,
            )
        )

    def earlier_end(self, block: _ExplainedBlock, last_index: int) -> search.LineChange | None:
        """Return the line before an empty line in a block, or its first header.

        It may end there as well.
        """
        change_above = None
        for change in self.changes[block.first_change + 1 : last_index + 1]:
            words = texts(tokens_of(change.text))
            is_separate = not change.text.strip() or (words[:1] and words[0] in BLOCK_ENDS)
            if change_above and is_separate:
                return change_above
            change_above = change if words else change_above
        return None

    def may_end_earlier(self, block: _ExplainedBlock, last_change: int) -> bool:
        """Return whether the last instruction of a block may be outside of it.

        A sign or a stop after others may as well come when a LOOP or a DEF is over.
        """
        first_words = block.first_words
        header, last_text = (
            self.changes[k].text.split("\n")[0] for k in (block.first_change, last_change)
        )
        is_deeper = last_text[:1].isspace() > header[:1].isspace()
        is_endless = {*texts(lexemes(header))} & {"FOREVER", "TRUE"}
        if len(first_words) < 2 or self.candidate.has_sure_blocks or is_deeper or is_endless:
            return False
        is_sign_of_end = (
            first_words[-1] in _WORDS_OF_SIGNS and first_words[-1] not in first_words[:-1]
        )
        return is_sign_of_end or block.word not in ("LOOP", "DEF")


def _first_line(change: search.LineChange) -> str:
    return format_line(tokens_of(change.text.split("\n")[0]))


def _words_of_numbers(change: InstructionChange) -> list[str]:
    """Return the words that a change writes in digits, nothing if it changes more."""
    if len(change.old_tokens) != len(change.new_tokens):
        return []
    pairs = zip(change.old_tokens, change.new_tokens, strict=True)
    changed_pairs = [
        (old_token, new_token) for old_token, new_token in pairs if old_token.text != new_token.text
    ]
    are_words = all(
        old_token.kind is WORD and new_token.kind is NUMBER
        for old_token, new_token in changed_pairs
    )
    return (
        list(dict.fromkeys(old_token.source or "" for old_token, _ in changed_pairs))
        if are_words
        else []
    )


def _is_closed(tokens: Sequence[Lexeme]) -> bool:
    return texts(tokens).count("(") == texts(tokens).count(")")


def trimmed_edit(start: int, old_text: str, new_text: str) -> Edit:
    """Return the edit, reduced to the part that differs."""
    head, tail = common_lengths(old_text, new_text)
    return Edit(
        Span(start + head, start + len(old_text) - tail), new_text[head : len(new_text) - tail]
    )
