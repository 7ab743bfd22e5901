"""Two tabs of one browser, and a browser that has no room: no work goes without a word."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.support.page_worlds import (
    NO_BORDER,
    drag,
    draw_wall,
    open_world_file,
    save_world,
    wait_for_status,
)
from tests.support.studio import (
    Pages,
    image,
    wait_for,
    wait_for_note,
    wait_for_phase,
    wait_until_checked,
    write,
)
from tiniscript import compile
from tiniscript.virtual.worlds import read

if TYPE_CHECKING:
    from playwright.sync_api import Page

# Simulates a full storage, which keeps its old content.
FULL_STORAGE_SCRIPT = """(full) => {
  const put = Storage.prototype.setItem;
  Storage.prototype.setItem = function (place, whole) {
    if (full.some((name) => this === window[name])) {
      throw new DOMException('full', 'QuotaExceededError');
    }
    put.call(this, place, whole);
  };
}"""
NO_STORAGE_SCRIPT = """for (const name of ['localStorage', 'sessionStorage']) {
  Object.defineProperty(window, name, { get() { throw new DOMException('no', 'SecurityError'); } });
}"""
PASTE_SCRIPT = """(count) => {
  const data = new DataTransfer();
  data.setData('text/plain', '// a long note\\n'.repeat(count));
  const options = { clipboardData: data, bubbles: true, cancelable: true };
  const event = new ClipboardEvent('paste', options);
  document.querySelector('#editor').shadowRoot.querySelector('.cm-content').dispatchEvent(event);
}"""


@pytest.mark.sampled(of="pages of their own", keep=2)
def test_changes_in_another_tab_become_one_previous_world(pages: Pages) -> None:
    """They precede this tab's own undo steps, and remove none of them."""

    def open_world(tab: Page, width_cm: int) -> None:
        name = f"w{width_cm}.toml"
        open_world_file(
            tab, NO_BORDER.replace(b"120.06", b"%d" % width_cm).replace(b"118", b"20"), name
        )
        wait_for_status(tab, f"Opened: {name}")
        save_world(tab)

    page = pages.open()
    page.locator("#world_draw:enabled").wait_for()
    page.click("#world_draw")
    open_world(page, 100)
    open_world(page, 101)
    other_page = pages.another(page)
    other_page.locator("#world_draw:enabled").wait_for()
    other_page.click("#world_draw")
    open_world(other_page, 102)
    for _ in range(5):
        for tab in (page, other_page):
            tab.select_option("#world_part", label="Robot")
            tab.locator("#arena").focus()
            tab.keyboard.press("ArrowRight")
            save_world(tab)
    kept_text = "(store) => JSON.parse(window[store]['tiniscript.worlds_before'])"
    widths = {
        store: [read(world, "before").width_cm for world in other_page.evaluate(kept_text, store)]
        for store in ("localStorage", "sessionStorage")
    }
    # The next tab finds those of both; this one has its own.
    assert widths == {"localStorage": [101, 100, 101], "sessionStorage": [101, 100]}
    newest = read(other_page.evaluate("localStorage['tiniscript.world']"), "newest")
    other_world = read(other_page.evaluate(kept_text, "localStorage")[-1], "theirs")
    assert (newest.width_cm, newest.start.x_cm) == (102, 45)
    assert other_world.start.x_cm == 45  # without any earlier step


def test_programs_of_both_tabs_are_kept(pages: Pages) -> None:
    page = pages.open()
    other_page = pages.another(page)
    for k in (1, 2):
        write(page, f"SI|F({k}, 10)")
        write(other_page, f"SI|B({k}, 20)")
    draw_wall(page)
    other_page.locator("#world_draw:enabled").wait_for()
    other_page.click("#world_draw")
    for count in (1, 2):  # the second change does not forget the first one's findings
        other_page.click("#world_add_walls")
        drag(other_page, [(150, 30), (190, 60)])
        other_page.locator("#world_part option", has_text=f"Wall {count}").wait_for(
            state="attached"
        )
        assert len(save_world(other_page).walls) == count
    other_page.click("#world_done")
    with page.expect_event("close"):
        page.close(run_before_unload=True)
    kept_text = "(localStorage['tiniscript.versions'] ?? '').includes('SI|F(2, 10)')"
    wait_for(
        other_page, lambda: other_page.evaluate(kept_text), "the closed tab has kept its program"
    )
    assert "B(2, 20)" in other_page.evaluate(
        "localStorage['tiniscript.work']"
    )  # kept for the next tab
    newest, older_texts = other_page.evaluate(
        "[localStorage['tiniscript.world'], JSON.parse(localStorage['tiniscript.worlds_before'])]"
    )
    assert [text.count("[[walls]]") for text in (newest, *older_texts)] == [2, 1]


def test_a_program_of_a_hidden_tab_is_kept(page: Page) -> None:
    """A phone ends hidden pages, which hear nothing of it."""
    write(page, "SI|F(9, 91)")
    page.evaluate(
        "() => { Object.defineProperty(document, 'hidden', { value: true, configurable: true });"
        " document.dispatchEvent(new Event('visibilitychange')); delete document.hidden; }"
    )
    assert "SI|F(9, 91)" in page.evaluate("localStorage['tiniscript.versions']")


def test_a_browser_without_storage_reports_it_and_otherwise_works(pages: Pages) -> None:
    """Otherwise the next tab would begin with an older program for no visible reason."""
    page = pages.open(is_alone=True)
    page.evaluate(FULL_STORAGE_SCRIPT, ["localStorage"])
    write(page, "SI|F(2, 20)")
    wait_for_note(page, "This browser does not save anything for this page. Save")
    page.locator("#world_draw:enabled").wait_for()
    page.click("#world_draw")
    page.click("#world_add_walls")
    drag(page, [(60, 30), (100, 60)])
    page.locator("#doing", has_text="This browser has no room for this world").wait_for()
    assert "F(2, 20)" in page.evaluate("sessionStorage['tiniscript.work']")  # this tab has it
    page.context.add_init_script(NO_STORAGE_SCRIPT)
    page.reload()
    wait_until_checked(page)
    page.click("#view_text")
    write(page, "SI|F(0.1, 80)")
    wait_for_note(page, "This browser does not save anything for this page. Save")
    assert image(page) == compile("SI|F(0.1, 80)").image
    page.click("#run")
    wait_for_phase(page, "ended")
    page.click("#my_programs")
    page.locator("#versions").wait_for()


def test_an_overlong_program_is_reported_as_not_kept(page: Page) -> None:
    """450,000 characters are kept as the work; a million is more than the compiler reads."""
    for count in (30_000, 70_000):
        write(page, "")
        page.locator(".cm-content").focus()
        page.evaluate("document.querySelector('#note').textContent = ''")
        page.evaluate(PASTE_SCRIPT, count)
        if count == 30_000:
            assert page.inner_text("#note") == ""
            page.click("#my_programs")
            page.click("#programs_close")
        wait_for_note(page, "This program is too long for the browser to save. Save")
        kept_state = page.evaluate("JSON.parse(localStorage['tiniscript.work']).text.length")
        assert (kept_state > 400_000) == (count == 30_000)
    write(page, "S")
