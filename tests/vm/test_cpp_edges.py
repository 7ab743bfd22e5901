"""What holds at the limits of the C++ machine: that it has so much room and uses no other.

Each test is of code that is made to come to one limit.
"""

from __future__ import annotations

from collections.abc import Iterator

from tests.machines import Senses
from tests.machines.host import host
from tests.support.cpp_checks import WIDE, compare_runs, compare_verdicts
from tests.support.images import image_for
from tests.support.random_codes import jump, loop, simple
from tiniscript.base.kit import MOST_DEVICES, NUMBER, Device, Kit
from tiniscript.base.limits import CALLS, COUNTERS, DEFS, JOINS, STACK_VALUES, VARIABLES
from tiniscript.bytecode.opcodes import BY_CODE, OPS, SHORTS


def show(number: int) -> bytes:
    return simple("PUSH8") + bytes([number]) + simple("SHOW")


def kit_of(sensors: int) -> Kit:
    return Kit(tuple(Device(f"S{number}", NUMBER, "", 0, 1000) for number in range(sensors)), ())


def test_many_defs() -> None:
    for count in range(20):
        for calls in range(12):
            end = simple("RETURN")
            one = jump("DEF", False, len(end)) + end
            code = one * count + jump("CALL", False, 3) * (calls if count else 0)
            compare_verdicts(host(), [code], 3, 2)


def procedure(body: bytes) -> bytes:
    return jump("DEF", True, len(body) + 1) + body + simple("RETURN")


def loops(inner: bytes, count: int) -> bytes:
    """Return something in so many loops around it."""
    for _ in range(count):
        inner = loop(inner, 1)
    return inner


def calls_in_calls(count: int) -> bytes:
    """Return procedures, each of which calls the one before it and then shows a number."""
    code, distance = b"", 0
    for number in range(count):
        body = jump("CALL", True, distance + 6) if number else b""
        body += show(number) + simple("RETURN")
        code += jump("DEF", True, len(body)) + body
        distance = len(body)
    return code


def test_what_is_closed_takes_no_room() -> None:
    """Blocks and procedures that have ended take no more room: there may be any number."""
    yes, stop = simple("PUSH_TRUE"), simple("STOP")
    leave = jump("BREAK", True, 3)
    pieces = (
        yes + jump("IF", True, 1) + stop,
        yes + jump("IF", True, 4) + stop + jump("ELSE", True, 1) + stop,
        yes + jump("IF", True, 5) + yes + jump("IF", True, 1) + stop,
        simple("FOREVER") + leave + jump("AGAIN", True, 6),
        jump("WHILE", True, 6) + leave + jump("AGAIN", True, 6),
        loop(stop, 1),
        yes + jump("AND_THEN", True, 1) + yes + simple("SHOW_YES_NO"),
        simple("WATCH_FOREVER_WAIT") + yes + simple("UNTIL"),
    )
    for piece in pieces:
        compare_verdicts(host(), [piece * count for count in range(40)], 3, 2)
        compare_runs(host(), piece * 40, WIDE, Senses(max_ms=1000, max_steps=1000))
    # what one procedure needs is not what the next one needs
    for needs in (0, 8, COUNTERS):
        for around in range(COUNTERS + 1):
            code = procedure(loops(stop, needs)) + procedure(stop)
            code += loops(jump("CALL", True, 5 + 2 * around), around)
            compare_verdicts(host(), [code], 3, 2)
    for count in range(CALLS + 1):
        compare_verdicts(host(), [calls_in_calls(CALLS) + calls_in_calls(count)], 3, 2)


def test_a_procedure_needs_what_it_calls_needs() -> None:
    """A procedure needs what it calls needs; loops and procedures are remembered at once."""
    stop = simple("STOP")
    for needs in (0, 1, 8):
        for between in (0, 1, 7):
            for around in range(COUNTERS + 1):
                first = loops(stop, needs)
                second = loops(jump("CALL", True, len(first) + 7 + 2 * between), between)
                code = procedure(first) + procedure(second)
                code += loops(jump("CALL", True, len(second) + 4 + 2 * around), around)
                compare_verdicts(host(), [code], 3, 2)
    for count in (DEFS - 1, DEFS, DEFS + 1):
        code = procedure(stop) * count + jump("CALL", True, 5)
        code += simple("PUSH_TRUE") + jump("IF", True, 1) + stop
        code += loops(stop, COUNTERS)
        compare_verdicts(host(), [code, code + loops(stop, COUNTERS + 1)], 3, 2)


def test_everything_has_a_place_of_its_own() -> None:
    """Every variable, reading, counter, value and call has a place of its own."""
    kit = kit_of(MOST_DEVICES)
    readings = {device.name: [1000 * k + 500] for k, device in enumerate(kit.sensors)}
    senses = Senses(readings, max_ms=1000, max_steps=5000)
    code = b""
    for k in range(VARIABLES):
        code += simple("SET_VAR8") + bytes([k, 100 - k])
    for k in range(MOST_DEVICES):
        code += simple("READ") + bytes([k])
    inner = b""
    for name, count in (("PUSH_VAR", VARIABLES), ("PUSH_SENSOR", MOST_DEVICES)):
        inner += b"".join(simple(name) + bytes([k]) + simple("SHOW") for k in range(count))
    values = b"".join(simple("PUSH8") + bytes([3 * k]) for k in range(STACK_VALUES))
    inner += values + simple("SUB") * (STACK_VALUES - 1) + simple("SHOW")
    code += loops(inner, COUNTERS)
    procedures = calls_in_calls(CALLS)
    last = len(calls_in_calls(CALLS)) - len(calls_in_calls(CALLS - 1)) - 3
    code += procedures + jump("CALL", True, last + 3)
    for k in range(VARIABLES):
        code += simple("PUSH_VAR") + bytes([k]) + simple("SHOW")
    compare_verdicts(host(), [code], MOST_DEVICES, 0)
    ending = compare_runs(host(), code, kit, senses)
    assert ending == "DONE", ending
    # joins beside a procedure
    code = calls_in_calls(1)
    for k in reversed(range(JOINS)):
        code += simple("PUSH_TRUE") + jump("AND_THEN", True, 4 * k + 1)
    code += simple("PUSH_TRUE") + simple("SHOW_YES_NO")
    compare_verdicts(host(), [code + jump("CALL", True, len(code))], 3, 2)


def test_an_instruction_of_one_byte_means_what_is_in_its_code() -> None:
    """Instructions of one byte mean the variable, sensor or actuator that is in their code."""
    devices = kit_of(SHORTS).sensors
    kit = Kit(devices, tuple(device._replace(name=f"A{device.name}") for device in devices))
    code = b""
    for family, before, after in (
        ("SET_VAR", "PUSH_NUM_{}", ""), ("PUSH_VAR", "", "SHOW"), ("READ", "", ""),
        ("PUSH_SENSOR", "", "SHOW"), ("PUSH_READ", "", "SHOW"), ("SET", "PUSH_NUM_{}", ""),
    ):  # fmt: skip
        for n in range(SHORTS):
            words = (before.format(n + 1), f"{family}_{n}", after)
            code += b"".join(simple(word) for word in words if word)
    readings = {device.name: (1000 * k + 1, 1000 * k + 2) for k, device in enumerate(devices)}
    compare_verdicts(host(), [code], SHORTS, SHORTS)
    ending = compare_runs(host(), code, kit, Senses(readings, max_ms=100, max_steps=200))
    assert ending == "DONE", ending


def test_a_program_may_run_for_24_days() -> None:
    """TIME is too large for a number after 24 days, and stays so: the clock of 32 bits wraps."""
    most = simple("PUSH32") + (2**31 - 1).to_bytes(4, "little") + simple("WAIT")
    time = simple("TIME") + simple("SHOW")
    senses = Senses(max_ms=2**31 + 1000, max_steps=100)
    ending = compare_runs(host(), most + time + simple("WAIT8") + b"\x01" + time, WIDE, senses)
    assert ending == "OVERFLOW", ending
    for code in (most * 2 + simple("WAIT8") + b"\x78", most * 5):
        image = image_for(code + time, WIDE)
        ran = host().run(image, WIDE, senses._replace(max_ms=2**32 - 1))
        assert ran.trace.splitlines()[-1].endswith(" FAULT OVERFLOW"), ran.trace


def changed_code(sensors: int) -> Iterator[tuple[bytes, int | None]]:
    """Yield code that no verifier accepts, and where it is caught; None: it is not.

    What a machine still looks at while it runs, at each edge.
    """
    yes, show, end = simple("PUSH_TRUE"), simple("SHOW"), simple("RETURN")
    count = simple("LOOP8") + b"\x01"
    for values, caught in ((STACK_VALUES, None), (STACK_VALUES + 1, STACK_VALUES)):
        yield yes * values, caught
    for name in ("TIME", "PUSH_FALSE", "PUSH_VAR_0", "PUSH_SENSOR_0", "PUSH_READ_0", "PUSH_NUM_1"):
        yield yes * STACK_VALUES + simple(name), STACK_VALUES
    for name in ("PUSH_VAR", "PUSH_SENSOR", "PUSH_READ", "PUSH8", "PUSH16", "PUSH32"):
        yield yes * STACK_VALUES + simple(name) + bytes(4), STACK_VALUES
    yield show, 0
    yield yes + simple("ADD") + show, 1
    # nothing is on the stack
    for name in ("ADD", "MAX", "EQ", "AND"):
        yield simple(name), 0
    for name in ("SET_VAR", "LOOP", "IF", "IF_NOT", "IF_FAR", "IF_NOT_FAR", "LOOP_FAR"):
        yield simple(name) + bytes(2), 0
    for name in ("IF8_EQ", "IF16_EQ"):
        yield simple(name) + bytes(3), 0
    yield simple("SET_VAR_0"), 0
    yield yes + simple("MOTORS"), 1
    for each, caught in ((VARIABLES - 1, None), (VARIABLES, 0), (255, 0)):
        number = bytes([each])
        yield simple("SET_VAR8") + number + b"\x01", caught
        yield simple("ADD_VAR8") + number + b"\x01", caught
        yield simple("ADD_VAR") + b"\x00" + number, caught
        yield simple("ADD_VAR") + number + b"\x00", caught
        yield simple("PUSH_VAR") + number, caught
        yield yes + simple("SET_VAR") + number, None if caught is None else 1
        yield simple("INC_VAR") + number, caught
        yield simple("DEC_VAR") + number, caught
        yield simple("IF_VAR8_NE") + number + b"\x07\x00", caught
        yield simple("IF_VAR16_NE") + number + b"\x07\x00\x00", caught
    for each, caught in ((sensors - 1, None), (sensors, 0), (255, 0)):
        number = bytes([each])
        for name in ("READ", "PUSH_SENSOR", "PUSH_READ"):
            yield simple(name) + number, caught
    # a distance that leads beyond all addresses of 16 bits, to the instruction itself
    yield jump("ELSE", True, 0xFFFD), 0
    for op in OPS:  # instructions of one byte name what a machine has, or may have not
        if op.implied and op.implied.kind.name == "sensor":
            yield bytes([op.code]), 0 if op.implied.value >= sensors else None
    frames = COUNTERS + CALLS  # of both, in the order in which they are opened
    yield count * frames, None
    yield count * (frames + 1), 2 * frames
    yield simple("LOOP8") + b"\xc8" + end, 200  # a loop is closed as a call
    close = jump("NEXT", False, 0)
    yield count + close, None
    yield close, 0
    yield jump("BREAK_LOOP", False, 0), 0
    calls = b"".join(jump("CALL", False, 0) for _ in range(frames + 1))
    yield calls[:-2], None
    yield calls, 2 * frames
    yield end, 0
    for far in (False, True):
        skip = jump("ELSE", far, 0)
        yield skip, None
        yield jump("ELSE", far, 1), len(skip) + 1
    yield jump("ELSE", True, 0x7FFF), 0x7FFF + 3
    yield jump("AGAIN", True, 4), 0xFFFF
    # an instruction that is cut takes what lies after the code for the rest of it
    yield simple("PUSH16"), 3
    yield simple("PUSH32") + b"\x01\x02", 5
    for code in range(256):
        if BY_CODE[code] is None:
            yield bytes([code, 0, 0, 0, 0]), 0


def test_code_that_changed_after_it_was_verified() -> None:
    """Code that changed after it was verified ends in BAD_CODE, and not too early."""
    # a robot may say that it has more sensors than a machine remembers
    for many in (3, MOST_DEVICES - 1, MOST_DEVICES, MOST_DEVICES + 1, 2 * MOST_DEVICES):
        kit = kit_of(many)
        for code, caught in changed_code(min(len(kit.readings), MOST_DEVICES)):
            ran = host().run_unverified(code, kit, Senses(max_ms=100, max_steps=100))
            ending = ran.trace.splitlines()[-1].split()[-1]
            wanted = "DONE" if caught is None else "BAD_CODE"
            assert ending == wanted, f"{code.hex(' ')}: {ending}, not {wanted}"
            assert caught in (None, ran.offset), f"{code.hex(' ')}: at {ran.offset}, not {caught}"
