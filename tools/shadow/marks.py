"""How recovery answers beside what is pinned: one mark for each program.

Knows what is pinned in `tests/pupils`, and which programs are put aside. Prints nothing.
"""

from __future__ import annotations

import hashlib
import re
from functools import cache
from typing import NamedTuple

from tests.pupils.corpus import Entry, check
from tiniscript import compile_text, robots
from tiniscript.base.source import applied
from tiniscript.diagnostics.codes import Code
from tiniscript.diagnostics.fixing import fixed, offer
from tiniscript.library.compiling import analyzed
from tiniscript.recovery.concepts import plain
from tiniscript.recovery.search import Candidate, Recovery
from tiniscript.recovery.setup import setup
from tiniscript.recovery.suggestions import suggested

SAME, EQUIVALENT, QUESTION, USAGE, WORSE = "same", "equivalent", "question", "usage", "worse"
OFFERS = 6  # of today's messages that are followed, one after the other
MARKS = (SAME, EQUIVALENT, QUESTION, USAGE, WORSE)
KIT = robots.load(robots.DEFAULT).kit


def is_aside(program: str) -> bool:
    """Whether a program belongs to the quarter that nobody tunes on."""
    return hashlib.sha256(program.encode()).digest()[0] % 4 == 0


@cache
def mistakes(program: str) -> tuple[Code, ...]:
    return tuple(each.code for each in analyzed(program, KIT).diagnostics if each.is_mistake)


@cache
def image(program: str) -> bytes:
    """Return the bytecode of a program, nothing for a wrong one."""
    found = compile_text(program, KIT)
    return found.image if found.is_right else b""


def meant(program: str) -> Candidate | None:
    return Recovery(program, KIT, mistakes).best()


class Answer(NamedTuple):
    """`code` is the first mistake that today's messages name."""

    entry: Entry
    mark: str
    found: Candidate | None

    @property
    def code(self) -> str:
        return self.entry.said[0].split(" ")[1] if self.entry.said else ""


def answer(entry: Entry) -> Answer:
    """Compare what becomes of a program with what is pinned.

    Where words are told beside it, or what stands for its `SI|`, that is what `--fix` makes. Where
    nothing is repaired, it is the same to repair nothing, equivalent to make what the messages
    tell to try, and worse to make anything else: of a reading of the whole text, since one of a
    part is not made.
    """
    found = meant(entry.program)
    if Recovery(entry.program, KIT, mistakes).sure() is None:
        if suggested(entry.program, KIT) or setup(entry.program):
            text = fixed(entry.program, check).text
            found = Candidate(text, True, False, ()) if text != entry.program else None
        elif found and entry.mended is None:
            found = found._replace(is_applied=False)
    return Answer(entry, mark_of(entry, found), found)


def mark_of(entry: Entry, found: Candidate | None) -> str:
    is_applied = found is not None and found.is_applied
    if entry.mended is None:
        is_told = is_applied and found is not None and is_offered(entry.program, found.text)
        return EQUIVALENT if is_told else WORSE if is_applied else SAME
    if found is None:
        return USAGE
    text = "\n".join(line.rstrip() for line in found.text.split("\n"))
    if same_tokens(text, entry.mended):
        return SAME if is_applied else QUESTION
    if image(text) and image(text) == image(entry.mended):
        return EQUIVALENT if is_applied else QUESTION
    if image(text) and not image(entry.mended) and is_offered(entry.mended, text):
        return EQUIVALENT if is_applied else QUESTION
    return WORSE if is_applied else USAGE


def is_offered(program: str, text: str) -> bool:
    """Whether a right text is what today's messages of a program tell to try, all of them."""
    meant = image(text)
    for _ in range(OFFERS):
        found = check(program)
        tried = (offer(program, found, which, check) for which in range(len(found)))
        edits = next(filter(None, tried), None)
        if not meant or edits is None:
            return False
        program = applied(program, edits)
        if image(program):
            return image(program) == meant
    return False


def same_tokens(one: str, other: str) -> bool:
    """Whether two texts differ in spaces, line ends, comments and letter case alone."""
    return _instructions(one) == _instructions(other)


def _instructions(text: str) -> list[str]:
    bare = re.sub(r"//[^\n]*", "", plain(text))
    return [each for each in re.split(r"[;\n]", re.sub(r"[ \t]+", "", bare)) if each]
