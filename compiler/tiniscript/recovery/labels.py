"""Labels before instructions, which count them: `1)`, `a.`, `Step 2 -`, `Questão 3:`.

A label is at the beginning of an instruction, in any language: a number or a letter with a sign, or
any word that is not an instruction with one of these. Numbers alone are labels where they count all
lines.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache

from tiniscript.base.source import Edit, Source, Span
from tiniscript.base.words import WORDS, lexicon, lexicon_concept, lexicon_meaning
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.recovery.meanings import certain_concept, plain
from tiniscript.recovery.writing import split_note

_FIRST_NUMBERS = (1, 10, 100)
_COUNTED_LINE = re.compile(r"(?im)^[ \t]*([0-9]{1,4})[ \t]+(?=[A-Z])(?!veces|times|x\b|vez)")
_INSTRUCTION_START = re.compile(r"(?i)(?:^|[;{}]|\bS[IB][ \t]*\|)[ \t]*(?=[(\w])")
_LABEL = re.compile(
    r"(?:(?P<word>[^\W\d_]{2,})[ \t]*(?:n[º°o]?\.?|#)?[ \t]*(?=[\d(]|\b[A-Za-z]\b))?\(?"
    r"(?P<count>\d{1,3}(?:\.\d{1,2})*|[A-Ha-h])(?P<sign>[ºª°]?[ \t]*[.):\]–—-]+|[ºª°])?"
    r"(?P<space>[ \t]*)(?=(?P<next>[^\W\d]\w*)[ \t]*(?P<after>[|(=])?)"
)
_NAMED_WORD = re.compile(r"\bDEF\s+(\w+)\b|\b(\w+)\s*[=(]")


@lru_cache(100)
def label_spans(text: str) -> tuple[Span, ...]:
    """Return the spans of the labels in a text, each with the spaces after it."""
    numbers = [*_COUNTED_LINE.finditer(text)]
    line_numbers = [int(number[1]) for number in numbers]
    is_counting = len(line_numbers) > 1 and line_numbers[0] in _FIRST_NUMBERS
    if is_counting and line_numbers == [
        *range(line_numbers[0], line_numbers[-1] + 1, line_numbers[0])
    ]:
        return tuple(Span(number.start(1), number.end()) for number in numbers)
    return tuple(_spans_in_lines(text))


def label_diagnostics(source: Source) -> list[Diagnostic]:
    """Return the diagnostics for the labels of a text, each of which is removed."""
    return [
        Diagnostic(codes.LINE_NUMBER, Span(span.start, span.start + len(label_text)),
                   {"found": label_text}, None, Repair((Edit(span, ""),), True))
        for span in label_spans(source.text)
        if (label_text := source[span].rstrip())
    ]  # fmt: skip


def _spans_in_lines(text: str) -> Iterator[Span]:
    line_start, is_value_open = 0, False
    for line in text.split("\n"):
        body = split_note(line)[0]
        depth = counted_to = 0  # bracket depth, and the place up to which it is counted
        for match in _INSTRUCTION_START.finditer(body):
            depth += body.count("(", counted_to, match.start()) - body.count(
                ")", counted_to, match.start()
            )
            counted_to = match.start()
            label_match = _LABEL.match(body, match.end())
            if label_match and not is_value_open and depth <= 0 and _is_label(label_match, text):
                yield Span(line_start + label_match.start(), line_start + label_match.end())
        is_value_open = body.rstrip()[-1:] in ("(", ",")  # the value continues in the next line
        line_start += len(line) + 1


def _is_label(label_match: re.Match[str], text: str) -> bool:
    word, sign = plain(label_match["word"] or ""), (label_match["sign"] or "").strip()
    is_instruction = _is_instruction(plain(label_match["next"]), label_match["after"] or "", text)
    if word:
        return is_instruction and (
            _is_step(word) if not sign else _is_step(word) or _is_free(word, text)
        )
    if label_match["count"].isalpha():
        is_apart = bool(label_match["space"]) or sign == ")"
        is_name = sign != ")" and _is_name(label_match["count"], text)
        return bool(sign) and is_apart and is_instruction and not is_name
    return bool(sign) and (bool(label_match["space"]) or sign[-1] in ".)]º" or is_instruction)


def _is_instruction(word: str, sign: str, text: str) -> bool:
    """Return whether an instruction begins with a word and the sign after it."""
    known_words = {word, lexicon_concept(word), certain_concept(word)} & WORDS.keys()
    return bool(sign or known_words or lexicon_meaning(word, "set", "declare")) or _is_name(
        word, text
    )


def _is_step(word: str) -> bool:
    """Return whether a word counts steps: `paso`, `step`, `line`."""
    entries = {(item.kind, item.value) for item in lexicon().get(word, ())}
    return ("unit", "steps") in entries or ("stem", "LINE") in entries


def _is_free(word: str, text: str) -> bool:
    """Return whether a word is neither a word of the language nor a name of the text."""
    is_instruction = (certain_concept(word) or "S") not in (
        "S",
        "STOP",
    )  # PARTE is no PARE with a number
    return not (word in WORDS or lexicon().get(word) or is_instruction or _is_name(word, text))


def _is_name(word: str, text: str) -> bool:
    """Return whether a text assigns, defines or calls a word."""
    return plain(word) in _names(text)


@lru_cache(1)
def _names(text: str) -> frozenset[str]:
    return frozenset(match[1] or match[2] for match in _NAMED_WORD.finditer(plain(text)))
