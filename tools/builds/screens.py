"""Pictures of each screen of the studio, to look at: `python -m tools.builds.screens FOLDER`.

Four sizes, each language, light and dark. They show problems; they are not kept.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Literal

from tests.studio.screens import each_screen
from tests.support import studio
from tiniscript.base.languages import languages

SIZES = ((1366, 768), (1024, 600), (390, 844), (844, 390))
THEMES: tuple[Literal["light", "dark"], ...] = ("light", "dark")


def main(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    with (
        studio.driver() as driver,
        studio.browser(driver) as browser,
        studio.serve_page() as server,
    ):
        for theme in THEMES:
            for language in languages():
                pages = studio.Pages(browser, server.address)
                page = pages.open("start", color_scheme=theme, reduced_motion="reduce")
                studio.speak(page, language)
                for screen, (width, height) in each_screen(page, lambda screen: SIZES):
                    name = f"{screen.replace(' ', '_')}.{width}x{height}.{language}.{theme}.png"
                    page.screenshot(path=folder / name)
                pages.close()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Take pictures of each screen of the studio.")
    parser.add_argument("folder", type=Path)
    options = parser.parse_args()
    if reason := studio.missing():
        sys.exit(reason)
    main(options.folder)
