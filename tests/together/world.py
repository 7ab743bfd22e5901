"""A clock, a class's computer, pages with pupils, and a network that delays, loses and breaks off.

The program's invariants can be checked at any time.
"""

from __future__ import annotations

import heapq
import json
import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from itertools import count
from random import Random
from typing import Any

from tests.together.pupils import Pupil
from tiniscript import compile_text, robots
from tiniscript.base.source import Source
from tiniscript.studio.block_printing import format_blocks
from tiniscript.studio.block_reading import read_blocks as read_blocks
from tiniscript.syntax.ast import Break, Def, If, Instruction, Loop, Task, While
from tiniscript.syntax.formatter import format_source
from tiniscript.syntax.parser import parse
from tiniscript.together.form import (
    Delete,
    Insert,
    Operation,
    Replace,
    TakenChange,
    Unwrap,
    Wrap,
    change_of,
    data_of_change,
    page_and_count,
)
from tiniscript.together.layout import parse_tree, text_of
from tiniscript.together.ordering import SharedProgram, program_of
from tiniscript.together.page import Page
from tiniscript.together.tree import BLOCK, INSTRUCTION, ROOT, START, Tree

Json = dict[str, Any]
KIT = robots.load("tinibot").kit
FIRST_PROGRAM = """// Our robot.
SI|X = 0;
LOOP(100001);
  F(100002, 50);
  IF(DISTANCE < 100003);  // near
    B(100004, 50);
  ELSE;
    R(100005, 50);
  ENDIF;
  W(100006);
END_LOOP;

BEEP(100007, 440);
S;
"""
REQUEST_INTERVAL_S = 0.5  # between the answer and the next request of a page
RETRY_S = 9.0  # after which a page asks again


class World:
    """`delay` is of one way; `loss_rate`: of messages. A crash begins an epoch."""

    def __init__(
        self, pages: int, seed: int, delay: Callable[[Random], float] = lambda r: r.uniform(0, 5),
        loss_rate: float = 0.05, asks_s: float = REQUEST_INTERVAL_S, spread: float = 0.5,
    ) -> None:  # fmt: skip
        self.rng = Random(seed)
        self.now_s = 0.0
        self.counts: Counter[str] = Counter()
        self.refusals_by_reason: Counter[str] = Counter()
        self.replaced_unseen = 0
        self._queue: list[tuple[float, int, Callable[..., None], tuple[Any, ...]]] = []
        self._order = count()
        self._delay, self._loss_rate, self._asks_s = delay, loss_rate, asks_s
        ids, numbers = count(1), count(200_000)
        self._rows: list[Json] = []  # the journal
        self.taken_changes: list[TakenChange] = []
        self.program = SharedProgram(
            parse_tree(FIRST_PROGRAM, lambda: f"i.{next(ids)}"), "e0", self._keep
        )
        self._snapshot = self._send_and_parse(self.program.snapshot())
        self.first_ids = set(self.program.tree.node_by_id)
        tree = self.program.tree
        self.typed_texts = {
            text for id in self.first_ids for text in (tree[id].text, tree[id].note)
        }
        names = "abcd"[:pages]
        self.pupils = {
            name: Pupil(Page.of(name, self.program.news(name, -1, "")), self.rng, numbers,
                        self.typed_texts, self.counts, spread)
            for name in names
        }  # fmt: skip
        self.off_until_s = dict.fromkeys(names, 0.0)
        self.turn = dict.fromkeys(names, 0)

    def schedule(self, after_s: float, function: Callable[..., None], *arguments: Any) -> None:
        heapq.heappush(self._queue, (self.now_s + after_s, next(self._order), function, arguments))

    def run(self, is_over: Callable[[], bool]) -> None:
        while self._queue and not is_over():
            self.now_s, _, function, arguments = heapq.heappop(self._queue)
            function(*arguments)

    def _send_and_parse(self, data: Json) -> Json:
        copy: Json = json.loads(json.dumps(data))
        return copy

    def _keep(self, row: Json) -> None:
        self._rows.append(self._send_and_parse(row))

    # -- network ----------------------------------------------------------------------------------

    def ask(self, name: str, turn: int) -> None:
        """Send pending changes and ask for news; a page without an answer asks again."""
        if turn != self.turn[name]:
            return
        page = self.pupils[name].page
        if self.now_s < self.off_until_s[name]:
            self.schedule(0.5, self.ask, name, turn)
            return
        self.schedule(RETRY_S, self._ask_again, name, turn)
        if self.rng.random() >= self._loss_rate:
            sent_data = self._send_and_parse(
                {"sent": [data_of_change(change) for change in page.pending_changes]}
            )
            seen_number = -1 if page.is_out_of_sync else page.number
            self.schedule(
                self._delay(self.rng),
                self._reach,
                name,
                turn,
                sent_data,
                seen_number,
                page.epoch,
            )

    def _ask_again(self, name: str, turn: int) -> None:
        if turn == self.turn[name]:
            self.turn[name] += 1
            self.ask(name, self.turn[name])

    def _reach(self, name: str, turn: int, sent_data: Json, seen_number: int, epoch: str) -> None:
        self.submit(sent_data["sent"])
        news = self._send_and_parse(self.program.news(name, seen_number, epoch))
        if self.rng.random() >= self._loss_rate and self.now_s >= self.off_until_s[name]:
            self.schedule(self._delay(self.rng), self._arrive, name, turn, news)

    def submit(self, sent_data: Sequence[Json]) -> None:
        for row in sent_data:
            change, program = change_of(row), self.program
            page, _ = page_and_count(change.uid)
            decided, tree_before = program.last_count_by_page.get(page, 0), program.tree
            if program.submit([change]):
                self.taken_changes.append(program.taken_changes[-1])
                self._count_unseen(tree_before, page, change.seen_number)
            elif program.last_count_by_page.get(page, 0) > decided:
                self.refusals_by_reason[program.refusals_by_page[page][-1][1]] += 1

    def _count_unseen(self, tree_before: Tree, page: str, seen_number: int) -> None:
        """Count values of others that this page had not seen and has replaced."""
        for operation in self.taken_changes[-1].operations:
            if isinstance(operation, Replace) and operation.id in tree_before:
                by = tree_before[operation.id].mark(operation.fields[0][0])
                self.replaced_unseen += (
                    bool(by)
                    and page_and_count(by)[0] != page
                    and any(
                        change.uid == by and change.number > seen_number
                        for change in self.taken_changes[-50:]
                    )
                )

    def _arrive(self, name: str, turn: int, news: Json) -> None:
        if self.now_s < self.off_until_s[name]:
            return
        page = self.pupils[name].page
        page.receive(news)
        self.counts["astray"] += page.is_out_of_sync and page.epoch == self.program.epoch
        if turn == self.turn[name]:
            self.turn[name] += 1
            self.schedule(self._asks_s, self.ask, name, self.turn[name])

    def reload(self, name: str) -> None:
        """The page is reloaded; it has the data stored in its browser."""
        pupil = self.pupils[name]
        pupil.page.flush()
        stored_data = self._send_and_parse(pupil.page.store_data())
        news = self._send_and_parse(self.program.news(name, -1, ""))
        pupil.page = Page.of(name, news, stored_data)
        self.turn[name] += 1
        self.ask(name, self.turn[name])

    def crash(self) -> None:
        """The class's computer goes on from its journal."""
        old_program = self.program
        self.program = program_of(self._snapshot, self._keep)
        self.program.replay(self._rows)
        assert self.program.tree.checksum() == old_program.tree.checksum()
        assert (self.program.number, self.program.last_count_by_page) == (
            old_program.number,
            old_program.last_count_by_page,
        )
        self.counts["crashes"] += 1
        self.program.epoch = f"e{self.counts['crashes']}"

    # -- laws -------------------------------------------------------------------------------------

    def settle(self) -> None:
        """Everybody comes to an end, and hears all."""
        for pupil in self.pupils.values():
            pupil.finish()
        for _ in range(4):
            for name, pupil in self.pupils.items():
                page = pupil.page
                self.submit(
                    self._send_and_parse({"": list(map(data_of_change, page.pending_changes))})[""]
                )
                seen_number = -1 if page.is_out_of_sync else page.number
                page.receive(self._send_and_parse(self.program.news(name, seen_number, page.epoch)))
                page.give_up()  # changes refused just now

    def check(self) -> None:
        tree = self.program.tree
        text = text_of(tree)
        parsed = parse(Source(text))
        assert not [diagnostic for diagnostic in parsed.diagnostics if diagnostic.is_mistake], text
        assert format_source(Source(text)) == text
        self._check_instructions(tree, text, parsed.program.body)
        assert parse_tree(text).shape() == tree.shape()
        # The page's own blocks form the same program.
        round_tripped = format_blocks(read_blocks(text, KIT)).text
        result, other_result = (
            compile_text(_with_x_set(text), KIT),
            compile_text(_with_x_set(round_tripped), KIT),
        )
        assert result.image and result.image == other_result.image, (
            text,
            round_tripped,
            result.diagnostics,
        )
        # No two pupils' values were mixed; no node is there twice.
        for node in tree.node_by_id.values():
            assert node.text in self.typed_texts or node.id in (ROOT, START), node.text
            assert not node.note or node.note in self.typed_texts, node.note
        ids = tree.subtree_ids()
        assert len(ids) == len(set(ids)) == len(tree.node_by_id)
        numbered = Counter(tree[id].text for id in ids if re.search("[0-9]", tree[id].text))
        twice = [text for text, times in numbered.items() if times > 1]
        assert not twice, twice

    def _check_instructions(self, tree: Tree, text: str, body: Sequence[Instruction]) -> None:
        """Each node is one instruction of the AST, in order, with the text that it has."""
        nodes = [tree[id] for id in tree.subtree_ids()[1:] if id != START]
        nodes = [node for node in nodes if node.kind in (INSTRUCTION, BLOCK)]
        walked = list(_walk(body))
        assert len(nodes) == len(walked), text
        for node, (instruction, kind) in zip(nodes, walked, strict=True):
            assert node.kind == kind
            if kind == INSTRUCTION and not isinstance(instruction, Break):
                span = instruction.span
                assert text[span.start : span.end] == node.text

    def check_pages(self) -> None:
        tree = self.program.tree
        for pupil in self.pupils.values():
            page = pupil.page
            assert not page.pending_changes and not page.drafts and not page.is_out_of_sync
            assert page.base.checksum() == page.view.checksum() == tree.checksum()
            assert "\n".join(page.lines) == text_of(tree).rstrip("\n")

    def check_nothing_is_lost(self) -> None:
        """Every node is still there unless a delete or an unwrap removed it."""
        alive_ids = set(self.first_ids)
        for change in self.taken_changes:
            for operation in change.operations:
                alive_ids |= _list_added_ids(operation)
                if isinstance(operation, Delete):
                    alive_ids -= set(operation.ids)
                elif isinstance(operation, Unwrap):
                    alive_ids.discard(operation.id)
        assert alive_ids == set(self.program.tree.node_by_id)


def _list_added_ids(operation: Operation) -> set[str]:
    if isinstance(operation, Insert):
        return {id for node in operation.nodes for id in node.ids()}
    return {operation.node.id} if isinstance(operation, Wrap) else set()


def _with_x_set(text: str) -> str:
    """Give X a value, because the line that assigns it may have been deleted."""
    start = re.search(r"\b(SI|SB)\|", text)
    return text.replace(start[0], "X = 0\n", 1) if start else "X = 0\n" + text


def _walk(body: Sequence[Instruction]) -> Iterator[tuple[Instruction, str]]:
    for instruction in body:
        if isinstance(instruction, If):
            yield instruction, BLOCK
            for arm in instruction.arms:
                yield from _walk(arm.body)
            yield from _walk(instruction.else_body)
        elif isinstance(instruction, Loop | While | Def | Task):
            yield instruction, BLOCK
            yield from _walk(instruction.body)
        else:
            yield instruction, INSTRUCTION
