"""The text next to a drawing: parts list, tables, warnings and checks.

Knows a plan, and which sentences apply to it. Text in a block is plain except for **bold** in
sentences of `texts`; the code that writes it escapes it.
"""

from __future__ import annotations

from typing import NamedTuple

from tiniscript.robots.driver import BOARD_3V3, BOARD_5V, FIVE_VOLTS, GROUND, PULL_DOWN
from tiniscript.robots.wiring.headers import SIDES
from tiniscript.robots.wiring.parts import BOARD_RAILS
from tiniscript.robots.wiring.plan import LAMP_PIN, End, Part, Plan
from tiniscript.robots.wiring.texts import text


class Block(NamedTuple):
    """A piece of a page. `kind` is one of KINDS; the first row of `ticks` is its head.

    `ticks` is a table with a box to tick in each row.
    """

    kind: str
    text: str = ""
    rows: tuple[tuple[str, ...], ...] = ()


SPARE_WIRES = 10  # jumper wires that break, or that a second rail wants
KINDS = ("title", "heading", "paragraph", "drawing", "finished", "list", "checks", "ticks")


def page_of(plan: Plan) -> list[Block]:
    """Return the blocks of a page, from its title to its last line."""
    return _Page(plan).blocks()


def wire_rows(plan: Plan) -> list[tuple[str, ...]]:
    """Return the table of the wires, its head first: wire, pin, part, terminal, on the way."""
    language = plan.language
    heads = ("head_wire", "head_pin", "head_part", "head_terminal", "head_through")
    rows = [tuple(text(head, language) for head in heads)]
    for part in plan.parts:
        for end in part.ends:
            if end.wire:
                colour = text(f"colour_{end.wire.colour}", language)
                name = f"{end.wire.number} {colour}"
                rows.append(
                    (name, end.wire.pin_name, part.title, end.name, _route_text(end, language))
                )
    if plan.has_lamp:
        lamp_title = text("part_lamp", language)
        on_board = text("on_board", language)
        rows.append(("–", str(LAMP_PIN), lamp_title, text("lamp_on_board", language), on_board))
    return rows


def rail_rows(plan: Plan) -> list[tuple[str, ...]]:
    """Return a row for each wire that joins power or GND, its head first: tag, colour, end."""
    language = plan.language
    rows = [tuple(text(key, language) for key in ("head_tag", "head_colour", "head_joined"))]
    for rail in plan.rails:
        colour = text("colour_black" if rail == GROUND else "colour_red", language)
        ends = []
        if rail in BOARD_RAILS:
            ends.append(text("the_board", language).format(pin=rail))
        for part in plan.parts:
            ends += [
                f"{part.title}: {end.name}"
                for end in part.ends
                if end.rail == rail or (end.name == rail and end.wire)
            ]
        rows += [(rail, colour, end_text) for end_text in ends]
    return rows


def _route_text(end: End, language: str) -> str:
    ground_key = "to_ground_pin" if end.far_resistor else "to_ground"
    pairs = (
        ("series", end.series_resistor),
        ("beyond", end.far_resistor),
        (ground_key, end.ground_resistor),
    )
    return "; ".join(text(key, language).format(value=value) for key, value in pairs if value)


class _Page:
    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.language = plan.language
        self.board_name = SIDES[plan.chip.name].name

    def text(self, key: str, **values: object) -> str:
        return text(key, self.language).format(**values)

    def blocks(self) -> list[Block]:
        say = self.text
        return [
            Block("title", say("title", robot=self.plan.robot)),
            Block("paragraph", say("intro", board=self.board_name)),
            Block("drawing", say("drawing")),
            Block("heading", say("finished", robot=self.plan.robot)),
            Block("finished", say("finished_drawing")),
            Block("heading", say("need")),
            Block("list", rows=_column(self._shopping_list())),
            Block("heading", say("wires")),
            Block("paragraph", say("wires_intro")),
            Block("ticks", rows=tuple(wire_rows(self.plan))),
            Block("heading", say("rails")),
            Block("paragraph", say("rails_intro")),
            Block("ticks", rows=tuple(rail_rows(self.plan))),
            *(Block("paragraph", sentence) for sentence in self._list_unconnected()),
            Block("list", rows=_column(self._power_lines())),
            Block("heading", say("mind")),
            Block("list", rows=_column(self._warnings())),
            Block("heading", say("bluetooth" if self.plan.has_radio else "usb")),
            Block("list", rows=_column(self._connection_rows())),
            Block("heading", say("check")),
            Block("checks", rows=_column(self._checks())),
            Block("paragraph", say("made_by", robot=self.plan.robot)),
        ]

    def _shopping_list(self) -> list[str]:
        parts_by_need: dict[str, list[Part]] = {}
        for part in self.plan.parts:
            if part.shape.need_key:
                parts_by_need.setdefault(part.shape.need_key, []).append(part)
        need_texts = [self.text("need_board", board=self.board_name)]
        for key, parts in parts_by_need.items():
            need_text = f"{len(parts)} × {self.text(key)}"
            if any(part.is_device for part in parts):
                need_text = self.text(
                    "for_part", need=need_text, parts=", ".join(p.title for p in parts)
                )
            need_texts.append(need_text)
        values = ", ".join(f"{count} × {value}" for value, count in self.plan.resistors.items())
        need_texts.append(self.text("need_resistors", values=values))
        join_count = len(self.plan.wires) + len(rail_rows(self.plan)) - 1
        need_texts.append(self.text("need_breadboard", count=join_count + SPARE_WIRES))
        body = self.plan.body
        size = f"{body.length_cm:g} × {body.width_cm:g} cm"
        need_texts += [self.text("need_plate", size=size), self.text("need_power_bank")]
        return need_texts

    def _list_unconnected(self) -> list[str]:
        """Return the parts without a pin or a rail: motors, and free terminals."""
        sentences = []
        motors = self.plan.parts[0].shape.motor_terminals
        if motors:
            ends = [
                self.text("motors_join", motor=self.text(key), terminals=terminals)
                for key, terminals in zip(("left_motor", "right_motor"), motors, strict=True)
            ]
            sentences.append(self.text("motor_wires", ends=", ".join(ends)))
        free_pins = [
            f"{part.title} {end.name}"
            for part in self.plan.parts
            for end in part.ends
            if not end.wire and not end.rail
        ]
        if free_pins:
            sentences.append(self.text("free", ends=", ".join(free_pins)))
        return sentences

    def _power_lines(self) -> list[str]:
        sentences = [
            self.text("power_own"),
            self.text("power_common"),
            self.text("power_not_5v" if self.plan.has_radio else "power_not_3v3"),
        ]
        shapes = [part.shape for part in self.plan.parts if part.shape.power_key]
        sentences += [self.text(shape.power_key, model=shape.model) for shape in shapes]
        return sentences

    def _pull_downs(self) -> str:
        ends = self.plan.parts[0].ends
        return ", ".join(end.name for end in ends if end.ground_resistor == PULL_DOWN)

    def _warnings(self) -> list[str]:
        sentences = []
        if self._pull_downs():
            sentences.append(self.text("mind_floating", ends=self._pull_downs()))
        is_5v = self.plan.chip.pin_volts == FIVE_VOLTS
        board_values = (
            {"rail": BOARD_5V, "volts": "5"} if is_5v else {"rail": BOARD_3V3, "volts": "3.3"}
        )
        for part in self.plan.parts:
            for key in part.shape.note_keys:
                sentence = self.text(key, part=part.title, **board_values)
                if sentence not in sentences:
                    sentences.append(sentence)
        return sentences

    def _connection_rows(self) -> list[str]:
        if not self.plan.has_radio:
            return [self.text("usb_link", baud=self.plan.baud), self.text("usb_reset")]
        speed = "bluetooth_speed" if self.plan.baud == 9600 else "bluetooth_other_speed"
        state = "bluetooth_state" if self.plan.has_state else "bluetooth_no_state"
        return [
            self.text("bluetooth_flash"),
            self.text("bluetooth_divider"),
            self.text(speed, baud=self.plan.baud),
            self.text(state),
        ]

    def _checks(self) -> list[str]:
        grounded_titles = ", ".join(part.title for part in self.plan.parts if _is_grounded(part))
        sentences = [
            self.text("check_wheels"),
            self.text("check_polarity"),
            self.text("check_ground", parts=grounded_titles),
            self.text("check_5v" if self.plan.has_radio else "check_3v3"),
        ]
        if self._pull_downs():
            sentences.append(self.text("check_pull_downs", ends=self._pull_downs()))
        sentences += [self.text(key) for part in self.plan.parts for key in part.shape.check_keys]
        keys: tuple[str, ...] = ("check_bare",)
        if self.plan.has_radio:
            keys = ("check_divider", "check_bare", "check_unplugged")
        elif any(end.series_resistor == "1 kΩ" for part in self.plan.parts for end in part.ends):
            keys = ("check_echo", "check_bare")
        sentences += [self.text(key) for key in keys]
        return [*sentences, self.text("check_hot"), self.text("check_way")]


def _is_grounded(part: Part) -> bool:
    return any(end.rail == GROUND or end.ground_resistor for end in part.ends)


def _column(lines: list[str]) -> tuple[tuple[str, ...], ...]:
    return tuple((line,) for line in lines)
