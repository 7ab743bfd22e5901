"""The effect of an operation on a tree in which its nodes may have moved or gone.

A place whose neighbour has gone is where that stood. A delete lists all that it deletes, so it
deletes nothing that its author has not seen. Inserting a node that still exists moves it and never
duplicates it. Of two changes to one field, the later one wins completely.
"""

from __future__ import annotations

from typing import NamedTuple

from tiniscript.together.form import (
    BAD,
    CHANGED,
    CIRCLE,
    HAS_NEW,
    IS_GONE,
    MAX_DEPTH,
    TOO_LONG,
    UNPARSED,
    Change,
    Condition,
    Delete,
    Insert,
    Move,
    Operation,
    Place,
    Refused,
    Replace,
    Unwrap,
    Wrap,
)
from tiniscript.together.layout import Unparsed, parse_tree, text_of
from tiniscript.together.tree import (
    ARM,
    BLOCK,
    COMMENT,
    PLACE,
    ROOT,
    START,
    TEXT,
    FormerPlace,
    Subtree,
    Tree,
    kind_of,
)

MAX_CHARACTERS = 20_000  # most characters of a program

# The operations applied, and those that undo them.
_Effect = tuple[list[Operation], list[Operation]]


class ChangeResult(NamedTuple):
    """The tree after a change, the operations applied, and those that undo it."""

    tree: Tree
    operations: tuple[Operation, ...]
    inverse: tuple[Operation, ...]


def apply_change(tree: Tree, change: Change, is_sure: bool = False) -> ChangeResult:
    """Return the effect of a change. Raises Refused.

    `is_sure`: it was taken elsewhere, after the same changes, and is not parsed again.
    """
    if not conditions_hold(tree, change.conditions):
        raise Refused(CHANGED)
    new_tree = tree.copy()
    operations: list[Operation] = []
    inverse: list[Operation] = []
    for operation in change.operations:
        step_operations, step_inverse = apply_operation(new_tree, operation, change.uid)
        operations += step_operations
        inverse[:0] = step_inverse
    new_tree.limit_former_places()
    if not is_sure:
        _check_text(new_tree)
    return ChangeResult(new_tree, tuple(operations), tuple(inverse))


def apply_operation(tree: Tree, operation: Operation, uid: str) -> _Effect:
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


def conditions_hold(tree: Tree, conditions: tuple[Condition, ...]) -> bool:
    return all(id in tree and tree[id].mark(name) == uid for id, name, uid in conditions)


def inverse_conditions(tree: Tree, inverse: tuple[Operation, ...]) -> tuple[Condition, ...]:
    """Return the conditions under which `inverse` undoes the change that led to this tree."""
    found_conditions: list[Condition] = []
    for operation in inverse:
        if isinstance(operation, Replace):
            found_conditions += [
                Condition(operation.id, name, tree[operation.id].mark(name))
                for name, _ in operation.fields
            ]
        elif isinstance(operation, Move):
            found_conditions += [Condition(id, PLACE, tree[id].mark(PLACE)) for id in operation.ids]
        elif isinstance(operation, Delete | Unwrap):
            ids = operation.ids if isinstance(operation, Delete) else (operation.id,)
            found_conditions += [Condition(id, name, tree[id].mark(name))
                      for id in ids if id in tree for name in (TEXT, COMMENT)]  # fmt: skip
    return tuple(dict.fromkeys(found_conditions))


def _check_text(tree: Tree) -> None:
    """The text must parse, and say the same tree again."""
    if _depth(tree) > MAX_DEPTH:
        raise Refused(BAD)
    text = text_of(tree)
    if len(text) > MAX_CHARACTERS:
        raise Refused(TOO_LONG)
    try:
        parsed_tree = parse_tree(text, is_laid_out=True)
    except Unparsed:
        raise Refused(UNPARSED) from None
    if parsed_tree.shape() != tree.shape():
        raise Refused(BAD)


def _depth(tree: Tree) -> int:
    """Return the depth of the most deeply nested node."""
    depth, level = 0, [ROOT]
    while level := [child for id in level for child in tree[id].children]:
        depth += 1
    return depth


def _current_place(tree: Tree, place: Place, moving_ids: frozenset[str] = frozenset()) -> Place:
    """Return a place as it is now. Raises Refused."""
    container, previous_id = place
    for _ in range(len(tree.former_place_by_id) + len(tree.node_by_id) + 2):
        if previous_id in moving_ids and previous_id in tree:
            container, previous_id = tree[previous_id].parent, tree.previous_sibling(previous_id)
        elif previous_id and previous_id in tree:
            return Place(tree[previous_id].parent, previous_id)
        elif previous_id:  # it has been removed: use its old place
            if previous_id not in tree.former_place_by_id:
                raise Refused(IS_GONE)
            container, previous_id, _ = tree.former_place_by_id[previous_id]
        elif container in tree:
            return Place(container, "")
        elif (
            container in tree.former_place_by_id
            and not tree.former_place_by_id[container].is_deleted
        ):  # its original place
            container, previous_id, _ = tree.former_place_by_id[container]
        else:
            break
    raise Refused(IS_GONE)


def _block_at(tree: Tree, place: Place, moving_ids: frozenset[str] = frozenset()) -> Place:
    """Return a place in a block as it is now. Raises Refused."""
    current_place = _current_place(tree, place, moving_ids)
    if tree[current_place.container].kind != BLOCK:
        raise Refused(BAD)
    return current_place


def _insert(tree: Tree, operation: Insert, uid: str) -> _Effect:
    ids = [id for node in operation.nodes for id in node.ids()]
    if any(id in tree for id in ids):
        return _insert_again(tree, operation, uid)
    place = _block_at(tree, operation.place)
    for node in operation.nodes:
        if not _is_sound(node):
            raise Refused(BAD)
        tree.add(node, place.container, uid)
    tree.put([node.id for node in operation.nodes], *place)
    for id in ids:
        tree.former_place_by_id.pop(id, None)
    arms = tuple(id for id in ids if tree[id].kind == ARM and tree.ids_of_arm(id)
                 and set(tree.ids_of_arm(id)) <= set(ids))  # fmt: skip
    return [Insert(place, operation.nodes)], [Delete(tuple(ids), arms)]


def _is_sound(subtree: Subtree) -> bool:
    """Return whether a node has content, and only blocks have children."""
    is_block = kind_of(subtree.text) == BLOCK
    return (
        bool(subtree.text)
        and (is_block or not (subtree.children or subtree.end))
        and all(map(_is_sound, subtree.children))
    )


def _insert_again(tree: Tree, operation: Insert, uid: str) -> _Effect:
    """Some of it is there: its delete was refused or taken back, or somebody has pasted it, too.
    Such a node is moved here, with its content."""
    operations: list[Operation] = []
    inverse: list[Operation] = []
    place = operation.place
    for node in operation.nodes:
        if node.id in tree:
            effect = _move(tree, Move((node.id,), place), uid)
        else:
            effect = _insert(tree, Insert(place, (node._replace(children=()),)), uid)
        effects = [effect]
        if node.children:
            effects.append(_insert_again(tree, Insert(Place(node.id, ""), node.children), uid))
        for step_operations, step_inverse in effects:
            operations += step_operations
            inverse[:0] = step_inverse
        place = Place(tree[node.id].parent, node.id)
    return operations, inverse


def _delete(tree: Tree, operation: Delete) -> _Effect:
    listed_ids = set(operation.ids) - {ROOT, START}
    present_ids = [id for id in operation.ids if id in tree and id in listed_ids]
    if not present_ids:  # another member had the same idea earlier
        return [], []
    if any(child not in listed_ids for id in present_ids for child in tree[id].children):
        raise Refused(HAS_NEW)
    for arm in operation.arms:
        if (
            arm in tree
            and tree[arm].kind == ARM
            and not listed_ids.issuperset(tree.ids_of_arm(arm))
        ):
            raise Refused(HAS_NEW)
    top_ids = {id for id in present_ids if tree[id].parent not in listed_ids}
    runs: list[list[str]] = []  # neighbours that return together
    for id in tree.subtree_ids():
        if id not in top_ids:
            continue
        if (
            runs
            and runs[-1][-1] == tree.previous_sibling(id)
            and tree[id].parent == tree[runs[-1][0]].parent
        ):
            runs[-1].append(id)
        else:
            runs.append([id])
    inverse: list[Operation] = [
        Insert(
            Place(tree[run[0]].parent, tree.previous_sibling(run[0])), tuple(map(tree.subtree, run))
        )
        for run in runs
    ]
    for run in runs:
        for id in run:
            ids_below = tree.subtree_ids(id)
            former_places = [
                FormerPlace(tree[child].parent, tree.previous_sibling(child), True)
                for child in ids_below
            ]
            tree[tree[id].parent].children.remove(id)
            for child, former_place in zip(
                ids_below[1:] + ids_below[:1], former_places[1:] + former_places[:1], strict=True
            ):
                tree.forget(child, former_place)
    return [Delete(tuple(present_ids))], inverse


def _move(tree: Tree, operation: Move, uid: str) -> _Effect:
    present_ids = [id for id in operation.ids if id in tree and id != ROOT]
    if not present_ids:
        raise Refused(IS_GONE)
    ids = [
        id
        for id in present_ids
        if not any(id != other and tree.is_in(id, other) for other in present_ids)
    ]
    place = _block_at(tree, operation.place, frozenset(ids))
    if any(tree.is_in(place.container, id) for id in ids):
        raise Refused(CIRCLE)
    if START in ids and place.container != ROOT:
        raise Refused(UNPARSED)
    marks = dict(operation.marks)
    inverse: list[Operation] = []
    previous_id = place.previous_id
    for id in ids:
        old_place = Place(tree[id].parent, tree.previous_sibling(id))
        inverse.insert(0, Move((id,), old_place, ((id, tree[id].mark(PLACE)),)))
        tree[old_place.container].children.remove(id)
        tree.put([id], place.container, previous_id)
        tree[id].marks[PLACE] = marks.get(id, uid)
        previous_id = id
    return [
        Move(tuple(ids), Place(place.container, tree.previous_sibling(ids[0])), operation.marks)
    ], inverse


def _wrap(tree: Tree, operation: Wrap, uid: str) -> _Effect:
    node = operation.node
    present_ids = [id for id in operation.ids if id in tree and id != ROOT]
    if node.id in tree or node.children or kind_of(node.text) != BLOCK:
        raise Refused(BAD)
    if not present_ids:
        raise Refused(IS_GONE)
    parents = [tree[id].parent for id in present_ids]
    container = max(parents, key=parents.count)
    siblings = tree[container].children
    indexes = [siblings.index(id) for id in present_ids if tree[id].parent == container]
    first_index, last_index = min(indexes), max(indexes)
    ids = siblings[first_index : last_index + 1]  # includes what others have inserted between them
    if START in ids:
        raise Refused(UNPARSED)
    block = tree.add(node, container, uid)
    siblings[first_index : last_index + 1] = [block.id]
    block.children = ids
    for id in ids:
        tree[id].parent = block.id
    tree.former_place_by_id.pop(block.id, None)
    return [Wrap(tuple(ids), node)], [Unwrap(block.id)]


def _unwrap(tree: Tree, operation: Unwrap) -> _Effect:
    id = operation.id
    if id not in tree:
        raise Refused(IS_GONE)
    node = tree[id]
    if node.kind != BLOCK or id == ROOT:
        raise Refused(BAD)
    place = Place(node.parent, tree.previous_sibling(id))
    subtree = tree.subtree(id, with_children=False)
    siblings = tree[node.parent].children
    k = siblings.index(id)
    siblings[k : k + 1] = node.children
    for child in node.children:
        tree[child].parent = node.parent
    tree.forget(id, FormerPlace(*place, False))
    inverse = Wrap(tuple(node.children), subtree) if node.children else Insert(place, (subtree,))
    return [operation], [inverse]


def _replace(tree: Tree, operation: Replace, uid: str) -> _Effect:
    id = operation.id
    if id not in tree or id == ROOT:
        raise Refused(IS_GONE)
    node, marks = tree[id], dict(operation.marks)
    old_fields, old_marks = [], []
    for name, value in operation.fields:
        if name == TEXT and id != START and (not value or kind_of(value) != node.kind):
            raise Refused(BAD)
        old_fields.append((name, getattr(node, name)))
        old_marks.append((name, node.mark(name)))
        setattr(node, name, value)
        node.marks[name] = marks.get(name, uid)
    return [operation], [Replace(id, tuple(old_fields), tuple(old_marks))]
