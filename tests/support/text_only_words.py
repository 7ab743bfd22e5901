"""Words that only a program in text has: no sentence for a program of blocks has one."""

from __future__ import annotations

import re

from tiniscript.base.words import WORDS
from tiniscript.lessons import catalogue

CODE_PATTERN = re.compile("`([^`]*)`")
LINES = {"en": r"\blines?\b", "es": r"\bl[ií]neas?\b", "pt": r"\blinhas?\b"}
WRITING_WORDS = {"en": r"\b(writ\w+|wrote)\b", "es": r"\bescri\w+", "pt": r"\bescr[ei]\w+"}
END_WORD = re.compile(r"\bEND\w*")
TEXT_SIGNS = re.compile(r"\w\(|`; `|\[\[|\]\]")
STOP = "STOP"  # a button of the page
CAPITAL_WORDS = re.compile(r"\b[A-Z][A-Z_]*\b")


def text_only_words(sentences: str, language: str, *, is_line_on_floor: bool = False) -> list[str]:
    """Return the words of a block sentence that only exist in text, apart from code."""
    prose = CODE_PATTERN.sub("``", sentences)
    patterns = [WRITING_WORDS[language], *([] if is_line_on_floor else [LINES[language]])]
    words = [match[0] for pattern in patterns for match in re.finditer(pattern, prose, re.I)]
    words += [match[0] for pattern in (END_WORD, TEXT_SIGNS) for match in pattern.finditer(prose)]
    return words + [word for word in CAPITAL_WORDS.findall(prose) if word in WORDS and word != STOP]


def has_line_on_floor(number: int) -> bool:
    return bool(catalogue.load(catalogue.folder_of(str(number))).world.lines)
