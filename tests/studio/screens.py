"""A walk through all screens of the studio's page, but those of a class."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING

from tests.support.studio import SETTLED_SCRIPT, turn, wait_for_blocks, wait_for_phase, write

if TYPE_CHECKING:
    from playwright.sync_api import Page

Size = tuple[int, int]  # width and height in pixels
# They are next to the program; on a phone they have their own screen.
SCREENS_BESIDE_PROGRAM = {"running", "paused", "driven", "trace", "plot", "floor", "drawing", "box",
                          "flag", "lesson", "checked", "real", "teacher", "programs"}  # fmt: skip
WHOLE_SCREENS = {"start", "own programs"}  # screens without halves
WRONG_PROGRAM = "SI|" + "F(-2, 80);\nIF(DISTANCE < 10;\n" * 6
Show = Callable[["Page"], None]


def _write(page: Page, text: str) -> None:
    turn(page, "program")
    page.click("#view_text")
    write(page, text)


def _show_blocks(page: Page) -> None:
    page.click("#start_write")
    page.click("#view_blocks")
    wait_for_blocks(page)


def _show_mistake(page: Page) -> None:
    page.click("#words")
    _write(page, WRONG_PROGRAM)


def _start_run(page: Page) -> None:
    _write(page, ";".join(f"V{k} = {k}" for k in range(12)) + ";F(3, 80);SHOW(1 / 0)")
    page.select_option("#world", "maze")
    page.select_option("#speed", "0.1")
    page.click("#run")
    wait_for_phase(page, "running")


def _pause_run(page: Page) -> None:
    page.click("#pause")
    wait_for_phase(page, "paused")


def _drive_run(page: Page) -> None:
    """A fault, and a score."""
    page.select_option("#speed", "20")
    page.click("#pause")
    wait_for_phase(page, "ended")


def _part(index: int) -> Show:
    def select_part(page: Page) -> None:
        count = page.locator("#world_part option").count()
        page.select_option("#world_part", index=index % count)

    return select_part


def _show_floor(page: Page) -> None:
    page.click("#seen_arena")
    page.click("#world_draw")
    _part(0)(page)


def _show_lesson(page: Page) -> None:
    page.click("#world_done")
    page.select_option("#world", "obstacles")
    page.click("#side_lessons")
    page.locator("#lesson_check:enabled").wait_for(state="attached")


def _check_lesson(page: Page) -> None:
    page.locator("#lesson_steps button").last.click()
    page.click("#lesson_hint summary")
    page.click("#lesson_check")
    page.locator("#lesson_said[data-verdict]").wait_for()
    page.evaluate("Promise.all(arena.getAnimations().map((each) => each.finished))")  # a bump


def _show_real_robot(page: Page) -> None:
    page.click("#lesson_hint summary")
    page.click("#side_real")


def _show_programs(page: Page) -> None:
    page.click("#link_teacher summary")
    page.click("#side_virtual")
    page.click("#my_programs")
    page.locator("#programs:not([data-shared=asked])").wait_for()


def _show_own_programs(page: Page) -> None:
    page.click("#programs_close")
    page.click("#home")
    page.locator("#start_programs li").first.wait_for()


SCREENS: dict[str, Show] = {
    "start": lambda page: page.locator("#pictures").wait_for(),
    "blocks": _show_blocks,
    "toolbox": lambda page: page.locator(".blocklyToolboxCategory").first.click(),
    "words": lambda page: page.click("#words"),
    "wrong": _show_mistake,
    "waiting blocks": lambda page: page.click("#view_blocks"),
    "running": _start_run,
    "paused": _pause_run,
    "driven": _drive_run,
    "trace": lambda page: page.click("#seen_trace"),
    "plot": lambda page: page.click("#seen_plot"),
    "floor": _show_floor,
    "drawing": _part(1),
    "box": _part(2),
    "flag": _part(-1),
    "lesson": _show_lesson,
    "checked": _check_lesson,
    "real": _show_real_robot,
    "teacher": lambda page: page.click("#link_teacher summary"),
    "programs": _show_programs,
    "own programs": _show_own_programs,
}


def each_screen(page: Page, sizes: Callable[[str], Iterable[Size]]) -> Iterator[tuple[str, Size]]:
    """See each screen of a page, from its start on, at its sizes; yield which one it is."""
    for screen, see in SCREENS.items():
        page.set_viewport_size({"width": 1366, "height": 768})
        page.evaluate(SETTLED_SCRIPT)
        see(page)
        for width, height in sizes(screen):
            page.set_viewport_size({"width": width, "height": height})
            if screen not in WHOLE_SCREENS:
                turn(page, "robot" if screen in SCREENS_BESIDE_PROGRAM else "program")
            page.evaluate(SETTLED_SCRIPT)
            yield screen, (width, height)
