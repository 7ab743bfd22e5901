"""TiniScript: from a line of text to what a robot does.

For programs in Python there are `compile`, `check`, `run`, `show`, `connect` and `virtual_robot`:
`docs/api.en.md`. They are in `library/`, and are imported when they are used.

`compile_text` is the whole road, a line for each stage: text, tokens, tree, program,
instructions, image. It prints nothing, opens nothing and needs the standard library alone.
"""

from __future__ import annotations

import gc
from typing import NamedTuple

__version__ = "0.1.0"

TYPE_CHECKING = False
if TYPE_CHECKING:
    from tiniscript.bytecode.verify import Verdict
    from tiniscript.codegen.lower import Place
    from tiniscript.diagnostics.codes import Problem
    from tiniscript.kit import Kit
    from tiniscript.library.connecting import connect
    from tiniscript.library.connection import Receipt, RobotConnection, RobotInfo
    from tiniscript.library.errors import (
        ProgramError,
        RobotError,
        StopNotConfirmed,
        TiniScriptError,
        UsageError,
    )
    from tiniscript.library.events import Ending, RobotEvent
    from tiniscript.library.programs import Diagnostic, Program, check, compile, show
    from tiniscript.library.runs import Fault, Trace, TraceEvent, run
    from tiniscript.library.simulated import VirtualRobotConnection, virtual_robot
    from tiniscript.robots.profile import Robot
    from tiniscript.semantics import ir
    from tiniscript.source import Source

__all__ = (  # what `docs/api.en.md` promises
    "Diagnostic",
    "Ending",
    "Fault",
    "Program",
    "ProgramError",
    "Receipt",
    "RobotConnection",
    "RobotError",
    "RobotEvent",
    "RobotInfo",
    "StopNotConfirmed",
    "TiniScriptError",
    "Trace",
    "TraceEvent",
    "UsageError",
    "VirtualRobotConnection",
    "check",
    "compile",
    "connect",
    "run",
    "show",
    "virtual_robot",
)
_HOMES = {
    "connecting": ("connect",),
    "connection": ("Receipt", "RobotConnection", "RobotInfo"),
    "events": ("Ending", "RobotEvent"),
    "errors": ("ProgramError", "RobotError", "StopNotConfirmed", "TiniScriptError", "UsageError"),
    "programs": ("Diagnostic", "Program", "check", "compile", "show"),
    "runs": ("Fault", "Trace", "TraceEvent", "run"),
    "simulated": ("VirtualRobotConnection", "virtual_robot"),
}

if not TYPE_CHECKING:

    def __getattr__(name: str) -> object:
        """Import what is asked for: so `import tiniscript` imports nothing else."""
        for home, names in _HOMES.items():
            if name in names:
                from importlib import import_module

                found = getattr(import_module(f"tiniscript.library.{home}"), name)
                globals()[name] = found
                return found
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

    def __dir__() -> list[str]:
        return sorted({*globals(), *__all__})


class Compiled(NamedTuple):
    """What became of a text. Where a problem is a mistake, `image` is empty.

    `program` is the checked program, as written; `places` says where in the text each
    instruction comes from.
    """

    source: Source
    problems: list[Problem]
    program: ir.Program | None = None
    code: bytes = b""
    places: tuple[Place, ...] = ()
    verdict: Verdict | None = None
    image: bytes = b""

    @property
    def is_right(self) -> bool:
        return not any(problem.is_mistake for problem in self.problems)


def check_text(text: str, kit: Kit, name: str = "") -> Compiled:
    """Return the checked program of a text, and all that is wrong with it."""
    from tiniscript.diagnostics.codes import in_order
    from tiniscript.semantics.checker import check
    from tiniscript.semantics.lint import advice
    from tiniscript.source import Source
    from tiniscript.syntax.parser import parse

    source = Source(text, name)
    parsed = parse(source, kit)
    checked = check(source, parsed.program, kit)
    found = [*parsed.problems, *checked.problems]
    if not any(problem.is_mistake for problem in found):
        found += advice(checked.program, kit)
    return Compiled(source, in_order(found), checked.program)


def fitting(compiled: Compiled, robot: Robot, is_mistake: bool) -> Compiled:
    """Return `compiled` with what there is to say where the robot's memory is too small."""
    from tiniscript.diagnostics import codes
    from tiniscript.source import Span

    over = len(compiled.code) - robot.board.program_bytes
    if over <= 0:
        return compiled
    code = codes.BOARD_TOO_SMALL if is_mistake else codes.BOARD_MAY_BE_TOO_SMALL
    values = {"robot": robot.name, "limit": str(robot.board.program_bytes),
              "code": str(len(compiled.code)), "over": str(over)}  # fmt: skip
    end = len(compiled.source.text)
    problem = codes.Problem(code, Span(end, end), values)
    return compiled._replace(problems=[*compiled.problems, problem])


def compile_text(text: str, kit: Kit, name: str = "", optimize: bool = True) -> Compiled:
    """Return the image of a text for robots with this kit, or all that is wrong with it.

    The garbage collector pauses meanwhile: there are many small values and no cycles among
    them, and looking for some would make long texts slower than in proportion.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        return _compiled(text, kit, name, optimize)
    finally:
        if was_enabled:
            gc.enable()


def _compiled(text: str, kit: Kit, name: str, optimize: bool) -> Compiled:
    from tiniscript.bytecode.image import pack
    from tiniscript.bytecode.opcodes import CODE_BYTES
    from tiniscript.bytecode.verify import verify
    from tiniscript.codegen.lower import lower
    from tiniscript.diagnostics import codes
    from tiniscript.semantics.optimizer import optimized
    from tiniscript.source import Span

    compiled = check_text(text, kit, name)
    program = compiled.program
    if program is None or not compiled.is_right:
        return compiled
    lowered = lower(optimized(program) if optimize else program)
    if len(lowered.code) > CODE_BYTES:
        over = {"limit": str(CODE_BYTES), "over": str(len(lowered.code) - CODE_BYTES)}
        place = Span(len(text), len(text))
        problem = codes.Problem(codes.CODE_TOO_LONG, place, over)
        return compiled._replace(problems=[*compiled.problems, problem])
    verdict = verify(lowered.code, len(kit.sensors), len(kit.actuators))
    image = pack(program.start, kit.fingerprint if verdict.uses_kit else 0, lowered.code)
    return compiled._replace(code=lowered.code, places=lowered.places, verdict=verdict, image=image)
