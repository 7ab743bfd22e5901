"""Blocks: which end belongs to which header, over all lines of a program.

Names bare ends, puts words for braces, and closes what a line or its indentation closes. Takes each
line as it is read.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from tiniscript.base.kit import REMOTE
from tiniscript.base.words import BLOCK_ENDS
from tiniscript.diagnostics import codes
from tiniscript.recovery.lines import ANY_END, Reading
from tiniscript.recovery.meanings import WORD_OF_END, Lexeme, made, texts
from tiniscript.recovery.rewrites import negated
from tiniscript.syntax.outline import Item

_ASKING_WORDS = ("IF", "WHILE", "WHEN")
_REMOTE_NAMES = frozenset(device.name for device in REMOTE)
MOST_ITEMS_AFTER_ELSE = 200  # items behind an ELSE whose ends are counted


class Line(NamedTuple):
    """A line as it is read. `is_when`: it begins with a word for both IF and WHEN."""

    indent: int
    is_when: bool
    reading: Reading

    @property
    def is_do(self) -> bool:
        """Whether it begins a block whose condition comes at its end."""
        return any(step.code is codes.ASKED_AFTER for step in self.reading.steps)


class Edit(NamedTuple):
    """From token `at` on, `old` tokens become `new`."""

    at: int
    old: int
    new: list[Lexeme]


_UNREADABLE_ITEMS = [Item("do", "", 0, 0)]  # what a line that cannot be read is taken for


class _Block:
    def __init__(self, item: Item, k: int, line: Line) -> None:
        is_header = item.kind == "open"
        self.word = item.word if is_header else ""  # nothing for braces that belong to no header
        self.end = BLOCK_ENDS.get(self.word, "")
        self.line = k
        self.start = item.start
        self.indent = line.indent
        self.body: int | None = None  # its lines' indentation, 0 where that is not deeper
        self.has_brace = not self.word
        self.is_begun = is_header and line.reading.is_new_line  # a row says that its body begins
        self.is_do = is_header and line.is_do
        self.is_behind = is_header and _is_behind(item, line.reading)
        self.is_translated = line.reading.tokens[item.start].source is None
        self.name = line.reading.tokens[item.start + 1].text if self.word == "DEF" else ""
        head = [token.text for token in line.reading.tokens[item.start + 1 : item.end]]
        self.is_endless = head in (["(", "FOREVER", ")"], ["(", "TRUE", ")"])
        self.last: int | None = None  # its last line that is ever done


def _is_behind(item: Item, reading: Reading) -> bool:
    """Whether a question stands behind an instruction that it may be of: `F(2, 80) IF(KEY_A);S`.

    No separator is before it, and one is after it.
    """
    tokens, items = reading.tokens, reading.items or ()
    before = [entry.kind for entry in items if entry.start < item.start][-1:]
    if item.word not in _ASKING_WORDS or before != ["do"] or item.end >= len(tokens):
        return False
    bracket_before, after = tokens[item.start - 1], tokens[item.end]
    return bracket_before.source is None and after.text == ";" and after.source is not None


class Matching:
    """What each line needs so that all blocks end: edits, ends behind its text, and on new lines.

    `run` takes item after item of all lines; `after` is the next one, of no kind at the end.
    `is_sure`: no end is a guess.
    """

    def __init__(self, lines: Sequence[Line]) -> None:
        self.lines = lines
        self.flat = [
            (k, item)
            for k, line in enumerate(lines)
            for item in (_UNREADABLE_ITEMS if line.reading.items is None else line.reading.items)
        ]
        self.flat.append((len(lines), Item("", "", 0, 0)))
        self.open: list[_Block] = []
        self.edits: dict[int, list[Edit]] = {}
        self.tails: dict[int, list[str]] = {}
        self.behind: dict[int, list[str]] = {}
        self.is_sure = True

    def run(self) -> bool:
        """Find what is missing for all blocks to end; return whether they fit."""
        last = -1
        for place, (k, item) in enumerate(self.flat[:-1]):
            self.place, self.k, self.line, self.item = place, k, self.lines[k], item
            next_line, self.after = self.flat[place + 1]
            if k != last:
                self.begin_line(last)
                last = k
            if not self.read():
                return False
            if next_line != k:
                self.end_line(self.lines[next_line].indent if next_line < len(self.lines) else 0)
        while self.open:
            block = self.open.pop()
            if not block.word or self.item.kind in ("open", "{"):
                return False  # nothing is in it
            if block.has_brace and block.line == last:
                self.tails.setdefault(last, []).append(block.end)
                continue
            self.is_sure = self.is_sure and bool(block.body) and block.is_begun
            self.is_sure = self.is_sure and not block.is_behind
            self.close_behind(last if block.last is None else block.last, block)
        return True

    def edit(self, old: int, *new_lexemes: str) -> None:
        self.edit_tokens(self.item.start, old, [made(item) for item in new_lexemes])

    def edit_tokens(self, at: int, old: int, new_lexemes: list[Lexeme]) -> None:
        self.edits.setdefault(self.k, []).append(Edit(at, old, new_lexemes))

    def close_behind(self, k: int, block: _Block) -> None:
        self.behind.setdefault(k, []).append(" " * block.indent + block.end)

    # -- the beginning of a line: its indentation may close what is open -----------------------

    def begin_line(self, last: int) -> None:
        indent = self.line.indent
        while self.open and self.item.kind in ("open", "do"):
            block = self.open[-1]
            is_further_left = indent < (block.body or 0) and indent <= block.indent
            if not is_further_left or block.has_brace:
                break
            self.open.pop()
            self.is_sure = self.is_sure and block.is_begun
            self.close_behind(last, block)
        for block in self.open:
            if block.body is None and block.line < self.k:
                block.body = indent if indent > block.indent else 0

    # -- items --------------------------------------------------------------------------------

    def read(self) -> bool:
        """Take an item; return whether it has a place among the blocks."""
        kind = self.item.kind
        if kind == "open":
            if self.is_made_up():
                return False
            if not self.is_end_of_do():
                if self.is_when():
                    self.edit(1, "WHEN")
                    self.item = self.item._replace(word="WHEN")
                self.open.append(_Block(self.item, self.k, self.line))
        elif kind == "{":
            return self.brace()
        elif kind == "}":
            return self.closing_brace()
        elif kind == "arm":
            return bool(self.open) and self.open[-1].word == "IF"
        elif kind == "end" and not self.is_before_arm():
            return self.bare_end() if self.item.word == ANY_END else self.end()
        return True

    def is_made_up(self) -> bool:
        """Whether a header is a word behind an instruction, and nothing more: `F(1, 80) LOP`."""
        tokens, (_, _, start, end) = self.line.reading.tokens, self.item
        around = [*tokens[max(0, start - 1) : start], *tokens[start + 1 : end]]
        is_begun = [item.text for item in around[:2]] == [";", "("]
        return is_begun and end == len(tokens) and all(it.source is None for it in around)

    def is_when(self) -> bool:
        """Whether an IF is meant as a WHEN: at the top level, with lines and an end of its own.

        A key is asked for so anyway: who asks once, as the program begins, never sees it pressed.
        """
        if self.open or not self.line.is_when or self.item.word != "IF":
            return False
        line, part = next(self.parts(), (self.k, self.item))
        ended_word = WORD_OF_END.get(part.word)
        if not _REMOTE_NAMES.isdisjoint(texts(self.line.reading.tokens[slice(*self.item[2:4])])):
            return part.kind != "end" or ended_word != "IF"
        return part.kind == "end" and (
            ended_word == "WHEN" or (line != self.k and ended_word != "IF")
        )

    def is_end_of_do(self) -> bool:
        """Whether a WHILE ends the block that a DO has begun: then it leaves that."""
        item = self.item
        if item.word != "WHILE" or not self.open or not self.open[-1].is_do:
            return False
        condition = self.line.reading.tokens[item.start + 2 : item.end - 1]
        new_lexemes = [made("IF"), made("("), *negated(condition), made(")")]
        new_lexemes += map(made, (";", "BREAK", ";", BLOCK_ENDS["IF"], ";", BLOCK_ENDS["LOOP"]))
        self.edit_tokens(item.start, item.end - item.start, new_lexemes)
        self.open.pop()
        return True

    def brace(self) -> bool:
        if not self.open:
            is_first = self.item.start == 0 or self.line.reading.tokens[0].text == "START"
            self.is_sure = self.is_sure and is_first
            self.edit(1)
            self.open.append(_Block(self.item, self.k, self.line))
            return True
        if self.open[-1].has_brace:
            return False
        self.open[-1].has_brace = True
        self.edit(1, ";")
        return True

    def closing_brace(self) -> bool:
        if not self.open:
            return False
        block, after = self.open[-1], self.after
        is_arm = block.word == "IF" and after.kind == "arm"
        goes_on = is_arm or (block.word and after.kind == "end" and after.word == block.end)
        if goes_on or (block.is_do and after.word == "WHILE"):
            self.edit(1, ";")
            block.has_brace = block.has_brace and not goes_on
            return True
        if not block.has_brace:
            return False
        self.open.pop()
        self.edit(1, *((";", block.end, ";") if block.word else ()))
        return True

    def is_before_arm(self) -> bool:
        """Whether an end comes too early, and is dropped: the ELSE behind it belongs to its IF."""
        item = self.item
        is_end_of_if = item.word == ANY_END or WORD_OF_END[item.word] == "IF"
        if not (
            is_end_of_if and self.after.kind == "arm" and self.open and self.open[-1].word == "IF"
        ):
            return False
        outer = sum(block.word == "IF" for block in self.open[:-1])
        rest = [it for _, it in self.flat[self.place + 1 : self.place + MOST_ITEMS_AFTER_ELSE]]
        ends = sum(it.kind == "end" and it.word in (ANY_END, "ENDIF", "END_IF") for it in rest)
        is_too_early = ends - sum(it.kind == "open" and it.word == "IF" for it in rest) > outer
        if is_too_early:
            is_parted = item.start > 0 and self.line.reading.tokens[item.start - 1].text == ";"
            self.edit_tokens(item.start - is_parted, 1 + is_parted, [])
        return is_too_early

    def bare_end(self) -> bool:
        """`FIN` ends the innermost block; one too many is dropped."""
        if not self.open:
            if any(line.reading.items is None for line in self.lines):
                return False
            before = self.line.reading.tokens[self.item.start - 1]
            follows_separator = (
                not self.after.kind and before.text == ";" and before.source is not None
            )
            is_only_item = len(self.line.reading.items or ()) == 1 or follows_separator
            self.is_sure = self.is_sure and is_only_item and len(self.flat) > 2
            self.edit(1)
        elif self.open[-1].word:
            self.edit(1, self.open.pop().end)
        else:
            return False
        return True

    def end(self) -> bool:
        expected_word, k = WORD_OF_END[self.item.word], self.k
        if self.open and self.open[-1].word not in ("", expected_word):
            words = [block.word for block in self.open]
            block = self.open[-1]
            is_in_block = (len(words) > 1 and block.line == k) or bool(block.body)
            if expected_word not in words:
                self.edit(1, self.open.pop().end)
                is_changed = bool(self.line.reading.steps) or block.is_translated
                self.is_sure = self.is_sure and is_changed
                return True
            next_end = next((it for _, it in self.parts() if it.kind == "end"), None)
            if (
                next_end and WORD_OF_END.get(next_end.word) == block.word
            ):  # the two ends are swapped
                self.is_sure = False
                del self.open[len(words) - 1 - words[::-1].index(expected_word)]
                return True
            if is_in_block:
                self.open.pop()
                is_in_same_line = block.line == k and (
                    block.is_endless or not self.is_parted(block)
                )
                is_changed = (block.is_begun or is_in_same_line) and not block.is_behind
                self.is_sure = self.is_sure and is_changed
                self.edit(0, block.end, ";")
        if self.open and self.open[-1].word == expected_word:
            block = self.open.pop()
            self.is_sure = self.is_sure and not block.has_brace and self.line.is_do <= block.is_do
            if block.is_endless and self.open and self.open[-1].last is None:
                outer = self.open[-1]  # a WHEN that never ends looks no more
                is_in_earlier_line = outer.word == "WHEN" and outer.line + 1 < block.line
                outer.last = block.line - 1 if is_in_earlier_line else k
            return True
        return False

    # -- the end of a line: a body behind its header ends there, unless an end is left for it ----

    def end_line(self, indent_below: int) -> None:
        after = self.after
        while self.open and self.open[-1].line == self.k and self.item.kind != "open":
            block = self.open[-1]
            if block.has_brace or not block.word or indent_below > block.indent:
                break
            is_closed = any(each.kind != "arm" or block.word == "IF" for _, each in self.parts())
            is_arm = block.word == "IF" and after.kind == "arm"
            if is_closed and (len(self.open) == 1 or is_arm):
                break
            self.open.pop()
            self.is_sure = self.is_sure and block.is_begun and not block.is_behind
            if block.word in ("IF", "WHILE", "LOOP"):
                self.is_sure = self.is_sure and not self.is_parted(block)
            elif block.word == "DEF" and after.kind == "do":
                self.is_sure = self.is_sure and after.word == block.name
            self.tails.setdefault(self.k, []).append(block.end)

    def is_parted(self, block: _Block) -> bool:
        """Whether a block may end before this: at a `;` of the text, or at another block."""
        last = self.item.start
        items = [it for it in self.line.reading.items or () if block.start <= it.start <= last]
        arm = max((k for k, each in enumerate(items) if each.kind == "arm"), default=0)
        messages = [item for item in items[arm:] if item.kind == "do"]
        tokens_between = (
            self.line.reading.tokens[messages[0].end : messages[-1].start] if messages else []
        )
        header_count = sum(item.kind == "open" and item.word == "IF" for item in items)
        return header_count > 1 or any(
            each.text == ";" and each.source is not None for each in tokens_between
        )

    def parts(self) -> Iterator[tuple[int, Item]]:
        """Give the arms and ends behind a place, but those of blocks that begin behind it."""
        depth = 0
        for line, item in self.flat[self.place + 1 :]:
            is_end = item.kind in ("end", "}")
            if not depth and (is_end or item.kind == "arm"):
                yield line, item
            depth += (item.kind == "open") - (is_end and depth > 0)
