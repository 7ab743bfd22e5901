"""A page of a lesson as one file of HTML that needs no network and prints on A4.

Knows HTML. The text comes from the lesson's Markdown, the drawing from `map`.
"""

from __future__ import annotations

import re
from functools import partial
from html import escape

from tiniscript.base import languages
from tiniscript.lessons.lesson import Lesson
from tiniscript.lessons.map import plan
from tiniscript.lessons.markdown import Block, blocks

STYLE = """\
@page { size: A4; margin: 11mm 13mm; }
body { font-family: 'DejaVu Sans', Verdana, Arial, sans-serif; line-height: 1.4; color: #111;
  background: #fff; max-width: 800px; margin: 1em auto; padding: 0 1em; }
h1, h2 { line-height: 1.2; break-after: avoid; }
h1 { margin: 0.2em 0; }
h2 { margin: 1em 0 0.3em; border-bottom: 2px solid #333; font-size: 1.15em; }
p, ul, ol { margin: 0.4em 0; }
p.names { display: flex; gap: 1em; border-bottom: 1px solid #777; padding-bottom: 0.6em; }
p.names span { flex: 1; }
svg { display: block; width: 100%; max-height: 62mm; margin: 0.5em 0; break-inside: avoid; }
pre { background: #f3f3f3; border: 1px solid #999; padding: 0.5em 0.8em; margin: 0.4em 0;
  white-space: pre-wrap; break-inside: avoid; }
pre, code { font-family: 'DejaVu Sans Mono', Consolas, monospace; font-size: 0.95em; }
table { border-collapse: collapse; width: 100%; break-inside: avoid; }
th, td { border: 1px solid #777; padding: 0.25em 0.5em; text-align: left; vertical-align: top;
  overflow-wrap: anywhere; }
th { background: #eee; overflow-wrap: normal; }
.blank { display: inline-block; min-width: 4em; border-bottom: 1px solid #333; }
li, p { break-inside: avoid; }
ul.checks { list-style: none; padding-left: 1.6em; }
ul.checks li { text-indent: -1.6em; }
ul.checks li::before { content: "\\2610"; display: inline-block; width: 1.33em; font-size: 1.2em;
  text-indent: 0; }
@media (max-width: 30em) { th, td { padding: 0.2em 0.3em; } }
@media print {
  body { font-size: 9.5pt; line-height: 1.32; max-width: none; margin: 0; padding: 0; }
  svg { max-height: 46mm; }
}
"""
BLANKS = ("names", "robot", "date")


def _sheet_text(language: str, key: str) -> str:
    return languages.text("lessons", f"sheet/{key}", language)


def sheet(page: str, lesson: Lesson, is_teachers: bool, language: str) -> str:
    """Return the page of pupils or of teachers. `page` is its Markdown."""
    text_of = partial(_sheet_text, language)
    page_blocks = blocks(page)
    title = lesson.title(language)
    parts = [_html(block) for block in page_blocks]
    caption_lines = [text_of("plan")]
    if lesson.variations:
        caption_lines.append(text_of("moves"))
    if lesson.is_mirrored:
        caption_lines.append(text_of("mirrored"))
    drawing = f"{plan(lesson, title)}\n<p>{escape(' '.join(caption_lines))}</p>"
    if not is_teachers:
        names = "".join(f"<span>{escape(name)}</span>" for name in map(text_of, BLANKS))
        parts.insert(1, f'<p class="names">{names}</p>\n{drawing}')
    else:
        parts.insert(1, drawing)
    body = "\n".join(parts)
    return (
        f'<!DOCTYPE html>\n<html lang="{language}">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="generator" content="TiniScript">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n{body}\n"
        "</body>\n</html>\n"
    )


def _words(words: str) -> str:
    """Return a line with its **bold** and `code`."""
    parts = re.split(r"(`[^`]+`)", words)
    return "".join(
        f"<code>{escape(part[1:-1])}</code>"
        if len(part) > 2 and part[0] == part[-1] == "`"
        else re.sub(r"\*\*([^*]+)\*\*", r"<strong>\1</strong>", _fill_blanks(escape(part)))
        for part in parts
    )


def _fill_blanks(words: str) -> str:
    """Return words with room for a pupil's answer where they have `____`."""
    return words.replace("____", '<span class="blank">&nbsp;</span>')


def _html(block: Block) -> str:
    if block.kind == "program":
        return "<pre>" + "\n".join(escape(row) for (row,) in block.rows) + "</pre>"
    if block.kind == "table":
        header, *rows = block.rows
        lines = "\n".join(_row(row, "td") for row in rows)
        return f"<table>\n<thead>{_row(header, 'th')}</thead>\n<tbody>\n{lines}\n</tbody>\n</table>"
    if block.kind in ("list", "checks", "steps"):
        items = "\n".join(f"<li>{_words(item)}</li>" for (item,) in block.rows)
        tag = "ol" if block.kind == "steps" else "ul"
        attributes = ' class="checks"' if block.kind == "checks" else ""
        if block.first_number > 1:
            attributes = f' start="{block.first_number}"'
        return f"<{tag}{attributes}>\n{items}\n</{tag}>"
    tag = {"title": "h1", "heading": "h2"}.get(block.kind, "p")
    return f"<{tag}>{_words(block.rows[0][0])}</{tag}>"


def _row(cells: tuple[str, ...], tag: str) -> str:
    return "<tr>" + "".join(f"<{tag}>{_words(cell)}</{tag}>" for cell in cells) + "</tr>"
