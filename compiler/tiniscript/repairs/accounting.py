"""Whether a change of a text keeps what its author wrote: each number, command and name of it.

Knows which words say the same, which change nothing, and how many of a unit another one is. What
a change takes away without such a reason is lost. Knows no rule that makes repairs: so it holds
for all of them.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from typing import NamedTuple

from tiniscript.diagnostics import codes
from tiniscript.syntax import phrases
from tiniscript.syntax.lexer import NUMBER, ODD, WORD, Token
from tiniscript.syntax.operators import COMPARISONS, OPPOSITES
from tiniscript.syntax.parser import scan
from tiniscript.syntax.suggestions import OPERATOR_WORDS, counted
from tiniscript.words import (
    ALIASES,
    BLOCK_ENDS,
    IN_MILLISECONDS,
    NEAR_WORDS,
    NOTE_WORDS,
    NUMBER_WORDS,
    OTHER_WAY,
    PLACEHOLDERS,
    POWER_WORDS,
    SWITCH_WORDS,
    TURN_WORDS,
    UNITS,
    WORDS,
    meant_by,
    nearest,
)

# What turns a sentence round, or says when it holds. It never goes without a reason.
_TURNING = frozenset((
    "NO", "NOT", "NI", "SIN", "NUNCA", "NEVER", "DONT", "WITHOUT", "MENOS", "EXCEPT", "EXCEPTO",
    "SALVO", "UNLESS", "BUT", "PERO", "SOLO", "ONLY", "EVITA", "AVOID", "HASTA", "UNTIL", "TILL",
    "SI", "IF", "CUANDO", "WHEN", "WHENEVER", "MIENTRAS", "WHILE", "ELSE", "SINO", "OTRO", "ANTES",
    "BEFORE", "ENTRE", "BETWEEN", "CADA", "EVERY", "OR", "AND", "O", "U", *TURN_WORDS,
))  # fmt: skip
_PLAIN = (
    "RETURN START IN EN RANGE STEP I J OF AT ON WITH ITS SU SUS HAY HAYA THERE VALUE VALOR YOUR TU"
    " THAT THIS EACH THAN SEE SEES VE VES VEA VEAS YOU DETECTA DETECTS GRACIAS ES IS SEA"
    " ESTA BE ALGO SERIAL CONSOLE SYSTEM OUT DEL"
)
# What may go: small words, and what this language needs no word for.
_SMALL = frozenset((
    *phrases.FILLERS, *phrases.AFTER_HEADER, *phrases.TIMES, *phrases.BEFORE_POWER,
    *phrases.BEFORE_TIME, *phrases.BEFORE_MOVE, *phrases.BETWEEN, *phrases.BEFORE_SENTENCE,
    *phrases.BEFORE_NAME, *phrases.SETTING, *phrases.CHANGING, *phrases.EVENTS, *phrases.IMPORTING,
    *phrases.TITLES, *phrases.STEPS, *phrases.BEFORE_CALL, *phrases.READING, *phrases.ENDS_OF_ANY,
    *phrases.FRAME_WORDS, *phrases.FRAME_NAMES, *phrases.CASE_WORDS, *phrases.COUNTING,
    *phrases.BEFORE_NOTE, *UNITS, *(name for names in PLACEHOLDERS.values() for name in names),
    *_PLAIN.split(),
)) - _TURNING - {"LEFT", "RIGHT", "IZQUIERDA", "DERECHA", "S", "M"}  # fmt: skip
_COMMANDS_AND_UNITS = {"S": "SEG", "M": "MT"}  # units only right behind a number
_LABEL = re.compile(r"\s*\w+(?:\s+[0-9]+)?\s*:\s*")  # the name of a step
# Two words and more that say what one word does.
_PHRASES = tuple(
    (re.compile(rf"\b{pattern}\b", re.IGNORECASE), word)
    for pattern, word in (
        (r"SI\s+NO(?!\s+(?:HAY|HAYA|VE|ES|ESTA|TIENE|DETECTA))", "ELSE"),
        (r"DE\s+LO\s+CONTRARIO", "ELSE"),
        (r"\A\s*IF\s+NOT?\s*\Z", "ELSE"),
        (r"SIEMPRE\s+QUE", "IF"),
        (r"\A\s*(?:S|STOP)\s+LOOP\s*\Z", "BREAK"),
        (r"BACK\s+UP", "BACK"),
        (r"(?:PARA|DEJA|NO)\s+(?:DE\s+)?AVANZ?C?[AE]R?S?(?:\s+MAS)?", "S"),
        (r"LUZ\s+(?=IZQUIERD|DERECH)", "LUZ_"),
        (r"\A\s*(?:ALGORITMO|PROGRAMA)\s+\w+\s*\Z", ""),
    )
)
# Words of this language of which one may stand for the other in a repair.
_SAME = {
    "STOP": "S", "TRUE": "FOREVER", "WHILE": "LOOP", "FALSE": "NOT",
    BLOCK_ENDS["LOOP"]: BLOCK_ENDS["WHILE"],
}  # fmt: skip
_STRUCTURAL = ("alias", "end", "setup", "start", "later")
_EXAMPLES = (80.0, 440.0)  # a power and a tone, which pupils leave out
_OF_RANGE = ("ENTRE", "BETWEEN", "HASTA", "DESDE")  # `RANDOM(entre 1 y 6)`
_AGAIN = ("OTRA", "NUEVO", "ONCE", "MORE")
# Repairs that write a number in another way, and those that name or note what was written.
_REWRITES = frozenset((
    codes.UNIT, codes.BAD_NUMBER, codes.LINE_NUMBER, codes.LOOP_COUNTS, codes.NEEDLESS_FRAME,
    codes.LISTS, codes.SETUP_UNKNOWN, codes.OTHER_ASSIGNMENT, codes.QUOTE, codes.WANTS_CONDITION,
    codes.MIXED_COMPARE,
))  # fmt: skip
_RENAMES = frozenset((
    codes.PROSE, codes.UNKNOWN_WORD, codes.UNKNOWN_NAME, codes.OTHER_NOTE, codes.SETUP_UNKNOWN,
    codes.BAD_NAME, codes.PASTED, codes.LINE_NUMBER, codes.BAD_NUMBER,
    codes.QUOTE, codes.LISTS, codes.WANTS_CONDITION, codes.WORDS_SHOWN, codes.MIXED_COMPARE,
    codes.NAMED_ARGUMENT, codes.WORDS_BEHIND, codes.BY_CHANCE,
))  # fmt: skip


class _Content(NamedTuple):
    """What a text says: its numbers, its words in their order, its signs, its notes' words."""

    numbers: Counter[float]
    words: list[str]
    signs: Counter[str]
    in_notes: Counter[str]


def lost(before: str, after: str, code: codes.Code | None = None) -> list[str]:
    """Return what `before` says and `after` does not, sorted: numbers, words, `//` for a note."""
    account = _Account(before, after)
    numbers = [] if code in _REWRITES else list(account.lost_numbers())
    words = [] if code in _RENAMES else list(account.lost_words())
    notes = ["//"] if code not in _RENAMES and account.fills_a_note() else []
    return sorted((*numbers, *words, *notes))


def makes_up(before: str, after: str, is_strict: bool = False) -> bool:
    """Whether `after` has a number that `before` does not say.

    What every example has is none, unless it `is_strict`.
    """
    account = _Account(before, after)
    list(account.lost_numbers())
    list(account.lost_words())
    return any(is_strict or number not in _EXAMPLES for number in account.spare.elements())


def makes_up_names(before: str, after: str) -> bool:
    """Whether `after` names something that `before` does not: `SHOW(DISTANCE)` for SHOW alone."""
    old = _content(before).words
    said = {part for word in old for part in word.split("_")}
    meant = {meant_by(word) for word in old}
    for word in _content(after).words:
        is_known = word in WORDS or word in old or word in meant
        if not is_known and not (set(word.split("_")) <= said or nearest(word, old)):
            return not (word == "DISTANCE" and NEAR_WORDS & set(old))
    return False


class _Account:
    """What two texts say, and what of the new one is not used up to explain the old one."""

    def __init__(self, before: str, after: str) -> None:
        self._old, self._new = _content(before), _content(after)
        self._before, self._after = before, after
        self.spare = self._new.numbers - self._old.numbers
        self._said = Counter(self._new.words)

    def lost_numbers(self) -> Iterator[str]:
        if _digits(self._before) == _digits(self._after):
            return  # `1,5` is 1.5, `2.80` is 2, 80
        gone = list((self._old.numbers - self._new.numbers).elements())
        units = {word for word in self._old.words if word in UNITS}
        if IN_MILLISECONDS & set(self._old.words):
            units.add("MS")
        gone = [number for number in gone if not self._is_converted(number, units)]
        words = self._old.words
        if "LOOP" in self._said and any(w in phrases.COUNTING or w == "LOOP" for w in words):
            tokens = scan(self._before).tokens
            if str(counted(tokens, 0)) in {f"{number:g}" for number in self._new.numbers}:
                return
        if set(words) & {"MEDIO", "MEDIA", "HALF", "Y"} and self.spare:
            return  # `1 minuto y 30 segundos`
        for number in gone:
            yield f"{number:g}"

    def _is_converted(self, number: float, units: set[str]) -> bool:
        """Whether a number is there in another unit, which the text names; that one is used up."""
        for unit in units:
            value = number * UNITS[unit][1] / 1000
            for other in self.spare:
                if abs(other - value) < 0.0015 and self.spare[other] > 0:
                    self.spare[other] -= 1
                    return True
        return False

    def lost_words(self) -> Iterator[str]:
        rest = []
        for word in self._old.words:  # what stays as it is goes first
            if self._said[word] > 0:
                self._said[word] -= 1
            elif word not in self._new.words or _is_command(word):
                rest.append(word)
        for word in rest:
            if not self._is_said(word):
                yield word
        if self._loses_a_minus():
            yield "-"

    def _loses_a_minus(self) -> bool:
        """Whether a value changes its sign: in `F-2, 80` and `F(2-80)` the `-` is none."""
        lost = self._old.signs["-"] > self._new.signs["-"]
        is_turned = any(word in OTHER_WAY for word in self._new.words)
        return lost and not is_turned and bool({"SHOW", "M"} & set(self._new.words))

    def fills_a_note(self) -> bool:
        return bool(self._new.in_notes - self._old.in_notes)

    def _is_said(self, word: str) -> bool:
        """Whether `word` is said by another word, number or sign; that word is used up."""
        meant = word if word in WORDS else meant_by(word)
        for other in (meant, _SAME.get(meant or "")):
            if other and self._said[other] > 0:
                self._said[other] -= 1
                return True
        if word == "SI" and not self._old.signs["|"]:  # of a question, in Spanish
            return bool({"IF", "SI", "TRUE", "ELSE"} & set(self._new.words))
        if word in _AGAIN:  # of an order that is there a second time
            commands = Counter(each for each in self._new.words if _is_command(each))
            return any(count > 1 for count in commands.values())
        if word in _SMALL or (word in WORDS and WORDS[word].role in _STRUCTURAL):
            return True
        return (
            self._is_sign(word, meant)
            or self._is_number(word)
            or self._is_part(word)
            or self._is_kind(word, meant)
        )

    def _is_sign(self, word: str, meant: str | None) -> bool:
        """Whether a sign says it: `mayor que`, `no` where a question is turned round."""
        new, old = self._new.signs, self._old.signs
        signs = [sign for sign in new if sign in COMPARISONS]
        is_turned = any(
            old[OPPOSITES[sign]] > new[OPPOSITES[sign]] or not old[sign] for sign in signs
        )
        if meant == "UNTIL" and "LOOP" in self._new.words and not new["<"] + new[">"]:
            return True  # `PARA I = 1 HASTA 4`
        if word in _OF_RANGE and "RANDOM" in self._new.words:
            return True  # `RANDOM(1 hasta 6)`
        if meant == "UNTIL" and "BREAK" in self._new.words:
            return True
        if word in ("NO", "NOT") or meant in ("WHILE", "UNTIL", "FALSE"):
            is_loop = meant in ("WHILE", "UNTIL") and not (
                {"WHILE", "UNTIL", "BREAK"} & set(self._new.words)
            )
            return is_turned and not is_loop
        if word in ("ENTRE", "BETWEEN"):
            return bool(new["/"] or (new["<"] and new[">"]) or "RANDOM" in self._new.words)
        if word in ("IGUAL", "EQUAL", "EQUALS", "DIVIDIDO"):
            return bool(signs or new["/"])
        if word in ("AND", "OR", "Y", "O") and new[";"]:
            return word in ("AND", "Y")
        said = OPERATOR_WORDS.get(word, "")
        if said.isalpha() and (said in self._new.words or any(len(sign) > 1 for sign in signs)):
            return True
        return bool(said and any(sign[:1] == said[:1] for sign in new)) or (
            word in ("MAYOR", "MENOR", "MENOS", "MAS") and is_turned
        )

    def _is_number(self, word: str) -> bool:
        for table in (NUMBER_WORDS, POWER_WORDS, NOTE_WORDS):
            if word in table and self.spare[float(table[word])] > 0:
                self.spare[float(table[word])] -= 1
                return True
        if word in ("MEDIO", "MEDIA", "HALF"):
            return any(number % 1 == 0.5 for number in self.spare)
        if word[:1] == "X" and word[1:].isdecimal() and self.spare[float(word[1:])] > 0:
            return "LOOP" in self._new.words
        if word in ("TWICE", "THRICE"):
            return self._said["LOOP"] > 0
        return word == "X" and bool("LOOP" in self._new.words or self._new.signs["*"])

    def _is_part(self, word: str) -> bool:
        """Whether it is within another word: `MI_VEL` for MI VEL, ELSEIF for ELSE IF, F for F2."""
        others = [other for other in self._said if self._said[other] > 0]
        if any(word in other.split("_") for other in others):
            return True
        if word in ("ELSE", "IF") and "ELSEIF" in self._new.words:
            return True
        if word[:1] in self._new.words and word[1:].isdecimal():
            return float(word[1:]) in self._new.numbers
        return nearest(word, others) is not None

    def _is_kind(self, word: str, meant: str | None) -> bool:
        """Whether what it does is said in another way: a turn, a switch, something near."""
        new = self._new.words
        if word in TURN_WORDS:
            return bool({"L", "R", "M", "S"} & set(new))
        if word in ("IZQUIERDO", "DERECHO", "MOTOR", "MOTORES"):
            return bool({"L", "R", "M", "F", "S"} & set(new))
        if meant in ("L", "R") and meant in new:
            return True  # `R(derecha, 2, 80)`
        if word in SWITCH_WORDS:
            return SWITCH_WORDS[word] in new or "S" in new
        is_ahead = word in ("AHEAD", "ADELANTE", "ENFRENTE") and NEAR_WORDS & set(self._old.words)
        if word in NEAR_WORDS or word in ("TOUCHING", "CLOSE") or is_ahead:
            return "DISTANCE" in new
        if meant in ("F", "L", "R") and "M" in new:  # `mover motor izquierdo 50`
            return True
        if meant == "LOOP":
            return "WHILE" in new  # `repetir hasta`
        if word == "BREAK":
            return bool({"SWITCH", "CASE"} & set(self._old.words))
        if word in BLOCK_ENDS:  # `END IF`
            return BLOCK_ENDS[word] in new
        if word == "TRUE":  # `DISTANCE < 10 = TRUE`
            return any(sign in COMPARISONS for sign in self._new.signs)
        if meant in OTHER_WAY and self._old.signs["-"] > self._new.signs["-"]:
            return OTHER_WAY[meant] in new
        return word == "CUANDO" and "START" in new


def _content(text: str) -> _Content:
    if _LABEL.fullmatch(text):
        text = ""
    for pattern, word in _PHRASES:
        text = pattern.sub(word, text)
    found = scan(text)
    numbers: Counter[float] = Counter()
    words: list[str] = []
    signs: Counter[str] = Counter()
    last: Token | None = None
    for token in found.tokens:
        if token.kind is NUMBER:
            numbers[float(token.text)] += 1
            unit = text[token.start : token.end].lstrip("0123456789.").upper()
            words += [_COMMANDS_AND_UNITS.get(unit, unit)] if unit in UNITS else []
        elif token.kind is WORD:
            if last is not None and last.kind is NUMBER and token.text in _COMMANDS_AND_UNITS:
                words.append(_COMMANDS_AND_UNITS[token.text])
            elif last is None or not _says_it_again(last, token):
                words.append(ALIASES.get(token.text, token.text))
        elif token.kind is ODD:
            words += re.findall("[A-Z]+", token.text.upper())
        else:
            signs[token.kind] += 1
        last = token
    notes: Counter[str] = Counter()
    for note in found.comments:
        notes.update(re.findall("[A-Z0-9]+", note.text.upper()))
    for diagnostic in found.diagnostics:
        if diagnostic.code is codes.OTHER_NOTE:
            notes.update(re.findall("[A-Z0-9]+", text[slice(*diagnostic.span)].upper()))
    return _Content(numbers, words, signs, notes)


def _says_it_again(last: Token, token: Token) -> bool:
    """`mover adelante`, `FIN REPETIR`: one command in two words."""
    if last.kind is not WORD or token.text in WORDS:
        return False
    meant = meant_by(token.text)
    return (meant is not None and meant == meant_by(last.text)) or (
        last.text in phrases.ENDS_OF_ANY and meant in BLOCK_ENDS
    )


def _is_command(word: str) -> bool:
    return word in WORDS and WORDS[word].is_instruction


def _digits(text: str) -> str:
    return "".join(re.findall("[0-9]", text))
