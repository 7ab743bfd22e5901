"""Operations and changes, and their form in JSON: what comes from elsewhere is checked here.

    {"do": "insert", "at": [container, previous], "nodes": [...]}  `previous` "": the first
    {"do": "delete", "ids": [...], "arms": [...]}     all ids of what goes; arms go with all of them
    {"do": "move", "ids": [...], "at": [container, previous]}
    {"do": "wrap", "ids": [...], "node": {...}}                  a new block around siblings
    {"do": "unwrap", "id": id}                                   what is in the block stays
    {"do": "replace", "id": id, "text": ..., "note": ...}        fields as a whole

A change has one or more of them and is taken or refused whole. Its conditions say of which change a
field, or a place, must still be: so an undo takes back what nobody has changed since. Knows no tree
that a program is in.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any, NamedTuple

from tiniscript.together.tree import (
    APART,
    COMMENT,
    END,
    FIELDS,
    PLACE,
    ROOT,
    START,
    TEXT,
    FormerPlace,
    Json,
    Subtree,
    Tree,
)

# Why a change was refused.
IS_GONE, HAS_NEW, CIRCLE, CHANGED, UNPARSED, TOO_LONG, BAD = (
    "gone", "has_new", "circle", "changed", "unparsed", "too_long", "bad")  # fmt: skip

MAX_OPERATIONS = 200  # most operations in a change
MAX_IDS = 2000  # most ids in an operation, such as deleting a whole program
MAX_CHARACTERS = 2000  # most characters of an instruction or a comment
MAX_DEPTH = 40
_ID = re.compile(r"[a-z0-9]{1,12}[.:][0-9]{1,9}|root|start")  # id of a node or a change


class Refused(Exception):
    """A change does not apply, or leaves no program."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason = reason


class Place(NamedTuple):
    """After which sibling, `previous_id`; if it was removed, its former place counts."""

    container: str
    previous_id: str


class Insert(NamedTuple):
    place: Place
    nodes: tuple[Subtree, ...]


class Delete(NamedTuple):
    ids: tuple[str, ...]
    arms: tuple[str, ...] = ()


class Move(NamedTuple):
    """`marks`: marks that an undo restores, with the change of the place."""

    ids: tuple[str, ...]
    place: Place
    marks: tuple[tuple[str, str], ...] = ()


class Wrap(NamedTuple):
    ids: tuple[str, ...]
    node: Subtree


class Unwrap(NamedTuple):
    id: str


class Replace(NamedTuple):
    """`fields` has a field's new value; `marks`: see Move."""

    id: str
    fields: tuple[tuple[str, Any], ...]
    marks: tuple[tuple[str, str], ...] = ()


Operation = Insert | Delete | Move | Wrap | Unwrap | Replace


class Condition(NamedTuple):
    """A field of a node, or its place, is of this change."""

    id: str
    name: str
    uid: str


class Change(NamedTuple):
    """`uid` is the page that makes it and a count, `m3:17`; `seen_number` what it had seen."""

    uid: str
    operations: tuple[Operation, ...]
    conditions: tuple[Condition, ...] = ()
    seen_number: int = 0


class TakenChange(NamedTuple):
    """The exact operations of a change, and its number."""

    number: int
    uid: str
    operations: tuple[Operation, ...]

    def data(self) -> Json:
        operations = [data_of(operation) for operation in self.operations]
        return {"n": self.number, "uid": self.uid, "ops": operations}


def page_and_count(uid: str) -> tuple[str, int]:
    page, _, number = uid.partition(":")
    return page, int(number)


# -- to JSON --------------------------------------------------------------------------------------


def data_of(operation: Operation) -> Json:
    if isinstance(operation, Insert):
        return {"do": "insert", "at": list(operation.place),
                "nodes": [node.data() for node in operation.nodes]}  # fmt: skip
    if isinstance(operation, Delete):
        arms: Json = {"arms": list(operation.arms)} if operation.arms else {}
        return {"do": "delete", "ids": list(operation.ids), **arms}
    if isinstance(operation, Wrap):
        return {"do": "wrap", "ids": list(operation.ids), "node": operation.node.data()}
    if isinstance(operation, Unwrap):
        return {"do": "unwrap", "id": operation.id}
    marks: Json = {"marks": dict(operation.marks)} if operation.marks else {}
    if isinstance(operation, Move):
        return {"do": "move", "ids": list(operation.ids), "at": list(operation.place), **marks}
    return {"do": "replace", "id": operation.id, **dict(operation.fields), **marks}


def data_of_change(change: Change) -> Json:
    data: Json = {"uid": change.uid, "ops": [data_of(operation) for operation in change.operations]}
    if change.conditions:
        data["if"] = [list(condition) for condition in change.conditions]
    if change.seen_number:
        data["since"] = change.seen_number
    return data


# -- from JSON ------------------------------------------------------------------------------------


def change_of(data: object) -> Change:
    """Return the change in data. Raises Refused."""
    uid, operations = _field(data, "uid"), _field(data, "ops")
    seen_number = _field(data, "since", 0)
    if not is_uid(uid) or type(seen_number) is not int or not _is_list(operations, MAX_OPERATIONS):
        raise Refused(BAD)
    conditions = []
    for row in _checked_list(_field(data, "if", []), MAX_IDS):
        cells = _checked_list(row, 3)
        id, name, mark = cells if len(cells) == 3 else (None, None, None)
        if name not in (*FIELDS, PLACE):
            raise Refused(BAD)
        conditions.append(Condition(_checked_id(id), str(name), _checked_mark(mark)))
    return Change(uid, tuple(map(operation_of, operations)), tuple(conditions), seen_number)


def is_uid(data: object) -> bool:
    return isinstance(data, str) and ":" in data and _ID.fullmatch(data) is not None


def operation_of(data: object) -> Operation:
    """Return the operation in data. Raises Refused."""
    make = _MAKERS.get(str(_field(data, "do")))
    if make is None:
        raise Refused(BAD)
    return make(data)


def subtree_of(data: object, depth: int = 0) -> Subtree:
    """Return the node in data, with all that is in it. Raises Refused."""
    if depth > MAX_DEPTH:
        raise Refused(BAD)
    children = _checked_list(_field(data, "in", []), MAX_IDS)
    return Subtree(
        _checked_id(_field(data, "id")), _checked_value(data, TEXT), _checked_value(data, COMMENT),
        _checked_value(data, APART), _checked_value(data, END),
        tuple(subtree_of(child, depth + 1) for child in children),
        _checked_mark(_field(data, "born", "")), _checked_marks(_field(data, "marks", {})),
    )  # fmt: skip


def tree_of(snapshot: object) -> Tree:
    """Return the tree of a snapshot. Raises Refused."""
    root, former_places = subtree_of(_field(snapshot, "tree")), _field(snapshot, "gone", {})
    if not isinstance(former_places, dict) or root.id != ROOT:
        raise Refused(BAD)
    ids = list(root.ids())
    if len(set(ids)) < len(ids) or START not in (child.id for child in root.children):
        raise Refused(BAD)
    checked_places = {}
    for id, row in former_places.items():
        if not _is_list(row, 3) or len(row) != 3 or type(row[2]) is not bool:
            raise Refused(BAD)
        checked_places[_checked_id(id)] = FormerPlace(
            _checked_id(row[0]), _checked_id(row[1]) if row[1] else "", row[2]
        )
    return Tree.of(root, checked_places)


def taken_change_of(data: Json) -> TakenChange:
    """Return the taken change in data. Raises Refused."""
    number, uid, operations = data.get("n"), data.get("uid"), data.get("ops")
    if type(number) is not int or not is_uid(uid) or not isinstance(operations, list):
        raise Refused(BAD)
    return TakenChange(number, str(uid), tuple(map(operation_of, operations)))


def _insert_of(data: object) -> Insert:
    nodes = tuple(subtree_of(node) for node in _checked_list(_field(data, "nodes"), MAX_IDS))
    ids = [id for node in nodes for id in node.ids()]
    if not nodes or len(set(ids)) < len(ids) or not {ROOT, START}.isdisjoint(ids):
        raise Refused(BAD)
    return Insert(_checked_place(data), nodes)


def _delete_of(data: object) -> Delete:
    return Delete(_checked_ids(_field(data, "ids")), _checked_ids(_field(data, "arms", [])))


def _move_of(data: object) -> Move:
    return Move(
        _checked_ids(_field(data, "ids")),
        _checked_place(data),
        _checked_marks(_field(data, "marks", {})),
    )


def _wrap_of(data: object) -> Wrap:
    return Wrap(_checked_ids(_field(data, "ids")), subtree_of(_field(data, "node")))


def _unwrap_of(data: object) -> Unwrap:
    return Unwrap(_checked_id(_field(data, "id")))


def _replace_of(data: object) -> Replace:
    assert isinstance(data, dict)
    fields = tuple((name, _checked_value(data, name)) for name in FIELDS if name in data)
    return Replace(
        _checked_id(_field(data, "id")), fields, _checked_marks(_field(data, "marks", {}))
    )


_MAKERS: dict[str, Callable[[object], Operation]] = {
    "insert": _insert_of,
    "delete": _delete_of,
    "move": _move_of,
    "wrap": _wrap_of,
    "unwrap": _unwrap_of,
    "replace": _replace_of,
}


def _field(data: object, name: str, default: Any = None) -> Any:
    if not isinstance(data, dict):
        raise Refused(BAD)
    return data.get(name, default)


def _is_list(data: object, most_items: int) -> bool:
    return isinstance(data, list) and len(data) <= most_items


def _checked_list(data: object, most_items: int) -> list[Any]:
    if not isinstance(data, list) or len(data) > most_items:
        raise Refused(BAD)
    return data


def _checked_id(data: object) -> str:
    if not isinstance(data, str) or _ID.fullmatch(data) is None or ":" in data:
        raise Refused(BAD)
    return data


def _checked_ids(data: object) -> tuple[str, ...]:
    return tuple(dict.fromkeys(map(_checked_id, _checked_list(data, MAX_IDS))))


def _checked_place(data: object) -> Place:
    row = _checked_list(_field(data, "at"), 2)
    if len(row) != 2:
        raise Refused(BAD)
    return Place(_checked_id(row[0]), _checked_id(row[1]) if row[1] != "" else "")


def _checked_mark(data: object) -> str:
    """Return the change that a mark refers to; none for the initial content."""
    if data != "" and not is_uid(data):
        raise Refused(BAD)
    return str(data)


def _checked_marks(data: object) -> tuple[tuple[str, str], ...]:
    if not isinstance(data, dict) or len(data) > MAX_IDS:
        raise Refused(BAD)
    names = {*FIELDS, PLACE}
    return tuple(
        (key if key in names else _checked_id(key), _checked_mark(uid)) for key, uid in data.items()
    )


def _checked_value(data: object, name: str) -> Any:
    """Return a field; `APART` is a bool. Reading it again checks that a text is one line."""
    value = _field(data, name, name != APART and "")
    if name == APART:
        if type(value) is not bool:
            raise Refused(BAD)
        return value
    if not isinstance(value, str) or len(value) > MAX_CHARACTERS:
        raise Refused(BAD)
    if name != TEXT and value and not value.startswith("//"):
        raise Refused(BAD)
    return value
