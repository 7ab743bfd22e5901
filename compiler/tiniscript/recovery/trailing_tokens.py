"""What words after an instruction say, beside what the instruction says itself.

Knows which words begin an order, and which numbers and words only repeat. Knows no row.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import lru_cache
from itertools import accumulate
from typing import NamedTuple

from tiniscript.base.source import Span
from tiniscript.base.spelling import nearest
from tiniscript.base.words import (
    EXTENTS,
    MOVES,
    OPPOSITE_MOVES,
    WORDS,
    lexicon_concept,
    lexicon_meaning,
)
from tiniscript.recovery import lines
from tiniscript.recovery.meanings import (
    ASKING_WORDS,
    NEAR,
    WORD_OF_END,
    Lexeme,
    Names,
    closed,
    lexemes,
)
from tiniscript.syntax.lexer import NUMBER, ODD, QUOTES, WORD
from tiniscript.syntax.operators import COMPARISONS
from tiniscript.syntax.outline import Failure

DOTS = ".…"
_BLANK_TEXT = re.compile(r"\s*\Z")
_SETUP_AT_START = re.compile(r"(?i)\s*(?:S[IB]|PING)\s*\|")
MARKS = f"{QUOTES}-–—_,"  # below a line that is meant again
# The first value of a call, and the last one where that is a whole number.
_VALUE_PART = r"(?:[^\s(),]|\([^()]*\))"
_TIME_OF_CALL = re.compile(rf"\w+\s*\(\s*({_VALUE_PART}(?:\s*{_VALUE_PART})*)(?=\s*[,)])")
_POWER_OF_CALL = re.compile(r"(?i)[(,]\s*([0-9]{1,3})\s*\)(?=\s*(?:UNTIL\b|$))")
_MIDDLE_POWER = 60  # a power that is neither fast nor slow
_SIGNS_BEFORE_NOTE = frozenset(("=", ">", "<", "*", ":", ",", "(", *COMPARISONS))
_SIGNS_OUTSIDE_NOTES = frozenset((*COMPARISONS, "*", "+", "==", "!=", "{", "}"))
_LONG_WORDS = tuple(word for word in WORDS if len(word) > 2)


class LineContext(NamedTuple):
    """Where an instruction stands: `depth` blocks are open there.

    `orders_above` are the lines before it, "" for one of no orders, None for one that begins a
    block.
    """

    text: str
    names: Names
    depth: int
    orders_above: Sequence[str | None]


def width(token: Lexeme) -> int:
    """Return how many characters a token of a text takes, with the space before it."""
    return len(token.space or "") + len(token.source or "")


def instruction_length(tokens: Sequence[Lexeme], names: Names) -> int:
    """Return how many tokens begin a line as a whole instruction."""
    first, sign = tokens[0].text, tokens[1].text if len(tokens) > 1 else ";"
    if first in names.defs or (sign == "=" and first not in WORDS):
        failure = lines.right(tokens, names)
        size = failure.at if isinstance(failure, Failure) else 0
        is_right = lines.is_right(tokens[:size], names)
        return size if is_right and tokens[size].space else 0
    word_row = WORDS.get(first)
    if word_row is None and not names.takes_values(names.meant(first, NEAR)):
        return 0
    if first == "DEF":
        return 2 if len(tokens) > 1 and tokens[1].kind is WORD else 0
    if word_row is not None and not word_row.arguments:
        is_done = word_row.role.name in ("stop", "start", "break", "end", "arm")
        return int(is_done and sign not in ("(", "="))
    end = closed(tokens, 1)
    if end and end < len(tokens) and tokens[end].text == "UNTIL":
        return closed(tokens, end + 1) or end
    return end


class Trailing:
    """An instruction of `size` tokens and the words after it; or words without one, where it is 0.

    `before` are the other instructions of its line, None for one of a block. `own` is the word of
    the language that it begins with, "" for none. `spoken` is the call where words say it.
    """

    def __init__(
        self, line_context: LineContext, start: int, tokens: Sequence[Lexeme], size: int,
        before: Sequence[str | None], spoken: str = "",
    ) -> None:  # fmt: skip
        text, self.names, depth, orders_above = line_context
        self.is_said = bool(spoken)
        self.tokens = lexemes(spoken) if spoken else tokens[:size]
        self.row = tokens[size:]
        self.before, self.is_more = [*orders_above, *before], bool(before)
        self.is_later = self.before[-1:] not in ([], [None])
        self.is_in_block = depth > 0
        ends = [*accumulate(map(width, tokens), initial=start)][1:]
        spans = [
            Span(end - len(it.source or ""), end) for it, end in zip(tokens, ends, strict=True)
        ]
        called = Span(spans[0].start, spans[size - 1].end if size else spans[0].start)
        self.place = Span(called.start, ends[-1])
        self.behind = Span(spans[size].start, ends[-1])
        self.call = spoken or text[slice(*called)]
        self.words = text[slice(*self.behind)]
        self.spans = [called, *spans[size:]]
        self.text = text
        concept = self.names.meant(self.tokens[0].text, NEAR) if size else ""
        word_row = WORDS.get(concept)
        self.is_arm = word_row is not None and word_row.role.is_of_blocks
        self.own = WORD_OF_END.get(concept, concept)
        self.is_asked = any(token.text == "UNTIL" for token in self.tokens)
        self.time = _TIME_OF_CALL.match(self.call)
        self.power = _POWER_OF_CALL.search(self.call)
        kinds = [
            lexicon_meaning(it.text, kind)
            for it in self.row
            for kind in ("value", "unit", "number")
        ]
        self.has_percent = any("%" in kind or kind == ("100",) for kind in kinds)  # `por ciento`
        self.numbers = {token.text for token in self.tokens if token.kind is NUMBER}

    def is_aside(self) -> bool:
        """Whether the words may say something: of no instruction, where they are none."""
        if not self.tokens:
            return not lines.is_right(self.row, self.names)
        if self._is_factor():
            return False
        has_dots = self.is_later and all(lexeme.text in DOTS for lexeme in self.row)
        kinds = {lexeme.kind for lexeme in self.row}
        has_sign = has_dots or NUMBER in kinds or self.words == "()"
        return WORD in kinds or (has_sign and lines.is_right(self.tokens, self.names))

    def _is_factor(self) -> bool:
        """Whether the words go on with a value of the instruction: `V = 2 x SIDE`."""
        signs, values = [lexeme.text for lexeme in self.row[:2]], (self.tokens[-1], *self.row[1:2])
        is_set = [token.text for token in self.tokens[1:2]] == ["="]
        return (
            is_set
            and signs[0] in ("X", "·")
            and len(values) > 1
            and all(it.kind is NUMBER or it.text in self.names.known.values for it in values)
        )

    def labels(self) -> list[str]:
        """Return the classes of the instruction and of each word, as patterns match them."""
        return [self._label_of_call(), *(self._label_of(k) for k in range(len(self.row)))]

    def _label_of_call(self) -> str:
        own_word, word_row = self.own, WORDS.get(self.own)
        is_timed = word_row is not None and word_row.role.lasts
        if self.tokens:
            is_instruction = word_row is not None and not self.is_arm and own_word != "START"
            labels: dict[str, object] = {
                own_word: True,
                "@any": True,
                "@cmd": is_instruction,
                "@did": self.tokens[0].text in self.names.defs,
                "@set": [token.text for token in self.tokens[1:2]] == ["="],
                "@move": own_word in MOVES,
                "@clock": (is_timed or own_word == "BEEP") and not self.is_asked,
                "@asked": self.is_asked,
                "@unasked": is_timed and not self.is_asked,
                "@outer": not self.is_in_block,
                "@more": is_instruction and self.is_more,
                "@later": self.is_later and not self.is_arm,
            }
        else:
            is_end = _BLANK_TEXT.match(self.text, self.place.end) and not self.is_in_block
            labels = {
                "@none": True,
                "@after": self.is_later,
                "@last": self.is_later and is_end,
                "@unbegun": not _SETUP_AT_START.match(self.text),
                "@opening": not _SETUP_AT_START.match(self.text) and self._is_opening(),
            }
        return label("\x01", labels)

    def _is_opening(self) -> bool:
        """Whether words are the first line of a text, and others follow."""
        before, after = self.text[: self.place.start], self.text[self.place.end :]
        return not before.strip() and bool(after.strip()) and not after.split("\n")[0].strip()

    def _label_of(self, k: int) -> str:
        token = self.row[k]
        text, before, after = token.text, self._text(k - 1), self._text(k + 1)
        is_number = self.number(k) is not None
        is_counted = (
            lexicon_meaning(after, "times")
            or after == "X"
            or lexicon_meaning(text, "often")
            or text[0] == "X"
        )
        is_multiplied = lexicon_meaning(before, "multiplied", "times") or before in ("X", "*")
        is_multiplied = is_multiplied or self.means(before) == "LOOP"
        concept = (
            lexicon_concept(text) if token.kind is WORD and not self.names.is_name(text) else None
        )
        is_of_kit = concept is None or concept in WORDS or self.names.has(concept)
        is_own_name = token.source == "l" or text in set_in(self.text)
        word_row = None if is_own_name else WORDS.get(text)
        labels = {
            "@number": is_number,
            "@often": is_number
            and (is_counted or (is_multiplied and not lexicon_meaning(after, "unit"))),
            "@percent": is_number and self.has_percent,
            "@in_s": lexicon_meaning(text, "unit")[:1] == ("s",),
            "@other": text not in WORDS and self.means(text) == OPPOSITE_MOVES.get(self.own),
            "@paced": self._is_paced(k),
            "@told": self.tokens and self._is_told(k),
            f"@no{concept}": not is_of_kit,
            "@call": word_row and word_row.is_call,
            "@order": word_row and word_row.role.is_instruction,
            "@ask": self.means(text) in ASKING_WORDS,
            "@quote": text in QUOTES and text != "`",
            "@mark": text in MARKS,
            "@dots": text == "…" or (text == "." and "." in (before, after)),
        }
        return label(self.names.label(token)[:-2], labels)

    def _text(self, k: int) -> str:
        return self.row[k].text if 0 <= k < len(self.row) else ""

    def means(self, word: str) -> str:
        """Return the word of the language that is said, "" where none is."""
        meant = "" if word in EXTENTS else self.names.meant(word)
        return WORD_OF_END.get(meant, meant)

    def number(self, k: int) -> str | None:
        """Return the number at a place in digits, None where there is none."""
        token = self.row[k]
        if token.kind is NUMBER:
            return token.text
        if token.text in self.names.known.values:
            return None
        text = lexicon_meaning(token.text, "number") or lexicon_meaning(token.text, "often")
        if text:
            return text[0]
        return token.text[1:] if re.fullmatch("X[0-9]+", token.text) else None

    def _is_paced(self, k: int) -> bool:
        text = self.row[k].text
        if self.power is None:
            return False
        sentence = lexicon_meaning(text, "power")
        is_fast = sentence[:1] == ("100",)
        is_changed = bool(k and lexicon_meaning(self.row[k - 1].text, "extra"))
        is_other = (int(self.power[1]) >= _MIDDLE_POWER) is not is_fast
        return lexicon_meaning(text, "pace") != () or bool(sentence and (is_changed or is_other))

    def _is_told(self, k: int) -> bool:
        """Whether a token says nothing that the instruction does not."""
        token, text = self.row[k], self.row[k].text
        is_first = not any(lexeme.kind in (WORD, NUMBER) for lexeme in self.row[:k])
        if token.kind is WORD and self.number(k) is None:
            return not self._is_order(k) and not (is_first and self._is_alone(k))
        if self.number(k) is not None:
            unit = lexicon_meaning(self._text(k + 1), "unit")
            if self.number(k) in self.numbers or (unit and unit[0] in ("cm", "°", "steps")):
                return True
            return token.kind is WORD and unit[:1] != ("s",) if is_first or unit else True
        is_number = self._text(k + 1)[:1].isdigit() and not self._is_told(k + 1)
        is_bracket = text == "(" and (is_number or (bool(k) and self.row[k - 1].kind is WORD))
        if not k:
            is_note_sign = text in _SIGNS_BEFORE_NOTE or (token.kind is ODD and text != "#")
            return is_note_sign and not is_bracket and not self.is_arm
        is_list_of_words = text == "," and self.row[k - 1].kind is NUMBER
        return (
            not is_bracket
            and not is_list_of_words
            and (is_first or text not in _SIGNS_OUTSIDE_NOTES)
        )

    def _is_alone(self, k: int) -> bool:
        """Whether a single word is rather a misspelt one, or the name of a DEF."""
        token = self.row[k]
        words = [lexeme for lexeme in self.row if lexeme.kind is WORD]
        if self.names.is_name(token.text):
            return len(words) == 1 or token.text in self.names.defs
        if len(words) == 1 and token.text in WORDS and not lexicon_meaning(token.text, "note"):
            return True
        is_explained = (
            self.means(token.text) or lexicon_meaning(token.text, "power") or self.own == "START"
        )
        if is_explained or len(words) > 1:
            return False
        source = token.source or ""
        is_capital_name = len(source) > 1 and source.isupper()
        return is_capital_name or nearest(token.text, _LONG_WORDS) is not None

    def _is_order(self, k: int) -> bool:
        """Whether the word at a place says what the instruction does not."""
        text, own_word = self.row[k].text, self.own
        is_last = not any(lexeme.kind in (WORD, NUMBER) for lexeme in self.row[k + 1 :])
        is_after_word = k or len(text) == 1 or lexicon_meaning(text, "count")
        is_small_word = lexicon_meaning(text, "small") and not is_last and is_after_word
        if is_small_word or (own_word == "BEEP" and lexicon_meaning(text, "note")):
            return False
        if lexicon_meaning(text, "lap", "turn"):
            return own_word not in ("L", "R", "M") and not (
                own_word == "B" and lexicon_meaning(text, "lap")
            )
        if lexicon_meaning(text, "on", "off", "act"):
            return True
        if lexicon_meaning(text, "end") or text in WORD_OF_END:
            return self.is_in_block and not self.is_arm
        if lexicon_meaning(text, "until"):
            return own_word != "SHOW" and self.row[0].text != "(" and not self.is_asked
        concept = self.means(text)
        word_row = WORDS.get(concept)
        is_repetition = concept == own_word or (concept == "S" and self.is_asked)
        if is_repetition or word_row is None or word_row.role.is_of_values or concept == "START":
            return False
        return own_word not in ("LOOP", "DEF", "S", "STOP") or concept not in ("S", "LOOP", "DEF")


@lru_cache(maxsize=1)
def set_in(text: str) -> frozenset[str]:
    """Return the words that a text sets, which is told at their own lines."""
    return frozenset(re.findall(r"\b(\w+)\s*=", text.upper()))


def label(first: str, labels: Mapping[str, object]) -> str:
    return "|".join((first, *(label for label, is_so in labels.items() if is_so), "\x02"))
