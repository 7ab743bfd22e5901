"""The parser's half that speaks where there is no instruction to read.

Knows what can stand in the place of an instruction, or where one must end, and how to go on
after it. Asked only where a text is wrong already; what beginners mean, `slips` knows.
"""

from __future__ import annotations

from typing import NoReturn

from tiniscript import problems
from tiniscript.problems import Code
from tiniscript.source import Span
from tiniscript.syntax.ast import Assign, Command
from tiniscript.syntax.blocks import Blocks, GoesOn
from tiniscript.syntax.call_suggestions import actuator_word, call_in, glued_call, written
from tiniscript.syntax.expressions import Failed
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, ODD, QUOTES, WORD, Token
from tiniscript.syntax.suggestions import (
    AFTER_HEADER,
    BEFORE_CALL,
    BEFORE_NAME,
    BEFORE_NOTE,
    BETWEEN,
    BLOCKS,
    COMPARISONS,
    COUNTING,
    ENDS,
    SIGNS,
    after_bracket,
    body_begins,
    foreign_block,
    head_in,
    is_assignment,
    is_question,
    update,
)
from tiniscript.words import WORDS, Word, meant_by

_AT_END = frozenset((";", NEWLINE, END))
_TIMED = ("move", "wait")


class Mistakes(Blocks):
    # -- going on ---------------------------------------------------------------------------

    def instead(self, token: Token, code: Code, span: Span, **values: str) -> None:
        """Report a problem in place of what the scan says about an odd sign."""
        self.answered.add(token.start)
        self.report(code, span, **values)

    def skip(self) -> None:
        """Go to the end of an instruction that could not be read."""
        while self.tokens[self.i].kind not in _AT_END:
            self.i += 1

    def _skip_line(self) -> None:
        while self.tokens[self.i].kind not in (NEWLINE, END):
            self.i += 1

    def set_somehow(self, name: Token) -> None:
        """Remember that a variable is set here, to a value that cannot be read."""
        if name.text not in WORDS:
            self.here.append(Assign(name.text, name.span, None, name.span))

    # -- what is no instruction ---------------------------------------------------------------

    def no_word(self, token: Token) -> None:
        """Something begins with a sign or a number."""
        self.i += 1
        if token.kind == "{":
            return
        if token.kind == "}":
            self.close_brace(token)
            return
        if token.kind is ODD:
            raise Failed
        if token.kind == "-" and self.tokens[self.i].kind == "-":
            self._other_note(token.start, "--", self.tokens[self.i].end)
        code = problems.EXTRA_CLOSE if token.kind == ")" else problems.NOT_AN_INSTRUCTION
        self.fail(code, token.span, found=token.text, fix="")

    def _other_note(self, start: int, sign: str, text_start: int) -> NoReturn:
        """`-- go` or `REM go`: the rest of the line is a note."""
        self._skip_line()
        span = Span(start, self.tokens[self.i].start)
        note = "// " + self.source[Span(text_start, span.end)].strip()[:40]
        self.fail(problems.OTHER_NOTE, span, found=sign, right=note)

    def refuse_if_no_command(self, word: Token, role: str, following: Token) -> None:
        if role == "setup":
            if word.text == "CHECK_CONNECTION":
                self.fail(problems.PING_ALONE, word.span)
            if word.text == "SI" and following.kind != "|":
                if following.kind == "(" or is_question(self.tokens, self.i + 1):
                    self.report(problems.SPANISH_IF, word.span)
                    self._foreign_header(word, "IF")
            code = problems.SETUP_TWICE if following.kind == "|" else problems.SETUP_NEEDS_BAR
            self.fail(code, word.span, found=word.text)
        if role == "until":
            self._until_after_its_move(word)
        if role == "forever":
            self.report(problems.FOREVER_NOT_HERE, word.span)
            self._forever(word)
        if role == "later":
            self.fail(problems.LATER_WORD, word.span, word=word.text)
        if role in ("value", "function", "operator"):
            self._no_instruction(word)

    def _until_after_its_move(self, word: Token) -> NoReturn:
        """`F(2, 80);UNTIL(c)`: the move has its UNTIL, only not where it belongs."""
        last = self.here[-1] if self.here else None
        known = WORDS.get(last.word) if isinstance(last, Command) else None
        if not isinstance(last, Command) or known is None or known.role not in _TIMED or last.until:
            self.fail(problems.UNTIL_ALONE, word.span, fix="")
        self.until_alone(word, self.source[last.span])
        self.i += 1
        self.here[-1] = last._replace(until=self.one_argument(word, is_told=True))
        raise Failed

    def _no_instruction(self, first: Token) -> NoReturn:
        """`DISTANCE < 10` alone: suggest the question."""
        start = self.i
        end = body_begins(self.tokens, start, names_end=False)
        tokens = self.tokens[start:end]
        is_question = any(token.kind in COMPARISONS or token.text == "NOT" for token in tokens)
        fix = head_in(WORDS["IF"], tokens) if is_question else ""
        sign = next((token for token in tokens if token.kind in SIGNS), first)
        place = first if sign is first or not is_question else sign
        self.fail(problems.NOT_AN_INSTRUCTION, place.span, found=place.text, fix=fix)

    def no_open_after(self, word: Token, known: Word) -> NoReturn:
        """`F 2 80`: suggest the same with brackets and commas."""
        start = self.i
        first = self.tokens[start]
        if self.source.text[first.start : first.start + 1] in tuple(QUOTES):
            raise Failed
        self.i = end = body_begins(self.tokens, start, names_end=False)
        rest = self.tokens[start:end]
        span = Span(word.start, rest[-1].end if rest else word.end)
        self._pair_braces(word, known, rest)
        self.report(problems.MISSING_OPEN, span, word=word.text, fix=call_in(known, rest))
        if self.tokens[end].kind is WORD and self.tokens[end].text != "UNTIL":
            self.go_on()
        raise Failed

    def _pair_braces(self, word: Token, known: Word, rest: list[Token]) -> None:
        """`F{2, 80}` has brackets, only not these."""
        brace = self.tokens[self.i]
        if rest or brace.kind != "{":
            return
        start = self.i + 1
        while self.tokens[self.i].kind not in ("}", *_AT_END):
            self.i += 1
        fix = call_in(known, self.tokens[start : self.i])
        self.instead(brace, problems.MISSING_OPEN, word.span, word=word.text, fix=fix)
        raise Failed

    # -- slips that begin with a name ---------------------------------------------------------

    def refuse_if_slip(self, word: Token, following: Token) -> None:
        """Name what no name of a program can be; a name alone may be one of its DEFs."""
        kind = following.kind
        if kind == "|":
            self.fail(problems.SETUP_TWICE, word.span, found=word.text)
        if kind not in _AT_END and kind != "(":
            self._refuse_what_follows(word, following)
        if self.kit is not None or (word.text == "END" and kind in _AT_END):
            meant = foreign_block(word.text)
            if meant is not None and not self.is_name(word.text):
                self._foreign(word, meant)
        if self.kit is not None:
            if kind is NUMBER or kind is WORD:
                self._refuse_actuator_without_brackets(word)
            if kind is WORD and following.text != "UNTIL" and not self.is_name(word.text):
                self._refuse_two_words(word, following)

    def _refuse_what_follows(self, word: Token, following: Token) -> None:
        kind, start = following.kind, self.i
        changed = update(word, self.tokens, start + 1)
        if changed is not None:
            fix, found = changed
            self.answered.add(following.start)
            self.set_somehow(word)
            self.fail(problems.OTHER_ASSIGNMENT, word.span, found=found, fix=fix)
        if kind is WORD and word.text in BEFORE_NAME and is_assignment(self.tokens, start + 1):
            end = body_begins(self.tokens, start + 3, names_end=False)
            fix = f"{following.text} = {written(self.tokens[start + 3 : min(end, start + 40)])}"
            self.report(problems.EXTRA_WORD, word.span, found=word.text, fix=fix)
            self.i += 1
            raise GoesOn
        if kind is WORD and word.text in BEFORE_CALL:
            self.report(problems.EXTRA_WORD, word.span, found=word.text, fix=following.text)
            self.i += 1
            raise GoesOn
        if word.text in BEFORE_NOTE and (kind is WORD or kind is ODD):
            self._other_note(word.start, word.text, word.end)
        if kind in SIGNS:
            self._no_instruction(word)
        if kind is NUMBER or kind == ",":
            end = body_begins(self.tokens, start + 1, names_end=False)
            rest = self.tokens[start + 1 : end]
            span = Span(word.start, rest[-1].end)
            glued = glued_call(word.text, rest)
            if glued is not None:
                self.i = end
                self.fail(problems.MISSING_OPEN, span, word=glued.partition("(")[0], fix=glued)
            meant = WORDS.get(meant_by(word.text) or "")
            if meant is not None and kind is NUMBER and meant.role in (*_TIMED, "show"):
                self.i = end
                self.fail(problems.OTHER_LANGUAGE, word.span, found=word.text, right=meant.text,
                          fix=call_in(meant, rest))  # fmt: skip

    def _refuse_actuator_without_brackets(self, word: Token) -> None:
        """`LED ON`, `GRIPPER 90`."""
        assert self.kit is not None
        device = next((each for each in self.kit.actuators if each.name == word.text), None)
        if device is not None:
            self.i += 1
            self.no_open_after(word, actuator_word(device))

    def _refuse_two_words(self, word: Token, following: Token) -> None:
        """`TURN LEFT`; and of `hello world` only the first word is a problem."""
        meant = WORDS.get(meant_by(f"{word.text}_{following.text}") or "")
        span = Span(word.start, following.end)
        if meant is not None and meant.role != "block":
            rest = self.tokens[self.i + 2 : body_begins(self.tokens, self.i + 2, names_end=False)]
            fix = call_in(meant, rest) if meant.arguments else meant.text
            self.fail(problems.OTHER_LANGUAGE, span, found=self.source[span], right=meant.text,
                      fix=fix)  # fmt: skip
        after = self.tokens[self.i + 2]
        if following.text not in WORDS and (after.kind in _AT_END or after.kind is WORD):
            self.here.append(Command(word.text, word.span, None, None, word.span))
            self.i += 1
            raise Failed

    def word_of(self, token: Token) -> Word | None:
        known = super().word_of(token)
        if known is None and token.kind is WORD and self.kit is not None:
            found = (each for each in self.kit.actuators if each.name == token.text)
            known = next((actuator_word(each) for each in found), None)
        return known

    # -- blocks in other languages ------------------------------------------------------------

    def _foreign(self, word: Token, meant: str) -> None:
        """`REPEAT(3)`, `SINO`, `FIN`: name the word, and read the block as ours."""
        if meant == "END":
            self.end_of_any(word)
            raise Failed
        if meant == "FOREVER":
            self._say_foreign(word, meant, "LOOP(FOREVER)")
            self._forever(word)
        if meant in ENDS:
            if self.blocks and self.blocks[-1].is_told:
                self.end_of_any(word)
            else:
                self._say_foreign(word, meant, meant)
                self.i += 1
                self.end(meant, word.span)
            raise Failed
        if meant in BLOCKS:
            self._say_foreign(word, meant, self._foreign_fix(word, meant))
            self._foreign_header(word, meant)
        if meant == "DEF":
            name = self.tokens[self.i + 1]
            fix = f"DEF {name.text}" if name.kind is WORD else "DEF DANCE"
            self._say_foreign(word, meant, fix)
            said = len(self.problems)
            try:
                self.define(word)
            except Failed:
                self.skip()
            del self.problems[said:]
            self.blocks[-1].is_told = True
            self.go_on()
        inside = self.inside(self.i + 1)
        self._say_foreign(word, meant, head_in(WORDS[meant], inside) if meant != "ELSE" else meant)
        self.arm(Token(WORD, meant, *word.span), is_told=True)
        self.go_on()

    def _forever(self, word: Token) -> NoReturn:
        """`FOREVER` alone on its line begins a block elsewhere."""
        self.i += 1
        if self.tokens[self.i].kind in ("{", *_AT_END) or self.tokens[self.i].text == ":":
            self.open("LOOP", word.span, None, None).is_told = True
        self.go_on()

    def _say_foreign(self, word: Token, meant: str, fix: str) -> None:
        self.report(problems.OTHER_LANGUAGE, word.span, found=word.text, right=meant, fix=fix)

    def _foreign_fix(self, word: Token, meant: str) -> str:
        inside = self.inside(self.i + 1)
        is_for = word.text in COUNTING or any(token.kind in (";", ",", "=") for token in inside)
        return WORDS[meant].example if is_for and meant == "LOOP" else head_in(WORDS[meant], inside)

    def _foreign_header(self, word: Token, meant: str) -> NoReturn:
        """Open the block of a header whose word is a problem already."""
        self.i += 1
        if word.text in COUNTING and self.tokens[self.i].kind != "(":
            while self.tokens[self.i].kind not in ("{", *_AT_END):
                if self.tokens[self.i].text in (":", *AFTER_HEADER):
                    break
                self.i += 1
        head, before = None, len(self.problems)
        try:
            head = self.one_argument(Token(WORD, meant, *word.span), is_told=True)
        except Failed:
            del self.problems[before:]
        span = Span(word.start, self.tokens[self.i - 1].end)
        self.open(meant, span, head, None).is_told = True
        self.go_on()

    # -- what comes after an instruction ------------------------------------------------------

    def no_separator(self, first: Token) -> None:
        """Name what stands where an instruction must end, and go on after it if that helps."""
        token, before = self.tokens[self.i], self.tokens[self.i - 1]
        kind, text = token.kind, token.text
        if kind in ("{", "}"):
            return
        after = self.tokens[self.i + 1]
        is_header = bool(self.blocks) and self.blocks[-1].span.end == before.end
        if (text == ":" and kind is ODD and is_header) or (
            (kind == "," or text in (".", ":")) and after.kind is WORD
        ):  # fmt: skip
            if not (is_header and self.blocks[-1].is_told):
                self._separator_missing(first, token, before, is_header)
            self.answered.add(token.start)
            self.i += 1
            raise GoesOn
        if kind is ODD:
            raise Failed
        if kind == ")":
            self.i += 1
            self.fail(problems.EXTRA_CLOSE, token.span, found=")")
        if kind == "|":
            self.fail(problems.SETUP_TWICE, token.span, found=first.text)
        if kind == "-" and after.kind == "-" and after.start == token.end:
            self._other_note(token.start, "--", after.end)
        if is_header and first.text in WORDS and WORDS[first.text].arguments:
            if kind in SIGNS or text in ("AND", "OR"):
                self._question_goes_on(first)
        if kind in SIGNS:
            self.fail(problems.NOT_AN_INSTRUCTION, token.span, found=text, fix="")
        if kind == "," and before.kind is NUMBER and after.kind is NUMBER:
            span = Span(before.start, after.end)
            fix = f"{self.source[Span(first.start, before.end)]}.{after.text}"
            self.fail(problems.DECIMAL_COMMA, span, fix=fix)
        if kind is WORD and text in (AFTER_HEADER if is_header else BETWEEN):
            if is_header or (after.kind is WORD and not self.is_name(text)):
                self.report(problems.EXTRA_WORD, token.span, found=text, fix="")
                self.i += 1
                self.go_on()
        self._separator_missing(first, token, before, is_header)
        if kind is not WORD:
            raise Failed

    def _separator_missing(
        self, first: Token, token: Token, before: Token, is_header: bool
    ) -> None:
        line = self.source.position(token.start)[0]
        if is_header:
            self.blocks[-1].is_told = True
        if line != self.crowded_line:
            self.crowded_line = line
            code = problems.HEADER_SEPARATOR if is_header else problems.MISSING_SEPARATOR
            shown = self.source.text[first.start : before.end]
            self.report(code, token.span, found=token.text, before=_short(shown))

    def _question_goes_on(self, first: Token) -> NoReturn:
        """`IF (A) AND (B)`: the brackets go around the whole question."""
        start = self.i
        while self.tokens[start] is not first:
            start -= 1
        end = body_begins(self.tokens, self.i)
        fix = head_in(WORDS[first.text], self.tokens[start + 1 : end])
        span = Span(first.start, self.tokens[end - 1].end)
        self.blocks[-1].is_told = True
        self.i = end
        self.report(problems.MISSING_OPEN, span, word=first.text, fix=fix)
        self.go_on()

    def until_alone(self, until: Token, before: str) -> None:
        fix = f"{before} {head_in(WORDS['UNTIL'], self.inside(self.i + 1))}" if before else ""
        self.report(problems.UNTIL_ALONE, until.span, fix=fix)

    def inside(self, start: int) -> list[Token]:
        """Return the tokens of the values that begin at `start`, in brackets or not."""
        if self.tokens[start].kind == "(":
            end = after_bracket(self.tokens, start)
            if end is not None:
                return self.tokens[start + 1 : end - 1]
            start += 1
        return self.tokens[start : body_begins(self.tokens, start)]


def _short(text: str) -> str:
    """Return text that fits into a message."""
    text = " ".join(text.split())
    return text if len(text) <= 40 else text[:37] + "..."
