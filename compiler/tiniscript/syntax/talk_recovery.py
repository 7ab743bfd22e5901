"""Recovery of lines that are talk: prose, what the robot is not to do, and one of its motors.

Knows which words say what a robot does. A line in which none does is taken for a note.
"""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.call_suggestions import LONGEST
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.lexer import NEWLINE, NUMBER, WORD, Token
from tiniscript.syntax.phrases import (
    BEFORE_NAME,
    BEFORE_NOTE,
    CHANGING,
    OFTEN_SAID,
    SETTING,
    STEPS,
    TERMINAL,
)
from tiniscript.syntax.reporter import Reporter, Resumed
from tiniscript.syntax.suggestions import foreign_block, shortened
from tiniscript.words import SWITCH_WORDS, TURN_WORDS, WORDS, is_guessed, meant_by

_LONGEST_MOTOR = 8  # tokens of `motor izquierdo (-50 %)`
_MOTORS = frozenset(("MOTOR", "RUEDA", "WHEEL", "LLANTA"))
_SIDES = {
    "L": {"IZQUIERDO", "IZQUIERDA", "IZQ", "LEFT"},
    "R": {"DERECHO", "DERECHA", "DER", "RIGHT"},
}


_ASKING = frozenset(("IF", "SI", "WHILE", "UNTIL", "HASTA"))


class TalkRecovery:
    def __init__(self, cursor: Cursor, reporter: Reporter, in_block: BlockRecovery) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.in_block = in_block

    def prose(self, start: int) -> None:
        """`Here is your program:`: a line of words of which none says what to do."""
        cursor = self.cursor
        tokens, end = cursor.tokens, start
        if start and tokens[start - 1].kind not in (NEWLINE, "|", ";"):
            return
        if tokens[start].text in BEFORE_NOTE:
            return
        while tokens[end].kind not in AT_END:
            if end > start + LONGEST or tokens[end].kind in (
                "(",
                ")",
                "=",
                "|",
                "{",
                "}",
                "<",
                ">",
            ):
                return
            end += 1
        row = tokens[start:end]
        words = [token for token in row if token.kind is WORD]
        turns = ("DA", "DAR", "DE", "MEDIA", "UNA")
        if words and words[0].text in turns and words[-1].text != "VEZ" and (
            {"VUELTA", "VUELTAS"} & {token.text for token in words}
        ):  # fmt: skip
            cursor.i = end
            self.reporter.fail(codes.WHICH_WAY, Span(row[0].start, row[-1].end))
        if len(words) < 3 or any(self._says_something(tokens, k) for k in range(start, end)):
            return
        for token in row:
            self.reporter.answer(token)
        cursor.i = end
        span = Span(row[0].start, row[-1].end)
        fix = f"// {cursor.source[span]}"
        command = cursor.source[span] if row[0].text in TERMINAL else ""
        self.reporter.fail(codes.PROSE, span, None, fix=fix, command=command)

    def _says_something(self, tokens: Sequence[Token], k: int) -> bool:
        """Whether the word at `k` says what a robot does, or is a name of the program."""
        token, after = tokens[k], tokens[k + 1]
        text = token.text
        if token.kind is not WORD:
            return False
        if text in OFTEN_SAID and after.kind is WORD and tokens[k - 1].kind is WORD:
            return False
        if text in BEFORE_NAME or text in SETTING or text in CHANGING:
            return True
        if self.in_block.known.is_name(self.in_block.known.value(text)):
            return True
        if text in TURN_WORDS or text in SWITCH_WORDS or self.in_block.is_name(text):
            return True
        meant = WORDS.get(text) or WORDS.get(meant_by(text) or "")
        if meant is None or meant.role in ("value", "operator", "function"):
            return False
        return not is_guessed(text) or after.kind in (NUMBER, *AT_END)

    def one_motor(self, word: Token) -> None:
        """`motor izquierdo 50`: M has a power for each motor, and sets both."""
        cursor = self.cursor
        said = self._motor_at(cursor.i)
        if said is None:
            return
        powers = {said[0]: said[1]}
        end = said[2]
        other = self._motor_at(cursor.after_newlines(end + (cursor.tokens[end].kind == ";")))
        if other is not None and other[0] not in powers:
            powers[other[0]] = other[1]
            end = other[2]
        fix = f"M({powers.get('L', '0')}, {powers.get('R', '0')})"
        span = Span(word.start, cursor.tokens[end - 1].end)
        cursor.i = end
        self.reporter.fail(
            codes.OTHER_LANGUAGE, span, span, found=shortened(cursor.source[span]), right="M",
            fix=fix, usage=WORDS["M"].usage,
        )  # fmt: skip

    def _motor_at(self, start: int) -> tuple[str, str, int] | None:
        """Return the side, the power and the end of the instruction `motor izquierdo 50`."""
        tokens, end = self.cursor.tokens, start
        while tokens[end].kind not in AT_END:
            end += 1
            if end - start > _LONGEST_MOTOR:
                return None
        row = tokens[start:end]
        texts = {each.text for each in row}
        numbers = [each.text for each in row if each.kind is NUMBER]
        sides = [side for side, names in _SIDES.items() if texts & names]
        if not texts & _MOTORS or len(sides) != 1 or len(numbers) != 1:
            return None
        if any(each.kind not in (WORD, NUMBER, "%", "(", ")", ",", "-") for each in row):
            return None
        sign = "-" if any(each.kind == "-" for each in row) else ""
        return sides[0], sign + numbers[0], end

    def not_to_move(self, word: Token) -> None:
        """`no avances`, `para de avanzar`, `deja de girar`: the robot stands still."""
        cursor, k = self.cursor, self.cursor.i + 1
        is_end = word.text in ("PARA", "DEJA", "STOP", "TERMINA") and cursor.token is word
        if is_end and cursor.tokens[k].text != "DE":
            return
        k += is_end
        if cursor.tokens[k].kind is not WORD:  # `deja de`
            return
        moves = WORDS.get(meant_by(cursor.tokens[k].text) or "")
        is_move = cursor.tokens[k].text in TURN_WORDS or (moves and moves.role == "move")
        end = k + 1
        while cursor.tokens[end].kind is WORD:
            end += 1
        said = {foreign_block(each.text) or each.text for each in cursor.tokens[k + 1 : end]}
        if not is_move or cursor.tokens[end].kind not in AT_END or said & _ASKING:
            return  # `no avances si …`
        cursor.skip_instruction()
        span = cursor.span_from(word)
        self.reporter.fail(
            codes.OTHER_LANGUAGE, span, span, found=shortened(cursor.source[span]), right="S",
            fix="S", usage="S",
        )  # fmt: skip

    def label(self, word: Token, following: Token, after: Token) -> None:
        """`Paso 1: F(2, 80)`, `a) F(2, 80)`: what counts the lines."""
        cursor = self.cursor
        is_step = word.text in STEPS and following.kind is NUMBER and after.text in (":", ")")
        is_letter = len(word.text) == 1 and following.kind == ")"
        count = 3 if is_step else 2
        last = cursor.tokens[cursor.i + count - 1]
        target = cursor.tokens[min(cursor.i + count, len(cursor.tokens) - 1)]
        is_own_line = cursor.line_of(target) == cursor.line_of(word)
        if not (is_step or is_letter) or target.kind is not WORD or not is_own_line:
            return
        if self.in_block.is_name(word.text):
            return
        self.reporter.answer(last)
        cursor.i += count
        span = Span(word.start, last.end)
        self.reporter.report(codes.LINE_NUMBER, span, found=cursor.source[span])
        raise Resumed
