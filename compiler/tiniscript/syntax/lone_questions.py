"""Recovery of a question that stands alone: `DISTANCE < 10`, `luz > 50: F(2, 80)`.

Knows that it belongs to an IF, and writes the line with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NoReturn

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.ast import Assign
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.lexer import NUMBER, ODD, WORD, Token
from tiniscript.syntax.operators import SIGNS
from tiniscript.syntax.reporter import Reporter, Resumed
from tiniscript.syntax.suggestions import head_in
from tiniscript.syntax.worded_questions import sensors_of
from tiniscript.words import WORDS

_SHORT = 20  # tokens of a line with odd signs


def asked_alone(
    cursor: Cursor, reporter: Reporter, in_block: BlockRecovery, row: Sequence[Token]
) -> NoReturn:
    """Report the question at the cursor, whose tokens are `row`, or the whole line with it."""
    start, first, known = cursor.i, row[0], in_block.known
    is_last = row[-1].kind is not ODD  # else a repair would leave `¿si? S` behind it
    while len(row) > 1 and row[-1].kind is ODD:  # `DISTANCE < 20 ¿si? S`
        row = row[:-1]
        for token in cursor.tokens[start : start + _SHORT]:
            if token.kind in AT_END:
                break
            reporter.answer(token)
    span = Span(first.start, row[-1].end)
    if len(row) > 2 and row[-2].kind == "=" and row[-1].kind is WORD:
        _turned(cursor, reporter, in_block, row)
    said = {"found": row[1].text if len(row) > 1 else first.text, "asked": cursor.source[span]}
    sensors = sensors_of(first.text, known)
    is_short = len(row) == 3 and row[1].kind in SIGNS and row[2].kind is NUMBER
    if sensors and is_short and not known.is_own(known.value(first.text)):
        questions = [f"IF({name} {row[1].text} {row[2].text})" for name in sensors[:2]]
        values = dict(zip(("one", "another"), questions, strict=False))
        cursor.skip_instruction()
        for token in cursor.tokens[start : cursor.i]:
            reporter.answer(token)
        reporter.fail(codes.NOT_AN_INSTRUCTION, span, span, fix="", **said, **values)
    if cursor.tokens[start + len(row)].kind not in AT_END:
        word = Token(WORD, "IF", first.start, first.start)
        cursor.tokens.insert(start, word)
        line = in_block.whole_line(word, "IF")
        if line is not None:
            place = cursor.span_from(first)
            reporter.report(codes.NOT_AN_INSTRUCTION, span, place, **said, fix=line)
            raise Resumed
        del cursor.tokens[start]
        cursor.i = start
    fix = known.translated(head_in(WORDS["IF"], row))
    reporter.fail(codes.NOT_AN_INSTRUCTION, span, span if is_last else None, **said, fix=fix)


def _turned(
    cursor: Cursor, reporter: Reporter, in_block: BlockRecovery, row: Sequence[Token]
) -> None:
    """`DISTANCE - 5 = REST`: the value stands before the name."""
    name, is_last = row[-1], cursor.tokens[cursor.i + len(row)].kind in AT_END
    is_free = name.text not in WORDS and not in_block.known.is_name(name.text)
    if not (is_last and is_free) or any(each.kind in ("<", ">") for each in row):
        return
    span = Span(row[0].start, name.end)
    value = in_block.known.translated(cursor.source[Span(row[0].start, row[-3].end)])
    fix = f"{name.text} = {value}"
    in_block.blocks.here.append(Assign(name.text, name.span, None, name.span))
    cursor.i += len(row)
    reporter.report(codes.NOT_AN_INSTRUCTION, span, span, found="=", turned=name.text, fix=fix)
    raise Resumed
