"""The shared program as a tree of instructions, each with an id that stays while its text changes.

A node is an instruction, a block, an arm (ELSE, ELSEIF: a leaf among what is in its IF, so that
"the first of an arm" is "after the arm"), a line of comment, or the start, which is always there
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
Shape = tuple[str, str, str, tuple[Any, ...]]  # text, note, note of the end, children

ROOT, START = "root", "start"
ARMS = frozenset(("ELSE", "ELSEIF"))
INSTRUCTION, BLOCK, ARM, NOTE = "do", "block", "arm", "note"
TEXT, COMMENT, APART, END = FIELDS = ("text", "note", "apart", "end")
PLACE = "place"  # kind of mark besides those of fields
MAX_FORMER_PLACES = 2000  # ids with known former places; the oldest are forgotten


def first_word(text: str) -> str:
    end = 0
    while end < len(text) and (text[end].isalnum() or text[end] == "_"):
        end += 1
    return text[:end]


def kind_of(text: str) -> str:
    if text.startswith("//"):
        return NOTE
    word = first_word(text)
    return BLOCK if word in BLOCK_ENDS else ARM if word in ARMS else INSTRUCTION


class Subtree(NamedTuple):
    """A node that is not in a tree, with all that is in it.

    `creator_uid` and `marks` are those of one that was in a tree.
    """

    id: str
    text: str = ""
    note: str = ""
    apart: bool = False
    end: str = ""
    children: tuple[Subtree, ...] = ()
    creator_uid: str = ""
    marks: tuple[tuple[str, str], ...] = ()

    def ids(self) -> Iterator[str]:
        """Return its id and those of all that is in it, in the order of the text."""
        yield self.id
        for child in self.children:
            yield from child.ids()

    def data(self) -> Json:
        """Return it for JSON, without default values."""
        data: Json = {"id": self.id}
        for name in FIELDS:
            if getattr(self, name):
                data[name] = getattr(self, name)
        if self.children:
            data["in"] = [child.data() for child in self.children]
        if self.creator_uid:
            data["born"] = self.creator_uid
        if self.marks:
            data["marks"] = dict(self.marks)
        return data


class FormerPlace(NamedTuple):
    """The former place of a removed node; `is_deleted`: with its children."""

    container: str
    previous_id: str
    is_deleted: bool


@dataclass(slots=True)
class Node:
    """`note` follows the instruction, `end` the end of its block; `apart`: an empty line precedes
    it. `creator_uid` is the change that made it; `marks` name the last change of each field and of
    the place, if it is another one.
    """

    id: str
    kind: str
    text: str = ""
    note: str = ""
    apart: bool = False
    end: str = ""
    parent: str = ""
    children: list[str] = field(default_factory=list)
    creator_uid: str = ""
    marks: dict[str, str] = field(default_factory=dict)

    def mark(self, name: str) -> str:
        """Return the last change of a field, or of the place."""
        return self.marks.get(name, self.creator_uid)

    def copy(self) -> Node:
        return Node(self.id, self.kind, self.text, self.note, self.apart, self.end, self.parent,
                    self.children[:], self.creator_uid, dict(self.marks))  # fmt: skip


class Tree:
    """A tree that is copied before a change, so that shared trees stay unchanged."""

    def __init__(self) -> None:
        self.node_by_id: dict[str, Node] = {
            ROOT: Node(ROOT, BLOCK, children=[START]),
            START: Node(START, START, parent=ROOT),
        }
        self.former_place_by_id: dict[str, FormerPlace] = {}

    def copy(self) -> Tree:
        copied_tree = Tree.__new__(Tree)
        copied_tree.node_by_id = {id: node.copy() for id, node in self.node_by_id.items()}
        copied_tree.former_place_by_id = dict(self.former_place_by_id)
        return copied_tree

    def __getitem__(self, id: str) -> Node:
        return self.node_by_id[id]

    def __contains__(self, id: object) -> bool:
        return id in self.node_by_id

    def previous_sibling(self, id: str) -> str:
        """Return the id before a node among its siblings, or nothing."""
        siblings = self.node_by_id[self.node_by_id[id].parent].children
        k = siblings.index(id)
        return siblings[k - 1] if k else ""

    def subtree_ids(self, id: str = ROOT) -> list[str]:
        """Return a node's id and those of all that is in it, in the order of the text."""
        ids = [id]
        for child_id in self.node_by_id[id].children:
            ids += self.subtree_ids(child_id)
        return ids

    def is_in(self, id: str, other: str) -> bool:
        """Return whether a node is another one, or inside it."""
        while id and id != other:
            id = self.node_by_id[id].parent
        return id == other

    def ids_of_arm(self, arm: str) -> list[str]:
        """Return the ids of an arm, up to the next arm."""
        siblings = self.node_by_id[self.node_by_id[arm].parent].children
        ids = []
        for sibling in siblings[siblings.index(arm) + 1 :]:
            if self.node_by_id[sibling].kind == ARM:
                break
            ids.append(sibling)
        return ids

    def add(self, subtree: Subtree, parent: str, uid: str) -> Node:
        """Add a node with its children, without a place among its siblings."""
        node = Node(
            subtree.id,
            kind_of(subtree.text),
            subtree.text,
            subtree.note,
            subtree.apart,
            subtree.end,
            parent,
            [child.id for child in subtree.children],
            subtree.creator_uid or uid,
            dict(subtree.marks),
        )
        self.node_by_id[node.id] = node
        for child in subtree.children:
            self.add(child, node.id, uid)
        return node

    def put(self, ids: list[str], container: str, previous_id: str) -> None:
        """Put nodes in a place."""
        siblings = self.node_by_id[container].children
        k = siblings.index(previous_id) + 1 if previous_id else 0
        siblings[k:k] = ids
        for id in ids:
            self.node_by_id[id].parent = container

    def forget(self, id: str, former_place: FormerPlace) -> None:
        """Take a node out, whose place is given away already."""
        del self.node_by_id[id]
        self.former_place_by_id.pop(id, None)  # the newest is the last
        self.former_place_by_id[id] = former_place

    def limit_former_places(self) -> None:
        for id in list(
            islice(
                self.former_place_by_id, max(0, len(self.former_place_by_id) - MAX_FORMER_PLACES)
            )
        ):
            del self.former_place_by_id[id]

    # -- as data ----------------------------------------------------------------------------------

    def subtree(self, id: str, with_children: bool = True) -> Subtree:
        """Return a node with its marks, and its children if `with_children`."""
        node = self.node_by_id[id]
        children = (
            tuple(self.subtree(child_id) for child_id in node.children) if with_children else ()
        )
        marks = tuple(node.marks.items())
        return Subtree(
            id, node.text, node.note, node.apart, node.end, children, node.creator_uid, marks
        )

    def snapshot(self) -> Json:
        return {
            "tree": self.subtree(ROOT).data(),
            "gone": {id: list(place) for id, place in self.former_place_by_id.items()},
        }

    @classmethod
    def of(cls, root: Subtree, former_places: dict[str, FormerPlace]) -> Tree:
        tree = cls()
        tree.node_by_id = {}
        tree.add(root, "", "")
        tree.node_by_id[ROOT].kind, tree.node_by_id[START].kind = BLOCK, START
        tree.former_place_by_id = former_places
        return tree

    def checksum(self) -> int:
        """Return a number that two trees share only where they are the same."""
        encoded_text = json.dumps(self.subtree(ROOT).data(), sort_keys=True, separators=(",", ":"))
        return crc32(encoded_text.encode())

    def shape(self) -> Shape:
        """Return the visible content without ids. An omitted start counts as the first."""
        children = self.node_by_id[ROOT].children
        if not self.node_by_id[START].text:
            children = [START, *(id for id in children if id != START)]
        return ("", "", "", tuple(map(self._shape, children)))

    def _shape(self, id: str) -> Shape:
        node = self.node_by_id[id]
        return (node.text, node.note, node.end, tuple(map(self._shape, node.children)))
