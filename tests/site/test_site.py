"""The site: every document is on it, every link leads somewhere, and it is read in a browser."""

from __future__ import annotations

import functools
import http.server
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING

import pytest

from tests.machines.host import make_once
from tests.support import studio
from tests.support.casefile import ROOT
from tests.support.platformio import shared_folder
from tests.support.rows import each_row
from tools import CannotMake
from tools.builds import site
from tools.builds import studio as studio_build
from tools.generate.built import build_all as built_texts
from tools.generate.built import makers_of_kept
from tools.site.documents import PARTS, documents
from tools.site.lexer import TiniScriptLexer
from tools.site.pages import page, shelf

pytestmark = pytest.mark.long  # the whole site is built

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page


@pytest.fixture(scope="session")
def site_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_once(
        shared_folder(tmp_path_factory) / "site",
        lambda path: site.build(ROOT, path, has_studio=not studio_build.unusable_reason()),
    )


@pytest.fixture(scope="module")
def address(site_folder: Path) -> Iterator[str]:
    class Quiet(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *words: object) -> None:
            """Say nothing."""

    class Server(http.server.ThreadingHTTPServer):
        def handle_error(self, request: object, client_address: object) -> None:
            """Say nothing of a browser that has left."""

    handler = functools.partial(Quiet, directory=str(site_folder))
    server = Server(("127.0.0.1", 0), handler)
    thread = Thread(target=server.serve_forever, args=(0.02,), daemon=True)
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}/"
    server.shutdown()
    server.server_close()
    thread.join()


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with studio.driver() as driver, studio.browser(driver) as browser:
        yield browser


@pytest.fixture
def visitor(browser: Browser, address: str) -> Iterator[Page]:
    """A page whose requests must stay on the site."""
    context = browser.new_context(service_workers="block")
    opened_page = context.new_page()
    questions: list[str] = []
    errors: list[str] = []
    opened_page.on("request", lambda request: questions.append(request.url))
    opened_page.on("pageerror", lambda failure: errors.append(str(failure)))
    yield opened_page
    context.close()
    assert questions
    assert [
        requested_address
        for requested_address in questions
        if not requested_address.startswith((address, "data:"))
    ] == []
    assert errors == []


def test_every_document_is_on_the_site_in_a_section(site_folder: Path) -> None:
    listed_documents = documents(ROOT, built_texts())
    sources = {source for document in listed_documents for source in document.sources.values()}
    paths = [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"),
             *ROOT.glob("compiler/tiniscript/lessons/*/*.md")]  # fmt: skip
    document_paths = {path.relative_to(ROOT).as_posix() for path in paths}
    assert document_paths | {name for name in built_texts() if name.endswith(".md")} == sources
    assert {document.part for document in listed_documents} == set(PARTS)
    for document in listed_documents:
        for language in document.sources:
            assert (site_folder / language / f"{document.name}.html").is_file()


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    """The documents of this repository, to be changed."""
    for path in ("docs", "compiler/tiniscript/lessons", "compiler/tiniscript/robots", "tools/site"):
        shutil.copytree(ROOT / path, tmp_path / "clone" / path)
    for file in (*ROOT.glob("*.md"), ROOT / "CITATION.cff"):
        shutil.copy(file, tmp_path / "clone")
    return tmp_path / "clone"


def test_a_broken_internal_link_fails_the_build(
    clone: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    few = [
        document for document in documents(ROOT) if document.name in ("link", "store")
    ]  # only in English
    monkeypatch.setattr(site, "documents", lambda root, built: few)
    store = clone / "docs" / "develop" / "store.md"
    text = "# A title\n"
    for path in clone.rglob("*.md"):
        path.write_text(text, encoding="utf-8")
    store.write_text(f"{text}\n[no](nowhere.md)\n", encoding="utf-8")
    with pytest.raises(CannotMake, match=r"^docs/develop/store\.md: nowhere\.md$"):
        site.build(clone, tmp_path / "site", has_studio=False)
    # Files that Sphinx reads itself.
    store.write_text(f"{text}\n[no](link.md#elsewhere)\n\n```strange\nx\n```\n", encoding="utf-8")
    with pytest.raises(CannotMake) as error_info:
        site.build(clone, tmp_path / "site", has_studio=False)
    assert "elsewhere" in str(error_info.value)
    assert "strange" in str(error_info.value)
    assert len(str(error_info.value).splitlines()) <= 4, error_info.value
    assert not (tmp_path / "site").exists()


def test_a_dead_link_fails_the_build(
    tmp_path: Path, site_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """These links Sphinx does not check: those between the languages, and in templates."""

    def render(source_folder: Path, folder: Path, link: object, has_studio: bool) -> None:
        folder.mkdir(parents=True)
        (folder / "store.html").write_text('<a href="../es/monday.html#nowhere">no</a>')
        (folder / "monday.html").touch()

    monkeypatch.setattr(site, "render", render)
    with pytest.raises(CannotMake, match="no such place on that page"):
        site.build(ROOT, tmp_path / "site", has_studio=False)


def test_links_point_to_pages_and_copies() -> None:
    texts = built_texts()
    on = shelf(ROOT, documents(ROOT, texts), texts)
    for language in ("en", "es", "pt"):  # each leads to wiring in its own language
        assert "](wiring/tinibot.md)" in page(f"docs/{language}/monday.md", on)
    assert '<a href="../files/docs/poster/poster.en.pdf">' in page("docs/en/materials.md", on)
    assert '<a href="../en/command.html' in page("docs/es/command.md", on)
    assert '<a href="../en/robots.html' in page("docs/es/robots.md", on), "to itself in English"
    assert "docs/pictures/wiring/liner.en.svg" not in on.linked_files | on.pictures
    assert "![" in page("docs/en/wiring/liner.md", on)
    assert "docs/pictures/wiring/liner.en.svg" in on.pictures


def test_a_clone_contains_only_generated_files_that_readers_need() -> None:
    paths = (*ROOT.glob("docs/*/wiring/*"), *ROOT.glob("docs/*/command.md"))
    names = {path.relative_to(ROOT).as_posix() for path in paths}
    assert names == set(makers_of_kept()) < set(built_texts())


def test_code_is_left_unchanged(clone: Path) -> None:
    (clone / "docs" / "develop" / "store.md").write_text("# A\n\n```text\n[x](nowhere.md)\n```\n")
    assert "[x](nowhere.md)" in page("docs/develop/store.md", shelf(clone, documents(clone)))


def test_programs_are_highlighted() -> None:
    tokens = TiniScriptLexer().get_tokens("si|F(2.5, 80) // go")
    kinds = [str(kind).removeprefix("Token.") for kind, text in tokens if text.strip()]
    assert kinds == ["Keyword.Namespace", "Operator", "Name.Builtin", "Punctuation",
                     "Literal.Number", "Punctuation", "Literal.Number", "Punctuation",
                     "Comment.Single"]  # fmt: skip


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(4))
def test_nothing_is_wider_than_a_phone(visitor: Page, address: str, part: int) -> None:
    visitor.set_viewport_size({"width": 390, "height": 844})
    visitor.goto(address)
    wide = [address] if _is_too_wide(visitor) else []
    for document in documents(ROOT, built_texts())[part::4]:
        for language in document.sources:
            visitor.goto(f"{address}{language}/{document.name}.html", wait_until="domcontentloaded")
            if _is_too_wide(visitor):
                wide.append(f"{language}/{document.name}")
    assert wide == []


def test_nothing_is_wider_than_the_screen(visitor: Page, address: str) -> None:
    for name in ("en/index", "es/index", "en/guarantees", "en/wiring/tinibot", "es/language"):
        visitor.goto(f"{address}{name}.html")
        for width, height in ((1366, 768), (1024, 600)):
            visitor.set_viewport_size({"width": width, "height": height})
            assert not _is_too_wide(visitor), (name, width)


def _is_too_wide(page: Page) -> bool:
    return bool(page.evaluate("document.documentElement.scrollWidth > window.innerWidth"))


def test_the_search_finds_a_word(visitor: Page, address: str) -> None:
    for language, word, title in (
        ("en", "heartbeat", "The link"),
        ("es", "obstáculos", "lenguaje"),
        ("en", "END_LOOP", "language"),
        ("en", "UNTIL", "Stop before the wall: UNTIL"),
        ("es", "SI", "lenguaje"),
    ):
        visitor.goto(f"{address}{language}/index.html")
        visitor.fill("input[name=q]", word)
        visitor.press("input[name=q]", "Enter")
        visitor.wait_for_selector(f"ul.search li a:has-text('{title}')")


def test_each_language_links_to_the_other(visitor: Page, address: str) -> None:
    visitor.goto(f"{address}en/monday.html")
    visitor.click(".languages a[lang=es]")
    assert visitor.url == f"{address}es/monday.html"
    assert visitor.locator("html").get_attribute("lang") == "es"
    visitor.goto(f"{address}en/link.html")  # the page exists only in English
    visitor.click(".languages a[lang=es]")
    assert visitor.url == f"{address}es/index.html"


@each_row("name", ["class", "index", "search", "lessons/01_first_line_pupil"])
def test_the_frame_of_a_spanish_page_is_spanish(site_folder: Path, name: str) -> None:
    english, spanish = (
        _texts_around_article(site_folder / language / f"{name}.html") for language in ("en", "es")
    )
    assert len(english) > 15
    assert english & spanish <= {"TiniScript", "Furo", "tsc", "Português"}


def _texts_around_article(path: Path) -> set[str]:
    """Return the texts and labels of a page that are not in its article."""
    text = re.sub(r"(?s)<(script|style|article).*?</\1>", "", path.read_text(encoding="utf-8"))
    labels = re.findall(r'(?:aria-label|title|placeholder)="([^"]+)"', text)
    return {" ".join(text.split()) for text in (*re.findall(r">([^<>]+)<", text), *labels)} - {""}


def test_the_studio_is_on_the_site(visitor: Page, address: str, site_folder: Path) -> None:
    assert not (site_folder / "studio" / studio_build.STAMP).exists()
    visitor.goto(f"{address}en/lessons.html")
    visitor.click(".languages a:has-text('Studio')")
    visitor.wait_for_selector("[data-state]", state="attached")
    assert visitor.url.startswith(f"{address}studio/")


def test_a_folder_with_other_contents_is_left_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    assert site.main([str(tmp_path), "--no-studio"]) == 2
    assert "is not empty" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_an_unbuilt_studio_is_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(studio_build, "unusable_reason", lambda: "the page is not built.")
    assert site.main([str(tmp_path / "site")]) == 2
    assert capsys.readouterr().err == "site: the page is not built. Without it:  --no-studio\n"


def test_a_missing_sphinx_is_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(site, "find_spec", lambda name: None)
    assert site.main([str(tmp_path / "site"), "--no-studio"]) == 2
    assert 'pip install -e ".[site]"' in capsys.readouterr().err
