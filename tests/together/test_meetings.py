"""Conflicts of two pupils: the winner, refusals and drafts, and the effect of undo."""

from __future__ import annotations

import json
import re
from functools import partial
from itertools import count
from random import Random
from typing import Any

import pytest

from tests.together.applying import apply_edits
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


class PagePair:
    """Ana and Luz edit one program; what Ana does reaches the computer first."""

    def __init__(self, text: str = TEXT) -> None:
        ids = count(1)
        self.program = SharedProgram(parse_tree(text, lambda: f"i.{next(ids)}"), "e")
        self.ana, self.luz = (Page.of(name, self.program.news(name, -1, "")) for name in "al")

    def find(self, text: str) -> str:
        tree = self.program.tree
        return next(id for id in tree.subtree_ids() if tree[id].text == text)

    def send(self, page: Page) -> None:
        self.program.submit(page.pending_changes)
        self.hear(page)

    def hear(self, page: Page) -> None:
        page.receive(self.program.news(page.name, page.number, page.epoch))

    def meet(self) -> str:
        """Return the program on one line, once both have heard all."""
        for page in (self.ana, self.luz) * 2:
            self.send(page)
        assert self.ana.base.checksum() == self.luz.base.checksum()
        assert self.ana.view.checksum() == self.program.tree.checksum()
        assert self.luz.view.checksum() == self.program.tree.checksum()
        return " ".join(text_of(self.program.tree).split())

    def insert(self, page: Page, container: str, previous: str, text: str = "BEEP(1, 440)") -> None:
        node = Subtree(page.new_id(), text)
        assert apply_edits(page, [Insert(Place(container, previous), (node,))])

    def type(self, page: Page, old_text: str, new_text: str, is_hot: bool = False) -> None:
        """Change part of a line, and leave it unless it `is_hot`."""
        [k] = [k for k, row in enumerate(page.lines) if old_text in row]
        rows = page.lines[:]
        rows[k] = rows[k].replace(old_text, new_text)
        page.type(rows, k, is_hot)
        page.flush()


@pytest.fixture
def pair() -> PagePair:
    return PagePair()


def test_a_delete_spares_changes_unseen_by_its_author(pair: PagePair) -> None:
    loop = pair.find("LOOP(3)")
    pair.insert(pair.ana, loop, pair.find("B(1, 40)"))
    apply_edits(pair.luz, [Delete(tuple(pair.luz.view.subtree_ids(loop)))])
    assert "LOOP(3); B(1, 40); BEEP(1, 440);" in pair.meet()
    assert pair.luz.refusals[-1][1] == HAS_NEW
    assert "  BEEP(1, 440);" in pair.luz.lines


def test_a_branch_is_deleted_with_all_its_contents_or_not_at_all(pair: PagePair) -> None:
    pair.insert(pair.ana, pair.find("IF(X < 1)"), pair.find("ELSE"))
    rows = [row for row in pair.luz.lines if "ELSE" not in row and "W(1)" not in row]
    pair.luz.type(rows, 0)
    pair.luz.flush()
    assert "ELSE; BEEP(1, 440); W(1)" in pair.meet()
    assert pair.luz.refusals[-1][1] == HAS_NEW


def test_a_new_block_encloses_instructions_inserted_meanwhile(pair: PagePair) -> None:
    first_id, last_id = pair.find("B(1, 40)"), pair.find("R(1, 40)")
    pair.insert(pair.ana, pair.find("LOOP(3)"), first_id)
    apply_edits(pair.luz, [Wrap((first_id, last_id), Subtree(pair.luz.new_id(), "WHILE(X < 2)"))])
    assert "WHILE(X < 2); B(1, 40); BEEP(1, 440); R(1, 40); END_WHILE;" in pair.meet()


def test_a_place_whose_neighbour_was_deleted_is_kept(pair: PagePair) -> None:
    apply_edits(pair.ana, [Delete((pair.find("R(1, 40)"),))])
    pair.insert(pair.luz, pair.find("LOOP(3)"), pair.find("R(1, 40)"))
    assert "B(1, 40); BEEP(1, 440); END_LOOP" in pair.meet()


def test_the_first_place_of_a_removed_block_is_kept(pair: PagePair) -> None:
    apply_edits(pair.ana, [Unwrap(pair.find("LOOP(3)"))])
    pair.insert(pair.luz, pair.find("LOOP(3)"), "")
    assert "F(1, 80); BEEP(1, 440); B(1, 40); R(1, 40); IF" in pair.meet()


def test_two_blocks_moved_into_each_other_form_no_cycle(pair: PagePair) -> None:
    loop, branch = pair.find("LOOP(3)"), pair.find("IF(X < 1)")
    apply_edits(pair.ana, [Move((loop,), Place(branch, ""))])
    apply_edits(pair.luz, [Move((branch,), Place(loop, ""))])
    assert "IF(X < 1); LOOP(3)" in pair.meet()
    assert pair.luz.refusals[-1][1] == CIRCLE


def test_the_later_of_two_values_wins_and_undo_restores_the_other(pair: PagePair) -> None:
    pair.type(pair.ana, "F(1, 80)", "F(2, 80)")
    pair.type(pair.luz, "F(1, 80)", "F(1, 99)")
    assert "F(1, 99)" in pair.meet()
    assert any("F(2, 80)" in str(change) for change in pair.program.taken_changes)
    assert not pair.ana.undo()  # her text is gone
    assert pair.luz.undo()
    assert "F(2, 80)" in pair.meet()
    assert pair.ana.undo()  # now it is
    assert "F(1, 80)" in pair.meet()


def test_an_undo_after_another_pupils_change_is_refused(pair: PagePair) -> None:
    pair.type(pair.luz, "F(1, 80)", "F(1, 99)")
    pair.meet()
    pair.type(pair.ana, "F(1, 99)", "F(5, 99)")
    assert pair.luz.undo()
    assert "F(5, 99)" in pair.meet()
    assert pair.luz.refusals[-1][1] == CHANGED


def test_undo_restores_deleted_blocks_with_their_ids(pair: PagePair) -> None:
    loop = pair.find("LOOP(3)")
    text_before = text_of(pair.program.tree)
    apply_edits(pair.ana, [Delete(tuple(pair.ana.view.subtree_ids(loop)))])
    pair.meet()
    assert pair.ana.undo()
    pair.meet()
    assert text_of(pair.program.tree) == text_before
    assert loop in pair.program.tree


def test_a_line_cut_and_pasted_by_two_exists_once(pair: PagePair) -> None:
    for page in (pair.ana, pair.luz):
        page.type([row for row in page.lines if "L(1, 60)" not in row], 0)
        page.flush()
    for page, k in ((pair.ana, 1), (pair.luz, 3)):
        page.type([*page.lines[:k], "L(1, 60)", *page.lines[k:]], 0)
        page.flush()
    assert pair.meet().count("L(1, 60)") == 1


def test_a_page_makes_no_change_that_leaves_no_program() -> None:
    two = PagePair("DEF TURN\nR(1, 40)\nEND_DEF\nLOOP(2)\nTURN\nEND_LOOP\n")
    page, turn = two.ana, two.find("TURN")
    assert not apply_edits(page, [Move((two.find("DEF TURN"),), Place(two.find("LOOP(2)"), ""))])
    for text in ("S; S", "END_LOOP", "s", "S // note", "LOOP(2)", ""):
        assert not apply_edits(page, [Replace(turn, (("text", text),))])
    assert not page.pending_changes


def test_a_line_being_typed_is_deleted_only_with_its_instruction(
    pair: PagePair,
) -> None:
    pair.type(pair.ana, "B(1, 40);", "B(1, 4", is_hot=True)
    assert not pair.ana.pending_changes
    apply_edits(pair.luz, [Move((pair.find("B(1, 40)"),), Place(ROOT, pair.find("L(1, 60)")))])
    pair.send(pair.luz)
    pair.hear(pair.ana)
    assert pair.ana.lines[-1] == "  B(1, 4"
    assert pair.ana.caret == len(pair.ana.lines) - 1
    apply_edits(pair.luz, [Delete((pair.find("B(1, 40)"),))])
    pair.send(pair.luz)
    pair.hear(pair.ana)
    assert pair.ana.lines[-1] == "  B(1, 4"
    pair.ana.type([*pair.ana.lines[:-1], "B(1, 45)"], len(pair.ana.lines) - 1)
    pair.ana.flush()
    assert pair.meet().endswith("L(1, 60); B(1, 45);")
    assert "i.3" in pair.program.tree  # the same instruction


def test_a_half_typed_value_is_not_a_change_even_if_it_parses(pair: PagePair) -> None:
    for shown in ("L(1, 6);", "L(1, 9);", "L(1, 95);"):
        old_row = next(row for row in pair.ana.lines if "L(1" in row)
        pair.type(pair.ana, old_row, shown, is_hot=True)
    assert "L(1, 60)" in pair.meet()
    pair.ana.leave()
    assert "L(1, 95)" in pair.meet()
    assert sum("L(1, 9" in str(change) for change in pair.program.taken_changes) == 1


def test_only_the_last_of_successively_typed_lines_waits(pair: PagePair) -> None:
    k = pair.ana.lines.index("L(1, 60);")
    for row in ("W(2)", "f(3,70)", "LOOP(2)", "BEEP(1, 440)", "END_LOOP"):
        rows = pair.ana.lines[:]
        rows[k:k] = [row] if rows[k] else []
        rows[k] = row
        pair.ana.type([*rows[: k + 1], "", *rows[k + 1 :]], k + 1, True)
        pair.ana.flush()
        k = pair.ana.caret
        assert pair.ana.lines[k] == ""
        assert len(pair.ana.drafts) == 1 + (row in ("LOOP(2)", "BEEP(1, 440)"))
    pair.send(pair.ana)
    pair.hear(pair.luz)
    assert "W(2); F(3, 70); LOOP(2); BEEP(1, 440); END_LOOP; L(1, 60);" in " ".join(
        " ".join(pair.luz.lines).split()
    )
    pair.ana.leave()
    pair.meet()
    assert pair.luz.lines[-3:] == ["END_LOOP;", "", "L(1, 60);"]  # the empty line is there for all


def test_a_value_typed_into_what_was_deleted_is_a_draft_again(pair: PagePair) -> None:
    apply_edits(pair.luz, [Delete((pair.find("R(1, 40)"),))])
    pair.type(pair.ana, "R(1, 40)", "R(2, 40)")
    for page in (pair.luz, pair.ana) * 2:
        pair.send(page)
    assert "R(2, 40)" in pair.ana.lines
    assert "R(2, 40)" not in pair.meet()
    rows = [row + " " if row == "R(2, 40)" else row for row in pair.ana.lines]
    pair.ana.type(rows, 3)  # wanted all the same
    pair.ana.leave()
    assert "B(1, 40); R(2, 40); END_LOOP" in pair.meet()
    assert "i.4" in pair.program.tree


def test_a_reloaded_page_continues(pair: PagePair) -> None:
    pair.type(pair.ana, "F(1, 80)", "F(2, 80)")
    pair.type(pair.ana, "W(1);", "W(9)", is_hot=True)
    stored_data = json.loads(json.dumps(pair.ana.store_data()))
    pair.type(pair.luz, "L(1, 60)", "L(3, 60)")
    pair.send(pair.luz)
    pair.ana = Page.of("a", pair.program.news("a", -1, ""), stored_data)
    assert pair.ana.lines[pair.ana.caret] == "  W(9)"
    pair.ana.leave()  # no one has continued that line
    assert "F(2, 80)" in pair.meet()
    assert "W(1)" in pair.meet()
    assert "L(3, 60)" in " ".join(pair.ana.lines)
    pair.type(pair.ana, "W(9)", "W(95)")
    assert "W(95)" in pair.meet()


@pytest.mark.parametrize("seed", range(10))
def test_undone_changes_can_be_redone_after_a_reload(seed: int) -> None:
    """The reload comes before the computer has heard of the undo."""
    rng, two = Random(seed), PagePair()
    for k in range(rng.randint(1, 3)):
        two.type(two.ana, f"F({k + 1}, 80)" if k else "F(1, 80)", f"F({k + 2}, 80)")
        two.send(two.ana)
    last_value = k + 2
    assert two.ana.undo()
    for _ in range(rng.randint(1, 2)):
        stored_data = json.loads(json.dumps(two.ana.store_data()))
        two.ana = Page.of("a", two.program.news("a", -1, ""), stored_data)
    assert f"F({last_value - 1}, 80)" in two.meet()
    assert not two.ana.undo()
    assert two.ana.redo()
    assert f"F({last_value}, 80)" in two.meet()


def test_a_renamed_page_loses_and_duplicates_nothing(pair: PagePair) -> None:
    pair.insert(pair.ana, ROOT, pair.find("L(1, 60)"))
    pair.program.submit(pair.ana.pending_changes)  # and the answer is lost
    pair.type(pair.ana, "F(1, 80)", "F(2, 80)")
    for time_s, name in enumerate("zyx", 2):
        stored_data = json.loads(json.dumps(pair.ana.store_data()))
        pair.ana = Page.of(name, pair.program.news(name, -1, ""), stored_data)
        pair.type(pair.ana, f"L({time_s - 1}, 60)", f"L({time_s}, 60)")  # before the rest is sent
        pair.type(pair.ana, f"W({time_s - 1})", f"W({time_s})")
    assert pair.meet().count("BEEP(1, 440)") == 1
    assert all(change in pair.meet() for change in ("F(2, 80)", "L(4, 60)", "W(4)"))


def test_a_copy_of_a_page_is_independent(pair: PagePair) -> None:
    data_before: list[Any] = [pair.ana.lines[:], data(pair.ana)]
    copy = pair.ana.copy()
    pair.type(pair.ana, "F(1, 80)", "F(2, 80)")
    pair.type(pair.ana, "W(1);", "W(", is_hot=True)
    assert [copy.lines, data(copy)] == data_before
    pair.ana = copy
    pair.type(pair.ana, "F(1, 80)", "F(3, 80)")
    assert "F(3, 80)" in pair.meet()


FLAT_PROGRAM = "SI|S\n" + "".join(f"F({number}, 80)\n" for number in range(1, 6))


def edit_line(page: Page, rng: Random) -> None:
    """Put a line in, take one out or change one, as somebody types it."""
    rows = page.lines[:]
    k = rng.randrange(1, len(rows))
    line = f"{rng.choice('FBLR')}({rng.randrange(1, 99)}, 40);"
    if len(rows) > 4 and rng.random() < 0.4:
        del rows[k]
    else:
        rows[k : k + rng.randrange(2)] = [line]
    page.type(rows, min(k, len(rows) - 1))
    page.leave()


def retype(page: Page, rng: Random) -> None:
    """Give an instruction another value."""
    k = rng.randrange(1, len(page.lines))
    value = f"({rng.randrange(1, 99)},"
    page.type([re.sub(r"\(\d+,", value, row) if row_number == k else row
               for row_number, row in enumerate(page.lines)], k)  # fmt: skip
    page.leave()


def program_of(page: Page) -> list[str]:
    return [row.rstrip(";") for row in page.lines]


def exchange(two: PagePair, message: str) -> None:
    """Send what Ana has changed, send it and lose the answer, or receive what is new."""
    if message == "send":
        two.send(two.ana)
    elif message == "lose":
        two.program.submit(two.ana.pending_changes)
    else:
        two.hear(two.ana)


def list_shown_pages(seed: int, makes_copies: bool) -> list[Any]:
    """Return what Ana's page shows after each step, with a copy in its place each time, or as it
    is. Nothing hears of what is changed on the old page then."""
    rng, other_rng, two = Random(seed), Random(seed), PagePair(FLAT_PROGRAM)
    results = list[Any]()
    for _ in range(40):
        if makes_copies:
            old_page, two.ana = two.ana, two.ana.copy()
            for function in (
                old_page.undo,
                old_page.redo,
                partial(edit_line, old_page, other_rng),
                old_page.undo,
            ):
                function()
        match rng.choice(("edit", "edit", "luz", "undo", "redo", "send", "lose", "hear")):
            case "edit":
                edit_line(two.ana, rng)
            case "luz":
                edit_line(two.luz, rng)
                two.send(two.luz)
            case "undo" | "redo" as does_back:
                results.append(two.ana.undo() if does_back == "undo" else two.ana.redo())
            case message:
                exchange(two, message)
        results.append([two.ana.lines[:], data(two.ana)])
    return [*results, two.meet()]


@pytest.mark.parametrize("seed", range(20))
def test_a_copy_continues_like_the_page_without_its_messages(seed: int) -> None:
    assert list_shown_pages(seed, makes_copies=True) == list_shown_pages(seed, makes_copies=False)


@pytest.mark.parametrize("seed", range(20))
def test_text_typed_before_and_after_a_reload_is_in_the_program(seed: int) -> None:
    """Whichever messages were sent, received or lost then, no text is refused, lost or
    duplicated."""
    rng, two = Random(seed), PagePair(FLAT_PROGRAM)
    for _ in range(60):
        typed_text = program_of(two.ana)
        match rng.choice(("edit", "edit", "send", "lose", "hear", "reload", "reload")):
            case "edit":
                edit_line(two.ana, rng)
                continue
            case "reload":
                stored_data = json.loads(json.dumps(two.ana.store_data()))
                two.ana = Page.of("a", two.program.news("a", -1, ""), stored_data)
            case message:
                exchange(two, message)
        assert program_of(two.ana) == typed_text
    typed_text = program_of(two.ana)
    two.meet()
    assert program_of(two.luz) == program_of(two.ana) == typed_text and not two.ana.refusals


@pytest.mark.parametrize("seed", range(20))
def test_a_reload_shows_what_the_news_show(seed: int) -> None:
    """Whatever both have changed, and whatever the computer has refused meanwhile."""
    rng, two = Random(seed), PagePair(FLAT_PROGRAM)
    for _ in range(60):
        match rng.choice(("edit", "retype", "retype", "luz", "luz", "lose", "hear", "reload")):
            case "edit":
                edit_line(two.ana, rng)
            case "retype":
                retype(two.ana, rng)
            case "luz":
                edit_line(two.luz, rng)
                two.send(two.luz)
            case "reload":
                stored_data = json.loads(json.dumps(two.ana.store_data()))
                two.hear(two.ana)
                reloaded_page = Page.of("a", two.program.news("a", -1, ""), stored_data)
                assert reloaded_page.lines == two.ana.lines
                two.ana = reloaded_page
            case message:
                exchange(two, message)
    two.meet()


def data(page: Page) -> Any:
    return [page.store_data(), list(map(data_of_change, page.pending_changes))]


def test_a_page_with_a_different_tree_requests_the_whole_program(pair: PagePair) -> None:
    pair.ana.base.node_by_id[pair.find("F(1, 80)")].text = "F(9, 80)"  # whatever the cause
    pair.hear(pair.ana)
    assert pair.ana.is_out_of_sync
    pair.ana.receive(pair.program.news("a", -1, pair.ana.epoch))
    assert not pair.ana.is_out_of_sync
    assert "SI|F(1, 80);" in pair.ana.lines


def test_a_redo_reverts_an_undo_until_the_next_change(pair: PagePair) -> None:
    pair.type(pair.ana, "B(1, 40)", "B(9, 40)")
    pair.type(pair.luz, "R(1, 40)", "R(5, 40)")
    text_before = pair.meet()
    assert not pair.ana.redo()
    for _ in range(2):
        assert pair.ana.undo()
        assert "B(1, 40)" in pair.meet()
        assert pair.ana.redo()
        assert pair.meet() == text_before
    assert pair.ana.undo()
    pair.meet()
    pair.type(pair.ana, "L(1, 60)", "L(2, 60)")
    pair.meet()
    assert not pair.ana.redo()


@pytest.mark.parametrize("seed", range(6))
def test_as_many_redos_as_undos_restore_everything(seed: int) -> None:
    rng, two = Random(seed), PagePair(FLAT_PROGRAM)
    texts = [two.meet()]
    for number in range(1, 6):
        two.type(two.ana, f"F({number}, 80)", f"F({number}1, 80)")
        texts.append(two.meet())
    for _ in range(4):
        count_back = rng.randrange(1, 5)
        for redo_count in range(count_back):
            assert two.ana.undo() and two.meet() == texts[-2 - redo_count]
        for redo_count in reversed(range(count_back)):
            assert two.ana.redo() and two.meet() == texts[-1 - redo_count]
