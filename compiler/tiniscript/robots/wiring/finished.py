"""Draws the finished robot from above, its front at the top: where wheels, parts and sensors sit.

Size, wheels and sensors are those of the profile's body; where board, breadboard and batteries lie
is a proposal. Knows a plan; what a plan's texts may hold is escaped by `drawing`.
"""

from __future__ import annotations

from math import cos, radians, sin

from tiniscript.robots.profile import Place
from tiniscript.robots.wiring.drawing import (
    BOLD_STYLE,
    FAINT_STYLE,
    LINE_COLOUR,
    RAIL_COLOURS,
    line_to,
    svg_of,
    text_at,
)
from tiniscript.robots.wiring.headers import SIDES
from tiniscript.robots.wiring.plan import Part, Plan
from tiniscript.robots.wiring.texts import text

PLATE_LENGTH = 520  # length of the plate's longer side
MARGIN = 70  # above and below the plate
SIDE_WIDTH = 230  # left and right of it, for the labels
WHEEL_CM = 6.5, 2.6  # diameter and width of a wheel
LABEL_STEP = 44  # between two labels
ARROW_LENGTH = 30
JAW_LENGTH = 46  # reach of a servo's arm
MAX_JAW_OFFSET_CM = 3  # greatest distance between the jaws' middle line and a jaw
PLATE_FILL, PART_FILL = "#f4f4f4", "#ffffff"
THIN_LINE = "#888888", 1  # the line from a label
DASHED_STYLE = ' stroke-dasharray="5 4"'  # style of parts under the plate


def finished_of(plan: Plan) -> str:
    """Return the drawing as a whole `<svg>`."""
    return _FinishedDrawing(plan).svg()


class _FinishedDrawing:
    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        body = plan.body
        self.scale = PLATE_LENGTH / max(body.length_cm, body.width_cm, body.wheel_base_cm)
        self.length, self.breadth = body.length_cm * self.scale, body.width_cm * self.scale
        wheel_cm = min(WHEEL_CM[0], body.length_cm * 0.4), min(WHEEL_CM[1], body.width_cm * 0.2)
        self.wheel = wheel_cm[0] * self.scale, wheel_cm[1] * self.scale
        half_width = max(self.breadth, body.wheel_base_cm * self.scale + self.wheel[1]) / 2
        self.left, self.right = SIDE_WIDTH, SIDE_WIDTH + 2 * half_width
        places_x_cm = [0.0, *(place.x_cm for place in body.places.values())]
        front_excess = max(0.0, max(places_x_cm) * self.scale - self.length / 2)
        self.x, self.y = SIDE_WIDTH + half_width, MARGIN + front_excess + self.length / 2
        self.servos = [part for part in plan.parts if part.is_device and part.shape.icon == "servo"]
        self.y += JAW_LENGTH if self.servos and self._touch_place() is None else 0
        self.width = self.right + SIDE_WIDTH
        self.height = self.y + self.length / 2 + MARGIN

    def svg(self) -> str:
        parts = (
            self._plate_svg,
            self._wheels_svg,
            self._rows_svg,
            self._servos_svg,
            self._sensors_svg,
            self._sizes_svg,
        )
        lines = [line for part in parts for line in part()]
        return svg_of(self.plan, "finished", (round(self.width), round(self.height)), lines)

    def text(self, key: str) -> str:
        return text(key, self.plan.language)

    def position(self, x_cm: float, y_cm: float) -> tuple[float, float]:
        """Return the drawn position of a place on the body: `x_cm` is forward, `y_cm` to the
        left.
        """
        return self.x - y_cm * self.scale, self.y - x_cm * self.scale

    def _plate_svg(self) -> list[str]:
        return [
            _box(self.x - self.breadth / 2, self.y - self.length / 2, self.breadth, self.length,
                 PLATE_FILL, corner=22),
            text_at(self.text("front"), self.x, MARGIN / 2, 400, "middle", style=BOLD_STYLE),
        ]  # fmt: skip

    def _wheels_svg(self) -> list[str]:
        """Return both wheels on their axle, each with its motor under the plate, and the caster."""
        lines = []
        half_base = self.plan.body.wheel_base_cm / 2 * self.scale
        diameter, width = self.wheel
        for side, key in ((-1, "left_motor"), (1, "right_motor")):
            x = self.x + side * half_base
            inner_x = (
                x - side * half_base * 0.62
            )  # under the boxes on the plate, as is the motor's end
            rows = (self.y - diameter * 0.17, self.y + diameter * 0.17)
            lines += [
                *(line_to(x, row, inner_x, row, LINE_COLOUR, 1, DASHED_STYLE) for row in rows),
                _box(x - width / 2, self.y - diameter / 2, width, diameter, "#333333", corner=8),
            ]  # fmt: skip
            label_x = self.left - 10 if side < 0 else self.right + 10
            anchor = "end" if side < 0 else "start"
            lines.append(text_at(self.text(key), label_x, self.y + 5, SIDE_WIDTH - 20, anchor))
        radius = diameter * 0.17
        caster_y = self.y + self.length / 2 - radius - 12
        lines += [
            f'<circle cx="{self.x:g}" cy="{caster_y:g}" r="{radius:g}" fill="none" '
            f'stroke="{LINE_COLOUR}"{DASHED_STYLE}/>',
            text_at(self.text("caster"), self.right + 10, caster_y + 5, SIDE_WIDTH - 20),
            line_to(self.x + radius, caster_y, self.right + 6, caster_y, *THIN_LINE),
        ]  # fmt: skip
        return lines

    def _rows_svg(self) -> list[str]:
        """Return board, breadboard and batteries: boxes on the plate, from front to back."""
        motor_driver_title = self.plan.parts[0].title
        supplies = [part for part in self.plan.parts if _is_supply(part)]
        boxes = [
            (SIDES[self.plan.chip.name].name, self.text("on_top_usb"), LINE_COLOUR),
            (motor_driver_title, self.text("beside_driver"), LINE_COLOUR),
            *((supply.title, supply.label, RAIL_COLOURS["M+"]) for supply in supplies),
            (self.text("power_bank"), self.text("for_the_board"), RAIL_COLOURS["5V"]),
        ]
        room = self.length * 0.72
        gap = 10.0
        box_height = (room - gap * (len(boxes) - 1)) / len(boxes)
        box_width = self.breadth * 0.5
        lines = []
        top = self.y - self.length / 2 + self.length * 0.13
        for title, label, ink in boxes:
            lines += [
                _box(self.x - box_width / 2, top, box_width, box_height, PART_FILL, ink),
                text_at(
                    title,
                    self.x,
                    top + box_height / 2 - 3,
                    box_width - 12,
                    "middle",
                    style=BOLD_STYLE,
                ),
                text_at(
                    label,
                    self.x,
                    top + box_height / 2 + 16,
                    box_width - 12,
                    "middle",
                    12,
                    FAINT_STYLE,
                ),
            ]
            top += box_height + gap
        return lines

    def _touch_place(self) -> Place | None:
        """Return the touch sensor that is held before the plate, in the middle: between jaws."""
        front_cm = self.plan.body.length_cm / 2
        for place in self.plan.body.places.values():
            if (
                place.sees == "touch"
                and place.x_cm > front_cm
                and abs(place.y_cm) < MAX_JAW_OFFSET_CM
            ):
                return place
        return None

    def _servos_svg(self) -> list[str]:
        """Return each servo at the front edge with its name: two jaws around a button, or an arm.

        The profile does not say where they are: they share the edge.
        """
        lines: list[str] = []
        touch_place = self._touch_place()
        front_y = self.y - self.length / 2
        label_count = sum(
            place.y_cm > 0 for place in self.plan.body.places.values()
        )  # other labels there
        first_row = max(front_y + 26, MARGIN + 14 + LABEL_STEP * label_count)
        for k, part in enumerate(self.servos):
            share = (k + 0.5) / len(self.servos) - 0.5
            if touch_place is not None:  # the jaws are in the middle, the others next to them
                share = (0.38 - 0.12 * ((k - 1) // 2)) * (1 if k % 2 else -1) if k else 0
            x = self.x + share * self.breadth
            lines.append(_box(x - 26, front_y + 4, 52, 30, PART_FILL))
            if k == 0 and touch_place is not None:
                tip_y = self.position(touch_place.x_cm, 0)[1] - ARROW_LENGTH
                for side in (-1, 1):
                    inner_x, outer_x = self.x + side * 24, self.x + side * 46
                    lines.append(
                        f'<path d="M{x + side * 14:g},{front_y + 6:g} '
                        f"L{outer_x:g},{front_y - 26:g} "
                        f'L{outer_x:g},{tip_y + 22:g} L{inner_x:g},{tip_y:g}" fill="none" '
                        f'stroke="{LINE_COLOUR}" stroke-width="7" stroke-linejoin="round" '
                        f'stroke-linecap="round"/>'
                    )
            else:
                lines.append(line_to(x, front_y + 10, x, front_y - JAW_LENGTH, LINE_COLOUR, 7))
            label_y = first_row + k * LABEL_STEP
            lines += [
                line_to(self.left - 4, label_y - 5, x - 26, front_y + 19, *THIN_LINE),
                text_at(
                    part.title, self.left - 10, label_y, SIDE_WIDTH - 20, "end", style=BOLD_STYLE
                ),
                text_at(
                    part.label,
                    self.left - 10,
                    label_y + 17,
                    SIDE_WIDTH - 20,
                    "end",
                    12,
                    FAINT_STYLE,
                ),
            ]
        return lines

    def _sensors_svg(self) -> list[str]:
        """Return each sensor where it sits, with an arrow to what it looks at, and its name."""
        lines: list[str] = []
        label_y_of_side = {"left": MARGIN + 14.0, "right": MARGIN + 14.0}
        body = self.plan.body
        sorted_places = sorted(body.places.items(), key=lambda item: -item[1].x_cm)
        labels = {part.title: part.label for part in self.plan.parts if part.is_device}
        for name, place in sorted_places:
            side = "left" if place.y_cm > 0 else "right"
            x, y = self.position(place.x_cm, place.y_cm)
            label_x = self.left - 10 if side == "left" else self.right + 10
            anchor = "end" if side == "left" else "start"
            label_y = label_y_of_side[side]
            label_y_of_side[side] += LABEL_STEP
            line_x = label_x + (6 if side == "left" else -6)
            front_y = self.y - self.length / 2
            if y < front_y:  # the part is held in front of the plate
                lines.append(line_to(x, y, x, front_y, LINE_COLOUR, 4))
            lines += [
                line_to(line_x, label_y - 5, x, y, *THIN_LINE),
                *self._sensor_mark(place, x, y),
                text_at(name, label_x, label_y, SIDE_WIDTH - 20, anchor, style=BOLD_STYLE),
                text_at(
                    labels.get(name, ""),
                    label_x,
                    label_y + 17,
                    SIDE_WIDTH - 20,
                    anchor,
                    12,
                    FAINT_STYLE,
                ),
            ]
        return lines

    def _sensor_mark(self, place: Place, x: float, y: float) -> list[str]:
        if place.sees in ("line", "white"):  # down, to the floor
            return [
                f'<circle cx="{x:g}" cy="{y:g}" r="9" fill="{PART_FILL}" '
                f'stroke="{LINE_COLOUR}"{DASHED_STYLE}/>'
            ]
        angle = radians(place.heading)
        tip_x, tip_y = x - ARROW_LENGTH * sin(angle), y - ARROW_LENGTH * cos(angle)
        ends = [(tip_x + 9 * sin(angle + k), tip_y + 9 * cos(angle + k)) for k in (-0.5, 0.5)]
        points = " ".join(f"{a:g},{b:g}" for a, b in ((tip_x, tip_y), *ends))
        return [
            line_to(x, y, tip_x, tip_y, LINE_COLOUR),
            f'<polygon points="{points}" fill="{LINE_COLOUR}"/>',
            f'<circle cx="{x:g}" cy="{y:g}" r="9" fill="{PART_FILL}" stroke="{LINE_COLOUR}" '
            f'stroke-width="2"/>',
        ]

    def _sizes_svg(self) -> list[str]:
        """Return the dimension lines of the plate, in centimetres."""
        body = self.plan.body
        size = f"{body.length_cm:g} × {body.width_cm:g} cm"
        return [text_at(size, self.x, self.y + self.length / 2 + 26, 300, "middle")]


def _is_supply(part: Part) -> bool:
    return part.shape.need_key in ("need_battery", "need_servo_supply")


def _box(
    x: float,
    y: float,
    width: float,
    height: float,
    fill: str,
    ink: str = LINE_COLOUR,
    corner: int = 6,
) -> str:
    return (
        f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" rx="{corner}" '
        f'fill="{fill}" stroke="{ink}" stroke-width="1.5"/>'
    )
