"""Recovery of instructions that are sentences: `girar a la derecha`, `TURN LEFT`, `robot.go(2)`.

Knows which word of the language a sentence says, and which of its words are values.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NoReturn

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.ast import Assign, Command
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.call_suggestions import LONG_TIME_S, call_in
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.lexer import NUMBER, ODD, WORD, Token
from tiniscript.syntax.operators import COMPARISONS
from tiniscript.syntax.phrases import (
    BEFORE_POWER,
    BEFORE_TIME,
    CHANGING,
    EVENTS,
    FILLERS,
    KEEPING,
    READING,
    TIMES,
)
from tiniscript.syntax.reporter import Failed, Reporter, Resumed
from tiniscript.syntax.suggestions import (
    body_begins,
    end_of_values,
    foreign_block,
    head_in,
    inside,
    is_filler,
    move_said,
    shortened,
    with_signs,
)
from tiniscript.syntax.time_phrases import with_numbers
from tiniscript.syntax.units import converted
from tiniscript.words import (
    NEAR_WORDS,
    POWER_WORDS,
    SWITCH_WORDS,
    TURN_WORDS,
    UNITS,
    WORDS,
    Word,
    is_guessed,
    meant_by,
)

# What stands between a variable and its new value: `set x to 5`.
_SMALL = frozenset(
    ("A", "TO", "EN", "IN", "POR", "BY", "COMO", "IGUAL", "EL", "LA", "THE", "AL", "VALOR")
)


class SentenceRecovery:
    def __init__(self, cursor: Cursor, reporter: Reporter, in_block: BlockRecovery) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.blocks = in_block.blocks
        self.in_block = in_block

    def two_words(self, word: Token, following: Token) -> None:
        """`TURN LEFT`; and of `hello world` only the first word is a mistake."""
        tokens, start = self.cursor.tokens, self.cursor.i + 2
        joined = f"{word.text}_{following.text}"
        if joined in SWITCH_WORDS:  # `turn on led`
            self.cursor.skip_instruction()
            self.reporter.fail(codes.SWITCH_WHAT, Span(word.start, following.end), found="", fix="")
        if self.in_block.is_name(joined):
            span = Span(word.start, following.end)
            found = self.cursor.source[span]
            self.reporter.fail(codes.NAME_WITH_SPACE, span, found=found, right=joined)
        row = tokens[start - 1 : start + 4]
        asks = any("BUTTON" in (each.text, meant_by(each.text)) for each in row)
        if asks and meant_by(word.text) == "W":
            self.cursor.skip_instruction()
            self.reporter.fail(codes.NO_BUTTON, self.cursor.span_from(word))
        self._reading(word)
        if meant_by(joined) == "FOREVER":
            self._void_loop(word, following)
        if word.text in SWITCH_WORDS and meant_by(following.text) == "M":
            span = Span(word.start, following.end)
            self.say_in_other_words(span, self.cursor.source[span], WORDS["S"], [])
        meant = WORDS.get(meant_by(f"{word.text}_{following.text}") or "")
        if meant is not None and meant.role != "block":
            span = Span(word.start, following.end)
            rest = tokens[start : body_begins(tokens, start, names_end=False)]
            self.say_in_other_words(span, self.cursor.source[span], meant, rest)
        said = WORDS.get(meant_by(word.text) or "")
        if is_guessed(word.text) and following.kind is WORD:
            said = None  # `Quiero que`: no slip of QUIETO
        if said is not None and said.role in ("move", "wait"):
            if "UNTIL" in (following.text, meant_by(following.text)):
                self._until_distance(word, said)
                self.until_question(word, said)
        if said is not None and said.arguments and following.text not in WORDS:
            rest = tokens[start - 1 : body_begins(tokens, start - 1, names_end=False)]
            self.say_in_other_words(word.span, word.text, said, rest)
        after = tokens[start].kind
        if following.text not in WORDS and (after in AT_END or after is WORD):
            self.blocks.here.append(Command(word.text, word.span, None, None, word.span))
            self.cursor.i += 1
            raise Failed

    def _reading(self, word: Token) -> None:
        """`lee la distancia`: a sensor's name alone takes a reading."""
        cursor, k = self.cursor, self.cursor.i + 1
        while is_filler(cursor.tokens, k):
            k += 1
        name = self.in_block.known.value(cursor.tokens[k].text)
        is_end = cursor.tokens[k + 1].kind in AT_END
        if word.text not in READING or not self.in_block.is_name(name) or not is_end:
            return
        cursor.i = k + 1
        place = cursor.span_from(word)
        found = shortened(cursor.source[place])
        self.reporter.fail(
            codes.OTHER_LANGUAGE, word.span, place, found=found, right=name, fix=name, usage=name
        )

    def _until_distance(self, word: Token, meant: Word) -> None:
        """`avanza hasta 10 cm`: what ends the move is a distance."""
        cursor, start = self.cursor, self.cursor.i + 2
        while is_filler(cursor.tokens, start):
            start += 1
        number, unit = cursor.tokens[start], cursor.tokens[min(start + 1, len(cursor.tokens) - 1)]
        self._until_something(word, meant, start)
        is_cm = number.kind is NUMBER and UNITS.get(unit.text, ("",))[0] == "cm"
        measures = self.in_block.known.is_number("DISTANCE")
        if not is_cm or not measures or meant.text not in ("F", "B"):
            return
        sign = "<" if meant.text == "F" else ">"
        limit = converted(number.text, unit.text)
        fix = f"{meant.text}(FOREVER, 80) UNTIL(DISTANCE {sign} {limit})"
        cursor.skip_instruction()
        place = cursor.span_from(word)
        self.reporter.fail(
            codes.OTHER_LANGUAGE, word.span, place, found=word.text, right=meant.text, fix=fix,
            usage=meant.usage,
        )  # fmt: skip

    def _until_something(self, word: Token, meant: Word, start: int) -> None:
        """`avanza hasta la pared`."""
        cursor, end = self.cursor, start
        while cursor.tokens[end].kind is WORD:
            end += 1
        row = cursor.tokens[start:end]
        measures = self.in_block.known.is_number("DISTANCE")
        is_near = any(each.text in NEAR_WORDS for each in row) and len(row) < 8
        if not (is_near and measures and cursor.tokens[end].kind in AT_END):
            return
        call = "W(FOREVER)" if meant.text == "W" else f"{meant.text}(FOREVER, 80)"
        cursor.i = end
        place = cursor.span_from(word)
        self.reporter.fail(
            codes.OTHER_LANGUAGE, word.span, place, found=word.text, right=meant.text,
            fix=f"{call} UNTIL(DISTANCE < 10)", usage=meant.usage,
        )  # fmt: skip

    def until_question(self, word: Token, meant: Word) -> None:
        """`esperar hasta distancia < 10`."""
        cursor, start = self.cursor, self.cursor.i + 2
        values = inside(cursor.tokens, start)
        if not any(each.kind in COMPARISONS for each in with_signs(values)):
            return
        end = end_of_values(cursor.tokens, start, values)
        found = cursor.source[Span(word.start, cursor.tokens[start - 1].end)]
        call = "W(FOREVER)" if meant.text == "W" else f"{meant.text}(FOREVER, 80)"
        fix = f"{call} {head_in(WORDS['UNTIL'], values)}"
        while cursor.token.start < end:
            cursor.i += 1
        place = Span(word.start, end)
        self.reporter.fail(
            codes.OTHER_LANGUAGE, word.span, place, found=found, right=meant.text, fix=fix,
            usage=meant.usage,
        )  # fmt: skip

    def event(self, word: Token) -> None:
        """`al presionar el boton`, `when green flag clicked`: how a program of Scratch begins."""
        cursor = self.cursor
        end = cursor.i
        while cursor.tokens[end].kind is WORD:
            end += 1
        row = cursor.tokens[cursor.i : end]
        texts = {each.text for each in row}
        if len(row) < 2 or cursor.tokens[end].kind not in AT_END or cursor.line_of(word) > 2:
            return
        span = Span(word.start, row[-1].end)
        is_button = any("BUTTON" in (text, meant_by(text)) for text in texts)
        if is_button and not any(map(self.in_block.known.is_own, texts)):
            cursor.i = end
            self.reporter.fail(codes.NO_BUTTON, span)
        if texts & EVENTS:
            cursor.i = end
            found = cursor.source[span]
            self.reporter.fail(
                codes.OTHER_LANGUAGE, span, span, found=found, right="START", fix="START", usage=""
            )

    def assigned(self, word: Token) -> None:
        """`set x to 5`, `cambiar x por 1`, `sumar 1 a x`: as Scratch sets and changes variables."""
        cursor, k = self.cursor, self.cursor.i
        end = k
        while cursor.tokens[end].kind not in AT_END:
            end += 1
        row = [each for each in cursor.tokens[k + 1 : end] if each.text not in _SMALL]
        if len(row) != 2 or end > k + 6:
            return
        is_kept = word.text in KEEPING  # `guardar distancia en x`
        name, value = row[::-1] if is_kept or row[0].kind is not WORD else row
        is_value = value.kind is NUMBER or value.kind is WORD
        if name.kind is not WORD or name.text in WORDS or not is_value:
            return
        fix = f"{name.text} = {self.in_block.known.value(value.text)}"
        is_set = word.text.startswith("C") and {"A", "TO"} & {t.text for t in cursor.tokens[k:end]}
        if word.text in CHANGING and not is_set:
            sign = "-" if word.text in ("RESTAR", "RESTA") else "+"
            fix = f"{name.text} = {name.text} {sign} {value.text}"
        self.blocks.here.append(Assign(name.text, name.span, None, name.span))
        cursor.i = end
        place = cursor.span_from(word)
        found = word.text.lower()
        self.reporter.fail(codes.OTHER_ASSIGNMENT, word.span, place, found=found, fix=fix)

    def say_in_other_words(
        self, span: Span, found: str, meant: Word, values: list[Token], end: int = 0
    ) -> NoReturn:
        """`end` is where the values end in the text, if not with the last of them."""
        values = with_numbers(values)
        self.so_often(span, meant, values, end)
        last = values[-1:]
        if len(values) > 1 and values[0].text in BEFORE_TIME:
            del values[0]
        values = [
            each
            for k, each in enumerate(values)
            if each.text not in BEFORE_POWER or not _is_number_at(values, k + 1)
        ]
        values = [each for each in values if each.text not in FILLERS or [each] == last]
        values = self._with_power(meant, values)
        fix = call_in(meant, values) if meant.arguments else meant.text
        if meant.role == "stop" and values:
            pause = call_in(WORDS["W"], values)  # `para 2 segundos`
            fix = f"{meant.text};{pause}" if pause else meant.text
        if any(each.kind is WORD and not self._is_value(each) for each in values):
            fix = ""
        is_far = any(UNITS.get(each.text, ("",))[0] == "cm" for each in values)
        far = meant.text if is_far and not fix and meant.role == "move" else ""
        place = Span(span.start, max(span.end, end, *(each.end for each in values)))
        self.reporter.fail(
            codes.OTHER_LANGUAGE, span, place, found=found, right=meant.text, fix=fix,
            usage=meant.usage, far=far,
        )  # fmt: skip

    def _with_power(self, meant: Word, values: list[Token]) -> list[Token]:
        """`avanza rapido 3 segundos`: the word says the power, and stands behind the time."""
        said = [each for each in values if each.text in POWER_WORDS]
        rest = [each for each in values if each.text not in POWER_WORDS]
        if meant.role != "move" or len(said) != 1 or len(rest) not in (1, 2):
            return values
        power = POWER_WORDS[said[0].text]
        return [*rest, said[0]._replace(kind=NUMBER, text=power, start=rest[-1].end + 1)]

    def so_often(self, span: Span, meant: Word, values: Sequence[Token], end: int) -> None:
        """`pitar 3 veces`, `avanza 2 segundos 4 veces`."""
        tokens, k = self.cursor.tokens, self.cursor.i
        while values and tokens[k].start < values[-1].end:
            k += 1
        if tokens[k].text in TIMES:
            values = [*values, tokens[k]]
        if len(values) < 2 or values[-1].text not in TIMES or not meant.arguments:
            return
        number = self.in_block.known.value(values[-2].text)
        call = call_in(meant, values[:-2])
        if not number.isdecimal() or not call:
            return
        if meant.role == "beep" and len(values) == 2:
            call = "BEEP(0.5, 440);W(0.5)"  # a pause makes them several
        fix = f"LOOP({number});{call};END_LOOP"
        self.cursor.skip_instruction()
        place = Span(span.start, max(span.end, end, values[-1].end))
        found = shortened(self.cursor.source[place])
        self.reporter.fail(codes.REPEATED, span, place, found=found, fix=fix)

    def _is_value(self, token: Token) -> bool:
        """Whether a word behind a number or a command is a value or a unit."""
        known = self.in_block.known
        text = known.value(token.text)
        return text in WORDS or text in UNITS or known.is_own(text)

    def move_in_a_sentence(self, word: Token) -> None:
        """`girar a la derecha 90 grados`, `el robot avanza 2 segundos`."""
        cursor = self.cursor
        said = move_said(cursor.tokens, cursor.i)
        if said is None:
            return
        meant, start = said
        span = Span(word.start, cursor.tokens[start - 1].end)
        values = inside(cursor.tokens, start)
        end = end_of_values(cursor.tokens, start, values)
        if meant.text in ("L", "R") and self._is_angle(values):
            way = "left" if meant.text == "L" else "right"
            self.reporter.fail(codes.WHICH_WAY, span, word=meant.text, way=way, usage=meant.usage)
        self.say_in_other_words(span, cursor.source[span], meant, list(values), end)

    def turn_by_angle(self, word: Token, following: Token) -> None:
        """`girar 90 grados a la derecha`."""
        cursor = self.cursor
        if word.text not in TURN_WORDS or following.kind is not NUMBER:
            return
        cursor.skip_instruction()
        span = cursor.span_from(word)
        said = [meant_by(text) for text in cursor.source[span].upper().split()]
        for name, way in (("L", "left"), ("R", "right")):
            if name in said:
                usage = WORDS[name].usage
                self.reporter.fail(codes.WHICH_WAY, span, word=name, way=way, usage=usage)
        self.reporter.fail(codes.WHICH_WAY, span)

    @staticmethod
    def _is_angle(values: Sequence[Token]) -> bool:
        """Whether these values are degrees: they say so, or one alone is too much for a time."""
        numbers = [each for each in values if each.kind is NUMBER]
        if any(UNITS.get(each.text, ("",))[0] == "°" for each in values):
            return True
        return len(numbers) == 1 and float(numbers[0].text) >= LONG_TIME_S

    def word_and_sign(self, word: Token, sign: Token) -> None:
        """`robot.adelante(2, 80)`, `Primero: F(2, 80)`: the instruction is behind the sign."""
        cursor = self.cursor
        if sign.kind is not ODD or sign.text not in (".", ":"):
            return
        after = cursor.tokens[min(cursor.i + 2, len(cursor.tokens) - 1)]
        if sign.text == ":" and foreign_block(word.text) is not None:
            return  # `repite: avanza 1`
        if sign.text == ":" and self.in_block.known.is_own(word.text):
            return  # a DEF and a `;` that is none
        meant = self.in_block.known.command(after.text) if after.kind is WORD else None
        is_a_part = word.text.startswith(("SERVO", "MOTOR", "PIN", "LED", "LCD"))
        if meant is None or (is_a_part and meant.role == "show"):  # `servo.write(90)`
            return
        self.reporter.answer(sign)
        if sign.text == ".":
            span = Span(word.start, after.end)
            if meant.role == "start":  # `Serial.begin(9600)`
                found = cursor.source[span]
                self.reporter.fail(codes.UNKNOWN_WORD, span, None, found=found, near="")
            values = inside(cursor.tokens, cursor.i + 3)
            end = end_of_values(cursor.tokens, cursor.i + 3, values)
            self.say_in_other_words(span, cursor.source[span], meant, list(values), end)
        found = f"{word.text}:"
        self.reporter.report(codes.EXTRA_WORD, Span(word.start, sign.end), found=found, label=found)
        cursor.i += 2
        raise Resumed

    def _void_loop(self, word: Token, following: Token) -> NoReturn:
        """`void loop() {`: what repeats for ever in a sketch."""
        cursor = self.cursor
        cursor.i += 2
        if cursor.token.kind == "(" and cursor.following.kind == ")":
            cursor.i += 2
        span = Span(word.start, following.end)
        place = cursor.span_from(word)
        fix = "LOOP(FOREVER)"
        found = cursor.source[span]
        self.reporter.report(
            codes.OTHER_LANGUAGE, span, place, found=found, right="LOOP", fix=fix, usage=fix
        )
        self.in_block.begin_reported("LOOP", span)
        self.in_block.go_on()


def _is_number_at(values: Sequence[Token], k: int) -> bool:
    return k < len(values) and values[k].kind is NUMBER
