"""The operations that turn a tree into the program of a new text.

An id stays where a person would say "the same instruction". First, the rows of both are aligned in
order, regardless of their blocks (so a LOOP typed around lines changes none of them); then the
remaining rows are searched elsewhere (cut and paste), longest runs first; then the operations are
created from the outside in. Knows no page.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Callable, Collection, Mapping, Sequence
from difflib import SequenceMatcher
from typing import NamedTuple

from tiniscript.together.form import Delete, Insert, Move, Operation, Place, Replace, Unwrap, Wrap
from tiniscript.together.layout import ids_after_empty_lines, parse_tree
from tiniscript.together.operations import apply_operation
from tiniscript.together.tree import (
    APART,
    ARM,
    BLOCK,
    COMMENT,
    END,
    INSTRUCTION,
    NOTE,
    ROOT,
    START,
    TEXT,
    Node,
    Subtree,
    Tree,
    first_word,
)

MAX_PAIRS = 40_000  # pairs of rows; above this, only equal rows are aligned
_BLOCK_FAMILIES = {"LOOP": "round", "WHILE": "round", "TASK": "task", "WHEN": "task"}
_WORDS = re.compile(r"\w+|[^\w\s]")
# The similarity of two rows; 0 if they cannot be the same instruction. Equal rows go first.
EQUAL, OTHER_NOTE, OTHER_START, SAME_VALUES, OTHER_BLOCK, FEW_WORDS, NO_WORDS = (
    3.0, 2.95, 0.9, 0.6, 0.3, 0.35, 0.2)  # fmt: skip


class Clipboard(NamedTuple):
    """Deleted nodes of a page, `ids_by_text`. A pasted node gets its id back, even if a refused
    deletion has restored it: such a node is one of `restored_ids`, and is moved.
    """

    ids_by_text: Mapping[str, list[str]]
    restored_ids: Collection[str]


EMPTY_CLIPBOARD = Clipboard({}, ())


def find_operations(
    old_tree: Tree, text: str, make_id: Callable[[], str], clipboard: Clipboard = EMPTY_CLIPBOARD,
    owners: Sequence[str] | None = None,
) -> list[Operation]:  # fmt: skip
    """Return operations that make of `old_tree` the program of a text. Raises Unparsed, Refused.

    `owners`: whose each line is, if that is known; what has none is new.
    """
    if owners is None:
        new_tree = parse_tree(text)
        return _Script(
            old_tree, new_tree, match_nodes(old_tree, new_tree), make_id, clipboard
        ).make_operations()
    line_by_id: dict[str, int] = {}
    new_tree = parse_tree(text, line_by_id=line_by_id)
    matches = {ROOT: ROOT, START: START}
    for id, line in line_by_id.items():
        owner = owners[line] if line < len(owners) else ""
        if (
            owner in old_tree
            and old_tree[owner].kind == new_tree[id].kind
            and owner not in matches.values()
        ):
            matches[id] = owner
    return _Script(old_tree, new_tree, matches, make_id, clipboard).make_operations()


# -- which is which -------------------------------------------------------------------------------


def similarity(node: Node, other: Node) -> float:
    if node.kind != other.kind:
        return 0.0
    if node.text == other.text:
        return EQUAL if node.note == other.note else OTHER_NOTE
    if node.kind == START:
        return OTHER_START
    if node.kind == NOTE:
        ratio = SequenceMatcher(None, node.text, other.text, autojunk=False).ratio()
        return 0.3 + 0.6 * ratio if ratio > 0.5 else 0.0
    word, other_word = first_word(node.text), first_word(other.text)
    if node.kind == BLOCK and _BLOCK_FAMILIES.get(word, word) != _BLOCK_FAMILIES.get(
        other_word, other_word
    ):
        return 0.0
    tokens, other_tokens = _WORDS.findall(node.text), _WORDS.findall(other.text)
    ratio = SequenceMatcher(None, tokens, other_tokens, autojunk=False).ratio()
    if word == other_word:
        return 0.5 + 0.4 * ratio
    if node.kind != INSTRUCTION:
        return OTHER_BLOCK
    if len(tokens) > 1 and tokens[1:] == other_tokens[1:]:  # F(1, 80) to B(1, 80)
        return SAME_VALUES
    return FEW_WORDS if ratio >= 0.6 else NO_WORDS


def match_nodes(old_tree: Tree, new_tree: Tree) -> dict[str, str]:
    """Return the old id of each new one that has one."""
    old_ids = [id for id in old_tree.subtree_ids()[1:] if id != START]
    new_ids = [id for id in new_tree.subtree_ids()[1:] if id != START]
    matches = {ROOT: ROOT, START: START}
    shorter = min(len(old_ids), len(new_ids))
    prefix_length = 0
    while prefix_length < shorter and _are_equal(
        old_tree[old_ids[prefix_length]], new_tree[new_ids[prefix_length]]
    ):
        matches[new_ids[prefix_length]] = old_ids[prefix_length]
        prefix_length += 1
    suffix_length = 0
    while suffix_length < shorter - prefix_length and _are_equal(
        old_tree[old_ids[-1 - suffix_length]], new_tree[new_ids[-1 - suffix_length]]
    ):
        matches[new_ids[-1 - suffix_length]] = old_ids[-1 - suffix_length]
        suffix_length += 1
    old_middle = old_ids[prefix_length : len(old_ids) - suffix_length]
    new_middle = new_ids[prefix_length : len(new_ids) - suffix_length]
    matches.update((y, x) for x, y in _align(old_tree, new_tree, old_middle, new_middle))
    matched_ids = set(matches.values())
    _add_moved(
        old_tree,
        new_tree,
        [x for x in old_middle if x not in matched_ids],
        [y for y in new_middle if y not in matches],
        matches,
    )
    return matches


def _are_equal(node: Node, other: Node) -> bool:
    return similarity(node, other) == EQUAL


def _align(
    old_tree: Tree, new_tree: Tree, old_ids: list[str], new_ids: list[str]
) -> list[tuple[str, str]]:
    """Return pairs in the order of both, with the greatest total similarity."""
    if len(old_ids) * len(new_ids) > MAX_PAIRS:
        rows = [old_tree[x].text for x in old_ids], [new_tree[y].text for y in new_ids]
        blocks = SequenceMatcher(None, *rows, autojunk=False).get_matching_blocks()
        return [(old_ids[i + k], new_ids[j + k]) for i, j, size in blocks for k in range(size)]
    best_scores = [[0.0] * (len(new_ids) + 1) for _ in range(len(old_ids) + 1)]
    scores: dict[tuple[int, int], float] = {}
    for i in range(len(old_ids) - 1, -1, -1):
        scores_here, scores_below = best_scores[i], best_scores[i + 1]
        old_node = old_tree[old_ids[i]]
        for j in range(len(new_ids) - 1, -1, -1):
            scores[i, j] = score = similarity(old_node, new_tree[new_ids[j]])
            scores_here[j] = max(
                scores_below[j], scores_here[j + 1], scores_below[j + 1] + score if score else 0.0
            )
    pairs = []
    i = j = 0
    while i < len(old_ids) and j < len(new_ids):
        score = scores[i, j]
        if score and best_scores[i][j] == best_scores[i + 1][j + 1] + score:
            pairs.append((old_ids[i], new_ids[j]))
            i, j = i + 1, j + 1
        elif best_scores[i][j] == best_scores[i + 1][j]:
            i += 1
        else:
            j += 1
    # Two different rows are no pair if one of them has an equal one elsewhere, because it was
    # moved.
    old_texts, new_texts = {old_tree[x].text for x in old_ids}, {new_tree[y].text for y in new_ids}
    unmatched_old_texts = old_texts - {old_tree[x].text for x, _ in pairs}
    unmatched_new_texts = new_texts - {new_tree[y].text for _, y in pairs}
    return [
        (x, y) for x, y in pairs
        if old_tree[x].text == new_tree[y].text
        or not (new_tree[y].text in unmatched_old_texts or old_tree[x].text in unmatched_new_texts)
    ]  # fmt: skip


def _add_moved(
    old_tree: Tree, new_tree: Tree, old_ids: list[str], new_ids: list[str], matches: dict[str, str]
) -> None:
    """Add equal rows out of order: the longest runs first; then blocks by their content."""
    while old_ids and new_ids:
        rows = [old_tree[x].text for x in old_ids], [new_tree[y].text for y in new_ids]
        i, j, size = SequenceMatcher(None, *rows, autojunk=False).find_longest_match()
        if not size:
            break
        matches.update(zip(new_ids[j : j + size], old_ids[i : i + size], strict=True))
        del old_ids[i : i + size], new_ids[j : j + size]
    for y in list(new_ids):  # a block that was moved, and whose head was changed
        if new_tree[y].kind != BLOCK:
            continue
        inner_ids = [matches[z] for z in new_tree.subtree_ids(y)[1:] if z in matches]
        parents = [old_tree[x].parent for x in inner_ids if x in old_tree]
        x = max(parents, key=parents.count) if parents else ""
        if x in old_ids and similarity(old_tree[x], new_tree[y]) > 0:
            matches[y] = x
            old_ids.remove(x)
            new_ids.remove(y)


# -- the operations -------------------------------------------------------------------------------


class _Script:
    """Makes the operations one by one, each on the tree that those before have made."""

    def __init__(
        self,
        old_tree: Tree,
        new_tree: Tree,
        matches: dict[str, str],
        make_id: Callable[[], str],
        clipboard: Clipboard,
    ) -> None:
        self._old_tree, self._new_tree = old_tree, new_tree
        self._work = old_tree.copy()
        self._work_ids = dict(matches)  # id in the working tree, by id in the new tree
        self._make_id = make_id
        self._clipboard = clipboard
        self._pasted_ids: set[str] = set()  # ids of existing nodes that were pasted
        self._removed_ids: set[str] = set()
        self._operations: list[Operation] = []

    def make_operations(self) -> list[Operation]:
        self._delete_removed()
        self._arrange(ROOT)
        self._replace_fields()
        return self._operations

    def _apply(self, operation: Operation) -> None:
        apply_operation(self._work, operation, "")
        self._operations.append(operation)

    def _delete_removed(self) -> None:
        """Whole blocks and runs; of a block with something that stays, only the block."""
        old_tree, kept_ids = self._old_tree, set(self._work_ids.values())
        removed_ids = [id for id in old_tree.subtree_ids() if id not in kept_ids]
        whole_ids = {id for id in removed_ids if kept_ids.isdisjoint(old_tree.subtree_ids(id))}
        top_ids = [
            id for id in removed_ids if id in whole_ids and old_tree[id].parent not in whole_ids
        ]
        if top_ids:
            arms = [id for id in top_ids if old_tree[id].kind == ARM and old_tree.ids_of_arm(id)
                    and whole_ids.issuperset(old_tree.ids_of_arm(id))]  # fmt: skip
            self._apply(
                Delete(
                    tuple(inner_id for id in top_ids for inner_id in old_tree.subtree_ids(id)),
                    tuple(arms),
                )
            )
        for id in removed_ids:
            if id not in whole_ids:
                self._apply(Unwrap(id))
        self._removed_ids = set(removed_ids)

    def _choose_id(self, new_id: str) -> str:
        """Return an id for a new row: the one it had, if this page has cut it out lately."""
        for id in self._clipboard.ids_by_text.get(self._new_tree[new_id].text, ()):
            if (
                id in self._clipboard.restored_ids
                and id in self._work
                and id not in self._pasted_ids
            ):
                self._pasted_ids.add(id)
                return id
            is_used = id in self._work or id in self._work_ids.values() or id in self._removed_ids
            if not is_used:
                return id
        return self._make_id()

    def _make_subtree(
        self, new_id: str, with_children: bool = True, is_wrap: bool = False
    ) -> Subtree:
        node = self._new_tree[new_id]
        self._work_ids[new_id] = self._choose_id(new_id)
        if is_wrap and self._work_ids[new_id] in self._work:
            self._work_ids[new_id] = self._make_id()
        children = tuple(map(self._make_subtree, node.children)) if with_children else ()
        return Subtree(self._work_ids[new_id], node.text, node.note, node.apart, node.end, children)

    def _is_new(self, new_id: str) -> bool:
        return new_id not in self._work_ids

    def _are_all_new(self, new_id: str) -> bool:
        return all(map(self._is_new, self._new_tree.subtree_ids(new_id)))

    def _arrange(self, new_id: str) -> None:
        """Arrange the children of a block in order, and recursively theirs."""
        container = self._work_ids[new_id]
        wanted_ids = self._new_tree[new_id].children
        index_of_id = {id: k for k, id in enumerate(self._work[container].children)}
        staying_ids = _longest_increasing(
            [child for child in wanted_ids if self._work_ids.get(child) in index_of_id],
            lambda z: index_of_id[self._work_ids[z]],
        )
        previous_id = ""
        k = 0
        while k < len(wanted_ids):
            child = wanted_ids[k]
            place = Place(container, previous_id)
            if self._are_all_new(child):
                subtrees = []
                while k < len(wanted_ids) and self._are_all_new(wanted_ids[k]):
                    subtrees.append(self._make_subtree(wanted_ids[k]))
                    k += 1
                self._apply(Insert(place, tuple(subtrees)))
                previous_id = subtrees[-1].id
                continue
            if self._is_new(child):
                self._wrap_or_insert(child, place, wanted_ids)
                previous_id = self._work_ids[child]
            elif child in staying_ids and self._work[self._work_ids[child]].parent == container:
                previous_id = self._work_ids[child]
            else:
                run = [self._work_ids[child]]
                while k + 1 < len(wanted_ids) and self._goes_with(
                    run, wanted_ids[k + 1], staying_ids
                ):
                    k += 1
                    run.append(self._work_ids[wanted_ids[k]])
                self._apply(Move(tuple(run), place))
                previous_id = run[-1]
            k += 1
        for child in wanted_ids:
            if self._new_tree[child].kind == BLOCK:
                self._arrange(child)

    def _wrap_or_insert(self, new_id: str, place: Place, wanted_ids: list[str]) -> None:
        """Put a new block around its old content here, or insert it empty."""
        siblings = self._work[place.container].children
        inner_ids = {
            self._work_ids[child]
            for child in self._new_tree.subtree_ids(new_id)
            if not self._is_new(child)
        }
        wanted_work_ids = {self._work_ids.get(child) for child in wanted_ids}
        run: list[str] = []
        for id in siblings[siblings.index(place.previous_id) + 1 if place.previous_id else 0 :]:
            if id in inner_ids:
                run.append(id)
            elif run or id in wanted_work_ids:
                break
        if not run:
            self._apply(Insert(place, (self._make_subtree(new_id, with_children=False),)))
            return
        self._apply(Wrap(tuple(run), self._make_subtree(new_id, with_children=False, is_wrap=True)))
        if self._work.previous_sibling(self._work_ids[new_id]) != place.previous_id:
            self._apply(Move((self._work_ids[new_id],), place))

    def _goes_with(self, run: list[str], new_id: str, staying_ids: set[str]) -> bool:
        """Return whether the next node moves along, without nesting in the run or containing it."""
        if self._is_new(new_id) or new_id in staying_ids:
            return False
        id, work = self._work_ids[new_id], self._work
        return not any(work.is_in(run_id, id) or work.is_in(id, run_id) for run_id in run)

    def _replace_fields(self) -> None:
        spaced_ids = ids_after_empty_lines(self._work)
        new_spaced_ids = ids_after_empty_lines(self._new_tree)
        for new_id, id in self._work_ids.items():
            if id == ROOT or id not in self._work:
                continue
            node, new_node = self._work[id], self._new_tree[new_id]
            fields = [(name, getattr(new_node, name)) for name in (TEXT, COMMENT, END)
                      if getattr(node, name) != getattr(new_node, name)]  # fmt: skip
            if (id in spaced_ids) != (new_id in new_spaced_ids):
                fields.append((APART, new_id in new_spaced_ids))
            if fields:
                self._apply(Replace(id, tuple(fields)))


def _longest_increasing(items: list[str], position_of: Callable[[str], int]) -> set[str]:
    """Return the most items that can stay where they are."""
    tails: list[int] = []
    ends: list[int] = []
    predecessors: list[int] = []
    for k, item in enumerate(items):
        position = position_of(item)
        i = bisect_left(tails, position)
        predecessors.append(ends[i - 1] if i else -1)
        tails[i : i + 1] = [position]
        ends[i : i + 1] = [k]
    staying_ids = set()
    k = ends[-1] if ends else -1
    while k >= 0:
        staying_ids.add(items[k])
        k = predecessors[k]
    return staying_ids
