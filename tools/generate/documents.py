"""The tables that documents take from the code, and how one gets into its document.

Knows the documents of `docs/` with tables of their own. The spec's tables are in `__main__.py`.
"""

from __future__ import annotations

import ast
import os
import re
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path

from tiniscript.base.languages import SOURCE_LANGUAGE, languages, text
from tiniscript.base.words import WORDS
from tiniscript.lessons.lesson import AREA_KEYS, DEVICE_KINDS, KINDS, CriterionKind
from tiniscript.robots.text_levels import CODE_BYTES, LEVELS
from tools import ROOT, measures
from tools.generate.poster import text_beside_block
from tools.site.documents import INDEX_PAGE, documents, sources

PACKAGE = ROOT / "compiler" / "tiniscript"


def architecture_document() -> str:
    """Return `docs/develop/architecture.md` with its picture, and the description of each
    folder."""
    rows = []
    for path in sorted(PACKAGE.glob("*/**/__init__.py")):
        text = ast.get_docstring(ast.parse(path.read_bytes())) or ""
        first_paragraph = " ".join(text.split("\n\n")[0].split())
        rows.append((f"`{path.parent.relative_to(PACKAGE).as_posix()}/`", first_paragraph))
    document_text = table(("folder", "content"), rows)
    document_text = splice(_text("docs/develop/architecture.md"), "packages", document_text)
    return splice(document_text, "modules", _modules())


def _modules() -> str:
    """Return the picture of the package's modules, in the language of Mermaid."""
    graph = measures.module_imports(measures.imports_of(sorted(PACKAGE.rglob("*.py"))))
    lines = [f"  {name} --> {' & '.join(sorted(targets))}"
             for name, targets in sorted(measures.direct_imports(graph).items())
             if targets and (PACKAGE / name / "__init__.py").is_file() and name]  # fmt: skip
    return "\n".join(["```mermaid", "flowchart TD", *lines, "```", ""])


def link_document(document: str) -> str:
    """Return a document about the link with the tables that it takes from the messages."""
    from tools.generate.link_header import DOCUMENT_TABLES

    text = _text(document)
    for name, make_rows in DOCUMENT_TABLES[document].items():
        text = splice(text, name, table(*make_rows()))
    return text


def text_document() -> str:
    """Return `docs/develop/text.md` with the table of levels."""
    rows = [
        (
            f"`{level.name}`",
            ", ".join(f"`{word}`" for word in sorted(level.missing_words)) or "nothing",
            level.room,
            min(CODE_BYTES, level.room),
        )
        for level in LEVELS.values()
    ]
    levels_table = table(("level", "lacks", "room in bytes", "bytes of code, at most"), rows)
    return splice(_text("docs/develop/text.md"), "levels", levels_table)


def guarantees_document() -> str:
    """Return `docs/en/guarantees.md` with the table of goals and figures."""
    from tools.campaign.results import TABLE_HEAD, rows

    return splice(_text("docs/en/guarantees.md"), "guarantees", table(TABLE_HEAD, rows()))


def lessons_document() -> str:
    """Return `docs/en/lessons.md` with the table of criteria."""
    return splice(_text("docs/en/lessons.md"), "criteria", table(*criteria()))


def bring_up_document(document: str, language: str) -> str:
    """Return a list for a real board, with the steps of the form that `tsc doctor` writes."""
    from tiniscript.cli.commands.doctor import FORM_STEPS
    from tiniscript.cli.texts import text

    kinds = ("step", "do", "see")
    rows = [
        [number, *(text(f"{kind}_{step}", language) for kind in kinds)]
        for number, step in enumerate(FORM_STEPS, 1)
    ]
    head = [text(f"head_{kind}", language) for kind in kinds]
    return splice(_text(document), "steps", table(["", *head], rows))


def language_document(document: str, language: str) -> str:
    """Return a reference of the language, with a complete list of words.

    It has those with fixed values, and the instructions that no row by hand has.
    """
    document_text = _text(document)
    words_by_hand = set(
        re.findall(r"`([A-Z_]+)`", document_text.partition("<!-- begin generated: fixed")[0])
    )
    words = [word for word in WORDS.values() if word.role.is_instruction]
    rows = {
        "fixed": [
            f"`{word.usage.upper()}` = `{word.expansion}`" for word in words if word.expansion
        ],
        "others": [
            f"`{word.usage.upper()}` {text_beside_block(word, language)}".rstrip()
            for word in words
            if not word.expansion and word.text not in words_by_hand
        ],
    }
    labels = {key: text("documents", f"language/{key}", language) for key in rows}
    lines = (
        f"- {labels[key]}: {' '.join(row_words)}\n" for key, row_words in rows.items() if row_words
    )
    return splice(document_text, "fixed", "".join(lines))


def list_of_documents(command: str) -> str:
    """Return `docs/README.md`: title and first sentence of each, in all languages side by side."""
    listed_documents = [
        document
        for document in documents(ROOT)
        if document.sources.get(SOURCE_LANGUAGE) != INDEX_PAGE
    ]
    listed_languages = [
        language
        for language in languages()
        if any(language in document.sources for document in listed_documents)
    ]

    def text_list(key: str) -> list[str]:
        return [text("documents", key, language) for language in listed_languages]

    parts = [
        f"<!-- Generated by {command} from tools/site/documents.py. Do not edit. -->\n",
        f"# {' · '.join(text_list('list/title'))}\n",
        f"{' · '.join(text_list('list/about'))}\n",
    ]
    for part in ("teach", "write", "wiring", "trust", "build"):
        rows = [
            [_link_to(document.sources.get(language, "")) for language in listed_languages]
            for document in listed_documents
            if document.part == part
        ]
        parts.append(table(text_list(f"part/{part}"), rows))
    return "\n".join(parts)


def _link_to(source: str) -> str:
    """Return the title of a document, with a link to it, and its first sentence, or an empty
    text."""
    if not source:
        return ""
    title, sentence = _title_and_readers((ROOT / source).read_text(encoding="utf-8"))
    link = f"[{title}]({Path(os.path.relpath(source, 'docs')).as_posix()})"
    return f"{link}<br>{sentence}" if sentence else link


def _title_and_readers(text: str) -> tuple[str, str]:
    """Return the title of a document, and the sentence that says who reads it, and for what."""
    _, _, body = f"\n{text}".partition("\n# ")
    title, *paragraphs = body.split("\n\n")
    first_paragraph = next(
        (paragraph for paragraph in paragraphs if not re.match(r"[\[!<]", paragraph)), ""
    )
    first_prose = first_paragraph if re.match(r"\w|`[^`]", first_paragraph) else ""
    words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", " ".join(first_prose.split()))
    return title, re.split(r"(?<=\.)\s", words)[0]


def _text(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def splice(text: str, name: str, table: str) -> str:
    """Return `text` with `table` between the marks called `name`."""
    begin, end = f"<!-- begin generated: {name} -->\n", f"<!-- end generated: {name} -->"
    text_above, begin_mark, text_below = text.partition(begin)
    _, end_mark, text_after = text_below.partition(end)
    assert begin_mark and end_mark, f"no marks for {name}"
    return text_above + begin + table + end + text_after


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a Markdown table; a bar in a cell is escaped."""
    lines = [head, ["---"] * len(head), *rows]
    cells = [[str(cell).replace("|", "\\|") for cell in line] for line in lines]
    return "".join(f"| {' | '.join(line)} |\n" for line in cells)


DOCUMENTS: dict[str, Callable[[], str]] = {
    "docs/develop/architecture.md": architecture_document,
    "docs/develop/link.md": partial(link_document, "docs/develop/link.md"),
    "docs/develop/network.md": partial(link_document, "docs/develop/network.md"),
    "docs/develop/owners.md": partial(link_document, "docs/develop/owners.md"),
    "docs/develop/text.md": text_document,
    "docs/en/guarantees.md": guarantees_document,
    **{
        path: partial(bring_up_document, path, language)
        for language, path in sources(ROOT, "docs/en/bring-up.md").items()
    },
    **{
        path: partial(language_document, path, language)
        for language, path in sources(ROOT, "docs/en/language.md").items()
    },
    "docs/en/lessons.md": lessons_document,
}


def criteria() -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Return its head and its rows."""
    rows: list[tuple[str, ...]] = [
        (f"`{name}`", kind.meaning, ", ".join(_key_list(kind))) for name, kind in KINDS.items()
    ]
    return ("criterion", "met if", "takes"), rows


def _key_list(kind: CriterionKind) -> list[str]:
    """Return the keys, with their defaults where these say something."""
    keys = ["`at`"] if kind.places else []
    if kind.words:
        keys.append("`what`" if kind.words in DEVICE_KINDS else "`words`")
    for number in kind.numbers:
        has_default = number.default is not None and number.default < number.high
        keys.append(f"`{number.key}`" + (f" ({number.default:g})" if has_default else ""))
    keys += [f"`{key}`" for key in (*kind.flags, *(AREA_KEYS if kind.has_area else ()))]
    return keys
