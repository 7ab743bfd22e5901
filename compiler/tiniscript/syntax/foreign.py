"""Recovery of what other languages, and Spanish, write for the blocks of this one.

Knows which rule of the grammar was meant. Reports the word, and goes on with that rule as if the
right word stood there.
"""

from __future__ import annotations

from typing import NoReturn, Protocol

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.ast import Argument
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.blocks import ENDS, HEADERS, Blocks
from tiniscript.syntax.call_suggestions import LONGEST
from tiniscript.syntax.construct_recovery import ConstructRecovery
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.end_recovery import EndRecovery
from tiniscript.syntax.group_recovery import GroupRecovery
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, WORD, Token
from tiniscript.syntax.phrases import AFTER_HEADER, COUNTING, NEGATED
from tiniscript.syntax.reporter import Failed, Reporter, Resumed
from tiniscript.syntax.suggestions import (
    counted,
    end_of_values,
    head_in,
    inside,
    opposite,
    with_signs,
)
from tiniscript.words import BLOCK_ENDS, WORDS, meant_by

_ENDLESS = frozenset(("PARA", "POR", "SIEMPRE", "FOREVER", "INFINITO", "INFINITAMENTE", "INFINITAS",
                      "VECES", "TIMES", "INFINITE", "AND", "EVER"))  # fmt: skip


class Recoveries(Protocol):
    """What goes on with a rule asks of the recovery of other places."""

    construct: ConstructRecovery
    groups: GroupRecovery
    in_block: BlockRecovery
    of_end: EndRecovery


class Grammar(Protocol):
    """The parser, with the rules that recovery goes on with."""

    cursor: Cursor
    reporter: Reporter
    blocks: Blocks

    @property
    def recovery(self) -> Recoveries: ...

    def argument_of(self, word: Token, is_reported: bool = False) -> Argument: ...

    def arm(self, word: Token, is_reported: bool = False) -> None: ...

    def definition(self, word: Token) -> None: ...


def foreign_word(parser: Grammar, word: Token, meant: str) -> None:
    """Read `REPEAT(3)`, `SINO`, `FIN` … `meant` is what `foreign_block` gives for the word."""
    if meant == "END":
        parser.recovery.in_block.end_of_any(word)
        raise Failed
    construct = parser.recovery.construct
    if meant == "FRAME":
        construct.frame(word)
        return
    if meant == "CASES":
        construct.cases(word)
        return
    if meant in ("LOOP", "FOREVER"):
        construct.asked_behind(word)
        parser.recovery.in_block.other.around(word)
    if meant == "FOREVER":
        _report(parser, word, "LOOP(FOREVER)", "LOOP(FOREVER)")
        forever_alone(parser, word)
    if meant in ENDS:
        _end(parser, word, meant)
    if (meant == "LOOP" and meant_by(parser.cursor.following.text) == "UNTIL") or (
        meant == "LOOP" and parser.cursor.following.text == "UNTIL"
    ):
        _repeat_until(parser, word)
    if meant == "LOOP":
        _for_ever(parser, word)
    if meant in HEADERS:
        in_block = parser.recovery.in_block
        line = None if word.text in NEGATED else in_block.whole_line(word, meant)
        if line is not None:
            _report(parser, word, meant, line, parser.cursor.span_from(word))
            raise Resumed
        _report(parser, word, meant, _header_fix(parser, word, meant))
        foreign_header(parser, word, meant)
    if meant == "DEF":
        _definition(parser, word)
    values = inside(parser.cursor.tokens, parser.cursor.i + 1)
    place = Span(word.start, end_of_values(parser.cursor.tokens, parser.cursor.i + 1, values))
    if meant == "ELSE":
        _report(parser, word, meant, meant)
    else:
        _report(parser, word, meant, head_in(WORDS[meant], values), place)
    parser.arm(Token(WORD, meant, *word.span), is_reported=True)
    parser.recovery.in_block.go_on()


def _for_ever(parser: Grammar, word: Token) -> None:
    """`repetir para siempre`: all of the line says that it has no end."""
    cursor = parser.cursor
    end = cursor.i + 1
    while cursor.tokens[end].text in _ENDLESS:
        end += 1
    row = cursor.tokens[cursor.i + 1 : end]
    at_end = cursor.tokens[end].kind in ("{", *AT_END) or cursor.tokens[end].text == ":"
    if not at_end or not any(
        meant_by(each.text) == "FOREVER" for each in row if each.text != "POR"
    ):
        return
    cursor.i = end
    place = cursor.span_from(word)
    _report(parser, word, "LOOP", "LOOP(FOREVER)", place)
    parser.recovery.in_block.begin_reported("LOOP", place)
    parser.recovery.in_block.go_on()


def _repeat_until(parser: Grammar, word: Token) -> None:
    """`repetir hasta DISTANCE < 10`: WHILE asks the opposite."""
    cursor = parser.cursor
    start = cursor.i + 2 + (meant_by("HASTA_" + cursor.tokens[cursor.i + 2].text) == "UNTIL")
    values = inside(cursor.tokens, start)
    question = opposite(with_signs(values))
    if not question:
        return
    end = end_of_values(cursor.tokens, start, values)
    while cursor.token.start < end:
        cursor.i += 1
    place = Span(word.start, end)
    found = cursor.source[Span(word.start, cursor.tokens[start - 1].end)]
    parser.reporter.report(
        codes.OTHER_LANGUAGE, Span(word.start, cursor.tokens[start - 1].end), place,
        found=found, right="WHILE", fix=f"WHILE({question})", usage="",
    )  # fmt: skip
    parser.recovery.in_block.begin_reported("WHILE", place)
    parser.recovery.in_block.go_on()


def foreign_header(parser: Grammar, word: Token, meant: str) -> NoReturn:
    """Open the block of a header whose word has a diagnostic already."""
    cursor, reporter = parser.cursor, parser.reporter
    cursor.i += 1
    if word.text in COUNTING and cursor.token.kind != "(":
        while cursor.token.kind not in ("{", *AT_END):
            if cursor.token.text in (":", *AFTER_HEADER):
                break
            cursor.i += 1
    head, count = None, len(reporter.diagnostics)
    values = inside(cursor.tokens, cursor.i)
    is_bare = cursor.token.kind != "("
    if is_bare and meant != "LOOP" and parser.recovery.in_block.is_a_sentence(values):
        parser.recovery.in_block.to_command()
    try:
        head = parser.argument_of(Token(WORD, meant, *word.span), is_reported=True)
    except Failed:
        reporter.withdraw(count)
    parser.recovery.in_block.begin_reported(meant, cursor.span_from(word), head)
    parser.recovery.in_block.go_on(word)


def forever_alone(parser: Grammar, word: Token) -> NoReturn:
    """`FOREVER` alone on its line begins a block elsewhere."""
    is_header = begins_forever(parser)
    parser.cursor.i += 1
    if is_header:
        parser.recovery.in_block.begin_reported("LOOP", word.span)
    parser.recovery.in_block.go_on()


def begins_forever(parser: Grammar) -> bool:
    """Whether nothing but a sign of a block stands behind the FOREVER at the cursor."""
    following = parser.cursor.following
    return following.kind in ("{", *AT_END) or following.text == ":"


def _end(parser: Grammar, word: Token, meant: str) -> NoReturn:
    block = parser.blocks.innermost
    if block is not None and block.is_reported:
        parser.recovery.in_block.end_of_any(word)
    else:
        is_open = any(each.word == ENDS[meant] for each in parser.blocks.open)
        right = meant if block is None or is_open else BLOCK_ENDS[block.word]
        if right == meant:
            _report(parser, word, meant, meant)
        else:  # `WHILE(c)`, a body, `FIN_REPETIR`
            parser.reporter.report(codes.END_ALONE, word.span, found=word.text, right=right)
        parser.cursor.i += 1
        parser.recovery.in_block.end(ENDS[right], word)
    raise Failed


def _definition(parser: Grammar, word: Token) -> NoReturn:
    name = parser.cursor.following
    is_named = name.kind is WORD
    cursor = parser.cursor
    place = Span(word.start, name.end) if is_named else None
    brackets = cursor.tokens[cursor.i + 2 : cursor.i + 4]
    if is_named and [each.kind for each in brackets] == ["(", ")"]:
        place = Span(word.start, brackets[1].end)
    _report(parser, word, "DEF", f"DEF {name.text}" if is_named else "DEF DANCE", place)
    count = len(parser.reporter.diagnostics)
    try:
        parser.definition(word)
    except Failed:
        parser.cursor.skip_instruction()
    parser.reporter.withdraw(count)
    parser.blocks.open[-1].is_reported = True
    parser.recovery.in_block.go_on()


def _report(parser: Grammar, word: Token, meant: str, fix: str, place: Span | None = None) -> None:
    usage = WORDS[meant].usage if meant in WORDS else meant
    parser.reporter.report(
        codes.OTHER_LANGUAGE, word.span, place, found=word.text, right=meant, fix=fix, usage=usage
    )


def _line(parser: Grammar) -> list[Token]:
    """Return the tokens from the cursor to the end of the line, of a long one the first."""
    row = []
    for token in parser.cursor.tokens[parser.cursor.i : parser.cursor.i + LONGEST]:
        if token.kind in (NEWLINE, END):
            break
        row.append(token)
    return row


def _header_fix(parser: Grammar, word: Token, meant: str) -> str:
    values = inside(parser.cursor.tokens, parser.cursor.i + 1)
    counts = word.text in COUNTING or any(token.kind in (";", ",", "=") for token in values)
    if meant == "LOOP" and counts:  # `for (i = 0; i < 3; i++)`
        times = counted(parser.cursor.tokens, parser.cursor.i + 1)
        if len(values) == 1 and values[0].text.isdecimal():  # `for 4 times`
            return f"LOOP({values[0].text})"
        if times is None:
            has_number = any(token.kind is NUMBER for token in _line(parser))
            return "" if has_number else WORDS[meant].example
        return f"LOOP({times})"
    if word.text in NEGATED:
        question = opposite(with_signs(values))
        return f"IF({question})" if question else ""
    numbers = [token for token in values if token.kind is NUMBER]
    if meant == "LOOP" and len(values) > len(numbers) == 1 and numbers[0].text.isdecimal():
        others = [each for each in values if each is not numbers[0]]
        if all(each.kind is WORD and not _is_value(parser, each) for each in others):
            return f"LOOP({numbers[0].text})"  # `repeat this 3 times`
    if meant != "LOOP" and parser.recovery.in_block.is_a_sentence(values):
        return WORDS[meant].example  # `mientras no haya pared`
    if len(values) == 1 and values[0].kind is WORD and not _is_value(parser, values[0]):
        return ""
    return head_in(WORDS[meant], values)


def _is_value(parser: Grammar, token: Token) -> bool:
    known = parser.recovery.in_block.known
    text = known.value(token.text)
    return text in WORDS or text.isdecimal() or known.is_own(text)
