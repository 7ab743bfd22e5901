"""Explanations: what was wrong with each line of a text, from the rewrites of its candidate.

Typed values and edits. Knows no sentence of any language.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from difflib import SequenceMatcher
from itertools import groupby
from typing import NamedTuple

from tiniscript.diagnostics import codes
from tiniscript.recovery import rows
from tiniscript.recovery.blocks import BRACES
from tiniscript.recovery.concepts import Lexeme, lexemes, said_of, texts
from tiniscript.recovery.lines import Step
from tiniscript.recovery.search import Candidate
from tiniscript.recovery.writing import laid_out, without_note
from tiniscript.source import Edit, Span
from tiniscript.syntax.lexer import NUMBER, WORD
from tiniscript.words import BLOCK_ENDS, WORDS, meant_by

_IF, _WORD_CODE = codes.SPANISH_IF.number, rows.OTHER_WORD


class Slip(NamedTuple):
    """`found` is written `right`; all of the instruction, where a sign is missing or too much.

    `word`, written as in `usage`, begins the instruction, and `before` stands before the slip;
    `fix` is what the instruction becomes.
    """

    found: str
    right: str
    before: str
    word: str
    usage: str
    fix: str


class Explanation(NamedTuple):
    """A slip, and the code it is told with.

    `place` is what the slip's `fix` stands for; `edits` are all that belong to it: ends, braces.
    """

    code: str
    span: Span
    place: Span
    slip: Slip
    edits: list[Edit]

    def is_same(self, code: str, slip: Slip) -> bool:
        one, other = ((each.found.upper(), each.word) for each in (self.slip, slip))
        return self.code == code and one == other


def explained(program: str, found: Candidate) -> list[Explanation]:
    """Return what is wrong with each line that a candidate changes, in the order of the text."""
    out: list[Explanation] = []
    lines = program.split("\n")
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line) + 1)
    steps = {k: [step for _, step in own] for k, own in groupby(found.steps, key=lambda it: it[0])}
    for k, change in enumerate(found.changes):
        old = "\n".join(lines[change.first : change.last + 1]).rstrip("\r")
        new = change.text.replace("\n", "\r\n" if "\r" in program else "\n")
        if new == old:
            continue
        edit = _trimmed(starts[change.first], old, new)
        before, after = lexemes(without_note(old)[0]), lexemes(without_note(new)[0])
        code = _code(steps.get(k, []), before, after)
        is_brace = len(before) == 1 or (out and out[-1].code == code)
        if out and code in _CLOSING and (code != _BRACES or is_brace):
            out[-1].edits.append(edit)
        else:
            slip = _slip(code, before, after)
            if code == codes.OTHER_NOTE.number:
                slip = slip._replace(right=change.text.strip())
            same = [each for each in out if code in _SAID_ONCE and each.is_same(code, slip)]
            if same:
                same[0].edits.append(edit)
                continue
            place = Span(starts[change.first], starts[change.first] + len(old))
            out.append(Explanation(code, edit.span, place, slip, [edit]))
    return out


_BRACES = codes.BRACES.number
_SAID_ONCE = (codes.BAD_NAME.number, codes.EMPTY_BRACKETS.number, codes.NAME_WITH_SPACE.number)
_CLOSING = (codes.NEVER_ENDS.number, codes.END_ALONE.number, _BRACES)


def _trimmed(start: int, old: str, new: str) -> Edit:
    """Return the edit of what differs."""
    most = min(len(old), len(new))
    head = next((k for k in range(most) if old[k] != new[k]), most)
    most -= head
    tail = next((k for k in range(most) if old[-1 - k] != new[-1 - k]), most)
    return Edit(Span(start + head, start + len(old) - tail), new[head : len(new) - tail])


def _code(steps: Sequence[Step], before: Sequence[Lexeme], after: Sequence[Lexeme]) -> str:
    """Return with which code a line is told."""
    words, new = set(texts(before)), set(texts(after))
    if "SI" in words - new and "IF" in new - words:
        return _IF
    own = [step.code for step in steps if step.code != _WORD_CODE]
    own.sort(key=lambda each: each == codes.OTHER_SIGN.number)
    if steps:
        is_translated = any(
            each.kind is WORD and each.text not in new and meant_by(each.text) in new - words
            for each in before
        )
        has_brackets = "(" in words or "(" not in new
        if not (own or is_translated or has_brackets) and before[0].text in WORDS:
            return rows.NO_BRACKETS
        return _WORD_CODE if is_translated or not own else own[0]
    if words & {*BRACES}:
        return _BRACES
    source = "".join(each.source or "" for each in before)
    if not source.isascii():
        has_word = any(each.kind is WORD and not (each.source or "").isascii() for each in before)
        return (codes.BAD_NAME if has_word else codes.OTHER_SIGN).number
    ends = [each.text for each in before if said_of(each.text, "end")]
    if ends and ends[-1] not in new:
        return (codes.END_ALONE if new & {*BLOCK_ENDS.values()} else codes.EXTRA_WORD).number
    return codes.NEVER_ENDS.number


def _slip(code: str, before: Sequence[Lexeme], after: Sequence[Lexeme]) -> Slip:
    start, found, right = _first_difference(before, after)
    if code == rows.WITH_UNIT and found and start and before[start - 1].kind is NUMBER:
        found = [before[start - 1], *found]  # `2 s`
    told, fix = list(_parted(before)), list(_parted(after))
    head, tail = _alike(told, fix)
    one = [each for part in told[head : len(told) - tail] for each in part]
    other = fix[head : len(fix) - tail]
    word = next((each.text for part in other for each in part if each.kind is WORD), "")
    if code == codes.EMPTY_BRACKETS.number and start:
        word = before[start - 1].text
    known = WORDS.get(word)
    was = _written(found or one)
    if code == codes.OTHER_NOTE.number:
        was = was[: re.match(r"\W*", was).end()].strip()  # type: ignore[union-attr]
    shown = ";".join(laid_out(part) for part in other)
    now = laid_out(right) or shown
    now = now.partition("(")[0] if code == _WORD_CODE else now
    return Slip(was, now, _written(one[:start]), word, known.usage if known else "", shown)


def _first_difference(
    before: Sequence[Lexeme], after: Sequence[Lexeme]
) -> tuple[int, Sequence[Lexeme], Sequence[Lexeme]]:
    """Return where two lines differ first, and what stands there in each of them."""
    old = [each.text if (each.source or "").isascii() else each.source for each in before]
    matched = SequenceMatcher(None, old, texts(after), autojunk=False)
    for kind, start, end, begin, stop in matched.get_opcodes():
        if kind != "equal":
            return start, before[start:end], after[begin:stop]
    return 0, before, after


def _written(tokens: Sequence[Lexeme]) -> str:
    return "".join((each.space or "") + (each.source or each.text) for each in tokens).strip()


def _parted(tokens: Sequence[Lexeme]) -> Iterator[list[Lexeme]]:
    """Give the instructions of a line."""
    for is_end, part in groupby(tokens, key=lambda each: each.text in (";", "|")):
        if not is_end:
            yield list(part)


def _alike(one: Sequence[Sequence[Lexeme]], other: Sequence[Sequence[Lexeme]]) -> tuple[int, int]:
    """Return how many instructions begin and end two lines alike."""
    old, new = [texts(each) for each in one], [texts(each) for each in other]
    most = min(len(old), len(new))
    head = next((k for k in range(most) if old[k] != new[k]), most)
    most -= head
    return head, next((k for k in range(most) if old[-1 - k] != new[-1 - k]), most)
