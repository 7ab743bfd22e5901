"""Recovery where an instruction is expected, or where one must end.

Knows what people write there, how to report it and where to go on. `suggestions` knows what they
meant; methods that go on with a rule of the grammar get the parser.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn

from tiniscript.diagnostics import codes
from tiniscript.kit import Kit
from tiniscript.source import Span
from tiniscript.syntax.ast import Assign, Command
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.blocks import Block, Blocks
from tiniscript.syntax.call_suggestions import (
    actuator_word,
    call_in,
    glued_call,
    starts_value,
    written,
)
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.foreign import foreign_word, forever_alone
from tiniscript.syntax.lexer import NUMBER, ODD, QUOTES, WORD, Token
from tiniscript.syntax.operators import COMPARISONS, SIGNS
from tiniscript.syntax.reporter import Failed, Reporter, Resumed
from tiniscript.syntax.setup_recovery import SetupRecovery
from tiniscript.syntax.suggestions import (
    AFTER_HEADER,
    BEFORE_CALL,
    BEFORE_NAME,
    BEFORE_NOTE,
    BETWEEN,
    COUNTING,
    body_begins,
    foreign_block,
    head_in,
    inside,
    is_assignment,
    is_counting,
    shortened,
    spaced_name,
    update,
)
from tiniscript.words import WORDS, Word, meant_by, other_name

if TYPE_CHECKING:
    from tiniscript.syntax.parser import Parser

_TIMED = ("move", "wait")


class Recovery:
    def __init__(self, cursor: Cursor, reporter: Reporter, blocks: Blocks, kit: Kit | None) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.blocks = blocks
        self.kit = kit
        self.setup = SetupRecovery(cursor, reporter)
        self.in_block = BlockRecovery(cursor, reporter, blocks, kit)

    # -- what is no instruction ---------------------------------------------------------------

    def no_word(self, token: Token) -> None:
        """An instruction begins with a sign or a number."""
        cursor = self.cursor
        cursor.i += 1
        if token.kind == "}":
            self.in_block.close_brace(token)
        if token.kind in ("{", "}"):
            return
        if token.kind is ODD:
            raise Failed
        if token.kind == "-" and cursor.token.kind == "-":
            self._other_note(token.start, "--", cursor.token.end)
        if token.kind is NUMBER:
            self._line_number(token)
        code = codes.EXTRA_CLOSE if token.kind == ")" else codes.NOT_AN_INSTRUCTION
        self.reporter.fail(code, token.span, found=token.text, fix="")

    def _line_number(self, number: Token) -> None:
        """`1. F(2, 80)`, `2) S`: go on with what stands behind the number."""
        cursor = self.cursor
        sign = cursor.token
        if sign.kind in (")", "-") or (sign.kind is ODD and sign.text in (":", ".", "°", "º")):
            cursor.i += 1
        if cursor.token.kind is WORD and cursor.line_of(cursor.token) == cursor.line_of(number):
            self.reporter.answer(number)
            self.reporter.answer(sign)
            span = Span(number.start, cursor.last.end)
            found = cursor.source[span]
            self.reporter.report(codes.LINE_NUMBER, span, found=found)
            raise Resumed

    def no_command(self, parser: Parser, word: Token, role: str) -> NoReturn:
        """A word of the language that is no command begins an instruction."""
        if role == "setup":
            self.setup.in_the_middle(parser, word)
        if role == "until":
            self._until_after_its_move(parser, word)
        if role == "forever":
            self.reporter.report(codes.FOREVER_NOT_HERE, word.span)
            forever_alone(parser, word)
        if role == "later":
            self.reporter.fail(codes.LATER_WORD, word.span, word=word.text)
        self._not_an_instruction(word)

    def _not_an_instruction(self, first: Token) -> NoReturn:
        """`DISTANCE < 10` alone: suggest the question."""
        tokens, start = self.cursor.tokens, self.cursor.i
        tokens = tokens[start : body_begins(tokens, start, names_end=False)]
        asks = any(token.kind in COMPARISONS or token.text == "NOT" for token in tokens)
        sign = next((token for token in tokens if token.kind in SIGNS), first)
        place = sign if asks else first
        fix = head_in(WORDS["IF"], tokens) if asks else ""
        self.reporter.fail(codes.NOT_AN_INSTRUCTION, place.span, found=place.text, fix=fix)

    def _other_note(self, start: int, sign: str, text_start: int) -> NoReturn:
        """`-- go` or `REM go`: the rest of the line is a note."""
        cursor = self.cursor
        cursor.skip_line()
        span = Span(start, cursor.token.start)
        note = "// " + cursor.source[Span(text_start, span.end)].strip()[:40]
        self.reporter.fail(codes.OTHER_NOTE, span, found=sign, right=note)

    # -- UNTIL --------------------------------------------------------------------------------

    def is_taken_for_until(self, word: Token) -> bool:
        """Whether `F(2, 80), UNTIL(c)` or `F(2, 80) HASTA(c)` is meant; then go to that word."""
        cursor = self.cursor
        token, following = cursor.token, cursor.following
        if token.kind == ",":
            if following.kind is not WORD or following.text != "UNTIL":
                return False
            cursor.i += 1
            self._until_alone(following, cursor.source[Span(word.start, token.start)])
            return True
        if token.kind is not WORD or meant_by(token.text) != "UNTIL":
            return False
        if not starts_value(following):
            return False
        fix = head_in(WORDS["UNTIL"], inside(cursor.tokens, cursor.i + 1))
        self.reporter.report(
            codes.OTHER_LANGUAGE, token.span, found=token.text, right="UNTIL", fix=fix
        )
        return True

    def _until_after_its_move(self, parser: Parser, word: Token) -> NoReturn:
        """`F(2, 80);UNTIL(c)`: the move has its UNTIL, only not where it belongs."""
        here = self.blocks.here
        last = here[-1] if here else None
        known = WORDS.get(last.word) if isinstance(last, Command) else None
        if not isinstance(last, Command) or known is None or known.role not in _TIMED or last.until:
            self.reporter.fail(codes.UNTIL_ALONE, word.span, fix="")
        self._until_alone(word, self.cursor.source[last.span])
        self.cursor.i += 1
        here[-1] = last._replace(until=parser.argument_of(word, is_reported=True))
        raise Failed

    def _until_alone(self, until: Token, before: str) -> None:
        values = inside(self.cursor.tokens, self.cursor.i + 1)
        fix = f"{before} {head_in(WORDS['UNTIL'], values)}" if before else ""
        self.reporter.report(codes.UNTIL_ALONE, until.span, fix=fix)

    # -- a command without brackets -----------------------------------------------------------

    def no_bracket(self, word: Token, known: Word) -> NoReturn:
        """`F 2 80`: suggest the same with brackets and commas."""
        cursor = self.cursor
        start = cursor.i
        first = cursor.source.text[cursor.token.start : cursor.token.start + 1]
        if first in tuple(QUOTES):
            raise Failed
        cursor.i = body_begins(cursor.tokens, start, names_end=False)
        rest = cursor.tokens[start : cursor.i]
        if not rest and cursor.token.kind == "{":
            self._braces_for_brackets(word, known)
        span = Span(word.start, rest[-1].end if rest else word.end)
        fix = call_in(known, rest)
        self.reporter.report(codes.MISSING_OPEN, span, word=word.text, fix=fix)
        if cursor.token.kind is WORD and cursor.token.text != "UNTIL":
            self.in_block.go_on()
        raise Failed

    def _braces_for_brackets(self, word: Token, known: Word) -> NoReturn:
        """`F{2, 80}`."""
        cursor = self.cursor
        start = cursor.i + 1
        self.reporter.answer(cursor.token)
        while cursor.token.kind not in ("}", *AT_END):
            cursor.i += 1
        fix = call_in(known, cursor.tokens[start : cursor.i])
        self.reporter.fail(codes.MISSING_OPEN, word.span, word=word.text, fix=fix)

    # -- what begins with a name --------------------------------------------------------------

    def reserved_name(self, name: Token) -> None:
        """`S = 5`; but `F = 2, 80` is F without brackets."""
        cursor = self.cursor
        word, start = WORDS[name.text], cursor.i + 2
        end = body_begins(cursor.tokens, start, names_end=False)
        rest = cursor.tokens[start:end]
        if len(word.arguments) > 1 and any(token.kind == "," for token in rest):
            span = Span(name.start, rest[-1].end)
            cursor.i = end
            fix = call_in(word, rest)
            self.reporter.fail(codes.MISSING_OPEN, span, word=name.text, fix=fix)
        self.reporter.reserved_words.add(name.text)
        right = other_name(name.text)
        self.reporter.report(codes.RESERVED, name.span, word=name.text, right=right)

    def unread_assignment(self, name: Token) -> None:
        """Remember that a variable is set here, to a value that cannot be read."""
        if name.text not in WORDS:
            self.blocks.here.append(Assign(name.text, name.span, None, name.span))

    def unknown_word(self, parser: Parser, word: Token, following: Token) -> None:
        """Report what no name of a program can be; a name alone may be one of its DEFs."""
        kind = following.kind
        is_alone = kind in AT_END
        if kind == "|":
            self.reporter.fail(codes.SETUP_TWICE, word.span, found=word.text)
        if word.text in COUNTING and is_counting(self.cursor.tokens, self.cursor.i + 1):
            foreign_word(parser, word, "LOOP")
        if not is_alone and kind != "(":
            self._what_follows_a_name(word, following)
        if self.kit is not None or (word.text == "END" and is_alone):
            meant = foreign_block(word.text)
            if meant is not None and not self.in_block.is_name(word.text):
                foreign_word(parser, word, meant)
        if self.kit is not None:
            if kind is NUMBER or kind is WORD:
                self._actuator_without_brackets(word, self.kit)
            if kind is WORD and following.text != "UNTIL":
                if not self.in_block.is_name(word.text):
                    self._two_words(word, following)

    def _what_follows_a_name(self, word: Token, following: Token) -> None:
        cursor, kind = self.cursor, following.kind
        changed = update(word, cursor.tokens, cursor.i + 1)
        if changed is not None:
            fix, found = changed
            self.reporter.answer(following)
            self.unread_assignment(word)
            self.reporter.fail(codes.OTHER_ASSIGNMENT, word.span, found=found, fix=fix)
        if kind is WORD:
            self._word_before(word, following)
        if word.text in BEFORE_NOTE and (kind is WORD or kind is ODD):
            self._other_note(word.start, word.text, word.end)
        if kind in SIGNS:
            self._not_an_instruction(word)
        if kind is NUMBER or kind == ",":
            self._values_without_brackets(word, following)

    def _word_before(self, word: Token, following: Token) -> None:
        """`LET X = 5`, `CALL DANCE`, `MY SPEED = 5`: go on with what is right."""
        cursor, start = self.cursor, self.cursor.i
        fix = ""
        name = spaced_name(cursor.tokens, start)
        if name is not None and word.text not in BEFORE_NAME:
            text, end = name
            span = Span(word.start, cursor.tokens[end - 1].end)
            self.reporter.report(codes.NAME_WITH_SPACE, span, found=cursor.source[span], right=text)
            self.unread_assignment(Token(WORD, text, *span))
            raise Failed
        if word.text in BEFORE_NAME and is_assignment(cursor.tokens, start + 1):
            end = body_begins(cursor.tokens, start + 3, names_end=False)
            value = written(cursor.tokens[start + 3 : min(end, start + 40)])
            fix = f"{following.text} = {value}"
        elif word.text in BEFORE_CALL:
            fix = following.text
        if fix:
            self.reporter.report(codes.EXTRA_WORD, word.span, found=word.text, fix=fix)
            cursor.i += 1
            raise Resumed

    def _values_without_brackets(self, word: Token, following: Token) -> None:
        """`F2, 80`, `FORWARD 2 80`, `SPEED 50`."""
        cursor, start = self.cursor, self.cursor.i + 1
        end = body_begins(cursor.tokens, start, names_end=False)
        rest = cursor.tokens[start:end]
        is_new = meant_by(word.text) is None and not self.in_block.is_name(word.text)
        if is_new and len(rest) == 1 and glued_call(word.text) is None:
            span = Span(word.start, following.end)
            fix = f"{word.text} = {following.text}"
            self.reporter.report(codes.MISSING_EQUALS, span, fix=fix)
            self.unread_assignment(word)
            raise Failed
        span = Span(word.start, rest[-1].end)
        glued = glued_call(word.text, rest)
        if glued is not None:
            cursor.i = end
            name = glued.partition("(")[0]
            self.reporter.fail(codes.MISSING_OPEN, span, word=name, fix=glued)
        meant = WORDS.get(meant_by(word.text) or "")
        if meant is not None and following.kind is NUMBER and meant.role in (*_TIMED, "show"):
            cursor.i = end
            self._say_in_other_words(word.span, word.text, meant, rest)

    def _actuator_without_brackets(self, word: Token, kit: Kit) -> None:
        """`LED ON`, `GRIPPER 90`."""
        device = next((each for each in kit.actuators if each.name == word.text), None)
        if device is not None:
            self.cursor.i += 1
            self.no_bracket(word, actuator_word(device))

    def _two_words(self, word: Token, following: Token) -> None:
        """`TURN LEFT`; and of `hello world` only the first word is a mistake."""
        tokens, start = self.cursor.tokens, self.cursor.i + 2
        meant = WORDS.get(meant_by(f"{word.text}_{following.text}") or "")
        if meant is not None and meant.role != "block":
            span = Span(word.start, following.end)
            rest = tokens[start : body_begins(tokens, start, names_end=False)]
            self._say_in_other_words(span, self.cursor.source[span], meant, rest)
        after = tokens[start].kind
        if following.text not in WORDS and (after in AT_END or after is WORD):
            self.blocks.here.append(Command(word.text, word.span, None, None, word.span))
            self.cursor.i += 1
            raise Failed

    def _say_in_other_words(
        self, span: Span, found: str, meant: Word, values: list[Token]
    ) -> NoReturn:
        fix = call_in(meant, values) if meant.arguments else meant.text
        self.reporter.fail(codes.OTHER_LANGUAGE, span, found=found, right=meant.text, fix=fix)

    # -- where an instruction must end --------------------------------------------------------

    def no_separator(self, first: Token) -> None:
        """Report what stands where an instruction must end, and go on after it if that helps."""
        cursor, fail = self.cursor, self.reporter.fail
        token, before, after = cursor.token, cursor.last, cursor.following
        kind, text = token.kind, token.text
        if kind in ("{", "}"):
            return
        block = self.blocks.innermost
        header = block if block is not None and block.span.end == before.end else None
        is_colon = kind is ODD and text == ":" and header is not None
        if is_colon or ((kind == "," or text in (".", ":")) and after.kind is WORD):
            if header is None or not header.is_reported:
                self._separator_missing(first, token, before, header)
            self.reporter.answer(token)
            cursor.i += 1
            raise Resumed
        if kind is ODD:
            raise Failed
        if kind == ")":
            cursor.i += 1
            fail(codes.EXTRA_CLOSE, token.span, found=")")
        if kind == "|":
            self.setup.bar_between(first, token)
        if kind == "-" and after.kind == "-" and after.start == token.end:
            self._other_note(token.start, "--", after.end)
        if header is not None and first.text in WORDS and WORDS[first.text].arguments:
            if kind in SIGNS or text in ("AND", "OR"):
                self._question_goes_on(first, header)
        if kind in SIGNS:
            fail(codes.NOT_AN_INSTRUCTION, token.span, found=text, fix="")
        if kind == "," and before.kind is NUMBER and after.kind is NUMBER:
            whole = cursor.source[Span(first.start, before.end)]
            fix = f"{whole}.{after.text}"
            fail(codes.DECIMAL_COMMA, Span(before.start, after.end), fix=fix)
        if kind is WORD and text in (BETWEEN if header is None else AFTER_HEADER):
            if header is not None or (after.kind is WORD and not self.in_block.is_name(text)):
                self.reporter.report(codes.EXTRA_WORD, token.span, found=text, fix="")
                cursor.i += 1
                self.in_block.go_on()
        self._separator_missing(first, token, before, header)
        if kind is not WORD:
            raise Failed

    def _separator_missing(
        self, first: Token, token: Token, before: Token, header: Block | None
    ) -> None:
        line = self.cursor.line_of(token)
        if header is not None:
            header.is_reported = True
        if line != self.reporter.crowded_line:
            self.reporter.crowded_line = line
            code = codes.MISSING_SEPARATOR if header is None else codes.HEADER_SEPARATOR
            shown = shortened(self.cursor.source.text[first.start : before.end])
            self.reporter.report(code, token.span, found=token.text, before=shown)

    def _question_goes_on(self, first: Token, header: Block) -> NoReturn:
        """`IF (A) AND (B)`: the brackets go around the whole question."""
        cursor = self.cursor
        start = cursor.i
        while cursor.tokens[start] is not first:
            start -= 1
        cursor.i = body_begins(cursor.tokens, cursor.i)
        fix = head_in(WORDS[first.text], cursor.tokens[start + 1 : cursor.i])
        header.is_reported = True
        span = cursor.span_from(first)
        self.reporter.report(codes.MISSING_OPEN, span, word=first.text, fix=fix)
        self.in_block.go_on()
