"""Superfluous parts of an instruction: words without meaning, and a second `SI|`.

Each message names what to remove: an instruction without values runs with its word alone.
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
from tiniscript.recovery.meanings import ASKING_WORDS, Lexeme, Names, lexemes, plain
from tiniscript.recovery.writing import split_note
from tiniscript.syntax.blocks import WORD_OF_END
from tiniscript.syntax.lexer import WORD

_SETUP_ANYWHERE = re.compile(r"(?i)(?P<before>\)|\w)?[ \t]*\b(?P<setup>S[IB][ \t]*\|)(?!\|)[ \t]*")
_SETUP_AT_START = re.compile(r"(?i)^\s*S[IB]\s*\|")
_NAMED_TASK = re.compile(r"\bTASK[ \t]+([A-Z]\w*)")
_INSTRUCTION = re.compile(r"[^;{}|]+")
_CALL = re.compile(r"\s*(\w+)\s*(?:\([^()]*\))?[\s.]*")
_HEADER_WORDS = frozenset((*BLOCK_ENDS, *ASKING_WORDS, "ELSE", "FOREVER"))
_MAX_LEFTOVER_WORDS = 3  # words
_WORDS_ALONE = frozenset(("BREAK", "S", "START", "STOP", *WORD_OF_END))
_EMPTY_WORDS = frozenset((
    "filler", "small", "please", "the", "of", "to", "in", "is", "soon", "there", "this", "so",
    "bye", "above", "program", "all", "moment", "one", "ahead", "first", "idle",
))  # fmt: skip


def leftover_diagnostics(source: Source, kit: Kit) -> list[Diagnostic]:
    """Return the diagnostics for the superfluous parts of a text."""
    bodies = [split_note(line)[0] for line in source.text.split("\n")]
    names = Names([lexemes(body) for body in bodies], kit)
    lines = source.text.split("\n")
    starts = [0, *accumulate(len(line) + 1 for line in lines)]
    # Names of tasks, which have none in this language.
    tasks = frozenset(_NAMED_TASK.findall(plain(source.text)))
    diagnostics: list[Diagnostic] = []
    for body, start in zip(bodies, starts, strict=False):
        diagnostics += _filler_diagnostics(body, start, names, tasks)
    return diagnostics


def setup_and_end_diagnostics(source: Source, kit: Kit) -> list[Diagnostic]:
    """Return the diagnostics for an `SI|` after an instruction, and for a final end word."""
    bodies = [split_note(line)[0] for line in source.text.split("\n")]
    starts = [0, *accumulate(len(line) + 1 for line in source.text.split("\n"))]
    setup_diagnostics = [
        diagnostic
        for body, start in zip(bodies, starts, strict=False)
        for diagnostic in _setup_diagnostics(body, start)
    ]
    return [
        *setup_diagnostics,
        *_end_word_diagnostics(bodies, starts, Names([lexemes(body) for body in bodies], kit)),
    ]


def _end_word_diagnostics(
    bodies: Sequence[str], starts: Sequence[int], names: Names
) -> Iterator[Diagnostic]:
    """Yield the end word below a program in which no block begins: `Fim.`"""
    last_index = max((k for k, body in enumerate(bodies) if body.strip()), default=0)
    tokens = [token for token in lexemes(bodies[last_index]) if token.text not in (".", ";")]
    instructions_above = [
        instruction
        for body in bodies[:last_index]
        for instruction in _SETUP_AT_START.sub("", body).split(";")
        if instruction.strip()
    ]
    calls = [_CALL.fullmatch(instruction) for instruction in instructions_above]
    has_block_start = any(call is None or not _is_call(call, names) for call in calls)
    is_end = len(tokens) == 1 and last_index > 0 and bool(lexicon_meaning(tokens[0].text, "end"))
    if is_end and not has_block_start and not names.is_name(tokens[0].text):
        word_start = starts[last_index] + len(bodies[last_index]) - len(bodies[last_index].lstrip())
        span = Span(word_start, starts[last_index] + len(bodies[last_index]))
        word = tokens[0].source or ""
        repair = Repair((Edit(span, ""),), True)
        yield Diagnostic(codes.EXTRA_WORD, span, {"found": word}, span, repair)


def _is_call(call: re.Match[str], names: Names) -> bool:
    """Return whether an instruction of the language, or nearly so, begins no block."""
    word = call[1].upper()
    meant_text = names.find_meaning(word) or likely_word(word, call[0].strip())
    return names.is_name(word) or (meant_text in WORDS and meant_text not in _HEADER_WORDS)


def _setup_diagnostics(body: str, start: int) -> Iterator[Diagnostic]:
    """Yield each `SI|` after an instruction of its line, with the text after it."""
    for match in _SETUP_ANYWHERE.finditer(body):
        follows_instruction = match["before"] == ")" or bool(
            _SETUP_AT_START.search(body[: match.start("setup")])
        )
        if match["before"] is None or not follows_instruction or match["setup"][1:2] in "Bb":
            continue
        setup_span = Span(start + match.start("setup"), start + match.end("setup"))
        edit = Edit(Span(start + match.end("before"), start + match.end()), "; ")
        values = {"found": match["setup"], "between": match["setup"]}
        yield Diagnostic(codes.SETUP_TWICE, setup_span, values, setup_span, Repair((edit,), True))


def _filler_diagnostics(
    body: str, start: int, names: Names, tasks: Set[str]
) -> Iterator[Diagnostic]:
    for match in _INSTRUCTION.finditer(body):
        tokens = lexemes(match[0])
        if not 1 < len(tokens) <= 1 + _MAX_LEFTOVER_WORDS or tokens[0].text not in _WORDS_ALONE:
            continue
        if all(token.text in tasks or _is_filler(token, names) for token in tokens[1:]):
            end = start + match.start() + len(match[0].rstrip())
            word_end = start + match.start() + match[0].index(tokens[0].source or "")
            word_end += len(tokens[0].source or "")
            words = " ".join(token.source or "" for token in tokens[1:])
            span = Span(
                end - len(match[0].rstrip()[word_end - start - match.start() :].lstrip()), end
            )
            repair = Repair((Edit(Span(word_end, end), ""),), False)
            values = {"before": tokens[0].source or "", "words": words, "needless": words}
            yield Diagnostic(codes.WORDS_AFTER, span, values, span, repair)


def _is_filler(token: Lexeme, names: Names) -> bool:
    """Return whether a token is neither an instruction, a name nor a part of a sentence."""
    word = token.text
    if token.kind is not WORD or word in WORDS or names.is_name(word) or names.find_meaning(word):
        return False
    kinds = {item.kind for item in lexicon().get(word, ())}
    return lexicon_concept(word) is None and kinds <= _EMPTY_WORDS
