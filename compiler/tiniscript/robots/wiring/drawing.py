"""Draws a plan as self-contained SVG that can be read in black and white.

`layout` gives all positions. All text is escaped here.
"""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from itertools import groupby
from unicodedata import east_asian_width

from tiniscript.robots.driver import GROUND
from tiniscript.robots.wiring import layout as places
from tiniscript.robots.wiring.headers import ROW_AT_THE_END, SIDES
from tiniscript.robots.wiring.layout import LEFT, RIGHT, STEP, ZONE_WIDTH, Box, Layout, Pin, Route
from tiniscript.robots.wiring.parts import BOARD_RAILS, ICONS, RAILS
from tiniscript.robots.wiring.plan import End, Plan, Wire
from tiniscript.robots.wiring.texts import text

WIRE_COLOURS = {
    "orange": "#e67300",
    "green": "#1a8f3c",
    "blue": "#1f5fd0",
    "violet": "#8e35b8",
    "yellow": "#c9a000",
    "grey": "#777777",
    "brown": "#7a4a21",
}
RAIL_COLOURS = {
    "5V": "#c81e1e",
    "3V3": "#e0702c",
    "GND": "#111111",
    "M+": "#a03060",
    "S+": "#a06000",
}
LINE_COLOUR = "#333333"
LEGEND_STEP = 24
FONT = "'DejaVu Sans', Verdana, Arial, sans-serif"
# The distance between a part's edge and the things in the zone next to it.
TAG_DISTANCE, NEAR_DISTANCE, DOT_DISTANCE, FAR_DISTANCE = 26, 65, 94, 118
MIN_SCALE = 0.65  # a text is made smaller to this part of its size, and then cut
NARROW_LETTERS = frozenset("iljtfrI1.,:;'|()[] ")
WIDE_CLASSES = frozenset("WFA")


def drawing_of(plan: Plan) -> str:
    """Return the drawing as a whole `<svg>`, with its size in units that may be scaled."""
    layout = places.layout_of(plan)
    bottom = layout.height + 10
    legend = _legend(plan, bottom)
    height = bottom + LEGEND_STEP * (len(legend)) + 6
    parts = [
        *_board(plan, layout),
        *(_wire(route) for route in layout.routes),
        *_squares(layout, plan),
        *(line for pin in layout.pins for line in _pin(pin, layout, plan)),
        *(line for route in layout.routes for line in _numbers(route)),
        *(line for box in layout.boxes for line in _box(box, plan.language)),
        *_circles(layout),
        *legend,
    ]
    return svg_of(plan, "title", (layout.width, height), parts)


def svg_of(plan: Plan, title_key: str, size: tuple[int, int], parts: Iterable[str]) -> str:
    """Return a drawing of a plan, on white."""
    title = escape(text(title_key, plan.language).format(robot=plan.robot))
    width, height = size
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
        f'width="{width}" height="{height}" font-family="{escape(FONT)}" font-size="14" '
        f'role="img" aria-label="{title}">',
        f"<title>{title}</title>",
        f'<rect width="{width}" height="{height}" fill="#ffffff"/>',
        *parts,
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


# -- texts


def _width(text: str, size: float) -> float:
    """Return about how wide a text is, rather too wide."""
    return sum(size * _part_of_size(letter) for letter in text)


def _part_of_size(letter: str) -> float:
    if letter in NARROW_LETTERS:
        return 0.4
    if east_asian_width(letter) in WIDE_CLASSES:
        return 1.1
    return 0.78 if letter.isupper() or letter in "mw%…" else 0.67


def text_at(
    label: str, x: float, y: float, room: float, anchor: str = "start", size: float = 14,
    style: str = "",
) -> str:  # fmt: skip
    """Return a text that takes at most `room`: smaller where it must be, and cut at the least."""
    label = "".join(letter for letter in label if letter.isprintable())
    while _width(label, size) * MIN_SCALE > room:
        label = label.rstrip("…")[:-1] + "…"
    size = min(size, size * room / (_width(label, size) or 1))
    size_attribute = f' font-size="{size:.3g}"' if size != 14 else ""
    return (
        f'<text x="{x:g}" y="{y:g}" text-anchor="{anchor}"{size_attribute}{style}>'
        f"{escape(label)}</text>"
    )


BOLD_STYLE = ' font-weight="bold"'
FAINT_STYLE = ' fill="#666666"'


# -- the board


def _board(plan: Plan, layout: Layout) -> list[str]:
    left, top, width, height = layout.board
    middle_x = left + width / 2
    lines = [
        f'<rect x="{left}" y="{top}" width="{width}" height="{height}" rx="8" '
        f'fill="#eef4f6" stroke="{LINE_COLOUR}" stroke-width="2"/>',
        f'<rect x="{middle_x - 22:g}" y="{top - 14}" width="44" height="24" rx="3" fill="#dddddd" '
        f'stroke="{LINE_COLOUR}"/>',
        text_at("USB", middle_x, top + 3, 40, "middle", 13),
        text_at(
            SIDES[plan.chip.name].name,
            middle_x,
            top + height - 14,
            width - 12,
            "middle",
            15,
            BOLD_STYLE,
        ),
    ]
    return lines


def _edge(pin: Pin, layout: Layout) -> int:
    left, _, width, _ = layout.board
    return left if pin.side == LEFT else left + width


def _is_used(pin: Pin, plan: Plan) -> bool:
    return pin.wire is not None or pin.name in set(BOARD_RAILS) & set(plan.rails)


def _marks(outlines: Iterable[tuple[bool, str]], style: str = "") -> list[str]:
    """Return the marks of pins or terminals: those that are used, and those that stay free."""
    sorted_outlines = sorted(outlines, reverse=True)
    return [
        f'<path d="{"".join(path for _, path in group)}" '
        f'fill="{"#ffffff" if is_used else "#cccccc"}" stroke="{LINE_COLOUR}"{style}/>'
        for is_used, group in groupby(sorted_outlines, key=lambda path: path[0])
    ]


def _squares(layout: Layout, plan: Plan) -> list[str]:
    return _marks(
        (_is_used(pin, plan), f"M{_edge(pin, layout) - 5},{pin.y - 5}h10v10h-10z")
        for pin in layout.pins
    )


def _pin(pin: Pin, layout: Layout, plan: Plan) -> list[str]:
    edge = _edge(pin, layout)
    inward = 1 if pin.side == LEFT else -1
    is_used = _is_used(pin, plan)
    lines = []
    label = pin.name
    if pin.number == 13 and plan.has_lamp:
        label = f"13 {text('lamp_on_board', plan.language)}"
        is_used = True
    anchor = "start" if pin.side == LEFT else "end"
    style = BOLD_STYLE if is_used else FAINT_STYLE
    lines.append(text_at(label, edge + 10 * inward, pin.y + 4.5, 62, anchor, 14, style))
    if pin.name in set(BOARD_RAILS) & set(plan.rails) and pin == _tag_pin(pin.name, layout):
        near_x, far_x = edge - 5 * inward, edge - 12 * inward
        lines.append(line_to(near_x, pin.y, far_x, pin.y, RAIL_COLOURS[pin.name]))
        lines.append(_tag(pin.name, edge - 29 * inward, pin.y))
    if pin.number in ROW_AT_THE_END and plan.chip.name == "mega":
        first_y = min(
            pin.y for pin in layout.pins if pin.number in ROW_AT_THE_END and pin.side == RIGHT
        )
        if pin.y == first_y:
            sentence = text("row_at_the_end", plan.language)
            lines.append(
                text_at(sentence, edge - 10, pin.y - STEP + 5, 100, "end", 11, FAINT_STYLE)
            )
    return lines


def _tag_pin(name: str, layout: Layout) -> Pin:
    """Return the pin of a rail that has its tag: the first one of the left side, if it has one."""
    return min((pin for pin in layout.pins if pin.name == name), key=lambda pin: pin[:2])


# -- wires


def _wire(route: Route) -> str:
    points = " ".join(f"{x},{y}" for x, y in route.points)
    ink = WIRE_COLOURS[route.wire.colour]
    return (
        f'<polyline points="{points}" fill="none" stroke="#ffffff" stroke-width="6"/>'
        f'<polyline points="{points}" fill="none" stroke="{ink}" stroke-width="2.5" '
        f'stroke-linejoin="round"/>'
    )


def _numbers(route: Route) -> list[str]:
    """Return a wire's number at both of its ends."""
    (start, start_y), (end, end_y) = route.points[0], route.points[-1]
    corner_x = route.points[-2][0]
    outward = 1 if route.points[1][0] > start else -1
    direction = 1 if end > corner_x else -1
    return [
        _number(route.wire, start + 17 * outward, start_y),
        _number(route.wire, end + 10 * direction, end_y),
    ]


def _number(wire: Wire, x: int, y: int) -> str:
    ink = WIRE_COLOURS[wire.colour]
    return (
        f'<circle cx="{x}" cy="{y}" r="9" fill="#ffffff" stroke="{ink}" stroke-width="2"/>'
        f'<text x="{x}" y="{y + 4}" text-anchor="middle" font-size="11">{wire.number}</text>'
    )


def line_to(
    x1: float, y1: float, x2: float, y2: float, ink: str, width: float = 2.5, attributes: str = "",
) -> str:  # fmt: skip
    return (
        f'<line x1="{x1:g}" y1="{y1:g}" x2="{x2:g}" y2="{y2:g}" stroke="{ink}" '
        f'stroke-width="{width:g}"{attributes}/>'
    )


def _tag(rail: str, x: float, y: float) -> str:
    """Return the tag of a rail around a point. Ground is filled to distinguish it."""
    ink = RAIL_COLOURS[rail]
    fill, text_colour = (ink, "#ffffff") if rail == GROUND else ("#ffffff", ink)
    return (
        f'<rect x="{x - 17:g}" y="{y - 9:g}" width="34" height="18" rx="9" fill="{fill}" '
        f'stroke="{ink}" stroke-width="2"/>'
        f'<text x="{x:g}" y="{y + 4:g}" text-anchor="middle" font-size="11" font-weight="bold" '
        f'fill="{text_colour}">{rail}</text>'
    )


def _resistor(value: str, x: float, y: float) -> str:
    return (
        f'<rect x="{x - 20:g}" y="{y - 8:g}" width="40" height="16" fill="#fdf6e3" '
        f'stroke="{LINE_COLOUR}" stroke-width="1.5"/>'
        f'<text x="{x:g}" y="{y + 4:g}" text-anchor="middle" font-size="11">{value}</text>'
    )


# -- parts


def _box(box: Box, language: str) -> list[str]:
    part, icon = box.part, ICONS[box.part.shape.icon]
    outer_x = box.x + (32 if box.side == LEFT else places.PART_WIDTH - 32)
    middle_y = box.y + box.height - 30
    inner_width = places.PART_WIDTH - 16
    model = part.shape.model if part.is_device else ""
    title = f"{part.title} ({model})" if model else part.title
    lines = [
        f'<rect x="{box.x}" y="{box.y}" width="{places.PART_WIDTH}" height="{box.height}" rx="6" '
        f'fill="#fafafa" stroke="{LINE_COLOUR}" stroke-width="2"/>',
        text_at(title, box.x + 8, box.y + 18, inner_width, size=15, style=BOLD_STYLE),
        text_at(part.label, box.x + 8, box.y + 36, inner_width, size=13) if part.label else "",
        f'<g transform="translate({outer_x} {middle_y:g})" fill="#ffffff" stroke="{LINE_COLOUR}" '
        f'stroke-width="1.5">{icon}</g>',
    ]
    if part.shape.motor_terminals:
        lines += _motors(box, language)
    for end, y in zip(part.ends, box.rows, strict=True):
        lines += _end(end, y, box)
    return [line for line in lines if line]


def _end(end: End, y: int, box: Box) -> list[str]:
    """Return a terminal, its name, and the parts in its wire through the zone."""
    edge, outward = box.edge, (1 if box.side == LEFT else -1)

    def x_at(distance: float) -> float:
        """Return the distance of a point from the part's edge, towards the board."""
        return edge + outward * distance

    lines = []
    anchor = "end" if box.side == LEFT else "start"
    if end.wire:
        ink = WIRE_COLOURS[end.wire.colour]
        lines.append(line_to(x_at(ZONE_WIDTH - 19), y, x_at(0), y, ink))
        if end.ground_resistor:
            ground_y = y + STEP
            lines += [
                line_to(x_at(DOT_DISTANCE), y, x_at(DOT_DISTANCE), ground_y, ink),
                line_to(x_at(DOT_DISTANCE + 1), ground_y, x_at(TAG_DISTANCE), ground_y, ink),
                f'<circle cx="{x_at(DOT_DISTANCE):g}" cy="{y}" r="4.5" fill="{ink}"/>',
                _resistor(end.ground_resistor, x_at(NEAR_DISTANCE), ground_y),
                _tag(GROUND, x_at(TAG_DISTANCE), ground_y),
            ]
        if end.series_resistor:
            lines.append(_resistor(end.series_resistor, x_at(FAR_DISTANCE), y))
        if end.far_resistor:
            lines.append(_resistor(end.far_resistor, x_at(NEAR_DISTANCE), y))
    elif end.rail:
        lines.append(line_to(x_at(TAG_DISTANCE), y, x_at(0), y, RAIL_COLOURS[end.rail]))
        lines.append(_tag(end.rail, x_at(TAG_DISTANCE), y))
    if end.name in RAILS and end.wire:
        lines.append(_tag(end.name, x_at(-28), y))
    else:
        style = "" if end.wire or end.rail else FAINT_STYLE
        lines.append(text_at(end.name, x_at(-10), y + 4.5, 90, anchor, 13, style))
    return lines


def _circles(layout: Layout) -> list[str]:
    """Return the terminals of all parts, on the ends of their wires."""
    return _marks(
        (
            (bool(end.wire or end.rail), f"M{box.edge - 5},{y}a5,5 0 1 0 10,0a5,5 0 1 0 -10,0z")
            for box in layout.boxes
            for end, y in zip(box.part.ends, box.rows, strict=True)
        ),
        ' stroke-width="1.5"',
    )


def _motors(box: Box, language: str) -> list[str]:
    lines = []
    outward = -1 if box.side == LEFT else 1
    outer_x = box.x if box.side == LEFT else box.x + places.PART_WIDTH
    top, step = box.y + places.HEAD_HEIGHT + 12, 100
    for k, (key, terminals) in enumerate(
        zip(("left_motor", "right_motor"), box.part.shape.motor_terminals, strict=True)
    ):
        x, y = outer_x + outward * 62, top + k * step + 18
        for offset in (-8, 8):
            lines.append(line_to(outer_x, y + offset, x, y + offset, LINE_COLOUR))
        lines += [
            f'<circle cx="{x}" cy="{y}" r="24" fill="#ffffff" stroke="{LINE_COLOUR}" '
            f'stroke-width="2"/>',
            text_at("M", x, y + 6, 40, "middle", 17, BOLD_STYLE),
            text_at(text(key, language), x - outward * 10, y + 42, 98, "middle", 12),
            text_at(
                terminals, outer_x - outward * 6, y + 4, 84, "end" if outward > 0 else "start", 11
            ),
        ]
    return lines


# -- the legend


def _legend(plan: Plan, top: int) -> list[str]:
    lines = [
        f'<g><circle cx="29" cy="{top + 8}" r="9" fill="#ffffff" stroke="{LINE_COLOUR}" '
        f'stroke-width="2"/><text x="29" y="{top + 12}" text-anchor="middle" font-size="11">7'
        f"</text>{text_at(text('legend_number', plan.language), 58, top + 13, 900)}</g>"
    ]
    for rail in plan.rails:
        y = top + 8 + LEGEND_STEP * len(lines)
        sentence = text(f"legend_{rail}", plan.language)
        lines.append(f"<g>{_tag(rail, 29, y)}{text_at(sentence, 58, y + 5, 900)}</g>")
    for key in ("legend_same", "legend_dot"):
        y = top + 8 + LEGEND_STEP * len(lines)
        lines.append(text_at(text(key, plan.language), 10, y + 5, 900))
    return lines
