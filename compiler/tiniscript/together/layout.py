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
    BEFORE_COMMENT,
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
OWN, OF_END = "own", "end"  # the line of an instruction, and that of the end of its block
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
        source.position(each.span.start)[0] - 1
        for each in parse(source).diagnostics
        if each.is_mistake
    )


def read(
    text: str, new_id: Callable[[], str] | None = None, is_laid_out: bool = False,
    places: dict[str, int] | None = None,
) -> Tree:  # fmt: skip
    """Return the tree of a text. Raises Unparsed. `is_laid_out`: as the formatter does it.

    `places` gets the line of each node, from 0.
    """
    wrong = mistaken_lines(text)
    if wrong:
        raise Unparsed(wrong)
    first_lines: list[int] = []  # before the formatter lays it out
    if places is not None:
        first_lines = [piece.first_line for piece in pieces_of(scan(text))]
    if not is_laid_out:
        text = format_source(Source(text))
    numbers = count(1)
    name = new_id or (lambda: f"?{next(numbers)}")
    tree = Tree()
    open_blocks = [ROOT]
    root, start = tree[ROOT], tree[START]
    for k, piece in enumerate(pieces_of(scan(text))):
        note = " ".join(piece.comments)
        if piece.is_setup:
            start.text, start.note, start.apart = (
                f"{piece.tokens[0].text}|", note, piece.follows_blank)  # fmt: skip
            root.inside.remove(START)
            root.inside.append(START)
            continue
        said, kind = note, NOTE
        if piece.tokens:
            said = instruction_text(piece.tokens)
            if first_word(said) in _ENDS:
                tree[open_blocks.pop()].end = note
                continue
            kind = kind_of(said)
        else:
            note = ""
        node = Node(name(), kind, said, note, piece.follows_blank, parent=open_blocks[-1])
        tree.nodes[node.id] = node
        tree[open_blocks[-1]].inside.append(node.id)
        if places is not None:
            places[node.id] = first_lines[k]
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
    for id in tree[container].inside:
        node = tree[id]
        if id == START and not node.text:
            continue
        word = "" if node.kind in (NOTE, START) else first_word(node.text)
        yield _Entry((id, OWN), word, node.text, node.note, node.apart)
        if node.kind == BLOCK:
            yield from _entries(tree, id)
            yield _Entry((id, OF_END), BLOCK_ENDS[word], BLOCK_ENDS[word], node.end, False)


def lines(tree: Tree) -> list[Line]:
    """Return the lines of a program. A start and what is behind it share one."""
    entries = list(_entries(tree))
    is_alone = _is_alone(entries)
    rows: list[Row] = []
    keys: list[tuple[Key, ...]] = []
    k = 0
    while k < len(entries):
        key, word, text, note, is_apart = entries[k]
        own = [key]
        following = entries[k + 1] if k + 1 < len(entries) else None
        if (
            key[0] == START and not note and following is not None and following.word
            and (is_alone or not following.is_apart)
        ):  # fmt: skip
            k += 1
            word, note = following.word, following.note
            text += following.text
            own.append(following.key)
        text += ";" if word and not is_alone else ""
        text += BEFORE_COMMENT + note if note else ""
        rows.append(Row("" if is_alone else word, text, is_apart))
        keys.append(tuple(own))
        k += 1
    found = []
    for text, owners in zip(lines_of(rows), keys, strict=True):
        if text.startswith("\n"):
            found.append(Line(""))
        found.append(Line(text.removeprefix("\n"), owners))
    return found


def _is_alone(entries: list[_Entry]) -> bool:
    """Whether there is one instruction and nothing between it and the start: it has no end sign."""
    said = [k for k, each in enumerate(entries) if each.word]
    if len(said) != 1:
        return False
    starts = [k for k, each in enumerate(entries) if each.key[0] == START and k < said[0]]
    return all(k == said[0] - 1 and not entries[k].note for k in starts)


def text_of(tree: Tree) -> str:
    return "".join(line.text + "\n" for line in lines(tree))


def ids_after_empty_lines(tree: Tree) -> set[str]:
    """Return the ids before which an empty line is seen."""
    found, was_empty = set(), False
    for line in lines(tree):
        if was_empty and line.keys:
            found.add(line.keys[0][0])
        was_empty = not line.keys
    return found
