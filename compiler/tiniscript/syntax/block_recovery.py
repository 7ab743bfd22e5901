"""Recovery of headers, arms and block ends.

Knows which end was meant for which block. A header that cannot be read still opens its block, so
that its end is not reported as a second mistake.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NoReturn

from tiniscript.diagnostics import codes
from tiniscript.kit import Kit
from tiniscript.source import Span
from tiniscript.syntax.ast import Argument, Assign, Command
from tiniscript.syntax.blocks import ENDS, HEADERS, Block, Blocks
from tiniscript.syntax.call_suggestions import ends_value
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.header_recovery import HeaderRecovery
from tiniscript.syntax.lexer import NEWLINE, NUMBER, ODD, WORD, Token
from tiniscript.syntax.one_line import line_of_block
from tiniscript.syntax.operators import COMPARISONS
from tiniscript.syntax.phrases import AFTER_HEADER, COUNTING, TITLES
from tiniscript.syntax.reporter import Failed, Reporter, Resumed
from tiniscript.syntax.suggestions import (
    OPERATOR_WORDS,
    after_bracket,
    body_begins,
    foreign_block,
    head_in,
    with_signs,
)
from tiniscript.syntax.unended import open_above, where_it_ends
from tiniscript.syntax.vocabulary import Vocabulary
from tiniscript.words import ALIASES, BLOCK_ENDS, TURN_WORDS, WORDS, meant_by, nearest


class BlockRecovery:
    def __init__(self, cursor: Cursor, reporter: Reporter, blocks: Blocks, kit: Kit | None) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.blocks = blocks
        self.kit = kit
        self.known = Vocabulary(cursor.tokens, kit)
        self.other = HeaderRecovery(cursor, reporter, blocks, self.known)
        self._owed = 0  # blocks that were closed by another one's end: their own may still come

    # -- headers ------------------------------------------------------------------------------

    def no_bracket(self, word: Token, is_reported: bool) -> NoReturn:
        """`IF DISTANCE < 10`: suggest the same with brackets."""
        cursor = self.cursor
        start = cursor.i
        self.other.in_braces(word, start)
        cursor.i = body_begins(cursor.tokens, start)
        if is_reported:
            raise Failed
        self.other.until_near(word, start)
        self.other.if_not(word, start)
        end = body_begins(cursor.tokens, start)
        if word.text in HEADERS and cursor.tokens[end].kind not in AT_END:
            cursor.i = start - 1
            line = self.whole_line(word, word.text)
            if line is not None:
                place = cursor.span_from(word)
                self.reporter.report(codes.MISSING_OPEN, place, word=word.text, fix=line, usage="")
                raise Resumed
            cursor.i = body_begins(cursor.tokens, start)
        self.other.instead(word, start)
        written = cursor.tokens[start : cursor.i]
        span = Span(word.start, written[-1].end if written else word.end)
        known = WORDS[word.text]
        fix = head_in(known, written)
        if len(written) == 1 and self.known.is_number(written[0].text) and word.text != "LOOP":
            fix = ""  # what it is compared with is not said
        if word.text != "LOOP" and self.is_a_sentence(written):
            fix = known.example  # `if wall ahead`
            self.to_command()
        if any(self.is_name(a.text) and b.kind == "(" for a, b in pairwise(written)):
            fix = ""  # `IF DISTANCE(15)`
            if len(written) > 4 and written[2].kind in COMPARISONS and written[-1].kind == ")":
                fix = head_in(known, [written[0], *written[2:-1]])  # `IF DISTANCE(< 15)`
        if written and written[0].text[:1] == "." and written[0].start == word.end:
            fix = ""  # `LOOP.4)`
        if any(ends_value(a) and b.kind is NUMBER for a, b in pairwise(with_signs(written))):
            fix = ""  # `IF DISTANCE 10`
        self.reporter.fail(codes.MISSING_OPEN, span, word=word.text, fix=fix, usage=known.usage)

    def is_a_sentence(self, written: Sequence[Token]) -> bool:
        """Whether words that no program knows stand where a question is wanted."""
        known = self.known
        if any(token.kind in COMPARISONS for token in written):
            return False
        if len(written) > 1 and written[-1].text in ("IS", "ES", "ESTA", "SEA"):
            return True
        written = [token for token in written if token.text not in OPERATOR_WORDS]
        words = [known.value(token.text) for token in written if token.kind is WORD]
        return any(word not in WORDS and not known.is_own(word) for word in words)

    def to_command(self) -> None:
        """Go over a question in words to where something is done, on the same line."""
        cursor = self.cursor
        while cursor.token.kind not in ("{", *AT_END) and cursor.token.text not in AFTER_HEADER:
            said = self.known.command(cursor.token.text) if cursor.token.kind is WORD else None
            if cursor.token.text in TURN_WORDS or (said is not None and said.is_instruction):
                break
            cursor.i += 1

    def whole_line(self, word: Token, block: str) -> str | None:
        """Return how the line is written that begins with `word`, the header of a `block`.

        Go to its end; blocks that it leaves open are opened. None where it is not understood.
        """
        cursor = self.cursor
        k = cursor.i
        while cursor.tokens[k].start > word.start:
            k -= 1
        line = line_of_block(cursor.tokens, k, block, self.known)
        if line is None:
            return None
        for token in cursor.tokens[k : line.end]:
            self.reporter.answer(token)
        cursor.i = line.end
        for block in line.open:
            self.begin_reported(block, cursor.span_from(word))
        for name in line.variables:
            self.blocks.here.append(Assign(name.text, name.span, None, name.span))
        return line.text

    def to_body(self, bracket: int) -> None:
        """Go to where the body begins behind the `(` at `bracket`, which cannot be read."""
        cursor = self.cursor
        end = after_bracket(cursor.tokens, bracket)
        cursor.i = end or body_begins(cursor.tokens, max(cursor.i, bracket + 1))

    def unread_header(self, word: Token) -> NoReturn:
        """Open the block of a header that cannot be read."""
        span = Span(word.start, max(word.end, self.cursor.last.end))
        self.begin_reported(word.text, span)
        self.go_on(word)

    def begin_reported(self, word: str, span: Span, head: Argument | None = None) -> None:
        """Open a block whose header has a diagnostic already."""
        self.blocks.begin(word, span, head).is_reported = True

    def go_on(self, header: Token | None = None) -> NoReturn:
        """Go on with what follows on this line, without reporting what is skipped.

        The thing to try of a `header` stands for what is skipped, too.
        """
        cursor = self.cursor
        token = cursor.token
        while token.text in AFTER_HEADER or (token.kind is ODD and token.text == ":"):
            self.reporter.answer(token)
            cursor.i += 1
            token = cursor.token
        self.reporter.crowded_line = cursor.line_of(cursor.last)
        if header is not None:
            self.reporter.widen(header.start, cursor.last.end)
        raise Resumed

    def needless_brackets(
        self, word: Token, bracket: Token, arguments: Sequence[Argument], other: str
    ) -> None:
        """`ENDIF()`, `ELSE(DISTANCE < 10)`."""
        cursor = self.cursor
        if not arguments:
            span = cursor.span_from(word)
            self.reporter.report(codes.EMPTY_BRACKETS, span, word=word.text)
            return
        inside = cursor.source[Span(arguments[0].span.start, arguments[-1].span.end)]
        is_else = not other or self.blocks.is_rest(inside, cursor.source)
        fix, asked = word.text if is_else else f"{other}({inside})", ""
        if word.text in WORDS and WORDS[word.text].role == "stop":
            is_time = len(arguments) == 1 and arguments[0].is_plain
            fix = f"{word.text};W({inside})" if is_time else word.text
            asked = f"UNTIL({inside})" if set(inside) & set("<>=") else ""
        span = cursor.span_from(bracket)
        values = {"word": word.text, "asked": asked, "fix": "" if asked else fix}
        self.reporter.report(codes.NO_BRACKETS_HERE, span, cursor.span_from(word), **values)

    # -- arms ---------------------------------------------------------------------------------

    def else_if(self, word: Token) -> Token:
        """`ELSE IF(c)`: suggest the whole header in one word, and go on with that word."""
        cursor = self.cursor
        span = Span(word.start, cursor.token.end)
        cursor.i += 1
        start = cursor.i
        end = after_bracket(cursor.tokens, start) if cursor.token.kind == "(" else None
        written = cursor.tokens[start : end or body_begins(cursor.tokens, start)]
        if not written:  # `ELSE IF {`: it asks nothing
            found = cursor.source[span]
            self.reporter.report(codes.OTHER_LANGUAGE, span, span, found=found, right="ELSE",
                                 fix="ELSE", usage="ELSE")  # fmt: skip
            return Token(WORD, "ELSE", *span)
        if written[0].kind == "(" and written[-1].kind == ")":
            written = written[1:-1]
        fix = head_in(WORDS["ELSEIF"], written)
        last = cursor.tokens[(end or body_begins(cursor.tokens, start)) - 1]
        self.reporter.report(codes.ELSE_IF, span, Span(word.start, last.end), fix=fix)
        return Token(WORD, "ELSEIF", *span)

    def misplaced_arm(self, arm: str, span: Span) -> Block:
        """Close what is open inside the IF that an arm belongs to, and return that IF."""
        innermost = self.blocks.innermost
        if innermost is None or not self._is_open("IF"):
            right = "IF(DISTANCE < 10)"
            self._owed += 1
            line = self._end_before(span)
            self.reporter.fail(codes.NOT_OPEN, span, found=arm, right=right, line=line)
        self._report_wrong_end(span, arm, innermost)
        return self._end_until("IF", span)

    def _end_before(self, span: Span) -> str:
        """Return the line of the ENDIF that stands right before the arm at `span`, if one does."""
        tokens = self.cursor.tokens
        k = self.cursor.i
        while k and tokens[k].start >= span.start:
            k -= 1
        while k and tokens[k].kind in AT_END:
            k -= 1
        is_end = ALIASES.get(tokens[k].text, tokens[k].text) == BLOCK_ENDS["IF"]
        return str(self.cursor.line_of(tokens[k])) if is_end else ""

    # -- ends ---------------------------------------------------------------------------------

    def end(self, word: str, end: Token) -> None:
        """Close the block of `word` that `end` ends."""
        block = self.blocks.innermost
        if block is not None and block.word == word:
            self.blocks.end(end.span)
        else:
            self.wrong_end(word, end)

    def wrong_end(self, word: str, end: Token) -> None:
        """The innermost block is not one of `word`: close the one that is, and all inside it.

        An end that closes nothing else closes the innermost block: it is probably meant.
        """
        block, span = self.blocks.innermost, end.span
        found = self.cursor.source[span].upper()
        found = found if found in ALIASES else BLOCK_ENDS[word]
        if block is not None and self._is_open(word):
            if not _is_swapped(self, block, end):
                self._report_wrong_end(span, found, block)
            self._end_until(word, span)
            self.blocks.end(span)
        elif self._owed:
            self._owed -= 1
        elif block is not None and word == "LOOP" and _has_a_number(block):
            head = self.cursor.source[block.span]
            number = head[head.find("(") + 1 :].rstrip(") ")
            self.reporter.report(codes.WANTS_CONDITION, block.span, block.span, by=block.word,
                                 found=number, fix=f"LOOP({number})")  # fmt: skip
            block.head = None
            self.blocks.end(span)
        elif block is not None:
            if not _told_with_header(self, block):
                self._report_wrong_end(span, found, block, fix=BLOCK_ENDS[block.word])
            self._owed += 1
            self.blocks.end(span)
        elif not self._is_misspelt_header(word) and not _is_taken_for_header(self, word):
            right = WORDS[word].example if word != "DEF" else "DEF DANCE"
            self.reporter.report(codes.NOT_OPEN, span, found=found, right=right)

    def end_in_two_words(self, end: Token, following: Token) -> None:
        """`END LOOP`."""
        right = BLOCK_ENDS[following.text]
        whole = Token(WORD, right, end.start, following.end)
        found = self.cursor.source[whole.span]
        self.reporter.report(codes.END_SPLIT, whole.span, found=found, right=right)
        self.cursor.i += 2
        self.end(following.text, whole)

    def end_of_any(self, end: Token) -> None:
        """`END` or `FIN` alone: it ends the innermost block."""
        cursor = self.cursor
        cursor.i += 1
        named = cursor.token
        said = {named.text, meant_by(named.text) or ""}
        is_header = bool(said & {"SI", "FOREVER", *COUNTING, *BLOCK_ENDS})
        if named.kind is WORD and is_header:
            cursor.i += 1  # `FIN SI`, `FIN MIENTRAS`, `FIN PARA`
        block = self.blocks.innermost
        if named is cursor.token and block is not None and self._else_comes():
            self.reporter.report(codes.EXTRA_WORD, end.span, found=end.text, fix="")
            return
        if block is None:
            cursor.i += named.text in TITLES  # `FIN PROGRAMA`
            span = cursor.span_from(end)
            self.reporter.report(codes.EXTRA_WORD, span, found=end.text, label=cursor.source[span])
            return
        if not block.is_reported:
            right = BLOCK_ENDS[block.word]
            span = cursor.span_from(end)
            found = cursor.source[span].upper()
            self.reporter.report(codes.END_ALONE, span, found=found, right=right)
        self.blocks.end(end.span)

    def _else_comes(self) -> bool:
        """Whether an ELSE follows the end of an IF: it ends later then."""
        tokens, k = self.cursor.tokens, self.cursor.i
        while tokens[k].kind in (NEWLINE, ";"):
            k += 1
        is_no = tokens[k].text == "SI" and tokens[k + 1].text == "NO"
        said = "ELSE" if is_no else tokens[k].text if tokens[k].text in WORDS else ""
        said = said or foreign_block(tokens[k].text) or ""
        innermost = self.blocks.innermost
        is_if = innermost is not None and innermost.word == "IF" and innermost.otherwise is None
        return is_if and said in ("ELSE", "ELSEIF")

    def close_brace(self, brace: Token) -> None:
        """`}` ends the innermost block, except before ELSE. The lexer has reported it."""
        cursor = self.cursor
        following = cursor.inner()
        if self.blocks.open and following.text not in ("ELSE", "ELSEIF", "SINO", "ELIF"):
            self.name_end(self.blocks.open[-1])
            self.blocks.end(brace.span)
            self._owed += 1

    def alone(self, brace: Token) -> None:
        """`{` where an instruction begins: if no block is meant, both brackets go."""
        block = self.blocks.innermost
        source = self.cursor.source
        if block is not None and not source[Span(block.span.end, brace.start)].strip("(); \t\r\n"):
            return
        for k, diagnostic in enumerate(self.reporter.diagnostics):
            if diagnostic.code is codes.BRACES and diagnostic.span.start == brace.start:
                self.reporter.change(k, diagnostic._replace(values={"alone": "{ }"}))

    def name_end(self, block: Block) -> None:
        """Let the diagnostic of the first brace name the end of its block, which is known now."""
        start = block.arms[0].span.end if block.arms else block.span.end
        for k, diagnostic in enumerate(self.reporter.diagnostics):
            if diagnostic.code is codes.BRACES and start <= diagnostic.span.start:
                if not self.cursor.source[Span(start, diagnostic.span.start)].strip("; \t\r\n"):
                    values = {**diagnostic.values, "right": BLOCK_ENDS[block.word]}
                    self.reporter.change(k, diagnostic._replace(values=values))

    def never_ended(self) -> None:
        """Report the blocks that are still open at the end of the text."""
        for block in self.blocks.open:
            if (not block.is_reported or block.word == "DEF") and not self._is_misspelt(block):
                right = BLOCK_ENDS[block.word]
                where = where_it_ends(block, self.cursor.source)
                self.reporter.report(
                    codes.NEVER_ENDS, block.span, None, word=block.word, right=right, **where
                )

    def _is_open(self, word: str) -> bool:
        return any(block.word == word for block in self.blocks.open)

    def _end_until(self, word: str, span: Span) -> Block:
        """Close blocks until one of `word` is the innermost."""
        while self.blocks.open[-1].word != word:
            self.blocks.end(span)
            self._owed += 1
        return self.blocks.open[-1]

    def _report_wrong_end(self, span: Span, found: str, block: Block, fix: str = "") -> None:
        if self._is_misspelt(block):
            return
        line, after, last = open_above(block, self.cursor.source, span.start)
        if fix:
            after = last = ""
        self.reporter.report(codes.WRONG_END, span, found=found, word=block.word, line=str(line),
                             after=after, last=last, right=BLOCK_ENDS[block.word],
                             fix=fix)  # fmt: skip

    def _is_misspelt(self, block: Block) -> bool:
        """Report what is probably the end of a block, with a letter of it wrong."""
        right = BLOCK_ENDS[block.word]
        for each in block.here:
            if isinstance(each, Command) and each.arguments is None and each.word not in WORDS:
                if nearest(each.word, (right,)) and not self.is_name(each.word):
                    span = each.span
                    self.reporter.report(codes.UNKNOWN_WORD, span, found=each.word, near=right)
                    return True
        return False

    def _is_misspelt_header(self, word: str) -> bool:
        """Whether a header with a wrong letter stands before, as `IFF(DISTANCE < 10)`."""
        return any(
            isinstance(each, Command) and each.word not in WORDS and nearest(each.word, (word,))
            for each in self.blocks.here
        )

    def is_name(self, word: str) -> bool:
        """Whether the kit or a DEF anywhere in the text has this name."""
        return self.known.is_name(word)


def _has_a_number(block: Block) -> bool:
    """Whether a number alone is what an IF or WHILE asks: a LOOP was meant."""
    return block.word in ("IF", "WHILE") and block.head is not None and block.head.is_plain


def _is_swapped(reader: BlockRecovery, block: Block, end: Token) -> bool:
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


def _told_with_header(reader: BlockRecovery, block: Block) -> bool:
    """Whether the header is said in another language, so that its message names the end, too."""
    for k, each in enumerate(reader.reporter.diagnostics):
        if each.code is codes.OTHER_LANGUAGE and each.span.start == block.header.start:
            values = {**each.values, "ends": BLOCK_ENDS[block.word]}
            reader.reporter.change(k, each._replace(values=values))
            return True
    return False


def _is_taken_for_header(reader: BlockRecovery, word: str) -> bool:
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
