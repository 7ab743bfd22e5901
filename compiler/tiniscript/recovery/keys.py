"""Keys and the stick of a remote control in a pupil's own words: `botón A`, `palanca izquierda`.

Each leads to one of the readings that a robot has of them, and a key that there is not to all of
these. Where an order is given to a key, `flecha arriba = F(1, 60)`, the key is asked. A side of the
stick, `PAD LEFT`, is a number below or above 0, and may be meant as the arrow: both are shown.
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
from tiniscript.recovery.meanings import ASKING_WORDS, WORD_OF_END, Names, lexemes, plain, words_of
from tiniscript.recovery.writing import without_note

KEYS = tuple(device.name for device in REMOTE if device.is_yes_no)
_SIDE_OF_MOVE = {"F": "UP", "B": "DOWN", "L": "LEFT", "R": "RIGHT"}  # what arrows say alone
_STICK_CONDITIONS = {
    "LEFT": "PAD_X < 0",
    "RIGHT": "PAD_X > 0",
    "UP": "PAD_Y > 0",
    "DOWN": "PAD_Y < 0",
}
_INSTRUCTION_AND_BAR = re.compile(r"([^;{}|]*)(\|?)")
_PIECE = re.compile(r"\d[\d.]*|[^\W\d_]+|<>|!=|==|\S")
_WORD_HUMP = re.compile(r"(?<=[a-zà-ÿ])(?=[A-ZÀ-Ý])")  # of `upKey`
_EQUAL_SIGNS = ("=", "==", "_", "-", ".", '"', "'", "<>", "!=", "(")
_ORDER_OF_KEY = re.compile(r"(?i)\s*(?:=>?|:|->)\s*((?:[FBLRSMW]|BEEP|STOP)\b[^;{}\n]*)")
_ASSIGNMENT = re.compile(r"(?m)(?:^|[;|{}])\s*(\w+)\s*=(?!=|>|\s*(?:[FBLRSMW]|BEEP|STOP)\b)")
_LINK_KINDS = ("the", "of", "to", "is", "filler", "small", "pressed")
_BEFORE, _BEHIND = ("(", "AND", "OR", "NOT"), (")", "AND", "OR")  # what is asked alone


class _Piece(NamedTuple):
    """A word, or a part of one, or a sign: `KEY_UP` is three."""

    word: str
    span: Span


class _Key(NamedTuple):
    """Pieces that say a key, from `first` up to `end`; `right` is "" for one that there is not.

    `arrow` is the key that may be meant where `right` asks the stick. What is not sure is shown.
    """

    first: int
    end: int
    right: str
    arrow: str = ""
    is_sure: bool = True


def asked_keys(source: Source, kit: Kit) -> list[Diagnostic]:
    """Return what is told of the keys that a text has in other words."""
    if not kit.has_remote or not re.search(_guard(), plain(source.text)):
        return []
    rows = [without_note(line)[0] for line in source.text.split("\n")]
    names = Names([lexemes(row) for row in rows], kit)
    own_names = names.defs.union(
        *names.parameters.values(), _ASSIGNMENT.findall(plain(source.text))
    )
    diagnostics: list[Diagnostic] = []
    start = depth = 0
    for row, line in zip(rows, source.text.split("\n"), strict=True):
        for part in _INSTRUCTION_AND_BAR.finditer(row):
            if part[2]:
                continue  # `SI|`
            diagnostics += _Part(part[1], start + part.start(), names, own_names).diagnostics(
                depth > 0
            )
            words = [lexeme.text for lexeme in lexemes(part[1])]
            depth += sum((it in BLOCK_ENDS) - (it in WORD_OF_END) for it in map(names.meant, words))
        start += len(line) + 1
    return diagnostics


def key_edits(text: str, kit: Kit) -> list[Edit]:
    """Return the edits that make the keys of a text the readings that they are."""
    repairs = (each.repair for each in asked_keys(Source(text), kit))
    return [edit for each in repairs if each and each.is_sure for edit in each.edits]


class _Part:
    """An instruction, which begins at a place of a text with `own_names`."""

    def __init__(self, text: str, at: int, names: Names, own_names: Set[str]) -> None:
        self.own_names = own_names
        self.text = text
        self.at = at
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
            for piece in _PIECE.finditer(_WORD_HUMP.sub(" ", source)):
                hump_count = len(_WORD_HUMP.findall(source[: piece.end()]))
                at = start + piece.start() - min(hump_count, piece.start())
                yield from _split_key(plain(piece[0]), at if hump_count else start + piece.start())

    def diagnostics(self, is_in_block: bool) -> Iterator[Diagnostic]:
        """Give what is told of an instruction, which is inside a block or not."""
        if order := self._assigned_key():
            yield self._order(*order, "IF" if is_in_block else "WHEN")
            return
        asking_positions = (
            k for k, each in enumerate(self.pieces) if self._key_of(each) in ASKING_WORDS
        )
        k = next(asking_positions, len(self.pieces))
        key_before = None
        while k < len(self.pieces):
            key = self._key(k) or self._stick(k) or self._side(k, key_before)
            if key is not None:
                yield from self._key_diagnostics(key)
            k = key.end if key else k + 1
            key_before = key or (key_before if self._word(k) in ("AND", "OR") else None)

    def _key_of(self, piece: _Piece) -> str:
        return self.names.meant(piece.word) if piece.word.isalpha() else ""

    def _span(self, key: _Key) -> Span:
        first, last = self.pieces[key.first], self.pieces[key.end - 1]
        return Span(self.at + first.span.start, self.at + last.span.end)

    def _key_diagnostics(self, key: _Key) -> Iterator[Diagnostic]:
        span = self._span(key)
        result = self.text[span.start - self.at : span.end - self.at]
        if not key.right:
            yield Diagnostic(codes.UNKNOWN_NAME, span, {"no_key": result, "keys": ", ".join(KEYS)})
        elif result.upper() != key.right:
            values = {"found": result, "right": key.right, "fix": key.right, "arrow": key.arrow}
            repair = Repair((Edit(span, key.right),), key.is_sure)
            yield Diagnostic(codes.OTHER_LANGUAGE, span, values, span, repair)

    # -- an order that is given to a key ----------------------------------------------------------

    def _assigned_key(self) -> tuple[_Key, str] | None:
        key = (self._key(0) or self._stick(0)) if self.pieces else None
        if key is None or not key.right:
            return None
        match = _ORDER_OF_KEY.fullmatch(self.text, self.pieces[key.end - 1].span.end)
        return (key, match[1].strip()) if match else None

    def _order(self, key: _Key, order: str, head: str) -> Diagnostic:
        begin = self._span(key)
        span = Span(begin.start, self.at + len(self.text.rstrip()))
        fix = f"{head}({key.right});{order};{BLOCK_ENDS[head]}"
        result = self.text[begin.start - self.at : begin.end - self.at]
        values, repair = (
            {"found": result, "right": key.right, "fix": fix},
            Repair((Edit(span, fix),), False),
        )
        if result.upper() != key.right:
            return Diagnostic(codes.OTHER_LANGUAGE, begin, values, span, repair)
        values = {"word": re.split(r"\W", order)[0].upper(), "fix": fix}
        return Diagnostic(codes.NO_VALUE, span, values, span, repair)

    # -- what says a key --------------------------------------------------------------------------

    def _key(self, k: int) -> _Key | None:
        """Return the key that pieces from one on say: its side goes before it or behind it."""
        if self._word(k).isalpha() and self._word(k + 1) == "." and not _is_key(self._word(k)):
            key = self._key(k + 2)  # of a thing: `input.buttonIsPressed(Button.A)`
            return key and key._replace(first=k)
        side_position = self._while(k, lambda it: it.isalpha() and _is_key_word(it, *_LINK_KINDS))
        side = _side(self._word(side_position))
        at = (
            self._while(side_position + 1, lambda it: _is_key_word(it, "the", "of") or it == "_")
            if side
            else side_position
        )
        if not _is_key(self._word(at)):
            return None
        end = self._past_keys(at, "the", "of")
        end = self._past_keys(at) if self._word(end) in ("A", "B") else end
        signs: list[str] = []
        if not side:
            end_position = self._while(
                end,
                lambda it: (
                    it in _EQUAL_SIGNS
                    or _is_key(it)
                    or _is_key_word(it, *_LINK_KINDS)
                    or bool(lexicon_meaning(it, "to"))
                ),
            )
            letters = (n for n in range(end, end_position + 1) if self._word(n) in ("A", "B"))
            side = _side(self._word(end_position))
            last = end_position if side else next(letters, None)
            side = side or (self._word(last) if last is not None else "")
            if not side and side_position - k > 1 and self._word(side_position - 1) in ("A", "B"):
                side, last = self._word(side_position - 1), end - 1  # `the A button`
            signs = [self._word(n) for n in range(end, end_position)]
            is_button = lexicon_concept(self._word(at)) == "BUTTON"
            if not side and is_button:
                return None
            is_compared = bool({*signs} & {"=", "==", "_"}) and self._word(end_position) not in (
                "",
                ")",
            )
            end = (last if last is not None else end_position if is_compared else end - 1) + 1
        while self._word(end) == "_" and self._word(end + 1).isalnum():
            end += 2  # a name is one thing
        closing = self._while(
            end, lambda it: it in ('"', "'") or _is_key_word(it, "is", "the", "pressed")
        )
        end = (
            closing if self._mentions_pressed(end, closing) or '"' in signs or "'" in signs else end
        )
        if "(" in signs and self._word(end) == ")":
            end += 1
        is_negated = bool({*signs} & {"<>", "!="})
        if self._word(end) in ("=", "==") and self._word(end + 1) in ("0", "1"):
            is_negated, end = self._word(end + 1) == "0", end + 2
        first = k if self._mentions_pressed(k, side_position) else side_position
        before = self.pieces[k - 1] if k else _Piece("", Span(0, 0))
        if before.word == "(" or self._key_of(before) in ASKING_WORDS:
            first = k  # with its article
        return _Key(first, end, f"{'NOT ' if is_negated else ''}KEY_{side}" if side else "")

    def _stick(self, k: int) -> _Key | None:
        """Return what the stick is asked: the number that says its side."""
        start = self._while(k, lambda it: _is_key_word(it, "the"))
        side = _side(self._word(start))
        at = (
            self._while(start + 1, lambda it: it == "_" or _is_key_word(it, "the", "of"))
            if side
            else start
        )
        if not _is_stick(self._word(at)):
            return None
        axis = self._while(at + 1, lambda it: it in ("_", ".") or _is_stick(it))
        has_axis = self._word(axis) in ("X", "Y")
        end = axis + 1 if has_axis else at + 1
        is_negated = False
        if not side:
            end_position = self._while(
                end, lambda it: it in _EQUAL_SIGNS or bool(lexicon_meaning(it, *_LINK_KINDS))
            )
            side = _side(self._word(end_position))
            signs = {self._word(n) for n in range(end, end_position)}
            is_negated = bool(signs & {"<>", "!="})
            end = end_position + 1 if side else end
            closing = self._while(end, lambda it: it in ('"', "'"))
            end = closing if signs & {'"', "'"} else end
            end += bool(side and "(" in signs and self._word(end) == ")")
        if not side:
            is_button = self._word(end) in ("A", "B") and self._word(end + 1) in ("", *_BEHIND)
            return _Key(k, end + 1, f"KEY_{self._word(end)}", is_sure=False) if is_button else None
        end = self._while(end, lambda it: _is_key_word(it, "is", "pressed"))
        is_asked_for_no, end = self._as_yes_no(end)
        no, arrow = "NOT " * (is_negated or is_asked_for_no), "" if has_axis else f"KEY_{side}"
        return _Key(
            k, end, f"{no}{_STICK_CONDITIONS[side]}", arrow and f"{no}{arrow}", is_sure=False
        )

    def _side(self, k: int, before: _Key | None) -> _Key | None:
        """Return the key that a side alone says, which nothing else is asked with: `WHEN(UP)`.

        Left and right may be those of a line that a robot sees; `before` is what is asked before.
        """
        side = _side(self._word(k))
        end = self._while(k + 1, lambda it: _is_key_word(it, "is", "pressed"))
        is_negated, end = self._as_yes_no(end)
        stands_alone = self._word(k - 1) in _BEFORE and self._word(end) in _BEHIND
        is_call = self._word(k - 1) == "(" and self._word(k - 2).isalpha()
        stands_alone = stands_alone and not (
            is_call and self._key_of(self.pieces[k - 2]) not in ASKING_WORDS
        )
        is_upright = side in ("UP", "DOWN") or self._mentions_pressed(k + 1, end)
        if not side or not stands_alone or not (is_upright or "LINE_L" not in self.names.sensors):
            return None
        no, arrow = "NOT " * is_negated, f"KEY_{side}"
        if before and before.arrow:
            return _Key(k, end, f"{no}{_STICK_CONDITIONS[side]}", f"{no}{arrow}", is_sure=False)
        return _Key(k, end, f"{no}{arrow}", is_sure=is_upright)

    def _as_yes_no(self, k: int) -> tuple[bool, int]:
        """Return whether a `= FALSE` or `= 0` stands at a place, and where what says so ends."""
        if self._word(k) in ("=", "==") and self._word(k + 1) in ("0", "1", "TRUE", "FALSE"):
            return self._word(k + 1) in ("0", "FALSE"), k + 2
        return False, k

    def _word(self, k: int) -> str:
        return self.pieces[k].word if 0 <= k < len(self.pieces) else ""

    def _while(self, k: int, predicate: Callable[[str], bool]) -> int:
        while k < len(self.pieces) and predicate(self._word(k)):
            k += 1
        return k

    def _past_keys(self, k: int, *links: str) -> int:
        """Pass what says a key, also in one name, `KEY_ARROW`, and words of these kinds."""
        while _is_key(self._word(k)) or _is_key_word(self._word(k), *links):
            after = self._word(k + 2) if self._word(k + 1) == "_" else ""
            k += 2 if _is_key(after) or _is_key_word(after, *links) else 1
        return k

    def _mentions_pressed(self, start: int, end: int) -> bool:
        return any(_is_key_word(self._word(k), "pressed") for k in range(start, end))


def _is_key_word(word: str, *kinds: str) -> bool:
    return bool(lexicon_meaning(word, *kinds)) and not {word, lexicon_concept(word)} & {
        *WORDS,
        *ASKING_WORDS,
    }


def _is_key(word: str) -> bool:
    return bool(lexicon_meaning(plain(word), "key")) or lexicon_concept(plain(word)) == "BUTTON"


def _is_stick(word: str) -> bool:
    return lexicon_meaning(plain(word), "stem") == ("PAD",)


def _side(word: str) -> str:
    if word and not word.isascii():
        return _SIDE_OF_MOVE.get(lexicon_concept(word) or "", "")
    return "".join(lexicon_meaning(word, "up", "down", "left", "right")).upper()


@cache
def _guard() -> str:
    """Return the pattern of what is in a text that speaks of keys."""
    return rf"{words_of('key', 'up', 'down', 'left', 'right', 'pressed', 'BUTTON')}|{_sticks()}"


def _sticks() -> str:
    return "|".join(word for word in lexicon() if _is_stick(word))


@cache
def _words() -> tuple[str, ...]:
    return tuple(word for word in lexicon() if _is_key(word) and word.isascii())


def _split_key(word: str, start: int) -> Iterator[_Piece]:
    """Give a word, in two where a key and its side are glued: `KEYUP`."""
    for key, ends in product(_words(), (str.removeprefix, str.removesuffix)):
        rest = ends(word, key)
        is_letter = (
            rest in ("A", "B") and bool(lexicon_meaning(key, "key")) and word.startswith(key)
        )
        if rest != word and (_side(rest) or is_letter):
            parts = (key, rest) if word.startswith(key) else (rest, key)
            middle = start + len(parts[0])
            yield _Piece(parts[0], Span(start, middle))
            yield _Piece(parts[1], Span(middle, start + len(word)))
            return
    yield _Piece(word, Span(start, start + len(word)))
