"""Tokens become a syntax tree.

Knows the shape of instructions and blocks. Does not know what a name stands for, how many
arguments a word takes or which kinds fit: `checker` does. Names what is wrong and goes on with
the next instruction. Works with stacks of its own, so no depth of input exhausts Python's.
"""

from __future__ import annotations

from typing import NamedTuple, NoReturn

from tiniscript import problems
from tiniscript.bytecode import BLOCKS
from tiniscript.expressions import Expressions, Failed
from tiniscript.source import Source, Span
from tiniscript.tokens import END, NEWLINE, NUMBER, ODD, WORD, Scan, Token, scan
from tiniscript.tree import (
    Argument,
    Arm,
    Assign,
    Break,
    Command,
    Def,
    If,
    Instruction,
    Loop,
    Program,
    While,
)
from tiniscript.words import ALIASES, BLOCK_ENDS, WORDS, meant_by, nearest

ENOUGH = 100  # mistakes after which reading on helps nobody

_OPERATORS = frozenset(("+", "-", "*", "/", "%", "=", "<", ">", "<=", ">=", "<>"))


class Parsed(NamedTuple):
    program: Program
    scan: Scan
    problems: list[problems.Problem]


def parse(source: Source) -> Parsed:
    """Return the tree of a program with all that is wrong in its shape."""
    parser = _Parser(source, scan(source.text))
    return Parsed(parser.program(), parser.scan, parser.problems)


class _Block:
    """A block whose end has not come yet."""

    __slots__ = ("arms", "body", "head", "name", "otherwise", "span", "word")

    def __init__(self, word: str, span: Span, head: Argument | None, name: Token | None) -> None:
        self.word = word
        self.span = span  # of the header: where a block that never ends is reported
        self.head = head  # the condition or the count of the arm that is being read
        self.name = name
        self.body: list[Instruction] = []
        self.arms: list[Arm] = []
        self.otherwise: list[Instruction] | None = None  # what follows ELSE, once it has come

    @property
    def here(self) -> list[Instruction]:
        """Where the next instruction belongs."""
        return self.body if self.otherwise is None else self.otherwise

    def next_arm(self, head: Argument | None, span: Span) -> None:
        self.arms.append(Arm(self.head, tuple(self.body), self.span))
        self.body, self.head, self.span = [], head, span


class _Parser(Expressions):
    def __init__(self, source: Source, scanned: Scan) -> None:
        super().__init__(source, scanned.tokens, list(scanned.problems))
        self.scan = scanned
        self.body: list[Instruction] = []
        self.blocks: list[_Block] = []
        self.depth = 0  # open blocks, DEF not counted
        self.crowded_line = -1  # the offset of the last missing separator's line, said once

    # -- the program ------------------------------------------------------------------------

    def program(self) -> Program:
        start = self._setup()
        while self.tokens[self.i].kind is not END and len(self.problems) <= ENOUGH:
            kind = self.tokens[self.i].kind
            if kind is NEWLINE or kind == ";":
                self.i += 1
                continue
            try:
                self._instruction()
            except Failed:
                self._skip()
        for block in self.blocks:
            end = BLOCK_ENDS[block.word]
            self.report(problems.NEVER_ENDS, block.span, word=block.word, right=end)
        return Program(start, tuple(self.body))

    def _setup(self) -> str:
        while self.tokens[self.i].kind is NEWLINE:
            self.i += 1
        word, bar = self.tokens[self.i], self.tokens[min(self.i + 1, len(self.tokens) - 1)]
        if word.kind is not WORD or bar.kind != "|":
            return "SI"
        self.i += 2
        if word.text == "PING":
            self._ping(word)
            return "PING"
        if word.text not in ("SI", "SB"):
            known = nearest(word.text, ["SI", "SB", "PING"]) or "SI"
            self.report(problems.SETUP_UNKNOWN, word.span, found=word.text, right=known + "|")
            return "SI"
        return word.text

    def _ping(self, ping: Token) -> None:
        """Read `check_connection`, after which nothing may come."""
        token = self.tokens[self.i]
        if token.kind is WORD and token.text == "CHECK_CONNECTION":
            self.i += 1
            while (token := self.tokens[self.i]).kind is NEWLINE or token.kind == ";":
                self.i += 1
            if token.kind is END:
                return
        self.report(problems.PING_ALONE, ping.span if token.kind is END else token.span)
        self.i = len(self.tokens) - 1

    def _skip(self) -> None:
        """Go to the end of an instruction that could not be read."""
        while self.tokens[self.i].kind not in (";", NEWLINE, END):
            self.i += 1

    # -- instructions -----------------------------------------------------------------------

    def _instruction(self) -> None:
        token = self.tokens[self.i]
        if token.kind is ODD:
            self.i += 1
            raise Failed
        if token.kind is not WORD:
            code = problems.EXTRA_CLOSE if token.kind == ")" else problems.NOT_AN_INSTRUCTION
            self.i += 1
            self.fail(code, token.span, found=token.text)
        following = self.tokens[self.i + 1]
        if following.kind == "=":
            self._assign(token)
        elif token.text in ("IF", "LOOP", "WHILE"):
            self._header(token)
        elif token.text == "DEF":
            self._def(token)
        elif token.text in ("ELSE", "ELSEIF"):
            self._arm(token)
        elif token.text == "END":
            self._end_in_two_words(token, following)
        elif token.text in ALIASES or token.text in BLOCK_ENDS.values():
            self.i += 1
            self._no_brackets(token)
            self._end(ALIASES.get(token.text, token.text), token.span)
        elif token.text == "BREAK":
            self.i += 1
            self._no_brackets(token)
            self._add(Break(token.span))
        else:
            self._command(token)
        self._separator(token)

    def _separator(self, first: Token) -> None:
        """What ends an instruction must come now."""
        token = self.tokens[self.i]
        kind = token.kind
        if kind in (";", NEWLINE, END):
            return
        if kind is ODD:
            raise Failed
        if kind == ")":
            self.i += 1
            self.fail(problems.EXTRA_CLOSE, token.span, found=")")
        if kind == "|":
            self.fail(problems.SETUP_TWICE, token.span, found=first.text)
        if kind in _OPERATORS:
            self.fail(problems.NOT_AN_INSTRUCTION, token.span, found=token.text)
        before = self.tokens[self.i - 1]
        if kind == "," and before.kind is NUMBER and self.tokens[self.i + 1].kind is NUMBER:
            after = self.tokens[self.i + 1]
            span = Span(before.start, after.end)
            self.fail(problems.DECIMAL_COMMA, span, right=f"{before.text}.{after.text}")
        if token.text in ("THEN", "DO", "BEGIN", "ENTONCES", "HACER"):
            self.report(problems.EXTRA_WORD, token.span, found=token.text)
            self.i += 1
            return self._separator(first)
        line = self.source.position(token.start)[0]
        if line != self.crowded_line:
            self.crowded_line = line
            header = self.blocks and self.blocks[-1].span.end == before.end
            code = problems.HEADER_SEPARATOR if header else problems.MISSING_SEPARATOR
            shown = self.source.text[first.start : before.end]
            self.report(code, token.span, found=token.text, before=_short(shown))
        if kind is not WORD:
            raise Failed

    def _add(self, instruction: Instruction) -> None:
        (self.blocks[-1].here if self.blocks else self.body).append(instruction)

    def _assign(self, name: Token) -> None:
        self.i += 2
        value = self.argument(inside=False)
        span = Span(name.start, value.span.end)
        if name.text in WORDS:
            other = name.text + "_1" if len(name.text) == 1 else "MY_" + name.text
            self.report(problems.RESERVED, name.span, word=name.text, right=other)
        else:
            self._add(Assign(name.text, name.span, value, span))

    def _command(self, word: Token) -> None:
        known = WORDS.get(word.text)
        following = self.tokens[self.i + 1]
        if known is not None:
            self._refuse_if_no_command(word, known.role, following)
        elif following.kind == "|":
            self.fail(problems.SETUP_TWICE, word.span, found=word.text)
        self.i += 1
        arguments = None
        if following.kind == "(":
            if known is not None and not known.arguments:
                self._no_brackets(word)
            else:
                arguments = self.arguments()
                if not arguments and known is None:
                    span = Span(word.start, self.tokens[self.i - 1].end)
                    self.report(problems.EMPTY_BRACKETS, span, word=word.text)
                    arguments = None
        elif known is not None and known.arguments:
            self._brackets_wanted(word, known.example)
        elif known is None and following.kind is NUMBER:
            meant = meant_by(word.text)
            if meant and WORDS[meant].role in ("move", "wait"):
                self.fail(problems.OTHER_LANGUAGE, word.span, found=word.text, right=meant,
                          fix=WORDS[meant].example)  # fmt: skip
        until = None
        if self.tokens[self.i].kind is WORD and self.tokens[self.i].text == "UNTIL":
            until = self._until(word)
        span = Span(word.start, self.tokens[self.i - 1].end)
        if known is None or known.role != "start":
            self._add(Command(word.text, word.span, arguments, until, span))

    def _refuse_if_no_command(self, word: Token, role: str, following: Token) -> None:
        if role == "setup":
            if word.text == "SI" and following.kind == "(":
                self._spanish_if(word)
            bar = following.kind == "|" or word.text == "CHECK_CONNECTION"
            code = problems.SETUP_TWICE if bar else problems.SETUP_NEEDS_BAR
            self.fail(code, word.span, found=word.text)
        if role == "until":
            self.fail(problems.UNTIL_ALONE, word.span)
        if role == "forever":
            self.fail(problems.FOREVER_NOT_HERE, word.span)
        if role == "later":
            self.fail(problems.LATER_WORD, word.span, word=word.text)
        if role in ("value", "function", "operator"):
            self.fail(problems.NOT_AN_INSTRUCTION, word.span, found=word.text)

    def _spanish_if(self, word: Token) -> NoReturn:
        """`SI(c)` is how Spanish says IF: name it, and read its block as one."""
        self.report(problems.SPANISH_IF, word.span)
        self.i += 1
        head = self._one_argument()
        self._open("IF", Span(word.start, self.tokens[self.i - 1].end), head, None)
        raise Failed

    def _brackets_wanted(self, word: Token, example: str) -> NoReturn:
        """`F 2 80`: suggest the same with brackets and commas."""
        start = self.i
        self._skip()
        written = [t.text for t in self.tokens[start : self.i] if t.kind in (NUMBER, WORD)]
        known = WORDS[word.text].arguments
        fits = len(written) == len(known)
        fix = f"{word.text}({', '.join(written)})" if fits else example
        span = Span(word.start, max(word.end, self.tokens[self.i - 1].end))
        self.fail(problems.MISSING_OPEN, span, word=word.text, fix=fix)

    def _until(self, word: Token) -> Argument:
        token = self.tokens[self.i]
        self.i += 1
        if self.tokens[self.i].kind != "(":
            self._condition_without_brackets(token)
        return self._one_argument()

    def _no_brackets(self, word: Token) -> None:
        if self.tokens[self.i].kind == "(":
            start = self.tokens[self.i].start
            arguments = self.arguments()
            span = Span(start, self.tokens[self.i - 1].end)
            code = problems.NO_BRACKETS_HERE if arguments else problems.EMPTY_BRACKETS
            self.report(code, span if arguments else Span(word.start, span.end), word=word.text)

    # -- blocks -----------------------------------------------------------------------------

    def _header(self, word: Token) -> None:
        """Read IF(c), LOOP(n) or WHILE(c). The block opens even where the header is wrong."""
        head = None
        try:
            self.i += 1
            head = self._head(word)
        finally:
            span = Span(word.start, max(word.end, self.tokens[self.i - 1].end))
            self._open(word.text, span, head, None)

    def _head(self, word: Token) -> Argument:
        if self.tokens[self.i].kind != "(":
            self._condition_without_brackets(word)
        return self._one_argument()

    def _condition_without_brackets(self, word: Token) -> NoReturn:
        """`IF DISTANCE < 10`: suggest the same with brackets."""
        start = self.i
        self._skip()
        written = self.tokens[start : self.i]
        if written:
            inside = self.source.text[written[0].start : written[-1].end]
            fix = f"{word.text}({_short(inside)})"
        else:
            fix = {"LOOP": "LOOP(3)"}.get(word.text, f"{word.text}(DISTANCE < 10)")
        span = Span(word.start, written[-1].end if written else word.end)
        self.fail(problems.MISSING_OPEN, span, word=word.text, fix=fix)

    def _one_argument(self) -> Argument:
        """Read `(c)` and return c."""
        open_bracket = self.tokens[self.i]
        arguments = self.arguments()
        if len(arguments) == 1:
            return arguments[0]
        span = Span(open_bracket.start, self.tokens[self.i - 1].end)
        word = self.tokens[self.tokens.index(open_bracket, self.i - 50 if self.i > 50 else 0) - 1]
        self.count_problem(WORDS[word.text], [each.span for each in arguments], span)
        raise Failed

    def _def(self, word: Token) -> None:
        self.i += 1
        name = self.tokens[self.i]
        if name.kind is not WORD:
            self._open("DEF", word.span, None, None)
            self.fail(problems.DEF_NEEDS_NAME, word.span)
        self.i += 1
        if name.text in WORDS:
            right = "MY_" + name.text
            self.report(problems.RESERVED, name.span, word=name.text, right=right)
        self._no_brackets(name)
        self._open("DEF", Span(word.start, name.end), None, name)

    def _open(self, word: str, span: Span, head: Argument | None, name: Token | None) -> None:
        if word == "DEF":
            if self.blocks:
                self.report(problems.DEF_NOT_TOP, span)
        else:
            self.depth += 1
            if self.depth == BLOCKS + 1:
                self.report(problems.BLOCKS_TOO_DEEP, span, limit=str(BLOCKS))
        self.blocks.append(_Block(word, span, head, name))

    def _arm(self, word: Token) -> None:
        block = self.blocks[-1] if self.blocks else None
        self.i += 1
        span, text, head = word.span, word.text, None
        following = self.tokens[self.i]
        if text == "ELSE" and following.kind is WORD and following.text == "IF":
            span, text = Span(word.start, following.end), "ELSEIF"
            self.report(problems.ELSE_IF, span)
            self.i += 1
        if text == "ELSEIF":
            try:
                head = self._head(Token(WORD, "ELSEIF", word.start, span.end))
            except Failed:
                self._skip()
            span = Span(word.start, self.tokens[self.i - 1].end)
        else:
            self._no_brackets(word)
        if block is None or block.word != "IF":
            open_if = next((each for each in self.blocks if each.word == "IF"), None)
            if block is None or open_if is None:
                self.fail(problems.NOT_OPEN, span, found=text, right="IF(DISTANCE < 10)")
            self._wrong_end(span, text, block)
            block = self._close_until("IF", span, text)
        if block.otherwise is not None:
            self.report(problems.AFTER_ELSE, span, found=text)
            block.otherwise.clear()
        else:
            block.next_arm(head, span)
            if text == "ELSE":
                block.otherwise = []

    def _end_in_two_words(self, end: Token, following: Token) -> None:
        """`END LOOP`, or `END` alone."""
        if following.kind is WORD and following.text in BLOCK_ENDS:
            right = BLOCK_ENDS[following.text]
            span = Span(end.start, following.end)
            self.report(problems.END_SPLIT, span, found=self.source[span], right=right)
            self.i += 2
        elif following.kind in (";", NEWLINE, END):
            span, right = end.span, BLOCK_ENDS[self.blocks[-1].word] if self.blocks else "ENDIF"
            self.report(problems.END_ALONE, span, right=right)
            self.i += 1
            if not self.blocks:
                return
        else:
            return self._command(end)
        self._end(right, span)

    def _end(self, end: str, span: Span) -> None:
        word = next(word for word, its_end in BLOCK_ENDS.items() if its_end == end)
        if not any(block.word == word for block in self.blocks):
            example = {"IF": "IF(DISTANCE < 10)", "LOOP": "LOOP(3)", "DEF": "DEF DANCE"}
            self.report(problems.NOT_OPEN, span, found=end,
                        right=example.get(word, "WHILE(DISTANCE > 10)"))  # fmt: skip
            return
        if self.blocks[-1].word != word:
            self._wrong_end(span, end, self.blocks[-1])
        self._close_until(word, span, end)
        self._close(span)

    def _wrong_end(self, span: Span, found: str, block: _Block) -> None:
        line = self.source.position(block.span.start)[0]
        self.report(problems.WRONG_END, span, found=found, word=block.word, line=str(line),
                    right=BLOCK_ENDS[block.word])  # fmt: skip

    def _close_until(self, word: str, span: Span, found: str) -> _Block:
        """Close blocks until one of `word` is the innermost."""
        while self.blocks[-1].word != word:
            self._close(span)
        return self.blocks[-1]

    def _close(self, end: Span) -> None:
        block = self.blocks.pop()
        span = Span(block.span.start, end.end)
        too_deep = self.depth > BLOCKS
        if block.word == "DEF":
            if block.name is not None and not self.blocks:
                name = block.name
                self._add(Def(name.text, name.span, tuple(block.body), span))
            return
        self.depth -= 1
        if too_deep:
            return
        if block.word == "IF":
            if block.otherwise is None:
                block.next_arm(None, block.span)
            self._add(If(tuple(block.arms), tuple(block.otherwise or ()), span))
        elif block.word == "LOOP":
            count = block.head
            if count is not None and count.expression[0].op == "FOREVER":
                count = None
            self._add(Loop(count, tuple(block.body), span))
        else:
            self._add(While(block.head, tuple(block.body), span))


def _short(text: str) -> str:
    """Return text that fits into a message."""
    text = " ".join(text.split())
    return text if len(text) <= 40 else text[:37] + "..."
