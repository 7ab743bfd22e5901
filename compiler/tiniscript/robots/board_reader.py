"""Turns `[board]` of a profile into a Board, and reports what the chip cannot do.

It knows which pins and timers are in use, and by which device. `boards` describes chips, and
`drivers` the parts connected to them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from tiniscript.base.kit import Device, Kit
from tiniscript.base.languages import languages
from tiniscript.robots.boards import BAUDS, CHIPS, Chip
from tiniscript.robots.driver import AT_STOP, PinKey, Setting
from tiniscript.robots.drivers import DRIVERS, drivers_for
from tiniscript.robots.ledc import FREQUENCIES, timers_of
from tiniscript.robots.profile import Board, Wiring
from tiniscript.robots.refusals import printable_value
from tiniscript.robots.toml_table import Table

LONGEST_RUN_SECONDS = 3600
DEFAULT_RUN_SECONDS = 600
NO_WIRING = Wiring("", {}, {})


class PinUse(NamedTuple):
    """A use of a pin: the path of the key, and the ability that it needs, one of `ABILITIES`.

    `shield` is the shield's name of the pin, if the shield decides the pin.
    """

    table: Table
    key: str
    pin: int
    ability: str
    shield: str = ""


class Pins:
    """The pins of a chip and their uses. Without a chip, nothing is checked."""

    def __init__(self, chip: Chip | None) -> None:
        self._chip = chip
        self._pin_uses: list[PinUse] = []

    def take_pin(
        self,
        table: Table,
        key: str,
        ability: str,
        is_optional: bool = False,
        is_motor: bool = False,
    ) -> int | None:
        """Return the number of the pin at `key`, or None if no usable pin is given."""
        given_pin = table.get(key, "" if is_optional else f"{key} = 5")
        if given_pin is None:
            return None
        if type(given_pin) not in (int, str):
            table.expect("pin", key, given_pin)
            return None
        chip = self._chip
        if chip is None:
            return None
        pin = chip.pin_number(given_pin)
        if pin is None:
            table.complain("no_such_pin", key, found=printable_value(given_pin), chip=chip.name)
            return None
        values = {"pin": chip.pin_name(pin), "chip": chip.name}
        earlier_use = next((pin_use for pin_use in self._pin_uses if pin_use.pin == pin), None)
        if pin in chip.link_pins:
            table.complain("pin_of_link", key, **values)
        elif ability == "count" and not chip.counting_pins:
            table.complain("no_discs", key, **values)
        elif not chip.has_ability(pin, ability):
            table.complain(
                "pin_cannot", key, need=ability, **values, choices=_choices(chip, ability)
            )
        elif is_motor and pin in chip.boot_pins:
            choices = _choices(chip, ability, excluded_pins=chip.boot_pins)
            table.complain("pin_at_boot", key, **values, choices=choices)
        elif key == "start_button" and pin == chip.reset_pin:
            choices = _choices(chip, ability, excluded_pins=chip.boot_pins)
            table.complain("pin_of_reset", key, **values, choices=choices)
        elif earlier_use is not None:
            table.complain(
                "pin_twice", key, **values, first=earlier_use.table.path_of(earlier_use.key)
            )
        else:
            self._pin_uses.append(PinUse(table, key, pin, ability))
        return pin

    def take_fixed(self, table: Table, key: str, pin_key: PinKey) -> int | None:
        """Return the number of a pin that a shield decides, or None if it is not usable.

        A complaint names `key`: the profile does not name the pin.
        """
        chip, pin = self._chip, pin_key.fixed_number
        if chip is None or pin is None:
            return None
        if chip.first_analog is None:  # the pins of this chip have other places
            if not any(code == "shield_of_uno" for code, _ in table.reasons):
                table.complain("shield_of_uno", key, chip=chip.name)
            return None
        earlier_use = next((pin_use for pin_use in self._pin_uses if pin_use.pin == pin), None)
        if earlier_use is not None:
            first_path = earlier_use.table.path_of(earlier_use.key)
            name = chip.pin_name(pin)
            table.complain("shield_pin_twice", key, pin=name, name=pin_key.name, first=first_path)
        else:
            self._pin_uses.append(PinUse(table, key, pin, pin_key.ability, pin_key.name))
        return pin

    def check_timers(self) -> None:
        """Complain about every PWM pin whose timer is used by servos or the buzzer."""
        if self._chip is None:
            return
        if self._chip.pwm_timers:
            return self._check_frequencies(self._chip)
        owners = {"servo": self._chip.servo_timer, "tone": self._chip.tone_timer}
        for ability, timer in owners.items():
            owner = next(
                (pin_use for pin_use in self._pin_uses if pin_use.ability == ability), None
            )
            if owner is None or timer is None:
                continue
            for pin_use in self._pin_uses:
                if pin_use.ability == "pwm" and self._chip.timer_of_pwm_pin[pin_use.pin] == timer:
                    pin_use.table.complain(
                        "shield_timer_twice" if pin_use.shield else "timer_twice",
                        pin_use.key,
                        pin=self._chip.pin_name(pin_use.pin),
                        timer=str(timer),
                        first=owner.table.path_of(owner.key),
                        name=pin_use.shield,
                        choices=_choices(self._chip, "pwm", frozenset(owners.values())),
                    )

    def _check_frequencies(self, chip: Chip) -> None:
        """Complain about the first PWM pin for which no timer is left."""
        pin_counts = dict.fromkeys(FREQUENCIES, 0)
        for pin_use in self._pin_uses:
            if pin_use.ability not in pin_counts:
                continue
            pin_counts[pin_use.ability] += 1
            if sum(map(timers_of, pin_counts.values())) > chip.pwm_timers:
                values = {"pin": chip.pin_name(pin_use.pin), "chip": chip.name}
                timers = str(chip.pwm_timers)
                pin_use.table.complain("timers_used_up", pin_use.key, **values, timers=timers)
                return


def _choices(
    chip: Chip, ability: str, excluded_timers: frozenset[int | None] = frozenset(),
    excluded_pins: frozenset[int] = frozenset(),
) -> str:  # fmt: skip
    """Return the pins that can do `ability`, except those of the timers in `excluded_timers`."""
    all_pins = sorted((chip.digital_pins | chip.reading_pins | chip.analog_pins) - excluded_pins)
    fitting_pins = [
        pin
        for pin in all_pins
        if chip.has_ability(pin, ability)
        and chip.timer_of_pwm_pin.get(pin, -1) not in excluded_timers
    ]
    return ", ".join(chip.pin_name(pin) for pin in fitting_pins)


def read_board(table: Table, kit: Kit) -> Board:
    """Return the board of a kit. Complaints are added to those of `table`."""
    chip = CHIPS.get(table.choice("chip", tuple(CHIPS)))
    pins = Pins(chip)
    most_bytes = chip.program_bytes if chip else 0
    program_bytes = most_bytes
    if table.check_for("program_bytes") and chip:
        program_bytes = table.whole_number("program_bytes", 1, most_bytes)
    baud = table.whole_number("baud", BAUDS[0], BAUDS[-1], "baud = 9600")
    if baud and baud not in BAUDS:
        bauds_text = ", ".join(map(str, BAUDS))
        table.complain("not_one_of", "baud", found=str(baud), choices=bauds_text)
    max_run = table.whole_number(
        "max_run_seconds", 1, LONGEST_RUN_SECONDS, default=DEFAULT_RUN_SECONDS
    )
    start_button = pins.take_pin(table, "start_button", "pull_up")
    buzzer = pins.take_pin(table, "buzzer", "tone", is_optional=True)
    status_led = pins.take_pin(table, "status_led", "output", is_optional=True)
    bluetooth_state = pins.take_pin(table, "bluetooth_state", "input", is_optional=True)
    language = table.choice("language", languages()) if table.check_for("language") else ""
    motors = _read_wiring(table.table("motors", "[board.motors]"), "motors", pins)
    discs = None
    if table.check_for("discs"):
        discs = _read_wiring(table.table("discs"), "discs", pins)
    sensors = _read_devices(table, "sensors", kit.sensors, pins)
    actuators = _read_devices(table, "actuators", kit.actuators, pins)
    table.finish()
    pins.check_timers()
    return Board(
        chip=chip.name if chip else "",
        program_bytes=program_bytes,
        baud=baud,
        max_run_seconds=max_run,
        motors=motors,
        sensors=sensors,
        actuators=actuators,
        start_button=start_button or 0,
        buzzer=buzzer,
        status_led=status_led,
        bluetooth_state=bluetooth_state,
        language=language,
        discs=discs,
    )


def device_tables(table: Table, key: str, devices: Sequence[Device]) -> dict[str, Table]:
    """Return the table `[key.NAME]` of each device that has one. The case of NAME is ignored."""
    group = table.table(key)
    device_names = tuple(device.name for device in devices if device.name)
    table_by_name: dict[str, Table] = {}
    for key_name in group.key_names():
        name = key_name.upper()
        if name not in device_names:
            group.complain_not_in_kit(key_name, device_names)
        elif name in table_by_name:
            group.complain("name_twice", key_name, found=name)
        else:
            table_by_name[name] = group.table(key_name)
    return table_by_name


def _read_devices(
    table: Table, key: str, devices: Sequence[Device], pins: Pins
) -> tuple[Wiring, ...]:
    tables = device_tables(table, key, devices)
    wirings = []
    for device in devices:
        device_table = tables.get(device.name)
        if device_table is not None:
            wirings.append(_read_wiring(device_table, f"{key} {device.kind}", pins))
        elif device.name:
            path = f"{key}.{device.name}"
            table.complain("missing", path, example=f"[{table.path}.{path}]")
    return tuple(wirings)


def _read_wiring(table: Table, used_by: str, pins: Pins) -> Wiring:
    """Return the wiring of one device. A device of unknown kind fits no driver."""
    driver_names = drivers_for(used_by)
    if not driver_names:
        return NO_WIRING
    name = table.choice("driver", driver_names)
    if not name:
        return NO_WIRING
    driver = DRIVERS[used_by, name]
    known_keys = {setting.key for setting in driver.settings}
    is_actuator = used_by.startswith("actuators")
    if is_actuator and AT_STOP not in known_keys and AT_STOP in table.key_names():
        table.check_for(AT_STOP)  # counted as known: one complaint is enough
        table.complain("at_stop_of_no_servo", AT_STOP)
    settings = {setting.key: _read_setting(table, setting) for setting in driver.settings}
    pin_of_key = {}
    for pin_key in driver.pins:
        key, ability, is_optional, fixed_number, _ = pin_key
        if fixed_number is not None:
            choosing_key = driver.choosing_key(key, settings)
            pin = pins.take_fixed(table, choosing_key, pin_key) if choosing_key else None
        else:
            has_pull_up = ability == "input" and settings.get("pull_up")
            ability = "pull_up" if has_pull_up else ability
            pin = pins.take_pin(table, key, ability, is_optional, is_motor=used_by == "motors")
        if pin is not None:
            pin_of_key[key] = pin
    table.finish()
    return Wiring(name, pin_of_key, settings)


def _read_setting(table: Table, setting: Setting) -> int:
    key, kind, default, low, high, _ = setting
    if kind == "choice":
        text = table.choice(key, setting.words) if table.check_for(key) else ""
        return setting.words.index(text) if text else default
    if kind == "yes/no":
        return int(table.yes_no(key, bool(default)))
    read_number = table.number if kind == "number" else table.whole_number
    return read_number(key, low, high, default=default)
