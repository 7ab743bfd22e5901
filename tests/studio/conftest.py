"""A browser and a server that the tests of the page share.

They end with the tests of this folder: Playwright keeps an event loop running in this thread, and
while it does no other test can begin one.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest

from tests.support import studio
from tests.support.waiting import HANG_LIMIT_S
from tiniscript.studio import attending, serving

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, Playwright


@pytest.fixture
def server_host(server: serving.Server) -> str:
    """The name in a request of the `server` that a file has."""
    return f"{serving.HOST}:{server.server_port}"


@pytest.fixture
def no_page_timeouts(monkeypatch: pytest.MonkeyPatch) -> None:
    """A page may be silent for as long as a busy computer keeps it so: its robot drives on."""
    monkeypatch.setattr(attending, "ATTENDED_S", HANG_LIMIT_S)
    monkeypatch.setattr(attending, "LEFT_S", HANG_LIMIT_S)


@pytest.fixture(scope="package")
def playwright() -> Iterator[Playwright]:
    with studio.driver() as started_playwright:
        yield started_playwright


@pytest.fixture(scope="package")
def browser(playwright: Playwright) -> Iterator[Browser]:
    with studio.browser(playwright) as browser:
        yield browser


@pytest.fixture(scope="module")
def server(browser: Browser) -> Iterator[serving.Server]:
    """A `tsc studio` that holds the robots of its pages."""
    with studio.serve_robots() as server:
        yield server


@pytest.fixture
def hosted_pages(browser: Browser, server: serving.Server) -> Iterator[studio.Pages]:
    """Pages of that server, which must not report errors."""
    opened_pages = studio.Pages(browser, server.address, entrance=server.entrance)
    yield opened_pages
    opened_pages.close()
    assert not opened_pages.errors


@pytest.fixture(scope="package")
def address(browser: Browser) -> Iterator[str]:
    with studio.serve_page() as server:
        yield server.address


@pytest.fixture
def pages(browser: Browser, address: str) -> Iterator[studio.Pages]:
    opened_pages = studio.Pages(browser, address)
    yield opened_pages
    opened_pages.close()
    assert not opened_pages.errors


@pytest.fixture(scope="module")
def only_page(browser: Browser, address: str) -> Iterator[tuple[studio.Pages, Page]]:
    """A page shared by many tests, because Python starts slowly."""
    opened_pages = studio.Pages(browser, address)
    yield opened_pages, opened_pages.open()
    opened_pages.close()


@pytest.fixture
def page(only_page: tuple[studio.Pages, Page]) -> Iterator[Page]:
    """The page as `begin_anew` has it. Its errors are checked after each test."""
    pages, current_page = only_page
    studio.begin_anew(current_page)
    yield current_page
    errors, pages.errors[:] = pages.errors[:], []
    assert not errors
