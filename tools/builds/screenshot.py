"""Takes the pictures of the studio for its pages, in Chromium: `docs/pictures/studio.en.png`.

    python -m tools.builds.screenshot

opens the built page (`python -m tools.builds.studio`), runs a program to its end on the virtual
robot, and saves a picture of the result. A picture carries the words that could be read in it, so
that `--check` sees without a browser whether the page still says them. It does not show new
content.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from io import BytesIO
from itertools import product
from pathlib import Path
from threading import Event, Thread
from typing import TYPE_CHECKING

from PIL import Image
from PIL.PngImagePlugin import PngInfo

from tests.support import studio
from tiniscript.base.languages import languages
from tiniscript.lessons import catalogue
from tools import ROOT
from tools.builds.page_texts import page_texts
from tools.site.documents import sources

if TYPE_CHECKING:
    from playwright.sync_api import Page

COMMAND = "python -m tools.builds.screenshot"
PROGRAM = """\
SI|LOOP(6)
  F(FOREVER, 80) UNTIL(DISTANCE < 15)
  BEEP(0.1, 880)
  R(0.5, 60)
END_LOOP
"""
COUNTING_PROGRAM = """\
SI|TURNS = 0
LOOP(6)
  F(FOREVER, 80) UNTIL(DISTANCE < 15)
  TURNS = TURNS + 1
  R(0.5, 60)
END_LOOP
"""
# Kinds of pictures: blocks after a run; a breakpoint with values; the start screen with saved work;
# a checked lesson; and those of SHOTS_OF_SCENE.
SCENES = {
    "": PROGRAM,
    ".held": COUNTING_PROGRAM,
    ".start": COUNTING_PROGRAM,
    ".lesson": "SI|F(5, 80)",
    ".drawing": PROGRAM,
    ".phone": PROGRAM,
    ".minute": PROGRAM,
    ".drive": PROGRAM,
    ".teacher": PROGRAM,
    ".wall": "",
    ".more": PROGRAM,
}
WALL_SCENE = ".wall"  # scene of a teacher with thirty pupils
PUPIL_NAMES = ["Ana", "Beto", "Carla", "Dani", "Elena", "Fabio", "Gabi", "Hugo", "Inés", "Julia",
               "Karim", "Lucía", "Mateo", "Nina", "Oscar", "Paula", "Quim", "Rosa", "Saúl", "Tania",
               "Ulises", "Vera", "Wara", "Ximena", "Yago", "Zoe", "Bruno", "Celia", "Emma",
               "Diego"]  # fmt: skip
PUPIL_PROGRAMS = ("F(1, 80);\n", "F(1, 80);\nR(0.5, 60);\n", PROGRAM.removeprefix("SI|"))
PUPIL_ADDRESS, RAISED_HAND = "192.0.2.7", 7  # their address, and the raised hand
BREAKPOINT_LINE = 5  # the line of the breakpoint
VIEWPORT = {"width": 1280, "height": 760}
GAP = 12  # pixels between the pictures of a sheet
COLOUR_COUNT = 72  # colours of a picture, which save half its bytes without a visible difference
WORDS_SCENE = "words"  # the text of the picture that has them
SEEN_SELECTOR = "button, label, h1, h2, .blocklyToolboxCategoryLabel"
CLASS = sources(ROOT, "docs/en/class.md")
GUIDES = {
    value: "".join((ROOT / guide).read_text("utf-8") for guide in (name, CLASS.get(value)) if guide)
    for value, name in sources(ROOT, "docs/en/studio.md").items()
}
LANGUAGES = tuple(value for value, text in GUIDES.items() if f"/studio.{value}.png)" in text)


def picture(language: str, scene: str = "") -> Path:
    return ROOT / "docs" / "pictures" / f"studio{scene}.{language}.png"


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Take the pictures of the studio.")
    parser.add_argument("--check", action="store_true", help="only say whether they are stale")
    options = parser.parse_args(arguments)
    if not options.check:
        reason = studio.missing()
        if reason:
            print(f"screenshot: {reason}", file=sys.stderr)
            return 2
        for language, scene in product(LANGUAGES, SCENES):
            take(language, scene, picture(language, scene))
            print(f"wrote {picture(language, scene).relative_to(ROOT)}")
        return 0
    complaints = [
        reason
        for language_and_scene in product(LANGUAGES, SCENES)
        if (reason := unusable_reason(*language_and_scene))
    ]
    for reason in complaints:
        print(f"screenshot: {reason}", file=sys.stderr)
    return 1 if complaints else 0


def take(language: str, scene: str, target: Path) -> None:
    """Write the picture of a scene of the page in a language, with the words that are in it."""
    words: list[str] = []
    shots: list[Image.Image] = []

    def take_shot() -> None:
        page.evaluate(studio.SETTLED_SCRIPT)
        words.extend(
            page.eval_on_selector_all(
                SEEN_SELECTOR,
                "all => all.filter(one => one.checkVisibility()).map(one => one.innerText)",
            )
        )
        shots.append(Image.open(BytesIO(page.screenshot())).convert("RGB"))

    with (
        _serve_scene(scene) as (address, entrance),
        studio.driver() as driver,
        studio.browser(driver) as browser,
    ):
        pages = studio.Pages(browser, address, patience_s=120)
        view = "wall" if scene == WALL_SCENE else "text"
        page = pages.visit(entrance, view, viewport=VIEWPORT, device_scale_factor=1)
        studio.speak(page, language)
        if scene != WALL_SCENE:
            studio.write(page, PROGRAM)
        SHOTS_OF_SCENE.get(scene, _take_single)(page, scene, take_shot)
        pages.close()
    if pages.errors:
        raise SystemExit(f"the page said {pages.errors[0]}")
    metadata = PngInfo()
    visible_lines = sorted(
        {row.strip() for word in words for row in word.splitlines() if row.strip()}
    )
    metadata.add_text(
        WORDS_SCENE, json.dumps([line for line in visible_lines if is_page_text(line)])
    )
    _sheet(shots).quantize(COLOUR_COUNT).save(target, optimize=True, pnginfo=metadata)


@contextmanager
def _serve_scene(scene: str) -> Iterator[tuple[str, str]]:
    """The address of a page, and where it is entered."""
    if scene != WALL_SCENE:
        with studio.serve_page() as server:
            yield server.address, server.address
        return
    with studio.serve_class([]) as (server, classroom):
        classroom.teach({"do": "class_places", "places": len(PUPIL_NAMES)})
        joins = {"do": "join", "code": classroom.code}
        tokens = [
            classroom.answer("", PUPIL_ADDRESS, {**joins, "name": name})["token"]
            for name in PUPIL_NAMES
        ]
        is_over = Event()

        def write_as_pupils() -> None:
            while True:
                for k, token in enumerate(tokens):
                    beat = {
                        "do": "here",
                        "text": f"SI|{PUPIL_PROGRAMS[k % len(PUPIL_PROGRAMS)]}",
                        "robot": "tinibot",
                    }
                    done_lessons = [folder.name for folder in catalogue.folders()[: k % 5]]
                    classroom.answer(
                        token,
                        PUPIL_ADDRESS,
                        {**beat, "lessons": done_lessons, "hand": k == RAISED_HAND},
                    )
                if is_over.wait(1):
                    return

        pupils = Thread(target=write_as_pupils)
        pupils.start()
        try:
            yield server.address, server.entrance()
        finally:
            is_over.set()
            pupils.join()


def _take_single(page: Page, scene: str, take_shot: Callable[[], None]) -> None:
    if scene == ".start":
        page.click("#home")
        page.click("#start_write")
    studio.write(page, SCENES[scene])
    page.select_option("#speed", "20")
    if scene == ".held":
        page.click("#view_text")
        numbers = page.locator(".cm-lineNumbers .cm-gutterElement")
        numbers.filter(has_text=str(BREAKPOINT_LINE)).last.click()
    if scene == ".lesson":
        page.click("#side_lessons")
        page.locator("#lesson_next:enabled").wait_for()
        page.locator("#lesson_steps button").last.click()
        page.click("#lesson_check")
        page.locator("#lesson_said[data-verdict]").wait_for()
    else:
        page.click("#home" if scene == ".start" else "#run")
    _in_phase(page, {".held": "paused", ".start": "off"}.get(scene, "ended"))
    if scene != ".start":
        page.select_option("#speed", "1")
    if scene in ("", ".lesson"):
        page.click("#view_blocks")
        studio.wait_for_blocks(page)
    take_shot()


def _in_phase(page: Page, phase: str) -> None:
    page.locator(f"[data-phase={phase}]").first.wait_for(state="attached")


def _drawing(page: Page, scene: str, take_shot: Callable[[], None]) -> None:
    page.select_option("#world", "parking")
    page.click("#world_draw")
    page.select_option("#world_part", index=1)
    take_shot()


def _phone(page: Page, scene: str, take_shot: Callable[[], None]) -> None:
    """The program, the robot on its way, and a world that is drawn."""
    page.select_option("#world", "maze")
    page.select_option("#speed", "20")
    page.click("#view_blocks")
    studio.wait_for_blocks(page)
    page.set_viewport_size({"width": 390, "height": 844})
    take_shot()
    page.click("#run")
    _in_phase(page, "ended")
    take_shot()
    page.click("#world_draw")
    page.select_option("#world_part", index=1)
    take_shot()


def _minute(page: Page, scene: str, take_shot: Callable[[], None]) -> None:
    """The start, a robot that dances, its blocks, one of them changed, run again, and a lesson."""
    page.click("#home")
    take_shot()
    page.click("[data-begin=obstacle]")
    _in_phase(page, "running")
    page.wait_for_timeout(2500)
    take_shot()
    page.click("#stop")
    page.click("#view_blocks")
    studio.wait_for_blocks(page)
    page.locator(".blocklyToolboxCategory").first.click()
    take_shot()
    page.keyboard.press("Escape")
    page.click("#view_text")
    studio.write(page, PROGRAM.replace("(0.5, 60)", "(0.9, 60)"))
    page.click("#view_blocks")
    page.select_option("#speed", "20")
    page.click("#run")
    _in_phase(page, "running")  # the run before has ended, too
    _in_phase(page, "ended")
    take_shot()
    page.select_option("#world", "maze")
    page.click("#run")
    page.locator("#score").wait_for()
    page.wait_for_timeout(500)
    take_shot()
    page.click("#stop")
    page.click("#side_lessons")
    page.locator("#lesson_check:enabled").wait_for(state="attached")
    take_shot()


def _drive(page: Page, scene: str, take_shot: Callable[[], None]) -> None:
    """Drive by hand: straight on, a turn with the horn, and the same on a large screen."""
    page.click("#home")
    page.set_viewport_size({"width": 390, "height": 844})
    page.click("[data-begin=drive]")
    _in_phase(page, "running")
    for key, duration_ms in (("ArrowUp", 1500), ("ArrowLeft", 200), ("a", 100)):
        page.keyboard.down(key)
        page.wait_for_timeout(duration_ms)
        if key != "ArrowLeft":
            take_shot()
    page.set_viewport_size({"width": 1366, "height": 768})
    page.click("#view_blocks")
    studio.wait_for_blocks(page)
    take_shot()


def _teacher(page: Page, scene: str, take_shot: Callable[[], None]) -> None:
    """Take a picture of a real robot in four steps, and the teacher's part below."""
    page.click("#side_real")
    page.click("#link_teacher summary")
    take_shot()


def _wall(page: Page, scene: str, take_shot: Callable[[], None]) -> None:
    """Thirty pupils, one with a hand up, without scrolling."""
    page.locator("#wall img[src^=blob]").nth(len(PUPIL_NAMES) - 1).wait_for()
    take_shot()


def _take_more(page: Page, scene: str, take_shot: Callable[[], None]) -> None:
    """A loose block, a wrong one, a link, a phone on its side twice, a block that keys move."""
    page.click("#view_blocks")
    for text in ("SI|F(1, 80)\n\n/// R(0.5, 60)\n/// B(1, 80)\n", "SI|F(-2, 80)\nR(0.5, 60)\n"):
        studio.write(page, text)
        studio.wait_for_blocks(page)
        if "-2" in text:
            page.locator(".blocklyBubble").wait_for()
        take_shot()
    studio.write(page, "SI|F(1, 80)\nR(0.5, 60)\n")
    page.click("#my_programs")
    page.click("#share summary")
    page.locator("#programs[data-shared=done]").wait_for()
    take_shot()
    page.click("#programs_close")
    page.set_viewport_size({"width": 844, "height": 390})
    take_shot()
    page.click("#other")
    page.click("#side_lessons")
    page.locator("#lesson_next:enabled").wait_for()
    take_shot()
    page.click("#side_virtual")
    page.set_viewport_size({"width": VIEWPORT["width"], "height": VIEWPORT["height"]})
    page.evaluate(studio.SETTLED_SCRIPT)
    page.locator("#redo").focus()
    for key in ("Tab", "Tab", "Tab", "ArrowDown", "ArrowDown", "m", "ArrowDown"):
        page.keyboard.press(key)
    take_shot()


# Scenes of several pictures, or next to the program.
SHOTS_OF_SCENE = {
    ".more": _take_more,
    ".wall": _wall,
    ".drawing": _drawing,
    ".phone": _phone,
    ".minute": _minute,
    ".drive": _drive,
    ".teacher": _teacher,
}


def _sheet(shots: list[Image.Image]) -> Image.Image:
    """Put pictures side by side, in two rows if there are many."""
    width, height = VIEWPORT["width"], VIEWPORT["height"]
    columns, rows = (3, 2) if len(shots) > 3 else (len(shots), 1)
    sheet = Image.new("RGB", (width, height), "#ffffff")
    cell_size = ((width - GAP * (columns - 1)) // columns, (height - GAP * (rows - 1)) // rows)
    for k, shot in enumerate(shots):
        scale = min(cell_size[0] / shot.width, cell_size[1] / shot.height)
        small_shot = shot.resize(
            (round(shot.width * scale), round(shot.height * scale)), Image.Resampling.LANCZOS
        )
        x = (k % columns) * (cell_size[0] + GAP) + (cell_size[0] - small_shot.width) // 2
        sheet.paste(
            small_shot,
            (x, (k // columns) * (cell_size[1] + GAP) + (cell_size[1] - small_shot.height) // 2),
        )
    return sheet


def is_page_text(words: str) -> bool:
    """Return whether the page's sentences contain these words."""
    return any(words in _shown_words(language) for language in languages())


def unusable_reason(language: str, scene: str = "") -> str:
    """Return the reason why a picture is not of this page, or ""."""
    path = picture(language, scene)
    if not path.is_file():
        return f"there is no {path.name}. Take it:  {COMMAND}"
    with Image.open(path) as image:
        words = json.loads(str(image.info.get(WORDS_SCENE, "[]")))
    if not words:
        return f"{path.name} does not say what can be read in it. Take it:  {COMMAND}"
    missing_words = [word for word in words if not is_page_text(word)]
    if missing_words:
        word = missing_words[0]
        return f"{path.name} shows “{word}”, which the page says no more. Take it:  {COMMAND}"
    return ""


@cache
def _shown_words(language: str) -> frozenset[str]:
    return frozenset(map(str, page_texts(language).values()))


if __name__ == "__main__":
    sys.exit(main())
