"""The page in a language whose texts are a third longer: no text is cut or too wide."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from tests.studio.screens import each_screen
from tests.support import studio
from tests.support.pseudo import pseudo
from tests.support.studio import SETTLED_SCRIPT, Pages

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, Route

SIZES = ((1366, 768), (390, 844), (844, 390))
WINDOWS = (("#class_come", "#big_code"), ("#wall .see >> nth=0", "#big_pupil"),
           ("#class_settings", "#class_window"))  # fmt: skip
PUPIL_MESSAGE = {"do": "here", "text": "SI|F(1, 50)", "robot": "tinibot", "lessons": [],
                 "wants": True, "hand": True}  # fmt: skip
# Each visible text, and whether its container cuts it, or it leaves its button or the page.
# Scrollable parts, and text for screen readers only, count as not cut; the title of a person's own
# program ends in an ellipsis.
CUT_TEXTS_SCRIPT = """() => {
  const found = new Set();
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const range = document.createRange();
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const holder = node.parentElement;
    if (!node.textContent.trim() || !holder.checkVisibility()) continue;
    if (holder.closest('option, svg, #start_programs strong, .tiles strong')) continue;
    if (holder.getBoundingClientRect().width < 2) continue;
    range.selectNodeContents(node);
    const text = range.getBoundingClientRect();
    const said = holder.closest('[id]')?.id + ': ' + node.textContent.trim().slice(0, 40);
    for (let at = holder; at; at = at.parentElement) {
      const {overflowX, display} = getComputedStyle(at);
      if (overflowX === 'auto' || overflowX === 'scroll') break;
      const box = at.getBoundingClientRect();
      const holds = overflowX !== 'visible' || at.tagName === 'BUTTON';
      const isOut = text.right > box.right + 1 || text.left < box.left - 1;
      if (!['inline', 'contents'].includes(display) && holds && isOut) found.add('cut in ' + said);
      if (at === document.body && text.right > innerWidth + 1) found.add('outside: ' + said);
    }
  }
  if (document.documentElement.scrollWidth > innerWidth) found.add('the page is too wide');
  return [...found];
}"""

# Texts that are visible or read aloud, and are in no catalogue of the page. Python provides the
# others: measured values, mistakes, lessons and robots.
PLAIN_TEXTS_SCRIPT = """() => {
  const is_plain = (text) => /[a-z]{3}/.test(text) && !/[äéîñöûóÄÉÎÑÖÛ]/.test(text);
  const found = [];
  const others = 'option, .cm-editor, svg, #values, #messages, #lesson, #lesson_findings,' +
    '#lesson_step, #versions';
  for (const each of document.querySelectorAll('body *')) {
    if (each.closest(others) || !each.checkVisibility()) continue;
    const own = [...each.childNodes].filter((node) => node.nodeType === Node.TEXT_NODE);
    const said = [...own.map((node) => node.textContent),
      each.getAttribute('aria-label') ?? '', each.getAttribute('placeholder') ?? ''];
    if (!/^(STYLE|SCRIPT)$/.test(each.tagName)) found.push(...said.filter(is_plain));
  }
  return found;
}"""


def _answer(route: Route) -> None:
    answer = route.fetch().json()
    route.fulfill(body=json.dumps(pseudo(answer)), content_type="application/json")


@pytest.mark.sampled(of="longer texts")
def test_longer_texts_fit_on_every_screen(pages: Pages) -> None:
    page = pages.blank(reduced_motion="reduce")
    page.route("**/texts.en.json", _answer)
    page.goto(pages.address)
    page.locator("#start_title", has_text="lóñg").wait_for()
    check_narrow_button_is_noticed(page, "#start_write")
    page.evaluate("document.querySelector('#start_title').append(' in English')")
    assert page.evaluate(PLAIN_TEXTS_SCRIPT) == [" in English"]
    page.evaluate("document.querySelector('#start_title').lastChild.remove()")
    cut_texts = {}
    for screen, size in each_screen(page, lambda screen: SIZES):
        cut_texts[screen, size] = page.evaluate(CUT_TEXTS_SCRIPT)
        if size == SIZES[0]:
            cut_texts[screen, size] += page.evaluate(PLAIN_TEXTS_SCRIPT)
    assert {place: value for place, value in cut_texts.items() if value} == {}


def check_narrow_button_is_noticed(page: Page, button: str) -> None:
    """A button that is too narrow for its text."""
    page.evaluate("(button) => { document.querySelector(button).style.width = '3em'; }", button)
    assert page.evaluate(CUT_TEXTS_SCRIPT) != []
    page.evaluate("(button) => { document.querySelector(button).style.width = ''; }", button)


@pytest.mark.sampled(of="longer texts")
def test_longer_texts_fit_on_the_wall_of_a_class(browser: Browser) -> None:
    """It shows ten pupils who want a robot and help, and each window in front of it."""
    with studio.serve_class([]) as taught_class:
        joins = {"do": "join", "code": taught_class.room.code}
        for number in range(10):
            join = {**joins, "name": f"Maximiliano {number}"}
            token = taught_class.room.answer("", f"192.0.2.{number}", join)["token"]
            taught_class.room.answer(token, f"192.0.2.{number}", PUPIL_MESSAGE)
        pages = Pages(browser, taught_class.server.address)
        page = pages.blank()
        page.route("**/texts.en.json", _answer)
        page.goto(taught_class.server.entrance())
        page.locator("#class_settings", has_text="Cläss").wait_for()
        page.locator("#wall li").nth(9).wait_for()
        check_narrow_button_is_noticed(page, "#class_settings")
        cut_texts = {}
        for width, height in SIZES:
            page.set_viewport_size({"width": width, "height": height})
            page.evaluate(SETTLED_SCRIPT)
            cut_texts["wall", width] = page.evaluate(CUT_TEXTS_SCRIPT)
            for button, window in WINDOWS:
                page.click(button)
                page.locator(f"{window} [data-text=close]").wait_for()
                page.evaluate(SETTLED_SCRIPT)
                cut_texts[window, width] = page.evaluate(CUT_TEXTS_SCRIPT)
                page.click(f"{window} [data-text=close]")
        assert {place: value for place, value in cut_texts.items() if value} == {}
        pages.close()
