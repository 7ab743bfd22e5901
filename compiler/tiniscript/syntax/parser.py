"""The grammar: tokens become an AST.

    program     = [ ("SI" | "SB") "|" ] { [ instruction ] separator }
                | "PING" "|" "CHECK_CONNECTION"
    separator   = ";" | end of line
    instruction = assignment | command | "BREAK" | definition | "TASK" | header | arm | block end
    assignment  = NAME "=" expression
    command     = (WORD | NAME) [ arguments ] [ until ]
    until       = "UNTIL" "(" argument ")"
    definition  = "DEF" NAME
    header      = ("IF" | "LOOP" | "WHILE" | "WHEN") "(" argument ")"
    arm         = "ELSEIF" "(" argument ")" | "ELSE"
    block end   = "ENDIF" | "END_LOOP" | "END_WHILE" | "END_DEF" | "END_TASK" | "END_WHEN"
    arguments   = "(" [ argument { "," argument } ] ")"
    argument    = "FOREVER" | expression
    expression  = operand { operator operand }
    operator    = "OR" | "AND" | "=" | "<>" | "<" | "<=" | ">" | ">=" | "+" | "-" | "*" | "/" | "%"
    operand     = { "-" | "NOT" } ( NUMBER | NAME | "TRUE" | "FALSE" | "TIME"
                                  | FUNCTION arguments | "(" expression ")" )

Each rule is a method of its name: here, and from `arguments` on in `expressions`. In brackets an
end of line is white space. Headers, arms and block ends are matched on a stack (`blocks`), so that
no depth of input exhausts Python's. Does not know what a name stands for, how many arguments a
command takes or which types fit: the checker does. Where a text is wrong a rule asks `recovery`,
which reports it and repairs the tokens or raises Failed; then the next instruction is read.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

from tiniscript.diagnostics import codes
from tiniscript.kit import Kit
from tiniscript.source import Source, Span
from tiniscript.syntax.ast import Argument, Assign, Break, Command, Program
from tiniscript.syntax.blocks import ENDS, HEADERS, Blocks
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.expressions import ExpressionParser
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, ODD, WORD, Scan, Token, lexed
from tiniscript.syntax.operators import COMPARISONS
from tiniscript.syntax.reporter import Failed, Reporter, Resumed
from tiniscript.words import BLOCK_ENDS, WORDS, Word

if TYPE_CHECKING:
    from tiniscript.syntax.recovery import Recovery

ENOUGH = 100  # diagnostics after which reading on helps nobody

_BEGIN_ENDS = ("END", "FIN")  # END_JUMP, FIN
# What stands alone for the line above, or for what follows.
_AGAIN = frozenset("IDEM DITTO IGUAL SAME AGAIN NUEVAMENTE ETC ETCETERA".split())  # noqa: SIM905
_IN_TITLE = frozenset((WORD, NUMBER, ODD, NEWLINE, ",", "-"))  # behind the first word of a sentence
_AFTER_NAME = frozenset(("(", *AT_END))


class Parsed(NamedTuple):
    program: Program
    scan: Scan
    diagnostics: list[codes.Diagnostic]


def scan(text: str) -> Scan:
    """Return the tokens of `text`, its comments and what could not be read."""
    scanned = lexed(text)
    if scanned is None:
        from tiniscript.syntax.lexer_recovery import scan_with_repairs

        scanned = scan_with_repairs(text)
    return scanned


def parse(source: Source, kit: Kit | None = None) -> Parsed:
    """Return the AST of a program, with all mistakes of its syntax.

    Names of `kit` are recognized as devices. Without a kit a name may be anything.
    """
    scanned = scan(source.text)
    parser = Parser(source, scanned, kit)
    program = parser.program()
    return Parsed(program, scanned, parser.reporter.found())


class Parser:
    def __init__(self, source: Source, scanned: Scan, kit: Kit | None) -> None:
        self.cursor = Cursor(source, scanned.tokens)
        self.reporter = Reporter(scanned.diagnostics)
        self.blocks = Blocks(self.reporter)
        self.expressions = ExpressionParser(self.cursor, self.reporter, kit)
        self._kit = kit
        devices = (*kit.sensors, *kit.actuators) if kit else ()
        self._devices = frozenset(each.name for each in devices)

    @cached_property
    def recovery(self) -> Recovery:
        """The recovery of wrong texts. A correct program never loads it."""
        from tiniscript.syntax.recovery import Recovery

        constructs = self.expressions.recovery.constructs
        return Recovery(self.cursor, self.reporter, self.blocks, self._kit, constructs)

    # -- the program ------------------------------------------------------------------------

    def program(self) -> Program:
        cursor, found = self.cursor, self.reporter.diagnostics
        tokens = cursor.tokens
        start = self.setup()
        while (kind := tokens[cursor.i].kind) is not END and len(found) <= ENOUGH:
            if kind is NEWLINE or kind == ";":
                cursor.i += 1
                continue
            try:
                self.instruction()
            except Resumed:
                continue
            except Failed:
                cursor.skip_instruction()
        if self.blocks.open:
            self.recovery.in_block.never_ended()
        return Program(start, tuple(self.blocks.program))

    def setup(self) -> str:
        cursor = self.cursor
        cursor.to_inner()
        word, bar = cursor.token, cursor.following
        if self._kit and word.text not in WORDS and bar.kind in _IN_TITLE:
            self.recovery.setup.titles()
            word, bar = cursor.token, cursor.following
        if word.kind is not WORD:
            return self.recovery.setup.misread(word) if bar.kind == "|" else "SI"
        if bar.kind != "|":
            if word.text == "S" and bar.text == "I":
                self.recovery.setup.in_two(word, bar)
            return "SI"
        cursor.i += 2
        if word.text == "PING":
            self.check_connection(word)
        elif word.text not in ("SI", "SB"):
            return self.recovery.setup.unknown(word)
        return word.text

    def check_connection(self, ping: Token) -> None:
        cursor = self.cursor
        token = cursor.token
        if token.kind is WORD and token.text == "CHECK_CONNECTION":
            cursor.i += 1
            cursor.skip_separators()
            token = cursor.token
            if token.kind is END:
                return
        self.recovery.setup.not_alone(ping, token)

    def instruction(self) -> None:
        cursor = self.cursor
        tokens = cursor.tokens
        token = tokens[cursor.i]
        if token.kind is not WORD:
            return self.recovery.no_word(token)
        following = tokens[cursor.i + 1]
        text = token.text
        if following.kind == "=":
            self.assignment(token)
        elif text in HEADERS:
            self.header(token)
        elif text == "DEF":
            self.definition(token)
        elif text == "TASK":
            self.task(token)
        elif text in ("ELSE", "ELSEIF"):
            self.arm(token)
        elif text in ENDS:
            self.block_end(token)
        elif text == "BREAK":
            cursor.i += 1
            self.no_arguments(token)
            self.blocks.here.append(Break(token.span))
        elif text == "END" and following.kind is WORD and following.text in BLOCK_ENDS:
            self.recovery.in_block.end_in_two_words(token, following)
        else:
            self.command(token)
        if tokens[cursor.i].kind not in AT_END:
            self.recovery.no_separator(token)

    # -- simple instructions ----------------------------------------------------------------

    def assignment(self, name: Token) -> None:
        is_reserved = name.text in WORDS
        tokens, start = self.cursor.tokens, self.cursor.i + 2
        if tokens[start].kind is WORD and tokens[start + 1].kind == "=":
            self.recovery.of_name.of_value.one_for_all(name, start)
        if is_reserved:
            self.recovery.of_name.reserved_name(name)
        self.cursor.i, said = start, len(self.reporter.diagnostics)
        try:
            value = self.expressions.expression(in_brackets=False)
        except Failed:
            self.recovery.groups.named(name, start, said)
            self.recovery.of_name.unread_assignment(name)
            self.recovery.constructs.unread_value(name, start, said)
            raise
        if is_reserved:
            raise Failed
        span = Span(name.start, value.span.end)
        self.blocks.here.append(Assign(name.text, name.span, value, span))

    def command(self, word: Token) -> None:
        cursor = self.cursor
        tokens = cursor.tokens
        known = WORDS.get(word.text)
        following = tokens[cursor.i + 1]
        if known is None:
            if not self._is_name(word, following):
                self.recovery.of_name.unknown_word(self, word, following)
        elif not known.is_instruction and known.role != "start":
            self.recovery.no_command(self, word, known.role)
        cursor.i += 1
        arguments = until = None
        is_call = following.kind == "("
        if not is_call and following.kind is ODD:
            is_call = self.recovery.in_block.other.is_sign_before_bracket()
        if is_call:
            arguments = self.arguments_of(word, known)
        elif known is not None and known.arguments:
            self.recovery.of_name.brackets.no_bracket(word, known)
        if tokens[cursor.i].kind not in AT_END:
            until = self.until(word)
        span = cursor.span_from(word)
        self.blocks.here.append(Command(word.text, word.span, arguments, until, span))

    def _is_name(self, word: Token, following: Token) -> bool:
        """Whether a word may stand here for a device, or for a DEF of the program."""
        if following.kind not in _AFTER_NAME or word.text[:3] in _BEGIN_ENDS:
            return False
        if word.text in self._devices or word.text in self.blocks.defs:
            return True
        from tiniscript.syntax.suggestions import foreign_block  # a right program never needs it

        return foreign_block(word.text) is None and word.text not in _AGAIN

    def arguments_of(self, word: Token, known: Word | None) -> tuple[Argument, ...] | None:
        if known is not None and not known.arguments:
            self.no_arguments(word)
            return None
        arguments = self.expressions.arguments()
        meant = known or (self.recovery.meant(word) if self.reporter.diagnostics else None)
        if meant is not None and self.reporter.diagnostics:
            from tiniscript.syntax.unit_recovery import fit_units  # a right program never needs it

            fit_units(self.reporter, meant, arguments)
        if arguments or known is not None or self.recovery.of_name.is_said_elsewhere(word):
            return arguments
        span = self.cursor.span_from(word)
        self.reporter.report(codes.EMPTY_BRACKETS, span, word=word.text)
        return None

    def until(self, word: Token) -> Argument | None:
        cursor = self.cursor
        is_said_so = cursor.token.kind is WORD and cursor.token.text == "UNTIL"
        if not is_said_so and not self.recovery.of_until.is_taken_for_until(word):
            return None
        until = Token(WORD, "UNTIL", *cursor.token.span)
        cursor.i += 1
        return self.argument_of(until, is_reported=not is_said_so)

    # -- blocks -----------------------------------------------------------------------------

    def header(self, word: Token) -> None:
        """Open the block even if its header is wrong, so that its end is not a second mistake."""
        cursor = self.cursor
        if word.text == "WHEN" and cursor.following.kind is WORD:
            self.recovery.of_name.sentence.event(word)
        cursor.i += 1
        if cursor.token.kind in AT_END:
            self.recovery.in_block.other.bare_header(word)
        if (
            word.text == "LOOP"
            and cursor.tokens[min(cursor.i + 2, len(cursor.tokens) - 1)].kind == "="
        ):
            self.recovery.in_block.other.counted_loop(word)
        start, said = cursor.i, len(self.reporter.diagnostics)
        try:
            head = self.argument_of(word)
        except Resumed:
            raise  # all of it was read as another header, or as a whole line
        except Failed:
            self.recovery.groups.in_header(word, start, said)
            self.recovery.in_block.unread_header(word)
        self.blocks.begin(word.text, self.cursor.span_from(word), head)

    def definition(self, word: Token) -> None:
        cursor = self.cursor
        cursor.i += 1
        name = cursor.token
        if name.kind is not WORD:
            self.recovery.of_def.no_name(word)
        cursor.i += 1
        if name.text in WORDS:
            right = cursor.free_name(name.text)
            self.reporter.report(codes.RESERVED, name.span, word=name.text, right=right)
        if cursor.token.kind in (WORD, NUMBER, "-"):
            name = self.recovery.of_def.joined(name)
        block = self.blocks.begin("DEF", Span(word.start, name.end), name=name)
        if cursor.token.kind == "(":
            self.recovery.groups.body(block, cursor.i)
            self.recovery.groups.function_on_a_line(block)
            self.recovery.of_def.def_with_values(word, name, self.expressions.arguments())
            block.span = cursor.span_from(word)
            self.recovery.of_def.body_of_def(block)

    def task(self, word: Token) -> None:
        cursor = self.cursor
        cursor.i += 1
        self.no_arguments(word, "WHEN")
        name = cursor.token
        if name.kind is WORD:
            cursor.i += 1
            self.reporter.report(codes.TASK_HAS_NAME, name.span, found=name.text)
        self.blocks.begin("TASK", word.span)

    def arm(self, word: Token, is_reported: bool = False) -> None:
        """`is_reported`: `word` has a diagnostic already, and may lack its brackets."""
        cursor = self.cursor
        block = self.blocks.innermost
        cursor.i += 1
        if word.text == "ELSE" and cursor.token.kind is WORD and cursor.token.text == "IF":
            word, is_reported = self.recovery.in_block.else_if(word), True
        head, is_read, span = None, True, word.span
        if word.text == "ELSE":
            if cursor.token.kind == "(" and not self.recovery.groups.is_body(cursor.i):
                start = cursor.i
                self.no_arguments(word, "ELSEIF")
                if any(each.kind in COMPARISONS for each in cursor.tokens[start : cursor.i]):
                    word = Token(WORD, "ELSEIF", *word.span)  # an ELSE may follow it
        else:
            try:
                head = self.argument_of(word, is_reported)
            except Failed:
                is_read = False
            span = Span(word.start, max(word.end, cursor.last.end))
        if block is None or block.word != "IF":
            block = self.recovery.in_block.misplaced_arm(word.text, span)
        if block.otherwise is not None:
            line = str(cursor.source.position(block.span.start)[0]) if word.text == "ELSE" else ""
            self.reporter.report(codes.AFTER_ELSE, span, found=word.text, line=line)
            block.otherwise.clear()
        else:
            block.next_arm(head, span)
            if word.text == "ELSE":
                block.otherwise = []
        if not is_read:
            self.recovery.in_block.go_on()

    def block_end(self, word: Token) -> None:
        self.cursor.i += 1
        self.no_arguments(word)
        block = self.blocks.innermost
        if block is not None and block.word == ENDS[word.text]:
            self.blocks.end(word.span)
        else:
            self.recovery.in_block.wrong_end(ENDS[word.text], word)

    def argument_of(self, word: Token, is_reported: bool = False) -> Argument:
        """Read the `(argument)` of a header, an ELSEIF or an UNTIL.

        Where that fails the cursor stands where a body may begin. `is_reported`: `word` has a
        diagnostic already, so that it needs none where brackets are missing.
        """
        cursor = self.cursor
        start = cursor.i
        if cursor.token.kind != "(" and not self.recovery.in_block.other.is_sign_before_bracket():
            self.recovery.in_block.no_bracket(word, is_reported)
        try:
            arguments = self.expressions.arguments()
            if len(arguments) != 1:
                spans = [each.span for each in arguments]
                span = cursor.span_from(cursor.tokens[start])
                self.expressions.recovery.wrong_count(WORDS[word.text], spans, span)
        except Failed:
            self.recovery.in_block.to_body(start)
            raise
        return arguments[0]

    def no_arguments(self, word: Token, other: str = "") -> None:
        """Go past brackets after a word that takes none. `other` is one that does."""
        if self.cursor.token.kind == "(":
            bracket = self.cursor.token
            self.recovery.in_block.needless_brackets(
                word, bracket, self.expressions.arguments(), other
            )
