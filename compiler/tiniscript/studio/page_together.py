"""The shared program in a pupil's page: what the editor asks, as data for JSON.

The editor may go on while this answers. So it says from which of the answers it goes on: the
newest, or the one before, where what was typed meanwhile stood in the way. Runs in Pyodide, in a
worker, and is fetched when it is first needed; knows no editor and no network.
"""

from __future__ import annotations

from difflib import SequenceMatcher
from typing import Any, NamedTuple

from tiniscript.studio.block_form import Form, from_data, in_order
from tiniscript.studio.block_printing import Printed, print_blocks
from tiniscript.studio.block_reading import split_loose
from tiniscript.syntax.formatter import BEFORE_COMMENT
from tiniscript.together.form import Refused, data_of_change
from tiniscript.together.page import Page
from tiniscript.together.tree import ARM, NOTE, Tree, first_word

Answer = dict[str, Any]
MOST_CHANGES = 50  # of a request to the class


class Shown(NamedTuple):
    """What the blocks show: a page as it was then, and of which instruction each block is."""

    page: Page
    nodes: dict[str, str]


class State(NamedTuple):
    """An answer. `loose` are the lines at the end of the text of what hangs on nothing: they are
    this page's alone."""

    version: int
    page: Page
    loose: list[str]
    blocks: Shown | None = None


_newest: State | None = None
_before: State | None = None


def begin(fields: Answer, data: bytes) -> Answer:
    """Begin with what the class has answered to a page that joins a group, and with what the page
    has kept of before it was loaded again."""
    global _newest, _before
    name, news, kept = fields["news"]["page"], fields["news"], fields.get("kept")
    loose: list[str] = []
    try:
        page = Page.of(name, news, kept)
        loose = list(map(str, kept["loose"])) if kept else []
    except (Refused, KeyError, TypeError, ValueError, AttributeError):
        page = Page.of(name, news)
    _before, _newest = None, State(1, page, loose)
    return _shown(_newest, data.decode(), None)


def step(fields: Answer, data: bytes) -> Answer:
    """Take the editor's text and news; return what the editor has to change of that text.

    `hot`: a key was pressed in the line of the caret, which has not left it. `blocks`: what the
    blocks are now, whose text is not the editor's yet. `back`: an undo, or a redo.
    """
    global _newest, _before
    assert _newest is not None, "no group"
    found = _newest if fields["from"] == _newest.version else _before
    assert found is not None
    assert found.version == fields["from"], "no such answer"
    text, page, blocks = data.decode(), found.page.copy(), found.blocks
    caret, is_hot = fields["caret"], fields["hot"]
    rows, loose = split_loose(_rows(text, caret if is_hot else None))
    page.type(rows, caret, is_hot)
    page.flush()
    printed: Printed | None = None
    if "blocks" in fields and blocks is not None:
        form = from_data(fields["blocks"]["form"])
        printed = print_blocks(form)
        blocks = _written(page, blocks, form, fields["blocks"]["ids"])
        loose = split_loose(_rows(printed.text, None))[1]
    for news in fields["news"]:
        page.receive(news)
    if "back" in fields:
        (page.undo if fields["back"] == "undo" else page.redo)()
    _before, _newest = found, State(_newest.version + 1, page, loose, blocks)
    answer = _shown(_newest, text, caret if caret < len(rows) else None)
    if printed is not None:
        is_shown = _text(_newest) == printed.text
        answer |= {"places": printed.places, "is_shown": is_shown}
    return answer


def blocks(fields: Answer, data: bytes) -> Answer:
    """The blocks show an answer from now on: `lines` says of each of them in which line it is."""
    global _newest, _before
    assert _newest is not None
    found = _newest if fields["version"] == _newest.version else _before
    if found is None or found.version != fields["version"]:
        return {"is_known": False}
    ids = found.page.ids_of_lines()
    nodes = {block: ids[line - 1] for block, line in fields["lines"] if 0 < line <= len(ids)}
    shown = Shown(found.page, nodes)
    _newest, _before = _newest._replace(blocks=shown), _before and _before._replace(blocks=shown)
    return {"is_known": True}


def _written(page: Page, shown: Shown, form: Form, ids: list[str]) -> Shown:
    """Do in a page what was done to the blocks since they were shown; return what they show."""
    printed = print_blocks(form._replace(loose=()))
    own = shown.page.copy()
    own.id_count = page.id_count
    rows = _rows(printed.text, None)
    own.write(rows, _owners(rows, printed, form, ids, shown))
    page.catch_up(own, shown.page)
    found = own.ids_of_lines()
    nodes = {
        block: found[lines[0]]
        for block, lines in zip(ids, printed.lines, strict=True)
        if lines[0] < len(found)
    }
    return Shown(own, nodes)


def _owners(
    rows: list[str], printed: Printed, form: Form, ids: list[str], shown: Shown
) -> list[str]:
    """Return of which instruction each line of changed blocks is; a new one has none."""
    tree = shown.page.view
    owners = [""] * len(rows)
    for id, block, (first, *more) in zip(ids, in_order(form.body), printed.lines, strict=True):
        node = shown.nodes.get(id, "")
        if node not in tree or (block.is_behind and tree[node].kind != NOTE):
            continue
        owners[first] = node
        arms = [each for each in tree[node].children if tree[each].kind == ARM]
        for line, arm in _paired([_said(rows[line]) for line in more[:-1]], tree, arms):
            owners[more[line]] = arm
    return owners


def _paired(said: list[str], tree: Tree, arms: list[str]) -> list[tuple[int, str]]:
    """Return which arms of a block are which of before: those that say the same, then in order."""
    texts = [tree[arm].text for arm in arms]
    found = []
    for tag, i1, i2, j1, j2 in SequenceMatcher(None, said, texts, autojunk=False).get_opcodes():
        found += [(i, arms[j]) for i, j in zip(range(i1, i2), range(j1, j2), strict=False)
                  if tag == "equal" or first_word(said[i]) == first_word(texts[j])]  # fmt: skip
    return found


def _said(row: str) -> str:
    return row.split(BEFORE_COMMENT + "//")[0].strip().rstrip(";")


def _rows(text: str, hot: int | None) -> list[str]:
    """Return the lines of a text; the empty one at its end is none, unless it is `hot`."""
    rows = text.split("\n")
    return rows[:-1] if not rows[-1] and hot != len(rows) - 1 else rows


def _text(state: State) -> str:
    """Return the whole text of an answer; it ends its last line."""
    rows = [*state.page.lines, *([""] if state.loose and state.page.lines else []), *state.loose]
    return "".join(f"{row}\n" for row in rows)


def _shown(state: State, text: str, caret: int | None) -> Answer:
    page = state.page
    wanted = _text(state)
    is_open = caret is not None and not text.endswith("\n")
    if is_open or wanted == "\n" or wanted.endswith("\n\n"):
        wanted = wanted[:-1]
    return {
        "version": state.version,
        "changes": changes(text, wanted, None if caret is None else (caret, page.caret)),
        "ids": page.ids_of_lines(),
        "pending": [data_of_change(each) for each in page.pending_changes[:MOST_CHANGES]],
        "since": -1 if page.is_astray else page.number,
        "epoch": page.epoch,
        "told": len(page.refusals),
        "why": page.refusals[-1][1] if page.refusals else "",
        "count": page.change_count,
        "kept": {**page.store_data(), "loose": state.loose},
    }


def changes(old: str, new: str, caret: tuple[int, int] | None = None) -> list[tuple[int, int, str]]:
    """Return what makes the new text of the old: from, to and what is put in, in units of UTF-16.

    A line that has changed keeps what is the same in it, where its caret and its undo are. `caret`:
    the line that the caret is in, in both; where that is the same, it is not touched.
    """
    a, b = _with_ends(old), _with_ends(new)
    if caret is None or a[caret[0] : caret[0] + 1] != b[caret[1] : caret[1] + 1]:
        return _between(a, b, 0)
    i, j = caret
    return _between(a[:i], b[:j], 0) + _between(a[i:], b[j:], sum(map(_units, a[:i])))


def _between(a: list[str], b: list[str], start: int) -> list[tuple[int, int, str]]:
    """Return the changes of lines of which the first begins at `start`."""
    found: list[tuple[int, int, str]] = []
    starts = [start]
    for row in a:
        starts.append(starts[-1] + _units(row))
    for tag, i1, i2, j1, j2 in SequenceMatcher(None, a, b, autojunk=False).get_opcodes():
        if tag == "equal":
            continue
        if tag == "replace" and i2 - i1 == j2 - j1:
            for one, other, begin_at in zip(a[i1:i2], b[j1:j2], starts[i1:i2], strict=True):
                found += _within(one, other, begin_at)
        else:
            found.append((starts[i1], starts[i2], "".join(b[j1:j2])))
    return found


def _with_ends(text: str) -> list[str]:
    """Return the lines as the editor counts them: other signs end none."""
    rows = text.split("\n")
    return [row + "\n" for row in rows[:-1]] + [rows[-1]] * bool(rows[-1])


def _within(old: str, new: str, start: int) -> list[tuple[int, int, str]]:
    return [
        (start + _units(old[:i1]), start + _units(old[:i2]), new[j1:j2])
        for tag, i1, i2, j1, j2 in SequenceMatcher(None, old, new, autojunk=False).get_opcodes()
        if tag != "equal"
    ]


def _units(text: str) -> int:
    return len(text) + sum(sign > "\uffff" for sign in text)


ASKED = {"group_begin": begin, "group_step": step, "group_blocks": blocks}
