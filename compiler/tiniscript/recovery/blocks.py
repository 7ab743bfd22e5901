"""Blocks: which end belongs to which header, over all lines of a program.

Names bare ends, puts words for braces, and closes what a line or its indentation closes. Knows the
items of each line, not how they were read.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from tiniscript.base.words import BLOCK_ENDS
from tiniscript.recovery.concepts import ENDED, Lexeme, made
from tiniscript.recovery.rewrites import negated
from tiniscript.syntax.outline import Item

ANY_END = "?"  # the word of an end that names no block: END, FIN
BRACES = ("{", "}")
LONGEST = 200  # items behind an ELSE whose ends are counted


class Line(NamedTuple):
    """A line whose items are known; `items` is None where it cannot be read.

    `is_rewritten`: by a row; `has_body`: by one that begins a body. `is_do`: it begins a block
    whose question comes at its end; `is_when`: it begins with a word for both IF and WHEN.
    """

    indent: int
    tokens: list[Lexeme]
    items: Sequence[Item] | None
    is_rewritten: bool
    has_body: bool
    is_do: bool
    is_when: bool


class Edit(NamedTuple):
    """From token `at` on, `old` tokens become `new`."""

    at: int
    old: int
    new: list[Lexeme]


class Matched(NamedTuple):
    """What each line needs so that all blocks end: edits, ends behind its text, and on new lines.

    `is_sure`: no end is a guess.
    """

    edits: dict[int, list[Edit]]
    tails: dict[int, list[str]]
    behind: dict[int, list[str]]
    is_sure: bool


_UNREAD = [Item("do", "", 0, 0)]  # what a line that cannot be read is taken for


class _Block:
    def __init__(self, item: Item, k: int, line: Line) -> None:
        is_header = item.kind == "open"
        self.word = item.word if is_header else ""  # nothing for braces that belong to no header
        self.line = k
        self.indent = line.indent
        self.body: int | None = None  # its lines' indentation, -1 where that is not deeper
        self.has_brace = not self.word
        self.is_begun = is_header and line.has_body  # a row says that its body begins
        self.is_do = is_header and line.is_do
        self.is_translated = line.tokens[item.start].source is None
        self.name = line.tokens[item.start + 1].text if self.word == "DEF" else ""
        head = [each.text for each in line.tokens[item.start + 1 : item.end]]
        self.is_endless = head in (["(", "FOREVER", ")"], ["(", "TRUE", ")"])
        self.last: int | None = None  # its last line that is ever done

    @property
    def end(self) -> str:
        return BLOCK_ENDS[self.word]

    @property
    def has_indented_body(self) -> bool:
        return self.body is not None and self.body >= 0


def matched(lines: Sequence[Line]) -> Matched | None:
    """Return what is missing for all blocks to end, or None where no reading fits."""
    return _Matching(lines).run()


class _Matching:
    def __init__(self, lines: Sequence[Line]) -> None:
        self.lines = lines
        self.flat = [
            (k, item)
            for k, line in enumerate(lines)
            for item in (_UNREAD if line.items is None else line.items)
        ]
        self.has_unread = any(line.items is None for line in lines)
        self.open: list[_Block] = []
        self.edits: dict[int, list[Edit]] = {}
        self.tails: dict[int, list[str]] = {}
        self.behind: dict[int, list[str]] = {}
        self.is_sure = True

    def run(self) -> Matched | None:
        last = -1
        for place, (k, item) in enumerate(self.flat):
            if k != last:
                self.begin_line(place, k, item, last)
                last = k
            if not self.read(place, k, item):
                return None
            if place + 1 == len(self.flat) or self.flat[place + 1][0] != k:
                self.end_line(place, k, item)
        while self.open:
            block = self.open.pop()
            if not block.word or item.kind in ("open", "{"):
                return None  # nothing is in it
            if block.has_brace and block.line == last:
                self.tails.setdefault(last, []).append(block.end)
                continue
            self.is_sure = self.is_sure and block.has_indented_body and block.is_begun
            self.close_behind(last if block.last is None else block.last, block)
        return Matched(self.edits, self.tails, self.behind, self.is_sure)

    def edit(self, k: int, item: Item, old: int, *new: str) -> None:
        self.edits.setdefault(k, []).append(Edit(item.start, old, [made(each) for each in new]))

    def close_behind(self, k: int, block: _Block) -> None:
        self.behind.setdefault(k, []).append(" " * block.indent + block.end)

    def after(self, place: int) -> Item | None:
        return self.flat[place + 1][1] if place + 1 < len(self.flat) else None

    # -- the beginning of a line: its indentation may close what is open -----------------------

    def begin_line(self, place: int, k: int, item: Item, last: int) -> None:
        indent = self.lines[k].indent
        while self.open and item.kind in ("open", "do"):
            block = self.open[-1]
            is_left = block.body is not None and indent < block.body and indent <= block.indent
            if not is_left or block.has_brace:
                break
            self.open.pop()
            self.is_sure = self.is_sure and block.is_begun
            self.close_behind(last, block)
        for block in self.open:
            if block.body is None and block.line < k:
                block.body = indent if indent > block.indent else -1

    # -- items --------------------------------------------------------------------------------

    def read(self, place: int, k: int, item: Item) -> bool:
        """Take an item; return whether it has a place among the blocks."""
        if item.kind == "open":
            if not self.is_end_of_do(place, k, item):
                if self.is_when(place, k, item):
                    self.edit(k, item, 1, "WHEN")
                    item = item._replace(word="WHEN")
                self.open.append(_Block(item, k, self.lines[k]))
            return True
        if item.kind == "{":
            return self.brace(k, item)
        if item.kind == "}":
            return self.closing_brace(place, k, item)
        if item.kind == "arm":
            return bool(self.open) and self.open[-1].word == "IF"
        if item.kind == "end" and self.is_before_arm(place, item):
            start = item.start - (
                self.lines[k].tokens[item.start - 1].text == ";" and item.start > 0
            )
            self.edit(k, item._replace(start=start), item.start + 1 - start)
            return True
        if item.kind == "end":
            return self.bare_end(place, k, item) if item.word == ANY_END else self.end(k, item)
        return True

    def is_when(self, place: int, k: int, item: Item) -> bool:
        """Whether an IF is meant as a WHEN: at the top level, with lines and an end of its own."""
        if self.open or not self.lines[k].is_when or item.word != "IF":
            return False
        line, part = next(self.parts(place), (k, item))
        ended = ENDED.get(part.word)
        return part.kind == "end" and (ended == "WHEN" or (line != k and ended != "IF"))

    def is_end_of_do(self, place: int, k: int, item: Item) -> bool:
        """Whether a WHILE ends the block that a DO has begun: then it leaves that."""
        if item.word != "WHILE" or not self.open or not self.open[-1].is_do:
            return False
        question = self.lines[k].tokens[item.start + 2 : item.end - 1]
        new = [made("IF"), made("("), *negated(question), made(")")]
        new += map(made, (";", "BREAK", ";", BLOCK_ENDS["IF"], ";", BLOCK_ENDS["LOOP"]))
        self.edits.setdefault(k, []).append(Edit(item.start, item.end - item.start, new))
        self.open.pop()
        return True

    def brace(self, k: int, item: Item) -> bool:
        if not self.open:
            is_first = item.start == 0 or self.lines[k].tokens[0].text == "START"
            self.is_sure = self.is_sure and is_first
            self.edit(k, item, 1)
            self.open.append(_Block(item, k, self.lines[k]))
            return True
        if self.open[-1].has_brace:
            return False
        self.open[-1].has_brace = True
        self.edit(k, item, 1, ";")
        return True

    def closing_brace(self, place: int, k: int, item: Item) -> bool:
        if not self.open:
            return False
        block, after = self.open[-1], self.after(place)
        goes_on = after is not None and (
            (block.word == "IF" and after.kind == "arm")
            or (block.word and after.kind == "end" and after.word == block.end)
        )
        if goes_on or (block.is_do and after and after.word == "WHILE"):
            self.edit(k, item, 1, ";")
            block.has_brace = block.has_brace and not goes_on
            return True
        if not block.has_brace:
            return False
        self.open.pop()
        self.edit(k, item, 1, *((";", block.end, ";") if block.word else ()))
        return True

    def is_before_arm(self, place: int, item: Item) -> bool:
        """Whether an end comes too early: the ELSE behind it belongs to its IF."""
        after = self.after(place)
        is_its = item.word == ANY_END or ENDED[item.word] == "IF"
        if not (
            is_its and after and after.kind == "arm" and self.open and self.open[-1].word == "IF"
        ):
            return False
        outer = sum(block.word == "IF" for block in self.open[:-1])
        rest = [it for _, it in self.flat[place + 1 : place + LONGEST]]
        ends = sum(it.kind == "end" and it.word in (ANY_END, "ENDIF", "END_IF") for it in rest)
        return ends - sum(it.kind == "open" and it.word == "IF" for it in rest) > outer

    def bare_end(self, place: int, k: int, item: Item) -> bool:
        """`FIN` ends the innermost block; one too many is dropped."""
        after = self.after(place)
        if not self.open:
            if self.has_unread:
                return False
            before = self.lines[k].tokens[item.start - 1]
            is_behind = after is None and before.text == ";" and before.source is not None
            is_alone = len(self.lines[k].items or ()) == 1 or is_behind
            self.is_sure = self.is_sure and is_alone and len(self.flat) > 1
            self.edit(k, item, 1)
        elif self.open[-1].word:
            self.edit(k, item, 1, self.open.pop().end)
        else:
            return False
        return True

    def end(self, k: int, item: Item) -> bool:
        want, line = ENDED[item.word], self.lines[k]
        if self.open and self.open[-1].word not in ("", want):
            words = [block.word for block in self.open]
            block = self.open[-1]
            is_inside = (len(words) > 1 and block.line == k) or block.has_indented_body
            if want not in words:
                self.edit(k, item, 1, self.open.pop().end)
                self.is_sure = self.is_sure and (line.is_rewritten or block.is_translated)
                return True
            if is_inside:
                self.open.pop()
                self.is_sure = self.is_sure and (block.is_begun or block.line == k)
                self.edit(k, item, 0, block.end, ";")
        if self.open and self.open[-1].word == want:
            block = self.open.pop()
            self.is_sure = self.is_sure and not block.has_brace and line.is_do <= block.is_do
            if block.is_endless and self.open and self.open[-1].last is None:
                outer = self.open[-1]  # a WHEN that never ends looks no more
                is_before = outer.word == "WHEN" and outer.line + 1 < block.line
                outer.last = block.line - 1 if is_before else k
            return True
        return False

    # -- the end of a line: a body behind its header ends there, unless an end is left for it ----

    def end_line(self, place: int, k: int, item: Item) -> None:
        while self.open and self.open[-1].line == k and item.kind != "open":
            block = self.open[-1]
            if block.has_brace or not block.word or self.goes_on_below(place, block):
                break
            parts, after = self.parts(place), self.after(place)
            is_closed = any(each.kind != "arm" or block.word == "IF" for _, each in parts)
            has_outer = len(self.open) > 1
            is_arm = block.word == "IF" and after is not None and after.kind == "arm"
            if is_closed and (not has_outer or is_arm):
                break
            self.open.pop()
            items = self.lines[k].items or []
            is_sure = block.is_begun
            if block.word in ("IF", "WHILE") and not any(each.kind == "arm" for each in items):
                is_sure = is_sure and not self.is_parted(k, items)
            elif block.word == "DEF" and after is not None and after.kind == "do":
                is_sure = is_sure and after.word == block.name
            self.is_sure = self.is_sure and is_sure
            self.tails.setdefault(k, []).append(block.end)

    def goes_on_below(self, place: int, block: _Block) -> bool:
        below = self.flat[place + 1][0] if place + 1 < len(self.flat) else block.line
        return self.lines[below].indent > block.indent

    def is_parted(self, k: int, items: Sequence[Item]) -> bool:
        """Whether a block may end before its line: at a `;` of the text, or at another block."""
        told = [each for each in items if each.kind == "do"]
        between = self.lines[k].tokens[told[0].end : told[-1].start] if told else []
        headers = sum(each.kind == "open" and each.word == "IF" for each in items)
        return headers > 1 or any(each.text == ";" and each.source is not None for each in between)

    def parts(self, place: int) -> Iterator[tuple[int, Item]]:
        """Give the arms and ends behind a place, but those of blocks that begin behind it."""
        depth = 0
        for line, item in self.flat[place + 1 :]:
            is_end = item.kind in ("end", "}")
            if not depth and (is_end or item.kind == "arm"):
                yield line, item
            depth += (item.kind == "open") - (is_end and depth > 0)
