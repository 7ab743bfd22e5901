"""From a text to operations: what makes of a tree the program of a new text.

An id stays where a person would say "the same instruction". First the rows of both are laid beside
each other in their order, whatever block they are in (so a LOOP typed around lines changes none of
them); then what is left is looked for elsewhere (cut and paste), longest runs first; then the
operations are made from the outside in. Knows no page.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Callable, Collection, Mapping, Sequence
from difflib import SequenceMatcher
from typing import NamedTuple

from tiniscript.together.form import At, Delete, Insert, Move, Operation, Replace, Unwrap, Wrap
from tiniscript.together.layout import ids_after_empty_lines, read
from tiniscript.together.operations import do
from tiniscript.together.tree import (
    APART,
    ARM,
    BLOCK,
    COMMENT,
    DO,
    END,
    NOTE,
    ROOT,
    START,
    TEXT,
    Node,
    Part,
    Tree,
    first_word,
)

LARGE = 40_000  # pairs of rows; of more, only equal rows are laid beside each other
_SAME_KIND = {"LOOP": "round", "WHILE": "round", "TASK": "task", "WHEN": "task"}
_WORDS = re.compile(r"\w+|[^\w\s]")
# How alike two rows are, from 0, where they cannot be one instruction. Equal rows go first.
EQUAL, OTHER_NOTE, STARTS, SAME_VALUES, OTHER_BLOCK, FEW_WORDS, NO_WORDS = (
    3.0, 2.95, 0.9, 0.6, 0.3, 0.35, 0.2)  # fmt: skip


class CutOut(NamedTuple):
    """What a page has deleted: `lately` has ids by text. What is pasted gets its id back, also
    where it is there again since its delete was refused: then it is `uncut`, and moved."""

    lately: Mapping[str, list[str]]
    uncut: Collection[str]


NOTHING = CutOut({}, ())


def operations(
    old: Tree, text: str, new_id: Callable[[], str], cut: CutOut = NOTHING,
    owners: Sequence[str] | None = None,
) -> list[Operation]:  # fmt: skip
    """Return operations that make of `old` the program of a text. Raises Unparsed, Refused.

    `owners`: whose each line is, where that is known; what has none is new.
    """
    if owners is None:
        new = read(text)
        return _Script(old, new, same_nodes(old, new), new_id, cut).steps()
    places: dict[str, int] = {}
    new = read(text, places=places)
    found = {ROOT: ROOT, START: START}
    for id, line in places.items():
        owner = owners[line] if line < len(owners) else ""
        if owner in old and old[owner].kind == new[id].kind and owner not in found.values():
            found[id] = owner
    return _Script(old, new, found, new_id, cut).steps()


# -- which is which -------------------------------------------------------------------------------


def likeness(one: Node, other: Node) -> float:
    if one.kind != other.kind:
        return 0.0
    if one.text == other.text:
        return EQUAL if one.note == other.note else OTHER_NOTE
    if one.kind == START:
        return STARTS
    if one.kind == NOTE:
        ratio = SequenceMatcher(None, one.text, other.text, autojunk=False).ratio()
        return 0.3 + 0.6 * ratio if ratio > 0.5 else 0.0
    a, b = first_word(one.text), first_word(other.text)
    if one.kind == BLOCK and _SAME_KIND.get(a, a) != _SAME_KIND.get(b, b):
        return 0.0
    mine, yours = _WORDS.findall(one.text), _WORDS.findall(other.text)
    ratio = SequenceMatcher(None, mine, yours, autojunk=False).ratio()
    if a == b:
        return 0.5 + 0.4 * ratio
    if one.kind != DO:
        return OTHER_BLOCK
    if len(mine) > 1 and mine[1:] == yours[1:]:  # F(1, 80) to B(1, 80)
        return SAME_VALUES
    return FEW_WORDS if ratio >= 0.6 else NO_WORDS


def same_nodes(old: Tree, new: Tree) -> dict[str, str]:
    """Return the old id of each new one that has one."""
    mine = [id for id in old.below()[1:] if id != START]
    yours = [id for id in new.below()[1:] if id != START]
    found = {ROOT: ROOT, START: START}
    least = min(len(mine), len(yours))
    first = 0
    while first < least and _are_equal(old[mine[first]], new[yours[first]]):
        found[yours[first]] = mine[first]
        first += 1
    last = 0
    while last < least - first and _are_equal(old[mine[-1 - last]], new[yours[-1 - last]]):
        found[yours[-1 - last]] = mine[-1 - last]
        last += 1
    a, b = mine[first : len(mine) - last], yours[first : len(yours) - last]
    found.update((y, x) for x, y in _beside(old, new, a, b))
    taken = set(found.values())
    _add_moved(old, new, [x for x in a if x not in taken], [y for y in b if y not in found], found)
    return found


def _are_equal(one: Node, other: Node) -> bool:
    return likeness(one, other) == EQUAL


def _beside(old: Tree, new: Tree, a: list[str], b: list[str]) -> list[tuple[str, str]]:
    """Return pairs in the order of both, which together are as alike as possible."""
    if len(a) * len(b) > LARGE:
        rows = [old[x].text for x in a], [new[y].text for y in b]
        blocks = SequenceMatcher(None, *rows, autojunk=False).get_matching_blocks()
        return [(a[i + k], b[j + k]) for i, j, size in blocks for k in range(size)]
    best = [[0.0] * (len(b) + 1) for _ in range(len(a) + 1)]
    like: dict[tuple[int, int], float] = {}
    for i in range(len(a) - 1, -1, -1):
        row, below = best[i], best[i + 1]
        one = old[a[i]]
        for j in range(len(b) - 1, -1, -1):
            like[i, j] = score = likeness(one, new[b[j]])
            row[j] = max(below[j], row[j + 1], below[j + 1] + score if score else 0.0)
    found = []
    i = j = 0
    while i < len(a) and j < len(b):
        score = like[i, j]
        if score and best[i][j] == best[i + 1][j + 1] + score:
            found.append((a[i], b[j]))
            i, j = i + 1, j + 1
        elif best[i][j] == best[i + 1][j]:
            i += 1
        else:
            j += 1
    # Two that differ, and one of which has an equal one elsewhere, are none: one was moved.
    texts, new_texts = {old[x].text for x in a}, {new[y].text for y in b}
    lonely = texts - {old[x].text for x, _ in found}
    new_lonely = new_texts - {new[y].text for _, y in found}
    return [
        (x, y) for x, y in found
        if old[x].text == new[y].text
        or not (new[y].text in lonely or old[x].text in new_lonely)
    ]  # fmt: skip


def _add_moved(old: Tree, new: Tree, a: list[str], b: list[str], found: dict[str, str]) -> None:
    """Add equal rows out of order: the longest runs first; then blocks by what is in them."""
    while a and b:
        rows = [old[x].text for x in a], [new[y].text for y in b]
        i, j, size = SequenceMatcher(None, *rows, autojunk=False).find_longest_match()
        if not size:
            break
        found.update(zip(b[j : j + size], a[i : i + size], strict=True))
        del a[i : i + size], b[j : j + size]
    for y in list(b):  # a block that was moved, and whose head was changed
        if new[y].kind != BLOCK:
            continue
        inside = [found[z] for z in new.below(y)[1:] if z in found]
        around = [old[x].parent for x in inside if x in old]
        x = max(around, key=around.count) if around else ""
        if x in a and likeness(old[x], new[y]) > 0:
            found[y] = x
            a.remove(x)
            b.remove(y)


# -- the operations -------------------------------------------------------------------------------


class _Script:
    """Makes the operations one by one, each on the tree that those before have made."""

    def __init__(
        self, old: Tree, new: Tree, same: dict[str, str], new_id: Callable[[], str], cut: CutOut
    ) -> None:
        self._old, self._new = old, new
        self._work = old.copy()
        self._name = dict(same)  # in the tree that is made, by the id in the new one
        self._new_id = new_id
        self._cut = cut
        self._again: set[str] = set()  # ids of what is still there, and was pasted
        self._gone: set[str] = set()
        self._made: list[Operation] = []

    def steps(self) -> list[Operation]:
        self._take_away()
        self._arrange(ROOT)
        self._replace_fields()
        return self._made

    def _do(self, operation: Operation) -> None:
        do(self._work, operation, "")
        self._made.append(operation)

    def _take_away(self) -> None:
        """Whole blocks and runs; of a block with something that stays, only the block."""
        old, kept = self._old, set(self._name.values())
        gone = [id for id in old.below() if id not in kept]
        whole = {id for id in gone if kept.isdisjoint(old.below(id))}
        tops = [id for id in gone if id in whole and old[id].parent not in whole]
        if tops:
            arms = [id for id in tops if old[id].kind == ARM and old.of_arm(id)
                    and whole.issuperset(old.of_arm(id))]  # fmt: skip
            self._do(Delete(tuple(each for id in tops for each in old.below(id)), tuple(arms)))
        for id in gone:
            if id not in whole:
                self._do(Unwrap(id))
        self._gone = set(gone)

    def _given(self, y: str) -> str:
        """Return an id for a new row: the one it had, if this page has cut it out lately."""
        for id in self._cut.lately.get(self._new[y].text, ()):
            if id in self._cut.uncut and id in self._work and id not in self._again:
                self._again.add(id)
                return id
            is_used = id in self._work or id in self._name.values() or id in self._gone
            if not is_used:
                return id
        return self._new_id()

    def _part(self, y: str, is_whole: bool = True, is_wrap: bool = False) -> Part:
        node = self._new[y]
        self._name[y] = self._given(y)
        if is_wrap and self._name[y] in self._work:
            self._name[y] = self._new_id()
        inside = tuple(map(self._part, node.inside)) if is_whole else ()
        return Part(self._name[y], node.text, node.note, node.apart, node.end, inside)

    def _is_new(self, y: str) -> bool:
        return y not in self._name

    def _are_all_new(self, y: str) -> bool:
        return all(map(self._is_new, self._new.below(y)))

    def _arrange(self, y: str) -> None:
        """Give a block what is in it, in its order; then each block in it."""
        container = self._name[y]
        wanted = self._new[y].inside
        here = {id: k for k, id in enumerate(self._work[container].inside)}
        stay = _longest_rise([z for z in wanted if self._name.get(z) in here],
                             lambda z: here[self._name[z]])  # fmt: skip
        behind = ""
        k = 0
        while k < len(wanted):
            z = wanted[k]
            at = At(container, behind)
            if self._are_all_new(z):
                nodes = []
                while k < len(wanted) and self._are_all_new(wanted[k]):
                    nodes.append(self._part(wanted[k]))
                    k += 1
                self._do(Insert(at, tuple(nodes)))
                behind = nodes[-1].id
                continue
            if self._is_new(z):
                self._put_around(z, at, wanted)
                behind = self._name[z]
            elif z in stay and self._work[self._name[z]].parent == container:
                behind = self._name[z]
            else:
                run = [self._name[z]]
                while k + 1 < len(wanted) and self._goes_with(run, wanted[k + 1], stay):
                    k += 1
                    run.append(self._name[wanted[k]])
                self._do(Move(tuple(run), at))
                behind = run[-1]
            k += 1
        for z in wanted:
            if self._new[z].kind == BLOCK:
                self._arrange(z)

    def _put_around(self, z: str, at: At, wanted: list[str]) -> None:
        """Put a new block around what there was of it here; else put it in, empty."""
        siblings = self._work[at.container].inside
        inner = {self._name[each] for each in self._new.below(z) if not self._is_new(each)}
        all_wanted = {self._name.get(each) for each in wanted}
        run: list[str] = []
        for id in siblings[siblings.index(at.behind) + 1 if at.behind else 0 :]:
            if id in inner:
                run.append(id)
            elif run or id in all_wanted:
                break
        if not run:
            self._do(Insert(at, (self._part(z, is_whole=False),)))
            return
        self._do(Wrap(tuple(run), self._part(z, is_whole=False, is_wrap=True)))
        if self._work.behind(self._name[z]) != at.behind:
            self._do(Move((self._name[z],), at))

    def _goes_with(self, run: list[str], z: str, stay: set[str]) -> bool:
        """Whether the next one is moved, too, and is in none of a run, nor the other way round."""
        if self._is_new(z) or z in stay:
            return False
        id, work = self._name[z], self._work
        return not any(work.is_in(each, id) or work.is_in(id, each) for each in run)

    def _replace_fields(self) -> None:
        seen, seen_new = ids_after_empty_lines(self._work), ids_after_empty_lines(self._new)
        for y, id in self._name.items():
            if id == ROOT or id not in self._work:
                continue
            one, other = self._work[id], self._new[y]
            fields = [(name, getattr(other, name)) for name in (TEXT, COMMENT, END)
                      if getattr(one, name) != getattr(other, name)]  # fmt: skip
            if (id in seen) != (y in seen_new):
                fields.append((APART, y in seen_new))
            if fields:
                self._do(Replace(id, tuple(fields)))


def _longest_rise(items: list[str], place: Callable[[str], int]) -> set[str]:
    """Return the most items that can stay where they are."""
    tails: list[int] = []
    ends: list[int] = []
    before: list[int] = []
    for k, item in enumerate(items):
        at = place(item)
        i = bisect_left(tails, at)
        before.append(ends[i - 1] if i else -1)
        tails[i : i + 1] = [at]
        ends[i : i + 1] = [k]
    found = set()
    k = ends[-1] if ends else -1
    while k >= 0:
        found.add(items[k])
        k = before[k]
    return found
