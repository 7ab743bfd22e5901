"""The grammar: tokens become an AST.

    program     = [ ("SI" | "SB") "|" ] { [ instruction ] separator }
                | "PING" "|" "CHECK_CONNECTION"
    separator   = ";" | end of line
    instruction = assignment | command | "BREAK" | definition | "TASK" | header | arm | block end
    assignment  = NAME "=" expression
    command     = (WORD | NAME) [ arguments ] [ until ]
    until       = "UNTIL" "(" argument ")"
    definition  = "DEF" NAME [ "(" [ NAME { "," NAME } ] ")" ]
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
command takes or which types fit: the checker does. If a rule cannot continue, it reports what it
expected, and parsing resumes at the next instruction. `recovery` finds out what was meant.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from tiniscript.base.source import Edit, Source, Span
from tiniscript.base.words import BLOCK_ENDS, WORDS, Word
from tiniscript.diagnostics import codes
from tiniscript.syntax.ast import Argument, Assign, Break, Command, Parameter, Program
from tiniscript.syntax.blocks import HEADERS, WORD_OF_END, Blocks
from tiniscript.syntax.cursor import INSTRUCTION_ENDS, Cursor
from tiniscript.syntax.expressions import ExpressionParser
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, WORD, Scan, Token, scan
from tiniscript.syntax.operators import ARITHMETIC_SIGNS
from tiniscript.syntax.reporter import Failed, Reporter

# Messages about a word of the language that is not a command, by its role.
_NO_COMMANDS = {"until": codes.UNTIL_ALONE, "forever": codes.FOREVER_NOT_HERE,
                "later": codes.LATER_WORD, "setup": codes.SETUP_TWICE}  # fmt: skip


class ParsedText(NamedTuple):
    program: Program
    scan: Scan
    diagnostics: list[codes.Diagnostic]


def parse(source: Source) -> ParsedText:
    """Return the AST of a program, with all mistakes of its syntax."""
    scan_result = scan(source.text)
    parser = Parser(source, scan_result)
    program = parser.program()
    return ParsedText(program, scan_result, parser.reporter.diagnostics)


class Parser:
    def __init__(self, source: Source, scan: Scan) -> None:
        self.cursor = Cursor(source, scan.tokens)
        self.reporter = Reporter(scan.diagnostics)
        self.blocks = Blocks(self.reporter)
        self.expressions = ExpressionParser(self.cursor, self.reporter)
        self.variables: set[str] = set()  # variables assigned so far
        self.defs: set[str] = set()  # the names of the DEFs that have begun
        # The diagnostics of ends, and the number of open blocks: outer ends precede inner ones.
        self.early_ends: list[tuple[int, int]] = []

    # -- the program ------------------------------------------------------------------------

    def program(self) -> Program:
        cursor, diagnostics = self.cursor, self.reporter.diagnostics
        tokens = cursor.tokens
        start = self.setup()
        while (kind := tokens[cursor.i].kind) is not END and len(
            diagnostics
        ) <= codes.MAX_DIAGNOSTICS:
            if kind is NEWLINE or kind == ";":
                cursor.i += 1
                continue
            try:
                self.instruction()
            except Failed:
                cursor.skip_instruction()
        while self.blocks.open_blocks:  # blocks without an end
            block = self.blocks.open_blocks[-1]
            end_word = BLOCK_ENDS[block.word]
            self.reporter.report(codes.NEVER_ENDS, block.header, word=block.word, right=end_word)
            self.blocks.end(cursor.last_token.span)
        return Program(start, tuple(self.blocks.program))

    def setup(self) -> str:
        cursor = self.cursor
        cursor.skip_newlines()
        word, bar = cursor.current_token, cursor.following_token
        if bar.kind != "|":
            return "SI"
        cursor.i += 2
        if word.text == "PING":
            token, *rest = cursor.tokens[cursor.i :]
            if token.text != "CHECK_CONNECTION" or any(
                token.kind not in INSTRUCTION_ENDS for token in rest
            ):
                self.reporter.report(codes.PING_ALONE, word.span)
            cursor.i = len(cursor.tokens) - 1
        elif word.text not in ("SI", "SB"):
            self.reporter.report(codes.SETUP_UNKNOWN, word.span, found=word.text, right="SI|")
            return "SI"
        return word.text

    def instruction(self) -> None:
        cursor = self.cursor
        tokens = cursor.tokens
        token = tokens[cursor.i]
        if token.kind is not WORD:
            self.expressions.reject_unknown_character(token)
            code = codes.EXTRA_CLOSE if token.kind == ")" else codes.NOT_AN_INSTRUCTION
            self.reporter.fail(code, token.span, found=token.text)
        following_token = tokens[cursor.i + 1]
        text = token.text
        if following_token.kind == "|" and text in ("SI", "SB"):
            self.reporter.report(codes.SETUP_TWICE, token.span, word=text, found=text)
            cursor.i += 2
            return
        if following_token.kind == "=":
            self.assignment(token)
        else:
            _RULES.get(text, Parser.command)(self, token)
        if tokens[cursor.i].kind not in INSTRUCTION_ENDS:
            self.report_missing_separator(token)

    # -- simple instructions ----------------------------------------------------------------

    def assignment(self, name: Token) -> None:
        if name.text in WORDS:
            self.reporter.fail(codes.RESERVED, name.span, word=name.text)
        self.cursor.i += 2
        self.variables.add(name.text)
        try:
            value = self.expressions.expression(is_in_brackets=False)
        except Failed:  # the name has a value, whichever
            self.blocks.current_body.append(Assign(name.text, name.span, None, name.span))
            raise
        span = Span(name.start, value.span.end)
        self.blocks.current_body.append(Assign(name.text, name.span, value, span))

    def command(self, word: Token) -> None:
        cursor = self.cursor
        tokens = cursor.tokens
        word_row = WORDS.get(word.text)
        following_token = tokens[cursor.i + 1]
        if word_row is None:
            self.own_name(word, following_token)
        elif not word_row.role.is_instruction and word.text != "START":
            code = _NO_COMMANDS.get(word_row.role.name, codes.NOT_AN_INSTRUCTION)
            self.reporter.fail(code, word.span, word=word.text, found=word.text)
        cursor.i += 1
        arguments = until = None
        if following_token.kind == "(":
            arguments = self.arguments_of(word, word_row)
        elif word_row is not None and word_row.arguments:
            self.report_missing_bracket(word_row)
        if tokens[cursor.i].kind not in INSTRUCTION_ENDS:
            until = self.until()
        span = cursor.span_from(word)
        self.blocks.current_body.append(Command(word.text, word.span, arguments, until, span))

    def leave(self, word: Token) -> None:
        self.cursor.i += 1
        self.reject_arguments(word)
        self.blocks.current_body.append(Break(word.span))

    def own_name(self, word: Token, following_token: Token) -> None:
        """A word that may be the name of a device or a DEF of the program, if no other follows
        it."""
        if following_token.kind == "(" or following_token.kind in INSTRUCTION_ENDS:
            return
        if word.text in self.variables and following_token.kind in ARITHMETIC_SIGNS:
            span = self.expressions.expression(is_in_brackets=False).span
            fix = f"{word.text} = {word.text}{self.cursor.source[Span(word.end, span.end)]}"
            self.reporter.fail(codes.VARIABLE_ALONE, span, name=word.text, fix=fix)
        self.reporter.fail(codes.UNKNOWN_WORD, word.span, found=word.text)

    def arguments_of(self, word: Token, word_row: Word | None) -> tuple[Argument, ...] | None:
        if word_row is not None and not word_row.arguments:
            self.reject_arguments(word)
        arguments = self.expressions.arguments()
        if word.text in self.defs:
            self.reject_units_in_call(arguments, word)
        else:
            self.reject_units(arguments[word_row is not None and word_row.role.is_move :])
        return arguments

    def until(self) -> Argument | None:
        token = self.cursor.current_token
        if token.kind is not WORD or token.text != "UNTIL":
            return None
        self.cursor.i += 1
        return self.argument_of(token)

    # -- blocks -----------------------------------------------------------------------------

    def header(self, word: Token) -> None:
        """Open the block even if its header is wrong, so that its end is not a second mistake."""
        cursor = self.cursor
        cursor.i += 1
        tokens, argument = cursor.tokens, None
        try:
            if word.text == "LOOP" and tokens[min(cursor.i + 2, len(tokens) - 1)].kind == "=":
                self.reporter.fail(codes.LOOP_COUNTS, tokens[cursor.i + 1].span)
            argument = self.argument_of(word)
        finally:
            self.blocks.begin(word.text, cursor.span_from(word), argument)

    def definition(self, word: Token) -> None:
        cursor = self.cursor
        cursor.i += 1
        name = cursor.current_token
        if name.kind is not WORD:
            self.blocks.begin("DEF", word.span)
            self.reporter.fail(codes.DEF_NEEDS_NAME, word.span)
        cursor.i += 1
        parameters: list[Parameter] = []
        try:
            if name.text in WORDS:
                report = self.reporter.report if cursor.has_names() else self.reporter.fail
                report(codes.RESERVED, name.span, word=name.text)
            else:
                self.defs.add(name.text)
            if cursor.current_token.kind == "(":
                self.parameters(name, parameters)
        finally:
            span = Span(word.start, name.end)
            self.blocks.begin("DEF", span, name=name, parameters=parameters)

    def parameters(self, def_word: Token, parameters: list[Parameter]) -> None:
        """Read the `(NAME, NAME)` of a DEF; what was read stays, even if the rest is wrong."""
        cursor = self.cursor
        bracket = cursor.i
        cursor.i += 1
        if cursor.take_inner(")"):
            return
        extra_token = None
        while True:
            name = cursor.peek_inner()
            if name.kind is not WORD:
                from tiniscript.syntax.unnamed import hints_of_use  # only wrong programs need this

                hints = hints_of_use(cursor.source, name) if name.kind is NUMBER else {}
                self.reporter.fail(
                    codes.PARAMETER_NEEDS_NAME, name.span, name=def_word.text, **hints
                )
            cursor.take_inner(WORD)
            if name.text in WORDS:
                self.reporter.report(codes.RESERVED, name.span, word=name.text)
            parameters.append(Parameter(name.text, name.span))
            odd_token = self.expressions.skip_after_name()
            extra_token = extra_token or odd_token
            if not cursor.take_inner(",") and (odd_token is None or odd_token.kind is not WORD):
                break
        if not cursor.take_inner(")"):
            self.expressions.report_missing_close(bracket)
        if extra_token is not None:
            self.expressions.report_not_only_names(
                bracket, extra_token, [parameter.name for parameter in parameters]
            )

    def task(self, word: Token) -> None:
        cursor = self.cursor
        cursor.i += 1
        self.reject_arguments(word)
        name = cursor.current_token
        while cursor.current_token.kind in (WORD, NUMBER):
            cursor.i += 1
        if cursor.current_token is not name:
            span = cursor.span_from(name)
            self.reporter.report(codes.TASK_HAS_NAME, span, found=cursor.source[span])
        self.blocks.begin("TASK", word.span)

    def arm(self, word: Token) -> None:
        block = self.blocks.innermost_block
        self.cursor.i += 1
        argument = None
        try:
            if word.text == "ELSEIF":
                argument = self.argument_of(word)
            else:
                self.reject_arguments(word)
        finally:
            span = self.cursor.span_from(word)
            if block is None or block.word != "IF":
                self.reporter.report(codes.NOT_OPEN, span, found=word.text, right="IF")
                self.early_ends = []
            elif block.else_body is not None:
                self.reporter.report(codes.AFTER_ELSE, span, found=word.text)
                block.else_body.clear()
            else:
                block.next_arm(argument, span)
                block.else_body = [] if word.text == "ELSE" else None

    def block_end(self, word: Token) -> None:
        self.cursor.i += 1
        self.reject_arguments(word)
        self.close(word)

    def close(self, word: Token) -> None:
        """End the block that a word ends, and those that are still open in it."""
        blocks, begin_word = self.blocks, WORD_OF_END[word.text]
        if not any(block.word == begin_word for block in blocks.open_blocks):
            if self.merge_swapped_ends(word):
                return
            hints = {}
            if blocks.open_blocks:  # the word may end the open block
                inner = blocks.open_blocks[-1]
                line = str(self.cursor.source.position(inner.header.start)[0])
                hints = {"around": inner.word, "line": line, "ends": BLOCK_ENDS[inner.word]}
            self.reporter.report(
                codes.NOT_OPEN, word.span, found=word.text, right=begin_word, **hints
            )
            return
        inner_index = max(
            k for k, block in enumerate(blocks.open_blocks) if block.word == begin_word
        )
        while (block := blocks.open_blocks[-1]).word != begin_word:
            line = str(self.cursor.source.position(block.header.start)[0])
            end_word = BLOCK_ENDS[block.word]
            values = {"found": word.text, "word": block.word, "line": line, "right": end_word}
            last_instruction = (
                block.current_body[-1]
                if len(block.current_body) > 1 and block.word != "LOOP"
                else None
            )
            if last_instruction and not isinstance(
                last_instruction, Break
            ):  # nothing may follow it
                values["several"] = self.cursor.source[last_instruction.span]
            self.early_ends.append((len(self.reporter.diagnostics), inner_index))
            self.reporter.report(codes.WRONG_END, word.span, **values)
            blocks.end(word.span)
        blocks.end(word.span)

    def merge_swapped_ends(self, late_end: Token) -> bool:
        """Return whether an end belongs to a block that another end closed, so that the two are
        swapped.
        """
        diagnostics, depth = self.reporter.diagnostics, len(self.blocks.open_blocks)
        ends_with_depth = (
            each_entry
            for each_entry in self.early_ends
            if WORD_OF_END[diagnostics[each_entry[0]].values["right"]] == WORD_OF_END[late_end.text]
        )
        entry = next((each_entry for each_entry in ends_with_depth if each_entry[1] == depth), None)
        if entry is None:
            return False
        self.early_ends.remove(entry)
        k, early_end = entry[0], diagnostics[entry[0]]
        edits = (
            Edit(early_end.span, late_end.text),
            Edit(late_end.span, early_end.values["found"]),
        )
        values = {**early_end.values, "swapped": late_end.text, "apart": late_end.text}
        diagnostics[k] = early_end._replace(values=values, repair=codes.Repair(edits, False))
        return True

    def argument_of(self, word: Token) -> Argument:
        """Read the `(argument)` of a header, an ELSEIF or an UNTIL."""
        cursor, word_row = self.cursor, WORDS[word.text]
        bracket = cursor.current_token
        if bracket.kind != "(":
            self.report_missing_bracket(word_row)
        arguments = self.expressions.arguments()
        if len(arguments) != 1:
            self.expressions.report_wrong_count(word_row, len(arguments), cursor.span_from(bracket))
        self.reject_units(arguments)
        return arguments[0]

    def reject_units(self, arguments: Sequence[Argument]) -> None:
        """CM and DEG are allowed only after the distance of a move."""
        for unit in (argument.unit for argument in arguments if argument.unit is not None):
            self.expressions.report_wrong_unit(unit.op, Span(unit.start, unit.end))

    def reject_units_in_call(self, arguments: Sequence[Argument], word: Token) -> None:
        """The unit of a DEF's value belongs in its body."""
        texts = (self.cursor.source[argument.span] for argument in arguments)
        fix = f"{word.text}({', '.join(texts)})"
        for unit in (argument.unit for argument in arguments if argument.unit is not None):
            self.reporter.report(codes.UNIT_IN_CALL, Span(unit.start, unit.end),
                                 name=word.text, found=unit.op, right=fix)  # fmt: skip

    def reject_arguments(self, word: Token) -> None:
        bracket = self.cursor.current_token
        if bracket.kind == "(":
            self.reporter.fail(
                codes.NO_BRACKETS_HERE, bracket.span, word=word.text, right=word.text
            )

    # -- what is wrong ------------------------------------------------------------------------

    def report_missing_bracket(self, word_row: Word) -> None:
        """After a word its values are expected, in brackets."""
        token = self.cursor.current_token
        self.expressions.reject_unknown_character(token)
        word = self.cursor.last_token
        self.reporter.fail(codes.MISSING_OPEN, word.span, word=word_row.text, usage=word_row.usage)

    def report_missing_separator(self, first: Token) -> None:
        """The end of an instruction is expected."""
        cursor = self.cursor
        token = cursor.current_token
        self.expressions.reject_unknown_character(token)
        if token.kind == ")":
            self.reporter.fail(codes.EXTRA_CLOSE, token.span)
        self.expressions.reject_unit(token)
        is_header = first.text in (*HEADERS, "DEF", "ELSE", "ELSEIF")
        code = codes.HEADER_SEPARATOR if is_header else codes.MISSING_SEPARATOR
        text_before = " ".join(cursor.source[cursor.span_from(first)].split())
        self.reporter.fail(code, token.span, before=text_before)


# The rule of an instruction, by its first word; of all others it is `command`. A parser made
# of this one changes what a rule calls, and no rule.
_RULES: dict[str, Callable[[Parser, Token], None]] = {
    **dict.fromkeys(HEADERS, Parser.header),
    **dict.fromkeys(WORD_OF_END, Parser.block_end),
    "DEF": Parser.definition,
    "TASK": Parser.task,
    "BREAK": Parser.leave,
    "ELSE": Parser.arm,
    "ELSEIF": Parser.arm,
}
