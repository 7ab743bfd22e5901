"""What is left over in an instruction: words that say nothing, and a second `SI|`.

Each is told to be taken out as what it is: an instruction without values is done with its word.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence, Set
from itertools import accumulate

from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Source, Span
from tiniscript.base.words import BLOCK_ENDS, WORDS, lexicon, lexicon_concept, lexicon_meaning
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.recovery.calls import likely_word
from tiniscript.recovery.meanings import ASKING_WORDS, WORD_OF_END, Lexeme, Names, lexemes, plain
from tiniscript.recovery.writing import without_note
from tiniscript.syntax.lexer import WORD

_SETUP_ANYWHERE = re.compile(r"(?i)(?P<before>\)|\w)?[ \t]*\b(?P<setup>S[IB][ \t]*\|)(?!\|)[ \t]*")
_SETUP_AT_START = re.compile(r"(?i)^\s*S[IB]\s*\|")
_NAMED_TASK = re.compile(r"\bTASK[ \t]+([A-Z]\w*)")
_INSTRUCTION = re.compile(r"[^;{}|]+")
_CALL = re.compile(r"\s*(\w+)\s*(?:\([^()]*\))?[\s.]*")
_HEADER_WORDS = frozenset((*BLOCK_ENDS, *ASKING_WORDS, "ELSE", "FOREVER"))
_MOST_LEFTOVER_WORDS = 3  # words
_WORDS_ALONE = frozenset(("BREAK", "S", "START", "STOP", *WORD_OF_END))
_EMPTY_WORDS = frozenset((
    "filler", "small", "please", "the", "of", "to", "in", "is", "soon", "there", "this", "so",
    "bye", "above", "program", "all", "moment", "one", "ahead", "first", "idle",
))  # fmt: skip


def leftovers(source: Source, kit: Kit) -> list[Diagnostic]:
    """Return what is told of all that is left over in a text."""
    rows = [without_note(line)[0] for line in source.text.split("\n")]
    names = Names([lexemes(row) for row in rows], kit)
    lines = source.text.split("\n")
    starts = [0, *accumulate(len(line) + 1 for line in lines)]
    tasks = frozenset(_NAMED_TASK.findall(plain(source.text)))  # which have no name
    diagnostics: list[Diagnostic] = []
    for row, start in zip(rows, starts, strict=False):
        diagnostics += _words(row, start, names, tasks)
    return diagnostics


def setup_and_end_leftovers(source: Source, kit: Kit) -> list[Diagnostic]:
    """Return what is told of each `SI|` after an instruction, and of a word for the end of all."""
    rows = [without_note(line)[0] for line in source.text.split("\n")]
    starts = [0, *accumulate(len(line) + 1 for line in source.text.split("\n"))]
    messages = [
        setup for row, start in zip(rows, starts, strict=False) for setup in _setups(row, start)
    ]
    return [*messages, *_ending(rows, starts, Names([lexemes(row) for row in rows], kit))]


def _ending(rows: Sequence[str], starts: Sequence[int], names: Names) -> Iterator[Diagnostic]:
    """Give the word for an end below a program in which no block begins: `Fim.`"""
    last = max((k for k, row in enumerate(rows) if row.strip()), default=0)
    tokens = [token for token in lexemes(rows[last]) if token.text not in (".", ";")]
    instructions_above = [
        part
        for row in rows[:last]
        for part in _SETUP_AT_START.sub("", row).split(";")
        if part.strip()
    ]
    calls = [_CALL.fullmatch(part) for part in instructions_above]
    has_block_start = any(it is None or not _is_call(it, names) for it in calls)
    is_end = len(tokens) == 1 and last > 0 and bool(lexicon_meaning(tokens[0].text, "end"))
    if is_end and not has_block_start and not names.is_name(tokens[0].text):
        begin = starts[last] + len(rows[last]) - len(rows[last].lstrip())
        span = Span(begin, starts[last] + len(rows[last]))
        word = tokens[0].source or ""
        repair = Repair((Edit(span, ""),), True)
        yield Diagnostic(codes.EXTRA_WORD, span, {"found": word}, span, repair)


def _is_call(part: re.Match[str], names: Names) -> bool:
    """Whether an instruction begins no block: it is one of the language, or nearly so."""
    word = part[1].upper()
    meant = names.meant(word) or likely_word(word, part[0].strip())
    return names.is_name(word) or (meant in WORDS and meant not in _HEADER_WORDS)


def _setups(row: str, start: int) -> Iterator[Diagnostic]:
    """Give each `SI|` behind an instruction of its line: what follows it comes next."""
    for match in _SETUP_ANYWHERE.finditer(row):
        follows_instruction = match["before"] == ")" or bool(
            _SETUP_AT_START.search(row[: match.start("setup")])
        )
        if match["before"] is None or not follows_instruction or match["setup"][1:2] in "Bb":
            continue
        place = Span(start + match.start("setup"), start + match.end("setup"))
        edit = Edit(Span(start + match.end("before"), start + match.end()), "; ")
        values = {"found": match["setup"], "between": match["setup"]}
        yield Diagnostic(codes.SETUP_TWICE, place, values, place, Repair((edit,), True))


def _words(row: str, start: int, names: Names, tasks: Set[str]) -> Iterator[Diagnostic]:
    for part in _INSTRUCTION.finditer(row):
        tokens = lexemes(part[0])
        if not 1 < len(tokens) <= 1 + _MOST_LEFTOVER_WORDS or tokens[0].text not in _WORDS_ALONE:
            continue
        if all(it.text in tasks or _is_filler(it, names) for it in tokens[1:]):
            end = start + part.start() + len(part[0].rstrip())
            begin = start + part.start() + part[0].index(tokens[0].source or "")
            begin += len(tokens[0].source or "")
            words = " ".join(token.source or "" for token in tokens[1:])
            span = Span(end - len(part[0].rstrip()[begin - start - part.start() :].lstrip()), end)
            repair = Repair((Edit(Span(begin, end), ""),), False)
            values = {"before": tokens[0].source or "", "words": words, "needless": words}
            yield Diagnostic(codes.WORDS_AFTER, span, values, span, repair)


def _is_filler(token: Lexeme, names: Names) -> bool:
    """Whether a token is a word that is no order, no name and no part of a sentence."""
    word = token.text
    if token.kind is not WORD or word in WORDS or names.is_name(word) or names.meant(word):
        return False
    kinds = {item.kind for item in lexicon().get(word, ())}
    return lexicon_concept(word) is None and kinds <= _EMPTY_WORDS
