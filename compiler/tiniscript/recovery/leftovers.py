"""What is left over in an instruction: words that say nothing, and a second `SI|`.

Each is told to be taken out as what it is: an instruction without values is done with its word.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Source, Span
from tiniscript.base.words import WORDS, concept_of, lexicon
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.recovery.meanings import ENDED, Lexeme, Names, lexemes
from tiniscript.recovery.writing import without_note
from tiniscript.syntax.lexer import WORD

_SETUP = re.compile(r"(?i)(?P<before>\)|\w)?[ \t]*\b(?P<setup>S[IB][ \t]*\|)(?!\|)[ \t]*")
_PART = re.compile(r"[^;{}|]+")
_MOST = 3  # words
_ALONE = frozenset(("BREAK", "S", "START", "STOP", *ENDED))
_MEANS_NOTHING = frozenset((
    "filler", "small", "please", "the", "of", "to", "in", "is", "soon", "there", "this", "so", "bye",
    "above", "program", "all", "moment", "one", "ahead", "first", "idle",
))  # fmt: skip


def leftovers(source: Source, kit: Kit) -> list[Diagnostic]:
    """Return what is told of all that is left over in a text."""
    rows = [without_note(line)[0] for line in source.text.split("\n")]
    names = Names([lexemes(row) for row in rows], kit)
    told: list[Diagnostic] = []
    start, is_begun = 0, False
    for row, line in zip(rows, source.text.split("\n"), strict=True):
        told += [*_setups(row, start, is_begun), *_words(row, start, names)]
        is_begun = is_begun or bool(row.strip())
        start += len(line) + 1
    return told


def _setups(row: str, start: int, is_begun: bool) -> Iterator[Diagnostic]:
    """Give each `SI|` behind an instruction of its line: what follows it comes next."""
    for match in _SETUP.finditer(row):
        if match["before"] is None or match["setup"][1:2] in "Bb":
            continue
        place = Span(start + match.start("setup"), start + match.end("setup"))
        edit = Edit(Span(start + match.end("before"), start + match.end()), "; ")
        values = {"found": match["setup"], "between": match["setup"]}
        yield Diagnostic(codes.SETUP_TWICE, place, values, place, Repair((edit,), True))


def _words(row: str, start: int, names: Names) -> Iterator[Diagnostic]:
    for part in _PART.finditer(row):
        tokens = lexemes(part[0])
        if not 1 < len(tokens) <= 1 + _MOST or tokens[0].text not in _ALONE:
            continue
        if all(_says_nothing(token, names) for token in tokens[1:]):
            end = start + part.start() + len(part[0].rstrip())
            begin = start + part.start() + part[0].index(tokens[0].source or "")
            begin += len(tokens[0].source or "")
            words = " ".join(token.source or "" for token in tokens[1:])
            span = Span(end - len(part[0].rstrip()[begin - start - part.start() :].lstrip()), end)
            repair = Repair((Edit(Span(begin, end), ""),), False)
            values = {"words": words, "needless": words}
            yield Diagnostic(codes.WORDS_BEHIND, span, values, span, repair)


def _says_nothing(token: Lexeme, names: Names) -> bool:
    """Whether a token is a word that is no order, no name and no part of a sentence."""
    word = token.text
    if token.kind is not WORD or word in WORDS or names.is_name(word) or names.meant(word):
        return False
    kinds = {said.kind for said in lexicon().get(word, ())}
    return concept_of(word) is None and kinds <= _MEANS_NOTHING
