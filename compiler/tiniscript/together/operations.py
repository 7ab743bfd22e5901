"""What an operation does to a tree, where what it names may have moved or gone meanwhile.

A place whose neighbour has gone is where that stood. A delete lists all that it deletes, so it
deletes nothing that its author has not seen. What is inserted and is still there is moved, never
doubled. Of two changes of one field the later one wins whole.
"""

from __future__ import annotations

from typing import NamedTuple

from tiniscript.together.form import (
    BAD,
    CHANGED,
    CIRCLE,
    DEEPEST,
    HAS_NEW,
    IS_GONE,
    TOO_LONG,
    UNPARSED,
    At,
    Change,
    Condition,
    Delete,
    Insert,
    Move,
    Operation,
    Refused,
    Replace,
    Unwrap,
    Wrap,
)
from tiniscript.together.layout import Unparsed, read, text_of
from tiniscript.together.tree import (
    ARM,
    BLOCK,
    COMMENT,
    PLACE,
    ROOT,
    START,
    TEXT,
    Gone,
    Part,
    Tree,
    kind_of,
)

MOST_CHARACTERS = 20_000  # of a program

_Both = tuple[list[Operation], list[Operation]]  # what was done exactly, and what takes it back


class Applied(NamedTuple):
    """The tree after a change, what was done exactly, and what takes it back."""

    tree: Tree
    done: tuple[Operation, ...]
    back: tuple[Operation, ...]


def applied(tree: Tree, change: Change, is_sure: bool = False) -> Applied:
    """Return what comes of a change. Raises Refused.

    `is_sure`: it was taken elsewhere, after the same changes, and is not parsed again.
    """
    if not do_hold(tree, change.conditions):
        raise Refused(CHANGED)
    new = tree.copy()
    done: list[Operation] = []
    back: list[Operation] = []
    for operation in change.operations:
        was_done, takes_back = do(new, operation, change.uid)
        done += was_done
        back[:0] = takes_back
    new.limit_gone()
    if not is_sure:
        _check(new)
    return Applied(new, tuple(done), tuple(back))


def do(tree: Tree, operation: Operation, uid: str) -> _Both:
    """Apply an operation to a tree of one's own. Raises Refused: then the tree is of no use."""
    if isinstance(operation, Insert):
        return _insert(tree, operation, uid)
    if isinstance(operation, Delete):
        return _delete(tree, operation)
    if isinstance(operation, Move):
        return _move(tree, operation, uid)
    if isinstance(operation, Wrap):
        return _wrap(tree, operation, uid)
    if isinstance(operation, Unwrap):
        return _unwrap(tree, operation)
    return _replace(tree, operation, uid)


def do_hold(tree: Tree, conditions: tuple[Condition, ...]) -> bool:
    return all(id in tree and tree[id].mark(name) == uid for id, name, uid in conditions)


def conditions(tree: Tree, back: tuple[Operation, ...]) -> tuple[Condition, ...]:
    """Return what must still be so that `back` takes back the change that has made this tree."""
    found: list[Condition] = []
    for each in back:
        if isinstance(each, Replace):
            found += [Condition(each.id, name, tree[each.id].mark(name)) for name, _ in each.fields]
        elif isinstance(each, Move):
            found += [Condition(id, PLACE, tree[id].mark(PLACE)) for id in each.ids]
        elif isinstance(each, Delete | Unwrap):
            ids = each.ids if isinstance(each, Delete) else (each.id,)
            found += [Condition(id, name, tree[id].mark(name))
                      for id in ids if id in tree for name in (TEXT, COMMENT)]  # fmt: skip
    return tuple(dict.fromkeys(found))


def _check(tree: Tree) -> None:
    """The text must parse, and say the same tree again."""
    if _depth(tree) > DEEPEST:
        raise Refused(BAD)
    text = text_of(tree)
    if len(text) > MOST_CHARACTERS:
        raise Refused(TOO_LONG)
    try:
        again = read(text, is_laid_out=True)
    except Unparsed:
        raise Refused(UNPARSED) from None
    if again.shape() != tree.shape():
        raise Refused(BAD)


def _depth(tree: Tree) -> int:
    """Return how many nodes are around the one that most are around."""
    deepest, here = 0, [ROOT]
    while here := [each for id in here for each in tree[id].inside]:
        deepest += 1
    return deepest


def _place(tree: Tree, at: At, moving: frozenset[str] = frozenset()) -> At:
    """Return a place as it is now. Raises Refused."""
    container, behind = at
    for _ in range(len(tree.gone) + len(tree.nodes) + 2):
        if behind in moving and behind in tree:
            container, behind = tree[behind].parent, tree.behind(behind)
        elif behind and behind in tree:
            return At(tree[behind].parent, behind)
        elif behind:  # has gone: where it was
            if behind not in tree.gone:
                raise Refused(IS_GONE)
            container, behind, _ = tree.gone[behind]
        elif container in tree:
            return At(container, "")
        elif container in tree.gone and not tree.gone[container].is_deleted:  # where it began
            container, behind, _ = tree.gone[container]
        else:
            break
    raise Refused(IS_GONE)


def _block_at(tree: Tree, at: At, moving: frozenset[str] = frozenset()) -> At:
    """Return a place in a block as it is now. Raises Refused."""
    found = _place(tree, at, moving)
    if tree[found.container].kind != BLOCK:
        raise Refused(BAD)
    return found


def _insert(tree: Tree, operation: Insert, uid: str) -> _Both:
    ids = [id for each in operation.nodes for id in each.ids()]
    if any(id in tree for id in ids):
        return _insert_again(tree, operation, uid)
    at = _block_at(tree, operation.at)
    for each in operation.nodes:
        if not _is_sound(each):
            raise Refused(BAD)
        tree.add(each, at.container, uid)
    tree.put([each.id for each in operation.nodes], *at)
    for id in ids:
        tree.gone.pop(id, None)
    arms = tuple(id for id in ids if tree[id].kind == ARM and tree.of_arm(id)
                 and set(tree.of_arm(id)) <= set(ids))  # fmt: skip
    return [Insert(at, operation.nodes)], [Delete(tuple(ids), arms)]


def _is_sound(part: Part) -> bool:
    """Whether a node says something, and only a block has others in it."""
    is_block = kind_of(part.text) == BLOCK
    return (
        bool(part.text)
        and (is_block or not (part.inside or part.end))
        and all(map(_is_sound, part.inside))
    )


def _insert_again(tree: Tree, operation: Insert, uid: str) -> _Both:
    """Some of it is there: its delete was refused or taken back, or somebody has pasted it, too.
    That is moved here, with all that is in it."""
    done: list[Operation] = []
    back: list[Operation] = []
    at = operation.at
    for each in operation.nodes:
        if each.id in tree:
            both = _move(tree, Move((each.id,), at), uid)
        else:
            both = _insert(tree, Insert(at, (each._replace(inside=()),)), uid)
        steps = [both]
        if each.inside:
            steps.append(_insert_again(tree, Insert(At(each.id, ""), each.inside), uid))
        for was_done, takes_back in steps:
            done += was_done
            back[:0] = takes_back
        at = At(tree[each.id].parent, each.id)
    return done, back


def _delete(tree: Tree, operation: Delete) -> _Both:
    listed = set(operation.ids) - {ROOT, START}
    alive = [id for id in operation.ids if id in tree and id in listed]
    if not alive:  # somebody was faster, with the same wish
        return [], []
    if any(each not in listed for id in alive for each in tree[id].inside):
        raise Refused(HAS_NEW)
    for arm in operation.arms:
        if arm in tree and tree[arm].kind == ARM and not listed.issuperset(tree.of_arm(arm)):
            raise Refused(HAS_NEW)
    tops = {id for id in alive if tree[id].parent not in listed}
    runs: list[list[str]] = []  # of neighbours: they come back together
    for id in tree.below():
        if id not in tops:
            continue
        if runs and runs[-1][-1] == tree.behind(id) and tree[id].parent == tree[runs[-1][0]].parent:
            runs[-1].append(id)
        else:
            runs.append([id])
    back: list[Operation] = [
        Insert(At(tree[run[0]].parent, tree.behind(run[0])), tuple(map(tree.part, run)))
        for run in runs
    ]
    for run in runs:
        for id in run:
            below = tree.below(id)
            were = [Gone(tree[each].parent, tree.behind(each), True) for each in below]
            tree[tree[id].parent].inside.remove(id)
            for each, was in zip(below[1:] + below[:1], were[1:] + were[:1], strict=True):
                tree.forget(each, was)
    return [Delete(tuple(alive))], back


def _move(tree: Tree, operation: Move, uid: str) -> _Both:
    alive = [id for id in operation.ids if id in tree and id != ROOT]
    if not alive:
        raise Refused(IS_GONE)
    ids = [id for id in alive if not any(id != each and tree.is_in(id, each) for each in alive)]
    at = _block_at(tree, operation.at, frozenset(ids))
    if any(tree.is_in(at.container, id) for id in ids):
        raise Refused(CIRCLE)
    if START in ids and at.container != ROOT:
        raise Refused(UNPARSED)
    marks = dict(operation.marks)
    back: list[Operation] = []
    behind = at.behind
    for id in ids:
        was = At(tree[id].parent, tree.behind(id))
        back.insert(0, Move((id,), was, ((id, tree[id].mark(PLACE)),)))
        tree[was.container].inside.remove(id)
        tree.put([id], at.container, behind)
        tree[id].marks[PLACE] = marks.get(id, uid)
        behind = id
    return [Move(tuple(ids), At(at.container, tree.behind(ids[0])), operation.marks)], back


def _wrap(tree: Tree, operation: Wrap, uid: str) -> _Both:
    node = operation.node
    alive = [id for id in operation.ids if id in tree and id != ROOT]
    if node.id in tree or node.inside or kind_of(node.text) != BLOCK:
        raise Refused(BAD)
    if not alive:
        raise Refused(IS_GONE)
    places = [tree[id].parent for id in alive]
    container = max(places, key=places.count)
    siblings = tree[container].inside
    inside = [siblings.index(id) for id in alive if tree[id].parent == container]
    first, last = min(inside), max(inside)
    ids = siblings[first : last + 1]  # what somebody has put between comes in, too
    if START in ids:
        raise Refused(UNPARSED)
    made = tree.add(node, container, uid)
    siblings[first : last + 1] = [made.id]
    made.inside = ids
    for id in ids:
        tree[id].parent = made.id
    tree.gone.pop(made.id, None)
    return [Wrap(tuple(ids), node)], [Unwrap(made.id)]


def _unwrap(tree: Tree, operation: Unwrap) -> _Both:
    id = operation.id
    if id not in tree:
        raise Refused(IS_GONE)
    node = tree[id]
    if node.kind != BLOCK or id == ROOT:
        raise Refused(BAD)
    at, part = At(node.parent, tree.behind(id)), tree.part(id, is_whole=False)
    siblings = tree[node.parent].inside
    k = siblings.index(id)
    siblings[k : k + 1] = node.inside
    for each in node.inside:
        tree[each].parent = node.parent
    tree.forget(id, Gone(*at, False))
    back = Wrap(tuple(node.inside), part) if node.inside else Insert(at, (part,))
    return [operation], [back]


def _replace(tree: Tree, operation: Replace, uid: str) -> _Both:
    id = operation.id
    if id not in tree or id == ROOT:
        raise Refused(IS_GONE)
    node, marks = tree[id], dict(operation.marks)
    were, had = [], []
    for name, value in operation.fields:
        if name == TEXT and id != START and (not value or kind_of(value) != node.kind):
            raise Refused(BAD)
        were.append((name, getattr(node, name)))
        had.append((name, node.mark(name)))
        setattr(node, name, value)
        node.marks[name] = marks.get(name, uid)
    return [operation], [Replace(id, tuple(were), tuple(had))]
