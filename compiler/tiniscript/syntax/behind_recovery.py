"""Recovery of what stands behind a whole call: its time once more, how often, an aside.

`F(2, 80) (3 veces)`, `F(2, 80) por 5 segundos`, `F(2, 80) "atras"`. Knows which number of the call
says the same. What is no instruction, and no note either, is shown as it stands: no `;` helps it.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import dropwhile, pairwise

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.ast import Command
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.lexer import NUMBER, ODD, QUOTES, WORD, Token
from tiniscript.syntax.lexer_recovery import scan_with_repairs
from tiniscript.syntax.note_recovery import NoteRecovery
from tiniscript.syntax.operators import COMPARISONS
from tiniscript.syntax.phrases import BEFORE_POWER, BEFORE_TIME, TIMES
from tiniscript.syntax.reporter import Reporter, Resumed
from tiniscript.syntax.suggestions import shortened
from tiniscript.syntax.times_recovery import OFTEN, TimesRecovery
from tiniscript.syntax.units import converted
from tiniscript.words import NUMBER_WORDS, SWITCH_WORDS, TURN_WORDS, UNITS, WORDS, Word, nearest

_LONGEST = 16  # tokens behind a call that are read as one
_LEADING = (",", "=", ":", "-", ">")
_BEFORE_TIME = BEFORE_TIME | {"EN", "IN", "DE", "Y", "A", "CON", "X"}
_BEFORE_VALUE = _BEFORE_TIME | BEFORE_POWER | {"AL", "AT", "LA", "UNA"}
_PERCENT = ("%", "CIENTO", "PORCIENTO", "PERCENT")
_MEASURED = ("cm", "°", "steps")  # that no instruction has, and pupils look at
_SENSIBLE = range(2, 51)  # times that a number in brackets may mean
_DEGREES = 20  # a number behind a turn that is rather an angle
_JOINING = frozenset(("CON", "WITH", "Y", "AND", "O", "OR", "U"))
_FRAMES = ("*", "-", "/", "+", "=")
_CLOCKED = ("move", "wait", "beep")
_SAYING_NO_MORE = frozenset((
    "CM", "SEG", "SEGUNDOS", "SECONDS", "THE", "EL", "AL", "ROBOT", "CAR", "CARRO", "CARRITO",
    "PLEASE", "GRACIAS",
))  # fmt: skip


class BehindRecovery:
    def __init__(
        self,
        cursor: Cursor,
        reporter: Reporter,
        in_block: BlockRecovery,
        of_note: NoteRecovery,
        times: TimesRecovery,
    ) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.in_block = in_block
        self.of_note = of_note
        self.times = times

    def call(self, first: Token, before: Token) -> None:
        """Report what stands behind the call from `first` to `before`, where it says a value."""
        row = self._row()
        known = WORDS.get(first.text)
        is_taught = self.in_block.known.is_def(first.text)
        if not row or not (is_taught or (known is not None and known.is_instruction)):
            return
        if self._is_open(first, before):
            return
        inner = self._unwrapped(row)
        is_aside = inner is not row
        said = inner[1:] if len(inner) > 1 and inner[0].text in _LEADING else inner
        whole = Span(first.start, before.end)
        if is_aside or said is not inner:
            self._so_often(first, before, row, said)
        is_motors = known is not None and known.role == "motors"
        is_number = len(said) == 1 and said[0].kind is NUMBER and before.text == ")"
        if is_number and not self._has_unit(said[0]) and (is_motors or said is inner):
            self._alone(said[0].text, row, whole, is_motors)
        if known is None:
            return
        if known.role == "move":
            self._power(row, said, whole)
        self._time(known, row, said, whole)
        if is_aside and known.role in ("move", "wait"):
            self._question(row, inner, whole)
        if is_aside and self._unit(inner) in _MEASURED:
            self._report(row, whole, f"{self.cursor.source[whole]} // {self._text(row)}")
        if is_aside and not self._is_told_again(first, inner):
            asked = self.of_note.asked(first, inner, whole)
            if row[0].kind == "(" and asked is not None and "until" in asked:
                return  # `F(2, 80) (hasta la mesa)`
            if asked is not None or row[0].kind is ODD:
                self._report(row, whole, **(asked or {"order": self._text(row)}))

    def no_more(self) -> None:
        """`SHOW(DISTANCE) cm`, `STOP the robot`: words that say no more."""
        cursor = self.cursor
        k = start = cursor.i
        while cursor.tokens[k].kind is WORD and cursor.tokens[k].text in _SAYING_NO_MORE:
            k += 1
        if k > start and cursor.tokens[k].kind in AT_END:
            cursor.i = k
            span = Span(cursor.tokens[start].start, cursor.last.end)
            self.reporter.fail(codes.EXTRA_WORD, span, found=cursor.source[span], fix="")

    def words(self, first: Token, before: Token, joining: int = 0) -> None:
        """Report what is no instruction from the cursor on: a `;` before it would not help.

        `joining` words of it would go between two instructions.
        """
        row = self._row()
        if first.kind is not WORD or self._is_open(first, before):
            return
        if len(row) > 1 and row[0].text + row[1].text == "UNTIL":  # as phones part it
            span = Span(row[0].start, row[1].end)
            found = self.cursor.source[span]
            asked = f"UNTIL{self.cursor.source[Span(row[1].end, row[-1].end)]}"
            self._go_past(row)
            self.reporter.fail(codes.OTHER_LANGUAGE, span, None, found=found, right="UNTIL",
                               fix="", usage=asked)  # fmt: skip
        if not row[joining:] or self._is_order(first, row[joining:]):
            return
        whole = Span(first.start, before.end)
        if not any(each.kind is WORD for each in row):
            self._report(row, whole, extra=self._text(row))
        for number, after in pairwise(row):
            if number.kind is NUMBER and after.text in TIMES and first.text in WORDS:
                self._alone(number.text, row, whole)  # `F(1, 50) 3 veces mas`
        self._report(row, whole, order=self._text(self._bare(row)))

    def _bare(self, row: Sequence[Token]) -> Sequence[Token]:
        """Return the instruction in `con SHOW(1)` and in `(L(1, 60))`, else the row."""
        inner = row[1:] if row[0].text in _JOINING else row
        if row[0].kind == "(" and row[-1].kind == ")" and len(row) > 2:
            inner = row[1:-1]
        known = WORDS.get(inner[0].text) if inner else None
        return inner if known is not None and known.is_instruction else row

    def framed(self, sign: Token) -> None:
        """`*F(2, 80)*`, `-F(2, 80)-`: an instruction between two signs."""
        row = self._row()
        inner = [each for each in row if each.kind != sign.kind]
        count = (len(row) - len(inner)) // 2
        if sign.kind not in _FRAMES or not (inner and count) or row[count:-count] != inner:
            return
        if inner[0].kind is not WORD or inner[-1].kind not in (")", WORD):
            return
        before = Span(row[0].start, row[count - 1].end)
        also = f"{row[-count].start}:{row[-1].end}"
        around = self.cursor.source[before]
        self.reporter.report(
            codes.LINE_NUMBER, before, None, found=around, around=around, also=also
        )
        end = self.cursor.i + len(row)
        del self.cursor.tokens[end - count : end]
        self.cursor.i += count
        raise Resumed

    def stop_of_loop(self, first: Token) -> None:
        """`STOP LOOP`: what leaves a loop is BREAK."""
        cursor, after = self.cursor, self.cursor.following
        here = self.in_block.blocks.here
        is_alone = cursor.token.text == "LOOP" and after.kind in AT_END
        if not is_alone or not here or here[-1].span.start != first.start:
            return
        del here[-1]
        place = Span(first.start, cursor.token.end)
        found = cursor.source[place]
        cursor.i += 1
        self.reporter.fail(codes.OTHER_LANGUAGE, place, place, found=found, right="BREAK",
                           fix="BREAK", usage="BREAK")  # fmt: skip

    def _is_open(self, first: Token, before: Token) -> bool:
        """Whether a call has no brackets: `F 2 s 60`, where S rather is a unit."""
        known = WORDS.get(first.text)
        if first is before and self.cursor.tokens[max(0, self.cursor.i - 2)].kind is NUMBER:
            return True
        return known is not None and known.is_call and before.kind != ")"

    # -- what stands there ----------------------------------------------------------------------

    def _row(self) -> Sequence[Token]:
        """Return the rest of the instruction, nothing where it is long or has a block in it."""
        tokens, end = self.cursor.tokens, self.cursor.i
        while tokens[end].kind not in AT_END:
            if end - self.cursor.i > _LONGEST or tokens[end].kind in ("{", "}", "|"):
                return ()
            end += 1
        return tokens[self.cursor.i : end]

    def _unwrapped(self, row: Sequence[Token]) -> Sequence[Token]:
        """Return what stands in the brackets or the quotation marks around all of a row."""
        inside = row[1:-1]
        if row[0].kind == "(" and row[-1].kind == ")" and inside:
            is_plain = all(each.kind not in ("(", ")", ",") for each in inside)
            return inside if is_plain else row
        text = self.cursor.source[row[0].span]
        if len(row) == 1 and row[0].kind is ODD and text[:1] in QUOTES:
            shift = row[0].start + 1
            inside = scan_with_repairs(text.strip(QUOTES)).tokens[:-1]
            moved = [
                each._replace(start=each.start + shift, end=each.end + shift) for each in inside
            ]
            return moved if moved and all(each.kind in (WORD, NUMBER) for each in moved) else row
        return row

    def _text(self, row: Sequence[Token]) -> str:
        return shortened(self.cursor.source[Span(row[0].start, row[-1].end)])

    def _has_unit(self, number: Token) -> bool:
        return self.cursor.source[number.span][-1:].isalpha()

    def _is_told_again(self, first: Token, inner: Sequence[Token]) -> bool:
        """`F(2, 80) (avanza)`."""
        known = self.in_block.known
        said = [known.command(each.text) for each in inner if each.kind is WORD]
        return all(each is None or each is known.command(first.text) for each in said) and (
            not any(each.text in TURN_WORDS for each in inner)
        )

    def _is_order(self, first: Token, row: Sequence[Token]) -> bool:
        """Whether an instruction begins with the row, or rather a word that nobody knows."""
        word = row[0]
        after = row[1].kind if len(row) > 1 else ""
        if word.kind == "," and after is NUMBER:
            return False  # `M(50, 50), 2`
        if word.kind is not WORD:
            return word.kind is not NUMBER and word.kind != "("
        known = self.in_block.known
        meant = known.command(word.text)
        if meant is not None and meant.role not in ("value", "operator", "function", "until"):
            return True
        is_name = known.is_own(word.text) or word.text == first.text or after in ("(", "=")
        is_asked_for = word.text in TURN_WORDS or word.text in SWITCH_WORDS
        is_near = nearest(word.text, [each for each in WORDS if len(each) > 2]) is not None
        return is_name or is_asked_for or is_near or len(row) == 1

    # -- what it says ---------------------------------------------------------------------------

    def _so_often(
        self, first: Token, before: Token, row: Sequence[Token], said: Sequence[Token]
    ) -> None:
        """`F(2, 80) (3 veces)`, `F(2, 80), 3 veces`, `F(2, 80) (x3)`."""
        texts = [each.text for each in said]
        is_led = texts[0] in OFTEN and len(texts) > 1
        number = said[is_led]
        rest = texts[is_led + 1 :]
        if not is_led and texts[0][:1] == "X" and texts[0][1:].isdecimal():
            number = number._replace(kind=NUMBER, text=texts[0][1:])
            is_led = True
        if number.text in NUMBER_WORDS:
            number = number._replace(kind=NUMBER, text=NUMBER_WORDS[number.text])
        is_often = rest[:1] != [] and rest[0] in TIMES and len(rest) == 1
        if number.kind is NUMBER and (is_often or (is_led and not rest)):
            self._answer(row)
            self.times.repeated(number, first, before)

    def _alone(
        self, number: str, row: Sequence[Token], whole: Span, is_motors: bool = False
    ) -> None:
        """`F(2, 80)(3)`: most often how many times, but `M(50, 50), 2` how long."""
        call = self.cursor.source[whole]
        if is_motors:
            self._report(row, whole, seconds=number, waiting=f"{call};W({number});S")
        is_turn = call[:2].upper() in ("L(", "R(") and self._text(row).strip("()") == number
        if is_turn and number.isdecimal() and int(number[:9]) >= _DEGREES:
            self._report(row, whole, extra=self._text(row))  # `L(1, 60)(45)`
        if number.isdecimal() and int(number[:9]) in _SENSIBLE:
            self._report(row, whole, often=f"LOOP({number});{call};END_LOOP", times=number)

    def _time(self, known: Word, row: Sequence[Token], said: Sequence[Token], whole: Span) -> None:
        """`F(2, 80) por 5 segundos`, `M(50, 50) 2 segundos`, `S 2 segundos`."""
        k = next((k for k, each in enumerate(said) if each.text == "UNTIL"), len(said))
        is_asked = 0 < k < len(said) and known.role in ("move", "wait")
        until = f" {self._text(said[k:])}" if is_asked else ""
        said = said[:k] if is_asked else said
        seconds = self._seconds(said)
        call = self.cursor.source[whole]
        if not seconds:
            return
        if known.role in ("motors", "stop"):
            fix = f"{call};W({seconds})" + ";S" * (known.role == "motors")
            self._report(row, whole, fix=fix)
        values = _values(call)
        if known.role not in _CLOCKED or not values or self._has_until():
            return
        time = values[0]
        if call[slice(*time)] == seconds and row[0].kind == "(":
            self._report(row, whole, f"{call} // {self._text(row)}")
        if call[slice(*time)] != seconds:
            longer = f"{call[: time.start]}{seconds}{call[time.end :]}{until}"
            self._report(row, whole, longer=longer, time=f"{seconds} s")

    def _power(self, row: Sequence[Token], said: Sequence[Token], whole: Span) -> None:
        """`F(2, 80) al 50%`, `F(2, 80) 80%`, `F(2, 80) con potencia 50`."""
        is_power = {"POR", "CIENTO"} <= {each.text for each in said}
        rest = [each for each in said if each.text not in _BEFORE_VALUE]
        if len(rest) == 2 and rest[0].kind is NUMBER and rest[1].text in _PERCENT:
            is_power = True
            del rest[1]
        if len(rest) == 1 and rest[0].kind is NUMBER:
            is_power |= self.cursor.source[rest[0].span].endswith("%")
            is_power |= any(each.text in BEFORE_POWER for each in said)
        call = self.cursor.source[whole]
        values = _values(call)
        is_number = len(rest) == 1 and rest[0].kind is NUMBER
        if not (is_power and is_number) or len(values) < 2:
            return
        start, end = values[-1]
        if not call[start:end].isdecimal():
            return
        if call[start:end] == rest[0].text:
            self._report(row, whole, f"{call} // {self._text(row)}")
        self._report(row, whole, power=f"{call[:start]}{rest[0].text}{call[end:]}")

    def _has_until(self) -> bool:
        here = self.in_block.blocks.here
        return bool(here) and isinstance(here[-1], Command) and here[-1].until is not None

    def _seconds(self, said: Sequence[Token]) -> str:
        """Return the seconds that a row says and nothing else, `0.5` for `500 ms`, else nothing."""
        rest = list(dropwhile(lambda each: each.text in _BEFORE_TIME, said))
        if self._unit(rest) != "s":
            return ""
        number = NUMBER_WORDS.get(rest[0].text, rest[0].text)
        return converted(number, rest[1].text) if len(rest) > 1 else number

    def _unit(self, rest: Sequence[Token]) -> str:
        """Return the unit of a number that is all of a row, "" where there is none."""
        if not 0 < len(rest) < 3 or (
            rest[0].kind is not NUMBER and rest[0].text not in NUMBER_WORDS
        ):  # fmt: skip
            return ""
        written = self.cursor.source[rest[0].span].lstrip("0123456789. ").upper()
        return UNITS.get(rest[1].text if len(rest) > 1 else written, ("", 0))[0]

    def _question(self, row: Sequence[Token], inner: Sequence[Token], whole: Span) -> None:
        """`F(5, 60) (DISTANCE < 30)`."""
        if any(each.kind in COMPARISONS for each in inner) and not self._has_until():
            found = self._text(row)
            span = Span(row[0].start, row[-1].end)
            until = f"{self.cursor.source[whole]} UNTIL{self.cursor.source[span]}"
            self._go_past(row)
            self.reporter.fail(codes.QUESTION_BEHIND, span, None,
                               found=found, fix="", until=until)  # fmt: skip

    def _answer(self, row: Sequence[Token]) -> None:
        for token in row:
            self.reporter.answer(token)

    def _go_past(self, row: Sequence[Token]) -> None:
        self._answer(row)
        self.cursor.i += len(row)

    def _report(self, row: Sequence[Token], whole: Span, fix: str = "", **said: str) -> None:
        self._go_past(row)
        span = Span(row[0].start, row[-1].end)
        place = Span(whole.start, span.end) if fix else None
        values = {"before": shortened(self.cursor.source[whole]), "words": self._text(row)}
        self.reporter.fail(codes.WORDS_BEHIND, span, place, **{**values, "fix": fix, **said})


def _values(call: str) -> list[Span]:
    """Return where the values of a call stand in its text, without the spaces around them."""
    found: list[Span] = []
    depth = start = 0
    for k, sign in enumerate(call):
        depth += sign == "("
        if sign == "(" and depth == 1:
            start = k + 1
        elif sign in ",)" and depth == 1:
            value = call[start:k]
            first = start + len(value) - len(value.lstrip())
            found.append(Span(first, first + len(value.strip())))
            start = k + 1
        depth -= sign == ")"
        if sign == ")" and not depth:
            break
    return found
