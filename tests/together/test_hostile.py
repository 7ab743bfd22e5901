"""Whatever a page sends, it is refused or the program stays valid, and journal and pages agree."""

from __future__ import annotations

import json
from collections import Counter
from itertools import count
from random import Random
from typing import Any

import pytest

from tiniscript.together.form import (
    BAD,
    TOO_LONG,
    UNPARSED,
    Refused,
    change_of,
    taken_change_of,
    tree_of,
)
from tiniscript.together.layout import parse_tree, text_of
from tiniscript.together.ordering import SharedProgram
from tiniscript.together.page import Page
from tiniscript.together.tree import MAX_FORMER_PLACES

MESSAGE_COUNT = 1500
TEXT = "SI|F(1, 80)\nLOOP(3)\nB(1, 40)\nEND_LOOP\nIF(X < 1)\nS\nELSE\nW(1)\nENDIF\n"
VALUES: list[Any] = [
    None, 0, -1, True, "", "root", "start", "i.1", "i.2", "i.5", "zz", "q.9", "a:1", [], {},
    ["i.2"], ["i.3", "i.4"], ["root", ""], ["i.3", "i.9"], ["start", ""], ["i.2", "i.2"],
    "F(1, 80)", "LOOP(2)", "END_LOOP", "F(1,80);S", "// c", "//\nS", "// \u2028S", "// \x0bS",
    "ELSE", "SI|", "SB|", "x" * 3000, {"id": "q.1", "text": "S"}, {"id": "q.1", "text": "LOOP(2)"},
    {"id": "i.2", "text": "S", "in": [{"id": "root", "text": "S"}]},
    [{"id": "q.2", "text": "LOOP(2)", "in": [{"id": "q.2", "text": "S"}]}],
    [{"id": "q.3", "text": "S", "in": [{"id": "q.4", "text": "S"}]}],
    [{"id": "q.5", "text": "DEF S"}], [{"id": "q.6", "text": "F(1, 80)", "note": "S"}],
    [{"id": "i.2", "text": "LOOP(9)", "in": [{"id": "q.7", "text": "S"}]}], [{"id": "q.8"}],
    {"text": "a:9", "place": "b:3"}, {"i.2": ""},
]  # fmt: skip
# Likely values for each operation, and random other fields.
LIKELY_VALUES: dict[str, list[Any]] = {
    "id": ["i.1", "i.2", "i.3", "i.5", "start", "q.1"], "ids": [["i.1"], ["i.2", "i.3"], ["q.1"]],
    "at": [["root", ""], ["i.2", ""], ["i.4", "i.6"], ["root", "q.1"]],
    "nodes": [[{"id": "q.1", "text": "S"}], [{"id": "i.3", "text": "S"}],
              [{"id": "q.2", "text": "LOOP(2)", "in": [{"id": "q.3", "text": "S"}]}]],
    "node": [{"id": "q.4", "text": "LOOP(4)"}], "text": ["F(2, 80)", "LOOP(5)", "// c"],
}  # fmt: skip
NEEDED_FIELDS = {
    "insert": ("at", "nodes"), "delete": ("ids",), "move": ("ids", "at"), "wrap": ("ids", "node"),
    "unwrap": ("id",), "replace": ("id", "text"), "no": (),
}  # fmt: skip
FIELD_NAMES = ("id", "ids", "at", "nodes", "node", "text", "note", "apart", "end", "arms", "marks")


def random_operation(rng: Random) -> Any:
    operation: Any = {"do": rng.choice(list(NEEDED_FIELDS))}
    for field in NEEDED_FIELDS[operation["do"]]:
        operation[field] = rng.choice(LIKELY_VALUES[field])
    for field in FIELD_NAMES:
        if rng.random() < 0.07:
            operation[field] = rng.choice(VALUES)
    return operation


@pytest.mark.parametrize("seed", range(3))
def test_no_change_spoils_the_program(seed: int) -> None:
    rng, ids = Random(seed), count(1)
    rows: list[Any] = []
    program = SharedProgram(parse_tree(TEXT, lambda: f"i.{next(ids)}"), "e", rows.append)
    page = Page.of("z", program.news("z", -1, ""))
    refusals: Counter[str] = Counter()
    for k in range(1, MESSAGE_COUNT + 1):
        operation = random_operation(rng)
        uid = f"m:{program.last_count_by_page.get('m', 0) + 1}"
        sent_data = json.loads(json.dumps({"uid": uid, "ops": [operation] * rng.choice((1, 1, 3))}))
        try:
            change = change_of(sent_data)
        except Refused as refusal:
            refusals[refusal.reason] += 1
            continue
        program.submit([change])
        refusals[str(rows[-1].get("refused", "taken"))] += 1
        if k % 10 == 0:
            tree = program.tree
            assert parse_tree(text_of(tree)).shape() == tree.shape()
            assert sorted(tree.subtree_ids()) == sorted(tree.node_by_id)
            assert tree_of(json.loads(json.dumps(tree.snapshot()))).checksum() == tree.checksum()
            page.receive(json.loads(json.dumps(program.news("z", page.number, "e"))))
            assert not page.is_out_of_sync
    assert refusals["taken"] > MESSAGE_COUNT / 50
    assert refusals[BAD] > MESSAGE_COUNT / 50


@pytest.mark.parametrize("value", VALUES, ids=repr)
def test_an_invalid_change_is_refused(value: Any) -> None:
    for data in (value, {"uid": value, "ops": []}, {"uid": "m:1", "ops": value},
                 {"uid": "m:1", "ops": [value]}, {"uid": "m:1", "ops": [], "if": [value]},
                 {"uid": "m:1", "ops": [], "since": "1"}):  # fmt: skip
        if data not in ({"uid": "m:1", "ops": []}, {"uid": "a:1", "ops": []}):
            with pytest.raises(Refused):
                change_of(data)
    for tree_data in (value, {"tree": value}, {"tree": {"id": "root"}, "gone": value}):
        with pytest.raises(Refused):
            tree_of(tree_data)


def test_deep_and_long_programs_are_refused() -> None:
    program = SharedProgram(parse_tree("S\n", lambda: "i.1"), "e")
    for k in range(1, 100):
        wrap = {"do": "wrap", "ids": ["i.1"], "node": {"id": f"m.{k}", "text": "LOOP(2)"}}
        program.submit([change_of({"uid": f"m:{k}", "ops": [wrap]})])
    assert len(program.tree.node_by_id) < 50
    for k in range(100, 200):
        nodes = [{"id": f"m.{k}00{j}", "text": "BEEP(1, 440)"} for j in range(40)]
        insert = {"do": "insert", "at": ["root", "start"], "nodes": nodes}
        program.submit([change_of({"uid": f"m:{k}", "ops": [insert]})])
    assert len(text_of(program.tree)) <= 20_000
    assert {reason for _, reason in program.refusals_by_page["m"]} == {UNPARSED, TOO_LONG}


def test_the_number_of_remembered_deletions_is_limited() -> None:
    program = SharedProgram(parse_tree("S\n", lambda: "i.1"), "e")
    page = Page.of("z", program.news("z", -1, ""))
    for k in range(1, 2 * MAX_FORMER_PLACES // 100 + 2):
        nodes = [{"id": f"m.{k}{j:03}", "text": "W(1)"} for j in range(100)]
        ids = [node["id"] for node in nodes]
        changes = [
            {"do": "insert", "at": ["root", ""], "nodes": nodes},
            {"do": "delete", "ids": ids},
        ]
        program.submit([change_of({"uid": f"m:{k}", "ops": changes})])
        page.receive(program.news("z", page.number, "e"))
    assert len(program.tree.former_place_by_id) == MAX_FORMER_PLACES
    assert list(page.base.former_place_by_id.items()) == list(
        program.tree.former_place_by_id.items()
    )


def test_a_change_counts_once_and_in_order() -> None:
    program = SharedProgram(parse_tree("S\n", lambda: "i.1"), "e")

    def beep(k: int) -> Any:
        nodes = [{"id": f"m.{k}", "text": f"BEEP({k}, 440)"}]
        insert = {"do": "insert", "at": ["root", "i.1"], "nodes": nodes}
        return change_of({"uid": f"m:{k}", "ops": [insert]})

    assert program.submit([beep(1), beep(2)])
    assert not program.submit([beep(1), beep(2)])  # it arrives twice
    assert program.submit([beep(5)])  # the page has heard of a decision on those between
    assert not program.submit([beep(4)])
    assert text_of(program.tree) == "S;\nBEEP(5, 440);\nBEEP(2, 440);\nBEEP(1, 440);\n"
    with pytest.raises(Refused):
        taken_change_of({"n": 1, "uid": "m:1", "ops": "no"})
