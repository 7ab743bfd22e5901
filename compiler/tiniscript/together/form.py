"""Operations and changes, and their form in JSON: what comes from elsewhere is checked here.

    {"do": "insert", "at": [container, behind], "nodes": [...]}  `behind` "" is the first place
    {"do": "delete", "ids": [...], "arms": [...]}     all ids of what goes; arms go with all of them
    {"do": "move", "ids": [...], "at": [container, behind]}
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
    Gone,
    Json,
    Part,
    Tree,
)

# Why a change was refused.
IS_GONE, HAS_NEW, CIRCLE, CHANGED, UNPARSED, TOO_LONG, BAD = (
    "gone", "has_new", "circle", "changed", "unparsed", "too_long", "bad")  # fmt: skip

MOST_OPERATIONS = 200  # of a change
MOST_IDS = 2000  # of an operation: what a delete of a whole program lists
MOST_CHARACTERS = 2000  # of an instruction or a comment
DEEPEST = 40
_NAME = re.compile(r"[a-z0-9]{1,12}[.:][0-9]{1,9}|root|start")  # of a node, and of a change


class Refused(Exception):
    """A change does not apply, or leaves no program."""

    def __init__(self, why: str) -> None:
        super().__init__(why)
        self.why = why


class At(NamedTuple):
    """`behind` which sibling; where that has gone, what counts is where it was."""

    container: str
    behind: str


class Insert(NamedTuple):
    at: At
    nodes: tuple[Part, ...]


class Delete(NamedTuple):
    ids: tuple[str, ...]
    arms: tuple[str, ...] = ()


class Move(NamedTuple):
    """`marks`: what an undo gives back, of which change the place was."""

    ids: tuple[str, ...]
    at: At
    marks: tuple[tuple[str, str], ...] = ()


class Wrap(NamedTuple):
    ids: tuple[str, ...]
    node: Part


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
    """`uid` is the page that makes it and a count, `m3:17`; `since` the number that it had seen."""

    uid: str
    operations: tuple[Operation, ...]
    conditions: tuple[Condition, ...] = ()
    since: int = 0


class Taken(NamedTuple):
    """What a change has done exactly, and its number."""

    number: int
    uid: str
    operations: tuple[Operation, ...]

    def data(self) -> Json:
        operations = [data_of(each) for each in self.operations]
        return {"n": self.number, "uid": self.uid, "ops": operations}


def page_and_count(uid: str) -> tuple[str, int]:
    page, _, number = uid.partition(":")
    return page, int(number)


# -- to JSON --------------------------------------------------------------------------------------


def data_of(operation: Operation) -> Json:
    if isinstance(operation, Insert):
        return {"do": "insert", "at": list(operation.at),
                "nodes": [each.data() for each in operation.nodes]}  # fmt: skip
    if isinstance(operation, Delete):
        arms: Json = {"arms": list(operation.arms)} if operation.arms else {}
        return {"do": "delete", "ids": list(operation.ids), **arms}
    if isinstance(operation, Wrap):
        return {"do": "wrap", "ids": list(operation.ids), "node": operation.node.data()}
    if isinstance(operation, Unwrap):
        return {"do": "unwrap", "id": operation.id}
    marks: Json = {"marks": dict(operation.marks)} if operation.marks else {}
    if isinstance(operation, Move):
        return {"do": "move", "ids": list(operation.ids), "at": list(operation.at), **marks}
    return {"do": "replace", "id": operation.id, **dict(operation.fields), **marks}


def data_of_change(change: Change) -> Json:
    found: Json = {"uid": change.uid, "ops": [data_of(each) for each in change.operations]}
    if change.conditions:
        found["if"] = [list(each) for each in change.conditions]
    if change.since:
        found["since"] = change.since
    return found


# -- from JSON ------------------------------------------------------------------------------------


def change_of(found: object) -> Change:
    """Return the change in data. Raises Refused."""
    uid, operations = _field(found, "uid"), _field(found, "ops")
    since = _field(found, "since", 0)
    if not is_uid(uid) or type(since) is not int or not _is_list(operations, MOST_OPERATIONS):
        raise Refused(BAD)
    conditions = []
    for row in _list(_field(found, "if", []), MOST_IDS):
        id, name, by = _list(row, 3) if len(_list(row, 3)) == 3 else (None, None, None)
        if name not in (*FIELDS, PLACE):
            raise Refused(BAD)
        conditions.append(Condition(_name(id), str(name), _mark(by)))
    return Change(uid, tuple(map(operation_of, operations)), tuple(conditions), since)


def is_uid(found: object) -> bool:
    return isinstance(found, str) and ":" in found and _NAME.fullmatch(found) is not None


def operation_of(found: object) -> Operation:
    """Return the operation in data. Raises Refused."""
    make = _MAKERS.get(str(_field(found, "do")))
    if make is None:
        raise Refused(BAD)
    return make(found)


def part_of(found: object, depth: int = 0) -> Part:
    """Return the node in data, with all that is in it. Raises Refused."""
    if depth > DEEPEST:
        raise Refused(BAD)
    inside = _list(_field(found, "in", []), MOST_IDS)
    return Part(
        _name(_field(found, "id")), _value(found, TEXT), _value(found, COMMENT),
        _value(found, APART), _value(found, END),
        tuple(part_of(each, depth + 1) for each in inside),
        _mark(_field(found, "born", "")), _marks(_field(found, "marks", {})),
    )  # fmt: skip


def tree_of(snapshot: object) -> Tree:
    """Return the tree of a snapshot. Raises Refused."""
    root, gone = part_of(_field(snapshot, "tree")), _field(snapshot, "gone", {})
    if not isinstance(gone, dict) or root.id != ROOT:
        raise Refused(BAD)
    ids = list(root.ids())
    if len(set(ids)) < len(ids) or START not in (each.id for each in root.inside):
        raise Refused(BAD)
    were = {}
    for id, row in gone.items():
        if not _is_list(row, 3) or len(row) != 3 or type(row[2]) is not bool:
            raise Refused(BAD)
        were[_name(id)] = Gone(_name(row[0]), _name(row[1]) if row[1] else "", row[2])
    return Tree.of(root, were)


def taken_of(found: Json) -> Taken:
    """Return the taken change in data. Raises Refused."""
    number, uid, operations = found.get("n"), found.get("uid"), found.get("ops")
    if type(number) is not int or not is_uid(uid) or not isinstance(operations, list):
        raise Refused(BAD)
    return Taken(number, str(uid), tuple(map(operation_of, operations)))


def _insert(found: object) -> Insert:
    nodes = tuple(part_of(each) for each in _list(_field(found, "nodes"), MOST_IDS))
    ids = [id for each in nodes for id in each.ids()]
    if not nodes or len(set(ids)) < len(ids) or not {ROOT, START}.isdisjoint(ids):
        raise Refused(BAD)
    return Insert(_at(found), nodes)


def _delete(found: object) -> Delete:
    return Delete(_names(_field(found, "ids")), _names(_field(found, "arms", [])))


def _move(found: object) -> Move:
    return Move(_names(_field(found, "ids")), _at(found), _marks(_field(found, "marks", {})))


def _wrap(found: object) -> Wrap:
    return Wrap(_names(_field(found, "ids")), part_of(_field(found, "node")))


def _unwrap(found: object) -> Unwrap:
    return Unwrap(_name(_field(found, "id")))


def _replace(found: object) -> Replace:
    assert isinstance(found, dict)
    fields = tuple((name, _value(found, name)) for name in FIELDS if name in found)
    return Replace(_name(_field(found, "id")), fields, _marks(_field(found, "marks", {})))


_MAKERS: dict[str, Callable[[object], Operation]] = {
    "insert": _insert, "delete": _delete, "move": _move, "wrap": _wrap, "unwrap": _unwrap,
    "replace": _replace,
}  # fmt: skip


def _field(found: object, name: str, usual: Any = None) -> Any:
    if not isinstance(found, dict):
        raise Refused(BAD)
    return found.get(name, usual)


def _is_list(found: object, most: int) -> bool:
    return isinstance(found, list) and len(found) <= most


def _list(found: object, most: int) -> list[Any]:
    if not isinstance(found, list) or len(found) > most:
        raise Refused(BAD)
    return found


def _name(found: object) -> str:
    if not isinstance(found, str) or _NAME.fullmatch(found) is None or ":" in found:
        raise Refused(BAD)
    return found


def _names(found: object) -> tuple[str, ...]:
    return tuple(dict.fromkeys(map(_name, _list(found, MOST_IDS))))


def _at(found: object) -> At:
    row = _list(_field(found, "at"), 2)
    if len(row) != 2:
        raise Refused(BAD)
    return At(_name(row[0]), _name(row[1]) if row[1] != "" else "")


def _mark(found: object) -> str:
    """Return of which change something is: nothing is what was there at the beginning."""
    if found != "" and not is_uid(found):
        raise Refused(BAD)
    return str(found)


def _marks(found: object) -> tuple[tuple[str, str], ...]:
    if not isinstance(found, dict) or len(found) > MOST_IDS:
        raise Refused(BAD)
    names = {*FIELDS, PLACE}
    return tuple((key if key in names else _name(key), _mark(uid)) for key, uid in found.items())


def _value(found: object, name: str) -> Any:
    """Return a field; `APART` is a bool. That a text is one line is seen when it is read again."""
    value = _field(found, name, name != APART and "")
    if name == APART:
        if type(value) is not bool:
            raise Refused(BAD)
        return value
    if not isinstance(value, str) or len(value) > MOST_CHARACTERS:
        raise Refused(BAD)
    if name != TEXT and value and not value.startswith("//"):
        raise Refused(BAD)
    return value
