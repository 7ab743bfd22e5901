"""Checks that every link of the finished site leads somewhere, and that no page loads files from
other sites.

Knows HTML files in a folder. Sphinx looks at the links inside of one language; this looks at all of
them, as a browser would follow them.
"""

from __future__ import annotations

from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

# Links that a page loads by itself, and those that a reader follows.
_FETCHED_ATTRIBUTES = {
    "img": "src",
    "script": "src",
    "link": "href",
    "iframe": "src",
    "source": "src",
}
_FOLLOWED_ATTRIBUTES = {"a": "href", "area": "href"}
_LINKS_NOT_FETCHED = (
    "canonical",
    "alternate",
    "author",
    "copyright",
    "index",
    "next",
    "prev",
    "search",
    "help",
)


class _Page(HTMLParser):
    """Collects the names of a page, and its links with how they are used."""

    def __init__(self) -> None:
        super().__init__()
        self.names: set[str] = set()
        self.links: list[tuple[str, bool]] = []  # an address, and whether it is fetched

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        self.names |= {name for name in (values.get("id"), values.get("name")) if name}
        address = values.get(_FETCHED_ATTRIBUTES.get(tag, _FOLLOWED_ATTRIBUTES.get(tag, "")))
        if address:
            is_fetched = tag in _FETCHED_ATTRIBUTES and values.get("rel") not in _LINKS_NOT_FETCHED
            self.links.append((address, is_fetched))


def dead_links(folder: Path) -> list[str]:
    """Return a line for each link that leads nowhere, and for each file from another origin.

    The studio's page is checked, but not the actions of its scripts: its own tests do that.
    """
    folder = folder.resolve()
    pages = {path: _read(path) for path in sorted(folder.rglob("*.html"))}

    @cache  # the frame around a page is the same everywhere
    def find_problem(path: Path, address: str, is_fetched: bool) -> str:
        return _link_problem(folder, path, address, is_fetched, pages)

    problem_lines: list[str] = []
    for path, page in pages.items():
        for address, is_fetched in page.links:
            is_here = address.startswith(("#", "?"))
            if reason := find_problem(path if is_here else path.parent / "*", address, is_fetched):
                problem_lines.append(f"{path.relative_to(folder).as_posix()}: {address}: {reason}")
    return problem_lines


def _read(path: Path) -> _Page:
    page = _Page()
    page.feed(path.read_text(encoding="utf-8"))
    return page


def _link_problem(
    folder: Path, path: Path, address: str, is_fetched: bool, pages: dict[Path, _Page]
) -> str:
    """Return the problem of a link of a page in a resolved folder, or ""."""
    parts = urlsplit(address)
    if parts.scheme or parts.netloc:
        if is_fetched and parts.scheme != "data":
            return "fetched from another origin"
        return ""
    target = path.parent / unquote(parts.path) if parts.path else path
    target = target.resolve()
    if not target.is_relative_to(folder):
        return "outside of the site"
    if target.is_dir():
        target /= "index.html"
    if not target.is_file():
        return "no such file"
    name = unquote(parts.fragment)
    target_page = pages.get(target)
    if name and target_page is not None and name not in target_page.names:
        return "no such place on that page"
    return ""
