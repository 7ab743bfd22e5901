"""Orders where a value is wanted, or to choose from: `F(1, 60, R)`, `RANDOM(L, R)`, `S o R(1, 60)`.

Knows how they are written instead: an instruction of their own, and an IF that asks RANDOM.
"""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.call_suggestions import call_in
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.free_names import for_a_number
from tiniscript.syntax.lexer import NUMBER, WORD, Token
from tiniscript.syntax.ranges import range_in
from tiniscript.syntax.reporter import Reporter
from tiniscript.syntax.suggestions import after_bracket
from tiniscript.syntax.vocabulary import Vocabulary
from tiniscript.words import BLOCK_ENDS, WORDS, meant_by

_FARTHEST = 12  # tokens in which the second of two orders ends
_OR = ("O", "OR", "U")


def order_as_value(cursor: Cursor, reporter: Reporter, known: Vocabulary, token: Token) -> None:
    """`F(1, 60, R)`, `F(2, R)`: report the word of an instruction where a value is wanted."""
    word = WORDS[token.text]
    if not word.is_instruction or known.is_own(token.text):
        return
    tokens, k = cursor.tokens, cursor.i
    start = k
    while start and tokens[start].kind not in ("(", *AT_END):
        start -= 1
    is_in_brackets = start > 0 and tokens[start].kind == "("
    owner = WORDS.get(tokens[start - 1].text) if is_in_brackets else None
    if is_in_brackets and "RANDOM" in (tokens[start - 1].text, meant_by(tokens[start - 1].text)):
        end = after_bracket(tokens, start) or k + 1
        orders = _orders(cursor, known, tokens[start + 1 : end - 1])
        if len(orders) > 1:  # `X = RANDOM(L, R)`
            span = Span(tokens[start - 1].start, tokens[end - 1].end)
            _choose(cursor, reporter, span, orders, is_sure=False)
    if owner is None or not owner.is_call:
        reporter.fail(codes.RESERVED, token.span, word=word.text, right="")
    values = {"example": owner.example}
    before = tokens[start + 1 : k - 1]
    count = sum(each.kind != "," for each in before)
    if tokens[k - 1].kind == "," and count == len(owner.arguments):
        fits = word.arguments == owner.arguments  # of BEEP(1, 440, F) no number is a power
        order = (call_in(word, before) if fits else "") or word.example
        order = word.text if word.role == "stop" else order
        values = {"apart": f"{call_in(owner, before)}; {order}"}
    reporter.fail(codes.NO_VALUE, token.span, None, word=word.text, **values)


def at_random(cursor: Cursor, reporter: Reporter, known: Vocabulary, first: Token) -> None:
    """`RANDOM(L, R)`, `RANDOM(F(1, 60), S)` alone: report that RANDOM does not choose."""
    tokens, k = cursor.tokens, cursor.i
    if first.text != "RANDOM":
        return
    end = after_bracket(tokens, k + 1) if tokens[k + 1].kind == "(" else None
    written = shown = WORDS["RANDOM"].example
    if end is not None:
        shown = cursor.source[Span(first.start, tokens[end - 1].end)]
        limits = range_in(cursor.source[Span(tokens[k + 1].end, tokens[end - 1].start)].strip())
        written = f"RANDOM({', '.join(limits)})" if limits else shown
    orders = _orders(cursor, known, tokens[k + 2 : end - 1]) if end is not None else []
    cursor.i = end or k + 1
    span = cursor.span_from(first)
    if len(orders) > 1 and tokens[cursor.i].kind in AT_END:
        _choose(cursor, reporter, span, orders)
    name = for_a_number(cursor.source.text)
    values = {"given": shown, "number": f"{name} = {written}"}
    reporter.fail(codes.NOT_AN_INSTRUCTION, span, None, found=first.text, **values)


def one_or_other(cursor: Cursor, reporter: Reporter, known: Vocabulary, start: int) -> None:
    """`L(1, 60) o R(1, 60)`: report what stands at `start`, up to the end of the second one."""
    tokens, k = cursor.tokens, cursor.i
    if tokens[k].text not in _OR or known.is_own(tokens[k].text):
        return
    end = k + 1
    while tokens[end].kind not in AT_END and end < k + _FARTHEST:
        end += 1
    rows = (tokens[start:k], tokens[k + 1 : end])
    orders = [each for row in rows for each in _orders(cursor, known, row)]
    if len(orders) == len(rows) and tokens[end].kind in AT_END:
        cursor.i = end
        _choose(cursor, reporter, cursor.span_from(tokens[start]), orders)


def _choose(
    cursor: Cursor, reporter: Reporter, span: Span, orders: Sequence[str], is_sure: bool = True
) -> None:
    is_whole = is_sure and all("(" in each or each == "S" for each in orders)
    name = for_a_number(cursor.source.text)
    shown = [each if "(" in each else WORDS[each].example for each in orders]
    row = ["IF(RANDOM(1, 2) = 1)", shown[0]]
    if len(shown) > 2:
        row = [f"{name} = RANDOM(1, {len(shown)})", f"IF({name} = 1)", shown[0]]
    for number, order in enumerate(shown[1:-1], 2):
        row += [f"ELSEIF({name} = {number})", order]
    row += ["ELSE", shown[-1], BLOCK_ENDS["IF"]]
    values = {"fix": ";".join(row) if is_whole else "", "example": "; ".join(row)}
    reporter.fail(codes.BY_CHANCE, span, span, **values)


def _orders(cursor: Cursor, known: Vocabulary, row: Sequence[Token]) -> list[str]:
    """Return the orders in a row with commas between them, nothing if it has anything else."""
    found: list[str] = []
    k = 0
    while k < len(row):
        word = known.command(row[k].text) if row[k].kind is WORD else None
        if word is None or not word.is_instruction:
            return []
        end = k + 1
        if end < len(row) and row[end].kind == "(":
            while end < len(row) and row[end].kind != ")":
                if row[end].kind not in ("(", ",", NUMBER):
                    return []
                end += 1
            end += 1
        values = Span(row[k].end, row[min(end, len(row)) - 1].end)
        found.append(word.text + cursor.source[values].strip())
        k = end + 1
        if end < len(row) and row[end].kind != ",":
            return []
    return found
