"""A picture of a world and of the way that a robot has gone in it, as a PNG.

Knows Pillow and colours. Importing this fails where Pillow is not installed.
"""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO

from PIL import Image, ImageDraw, ImageFont
from PIL.PngImagePlugin import PngInfo

from tiniscript.robots.kinematics import Pose
from tiniscript.virtual.bout import rival_hull
from tiniscript.virtual.driving import Hull
from tiniscript.virtual.geometry import Point
from tiniscript.virtual.world import World

OVERSAMPLING = 2  # drawn this many times larger, then scaled down: smooth lines
LONGEST_SIDE = 1200  # pixels of the longer side
MARGIN = 24
PAPER, FLOOR, WALL, BOX = "#ffffff", "#f5f2ea", "#37414b", "#8a97a3"
LINE, LAMP, GLOW = "#202020", "#f5b400", "#fdf3c8"
RING, EDGE, RIVAL = "#3b434c", "#ffffff", "#d8b4f0"
WAY, BEGIN, ROBOT, TEXT = "#1273de", "#2a9d55", "#e8590c", "#37414b"
RULERS = (10, 20, 50, 100, 200, 500, 1000)  # centimetres


def png(
    world: World, hull: Hull, corners: Sequence[Pose], pose: Pose, title: str,
    rivals: Sequence[Pose] = (),
) -> bytes:  # fmt: skip
    """Return the picture; straight lines join `corners`, and `pose` is where the robot is now."""
    return _Sheet(world).render(hull, corners, pose, title, rivals)


class _Sheet:
    def __init__(self, world: World) -> None:
        self.world = world
        self.scale = (
            (LONGEST_SIDE - 2 * MARGIN) / max(world.width_cm, world.height_cm) * OVERSAMPLING
        )
        self.margin = MARGIN * OVERSAMPLING
        self.foot = 2 * MARGIN * OVERSAMPLING
        size = (
            round(world.width_cm * self.scale) + 2 * self.margin,
            round(world.height_cm * self.scale) + 2 * self.margin + self.foot,
        )
        self.image = Image.new("RGB", size, PAPER)
        self.draw = ImageDraw.Draw(self.image)

    def at(self, point: Point | Pose) -> tuple[float, float]:
        """Return the place on the sheet: up is down there."""
        x, y = point[:2]
        return (
            self.margin + x * self.scale,
            self.margin + (self.world.height_cm - y) * self.scale,
        )

    def render(
        self, hull: Hull, corners: Sequence[Pose], pose: Pose, title: str, rivals: Sequence[Pose]
    ) -> bytes:
        world, draw = self.world, self.draw
        top_left, bottom_right = Point(0, world.height_cm), Point(world.width_cm, 0)
        draw.rectangle((*self.at(top_left), *self.at(bottom_right)), fill=FLOOR)
        for lamp in world.lamps:
            self._disc(lamp.place, lamp.reach_cm / 4, GLOW)
        for ring in world.rings:
            self._disc(ring.place, ring.radius_cm, EDGE)
            self._disc(ring.place, ring.radius_cm - ring.edge_cm, RING)
        for line in world.lines:
            self._row(line.points, LINE, line.width_cm * self.scale)
        for box in world.boxes:
            draw.polygon(
                [self.at(point) for point in box], fill=BOX, outline=WALL, width=2 * OVERSAMPLING
            )
        for wall in world.walls:
            self._row(wall, WALL, 5 * OVERSAMPLING)
        if world.has_border:
            draw.rectangle(
                (*self.at(top_left), *self.at(bottom_right)), outline=WALL, width=4 * OVERSAMPLING
            )
        for lamp in world.lamps:
            self._disc(lamp.place, 2.5, LAMP)
        self._row([*corners, pose], WAY, 2.5 * OVERSAMPLING)
        self._disc(corners[0], 1.5, BEGIN)
        for rival, place in zip(world.rivals, rivals, strict=False):
            body = rival_hull(rival)
            outline = [self.at(point) for point in body.outline(place)]
            draw.polygon(outline, fill=RIVAL, outline=WALL, width=2 * OVERSAMPLING)
            self._disc(body.spine(place).b, 1.2, WALL)
        draw.polygon(
            [self.at(point) for point in hull.outline(pose)],
            outline=ROBOT,
            width=round(2.5 * OVERSAMPLING),
        )
        self._disc(hull.spine(pose).b, 1.2, ROBOT)
        self._draw_title(title)
        small = self.image.resize(
            (self.image.width // OVERSAMPLING, self.image.height // OVERSAMPLING),
            Image.Resampling.LANCZOS,
        )
        file = BytesIO()
        about = PngInfo()
        about.add_text("Software", "TiniScript")  # by which tsc knows its own pictures
        small.save(file, "PNG", pnginfo=about)
        return file.getvalue()

    def _disc(self, middle: Point | Pose, radius_cm: float, colour: str) -> None:
        x, y = self.at(middle)
        radius = radius_cm * self.scale
        self.draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill=colour)

    def _row(self, points: Sequence[Point | Pose], colour: str, width: float) -> None:
        places = [self.at(point) for point in points]
        self.draw.line(places, fill=colour, width=max(1, round(width)), joint="curve")

    def _draw_title(self, title: str) -> None:
        """Write the title, and draw how long a good length is."""
        font = ImageFont.load_default(16 * OVERSAMPLING)
        y = self.image.height - self.foot
        self.draw.text((self.margin, y), title, fill=TEXT, font=font)
        length = max(
            (ruler for ruler in RULERS if ruler <= self.world.width_cm / 5), default=RULERS[0]
        )
        right = self.image.width - self.margin
        left = right - length * self.scale
        bar = y + 24 * OVERSAMPLING
        self.draw.line([(left, bar), (right, bar)], fill=TEXT, width=2 * OVERSAMPLING)
        for x in (left, right):
            self.draw.line(
                [(x, bar - 5 * OVERSAMPLING), (x, bar + 5 * OVERSAMPLING)],
                fill=TEXT,
                width=2 * OVERSAMPLING,
            )
        label = f"{length} cm"
        self.draw.text((right - self.draw.textlength(label, font), y), label, fill=TEXT, font=font)
