"""Builds the site: the documents in each language, and the studio.

    python -m tools.builds.site site

writes a folder for any static host: a part for each language with a search, `en/` and `es/`,
`studio/` where its page is built (`python -m tools.builds.studio`), and `files/` with the other
files that the documents link to. Needs `pip install -e ".[site]"`. A link that leads nowhere ends
it, so does every warning of Sphinx.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec
from pathlib import Path

from tiniscript.base.languages import SOURCE_LANGUAGE, language_info, languages, text
from tools import ROOT, CannotMake
from tools.builds import studio
from tools.generate.built import build_all
from tools.site import links, theme
from tools.site.documents import FRONT_PAGE, PARTS, Document, documents, sources
from tools.site.pages import FILES_FOLDER, Shelf, SitePage, page, shelf

SITE_SOURCES = ROOT / "tools" / "site"
LANGUAGES_AT_ONCE = 2  # parts of the site, one for each language


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="site", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path, help="a folder that is not there yet, or is empty")
    parser.add_argument("--no-studio", action="store_true", help="leave the studio out")
    options = parser.parse_args(arguments)
    folder: Path = options.folder
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        print(f"site: {folder} is there already, and is not empty.", file=sys.stderr)
        return 2
    reason = "" if options.no_studio else studio.unusable_reason()
    if reason:
        print(f"site: {reason} Without it:  --no-studio", file=sys.stderr)
        return 2
    try:
        build(ROOT, folder, has_studio=not options.no_studio)
    except CannotMake as error:
        print(f"site: {error}", file=sys.stderr)
        return 2
    size = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
    print(f"{folder}: {size / 1e6:.0f} MB")
    return 0


def build(root: Path, folder: Path, has_studio: bool) -> None:
    """Write the site of a clone into a folder, whole or not at all. Raises CannotMake."""
    if find_spec("sphinx") is None:
        raise CannotMake('Sphinx is not installed. Do that with:  pip install -e ".[site]"')
    with tempfile.TemporaryDirectory() as scratch:
        new_folder = Path(scratch) / "site"
        _build(root, new_folder, Path(scratch), has_studio)
        shutil.copytree(new_folder, folder, dirs_exist_ok=True)


def _build(root: Path, folder: Path, scratch: Path, has_studio: bool) -> None:
    texts = build_all()
    site_documents = documents(root, texts)
    shelf_ = shelf(root, site_documents, texts)
    site_languages = languages_of(site_documents)

    def make(language: str) -> None:
        source_folder = scratch / language
        stage(source_folder, site_documents, shelf_, language)
        render(source_folder, folder / language, site_documents, has_studio)

    with ThreadPoolExecutor(LANGUAGES_AT_ONCE) as pool:
        list(pool.map(make, site_languages))
    for name in sorted(shelf_.linked_files):
        shelf_.copy(name, folder / FILES_FOLDER / name)
    link = ""
    if has_studio:
        shutil.copytree(studio.PAGE, folder / "studio",
                        ignore=shutil.ignore_patterns(studio.STAMP))  # fmt: skip
        link = '<a href="studio/index.html">TiniScript Studio</a>'
    start_page = (SITE_SOURCES / "choice.html").read_text(encoding="utf-8")
    rows = "\n".join(map(_start_page, reversed(site_languages)))
    start_page = start_page.replace("STUDIO", link).replace("LANGUAGES", rows)
    (folder / "index.html").write_text(start_page, encoding="utf-8")
    (folder / ".nojekyll").touch()  # without this file, some hosts omit folders that begin with _
    dead_links = links.dead_links(folder)
    if dead_links:
        raise CannotMake("\n".join(dead_links))


def languages_of(documents: list[Document]) -> list[str]:
    """Return the languages of the documents, English first."""
    return [
        language
        for language in languages()
        if any(language in document.sources for document in documents)
    ]


def _start_page(language: str) -> str:
    sentence = f"{language_info(language).name}: {text('documents', 'site/choice', language)}"
    return f'<a href="{language}/index.html" lang="{language}" hreflang="{language}">{sentence}</a>'


def stage(source_folder: Path, documents: list[Document], shelf_: Shelf, language: str) -> None:
    """Write the sources of one language, as Sphinx reads them. Raises CannotMake.

    A language without a front page has the English one.
    """
    pages = {
        document.name: page(document.sources[language], shelf_)
        for document in documents
        if language in document.sources
    }
    front = sources(shelf_.root, FRONT_PAGE)
    front_page = page(front.get(language, FRONT_PAGE), shelf_, SitePage(language, "index"))
    for name, markdown in {**pages, "index": front_page + contents(documents, language)}.items():
        target = source_folder / f"{name}.md"
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(markdown, encoding="utf-8")
    for name in sorted(shelf_.pictures):
        shelf_.copy(name, source_folder / FILES_FOLDER / name)
    for name in ("templates", "static"):
        shutil.copytree(SITE_SOURCES / name, source_folder / name)
    shutil.copy(SITE_SOURCES / "conf.py", source_folder)


def render(source_folder: Path, folder: Path, documents: list[Document], has_studio: bool) -> None:
    """Make the pages of one language with Sphinx. It raises CannotMake with the complaints."""
    language = folder.name
    language_names = {
        other_language: language_info(other_language).name
        for other_language in languages_of(documents)
        if other_language != language
    }
    settings = {
        "others": language_names,
        "pages": {page.name: list(page.sources) for page in documents},
        "has_studio": has_studio,
    }
    (source_folder / "settings.json").write_text(json.dumps(settings), encoding="utf-8")
    command = [sys.executable, "-m", "sphinx", "-b", "html", "-q", "-W", "--keep-going",
             "-E", "-D", f"language={language}",
             "-d", str(source_folder.parent / f"{language}.trees"),
             str(source_folder), str(folder)]  # fmt: skip
    paths = os.pathsep.join([str(ROOT), str(ROOT / "compiler")])
    result = subprocess.run(command, capture_output=True, text=True, errors="replace",
                               env={**os.environ, "PYTHONPATH": paths})  # fmt: skip
    if result.returncode:
        raise CannotMake(
            (result.stdout + result.stderr).replace(f"{source_folder}{os.sep}", "").strip()
        )
    if language != SOURCE_LANGUAGE:
        theme.translate(folder, language)


def contents(documents: list[Document], language: str) -> str:
    """Return the table of contents of one language, which the page's side shows."""
    rows: list[str] = []
    for part in PARTS:
        names = [
            document.name
            for document in documents
            if document.part == part and language in document.sources
        ]
        names = ["self" if name == "index" else name for name in names]
        if names:
            rows += [
                "",
                "```{toctree}",
                ":hidden:",
                f":caption: {text('documents', f'part/{part}', language)}",
                "",
                *names,
                "```",
            ]
    return "\n".join(rows) + "\n"


if __name__ == "__main__":
    sys.exit(main())
