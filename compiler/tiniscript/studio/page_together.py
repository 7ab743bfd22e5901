"""The shared program in a pupil's page: what the editor asks, as data for JSON.

The editor may change while this answers. So it says on which answer its change is based: the
newest, or the one before, if text typed meanwhile conflicted. Runs in Pyodide, in a worker, and is
fetched when it is first needed; knows no editor and no network.
"""

from __future__ import annotations

from difflib import SequenceMatcher
from typing import Any, NamedTuple

from tiniscript.studio.block_form import Form, from_data, in_order
from tiniscript.studio.block_printing import PrintedForm, format_blocks
from tiniscript.studio.block_reading import split_loose
from tiniscript.syntax.formatter import COMMENT_GAP
from tiniscript.together.form import Refused, data_of_change
from tiniscript.together.page import Page
from tiniscript.together.tree import ARM, NOTE, Tree, first_word

Json = dict[str, Any]
MAX_CHANGES = 50  # most changes in a request to the class


class ShownBlocks(NamedTuple):
    """The state shown by the blocks: the page at that time, and the instruction of each block."""

    page: Page
    nodes: dict[str, str]


class State(NamedTuple):
    """An answer. `loose` are the lines at the end of the text of what hangs on nothing: they are
    this page's alone."""

    version: int
    page: Page
    loose: list[str]
    blocks: ShownBlocks | None = None


_newest: State | None = None
_previous: State | None = None


def begin(fields: Json, data: bytes) -> Json:
    """Begin with what the class has answered to a page that joins a group, and with what the page
    has kept of before it was loaded again."""
    global _newest, _previous
    name, news, store = fields["news"]["page"], fields["news"], fields.get("kept")
    loose_rows: list[str] = []
    try:
        page = Page.of(name, news, store)
        loose_rows = list(map(str, store["loose"])) if store else []
    except (Refused, KeyError, TypeError, ValueError, AttributeError):
        page = Page.of(name, news)
    _previous, _newest = None, State(1, page, loose_rows)
    return _answer(_newest, data.decode(), None)


def step(fields: Json, data: bytes) -> Json:
    """Take the editor's text and news; return what the editor has to change of that text.

    `hot`: a key was pressed in the line of the caret, which has not left it. `blocks`: what the
    blocks are now, whose text is not the editor's yet. `back`: an undo, or a redo.
    """
    global _newest, _previous
    assert _newest is not None, "no group"
    state = _newest if fields["from"] == _newest.version else _previous
    assert state is not None
    assert state.version == fields["from"], "no such answer"
    text, page, blocks = data.decode(), state.page.copy(), state.blocks
    caret, is_line_edited = fields["caret"], fields["hot"]
    text_rows = _rows(text, caret if is_line_edited else None)
    rows, loose_rows = split_loose(text_rows)
    page.type(rows, caret, is_line_edited)
    page.flush()
    printed_form: PrintedForm | None = None
    if "blocks" in fields and blocks is not None:
        form = from_data(fields["blocks"]["form"])
        printed_form = format_blocks(form)
        blocks = _write_blocks(page, blocks, form, fields["blocks"]["ids"])
        loose_rows = split_loose(_rows(printed_form.text, None))[1]
    for news in fields["news"]:
        page.receive(news)
    if "back" in fields:
        (page.undo if fields["back"] == "undo" else page.redo)()
    _previous, _newest = state, State(_newest.version + 1, page, loose_rows, blocks)
    carets = None
    if caret < len(rows):
        carets = caret, page.caret
    elif loose_rows:  # loose blocks come after both texts
        carets = caret, caret - len(text_rows) + len(_all_rows(_newest))
    answer = _answer(_newest, text, carets)
    if printed_form is not None:
        is_shown = _text(_newest) == printed_form.text
        answer |= {"text": printed_form.text, "places": printed_form.places, "is_shown": is_shown}
    return answer


def show_blocks(fields: Json, data: bytes) -> Json:
    """The blocks show an answer from now on: `lines` says of each of them in which line it is."""
    global _newest, _previous
    assert _newest is not None
    state = _newest if fields["version"] == _newest.version else _previous
    if state is None or state.version != fields["version"]:
        return {"is_known": False}
    ids = state.page.ids_of_lines()
    nodes = {block: ids[line - 1] for block, line in fields["lines"] if 0 < line <= len(ids)}
    shown_blocks = ShownBlocks(state.page, nodes)
    _newest = _newest._replace(blocks=shown_blocks)
    _previous = _previous and _previous._replace(blocks=shown_blocks)
    return {"is_known": True}


def _write_blocks(page: Page, shown_blocks: ShownBlocks, form: Form, ids: list[str]) -> ShownBlocks:
    """Do in a page what was done to the blocks since they were shown; return what they show."""
    printed_form = format_blocks(form._replace(loose=()))
    blocks_page = shown_blocks.page.copy()
    blocks_page.id_count = page.id_count
    rows = _rows(printed_form.text, None)
    blocks_page.write(rows, _owners(rows, printed_form, form, ids, shown_blocks))
    page.catch_up(blocks_page, shown_blocks.page)
    ids_of_lines = blocks_page.ids_of_lines()
    nodes = {
        block: ids_of_lines[lines[0]]
        for block, lines in zip(ids, printed_form.lines, strict=True)
        if lines[0] < len(ids_of_lines)
    }
    return ShownBlocks(blocks_page, nodes)


def _owners(
    rows: list[str],
    printed_form: PrintedForm,
    form: Form,
    ids: list[str],
    shown_blocks: ShownBlocks,
) -> list[str]:
    """Return the instruction of each line of changed blocks; new lines have none."""
    tree = shown_blocks.page.view
    owners = [""] * len(rows)
    for id, block, (first_line, *other_lines) in zip(
        ids, in_order(form.body), printed_form.lines, strict=True
    ):
        node = shown_blocks.nodes.get(id, "")
        if node not in tree or (block.is_behind and tree[node].kind != NOTE):
            continue
        owners[first_line] = node
        arms = [child for child in tree[node].children if tree[child].kind == ARM]
        for line, arm in _pair_arms(
            [_instruction_in(rows[line]) for line in other_lines[:-1]], tree, arms
        ):
            owners[other_lines[line]] = arm
    return owners


def _pair_arms(arm_texts: list[str], tree: Tree, arms: list[str]) -> list[tuple[int, str]]:
    """Return the old arms of a block's new arms: first those with the same text, then in order."""
    old_texts = [tree[arm].text for arm in arms]
    pairs = []
    for tag, i1, i2, j1, j2 in SequenceMatcher(
        None, arm_texts, old_texts, autojunk=False
    ).get_opcodes():
        pairs += [
            (i, arms[j])
            for i, j in zip(range(i1, i2), range(j1, j2), strict=False)
            if tag == "equal" or first_word(arm_texts[i]) == first_word(old_texts[j])
        ]
    return pairs


def _instruction_in(row: str) -> str:
    return row.split(COMMENT_GAP + "//")[0].strip().rstrip(";")


def _rows(text: str, edited_line: int | None) -> list[str]:
    """Return the lines of a text; the empty one at its end is none, unless it is `edited_line`."""
    rows = text.split("\n")
    return rows[:-1] if not rows[-1] and edited_line != len(rows) - 1 else rows


def _text(state: State) -> str:
    """Return the whole text of an answer; it ends its last line."""
    return "".join(f"{row}\n" for row in _all_rows(state))


def _all_rows(state: State) -> list[str]:
    return [*state.page.lines, *([""] if state.loose and state.page.lines else []), *state.loose]


def _answer(state: State, text: str, carets: tuple[int, int] | None) -> Json:
    """`carets`: the line of the caret, in the editor's text and in that of the answer."""
    page = state.page
    new_text = _text(state)
    is_open = carets is not None and not text.endswith("\n")
    if is_open or new_text == "\n" or new_text.endswith("\n\n"):
        new_text = new_text[:-1]
    return {
        "version": state.version,
        "changes": changes(text, new_text, carets),
        "ids": page.ids_of_lines(),
        "drafts": page.lines_of_drafts(),
        "pending": [data_of_change(change) for change in page.pending_changes[:MAX_CHANGES]],
        "since": -1 if page.is_out_of_sync else page.number,
        "epoch": page.epoch,
        "told": len(page.refusals),
        "why": page.refusals[-1][1] if page.refusals else "",
        "count": page.change_count,
        "kept": {**page.store_data(), "loose": state.loose},
    }


def changes(
    old_text: str, new_text: str, carets: tuple[int, int] | None = None
) -> list[tuple[int, int, str]]:
    """Return the edits between two texts: start, end and replacement, in UTF-16 units.

    A line that has changed keeps what is the same in it, where its caret and its undo are.
    `carets`: the line that the caret is in, in both; where that is the same, it is not touched.
    """
    old_rows, new_rows = _with_ends(old_text), _with_ends(new_text)
    if carets is not None:
        i, j = carets
        old_row, new_row = ("".join(rows[k : k + 1]).rstrip("\n")
                            for rows, k in ((old_rows, i), (new_rows, j)))  # fmt: skip
        if old_row == new_row:  # its end is not part of the row: lines may follow below an open one
            start = sum(map(_utf16_length, old_rows[:i])) + _utf16_length(old_row)
            old_rest, new_rest = ("".join(rows[k:])[len(old_row) :]
                                  for rows, k in ((old_rows, i), (new_rows, j)))  # fmt: skip
            return _line_changes(old_rows[:i], new_rows[:j], 0) + _line_changes(
                _with_ends(old_rest), _with_ends(new_rest), start
            )
    return _line_changes(old_rows, new_rows, 0)


def _line_changes(
    old_rows: list[str], new_rows: list[str], start: int
) -> list[tuple[int, int, str]]:
    """Return the changes of lines, the first of which begins at `start`."""
    line_changes: list[tuple[int, int, str]] = []
    starts = [start]
    for row in old_rows:
        starts.append(starts[-1] + _utf16_length(row))
    for tag, i1, i2, j1, j2 in SequenceMatcher(
        None, old_rows, new_rows, autojunk=False
    ).get_opcodes():
        if tag == "equal":
            continue
        if tag == "replace" and i2 - i1 == j2 - j1:
            for old_row, new_row, begin_at in zip(
                old_rows[i1:i2], new_rows[j1:j2], starts[i1:i2], strict=True
            ):
                line_changes += _changes_in_row(old_row, new_row, begin_at)
        else:
            line_changes.append((starts[i1], starts[i2], "".join(new_rows[j1:j2])))
    return line_changes


def _with_ends(text: str) -> list[str]:
    """Return the lines as the editor counts them: other signs end none."""
    rows = text.split("\n")
    return [row + "\n" for row in rows[:-1]] + [rows[-1]] * bool(rows[-1])


def _changes_in_row(old_text: str, new_text: str, start: int) -> list[tuple[int, int, str]]:
    return [
        (
            start + _utf16_length(old_text[:i1]),
            start + _utf16_length(old_text[:i2]),
            new_text[j1:j2],
        )
        for tag, i1, i2, j1, j2 in SequenceMatcher(
            None, old_text, new_text, autojunk=False
        ).get_opcodes()
        if tag != "equal"
    ]


def _utf16_length(text: str) -> int:
    return len(text) + sum(sign > "\uffff" for sign in text)


HANDLERS = {"group_begin": begin, "group_step": step, "group_blocks": show_blocks}
