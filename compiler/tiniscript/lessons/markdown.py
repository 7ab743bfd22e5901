"""The small part of Markdown that pages of lessons are written in: text becomes blocks.

Headings (`#`, `##`), paragraphs, lists (`-`, `- [ ]`, `1.`), tables, and fences of programs; in
lines `**bold**` and `` `code` ``. Anything else becomes a paragraph. Knows no HTML (`sheet`).

A pupil's page is printed, and shown next to the studio's simulator. A line that begins with
`[print]` appears only on paper, one with `[page]` or `[hint]` only in the studio.
"""

from __future__ import annotations

import re
from textwrap import fill
from typing import NamedTuple

from tiniscript.base.source import printable

WIDTH = 80  # columns of a page on a terminal
ITEM = re.compile(r"(- \[ \]|-|[0-9]{1,2}\.) +(.*)")
KINDS = {"- [ ]": "checks", "-": "list"}
MARK = re.compile(r"((?:-|[0-9]{1,2}\.) +)?\[(print|page|hint)\] +")
HINT = "[hint] "


class Block(NamedTuple):
    """`kind` is title, heading, paragraph, list, checks, steps, table or program.

    `rows` has a row of cells for each line of a table, one cell for each item or line otherwise.
    `first_number` is the number of the first step.
    """

    kind: str
    rows: tuple[tuple[str, ...], ...]
    first_number: int = 1


def blocks(text: str) -> list[Block]:
    """Return the blocks of a page."""
    blocks: list[Block] = []
    lines = text.split("\n")
    k = 0
    while k < len(lines):
        line = lines[k]
        if line.startswith("```"):
            end = next((n for n in range(k + 1, len(lines)) if lines[n] == "```"), len(lines))
            blocks.append(Block("program", tuple((line,) for line in lines[k + 1 : end])))
            k = end + 1
            continue
        start = k
        k += 1
        if not line.strip():
            continue
        if line.startswith("#"):
            kind = "title" if line.startswith("# ") else "heading"
            blocks.append(Block(kind, ((line.lstrip("# "),),)))
            continue
        while k < len(lines) and lines[k].strip() and not lines[k].startswith(("#", "```")):
            k += 1
        blocks += _paragraph(lines[start:k])
    return blocks


def _paragraph(lines: list[str]) -> list[Block]:
    """Return the blocks of lines without an empty one among them."""
    if lines[0].startswith("|"):
        row_texts = (line.strip().removeprefix("|").removesuffix("|") for line in lines)
        rows = [tuple(cell.strip() for cell in row.split("|")) for row in row_texts]
        kept_rows = tuple(row for row in rows if set("".join(row)) - set("-: "))
        return [Block("table", kept_rows)] if kept_rows else []
    groups: list[tuple[str, list[str]]] = []
    for line in lines:
        match = ITEM.match(line)
        kind = KINDS.get(match[1], "steps") if match else "paragraph"
        if match is None and groups:
            groups[-1][1][-1] += " " + line.strip()
        elif groups and groups[-1][0] == kind:
            groups[-1][1].append(match[2] if match else line)
        else:
            groups.append((kind, [match[2] if match else line]))
    number = re.match(r"[0-9]+", lines[0])
    first_number = int(number[0]) if number and groups[0][0] == "steps" else 1
    return [Block(kind, tuple((row,) for row in rows), first_number) for kind, rows in groups]


def printed_part(page: str) -> str:
    """Return the printed part of a page."""
    return _section(page, {"print": ""})


def studio_part(page: str) -> str:
    """Return the part of a page for the studio; a hint is a paragraph that begins with HINT."""
    return _section(page, {"page": "", "hint": HINT})


def _section(page: str, prefix_of_mark: dict[str, str]) -> str:
    kept_lines = []
    for line in page.split("\n"):
        mark = MARK.match(line)
        if mark is None:
            kept_lines.append(line)
        elif mark[2] in prefix_of_mark:
            kept_lines.append((mark[1] or "") + prefix_of_mark[mark[2]] + line[mark.end() :])
    return "\n".join(kept_lines)


def as_text(page: str) -> str:
    """Return a page as a terminal shows it; its control characters are those of lines alone."""
    lines = "\n".join(printable(line) for line in page.expandtabs(4).splitlines())
    return "\n".join(_as_text(block) + "\n" for block in blocks(lines))


def _as_text(block: Block) -> str:
    if block.kind == "program":
        return "\n".join(f"    {row}" for (row,) in block.rows)
    rows = [tuple(re.sub(r"\*\*|`", "", cell) for cell in row) for row in block.rows]
    if block.kind == "table":
        widths = [max(len(row[k]) for row in rows if k < len(row)) for k in range(len(rows[0]))]
        return "\n".join(
            "  ".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=False)).rstrip()
            for row in rows
        )
    if block.kind in ("title", "heading"):
        (title,) = rows[0]
        return f"{title}\n{('=' if block.kind == 'title' else '-') * len(title)}"
    lines = []
    for number, (row,) in enumerate(rows, block.first_number):
        mark = {"list": "- ", "checks": "[ ] ", "steps": f"{number}. "}.get(block.kind, "")
        lines.append(fill(row, WIDTH, initial_indent=mark, subsequent_indent=" " * len(mark)))
    return "\n".join(lines)
