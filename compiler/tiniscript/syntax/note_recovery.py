"""Recovery of words behind a whole instruction: `F(1, 80) voy a la bodega` has a note without //.

Knows which words ask the robot for something, so that no order is taken for a note. What asks for
another number, for a round more or for an end is said in words.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.ast import Command
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.blocks import Block
from tiniscript.syntax.call_suggestions import LONGEST
from tiniscript.syntax.clauses import sentence_at
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, ODD, QUOTES, WORD, Token
from tiniscript.syntax.near import near_at
from tiniscript.syntax.operators import COMPARISONS
from tiniscript.syntax.phrases import (
    AFTER_HEADER,
    AGAIN,
    BEFORE_POWER,
    BETWEEN,
    ENDS_OF_ANY,
    FILLERS,
    OFTEN_SAID,
    TIMES,
)
from tiniscript.syntax.reporter import Reporter, Resumed
from tiniscript.syntax.suggestions import shortened
from tiniscript.syntax.times_recovery import says_how_often
from tiniscript.words import (
    BLOCK_ENDS,
    NOTE_WORDS,
    NUMBER_WORDS,
    OTHER_WAY,
    SWITCH_WORDS,
    TURN_WORDS,
    UNITS,
    WORDS,
    is_guessed,
    meant_by,
    nearest,
)

# Signs that stand before a note, and the words of one.
_LEADING = frozenset(("=", ">", "<", "*", ":", ",", "\\", "→", "←", "=>"))
_BARE = ":,\\* " + QUOTES  # signs that a note needs not
_AGAIN_ALONE = frozenset(("AGAIN", "NUEVAMENTE", "REPITO", "REPETIDO"))
_NEVER_ENDS = frozenset(("FOREVER", "ETERNAMENTE", "INFINITO", "SIEMPRE"))
_WITHOUT_END = frozenset(("PARAR", "PARA", "FIN", "DETENERSE", "DETENER", "STOP", "STOPPING"))
_ASKING = frozenset(("SI", "IF", "CUANDO", "WHEN", "MIENTRAS", "WHILE", "SINO", "ELSE", "UNLESS"))
# Orders for which the language has no single word.
_OTHER_ORDERS = frozenset("VUELVE VOLVER RETURN BAILA BAILAR DANCE ACELERA CANTA".split())  # noqa: SIM905
_FAST = ("RAPIDO", "RAPIDA", "RAPIDITO", "FAST", "FUERTE", "VELOZ", "MAX", "MAXIMO")
_SLOW = ("LENTO", "LENTA", "LENTITO", "SLOW", "SLOWLY", "DESPACIO", "DESPACITO")
_CHANGING = frozenset(("FASTER", "SLOWER"))  # than now, whatever the power is
_ASKING_FOR = frozenset((
    "ESQUIVA", "EVITA", "ABRE", "CIERRA", "AGARRA", "COGE", "SUELTA", "GRAB", "AVOID", "DODGE",
))  # fmt: skip
_OTHER_UNITS = ("cm", "°", "steps")  # that no instruction has, and pupils measure in
_HALF = 60  # a power that is neither fast nor slow


class NoteRecovery:
    def __init__(self, cursor: Cursor, reporter: Reporter, in_block: BlockRecovery) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.in_block = in_block
        self.known = in_block.known

    def behind(self, first: Token, before: Token, header: Block | None) -> None:
        """Report words from the cursor to the end of the line that are no instruction."""
        row = self._row()
        words = [token for token in row if token.kind is WORD]
        if not (words or self._is_measured(row) or self._is_quoted(first, row)):
            return
        if self._is_call(row):
            return
        whole = Span(first.start, before.end)
        known = WORDS.get(first.text)
        if header is None and known is not None and known.role in ("move", "wait", "beep"):
            self._condition(row, whole)
        if self._begins_order(row, header) and not self._is_title(first, row):
            return
        said = self.asked(first, row, whole)
        if said is None and header is None and self._orders(row, whole):
            return
        if said is None and not self._is_note(first, row, header):
            return
        shown = shortened(self.cursor.source[whole])
        self._go_past(row)
        span = Span(row[0].start, row[-1].end)
        text = self.cursor.source[span]
        if said is not None:
            values = {"before": shown, "words": shortened(text), "fix": "", **said}
            self.reporter.report(codes.WORDS_BEHIND, span, None, **values)
            raise Resumed
        end = self.cursor.token
        note = f"// {text.strip(_BARE)}"
        is_last = end.kind in (NEWLINE, END) or self._ends_line(end)
        is_whole = first.text in WORDS and not self._is_reported(whole) and len(shown) < LONGEST
        place = Span(first.start if is_whole else span.start, span.end)
        fix = f"{self.cursor.source[whole]} {note}" if is_whole else note
        self.reporter.report(
            codes.WORDS_BEHIND, span, place, before=shown, fix=fix if is_last else ""
        )
        raise Resumed

    def _row(self) -> list[Token]:
        """Return the rest of the line, up to a `;`; nothing where it is long."""
        cursor = self.cursor
        end = cursor.i
        while cursor.tokens[end].kind not in AT_END:
            if end - cursor.i > LONGEST or cursor.tokens[end].kind in ("{", "}", "|"):
                return []
            end += 1
        return cursor.tokens[cursor.i : end]

    def _is_measured(self, row: Sequence[Token]) -> bool:
        """`L(0.39, 60) 90°`, `F(2, 80) = 60cm`: what came of it, in a unit that no value has."""
        numbers = [each for each in row if each.kind is NUMBER]
        if len(numbers) != 1 or any(each.kind is WORD for each in row):
            return False
        unit = self.cursor.source[numbers[0].span].lstrip("0123456789. ").upper()
        return UNITS.get(unit, ("", 0))[0] in _OTHER_UNITS

    def _is_quoted(self, first: Token, row: Sequence[Token]) -> bool:
        """`F(1, 80) "adelante"`: words in quotation marks that order nothing else."""
        text = self.cursor.source[row[0].span] if len(row) == 1 else ""
        if text[:1] not in QUOTES or not text.strip(QUOTES).replace(" ", "").isalpha():
            return False
        said = {meant_by(word) for word in text.strip(QUOTES).upper().split()}
        named = said & {*WORDS} if first.text in WORDS else said - {None}
        return named <= {first.text}

    def _ends_line(self, semicolon: Token) -> bool:
        """Whether nothing but its `;` ends the line."""
        after = self.cursor.source.text[semicolon.end :][:200].lstrip(" \t;")
        return not after or after[0] in "\r\n"

    def _go_past(self, row: Sequence[Token]) -> None:
        for token in row:
            self.reporter.answer(token)  # an accent, a sign, quotation marks
        self.cursor.i += len(row)

    def _is_reported(self, span: Span) -> bool:
        found = self.reporter.diagnostics
        return any(span.start <= each.span.start < span.end for each in found)

    def _is_title(self, first: Token, row: Sequence[Token]) -> bool:
        """`START BAILE`, where BAILE is nothing that the program knows."""
        name = row[0].text
        is_known = name in WORDS or meant_by(name) is not None or self.known.is_own(name)
        return first.text == "START" and len(row) == 1 and not is_known

    def _is_call(self, row: Sequence[Token]) -> bool:
        """Whether brackets hold values, or a sign compares or sets something."""
        for k, token in enumerate(row):
            is_leading = all(each.kind != WORD and each.kind != NUMBER for each in row[:k])
            if token.kind == "(" and any(each.kind is NUMBER for each in row[k:]):
                return True
            if token.kind == "(" and k and row[k - 1].end == token.start:
                return True
            if (token.kind in COMPARISONS or token.kind in ("*", "+")) and not is_leading:
                return True
            if token.kind == "," and k and row[k - 1].kind is NUMBER:
                return True
        is_arrow = row[0].kind == "-" and len(row) > 1 and row[1].kind == ">"
        is_sign = row[0].kind not in (WORD, NUMBER, ODD, "(") and row[0].text not in _LEADING
        return is_sign and not is_arrow

    def _begins_order(self, row: Sequence[Token], header: Block | None) -> bool:
        """Whether the first word begins another instruction, or is a name of the program."""
        first = next((token for token in row if token.kind is WORD), row[-1])
        if self.known.is_def(first.text) or self.known.is_own(first.text):
            return len(row) == 1 or self.known.is_def(first.text)
        if header is not None and (first.text in AFTER_HEADER or row[0].text in (":", ",", "=")):
            return True
        if says_how_often(row) and (header is None or header.word != "LOOP"):
            return True
        known = WORDS.get(first.text)
        if header is None and len(row) == 1 and first.text == "FOREVER":
            return False  # `F(1, 80) forever`
        if header is not None and header.word in ("IF", "WHILE") and first.text in _ASKING:
            return False  # `IF(DISTANCE < 30) si hay pared`
        if known is not None:
            return not (known.role in ("operator", "value") and len(row) > 1)
        is_only = len([token for token in row if token.kind is WORD]) == 1
        own = [word for word in WORDS if len(word) > 2]
        is_word = meant_by(first.text) or first.text in (*_FAST, *_SLOW)
        if is_only and len(row) == len(first.text) == 1:
            return True  # `S I`
        if not is_only or is_word:
            return False
        written = self.cursor.source[first.span]
        is_name = len(written) > 1 and written.isupper()  # of a DEF that is missing
        return is_name or nearest(first.text, own) is not None

    # -- what asks for something ----------------------------------------------------------------

    def _condition(self, row: Sequence[Token], whole: Span) -> None:
        """`F(2, 80) cuando no hay pared`, `F(2, 80) mientras no haya pared`."""
        cursor = self.cursor
        text = row[0].text
        if text not in _ASKING or meant_by(text) == "ELSE" or text in ("SINO", "ELSE", "UNLESS"):
            return
        near = near_at(cursor.tokens, cursor.i + 1, self.known)
        if near is None or near.end != cursor.i + len(row) or self._is_reported(whole):
            return
        call = cursor.source[whole]
        fix = f"IF({near.question});{call};ENDIF"
        if text in ("MIENTRAS", "WHILE"):
            is_less = "<" in near.question
            contrary = near.question.replace(*("<", ">") if is_less else (">", "<"))
            fix = f"{call} UNTIL({contrary})"
        self._go_past(row)
        place = Span(whole.start, row[-1].end)
        span = row[0].span
        self.reporter.report(codes.QUESTION_BEHIND, span, place, found=text, fix=fix)
        raise Resumed

    def asked(self, first: Token, row: Sequence[Token], whole: Span) -> dict[str, str] | None:
        """Return how it is written what the words ask for, None where they ask for nothing."""
        texts = [token.text for token in row if token.kind is WORD]
        call = self.cursor.source[whole]
        known = WORDS.get(first.text)
        if row[0].kind == "(":
            return None  # `F(2, 80) (hasta la mesa)`
        pairs = list(pairwise(texts))
        if known is None and self.known.is_def(first.text) and (
            any(pair in AGAIN for pair in pairs) or _AGAIN_ALONE & set(texts)
        ):  # fmt: skip
            return {"again": f"LOOP(2);{call};END_LOOP"}
        if known is None or not known.is_instruction or known.role == "block":
            return None
        loops = [text for text in texts if meant_by(text) == "LOOP" and text not in OFTEN_SAID]
        has_number = any(token.kind is NUMBER or token.text in NUMBER_WORDS for token in row)
        if any(pair in AGAIN for pair in pairs) or _AGAIN_ALONE & set(texts) or (
            loops and not (has_number and texts[-1] in TIMES)
        ):  # fmt: skip
            return {"again": f"LOOP(2);{call};END_LOOP"}
        is_endless = any(a == "SIN" and b in _WITHOUT_END for a, b in pairs)
        is_endless |= any(a in ("TODO", "ALL") and b in ("EL", "THE") for a, b in pairs)
        if known.role in ("move", "wait", "motors") and (is_endless or _NEVER_ENDS & set(texts)):
            return {"endless": f"LOOP(FOREVER);{call};END_LOOP"}
        if known.role in ("move", "wait") and any(
            text in ("HASTA", "UNTIL") or meant_by(text) == "UNTIL" for text in texts
        ):
            return {"until": f"{call} UNTIL(DISTANCE < 10)"} if "UNTIL" not in call else None
        other = OTHER_WAY.get(known.text, "")
        if other and texts == ["AL", "REVES"]:
            return {"other": f"{other}{call[len(known.text) :]}"}
        if texts and texts[0] in _ASKING_FOR and row[0].kind is WORD:
            return {"order": shortened(" ".join(texts).lower())}
        said = {meant_by(text) for text in texts if text not in OFTEN_SAID} & {*OTHER_WAY}
        if said == {other} and not has_number and not BETWEEN & set(texts):
            return {"other": f"{other}{call[len(known.text) :]}"}  # `R(0.39, 60) izquierda`
        powers = [token.text for token in row if token.kind is NUMBER]
        if known.role == "move" and self._wants_power(call, texts, powers):
            return {"power": call}
        return None

    def _wants_power(self, call: str, texts: Sequence[str], numbers: Sequence[str]) -> bool:
        """Whether words say another power than the move has: `F(2, 80) despacio`."""
        power = call.rpartition(",")[2].strip(" )")
        if set(texts) & BEFORE_POWER and numbers:
            return power not in numbers
        if texts == ["A"] and len(numbers) == 1 and len(numbers[0]) == len(power) == 2:
            return power != numbers[0]  # `F(1, 80) a 50`
        if len(texts) > 3 or not power.isdecimal() or not 0 < len(power) < 4:
            return False
        is_more = bool({"MAS", "MORE"} & set(texts)) and bool({*_FAST, *_SLOW} & set(texts))
        if is_more or _CHANGING & set(texts):
            return True
        is_fast = int(power) >= _HALF
        return bool(set(texts) & set(_SLOW if is_fast else _FAST))

    def _orders(self, row: Sequence[Token], whole: Span) -> bool:
        """Report `F(1, 80) y luego retrocede`: each order is an instruction; no note."""
        cursor = self.cursor
        if any(token.text in WORDS and WORDS[token.text].is_instruction for token in row):
            return False
        if row[0].kind is not WORD or self._is_same(row, cursor.source[whole]):
            return False
        sentence = sentence_at(cursor.tokens, cursor.i, self.known)
        if sentence is None or sentence.turn is not None or cursor.tokens[sentence.end] is row[0]:
            return False
        if sentence.end - cursor.i != len(row) or self._is_reported(whole):
            return False
        begin = whole.start
        self._go_past(row)
        place = Span(begin, row[-1].end)
        fix = ";".join((cursor.source[whole], *sentence.orders))
        self.reporter.report(codes.SEVERAL_ORDERS, Span(row[0].start, row[-1].end), place, fix=fix,
                             example=", ".join(sentence.examples))  # fmt: skip
        raise Resumed

    def _is_same(self, row: Sequence[Token], call: str) -> bool:
        """Whether the words say the instruction that they stand behind: `F(1, 80) adelante`."""
        own = self.known.command(call.partition("(")[0].strip().upper())
        said = [self._order(row, k, own.text if own else "") for k in range(len(row))]
        return not any(said)

    # -- what is a note -------------------------------------------------------------------------

    def _is_note(self, first: Token, row: Sequence[Token], header: Block | None) -> bool:
        """Whether no word says what a robot does, but what is there already."""
        text = header.word if header is not None else first.text
        own = self.known.command(text)
        name = own.text if own is not None else text
        ended = {each: block for block, each in BLOCK_ENDS.items()}
        name = ended.get(name, name)
        if any(self._order(row, k, name) for k in range(len(row))):
            return False
        here = self.in_block.blocks.here
        its: set[str] = set()
        for token in self.cursor.tokens[: self.cursor.i][::-1][:LONGEST]:
            its.add(token.text)
            if token is first:
                break
        if first.text not in WORDS and header is None and not (here and isinstance(
            here[-1], Command
        ) and meant_by(first.text)) and not self.known.is_own(first.text):  # fmt: skip
            return False
        return all(self._is_told(row, k, its) for k in range(len(row)))

    def _is_told(self, row: Sequence[Token], k: int, its: set[str]) -> bool:
        """Whether the number at `k` says the same again, counts the lines, or was measured."""
        token = row[k]
        after = row[k + 1].text if k + 1 < len(row) else ""
        if self._is_measured([token]):
            return True
        if token.kind is not NUMBER and UNITS.get(after, ("", 0))[0] == "s":  # `dos segundos`
            return token.text not in NUMBER_WORDS or NUMBER_WORDS[token.text] in its
        if token.kind is not NUMBER:
            return True
        is_first = all(each.kind is not WORD for each in row[:k])
        unit = UNITS.get(after, ("", 0))[0]
        if token.text in its or unit in _OTHER_UNITS:
            return True
        return not is_first and not unit

    def _has_until(self) -> bool:
        """Whether the instruction that was read last ends with its UNTIL."""
        here = self.in_block.blocks.here
        return bool(here) and isinstance(here[-1], Command) and here[-1].until is not None

    def _order(self, row: Sequence[Token], k: int, own: str) -> bool:
        """Whether the word at `k` says what `own` does not."""
        token = row[k]
        text = token.text
        if token.kind is not WORD:
            return False
        is_last = k + 1 == len(row)
        if own == "BEEP" and text in NOTE_WORDS:
            return False
        if text in OFTEN_SAID and k + 1 < len(row) and (k or text in ("A", "E", "PARA")):
            return False
        if self.known.is_def(text):
            return not (k and row[k - 1].text in (*FILLERS, "DEL", "MI", "MY"))  # `fin del salto`
        if text in TURN_WORDS or text in ("VUELTA", "VUELTAS"):
            return own not in (("L", "R", "M", "B") if text[0] == "V" else ("L", "R", "M"))
        if text in SWITCH_WORDS or text in _OTHER_ORDERS:
            return True
        if text in ENDS_OF_ANY:
            return bool(self.in_block.blocks.open) and own not in BLOCK_ENDS
        if text in _ASKING:
            return own not in ("IF", "WHILE")
        if text in ("HASTA", "UNTIL"):
            return own != "SHOW" and row[0].kind != "(" and not self._has_until()
        known = WORDS.get(text)
        if known is not None and known.role in ("value", "operator"):
            return False
        meant = known.text if known is not None else meant_by(text)
        if meant == "S" and self._has_until():
            return False  # `frena antes de la pared`
        if meant is None or meant == own or (own in ("IF", "WHILE") and text in BETWEEN):
            return False
        word = WORDS.get(meant)
        if word is None or word.role in ("value", "operator", "function", "start"):
            return False
        if own in ("LOOP", "DEF", "S", "STOP") and meant in ("S", "LOOP", "DEF"):
            return False
        after = row[k + 1].kind if not is_last else END
        return not is_guessed(text) or after in (NUMBER, END)
