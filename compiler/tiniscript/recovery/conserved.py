"""Conservation: the content that a repair omits, and the actions that it adds.

Counts numbers with their signs and units, names, commands, comparisons and branches, as far as
words and signs say them. It knows no row: it compares the text before and after.
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
from tiniscript.recovery.labels import label_spans
from tiniscript.recovery.meanings import (
    ASKING_WORDS,
    CALL_WORDS,
    FULL_TURN,
    NEAR_CM,
    NEAR_COST,
    Lexeme,
    Names,
    brackets_end,
    lexemes,
    lexicon_concept,
    lexicon_meaning,
    texts,
)
from tiniscript.recovery.notes import note_edits
from tiniscript.recovery.rewrites import join_one_name
from tiniscript.recovery.writing import PLAIN_SIGNS, instruction_at, split_note
from tiniscript.syntax.blocks import WORD_OF_END
from tiniscript.syntax.lexer import NUMBER, WORD
from tiniscript.syntax.operators import ARITHMETIC_SIGNS

_COMPARISON_SENSES = {
    "<": "<", "<=": "<", ">": ">", ">=": ">", "<>": "<>", "=<": "<", "=>": ">", "!=": "<>",
    "=!": "<>", "≤": "<", "≥": ">", "≠": "<>",
}  # fmt: skip
_UNITS = ("s", "cm", "°", "%", "Hz")
_WAY_UNITS = tuple(way.unit for way in EXTENTS.values())
_STORED_UNIT = "="  # unit of a stored number that nothing reads; a move would use seconds
_COUNTED_UNITS = (*_UNITS, "turns")  # units with a number before them
_ARMS = ("ELSE", "ELSEIF")
_HEADER_WORDS = frozenset((*BLOCK_ENDS, *_ARMS))
_DRIVING_WORDS = frozenset((*MOVES, "M", "W", "BEEP", "S"))
_COUNTED_WORDS = frozenset((
    *_DRIVING_WORDS, *_HEADER_WORDS, *FUNCTIONS, "SHOW", "UNTIL", "BREAK", "AND", "OR", "NOT",
    "TRUE", "FALSE", "TIME", "FOREVER",
))  # fmt: skip
# Phrases without their own word: `repeat until` is WHILE, `void loop` is FOREVER.
_SUBSTITUTES_OF_WORD = {
    "LOOP": ("WHILE", "BREAK", "FOREVER"), "WHILE": ("BREAK", "UNTIL"), "UNTIL": ("WHILE", "BREAK"),
    "FOREVER": ("TRUE", "LOOP", "WHILE"), "TRUE": ("FOREVER",), "S": ("BREAK", "UNTIL"),
    "IF": ("WHEN",), "WHEN": ("IF", "UNTIL"), "ELSE": ("ELSEIF",), "DEF": ("TASK", "FOREVER"),
}  # fmt: skip
_QUESTION_TURNERS = ("NOT", "UNTIL", "WHILE")  # removing one of these may invert a question
_NEGATING_KINDS = ("no", "without", "unless", "different")
# Text that only surrounds a program: its setup, HTML tags, an anonymous function, line labels.
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
# Digits, and letters that look like them; and separators between the parts of a number.
_DIGITS = re.compile(r"[0-9oOlI]*[0-9][0-9oOlI]*|\b[oO](?=\.)")
_GROUP_SEPARATORS = re.compile(r"[.,:;'´`·_ ]*")
_DIGITS_OF_LETTERS = str.maketrans("oOlI", "0011")
_NUMBER_WITH_UNIT = re.compile(r"[\d.]+\s*([^\W\d]+|[%°])")
_SEPARATORS = ";\n"
_MAX_NUMBER_PARTS = 3  # parts of a number
_GROUP_DIGITS = 3  # digits of the last part of `1,000`
# The removable parts of a text, and the codes whose messages name their effect.
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
    """A number with its sign and its unit, "" if unknown; its text and place."""

    value: float
    unit: str
    source_text: str
    line: int


MAX_EXAMINED_LOSSES = 40  # most losses examined in one text, and most characters examined in each
MAX_EXAMINED_CHARACTERS = 100_000
MAX_LAYERS = 8


class Difference(NamedTuple):
    """The `losses`, as they are written, and the commands that there are more of: `additions`."""

    losses: list[str]
    additions: list[str]


NO_DIFFERENCE = Difference([], [])
UNKNOWN_DIFFERENCE = Difference([""], [])  # a difference that has not been examined, or not alone


def difference(text: str, repaired_text: str, kit: Kit) -> Difference:
    """Return the difference between a text and its repair, in both directions."""
    statement, repaired_statement = (
        _statement_of_wrong(text, _words_of(repaired_text), kit),
        _statement_of_right(repaired_text, kit),
    )
    losses = [
        *_lost_amounts(statement, repaired_statement),
        *_lost_words(statement, repaired_statement),
        *_lost_questions(statement, repaired_statement),
    ]
    losses += statement.count_sum_signs() - repaired_statement.count_sum_signs()
    additions = [
        word
        for word in _DRIVING_WORDS
        if repaired_statement.sure_word_counts[word] > statement.possible_word_counts[word]
    ]
    additions = additions if len(additions) > statement.unknown_word_count else []
    additions += [
        name
        for name in repaired_statement.names.defs
        if repaired_statement.count_calls(name) > statement.count_calls(name)
    ]
    return Difference([*dict.fromkeys(losses)], additions)


def withhold_lossy_repairs(
    diagnostics: Sequence[Diagnostic], text: str, kit: Kit
) -> list[Diagnostic]:
    """Return diagnostics whose certain repairs lose and add nothing.

    A lossy repair is shown together with what is `lost`, and so is an unsure one.
    """
    sure_diagnostics = [
        diagnostic
        for diagnostic in diagnostics
        if diagnostic.repair and diagnostic.repair.is_sure and diagnostic.repair.edits
    ]
    loss_of_diagnostic = _losses_of_sure_repairs(sure_diagnostics, text, kit)
    shown_diagnostics = [
        diagnostic
        for diagnostic in diagnostics
        if id(diagnostic) not in loss_of_diagnostic
        and "lost" not in diagnostic.values
        and not (diagnostic.repair and diagnostic.repair.is_sure)
        and edits_of(diagnostic)
    ]
    losses = zip(shown_diagnostics, _losses(shown_diagnostics, text, kit), strict=True)
    unmentioned_of_diagnostic = {
        id(diagnostic): unmentioned_losses
        for diagnostic, loss in losses
        if (unmentioned_losses := _unmentioned_losses(diagnostic, loss.losses, text))
    }
    losses_of_diagnostic = unmentioned_of_diagnostic | {
        key: loss.losses for key, loss in loss_of_diagnostic.items()
    }
    return [
        _with_losses(diagnostic, losses_of_diagnostic[id(diagnostic)])
        if id(diagnostic) in losses_of_diagnostic
        else diagnostic
        for diagnostic in diagnostics
    ]


def _losses_of_sure_repairs(
    sure_diagnostics: Sequence[Diagnostic], text: str, kit: Kit
) -> dict[int, Difference]:
    """Return the losses of certain repairs: of each alone, or of all together."""
    edits = [diagnostic.repair.edits for diagnostic in sure_diagnostics if diagnostic.repair]
    joint_edits = [edit for k in _layers(dict(enumerate(edits)))[0] for edit in edits[k]]
    if not joint_edits or not any(difference(text, apply_edits(text, joint_edits), kit)):
        return {}
    loss_of_diagnostic = {
        id(diagnostic): loss
        for diagnostic, loss in zip(
            sure_diagnostics, _losses(sure_diagnostics, text, kit), strict=True
        )
    }
    is_only_joint = not any(
        any(difference) for difference in loss_of_diagnostic.values()
    )  # no single one does: then all together do
    return {key: loss for key, loss in loss_of_diagnostic.items() if is_only_joint or any(loss)}


def are_lossless(diagnostics: Sequence[Diagnostic], text: str, kit: Kit) -> list[bool]:
    """Return for each diagnostic whether its edits alone keep everything that was written."""
    return [not loss.losses for loss in _losses(diagnostics, text, kit)]


def _losses(diagnostics: Sequence[Diagnostic], text: str, kit: Kit) -> list[Difference]:
    """Return the losses of each diagnostic's edits alone.

    If there are many, they are checked together: halves of them, while checks are left. If many
    together lose something, each loses what its own instructions contain.
    """
    edits = [edits_of(diagnostic) or () for diagnostic in diagnostics]
    changing_keys = [k for k, edits_of_one in enumerate(edits) if edits_of_one]
    looks_left = min(MAX_EXAMINED_LOSSES, MAX_EXAMINED_CHARACTERS // (len(text) + 1))
    differences = [NO_DIFFERENCE] * len(edits)
    groups = deque([k] for k in changing_keys)
    if len(groups) > looks_left:
        *layers, last_layer = _layers({k: edits[k] for k in changing_keys})
        groups = deque(layers)
        for k in last_layer:
            differences[k] = UNKNOWN_DIFFERENCE
    while groups:
        group, looks_left = groups.popleft(), looks_left - 1
        joint_difference = difference(
            text, apply_edits(text, [edit for k in group for edit in edits[k]]), kit
        )
        half_count = len(group) // 2
        if half_count and any(joint_difference) and looks_left > len(groups) + 1:
            groups += [group[:half_count], group[half_count:]]
        elif any(joint_difference):
            shares = _split_difference(
                joint_difference, [_surrounding_text(edits[k], text) for k in group]
            )
            for k, share in zip(group, shares, strict=True):
                differences[k] = share
    return differences


def _layers(edits: Mapping[int, Sequence[Edit]]) -> list[list[int]]:
    """Return groups of changes that do not touch, by their keys, and at last those in no group."""
    layers: list[list[int]] = [[] for _ in range(MAX_LAYERS + 1)]
    spans_by_layer: list[list[Span]] = [[] for _ in range(MAX_LAYERS)]
    for k, edits_of_one in edits.items():
        free_layers = (
            layer_index
            for layer_index, spans in enumerate(spans_by_layer)
            if not any(_overlaps(edit, spans) for edit in edits_of_one)
        )
        layer_index = next(free_layers, MAX_LAYERS)
        layers[layer_index].append(k)
        for edit in edits_of_one if layer_index < MAX_LAYERS else ():
            insort(spans_by_layer[layer_index], edit.span)
    return [layer for layer in layers[:-1] if layer] + layers[-1:]


def _overlaps(edit: Edit, spans: Sequence[Span]) -> bool:
    """Return whether an edit overlaps these ordered, disjoint spans."""
    index = bisect_right(spans, edit.span.end, key=lambda span: span.start)
    return index > 0 and spans[index - 1].end >= edit.span.start


def _split_difference(joint: Difference, parts: Sequence[str]) -> list[Difference]:
    """Return the losses of several edits in these parts: the text that they contain."""
    if len(parts) == 1:
        return [joint]
    losses_by_part = [[loss for loss in joint.losses if loss in part] for part in parts]
    is_complete = not joint.additions and {*joint.losses} == {
        loss for losses in losses_by_part for loss in losses
    }
    return [
        Difference(losses, []) if losses or is_complete else UNKNOWN_DIFFERENCE
        for losses in losses_by_part
    ]


def _surrounding_text(edits: Sequence[Edit], text: str) -> str:
    """Return the instructions that changes are in."""
    start, end = min(edits).span.start, max(edit.span.end for edit in edits)
    text_start = max(text.rfind(sign, 0, start) for sign in _SEPARATORS) + 1
    separators_after = [text.find(sign, end) for sign in _SEPARATORS]
    return text[
        text_start : min((offset for offset in separators_after if offset >= 0), default=len(text))
    ]


def _unmentioned_losses(diagnostic: Diagnostic, losses: Sequence[str], text: str) -> list[str]:
    """Return the unmentioned losses of a shown edit: a unit, or removed text.

    A minus is not among these: it reverses a move.
    """
    edits = edits_of(diagnostic) or []
    new_text = " ".join(edit.text for edit in edits).upper()
    removed_words = {
        *_COUNTED_TOKEN.findall(" ".join(text[slice(*edit.span)] for edit in edits).upper())
    }
    kept_words = {*_COUNTED_TOKEN.findall(new_text)}
    is_only_cut = kept_words <= removed_words and diagnostic.code not in _NAMING_CODES
    unmentioned_losses = []
    for loss in losses:
        unit_match = _NUMBER_WITH_UNIT.fullmatch(loss) if diagnostic.repair else None
        is_lost_unit = unit_match is not None and unit_match[1].upper() not in new_text
        if is_lost_unit or (is_only_cut and loss.upper() in removed_words - kept_words):
            unmentioned_losses.append(loss)
    return unmentioned_losses


def name_samples(diagnostics: Sequence[Diagnostic], text: str, kit: Kit) -> list[Diagnostic]:
    """Return diagnostics that mark each number not written by the user as an example.

    Such a number is a distance that a pupil called near, `DISTANCE < 10` for "near a wall", or the
    time, the power or the pitch that a call lacks. If the text has that number, or the message
    shows an example anyway, nothing changes.
    """
    written_numbers: set[float] | None = None
    named_diagnostics = []
    for diagnostic in diagnostics:
        fix = diagnostic.values.get("fix", "")
        samples = [] if diagnostic.values.get("example") else _possible_samples(fix)
        if samples and len(_NUMBER.findall(fix)) <= _count_numbers(diagnostic, text):
            samples = [
                sample for sample in samples if sample[1] == _NEAR_SAMPLE
            ]  # each names one amount, in words or nearly
        if samples and written_numbers is None:
            written_numbers = {amount.value for amount in _statement_of_right(text, kit).amounts}
        samples_text = ", ".join(
            sample for number, sample in samples if number not in (written_numbers or ())
        )
        gap = "samples" if ", " in samples_text else "sample"
        values = {**diagnostic.values, gap: samples_text} if samples_text else diagnostic.values
        named_diagnostics.append(diagnostic._replace(values=values))
    return named_diagnostics


def _count_numbers(diagnostic: Diagnostic, text: str) -> int:
    """Return the number of numbers at a mistake, in digits, words or nearly so."""
    span = diagnostic.place or diagnostic.span
    if ";" not in diagnostic.values.get("fix", ""):
        span = instruction_at(diagnostic.span, Source(text))
    return sum(
        any(map(str.isdigit, token.text)) or bool(lexicon_meaning(token.text, *_NUMBERED_KINDS))
        for token in lexemes(text[slice(*span)])
    )


def _possible_samples(fix: str) -> list[tuple[float, str]]:
    """Return the numbers of an offer that may be examples, each with its unit."""
    samples = [_NEAR_SAMPLE] if _NEAR_QUESTION.search(fix) else []
    for match in _CALL.finditer(fix):
        arguments = WORDS[match[1]].arguments if match[1] in _DRIVING_WORDS else ()
        samples += [
            f"{argument.sample} {argument.unit}"
            for argument, value in zip(arguments, match[2].split(","), strict=False)
            if value.strip() == argument.sample
        ]
    return [(float(sample.split()[0]), sample) for sample in dict.fromkeys(samples)]


def _with_losses(diagnostic: Diagnostic, losses: Sequence[str]) -> Diagnostic:
    values = {**diagnostic.values, "lost": ", ".join(losses)} if losses else diagnostic.values
    repair = diagnostic.repair and diagnostic.repair._replace(is_sure=False)
    return diagnostic._replace(values=values, repair=repair)


class _Statement:
    """The content of a text in words of any language; `other_words` are those of the repair."""

    def __init__(self, text: str, other_words: frozenset[str], kit: Kit, is_right: bool) -> None:
        self.is_right = is_right  # right after its repair
        self.other_words = other_words
        parts = [split_note(line.translate(PLAIN_SIGNS)) for line in text.split("\n")]
        self.note_words = Counter(self._all_lines([note for _, note in parts]))
        self.body_text = self._without_frame("\n".join(body for body, _ in parts))
        lines = [lexemes(self._separated_numbers(line)) for line in self.body_text.split("\n")]
        self.names = Names(lines, kit)
        self.tokens = [token for line in lines for token in (*self._join_words(line), _END)]
        self.line_of_token = [0, *accumulate(token is _END for token in self.tokens)]
        self._concepts_of_text: dict[str, set[str]] = {}
        # Last words of names with spaces, such as `mi velocidad`.
        self._name_ends = {row[-1] for row in self.names.spaced_names}
        # A number without a unit has another meaning: 50 % of light is not 50.
        self.units = {reading.name: reading.unit or reading.name for reading in kit.readings} | {
            "TIME": "s"
        }
        self.units |= self._units_of_names()
        # Words that the statement certainly contains.
        self.sure_word_counts: Counter[str] = Counter()
        self.possible_word_counts: Counter[str] = Counter()  # words that the statement may contain
        self.source_of_word: dict[str, str] = {}
        self.amounts: list[Amount] = []
        self.loose_units: list[
            tuple[str, str]
        ] = []  # units after no number, and how they are written
        self.foreign_word_counts: Counter[str] = Counter()  # the subset that is in another language
        self.unknown_word_count = 0  # words of other languages, or of no language
        self._read()

    @staticmethod
    def _all_lines(lines: Sequence[str]) -> list[str]:
        return [lexicon_concept(text) or text for line in lines for text in texts(lexemes(line))]

    @staticmethod
    def _without_frame(text: str) -> str:
        for sign, replacement in _ESCAPED_SIGNS.items():
            text = re.sub(rf"(?<=\d) ?{sign}", replacement, text) if replacement[0] == "." else text
            text = text.replace(sign, f"0{replacement}" if replacement[0] == "." else replacement)
        text = apply_edits(text, [Edit(span, "") for span in label_spans(text)])
        return _FRAME_PATTERN.sub(";", text)

    def _separated_numbers(self, line: str) -> str:
        """Return a line with separate numbers, except those in names: `F2,80`, `F_2_80`."""
        for fraction, decimals in _FRACTIONS.items():
            line = re.sub(rf"(?<!\d)(\d) {fraction}(?!\d)", rf"\1{decimals}", line)
            lone_fraction = rf"(?i)(?<![\d)] )(?<!\d){fraction}(?!\d)(?=\s*[a-z])"
            line = re.sub(lone_fraction, f"0{decimals}", line)
        return _GLUED_NUMBER.sub(
            lambda match: (
                match[0] if match[0].upper() in self.other_words else f"{match[1]} {match[2]} "
            ),
            line,
        )

    def _join_words(self, line: list[Lexeme]) -> list[Lexeme]:
        """Return a line in which words are one that the language, or the repair, has as one."""
        joined_tokens: list[Lexeme] = []
        for token in line:
            last_token = joined_tokens[-1] if joined_tokens else _END
            word_before = (
                joined_tokens[-2]
                if last_token.text in ("-", "_", ".") and len(joined_tokens) > 1
                else last_token
            )
            joined_word = f"{word_before.text}_{token.text}"
            if word_before.kind is token.kind is WORD and joined_word in self.other_words:
                joined_tokens[
                    joined_tokens.index(word_before, -2 if word_before is not last_token else -1) :
                ] = [token._replace(text=joined_word)]
            elif last_token.text == "ELSE" and token.text == "IF":
                joined_tokens[-1] = token._replace(text="ELSEIF")
            else:
                joined_tokens.append(token)
        while joined_line := join_one_name(joined_tokens, self.names):
            joined_tokens = joined_line[0]
        return joined_tokens

    # -- the meaning of each word ----------------------------------------------------------------

    def _sure_word(self, token: Lexeme) -> str:
        """Return the word of the language, or the name, that a word surely says, "" for none."""
        text = ALIASES.get(token.text, token.text)
        if self.names.is_name(text) or (text in WORDS and text != "SI"):
            return "S" if text == "STOP" else text
        return (lexicon_concept(text) or "") if len(lexicon().get(text, ())) == 1 else ""

    def _possible_words(self, token: Lexeme) -> set[str]:
        """Return the words of the language that a word may say."""
        if token.text not in self._concepts_of_text:
            self._concepts_of_text[token.text] = self._concepts_of(token)
        return self._concepts_of_text[token.text]

    def _concepts_of(self, token: Lexeme) -> set[str]:
        concepts = {self._sure_word(token), lexicon_concept(token.text) or ""}
        concepts |= {
            meaning.concept
            for meaning in self.names.meanings(token.text)
            if meaning.cost <= NEAR_COST
        }
        return {"S" if concept == "STOP" else concept for concept in concepts}

    def _read(self) -> None:
        units = self._units_at_tokens()
        k, open_brackets = 0, [False]  # whether each bracket is that of a call
        while k < len(self.tokens):
            token, previous_token = self.tokens[k], self.tokens[k - 1] if k else _END
            if token.text == "(":
                open_brackets.append(bool(self._possible_words(previous_token) & CALL_WORDS))
            elif token.text == ")":
                open_brackets = open_brackets[:-1] or [False]
            elif token is _END:
                open_brackets = [False]
            if (value := self._number_of(token)) is not None:
                is_amount_word = (
                    bool(lexicon_meaning(previous_token.text, "leaves", "by"))
                    and previous_token.kind is WORD
                )
                k = (
                    k + 1
                    if is_amount_word or self._is_lone_one(k)
                    else self._add_amount(k, value, units[k])
                )
                continue
            if token.kind is WORD and not self._is_label(k):
                self._count_word(k, len(open_brackets) > 1)
            k += 1
        self.sure_word_counts["ELSE"] += self._count_arms_in_brackets()

    def _is_lone_one(self, k: int) -> bool:
        """Return whether a single 1 means TRUE: `while (1)`."""
        header, bracket = self.tokens[max(0, k - 2)], self.tokens[k - 1]
        is_alone = (bracket.text, self.tokens[k].text, self._next_token(k).text) == ("(", "1", ")")
        return is_alone and bool(self._possible_words(header) & ASKING_WORDS)

    def _count_word(self, k: int, is_in_brackets: bool) -> None:
        token, previous_token, following_token = (
            self.tokens[k],
            self.tokens[k - 1] if k else _END,
            self._next_token(k),
        )
        if self._is_loose_unit(k):
            self.loose_units.append(
                (lexicon_meaning(token.text, "unit")[0], token.source or token.text)
            )
            return
        word = self._sure_word(token)
        neighbour_texts = {previous_token.text, following_token.text}
        is_name_part = token.text in self._name_ends
        is_times_sign = (
            token.text == "X"
            and previous_token.kind is NUMBER
            and following_token.kind in (NUMBER, WORD)
        )
        is_joint = (
            word in ("AND", "OR")
            and not is_in_brackets
            and bool(self._possible_words(following_token) & _DRIVING_WORDS)
        )
        is_repetition = (word == "IF" and previous_token.text in ("AND", "OR")) or (
            word == "OR" and previous_token.text in _COMPARISON_SENSES
        )
        is_repetition |= (
            following_token.text == "." and self._next_token(k + 1).kind is WORD
        )  # `random.randint`
        is_repetition |= (
            word in MOVES
            and following_token.kind is WORD
            and word == self._sure_word(following_token)
        )
        is_equal = any(
            text in ("=", "==") or lexicon_meaning(text, "is") for text in neighbour_texts
        )
        is_needless = (word == "TRUE" and is_equal and is_in_brackets) or (
            word == "TIME" and not neighbour_texts & _COMPARISON_SENSES.keys()
        )
        self.possible_word_counts.update(self._possible_words(token))
        self.unknown_word_count += token.text not in WORDS and not self.names.is_name(token.text)
        if is_name_part or is_times_sign or is_joint or is_repetition or is_needless:
            return
        if word in _COUNTED_WORDS or (word and word not in WORDS):
            self.sure_word_counts[word] += 1
            self.foreign_word_counts[word] += word != token.text
            self.source_of_word.setdefault(word, token.source or token.text)

    def _next_token(self, k: int) -> Lexeme:
        return self.tokens[k + 1] if k + 1 < len(self.tokens) else _END

    def _is_label(self, k: int) -> bool:
        """Return whether a word after an end names the block that ends."""
        position_before = k - 2 if k > 1 and self.tokens[k - 1].text in ("-", "_", ".") else k - 1
        previous_token = self.tokens[position_before] if k else _END
        is_end = previous_token.text in WORD_OF_END or bool(
            lexicon_meaning(previous_token.text, "end")
        )
        token = self.tokens[k]
        is_block = token.text in self.names.defs or bool(
            self._possible_words(token) & BLOCK_ENDS.keys()
        )
        return (
            is_end
            and is_block
            and previous_token.kind is WORD
            and self._next_token(k).text in (";", "(")
        )

    # -- numbers ---------------------------------------------------------------------------------

    def _number_of(self, token: Lexeme) -> float | None:
        if token.kind is NUMBER:
            return float(token.text)
        meaning = lexicon_meaning(token.text, "number") if token.kind is WORD else ()
        is_other = self.names.is_name(token.text) or len(lexicon().get(token.text, ())) > 1
        return float(meaning[0]) if meaning and not is_other and meaning != ("1",) else None

    def _add_amount(self, k: int, value: float, slot_unit: str) -> int:
        """Keep the number at a place with its sign and its unit; return where to read on."""
        token, following_token = self.tokens[k], self._next_token(k)
        is_minus = self._is_minus(k)
        text = f"{'-' if is_minus else ''}{token.source or token.text}"
        while token.kind is WORD and value % 10 == 0:  # `ochenta y cinco`
            number_index = k + 1 + bool(lexicon_meaning(self._next_token(k).text, "and"))
            next_number = (
                self._number_of(self.tokens[number_index])
                if number_index < len(self.tokens)
                else None
            )
            if next_number is None or next_number >= (100 if value % 100 == 0 else 10):
                break
            value, k = value + next_number, number_index
        unit = slot_unit if self.is_right else ""
        if unit_and_scale := self._unit_after(k):
            unit, scale = unit_and_scale
            value, k = value * scale / 1000, k + 1
            text += f"{following_token.space or ''}{following_token.source or following_token.text}"
        signed_value = -value if is_minus else value
        self.amounts.append(Amount(signed_value, unit, text, self.line_of_token[k]))
        return k + 1

    def _is_minus(self, k: int) -> bool:
        """Return whether a minus belongs to a number, not to a subtraction."""
        sign, previous_token = (
            self.tokens[k - 1] if k else _END,
            self.tokens[k - 2] if k > 1 else _END,
        )
        if sign.text != "-":
            return False
        is_value = (
            previous_token.kind is NUMBER
            or previous_token.text == ")"
            or self.names.is_name(previous_token.text)
        )
        is_evenly_spaced = self.is_right or bool(sign.space) == bool(self.tokens[k].space)
        return not (is_value and is_evenly_spaced)

    def _unit_after(self, k: int) -> tuple[str, float] | None:
        """Return the unit after a number, and how many thousandths of it one is."""
        token, next_text = self._next_token(k), self._next_token(k + 1).text
        if token.text == "%" and next_text in (")", ",", ";"):  # no remainder of a division
            return "%", 1000
        meaning = lexicon_meaning(token.text, "unit")
        is_letter = len(token.text) == 1 and token.kind is WORD
        is_separate = is_letter and token.space != "" and next_text not in (",", ")")
        is_move_letter = is_letter and token.source == token.text and token.space != ""
        if not meaning or (is_separate and is_move_letter) or self.names.is_name(token.text):
            return None
        return meaning[0] if meaning[0] in _COUNTED_UNITS else "", float(meaning[1])

    def _is_loose_unit(self, k: int) -> bool:
        """Return whether a word is only a unit, without a number."""
        token, previous_token, following_token = (
            self.tokens[k],
            self.tokens[k - 1] if k else _END,
            self._next_token(k),
        )
        kinds = {item.kind for item in lexicon().get(token.text, ())}
        ends_argument = (
            len(token.text) == 1
            and following_token.text in (",", ")")
            and previous_token.kind is WORD
        )
        is_only_unit = kinds == {"unit"} or (
            "unit" in kinds and (ends_argument or token.text in EXTENTS)
        )
        is_unbound = not self.names.is_name(token.text) and following_token.kind is not NUMBER
        if not is_only_unit or not is_unbound or (len(token.text) == 1 and not ends_argument):
            return False
        return lexicon_meaning(token.text, "unit")[0] in _UNITS

    def _units_at_tokens(self) -> list[str]:
        """Return the unit that a value at each token has by its place, "" for none."""
        unit_of_token = [""] * len(self.tokens)
        units_by_depth: list[list[str]] = [[""]]
        for k, token in enumerate(self.tokens):
            if token.text == "(":
                units_by_depth.append(self._argument_units(k) or [units_by_depth[-1][0]])
            elif token.text == ")" and len(units_by_depth) > 1:
                units_by_depth.pop()
            elif token.text == "," and len(units_by_depth[-1]) > 1:
                units_by_depth[-1] = units_by_depth[-1][1:]
            elif token is _END:
                units_by_depth = [[""]]
            unit_of_token[k] = units_by_depth[-1][0]
        counts = Counter(token.text for token in self.tokens)
        triples = zip(self.tokens, self.tokens[1:], self.tokens[2:], strict=False)
        for k, (left, sign, right) in enumerate(triples):
            if sign.text in _COMPARISON_SENSES or sign.text == "=":
                right_index = min(k + 3 if right.text == "-" else k + 2, len(unit_of_token) - 1)
                unit_of_token[right_index] = unit_of_token[right_index] or self.units.get(
                    left.text, ""
                )
                unit_of_token[k] = unit_of_token[k] or self.units.get(right.text, "")
                previous_token = self.tokens[k - 1] if k else _END
                is_assignment = sign.text == "=" and previous_token.text in ("|", ";", _END.text)
                is_stored = is_assignment and counts[left.text] == 1
                unit_of_token[right_index] = unit_of_token[right_index] or (
                    _STORED_UNIT if is_stored else ""
                )
        return unit_of_token

    def _argument_units(self, k: int) -> list[str]:
        """Return the units in the brackets that begin at a token."""
        word = self.tokens[k - 1] if k else _END
        if word.kind is not WORD:
            return []
        if word.text in self.names.parameters:
            return [self.units.get(name, "") for name in self.names.parameters[word.text]]
        if word.text not in WORDS or not WORDS[word.text].is_call:
            return [""]
        units = [argument.unit for argument in WORDS[word.text].arguments]
        argument_texts = texts(self.tokens[k : brackets_end(self.tokens, k) or k])
        extent_word = UNIT_OF.get(word.text, "")
        if extent_word in argument_texts:
            units[0] = EXTENTS[extent_word].unit
        return units

    def _units_of_names(self) -> dict[str, str]:
        """Return the units that variables have by their use; where they are two, with a `/`."""
        units_by_name: dict[str, dict[str, None]] = {}
        for token, unit in zip(self.tokens, self._units_at_tokens(), strict=True):
            if unit and token.text in self.names.variables:
                units_by_name.setdefault(token.text, {})[unit] = None
        return {name: "/".join(units) for name, units in units_by_name.items()}

    # -- branches --------------------------------------------------------------------------------

    def count_calls(self, name: str) -> int:
        """Return the number of calls of a DEF; its name after DEF or an end is no call."""
        count = 0
        for k, (previous_token, token) in enumerate(pairwise([_END, *self.tokens])):
            count += token.text == name and not (
                "DEF" in self._possible_words(previous_token) or self._is_label(k)
            )
        return count

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
                self._possible_words(token) & ASKING_WORDS for token in lexemes_before
            ):
                negations.append(token.source or token.text)
        return negations

    def count_sum_signs(self) -> Counter[str]:
        """Count the signs between two values, at least one of which is not a plain number."""
        sign_counts: Counter[str] = Counter()
        tokens_after = (*self.tokens[3:], _END)
        for left, sign, right, token_after in zip(
            self.tokens, self.tokens[1:], self.tokens[2:], tokens_after, strict=False
        ):
            is_first_value = left.text == ")" or self._has_value(left)
            is_other_value = self._has_value(token_after if right.text == "(" else right)
            is_plain = left.kind is NUMBER and right.kind is NUMBER
            if sign.text in ARITHMETIC_SIGNS and is_first_value and is_other_value and not is_plain:
                sign_counts[sign.text] += 1
        return sign_counts

    def _has_value(self, token: Lexeme) -> bool:
        """Return whether a token is a number, or a name with a value."""
        return (
            token.kind is NUMBER
            or token.text == "TIME"
            or token.text in self.names.known_names.values
        )

    def count_empty_branches(self) -> int:
        """Return the number of empty branches."""
        tokens_left = [
            token for token in self.tokens if token is not _END and token.text not in (";", "{")
        ]
        count = 0
        for k, token in enumerate(tokens_left):
            word = self._sure_word(token)
            if word in _HEADER_WORDS:
                end = (
                    brackets_end(tokens_left, k + 1)
                    if texts(tokens_left[k + 1 : k + 2]) == ("(",)
                    else k + 1
                )
                end += word == "DEF"
                if 0 < end < len(tokens_left):
                    is_branch_end = (
                        tokens_left[end].text in (*WORD_OF_END, "}")
                        or self._sure_word(tokens_left[end]) in _ARMS
                    )
                    count += is_branch_end
        return count

    def _count_arms_in_brackets(self) -> int:
        """Return the number of IFs with two branches in their brackets: `IF(question, F, B)`."""
        count = 0
        for k, token in enumerate(self.tokens[:-1]):
            end = brackets_end(self.tokens, k + 1) if self._next_token(k).text == "(" else 0
            if end and "IF" in self._possible_words(token):
                inner_pairs = pairwise(self.tokens[k + 2 : end - 1])
                first_tokens = [b for a, b in inner_pairs if a.text in (",", ";")]
                count += (
                    sum(
                        bool(self._possible_words(token) & _DRIVING_WORDS) for token in first_tokens
                    )
                    > 1
                )
        return count


@lru_cache(2)
def _statement_of_wrong(text: str, other_words: frozenset[str], kit: Kit) -> _Statement:
    text = apply_edits(text, note_edits(text))
    return _Statement(apply_edits(text, key_edits(text, kit)), other_words, kit, is_right=False)


@lru_cache(2)
def _statement_of_right(text: str, kit: Kit) -> _Statement:
    return _Statement(text, _words_of(text), kit, is_right=True)


def _words_of(text: str) -> frozenset[str]:
    return frozenset(name.upper() for name in _NAME.findall(text))


def _lost_amounts(statement: _Statement, repaired_statement: _Statement) -> Iterator[str]:
    """Yield the numbers that are lost, or have another sign or unit."""
    new_stock, old_stock = _Stock(repaired_statement.amounts), _Stock(statement.amounts)
    read_parts: list[float] = []  # the parts of the run that was read last, which is one number
    for value, parts in _digit_runs(statement.body_text):
        is_one_number = parts is not read_parts and new_stock.has([value]) and old_stock.has(parts)
        if is_one_number and not new_stock.has(parts):
            read_parts = parts
            new_stock.remove([value])
            old_stock.remove(parts)
    lost_amounts, new_amounts = old_stock.remaining(), new_stock.remaining()
    # First the matches in the same line, because another line's 50 is no 50 %.
    for is_same_line in (True, False):
        lost_amounts, new_amounts = _remove_matches(lost_amounts, new_amounts, is_same_line)
    yield from (amount.source_text for amount in lost_amounts)
    units = {unit for amount in repaired_statement.amounts for unit in amount.unit.split("/")}
    units |= {repaired_statement.units.get(token.text, "") for token in repaired_statement.tokens}
    repaired_units = Counter(repaired_statement.loose_units)
    yield from (
        loose_unit[1]
        for loose_unit in statement.loose_units
        if loose_unit[0] not in units and not repaired_units[loose_unit]
    )


class _Stock:
    """Amounts of a text, by how much they are without a sign; the first of each goes first."""

    def __init__(self, amounts: Sequence[Amount]) -> None:
        self.amounts = amounts
        self.indexes_of_value: dict[float, deque[int]] = {}
        for k, amount in enumerate(amounts):
            self.indexes_of_value.setdefault(abs(amount.value), deque()).append(k)

    def has(self, values: Sequence[float]) -> bool:
        """Return whether each of these values has its own occurrence, and there is at least one."""
        are_enough = (
            len(self.indexes_of_value.get(value, ())) >= count
            for value, count in Counter(values).items()
        )
        return bool(values) and all(are_enough)

    def remove(self, values: Sequence[float]) -> None:
        for value in values:
            self.indexes_of_value[value].popleft()

    def remaining(self) -> list[Amount]:
        return [
            self.amounts[k]
            for k in sorted(k for indexes in self.indexes_of_value.values() for k in indexes)
        ]


def _remove_matches(
    old_amounts: Sequence[Amount], new_amounts: Sequence[Amount], is_same_line: bool
) -> tuple[list[Amount], list[Amount]]:
    """Return the amounts of two texts without those that both have; `is_same_line`: in one line."""
    indexes_by_key: dict[tuple[int, int], dict[str, deque[int]]] = {}
    for k, amount in enumerate(new_amounts):
        key = _thousandths(amount.value), amount.line * is_same_line
        indexes_by_key.setdefault(key, {}).setdefault(amount.unit, deque()).append(k)
    unmatched_amounts: list[Amount] = []
    matched_positions: set[int] = set()
    for amount in old_amounts:
        scale = FULL_TURN if amount.unit == "turns" else 1
        keys = {
            (_thousandths(amount.value * factor), amount.line * is_same_line)
            for factor in (1, scale)
        }
        fitting_positions = [
            positions
            for key in keys
            for positions in indexes_by_key.get(key, {}).values()
            if positions and _are_same(amount, new_amounts[positions[0]])
        ]
        if fitting_positions:
            nearest = min(
                fitting_positions,
                key=lambda positions: (new_amounts[positions[0]].unit != amount.unit, positions[0]),
            )
            matched_positions.add(nearest.popleft())
        else:
            unmatched_amounts.append(amount)
    return unmatched_amounts, [
        amount for k, amount in enumerate(new_amounts) if k not in matched_positions
    ]


def _thousandths(value: float) -> int:
    return round(value * 1000)


def _are_same(old_amount: Amount, new_amount: Amount) -> bool:
    if (old_amount.unit, new_amount.unit) == ("turns", "°"):
        return _thousandths(old_amount.value * FULL_TURN) == _thousandths(new_amount.value)
    units = {*new_amount.unit.split("/")} - {""}
    is_unit = not old_amount.unit or units <= {*old_amount.unit.split("/")}
    is_unit |= units == {_STORED_UNIT} and old_amount.unit not in _WAY_UNITS
    return is_unit and _thousandths(old_amount.value) == _thousandths(new_amount.value)


def _digit_runs(text: str) -> Iterator[tuple[float, list[float]]]:
    """Yield the values of digits as one number, and as several: `2,5`, `8 0`, `8O`, `1:30`."""
    pieces = [*_DIGITS.finditer(text)]
    for start in range(len(pieces)):
        for end in range(start, min(start + _MAX_NUMBER_PARTS, len(pieces))):
            digit_matches = pieces[start : end + 1]
            gaps = [text[a.end() : b.start()] for a, b in pairwise(digit_matches)]
            if not all(_GROUP_SEPARATORS.fullmatch(gap) for gap in gaps):
                break
            digits = [match[0].translate(_DIGITS_OF_LETTERS) for match in digit_matches]
            sentence = text[digit_matches[0].start() : digit_matches[-1].end()]
            parts = [
                float(digits_text) for digits_text in re.findall(r"\d+(?:\.\d+)?|\.\d+", sentence)
            ]
            is_thousands = len(digits[-1]) == _GROUP_DIGITS
            is_decimal = not is_thousands and all("," in gap or "." in gap for gap in gaps)
            values = _possible_numbers(digits, is_decimal, ":" in sentence)
            yield from ((value, parts) for value in values)


def _possible_numbers(digits: Sequence[str], is_decimal: bool, is_time: bool) -> Iterator[float]:
    """Yield possible values of a number's parts, the likeliest first: `2,5` is hardly 25."""
    points = [f"{''.join(digits[:k])}.{''.join(digits[k:])}" for k in range(1, len(digits))]
    joined_text = "".join(digits)
    yield from map(float, (*points, joined_text) if is_decimal else (joined_text, *points))
    if is_time and len(digits) > 1:
        yield 60 * float(digits[0]) + float(digits[1])


def _lost_words(statement: _Statement, repaired_statement: _Statement) -> Iterator[str]:
    """Yield the words that are lost, and are not in a note."""
    noted_words = repaired_statement.note_words - statement.note_words
    is_turned = _count_senses(statement) != _count_senses(repaired_statement)
    for word, count in statement.sure_word_counts.items():
        missing_count = count - repaired_statement.sure_word_counts[word]
        replaced_count = max(
            (
                repaired_statement.sure_word_counts[replacement]
                - statement.sure_word_counts[replacement]
                for replacement in _SUBSTITUTES_OF_WORD.get(word, ())
            ),
            default=0,
        )
        replaced_count = max(
            replaced_count, min(noted_words[word], statement.foreign_word_counts[word])
        )
        if missing_count > replaced_count and not (word == "NOT" and is_turned):
            yield statement.source_of_word.get(word, word)


def _lost_questions(statement: _Statement, repaired_statement: _Statement) -> Iterator[str]:
    """Yield the lost or inverted comparisons, and branches that became empty."""
    lost_senses = _count_senses(statement) - (repaired_statement.note_words - statement.note_words)
    new_senses = _count_senses(repaired_statement)
    turner_counts = (
        {word: each_statement.sure_word_counts[word] for word in _QUESTION_TURNERS}
        for each_statement in (statement, repaired_statement)
    )
    negations = (statement.negations, repaired_statement.negations)
    may_turn = (
        bool(negations[0] or negations[1]) or len({str(turner) for turner in turner_counts}) > 1
    )
    if lost_senses.total() > new_senses.total() or (lost_senses - new_senses and not may_turn):
        yield from (lost_senses - new_senses) or lost_senses
    elif lost_senses == new_senses and len(negations[0]) > len(
        negations[1]
    ):  # nothing is inverted instead
        yield negations[0][0]
    if repaired_statement.count_empty_branches() > statement.count_empty_branches():
        yield "ELSE"


def _count_senses(statement: _Statement) -> Counter[str]:
    sense_counts: Counter[str] = Counter()
    open_brackets = [False]
    for left, sign, right in zip(
        statement.tokens, statement.tokens[1:], statement.tokens[2:], strict=False
    ):
        if sign.text == "(":
            open_brackets.append(left.text in CALL_WORDS)
        elif sign.text == ")":
            open_brackets = open_brackets[:-1] or [False]
        elif sign is _END:
            open_brackets = [False]
        is_comparison = left.kind in (WORD, NUMBER) or left.text == ")"
        is_comparison &= right.kind in (WORD, NUMBER) or right.text in ("(", "-", "+")
        if (
            sign.text in _COMPARISON_SENSES
            and is_comparison
            and not open_brackets[-1]
            and left.text not in CALL_WORDS
        ):
            sense_counts[_COMPARISON_SENSES[sign.text]] += 1
    return sense_counts
