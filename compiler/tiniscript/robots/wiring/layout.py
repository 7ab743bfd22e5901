"""Calculates where the board, the parts and the wires of a plan are drawn.

Pins lie on a grid, terminals half a step off it, and every wire has its own track between the board
and the parts, so wires may cross but never overlap. Knows no SVG.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from tiniscript.robots.wiring.headers import RECEIVE_PINS, ROW_AT_THE_END, SIDES, Slot
from tiniscript.robots.wiring.plan import Part, Plan, Wire

LEFT, RIGHT = 0, 1
STEP = 22  # distance between pins
TRACK_WIDTH = 9  # distance between wires
HEAD_HEIGHT = 44  # the title of a part
BOARD_WIDTH = 136
BOARD_NAME_HEIGHT = 44  # below its pins
PART_WIDTH = 160
ZONE_WIDTH = 158  # the zone next to a part, where its resistors are
BOARD_GAPS = (54, 26)  # left: connections of the board's 5V and GND; right: only numbers
MOTORS_WIDTH = 100
MARGIN = 10
PART_GAP = 16  # smallest distance between parts


class Pin(NamedTuple):
    """The drawing of a place on the board's edge. `wire` is None if it is unconnected."""

    side: int
    y: int
    name: str
    number: int | None
    wire: Wire | None


class Box(NamedTuple):
    """A part and its place; `rows` are the heights of its terminals. `x` is its left edge."""

    part: Part
    side: int
    x: int
    y: int
    height: int
    rows: tuple[int, ...]

    @property
    def edge(self) -> int:
        """The position of its terminals."""
        return self.x + (PART_WIDTH if self.side == LEFT else 0)


class Route(NamedTuple):
    """A wire's corners, from the board's edge to the zone next to its part."""

    wire: Wire
    points: tuple[tuple[int, int], ...]


class Layout(NamedTuple):
    width: int
    height: int
    board: tuple[int, int, int, int]  # left, top, width, height
    pins: tuple[Pin, ...]
    boxes: tuple[Box, ...]
    routes: tuple[Route, ...]


def _rows_of(part: Part) -> list[int]:
    """Return the heights of a part's terminals, from its top. A resistor to ground takes a row."""
    rows, y = [], HEAD_HEIGHT + STEP // 2
    for end in part.ends:
        rows.append(y)
        y += STEP * (2 if end.ground_resistor else 1)
    return rows


def _height_of(part: Part) -> int:
    bottom = _rows_of(part)[-1] + (STEP if part.ends[-1].ground_resistor else 0)
    return max(bottom, HEAD_HEIGHT + STEP + STEP // 2) + STEP // 2 + 6


class _Channel:
    """The wires between the board and the parts of a side, each on a track of its own.

    A wire's two heights are where it comes from on the board's side, and where it goes.
    """

    def __init__(self) -> None:
        self.span_by_wire: dict[int, tuple[int, int]] = {}

    def tracks(self) -> dict[int, int]:
        """Return the track of each wire (0 is next to the board), chosen for few crossings."""
        order = sorted(self.span_by_wire, key=lambda wire: self.span_by_wire[wire])
        has_improved = True
        while has_improved:
            has_improved = False
            for wire in tuple(order):
                k = order.index(wire)
                other_wires = order[:k] + order[k + 1 :]
                costs = [self._cost(other_wires, wire, place) for place in range(len(order))]
                best_track = costs.index(min(costs))
                if costs[best_track] < costs[k]:
                    order = [*other_wires[:best_track], wire, *other_wires[best_track:]]
                    has_improved = True
        return {wire: track for track, wire in enumerate(order)}

    def _cost(self, other_wires: Sequence[int], wire: int, track: int) -> int:
        crossing_count = sum(self._crossings(other, wire) for other in other_wires[:track])
        return crossing_count + sum(self._crossings(wire, other) for other in other_wires[track:])

    def _crossings(self, near_wire: int, far_wire: int) -> int:
        """Count where two wires cross if `near_wire` has the track that is nearer to the board."""
        near_from, near_to = self.span_by_wire[near_wire]
        far_from, far_to = self.span_by_wire[far_wire]
        crosses_from = min(near_from, near_to) < far_from < max(near_from, near_to)
        return crosses_from + (min(far_from, far_to) < near_to < max(far_from, far_to))


def layout_of(plan: Plan) -> Layout:
    """Return the places of all that `plan` has."""
    return _Layout(plan).compute()


class _Layout:
    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.wires = {wire.pin: wire for wire in plan.wires}
        columns = [self._slots(side) for side in (LEFT, RIGHT)]
        self.pin_side = {pin: side for side in (LEFT, RIGHT) for pin in columns[side]}
        # A column that has a rail of its own needs room for its tag, as the left one has.
        has_rail = set(columns[RIGHT]) & set(plan.rails) - set(columns[LEFT])
        self.board_gaps = (BOARD_GAPS[LEFT], BOARD_GAPS[LEFT if has_rail else RIGHT])
        parts: list[list[Part]] = [[], []]
        for part in plan.parts:
            parts[self._side_of(part)].append(part)
        column_height = max(len(column) for column in columns) * STEP + BOARD_NAME_HEIGHT
        heights = [sum(_room(part) for part in column_parts) for column_parts in parts]
        full_height = max(column_height, *heights)
        self.board_top = MARGIN + STEP + _snap((full_height - column_height) // 2)
        self.board_height = column_height
        self.pins: list[Pin] = []
        for side, column in enumerate(columns):
            for k, slot in enumerate(column):
                if slot is not None:
                    self.pins.append(self._pin(side, self.board_top + STEP * (k + 1), slot))
        self.pin_y = {pin.number: pin.y for pin in self.pins if pin.number is not None}
        self.top_by_part: dict[int, int] = {}  # top of each part, by its index in the plan
        bottom = MARGIN + STEP + full_height
        for column_parts in parts:
            self._stack(column_parts, bottom)

    # -- the board

    def _slots(self, side: int) -> list[Slot]:
        sides = SIDES[self.plan.chip.name]
        slots: list[Slot] = list(sides.left if side == LEFT else sides.right)
        printed_pins = {slot for slot in (*sides.left, *sides.right) if isinstance(slot, int)}
        if side == RIGHT:
            row_end_pins = sorted(pin for pin in self.wires if pin not in printed_pins)
            assert all(pin in ROW_AT_THE_END for pin in row_end_pins)
            slots += [None, *row_end_pins] if row_end_pins else []
        return slots

    def _pin(self, side: int, y: int, slot: int | str) -> Pin:
        if isinstance(slot, str):
            return Pin(side, y, slot, None, None)
        name = self.plan.chip.pin_name(slot)
        if slot in self.plan.chip.link_pins:
            name += " RX" if slot == RECEIVE_PINS.get(self.plan.chip.name, 0) else " TX"
        return Pin(side, y, name, slot, self.wires.get(slot))

    # -- the parts

    def _side_of(self, part: Part) -> int:
        sides = [self.pin_side[end.wire.pin] for end in part.ends if end.wire]
        return RIGHT if sides and 2 * sum(sides) >= len(sides) else LEFT

    def _wanted_y(self, part: Part) -> float:
        """Return the preferred height of a part's first terminal: that of its pins."""
        offsets = [
            self.pin_y[end.wire.pin] - row
            for end, row in zip(part.ends, _rows_of(part), strict=True)
            if end.wire
        ]
        return sum(offsets) / len(offsets) if offsets else float("inf")

    def _center_y(self, part: Part) -> float:
        pins = [self.pin_y[end.wire.pin] for end in part.ends if end.wire]
        return sum(pins) / len(pins) if pins else float("inf")

    def _stack(self, parts: Sequence[Part], bottom: int) -> None:
        """Put the parts of a side below each other, each as near to its pins as there is room."""
        sorted_parts = sorted(parts, key=self._center_y)
        y = MARGIN + STEP
        for k, part in enumerate(sorted_parts):
            latest_y = bottom - sum(_room(part) for part in sorted_parts[k:])
            wanted_y = min(self._wanted_y(part), latest_y)
            y = max(y, _snap(int(wanted_y)))
            self.top_by_part[id(part)] = y
            y += _room(part)

    # -- the wires

    def compute(self) -> Layout:
        channels = (_Channel(), _Channel())
        crossing_wires: list[int] = []  # wires from a pin of one side to a part of the other
        end_by_wire: dict[int, tuple[int, int]] = {}  # side and height of each wire's terminal
        for part in self.plan.parts:
            top = self.top_by_part[id(part)]
            for end, row in zip(part.ends, _rows_of(part), strict=True):
                if end.wire:
                    end_by_wire[end.wire.number] = (self._side_of(part), top + row)
        first_lane_y = self._free_y()
        lane_y_of_wire: dict[int, int] = {}
        for wire in self.plan.wires:
            side, y = end_by_wire[wire.number]
            pin_side = self.pin_side[wire.pin]
            if side == pin_side:
                channels[side].span_by_wire[wire.number] = (self.pin_y[wire.pin], y)
                continue
            lane_y_of_wire[wire.number] = first_lane_y + STEP * len(crossing_wires)
            crossing_wires.append(wire.number)
            channels[pin_side].span_by_wire[wire.number] = (
                self.pin_y[wire.pin],
                lane_y_of_wire[wire.number],
            )
            channels[side].span_by_wire[wire.number] = (lane_y_of_wire[wire.number], y)
        widths = [TRACK_WIDTH * (len(channel.span_by_wire) + 1) for channel in channels]
        has_motors = [
            any(
                part.shape.motor_terminals and self._side_of(part) == side
                for part in self.plan.parts
            )
            for side in (LEFT, RIGHT)
        ]
        left_part = MARGIN + MOTORS_WIDTH * has_motors[LEFT]
        board_left = left_part + PART_WIDTH + ZONE_WIDTH + widths[LEFT] + self.board_gaps[LEFT]
        board_right = board_left + BOARD_WIDTH
        right_zone = board_right + self.board_gaps[RIGHT] + widths[RIGHT]
        right_part = right_zone + ZONE_WIDTH
        edges = (board_left, board_right)
        zones = (left_part + PART_WIDTH + ZONE_WIDTH, right_zone)
        tracks = [channel.tracks() for channel in channels]

        def x_of(side: int, number: int) -> int:
            distance = self.board_gaps[side] + TRACK_WIDTH * (tracks[side][number] + 1)
            return edges[side] + (distance if side == RIGHT else -distance)

        routes = tuple(
            self._route(
                wire, end_by_wire[wire.number], lane_y_of_wire.get(wire.number), edges, zones, x_of
            )
            for wire in self.plan.wires
        )
        boxes = tuple(self._box(part, (left_part, right_part)) for part in self.plan.parts)
        width = right_part + PART_WIDTH + MARGIN + MOTORS_WIDTH * has_motors[RIGHT]
        bottom_y = max(
            self.board_top + self.board_height,
            *(box.y + box.height for box in boxes),
            *(y for route in routes for _, y in route.points),
        )
        board = (board_left, self.board_top, BOARD_WIDTH, self.board_height)
        return Layout(width, bottom_y + MARGIN, board, tuple(self.pins), boxes, routes)

    def _free_y(self) -> int:
        """Return the first height below the board, a quarter step off pins and terminals."""
        return self.board_top + _snap(self.board_height) + STEP + STEP // 4

    def _box(self, part: Part, columns: tuple[int, int]) -> Box:
        side, top = self._side_of(part), self.top_by_part[id(part)]
        rows = tuple(top + row for row in _rows_of(part))
        return Box(part, side, columns[side], top, _height_of(part), rows)

    def _route(
        self, wire: Wire, end: tuple[int, int], lane: int | None, edges: tuple[int, int],
        zones: tuple[int, int], x_of: Callable[[int, int], int],
    ) -> Route:  # fmt: skip
        side, y = end
        pin_side = self.pin_side[wire.pin]
        start, x = self.pin_y[wire.pin], x_of(pin_side, wire.number)
        points = [(edges[pin_side], start), (x, start)]
        if lane is not None:
            points += [(x, lane), (x_of(side, wire.number), lane)]
        points += [(points[-1][0], y), (zones[side], y)]
        return Route(wire, tuple(points))


def _room(part: Part) -> int:
    """Return the height that a part takes in its column, a multiple of STEP."""
    return _snap(_height_of(part) + PART_GAP + STEP - 1)


def _snap(y: int) -> int:
    return y - y % STEP
