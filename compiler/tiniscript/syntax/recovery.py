"""Recovery where an instruction is expected, or where one must end.

Knows what people write there, how to report it and where to go on. `suggestions` knows what they
meant; methods that go on with a rule of the grammar get the parser.
"""

from __future__ import annotations

from typing import NoReturn

from tiniscript.diagnostics import codes
from tiniscript.kit import Kit
from tiniscript.source import Span
from tiniscript.syntax.ast import Assign, Command
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.blocks import Block, Blocks
from tiniscript.syntax.construct_recovery import ConstructRecovery
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.def_recovery import DefRecovery
from tiniscript.syntax.end_recovery import EndRecovery
from tiniscript.syntax.foreign import Grammar, begins_forever, forever_alone
from tiniscript.syntax.group_recovery import GroupRecovery
from tiniscript.syntax.joining_recovery import JoiningRecovery
from tiniscript.syntax.lexer import NUMBER, ODD, WORD, Token
from tiniscript.syntax.name_recovery import NameRecovery
from tiniscript.syntax.operators import SIGNS
from tiniscript.syntax.phrases import AFTER_HEADER
from tiniscript.syntax.reporter import Failed, Reporter, Resumed
from tiniscript.syntax.setup_recovery import SetupRecovery
from tiniscript.syntax.suggestions import shortened
from tiniscript.syntax.until_recovery import UntilRecovery
from tiniscript.syntax.value_constructs import ValueConstructs
from tiniscript.words import NOT_DONE, WORDS, Word, meant_by, said_instead


class Recovery:
    def __init__(
        self,
        cursor: Cursor,
        reporter: Reporter,
        blocks: Blocks,
        kit: Kit | None,
        constructs: ValueConstructs,
    ) -> None:
        self.constructs = constructs
        self.cursor = cursor
        self.reporter = reporter
        self.blocks = blocks
        self.kit = kit
        self.setup = SetupRecovery(cursor, reporter)
        self.in_block = BlockRecovery(cursor, reporter, blocks, kit)
        self.of_name = NameRecovery(cursor, reporter, blocks, kit, self.in_block)
        self.of_def = DefRecovery(cursor, reporter, self.in_block)
        self.of_end = EndRecovery(cursor, reporter, self.in_block)
        self.of_until = UntilRecovery(cursor, reporter, blocks, self.in_block.known)
        self.construct = ConstructRecovery(cursor, reporter, self.in_block)
        self.groups = GroupRecovery(cursor, reporter, self.in_block)
        self.joining = JoiningRecovery(cursor, reporter, self.in_block)

    # -- what is no instruction ---------------------------------------------------------------

    def no_word(self, token: Token) -> None:
        """An instruction begins with a sign or a number."""
        cursor = self.cursor
        block = self.blocks.innermost
        cursor.i += 1
        if token.kind == "}":
            self.in_block.close_brace(token)
        if token.kind == "{":
            self.in_block.alone(token)
        if token.kind in ("{", "}"):
            return
        if token.kind is ODD:
            cursor.i -= 1
            self.of_end.dots(block if block is not None and not block.here else None)
            cursor.i += 1
            self.of_name.talk.prose(cursor.i - 1)
            raise Failed
        if token.kind == "-" and cursor.token.kind == "-":
            self.of_name.other_note(token.start, "--", cursor.token.end)
        if token.kind == "/" and cursor.token.kind is WORD and not self._is_command(cursor.token):
            self.of_name.other_note(token.start, "/", cursor.token.start)  # `/ gira`
        if token.kind == "(":
            self.groups.alone(cursor.i - 1)
        if token.kind is NUMBER:
            self.groups.counted(token)
        if token.kind is NUMBER or token.kind == "(":
            self.constructs.values_in_front(token)
        if token.kind is NUMBER:
            self._line_number(token)
        if token.kind in ("-", "*", "|") and cursor.token.kind is WORD:
            self.reporter.report(codes.LINE_NUMBER, token.span, found=token.text, dash=token.text)
            raise Resumed
        code = codes.EXTRA_CLOSE if token.kind == ")" else codes.NOT_AN_INSTRUCTION
        self.reporter.fail(code, token.span, found=token.text, fix="")

    def _line_number(self, number: Token) -> None:
        """`1. F(2, 80)`, `2) S`: go on with what stands behind the number; but `50 = V` sets V."""
        cursor = self.cursor
        sign = cursor.token
        name = cursor.following
        if sign.kind == "=" and name.kind is WORD and name.text not in WORDS:
            span = Span(number.start, name.end)
            self.of_name.unread_assignment(name)
            values = {"found": number.text, "fix": f"{name.text} = {number.text}"}
            self.reporter.fail(codes.NOT_AN_INSTRUCTION, number.span, span, **values)
        written = cursor.source[number.span]
        after_digits = written.lstrip("0123456789_")
        if sign.kind == "=" and after_digits[:1].isalpha() and after_digits.isascii():  # `2X = 5`
            self.reporter.answer(number)
            right = after_digits + written[: len(written) - len(after_digits)]
            self.of_name.unread_assignment(Token(WORD, right.upper(), *number.span))
            self.reporter.fail(codes.BAD_NAME, number.span, found=written, right=right)
        if sign.kind in (")", "-") or (sign.kind is ODD and sign.text in (":", ".", "°", "º")):
            cursor.i += 1
        first = WORDS.get(cursor.token.text)
        has_sign = cursor.last is not number or written.endswith(".")  # `1. Avanza`
        has_sign |= cursor.token.text in NOT_DONE  # `30 GOTO 10`
        is_before_word = first is not None and first.role not in ("value", "operator", "function")
        is_same_line = cursor.line_of(cursor.token) == cursor.line_of(number)
        if cursor.token.kind is WORD and is_same_line and (has_sign or is_before_word):
            self.reporter.answer(number)
            self.reporter.answer(sign)
            span = Span(number.start, cursor.last.end)
            found = cursor.source[span]
            self.reporter.report(codes.LINE_NUMBER, span, found=found)
            raise Resumed

    def no_command(self, parser: Grammar, word: Token, role: str) -> NoReturn:
        """A word of the language that is no command begins an instruction."""
        if role == "setup":
            self.setup.in_the_middle(parser, word)
        if role == "until":
            self.of_until.after_its_move(word, parser.argument_of)
        if role == "forever":
            fix = {"fix": "LOOP(FOREVER)", "right": "LOOP"} if begins_forever(parser) else {}
            self.reporter.report(codes.FOREVER_NOT_HERE, word.span, None, **fix)
            if self.cursor.following.kind == "(":
                raise Failed
            forever_alone(parser, word)
        if role == "later":
            self.of_name.sentence.event(word)
            self.reporter.fail(codes.LATER_WORD, word.span, word=word.text)
        if role == "value":
            self.of_name.sentence.word_and_sign(word, self.cursor.following)
        self.of_name.not_an_instruction(word)

    # -- where an instruction must end --------------------------------------------------------

    def no_separator(self, first: Token) -> None:
        """Report what stands where an instruction must end, and go on after it if that helps."""
        cursor, fail = self.cursor, self.reporter.fail
        token, before, after = cursor.token, cursor.last, cursor.following
        kind, text = token.kind, token.text
        try:
            self.constructs.goes_on(first)
        except Failed:
            here = self.blocks.here
            if here and isinstance(here[-1], Assign):  # the value that was read is not all of it
                here[-1] = here[-1]._replace(value=None)
            elif here and isinstance(here[-1], Command) and here[-1].span.start == first.start:
                del here[-1]
            raise
        block = self.blocks.innermost
        header = block if block is not None and block.span.end == before.end else None
        self.of_end.dots(header)
        self.of_end.named_again(first, token)
        if header is not None and header.word != "DEF" and self._is_colon(token):
            token, after = cursor.token, cursor.following
            kind, text = token.kind, token.text
        goes_on = kind in SIGNS or text in ("AND", "OR")  # of the question, or of its line
        goes_on = goes_on or (text in AFTER_HEADER and after.kind in AT_END)
        if header is not None and header.word == "DEF" and (kind is WORD or text in ("=", ":")):
            self.groups.line_of_def(header)
        if header is not None and kind == "(":
            self.groups.body(header, cursor.i)
        if header is not None and header.word != "DEF" and first.text != "ELSE" and not goes_on:
            self._line_of(header, token)
        if kind in ("{", "}"):
            return self.of_end.unclosed(header)
        if header is None and self._is_no_instruction(first):
            if text == ".":
                self.reporter.answer(token)
                self.reporter.report(codes.UNKNOWN_WORD, first.span, found=first.text, near="")
            if text == "." or (kind is WORD and text not in WORDS):
                raise Failed
        is_glued = before.kind is WORD and before.end == token.start and token.end == after.start
        if text == "." and after.kind is WORD and is_glued:  # `motorA.setSpeed(200)`
            self._dotted(first, token)
        is_colon = kind is ODD and text == ":" and header is not None
        if is_colon or ((kind == "," or text in (".", ":")) and after.kind is WORD):
            if header is None or not header.is_reported:
                self._separator_missing(first, token, before, header)
            self.reporter.answer(token)
            cursor.i += 1
            raise Resumed
        if kind is ODD and not (text in ("&", "→") and self._is_command(after)):
            raise Failed
        if kind == ")":
            cursor.i += 1
            fail(codes.EXTRA_CLOSE, token.span, found=")")
        if kind == "|":
            self.setup.bar_between(first, token)
        if header is None:
            self.of_name.note_behind(first, token, after)
        if kind == "-" and after.kind == ">":  # `F(2, 80) -> R(1, 50)`
            cursor.tokens[cursor.i : cursor.i + 2] = [Token("→", "->", token.start, after.end)]
            token, after = cursor.token, cursor.following
            kind, text = token.kind, token.text
        if text in ("+", "/", "&", "-", "→", "->", ">") and self._is_command(after):
            self.reporter.answer(token)
            shown = shortened(cursor.source.text[first.start : before.end])
            self.reporter.report(codes.SIGN_BETWEEN, token.span, found=text, before=shown)
            cursor.i += 1
            raise Resumed
        if kind in SIGNS:
            fail(codes.NOT_AN_INSTRUCTION, token.span, found=text, fix="")
        if kind == "," and before.kind is NUMBER and after.text == "000":  # `X = 1,000`
            span = Span(before.start, after.end)
            fail(codes.BAD_NUMBER, span, found=cursor.source[span], right=before.text + "000")
        if kind == "," and before.kind is NUMBER and after.kind is NUMBER:
            whole = cursor.source[Span(first.start, before.end)]
            fix = f"{whole}.{after.text}"
            span = Span(before.start, after.end)
            fail(codes.DECIMAL_COMMA, span, Span(first.start, after.end), fix=fix)
        is_joining = header is None and kind is WORD and self.joining.words() > 0
        if is_joining or (kind is WORD and header is not None and text in AFTER_HEADER):
            if header is not None or (after.kind is WORD and not self.in_block.is_name(text)):
                cursor.i += 1 if header is not None else self.joining.words()
                span = cursor.span_from(token)
                shown = cursor.source[span].upper()
                joining = "" if header is not None else cursor.source[span]
                self.reporter.report(codes.EXTRA_WORD, span, found=shown, fix="", joining=joining)
                self.in_block.go_on()
        if header is not None or not self._is_no_instruction(first):
            self._separator_missing(first, token, before, header)
        if kind is not WORD:
            raise Failed

    def meant(self, word: Token) -> Word | None:
        """Return the command that a word of another language means."""
        meant = self.in_block.known.command(word.text)
        return meant if meant is not None and meant.is_instruction else None

    def _is_command(self, token: Token) -> bool:
        known = WORDS.get(token.text) if token.kind is WORD else None
        return known is not None and known.is_instruction

    def _is_no_instruction(self, first: Token) -> bool:
        """Whether an instruction begins with a word that nobody knows: that is said of it."""
        known = self.in_block.known
        is_known = first.text in WORDS or known.is_own(first.text) or meant_by(first.text)
        return self.kit is not None and first.kind is WORD and not is_known

    def _line_of(self, header: Block, token: Token) -> None:
        """`IF(c) S` or `LOOP(2) { S }`: suggest the whole line, if all of it is understood."""
        cursor = self.cursor
        start = cursor.i
        word = Token(WORD, header.word, header.span.start, header.span.start + len(header.word))
        self.blocks.forget()
        line = self.in_block.whole_line(word, header.word)
        if line is None:
            cursor.i = start
            self.blocks.reopen(header)
            return
        if not header.is_reported:
            place = cursor.span_from(word)
            self.reporter.answer(token)
            is_brace = token.kind == "{"
            before = shortened(cursor.source[header.span])
            if not is_brace or any(
                each.code is codes.BRACES and each.span == token.span
                for each in self.reporter.diagnostics
            ):
                code = codes.BRACES if is_brace else codes.HEADER_SEPARATOR
                self.reporter.report(
                    code, token.span, place, found=token.text, before=before, fix=line
                )
        raise Resumed

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
            sign = "," if token.kind == "," and header is None else ""
            self.reporter.report(code, token.span, found=token.text, before=shown, sign=sign)

    def _dotted(self, first: Token, point: Token) -> NoReturn:
        cursor = self.cursor
        here = self.blocks.here
        if here and isinstance(here[-1], Command) and here[-1].span.start == first.start:
            del here[-1]
        self.reporter.answer(point)
        end = cursor.i
        cursor.skip_instruction()
        for token in cursor.tokens[end : cursor.i]:
            self.reporter.answer(token)
        span = Span(first.start, cursor.tokens[end + 1].end)
        values = {"found": cursor.source[span], "near": "", **said_instead(first.text)}
        self.reporter.fail(codes.UNKNOWN_WORD, span, None, **values)

    def _is_colon(self, token: Token) -> bool:
        """Whether `=`, `->` or `?` stands behind a question for the colon; then it becomes one."""
        tokens, k = self.cursor.tokens, self.cursor.i
        end = k + 1 + (token.kind == "-" and tokens[k + 1].kind == ">")
        is_sign = token.kind == "=" or end == k + 2 or token.text in ("?", "→")
        if not is_sign or not self._is_command(tokens[end]):
            return False
        self.reporter.answer(token)
        tokens[k:end] = [Token(ODD, ":", token.start, tokens[end - 1].end)]
        other = k + 1
        while tokens[other].kind not in AT_END and tokens[other].text != ":":
            other += 1
        if token.text == "?" and tokens[other].text == ":":  # `IF(c) ? F(1, 50) : S`
            self.reporter.answer(tokens[other])
            tokens[other] = Token(WORD, "ELSE", *tokens[other].span)
        return True
