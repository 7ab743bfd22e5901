"""Explanations: what was wrong with each line of a text, from the rewrites of its candidate.

A line has slips, `slips` says what each of them is; here they get their edits, and what belongs to
a block is told at its beginning. Knows no sentence of any language.
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
from tiniscript.recovery.ends import added_end, header_of, places_text, possible_places
from tiniscript.recovery.lines import BRACES, Step
from tiniscript.recovery.meanings import (
    WORD_OF_END,
    Lexeme,
    lexemes,
    lexicon_meaning,
    meant_by,
    plain,
    texts,
)
from tiniscript.recovery.search import Candidate
from tiniscript.recovery.slips import BLOCK_WORDS, Change, Slip, alike, instructions
from tiniscript.recovery.writing import in_one_line, laid_out, spoken_signs, tokens_of, without_note
from tiniscript.syntax.lexer import NUMBER, WORD

_MOST_SIGN_NAMES = 3  # names of signs that a message shows
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
_WORD, _WORD_BEFORE = re.compile(r"\w+"), re.compile(r"\w+\Z")
_SECOND_WORD = re.compile(r"\W*\w+[\s;]+(\w+)")
_ARMS = ("ELSE", "ELSEIF")
_WORDS_OF_SIGNS = ("BEEP", "SHOW", "S", "STOP")


class Slipped(NamedTuple):
    """A slip, and what only its line, or the text around it, can say of it.

    `right` are names that get their letters, or a note; `needless` is a brace, `early` an end, both
    too many. `spoken` are the names of signs, `digits` and `tones` the words of numbers. An end of
    another block stands for `fix`, the end of the `word` on line `line`.
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
        return slips.values_of(self.slip, code) | own_values


@dataclass
class Unended:
    """A block that begins with `word` and lacks its end, `right`.

    It has `behind` on its own line, where it may end after any of `places`, or it is `begun` on
    another line than that of the place, and line `line`, `last`, is its last one. Of `several`
    instructions the last one may as well be behind it: there `last` is empty. It may end `early`,
    on the line before one that `begins`.
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
    """What is told of a line: its code, and what it is `about`.

    Where more of its block changes, that becomes `whole`, and ends with `ends`.

    `place` is what `fix` stands for; `edits` are all that belong to it: ends, braces. It begins in
    change `first`, from 0; `last` is a change, and how many of its lines belong to it; `opened` are
    the changes in which blocks begin that it ends. `is_sure`: nothing that it changes is a guess.
    """

    code: Code
    place: Span
    span: Span
    about: Slipped | Unended
    edits: list[Edit]
    first: int
    last: tuple[int, int]
    whole: str = ""
    ends: str = ""
    opened: set[int] = field(default_factory=set)
    is_sure: bool = True

    @property
    def slip(self) -> Slip | None:
        return self.about.slip if isinstance(self.about, Slipped) else None

    @property
    def fix(self) -> str:
        """What the instruction becomes; nothing where only an end is missing."""
        about = self.about
        return (about.fix or slips.fix_of(about.slip)) if isinstance(about, Slipped) else ""

    def values_as(self, code: Code) -> dict[str, str]:
        """Return the values of a message with this code."""
        return self.about.values(code) | {"whole": self.whole, "ends": self.ends}


def explained(program: str, candidate: Candidate) -> list[Explanation]:
    """Return what is wrong with each line that a candidate changes, in the order of the text."""
    explainer = _Explainer(program, candidate)
    for k, change in enumerate(candidate.changes):
        explainer.explain_change(k, change)
    for item in explainer.out:
        explainer.complete(item)
    return explainer.out


@dataclass
class _Block:
    """A block that is open: what is told of its beginning, which is in change `first`.

    `inside` is the first word of each line of its last arm.
    """

    word: str
    first: int
    explanation: Explanation | None = None
    inside: list[str] = field(default_factory=list)


class _Explainer:
    def __init__(self, program: str, candidate: Candidate) -> None:
        self.program = program
        self.candidate = candidate
        self.changes = candidate.changes
        self.lines = program.split("\n")
        self.starts = [0, *accumulate(len(line) + 1 for line in self.lines)]
        self.out: list[Explanation] = []
        self.open: list[_Block] = []

    def complete(self, explanation: Explanation) -> None:
        if explanation.code is not codes.NEVER_ENDS:
            is_shown = self.candidate.is_whole and explanation.last > (explanation.first, 1)
            explanation.whole = (
                self.joined_changes(explanation.first, explanation.last) if is_shown else ""
            )
        start, end = self.words(explanation.edits[0].span)
        while start < end and self.program[start] in "\r\n":
            start += 1
        explanation.span = Span(start, end)
        explanation.is_sure = self.is_sure(explanation)

    def is_sure(self, explanation: Explanation) -> bool:
        """Whether nothing that an explanation changes is a guess."""
        places = (place for edit in explanation.edits for place in edit.span)
        lines = {self.program.count("\n", 0, place) for place in places}
        touched_changes = [
            change for change in self.changes if lines & {*range(change.first, change.last + 1)}
        ]
        touched_changes += [self.changes[k] for k in (explanation.first, *explanation.opened)]
        text = " ".join(f"{item.text} {self.lines[item.first]}" for item in touched_changes)
        has_blocks = bool({*re.findall(r"\w+|[{}]", text.upper())} & BLOCK_WORDS)
        is_block_sure = self.candidate.has_sure_blocks or not has_blocks
        return is_block_sure and all(item.is_sure for item in touched_changes)

    def words(self, span: Span) -> Span:
        """Return a span with all of the words that it begins and ends in."""
        start, end = span
        if start < end:
            line = self.program.rfind("\n", 0, start) + 1
            before = _WORD_BEFORE.search(self.program, line, start + 1)
            behind = _WORD.match(self.program, end - 1)
            start -= len(before[0]) - 1 if before else 0
            end += len(behind[0]) - 1 if behind else 0
        return Span(start, end)

    def joined_changes(self, first: int, last: tuple[int, int]) -> str:
        """Return what changes become, as one line, nothing where that is long."""
        *earlier_lines, text = (change.text for change in self.changes[first : last[0] + 1])
        return in_one_line("\n".join((*earlier_lines, *text.split("\n")[: last[1]])))

    def explain_change(self, k: int, change: search.Change) -> None:
        old = "\n".join(self.lines[change.first : change.last + 1]).rstrip("\r")
        own_text, *ends = change.text.split("\n")
        enclosing = self.open[-1] if self.open else None
        before, after = tokens_of(old), tokens_of(own_text)
        closed = self.walk(k, after)
        parts = [] if closed or "\n" in old else self.parts(k, old, own_text, before, after)
        for part in parts:
            self.new(k, part, *slips.code_of(part))
        if own_text != old and not parts:
            place = Span(self.starts[change.first], self.starts[change.first] + len(old))
            edit = trimmed(place.start, old, own_text)
            if ends and edit.span.start == place.end:
                edit = Edit(
                    place, own_text
                )  # the ends that are missing behind it come behind all of it
            part = Change(place, edit, self.changes[k].steps, before, after)
            code, step = slips.code_of(part)
            is_brace = code is codes.BRACES and before[0].text in BRACES
            is_arm = bool(after) and after[0].text in _ARMS
            has_added_end = code in (_ARM_CODES if is_arm else _BLOCK_CODES) and (
                closed or is_brace or is_arm
            )
            message = (
                self.added(closed or enclosing, edit, (k, 1), after) if has_added_end else None
            )
            message = message or self.new(k, part, code, step)
            message.opened |= {closed.first} if closed else set()
            if code is codes.WRONG_END and isinstance(details := message.about, Slipped):
                right = slips.right_of(details.slip)
                line = str(self.changes[closed.first if closed else k].first + 1)
                message.about = details._replace(
                    word=WORD_OF_END.get(right, ""), line=line, fix=right
                )
            for block in self.open:
                if block.first == k or is_brace:
                    block.explanation = block.explanation or message
        line_end = "\r\n" if "\r" in self.program else "\n"
        for count, end in enumerate(ends, 2):
            self.end((k, count), change, end.strip(), line_end + end)

    def parts(
        self, k: int, old: str, own_text: str, before: Sequence[Lexeme], after: Sequence[Lexeme]
    ) -> list[Change]:
        """Return the instructions of a line that change; nothing for one, or for others."""
        steps: dict[int, list[Step]] = {}
        for step in self.changes[k].steps:
            one, other = (instructions(item) for item in step[1:])
            if len(one) != len(other) or step.code is codes.ASKED_AFTER:
                return []
            pairs = enumerate(zip(one, other, strict=True))
            n = next((n for n, (a, b) in pairs if texts(a) != texts(b)), len(one) - 1)
            steps.setdefault(n, []).append(Step(step.code, one[n], other[n]))
        old_instructions, new_instructions = instructions(before), instructions(after)
        notes = (without_note(item)[1] for item in (old, own_text))
        if (
            len(old_instructions) != len(new_instructions)
            or len({*notes}) > 1
            or {*texts(before)} & {*BRACES}
        ):
            return []
        if _is_closed(before) and not all(map(_is_closed, old_instructions)):
            return []  # a separator is in brackets
        changes = []
        first, end = self.starts[self.changes[k].first], 0
        for n, (part, instruction) in enumerate(
            zip(old_instructions, new_instructions, strict=True)
        ):
            text, new = slips.text_of(part), slips.text_of(instruction)
            start = old.index(text, end)
            end = start + len(text)
            if text != new:
                place = Span(first + start, first + end)
                edit = trimmed(place.start, text, new)
                if edit.span.start == place.end:
                    edit = Edit(place, new)  # an end that is missing comes behind all of it
                changes.append(Change(place, edit, steps.get(n, []), part, instruction))
                if not steps.get(n) and text.isascii():
                    return []
        has_all_texts = all(it.after for it in changes)
        is_separate_line = not self.candidate.is_whole and has_all_texts  # others are not read
        return (
            changes if len(changes) > 1 or (len(old_instructions) > 1 and is_separate_line) else []
        )

    def walk(self, k: int, tokens: Sequence[Lexeme]) -> _Block | None:
        """Open and close blocks; return the first one that began in an earlier change."""
        closed = None
        if self.open and tokens:
            block_instructions, head = self.open[-1].inside, tokens[0].text
            block_instructions[:] = [] if head in _ARMS else [*block_instructions, head]
        for token in tokens:
            if token.text in BLOCK_ENDS:
                self.open.append(_Block(token.text, k))
            elif token.text in WORD_OF_END and self.open:
                ending_blocks = (
                    item for item in self.open[::-1] if item.word == WORD_OF_END[token.text]
                )
                block = next(ending_blocks, self.open[-1])  # ends may be crossed
                self.open.remove(block)
                closed = closed or (block if block.first < k else None)
                if block.explanation and block.explanation.last > (block.first, 1):
                    block.explanation.last = max(block.explanation.last, (k, 1))
        return closed

    def added(
        self, block: _Block | None, edit: Edit, last: tuple[int, int], after: Sequence[Lexeme]
    ) -> Explanation | None:
        """Make an edit part of what is told of the beginning of its block, None where too long."""
        explanation = block.explanation if block else None
        if block is None or explanation is None or explanation.code not in _CODES_SHOWN_WHOLE:
            return None
        first = min(explanation.first, block.first)
        if not self.joined_changes(first, last):
            return None
        explanation.edits.append(edit)
        explanation.first, explanation.last = first, max(explanation.last, last)
        ends = next((item.text for item in after if item.text in WORD_OF_END), "")
        explanation.ends = explanation.ends or ends
        return explanation

    def new(self, k: int, part: Change, code: Code, step: Step | None) -> Explanation:
        is_end = code is codes.NEVER_ENDS
        if (
            spoken_signs_found := spoken_signs(self.program[slice(*part.place)])
            if part.after
            else ()
        ):
            code = codes.OTHER_SIGN
            details: Slipped | Unended = Slipped(
                slips.slip_of(part, code, step),
                spoken=", ".join(spoken_signs_found[:_MOST_SIGN_NAMES]),
            )
        else:
            details = self.unended(k, part) if is_end else self.slipped(k, part, code, step)
        self.out.append(Explanation(code, part.place, part.place, details, [part.edit], k, (k, 1)))
        return self.out[-1]

    def slipped(self, k: int, part: Change, code: Code, step: Step | None) -> Slipped:
        slip = slips.slip_of(part, code, step)
        if code is codes.BRACES and part.before and not part.after:
            return Slipped(slip, needless=slips.found_in(slip))
        if code is codes.OTHER_NOTE:
            return Slipped(slip, right=self.changes[k].text.strip())
        if code is codes.EXTRA_WORD and not step:
            arm_match = _SECOND_WORD.match(self.program, self.words(part.edit.span).start)
            arm = arm_match[1].upper() if arm_match else ""
            is_early_arm = bool({arm, meant_by(arm)} & {*_ARMS})
            return Slipped(slip, early=slips.found_in(slip) if is_early_arm else "")
        if code is codes.OTHER_CALL and (words := _words_of_numbers(part)):
            is_tone = all(lexicon_meaning(plain(word), "note") for word in words)
            return Slipped(slip, **{"tones" if is_tone else "digits": ", ".join(words)})
        if code in _CODES_OF_EACH_WORD:  # LIGHT_L and LIGHT_R
            steps = (it for it in self.changes[k].steps if it.code is code)
            pairs = ((texts(it.before), texts(it.after)) for it in steps)
            names = [
                item
                for old_texts, new_texts in pairs
                for item in new_texts
                if item not in old_texts
            ]
            if slips.right_of(slip) in names:
                return Slipped(slip, right=", ".join(dict.fromkeys(names)))
        return Slipped(slip)

    def unended(self, k: int, part: Change) -> Unended:
        """Return what is said of a block that lacks its end on the line where it begins."""
        new_texts, at = texts(part.after), added_end(part.before, part.after)
        end = (
            next((it for it in new_texts if it in WORD_OF_END), "") if at is None else new_texts[at]
        )
        unended = Unended(WORD_OF_END.get(end, ""), end)
        block_instructions = [
            instruction for instruction in instructions(part.after[:at]) if instruction
        ]
        above = next((it for it in self.changes[k - 1 :: -1] if it.text.strip()), None)
        if at is not None and unended.word in new_texts[:at]:
            unended.behind = laid_out(block_instructions[-1]) if block_instructions else ""
            unended.places = places_text(
                possible_places(part.after[header_of(part.after, at) : at])
            )
        elif k and above:  # its indentation says where it ends
            unended.line, unended.last = str(above.last + 1), _first_line(above)
        return unended

    def end(self, last: tuple[int, int], change: search.Change, end: str, text: str) -> None:
        """Tell of an end that is missing behind a line."""
        block = self.open.pop() if self.open else None
        end_offset = self.starts[change.last] + len(self.lines[change.last].rstrip("\r"))
        edit = Edit(Span(end_offset, end_offset), text)
        if self.added(block, edit, last, lexemes(end)):
            return
        first, word = (block.first, block.word) if block else (last[0], "")
        result = Unended(word, end, line=str(change.last + 1), last=_first_line(change))
        whole_text = self.joined_changes(first, last)
        if block and self.may_end_earlier(block, last[0]):
            result.several, result.last, whole_text = result.last, "", ""
            if before := self.early(block, last[0]):
                result.early, result.begins = str(before.last + 1), _first_line(before)
        if first < last[0]:
            result.begun = str(self.changes[first].first + 1)
        place = Span(self.starts[self.changes[first].first], end_offset)
        self.out.append(
            Explanation(
                codes.NEVER_ENDS, place, place, result, [edit], first, (first, 1), whole_text
            )
        )

    def early(self, block: _Block, last: int) -> search.Change | None:
        """Return the line before an empty line in a block, or its first header.

        It may end there as well.
        """
        above = None
        for change in self.changes[block.first + 1 : last + 1]:
            words = texts(tokens_of(change.text))
            is_separate = not change.text.strip() or (words[:1] and words[0] in BLOCK_ENDS)
            if above and is_separate:
                return above
            above = change if words else above
        return None

    def may_end_earlier(self, block: _Block, last: int) -> bool:
        """Whether nothing says that the last instruction of a block is in it.

        A sign or a stop behind others may as well come when a LOOP or a DEF is over.
        """
        block_instructions = block.inside
        header, end = (self.changes[k].text.split("\n")[0] for k in (block.first, last))
        is_deeper = end[:1].isspace() > header[:1].isspace()
        is_endless = {*texts(lexemes(header))} & {"FOREVER", "TRUE"}
        if len(block_instructions) < 2 or self.candidate.has_sure_blocks or is_deeper or is_endless:
            return False
        is_sign_of_end = (
            block_instructions[-1] in _WORDS_OF_SIGNS
            and block_instructions[-1] not in block_instructions[:-1]
        )
        return is_sign_of_end or block.word not in ("LOOP", "DEF")


def _first_line(change: search.Change) -> str:
    return laid_out(tokens_of(change.text.split("\n")[0]))


def _words_of_numbers(part: Change) -> list[str]:
    """Return the words that a change writes in digits, nothing where it changes more."""
    if len(part.before) != len(part.after):
        return []
    pairs = zip(part.before, part.after, strict=True)
    changed_pairs = [(was, now) for was, now in pairs if was.text != now.text]
    are_words = all(was.kind is WORD and now.kind is NUMBER for was, now in changed_pairs)
    return list(dict.fromkeys(was.source or "" for was, _ in changed_pairs)) if are_words else []


def _is_closed(tokens: Sequence[Lexeme]) -> bool:
    return texts(tokens).count("(") == texts(tokens).count(")")


def trimmed(start: int, old: str, new: str) -> Edit:
    """Return the edit of what differs."""
    head, tail = alike(old, new)
    return Edit(Span(start + head, start + len(old) - tail), new[head : len(new) - tail])
