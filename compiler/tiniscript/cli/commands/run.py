"""`tsc run`: prints the trace of a simulated robot, or compares a robot with the virtual one."""

from __future__ import annotations

import sys
from argparse import Namespace
from typing import TYPE_CHECKING

from tiniscript.cli import images, inputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.options import decimal, whole_number
from tiniscript.cli.texts.common import text

if TYPE_CHECKING:
    from tiniscript.bytecode.image import Image
    from tiniscript.codegen.source_map import Map
    from tiniscript.kit import Device
    from tiniscript.robots.profile import Robot
    from tiniscript.vm.trace import Ending, MachineOf

LONGEST = 10**9  # seconds
STEPS = 10_000_000


def run(options: Namespace, language: str) -> int:
    if options.replay is not None:
        from tiniscript.cli.robot.replay import replay

        return replay(options, language)
    max_ms = _decimal("--max-time", options.max_time, 60_000, LONGEST, language)
    pace = _decimal("--pace", options.pace, 1000, 1_000_000, language)
    max_steps = whole_number("--max-steps", options.max_steps, STEPS, 0, 10**15, language)
    seed = whole_number("--seed", options.seed, 1, 1, 2**32 - 1, language)
    given = inputs.program(options)
    robot = inputs.robot(options, language)
    if options.world is not None:
        raise CommandError(2, "world_without_replay")
    lists = sensor_lists(options.sensor, robot, language)
    ready = images.ready(given, robot, language)
    if ready is None:
        return 1
    machine_of = _cpp_machine(ready.image, robot) if options.machine == "cpp" else None
    from tiniscript.library.runs import begun

    events = begun(ready.image, robot, lists, max_ms, max_steps, seed, machine_of)
    if options.show and sys.stderr.isatty():
        from tiniscript.cli.terminal.run_drawing import watch

        ending = watch(events, robot, pace / 1000, language)
    else:
        ending = _print(events)
    if ending.what != "FAULT":
        return 0
    sys.stdout.flush()
    said = fault_text(ending.fault, ending.offset, ready.places, given.is_image, language)
    print(said, file=sys.stderr)
    return 1


def _cpp_machine(image: Image, robot: Robot) -> MachineOf:
    """Return the C++ machine with a verified image."""
    from tiniscript.library.runs import cpp_machine

    try:
        return cpp_machine(image, robot)
    except (ImportError, OSError, RuntimeError) as why:  # missing, or not for this computer
        from tiniscript.library import install_advice

        how = install_advice.command(install_advice.VIRTUAL)
        raise CommandError(2, "no_wasmtime", why=str(why), how=how) from None


def _print(events: object) -> Ending:
    from collections.abc import Iterator
    from typing import cast

    from tiniscript.vm.trace import Ending, Event

    write = sys.stdout.write
    for event in cast("Iterator[Event | Ending]", events):
        if isinstance(event, Ending):
            return event
        write(f"{event}\n")
    raise AssertionError("a run without an ending")


def fault_text(fault: str, offset: int, places: Map | None, is_image: bool, language: str) -> str:
    """Return the meaning of a fault, and its line in the text.

    For an image this is the text that was last compiled to it; its name is added.
    """
    place = places.at(offset) if places is not None else None
    if places is None or place is None:
        where = text("fault_no_line", language).format(offset=f"{offset:04x}")
    else:
        line = places.line(place.line)
        end = place.end_column - 1 if place.end_line == place.line else len(line)
        shown = line[place.column - 1 : end] if len(line) > 100 else line.strip()
        shown = shown.replace("\t", " ")
        key = "fault_line_of" if is_image else "fault_line"
        name = inputs.shown(places.name)
        where = text(key, language).format(name=name, line=place.line, shown=shown[:100])
    what = text(f"fault_{fault}", language)
    return text("fault_at", language).format(fault=fault, what=what, place=where)


def _decimal(option: str, found: str | None, default: int, highest: int, language: str) -> int:
    """Return an option's number in thousandths, from 0 to `highest` units."""
    if found is None:
        return default
    value = decimal(found)
    if value is None or not 0 <= value <= highest * 1000:
        allowed = text("range_number", language).format(low=0, high=highest)
        raise CommandError(2, "bad_number", option=option, range=allowed, found=found)
    return value


def sensor_lists(texts: list[str], robot: Robot, language: str) -> dict[int, list[int]]:
    """Return the readings that `--sensor NAME=1,2,3` say, by the sensor's number."""
    sensors = robot.kit.sensors
    names = [device.name for device in sensors]
    lists: dict[int, list[int]] = {}
    for each in texts:
        name, equals, values = each.partition("=")
        name = name.strip().upper()
        if name not in names:
            from tiniscript.words import nearest

            known = ", ".join(names) or text("no_sensors", language)
            raise CommandError(2, "no_sensor", robot=robot.name, found=name or each, known=known,
                          near=nearest(name, names) or "")  # fmt: skip
        number = names.index(name)
        device = sensors[number]
        if not equals or not values.strip():
            example = f"{name}={device.text(device.low)},{device.text(device.high)}"
            raise CommandError(2, "sensor_form", example=example)
        if number in lists:
            raise CommandError(2, "sensor_twice", name=name)
        lists[number] = [_reading(device, value.strip(), language) for value in values.split(",")]
    return lists


def _reading(device: Device, found: str, language: str) -> int:
    if device.is_yes_no:
        value = {"TRUE": 1, "FALSE": 0, "1": 1, "0": 0}.get(found.upper())
        allowed = text("range_yes_no", language)
    else:
        value = decimal(found)
        low, high = device.text(device.low), device.text(device.high)
        allowed = text("range_number", language).format(low=low, high=high)
    if value is None or not device.low <= value <= device.high:
        raise CommandError(2, "sensor_value", found=found or "''", name=device.name, range=allowed)
    return value
