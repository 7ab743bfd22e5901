"""The world on the page: drawn, moved and saved."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from tiniscript.virtual import worlds
from tiniscript.virtual.world import World

if TYPE_CHECKING:
    from collections.abc import Sequence

    from playwright.sync_api import Page


Place = tuple[float, float]
NO_BORDER = b"""[floor]
width_cm = 120.06
height_cm = 80.04
border = false
[start]
x_cm = 118
y_cm = 78
"""


def screen_position(page: Page, place: Place, floor: Place = (220, 200)) -> Place:
    """Return the screen position of a place on the floor, in centimetres."""
    box = page.locator("#arena").bounding_box()
    assert box is not None
    scale = min(box["width"] / (floor[0] + 8), box["height"] / (floor[1] + 8))
    return (
        box["x"] + box["width"] / 2 + (place[0] - floor[0] / 2) * scale,
        box["y"] + box["height"] / 2 - (place[1] - floor[1] / 2) * scale,
    )


def drag(page: Page, places: Sequence[Place]) -> None:
    """Go along a way on the floor with the mouse down."""
    page.mouse.move(*screen_position(page, places[0]))
    page.mouse.down()
    for place in places[1:]:
        page.mouse.move(*screen_position(page, place), steps=4)
    page.mouse.up()


def wait_for_status(page: Page, text: str) -> None:
    page.locator("#doing").filter(has_text=text).wait_for()


def save_world(page: Page) -> World:
    """Save the world as a person does, and read it as `tsc robot --world` does."""
    with page.expect_download() as download:
        page.click("#world_save")
    path = Path(download.value.path())
    named_path = path.with_suffix(".toml")
    path.rename(named_path)
    assert download.value.suggested_filename in ("world.toml", "mundo.toml")
    return worlds.load(str(named_path))


def read_start(page: Page) -> Place:
    page.click("#world_draw")
    start = save_world(page).start
    page.click("#world_done")
    return start.x_cm, start.y_cm


def open_world_file(page: Page, data: bytes, name: str = "own.toml") -> None:
    page.set_input_files(
        "#world_file", {"name": name, "mimeType": "application/toml", "buffer": data}
    )


def draw_wall(page: Page) -> None:
    """Make a world of one's own, with a wall."""
    page.select_option("#world", "obstacles")
    page.click("#world_draw")
    page.click("#world_add_walls")
    drag(page, [(60, 30), (100, 60)])
    assert len(save_world(page).walls) == 1
    page.click("#world_done")
