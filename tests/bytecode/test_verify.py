"""The verifier: every rule has a disassembly that breaks it.

`tests/vm/test_cpp_agreement.py` shows that it agrees with the verifier in C++ for any code, and
that code which both accept runs identically and safely.
"""

from __future__ import annotations

import pytest

from tests.support.casefile import ROOT, read
from tests.support.kits import KITS
from tiniscript import compile_text
from tiniscript.base.kit import MAX_DEVICES
from tiniscript.base.limits import CODE_BYTES
from tiniscript.bytecode.opcodes import OPS
from tiniscript.bytecode.verify import RULES, Refused, verify

SENSORS, ACTUATORS = 3, 2


def refusal(code: bytes) -> str:
    try:
        verify(code, SENSORS, ACTUATORS)
    except Refused as refusal:
        assert 0 <= refusal.offset <= len(code)
        return refusal.name
    return ""


def test_every_rule_has_a_case() -> None:
    rules = {
        case.parts["refused"].split()[1]
        for name in ("refused.md", "tasks.md")
        for case in read(ROOT / "tests/cases" / name)
        if "refused" in case.parts
    }
    assert rules | {"CODE_LENGTH"} == set(RULES)


def test_code_may_be_as_long_as_the_limit() -> None:
    stop = bytes([next(op.code for op in OPS if op.name == "STOP")])
    assert refusal(stop * CODE_BYTES) == ""
    assert refusal(stop * (CODE_BYTES + 1)) == "CODE_LENGTH"


def test_a_way_that_is_cut_after_its_first_byte() -> None:
    assert refusal(bytes.fromhex("bcbfff")) == "CUT_OPERAND"
    assert refusal(bytes.fromhex("bcbfff40")) == ""
    with pytest.raises(Refused, match="UNKNOWN_OPCODE"):
        verify(bytes.fromhex("bcbfff"), SENSORS, ACTUATORS, needs=0)


@pytest.mark.parametrize("sensors", [0, 1, 32])
def test_devices_are_counted(sensors: int) -> None:
    read_op = next(op.code for op in OPS if op.name == "READ")
    for index in range(33):
        code = bytes([read_op, index])
        if index < sensors:
            assert verify(code, sensors, 0).uses == (("sensor", index),)
        else:
            rule = "NO_SUCH_DEVICE" if index < MAX_DEVICES else "BAD_OPERAND"
            with pytest.raises(Refused, match=rule):
                verify(code, sensors, 0)


def test_the_verdict_contains_the_needs_of_the_code() -> None:
    _oracle_kit, kit = KITS[0]
    text = """
        DEF IN; LOOP(2); LOOP(3); SHOW(1 + TIME * 2); END_LOOP; END_LOOP; END_DEF
        DEF OUT; IN; END_DEF
        LOOP(4); OUT; END_LOOP
    """
    verdict = compile_text(text, kit).verdict
    assert verdict == (3, 3, 2, (), 0, 0)
