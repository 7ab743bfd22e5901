"""The machine, in Python.

Runs verified code. Time comes in as `now_ms`, which does not wrap around here; the world is
accessed through `state.Robot`. `tick` does a little and returns: nothing here waits. In C++ it is
`vm_arduino/src/vm/machine.h`, whose `tick` counts jumps back and calls instead of instructions;
`tests/project/test_twins.py` lists what has another name there.

`values`, `actions` and `control` have a handler for each row of the table in `bytecode`; importing
this fails if one is missing. A short instruction shares the handler of its long form. Those of
tasks come with `tasks`.
"""

from __future__ import annotations

from tiniscript.base.fixed_point import Fault
from tiniscript.bytecode.opcodes import NEEDS_TASKS, OPS, Op, op_at, read_operands
from tiniscript.vm import actions, control, values
from tiniscript.vm.handlers import HANDLERS, STAY, Step, mark_stop
from tiniscript.vm.state import DONE, FAULT, MOVE, NOTHING, RUNNING, WAITING, Drive, Robot, Task

_FAMILIES = (values, actions, control)  # importing them fills the table

for _op in OPS:
    if _op.implied is not None:
        HANDLERS[_op.name] = HANDLERS[_op.family]

_ops_without_handler = [
    op.name for op in OPS if op.name not in HANDLERS and op.needs != NEEDS_TASKS
]
assert not _ops_without_handler, f"no handler for {_ops_without_handler}"


def bind_steps(machine: Drive, code: bytes) -> list[Step]:
    """Return the step of the instruction at each offset, for this machine. Jumps are offsets.

    END follows the code.
    """
    steps = [HANDLERS["END"](machine, 0)] * (len(code) + 1)
    offset = 0
    while offset < len(code):
        op, next_pc = instruction_at(code, offset)
        operands = read_operands(op, code, offset) if op.implied is None else (op.implied.value,)
        operand_kind = op.operands[-1].kind.name if op.operands else ""
        if operand_kind.startswith("fwd"):
            operands = (*operands[:-1], next_pc + operands[-1])
        elif operand_kind.startswith("back"):
            operands = (*operands[:-1], next_pc - operands[-1])
        steps[offset] = HANDLERS[op.name](machine, next_pc, *operands)
        offset = next_pc
    return steps


def instruction_at(code: bytes, offset: int) -> tuple[Op, int]:
    """Return the instruction at an offset, and where the next one begins."""
    op = op_at(code, offset)
    assert op is not None, "the code is not verified"
    return op, offset + op.size


class Machine(Drive):
    """Runs the code of one image on one robot. It has no tasks."""

    def __init__(
        self, code: bytes, robot: Robot, sensor_count: int = 0, seed: int = 1, now_ms: int = 0
    ) -> None:
        """`code` must be verified for a kit with so many sensors; `seed` is 1 to 4294967295."""
        super().__init__(robot, Task(seed, sensor_count, now_ms), now_ms)
        self.fault = ""
        self.offset = 0  # start of the instruction that runs or has faulted
        self.steps = 0  # instructions that have run
        self._code = code
        self._steps = bind_steps(self, code)

    def tick(self, now_ms: int, most_steps: int) -> str:
        """Run at most `most_steps` instructions at the time `now_ms`; return the status."""
        if self.status in (DONE, FAULT):
            return self.status
        self.now_ms = now_ms
        task = self.task
        if task.wait != NOTHING:
            if now_ms < task.wake_ms:
                return WAITING
            if task.wait == MOVE:
                self.robot.motors(0, 0)
            task.wait = NOTHING
        self.status = RUNNING
        steps = self._steps
        offset, pc = self.offset, task.pc
        steps_left = most_steps
        try:
            for steps_left in range(most_steps - 1, -1, -1):  # noqa: B007 - asked for after the loop
                offset = pc
                pc = steps[offset]()
                if pc < 0:
                    pc = offset if pc == STAY else mark_stop(pc)
                    break
        except Fault as fault:
            self.robot.off()
            self.status, self.fault = FAULT, fault.name
            pc = instruction_at(self._code, offset)[1]
        self.offset, task.pc = offset, pc
        self.steps += most_steps - steps_left
        return self.status
