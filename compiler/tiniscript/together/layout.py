"""The text of a shared program, as the formatter lays it out, and the tree of a text.

Parsing, layout and words are the package's own. Knows no operation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import lru_cache
from itertools import count
from typing import NamedTuple

from tiniscript.base.source import Source
from tiniscript.base.words import BLOCK_ENDS
from tiniscript.syntax.formatter import (
    COMMENT_GAP,
    Row,
    format_source,
    instruction_text,
    lines_of,
    pieces_of,
)
from tiniscript.syntax.lexer import scan
from tiniscript.syntax.parser import parse
from tiniscript.together.tree import (
    BLOCK,
    NOTE,
    ROOT,
    START,
    Node,
    Tree,
    first_word,
    kind_of,
)

_ENDS = frozenset(BLOCK_ENDS.values())
OWN_LINE, END_LINE = "own", "end"  # the line of an instruction, and that of the end of its block
Key = tuple[str, str]  # the id of a node, and one of these


class Unparsed(Exception):
    """A text does not parse; `lines` are where, from 0."""

    def __init__(self, lines: frozenset[int]) -> None:
        super().__init__(f"lines {sorted(lines)}")
        self.lines = lines


class Line(NamedTuple):
    """`keys` say whose text it is; an empty line has none."""

    text: str
    keys: tuple[Key, ...] = ()


@lru_cache(maxsize=32)
def mistaken_lines(text: str) -> frozenset[int]:
    """Return the lines, from 0, of what the parser finds wrong."""
    source = Source(text)
    return frozenset(
        source.position(diagnostic.span.start)[0] - 1
        for diagnostic in parse(source).diagnostics
        if diagnostic.is_mistake
    )


def parse_tree(
    text: str, make_id: Callable[[], str] | None = None, is_laid_out: bool = False,
    line_by_id: dict[str, int] | None = None,
) -> Tree:  # fmt: skip
    """Return the tree of a text. Raises Unparsed. `is_laid_out`: as the formatter does it.

    `line_by_id` gets the line of each node, from 0.
    """
    bad_lines = mistaken_lines(text)
    if bad_lines:
        raise Unparsed(bad_lines)
    first_lines: list[int] = []  # line numbers before formatting
    if line_by_id is not None:
        first_lines = [piece.first_line for piece in pieces_of(scan(text))]
    if not is_laid_out:
        text = format_source(Source(text))
    numbers = count(1)
    next_id = make_id or (lambda: f"?{next(numbers)}")
    tree = Tree()
    open_blocks = [ROOT]
    root, start = tree[ROOT], tree[START]
    for k, piece in enumerate(pieces_of(scan(text))):
        note = " ".join(piece.comments)
        if piece.is_setup:
            start.text, start.note, start.apart = (
                f"{piece.tokens[0].text}|", note, piece.follows_blank)  # fmt: skip
            root.children.remove(START)
            root.children.append(START)
            continue
        node_text, kind = note, NOTE
        if piece.tokens:
            node_text = instruction_text(piece.tokens)
            if first_word(node_text) in _ENDS:
                tree[open_blocks.pop()].end = note
                continue
            kind = kind_of(node_text)
        else:
            note = ""
        node = Node(next_id(), kind, node_text, note, piece.follows_blank, parent=open_blocks[-1])
        tree.node_by_id[node.id] = node
        tree[open_blocks[-1]].children.append(node.id)
        if line_by_id is not None:
            line_by_id[node.id] = first_lines[k]
        if node.kind == BLOCK:
            open_blocks.append(node.id)
    return tree


class _Entry(NamedTuple):
    key: Key
    word: str  # empty of a comment and of the start
    text: str
    note: str
    is_apart: bool


def _entries(tree: Tree, container: str = ROOT) -> Iterable[_Entry]:
    for id in tree[container].children:
        node = tree[id]
        if id == START and not node.text:
            continue
        word = "" if node.kind in (NOTE, START) else first_word(node.text)
        yield _Entry((id, OWN_LINE), word, node.text, node.note, node.apart)
        if node.kind == BLOCK:
            yield from _entries(tree, id)
            yield _Entry((id, END_LINE), BLOCK_ENDS[word], BLOCK_ENDS[word], node.end, False)


def tree_lines(tree: Tree) -> list[Line]:
    """Return the lines of a program. A start shares a line with the text after it."""
    entries = list(_entries(tree))
    is_alone = _has_one_instruction(entries)
    rows: list[Row] = []
    keys: list[tuple[Key, ...]] = []
    k = 0
    while k < len(entries):
        key, word, text, note, is_apart = entries[k]
        line_keys = [key]
        next_entry = entries[k + 1] if k + 1 < len(entries) else None
        if (
            key[0] == START and not note and next_entry is not None and next_entry.word
            and (is_alone or not next_entry.is_apart)
        ):  # fmt: skip
            k += 1
            word, note = next_entry.word, next_entry.note
            text += next_entry.text
            line_keys.append(next_entry.key)
        text += ";" if word and not is_alone else ""
        text += COMMENT_GAP + note if note else ""
        rows.append(Row("" if is_alone else word, text, is_apart))
        keys.append(tuple(line_keys))
        k += 1
    lines = []
    for text, own_keys in zip(lines_of(rows), keys, strict=True):
        if text.startswith("\n"):
            lines.append(Line(""))
        lines.append(Line(text.removeprefix("\n"), own_keys))
    return lines


def _has_one_instruction(entries: list[_Entry]) -> bool:
    """Return whether there is a single instruction after the start, so that it needs no end
    sign.
    """
    instruction_indexes = [k for k, entry in enumerate(entries) if entry.word]
    if len(instruction_indexes) != 1:
        return False
    start_indexes = [
        k for k, entry in enumerate(entries) if entry.key[0] == START and k < instruction_indexes[0]
    ]
    return all(k == instruction_indexes[0] - 1 and not entries[k].note for k in start_indexes)


def text_of(tree: Tree) -> str:
    return "".join(line.text + "\n" for line in tree_lines(tree))


def ids_after_empty_lines(tree: Tree) -> set[str]:
    """Return the ids before which an empty line is seen."""
    ids, was_empty = set(), False
    for line in tree_lines(tree):
        if was_empty and line.keys:
            ids.add(line.keys[0][0])
        was_empty = not line.keys
    return ids
