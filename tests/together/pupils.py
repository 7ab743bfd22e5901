"""Pupils that write by chance: with blocks, and with the keyboard, a few keys at a time.

Each instruction that they write has a new number, which shows whether values of two were mixed or a
node is there twice.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from random import Random

from tests.together.applying import apply_edits
from tiniscript.syntax.formatter import instruction_text
from tiniscript.syntax.lexer import scan
from tiniscript.together.form import Delete, Insert, Move, Operation, Place, Replace, Unwrap, Wrap
from tiniscript.together.page import Page
from tiniscript.together.tree import ARM, BLOCK, INSTRUCTION, NOTE, ROOT, START, Subtree, Tree

Text = list[str]
Stage = Callable[[Text, int], tuple[Text, int, bool]]  # the editor's text after some keys
VALUES = {
    "F": "F({}, 50)", "B": "B({}, 50)", "L": "L({}, 60)", "R": "R({}, 60)", "W": "W({})",
    "LOOP": "LOOP({})", "WHILE": "WHILE(X < {})", "IF": "IF(X > {})", "ELSEIF": "ELSEIF(X > {})",
    "SHOW": "SHOW({})", "BEEP": "BEEP({}, 440)",
}  # fmt: skip
EDIT_KINDS = (
    *["insert"] * 5, *["delete"] * 4, *["move"] * 4, *["wrap"] * 2, *["unwrap"] * 2,
    *["replace"] * 6, "note", "arm", "comment", "start", "undo", "undo",
)  # fmt: skip
PLANS = (
    *["change"] * 6, *["new"] * 5, *["around"] * 2, *["cut"] * 2, *["gone"] * 2, *["lines"] * 2,
    "unround", "arm", "note", "blank", "layout", "two", "anew",
)  # fmt: skip
LARGE_PROGRAM = 60  # instructions: from then on more is deleted


class Pupil:
    """`typed_texts`: all that anybody has written; `focus`: where in the text this one works."""

    def __init__(
        self, page: Page, rng: Random, numbers: Iterator[int], typed_texts: set[str],
        deeds: Counter[str], spread: float = 0.5,
    ) -> None:  # fmt: skip
        self.page, self.typed_texts, self.counts_by_deed = page, typed_texts, deeds
        self.focus = 0.5
        self.stages: list[Stage] = []
        self._rng, self._numbers, self._spread = rng, numbers, spread
        self._cut_lines: Text = []

    def act(self) -> None:
        """Continue typing, or take another action."""
        if self.stages or self._rng.random() < 0.55:
            self.type()
        else:
            self.edit_blocks()

    def drop(self) -> None:
        """Cut text is not pasted, and unfinished text is not finished."""
        self.page.give_up()
        self.stages, self._cut_lines = [], []

    def finish(self) -> None:
        while self.stages:
            self.type()
        self.page.leave()
        self.page.give_up()

    def _note_own(self, text: str) -> str:
        own_text = text if text.startswith("//") else instruction_text(scan(text).tokens[:-1])
        self.typed_texts.add(own_text)
        return text

    def _simple(self) -> str:
        k = next(self._numbers)
        return self._note_own(self._rng.choice((
            f"F({k}, 50)", f"B({k}, 50)", f"L({k}, 60)", f"R({k}, 60)", f"W({k})", f"X = {k}",
            f"F({k}, 40) UNTIL(DISTANCE < 10)", f"SHOW({k})",
        )))  # fmt: skip

    def _make_head(self) -> str:
        k = next(self._numbers)
        return self._note_own(self._rng.choice((f"LOOP({k})", f"WHILE(X < {k})", f"IF(X > {k})")))

    # -- by blocks --------------------------------------------------------------------------------

    def edit_blocks(self) -> bool:
        page = self.page
        page.leave()
        view = page.view
        ids = [id for id in view.subtree_ids()[1:] if id != START]
        deeds = EDIT_KINDS + ("delete",) * 8 if len(ids) > LARGE_PROGRAM else EDIT_KINDS
        deed = self._rng.choice(deeds) if ids else "insert"
        if deed == "undo":
            is_done = page.undo()
        else:
            make_operations: Callable[[Tree, list[str], str], list[Operation]] = getattr(
                self, f"_{deed}"
            )
            is_done = apply_edits(page, make_operations(view, ids, self._near(ids) if ids else ""))
        self.counts_by_deed[f"{deed}{'' if is_done else ', not possible'}"] += 1
        return is_done

    def _near(self, ids: list[str]) -> str:
        k = round(self._rng.gauss(self.focus * len(ids), max(2.0, len(ids) * self._spread)))
        return ids[max(0, min(len(ids) - 1, k))]

    def _place_at(self, view: Tree, block_id: str) -> Place:
        if not block_id or self._rng.random() < 0.1:
            return Place(ROOT, START if view[START].text else "")
        if view[block_id].kind == BLOCK and self._rng.random() < 0.4:
            return Place(block_id, "")
        return Place(view[block_id].parent, block_id)

    def _insert(self, view: Tree, ids: list[str], block_id: str) -> list[Operation]:
        new_trees = tuple(Subtree(self.page.new_id(), self._simple())
                    for _ in range(self._rng.choice((1, 1, 1, 2, 3))))  # fmt: skip
        if self._rng.random() < 0.25:
            new_trees = (Subtree(self.page.new_id(), self._make_head(), children=new_trees),)
        return [Insert(self._place_at(view, block_id), new_trees)]

    def _run(self, view: Tree, block_id: str, max_count: int, has_arms: bool = True) -> list[str]:
        siblings = view[view[block_id].parent].children
        k = siblings.index(block_id)
        run = []
        for id in siblings[k : k + self._rng.randint(1, max_count)]:
            if id == START or (not has_arms and view[id].kind == ARM):
                break
            run.append(id)
        return run

    def _delete(self, view: Tree, ids: list[str], block_id: str) -> list[Operation]:
        run = self._run(view, block_id, 3)
        arms = tuple(id for id in run if view[id].kind == ARM and view.ids_of_arm(id)
                     and set(view.ids_of_arm(id)) <= set(run))  # fmt: skip
        return [Delete(tuple(child_id for id in run for child_id in view.subtree_ids(id)), arms)]

    def _move(self, view: Tree, ids: list[str], block_id: str) -> list[Operation]:
        run = self._run(view, block_id, 3, has_arms=False)
        target_id = self._near(ids)
        if not run or any(view.is_in(target_id, id) for id in run):
            return []
        return [Move(tuple(run), self._place_at(view, target_id))]

    def _wrap(self, view: Tree, ids: list[str], block_id: str) -> list[Operation]:
        run = self._run(view, block_id, 4, has_arms=False)
        return [Wrap(tuple(run), Subtree(self.page.new_id(), self._make_head()))] if run else []

    def _unwrap(self, view: Tree, ids: list[str], block_id: str) -> list[Operation]:
        blocks = [id for id in ids if view[id].kind == BLOCK]
        return [Unwrap(self._rng.choice(blocks))] if blocks else []

    def _replace(self, view: Tree, ids: list[str], block_id: str) -> list[Operation]:
        node, k = view[block_id], next(self._numbers)
        if node.kind == INSTRUCTION:
            text = self._simple()
        elif node.kind == BLOCK:
            text = self._note_own(f"IF(X > {k})" if node.text.startswith("IF") else f"LOOP({k})")
        elif node.kind == NOTE:
            text = self._note_own(f"// c{k}")
        else:
            return []
        return [Replace(block_id, (("text", text),))]

    def _note(self, view: Tree, ids: list[str], block_id: str) -> list[Operation]:
        if view[block_id].kind == NOTE:
            return []
        return [Replace(block_id, (("note", self._note_own(f"// n{next(self._numbers)}")),))]

    def _arm(self, view: Tree, ids: list[str], block_id: str) -> list[Operation]:
        ifs = [id for id in ids if view[id].text.startswith("IF")]
        if not ifs:
            return []
        block = self._rng.choice(ifs)
        arm = "ELSE" if self._rng.random() < 0.6 else f"ELSEIF(X > {next(self._numbers)})"
        place = Place(block, self._rng.choice(["", *view[block].children]))
        return [Insert(place, (Subtree(self.page.new_id(), self._note_own(arm)),))]

    def _comment(self, view: Tree, ids: list[str], block_id: str) -> list[Operation]:
        text, is_apart = self._note_own(f"// c{next(self._numbers)}"), self._rng.random() < 0.5
        new_tree = Subtree(self.page.new_id(), text, apart=is_apart)
        return [Insert(self._place_at(view, block_id), (new_tree,))]

    def _start(self, view: Tree, ids: list[str], block_id: str) -> list[Operation]:
        return [Replace(START, (("text", self._rng.choice(("SI|", "SB|"))),))]

    # -- with the keyboard ------------------------------------------------------------------------

    def type(self) -> None:
        page = self.page
        if not self.stages:
            has_staying_draft = any(draft.stays for draft in page.drafts)
            plan = (
                "kept"
                if has_staying_draft and self._rng.random() < 0.5
                else self._rng.choice(PLANS)
            )
            self.counts_by_deed[f"types {plan}"] += 1
            self.stages = getattr(self, f"_plan_{plan}")()
        page.type(*self.stages.pop(0)(page.lines[:], page.caret))
        page.flush()

    def _line(self, text: Text) -> int:
        k = round(self._rng.gauss(self.focus * len(text), max(2.0, len(text) * self._spread)))
        return max(0, min(len(text) - 1, k))

    def _new_line(self, text: Text) -> int:
        """Return where a line may be put in: not before the start."""
        k = self._line(text) if text else 0
        return k + 1 if text and "|" in text[k] else k

    def _code(self, text: Text, matches: Callable[[str], bool] = lambda row: True) -> int | None:
        rows = [k for k, row in enumerate(text) if row.strip() and "//" not in row and matches(row)]
        aim = self._line(text) if text else 0
        return min(rows, key=lambda k: abs(k - aim)) if rows else None

    def _part_of(self, final: str) -> str:
        return final[: self._rng.randint(1, len(final) - 1)]

    def _plan_change(self) -> list[Stage]:
        final = ""

        def first_step(text: Text, caret: int) -> tuple[Text, int, bool]:
            nonlocal final
            k = self._code(text, lambda row: row.strip().rstrip(";").endswith(")")
                           and "DISTANCE" not in row)  # fmt: skip
            word = text[k].split("|")[-1].strip().split("(")[0] if k is not None else ""
            if k is None or word not in VALUES:
                return text, caret, False
            start = text[k][:3] if text[k][:3] in ("SI|", "SB|") else ""
            final = start + self._note_own(VALUES[word].format(next(self._numbers)))
            text[k] = start + self._part_of(final[len(start) :])
            return text, k, True

        def last_step(text: Text, caret: int) -> tuple[Text, int, bool]:
            if final and text:
                text[caret] = final
            return text, caret, False

        return [first_step, last_step]

    def _plan_kept(self) -> list[Stage]:
        """Keep refused changes in the plan."""
        rows = [draft.rows[0] for draft in self.page.drafts if draft.stays]
        return [lambda text, caret: ([row + " " * (row in rows) for row in text], caret, False)]

    def _plan_new(self) -> list[Stage]:
        final = self._simple()

        def first_step(text: Text, caret: int) -> tuple[Text, int, bool]:
            k = self._line(text) + 1 if text else 0
            k += k < len(text) and "|" in text[k]
            text.insert(k, self._part_of(final))
            return text, k, True

        def last_step(text: Text, caret: int) -> tuple[Text, int, bool]:
            if text:
                text[caret] = final
            return text, caret, False

        return [first_step, last_step]

    def _plan_lines(self) -> list[Stage]:
        """Plan lines one below the other, each followed by Enter."""
        rows = [self._simple() for _ in range(self._rng.randint(2, 4))]
        row_number = 0

        def first_step(text: Text, caret: int) -> tuple[Text, int, bool]:
            k = self._new_line(text)
            text.insert(k, rows[0])
            text.insert(k + 1, "")
            return text, k + 1, True

        def next_step(text: Text, caret: int) -> tuple[Text, int, bool]:
            nonlocal row_number
            row_number += 1
            if not text:
                return text, caret, False
            text[caret] = rows[row_number]
            if row_number == len(rows) - 1:
                return text, caret, False
            text.insert(caret + 1, "")
            return text, caret + 1, True

        return [first_step, *[next_step] * (len(rows) - 1)]

    def _plan_around(self) -> list[Stage]:
        head = self._make_head()
        end = {"L": "END_LOOP", "W": "END_WHILE", "I": "ENDIF"}[head[0]]
        size = self._rng.randint(1, 4)

        def first_step(text: Text, caret: int) -> tuple[Text, int, bool]:
            k = self._new_line(text)
            text.insert(k, head)
            return text, k, False

        def last_step(text: Text, caret: int) -> tuple[Text, int, bool]:
            rows = [k for k, row in enumerate(text) if row.strip() == head]
            text.insert(min(len(text), (rows[0] if rows else caret) + 1 + size), end)
            return text, caret, False

        return [first_step, last_step]

    def _plan_cut(self) -> list[Stage]:
        """One after the other, or pasted before anything is made of it."""

        def first_step(text: Text, caret: int) -> tuple[Text, int, bool]:
            k = self._code(text)
            size = self._rng.randint(1, 3)
            if k is None or any("|" in row for row in text[k : k + size]):
                return text, caret, False
            self._cut_lines = text[k : k + size]
            del text[k : k + size]
            return text, min(k, len(text) - 1), False

        def last_step(text: Text, caret: int) -> tuple[Text, int, bool]:
            k = self._new_line(text)
            text[k:k] = self._cut_lines
            self._cut_lines = []
            return text, k, False

        if self._rng.random() < 0.5:
            return [lambda text, caret: last_step(*first_step(text, caret)[:2])]
        return [first_step, last_step]

    def _plan_gone(self) -> list[Stage]:
        def only(text: Text, caret: int) -> tuple[Text, int, bool]:
            k = self._code(text, lambda row: "|" not in row)
            if k is not None:
                del text[k : k + self._rng.randint(1, 2)]
            return text, caret, False

        return [only]

    def _plan_unround(self) -> list[Stage]:
        indent = -1

        def first_step(text: Text, caret: int) -> tuple[Text, int, bool]:
            nonlocal indent
            heads = [k for k, row in enumerate(text)
                     if row.strip().startswith(("LOOP", "WHILE", "IF"))]  # fmt: skip
            if not heads:
                return text, caret, False
            k = self._rng.choice(heads)
            indent = len(text[k]) - len(text[k].lstrip())
            del text[k]
            return text, min(k, len(text) - 1), False

        def last_step(text: Text, caret: int) -> tuple[Text, int, bool]:
            for k in range(max(0, caret), len(text)):
                is_here = len(text[k]) - len(text[k].lstrip()) == indent
                if is_here and text[k].strip().startswith("END"):
                    del text[k]
                    break
            return text, caret, False

        return [first_step, last_step]

    def _plan_arm(self) -> list[Stage]:
        def only(text: Text, caret: int) -> tuple[Text, int, bool]:
            heads = [k for k, row in enumerate(text) if row.strip().startswith("IF(")]
            if heads:
                k = self._rng.choice(heads) + 1 + self._rng.randint(0, 1)
                text.insert(k, self._note_own("ELSE"))
            return text, caret, False

        return [only]

    def _plan_note(self) -> list[Stage]:
        def only(text: Text, caret: int) -> tuple[Text, int, bool]:
            k = self._code(text)
            note = self._note_own(f"// t{next(self._numbers)}")
            if k is None or self._rng.random() < 0.5:
                text.insert(k or 0, note)
            else:
                text[k] += "  " + note
            return text, caret, False

        return [only]

    def _plan_blank(self) -> list[Stage]:
        def only(text: Text, caret: int) -> tuple[Text, int, bool]:
            text.insert(self._line(text) if text else 0, "")
            return text, caret, False

        return [only]

    def _plan_layout(self) -> list[Stage]:
        def relaid_row(row: str) -> str:
            return row + " " if "//" in row else row.lower().replace(", ", " ,  ")

        return [lambda text, caret: (list(map(relaid_row, text)), caret, False)]

    def _plan_two(self) -> list[Stage]:
        pair = f"{self._simple()}; {self._simple()}"

        def only(text: Text, caret: int) -> tuple[Text, int, bool]:
            middle = len(text) // 2
            is_start = bool(text) and "|" in text[middle]
            text.insert(len(text) if is_start else middle, pair)
            return text, caret, False

        return [only]

    def _plan_anew(self) -> list[Stage]:
        """A line is deleted and another written in its place."""
        final = self._simple()

        def first_step(text: Text, caret: int) -> tuple[Text, int, bool]:
            words = ("F(", "B(", "L(", "R(", "W(")
            k = self._code(text, lambda row: row.strip().startswith(words))
            if k is None:
                text.append("")
                k = len(text) - 1
            text[k] = final[:2]
            return text, k, True

        def last_step(text: Text, caret: int) -> tuple[Text, int, bool]:
            if text:
                text[caret] = final
            return text, caret, False

        return [first_step, last_step]
