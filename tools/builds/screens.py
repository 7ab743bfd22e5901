"""Pictures of each screen of the studio, to look at: `python -m tools.builds.screens FOLDER`.

Four sizes, each language, light and dark. They show what is wrong; nobody keeps them.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from tiniscript.base.languages import languages

if TYPE_CHECKING:
    from playwright.sync_api import Page

SIZES = {"laptop": (1366, 768), "small": (1024, 600), "phone": (390, 844), "lying": (844, 390)}
# Beside the program; on a phone a screen of their own.
BESIDE = {"driven", "task", "plot", "drawing", "lesson", "real", "teacher", "programs"}
WRONG = "SI|F(-2, 80)\nB(1, 80)\n"


def _start(page: Page) -> None:
    page.locator("#pictures").wait_for()


def _blocks(page: Page) -> None:
    from tests.support.studio import shown

    page.click("#start_write")
    shown(page)


def _wrong(page: Page) -> None:
    from tests.support.studio import turn, write

    turn(page, "program")
    page.click("#view_text")
    write(page, WRONG)


def _driven(page: Page) -> None:
    from tests.support.studio import turn, write

    write(page, "SI|F(1, 80)\nSHOW(DISTANCE)\n")
    turn(page, "robot")
    page.click("#side_virtual")
    page.click("#run")
    page.locator("html[data-phase=ended]").wait_for(state="attached")


def _task(page: Page) -> None:
    from tests.support.studio import write

    write(page, "SI|F(1.8, 80)\nR(0.3, 60)\nF(1, 80)\n")
    page.select_option("#world", "maze")
    page.click("#run")
    page.locator("html[data-phase=ended]").wait_for(state="attached")


def _plot(page: Page) -> None:
    page.click("#seen_plot")


def _drawing(page: Page) -> None:
    page.click("#seen_arena")
    page.click("#world_draw")
    page.select_option("#world_part", index=1)


def _lesson(page: Page) -> None:
    page.click("#world_done")
    page.click("#side_lessons")
    page.locator("#lesson_steps button").last.click()
    page.locator("#lesson_check:enabled").click()
    page.locator("#lesson_said[data-verdict]").wait_for()


def _real(page: Page) -> None:
    page.click("#side_real")


def _teacher(page: Page) -> None:
    page.click("#link_teacher summary")


def _programs(page: Page) -> None:
    page.click("#my_programs")
    page.locator("#programs:not([data-shared=asked])").wait_for()


SCREENS: dict[str, Callable[[Page], None]] = {
    "start": _start, "blocks": _blocks, "wrong": _wrong, "driven": _driven, "task": _task,
    "plot": _plot, "drawing": _drawing, "lesson": _lesson, "real": _real, "teacher": _teacher,
    "programs": _programs,
}  # fmt: skip


def pictures(folder: Path) -> list[Path]:
    """Make them all; return their files, by size, language, theme and screen."""
    from tests.support.studio import SETTLED, Pages, browser, driver, served, speak, turn

    folder.mkdir(parents=True, exist_ok=True)
    found = []
    with driver() as playwright, browser(playwright) as opened, served() as server:
        for theme in ("light", "dark"):
            for language in languages():
                pages = Pages(opened, server.address)
                page = pages.open("start", color_scheme=theme, reduced_motion="reduce")
                speak(page, language)
                for screen, see in SCREENS.items():
                    page.set_viewport_size({"width": 1366, "height": 768})
                    page.evaluate(SETTLED)
                    see(page)
                    for size, (width, height) in SIZES.items():
                        page.set_viewport_size({"width": width, "height": height})
                        turn(page, "robot" if screen in BESIDE else "program")
                        page.evaluate(SETTLED)
                        path = folder / f"{screen}.{size}.{language}.{theme}.png"
                        page.screenshot(path=path)
                        found.append(path)
                pages.close()
    return found


if __name__ == "__main__":
    print(f"{len(pictures(Path(sys.argv[1])))} pictures in {sys.argv[1]}")
