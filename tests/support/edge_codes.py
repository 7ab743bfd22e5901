"""Code at the limits of the machine that no verifier accepts."""

from __future__ import annotations

from collections.abc import Iterator

from tests.support.random_codes import jump, simple
from tiniscript.base.kit import NUMBER, Device, Kit
from tiniscript.base.limits import CALLS, COUNTERS, STACK_VALUES, VARIABLES
from tiniscript.bytecode.opcodes import BY_CODE, OPS


def kit_with_sensors(sensors: int) -> Kit:
    return Kit(tuple(Device(f"S{number}", NUMBER, "", 0, 1000) for number in range(sensors)), ())


def unverified_code(sensors: int) -> Iterator[tuple[bytes, int | None]]:
    """Yield code that no verifier accepts, and where it is caught, or None if it is not.

    Return code for each check that a machine makes at run time, at each edge.
    """
    yes, show, end = simple("PUSH_TRUE"), simple("SHOW"), simple("RETURN")
    count = simple("LOOP8") + b"\x01"
    for values, fault_step in ((STACK_VALUES, None), (STACK_VALUES + 1, STACK_VALUES)):
        yield yes * values, fault_step
    for name in ("TIME", "PUSH_FALSE", "PUSH_VAR_0", "PUSH_SENSOR_0", "PUSH_READ_0", "PUSH_NUM_1"):
        yield yes * STACK_VALUES + simple(name), STACK_VALUES
    for name in ("PUSH_VAR", "PUSH_SENSOR", "PUSH_READ", "PUSH8", "PUSH16", "PUSH32"):
        yield yes * STACK_VALUES + simple(name) + bytes(4), STACK_VALUES
    yield show, 0
    yield yes + simple("ADD") + show, 1
    # Code with an empty stack.
    for name in ("ADD", "MAX", "EQ", "AND"):
        yield simple(name), 0
    for name in ("SET_VAR", "LOOP", "IF", "IF_NOT", "IF_FAR", "IF_NOT_FAR", "LOOP_FAR"):
        yield simple(name) + bytes(2), 0
    for name in ("IF8_EQ", "IF16_EQ"):
        yield simple(name) + bytes(3), 0
    yield simple("SET_VAR_0"), 0
    yield yes + simple("MOTORS"), 1
    for variable, fault_step in ((VARIABLES - 1, None), (VARIABLES, 0), (255, 0)):
        number = bytes([variable])
        yield simple("SET_VAR8") + number + b"\x01", fault_step
        yield simple("ADD_VAR8") + number + b"\x01", fault_step
        yield simple("ADD_VAR") + b"\x00" + number, fault_step
        yield simple("ADD_VAR") + number + b"\x00", fault_step
        yield simple("PUSH_VAR") + number, fault_step
        yield yes + simple("SET_VAR") + number, None if fault_step is None else 1
        yield simple("INC_VAR") + number, fault_step
        yield simple("DEC_VAR") + number, fault_step
        yield simple("IF_VAR8_NE") + number + b"\x07\x00", fault_step
        yield simple("IF_VAR16_NE") + number + b"\x07\x00\x00", fault_step
    for variable, fault_step in ((sensors - 1, None), (sensors, 0), (255, 0)):
        number = bytes([variable])
        for name in ("READ", "PUSH_SENSOR", "PUSH_READ"):
            yield simple(name) + number, fault_step
    # a distance that leads beyond all addresses of 16 bits, to the instruction itself
    yield jump("ELSE", True, 0xFFFD), 0
    for op in OPS:  # one-byte instructions that depend on a machine's features
        if op.implied and op.implied.kind.name == "sensor":
            yield bytes([op.code]), 0 if op.implied.value >= sensors else None
    frames = COUNTERS + CALLS  # frames of both kinds, in the order in which they are opened
    yield count * frames, None
    yield count * (frames + 1), 2 * frames
    yield simple("LOOP8") + b"\xc8" + end, 200  # a loop is closed as a call
    loop_end = jump("NEXT", False, 0)
    yield count + loop_end, None
    yield loop_end, 0
    yield jump("BREAK_LOOP", False, 0), 0
    calls = b"".join(jump("CALL", False, 0) for _ in range(frames + 1))
    yield calls[:-2], None
    yield calls, 2 * frames
    yield end, 0
    for is_far in (False, True):
        skip = jump("ELSE", is_far, 0)
        yield skip, None
        yield jump("ELSE", is_far, 1), len(skip) + 1
    yield jump("ELSE", True, 0x7FFF), 0x7FFF + 3
    yield jump("AGAIN", True, 4), 0xFFFF
    # A cut instruction reads the bytes after the code.
    yield simple("PUSH16"), 3
    yield simple("PUSH32") + b"\x01\x02", 5
    for code in range(256):
        if BY_CODE[code] is None:
            yield bytes([code, 0, 0, 0, 0]), 0
