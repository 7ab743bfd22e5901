"""The limits of the C++ machine: it has exactly so much room and uses no other.

Each test is of code that is made to come to one limit.
"""

from __future__ import annotations

from tests.machines import Senses
from tests.machines.host import host
from tests.support.cpp_checks import WIDE_KIT, compare_runs, compare_verdicts
from tests.support.edge_codes import kit_with_sensors, unverified_code
from tests.support.images import image_for
from tests.support.random_codes import jump, loop, simple
from tiniscript.base.kit import MAX_DEVICES, Kit
from tiniscript.base.limits import CALLS, COUNTERS, DEFS, JOINS, STACK_VALUES, VARIABLES
from tiniscript.bytecode.opcodes import SHORTS


def show(number: int) -> bytes:
    return simple("PUSH8") + bytes([number]) + simple("SHOW")


def test_many_defs_compile() -> None:
    for count in range(20):
        for call_count in range(12):
            end = simple("RETURN")
            one = jump("DEF", False, len(end)) + end
            code = one * count + jump("CALL", False, 3) * (call_count if count else 0)
            compare_verdicts(host(), [code], 3, 2)


def procedure(body: bytes) -> bytes:
    return jump("DEF", True, len(body) + 1) + body + simple("RETURN")


def loops(inner: bytes, count: int) -> bytes:
    """Return something in so many loops around it."""
    for _ in range(count):
        inner = loop(inner, 1)
    return inner


def calls_in_calls(count: int) -> bytes:
    """Return procedures, each of which calls the previous one and then shows a number."""
    code, distance = b"", 0
    for number in range(count):
        body = jump("CALL", True, distance + 6) if number else b""
        body += show(number) + simple("RETURN")
        code += jump("DEF", True, len(body)) + body
        distance = len(body)
    return code


def test_closed_blocks_take_no_room() -> None:
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
        compare_runs(host(), piece * 40, WIDE_KIT, Senses(max_ms=1000, max_steps=1000))
    # Needs of one procedure are not needs of the next.
    for needs in (0, 8, COUNTERS):
        for loop_count in range(COUNTERS + 1):
            code = procedure(loops(stop, needs)) + procedure(stop)
            code += loops(jump("CALL", True, 5 + 2 * loop_count), loop_count)
            compare_verdicts(host(), [code], 3, 2)
    for count in range(CALLS + 1):
        compare_verdicts(host(), [calls_in_calls(CALLS) + calls_in_calls(count)], 3, 2)


def test_a_procedure_needs_what_it_calls_needs() -> None:
    """A procedure needs what it calls needs; loops and procedures are remembered at once."""
    stop = simple("STOP")
    for needs in (0, 1, 8):
        for loops_before in (0, 1, 7):
            for loop_count in range(COUNTERS + 1):
                first = loops(stop, needs)
                second = loops(jump("CALL", True, len(first) + 7 + 2 * loops_before), loops_before)
                code = procedure(first) + procedure(second)
                code += loops(jump("CALL", True, len(second) + 4 + 2 * loop_count), loop_count)
                compare_verdicts(host(), [code], 3, 2)
    for count in (DEFS - 1, DEFS, DEFS + 1):
        code = procedure(stop) * count + jump("CALL", True, 5)
        code += simple("PUSH_TRUE") + jump("IF", True, 1) + stop
        code += loops(stop, COUNTERS)
        compare_verdicts(host(), [code, code + loops(stop, COUNTERS + 1)], 3, 2)


def test_every_value_has_its_own_place() -> None:
    """Every variable, reading, counter, value and call has a place of its own."""
    kit = kit_with_sensors(MAX_DEVICES)
    readings = {device.name: [1000 * k + 500] for k, device in enumerate(kit.sensors)}
    senses = Senses(readings, max_ms=1000, max_steps=5000)
    code = b""
    for k in range(VARIABLES):
        code += simple("SET_VAR8") + bytes([k, 100 - k])
    for k in range(MAX_DEVICES):
        code += simple("READ") + bytes([k])
    inner = b""
    for name, count in (("PUSH_VAR", VARIABLES), ("PUSH_SENSOR", MAX_DEVICES)):
        inner += b"".join(simple(name) + bytes([k]) + simple("SHOW") for k in range(count))
    values = b"".join(simple("PUSH8") + bytes([3 * k]) for k in range(STACK_VALUES))
    inner += values + simple("SUB") * (STACK_VALUES - 1) + simple("SHOW")
    code += loops(inner, COUNTERS)
    procedures = calls_in_calls(CALLS)
    last = len(calls_in_calls(CALLS)) - len(calls_in_calls(CALLS - 1)) - 3
    code += procedures + jump("CALL", True, last + 3)
    for k in range(VARIABLES):
        code += simple("PUSH_VAR") + bytes([k]) + simple("SHOW")
    compare_verdicts(host(), [code], MAX_DEVICES, 0)
    ending = compare_runs(host(), code, kit, senses)
    assert ending == "DONE", ending
    # joins in addition to a procedure
    code = calls_in_calls(1)
    for k in reversed(range(JOINS)):
        code += simple("PUSH_TRUE") + jump("AND_THEN", True, 4 * k + 1)
    code += simple("PUSH_TRUE") + simple("SHOW_YES_NO")
    compare_verdicts(host(), [code + jump("CALL", True, len(code))], 3, 2)


def test_an_instruction_of_one_byte_contains_its_operand() -> None:
    """Instructions of one byte mean the variable, sensor or actuator that is in their code."""
    devices = kit_with_sensors(SHORTS).sensors
    kit = Kit(devices, tuple(device._replace(name=f"A{device.name}") for device in devices))
    code = b""
    for family, text_before, text_after in (
        ("SET_VAR", "PUSH_NUM_{}", ""), ("PUSH_VAR", "", "SHOW"), ("READ", "", ""),
        ("PUSH_SENSOR", "", "SHOW"), ("PUSH_READ", "", "SHOW"), ("SET", "PUSH_NUM_{}", ""),
    ):  # fmt: skip
        for n in range(SHORTS):
            words = (text_before.format(n + 1), f"{family}_{n}", text_after)
            code += b"".join(simple(word) for word in words if word)
    readings = {device.name: (1000 * k + 1, 1000 * k + 2) for k, device in enumerate(devices)}
    compare_verdicts(host(), [code], SHORTS, SHORTS)
    ending = compare_runs(host(), code, kit, Senses(readings, max_ms=100, max_steps=200))
    assert ending == "DONE", ending


def test_a_program_may_run_for_24_days() -> None:
    """TIME is too large for a number after 24 days, and stays so: the clock of 32 bits wraps."""
    longest_wait = simple("PUSH32") + (2**31 - 1).to_bytes(4, "little") + simple("WAIT")
    time = simple("TIME") + simple("SHOW")
    senses = Senses(max_ms=2**31 + 1000, max_steps=100)
    ending = compare_runs(
        host(), longest_wait + time + simple("WAIT8") + b"\x01" + time, WIDE_KIT, senses
    )
    assert ending == "OVERFLOW", ending
    for code in (longest_wait * 2 + simple("WAIT8") + b"\x78", longest_wait * 5):
        image = image_for(code + time, WIDE_KIT)
        run = host().run(image, WIDE_KIT, senses._replace(max_ms=2**32 - 1))
        assert run.trace.splitlines()[-1].endswith(" FAULT OVERFLOW"), run.trace


def test_code_changed_after_verification_ends_in_bad_code() -> None:
    """Code that changed after it was verified ends in BAD_CODE, and not too early."""
    # A robot may report more sensors than a machine remembers.
    for device_count in (3, MAX_DEVICES - 1, MAX_DEVICES, MAX_DEVICES + 1, 2 * MAX_DEVICES):
        kit = kit_with_sensors(device_count)
        for code, caught_at in unverified_code(min(len(kit.readings), MAX_DEVICES)):
            run = host().run_unverified(code, kit, Senses(max_ms=100, max_steps=100))
            ending = run.trace.splitlines()[-1].split()[-1]
            expected_text = "DONE" if caught_at is None else "BAD_CODE"
            assert ending == expected_text, f"{code.hex(' ')}: {ending}, not {expected_text}"
            assert caught_at in (None, run.offset), (
                f"{code.hex(' ')}: at {run.offset}, not {caught_at}"
            )
