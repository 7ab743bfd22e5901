"""The code in a sentence, as the blocks that it is: for those who build programs of blocks.

Such a sentence has back quotes around its code. Lessons are written so; what the compiler says of a
program is not, and there code is what begins with a name in capitals, or a word with its brackets,
and is read as an instruction or a value.
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Any

from tiniscript.base.kit import Kit
from tiniscript.base.words import WORDS
from tiniscript.studio.block_form import Block, lone_block
from tiniscript.studio.block_reading import read_blocks

CODE_PATTERN = re.compile("`([^`]+)`")
WORD_PATTERN = re.compile(r"\w+")
# Completions that make a program of code in a sentence: the end of its block, or SHOW around a
# value.
PROGRAM_FORMS = (
    "{}",
    *(f"{{}}\n{end}" for end in ("END_LOOP", "ENDIF", "END_WHILE", "END_WHEN", "END_DEF")),
)
VALUE_FORM = "SHOW({})"
_BRACKETS = r"\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*\)"
_NAME = rf"[^\W\d]\w*{_BRACKETS}|[A-Z][A-Z0-9_]*\b"
_CODE_PART = re.compile(rf" ?(?:{_NAME}|{_BRACKETS}|\d+(?:\.\d+)?\b|<>|<=|>=|[-+*/%<>=])")
_BEGINNING = re.compile(r"(?<![\w.])(?P<word>[A-Z][A-Z0-9_]*\b|[^\W\d]\w*(?=\())")


def mark_code(sentence: str, kit: Kit) -> str:
    """Return a sentence with back quotes around its code, as much of it as is read as one block."""
    if "`" in sentence:
        return sentence  # the sentence mentions its values
    parts, offset = [], 0
    while match := _BEGINNING.search(sentence, offset):
        start, word_end = match.start(), match.start() + len(match["word"])
        end = _end_of_code(sentence, start, kit)
        parts += [sentence[offset:start], f"`{sentence[start:end]}`" if end else match["word"]]
        offset = end or word_end
    return "".join((*parts, sentence[offset:]))


def codes_in(sentences: list[str]) -> list[str]:
    return [code for sentence in sentences for code in CODE_PATTERN.findall(sentence)]


def blocks_of(codes: list[str], kit: Kit) -> dict[str, dict[str, Any]]:
    """Return the block that each code is, but of a word alone; of a value one without a kind."""
    block_of_code: dict[str, dict[str, Any]] = {}
    for code in codes:
        if WORD_PATTERN.fullmatch(code):
            continue  # the page has the names of words
        if block := _block_of(code, kit):
            block_of_code[code] = {"kind": block.kind, "word": block.word, "values": block.values}
    return block_of_code


@lru_cache(maxsize=1000)  # the same ones occur again at every check of a text
def _block_of(code: str, kit: Kit) -> Block | None:
    for form in (*PROGRAM_FORMS, VALUE_FORM):
        block = lone_block(read_blocks(form.format(code), kit))
        if block is not None:
            return block._replace(kind="") if form == VALUE_FORM else block
    return None


def _end_of_code(sentence: str, start: int, kit: Kit) -> int:
    """Return the end of the longest code that begins there, or 0 if there is none."""
    word = WORD_PATTERN.match(sentence, start)
    assert word is not None, "code begins with a name"
    ends, end = [word.end()], start
    while part := _CODE_PART.match(sentence, end):
        end = part.end()
        ends.append(end)
    return next((end for end in reversed(ends) if _is_code(sentence[start:end], kit)), 0)


def _is_code(code: str, kit: Kit) -> bool:
    if WORD_PATTERN.fullmatch(code):
        return code in WORDS or any(
            code == device.name for device in (*kit.readings, *kit.actuators)
        )
    name = code.partition("(")[0].strip()
    return (name == name.upper() or name.upper() in WORDS) and _block_of(code, kit) is not None
