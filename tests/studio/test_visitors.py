"""Of the tests themselves: who visits a page in a browser that others have used is new to it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tests.support import studio
from tests.support.studio import Pages
from tiniscript.studio.serving import TYPES, File

if TYPE_CHECKING:
    from playwright.sync_api import Browser

PAGE = {
    "index.html": b'<!doctype html><html data-state="checked"><button id="view_text">',
    "pyodide.asm.wasm": b"\0asm\1\0\0\0",
    studio.STILL: b"",
}
# Returns how much was there before.
LEAVES = """async () => {
  const found = [localStorage.length, sessionStorage.length, document.cookie.length,
    (await caches.keys()).length, (await indexedDB.databases()).length];
  localStorage.a = sessionStorage.a = document.cookie = 'a=1';
  await caches.open('a');
  const opens = indexedDB.open('a');
  await new Promise((done) => { opens.onsuccess = done; });
  opens.result.close();
  return found;
}"""


def test_a_visitor_finds_nothing_of_an_earlier_one(browser: Browser) -> None:
    files = {name: File(data, TYPES[f".{name.rpartition('.')[2]}"]) for name, data in PAGE.items()}
    with studio.served(page=files) as server:
        first, second = (Pages(browser, server.address) for _ in range(2))
        used = set()
        for pages in (first, second):
            page = pages.open()
            context = page.context
            used.add(context)
            assert page.evaluate(LEAVES) == [0] * 5
            context.new_page()
            pages.close()
            assert page.is_closed() and len(context.pages) == 1 and pages.wrong == []
            first.address = "https://elsewhere.example"  # what it still hears would be wrong
        assert first.wrong == [] and len(used) == 1
