"""A picture of a world and of a robot's path in it, as a PNG.

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
PAPER_COLOUR, FLOOR_COLOUR, WALL_COLOUR, BOX_COLOUR = "#ffffff", "#f5f2ea", "#37414b", "#8a97a3"
LINE_COLOUR, LAMP_COLOUR, GLOW_COLOUR = "#202020", "#f5b400", "#fdf3c8"
RING_COLOUR, EDGE_COLOUR, RIVAL_COLOUR = "#3b434c", "#ffffff", "#d8b4f0"
WAY_COLOUR, START_COLOUR, ROBOT_COLOUR, TEXT_COLOUR = "#1273de", "#2a9d55", "#e8590c", "#37414b"
RULER_LENGTHS_CM = (10, 20, 50, 100, 200, 500, 1000)  # centimetres


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
        self.footer_height = 2 * MARGIN * OVERSAMPLING
        size = (
            round(world.width_cm * self.scale) + 2 * self.margin,
            round(world.height_cm * self.scale) + 2 * self.margin + self.footer_height,
        )
        self.image = Image.new("RGB", size, PAPER_COLOUR)
        self.draw = ImageDraw.Draw(self.image)

    def to_pixels(self, point: Point | Pose) -> tuple[float, float]:
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
        draw.rectangle(
            (*self.to_pixels(top_left), *self.to_pixels(bottom_right)), fill=FLOOR_COLOUR
        )
        for lamp in world.lamps:
            self._disc(lamp.place, lamp.reach_cm / 4, GLOW_COLOUR)
        for ring in world.rings:
            self._disc(ring.place, ring.radius_cm, EDGE_COLOUR)
            self._disc(ring.place, ring.radius_cm - ring.edge_cm, RING_COLOUR)
        for line in world.lines:
            self._row(line.points, LINE_COLOUR, line.width_cm * self.scale)
        for box in world.boxes:
            draw.polygon(
                [self.to_pixels(point) for point in box],
                fill=BOX_COLOUR,
                outline=WALL_COLOUR,
                width=2 * OVERSAMPLING,
            )
        for wall in world.walls:
            self._row(wall, WALL_COLOUR, 5 * OVERSAMPLING)
        if world.has_border:
            draw.rectangle(
                (*self.to_pixels(top_left), *self.to_pixels(bottom_right)),
                outline=WALL_COLOUR,
                width=4 * OVERSAMPLING,
            )
        for lamp in world.lamps:
            self._disc(lamp.place, 2.5, LAMP_COLOUR)
        self._row([*corners, pose], WAY_COLOUR, 2.5 * OVERSAMPLING)
        self._disc(corners[0], 1.5, START_COLOUR)
        for rival, rival_pose in zip(world.rivals, rivals, strict=False):
            body = rival_hull(rival)
            outline = [self.to_pixels(point) for point in body.outline(rival_pose)]
            draw.polygon(outline, fill=RIVAL_COLOUR, outline=WALL_COLOUR, width=2 * OVERSAMPLING)
            self._disc(body.spine(rival_pose).b, 1.2, WALL_COLOUR)
        draw.polygon(
            [self.to_pixels(point) for point in hull.outline(pose)],
            outline=ROBOT_COLOUR,
            width=round(2.5 * OVERSAMPLING),
        )
        self._disc(hull.spine(pose).b, 1.2, ROBOT_COLOUR)
        self._draw_title(title)
        small_image = self.image.resize(
            (self.image.width // OVERSAMPLING, self.image.height // OVERSAMPLING),
            Image.Resampling.LANCZOS,
        )
        file = BytesIO()
        metadata = PngInfo()
        metadata.add_text("Software", "TiniScript")  # key by which tsc recognizes its own pictures
        small_image.save(file, "PNG", pnginfo=metadata)
        return file.getvalue()

    def _disc(self, center: Point | Pose, radius_cm: float, colour: str) -> None:
        x, y = self.to_pixels(center)
        radius = radius_cm * self.scale
        self.draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill=colour)

    def _row(self, points: Sequence[Point | Pose], colour: str, width: float) -> None:
        pixels = [self.to_pixels(point) for point in points]
        self.draw.line(pixels, fill=colour, width=max(1, round(width)), joint="curve")

    def _draw_title(self, title: str) -> None:
        """Write the title, and draw how long a good length is."""
        font = ImageFont.load_default(16 * OVERSAMPLING)
        y = self.image.height - self.footer_height
        self.draw.text((self.margin, y), title, fill=TEXT_COLOUR, font=font)
        length_cm = max(
            (ruler for ruler in RULER_LENGTHS_CM if ruler <= self.world.width_cm / 5),
            default=RULER_LENGTHS_CM[0],
        )
        right = self.image.width - self.margin
        left = right - length_cm * self.scale
        bar_y = y + 24 * OVERSAMPLING
        self.draw.line([(left, bar_y), (right, bar_y)], fill=TEXT_COLOUR, width=2 * OVERSAMPLING)
        for x in (left, right):
            self.draw.line(
                [(x, bar_y - 5 * OVERSAMPLING), (x, bar_y + 5 * OVERSAMPLING)],
                fill=TEXT_COLOUR,
                width=2 * OVERSAMPLING,
            )
        label = f"{length_cm} cm"
        self.draw.text(
            (right - self.draw.textlength(label, font), y), label, fill=TEXT_COLOUR, font=font
        )
