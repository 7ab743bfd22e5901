"""`tsc run`: prints the trace of a simulated robot, or plays a recorded run again."""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Iterator

from tiniscript.base.kit import Device
from tiniscript.base.trace import Ending, Event
from tiniscript.bytecode.image import Image
from tiniscript.cli import images, inputs
from tiniscript.cli.errors import CommandError, missing_package_error
from tiniscript.cli.faults import fault_text
from tiniscript.cli.options import sensor_lists, thousandths, whole_number
from tiniscript.cli.paths import is_recording
from tiniscript.cli.texts import say_aside
from tiniscript.library.runs import cpp_machine, iter_actions
from tiniscript.robots.profile import Robot
from tiniscript.vm.runner import MAX_STEPS, MachineOf

LONGEST_MS = 10**12  # milliseconds


def run(options: Namespace, language: str) -> int:
    program_input = inputs.program(options)
    if is_recording(program_input.data):
        from tiniscript.cli.robot.recorded_run import play

        return play(program_input, options, language)
    if options.record is not None:
        from tiniscript.cli.robot.recorded_run import record

        return record(program_input, options, language)
    if options.world is not None:
        raise CommandError(2, "world_alone")
    max_ms = thousandths("--max-time", options.max_time, 60_000, 0, LONGEST_MS, language)
    pace = thousandths("--pace", options.pace, 1000, 0, 10**9, language)
    max_steps = whole_number("--max-steps", options.max_steps, MAX_STEPS, 0, 10**15, language)
    seed = whole_number("--seed", options.seed, 1, 1, 2**32 - 1, language)
    robot = inputs.robot_for(program_input, options, language)
    reading_lists = sensor_lists(options.sensor, robot, language)
    ready_program = images.ready_program(program_input, robot, language)
    if ready_program is None:
        return 1
    machine_of = _cpp_machine(ready_program.image, robot) if options.machine == "cpp" else None
    actions = iter_actions(
        ready_program.image, robot, reading_lists, max_ms, max_steps, seed, machine_of
    )
    read_sensors: set[int] = set()
    events = _recording_reads(actions, read_sensors)
    if options.show and sys.stderr.isatty():
        from tiniscript.cli.terminal.run_drawing import watch

        ending = watch(events, robot, pace / 1000, language)
    else:
        ending = _print(events)
    sys.stdout.flush()
    for sensor in sorted(read_sensors.difference(reading_lists)):
        device = robot.kit.readings[sensor]
        values = {"sensor": device.name, "zero": device.text(0), "readings": _readings(device)}
        say_aside("read_nothing", language, **values)
    if ending.kind != "FAULT":
        return 0
    text = fault_text(
        ending.fault, ending.offset, ready_program.program_map, program_input.is_image, language
    )
    print(text, file=sys.stderr)
    return 1


def _cpp_machine(image: Image, robot: Robot) -> MachineOf:
    """Return the C++ machine with a verified image."""
    try:
        return cpp_machine(image, robot)
    except (ImportError, OSError, RuntimeError) as error:  # missing, or not for this computer
        raise missing_package_error("no_wasmtime", error) from None


def _recording_reads(
    events: Iterator[Event | Ending], read_sensors: set[int]
) -> Iterator[Event | Ending]:
    """Yield the events of a run, and note the numbers of the sensors that it reads."""
    for event in events:
        if isinstance(event, Event) and event.kind == "READ":
            read_sensors.add(event.values[0])
        yield event


def _readings(device: Device) -> str:
    """Return two readings of a sensor, for an example."""
    if device.is_yes_no:
        return "FALSE,TRUE"
    values = (max(device.low, device.high // divisor) for divisor in (8, 44))
    return ",".join(device.text(value // 1000 * 1000 or value // 100 * 100) for value in values)


def _print(events: Iterator[Event | Ending]) -> Ending:
    write = sys.stdout.write
    for event in events:
        if isinstance(event, Ending):
            return event
        write(f"{event}\n")
    raise AssertionError("a run without an ending")
