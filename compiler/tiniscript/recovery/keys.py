"""Keys and the stick of a remote control in a pupil's own words: `botón A`, `palanca izquierda`.

Each leads to one of the readings that a robot has of them, and a key that there is not to all of
these. If an instruction is assigned to a key, `flecha arriba = F(1, 60)`, the key becomes a
question. A side of the stick, `PAD LEFT`, is a number below or above 0, and may be meant as the
arrow: both are shown.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Set
from functools import cache
from itertools import product
from typing import NamedTuple

from tiniscript.base.kit import REMOTE, Kit
from tiniscript.base.source import Edit, Source, Span
from tiniscript.base.words import BLOCK_ENDS, WORDS, lexicon, lexicon_concept, lexicon_meaning
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.recovery.meanings import ASKING_WORDS, Names, lexemes, plain, words_of
from tiniscript.recovery.writing import split_note
from tiniscript.syntax.blocks import WORD_OF_END

KEYS = tuple(device.name for device in REMOTE if device.is_yes_no)
# Directions meant by an arrow alone.
_SIDE_OF_MOVE = {"F": "UP", "B": "DOWN", "L": "LEFT", "R": "RIGHT"}
_STICK_CONDITIONS = {
    "LEFT": "PAD_X < 0",
    "RIGHT": "PAD_X > 0",
    "UP": "PAD_Y > 0",
    "DOWN": "PAD_Y < 0",
}
_INSTRUCTION_AND_BAR = re.compile(r"([^;{}|]*)(\|?)")
_PIECE_PATTERN = re.compile(r"\d[\d.]*|[^\W\d_]+|<>|!=|==|\S")
_WORD_HUMP = re.compile(r"(?<=[a-zà-ÿ])(?=[A-ZÀ-Ý])")  # boundary of words in `upKey`
_EQUAL_SIGNS = ("=", "==", "_", "-", ".", '"', "'", "<>", "!=", "(")
_INSTRUCTION_OF_KEY = re.compile(r"(?i)\s*(?:=>?|:|->)\s*((?:[FBLRSMW]|BEEP|STOP)\b[^;{}\n]*)")
_ASSIGNMENT = re.compile(r"(?m)(?:^|[;|{}])\s*(\w+)\s*=(?!=|>|\s*(?:[FBLRSMW]|BEEP|STOP)\b)")
_LINK_KINDS = ("the", "of", "to", "is", "filler", "small", "pressed")
_TEXTS_LEFT_OF_KEY, _TEXTS_RIGHT_OF_KEY = (
    ("(", "AND", "OR", "NOT"),
    (")", "AND", "OR"),
)  # keys that are asked for alone


class _Piece(NamedTuple):
    """A word, or a part of one, or a sign: `KEY_UP` is three."""

    word: str
    span: Span


class _Key(NamedTuple):
    """Pieces that say a key, from `start` up to `end`; `condition` is "" for one that there is not.

    `arrow` is the key that may be meant where `condition` asks the stick. An unsure repair is only
    shown.
    """

    start: int
    end: int
    condition: str
    arrow: str = ""
    is_sure: bool = True


def key_diagnostics(source: Source, kit: Kit) -> list[Diagnostic]:
    """Return the diagnostics for keys that are written in other words."""
    if not kit.has_remote or not re.search(_key_pattern(), plain(source.text)):
        return []
    bodies = [split_note(line)[0] for line in source.text.split("\n")]
    names = Names([lexemes(body) for body in bodies], kit)
    own_names = names.defs.union(
        *names.parameters.values(), _ASSIGNMENT.findall(plain(source.text))
    )
    diagnostics: list[Diagnostic] = []
    line_start = depth = 0
    for body, line in zip(bodies, source.text.split("\n"), strict=True):
        for match in _INSTRUCTION_AND_BAR.finditer(body):
            if match[2]:
                continue  # `SI|`
            diagnostics += _Instruction(
                match[1], line_start + match.start(), names, own_names
            ).diagnostics(depth > 0)
            words = [token.text for token in lexemes(match[1])]
            depth += sum(
                (concept in BLOCK_ENDS) - (concept in WORD_OF_END)
                for concept in map(names.find_meaning, words)
            )
        line_start += len(line) + 1
    return diagnostics


def key_edits(text: str, kit: Kit) -> list[Edit]:
    """Return the edits that make the keys of a text the readings that they are."""
    repairs = (repair.repair for repair in key_diagnostics(Source(text), kit))
    return [edit for repair in repairs if repair and repair.is_sure for edit in repair.edits]


class _Instruction:
    """An instruction, which begins at a place of a text with `own_names`."""

    def __init__(self, text: str, start: int, names: Names, own_names: Set[str]) -> None:
        self.own_names = own_names
        self.text = text
        self.start = start
        self.names = names
        self.pieces = [*self._pieces()]

    def _pieces(self) -> Iterator[_Piece]:
        end = 0
        for token in lexemes(self.text):
            source = token.source or ""
            start = self.text.index(source, end)
            end = start + len(source)
            if token.text in self.own_names:
                yield _Piece("", Span(start, end))  # a variable may be called KEY
                continue
            for match in _PIECE_PATTERN.finditer(_WORD_HUMP.sub(" ", source)):
                hump_count = len(_WORD_HUMP.findall(source[: match.end()]))
                piece_start = start + match.start() - min(hump_count, match.start())
                yield from _split_key(
                    plain(match[0]), piece_start if hump_count else start + match.start()
                )

    def diagnostics(self, is_in_block: bool) -> Iterator[Diagnostic]:
        """Yield the diagnostics for an instruction, depending on whether it is inside a block."""
        if instruction := self._assigned_key():
            yield self._instruction_diagnostic(*instruction, "IF" if is_in_block else "WHEN")
            return
        asking_positions = (
            k for k, piece in enumerate(self.pieces) if self._concept_of(piece) in ASKING_WORDS
        )
        k = next(asking_positions, len(self.pieces))
        key_before = None
        while k < len(self.pieces):
            key = self._find_key(k) or self._find_stick(k) or self._find_side(k, key_before)
            if key is not None:
                yield from self._key_diagnostics(key)
            k = key.end if key else k + 1
            key_before = key or (key_before if self._word_at(k) in ("AND", "OR") else None)

    def _concept_of(self, piece: _Piece) -> str:
        return self.names.find_meaning(piece.word) if piece.word.isalpha() else ""

    def _span(self, key: _Key) -> Span:
        first_piece, last_piece = self.pieces[key.start], self.pieces[key.end - 1]
        return Span(self.start + first_piece.span.start, self.start + last_piece.span.end)

    def _key_diagnostics(self, key: _Key) -> Iterator[Diagnostic]:
        span = self._span(key)
        found_text = self.text[span.start - self.start : span.end - self.start]
        if not key.condition:
            yield Diagnostic(
                codes.UNKNOWN_NAME, span, {"no_key": found_text, "keys": ", ".join(KEYS)}
            )
        elif found_text.upper() != key.condition:
            values = {
                "found": found_text,
                "right": key.condition,
                "fix": key.condition,
                "arrow": key.arrow,
            }
            repair = Repair((Edit(span, key.condition),), key.is_sure)
            yield Diagnostic(codes.OTHER_LANGUAGE, span, values, span, repair)

    # -- an instruction that is given to a key ----------------------------------------------------

    def _assigned_key(self) -> tuple[_Key, str] | None:
        key = (self._find_key(0) or self._find_stick(0)) if self.pieces else None
        if key is None or not key.condition:
            return None
        match = _INSTRUCTION_OF_KEY.fullmatch(self.text, self.pieces[key.end - 1].span.end)
        return (key, match[1].strip()) if match else None

    def _instruction_diagnostic(self, key: _Key, instruction: str, head: str) -> Diagnostic:
        key_span = self._span(key)
        span = Span(key_span.start, self.start + len(self.text.rstrip()))
        fix = f"{head}({key.condition});{instruction};{BLOCK_ENDS[head]}"
        found_text = self.text[key_span.start - self.start : key_span.end - self.start]
        values, repair = (
            {"found": found_text, "right": key.condition, "fix": fix},
            Repair((Edit(span, fix),), False),
        )
        if found_text.upper() != key.condition:
            return Diagnostic(codes.OTHER_LANGUAGE, key_span, values, span, repair)
        values = {"word": re.split(r"\W", instruction)[0].upper(), "fix": fix}
        return Diagnostic(codes.NO_VALUE, span, values, span, repair)

    # -- words for a key --------------------------------------------------------------------------

    def _find_key(self, k: int) -> _Key | None:
        """Return the key that pieces from one on say: its side goes before it or after it."""
        if (
            self._word_at(k).isalpha()
            and self._word_at(k + 1) == "."
            and not _is_key(self._word_at(k))
        ):
            # The key follows an object: `input.buttonIsPressed(Button.A)`.
            key = self._find_key(k + 2)
            return key and key._replace(start=k)
        side_position = self._skip_while(
            k, lambda word: word.isalpha() and _is_key_word(word, *_LINK_KINDS)
        )
        side = _side_of(self._word_at(side_position))
        key_index = (
            self._skip_while(
                side_position + 1, lambda word: _is_key_word(word, "the", "of") or word == "_"
            )
            if side
            else side_position
        )
        if not _is_key(self._word_at(key_index)):
            return None
        end = self._skip_keys(key_index, "the", "of")
        end = self._skip_keys(key_index) if self._word_at(end) in ("A", "B") else end
        texts_between: list[str] = []
        if not side:
            end_position = self._skip_while(
                end,
                lambda word: (
                    word in _EQUAL_SIGNS
                    or _is_key(word)
                    or _is_key_word(word, *_LINK_KINDS)
                    or bool(lexicon_meaning(word, "to"))
                ),
            )
            letters = (n for n in range(end, end_position + 1) if self._word_at(n) in ("A", "B"))
            side = _side_of(self._word_at(end_position))
            side_index = end_position if side else next(letters, None)
            side = side or (self._word_at(side_index) if side_index is not None else "")
            if (
                not side
                and side_position - k > 1
                and self._word_at(side_position - 1) in ("A", "B")
            ):
                side, side_index = self._word_at(side_position - 1), end - 1  # `the A button`
            texts_between = [self._word_at(n) for n in range(end, end_position)]
            is_button = lexicon_concept(self._word_at(key_index)) == "BUTTON"
            if not side and is_button:
                return None
            is_compared = bool({*texts_between} & {"=", "==", "_"}) and self._word_at(
                end_position
            ) not in (
                "",
                ")",
            )
            end = (
                side_index if side_index is not None else end_position if is_compared else end - 1
            ) + 1
        while self._word_at(end) == "_" and self._word_at(end + 1).isalnum():
            end += 2  # a name is one thing
        end_after_words = self._skip_while(
            end, lambda word: word in ('"', "'") or _is_key_word(word, "is", "the", "pressed")
        )
        end = (
            end_after_words
            if self._mentions_pressed(end, end_after_words)
            or '"' in texts_between
            or "'" in texts_between
            else end
        )
        if "(" in texts_between and self._word_at(end) == ")":
            end += 1
        is_negated = bool({*texts_between} & {"<>", "!="})
        if self._word_at(end) in ("=", "==") and self._word_at(end + 1) in ("0", "1"):
            is_negated, end = self._word_at(end + 1) == "0", end + 2
        start = k if self._mentions_pressed(k, side_position) else side_position
        previous_piece = self.pieces[k - 1] if k else _Piece("", Span(0, 0))
        if previous_piece.word == "(" or self._concept_of(previous_piece) in ASKING_WORDS:
            start = k  # includes its article
        return _Key(start, end, f"{'NOT ' if is_negated else ''}KEY_{side}" if side else "")

    def _find_stick(self, k: int) -> _Key | None:
        """Return the direction of the stick by the number it is compared with."""
        start = self._skip_while(k, lambda word: _is_key_word(word, "the"))
        side = _side_of(self._word_at(start))
        stick_index = (
            self._skip_while(start + 1, lambda word: word == "_" or _is_key_word(word, "the", "of"))
            if side
            else start
        )
        if not _is_stick(self._word_at(stick_index)):
            return None
        axis_index = self._skip_while(
            stick_index + 1, lambda word: word in ("_", ".") or _is_stick(word)
        )
        has_axis = self._word_at(axis_index) in ("X", "Y")
        end = axis_index + 1 if has_axis else stick_index + 1
        is_negated = False
        if not side:
            end_position = self._skip_while(
                end, lambda word: word in _EQUAL_SIGNS or bool(lexicon_meaning(word, *_LINK_KINDS))
            )
            side = _side_of(self._word_at(end_position))
            signs = {self._word_at(n) for n in range(end, end_position)}
            is_negated = bool(signs & {"<>", "!="})
            end = end_position + 1 if side else end
            end_after_quotes = self._skip_while(end, lambda word: word in ('"', "'"))
            end = end_after_quotes if signs & {'"', "'"} else end
            end += bool(side and "(" in signs and self._word_at(end) == ")")
        if not side:
            is_button = self._word_at(end) in ("A", "B") and self._word_at(end + 1) in (
                "",
                *_TEXTS_RIGHT_OF_KEY,
            )
            return (
                _Key(k, end + 1, f"KEY_{self._word_at(end)}", is_sure=False) if is_button else None
            )
        end = self._skip_while(end, lambda word: _is_key_word(word, "is", "pressed"))
        is_asked_for_no, end = self._as_yes_no(end)
        negation, arrow = (
            "NOT " * (is_negated or is_asked_for_no),
            "" if has_axis else f"KEY_{side}",
        )
        return _Key(
            k,
            end,
            f"{negation}{_STICK_CONDITIONS[side]}",
            arrow and f"{negation}{arrow}",
            is_sure=False,
        )

    def _find_side(self, k: int, key_before: _Key | None) -> _Key | None:
        """Return the key that a direction alone means, as in `WHEN(UP)`.

        Left and right may refer to a line that a robot sees; `key_before` is the question before.
        """
        side = _side_of(self._word_at(k))
        end = self._skip_while(k + 1, lambda word: _is_key_word(word, "is", "pressed"))
        is_negated, end = self._as_yes_no(end)
        stands_alone = (
            self._word_at(k - 1) in _TEXTS_LEFT_OF_KEY and self._word_at(end) in _TEXTS_RIGHT_OF_KEY
        )
        is_call = self._word_at(k - 1) == "(" and self._word_at(k - 2).isalpha()
        stands_alone = stands_alone and not (
            is_call and self._concept_of(self.pieces[k - 2]) not in ASKING_WORDS
        )
        is_upright = side in ("UP", "DOWN") or self._mentions_pressed(k + 1, end)
        if not side or not stands_alone or not (is_upright or "LINE_L" not in self.names.sensors):
            return None
        negation, arrow = "NOT " * is_negated, f"KEY_{side}"
        if key_before and key_before.arrow:
            return _Key(
                k, end, f"{negation}{_STICK_CONDITIONS[side]}", f"{negation}{arrow}", is_sure=False
            )
        return _Key(k, end, f"{negation}{arrow}", is_sure=is_upright)

    def _as_yes_no(self, k: int) -> tuple[bool, int]:
        """Return whether a `= FALSE` or `= 0` is at a place, and its end."""
        if self._word_at(k) in ("=", "==") and self._word_at(k + 1) in ("0", "1", "TRUE", "FALSE"):
            return self._word_at(k + 1) in ("0", "FALSE"), k + 2
        return False, k

    def _word_at(self, k: int) -> str:
        return self.pieces[k].word if 0 <= k < len(self.pieces) else ""

    def _skip_while(self, k: int, predicate: Callable[[str], bool]) -> int:
        while k < len(self.pieces) and predicate(self._word_at(k)):
            k += 1
        return k

    def _skip_keys(self, k: int, *links: str) -> int:
        """Pass the words for a key, also in one name, `KEY_ARROW`, and words of these kinds."""
        while _is_key(self._word_at(k)) or _is_key_word(self._word_at(k), *links):
            next_word = self._word_at(k + 2) if self._word_at(k + 1) == "_" else ""
            k += 2 if _is_key(next_word) or _is_key_word(next_word, *links) else 1
        return k

    def _mentions_pressed(self, start: int, end: int) -> bool:
        return any(_is_key_word(self._word_at(k), "pressed") for k in range(start, end))


def _is_key_word(word: str, *kinds: str) -> bool:
    return bool(lexicon_meaning(word, *kinds)) and not {word, lexicon_concept(word)} & {
        *WORDS,
        *ASKING_WORDS,
    }


def _is_key(word: str) -> bool:
    return bool(lexicon_meaning(plain(word), "key")) or lexicon_concept(plain(word)) == "BUTTON"


def _is_stick(word: str) -> bool:
    return lexicon_meaning(plain(word), "stem") == ("PAD",)


def _side_of(word: str) -> str:
    if word and not word.isascii():
        return _SIDE_OF_MOVE.get(lexicon_concept(word) or "", "")
    return "".join(lexicon_meaning(word, "up", "down", "left", "right")).upper()


@cache
def _key_pattern() -> str:
    """Return the pattern of texts about keys."""
    return (
        rf"{words_of('key', 'up', 'down', 'left', 'right', 'pressed', 'BUTTON')}|{_stick_pattern()}"
    )


def _stick_pattern() -> str:
    return "|".join(word for word in lexicon() if _is_stick(word))


@cache
def _key_words() -> tuple[str, ...]:
    return tuple(word for word in lexicon() if _is_key(word) and word.isascii())


def _split_key(word: str, start: int) -> Iterator[_Piece]:
    """Yield a word, split in two if a key and its side are joined: `KEYUP`."""
    for key, remove in product(_key_words(), (str.removeprefix, str.removesuffix)):
        side = remove(word, key)
        is_letter = (
            side in ("A", "B") and bool(lexicon_meaning(key, "key")) and word.startswith(key)
        )
        if side != word and (_side_of(side) or is_letter):
            parts = (key, side) if word.startswith(key) else (side, key)
            split_index = start + len(parts[0])
            yield _Piece(parts[0], Span(start, split_index))
            yield _Piece(parts[1], Span(split_index, start + len(word)))
            return
    yield _Piece(word, Span(start, start + len(word)))
