"""An editor's handling of late answers from the page's Python.

Two editors are typed into, character by character, while answers are on their way. Text typed
meanwhile in another line stays; in the same line the answer is void, and the next one continues
from the one before. A page may be reloaded at any time: loose blocks stay in its text. In the end
both have the same program.
"""

from __future__ import annotations

import json
from itertools import count
from random import Random
from typing import Any

import pytest

from tests.together.world import FIRST_PROGRAM
from tiniscript.studio import page_together, worker
from tiniscript.studio.block_reading import split_loose
from tiniscript.together.form import change_of
from tiniscript.together.layout import parse_tree, text_of
from tiniscript.together.ordering import SharedProgram

Json = dict[str, Any]
BACKSPACE = "\b"
KEYS = [BACKSPACE] * 6 + list("1957;X \U0001f916")
TURNS = 150


class Editor:
    """The text with a caret, and the actions of `together.js` on it."""

    def __init__(self, name: str, program: SharedProgram) -> None:
        self.program = program
        self.name = name
        self.text = ""
        self.begin(None)

    def begin(self, stored_data: Json | None) -> None:
        """Join the group, with the page's stored data from before a reload."""
        self.column, self.is_hot = 0, False
        self.keys: list[str] = []  # that are to be pressed
        self.news: list[Json] = []
        self.python: tuple[Any, Any] = (None, None)
        news = {**self.program.news(self.name, -1, ""), "page": self.name}
        self.take(self.ask({"do": "group_begin", "news": news, "kept": stored_data}))

    @property
    def loose(self) -> list[str]:
        return [row for row in split_loose(self.text.split("\n"))[1] if row]

    def ask(self, request: Json) -> Json:
        """Each page has a Python of its own."""
        page_together._newest, page_together._previous = self.python
        answer: Json = json.loads(worker.answer(json.dumps(request), self.text.encode()))
        self.python = page_together._newest, page_together._previous
        return answer

    def change(self, changes: list[tuple[int, int, str]]) -> None:
        """Change the text, in units of UTF-16; the caret goes with it."""
        units = self.text.encode("utf-16-le")
        for start, end, put in reversed(changes):
            data = put.encode("utf-16-le")
            caret = len(self.text[: self.column].encode("utf-16-le")) // 2
            is_first = self.column == 0 or self.text[self.column - 1] == "\n"  # of its line
            if caret > end or (caret == end and (start < end or is_first)):
                caret += len(data) // 2 - (end - start)
            elif caret > start:
                caret = start
            units = units[: 2 * start] + data + units[2 * end :]
            self.text = units.decode("utf-16-le")
            self.column = len(units[: 2 * caret].decode("utf-16-le", "ignore"))

    @property
    def line(self) -> int:
        return self.text.count("\n", 0, self.column)

    def step(self) -> Json:
        request = {"do": "group_step", "from": self.shown_answer["version"], "caret": self.line,
                   "hot": self.is_hot, "news": self.news}  # fmt: skip
        return self.ask(request)

    def take(self, answer: Json) -> None:
        self.news, self.shown_answer = [], answer
        self.change(answer["changes"])

    def hear(self) -> None:
        """Send pending changes, and receive news."""
        self.program.submit(list(map(change_of, self.shown_answer["pending"])))
        name = self.shown_answer["kept"]["name"]
        news = self.program.news(name, self.shown_answer["since"], self.shown_answer["epoch"])
        self.news.append(json.loads(json.dumps(news)))

    def type(self, rng: Random) -> bool:
        """Press a key: of an instruction below a line, of a loose one, or any; return whether a
        line is finished.
        """
        if not self.keys and rng.random() < 0.7:
            end = self.text.find("\n", rng.randint(0, len(self.text)))
            self.go_to(end if end >= 0 else len(self.text))
            self.keys = list(f"\n{rng.choice(('F', 'b', 'L'))}({rng.randint(1, 99)}, 50)")
            self.keys += ["\n"] * (rng.random() < 0.5)
            if rng.random() < 0.2:
                self.go_to(len(self.text))
                self.keys = list(f"\n/// F({rng.randint(1, 99)}, 50)")
        key, line = self.keys.pop(0) if self.keys else rng.choice(KEYS), self.line
        if key == BACKSPACE:
            self.text, self.column = (
                self.text[: max(0, self.column - 1)] + self.text[self.column :],
                self.column - 1,
            )
            self.column = max(0, self.column)
        else:
            self.text, self.column = (
                self.text[: self.column] + key + self.text[self.column :],
                self.column + 1,
            )
        was_hot, self.is_hot = self.is_hot, True
        return self.line != line and was_hot

    def go_to(self, at: int) -> None:
        line, self.column = self.line, at
        self.is_hot = self.is_hot and self.line == line


@pytest.mark.sampled("seed", keep=2)
@pytest.mark.parametrize("seed", range(6))
def test_editors_that_hear_late_end_with_the_same_text(seed: int) -> None:
    rng, ids = Random(seed), count(1)
    program = SharedProgram(parse_tree(FIRST_PROGRAM, lambda: f"i.{next(ids)}"), "e")
    editors = [Editor(name, program) for name in ("m1", "m2")]
    assert {editor.text for editor in editors} == {FIRST_PROGRAM}
    reloads = draft_count = 0
    for _ in range(TURNS):
        editor = rng.choice(editors)
        for _ in range(rng.randint(1, 6)):
            if editor.type(rng):
                editor.take(editor.step())
        if rng.random() < 0.3:
            editor.go_to(rng.randint(0, len(editor.text)))
        if rng.random() < 0.5:
            editor.hear()
        answer = editor.step()
        if rng.random() < 0.3:  # typing there changes something, so it is void
            editor.type(rng)
            answer = editor.step()
        row = editor.text.split("\n")[editor.line]
        editor.take(answer)
        page = editor.python[0][1]
        drafts = {page.lines[number - 1] for number in answer["drafts"]}
        program_rows = iter(text_of(page.view).split("\n"))
        assert all(row in program_rows for number, row in enumerate(page.lines, 1)
                   if row.strip() and number not in answer["drafts"])  # fmt: skip
        assert drafts <= {row for draft in page.drafts for row in draft.rows}
        draft_count += len(drafts)
        if editor.is_hot:  # no one else edits the line being typed
            assert editor.text.split("\n")[editor.line] == row
        if rng.random() < 0.1:
            loose_before = editor.loose
            editor.begin(answer["kept"])
            assert editor.loose[len(editor.loose) - len(loose_before) :] == loose_before
            reloads += bool(loose_before)
    for editor in editors:
        editor.is_hot = False
        editor.take(editor.step())
    while any(editor.shown_answer["pending"] or editor.shown_answer["since"] != program.number
              for editor in editors):  # fmt: skip
        for editor in editors:
            editor.hear()
            editor.take(editor.step())
    assert program.number > 1 and reloads and draft_count
    for editor in editors:
        page = editor.python[0][1]
        assert page.base.checksum() == program.tree.checksum()
        page.give_up()  # what is incomplete is nobody else's
        assert not page.pending_changes and page.lines == text_of(program.tree).split("\n")[:-1]


@pytest.mark.parametrize("seed", range(20))
def test_changes_turn_the_old_text_into_the_new(seed: int) -> None:
    rng = Random(seed)
    rows = ["F(1, 80);", "f(1,80)", "", "  B(2, 40);", "// \U0001f916 a", "// b \x0b c", "W(1)"]
    old_text, new_text = ("\n".join(rng.choices(rows, k=rng.randint(0, 8))) for _ in range(2))
    units = old_text.encode("utf-16-le")
    for start, end, put in reversed(page_together.changes(old_text, new_text)):
        units = units[: 2 * start] + put.encode("utf-16-le") + units[2 * end :]
    assert units.decode("utf-16-le") == new_text
