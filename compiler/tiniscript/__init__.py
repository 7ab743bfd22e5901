"""TiniScript: from a line of text to what a robot does.

For programs in Python there are `compile`, `check`, `run`, `show`, `connect` and `virtual_robot`:
`docs/api.en.md`. They are in `library/`, and are imported when they are used.

`compile_text` is the whole road, a line for each stage: text, tokens, tree, program,
instructions, image. It prints nothing, opens nothing and needs the standard library alone.
"""

from __future__ import annotations

import gc
from typing import TYPE_CHECKING, NamedTuple

__version__ = "0.2.0"

if TYPE_CHECKING:
    from tiniscript.bytecode.verify import Verdict
    from tiniscript.codegen.lower import Place
    from tiniscript.diagnostics.codes import Diagnostic
    from tiniscript.diagnostics.rendering import Message
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
    from tiniscript.library.programs import Program, check, compile, show
    from tiniscript.library.runs import Fault, Trace, TraceEvent, run
    from tiniscript.library.simulated import VirtualRobotConnection, virtual_robot
    from tiniscript.robots.profile import Robot
    from tiniscript.semantics import ir
    from tiniscript.source import Source

__all__ = (  # what `docs/api.en.md` promises
    "Ending",
    "Fault",
    "Message",
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
    "diagnostics.rendering": ("Message",),
    "library.connecting": ("connect",),
    "library.connection": ("Receipt", "RobotConnection", "RobotInfo"),
    "library.events": ("Ending", "RobotEvent"),
    "library.errors": (
        "ProgramError",
        "RobotError",
        "StopNotConfirmed",
        "TiniScriptError",
        "UsageError",
    ),
    "library.programs": ("Program", "check", "compile", "show"),
    "library.runs": ("Fault", "Trace", "TraceEvent", "run"),
    "library.simulated": ("VirtualRobotConnection", "virtual_robot"),
}

if not TYPE_CHECKING:

    def __getattr__(name: str) -> object:
        """Import what is asked for: so `import tiniscript` imports nothing else."""
        for home, names in _HOMES.items():
            if name in names:
                from importlib import import_module

                found = getattr(import_module(f"tiniscript.{home}"), name)
                globals()[name] = found
                return found
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

    def __dir__() -> list[str]:
        return sorted({*globals(), *__all__})


class Compiled(NamedTuple):
    """What became of a text. Where a diagnostic is a mistake, `image` is empty.

    `program` is the checked program, as written; `places` says where in the text each
    instruction comes from.
    """

    source: Source
    diagnostics: list[Diagnostic]
    program: ir.Program | None = None
    code: bytes = b""
    places: tuple[Place, ...] = ()
    verdict: Verdict | None = None
    image: bytes = b""

    @property
    def is_right(self) -> bool:
        return not any(diagnostic.is_mistake for diagnostic in self.diagnostics)


def check_text(text: str, kit: Kit, name: str = "") -> Compiled:
    """Return the checked program of a text, and all that is wrong with it."""
    found = _checked(text, kit, name)
    if found.is_right:
        return found
    from tiniscript.diagnostics.codes import in_order
    from tiniscript.recovery.findings import findings, moved_back
    from tiniscript.source import applied

    answered = findings(found.source, found.diagnostics, lambda it: _checked(it, kit).diagnostics)
    if answered:
        edits = [edit for each in answered if each.repair for edit in each.repair.edits]
        rest = check_text(applied(text, edits), kit)
        if not rest.is_right:  # else its warnings come when it is repaired
            answered += [moved_back(each, edits) for each in rest.diagnostics]
        return found._replace(diagnostics=in_order(answered))
    from tiniscript.repairs.def_order import with_moved_defs
    from tiniscript.repairs.everywhere import said_once
    from tiniscript.repairs.vouching import vouched
    from tiniscript.repairs.whole_blocks import with_whole_blocks

    def offered(result: Compiled) -> list[Diagnostic]:
        kept = vouched(result.diagnostics, result.source, lambda it: _checked(it, kit).diagnostics)
        return said_once(kept, result.source)

    def offered_in(text: str) -> list[Diagnostic]:
        return offered(_checked(text, kit))

    kept = with_moved_defs(offered(found), found.source, offered_in)
    kept = with_whole_blocks(kept, found.source, offered_in)
    return found._replace(diagnostics=kept)


def _checked(text: str, kit: Kit, name: str = "") -> Compiled:
    """Return the checked program of a text, and what is wrong with it; no repair is vouched for."""
    from tiniscript.diagnostics.codes import in_order
    from tiniscript.semantics.checker import check
    from tiniscript.semantics.empty_blocks import empty_blocks
    from tiniscript.semantics.lint import advice
    from tiniscript.source import Source
    from tiniscript.syntax.parser import parse

    source = Source(text, name)
    parsed = parse(source, kit)
    checked = check(source, parsed.program, kit)
    found = [*parsed.diagnostics, *checked.diagnostics]
    if any(diagnostic.is_mistake for diagnostic in found):
        from tiniscript.semantics.joining import joined

        found = joined(found, source, parsed.scan.tokens, kit)
    else:
        found += advice(checked.program, kit, source)
        found += empty_blocks(checked.program, source)
        if parsed.scan.comments:
            from tiniscript.semantics.notes import in_notes

            found += in_notes(parsed.scan.comments, parsed.scan.tokens, source)
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
    diagnostic = codes.Diagnostic(code, Span(end, end), values)
    return compiled._replace(diagnostics=[*compiled.diagnostics, diagnostic])


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
        diagnostic = codes.Diagnostic(codes.CODE_TOO_LONG, place, over)
        return compiled._replace(diagnostics=[*compiled.diagnostics, diagnostic])
    verdict = verify(lowered.code, len(kit.sensors), len(kit.actuators))
    image = pack(program.start, kit.hash_of_used(verdict.uses), lowered.code)
    return compiled._replace(code=lowered.code, places=lowered.places, verdict=verdict, image=image)
