"""Compiles a text for the page: its image, and what to show in the editor.

Knows which repairs are offered as buttons: a check compiles the text once, and what a button does
is tried when somebody pauses. Lines and columns count from 1, columns in characters,
as in `tsc check --json`; the end is not included.
"""

from __future__ import annotations

from functools import cache, lru_cache
from typing import NamedTuple

from tiniscript import robots
from tiniscript.base.kit import REMOTE, Kit
from tiniscript.base.source import Edit, Source
from tiniscript.bytecode.statements import statement_of, statement_starts
from tiniscript.codegen.text.line import line_of
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.diagnostics.fixing import MAX_OFFERS, edits_of, edits_offered
from tiniscript.diagnostics.rendering import Message, message
from tiniscript.library import source_map
from tiniscript.library.compiling import Compilation, compile_source, fit_to_robot, text_of
from tiniscript.library.named_robot import robot_of, shipped_name_in
from tiniscript.library.shows import Show, Shows
from tiniscript.library.text_fitting import find_misfits
from tiniscript.robots.profile import Robot
from tiniscript.robots.text_levels import level_of


class Change(NamedTuple):
    """`text` takes the place of a range."""

    line: int
    column: int
    end_line: int
    end_column: int
    text: str


class Finding(NamedTuple):
    """A message as `tsc compile` prints it; `repair` decides whether it may have a button."""

    message: Message
    may_repair: bool
    on_blocks: Message


class Variable(NamedTuple):
    name: str
    is_yes_no: bool


class CheckResult(NamedTuple):
    """`image` is empty for programs with mistakes. `places` map each instruction's start to a range
    of the text, `halts` to the halt of a real robot before it, `shows` to the names of SHOWs, by
    offset; `variables` are in the order of their numbers; `start` is SI, SB or PING, or empty if
    there are mistakes; `robot` is the target, which the text names if `names_robot`; it reads the
    sensors of the robot with the numbers `read_sensors`, and the words `remote_words` of a remote
    control.
    """

    image: bytes
    code_bytes: int
    findings: tuple[Finding, ...]
    places: tuple[source_map.MapLocation, ...]
    halts: tuple[int, ...] = ()
    shows: tuple[tuple[int, Show], ...] = ()
    variables: tuple[Variable, ...] = ()
    start: str = ""
    robot: str = ""
    names_robot: bool = False
    read_sensors: tuple[int, ...] = ()
    remote_words: tuple[str, ...] = ()


def check(data: bytes, robot: str, language: str) -> CheckResult:
    """Compile a program's text for a shipped robot, or for the one that it names, as `tsc upload`
    does."""
    profile = profile_for(data, robot)
    compilation = _compile(data, robot)
    findings = _findings(compilation, language)
    names_robot = shipped_name_in(data) is not None
    if not compilation.is_right or compilation.program is None:
        return CheckResult(b"", 0, findings, (), robot=profile.name, names_robot=names_robot)
    variables = tuple(map(Variable, compilation.program.variables, compilation.yes_no_flags))
    program_map = source_map.map_of_compiled(compilation)
    read_sensors, remote_words = _read_devices(compilation, profile.kit)
    statement_offsets = statement_starts(compilation.code)
    halts = tuple(statement_of(statement_offsets, place.offset) for place in program_map.locations)
    return CheckResult(
        compilation.image,
        len(compilation.code),
        findings,
        program_map.locations,
        halts,
        _show_places(program_map),
        variables,
        compilation.program.start,
        profile.name,
        names_robot,
        read_sensors,
        remote_words,
    )


def _read_devices(compilation: Compilation, kit: Kit) -> tuple[tuple[int, ...], tuple[str, ...]]:
    """Return the numbers of the sensors that a program reads, and its words of a remote control."""
    used_devices = compilation.verdict.uses if compilation.verdict is not None else ()
    read_numbers = {number for device_kind, number in used_devices if device_kind == "sensor"}
    sensor_count = len(kit.sensors)
    sensors = tuple(sorted(number for number in read_numbers if number < sensor_count))
    remote = (device.name for k, device in enumerate(REMOTE, sensor_count) if k in read_numbers)
    return sensors, tuple(remote)


def _show_places(program_map: source_map.SourceMap) -> tuple[tuple[int, Show], ...]:
    shows = Shows(program_map)
    shows_by_offset = (
        (place.offset, shows.show_at(place.offset)) for place in program_map.locations
    )
    return tuple((offset, show) for offset, show in shows_by_offset if show)


def repair(data: bytes, robot: str, finding_number: int) -> tuple[Change, ...]:
    """Return the edits of a finding's button, or none if they do not help.

    `finding_number` counts the findings of this text from 0.
    """
    compilation = _compile(data, robot)

    def check(text: str) -> list[Diagnostic]:
        changed_bytes = text.encode()
        return compile_source(
            changed_bytes, profile_for(changed_bytes, robot), "", is_strict=True
        ).diagnostics

    edits = edits_offered(compilation.source.text, compilation.diagnostics, finding_number, check)
    return tuple(_change(edit, compilation.source) for edit in edits)


def open_text(data: bytes, robot: str, language: str) -> str | Message:
    """Return the text of a file, or its problem."""
    text = text_of(data, "")
    if isinstance(text, str):
        return text
    return message(text.diagnostics[0], text.source, language)


def line_for_robot(data: bytes, robot: str, language: str) -> str | Message:
    """Return a program as a line of text with its checksum, as `tsc compile --text` writes it.

    Or what is wrong, where such a robot cannot read it.
    """
    profile = profile_for(data, robot)
    compilation = compile_source(data, profile, "", is_strict=True)
    if not compilation.is_right or compilation.program is None:
        mistake = next(
            diagnostic for diagnostic in compilation.diagnostics if diagnostic.is_mistake
        )
        return message(mistake, compilation.source, language)
    level = level_of(profile.board.chip, profile.board.discs is not None)
    misfits = find_misfits(compilation.source, compilation.program, profile.kit, level)
    return (
        message(misfits[0], compilation.source, language)
        if misfits
        else line_of(compilation.source)
    )


@cache
def profile_of(robot: str) -> Robot:
    assert robot in robots.names(), robot  # the page has no profiles of its own
    return robots.load(robot)


def profile_for(data: bytes, robot: str) -> Robot:
    """Return the robot that a program's text names, otherwise the page's robot."""
    return robot_of(data, profile_of(robot))


@lru_cache(maxsize=1)  # the page asks for the edits of one program repeatedly
def _compile(data: bytes, robot: str) -> Compilation:
    profile = profile_for(data, robot)
    return fit_to_robot(compile_source(data, profile, "", is_strict=True), profile)


def _findings(compilation: Compilation, language: str) -> tuple[Finding, ...]:
    """Return the messages; the first of those that name changes may have a button."""
    repairable_indexes = [
        k for k, diagnostic in enumerate(compilation.diagnostics) if edits_of(diagnostic)
    ][:MAX_OFFERS]
    return tuple(
        Finding(
            message(diagnostic, compilation.source, language),
            k in repairable_indexes,
            message(diagnostic, compilation.source, language, is_on_blocks=True),
        )
        for k, diagnostic in enumerate(compilation.diagnostics)
    )


def _change(edit: Edit, source: Source) -> Change:
    start, end = edit.span
    return Change(*source.position(start), *source.position(end), edit.text)
