"""Explanations: what was wrong with a text, from the rewrites of its candidate.

Typed values, a NamedTuple for each family of messages. Knows no sentence of any language.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from tiniscript.recovery.concepts import Lexeme, texts
from tiniscript.recovery.lines import Step
from tiniscript.recovery.search import Candidate
from tiniscript.recovery.writing import laid_out
from tiniscript.syntax.lexer import NUMBER, WORD


class Missing(NamedTuple):
    """`sign` is missing behind `before`."""

    code: str
    line: int
    sign: str
    before: str


class Needless(NamedTuple):
    """`found` is too much."""

    code: str
    line: int
    found: str


class OtherWord(NamedTuple):
    """`found` is said `right` here."""

    code: str
    line: int
    found: str
    right: str


class OtherSign(NamedTuple):
    """`found` stands where `right` is meant."""

    code: str
    line: int
    found: str
    right: str


class OtherNumber(NamedTuple):
    """The number `found` is written `right`."""

    code: str
    line: int
    found: str
    right: str


class Rewritten(NamedTuple):
    """What is said by `found` is written `right`."""

    code: str
    line: int
    found: str
    right: str


Explanation = Missing | Needless | OtherWord | OtherSign | OtherNumber | Rewritten


_FAMILIES: dict[str, type[OtherWord | OtherNumber]] = {WORD: OtherWord, NUMBER: OtherNumber}


def explained(found: Candidate) -> list[Explanation]:
    """Return what each rewrite of a candidate says, in the order of the text; lines from 1."""
    steps = sorted(enumerate(found.steps), key=lambda each: (each[1][0], each[0]))
    return [_explained(line + 1, step) for _, (line, step) in steps]


def _explained(line: int, step: Step) -> Explanation:
    head, old, new = difference(step.before, step.after)
    was, right = laid_out(old), laid_out(new)
    if not old:
        return Missing(step.code, line, right, step.after[head - 1].text if head else "")
    if not new:
        return Needless(step.code, line, was)
    if len(old) > 1 or len(new) > 1:
        return Rewritten(step.code, line, was, right)
    kinds = {each.kind for each in (*old, *new)}
    family = _FAMILIES.get(old[0].kind, OtherSign) if len(kinds) == 1 else Rewritten
    found: Explanation = family(step.code, line, was, right)
    return found


def difference(
    before: Sequence[Lexeme], after: Sequence[Lexeme]
) -> tuple[int, Sequence[Lexeme], Sequence[Lexeme]]:
    """Return how many tokens are alike at the beginning, and those that differ."""
    old, new = texts(before), texts(after)
    most = min(len(old), len(new))
    head = next((k for k in range(most) if old[k] != new[k]), most)
    most -= head
    tail = next((k for k in range(most) if old[-1 - k] != new[-1 - k]), most)
    return head, before[head : len(old) - tail], after[head : len(new) - tail]
