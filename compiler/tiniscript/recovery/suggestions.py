"""Suggestions: what is told of words that no repair reads surely.

Reads each instruction of a line with the words behind it, and words without one, by the rows of
`suggestion_rows`; `holding` finds them, for `usage`, too. Knows no row and no sentence of any
language.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cache
from itertools import islice
from typing import NamedTuple, Protocol

from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Span, edits_overlap
from tiniscript.base.spelling import nearest
from tiniscript.base.words import BLOCK_ENDS, OPPOSITE_MOVES, UNIT_OF, WORDS
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import CODES, Code, Diagnostic
from tiniscript.recovery import lines, rewrites, suggestion_rows
from tiniscript.recovery.meanings import (
    ASKING_WORDS,
    NEAR,
    WORD_OF_END,
    Lexeme,
    Names,
    lexemes,
    lexicon_meaning,
    made,
    plain,
)
from tiniscript.recovery.orders import Order, condition_in, made_up, orders, written
from tiniscript.recovery.slots import filled
from tiniscript.recovery.trailing_tokens import (
    LineContext,
    Trailing,
    instruction_length,
    set_in,
    width,
)
from tiniscript.recovery.worded import sensors_of, worded
from tiniscript.recovery.writing import laid_out, shortened, without_note
from tiniscript.syntax.free_names import free_number_name
from tiniscript.syntax.lexer import QUOTES, WORD
from tiniscript.syntax.operators import COMPARISONS

MOST_WORDS = 24  # words behind an instruction that are read
MOST_INSTRUCTIONS = 1_000  # instructions of a text that are read
# Codes of words that a repair may read better.
_SECONDARY_CODES = (codes.REPEATED, codes.WORDS_AFTER)
_NOTE_CODES = (codes.WORDS_AFTER, codes.SEVERAL_ORDERS)
_UNIT_MEANINGS = (("s",), ("cm",), ("°",), ("%",), ("Hz",))
_PROSE_SIGNS = frozenset((",", ".", ":", "!", "\u00a1", *QUOTES))
_MOST_REPEATED = 8  # instructions that an example repeats
_MOST_LINES_BACK = 40  # lines and instructions that are looked at for what is done again
_BODY_STARTS = (*BLOCK_ENDS, "ELSE", "ELSEIF")
# An instruction of a line, and the bar of a `SI|`.
_INSTRUCTION_AND_BAR = re.compile(r"((?:[^;{}|]|\|\|)+)(\|?)")
_REPEATED_ORDERS = re.compile(r"(.+?;)\1*")  # orders that the others repeat
_CHOICE_CALL = re.compile(r"\s*(\w+)\s*(\([0-9., ]*\))?\s*")
_LINE_COUNT = re.compile(r"^\s*\d{1,2}\s*[.)]\s*(?=[A-Za-z])")
_SHORTEST_WORD = 3  # letters: X is rather a variable
_NEEDLESS_SIGNS = ".:,\\* \"'`´“”‘’«»"  # signs that a note needs not


class Row(NamedTuple):
    """A row: its code is None where it is told with that which was found, and `conditions` says
    where."""

    pattern: rewrites.Pattern
    code: Code | None
    conditions: Sequence[str]
    values: dict[str, str]
    example: tuple[str, str]


class Place(Protocol):
    """What rows speak of: what comes first, and the tokens of the `row` behind it."""

    text: str
    names: Names

    @property
    def row(self) -> Sequence[Lexeme]: ...

    @property
    def spans(self) -> Sequence[Span]: ...

    @property
    def gaps(self) -> Mapping[str, Callable[[Gaps], str]]: ...

    def labels(self) -> list[str]: ...

    def values(self) -> dict[str, str]: ...

    def several(self, name: str, gaps: Gaps) -> Mapping[str, str]: ...


class Suggestion(NamedTuple):
    """What is told, and the words that are passed over so that the rest can be read."""

    diagnostic: Diagnostic
    blanking_edit: Edit


@cache
def rows() -> tuple[Row, ...]:
    compiled_rows = []
    for pattern, code, values, example in rewrites.cells(suggestion_rows.SUGGESTIONS):
        named_values = dict(item.split("=", 1) for item in values.split("; ") if item)
        wrong, _, right = example.replace("⏎", "\n").rpartition(" => ")
        compiled = rewrites.compiled(pattern, suggestion_rows.PARTS)
        number, *how = code.split()
        compiled_rows.append(Row(compiled, CODES.get(number), how, named_values, (wrong, right)))
    return tuple(compiled_rows)


@cache
def _places() -> rewrites.RowIndex:
    return rewrites.places({k: row.pattern for k, row in enumerate(rows())})


def suggested(text: str, kit: Kit) -> list[Suggestion]:
    """Return what is told of words behind each instruction of a text, or in place of one."""
    bodies = [without_note(line)[0] for line in text.split("\n")]
    names = Names([lexemes(body) for body in bodies], kit)
    suggestions: list[Suggestion] = []
    orders_above: list[str | None] = []
    start = depth = 0
    instructions_left = MOST_INSTRUCTIONS
    for body, line in zip(bodies, text.split("\n"), strict=True):
        suggestions_of_line: list[Suggestion] = []
        words = lexemes(body)
        is_right = lines.is_right(words, names)
        if "~" not in body and not is_right:
            for part in islice(
                _parts(body, start, LineContext(text, names, depth, orders_above)),
                instructions_left,
            ):
                instructions_left -= 1
                each = _suggestion_for(part)
                if each and not (
                    suggestions_of_line
                    and edits_overlap([suggestions_of_line[-1].blanking_edit], [each.blanking_edit])
                ):
                    suggestions_of_line.append(each)
        suggestions += suggestions_of_line
        if body.strip() and not any(
            each.diagnostic.code is codes.SAME_AGAIN for each in suggestions_of_line
        ):
            uncounted = _LINE_COUNT.sub("", body)  # `2. S`
            is_right = is_right or (uncounted != body and lines.is_right(lexemes(uncounted), names))
            orders_above.append(_as_orders(uncounted.partition("|")[2] or uncounted, is_right))
        depth += sum((word.text in BLOCK_ENDS) - (word.text in WORD_OF_END) for word in words)
        start += len(line) + 1
    return suggestions


def _as_orders(line: str, is_right: bool) -> str | None:
    """Return a line of orders, "" for another one, None for one that begins a block."""
    heads = [item[0].text for item in map(lexemes, line.split(";")) if item]
    if heads and heads[-1] in _BODY_STARTS:
        return None
    is_right = is_right and not {*heads} & {*_BODY_STARTS, *WORD_OF_END}
    return line.strip().rstrip(" ;") if is_right else ""


def _parts(body: str, start: int, line_context: LineContext) -> Iterator[_Words]:
    """Give each instruction of a line that has words behind it, and words without one."""
    names = line_context.names
    before: list[str | None] = []
    for match in _INSTRUCTION_AND_BAR.finditer(body):
        tokens, at = lexemes(match[1]), start + match.start()
        if not tokens or match[2]:
            continue
        is_block = tokens[0].text in (*_BODY_STARTS, *WORD_OF_END)
        while 0 < len(tokens) <= lines.MOST_TOKENS:
            size = instruction_length(tokens, names)
            rest = tokens[size:]
            if not size and (spoken_call := _spoken_call(tokens, names)):
                yield _Words(line_context, at, tokens, spoken_call[0], before, spoken_call[1])
                break
            if not size or not rest:
                yield _Words(line_context, at, tokens, 0, before)
                break
            if any(token.text in ASKING_WORDS for token in tokens[:size]):
                has_only_then = all(lexicon_meaning(item.text, "do") for item in rest)  # by a THEN
                yield _Words(
                    line_context, at, tokens if has_only_then else tokens[:size], 0, before
                )
            if not instruction_length(rest, names) or rest[0].text in ("IF", "WHILE"):
                yield _Words(line_context, at, tokens, size, before)
                break
            at += sum(map(width, tokens[:size]))
            tokens = rest
        before = [*before, None if is_block else match[1].strip()]


def holding(place: Place) -> Iterator[tuple[Row, Gaps]]:
    """Give the rows that hold at a place, with what fills their gaps, in the order of the table."""
    line = rewrites.Encoded([made(";"), *place.row], place.names, place.labels())
    for k in line.candidate_rows(_places()):
        row = rows()[k]
        if match := next(line.matches(row.pattern), None):
            gaps = Gaps(place, line, match)
            with suppress(NoGap):
                gaps.fill(row)
                yield row, gaps


def _suggestion_for(part: _Words) -> Suggestion | None:
    if len(part.row) > MOST_WORDS or not part.is_aside():
        return None
    for row, gaps in holding(part):
        is_aside = row.code in _SECONDARY_CODES and part.tokens and _is_read_surely(part)
        return None if is_aside else _suggestion(row, gaps)
    return None


def _is_read_surely(part: Trailing) -> bool:
    """Whether a repair of the whole instruction can mean nothing else."""
    if part.own == "DEF":
        return False  # it may be called by its first word
    result = lines.read([*part.tokens, *part.row], part.names, is_quick=True)
    return bool(result) and result[0].is_sure and len(result[0].items or ()) == 1


class _Words(Trailing):
    """Words behind an instruction, or without one, as a place of rows."""

    def __init__(
        self, line_context: LineContext, start: int, tokens: Sequence[Lexeme], size: int,
        before: Sequence[str | None], spoken: str = "",
    ) -> None:  # fmt: skip
        super().__init__(line_context, start, tokens, size, before, spoken)
        self.gaps = _GAP_FUNCTIONS

    def values(self) -> dict[str, str]:
        return {"before": shortened(self.call), "words": shortened(self.words), "fix": ""}

    def several(self, name: str, gaps: Gaps) -> Mapping[str, str]:
        return _worded_condition(gaps)


def _suggestion(row: Row, gaps: Gaps) -> Suggestion:
    part, group_names, values = gaps.part, row.pattern.of_labels.groupindex, gaps.filled
    place = part.place if values["fix"] else None
    is_right = lines.is_right(part.tokens, part.names)
    if place and not is_right and values["fix"].startswith(part.call):
        place = part.behind  # of a call with a mistake of its own
        values["fix"] = values["fix"][len(part.call) :].lstrip(" ")
    start, end = gaps.span("s") if "s" in group_names else (1, len(part.spans))
    span = Span(part.spans[start].start, part.spans[end - 1].end)
    code = row.code
    assert code is not None
    has_other_values = any(values[gap] for gap in values if gap not in ("before", "words", "order"))
    is_noted = "//" in values["fix"] or not has_other_values
    if code in _NOTE_CODES and part.tokens and not is_noted:
        values = {**values, **_as_note(part)}  # what changes no movement comes first
    if code is codes.OTHER_LANGUAGE and values["found"].upper() == values["right"]:
        code, values = codes.MISSING_OPEN, {**values, "word": values["right"], "words": ""}
    result = Diagnostic(code, span, values, place)
    if "h" in group_names:
        place = Span(part.spans[gaps.span("h")[0]].start, part.behind.end)
        condition = values.get("asked") or values.get("question") or "TRUE"
        return Suggestion(result, Edit(place, f"{gaps['head']}({condition})"))
    if part.is_said:
        return Suggestion(result, Edit(part.place, values["fix"] or part.call))
    fix = "" if part.tokens else values["fix"]
    return Suggestion(result, Edit(part.behind, fix or " " * (part.behind.end - part.behind.start)))


def _spoken_call(tokens: Sequence[Lexeme], names: Names) -> tuple[int, str] | None:
    """Return the call that words before a condition say, and how many they are."""
    meant = [names.meant(token.text, NEAR) for token in tokens]
    asks = next((k for k in range(1, len(tokens)) if meant[k] in ("IF", "WHILE")), 0)
    has_until = meant[asks] == "WHILE"
    call = filled(tokens[:asks], names, has_until, is_order=True) if asks else None
    return (asks, laid_out(call.tokens)) if call and not call.times else None


class NoGap(Exception):
    """A gap of a row cannot be filled."""


class Gaps(dict[str, str]):
    """Fills the gaps of a row: captures, and the functions of its place.

    `filled` are the values so far: a gap may speak of those before it.
    """

    def __init__(self, place: Place, line: rewrites.Encoded, match: re.Match[str]) -> None:
        self.place = place
        self.filled: dict[str, str] = {}
        self._line = line
        self._match = match

    @property
    def part(self) -> Trailing:
        assert isinstance(self.place, Trailing)
        return self.place

    def fill(self, row: Row) -> None:
        self.filled = self.place.values()
        for name, template in row.values.items():
            if name == "*":
                self.filled |= self.place.several(template, self)
            else:
                self.filled[name] = template.format_map(self)
        self.filled.pop("?", None)

    def __missing__(self, name: str) -> str:
        gap = name.rstrip("?")
        result = self.place.gaps[gap](self) if gap in self.place.gaps else self.captured(gap)
        if not result and gap == name:
            raise NoGap
        return result

    def span(self, name: str) -> tuple[int, int]:
        """Return where a capture stands: from which token on, and before which."""
        return self._line.span(self._match, name)

    def tokens(self, name: str) -> Sequence[Lexeme]:
        start, end = self.span(name)
        return self.part.row[start - 1 : end - 1]

    def from_on(self, name: str) -> Sequence[Lexeme]:
        """Return the words from a capture on."""
        return self.part.row[self.span(name)[0] - 1 :]

    def meant(self, name: str) -> str:
        """Return the word of the language that a capture begins with."""
        return self.part.means(self.from_on(name)[0].text)

    def captured(self, name: str) -> str:
        start, end = self.span(name)
        if start == end:
            return ""
        if start == 0:
            return self.part.call
        if name == "n":
            return self.number(start - 1)
        spans = self.part.spans
        return self.part.text[spans[start].start : spans[end - 1].end]

    def number(self, k: int) -> str:
        """Return the number at a place in the unit of an instruction: `0.5` for `500 ms`."""
        number = self.part.number(k) or ""
        text = (
            lexicon_meaning(self.part.row[k + 1].text, "unit") if k + 1 < len(self.part.row) else ()
        )
        if text[:1] == ("s",) and text[1] != "1000":
            return f"{float(number) * int(text[1]) / 1000:g}"
        return number


def _loop_over_all(gaps: Gaps, times: str) -> str:
    """The loop that does so often all that stands before, nothing where that is long."""
    part, before = gaps.part, [item for item in gaps.part.before if item]
    has_all_orders = len(before) == len(part.before) <= _MOST_LINES_BACK
    if not has_all_orders or part.is_in_block or times in ("", "0", "1"):
        return ""
    messages = [item.strip() for line in (*before, part.call) for item in line.split(";")]
    orders = [item for item in messages if item.upper() not in ("", "START")]
    text = "".join(f"{order};" for order in orders)
    if once := _REPEATED_ORDERS.fullmatch("".join(text.split()).upper()):  # F and L of `F; L; F; L`
        orders = orders[: once[1].count(";")]
    if not 0 < len(orders) <= _MOST_REPEATED:
        return ""
    return ";".join((f"LOOP({times})", *orders, BLOCK_ENDS["LOOP"]))


def _worded_condition(gaps: Gaps) -> dict[str, str]:
    """What the words of a condition ask."""
    row, names = gaps.tokens("s"), gaps.part.names
    is_bare = [item.text for item in gaps.from_on("s")[len(row) :][:1]] != [")"]
    is_for_instruction = is_bare and gaps["head"] == "UNTIL" and not gaps.part.tokens
    is_for_instruction |= is_bare and any("|@start|" in names.label(item) for item in row)
    has_other_reader = is_for_instruction or bool(_condition_tokens(gaps, "s"))
    result = None if has_other_reader else worded(row, names)
    if result is None:
        raise NoGap
    return result


def _sensor(gaps: Gaps, k: int) -> str:
    """One of the sensors that a word may mean."""
    return "".join(sensors_of(plain(gaps["l"]), gaps.part.names)[k : k + 1])


def _measured(gaps: Gaps) -> str:
    """What words ask with a number of their own: `la pared a 30 cm`."""
    words = gaps.tokens("l")
    is_said = any(
        word.kind is WORD and not lexicon_meaning(word.text, "unit", "in") for word in words
    )
    return (worded(words, gaps.part.names) or {}).get("asked", "") if is_said else ""


def _reading(gaps: Gaps) -> str:
    """The sensor on the side of an L or R, which is no name."""
    word, part = gaps["s"].upper(), gaps.part
    return "" if word in set_in(part.text) else part.names.on_side(word)


def _lone_condition(gaps: Gaps) -> str:
    """A condition that stands alone, and sets nothing."""
    signs = {token.text for token in gaps.tokens("s")}
    return laid_out(_condition_tokens(gaps, "s")) if signs & {*COMPARISONS} - {"="} else ""


def _consequence(gaps: Gaps) -> str:
    """What is done: the words from a capture on where they are right, else the orders they say."""
    words, names = gaps.from_on("w"), gaps.part.names
    return (
        _rest_of_words(gaps, "w") if lines.is_right(words, names) else written(orders(words, names))
    )


def _free_name(gaps: Gaps) -> str:
    """A name that may get the value before it, which is no other name."""
    names, name = gaps.part.names, plain(gaps["x"])
    is_name = all(token.kind is WORD for token in gaps.tokens("v"))
    is_taken = name in names.sensors or name in names.defs or name in names.actuators
    return "" if is_name or is_taken else name


def _choice(gaps: Gaps, is_exact: bool = False) -> str:
    """An IF that asks RANDOM which of two orders or more is done; `is_exact`: by no example."""
    text = f"{gaps.part.call},{gaps['l']}".lstrip(",")
    orders = []
    for match in map(_CHOICE_CALL.fullmatch, re.split(r",(?![^(]*\))", text)):
        word_row = WORDS.get(gaps.part.means(plain(match[1]))) if match else None
        if match is None or word_row is None or not word_row.role.is_instruction:
            return ""
        if is_exact and word_row.arguments and not match[2]:
            return ""
        orders.append(word_row.text + match[2] if match[2] else word_row.example)
    name, count = free_number_name(gaps.part.text), len(orders)
    drawn, conditions = f"{name} = RANDOM(1, {count}); ", [f"{name} = {k}" for k in range(1, count)]
    if count == 2:
        drawn, conditions = "", ["RANDOM(1, 2) = 1"]
    arms = [f"ELSEIF({one}); {order}; " for one, order in zip(conditions, orders, strict=False)]
    return f"{drawn}{''.join(arms)[4:]}ELSE; {orders[-1]}; ENDIF" if arms else ""


def _loop(gaps: Gaps) -> str:
    number = gaps["n"]
    is_often = number.isdecimal() and number not in ("0", "1")
    return f"LOOP({number});{gaps.part.call};{BLOCK_ENDS['LOOP']}" if is_often else ""


def _with_value(gaps: Gaps, value: re.Match[str] | None, new: str) -> str:
    """The call with another value, of which the old one is a part; nothing where it is the same."""
    new = value.expand(new) if value else ""
    if value is None or value[1] == new:
        return ""
    return f"{gaps.part.call[: value.start(1)]}{new}{gaps.part.call[value.end(1) :]}"


def _with_power(gaps: Gaps) -> str:
    """The call with another power."""
    number = gaps["n"]
    return _with_value(gaps, gaps.part.power, number) if 9 < float(number) <= 100 else ""


def _condition_tokens(gaps: Gaps, name: str = "q") -> list[Lexeme]:
    """The condition that words ask, in words of the language; nothing where they ask none."""
    return [] if gaps.part.is_asked else condition_in(gaps.tokens(name), gaps.part.names)


def _shown_word(gaps: Gaps) -> str:
    """A word to show, which is no letter and like no name of the program."""
    word = gaps["s"]
    names = gaps.part.names
    is_name = len(word) < _SHORTEST_WORD or nearest(plain(word), names.known.values)
    return "" if is_name or plain(word) in names.in_brackets else word


def _rest_of_words(gaps: Gaps, name: str) -> str:
    """The words from a capture on."""
    start, end = gaps.span(name)
    return gaps.part.text[gaps.part.spans[start].start : gaps.part.place.end] if start < end else ""


def _calls(part: Trailing) -> list[Order]:
    """The orders that the words say, nothing where a turn of them says no way."""
    result = orders(part.row, part.names)
    return [] if any(item.is_side_free or item.is_repeated for item in result) else result


def _orders(gaps: Gaps) -> str:
    """The instruction, and those that the words behind it say."""
    result = _calls(gaps.part)
    return f"{gaps.part.call};{written(result)}" if result else ""


def _note(gaps: Gaps) -> str:
    part = gaps.part
    return f"{part.call} // {part.words.strip(_NEEDLESS_SIGNS)}" if _is_last(part) else ""


def _is_last(part: Trailing) -> bool:
    """Whether nothing but a note follows the words on their line."""
    after = part.text[part.place.end :].split("\n")[0].lstrip(" \t;\r")
    return not after or after.startswith("//")


def _as_note(part: Trailing) -> dict[str, str]:
    """Return how words behind a whole instruction are written as a note, where they may be one.

    What has a number or a sign of a program, or is joined to the instruction, says more of it.
    """
    is_joined = lexicon_meaning(part.row[0].text, "then", "and", "or") or part.row[0].text in (
        "AND",
        "OR",
    )
    is_prose = all(it.kind is WORD or it.text in _PROSE_SIGNS for it in part.row)
    words = part.words.strip(_NEEDLESS_SIGNS)
    if is_joined or not is_prose or not words or not lines.is_right(part.tokens, part.names):
        return {}
    is_instruction = any(it.text in WORDS and it.source == it.text for it in part.row)
    is_instruction |= any(lexicon_meaning(it.text, "unit")[:1] in _UNIT_MEANINGS for it in part.row)
    if is_instruction:
        return {}
    note = f"// {words}"
    return {"note": f"{part.call} {note}"} if _is_last(part) else {"last_note": note}


_GAP_FUNCTIONS: dict[str, Callable[[Gaps], str]] = {
    "above": lambda gaps: ["", *gaps.part.before][-1] or "",
    "all": lambda gaps: _loop_over_all(gaps, gaps["n?"]),
    "often": lambda gaps: _loop_over_all(gaps, "4"),
    "endless": lambda gaps: _loop_over_all(gaps, "FOREVER"),
    "more": lambda gaps: _loop_over_all(gaps, str(int(gaps["n"]) + 1)),
    "said": lambda gaps: gaps.part.words.strip(" ,:"),
    "head": lambda gaps: gaps.meant("h"), "called": lambda gaps: gaps.meant("w"),
    "block": lambda gaps: gaps.meant("g"), "usage": lambda gaps: WORDS[gaps.meant("w")].usage,
    "choice": lambda gaps: _choice(gaps, is_exact=True).replace("; ", ";"),
    "choices": _choice, "number": lambda gaps: free_number_name(gaps.part.text),
    "example": lambda gaps: WORDS[plain(gaps["w"])].example,
    "reading": _reading,
    "next": lambda gaps: WORDS[plain(gaps["s"])].example,
    "one": lambda gaps: _sensor(gaps, 0), "two": lambda gaps: _sensor(gaps, 1),
    "measured": _measured, "alone": _lone_condition, "then": _consequence, "free": _free_name,
    "loop": _loop,
    "by_way": lambda gaps: _with_value(gaps, gaps.part.time, rf"\1 {UNIT_OF[gaps.part.own]}"),
    "text": lambda gaps: shortened(gaps.part.text[slice(*gaps.part.place)]),
    "words": lambda gaps: shortened(gaps.part.words),
    "end": lambda gaps: "" if _condition_tokens(gaps, "s") else BLOCK_ENDS[gaps.meant("g")],
    "shown": _shown_word, "note": _note,
    "other": lambda gaps: re.sub(r"^\w+", OPPOSITE_MOVES[gaps.part.own], gaps.part.call),
    "once": lambda gaps: gaps.part.call if gaps["n"] == "1" else "",
    "longer": lambda gaps: _with_value(gaps, gaps.part.time, gaps["n"]), "paced": _with_power,
    "question": lambda gaps: laid_out(_condition_tokens(gaps)),
    "contrary": lambda gaps:
        laid_out(rewrites.negated(it)) if (it := _condition_tokens(gaps)) else "",
    "made_up": lambda gaps: made_up(_calls(gaps.part)),
    "until": lambda gaps: f" {_rest_of_words(gaps, 't')}".rstrip(),
    "behind": lambda gaps: _rest_of_words(gaps, "w"), "orders": _orders,
    "sensors": lambda gaps: ", ".join(gaps.part.names.measuring),
    "distance": lambda gaps: "DISTANCE" if "DISTANCE" in gaps.part.names.sensors else "",
}  # fmt: skip
