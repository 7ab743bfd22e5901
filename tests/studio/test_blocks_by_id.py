"""Changes of blocks in a group, in Python alone: operations only of the blocks that were touched,
whatever the others of the group do meanwhile."""

from __future__ import annotations

import json
from itertools import count
from random import Random
from typing import Any

import pytest

from tiniscript import robots
from tiniscript.studio import page_together
from tiniscript.studio.block_form import data_of, from_data, in_order
from tiniscript.studio.block_printing import format_blocks
from tiniscript.studio.block_reading import read_blocks as read_blocks
from tiniscript.together.form import Change as Made
from tiniscript.together.form import Delete, Insert, Place, Replace, change_of
from tiniscript.together.layout import parse_tree, text_of
from tiniscript.together.ordering import SharedProgram
from tiniscript.together.tree import ROOT, START, Subtree

Json = dict[str, Any]
KIT = robots.load("tinibot").kit
TEXT = """SI|F(1.50, (80));  // first
LOOP(3);
  B(1, 40);

  R(0.50, 60);
END_LOOP;  // three
IF(DISTANCE < 2.0);
  S;
ELSEIF((DISTANCE) < 9);  // near
  W(1.0);
ELSE;  // else
  BEEP(1, 440);
ENDIF;
W(2);
"""


class Ana:
    """A page with blocks: a block has the number that it was made with, wherever it goes."""

    def __init__(self, program: SharedProgram) -> None:
        self.program = program
        self.numbers = count(1)
        self.text = ""
        self.take_answer(page_together.begin({"news": {"page": "a", **self.news(-1, "")}}, b""))
        self.show()

    def news(self, seen_number: int, epoch: str) -> Json:
        answer: Json = json.loads(json.dumps(self.program.news("a", seen_number, epoch)))
        return answer

    def take_answer(self, answer: Json) -> None:
        for start, end, text in reversed(answer["changes"]):
            self.text = self.text[:start] + text + self.text[end:]
        self.answer = answer

    def show(self) -> None:
        form = read_blocks(self.text, KIT)
        blocks = in_order(form.body)
        self.form: Json = json.loads(json.dumps(data_of(form)))
        self.ids = [f"b{next(self.numbers)}" for _ in blocks]
        for data, id in zip(self.inside(self.form["body"]), self.ids, strict=True):
            data["id"] = id
        lines = [[id, block.place[0]] for id, block in zip(self.ids, blocks, strict=True)]
        fields = {"version": self.answer["version"], "lines": lines}
        assert page_together.show_blocks(fields, b"") == {"is_known": True}

    def inside(self, body: list[Json]) -> list[Json]:
        nodes = []
        for data in body:
            nodes.append(data)
            for inner_body in data["bodies"]:
                nodes += self.inside(inner_body)
        return nodes

    def step(self, is_heard: bool = True, **extra_fields: Any) -> Json:
        """Ask for the next answer; one that is not heard comes too late."""
        news = [self.news(self.answer["since"], self.answer["epoch"])]
        fields = {
            "from": self.answer["version"],
            "caret": 0,
            "hot": False,
            "news": news,
            **extra_fields,
        }
        answer = page_together.step(fields, self.text.encode())
        if is_heard:
            self.take_answer(json.loads(json.dumps(answer)))
        return answer

    def write(self) -> Json:
        ids = [data["id"] for data in self.inside(self.form["body"])]
        return self.step(blocks={"form": self.form, "ids": ids})

    def send(self) -> None:
        self.program.submit([change_of(change) for change in self.answer["pending"]])
        self.step()


def program_of(text: str = TEXT) -> SharedProgram:
    numbers = count(1)
    return SharedProgram(parse_tree(text, lambda: f"i.{next(numbers)}"), "e")


def change_blocks(body: list[Json], rng: Random, next_id: Any) -> set[str]:
    """Change blocks at random; return the ids of those that were touched."""
    bodies = [body, *(inner_body for data in body for inner_body in data["bodies"])]
    filled_bodies = [body for body in bodies if body]
    if not filled_bodies:
        return set()
    chosen_body = rng.choice(filled_bodies)
    data = rng.choice(chosen_body)
    kind = rng.randrange(4)
    if kind == 0 and data["values"] and data["kind"] != "if":
        data["values"][0] = [["NUMBER", str(rng.randrange(2, 9))]]
        data["said"] = []
        return {data["id"]}
    if kind == 1:
        chosen_body.remove(data)
        return {data["id"]}
    if kind == 2 and not data["bodies"]:
        chosen_body.remove(data)
        target = rng.choice(bodies)
        target.insert(rng.randrange(len(target) + 1), data)
        return {data["id"]}
    block = {"kind": "move", "word": "L", "values": [[["NUMBER", "1"]], [["NUMBER", "60"]]],
             "bodies": [], "note": "", "is_apart": False, "id": next_id()}  # fmt: skip
    chosen_body.insert(rng.randrange(len(chosen_body) + 1), block)
    return set()


@pytest.mark.parametrize("seed", range(60))
def test_only_touched_blocks_change_and_keep_their_ids(seed: int) -> None:
    rng = Random(seed)
    program = program_of()
    ana = Ana(program)
    if seed % 2:  # an answer was on its way when the blocks were shown
        ana.step(is_heard=False)
        ana.show()
    nodes_before = {id: node.copy() for id, node in program.tree.node_by_id.items()}
    nodes = dict(page_together._newest.blocks.nodes)  # type: ignore[union-attr]
    touched_ids: set[str] = set()
    for _ in range(rng.randrange(1, 5)):
        touched_ids |= change_blocks(ana.form["body"], rng, lambda: f"n{next(ana.numbers)}")
    expected_text = format_blocks(from_data(ana.form)).text
    answer = ana.write()
    assert ana.text == expected_text == text_of(page_together._newest.page.view)  # type: ignore[union-attr]
    assert answer["is_shown"]
    ana.send()
    assert text_of(program.tree) == ana.text
    ids = {nodes[id] for id in touched_ids if id in nodes}
    inner_ids = {node for id in ids for node in
             ([id, *nodes_before[id].children] if id in nodes_before else [id])}  # fmt: skip
    for id, node in nodes_before.items():
        if id not in inner_ids and id not in (ROOT, START):
            new_node = program.tree[id]
            assert (new_node.text, new_node.mark("text")) == (node.text, node.mark("text")), id
    present_ids = {node["id"] for node in ana.inside(ana.form["body"])}
    for block, id in nodes.items():
        assert block not in present_ids or id not in nodes_before or id in program.tree, (block, id)


@pytest.mark.parametrize("seed", range(40))
def test_concurrent_changes_of_others_are_kept(seed: int) -> None:
    """Two changes of blocks that were shown before; others have changed the program twice."""
    rng = Random(seed)
    program = program_of()
    ana = Ana(program)
    loop = next(id for id in program.tree.subtree_ids() if program.tree[id].text == "LOOP(3)")
    last_id = program.tree[ROOT].children[-1]
    change = Made("z:1", (Insert(Place(loop, ""), (Subtree("z.1", "BEEP(0.25, 990)"),)),))
    program.submit([change])
    ana.step()
    change_blocks(ana.form["body"], rng, lambda: f"n{next(ana.numbers)}")
    ana.write()
    program.submit([Made("z:2", (Replace(last_id, (("text", "W(7.25)"),)),))])
    ana.step()
    change_blocks(ana.form["body"], rng, lambda: f"n{next(ana.numbers)}")
    ana.write()
    ana.send()
    assert ana.text == text_of(program.tree)
    is_loop_there = loop in program.tree
    assert ("BEEP(0.25, 990)" in ana.text) is is_loop_there
    assert last_id not in program.tree or program.tree[last_id].text != "W(2)"


def test_an_empty_place_belongs_to_its_own_block() -> None:
    program = program_of()
    ana = Ana(program)
    ana.form["body"][0]["values"][0] = [["NOTHING", ""]]
    ana.form["body"][0]["said"] = []
    assert ana.write()["is_shown"]
    ana.send()
    assert "F(, " in ana.text
    assert text_of(program.tree) == TEXT
    ana.form["body"][0]["values"][0] = [["NUMBER", "4"]]
    ana.write()
    ana.send()
    assert text_of(program.tree).startswith("SI|F(4, (80));")
    assert ana.text == text_of(program.tree)


def test_a_deleted_block_with_new_contents_is_kept() -> None:
    program = program_of()
    ana = Ana(program)
    loop = next(id for id in program.tree.subtree_ids() if program.tree[id].text == "LOOP(3)")
    ana.form["body"] = [data for data in ana.form["body"] if data["kind"] != "loop"]
    program.submit([Made("z:1", (Insert(Place(loop, ""), (Subtree("z.1", "BEEP(0.25, 990)"),)),))])
    ana.write()
    ana.send()
    assert "BEEP(0.25, 990)" in text_of(program.tree)
    assert ana.text == text_of(program.tree)
    assert ana.answer["why"] == "has_new"
    program.submit([Made("z:2", (Delete(tuple(program.tree.subtree_ids(loop))),))])
    ana.step()
    assert "LOOP" not in ana.text


def test_of_two_equal_blocks_the_touched_one_is_changed() -> None:
    program = program_of("W(1);\nB(1, 40);\nB(1, 40);\nW(2);\n")
    [_, changed_id, other_id, _] = (id for id in program.tree[ROOT].children if id != START)
    ana = Ana(program)
    del ana.form["body"][1]
    ana.write()
    ana.send()
    assert changed_id not in program.tree
    assert other_id in program.tree
    ana.form["body"].reverse()
    ana.write()
    ana.send()
    assert program.tree[ROOT].children.index(other_id) == 2


@pytest.mark.parametrize("seed", range(20))
def test_what_is_written_in_a_block_that_others_delete_is_kept(seed: int) -> None:
    """As a draft where its instruction is gone; the head of a block alone would mean nothing."""
    rng = Random(seed)
    program = program_of()
    ana = Ana(program)
    deleted_id = rng.choice([id for id in program.tree.subtree_ids() if id not in (ROOT, START)])
    program.submit([Made("z:1", (Delete(tuple(program.tree.subtree_ids(deleted_id))),))])
    if rng.random() < 0.8:
        ana.step()
    written_by_block: dict[str, str] = {}
    for number in range(301, 305):
        data = rng.choice([data for data in ana.inside(ana.form["body"])
                           if data["values"] and not data["bodies"]])  # fmt: skip
        data["values"][0] = [["NUMBER", str(number)]]
        data["said"] = []
        written_by_block[data["id"]] = str(number)
        if rng.random() < 0.5:
            ana.write()
    ana.write()
    ana.send()
    assert all(number in ana.text for number in written_by_block.values()), ana.text
