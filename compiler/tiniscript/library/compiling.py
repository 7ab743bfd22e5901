"""The whole road, a line for each stage: text, tokens, AST, IR, instructions, image.

The command, the page and the functions of the library use it. It prints nothing, opens nothing and
needs the standard library alone. What only wrong programs need is imported for them.
"""

from __future__ import annotations

import gc
from collections.abc import Callable
from functools import cache
from typing import NamedTuple

from tiniscript.base.kit import KIT_WORDS_SINCE, Kit
from tiniscript.base.limits import CODE_BYTES
from tiniscript.base.source import Source, Span, Unreadable, decode
from tiniscript.bytecode.image import GO, TASKS, Image, checksum, isa_for_needs, pack
from tiniscript.bytecode.verify import Verdict, verify
from tiniscript.codegen.lower import SourceLocation, lower
from tiniscript.diagnostics import codes
from tiniscript.library.named_robot import unknown_robot
from tiniscript.robots.profile import Robot
from tiniscript.semantics import ir
from tiniscript.semantics.checker import check
from tiniscript.semantics.lint import lint
from tiniscript.semantics.optimizer import optimize_program
from tiniscript.syntax.parser import parse


class Compiled(NamedTuple):
    """What became of a text. Where a diagnostic is a mistake, `image` is empty.

    `program` is the checked program, as written, and `lowered` what the code was made of; `places`
    says where in the text each instruction comes from, `yes_no` which of its variables are a
    yes/no.
    """

    source: Source
    diagnostics: list[codes.Diagnostic]
    program: ir.Program | None = None
    code: bytes = b""
    places: tuple[SourceLocation, ...] = ()
    verdict: Verdict | None = None
    image: bytes = b""
    lowered: ir.Program | None = None
    yes_no: tuple[bool, ...] = ()

    @property
    def variables(self) -> tuple[str, ...]:
        """The names of the code's variables, in the order of their numbers."""
        return self.lowered.variables if self.lowered is not None else ()

    @property
    def is_right(self) -> bool:
        return not any(diagnostic.is_mistake for diagnostic in self.diagnostics)


def check_text(text: str, kit: Kit, name: str = "") -> Compiled:
    """Return the checked program of a text, and all that is wrong with it."""
    compilation = analyze(text, kit, name)
    return compilation if compilation.is_right else _add_findings(compilation, kit)


def _add_findings(compilation: Compiled, kit: Kit) -> Compiled:
    """Return a wrong program with what is told of it."""
    from tiniscript.recovery.told import diagnose

    diagnostics_of = cache(
        lambda text: analyze(text, kit).diagnostics
    )  # a repair is asked for again
    own_kit = _kit_in(compilation.source.text, kit)
    return compilation._replace(
        diagnostics=diagnose(compilation.source, compilation.diagnostics, diagnostics_of, own_kit)
    )


def analyze(text: str, kit: Kit, name: str = "") -> Compiled:
    """Return the checked program of a text, and what is wrong with it; no repair is vouched for."""
    source = Source(text, name)
    parsed = parse(source)
    kit = _kit_in(text, kit)
    checked = check(source, parsed.program, kit)
    diagnostics = [*parsed.diagnostics, *checked.diagnostics]
    if not any(diagnostic.is_mistake for diagnostic in diagnostics):
        diagnostics += lint(checked.program, kit, source, parsed.scan)
        if kit.given_words:
            from tiniscript.syntax.later_words import report_given_way

            diagnostics += report_given_way(parsed.scan.tokens, kit, source)
    return Compiled(source, codes.in_order(diagnostics), checked.program)


def _kit_in(text: str, kit: Kit) -> Kit:
    """Return the kit as a program has it: without the words that have given way there."""
    sentence = text.upper()
    if not any(word in sentence for word in KIT_WORDS_SINCE):
        return kit
    from tiniscript.syntax.later_words import kit_for_text

    return kit_for_text(text, kit)


def check_size(compilation: Compiled, robot: Robot, is_mistake: bool) -> Compiled:
    """Return `compilation` with a message if the robot's memory is too small."""
    excess_bytes = len(compilation.code) - robot.board.program_bytes
    if excess_bytes <= 0:
        return compilation
    code = codes.BOARD_TOO_SMALL if is_mistake else codes.BOARD_MAY_BE_TOO_SMALL
    values = {"robot": robot.name, "limit": str(robot.board.program_bytes),
              "code": str(len(compilation.code)), "over": str(excess_bytes)}  # fmt: skip
    end = len(compilation.source.text)
    diagnostic = codes.Diagnostic(code, Span(end, end), values)
    return compilation._replace(diagnostics=[*compilation.diagnostics, diagnostic])


def fit_to_robot(compilation: Compiled, robot: Robot) -> Compiled:
    """Return `compilation`, with a mistake and no image where the robot lacks what it uses.

    For what is about to be sent to a robot, a virtual one too.
    """
    program, verdict = compilation.program, compilation.verdict
    if program is None or verdict is None or not compilation.is_right:
        return compilation
    asks_remote = robot.kit.asks_remote(verdict.uses)
    if not verdict.needs and not asks_remote:
        return compilation
    from tiniscript.library.known_kits import has_remote, lacks

    needed = (
        (codes.NO_TASKS, TASKS, program.tasks[0].word if program.tasks else None),
        (codes.NO_WAYS, GO, ir.first_extent_move(program)),
    )
    missing_features = [
        codes.Diagnostic(code, span, {"robot": robot.name})
        for code, missing, span in needed
        if span is not None and lacks(missing, robot)
    ]
    if asks_remote and not has_remote(robot):
        missing_features.append(_remote_missing(compilation, robot))
    if not missing_features:
        return compilation
    return compilation._replace(
        diagnostics=codes.in_order([*compilation.diagnostics, *missing_features]), image=b""
    )


def _remote_missing(compilation: Compiled, robot: Robot) -> codes.Diagnostic:
    """Return the mistake of a program that asks a remote control which the robot does not have."""
    from tiniscript.bytecode.disassembly import devices_of, rows

    first = next(row for row in rows(compilation.code) if robot.kit.asks_remote(devices_of(row)))
    span = max(place for place in compilation.places if place.offset <= first.offset).span
    return codes.Diagnostic(codes.NO_REMOTE, span, {"robot": robot.name})


def compile_text(text: str, kit: Kit, name: str = "", optimize: bool = True) -> Compiled:
    """Return the image of a text for robots with this kit, or all that is wrong with it.

    The garbage collector pauses meanwhile: there are many small values and no cycles among
    them, and looking for some would make long texts slower than in proportion.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        return _compile(text, kit, name, optimize)
    finally:
        if was_enabled:
            gc.enable()


def _compile(text: str, kit: Kit, name: str, optimize: bool) -> Compiled:
    compilation = check_text(text, kit, name)
    program = compilation.program
    if program is None or not compilation.is_right:
        return compilation
    if program.tasks and any(procedure.values for procedure in program.procedures):
        from tiniscript.semantics.task_copies import copy_defs_per_task

        program = copy_defs_per_task(program)
    yes_no = tuple(ir.yes_no_variables(program, kit))
    program = optimize_program(program) if optimize else program
    lowered = lower(program)
    if len(lowered.code) > CODE_BYTES:
        values = {"limit": str(CODE_BYTES), "over": str(len(lowered.code) - CODE_BYTES)}
        place = Span(len(text), len(text))
        diagnostic = codes.Diagnostic(codes.CODE_TOO_LONG, place, values)
        return compilation._replace(diagnostics=[*compilation.diagnostics, diagnostic])
    verdict = verify(lowered.code, len(kit.readings), len(kit.actuators))
    devices = kit.hash_of_used(verdict.uses)
    image = pack(program.start, devices, lowered.code, needs=verdict.needs)
    return compilation._replace(lowered=program, code=lowered.code, places=lowered.locations,
                                verdict=verdict, image=image, yes_no=yes_no)  # fmt: skip


def compile_source(
    data: bytes,
    robot: Robot,
    name: str,
    is_strict: bool,
    optimize: bool = True,
    names_robots: bool = True,
    is_chosen: bool = False,
) -> Compiled:
    """Return the result of compiling a program's text.

    `is_strict`: a program that is too large for the robot is a mistake, else a warning.
    `names_robots`: a word of another robot is said to be that; not where no other can be chosen.
    `is_chosen`: the robot is what somebody has chosen, else what `named_robot` says of the text.
    """
    text = text_of(data, name)
    if not isinstance(text, str):
        return text
    unknown_robot_diagnostic = None if is_chosen else unknown_robot(text)
    if unknown_robot_diagnostic is not None:  # which words there are nobody knows
        return Compiled(Source(text, name), [unknown_robot_diagnostic])
    result = compile_text(text, robot.kit, name, optimize)
    if not result.is_right:
        return add_robot_hints(result, robot, is_chosen) if names_robots else result
    return check_size(result, robot, is_strict)


def add_robot_hints(compilation: Compiled, robot: Robot, is_chosen: bool = False) -> Compiled:
    """Return `compilation` with hints to the robots that have a word that this robot lacks."""
    from tiniscript.library.other_robots import with_robot_hints

    diagnostics = with_robot_hints(
        compilation.diagnostics, compilation.source.text, robot, is_chosen
    )
    return compilation._replace(diagnostics=diagnostics)


def text_of(data: bytes, name: str) -> str | Compiled:
    """Return a program's text, or a result with one diagnostic where the bytes are no text."""
    try:
        return decode(data)
    except Unreadable as unreadable:
        reasons = {"too_large": codes.TOO_LARGE, "binary": codes.BINARY}
        code = reasons.get(unreadable.reason, codes.NOT_UTF8)
        return Compiled(Source("", name), [codes.Diagnostic(code, Span(0, 0))])


def image_of(compilation: Compiled, robot: Robot) -> Image:
    """Return the image of a program without mistakes."""
    assert compilation.program is not None and compilation.verdict is not None
    devices, needs = robot.kit.hash_of_used(compilation.verdict.uses), compilation.verdict.needs
    return Image(compilation.program.start, devices, compilation.code,
                 checksum(compilation.image), isa_for_needs(needs), needs=needs)  # fmt: skip


def image_maker(robot: Robot) -> Callable[[str], Image | None]:
    """Return what makes the image of a text for a robot, or None where the text has mistakes."""

    def make(text: str) -> Image | None:
        result = compile_source(text.encode(), robot, "", is_strict=True)
        return image_of(result, robot) if result.is_right else None

    return make


def kit_of(compilation: Compiled, robot: Robot) -> int:
    """Return the fingerprint of the kit whose words a program uses, or 0 for none."""
    assert compilation.verdict is not None
    return robot.kit.fingerprint if compilation.verdict.uses else 0
