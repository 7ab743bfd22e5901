"""Blocks: which end belongs to which header, over all lines of a program.

Names bare ends, replaces braces by words, and closes the blocks that a line or its indentation
closes. Takes each line as it is read.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from tiniscript.base.kit import REMOTE
from tiniscript.base.words import BLOCK_ENDS
from tiniscript.diagnostics import codes
from tiniscript.recovery.lines import ANY_END, Reading
from tiniscript.recovery.meanings import Lexeme, make_token, texts
from tiniscript.recovery.rewrites import negate
from tiniscript.syntax.blocks import WORD_OF_END
from tiniscript.syntax.outline import Item

_ASKING_WORDS = ("IF", "WHILE", "WHEN")
_REMOTE_NAMES = frozenset(device.name for device in REMOTE)
MAX_ITEMS_AFTER_ELSE = 200  # the number of items after an ELSE whose ends are counted


class Line(NamedTuple):
    """A line as it is read. `is_when`: it begins with a word for both IF and WHEN."""

    indent: int
    is_when: bool
    reading: Reading

    @property
    def asks_at_end(self) -> bool:
        """Return whether the block has its condition at its end."""
        return any(step.code is codes.ASKED_AFTER for step in self.reading.steps)


class TokenEdit(NamedTuple):
    """An edit that replaces `old_count` tokens from `start` on by `new_tokens`."""

    start: int
    old_count: int
    new_tokens: list[Lexeme]


_UNREADABLE_ITEMS = [Item("do", "", 0, 0)]  # the reading of a line that cannot be read


class _OpenBlock:
    def __init__(self, item: Item, k: int, line: Line) -> None:
        is_header = item.kind == "open"
        self.word = item.word if is_header else ""  # empty for braces without a header
        self.end = BLOCK_ENDS.get(self.word, "")
        self.line = k
        self.start = item.start
        self.indent = line.indent
        # Indentation of its lines, or 0 if not deeper than the header's.
        self.body_indent: int | None = None
        self.has_brace = not self.word
        self.has_known_start = (
            is_header and line.reading.is_new_line
        )  # a row marks the beginning of its body
        self.asks_at_end = is_header and line.asks_at_end
        self.may_ask_before = is_header and _may_ask_before(item, line.reading)
        self.is_translated = line.reading.tokens[item.start].source is None
        self.name = line.reading.tokens[item.start + 1].text if self.word == "DEF" else ""
        header_texts = [token.text for token in line.reading.tokens[item.start + 1 : item.end]]
        self.is_endless = header_texts in (["(", "FOREVER", ")"], ["(", "TRUE", ")"])
        self.last_reached_line: int | None = None  # the last line that can be reached


def _may_ask_before(item: Item, reading: Reading) -> bool:
    """Return whether a question follows an instruction that it may belong to: `F(2, 80)
    IF(KEY_A);S`.

    No separator is before it, and one is after it.
    """
    tokens, items = reading.tokens, reading.items or ()
    kind_before = [entry.kind for entry in items if entry.start < item.start][-1:]
    if item.word not in _ASKING_WORDS or kind_before != ["do"] or item.end >= len(tokens):
        return False
    bracket_before, token_after = tokens[item.start - 1], tokens[item.end]
    return (
        bracket_before.source is None and token_after.text == ";" and token_after.source is not None
    )


class Matching:
    """The changes that end all blocks: edits, ends after a line's text, and on new lines.

    `run` takes item after item of all lines; `next_item` is the next one, of no kind at the end.
    `is_sure`: no end is a guess.
    """

    def __init__(self, lines: Sequence[Line]) -> None:
        self.lines = lines
        self.items = [
            (k, item)
            for k, line in enumerate(lines)
            for item in (_UNREADABLE_ITEMS if line.reading.items is None else line.reading.items)
        ]
        self.items.append((len(lines), Item("", "", 0, 0)))
        self.open_blocks: list[_OpenBlock] = []
        self.edits_by_line: dict[int, list[TokenEdit]] = {}
        self.ends_on_line: dict[int, list[str]] = {}
        self.ends_below: dict[int, list[str]] = {}
        self.is_sure = True

    def run(self) -> bool:
        """Find the changes that end all blocks; return whether they fit."""
        last_line = -1
        for index, (k, item) in enumerate(self.items[:-1]):
            self.item_index, self.k, self.line, self.item = index, k, self.lines[k], item
            next_line, self.next_item = self.items[index + 1]
            if k != last_line:
                self.begin_line(last_line)
                last_line = k
            if not self.read_item():
                return False
            if next_line != k:
                self.end_line(self.lines[next_line].indent if next_line < len(self.lines) else 0)
        while self.open_blocks:
            block = self.open_blocks.pop()
            if not block.word or self.item.kind in ("open", "{"):
                return False  # the block is empty
            if block.has_brace and block.line == last_line:
                self.ends_on_line.setdefault(last_line, []).append(block.end)
                continue
            self.is_sure = self.is_sure and bool(block.body_indent) and block.has_known_start
            self.is_sure = self.is_sure and not block.may_ask_before
            self.close_below(
                last_line if block.last_reached_line is None else block.last_reached_line, block
            )
        return True

    def edit_item(self, old_count: int, *new_texts: str) -> None:
        self.edit_tokens(self.item.start, old_count, [make_token(text) for text in new_texts])

    def edit_tokens(self, start: int, old_count: int, new_tokens: list[Lexeme]) -> None:
        self.edits_by_line.setdefault(self.k, []).append(TokenEdit(start, old_count, new_tokens))

    def close_below(self, k: int, block: _OpenBlock) -> None:
        self.ends_below.setdefault(k, []).append(" " * block.indent + block.end)

    # -- the beginning of a line: its indentation may close blocks --------------------------------

    def begin_line(self, line_before: int) -> None:
        indent = self.line.indent
        while self.open_blocks and self.item.kind in ("open", "do"):
            block = self.open_blocks[-1]
            is_further_left = indent < (block.body_indent or 0) and indent <= block.indent
            if not is_further_left or block.has_brace:
                break
            self.open_blocks.pop()
            self.is_sure = self.is_sure and block.has_known_start
            self.close_below(line_before, block)
        for block in self.open_blocks:
            if block.body_indent is None and block.line < self.k:
                block.body_indent = indent if indent > block.indent else 0

    # -- items --------------------------------------------------------------------------------

    def read_item(self) -> bool:
        """Take an item; return whether it has a place among the blocks."""
        kind = self.item.kind
        if kind == "open":
            if self.is_made_up():
                return False
            if not self.end_do():
                if self.is_when():
                    self.edit_item(1, "WHEN")
                    self.item = self.item._replace(word="WHEN")
                self.open_blocks.append(_OpenBlock(self.item, self.k, self.line))
        elif kind == "{":
            return self.read_brace()
        elif kind == "}":
            return self.read_closing_brace()
        elif kind == "arm":
            return bool(self.open_blocks) and self.open_blocks[-1].word == "IF"
        elif kind == "end" and not self.drop_early_end():
            return self.read_bare_end() if self.item.word == ANY_END else self.read_end()
        return True

    def is_made_up(self) -> bool:
        """Return whether a header is only a word after an instruction: `F(1, 80) LOP`."""
        tokens, (_, _, start, end) = self.line.reading.tokens, self.item
        tokens_around = [*tokens[max(0, start - 1) : start], *tokens[start + 1 : end]]
        has_separator = [token.text for token in tokens_around[:2]] == [";", "("]
        return (
            has_separator
            and end == len(tokens)
            and all(token.source is None for token in tokens_around)
        )

    def is_when(self) -> bool:
        """Return whether an IF means a WHEN: at the top level, with lines and an end of its own.

        This is for keys: a program that checks a key only once, at its start, never sees it
        pressed.
        """
        if self.open_blocks or not self.line.is_when or self.item.word != "IF":
            return False
        line, next_part = next(self.arms_and_ends(), (self.k, self.item))
        ended_word = WORD_OF_END.get(next_part.word)
        if not _REMOTE_NAMES.isdisjoint(texts(self.line.reading.tokens[slice(*self.item[2:4])])):
            return next_part.kind != "end" or ended_word != "IF"
        return next_part.kind == "end" and (
            ended_word == "WHEN" or (line != self.k and ended_word != "IF")
        )

    def end_do(self) -> bool:
        """End the block of a DO where a WHILE does; return whether it did."""
        item = self.item
        if item.word != "WHILE" or not self.open_blocks or not self.open_blocks[-1].asks_at_end:
            return False
        condition = self.line.reading.tokens[item.start + 2 : item.end - 1]
        new_tokens = [make_token("IF"), make_token("("), *negate(condition), make_token(")")]
        new_tokens += map(
            make_token, (";", "BREAK", ";", BLOCK_ENDS["IF"], ";", BLOCK_ENDS["LOOP"])
        )
        self.edit_tokens(item.start, item.end - item.start, new_tokens)
        self.open_blocks.pop()
        return True

    def read_brace(self) -> bool:
        if not self.open_blocks:
            is_first = self.item.start == 0 or self.line.reading.tokens[0].text == "START"
            self.is_sure = self.is_sure and is_first
            self.edit_item(1)
            self.open_blocks.append(_OpenBlock(self.item, self.k, self.line))
            return True
        if self.open_blocks[-1].has_brace:
            return False
        self.open_blocks[-1].has_brace = True
        self.edit_item(1, ";")
        return True

    def read_closing_brace(self) -> bool:
        if not self.open_blocks:
            return False
        block, next_item = self.open_blocks[-1], self.next_item
        is_arm = block.word == "IF" and next_item.kind == "arm"
        is_continued = is_arm or (
            block.word and next_item.kind == "end" and next_item.word == block.end
        )
        if is_continued or (block.asks_at_end and next_item.word == "WHILE"):
            self.edit_item(1, ";")
            block.has_brace = block.has_brace and not is_continued
            return True
        if not block.has_brace:
            return False
        self.open_blocks.pop()
        self.edit_item(1, *((";", block.end, ";") if block.word else ()))
        return True

    def drop_early_end(self) -> bool:
        """Drop an end before the ELSE of its IF; return whether it found one."""
        item = self.item
        is_end_of_if = item.word == ANY_END or WORD_OF_END[item.word] == "IF"
        if not (
            is_end_of_if
            and self.next_item.kind == "arm"
            and self.open_blocks
            and self.open_blocks[-1].word == "IF"
        ):
            return False
        outer_count = sum(block.word == "IF" for block in self.open_blocks[:-1])
        items_after = [
            item
            for _, item in self.items[self.item_index + 1 : self.item_index + MAX_ITEMS_AFTER_ELSE]
        ]
        end_count = sum(
            item.kind == "end" and item.word in (ANY_END, "ENDIF", "END_IF") for item in items_after
        )
        is_too_early = (
            end_count - sum(item.kind == "open" and item.word == "IF" for item in items_after)
            > outer_count
        )
        if is_too_early:
            is_parted = item.start > 0 and self.line.reading.tokens[item.start - 1].text == ";"
            self.edit_tokens(item.start - is_parted, 1 + is_parted, [])
        return is_too_early

    def read_bare_end(self) -> bool:
        """`FIN` ends the innermost block; one too many is dropped."""
        if not self.open_blocks:
            if any(line.reading.items is None for line in self.lines):
                return False
            previous_token = self.line.reading.tokens[self.item.start - 1]
            follows_separator = (
                not self.next_item.kind
                and previous_token.text == ";"
                and previous_token.source is not None
            )
            is_only_item = len(self.line.reading.items or ()) == 1 or follows_separator
            self.is_sure = self.is_sure and is_only_item and len(self.items) > 2
            self.edit_item(1)
        elif self.open_blocks[-1].word:
            self.edit_item(1, self.open_blocks.pop().end)
        else:
            return False
        return True

    def read_end(self) -> bool:
        expected_word, k = WORD_OF_END[self.item.word], self.k
        if self.open_blocks and self.open_blocks[-1].word not in ("", expected_word):
            words = [block.word for block in self.open_blocks]
            block = self.open_blocks[-1]
            is_in_block = (len(words) > 1 and block.line == k) or bool(block.body_indent)
            if expected_word not in words:
                self.edit_item(1, self.open_blocks.pop().end)
                is_changed = bool(self.line.reading.steps) or block.is_translated
                self.is_sure = self.is_sure and is_changed
                return True
            next_end = next((item for _, item in self.arms_and_ends() if item.kind == "end"), None)
            if (
                next_end and WORD_OF_END.get(next_end.word) == block.word
            ):  # the two ends are swapped
                self.is_sure = False
                del self.open_blocks[len(words) - 1 - words[::-1].index(expected_word)]
                return True
            if is_in_block:
                self.open_blocks.pop()
                is_in_same_line = block.line == k and (
                    block.is_endless or not self.has_break_in(block)
                )
                is_changed = (block.has_known_start or is_in_same_line) and not block.may_ask_before
                self.is_sure = self.is_sure and is_changed
                self.edit_item(0, block.end, ";")
        if self.open_blocks and self.open_blocks[-1].word == expected_word:
            block = self.open_blocks.pop()
            self.is_sure = (
                self.is_sure and not block.has_brace and self.line.asks_at_end <= block.asks_at_end
            )
            if (
                block.is_endless
                and self.open_blocks
                and self.open_blocks[-1].last_reached_line is None
            ):
                outer = self.open_blocks[-1]  # a WHEN that never ends looks no more
                is_in_earlier_line = outer.word == "WHEN" and outer.line + 1 < block.line
                outer.last_reached_line = block.line - 1 if is_in_earlier_line else k
            return True
        return False

    # -- the end of a line: a body after its header ends there, unless an end is left for it ----

    def end_line(self, indent_below: int) -> None:
        next_item = self.next_item
        while self.open_blocks and self.open_blocks[-1].line == self.k and self.item.kind != "open":
            block = self.open_blocks[-1]
            if block.has_brace or not block.word or indent_below > block.indent:
                break
            is_closed = any(
                part.kind != "arm" or block.word == "IF" for _, part in self.arms_and_ends()
            )
            is_arm = block.word == "IF" and next_item.kind == "arm"
            if is_closed and (len(self.open_blocks) == 1 or is_arm):
                break
            self.open_blocks.pop()
            self.is_sure = self.is_sure and block.has_known_start and not block.may_ask_before
            if block.word in ("IF", "WHILE", "LOOP"):
                self.is_sure = self.is_sure and not self.has_break_in(block)
            elif block.word == "DEF" and next_item.kind == "do":
                self.is_sure = self.is_sure and next_item.word == block.name
            self.ends_on_line.setdefault(self.k, []).append(block.end)

    def has_break_in(self, block: _OpenBlock) -> bool:
        """Return whether a block may end before this: at a `;` of the text, or at another block."""
        current_start = self.item.start
        items = [
            item
            for item in self.line.reading.items or ()
            if block.start <= item.start <= current_start
        ]
        arm_index = max((k for k, item in enumerate(items) if item.kind == "arm"), default=0)
        instructions = [item for item in items[arm_index:] if item.kind == "do"]
        tokens_between = (
            self.line.reading.tokens[instructions[0].end : instructions[-1].start]
            if instructions
            else []
        )
        header_count = sum(item.kind == "open" and item.word == "IF" for item in items)
        return header_count > 1 or any(
            item.text == ";" and item.source is not None for item in tokens_between
        )

    def arms_and_ends(self) -> Iterator[tuple[int, Item]]:
        """Yield the arms and ends after a place, except those of blocks that begin later."""
        depth = 0
        for line, item in self.items[self.item_index + 1 :]:
            is_end = item.kind in ("end", "}")
            if not depth and (is_end or item.kind == "arm"):
                yield line, item
            depth += (item.kind == "open") - (is_end and depth > 0)
