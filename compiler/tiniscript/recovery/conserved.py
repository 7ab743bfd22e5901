"""Conservation: what a text says that a repair of it leaves out, and what a robot does more by it.

Counts numbers with their signs and units, names, commands, comparisons and branches, as far as
words and signs say them. Knows no row: what was written is compared with what is written then.
"""

from __future__ import annotations

import re
from bisect import bisect_right, insort
from collections import Counter, deque
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property, lru_cache
from itertools import accumulate, pairwise
from typing import NamedTuple

from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Source, Span, apply_edits
from tiniscript.base.words import (
    ALIASES,
    BLOCK_ENDS,
    EXTENTS,
    FUNCTIONS,
    MOVES,
    UNIT_OF,
    WORDS,
    lexicon,
)
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.diagnostics.fixing import edits_of
from tiniscript.recovery.keys import key_edits
from tiniscript.recovery.labels import labels
from tiniscript.recovery.meanings import (
    ASKING_WORDS,
    CALL_WORDS,
    LAP,
    NEAR,
    NEAR_CM,
    WORD_OF_END,
    Lexeme,
    Names,
    closed,
    lexemes,
    lexicon_concept,
    lexicon_meaning,
    texts,
)
from tiniscript.recovery.notes import note_edits
from tiniscript.recovery.rewrites import one_word
from tiniscript.recovery.writing import PLAIN_SIGNS, instruction_at, without_note
from tiniscript.syntax.lexer import NUMBER, WORD
from tiniscript.syntax.operators import SUMS

_COMPARISON_SENSES = {
    "<": "<", "<=": "<", ">": ">", ">=": ">", "<>": "<>", "=<": "<", "=>": ">", "!=": "<>",
    "=!": "<>", "≤": "<", "≥": ">", "≠": "<>",
}  # fmt: skip
_UNITS = ("s", "cm", "°", "%", "Hz")
_WAY_UNITS = tuple(way.unit for way in EXTENTS.values())
_STORED_UNIT = "="  # of what a variable keeps that nothing reads: a move would take seconds
_COUNTED_UNITS = (*_UNITS, "turns")  # with a number before them
_ARMS = ("ELSE", "ELSEIF")
_HEADER_WORDS = frozenset((*BLOCK_ENDS, *_ARMS))
_DRIVING_WORDS = frozenset((*MOVES, "M", "W", "BEEP", "S"))
_COUNTED_WORDS = frozenset((
    *_DRIVING_WORDS, *_HEADER_WORDS, *FUNCTIONS, "SHOW", "UNTIL", "BREAK", "AND", "OR", "NOT",
    "TRUE", "FALSE", "TIME", "FOREVER",
))  # fmt: skip
# What says the same where a word is gone: `repeat until` is WHILE, `void loop` is FOREVER.
_COUNTED_AS = {
    "LOOP": ("WHILE", "BREAK", "FOREVER"), "WHILE": ("BREAK", "UNTIL"), "UNTIL": ("WHILE", "BREAK"),
    "FOREVER": ("TRUE", "LOOP", "WHILE"), "TRUE": ("FOREVER",), "S": ("BREAK", "UNTIL"),
    "IF": ("WHEN",), "WHEN": ("IF", "UNTIL"), "ELSE": ("ELSEIF",), "DEF": ("TASK", "FOREVER"),
}  # fmt: skip
_QUESTION_TURNERS = ("NOT", "UNTIL", "WHILE")  # where one goes, a question may become its opposite
_NEGATING_KINDS = ("no", "without", "unless", "different")
# What frames a program and says nothing: its setup, the tags of a page, a function with no name;
# and labels of lines.
_FRAME_PATTERN = re.compile(
    r"(?im)^\s*[S5]\s?[IÍB1Ll]\s*(?:\|+|[¦:/\\!]+)|</?[a-z]+/?>|(?:\bfunction\s*\(\s*\)|\(\s*\)\s*=>)(?=\s*\{)"
)
_ESCAPED_SIGNS = {
    "¡=": "!=",
    "&lt;": "<",
    "&gt;": ">",
    "&nbsp;": " ",
    "½": ".5",
    "¼": ".25",
    "¾": ".75",
}
_FRACTIONS = {"1/2": ".5", "1/4": ".25", "3/4": ".75"}
_GLUED_NUMBER = re.compile(r"\b([A-Za-z_]+?)_?(\d+(?:\.\d+)?)(?:_(?=\d)|(?![\w.]))")
# Digits, and letters that look like some; and what may stand between two parts of one number.
_DIGITS = re.compile(r"[0-9oOlI]*[0-9][0-9oOlI]*|\b[oO](?=\.)")
_GROUP_SEPARATORS = re.compile(r"[.,:;'´`·_ ]*")
_DIGITS_OF_LETTERS = str.maketrans("oOlI", "0011")
_NUMBER_WITH_UNIT = re.compile(r"[\d.]+\s*([^\W\d]+|[%°])")
_SEPARATORS = ";\n"
_MOST_NUMBER_PARTS = 3  # parts of a number
_GROUP_DIGITS = 3  # digits of the last part of `1,000`
# What is written, as far as a change may cut it out; and which messages name what they do.
_COUNTED_TOKEN = re.compile(r"\d[\d.]*|[^\W\d]\w*|[<>≤≥≠]=?|[=!]=")
_NAMING_CODES = (
    codes.EXTRA_WORD,
    codes.WORDS_AFTER,
    codes.NAMED_ARGUMENT,
    codes.LOOP_COUNTS,
    codes.MIXED_COMPARE,
)
_NAME = re.compile(r"[A-Za-z_]\w*")
_END = lexemes(";")[0]
_NUMBERED_KINDS = ("number", "power", "often", "note")
_NUMBER = re.compile(r"(?<![\w.])\d[\d.]*")
_CALL = re.compile(r"\b([A-Z]+)\(([^()]*)\)")
_NEAR_SAMPLE = f"{NEAR_CM} cm"
_NEAR_QUESTION = re.compile(rf"DISTANCE [<>]=? {NEAR_CM}(?![\d.])")


class Amount(NamedTuple):
    """A number with its sign and its unit, "" for none that is known; how it is written, where."""

    value: float
    unit: str
    source_text: str
    line: int


MOST_LOOKS = 40  # at what is lost, of one text; and how many characters are looked at in them
MOST_CHARACTERS_LOOKED_AT = 100_000
MOST_LAYERS = 8


class Difference(NamedTuple):
    """The `losses`, as they are written, and the commands that there are more of: `additions`."""

    losses: list[str]
    additions: list[str]


NO_DIFFERENCE = Difference([], [])
UNKNOWN_DIFFERENCE = Difference([""], [])  # nobody has looked, or not at this alone


def difference(text: str, repaired_text: str, kit: Kit) -> Difference:
    """Return what a text says that a repaired one doesn't, and what only that does."""
    before, after = (
        _words_of_wrong(text, _words_of(repaired_text), kit),
        _words_of_right(repaired_text, kit),
    )
    losses = [*_amounts(before, after), *_words(before, after), *_questions(before, after)]
    losses += before.sums() - after.sums()
    additions = [word for word in _DRIVING_WORDS if after.words[word] > before.meant[word]]
    additions = additions if len(additions) > before.strange else []
    additions += [name for name in after.names.defs if after.calls(name) > before.calls(name)]
    return Difference([*dict.fromkeys(losses)], additions)


def conserving(diagnostics: Sequence[Diagnostic], text: str, kit: Kit) -> list[Diagnostic]:
    """Return diagnostics of which no repair is sure that loses something, or does more.

    It is shown together with what is `lost`, and so is what was not sure before.
    """
    sure_diagnostics = [
        it for it in diagnostics if it.repair and it.repair.is_sure and it.repair.edits
    ]
    loss_of_diagnostic = _losses_of_sure_repairs(sure_diagnostics, text, kit)
    shown_diagnostics = [
        it
        for it in diagnostics
        if id(it) not in loss_of_diagnostic
        and "lost" not in it.values
        and not (it.repair and it.repair.is_sure)
        and edits_of(it)
    ]
    losses = zip(shown_diagnostics, _losses(shown_diagnostics, text, kit), strict=True)
    left_out = {
        id(it): unmentioned
        for it, loss in losses
        if (unmentioned := _unmentioned_losses(it, loss.losses, text))
    }
    return [
        _with_losses(it, loss_of_diagnostic[id(it)].losses) if id(it) in loss_of_diagnostic
        else _with_losses(it, left_out[id(it)]) if id(it) in left_out else it
        for it in diagnostics
    ]  # fmt: skip


def _losses_of_sure_repairs(
    sure_diagnostics: Sequence[Diagnostic], text: str, kit: Kit
) -> dict[int, Difference]:
    """Return what is lost by which sure repairs: by one alone, or by all of them together."""
    edits = [it.repair.edits for it in sure_diagnostics if it.repair]
    joint_edits = [it for k in _layers(dict(enumerate(edits)))[0] for it in edits[k]]
    if not joint_edits or not any(difference(text, apply_edits(text, joint_edits), kit)):
        return {}
    loss_of_diagnostic = {
        id(it): loss
        for it, loss in zip(sure_diagnostics, _losses(sure_diagnostics, text, kit), strict=True)
    }
    is_joint = not any(
        any(item) for item in loss_of_diagnostic.values()
    )  # none alone: then all together do it
    return {key: loss for key, loss in loss_of_diagnostic.items() if is_joint or any(loss)}


def keeps_all(diagnostics: Sequence[Diagnostic], text: str, kit: Kit) -> list[bool]:
    """Return for each diagnostic whether its changes alone lose nothing that was written."""
    return [not loss.losses for loss in _losses(diagnostics, text, kit)]


def _losses(diagnostics: Sequence[Diagnostic], text: str, kit: Kit) -> list[Difference]:
    """Return what the changes of each of these lose alone.

    Where they are many, they are looked at together: halves of them while there are looks left. Of
    what many lose together each loses what stands in its own instructions.
    """
    edits = [edits_of(it) or () for it in diagnostics]
    changing_keys = [k for k, edits_of_one in enumerate(edits) if edits_of_one]
    looks_left = min(MOST_LOOKS, MOST_CHARACTERS_LOOKED_AT // (len(text) + 1))
    differences = [NO_DIFFERENCE] * len(edits)
    groups = deque([k] for k in changing_keys)
    if len(groups) > looks_left:
        *layers, last_layer = _layers({k: edits[k] for k in changing_keys})
        groups = deque(layers)
        for k in last_layer:
            differences[k] = UNKNOWN_DIFFERENCE
    while groups:
        group, looks_left = groups.popleft(), looks_left - 1
        joint = difference(text, apply_edits(text, [it for k in group for it in edits[k]]), kit)
        half = len(group) // 2
        if half and any(joint) and looks_left > len(groups) + 1:
            groups += [group[:half], group[half:]]
        elif any(joint):
            shares = _split_difference(joint, [_surrounding_text(edits[k], text) for k in group])
            for k, share in zip(group, shares, strict=True):
                differences[k] = share
    return differences


def _layers(edits: Mapping[int, Sequence[Edit]]) -> list[list[int]]:
    """Return groups of changes that do not touch, by their keys, and at last those in no group."""
    layers: list[list[int]] = [[] for _ in range(MOST_LAYERS + 1)]
    spanses: list[list[Span]] = [[] for _ in range(MOST_LAYERS)]
    for k, edits_of_one in edits.items():
        free = (
            at
            for at, spans in enumerate(spanses)
            if not any(_overlaps(it, spans) for it in edits_of_one)
        )
        at = next(free, MOST_LAYERS)
        layers[at].append(k)
        for edit in edits_of_one if at < MOST_LAYERS else ():
            insort(spanses[at], edit.span)
    return [layer for layer in layers[:-1] if layer] + layers[-1:]


def _overlaps(edit: Edit, spans: Sequence[Span]) -> bool:
    """Whether a change is at a place that others have; these are in order, and do not touch."""
    at = bisect_right(spans, edit.span.end, key=lambda span: span.start)
    return at > 0 and spans[at - 1].end >= edit.span.start


def _split_difference(joint: Difference, parts: Sequence[str]) -> list[Difference]:
    """Return what each of several changes loses, which are in these parts: what stands there."""
    if len(parts) == 1:
        return [joint]
    own = [[it for it in joint.losses if it in part] for part in parts]
    is_told = not joint.additions and {*joint.losses} == {it for item in own for it in item}
    return [Difference(item, []) if item or is_told else UNKNOWN_DIFFERENCE for item in own]


def _surrounding_text(edits: Sequence[Edit], text: str) -> str:
    """Return the instructions that changes are in."""
    start, end = min(edits).span.start, max(edit.span.end for edit in edits)
    begin = max(text.rfind(sign, 0, start) for sign in _SEPARATORS) + 1
    behind = [text.find(sign, end) for sign in _SEPARATORS]
    return text[begin : min((it for it in behind if it >= 0), default=len(text))]


def _unmentioned_losses(diagnostic: Diagnostic, losses: Sequence[str], text: str) -> list[str]:
    """Return what a shown change leaves out and does not say: a unit, or what it only cuts out.

    A minus is none of these: a move goes the other way then.
    """
    edits = edits_of(diagnostic) or []
    outcome = " ".join(edit.text for edit in edits).upper()
    removed_words = {
        *_COUNTED_TOKEN.findall(" ".join(text[slice(*edit.span)] for edit in edits).upper())
    }
    kept_words = {*_COUNTED_TOKEN.findall(outcome)}
    is_only_cut = kept_words <= removed_words and diagnostic.code not in _NAMING_CODES
    result = []
    for item in losses:
        unit = _NUMBER_WITH_UNIT.fullmatch(item) if diagnostic.repair else None
        is_lost_unit = unit is not None and unit[1].upper() not in outcome
        if is_lost_unit or (is_only_cut and item.upper() in removed_words - kept_words):
            result.append(item)
    return result


def with_sample(diagnostics: Sequence[Diagnostic], text: str, kit: Kit) -> list[Diagnostic]:
    """Return diagnostics that say of each number of what they offer that nobody wrote: an example.

    That is a distance that a pupil called near, `DISTANCE < 10` for "near a wall", and the time,
    the power or the pitch that a call lacks. Where the text has that number, or where the message
    shows an example anyway, nothing changes.
    """
    written_numbers: set[float] | None = None
    result = []
    for diagnostic in diagnostics:
        fix = diagnostic.values.get("fix", "")
        samples = [] if diagnostic.values.get("example") else _samples(fix)
        if samples and len(_NUMBER.findall(fix)) <= _count_numbers(diagnostic, text):
            samples = [
                it for it in samples if it[1] == _NEAR_SAMPLE
            ]  # one each, in words or nearly so
        if samples and written_numbers is None:
            written_numbers = {it.value for it in _words_of_right(text, kit).amounts}
        samples_text = ", ".join(
            item for number, item in samples if number not in (written_numbers or ())
        )
        gap = "samples" if ", " in samples_text else "sample"
        values = {**diagnostic.values, gap: samples_text} if samples_text else diagnostic.values
        result.append(diagnostic._replace(values=values))
    return result


def _count_numbers(diagnostic: Diagnostic, text: str) -> int:
    """Return how many numbers stand in the place of a mistake, in digits, words or nearly so."""
    place = diagnostic.place or diagnostic.span
    if ";" not in diagnostic.values.get("fix", ""):
        place = instruction_at(diagnostic.span, Source(text))
    return sum(
        any(map(str.isdigit, token.text)) or bool(lexicon_meaning(token.text, *_NUMBERED_KINDS))
        for token in lexemes(text[slice(*place)])
    )


def _samples(fix: str) -> list[tuple[float, str]]:
    """Return the numbers of what is offered that may be examples, and each with its unit."""
    samples = [_NEAR_SAMPLE] if _NEAR_QUESTION.search(fix) else []
    for match in _CALL.finditer(fix):
        arguments = WORDS[match[1]].arguments if match[1] in _DRIVING_WORDS else ()
        samples += [
            f"{argument.sample} {argument.unit}"
            for argument, value in zip(arguments, match[2].split(","), strict=False)
            if value.strip() == argument.sample
        ]
    return [(float(item.split()[0]), item) for item in dict.fromkeys(samples)]


def _with_losses(diagnostic: Diagnostic, losses: Sequence[str]) -> Diagnostic:
    values = {**diagnostic.values, "lost": ", ".join(losses)} if losses else diagnostic.values
    repair = diagnostic.repair and diagnostic.repair._replace(is_sure=False)
    return diagnostic._replace(values=values, repair=repair)


class _Said:
    """What a text says, in words of any language; `other_words` are all words of the repaired
    one."""

    def __init__(self, text: str, other_words: frozenset[str], kit: Kit, is_right: bool) -> None:
        self.is_right = is_right  # as far as it is repaired
        self.other_words = other_words
        parts = [without_note(line.translate(PLAIN_SIGNS)) for line in text.split("\n")]
        self.notes = Counter(self._all_lines([note for _, note in parts]))
        self.body = self._without_frame("\n".join(body for body, _ in parts))
        lines = [lexemes(self._separated_numbers(line)) for line in self.body.split("\n")]
        self.names = Names(lines, kit)
        self.tokens = [lexeme for line in lines for lexeme in (*self._join_words(line), _END)]
        self.lines = [0, *accumulate(lexeme is _END for lexeme in self.tokens)]
        self._meanings: dict[str, set[str]] = {}
        self._parts = {row[-1] for row in self.names.rows}  # of `mi velocidad`
        # what has no unit counts something of its own: 50 % of light is no 50
        self.units = {reading.name: reading.unit or reading.name for reading in kit.readings} | {
            "TIME": "s"
        }
        self.units |= self._units_of_names()
        self.words: Counter[str] = Counter()  # that it surely says
        self.meant: Counter[str] = Counter()  # that it may say
        self.written: dict[str, str] = {}
        self.amounts: list[Amount] = []
        self.loose: list[tuple[str, str]] = []  # units after no number, and how they are written
        self.foreign: Counter[str] = Counter()  # of those, in words of another language
        self.strange = 0  # words of other languages, or of none
        self._read()

    @staticmethod
    def _all_lines(lines: Sequence[str]) -> list[str]:
        return [lexicon_concept(text) or text for line in lines for text in texts(lexemes(line))]

    @staticmethod
    def _without_frame(text: str) -> str:
        for sign, meant in _ESCAPED_SIGNS.items():
            text = re.sub(rf"(?<=\d) ?{sign}", meant, text) if meant[0] == "." else text
            text = text.replace(sign, f"0{meant}" if meant[0] == "." else meant)
        text = apply_edits(text, [Edit(span, "") for span in labels(text)])
        return _FRAME_PATTERN.sub(";", text)

    def _separated_numbers(self, line: str) -> str:
        """Return a line in which numbers stand alone, but for those of names: `F2,80`, `F_2_80`."""
        for part, decimals in _FRACTIONS.items():
            line = re.sub(rf"(?<!\d)(\d) {part}(?!\d)", rf"\1{decimals}", line)
            alone = rf"(?i)(?<![\d)] )(?<!\d){part}(?!\d)(?=\s*[a-z])"
            line = re.sub(alone, f"0{decimals}", line)
        return _GLUED_NUMBER.sub(
            lambda it: it[0] if it[0].upper() in self.other_words else f"{it[1]} {it[2]} ", line
        )

    def _join_words(self, line: list[Lexeme]) -> list[Lexeme]:
        """Return a line in which words are one that the language, or the repair, has as one."""
        joined_lexemes: list[Lexeme] = []
        for token in line:
            last = joined_lexemes[-1] if joined_lexemes else _END
            before = (
                joined_lexemes[-2]
                if last.text in ("-", "_", ".") and len(joined_lexemes) > 1
                else last
            )
            one = f"{before.text}_{token.text}"
            if before.kind is token.kind is WORD and one in self.other_words:
                joined_lexemes[joined_lexemes.index(before, -2 if before is not last else -1) :] = [
                    token._replace(text=one)
                ]
            elif last.text == "ELSE" and token.text == "IF":
                joined_lexemes[-1] = token._replace(text="ELSEIF")
            else:
                joined_lexemes.append(token)
        while joined_line := one_word(joined_lexemes, self.names):
            joined_lexemes = joined_line[0]
        return joined_lexemes

    # -- what each word is -----------------------------------------------------------------------

    def _word(self, token: Lexeme) -> str:
        """Return the word of the language, or the name, that a word surely says, "" for none."""
        text = ALIASES.get(token.text, token.text)
        if self.names.is_name(text) or (text in WORDS and text != "SI"):
            return "S" if text == "STOP" else text
        return (lexicon_concept(text) or "") if len(lexicon().get(text, ())) == 1 else ""

    def _possible_words(self, token: Lexeme) -> set[str]:
        """Return the words of the language that a word may say."""
        if token.text not in self._meanings:
            self._meanings[token.text] = self._concepts_of(token)
        return self._meanings[token.text]

    def _concepts_of(self, token: Lexeme) -> set[str]:
        concepts = {self._word(token), lexicon_concept(token.text) or ""}
        concepts |= {
            meaning.concept for meaning in self.names.meanings(token.text) if meaning.cost <= NEAR
        }
        return {"S" if item == "STOP" else item for item in concepts}

    def _read(self) -> None:
        slots = self._slots()
        k, open_brackets = 0, [False]  # whether each bracket is that of a call
        while k < len(self.tokens):
            token, before = self.tokens[k], self.tokens[k - 1] if k else _END
            if token.text == "(":
                open_brackets.append(bool(self._possible_words(before) & CALL_WORDS))
            elif token.text == ")":
                open_brackets = open_brackets[:-1] or [False]
            elif token is _END:
                open_brackets = [False]
            if (value := self._number(token)) is not None:
                is_amount_word = (
                    bool(lexicon_meaning(before.text, "leaves", "by")) and before.kind is WORD
                )
                k = (
                    k + 1
                    if is_amount_word or self._is_yes(k)
                    else self._add_amount(k, value, slots[k])
                )
                continue
            if token.kind is WORD and not self._is_label(k):
                self._take_word(k, len(open_brackets) > 1)
            k += 1
        self.words["ELSE"] += self._arms_in_brackets()

    def _is_yes(self, k: int) -> bool:
        """Whether a 1 alone is asked for yes: `while (1)`."""
        head, sign = self.tokens[max(0, k - 2)], self.tokens[k - 1]
        is_alone = (sign.text, self.tokens[k].text, self._next_lexeme(k).text) == ("(", "1", ")")
        return is_alone and bool(self._possible_words(head) & ASKING_WORDS)

    def _take_word(self, k: int, is_in_brackets: bool) -> None:
        token, before, after = (
            self.tokens[k],
            self.tokens[k - 1] if k else _END,
            self._next_lexeme(k),
        )
        if self._is_loose_unit(k):
            self.loose.append((lexicon_meaning(token.text, "unit")[0], token.source or token.text))
            return
        word = self._word(token)
        neighbours = {before.text, after.text}
        is_name_part = token.text in self._parts
        is_times_sign = token.text == "X" and before.kind is NUMBER and after.kind in (NUMBER, WORD)
        is_joint = (
            word in ("AND", "OR")
            and not is_in_brackets
            and bool(self._possible_words(after) & _DRIVING_WORDS)
        )
        is_repetition = (word == "IF" and before.text in ("AND", "OR")) or (
            word == "OR" and before.text in _COMPARISON_SENSES
        )
        is_repetition |= (
            after.text == "." and self._next_lexeme(k + 1).kind is WORD
        )  # `random.randint`
        is_repetition |= word in MOVES and after.kind is WORD and word == self._word(after)
        is_equal = any(text in ("=", "==") or lexicon_meaning(text, "is") for text in neighbours)
        is_needless = (word == "TRUE" and is_equal and is_in_brackets) or (
            word == "TIME" and not neighbours & _COMPARISON_SENSES.keys()
        )
        self.meant.update(self._possible_words(token))
        self.strange += token.text not in WORDS and not self.names.is_name(token.text)
        if is_name_part or is_times_sign or is_joint or is_repetition or is_needless:
            return
        if word in _COUNTED_WORDS or (word and word not in WORDS):
            self.words[word] += 1
            self.foreign[word] += word != token.text
            self.written.setdefault(word, token.source or token.text)

    def _next_lexeme(self, k: int) -> Lexeme:
        return self.tokens[k + 1] if k + 1 < len(self.tokens) else _END

    def _is_label(self, k: int) -> bool:
        """Whether a word after an end says which one ends."""
        position_before = k - 2 if k > 1 and self.tokens[k - 1].text in ("-", "_", ".") else k - 1
        before = self.tokens[position_before] if k else _END
        is_end = before.text in WORD_OF_END or bool(lexicon_meaning(before.text, "end"))
        token = self.tokens[k]
        is_block = token.text in self.names.defs or bool(
            self._possible_words(token) & BLOCK_ENDS.keys()
        )
        return (
            is_end and is_block and before.kind is WORD and self._next_lexeme(k).text in (";", "(")
        )

    # -- numbers ---------------------------------------------------------------------------------

    def _number(self, token: Lexeme) -> float | None:
        if token.kind is NUMBER:
            return float(token.text)
        text = lexicon_meaning(token.text, "number") if token.kind is WORD else ()
        is_other = self.names.is_name(token.text) or len(lexicon().get(token.text, ())) > 1
        return float(text[0]) if text and not is_other and text != ("1",) else None

    def _add_amount(self, k: int, value: float, slot: str) -> int:
        """Keep the number at a place with its sign and its unit; return where to read on."""
        token, after = self.tokens[k], self._next_lexeme(k)
        is_minus = self._is_minus(k)
        text = f"{'-' if is_minus else ''}{token.source or token.text}"
        while token.kind is WORD and value % 10 == 0:  # `ochenta y cinco`
            at = k + 1 + bool(lexicon_meaning(self._next_lexeme(k).text, "and"))
            next_number = self._number(self.tokens[at]) if at < len(self.tokens) else None
            if next_number is None or next_number >= (100 if value % 100 == 0 else 10):
                break
            value, k = value + next_number, at
        unit = slot if self.is_right else ""
        if unit_and_scale := self._unit_after(k):
            unit, scale = unit_and_scale
            value, k = value * scale / 1000, k + 1
            text += f"{after.space or ''}{after.source or after.text}"
        signed = -value if is_minus else value
        self.amounts.append(Amount(signed, unit, text, self.lines[k]))
        return k + 1

    def _is_minus(self, k: int) -> bool:
        """Whether the sign before a number belongs to it, and is none of a sum."""
        sign, before = self.tokens[k - 1] if k else _END, self.tokens[k - 2] if k > 1 else _END
        if sign.text != "-":
            return False
        is_value = before.kind is NUMBER or before.text == ")" or self.names.is_name(before.text)
        is_even = self.is_right or bool(sign.space) == bool(self.tokens[k].space)
        return not (is_value and is_even)

    def _unit_after(self, k: int) -> tuple[str, float] | None:
        """Return the unit after a number, and how many thousandths of it one is."""
        token, next_one = self._next_lexeme(k), self._next_lexeme(k + 1).text
        if token.text == "%" and next_one in (")", ",", ";"):  # no remainder of a division
            return "%", 1000
        text = lexicon_meaning(token.text, "unit")
        is_letter = len(token.text) == 1 and token.kind is WORD
        is_separate = is_letter and token.space != "" and next_one not in (",", ")")
        is_move_letter = is_letter and token.source == token.text and token.space != ""
        if not text or (is_separate and is_move_letter) or self.names.is_name(token.text):
            return None
        return text[0] if text[0] in _COUNTED_UNITS else "", float(text[1])

    def _is_loose_unit(self, k: int) -> bool:
        """Whether a word says a unit and nothing else, of no number."""
        token, before, after = (
            self.tokens[k],
            self.tokens[k - 1] if k else _END,
            self._next_lexeme(k),
        )
        texts = {item.kind for item in lexicon().get(token.text, ())}
        is_last_argument = len(token.text) == 1 and after.text in (",", ")") and before.kind is WORD
        is_only_unit = texts == {"unit"} or (
            "unit" in texts and (is_last_argument or token.text in EXTENTS)
        )
        is_unbound = not self.names.is_name(token.text) and after.kind is not NUMBER
        if not is_only_unit or not is_unbound or (len(token.text) == 1 and not is_last_argument):
            return False
        return lexicon_meaning(token.text, "unit")[0] in _UNITS

    def _slots(self) -> list[str]:
        """Return the unit that a value at each token has by its place, "" for none."""
        slots = [""] * len(self.tokens)
        units_by_depth: list[list[str]] = [[""]]
        for k, token in enumerate(self.tokens):
            if token.text == "(":
                units_by_depth.append(self._arguments(k) or [units_by_depth[-1][0]])
            elif token.text == ")" and len(units_by_depth) > 1:
                units_by_depth.pop()
            elif token.text == "," and len(units_by_depth[-1]) > 1:
                units_by_depth[-1] = units_by_depth[-1][1:]
            elif token is _END:
                units_by_depth = [[""]]
            slots[k] = units_by_depth[-1][0]
        counts = Counter(token.text for token in self.tokens)
        triples = zip(self.tokens, self.tokens[1:], self.tokens[2:], strict=False)
        for k, (one, sign, other) in enumerate(triples):
            if sign.text in _COMPARISON_SENSES or sign.text == "=":
                at = min(k + 3 if other.text == "-" else k + 2, len(slots) - 1)
                slots[at] = slots[at] or self.units.get(one.text, "")
                slots[k] = slots[k] or self.units.get(other.text, "")
                before = self.tokens[k - 1] if k else _END
                is_assignment = sign.text == "=" and before.text in ("|", ";", _END.text)
                is_stored = is_assignment and counts[one.text] == 1
                slots[at] = slots[at] or (_STORED_UNIT if is_stored else "")
        return slots

    def _arguments(self, k: int) -> list[str]:
        """Return the units of what is in the brackets that begin at a token."""
        word = self.tokens[k - 1] if k else _END
        if word.kind is not WORD:
            return []
        if word.text in self.names.parameters:
            return [self.units.get(name, "") for name in self.names.parameters[word.text]]
        if word.text not in WORDS or not WORDS[word.text].is_call:
            return [""]
        units = [argument.unit for argument in WORDS[word.text].arguments]
        after = texts(self.tokens[k : closed(self.tokens, k) or k])
        way = UNIT_OF.get(word.text, "")
        if way in after:
            units[0] = EXTENTS[way].unit
        return units

    def _units_of_names(self) -> dict[str, str]:
        """Return the units that variables have by their use; where they are two, with a `/`."""
        units_by_name: dict[str, dict[str, None]] = {}
        for token, unit in zip(self.tokens, self._slots(), strict=True):
            if unit and token.text in self.names.variables:
                units_by_name.setdefault(token.text, {})[unit] = None
        return {name: "/".join(units) for name, units in units_by_name.items()}

    # -- branches --------------------------------------------------------------------------------

    def calls(self, name: str) -> int:
        """Return how often a DEF is called: after DEF, or after an end, its name is no call."""
        result = 0
        for k, (before, lexeme) in enumerate(pairwise([_END, *self.tokens])):
            result += lexeme.text == name and not (
                "DEF" in self._possible_words(before) or self._is_label(k)
            )
        return result

    @cached_property
    def negations(self) -> list[str]:
        """Return the words that turn a question round, as they are written."""
        negations = []
        for k, token in enumerate(self.tokens):
            is_negation = token.text in ("NOT", "!") or bool(
                lexicon_meaning(token.text, *_NEGATING_KINDS)
            )
            if not is_negation or self.names.is_name(token.text):
                continue
            lexemes_before = self.tokens[max(0, k - 4) : k]
            if lexicon_meaning(token.text, "unless") or any(
                self._possible_words(it) & ASKING_WORDS for it in lexemes_before
            ):
                negations.append(token.source or token.text)
        return negations

    def sums(self) -> Counter[str]:
        """Count the signs between two values, of which one at least is no plain number."""
        sums: Counter[str] = Counter()
        after = (*self.tokens[3:], _END)
        for one, sign, other, inner in zip(
            self.tokens, self.tokens[1:], self.tokens[2:], after, strict=False
        ):
            is_first_value = one.text == ")" or self._is_read(one)
            is_other_value = self._is_read(inner if other.text == "(" else other)
            is_plain = one.kind is NUMBER and other.kind is NUMBER
            if sign.text in SUMS and is_first_value and is_other_value and not is_plain:
                sums[sign.text] += 1
        return sums

    def _is_read(self, token: Lexeme) -> bool:
        """Whether a token is a number, or a name that has a value."""
        return token.kind is NUMBER or token.text == "TIME" or token.text in self.names.known.values

    def empty(self) -> int:
        """Return how many branches have nothing in them."""
        left = [
            lexeme for lexeme in self.tokens if lexeme is not _END and lexeme.text not in (";", "{")
        ]
        result = 0
        for k, token in enumerate(left):
            word = self._word(token)
            if word in _HEADER_WORDS:
                end = closed(left, k + 1) if texts(left[k + 1 : k + 2]) == ("(",) else k + 1
                end += word == "DEF"
                if 0 < end < len(left):
                    is_branch_end = (
                        left[end].text in (*WORD_OF_END, "}") or self._word(left[end]) in _ARMS
                    )
                    result += is_branch_end
        return result

    def _arms_in_brackets(self) -> int:
        """Return how many IFs have two branches in their brackets: `IF(question, F, B)`."""
        result = 0
        for k, token in enumerate(self.tokens[:-1]):
            end = closed(self.tokens, k + 1) if self._next_lexeme(k).text == "(" else 0
            if end and "IF" in self._possible_words(token):
                inside = pairwise(self.tokens[k + 2 : end - 1])
                begun = [b for a, b in inside if a.text in (",", ";")]
                result += (
                    sum(bool(self._possible_words(lexeme) & _DRIVING_WORDS) for lexeme in begun) > 1
                )
        return result


@lru_cache(2)
def _words_of_wrong(text: str, other_words: frozenset[str], kit: Kit) -> _Said:
    text = apply_edits(text, note_edits(text))
    return _Said(apply_edits(text, key_edits(text, kit)), other_words, kit, is_right=False)


@lru_cache(2)
def _words_of_right(text: str, kit: Kit) -> _Said:
    return _Said(text, _words_of(text), kit, is_right=True)


def _words_of(text: str) -> frozenset[str]:
    return frozenset(item.upper() for item in _NAME.findall(text))


def _amounts(before: _Said, after: _Said) -> Iterator[str]:
    """Give the numbers that are gone, or have another sign or unit."""
    new_stock, old_stock = _Stock(after.amounts), _Stock(before.amounts)
    read_parts: list[float] = []  # the parts of the run that was read last, which is one number
    for value, parts in _runs(before.body):
        is_one_number = parts is not read_parts and new_stock.has([value]) and old_stock.has(parts)
        if is_one_number and not new_stock.has(parts):
            read_parts = parts
            new_stock.take([value])
            old_stock.take(parts)
    lost_amounts, new_amounts = old_stock.all(), new_stock.all()
    for is_same_line in (True, False):  # first what stays in its line: another line's 50 is no 50 %
        lost_amounts, new_amounts = _unmatched(lost_amounts, new_amounts, is_same_line)
    yield from (amount.source_text for amount in lost_amounts)
    units = {unit for it in after.amounts for unit in it.unit.split("/")}
    units |= {after.units.get(token.text, "") for token in after.tokens}
    loose = Counter(after.loose)
    yield from (item[1] for item in before.loose if item[0] not in units and not loose[item])


class _Stock:
    """Amounts of a text, by how much they are without a sign; the first of each goes first."""

    def __init__(self, amounts: Sequence[Amount]) -> None:
        self.amounts = amounts
        self.places: dict[float, deque[int]] = {}
        for k, amount in enumerate(amounts):
            self.places.setdefault(abs(amount.value), deque()).append(k)

    def has(self, values: Sequence[float]) -> bool:
        """Whether there is one for each of these, of which there is one at least."""
        result = (len(self.places.get(value, ())) >= n for value, n in Counter(values).items())
        return bool(values) and all(result)

    def take(self, values: Sequence[float]) -> None:
        for value in values:
            self.places[value].popleft()

    def all(self) -> list[Amount]:
        return [self.amounts[k] for k in sorted(k for item in self.places.values() for k in item)]


def _unmatched(
    before: Sequence[Amount], after: Sequence[Amount], is_same_line: bool
) -> tuple[list[Amount], list[Amount]]:
    """Return the amounts of two texts without those that both have; `is_same_line`: in one line."""
    places: dict[tuple[int, int], dict[str, deque[int]]] = {}
    for k, amount in enumerate(after):
        key = _thousandths(amount.value), amount.line * is_same_line
        places.setdefault(key, {}).setdefault(amount.unit, deque()).append(k)
    unmatched_amounts: list[Amount] = []
    matched_positions: set[int] = set()
    for amount in before:
        scale = LAP if amount.unit == "turns" else 1
        keys = {
            (_thousandths(amount.value * factor), amount.line * is_same_line)
            for factor in (1, scale)
        }
        fitting_positions = [
            positions
            for key in keys
            for positions in places.get(key, {}).values()
            if positions and _is_same(amount, after[positions[0]])
        ]
        if fitting_positions:
            nearest = min(
                fitting_positions,
                key=lambda positions: (after[positions[0]].unit != amount.unit, positions[0]),
            )
            matched_positions.add(nearest.popleft())
        else:
            unmatched_amounts.append(amount)
    return unmatched_amounts, [
        amount for k, amount in enumerate(after) if k not in matched_positions
    ]


def _thousandths(value: float) -> int:
    return round(value * 1000)


def _is_same(before: Amount, after: Amount) -> bool:
    if (before.unit, after.unit) == ("turns", "°"):
        return _thousandths(before.value * LAP) == _thousandths(after.value)
    units = {*after.unit.split("/")} - {""}
    is_unit = not before.unit or units <= {*before.unit.split("/")}
    is_unit |= units == {_STORED_UNIT} and before.unit not in _WAY_UNITS
    return is_unit and _thousandths(before.value) == _thousandths(after.value)


def _runs(text: str) -> Iterator[tuple[float, list[float]]]:
    """Give what digits may mean as one number, and as several: `2,5`, `8 0`, `8O`, `1:30`."""
    pieces = [*_DIGITS.finditer(text)]
    for first in range(len(pieces)):
        for last in range(first, min(first + _MOST_NUMBER_PARTS, len(pieces))):
            run = pieces[first : last + 1]
            gaps = [text[a.end() : b.start()] for a, b in pairwise(run)]
            if not all(_GROUP_SEPARATORS.fullmatch(gap) for gap in gaps):
                break
            digits = [match[0].translate(_DIGITS_OF_LETTERS) for match in run]
            sentence = text[run[0].start() : run[-1].end()]
            parts = [float(item) for item in re.findall(r"\d+(?:\.\d+)?|\.\d+", sentence)]
            is_thousands = len(digits[-1]) == _GROUP_DIGITS
            is_decimal = not is_thousands and all("," in gap or "." in gap for gap in gaps)
            values = _values(digits, is_decimal, ":" in sentence)
            yield from ((value, parts) for value in values)


def _values(digits: Sequence[str], is_decimal: bool, is_time: bool) -> Iterator[float]:
    """Give what parts of a number may be, the likeliest first: `2,5` is rather no 25."""
    points = [f"{''.join(digits[:k])}.{''.join(digits[k:])}" for k in range(1, len(digits))]
    joined = "".join(digits)
    yield from map(float, (*points, joined) if is_decimal else (joined, *points))
    if is_time and len(digits) > 1:
        yield 60 * float(digits[0]) + float(digits[1])


def _words(before: _Said, after: _Said) -> Iterator[str]:
    """Give the words that are gone, and are not in a note."""
    noted = after.notes - before.notes
    is_turned = _senses(before) != _senses(after)
    for word, count in before.words.items():
        missing = count - after.words[word]
        instead = max(
            (after.words[it] - before.words[it] for it in _COUNTED_AS.get(word, ())), default=0
        )
        instead = max(instead, min(noted[word], before.foreign[word]))
        if missing > instead and not (word == "NOT" and is_turned):
            yield before.written.get(word, word)


def _questions(before: _Said, after: _Said) -> Iterator[str]:
    """Give the comparisons that are gone, or turned round, and branches that nothing is in."""
    lost_senses = _senses(before) - (after.notes - before.notes)
    new_senses = _senses(after)
    turners = ({word: item.words[word] for word in _QUESTION_TURNERS} for item in (before, after))
    negated = (before.negations, after.negations)
    may_turn = bool(negated[0] or negated[1]) or len({str(turner) for turner in turners}) > 1
    if lost_senses.total() > new_senses.total() or (lost_senses - new_senses and not may_turn):
        yield from (lost_senses - new_senses) or lost_senses
    elif lost_senses == new_senses and len(negated[0]) > len(
        negated[1]
    ):  # nothing is turned round instead
        yield negated[0][0]
    if after.empty() > before.empty():
        yield "ELSE"


def _senses(words_said: _Said) -> Counter[str]:
    senses: Counter[str] = Counter()
    open_brackets = [False]
    for one, sign, other in zip(
        words_said.tokens, words_said.tokens[1:], words_said.tokens[2:], strict=False
    ):
        if sign.text == "(":
            open_brackets.append(one.text in CALL_WORDS)
        elif sign.text == ")":
            open_brackets = open_brackets[:-1] or [False]
        elif sign is _END:
            open_brackets = [False]
        is_comparison = one.kind in (WORD, NUMBER) or one.text == ")"
        is_comparison &= other.kind in (WORD, NUMBER) or other.text in ("(", "-", "+")
        if (
            sign.text in _COMPARISON_SENSES
            and is_comparison
            and not open_brackets[-1]
            and one.text not in CALL_WORDS
        ):
            senses[_COMPARISON_SENSES[sign.text]] += 1
    return senses
