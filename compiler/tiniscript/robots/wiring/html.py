"""A wiring page as one file of HTML that needs no network and prints well on A4."""

from __future__ import annotations

import re
from html import escape

from tiniscript.robots.wiring.drawing import drawing_of
from tiniscript.robots.wiring.finished import finished_of
from tiniscript.robots.wiring.page import Block, page_of
from tiniscript.robots.wiring.plan import Plan
from tiniscript.robots.wiring.texts import text

STYLE = """\
@page { size: A4; margin: 11mm; }
body { font-family: 'DejaVu Sans', Verdana, Arial, sans-serif; line-height: 1.45; color: #111;
  background: #fff; max-width: 1150px; margin: 1em auto; padding: 0 1em; }
h1, h2 { line-height: 1.2; break-after: avoid; }
h2 { margin-top: 1.6em; border-bottom: 2px solid #333; }
svg { display: block; width: 100%; height: auto; break-inside: avoid; }
table { border-collapse: collapse; width: 100%; }
th, td:first-child { white-space: nowrap; }
th, td { border: 1px solid #777; padding: 0.25em 0.6em; text-align: left; vertical-align: top;
  overflow-wrap: break-word; }
th { background: #eee; }
tr, li, p { break-inside: avoid; }
li { margin: 0.35em 0; }
ul.checks { list-style: none; padding-left: 2em; }
ul.checks li { text-indent: -2em; }
ul.checks li::before { content: "\\2610"; display: inline-block; width: 1.67em; font-size: 1.2em;
  text-indent: 0; }
td:first-child::before { content: "\\2610"; display: inline-block; width: 1.5em; }
.finished svg { max-height: 640px; }
.slide { display: none; }
@media screen and (max-width: 640px) {
  .drawing { overflow-x: auto; }
  .drawing svg { width: 900px; }
  .slide { display: block; font-weight: bold; }
  thead { display: none; }
  table, tbody, tr, td { display: block; border: 0; }
  tr { border: 1px solid #777; margin: 0.5em 0; padding: 0.2em 0.4em; }
  td { padding: 0.1em 0; }
  td:first-child { font-weight: bold; white-space: normal; }
  td:not(:first-child)::before { content: attr(data-head) ": "; color: #555; }
  td:empty { display: none; }
}
@media print {
  body { font-size: 10.5pt; max-width: none; margin: 0; padding: 0; }
  svg { max-height: 236mm; break-after: page; }
  .finished svg { max-height: 120mm; break-after: auto; }
}
"""


def html_of(plan: Plan) -> str:
    """Return the page of a plan, with its drawing inside."""
    blocks = page_of(plan)
    title = escape(blocks[0].text)
    body = "\n".join(_block(block, plan) for block in blocks)
    return (
        f'<!DOCTYPE html>\n<html lang="{plan.language}">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        '<meta name="generator" content="TiniScript">\n'
        f"<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n{body}\n"
        "</body>\n</html>\n"
    )


def _bold_html(sentence: str) -> str:
    return re.sub(r"\*\*([^*]+)\*\*", r"<strong>\1</strong>", escape(sentence))


def _block(block: Block, plan: Plan) -> str:
    if block.kind in ("drawing", "finished"):
        svg = drawing_of(plan) if block.kind == "drawing" else finished_of(plan)
        paragraphs = f"<p>{_bold_html(block.text)}</p>\n"
        if block.kind == "drawing":  # a phone shows a part of a drawing
            paragraphs += f'<p class="slide">{escape(text("slide", plan.language))}</p>\n'
        return f'{paragraphs}<div class="{block.kind}">\n{svg}</div>'
    if block.kind == "ticks":
        head, *rows = block.rows
        lines = "\n".join(_row(row, head) for row in rows)
        heads = "".join(f"<th>{_bold_html(cell)}</th>" for cell in head)
        return f"<table>\n<thead><tr>{heads}</tr></thead>\n<tbody>\n{lines}\n</tbody>\n</table>"
    if block.kind in ("list", "checks"):
        items = "\n".join(f"<li>{_bold_html(item)}</li>" for (item,) in block.rows)
        mark = ' class="checks"' if block.kind == "checks" else ""
        return f"<ul{mark}>\n{items}\n</ul>"
    tag = {"title": "h1", "heading": "h2"}.get(block.kind, "p")
    return f"<{tag}>{_bold_html(block.text)}</{tag}>"


def _row(cells: tuple[str, ...], head: tuple[str, ...]) -> str:
    """Return a row; each cell knows its column, which a narrow screen shows next to it."""
    html_cells = (
        f'<td data-head="{escape(name)}">{_bold_html(cell)}</td>'
        for cell, name in zip(cells, head, strict=True)
    )
    return f"<tr>{''.join(html_cells)}</tr>"
