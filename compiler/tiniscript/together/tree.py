"""The shared program as a tree of instructions, each with an id that stays while its text changes.

A node is an instruction, a block, an arm (ELSE, ELSEIF: a leaf among what is in its IF, so that
"the first of an arm" is "behind the arm"), a line of comment, or the start, which is always there
and whose text may be empty. Knows no text of a program and no operation.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import islice
from typing import Any, NamedTuple
from zlib import crc32

from tiniscript.base.words import BLOCK_ENDS

Json = dict[str, Any]
Shape = tuple[str, str, str, tuple[Any, ...]]  # text, note, note of the end, what is inside

ROOT, START = "root", "start"
ARMS = frozenset(("ELSE", "ELSEIF"))
DO, BLOCK, ARM, NOTE = "do", "block", "arm", "note"
TEXT, COMMENT, APART, END = FIELDS = ("text", "note", "apart", "end")
PLACE = "place"  # what has a mark besides fields
MOST_GONE = 2000  # ids of which it is known where they were; the oldest are forgotten


def first_word(text: str) -> str:
    end = 0
    while end < len(text) and (text[end].isalnum() or text[end] == "_"):
        end += 1
    return text[:end]


def kind_of(text: str) -> str:
    if text.startswith("//"):
        return NOTE
    word = first_word(text)
    return BLOCK if word in BLOCK_ENDS else ARM if word in ARMS else DO


class Part(NamedTuple):
    """A node that is not in a tree, with all that is in it; `born` and `marks` of one that was."""

    id: str
    text: str = ""
    note: str = ""
    apart: bool = False
    end: str = ""
    inside: tuple[Part, ...] = ()
    born: str = ""
    marks: tuple[tuple[str, str], ...] = ()

    def ids(self) -> Iterator[str]:
        """Return its id and those of all that is in it, in the order of the text."""
        yield self.id
        for each in self.inside:
            yield from each.ids()

    def data(self) -> Json:
        """Return it for JSON, without what is usual."""
        found: Json = {"id": self.id}
        for name in FIELDS:
            if getattr(self, name):
                found[name] = getattr(self, name)
        if self.inside:
            found["in"] = [each.data() for each in self.inside]
        if self.born:
            found["born"] = self.born
        if self.marks:
            found["marks"] = dict(self.marks)
        return found


class Gone(NamedTuple):
    """Where what is no more was; `is_deleted`: with all that was in it."""

    container: str
    behind: str
    is_deleted: bool


@dataclass(slots=True)
class Node:
    """`note` is behind the instruction, `end` behind the end of its block; `apart`: an empty line
    is before it. `born` is the change that made it; `marks` says of each field and of the place
    which change was the last, where another one was.
    """

    id: str
    kind: str
    text: str = ""
    note: str = ""
    apart: bool = False
    end: str = ""
    parent: str = ""
    inside: list[str] = field(default_factory=list)
    born: str = ""
    marks: dict[str, str] = field(default_factory=dict)

    def mark(self, name: str) -> str:
        """Return the last change of a field, or of the place."""
        return self.marks.get(name, self.born)

    def copy(self) -> Node:
        return Node(self.id, self.kind, self.text, self.note, self.apart, self.end, self.parent,
                    self.inside[:], self.born, dict(self.marks))  # fmt: skip


class Tree:
    """Whoever changes one makes a copy first: a tree that was given to somebody stays."""

    def __init__(self) -> None:
        self.nodes: dict[str, Node] = {
            ROOT: Node(ROOT, BLOCK, inside=[START]),
            START: Node(START, START, parent=ROOT),
        }
        self.gone: dict[str, Gone] = {}

    def copy(self) -> Tree:
        new = Tree.__new__(Tree)
        new.nodes = {id: node.copy() for id, node in self.nodes.items()}
        new.gone = dict(self.gone)
        return new

    def __getitem__(self, id: str) -> Node:
        return self.nodes[id]

    def __contains__(self, id: object) -> bool:
        return id in self.nodes

    def behind(self, id: str) -> str:
        """Return the id before a node among its siblings, or nothing."""
        siblings = self.nodes[self.nodes[id].parent].inside
        k = siblings.index(id)
        return siblings[k - 1] if k else ""

    def below(self, id: str = ROOT) -> list[str]:
        """Return a node's id and those of all that is in it, in the order of the text."""
        found = [id]
        for each in self.nodes[id].inside:
            found += self.below(each)
        return found

    def is_in(self, id: str, other: str) -> bool:
        """Whether a node is another one, or in it."""
        while id and id != other:
            id = self.nodes[id].parent
        return id == other

    def of_arm(self, arm: str) -> list[str]:
        """Return what belongs to an arm: up to the next one."""
        siblings = self.nodes[self.nodes[arm].parent].inside
        found = []
        for each in siblings[siblings.index(arm) + 1 :]:
            if self.nodes[each].kind == ARM:
                break
            found.append(each)
        return found

    def add(self, part: Part, parent: str, uid: str) -> Node:
        """Add a node and what is in it; it has no place among its siblings yet."""
        node = Node(part.id, kind_of(part.text), part.text, part.note, part.apart, part.end, parent,
                    [each.id for each in part.inside], part.born or uid,
                    dict(part.marks))  # fmt: skip
        self.nodes[node.id] = node
        for each in part.inside:
            self.add(each, node.id, uid)
        return node

    def put(self, ids: list[str], container: str, behind: str) -> None:
        """Give nodes their place."""
        siblings = self.nodes[container].inside
        k = siblings.index(behind) + 1 if behind else 0
        siblings[k:k] = ids
        for id in ids:
            self.nodes[id].parent = container

    def forget(self, id: str, was: Gone) -> None:
        """Take a node out, whose place is given away already."""
        del self.nodes[id]
        self.gone.pop(id, None)  # the newest is the last
        self.gone[id] = was

    def limit_gone(self) -> None:
        for id in list(islice(self.gone, max(0, len(self.gone) - MOST_GONE))):
            del self.gone[id]

    # -- as data ----------------------------------------------------------------------------------

    def part(self, id: str, is_whole: bool = True) -> Part:
        """Return a node, with its marks and what is in it if it `is_whole`."""
        node = self.nodes[id]
        inside = tuple(self.part(each) for each in node.inside) if is_whole else ()
        marks = tuple(node.marks.items())
        return Part(id, node.text, node.note, node.apart, node.end, inside, node.born, marks)

    def snapshot(self) -> Json:
        return {"tree": self.part(ROOT).data(), "gone": {id: list(each) for id, each in
                                                         self.gone.items()}}  # fmt: skip

    @classmethod
    def of(cls, root: Part, gone: dict[str, Gone]) -> Tree:
        tree = cls()
        tree.nodes = {}
        tree.add(root, "", "")
        tree.nodes[ROOT].kind, tree.nodes[START].kind = BLOCK, START
        tree.gone = gone
        return tree

    def checksum(self) -> int:
        """Return a number that two trees share only where they are the same."""
        whole = json.dumps(self.part(ROOT).data(), sort_keys=True, separators=(",", ":"))
        return crc32(whole.encode())

    def shape(self) -> Shape:
        """Return what a page shows of it, without ids. A start that is not said is the first."""
        inside = self.nodes[ROOT].inside
        if not self.nodes[START].text:
            inside = [START, *(id for id in inside if id != START)]
        return ("", "", "", tuple(map(self._shape, inside)))

    def _shape(self, id: str) -> Shape:
        node = self.nodes[id]
        return (node.text, node.note, node.end, tuple(map(self._shape, node.inside)))
