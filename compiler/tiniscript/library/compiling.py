"""The whole road, a line for each stage: text, tokens, AST, IR, instructions, image.

The command, the page and the functions of the library use it. It prints nothing, opens no files and
needs only the standard library. It imports what only wrong programs need only for them.
"""

from __future__ import annotations

import gc
from collections.abc import Callable
from functools import cache
from typing import NamedTuple

from tiniscript.base.kit import KIT_WORDS_SINCE, Kit
from tiniscript.base.limits import CODE_BYTES
from tiniscript.base.source import Source, Span, Unreadable, decode
from tiniscript.bytecode.image import GO, TASKS, Image, checksum, isa_of, pack
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


class Compilation(NamedTuple):
    """The result of compiling a text. If a diagnostic is a mistake, `image` is empty.

    `program` is the checked program, as written, and `lowered_program` the source of the code;
    `locations` says where in the text each instruction comes from, `yes_no_flags` which of its
    variables are a yes/no.
    """

    source: Source
    diagnostics: list[codes.Diagnostic]
    program: ir.Program | None = None
    code: bytes = b""
    locations: tuple[SourceLocation, ...] = ()
    verdict: Verdict | None = None
    image: bytes = b""
    lowered_program: ir.Program | None = None
    yes_no_flags: tuple[bool, ...] = ()

    @property
    def variables(self) -> tuple[str, ...]:
        """The names of the code's variables, in the order of their numbers."""
        return self.lowered_program.variables if self.lowered_program is not None else ()

    @property
    def is_right(self) -> bool:
        return not any(diagnostic.is_mistake for diagnostic in self.diagnostics)


def check_text(text: str, kit: Kit, name: str = "") -> Compilation:
    """Return the checked program of a text, and all that is wrong with it."""
    compilation = analyze(text, kit, name)
    return compilation if compilation.is_right else _add_findings(compilation, kit)


def _add_findings(compilation: Compilation, kit: Kit) -> Compilation:
    """Return a wrong program with its diagnostics."""
    from tiniscript.recovery.told import diagnose

    diagnostics_of = cache(
        lambda text: analyze(text, kit).diagnostics
    )  # a repair is asked for again
    own_kit = _kit_in(compilation.source.text, kit)
    return compilation._replace(
        diagnostics=diagnose(compilation.source, compilation.diagnostics, diagnostics_of, own_kit)
    )


def analyze(text: str, kit: Kit, name: str = "") -> Compilation:
    """Return the checked program of a text with its diagnostics; repairs are not verified."""
    source = Source(text, name)
    parse_result = parse(source)
    kit = _kit_in(text, kit)
    check_result = check(source, parse_result.program, kit)
    diagnostics = [*parse_result.diagnostics, *check_result.diagnostics]
    if not any(diagnostic.is_mistake for diagnostic in diagnostics):
        diagnostics += lint(check_result.program, kit, source, parse_result.scan)
        if kit.given_words:
            from tiniscript.syntax.later_words import report_given_way

            diagnostics += report_given_way(parse_result.scan.tokens, kit, source)
    return Compilation(source, codes.in_order(diagnostics), check_result.program)


def _kit_in(text: str, kit: Kit) -> Kit:
    """Return the kit as a program has it: without the words that have given way there."""
    upper_text = text.upper()
    if not any(word in upper_text for word in KIT_WORDS_SINCE):
        return kit
    from tiniscript.syntax.later_words import kit_for_text

    return kit_for_text(text, kit)


def check_size(compilation: Compilation, robot: Robot, is_mistake: bool) -> Compilation:
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


def fit_to_robot(compilation: Compilation, robot: Robot) -> Compilation:
    """Return `compilation`, with a mistake and no image if the robot lacks something that it uses.

    For a program that is about to be sent to a robot, even a virtual one.
    """
    program, verdict = compilation.program, compilation.verdict
    if program is None or verdict is None or not compilation.is_right:
        return compilation
    asks_remote = robot.kit.asks_remote(verdict.uses)
    if not verdict.needs and not asks_remote:
        return compilation
    from tiniscript.library.known_kits import has_remote, lacks

    feature_checks = (
        (codes.NO_TASKS, TASKS, program.tasks[0].word if program.tasks else None),
        (codes.NO_WAYS, GO, ir.first_extent_move(program)),
    )
    missing_features = [
        codes.Diagnostic(code, span, {"robot": robot.name})
        for code, need, span in feature_checks
        if span is not None and lacks(need, robot)
    ]
    if asks_remote and not has_remote(robot):
        missing_features.append(_remote_missing(compilation, robot))
    if not missing_features:
        return compilation
    return compilation._replace(
        diagnostics=codes.in_order([*compilation.diagnostics, *missing_features]), image=b""
    )


def _remote_missing(compilation: Compilation, robot: Robot) -> codes.Diagnostic:
    """Return the mistake of a program that asks a remote control which the robot does not have."""
    from tiniscript.bytecode.disassembly import devices_of, rows

    first_row = next(
        row for row in rows(compilation.code) if robot.kit.asks_remote(devices_of(row))
    )
    span = max(
        location for location in compilation.locations if location.offset <= first_row.offset
    ).span
    return codes.Diagnostic(codes.NO_REMOTE, span, {"robot": robot.name})


def compile_text(text: str, kit: Kit, name: str = "", optimize: bool = True) -> Compilation:
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


def _compile(text: str, kit: Kit, name: str, optimize: bool) -> Compilation:
    compilation = check_text(text, kit, name)
    program = compilation.program
    if program is None or not compilation.is_right:
        return compilation
    if program.tasks and any(procedure.values for procedure in program.procedures):
        from tiniscript.semantics.task_copies import copy_defs_per_task

        program = copy_defs_per_task(program)
    yes_no_flags = tuple(ir.yes_no_variables(program, kit))
    program = optimize_program(program) if optimize else program
    lowered_code = lower(program)
    if len(lowered_code.code) > CODE_BYTES:
        values = {"limit": str(CODE_BYTES), "over": str(len(lowered_code.code) - CODE_BYTES)}
        end_span = Span(len(text), len(text))
        diagnostic = codes.Diagnostic(codes.CODE_TOO_LONG, end_span, values)
        return compilation._replace(diagnostics=[*compilation.diagnostics, diagnostic])
    verdict = verify(lowered_code.code, len(kit.readings), len(kit.actuators))
    devices_hash = kit.hash_of_used(verdict.uses)
    image = pack(program.start, devices_hash, lowered_code.code, needs=verdict.needs)
    return compilation._replace(
        lowered_program=program,
        code=lowered_code.code,
        locations=lowered_code.locations,
        verdict=verdict,
        image=image,
        yes_no_flags=yes_no_flags,
    )


def compile_source(
    data: bytes,
    robot: Robot,
    name: str,
    is_strict: bool,
    optimize: bool = True,
    names_robots: bool = True,
    is_chosen: bool = False,
) -> Compilation:
    """Return the result of compiling a program's text.

    `is_strict`: a program that is too large for the robot is a mistake, otherwise a warning.
    `names_robots`: a word of another robot is said to be that; not if no other can be chosen.
    `is_chosen`: the user chose the robot; otherwise `named_robot` finds it in the text.
    """
    text = text_of(data, name)
    if not isinstance(text, str):
        return text
    unknown_robot_diagnostic = None if is_chosen else unknown_robot(text)
    if unknown_robot_diagnostic is not None:  # the words of an unknown robot are unknown
        return Compilation(Source(text, name), [unknown_robot_diagnostic])
    compilation = compile_text(text, robot.kit, name, optimize)
    if not compilation.is_right:
        return add_robot_hints(compilation, robot, is_chosen) if names_robots else compilation
    return check_size(compilation, robot, is_strict)


def add_robot_hints(compilation: Compilation, robot: Robot, is_chosen: bool = False) -> Compilation:
    """Return `compilation` with hints to the robots that have a word that this robot lacks."""
    from tiniscript.library.other_robots import with_robot_hints

    diagnostics = with_robot_hints(
        compilation.diagnostics, compilation.source.text, robot, is_chosen
    )
    return compilation._replace(diagnostics=diagnostics)


def text_of(data: bytes, name: str) -> str | Compilation:
    """Return a program's text, or a result with one diagnostic where the bytes are no text."""
    try:
        return decode(data)
    except Unreadable as error:
        reasons = {"too_large": codes.TOO_LARGE, "binary": codes.BINARY}
        code = reasons.get(error.reason, codes.NOT_UTF8)
        return Compilation(Source("", name), [codes.Diagnostic(code, Span(0, 0))])


def image_of(compilation: Compilation, robot: Robot) -> Image:
    """Return the image of a program without mistakes."""
    assert compilation.program is not None and compilation.verdict is not None
    devices_hash, needs = (
        robot.kit.hash_of_used(compilation.verdict.uses),
        compilation.verdict.needs,
    )
    isa = isa_of(compilation.code, needs)
    return Image(compilation.program.start, devices_hash, compilation.code,
                 checksum(compilation.image), isa, needs=needs)  # fmt: skip


def image_maker(robot: Robot) -> Callable[[str], Image | None]:
    """Return a function that compiles a text for a robot; it returns None for texts with
    mistakes.
    """

    def make_image(text: str) -> Image | None:
        compilation = compile_source(text.encode(), robot, "", is_strict=True)
        return image_of(compilation, robot) if compilation.is_right else None

    return make_image


def used_fingerprint(compilation: Compilation, robot: Robot) -> int:
    """Return the fingerprint of the kit whose words a program uses, or 0 for none."""
    assert compilation.verdict is not None
    return robot.kit.fingerprint if compilation.verdict.uses else 0
