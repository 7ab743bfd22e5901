"""The shared program in a pupil's page: what the editor asks, as data for JSON.

The editor may go on while this answers. So it says from which of the answers it goes on: the
newest, or the one before, where what was typed meanwhile stood in the way. Runs in Pyodide, in a
worker, and is fetched when it is first needed; knows no editor and no network.
"""

from __future__ import annotations

from difflib import SequenceMatcher
from typing import Any

from tiniscript.together.form import Refused, data_of_change
from tiniscript.together.page import Page

Answer = dict[str, Any]
MOST_CHANGES = 50  # of a request to the class

_newest: tuple[int, Page] | None = None
_before: tuple[int, Page] | None = None


def begin(fields: Answer, data: bytes) -> Answer:
    """Begin with what the class has answered to a page that joins a group, and with what the page
    has kept of before it was loaded again."""
    global _newest, _before
    name, news, kept = fields["news"]["page"], fields["news"], fields.get("kept")
    try:
        page = Page.of(name, news, kept)
    except (Refused, KeyError, TypeError, ValueError, AttributeError):
        page = Page.of(name, news)
    _before, _newest = None, (1, page)
    return _shown(page, 1, data.decode(), None)


def step(fields: Answer, data: bytes) -> Answer:
    """Take the editor's text and news; return what the editor has to change of that text.

    `hot`: a key was pressed in the line of the caret, which has not left it.
    """
    global _newest, _before
    assert _newest is not None, "no group"
    found = _newest if fields["from"] == _newest[0] else _before
    assert found is not None
    assert found[0] == fields["from"], "no such answer"
    text, page = data.decode(), found[1].copy()
    caret, is_hot = fields["caret"], fields["hot"]
    page.type(_rows(text, caret if is_hot else None), caret, is_hot)
    page.flush()
    for news in fields["news"]:
        page.receive(news)
    _before, _newest = found, (_newest[0] + 1, page)
    return _shown(page, _newest[0], text, caret)


def _rows(text: str, hot: int | None) -> list[str]:
    """Return the lines of a text; the empty one at its end is none, unless it is `hot`."""
    rows = text.split("\n")
    return rows[:-1] if not rows[-1] and hot != len(rows) - 1 else rows


def _shown(page: Page, version: int, text: str, caret: int | None) -> Answer:
    wanted = "\n".join(page.text)
    if page.text and page.text[-1] and (caret is None or text.endswith("\n")):
        wanted += "\n"
    return {
        "version": version,
        "changes": changes(text, wanted, None if caret is None else (caret, page.caret)),
        "ids": page.ids_of_lines(),
        "pending": [data_of_change(each) for each in page.pending[:MOST_CHANGES]],
        "since": -1 if page.is_astray else page.number,
        "epoch": page.epoch,
        "told": len(page.told),
        "why": page.told[-1][1] if page.told else "",
        "kept": page.kept(),
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


ASKED = {"group_begin": begin, "group_step": step}
