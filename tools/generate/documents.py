"""The tables that documents take from the code, and how one gets into its document.

Knows the documents of `docs/` with tables of their own. The spec's tables are in `__main__.py`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path

from tiniscript.text.levels import CODE_BYTES, LEVELS

FOLDER = Path(__file__).resolve().parent.parent.parent / "docs"


def link_document(document: str) -> str:
    """Return a document about the link with the tables that it takes from the messages."""
    from tools.generate.link_header import DOCUMENT_TABLES

    text = _text(document)
    for name, made in DOCUMENT_TABLES[document].items():
        text = spliced(text, name, table(*made()))
    return text


def text_document() -> str:
    """Return `docs/text.md` with the table of levels."""
    rows = [
        (f"`{each.name}`", ", ".join(f"`{word}`" for word in sorted(each.lacks)) or "nothing",
         each.room, min(CODE_BYTES, each.room))
        for each in LEVELS.values()
    ]  # fmt: skip
    made = table(("level", "lacks", "room in bytes", "bytes of code, at most"), rows)
    return spliced(_text("text.md"), "levels", made)


def promises_document() -> str:
    """Return `docs/promises.md` with the table of goals and figures."""
    from tools.campaign.results import HEAD, rows

    return spliced(_text("promises.md"), "promises", table(HEAD, rows()))


def lessons_document() -> str:
    """Return `docs/lessons.en.md` with the table of criteria."""
    from tools.generate.lesson_table import criteria

    return spliced(_text("lessons.en.md"), "criteria", table(*criteria()))


def _text(name: str) -> str:
    return (FOLDER / name).read_text(encoding="utf-8")


def spliced(text: str, name: str, table: str) -> str:
    """Return `text` with `table` between the marks called `name`."""
    begin, end = f"<!-- begin generated: {name} -->\n", f"<!-- end generated: {name} -->"
    head, mark, rest = text.partition(begin)
    _, last, tail = rest.partition(end)
    assert mark and last, f"no marks for {name}"
    return head + begin + table + end + tail


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a Markdown table; a bar in a cell is escaped."""
    lines = [head, ["---"] * len(head), *rows]
    cells = [[str(cell).replace("|", "\\|") for cell in line] for line in lines]
    return "".join(f"| {' | '.join(line)} |\n" for line in cells)


DOCUMENTS: dict[str, Callable[[], str]] = {
    "link.md": partial(link_document, "link.md"),
    "network.md": partial(link_document, "network.md"),
    "owners.md": partial(link_document, "owners.md"),
    "text.md": text_document,
    "promises.md": promises_document,
    "lessons.en.md": lessons_document,
}
