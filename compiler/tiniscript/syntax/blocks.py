"""The parser's half that opens and closes blocks.

Knows which headers, arms and ends belong together. Where a header cannot be read its block
opens all the same, so that its end is no second problem.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NoReturn

from tiniscript import problems
from tiniscript.bytecode import BLOCKS
from tiniscript.kit import Kit
from tiniscript.source import Source, Span
from tiniscript.syntax.ast import Argument, Arm, Command, Def, If, Instruction, Loop, While
from tiniscript.syntax.expressions import Expressions, Failed
from tiniscript.syntax.lexer import NEWLINE, ODD, WORD, Scan, Token
from tiniscript.syntax.suggestions import AFTER_HEADER, ENDS, after_bracket, body_begins, head_in
from tiniscript.words import ALIASES, BLOCK_ENDS, WORDS, nearest, other_name


class GoesOn(Failed):
    """What could not be read ends here: the next instruction begins at `i`, on the same line."""


class _Block:
    """A block whose end has not come yet."""

    __slots__ = ("arms", "body", "head", "is_told", "name", "otherwise", "span", "word")

    def __init__(self, word: str, span: Span, head: Argument | None, name: Token | None) -> None:
        self.word = word
        self.span = span  # of the header: where a block that never ends is reported
        self.head = head  # the condition or the count of the arm that is being read
        self.name = name
        self.body: list[Instruction] = []
        self.arms: list[Arm] = []
        self.otherwise: list[Instruction] | None = None  # what follows ELSE, once it has come
        self.is_told = False  # its header is a problem already: how it ends is none besides

    @property
    def here(self) -> list[Instruction]:
        """Where the next instruction belongs."""
        return self.body if self.otherwise is None else self.otherwise

    def next_arm(self, head: Argument | None, span: Span) -> None:
        self.arms.append(Arm(self.head, tuple(self.body), self.span))
        self.body, self.head, self.span = [], head, span


class Blocks(Expressions):
    def __init__(self, source: Source, scanned: Scan, kit: Kit | None) -> None:
        super().__init__(source, scanned.tokens, list(scanned.problems))
        self.kit = kit
        self.names: set[str] | None = None  # of the kit and of all DEFs, once somebody asks
        self.body: list[Instruction] = []
        self.blocks: list[_Block] = []
        self.depth = 0  # open blocks, DEF not counted
        self.owed = 0  # blocks that were closed by another one's end: their own may still come
        self.crowded_line = -1  # the last line with a separator missing, which is said once

    @property
    def here(self) -> list[Instruction]:
        """Where the next instruction belongs."""
        return self.blocks[-1].here if self.blocks else self.body

    def never_end(self) -> None:
        """Report the blocks that are still open at the end of the text."""
        for block in self.blocks:
            if not block.is_told and not self._is_misspelt(block):
                right = BLOCK_ENDS[block.word]
                self.report(problems.NEVER_ENDS, block.span, word=block.word, right=right)

    def is_name(self, word: str) -> bool:
        """Whether the kit or a DEF anywhere in the text has this name."""
        if self.names is None:
            pairs = pairwise(self.tokens)
            self.names = {name.text for first, name in pairs if first.text == "DEF"}
            if self.kit is not None:
                self.names |= {each.name for each in (*self.kit.sensors, *self.kit.actuators)}
        return word in self.names

    def _is_misspelt(self, block: _Block) -> bool:
        """Name what is probably the end of a block, with a slip of the finger in it."""
        right = BLOCK_ENDS[block.word]
        for each in block.here:
            if isinstance(each, Command) and each.arguments is None and each.word not in WORDS:
                if nearest(each.word, (right,)) and not self.is_name(each.word):
                    self.report(problems.UNKNOWN_WORD, each.span, found=each.word, near=right)
                    return True
        return False

    # -- headers ----------------------------------------------------------------------------

    def header(self, word: Token) -> None:
        """Read IF(c), LOOP(n) or WHILE(c). The block opens even where the header is wrong."""
        self.i += 1
        try:
            head = self.one_argument(word)
        except Failed:
            span = Span(word.start, max(word.end, self.tokens[self.i - 1].end))
            self.open(word.text, span, None, None).is_told = True
            self.go_on()
        self.open(word.text, Span(word.start, self.tokens[self.i - 1].end), head, None)

    def one_argument(self, word: Token, is_told: bool = False) -> Argument:
        """Read `(c)` after `word` and return c. `i` is where the body begins if that fails.

        `is_told`: `word` is a problem already, so that brackets are missing is none.
        """
        start = self.i
        its = WORDS[word.text]
        if self.tokens[start].kind != "(":
            self.i = body_begins(self.tokens, start)
            if is_told:
                raise Failed
            self._no_open(word, start)
        try:
            arguments = self.arguments()
            if len(arguments) == 1:
                return arguments[0]
            span = Span(self.tokens[start].start, self.tokens[self.i - 1].end)
            self.count_problem(its, [each.span for each in arguments], span)
            raise Failed
        except Failed:
            end = after_bracket(self.tokens, start)
            self.i = end or body_begins(self.tokens, max(self.i, start + 1))
            raise

    def _no_open(self, word: Token, start: int) -> NoReturn:
        """`IF DISTANCE < 10`: suggest the same with brackets."""
        written = self.tokens[start : self.i]
        span = Span(word.start, written[-1].end if written else word.end)
        fix = head_in(WORDS[word.text], written)
        self.fail(problems.MISSING_OPEN, span, word=word.text, fix=fix)

    def go_on(self) -> NoReturn:
        """Go on with what follows on this line, in silence about what stands between."""
        token = self.tokens[self.i]
        while token.text in AFTER_HEADER or (token.kind is ODD and token.text == ":"):
            self.answered.add(token.start)
            self.i += 1
            token = self.tokens[self.i]
        self.crowded_line = self.source.position(self.tokens[self.i - 1].start)[0]
        raise GoesOn

    def define(self, word: Token) -> None:
        """Read DEF NAME."""
        self.i += 1
        name = self.tokens[self.i]
        if name.kind is not WORD:
            self.open("DEF", word.span, None, None).is_told = True
            self.fail(problems.DEF_NEEDS_NAME, word.span)
        self.i += 1
        if name.text in WORDS:
            right = other_name(name.text)
            self.report(problems.RESERVED, name.span, word=name.text, right=right)
        block = self.open("DEF", Span(word.start, name.end), None, name)
        if self.tokens[self.i].kind == "(":
            block.is_told = True
            self.no_brackets(name)
            block.span = Span(word.start, self.tokens[self.i - 1].end)

    def open(self, word: str, span: Span, head: Argument | None, name: Token | None) -> _Block:
        if word == "DEF":
            if self.blocks:
                self.report(problems.DEF_NOT_TOP, span)
        else:
            self.depth += 1
            if self.depth == BLOCKS + 1:
                self.report(problems.BLOCKS_TOO_DEEP, span, limit=str(BLOCKS))
        self.blocks.append(_Block(word, span, head, name))
        return self.blocks[-1]

    def no_brackets(self, word: Token, fix: str = "") -> None:
        """Name brackets after a word that takes none, and pass over them."""
        if self.tokens[self.i].kind == "(":
            start = self.tokens[self.i].start
            arguments = self.arguments()
            span = Span(start, self.tokens[self.i - 1].end)
            if not arguments:
                span = Span(word.start, span.end)
                self.report(problems.EMPTY_BRACKETS, span, word=word.text)
                return
            inside = self.source[Span(arguments[0].span.start, arguments[-1].span.end)]
            shown = f"{fix}({inside})" if fix else word.text
            self.report(problems.NO_BRACKETS_HERE, span, word=word.text, fix=shown)

    # -- arms -------------------------------------------------------------------------------

    def arm(self, word: Token, is_told: bool = False) -> None:
        """Read ELSE or ELSEIF(c)."""
        block = self.blocks[-1] if self.blocks else None
        first = self.i
        self.i += 1
        text, following = word.text, self.tokens[self.i]
        span, head, has_failed = word.span, None, False
        if text == "ELSE" and following.kind is WORD and following.text == "IF":
            self.i += 1
            self._else_if(word, following)
            text, is_told = "ELSEIF", True
            span = Span(word.start, following.end)
        if text == "ELSEIF":
            try:
                head = self.one_argument(Token(WORD, text, *span), is_told)
            except Failed:
                has_failed = True
            last = self.tokens[max(self.i - 1, first)]
            span = Span(word.start, max(span.end, last.end))
        else:
            self.no_brackets(word, "ELSEIF")
        if block is None or block.word != "IF":
            open_if = next((each for each in self.blocks if each.word == "IF"), None)
            if block is None or open_if is None:
                self.fail(problems.NOT_OPEN, span, found=text, right="IF(DISTANCE < 10)")
            self._wrong_end(span, text, block)
            block = self._close_until("IF", span)
        if block.otherwise is not None:
            self.report(problems.AFTER_ELSE, span, found=text)
            block.otherwise.clear()
        else:
            block.next_arm(head, span)
            if text == "ELSE":
                block.otherwise = []
        if has_failed:
            self.go_on()

    def _else_if(self, word: Token, following: Token) -> None:
        """`ELSE IF(c)`: suggest the whole header in one word."""
        end = after_bracket(self.tokens, self.i) if self.tokens[self.i].kind == "(" else None
        end = end or body_begins(self.tokens, self.i)
        written = self.tokens[self.i : end]
        if written and written[0].kind == "(" and written[-1].kind == ")":
            written = written[1:-1]
        span = Span(word.start, following.end)
        self.report(problems.ELSE_IF, span, fix=head_in(WORDS["ELSEIF"], written))

    # -- ends -------------------------------------------------------------------------------

    def end_in_two_words(self, end: Token, following: Token) -> None:
        """`END LOOP`."""
        right = BLOCK_ENDS[following.text]
        span = Span(end.start, following.end)
        self.report(problems.END_SPLIT, span, found=self.source[span], right=right)
        self.i += 2
        self.end(right, span)

    def end_of_any(self, end: Token) -> None:
        """`END` or `FIN` alone: it ends the innermost block."""
        self.i += 1
        block = self.blocks[-1] if self.blocks else None
        if block is None:
            self.report(problems.EXTRA_WORD, end.span, found=end.text, fix="")
            return
        if not block.is_told:
            right = BLOCK_ENDS[block.word]
            self.report(problems.END_ALONE, end.span, found=end.text, right=right)
        self._close(end.span)

    def end(self, end: str, span: Span) -> None:
        """Close the block that `end` (ENDIF, END_LOOP …) ends, and name those inside it."""
        word = ENDS[end]
        found = self.source[span].upper()
        found = found if found in ALIASES else end
        if self.blocks and self.blocks[-1].word == word:
            self._close(span)
        elif any(block.word == word for block in self.blocks):
            self._wrong_end(span, found, self.blocks[-1])
            self._close_until(word, span)
            self._close(span)
        elif self.owed:
            self.owed -= 1
        elif self.blocks:
            block = self.blocks[-1]
            right = BLOCK_ENDS[block.word]
            self._wrong_end(span, found, block, fix=right)
            self.owed += 1
            self._close(span)
        else:
            right = WORDS[word].example if word != "DEF" else "DEF DANCE"
            self.report(problems.NOT_OPEN, span, found=found, right=right)

    def _wrong_end(self, span: Span, found: str, block: _Block, fix: str = "") -> None:
        if self._is_misspelt(block):
            return
        line = self.source.position(block.span.start)[0]
        self.report(problems.WRONG_END, span, found=found, word=block.word, line=str(line),
                    right=BLOCK_ENDS[block.word], fix=fix)  # fmt: skip

    def _close_until(self, word: str, span: Span) -> _Block:
        """Close blocks until one of `word` is the innermost."""
        while self.blocks[-1].word != word:
            self._close(span)
            self.owed += 1
        return self.blocks[-1]

    def close_brace(self, brace: Token) -> None:
        """`}` ends the innermost block, except before ELSE. That it does so is told already."""
        k = self.i
        while self.tokens[k].kind is NEWLINE:
            k += 1
        if self.blocks and self.tokens[k].text not in ("ELSE", "ELSEIF", "SINO", "ELIF"):
            self._close(brace.span)
            self.owed += 1

    def _close(self, end: Span) -> None:
        block = self.blocks.pop()
        span = Span(block.span.start, end.end)
        too_deep = self.depth > BLOCKS
        if block.word == "DEF":
            if block.name is not None and not self.blocks:
                name = block.name
                self.body.append(Def(name.text, name.span, tuple(block.body), span))
            return
        self.depth -= 1
        if too_deep:
            return
        if block.word == "IF":
            if block.otherwise is None:
                block.next_arm(None, block.span)
            self.here.append(If(tuple(block.arms), tuple(block.otherwise or ()), span))
        elif block.word == "LOOP":
            count = block.head
            if count is not None and count.expression[0].op == "FOREVER":
                count = None
            self.here.append(Loop(count, tuple(block.body), span))
        else:
            self.here.append(While(block.head, tuple(block.body), span))
