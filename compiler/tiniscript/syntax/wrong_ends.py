"""What is meant where the end of a block is not that of the innermost one.

Knows the blocks that are open and what stands before and behind the end. Reports it, or nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.ast import Command
from tiniscript.syntax.blocks import ENDS, Block
from tiniscript.syntax.lexer import NEWLINE, Token
from tiniscript.words import ALIASES, BLOCK_ENDS, WORDS

if TYPE_CHECKING:
    from tiniscript.syntax.block_recovery import BlockRecovery


def is_swapped(reader: BlockRecovery, block: Block, end: Token) -> bool:
    """Whether the end of `block` follows right behind the end of the one around it; say so."""
    cursor, blocks = reader.cursor, reader.blocks.open
    k = cursor.i
    while cursor.tokens[k].kind in (NEWLINE, ";"):
        k += 1
    other = cursor.tokens[k]
    right = BLOCK_ENDS[block.word]
    if ALIASES.get(other.text, other.text) != right or len(blocks) < 2:
        return False
    if blocks[-2].word != ENDS.get(end.text) or block.is_reported:
        return False
    between = cursor.source.text[end.end : other.start]
    reader.reporter.report(
        codes.WRONG_END, end.span, Span(end.start, other.end), found=end.text, right=right,
        word=block.word, line=str(cursor.source.position(block.header.start)[0]),
        swapped=other.text, fix=f"{cursor.source[other.span]}{between}{cursor.source[end.span]}",
    )  # fmt: skip
    return True


def told_with_header(reader: BlockRecovery, block: Block) -> bool:
    """Whether the header is said in another language, so that its message names the end, too."""
    for k, each in enumerate(reader.reporter.diagnostics):
        if each.code is codes.OTHER_LANGUAGE and each.span.start == block.header.start:
            values = {**each.values, "ends": BLOCK_ENDS[block.word]}
            reader.reporter.change(k, each._replace(values=values))
            return True
    return False


def is_taken_for_header(reader: BlockRecovery, word: str) -> bool:
    """Whether `Loco(4)` stands before, where END_LOOP ends nothing; then say so."""
    here = reader.blocks.here
    for each in reversed(here if word == "LOOP" else ()):
        if not isinstance(each, Command) or each.word in WORDS or len(each.arguments or ()) != 1:
            continue
        is_number = each.arguments is not None and each.arguments[0].is_plain
        if is_number and not reader.known.command(each.word) and not reader.is_name(each.word):
            reader.reporter.report(codes.UNKNOWN_WORD, each.word_span, found=each.word, near=word)
            here.remove(each)
            return True
    return False
