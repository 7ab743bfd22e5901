"""Draws the finished robot from above, its front at the top: where wheels, parts and sensors sit.

Size, wheels and sensors are those of the profile's body; where board, breadboard and batteries lie
is a proposal. Knows a plan; what a plan's texts may hold is escaped by `drawing`.
"""

from __future__ import annotations

from math import cos, radians, sin

from tiniscript.robots.profile import Place
from tiniscript.robots.wiring.drawing import BOLD, FAINT, LINE, RAIL_INKS, line_to, svg_of, text_at
from tiniscript.robots.wiring.headers import SIDES
from tiniscript.robots.wiring.plan import Part, Plan
from tiniscript.robots.wiring.texts import text

LONGEST = 520  # of the longer side of the plate
MARGIN = 70  # above and below the plate
BESIDE = 230  # left and right of it, for the labels
WHEEL_CM = 6.5, 2.6  # its diameter and its width
ROW_STEP = 44  # between two labels
ARROW = 30
JAW = 46  # how far the arm of a servo reaches ahead
BETWEEN_CM = 3  # from the middle line: so far is between the jaws
PLATE, PARTS = "#f4f4f4", "#ffffff"
THIN = "#888888", 1  # the line from a label
BELOW = ' stroke-dasharray="5 4"'  # what is under the plate


def finished_of(plan: Plan) -> str:
    """Return the drawing as a whole `<svg>`."""
    return _Finished(plan).svg()


class _Finished:
    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        body = plan.body
        self.scale = LONGEST / max(body.length_cm, body.width_cm, body.wheel_base_cm)
        self.length, self.breadth = body.length_cm * self.scale, body.width_cm * self.scale
        wheel_cm = min(WHEEL_CM[0], body.length_cm * 0.4), min(WHEEL_CM[1], body.width_cm * 0.2)
        self.wheel = wheel_cm[0] * self.scale, wheel_cm[1] * self.scale
        half = max(self.breadth, body.wheel_base_cm * self.scale + self.wheel[1]) / 2
        self.left, self.right = BESIDE, BESIDE + 2 * half
        places_x_cm = [0.0, *(place.x_cm for place in body.places.values())]
        front_excess = max(0.0, max(places_x_cm) * self.scale - self.length / 2)
        self.x, self.y = BESIDE + half, MARGIN + front_excess + self.length / 2
        self.servos = [part for part in plan.parts if part.is_device and part.shape.icon == "servo"]
        self.y += JAW if self.servos and self._caster_place() is None else 0
        self.width = self.right + BESIDE
        self.height = self.y + self.length / 2 + MARGIN

    def svg(self) -> str:
        parts = (self._plate, self._wheels, self._rows, self._servos, self._sensors, self._sizes)
        lines = [line for part in parts for line in part()]
        return svg_of(self.plan, "finished", (round(self.width), round(self.height)), lines)

    def say(self, key: str) -> str:
        return text(key, self.plan.language)

    def at(self, x_cm: float, y_cm: float) -> tuple[float, float]:
        """Return where a place of the body is drawn: `x_cm` goes forward, `y_cm` to the left."""
        return self.x - y_cm * self.scale, self.y - x_cm * self.scale

    def _plate(self) -> list[str]:
        return [
            _box(self.x - self.breadth / 2, self.y - self.length / 2, self.breadth, self.length,
                 PLATE, corner=22),
            text_at(self.say("front"), self.x, MARGIN / 2, 400, "middle", style=BOLD),
        ]  # fmt: skip

    def _wheels(self) -> list[str]:
        """Return both wheels on their axle, each with its motor under the plate, and the caster."""
        lines = []
        across = self.plan.body.wheel_base_cm / 2 * self.scale
        diameter, width = self.wheel
        for side, key in ((-1, "left_motor"), (1, "right_motor")):
            x = self.x + side * across
            inner = x - side * across * 0.62  # under the boxes on the plate, as is the motor's end
            rows = (self.y - diameter * 0.17, self.y + diameter * 0.17)
            lines += [
                *(line_to(x, row, inner, row, LINE, 1, BELOW) for row in rows),
                _box(x - width / 2, self.y - diameter / 2, width, diameter, "#333333", corner=8),
            ]  # fmt: skip
            outside = self.left - 10 if side < 0 else self.right + 10
            anchor = "end" if side < 0 else "start"
            lines.append(text_at(self.say(key), outside, self.y + 5, BESIDE - 20, anchor))
        radius = diameter * 0.17
        caster = self.y + self.length / 2 - radius - 12
        lines += [
            f'<circle cx="{self.x:g}" cy="{caster:g}" r="{radius:g}" fill="none" '
            f'stroke="{LINE}"{BELOW}/>',
            text_at(self.say("caster"), self.right + 10, caster + 5, BESIDE - 20),
            line_to(self.x + radius, caster, self.right + 6, caster, *THIN),
        ]  # fmt: skip
        return lines

    def _rows(self) -> list[str]:
        """Return board, breadboard and batteries: boxes on the plate, from front to back."""
        driver = self.plan.parts[0].title
        supplies = [part for part in self.plan.parts if _is_supply(part)]
        boxes = [
            (SIDES[self.plan.chip.name].name, self.say("on_top_usb"), LINE),
            (driver, self.say("beside_driver"), LINE),
            *((supply.title, supply.label, RAIL_INKS["M+"]) for supply in supplies),
            (self.say("power_bank"), self.say("for_the_board"), RAIL_INKS["5V"]),
        ]
        room = self.length * 0.72
        gap = 10.0
        high = (room - gap * (len(boxes) - 1)) / len(boxes)
        broad = self.breadth * 0.5
        lines = []
        top = self.y - self.length / 2 + self.length * 0.13
        for title, label, ink in boxes:
            lines += [
                _box(self.x - broad / 2, top, broad, high, PARTS, ink),
                text_at(title, self.x, top + high / 2 - 3, broad - 12, "middle", style=BOLD),
                text_at(label, self.x, top + high / 2 + 16, broad - 12, "middle", 12, FAINT),
            ]
            top += high + gap
        return lines

    def _caster_place(self) -> Place | None:
        """Return the touch sensor that is held before the plate, in the middle: between jaws."""
        front_cm = self.plan.body.length_cm / 2
        for place in self.plan.body.places.values():
            if place.sees == "touch" and place.x_cm > front_cm and abs(place.y_cm) < BETWEEN_CM:
                return place
        return None

    def _servos(self) -> list[str]:
        """Return each servo at the front edge with its name: two jaws around a button, or an arm.

        The profile does not say where they are: they share the edge.
        """
        lines: list[str] = []
        caster = self._caster_place()
        edge = self.y - self.length / 2
        above = sum(
            place.y_cm > 0 for place in self.plan.body.places.values()
        )  # other labels there
        first_row = max(edge + 26, MARGIN + 14 + ROW_STEP * above)
        for k, part in enumerate(self.servos):
            share = (k + 0.5) / len(self.servos) - 0.5
            if caster is not None:  # the jaws are in the middle, the others beside them
                share = (0.38 - 0.12 * ((k - 1) // 2)) * (1 if k % 2 else -1) if k else 0
            x = self.x + share * self.breadth
            lines.append(_box(x - 26, edge + 4, 52, 30, PARTS))
            if k == 0 and caster is not None:
                tip = self.at(caster.x_cm, 0)[1] - ARROW
                for side in (-1, 1):
                    inner, outer = self.x + side * 24, self.x + side * 46
                    lines.append(
                        f'<path d="M{x + side * 14:g},{edge + 6:g} L{outer:g},{edge - 26:g} '
                        f'L{outer:g},{tip + 22:g} L{inner:g},{tip:g}" fill="none" '
                        f'stroke="{LINE}" stroke-width="7" stroke-linejoin="round" '
                        f'stroke-linecap="round"/>'
                    )
            else:
                lines.append(line_to(x, edge + 10, x, edge - JAW, LINE, 7))
            row = first_row + k * ROW_STEP
            lines += [
                line_to(self.left - 4, row - 5, x - 26, edge + 19, *THIN),
                text_at(part.title, self.left - 10, row, BESIDE - 20, "end", style=BOLD),
                text_at(part.label, self.left - 10, row + 17, BESIDE - 20, "end", 12, FAINT),
            ]
        return lines

    def _sensors(self) -> list[str]:
        """Return each sensor where it sits, with an arrow to what it looks at, and its name."""
        lines: list[str] = []
        rows = {"left": MARGIN + 14.0, "right": MARGIN + 14.0}
        body = self.plan.body
        by_side = sorted(body.places.items(), key=lambda each: -each[1].x_cm)
        labels = {part.title: part.label for part in self.plan.parts if part.is_device}
        for name, place in by_side:
            side = "left" if place.y_cm > 0 else "right"
            x, y = self.at(place.x_cm, place.y_cm)
            outside = self.left - 10 if side == "left" else self.right + 10
            anchor = "end" if side == "left" else "start"
            row = rows[side]
            rows[side] += ROW_STEP
            near = outside + (6 if side == "left" else -6)
            edge = self.y - self.length / 2
            if y < edge:  # it is held before the plate
                lines.append(line_to(x, y, x, edge, LINE, 4))
            lines += [
                line_to(near, row - 5, x, y, *THIN), *self._looks(place, x, y),
                text_at(name, outside, row, BESIDE - 20, anchor, style=BOLD),
                text_at(labels.get(name, ""), outside, row + 17, BESIDE - 20, anchor, 12, FAINT),
            ]  # fmt: skip
        return lines

    def _looks(self, place: Place, x: float, y: float) -> list[str]:
        if place.sees in ("line", "white"):  # down, to the floor
            return [f'<circle cx="{x:g}" cy="{y:g}" r="9" fill="{PARTS}" stroke="{LINE}"{BELOW}/>']
        turn = radians(place.heading)
        tip_x, tip_y = x - ARROW * sin(turn), y - ARROW * cos(turn)
        ends = [
            (tip_x + 9 * sin(turn + k), tip_y + 9 * cos(turn + k)) for k in (-0.5, 0.5)
        ]  # fmt: skip
        points = " ".join(f"{a:g},{b:g}" for a, b in ((tip_x, tip_y), *ends))
        return [
            line_to(x, y, tip_x, tip_y, LINE),
            f'<polygon points="{points}" fill="{LINE}"/>',
            f'<circle cx="{x:g}" cy="{y:g}" r="9" fill="{PARTS}" stroke="{LINE}" '
            f'stroke-width="2"/>',
        ]

    def _sizes(self) -> list[str]:
        """Return how long and how wide the plate is, in centimetres."""
        body = self.plan.body
        size = f"{body.length_cm:g} × {body.width_cm:g} cm"
        return [text_at(size, self.x, self.y + self.length / 2 + 26, 300, "middle")]


def _is_supply(part: Part) -> bool:
    return part.shape.need_key in ("need_battery", "need_servo_supply")


def _box(
    x: float, y: float, width: float, height: float, fill: str, ink: str = LINE, corner: int = 6,
) -> str:  # fmt: skip
    return (
        f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" rx="{corner}" '
        f'fill="{fill}" stroke="{ink}" stroke-width="1.5"/>'
    )
