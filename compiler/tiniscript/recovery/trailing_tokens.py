"""The content of words after an instruction, beyond that of the instruction.

Knows which words begin an instruction, and which numbers and words only repeat. Knows no row.
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
    NEAR_COST,
    Lexeme,
    Names,
    brackets_end,
    lexemes,
)
from tiniscript.syntax.blocks import WORD_OF_END
from tiniscript.syntax.lexer import NUMBER, QUOTES, UNKNOWN_SIGN, WORD
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
    """The context of an instruction: `depth` is the number of open blocks.

    `instructions_above` are the lines before it, "" for one without instructions, None for one that
    begins a block.
    """

    text: str
    names: Names
    depth: int
    instructions_above: Sequence[str | None]


def token_width(token: Lexeme) -> int:
    """Return the width of a token in characters, including the space before it."""
    return len(token.space or "") + len(token.source or "")


def instruction_length(tokens: Sequence[Lexeme], names: Names) -> int:
    """Return the number of tokens at a line's start that form a whole instruction."""
    first_text, second_text = tokens[0].text, tokens[1].text if len(tokens) > 1 else ";"
    if first_text in names.defs or (second_text == "=" and first_text not in WORDS):
        failure = lines.parse_line(tokens, names)
        failure_index = failure.failed_at if isinstance(failure, Failure) else 0
        is_right = lines.is_right(tokens[:failure_index], names)
        return failure_index if is_right and tokens[failure_index].space else 0
    word_row = WORDS.get(first_text)
    if word_row is None and not names.takes_values(names.find_meaning(first_text, NEAR_COST)):
        return 0
    if first_text == "DEF":
        return 2 if len(tokens) > 1 and tokens[1].kind is WORD else 0
    if word_row is not None and not word_row.arguments:
        is_whole = word_row.role.name in ("stop", "start", "break", "end", "arm")
        return int(is_whole and second_text not in ("(", "="))
    end = brackets_end(tokens, 1)
    if end and end < len(tokens) and tokens[end].text == "UNTIL":
        return brackets_end(tokens, end + 1) or end
    return end


class TrailingTokens:
    """An instruction and the words after it; or words without one, where `instruction_size` is 0.

    `instructions_before` are the other instructions of its line, None for one of a block. `command`
    is its first word if that is one of the language, otherwise "". `spoken_call` is the call where
    words say it.
    """

    def __init__(
        self, line_context: LineContext, start_offset: int, tokens: Sequence[Lexeme],
        instruction_size: int, instructions_before: Sequence[str | None], spoken_call: str = "",
    ) -> None:  # fmt: skip
        text, self.names, depth, instructions_above = line_context
        self.is_spoken = bool(spoken_call)
        self.tokens = lexemes(spoken_call) if spoken_call else tokens[:instruction_size]
        self.row_tokens = tokens[instruction_size:]
        self.instructions_before, self.has_instruction_before = (
            [*instructions_above, *instructions_before],
            bool(instructions_before),
        )
        self.is_later = self.instructions_before[-1:] not in ([], [None])
        self.is_in_block = depth > 0
        ends = [*accumulate(map(token_width, tokens), initial=start_offset)][1:]
        spans = [
            Span(end - len(token.source or ""), end)
            for token, end in zip(tokens, ends, strict=True)
        ]
        call_span = Span(
            spans[0].start, spans[instruction_size - 1].end if instruction_size else spans[0].start
        )
        self.whole_span = Span(call_span.start, ends[-1])
        self.words_span = Span(spans[instruction_size].start, ends[-1])
        self.call_text = spoken_call or text[slice(*call_span)]
        self.words_text = text[slice(*self.words_span)]
        self.spans = [call_span, *spans[instruction_size:]]
        self.text = text
        concept = (
            self.names.find_meaning(self.tokens[0].text, NEAR_COST) if instruction_size else ""
        )
        word_row = WORDS.get(concept)
        self.is_arm = word_row is not None and word_row.role.belongs_to_blocks
        self.command = WORD_OF_END.get(concept, concept)
        self.has_until = any(token.text == "UNTIL" for token in self.tokens)
        self.time_match = _TIME_OF_CALL.match(self.call_text)
        self.power_match = _POWER_OF_CALL.search(self.call_text)
        kinds = [
            lexicon_meaning(token.text, kind)
            for token in self.row_tokens
            for kind in ("value", "unit", "number")
        ]
        self.has_percent = any("%" in kind or kind == ("100",) for kind in kinds)  # `por ciento`
        self.number_texts = {token.text for token in self.tokens if token.kind is NUMBER}

    def may_say_something(self) -> bool:
        """Return whether the words may have a meaning."""
        if not self.tokens:
            return not lines.is_right(self.row_tokens, self.names)
        if self._is_factor():
            return False
        has_dots = self.is_later and all(token.text in DOTS for token in self.row_tokens)
        kinds = {token.kind for token in self.row_tokens}
        has_sign = has_dots or NUMBER in kinds or self.words_text == "()"
        return WORD in kinds or (has_sign and lines.is_right(self.tokens, self.names))

    def _is_factor(self) -> bool:
        """Return whether the words continue a value of the instruction: `V = 2 x SIDE`."""
        signs, values = (
            [token.text for token in self.row_tokens[:2]],
            (self.tokens[-1], *self.row_tokens[1:2]),
        )
        is_set = [token.text for token in self.tokens[1:2]] == ["="]
        return (
            is_set
            and signs[0] in ("X", "·")
            and len(values) > 1
            and all(
                token.kind is NUMBER or token.text in self.names.known_names.values
                for token in values
            )
        )

    def labels(self) -> list[str]:
        """Return the classes of the instruction and of each word, as patterns match them."""
        return [self._label_of_call(), *(self._label_of(k) for k in range(len(self.row_tokens)))]

    def _label_of_call(self) -> str:
        command, word_row = self.command, WORDS.get(self.command)
        is_timed = word_row is not None and word_row.role.has_duration
        if self.tokens:
            is_instruction = word_row is not None and not self.is_arm and command != "START"
            labels: dict[str, object] = {
                command: True,
                "@any": True,
                "@cmd": is_instruction,
                "@did": self.tokens[0].text in self.names.defs,
                "@set": [token.text for token in self.tokens[1:2]] == ["="],
                "@move": command in MOVES,
                "@clock": (is_timed or command == "BEEP") and not self.has_until,
                "@asked": self.has_until,
                "@unasked": is_timed and not self.has_until,
                "@outer": not self.is_in_block,
                "@more": is_instruction and self.has_instruction_before,
                "@later": self.is_later and not self.is_arm,
            }
        else:
            is_end = _BLANK_TEXT.match(self.text, self.whole_span.end) and not self.is_in_block
            labels = {
                "@none": True,
                "@after": self.is_later,
                "@last": self.is_later and is_end,
                "@unbegun": not _SETUP_AT_START.match(self.text),
                "@opening": not _SETUP_AT_START.match(self.text) and self._is_opening(),
            }
        return join_labels("\x01", labels)

    def _is_opening(self) -> bool:
        """Return whether words are the first line of a text, and others follow."""
        text_before, text_after = (
            self.text[: self.whole_span.start],
            self.text[self.whole_span.end :],
        )
        return (
            not text_before.strip()
            and bool(text_after.strip())
            and not text_after.split("\n")[0].strip()
        )

    def _label_of(self, k: int) -> str:
        token = self.row_tokens[k]
        text, previous_text, following_text = token.text, self._text_at(k - 1), self._text_at(k + 1)
        is_number = self.number(k) is not None
        is_counted = (
            lexicon_meaning(following_text, "times")
            or following_text == "X"
            or lexicon_meaning(text, "often")
            or text[0] == "X"
        )
        is_multiplied = lexicon_meaning(previous_text, "multiplied", "times") or previous_text in (
            "X",
            "*",
        )
        is_multiplied = is_multiplied or self.meant_word(previous_text) == "LOOP"
        concept = (
            lexicon_concept(text) if token.kind is WORD and not self.names.is_name(text) else None
        )
        is_known_concept = (
            concept is None or concept in WORDS or self.names.is_device_or_end(concept)
        )
        is_own_name = token.source == "l" or text in words_set(self.text)
        word_row = None if is_own_name else WORDS.get(text)
        labels = {
            "@number": is_number,
            "@often": is_number
            and (is_counted or (is_multiplied and not lexicon_meaning(following_text, "unit"))),
            "@percent": is_number and self.has_percent,
            "@in_s": lexicon_meaning(text, "unit")[:1] == ("s",),
            "@other": text not in WORDS
            and self.meant_word(text) == OPPOSITE_MOVES.get(self.command),
            "@paced": self._is_paced(k),
            "@told": self.tokens and self._is_redundant(k),
            f"@no{concept}": not is_known_concept,
            "@call": word_row and word_row.is_call,
            "@order": word_row and word_row.role.is_instruction,
            "@ask": self.meant_word(text) in ASKING_WORDS,
            "@quote": text in QUOTES and text != "`",
            "@mark": text in MARKS,
            "@dots": text == "…" or (text == "." and "." in (previous_text, following_text)),
        }
        return join_labels(self.names.label(token)[:-2], labels)

    def _text_at(self, k: int) -> str:
        return self.row_tokens[k].text if 0 <= k < len(self.row_tokens) else ""

    def meant_word(self, word: str) -> str:
        """Return the word of the language that is meant, or ""."""
        meant_text = "" if word in EXTENTS else self.names.find_meaning(word)
        return WORD_OF_END.get(meant_text, meant_text)

    def number(self, k: int) -> str | None:
        """Return the number at a place in digits, None if there is none."""
        token = self.row_tokens[k]
        if token.kind is NUMBER:
            return token.text
        if token.text in self.names.known_names.values:
            return None
        meaning = lexicon_meaning(token.text, "number") or lexicon_meaning(token.text, "often")
        if meaning:
            return meaning[0]
        return token.text[1:] if re.fullmatch("X[0-9]+", token.text) else None

    def _is_paced(self, k: int) -> bool:
        text = self.row_tokens[k].text
        if self.power_match is None:
            return False
        power_meaning = lexicon_meaning(text, "power")
        is_fast = power_meaning[:1] == ("100",)
        is_changed = bool(k and lexicon_meaning(self.row_tokens[k - 1].text, "extra"))
        is_other = (int(self.power_match[1]) >= _MIDDLE_POWER) is not is_fast
        return lexicon_meaning(text, "pace") != () or bool(
            power_meaning and (is_changed or is_other)
        )

    def _is_redundant(self, k: int) -> bool:
        """Return whether a token adds nothing to the instruction."""
        token, text = self.row_tokens[k], self.row_tokens[k].text
        is_first = not any(token.kind in (WORD, NUMBER) for token in self.row_tokens[:k])
        if token.kind is WORD and self.number(k) is None:
            return not self._is_instruction(k) and not (is_first and self._is_alone(k))
        if self.number(k) is not None:
            unit = lexicon_meaning(self._text_at(k + 1), "unit")
            if self.number(k) in self.number_texts or (unit and unit[0] in ("cm", "°", "steps")):
                return True
            return token.kind is WORD and unit[:1] != ("s",) if is_first or unit else True
        is_number = self._text_at(k + 1)[:1].isdigit() and not self._is_redundant(k + 1)
        is_bracket = text == "(" and (
            is_number or (bool(k) and self.row_tokens[k - 1].kind is WORD)
        )
        if not k:
            is_note_sign = text in _SIGNS_BEFORE_NOTE or (
                token.kind is UNKNOWN_SIGN and text != "#"
            )
            return is_note_sign and not is_bracket and not self.is_arm
        is_list_of_words = text == "," and self.row_tokens[k - 1].kind is NUMBER
        return (
            not is_bracket
            and not is_list_of_words
            and (is_first or text not in _SIGNS_OUTSIDE_NOTES)
        )

    def _is_alone(self, k: int) -> bool:
        """Return whether a single word is probably misspelt, or the name of a DEF."""
        token = self.row_tokens[k]
        words = [token for token in self.row_tokens if token.kind is WORD]
        if self.names.is_name(token.text):
            return len(words) == 1 or token.text in self.names.defs
        if len(words) == 1 and token.text in WORDS and not lexicon_meaning(token.text, "note"):
            return True
        is_explained = (
            self.meant_word(token.text)
            or lexicon_meaning(token.text, "power")
            or self.command == "START"
        )
        if is_explained or len(words) > 1:
            return False
        source = token.source or ""
        is_capital_name = len(source) > 1 and source.isupper()
        return is_capital_name or nearest(token.text, _LONG_WORDS) is not None

    def _is_instruction(self, k: int) -> bool:
        """Return whether the word at a place adds something to the instruction."""
        text, command = self.row_tokens[k].text, self.command
        is_last = not any(token.kind in (WORD, NUMBER) for token in self.row_tokens[k + 1 :])
        is_after_word = k or len(text) == 1 or lexicon_meaning(text, "count")
        is_small_word = lexicon_meaning(text, "small") and not is_last and is_after_word
        if is_small_word or (command == "BEEP" and lexicon_meaning(text, "note")):
            return False
        if lexicon_meaning(text, "lap", "turn"):
            return command not in ("L", "R", "M") and not (
                command == "B" and lexicon_meaning(text, "lap")
            )
        if lexicon_meaning(text, "on", "off", "act"):
            return True
        if lexicon_meaning(text, "end") or text in WORD_OF_END:
            return self.is_in_block and not self.is_arm
        if lexicon_meaning(text, "until"):
            return command != "SHOW" and self.row_tokens[0].text != "(" and not self.has_until
        concept = self.meant_word(text)
        word_row = WORDS.get(concept)
        is_repetition = concept == command or (concept == "S" and self.has_until)
        if (
            is_repetition
            or word_row is None
            or word_row.role.belongs_to_values
            or concept == "START"
        ):
            return False
        return command not in ("LOOP", "DEF", "S", "STOP") or concept not in ("S", "LOOP", "DEF")


@lru_cache(maxsize=1)
def words_set(text: str) -> frozenset[str]:
    """Return the variables that a text assigns, which are reported at their own lines."""
    return frozenset(re.findall(r"\b(\w+)\s*=", text.upper()))


def join_labels(first_label: str, labels: Mapping[str, object]) -> str:
    return "|".join(
        (
            first_label,
            *(join_labels for join_labels, is_member in labels.items() if is_member),
            "\x02",
        )
    )
