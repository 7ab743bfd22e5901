"""Runs a program without a robot, and returns its actions as data."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Literal, NamedTuple

from tiniscript.base.fixed_point import value_of
from tiniscript.base.kit import Device, Kit
from tiniscript.base.source import printable
from tiniscript.base.trace import Ending, Event, Senses
from tiniscript.bytecode.image import Image, ImageRefused, pack
from tiniscript.bytecode.verify import Refused
from tiniscript.library.errors import UsageError, sentence
from tiniscript.library.programs import Language, Program, program_of
from tiniscript.library.source_map import SourceMap
from tiniscript.robots.profile import Robot
from tiniscript.vm.runner import MAX_STEPS, MachineOf
from tiniscript.vm.runner import run as run_code
from tiniscript.vm.tasks import machine_of as python_machine

Value = float | bool | str  # an int where a number has no decimals
Readings = Mapping[str, "float | bool | Sequence[float | bool]"]

LONGEST_RUN_S = 10**9
MAX_STEPS_LIMIT = 10**15
LARGEST_SEED = 2**32 - 1


class TraceEvent(NamedTuple):
    """An action of a robot, `ms` milliseconds after the start. `str()` is the line of `tsc run`.

    name      values
    MOTORS    left, right: percent, -100 to 100
    READ      sensor: its name; value
    BEEP      hertz, ms
    SHOW      value
    SET       actuator: its name; value
    DONE, FAULT, LIMIT      none: the last event
    """

    ms: int
    name: str
    values: Mapping[str, Value]
    text: str

    def __str__(self) -> str:
        return f"{self.ms} {self.text}"


class Fault(NamedTuple):
    """A fault of a program: its name, the offset in the code, and the line and column in the text
    from 1, or None if the text is unknown."""

    name: str
    offset: int
    line: int | None
    column: int | None


class Trace(NamedTuple):
    """A whole run. `ending` is DONE, FAULT or LIMIT (cut off by a limit); `ms` is its length by the
    robot's clock, `steps` the number of instructions."""

    events: tuple[TraceEvent, ...]
    ending: Literal["DONE", "FAULT", "LIMIT"]
    fault: Fault | None
    ms: int
    steps: int

    def __str__(self) -> str:
        return "".join(f"{event}\n" for event in self.events)


def run(
    program: Program | str | bytes | os.PathLike[str],
    robot: str | os.PathLike[str] | None = None,
    *,
    sensors: Readings | None = None,
    max_time: float = 60,
    max_steps: int = MAX_STEPS,
    seed: int = 1,
    machine: Literal["python", "cpp"] = "python",
    language: Language = "en",
) -> Trace:
    """Run a program (from `compile`, a text, an image, or the Path of a file) with a simulated
    clock, without waiting.

    `sensors` has readings by sensor name: each READ takes the next one, and the last one repeats;
    the default is 0 or False. `max_time` is in simulated seconds, `max_steps` in instructions while
    no time passes, `seed` is that of RANDOM. Raises ProgramError for mistakes, UsageError for wrong
    arguments. A fault raises no exception: `ending` reports it.
    """
    ready_program = program_of(program, robot, language)
    profile, image = ready_program._profile, ready_program._image
    max_ms = round(checked_number("max_time", max_time, 0, LONGEST_RUN_S, language) * 1000)
    check_whole_number("max_steps", max_steps, 0, MAX_STEPS_LIMIT, language)
    check_whole_number("seed", seed, 1, LARGEST_SEED, language)
    reading_lists = thousandths(sensors or {}, profile, language)
    if machine not in ("python", "cpp"):
        raise UsageError("bad_choice", language, {"found": printable(repr(machine))})
    machine_of: MachineOf | None = None
    if machine == "cpp":
        try:
            machine_of = cpp_machine(image, profile)
        except (ImportError, OSError, RuntimeError) as error:
            from tiniscript.library import install_advice

            install_command = install_advice.command(install_advice.VIRTUAL)
            raise UsageError(
                "no_wasmtime", language, {"why": str(error), "how": install_command}
            ) from None
    return _collect_trace(
        iter_actions(image, profile, reading_lists, max_ms, max_steps, seed, machine_of),
        profile.kit,
        ready_program._map,
    )


def iter_actions(
    image: Image,
    robot: Robot,
    reading_lists: Mapping[int, Sequence[int]],
    max_ms: int,
    max_steps: int,
    seed: int,
    machine_of: MachineOf | None = None,
) -> Iterator[Event | Ending]:
    """Yield the actions of a robot with a verified image. Readings are in thousandths."""
    senses = Senses(robot.kit, reading_lists)
    return run_code(
        image.code, robot.kit, senses, max_ms, max_steps, seed, machine_of or python_machine
    )


def cpp_machine(image: Image, robot: Robot) -> MachineOf:
    """Return the C++ machine with a verified image; its own verifier must accept the image, too.

    Raises ImportError, OSError or RuntimeError if wasmtime is missing or not for this computer.
    """
    from tiniscript.vm.wasm import WasmImage

    kit = robot.kit
    data = pack(image.start, image.devices, image.code, image.later_fields, image.needs)
    try:
        return WasmImage(data, kit).machine
    except (ImageRefused, Refused) as error:
        raise AssertionError(f"the C++ machine refuses what Python accepts: {error}") from None


def thousandths(sensors: Readings, robot: Robot, language: Language) -> dict[int, list[int]]:
    """Return readings in thousandths, by sensor number. Raises UsageError."""
    devices = robot.kit.readings
    number_by_name = {device.name: number for number, device in enumerate(devices) if device.name}
    reading_lists: dict[int, list[int]] = {}
    for name, readings in sensors.items():
        number = number_by_name.get(str(name).upper())
        if number is None:
            sensors_text = ", ".join(sensor.name for sensor in robot.kit.sensors) or sentence(
                "no_sensors", language, {}
            )
            values = {"robot": robot.name, "found": printable(str(name), 60), "known": sensors_text}
            raise UsageError("no_sensor", language, values)
        reading_list = readings if isinstance(readings, Iterable) else [readings]
        reading_values = [] if isinstance(reading_list, str | bytes) else list(reading_list)
        if not reading_values:
            raise UsageError("bad_readings", language, {"name": devices[number].name})
        reading_lists[number] = [
            _convert_reading(devices[number], reading, language) for reading in reading_values
        ]
    return reading_lists


def fault_of(name: str, offset: int, program_map: SourceMap | None) -> Fault:
    """Return a fault with its place in the text, if that is known."""
    location = program_map.location_at(offset) if program_map is not None else None
    if location is None:
        return Fault(name, offset, None, None)
    return Fault(name, offset, location.line, location.column)


def _collect_trace(
    events: Iterator[Event | Ending], kit: Kit, program_map: SourceMap | None
) -> Trace:
    trace_events: list[TraceEvent] = []
    for event in events:
        if not isinstance(event, Ending):
            trace_events.append(_trace_event(event, kit))
            continue
        fault = fault_of(event.fault, event.offset, program_map) if event.kind == "FAULT" else None
        return Trace(tuple(trace_events), event.kind, fault, trace_events[-1].ms, event.steps)  # type: ignore[arg-type]
    raise AssertionError("a run without an ending")


def _trace_event(event: Event, kit: Kit) -> TraceEvent:
    event_values = event.values
    values: dict[str, Value] = {}
    if event.kind == "MOTORS":
        values = {"left": event_values[0], "right": event_values[1]}
    elif event.kind == "BEEP":
        values = {"hertz": event_values[0], "ms": event_values[1]}
    elif event.kind == "SHOW":
        is_yes_no = event.text.endswith(("TRUE", "FALSE"))
        values = {"value": value_of(event_values[0], is_yes_no)}
    elif event.kind in ("READ", "SET"):
        device_kind, devices = {
            "READ": ("sensor", kit.readings),
            "SET": ("actuator", kit.actuators),
        }[event.kind]
        device = devices[event_values[0]]
        values = {device_kind: device.name, "value": value_of(event_values[1], device.is_yes_no)}
    return TraceEvent(event.time_ms, event.kind, values, event.text)


def _convert_reading(device: Device, reading: object, language: Language) -> int:
    value: int | None = None
    if device.is_yes_no:
        value = int(reading) if reading in (0, 1) and isinstance(reading, int | float) else None
    elif isinstance(reading, int | float) and not isinstance(reading, bool) and abs(reading) < 1e9:
        value = round(reading * 1000)
    if value is None or not device.low <= value <= device.high:
        low, high = device.text(device.low), device.text(device.high)
        key = "range_yes_no" if device.is_yes_no else "range"
        range_text = sentence(key, language, {"low": low, "high": high})
        values = {
            "found": printable(repr(reading), 60),
            "name": device.name,
            "range": range_text,
        }
        raise UsageError("bad_reading", language, values)
    return value


def checked_number(name: str, number: object, low: float, high: float, language: Language) -> float:
    """Return an argument that must be a number in a range. Raises UsageError."""
    if isinstance(number, int | float) and not isinstance(number, bool) and low <= number <= high:
        return number
    raise _bad_number(name, number, low, high, language)


def check_whole_number(name: str, number: object, low: int, high: int, language: Language) -> None:
    """Check an argument that must be a whole number in a range. Raises UsageError."""
    if isinstance(number, float):
        raise _bad_number(name, number, low, high, language)
    checked_number(name, number, low, high, language)


def _bad_number(
    name: str, number: object, low: float, high: float, language: Language
) -> UsageError:
    range_text = sentence("range", language, {"low": str(low), "high": str(high)})
    values = {"name": name, "found": printable(repr(number), 60), "range": range_text}
    return UsageError("bad_number", language, values)
