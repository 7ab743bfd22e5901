"""A line of text as each reader takes it."""

from __future__ import annotations

import re

from tiniscript import compile_text
from tiniscript.base.kit import Kit
from tiniscript.base.source import Source
from tiniscript.base.words import WORDS
from tiniscript.codegen.text.line import line_of, plain_code
from tiniscript.diagnostics import codes


def expanded_word(word: re.Match[str]) -> str:
    """Return the meaning of a word with fixed values; others stay unchanged."""
    known_word = WORDS.get(word[0].upper())
    return (known_word and known_word.expansion) or word[0]


def check_line(text: str, kit: Kit) -> None:
    compilation = compile_text(text, kit)
    line = line_of(compilation.source)
    assert re.fullmatch(r"[ -}]*~[0-9A-F]{8}", line), line
    assert "//" not in line and "  " not in line
    assert line == line.upper()
    longest_text = re.sub(r"\w+", expanded_word, text)
    assert len(line) <= len(longest_text.encode()) + len("SI|~00000000")
    compiled_line = compile_text(line, kit)
    assert compiled_line.is_right and compiled_line.image == compilation.image, line
    assert compilation.program is not None and compiled_line.program is not None
    assert plain_code(compiled_line.program).code == plain_code(compilation.program).code, line
    # A line has no comments, nor a block that contains only a comment.
    text_codes, line_codes = (
        sorted(
            diagnostic.code.number
            for diagnostic in result.diagnostics
            if diagnostic.code not in (codes.IN_A_NOTE, codes.EMPTY_BLOCK)
        )
        for result in (compilation, compiled_line)
    )
    assert text_codes == line_codes
    assert line_of(Source(line)) == line
