"""The pages on a USB stick: documents, wiring and lessons as HTML that needs no network.

A document becomes a page with the same name and the same neighbours, so links still work. Files
outside that it links to (such as a source file) are copied unchanged.
"""

from __future__ import annotations

import re
import shutil
from contextlib import redirect_stdout
from functools import partial
from html import escape
from io import StringIO
from itertools import pairwise
from pathlib import Path

from markdown_it import MarkdownIt
from markdown_it.token import Token

from tiniscript import robots
from tiniscript.base.languages import SOURCE_LANGUAGE, language_info, text, translated_languages
from tiniscript.lessons import catalogue
from tiniscript.robots.wiring.html import html_of
from tiniscript.robots.wiring.plan import plan_of
from tools.generate.built import build_all
from tools.site.documents import language_of, name_in, sources

STYLE = """\
body { font-family: Verdana, 'DejaVu Sans', Arial, sans-serif; line-height: 1.5; color: #111;
  max-width: 55em; margin: 1em auto; padding: 0 1em; overflow-wrap: break-word; }
pre { background: #f3f3f3; padding: 0.6em; white-space: pre-wrap; overflow-wrap: anywhere; }
table { border-collapse: collapse; display: block; overflow-x: auto; }
th, td { border: 1px solid #999; padding: 0.25em 0.6em; text-align: left; vertical-align: top; }
th { background: #eee; }
img { max-width: 100%; }
li.check { list-style: none; }
@media (max-width: 40em) { th, td { font-size: 0.8em; padding: 0.15em 0.3em; } }
@page { size: A4; margin: 15mm; }
@media print { h2, h3 { break-after: avoid; } tr, pre, li { break-inside: avoid; } }
"""
GUIDES = ("docs/en/monday.md", "docs/en/lessons.md", "docs/en/materials.md", "docs/en/studio.md",
          "docs/en/class.md", "docs/en/language.md", "docs/en/robots.md", "docs/en/command.md",
          "docs/en/worlds.md", "docs/en/modules.md", "docs/en/api.md", "README.md")  # fmt: skip
INDEX, POSTER = "index.html", "docs/poster/poster.en.pdf"
LINK = re.compile(r'(href|src)="([^"#:]+)(#[^"]*)?"')


def make(root: Path, folder: Path) -> None:
    """Write all pages into a folder, with an index in each language."""
    pages = {path: path.read_text(encoding="utf-8")
             for path in (*root.glob("*.md"), *root.glob("docs/**/*.md"))}  # fmt: skip
    pages |= {
        root / name: text for name, text in build_all().items() if name.endswith("command.md")
    }
    linked_paths = {(root / name).resolve() for name in sources(root, POSTER).values()}
    titles: dict[str, str] = {}
    for source, markdown in pages.items():
        body, title = render(markdown)
        linked_paths |= {(source.parent / path).resolve() for _, path, _ in LINK.findall(body)}
        body = LINK.sub(partial(_to_page, folder=source.parent, documents=list(pages)), body)
        name = source.relative_to(root).as_posix()
        titles[name] = title
        _write((folder / name).with_suffix(".html"), page(title, body, language_of(name)))
    for path in sorted(linked_paths - {path.resolve() for path in pages}):
        target = folder / path.relative_to(root.resolve())
        if path.is_file():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, target)
        else:
            _write(
                target / "index.html",
                page(path.name, f"<p>{escape(path.name)}/</p>", SOURCE_LANGUAGE),
            )
    for language in translated_languages("documents", "stick/title"):
        for name in robots.names():
            plan = plan_of(robots.load(name).with_language(language), language)
            _write(folder / "wiring" / f"{name}.{language}.html", html_of(plan))
        _write(folder / name_in(language, INDEX), _index(root, folder, language, titles))


def page(title: str, body: str, language: str) -> str:
    return (
        f'<!DOCTYPE html>\n<html lang="{language}">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n{body}\n"
        "</body>\n</html>\n"
    )


def render(text: str) -> tuple[str, str]:
    """Return the HTML of a Markdown text, whose headings have names as on GitHub, and its title."""
    parser = MarkdownIt("commonmark", {"html": False}).enable("table")
    tokens = parser.parse(text)
    title = ""
    heading_counts: dict[str, int] = {}
    for token, content in pairwise(tokens):
        if token.type == "heading_open":
            title = title or content.content.replace("`", "")
            token.attrSet("id", _anchor(content, heading_counts))
    body = str(parser.renderer.render(tokens, parser.options, {}))
    return body.replace("<li>[ ] ", '<li class="check">\N{BALLOT BOX} '), title


def _anchor(heading: Token, heading_counts: dict[str, int]) -> str:
    words = "".join(token.content for token in heading.children or ())
    name = re.sub(r"[^\w\- ]", "", words.lower()).replace(" ", "-")
    number = heading_counts.get(name, 0)
    heading_counts[name] = number + 1
    return f"{name}-{number}" if number else name


def _to_page(match: re.Match[str], folder: Path, documents: list[Path]) -> str:
    kind, path, anchor = match.group(1), match.group(2), match.group(3) or ""
    if (folder / path).resolve() in {document.resolve() for document in documents}:
        path = path.removesuffix(".md") + ".html"
    elif (folder / path).is_dir():
        path = path.rstrip("/") + "/index.html"
    return f'{kind}="{path}{anchor}"'


def _index(root: Path, folder: Path, language: str, titles: dict[str, str]) -> str:
    """Write the lessons' sheets, and return the page that leads to everything."""
    from tiniscript.cli import main as tsc

    keys = ("title", "lessons", "pupils", "teacher", "wiring", "guides", "poster")
    title, lessons, pupils, teacher, wiring, guides, poster = (
        text("documents", f"stick/{key}", language) for key in keys
    )
    other_links = " · ".join(
        f'<a href="{name_in(other_language, INDEX)}">{language_info(other_language).name}</a>'
        for other_language in translated_languages("documents", "stick/title")
        if other_language != language
    )
    rows = [f"<h1>{title}</h1>", f"<p>{other_links}</p>", f"<h2>{guides}</h2>", "<ul>"]
    for guide in GUIDES:
        own_name = name_in(language, guide)
        name = own_name if own_name in titles else guide
        address = f"{name.removesuffix('.md')}.html"
        rows.append(f'<li><a href="{address}">{escape(titles[name])}</a></li>')
    file = sources(root, POSTER).get(language, POSTER)
    rows += [f'<li><a href="{file}">{poster}</a></li>', "</ul>"]
    rows += [f"<h2>{wiring}</h2>", "<ul>"]
    for name in robots.names():
        label = robots.load(name).labels[language]["robot"]
        rows.append(f'<li><a href="wiring/{name}.{language}.html">{escape(label)}</a></li>')
    rows += ["</ul>", f"<h2>{lessons}</h2>", "<ol>"]
    for number, lesson_folder in enumerate(catalogue.folders(), 1):
        links = []
        for label, options in ((pupils, []), (teacher, ["--teacher"])):
            path = Path("lessons") / f"{number:02}.{'teacher.' if options else ''}{language}.html"
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            words = ["lesson", "sheet", str(number), "-o", str(folder / path), *options]
            with redirect_stdout(StringIO()):
                exit_code = tsc([*words, "--lang", language])
            if exit_code:
                raise SystemExit(exit_code)
            links.append(f'<a href="{path.as_posix()}">{label}</a>')
        name = escape(catalogue.load(lesson_folder).title(language))
        rows.append(f"<li>{name}: {', '.join(links)}</li>")
    return page(title, "\n".join([*rows, "</ol>"]), language)


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8", newline="\n")
