"""Recovery of lines that stand for others: ditto marks, `lo mismo`, `etc.`, `...`.

Knows how people write that the line above is meant again, or that it goes on like that. The robot
does what stands there: each line is written out, or LOOP says how often.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from unicodedata import combining, normalize

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.ast import Assign, Command
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.lexer import NEWLINE, QUOTES, Token
from tiniscript.syntax.reporter import Reporter
from tiniscript.words import BLOCK_ENDS, NUMBER_WORDS, WORDS

_LONGEST = 80  # characters of such a line
_MANY = 8  # instructions that an example repeats
_ENOUGH = 100  # diagnostics that are looked at
_OFTEN = "4"  # times, in an example
_MARKS = re.compile(rf"[-\s–—_]*(?:[{re.escape(QUOTES)}]+|,(?:\s*,)+)[-\s–—_,{re.escape(QUOTES)}]*")
_THEN = r"(?:(?:Y|E|AND|LUEGO|DESPUES|THEN) +)*"
_SAME = re.compile(
    _THEN + r"(?:IDEM|DITTO|IGUAL|(?:LO|LA|THE)? ?(?:MISMO|MISMA|SAME)(?: THING)?|OTRA VEZ|DE NUEVO"
    r"|NUEVAMENTE|AGAIN|ONCE MORE)(?: (?:OTRA VEZ|DE NUEVO|AGAIN))?"
    r"(?: (?:QUE|DE|A|AS|COMO) (?:LA |LO |EL )?(?:ARRIBA|ANTES|ANTERIOR|DE ARRIBA|ABOVE|BEFORE))?"
    r"(?:(?: POR)? (?P<often>[0-9]{1,3}|DOS|TRES|CUATRO|CINCO) ?(?:VECES|TIMES)"
    r"(?P<more> MAS| MORE)?)?"
)
_SO_ON = re.compile(
    r"(?:(?:Y|AND|E) +)?(?:ETC(?:ETERA)?|ASI SUCESIVAMENTE|SO ON|SO FORTH)\b.*|Y ASI\b.*|"
    r"ASI (?:SIEMPRE|HASTA|VARIAS|MUCHAS|TODO)\b.*|Y (?:SIGUE|MAS|TODO)(?: ASI| ESO)?"
)
_DOTS = re.compile(r"[\s,]*(?:\.[\s.]*\.|…[\s.…]*)")


class AgainRecovery:
    def __init__(self, cursor: Cursor, reporter: Reporter, in_block: BlockRecovery) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.in_block = in_block
        self._said: dict[int, int] = {}  # of a line: the one above it that says more, see `_above`

    def line(self) -> None:
        """Report an instruction at the cursor that says no more than that it is done again."""
        row = self._row()
        text = self._text(row)
        if not text or self.in_block.is_name(row[0].text):
            return
        if _MARKS.fullmatch(text):
            self._same(row, text, is_mark=True)
        if same := _SAME.fullmatch(text.strip(" .!")):
            if same["often"]:
                times = int(NUMBER_WORDS.get(same["often"], same["often"]))
                self._so_often(row, str(times + bool(same["more"])))
            self._same(row, text, is_mark=False)
        if _SO_ON.fullmatch(text) or _DOTS.fullmatch(text):
            self._goes_on(row)

    def _same(self, row: Sequence[Token], text: str, is_mark: bool) -> None:
        above = self._above(row[0])
        if above is None:
            return
        values = {"found": text, "right": above}
        whole = self._loop("2")
        if not is_mark and above and whole.count(";") > 2:  # more than one instruction
            values = {"found": text, "right": "", "last": above, "all": whole}
        self._skip(row)
        self.reporter.fail(codes.SAME_AGAIN, Span(row[0].start, row[-1].end), None, **values)

    def _so_often(self, row: Sequence[Token], times: str) -> None:
        """`y lo mismo 3 veces`: three times in all, or three more."""
        whole = self._loop(times)
        if whole:
            self._skip(row)
            span = Span(row[0].start, row[-1].end)
            self.reporter.fail(codes.SAME_AGAIN, span, None, right="", often=whole)

    def _loop(self, times: str) -> str:
        """Return the loop that does so often all that stands before, nothing where that is long."""
        blocks = self.in_block.blocks
        before = [each for each in blocks.here if isinstance(each, Command | Assign)]
        rows = _once([self.cursor.source[each.span] for each in before])
        if len(before) != len(blocks.here) or blocks.open or not 0 < len(rows) <= _MANY:
            return ""
        return ";".join((f"LOOP({times})", *rows, BLOCK_ENDS["LOOP"]))

    def behind(self) -> None:
        """`F(2, 80), etc.`, `F(2, 80) ...` from behind the instruction on."""
        row = self._row()
        text = self._text(row).strip(" ,")
        is_row = len(self.in_block.blocks.here) > 1  # `F(2, 80)...` ends a sentence
        if text and (_SO_ON.fullmatch(text) or (is_row and _DOTS.fullmatch(text))):
            self._goes_on(row)

    def _row(self) -> Sequence[Token]:
        """Return the rest of the instruction, nothing where it is long."""
        tokens, end = self.cursor.tokens, self.cursor.i
        while tokens[end].kind not in AT_END:
            end += 1
            if tokens[end].start - tokens[self.cursor.i].start > _LONGEST:
                return ()
        return tokens[self.cursor.i : end]

    def _text(self, row: Sequence[Token]) -> str:
        """Return what a row says, in capitals and without accents."""
        if not row:
            return ""
        text = self.cursor.source[Span(row[0].start, row[-1].end)].upper()
        return " ".join("".join(c for c in normalize("NFD", text) if not combining(c)).split())

    def _skip(self, row: Sequence[Token]) -> None:
        for token in row:
            self.reporter.answer(token)
        self.cursor.i += len(row)

    def _above(self, first: Token) -> str | None:
        """Return what is meant again: the line above, or the instruction before on this line.

        It is "" where that line has more than instructions. None where nothing stands before.
        """
        tokens, k = self.cursor.tokens, self.cursor.i - 1
        if k < 0:
            return None
        source = self.cursor.source
        if tokens[k].kind is not NEWLINE:  # `F(2, 80); "`
            here = [each for each in self.in_block.blocks.here if isinstance(each, Command)]
            return source[here[-1].span] if here else None
        line = source.position(first.start)[0]
        number = line - 1
        while number > 0:
            text = source.line_text(number).partition("//")[0].strip()
            if text and not _MARKS.fullmatch(text) and not _SAME.fullmatch(text.upper()):
                text = text.partition("|")[2].strip() if "|" in text else text
                words = {word.upper() for word in re.findall(r"\w+", text)}
                blocks = {*BLOCK_ENDS, *BLOCK_ENDS.values(), "ELSE", "ELSEIF"}
                is_wrong = any(
                    source.position(each.span.start)[0] == number
                    for each in self.reporter.diagnostics[:_ENOUGH]
                )
                is_plain = not (words & blocks or is_wrong) and words & {*WORDS}
                self._said[line] = number
                return text.rstrip(" ;") if is_plain else ""
            number = self._said.get(number, number - 1)
        self._said[line] = 0
        return None

    def _goes_on(self, row: Sequence[Token]) -> None:
        if not self.in_block.blocks.here:
            return
        self._skip(row)
        span = Span(row[0].start, row[-1].end)
        found = self.cursor.source[span].strip(" ,")
        values = {"found": found, "all": self._loop(_OFTEN)}
        self.reporter.fail(codes.AND_SO_ON, span, None, **values)


def _once(rows: list[str]) -> list[str]:
    """Return the rows that the others repeat: F and L of `F; L; F; L`."""
    said = [re.sub(r"\s", "", each).upper() for each in rows]
    for length in range(1, len(rows) // 2 + 1):
        if len(rows) % length == 0 and said == said[:length] * (len(rows) // length):
            return rows[:length]
    return rows
