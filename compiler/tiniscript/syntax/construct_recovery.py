"""Recovery of whole constructs that TiniScript has in another form, or not at all.

Knows `repeat … until`, `do … while`, `switch` and the `main() { … }` around a program. One
diagnostic stands for all of it: the tokens are replaced by those that were meant, and the grammar
reads on.
"""

from __future__ import annotations

from typing import NamedTuple

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.blocks import ENDS
from tiniscript.syntax.call_suggestions import LONGEST, written
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, ODD, WORD, Token
from tiniscript.syntax.phrases import CASE_WORDS, ENDS_OF_ANY, FRAME_NAMES, FRAME_WORDS
from tiniscript.syntax.reporter import Failed, Reporter, Resumed
from tiniscript.syntax.suggestions import (
    after_bracket,
    end_of_values,
    foreign_block,
    inside,
    opposite,
    with_signs,
)
from tiniscript.words import BLOCK_ENDS, WORDS, meant_by

_FARTHEST = 2000  # tokens in which the end of a construct is looked for
_OTHERWISE = frozenset(("DEFAULT", "OTHERWISE", "ELSE", "SINO", "OTRO"))


class _Tail(NamedTuple):
    """The `until(c)` or `while(c)` behind a body: its first token, the place after its last."""

    first: int
    word: int
    end: int
    question: str  # that leaves the loop


class ConstructRecovery:
    def __init__(self, cursor: Cursor, reporter: Reporter, in_block: BlockRecovery) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.in_block = in_block

    # -- a loop that asks behind its body -----------------------------------------------------

    def asked_behind(self, word: Token) -> None:
        """`repetir … hasta (c)`, `do { … } while (c)`: an IF with BREAK asks at the end."""
        cursor = self.cursor
        tokens, k = cursor.tokens, cursor.i + 1
        sign = tokens[k]
        if sign.kind not in ("{", *AT_END) and sign.text != ":":
            return
        tail = self._tail(word, cursor.after_newlines(k))
        if tail is None:
            return
        has_sign = sign.kind == "{" or sign.text == ":"
        body = Span(sign.end if has_sign else word.end, tokens[tail.first].start)
        last = tokens[tail.end - 1].end
        text = cursor.source[body].rstrip(" \t")
        begin = "" if text.lstrip(" \t")[:1] in (";", "\r", "\n") else ";"
        end = "" if text[-1:] in (";", "\n", "\r") else ";"
        out = f"IF({tail.question});BREAK;ENDIF;END_LOOP"
        self.reporter.report(
            codes.ASKED_BEHIND, word.span, Span(word.start, last),
            found=f"{word.text} … {tokens[tail.word].text}", first=cursor.source[word.span],
            last=cursor.source[Span(tokens[tail.first].start, last)], right=out,
            fix=f"LOOP(FOREVER){begin}{text}{end}{out}",
        )  # fmt: skip
        for token in (sign, *tokens[tail.first : tail.end]):
            self.reporter.answer(token)
        span = Span(tokens[tail.first].start, last)
        tokens[tail.first : tail.end] = [
            Token(";", ";", *span),
            Token(WORD, BLOCK_ENDS["LOOP"], *span),
        ]
        cursor.i += 1
        self.in_block.begin_reported("LOOP", word.span)
        self.in_block.go_on()

    def _tail(self, word: Token, start: int) -> _Tail | None:
        tokens = self.cursor.tokens
        if tokens[start].kind == "{":
            close = self.cursor.closing(start)
            if close is None:
                return None
            return self._asks(close, self.cursor.after_newlines(close + 1), word)
        depth, is_first = 0, True
        for k in range(start, min(len(tokens) - 1, start + _FARTHEST)):
            token = tokens[k]
            if is_first and token.kind is WORD:
                block = token.text if token.text in WORDS else foreign_block(token.text)
                if not depth:
                    found = self._asks(k, k, word)
                    if found is not None and self._ends_there(found, k):
                        return found
                if block in ENDS or block == "END":
                    if not depth:
                        return self._asks(k, self.cursor.after_newlines(k + 1), word)
                    depth -= 1
                elif block in BLOCK_ENDS:
                    depth += 1
            elif token.kind == "}":
                return None
            is_first = token.kind in AT_END
        return None

    def _asks(self, first: int, k: int, word: Token) -> _Tail | None:
        """Return the tail whose question begins with the word at `k`."""
        tokens = self.cursor.tokens
        text = tokens[k].text
        meant = text if text in WORDS else meant_by(text)
        if tokens[k].kind is not WORD or meant not in ("UNTIL", "WHILE"):
            return None
        values = inside(tokens, k + 1)
        if not values or len(values) > LONGEST or tokens[k + 1].kind in AT_END:
            return None
        end = end_of_values(tokens, k + 1, values)
        after = k
        while tokens[after].start < end:
            after += 1
        if tokens[after].kind not in AT_END:
            return None
        row = with_signs(values)
        question = written(row) if meant == "UNTIL" else opposite(row)
        question = self.in_block.known.translated(question)
        return _Tail(first, k, after, question) if question else None

    def _ends_there(self, tail: _Tail, k: int) -> bool:
        """Whether the `while(c)` at `k` is an end, and no loop with a body of its own."""
        tokens = self.cursor.tokens
        text = tokens[k].text
        if (text if text in WORDS else meant_by(text)) == "UNTIL":
            return True
        rest = tokens[tail.end : tail.end + _FARTHEST]
        ends = {foreign_block(each.text) or each.text for each in rest if each.kind is WORD}
        others = {"END", "ENDWHILE", "ENDLOOP", BLOCK_ENDS["LOOP"], BLOCK_ENDS["WHILE"]}
        return not ends & others

    # -- a frame around the program -----------------------------------------------------------

    def frame(self, word: Token) -> None:
        """`main() { … }`, `void setup() { … }`: a program has nothing around it."""
        cursor = self.cursor
        tokens, k = cursor.tokens, cursor.i
        while tokens[k].text in FRAME_WORDS:
            k += 1
        if tokens[k].text not in FRAME_NAMES or self.in_block.known.is_own(tokens[k].text):
            return
        name = k
        k += 1
        if tokens[k].kind == "(":
            k = after_bracket(tokens, k) or k
        k = cursor.after_newlines(k)
        close = cursor.closing(k) if tokens[k].kind == "{" else None
        if close is None:
            return
        body = Span(tokens[k].end, tokens[close].start)
        gone = self._returns(k, close)
        text = cursor.source[body]
        if gone is not None:
            text = cursor.source[Span(body.start, tokens[gone].start)]
        head = cursor.source[Span(word.start, tokens[k].start)]
        self.reporter.report(
            codes.NEEDLESS_FRAME, Span(word.start, tokens[name].end),
            Span(word.start, tokens[close].end), found=" ".join(head.split()),
            fix=text.strip() or "START",
        )  # fmt: skip
        self.reporter.answer(tokens[k])
        if text.strip():
            end = tokens[close].span
            tokens[gone if gone is not None else close : close + 1] = [Token(";", ";", *end)]
            cursor.i = k + 1
            raise Resumed
        cursor.i = close + 1
        raise Failed

    def _returns(self, start: int, close: int) -> int | None:
        """Return the place of the `return 0` at the end of the frame, if one stands there."""
        tokens = self.cursor.tokens
        k = close
        while k > start and tokens[k - 1].kind in AT_END:
            k -= 1
        k -= tokens[k - 1].kind is NUMBER
        return k - 1 if tokens[k - 1].text == "RETURN" else None

    # -- cases --------------------------------------------------------------------------------

    def cases(self, word: Token) -> None:
        """`switch(X) { case 1: … }`: each case is an IF."""
        cursor = self.cursor
        tokens = cursor.tokens
        subject = inside(tokens, cursor.i + 1)
        end = self._end_of_cases(cursor.i + 1)
        if end is None:
            return
        places = [k for k in range(cursor.i, end) if self._begins_case(k)]
        if not places or not subject or len(subject) > LONGEST:
            return
        asked = self.in_block.known.translated(written(subject))
        limits = [tokens[k + 1].text for k in places if tokens[k].text not in _OTHERWISE]
        asks = [f"IF({asked} = {limit})" for limit in limits]
        row = [each if k == 0 else f"ELSE{each}" for k, each in enumerate(asks)]
        row += ["ELSE"] * (len(limits) < len(places))
        bodies = [self._body_of_case(k, n) for k, n in zip(places, [*places[1:], end], strict=True)]
        fix = ""
        if row and None not in bodies and limits and tokens[places[0]].text not in _OTHERWISE:
            pairs = zip(row, bodies, strict=True)
            fix = "\n".join((*(f"{head}\n{body}" for head, body in pairs), BLOCK_ENDS["IF"]))
        last = tokens[end]
        for token in tokens[cursor.i : end + 1]:
            self.reporter.answer(token)
        cursor.i = end + (last.kind is not END)
        self.reporter.fail(
            codes.CASES, word.span, Span(word.start, last.end), found=word.text,
            first=row[0] if row else "", second=row[1] if len(row) > 1 else "", fix=fix,
        )  # fmt: skip

    def _begins_case(self, k: int) -> bool:
        """Whether `case 10:` or `default:` stands at `k`."""
        token, after = self.cursor.tokens[k], self.cursor.tokens[k + 1]
        is_first = self.cursor.tokens[k - 1].kind in ("{", ":", *AT_END)
        if token.text in ("CASE", "CASO"):
            return after.kind is NUMBER or after.kind is WORD
        return is_first and token.text in _OTHERWISE and after.text == ":"

    def _body_of_case(self, k: int, end: int) -> str | None:
        """Return what a case does; None where it does what the next one does, too."""
        tokens = self.cursor.tokens
        start = k + (1 if tokens[k].text in _OTHERWISE else 2)
        start += tokens[start].kind is ODD or tokens[start].text == ":"
        last = end
        while last > start and tokens[last - 1].kind in AT_END:
            last -= 1
        if last > start and tokens[last - 1].text == "BREAK":
            last -= 1
        elif tokens[end].kind != "}" and tokens[end].text in CASE_WORDS:
            return None
        while last > start and tokens[last - 1].kind in AT_END:
            last -= 1
        if any(token.text == "BREAK" or token.kind in "{}" for token in tokens[start:last]):
            return None
        return self.cursor.source[Span(tokens[start].start, tokens[last - 1].end)] if (
            last > start
        ) else ""  # fmt: skip

    def _end_of_cases(self, start: int) -> int | None:
        """Return the place of the last token of the construct."""
        tokens = self.cursor.tokens
        k = start
        while tokens[k].kind not in ("{", NEWLINE, END):
            k += 1
        k = self.cursor.after_newlines(k)
        if tokens[k].kind == "{":
            return self.cursor.closing(k)
        for place in range(k, min(len(tokens), k + _FARTHEST)):
            text = tokens[place].text
            is_end = text in ENDS_OF_ANY or text.startswith(("END", "FIN"))
            if is_end and tokens[place].kind is WORD and tokens[place - 1].kind in AT_END:
                return place + (tokens[place + 1].text in CASE_WORDS)
            if tokens[place].kind is END:
                return place
        return None
