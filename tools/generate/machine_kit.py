"""Makes `conformance/machine.json`: the requirements of a machine in any language.

Knows the form of the file, which `docs/develop/conformance.md` describes, and where its cases come
from: the case files, images that are damaged on purpose, the edges of numbers, and random programs.
The expected results are those of the machine in Python; the tests compare it with the others and
with the oracles. It needs only the package and the sources of the tests, not the tools that run
them.
"""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import chain, product, repeat
from typing import NamedTuple

from tests.machines import Senses
from tests.machines.pace import ECHO_SENSORS, Pace, random_pace
from tests.machines.python import lists_of
from tests.oracle import programs
from tests.oracle.task_programs import rival_program, task_program
from tests.support.case_runs import compile_case, robot_and_senses
from tests.support.casefile import ROOT, Case, read
from tests.support.images import image_for
from tests.support.kits import KITS
from tests.support.random_programs import random_program
from tiniscript import compile_text, robots
from tiniscript.base.kit import MAX_DEVICES, NUMBER, YES_NO, Device, Kit
from tiniscript.base.trace import TracedRobot
from tiniscript.bytecode.disassembly import assemble
from tiniscript.bytecode.image import GO, TASKS, Image, ImageRefused, pack, unpack, with_checksum
from tiniscript.bytecode.opcodes import BY_NAME, ESCAPE, ISA_MAJOR, ISA_MINOR, SHORTS, Op
from tiniscript.bytecode.verify import Refused, load_image
from tiniscript.conformance.kit import MACHINE_FORM, MACHINE_VERSION
from tiniscript.vm.machine import Machine
from tiniscript.vm.state import DONE, FAULT, RUNNING, Robot
from tiniscript.vm.tasks import machine_of

TINIBOT_KIT = robots.load("tinibot").kit
MAX_STEPS = (
    100_000  # a case that runs more without a wait says nothing about its end: it is left out,
)
MAX_CALLS = 1000  # most calls of a run, also at one time
RANDOM_PROGRAMS = range(1000, 1030)
TASK_PROGRAMS = range(1000, 1020)
TASK_RUN_MS = 600
WAY_PROGRAMS = range(1000, 1012)
Schedule = tuple[int, tuple[int, ...]]

# The start time of a run, and the number of calls of its machine: for the first wait, for the next,
# and the last for all further ones. The first schedule is that of `tsc run`.
USUAL_SCHEDULE: Schedule = (0, (1,))
WRAPPING_SCHEDULE: Schedule = (2**32 - 7, (1,))
SELDOM_SCHEDULE: Schedule = (2**31 - 30, (7,))
LATE_CALL_MS = 45  # between two calls
OFTEN_MS = (3, 7, 20)  # ms between two calls, for tasks: each has a clock of its own
ROUND_MS = 2**31 - 8  # a multiple of the 20 ms of UNTIL; twice this is 16 ms before 2^32
FAR_SENSES = Senses({"DISTANCE": [50_000]})
MAX_LONG = 2**31 - 1
EDGE_NUMBERS = (-MAX_LONG - 1, -1_500_500, -1, 0, 499, 1000, 2500, MAX_LONG)
CALCULATIONS = ("ADD", "SUB", "MUL", "DIV", "MOD", "NEG", "ABS", "MIN", "MAX", "ROUND", "RANDOM",
                "EQ", "NE", "LT", "LE", "GT", "GE", "NOT", "AND", "OR")  # fmt: skip
NO_OP_CODE = bytes([BY_NAME["SET_VAR8"].code, 0, 0])


class Run(NamedTuple):
    """The input of a machine. `readings` are thousandths by the sensor's name. A sensor in
    `slow_readings` is not ready in a range of each period. `text` is the compiled text, if any.
    """

    name: str
    kit: Kit
    image: bytes
    senses: Senses = Senses()
    schedule: Schedule = USUAL_SCHEDULE
    slow_readings: Mapping[str, tuple[int, int, int]] = {}
    text: str = ""

    def call_every(self, call_interval_ms: int) -> Run:
        name = f"{self.name} (called every {call_interval_ms} ms)"
        return self._replace(name=name, schedule=(0, (call_interval_ms,)))

    def at_pace(self, pace: Pace) -> Run:
        """Return this run at a pace, with some late readings."""
        slow_readings = dict.fromkeys(pace.slow, (pace.period_ms, pace.from_ms, pace.to_ms))
        interval_ms = pace.call_interval_ms
        name = f"{self.name} ({' and '.join(slow_readings)} late, called every {interval_ms} ms)"
        return self._replace(name=name, schedule=(0, (interval_ms,)), slow_readings=slow_readings)

    @property
    def needs(self) -> int:
        """Return the features that a machine may lack, and refuse the image for."""
        try:
            return unpack(self.image).needs
        except ImageRefused:
            return 0


def machine_kit(command: str) -> str:
    """Return the text of the file: a line for each case."""
    kits: list[Kit] = []
    rows = []
    for run in runs():
        answer = answer_of(run)
        if answer is None:
            continue
        if run.kit not in kits:
            kits.append(run.kit)
        rows.append(json.dumps(case_of(run, kits.index(run.kit), answer), ensure_ascii=False))
    head = {
        "form": MACHINE_FORM,
        "version": MACHINE_VERSION,
        "made_by": command,
        "isa": [ISA_MAJOR, ISA_MINOR],
        "kits": [[line.removesuffix("\n") for line in lines_of(kit)] for kit in kits],
    }
    start = json.dumps(head, ensure_ascii=False, indent=1).removesuffix("\n}")
    return f'{start},\n "cases": [\n' + ",\n".join(rows) + "\n ]\n}\n"


def runs() -> Iterator[Run]:
    """Return all that a machine is asked for, and some that never end."""
    makers = (
        documented_runs,
        time_runs,
        late_runs,
        device_runs,
        image_runs,
        needs_runs,
        arithmetic_runs,
    )
    for make_runs in (*makers, random_program_runs, task_program_runs, way_runs):
        yield from make_runs()


def lines_of(kit: Kit) -> list[str]:
    """Return the devices of a kit, and how fast it is if that is known."""
    speeds = ("speed", kit.speed), ("turn", kit.turn)
    return [*kit.device_lines(), *(f"{name} {value}" for name, value in speeds if value)]


def case_of(run: Run, kit: int, answer: list[str]) -> dict[str, object]:
    """Return a case as the file has it."""
    names = [device.name for device in run.kit.readings]
    start_ms, call_intervals_ms = run.schedule
    return {
        "name": run.name,
        "kit": kit,
        "image": run.image.hex(),
        "readings": _by_number(names, run.senses.readings),
        **({"slow": _by_number(names, run.slow_readings)} if run.slow_readings else {}),
        "seed": run.senses.seed,
        "begin": start_ms,
        "every": list(call_intervals_ms),
        "until": run.senses.max_ms,
        **({"needs": run.needs} if run.needs else {}),
        "answer": answer,
    }


def _by_number(names: list[str], rows: Mapping[str, Sequence[int]]) -> dict[str, list[int]]:
    return {str(names.index(name)): list(values) for name, values in rows.items()}


class SlowRobot(TracedRobot):
    """A robot whose slow sensors are not always ready."""

    def __init__(self, run: Run) -> None:
        super().__init__(run.kit, lists_of(run.kit, run.senses))
        self.slow_readings = run.slow_readings
        self.was_slow = False  # whether the current call was slow

    def read(self, sensor: int) -> int | None:
        period_ms, from_ms, to_ms = self.slow_readings.get(
            self.kit.readings[sensor].name, (1, 0, 0)
        )
        if from_ms <= self.now_ms % period_ms < to_ms:
            self.was_slow = True
            return None
        return super().read(sensor)


def answer_of(
    run: Run,
    load_image: Callable[[bytes, Kit], Image] = load_image,
    machine_of: Callable[[bytes, Robot, int, int, int], Machine] = machine_of,
) -> list[str] | None:
    """Return the answer of the machine in Python; None if no step takes time."""
    try:
        code = load_image(run.image, run.kit).code
    except Refused as error:
        return [f"REFUSED {error.name} {error.offset}"]
    except ImageRefused as error:
        return [f"REFUSED {error.name}"]
    start_ms, call_intervals_ms = run.schedule
    intervals_ms = chain(call_intervals_ms, repeat(call_intervals_ms[-1]))
    robot = SlowRobot(run)
    machine = machine_of(code, robot, len(run.kit.readings), run.senses.seed, start_ms)
    call_count = 0  # calls at the same time
    while call_count < MAX_CALLS:
        robot.was_slow = False
        status = machine.tick(start_ms + robot.now_ms, MAX_STEPS)
        if status == DONE:
            robot.record("DONE", (), "DONE")
        elif status == FAULT:
            robot.record("FAULT", (), f"FAULT {machine.fault}")
        elif status == RUNNING and not robot.was_slow:
            return None
        else:
            wake_ms = max(machine.wake_ms - start_ms, robot.now_ms + robot.was_slow)
            interval_ms = next(intervals_ms)
            wake_ms = -(-wake_ms // interval_ms) * interval_ms
            if wake_ms <= run.senses.max_ms:
                call_count = call_count + 1 if wake_ms == robot.now_ms else 0
                robot.now_ms = wake_ms
                continue
            robot.now_ms = run.senses.max_ms
            robot.record("LIMIT", (), "LIMIT")
        return [str(event) for event in robot.events]
    return None


# -- where cases come from ----------------------------------------------------------------------


def documented_runs() -> Iterator[Run]:
    """Yield the runs and refusals of the case files and the specification."""
    paths = [*sorted(ROOT.glob("tests/cases/*.md")), ROOT / "bytecode_spec.md"]
    for case in (case for path in paths for case in read(path)):
        if not case.parts.keys() & {"robot", "refused"} and not stands_alone(case):
            continue
        robot, senses = robot_and_senses(case)
        text = case.parts.get("tiniscript", "")
        run = Run(case.id, robot.kit, image_of(case, robot.kit), senses, text=text)
        yield run
        if "robot" not in case.parts or not takes_time(run):
            continue
        yield run._replace(name=f"{case.id} (time wraps around)", schedule=WRAPPING_SCHEDULE)
        yield run._replace(
            name=f"{case.id} (called every 7 ms, time wraps around)", schedule=SELDOM_SCHEDULE
        )
        yield run.call_every(LATE_CALL_MS)
        if run.needs & TASKS:
            yield from (run.call_every(interval_ms) for interval_ms in OFTEN_MS)
        if senses.readings:
            yield run.at_pace(Pace(7, tuple(senses.readings), 50, 0, 30))


def stands_alone(case: Case) -> bool:
    return "bytecode" in case.parts and "tiniscript" not in case.parts


def image_of(case: Case, kit: Kit) -> bytes:
    if stands_alone(case):
        return image_for(assemble(case.parts["bytecode"]), kit)
    return compile_case(case).image


def takes_time(run: Run) -> bool:
    answer = answer_of(run)
    return answer is not None and not answer[-1].startswith("0 ")


def time_runs() -> Iterator[Run]:
    """Return runs that are called late, by as much as a clock catches up or not, or after weeks."""
    late_senses = Senses({"DISTANCE": [50_000] * 6 + [9_000]}, 2**33)
    move_until = "F(0.1, 80) UNTIL(DISTANCE < 10)"
    for name, text, schedule, senses in (
        ("20 ms late", "W(0.001); F(0.1, 80)", (0, (21, 1)), Senses()),
        ("21 ms late", "W(0.001); F(0.1, 80)", (0, (22, 1)), Senses()),
        ("UNTIL begins 20 ms late", f"W(0.001); {move_until}", (0, (21, 1)), FAR_SENSES),
        ("UNTIL begins 21 ms late", f"W(0.001); {move_until}", (0, (22, 1)), FAR_SENSES),
        ("UNTIL is checked late", move_until, (0, (30, 61, 1)), FAR_SENSES),
        ("UNTIL past 2^32 ms", "F(FOREVER, 80) UNTIL(DISTANCE < 10); W(0.1)",
         (0, (ROUND_MS, ROUND_MS - 20, 90, 1)), late_senses),
        ("UNTIL past 2^32 ms, and now wraps", "W(FOREVER) UNTIL(DISTANCE < 10); W(0.1)",
         (2**31 + 5, (ROUND_MS, ROUND_MS, 1, 1, 27, 1)), late_senses),
        ("TIME is over for good", "W(FOREVER) UNTIL(DISTANCE < 10); SHOW(TIME)",
         (0, (ROUND_MS, ROUND_MS, 1)), late_senses),
    ):  # fmt: skip
        yield Run(f"time: {name}", TINIBOT_KIT, compile_image(text), senses, schedule, text=text)


def late_runs() -> Iterator[Run]:
    """Return runs whose readings come late, and the actions of each task meanwhile."""
    first_pace, echo_pace = Pace(1, ECHO_SENSORS, 1000, 0, 12), Pace(1, ECHO_SENSORS, 1000, 0, 30)
    rivals = "WHEN(LIGHT_R > 5);B(0.1, 50);END_WHEN;TASK;{};SHOW(TIME);END_TASK"
    looking_text = rivals.format("F(FOREVER, 40) UNTIL(DISTANCE < 10)")
    beginning_text = rivals.format(
        "W(0.13);M(20, 30);F(0.05, 40) UNTIL(LIGHT_L > 5 AND DISTANCE < 10)"
    )
    for name, text, pace in (
        ("the first turn of the main task waits", "N = DISTANCE;TASK;SHOW(N);END_TASK;SHOW(TIME)",
         first_pace),
        ("the others begin after that turn", "DISTANCE;TASK;W(0.015);SHOW(TIME);END_TASK",
         first_pace),
        ("the others do not wait",
         "WHEN(DISTANCE < 10);SHOW(1);END_WHEN;TASK;SHOW(2);W(0.005);SHOW(3);END_TASK", echo_pace),
        ("a look is over when the motors are taken", looking_text,
         Pace(1, ECHO_SENSORS, 1000, 100, 150)),
        ("a first look is, too", beginning_text, Pace(1, ECHO_SENSORS, 1000, 125, 150)),
        ("the UNTIL of a wait is looked at whoever has the motors",
         "TASK;W(0.01);B(0.1, 50);END_TASK;TASK;W(FOREVER) UNTIL(DISTANCE < 10);SHOW(TIME);"
         "END_TASK", echo_pace),
        ("a clock stays where it was",
         "TASK;LOOP(3);W(0.01);SHOW(DISTANCE);SHOW(TIME);END_LOOP;END_TASK",
         Pace(1, ECHO_SENSORS, 1000, 8, 25)),
        ("to wait for a reading is no wait",
         "TASK;LOOP(4);SHOW(DISTANCE);SHOW(TIME);END_LOOP;END_TASK", echo_pace),
        ("a move that is over does not wait for its look",
         "F(0.05, 60) UNTIL(DISTANCE < 3);SHOW(TIME);F(0.05, 60)",
         Pace(1, ECHO_SENSORS, 1000, 15, 47)),
        ("values stay on the stack", "SHOW(1 + MAX(DISTANCE, LIGHT_R) * 2);W(0.01);SHOW(TIME)",
         Pace(1, ("LIGHT_R",), 1000, 0, 7)),
    ):  # fmt: skip
        senses = Senses({"LIGHT_R": [9000, 0, 9000, 0], "DISTANCE": [5000]}, 300)
        run = Run(f"late: {name}", TINIBOT_KIT, compile_image(text), senses, text=text)
        yield from (
            run.at_pace(pace._replace(call_interval_ms=interval_ms))
            for interval_ms in (1, *OFTEN_MS)
        )


def device_runs() -> Iterator[Run]:
    """Return a run with as many devices as a kit may have, by each way to name one."""
    kinds = ((NUMBER, "cm", -1000, 400_000), (YES_NO, "", 0, 1))
    kit = Kit(
        tuple(Device(f"S{k}", *kinds[k % 3 == 1]) for k in range(MAX_DEVICES)),
        tuple(Device(f"A{k}", *kinds[k % 3 == 2]) for k in range(MAX_DEVICES)),
    )
    code = b""
    for sensor, actuator in chain(
        ((f" s{k}", f" a{MAX_DEVICES - 1 - k}") for k in range(MAX_DEVICES)),
        ((f"_{k}", f"_{k}") for k in range(SHORTS)),
    ):
        for name in (f"READ{sensor}", f"PUSH_SENSOR{sensor}", f"SET{actuator}"):
            code += assemble_bytes(name)
        code += assemble_bytes(f"PUSH_READ{sensor}") + assemble_bytes("SHOW")
    readings = {
        device.name: [0, 1, 1, 0] if device.is_yes_no else [1000 * k + count for count in range(4)]
        for k, device in enumerate(kit.sensors)
    }
    yield Run("devices: 32 of each", kit, image_for(code, kit), Senses(readings))


def assemble_bytes(text: str) -> bytes:
    """Return the bytes of an instruction that has a device, or nothing, as operand."""
    name, _, device = text.partition(" ")
    return bytes([BY_NAME[name].code, *([int(device[1:])] if device else [])])


def image_runs() -> Iterator[Run]:
    """Return images that are cut, longer, of other versions, and wrong in more ways than one."""
    good_image = compile_image("F(1, 80) UNTIL(DISTANCE < 10)")
    for name, image in {
        "whole": good_image,
        "a header that is longer": pack("SI", 0, bytes.fromhex("440150"), b"later"),
        "the longest header": pack("SI", 0, bytes.fromhex("440150"), bytes(range(240))),
        "no code": pack("SI", 0, b""),
        "the longest code": pack("SI", 0, NO_OP_CODE * 10922 + b"\x58"),
        "waits for a button": pack("SB", 0, bytes.fromhex("440150")),
        "only PING": pack("PING", 0, b""),
        "PING with code": pack("PING", 0, b"\x58"),
        "a start that is not known": change_byte(good_image, 4, 3),
        "something of needs": change_byte(good_image, 14, 4),
        "the last bit of needs": change_byte(good_image, 14, 128),
        "an older major version": change_byte(good_image, 2, 1),
        "a later major version": change_byte(good_image, 2, 3),
        "a later minor version": change_byte(good_image, 3, ISA_MINOR + 1),
        "another version, and nothing after it": b"TS\x01\x00",
        "another version, and no checksum": b"TS\x03" + good_image[3:10] + bytes(4)
        + good_image[14:],
        "a header of 14 bytes": change_byte(good_image, 5, 14),
        "a header of 0 bytes": change_byte(good_image, 5, 0),
        "more code than there may be": good_image[:8] + b"\x00\x80" + good_image[10:],
        "one byte more": good_image + b"\0",
        "one byte more, and a wrong checksum": good_image[:-1] + b"\0\0",
        "a letter of another kind": b"Ts" + good_image[2:],
        "one letter, another one": b"X",
        "nothing": b"",
        "needs before the start": change_byte(change_byte(good_image, 14, 4), 4, 9),
        "a checksum before needs": change_byte(good_image, 14, 4)[:-1] + b"\0",
        "a start before a rule": change_byte(pack("SI", 0, b"\xff"), 4, 3),
        "a rule before another kit": pack("SI", 0x1234, b"\x92\xff"),
        "another sensor": pack("SI", 0x1234, bytes.fromhex("9a")),
        "devices where there are none": pack("SI", 1, bytes.fromhex("58")),
        "none where there are devices": pack("SI", 0, bytes.fromhex("9a")),
    }.items():  # fmt: skip
        yield Run(f"images: {name}", TINIBOT_KIT, image)
    for length in range(1, len(good_image)):
        yield Run(f"images: the first {length} bytes", TINIBOT_KIT, good_image[:length])
    for offset in range(len(good_image)):
        changed_image = (
            good_image[:offset] + bytes([good_image[offset] ^ 0x10]) + good_image[offset + 1 :]
        )
        yield Run(f"images: byte {offset} is another one", TINIBOT_KIT, changed_image)
    for name in ("liner", "grabber"):
        yield Run(f"images: on a {name}", robots.load(name).kit, good_image)


def needs_runs() -> Iterator[Run]:
    """Return instructions that an image has, and does not say that it needs them."""
    for name in ("TASK", "WHEN", "LOOK", "END_TASK", "END_WHEN", "GO_F", "WATCH_GO_F"):
        op = BY_NAME[name]
        values = bytes([BY_NAME["PUSH_NUM_1"].code]) * op.pops
        code = values + op.opcode + bytes(op.size - len(op.opcode))
        yield Run(f"needs: {name} without its bit", TINIBOT_KIT, pack("SI", 0, code))
        yield Run(
            f"needs: {name} without its bit, cut",
            TINIBOT_KIT,
            pack("SI", 0, code[: len(values) + 1]),
        )
        yield Run(f"needs: {name} with the other bit", TINIBOT_KIT,
                  pack("SI", 0, code, needs=GO if op.needs == TASKS else TASKS))  # fmt: skip


def compile_image(text: str) -> bytes:
    return compile_text(text, TINIBOT_KIT).image


def change_byte(image: bytes, offset: int, value: int) -> bytes:
    """Return an image with another byte, and the checksum that fits."""
    return with_checksum(image[:offset] + bytes([value]) + image[offset + 1 :])


def arithmetic_runs() -> Iterator[Run]:
    """Return operations on the edges of numbers: an operation that faults ends a run, the others
    share one."""
    for op in map(BY_NAME.__getitem__, CALCULATIONS):
        show_op = "SHOW_YES_NO" if op.code in range(0x20, 0x29) else "SHOW"
        joined_code = b""
        for values in product(EDGE_NUMBERS, repeat=op.pops):
            code = b"".join(map(push32, values)) + bytes([op.code, BY_NAME[show_op].code])
            run = Run(title(op, values), TINIBOT_KIT, pack("SI", 0, code))
            answer = answer_of(run)
            assert answer is not None
            if answer[-1].endswith("DONE"):
                joined_code += code
            else:
                yield run
        yield Run(f"arithmetic: {op.name}", TINIBOT_KIT, pack("SI", 0, joined_code))


def push32(value: int) -> bytes:
    return bytes([BY_NAME["PUSH32"].code]) + value.to_bytes(4, "little", signed=True)


def title(op: Op, values: tuple[int, ...]) -> str:
    return f"arithmetic: {op.name} {' '.join(str(value / 1000) for value in values)}"


def random_program_runs() -> Iterator[Run]:
    """Return programs at random, at the usual times and at others."""
    for seed in RANDOM_PROGRAMS:
        program = random_program(seed)
        image = program.short_compilation.image
        run = Run(f"programs: {seed}", program.kit, image, program.senses, text=program.text)
        yield run
        if takes_time(run):
            yield run._replace(
                name=f"{run.name} (called every 7 ms, time wraps around)", schedule=SELDOM_SCHEDULE
            )
            sensors = tuple(reading.name for reading in program.kit.readings)
            yield run.at_pace(Pace(OFTEN_MS[seed % len(OFTEN_MS)], sensors, 130, 20, 90))


def task_program_runs() -> Iterator[Run]:
    """Return programs with tasks at random, at the usual times and at others; with readings that
    come late, too, and tasks that take the motors from each other meanwhile."""
    for seed in TASK_PROGRAMS:
        rng = random.Random(seed)
        text, readings = task_program(rng)
        run = task_run(f"tasks: {seed}", text, readings)
        yield run
        yield from (run.call_every(interval_ms) for interval_ms in OFTEN_MS)
        yield run._replace(
            name=f"{run.name} (called every 7 ms, time wraps around)", schedule=SELDOM_SCHEDULE
        )
        yield run.at_pace(random_pace(rng))
        run = task_run(f"tasks: rivals {seed}", *rival_program(rng))
        yield run
        yield from (
            run.at_pace(random_pace(rng)._replace(call_interval_ms=interval_ms))
            for interval_ms in OFTEN_MS
        )


def task_run(name: str, text: str, readings: Mapping[str, Sequence[int]]) -> Run:
    return Run(name, TINIBOT_KIT, compile_image(text), Senses(readings, TASK_RUN_MS), text=text)


def way_runs() -> Iterator[Run]:
    """Return moves by centimetres and degrees: their edges, with tasks, at random and refused."""
    longest = "2147483.647"
    for text in (
        "F(20 CM, 60); B(20 CM, 60); L(90 DEG, 60); R(90 DEG, 60)",
        "F(0.009 CM, 40); F(0.008 CM, 40); F(0.001 CM, 100)",  # half a millisecond, and less
        "F(0 CM, 0); B(0 - 5 CM, 0); F(-0.4 + TIME CM, 60)",
        "F(1 CM, 200 + TIME); R(1 DEG, 0.5 + TIME); F(1 CM, 0.4 + TIME)",
        f"L({longest} DEG, 100); F({longest} CM, 3) UNTIL(TIME >= 0)",
        f"F({longest} CM, 2)",
        "F(5 CM, 0) UNTIL(DISTANCE < 10)",
        "F(45 CM, 100) UNTIL(DISTANCE < 10); B(4.5 CM, 100) UNTIL(DISTANCE > 10)",
        "F(0.9 CM, 100) UNTIL(FALSE); F(0.91 CM, 100) UNTIL(FALSE)",
        "W(0.05); F(4.5 CM, 100); TASK; W(0.07); L(36 DEG, 100); END_TASK",
        "F(45 CM, 50) UNTIL(TIME > 0.5); WHEN(TIME > 0.1 AND TIME < 0.2); S; END_WHEN",
        "F(FOREVER, 60); WHEN(TIME > 0.1); B(1 CM, 0); END_WHEN",
    ):
        senses = FAR_SENSES._replace(max_ms=5000)
        run = Run(f"ways: {text}", TINIBOT_KIT, compile_image(text), senses, text=text)
        yield run
        yield run.call_every(LATE_CALL_MS)
    go_code, watch_code = BY_NAME["GO_F"].opcode, BY_NAME["WATCH_GO_R"].opcode
    two_values = bytes([BY_NAME["PUSH_NUM_2"].code, BY_NAME["PUSH_NUM_20"].code])
    for name, code, needs_runs in (
        ("no such code", two_values + bytes([ESCAPE, 0]), GO),
        ("half a code", two_values + bytes([ESCAPE]), GO),
        ("one value", two_values[:1] + go_code, GO),
        ("no check", two_values + watch_code, GO),
        ("needs that say tasks", two_values + go_code, TASKS),
    ):
        yield Run(f"ways: {name}", TINIBOT_KIT, pack("SI", 0, code, needs=needs_runs))
    for seed in WAY_PROGRAMS:
        oracle_kit, kit = KITS[seed % len(KITS)]
        rng = random.Random(seed)
        text = programs.program(rng, oracle_kit, ways=True)
        senses = Senses(programs.senses(rng, oracle_kit), 20_000)
        image = compile_text(text, kit).image
        yield Run(f"ways: program {seed}", kit, image, senses, text=text)
        yield task_run(f"ways: tasks {seed}", *task_program(random.Random(seed), ways=True))
