"""Conflicts of two pupils: the winner, refusals and drafts, and the effect of undo."""

from __future__ import annotations

import json
from functools import partial
from itertools import count
from random import Random
from typing import Any

import pytest

from tests.together.does import apply_edits
from tiniscript.together.form import (
    CHANGED,
    CIRCLE,
    HAS_NEW,
    Delete,
    Insert,
    Move,
    Place,
    Replace,
    Unwrap,
    Wrap,
    data_of_change,
)
from tiniscript.together.layout import parse_tree, text_of
from tiniscript.together.ordering import SharedProgram
from tiniscript.together.page import Page
from tiniscript.together.tree import ROOT, Subtree

TEXT = """SI|F(1, 80)
LOOP(3)
B(1, 40)
R(1, 40)
END_LOOP
IF(X < 1)
S
ELSE
W(1)
ENDIF
L(1, 60)
"""


class Two:
    """Ana and Luz edit one program; what Ana does reaches the computer first."""

    def __init__(self, text: str = TEXT) -> None:
        ids = count(1)
        self.program = SharedProgram(parse_tree(text, lambda: f"i.{next(ids)}"), "e")
        self.ana, self.luz = (Page.of(name, self.program.news(name, -1, "")) for name in "al")

    def find(self, text: str) -> str:
        tree = self.program.tree
        return next(id for id in tree.subtree_ids() if tree[id].text == text)

    def sends(self, page: Page) -> None:
        self.program.submit(page.pending_changes)
        self.hears(page)

    def hears(self, page: Page) -> None:
        page.receive(self.program.news(page.name, page.number, page.epoch))

    def meet(self) -> str:
        """Return the program on one line, once both have heard all."""
        for page in (self.ana, self.luz) * 2:
            self.sends(page)
        assert self.ana.base.checksum() == self.luz.base.checksum()
        assert self.ana.view.checksum() == self.program.tree.checksum()
        assert self.luz.view.checksum() == self.program.tree.checksum()
        return " ".join(text_of(self.program.tree).split())

    def inserts(
        self, page: Page, container: str, previous: str, text: str = "BEEP(1, 440)"
    ) -> None:
        node = Subtree(page.new_id(), text)
        assert apply_edits(page, [Insert(Place(container, previous), (node,))])

    def types(self, page: Page, old: str, new: str, is_hot: bool = False) -> None:
        """Change part of a line, and leave it unless it `is_hot`."""
        [k] = [k for k, row in enumerate(page.lines) if old in row]
        rows = page.lines[:]
        rows[k] = rows[k].replace(old, new)
        page.type(rows, k, is_hot)
        page.flush()


@pytest.fixture
def two() -> Two:
    return Two()


def test_a_delete_spares_what_its_author_has_not_seen(two: Two) -> None:
    loop = two.find("LOOP(3)")
    two.inserts(two.ana, loop, two.find("B(1, 40)"))
    apply_edits(two.luz, [Delete(tuple(two.luz.view.subtree_ids(loop)))])
    assert "LOOP(3); B(1, 40); BEEP(1, 440);" in two.meet()
    assert two.luz.refusals[-1][1] == HAS_NEW
    assert "  BEEP(1, 440);" in two.luz.lines


def test_an_arm_goes_with_all_that_is_in_it_or_not(two: Two) -> None:
    two.inserts(two.ana, two.find("IF(X < 1)"), two.find("ELSE"))
    rows = [row for row in two.luz.lines if "ELSE" not in row and "W(1)" not in row]
    two.luz.type(rows, 0)
    two.luz.flush()
    assert "ELSE; BEEP(1, 440); W(1)" in two.meet()
    assert two.luz.refusals[-1][1] == HAS_NEW


def test_a_block_goes_around_what_was_put_between(two: Two) -> None:
    first_id, last = two.find("B(1, 40)"), two.find("R(1, 40)")
    two.inserts(two.ana, two.find("LOOP(3)"), first_id)
    apply_edits(two.luz, [Wrap((first_id, last), Subtree(two.luz.new_id(), "WHILE(X < 2)"))])
    assert "WHILE(X < 2); B(1, 40); BEEP(1, 440); R(1, 40); END_WHILE;" in two.meet()


def test_a_place_whose_neighbour_has_gone_is_where_that_stood(two: Two) -> None:
    apply_edits(two.ana, [Delete((two.find("R(1, 40)"),))])
    two.inserts(two.luz, two.find("LOOP(3)"), two.find("R(1, 40)"))
    assert "B(1, 40); BEEP(1, 440); END_LOOP" in two.meet()


def test_the_first_place_of_a_block_that_was_taken_away_stays(two: Two) -> None:
    apply_edits(two.ana, [Unwrap(two.find("LOOP(3)"))])
    two.inserts(two.luz, two.find("LOOP(3)"), "")
    assert "F(1, 80); BEEP(1, 440); B(1, 40); R(1, 40); IF" in two.meet()


def test_two_blocks_that_go_into_each_other_make_no_circle(two: Two) -> None:
    loop, branch = two.find("LOOP(3)"), two.find("IF(X < 1)")
    apply_edits(two.ana, [Move((loop,), Place(branch, ""))])
    apply_edits(two.luz, [Move((branch,), Place(loop, ""))])
    assert "IF(X < 1); LOOP(3)" in two.meet()
    assert two.luz.refusals[-1][1] == CIRCLE


def test_of_two_values_the_later_wins_whole_and_undo_gives_back_the_other(two: Two) -> None:
    two.types(two.ana, "F(1, 80)", "F(2, 80)")
    two.types(two.luz, "F(1, 80)", "F(1, 99)")
    assert "F(1, 99)" in two.meet()
    assert any("F(2, 80)" in str(change) for change in two.program.taken_changes)
    assert not two.ana.undo()  # her text is gone
    assert two.luz.undo()
    assert "F(2, 80)" in two.meet()
    assert two.ana.undo()  # now it is
    assert "F(1, 80)" in two.meet()


def test_an_undo_that_comes_after_anothers_change_is_refused(two: Two) -> None:
    two.types(two.luz, "F(1, 80)", "F(1, 99)")
    two.meet()
    two.types(two.ana, "F(1, 99)", "F(5, 99)")
    assert two.luz.undo()
    assert "F(5, 99)" in two.meet()
    assert two.luz.refusals[-1][1] == CHANGED


def test_undo_brings_back_what_was_deleted_with_its_ids(two: Two) -> None:
    loop = two.find("LOOP(3)")
    before = text_of(two.program.tree)
    apply_edits(two.ana, [Delete(tuple(two.ana.view.subtree_ids(loop)))])
    two.meet()
    assert two.ana.undo()
    two.meet()
    assert text_of(two.program.tree) == before
    assert loop in two.program.tree


def test_a_line_that_two_have_cut_and_pasted_is_there_once(two: Two) -> None:
    for page in (two.ana, two.luz):
        page.type([row for row in page.lines if "L(1, 60)" not in row], 0)
        page.flush()
    for page, k in ((two.ana, 1), (two.luz, 3)):
        page.type([*page.lines[:k], "L(1, 60)", *page.lines[k:]], 0)
        page.flush()
    assert two.meet().count("L(1, 60)") == 1


def test_a_page_makes_no_change_that_leaves_no_program() -> None:
    two = Two("DEF TURN\nR(1, 40)\nEND_DEF\nLOOP(2)\nTURN\nEND_LOOP\n")
    page, turn = two.ana, two.find("TURN")
    assert not apply_edits(page, [Move((two.find("DEF TURN"),), Place(two.find("LOOP(2)"), ""))])
    for text in ("S; S", "END_LOOP", "s", "S // note", "LOOP(2)", ""):
        assert not apply_edits(page, [Replace(turn, (("text", text),))])
    assert not page.pending_changes


def test_a_line_that_is_being_typed_goes_with_its_instruction_and_stays_without(two: Two) -> None:
    two.types(two.ana, "B(1, 40);", "B(1, 4", is_hot=True)
    assert not two.ana.pending_changes
    apply_edits(two.luz, [Move((two.find("B(1, 40)"),), Place(ROOT, two.find("L(1, 60)")))])
    two.sends(two.luz)
    two.hears(two.ana)
    assert two.ana.lines[-1] == "  B(1, 4"
    assert two.ana.caret == len(two.ana.lines) - 1
    apply_edits(two.luz, [Delete((two.find("B(1, 40)"),))])
    two.sends(two.luz)
    two.hears(two.ana)
    assert two.ana.lines[-1] == "  B(1, 4"
    two.ana.type([*two.ana.lines[:-1], "B(1, 45)"], len(two.ana.lines) - 1)
    two.ana.flush()
    assert two.meet().endswith("L(1, 60); B(1, 45);")
    assert "i.3" in two.program.tree  # the same instruction


def test_a_half_typed_value_is_not_a_change_though_it_parses(two: Two) -> None:
    for shown in ("L(1, 6);", "L(1, 9);", "L(1, 95);"):
        old = next(row for row in two.ana.lines if "L(1" in row)
        two.types(two.ana, old, shown, is_hot=True)
    assert "L(1, 60)" in two.meet()
    two.ana.leave()
    assert "L(1, 95)" in two.meet()
    assert sum("L(1, 9" in str(change) for change in two.program.taken_changes) == 1


def test_of_lines_typed_one_below_the_other_only_the_last_one_waits(two: Two) -> None:
    k = two.ana.lines.index("L(1, 60);")
    for row in ("W(2)", "f(3,70)", "LOOP(2)", "BEEP(1, 440)", "END_LOOP"):
        rows = two.ana.lines[:]
        rows[k:k] = [row] if rows[k] else []
        rows[k] = row
        two.ana.type([*rows[: k + 1], "", *rows[k + 1 :]], k + 1, True)
        two.ana.flush()
        k = two.ana.caret
        assert two.ana.lines[k] == ""
        assert len(two.ana.drafts) == 1 + (row in ("LOOP(2)", "BEEP(1, 440)"))
    two.sends(two.ana)
    two.hears(two.luz)
    assert "W(2); F(3, 70); LOOP(2); BEEP(1, 440); END_LOOP; L(1, 60);" in " ".join(
        " ".join(two.luz.lines).split()
    )
    two.ana.leave()
    two.meet()
    assert two.luz.lines[-3:] == ["END_LOOP;", "", "L(1, 60);"]  # the empty line is there for all


def test_a_value_typed_into_what_was_deleted_is_a_draft_again(two: Two) -> None:
    apply_edits(two.luz, [Delete((two.find("R(1, 40)"),))])
    two.types(two.ana, "R(1, 40)", "R(2, 40)")
    for page in (two.luz, two.ana) * 2:
        two.sends(page)
    assert "R(2, 40)" in two.ana.lines
    assert "R(2, 40)" not in two.meet()
    rows = [row + " " if row == "R(2, 40)" else row for row in two.ana.lines]
    two.ana.type(rows, 3)  # wanted all the same
    two.ana.leave()
    assert "B(1, 40); R(2, 40); END_LOOP" in two.meet()
    assert "i.4" in two.program.tree


def test_a_page_that_is_loaded_again_goes_on(two: Two) -> None:
    two.types(two.ana, "F(1, 80)", "F(2, 80)")
    two.types(two.ana, "W(1);", "W(9)", is_hot=True)
    stored_data = json.loads(json.dumps(two.ana.store_data()))
    two.types(two.luz, "L(1, 60)", "L(3, 60)")
    two.sends(two.luz)
    two.ana = Page.of("a", two.program.news("a", -1, ""), stored_data)
    assert two.ana.lines[two.ana.caret] == "  W(9)"
    two.ana.leave()  # no one has continued that line
    assert "F(2, 80)" in two.meet()
    assert "W(1)" in two.meet()
    assert "L(3, 60)" in " ".join(two.ana.lines)
    two.types(two.ana, "W(9)", "W(95)")
    assert "W(95)" in two.meet()


@pytest.mark.parametrize("seed", range(10))
def test_what_was_undone_before_any_reload_is_redone_after_it_and_not_undone(seed: int) -> None:
    """The reload comes before the computer has heard of the undo."""
    chance, two = Random(seed), Two()
    for k in range(chance.randint(1, 3)):
        two.types(two.ana, f"F({k + 1}, 80)" if k else "F(1, 80)", f"F({k + 2}, 80)")
        two.sends(two.ana)
    last = k + 2
    assert two.ana.undo()
    for _ in range(chance.randint(1, 2)):
        kept = json.loads(json.dumps(two.ana.store_data()))
        two.ana = Page.of("a", two.program.news("a", -1, ""), kept)
    assert f"F({last - 1}, 80)" in two.meet()
    assert not two.ana.undo()
    assert two.ana.redo()
    assert f"F({last}, 80)" in two.meet()


def test_a_page_that_gets_another_name_loses_nothing_and_doubles_nothing(two: Two) -> None:
    two.inserts(two.ana, ROOT, two.find("L(1, 60)"))
    two.program.submit(two.ana.pending_changes)  # and the answer is lost
    two.types(two.ana, "F(1, 80)", "F(2, 80)")
    for time_s, name in enumerate("zyx", 2):
        stored_data = json.loads(json.dumps(two.ana.store_data()))
        two.ana = Page.of(name, two.program.news(name, -1, ""), stored_data)
        two.types(two.ana, f"L({time_s - 1}, 60)", f"L({time_s}, 60)")  # before the rest is sent
        two.types(two.ana, f"W({time_s - 1})", f"W({time_s})")
    assert two.meet().count("BEEP(1, 440)") == 1
    assert all(change in two.meet() for change in ("F(2, 80)", "L(4, 60)", "W(4)"))


def test_a_copy_of_a_page_goes_its_own_way(two: Two) -> None:
    before: list[Any] = [two.ana.lines[:], data(two.ana)]
    copy = two.ana.copy()
    two.types(two.ana, "F(1, 80)", "F(2, 80)")
    two.types(two.ana, "W(1);", "W(", is_hot=True)
    assert [copy.lines, data(copy)] == before
    two.ana = copy
    two.types(two.ana, "F(1, 80)", "F(3, 80)")
    assert "F(3, 80)" in two.meet()


FLAT_PROGRAM = "SI|S\n" + "".join(f"F({number}, 80)\n" for number in range(1, 6))


def edits(page: Page, chance: Random) -> None:
    """Put a line in, take one out or change one, as somebody types it."""
    rows = page.lines[:]
    k = chance.randrange(1, len(rows))
    line = f"{chance.choice('FBLR')}({chance.randrange(1, 99)}, 40);"
    if len(rows) > 4 and chance.random() < 0.4:
        del rows[k]
    else:
        rows[k : k + chance.randrange(2)] = [line]
    page.type(rows, min(k, len(rows) - 1))
    page.leave()


def program_of(page: Page) -> list[str]:
    return [row.rstrip(";") for row in page.lines]


def exchange(two: Two, message: str) -> None:
    """Send what Ana has changed, send it and lose the answer, or receive what is new."""
    if message == "send":
        two.sends(two.ana)
    elif message == "lose":
        two.program.submit(two.ana.pending_changes)
    else:
        two.hears(two.ana)


def list_shown_pages(seed: int, makes_copies: bool) -> list[Any]:
    """Return what Ana's page shows after each step, with a copy in its place each time, or as it
    is. Nothing hears of what is changed on the old page then."""
    chance, other_chance, two = Random(seed), Random(seed), Two(FLAT_PROGRAM)
    seen = list[Any]()
    for _ in range(40):
        if makes_copies:
            before, two.ana = two.ana, two.ana.copy()
            for do in (before.undo, before.redo, partial(edits, before, other_chance), before.undo):
                do()
        match chance.choice(("edit", "edit", "luz", "undo", "redo", "send", "lose", "hear")):
            case "edit":
                edits(two.ana, chance)
            case "luz":
                edits(two.luz, chance)
                two.sends(two.luz)
            case "undo" | "redo" as does_back:
                seen.append(two.ana.undo() if does_back == "undo" else two.ana.redo())
            case message:
                exchange(two, message)
        seen.append([two.ana.lines[:], data(two.ana)])
    return [*seen, two.meet()]


@pytest.mark.parametrize("seed", range(20))
def test_a_copy_goes_on_as_the_page_itself_and_hears_nothing_of_it(seed: int) -> None:
    assert list_shown_pages(seed, makes_copies=True) == list_shown_pages(seed, makes_copies=False)


@pytest.mark.parametrize("seed", range(20))
def test_what_is_typed_before_and_after_any_reload_is_the_program(seed: int) -> None:
    """Whichever messages were sent, received or lost then, no text is refused, lost or
    duplicated."""
    chance, two = Random(seed), Two(FLAT_PROGRAM)
    for _ in range(60):
        typed = program_of(two.ana)
        match chance.choice(("edit", "edit", "send", "lose", "hear", "reload", "reload")):
            case "edit":
                edits(two.ana, chance)
                continue
            case "reload":
                stored_data = json.loads(json.dumps(two.ana.store_data()))
                two.ana = Page.of("a", two.program.news("a", -1, ""), stored_data)
            case message:
                exchange(two, message)
        assert program_of(two.ana) == typed
    typed = program_of(two.ana)
    two.meet()
    assert program_of(two.luz) == program_of(two.ana) == typed and not two.ana.refusals


def data(page: Page) -> Any:
    return [page.store_data(), list(map(data_of_change, page.pending_changes))]


def test_a_page_whose_tree_is_another_one_asks_for_the_whole(two: Two) -> None:
    two.ana.base.node_by_id[two.find("F(1, 80)")].text = "F(9, 80)"  # whatever the cause
    two.hears(two.ana)
    assert two.ana.is_astray
    two.ana.receive(two.program.news("a", -1, two.ana.epoch))
    assert not two.ana.is_astray
    assert "SI|F(1, 80);" in two.ana.lines


def test_a_redo_takes_back_an_undo_until_something_else_is_done(two: Two) -> None:
    two.types(two.ana, "B(1, 40)", "B(9, 40)")
    two.types(two.luz, "R(1, 40)", "R(5, 40)")
    before = two.meet()
    assert not two.ana.redo()
    for _ in range(2):
        assert two.ana.undo()
        assert "B(1, 40)" in two.meet()
        assert two.ana.redo()
        assert two.meet() == before
    assert two.ana.undo()
    two.meet()
    two.types(two.ana, "L(1, 60)", "L(2, 60)")
    two.meet()
    assert not two.ana.redo()


@pytest.mark.parametrize("seed", range(6))
def test_as_many_redos_as_undos_bring_all_back(seed: int) -> None:
    chance, two = Random(seed), Two(FLAT_PROGRAM)
    texts = [two.meet()]
    for number in range(1, 6):
        two.types(two.ana, f"F({number}, 80)", f"F({number}1, 80)")
        texts.append(two.meet())
    for _ in range(4):
        count_back = chance.randrange(1, 5)
        for done in range(count_back):
            assert two.ana.undo() and two.meet() == texts[-2 - done]
        for done in reversed(range(count_back)):
            assert two.ana.redo() and two.meet() == texts[-1 - done]
