"""`tsc lesson check`: one program, or every program of a folder, in the worlds of a lesson.

Decides which messages a program gets, and in which form; `lessons.running` lets it drive, and
`lessons.judging` compares.
"""

from __future__ import annotations

import json
import os
import re
import sys
import textwrap
import unicodedata
from argparse import Namespace
from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from pathlib import Path
from shutil import get_terminal_size
from typing import NamedTuple

from rich.cells import cell_len, set_cell_size

from tiniscript import robots
from tiniscript.base.source import PROGRAM_SUFFIXES, Unreadable, decode, printable
from tiniscript.cli import compilations, inputs, outputs
from tiniscript.cli.errors import CommandError, missing_package_error
from tiniscript.cli.options import whole_number
from tiniscript.cli.program_files import ProgramFile, in_folder, read
from tiniscript.cli.robot.simulator_options import check_picture, draw_picture
from tiniscript.cli.spreadsheet import as_csv
from tiniscript.cli.texts import say, text
from tiniscript.diagnostics.rendering import message
from tiniscript.lessons.findings import Finding
from tiniscript.lessons.lesson import Lesson
from tiniscript.lessons.marking import Marking
from tiniscript.lessons.running import Run
from tiniscript.lessons.sentences import sentence
from tiniscript.library.compiling import Compilation, fit_to_robot, image_maker
from tiniscript.library.named_robot import robot_of, shipped_name_in
from tiniscript.robots.profile import Robot
from tiniscript.virtual.module import NoWebAssembly
from tiniscript.virtual.world import WorldRefused

MAX_PROGRAMS = 200  # most programs in a folder
MIN_COLUMNS = 24  # columns that a sentence needs next to its program; otherwise below it
TEXT_SUFFIXES = (*PROGRAM_SUFFIXES, ".txt")
NOTES_NAME = re.compile(r"(?:read ?me|leeme|notes|notas)(?![^\W\d_])", re.IGNORECASE)  # names
# A line of a program begins so, also a wrong one: `SI|`, `SI`, `F 2`, `ADELANTE (2)`, `x = 3`.
PROGRAM_LINE = re.compile(
    r"[ \t]*(?:\w+(?:[ \t]*[|=]|\(|[ \t]+\([ \t]*\d)|S[IB][ \t]*(?:[;:,.]|$)|[A-Z][ \t]*\d)",
    re.IGNORECASE,
)
PASSED, FAILED, MISTAKES, UNREADABLE = "passed", "failed", "mistakes", "unreadable"
NO_PROGRAM = "no_program"  # notes next to the programs; they are ignored


class Mark(NamedTuple):
    """The result of a program. `seed` is the world in which it failed, or 0.

    `sentences` are pairs of a criterion's kind and a sentence; `run` is the last run.
    """

    name: str
    verdict: str
    seed: int
    sentences: tuple[tuple[str, str], ...]
    run: Run | None = None


def check(options: Namespace, lesson: Lesson, language: str) -> int:
    seeds: Sequence[int] = range(1, lesson.world_count + 1)
    if options.seed is not None:
        seeds = [whole_number("--seed", options.seed, 1, 1, 2**32 - 1, language)]
    if options.program is None and not options.texts:
        raise CommandError(2, "lesson_no_program", number=inputs.printable_name(options.number))

    marker = _Marker(lesson, robots.load(lesson.robot), seeds, language)
    if _is_folder(options):
        if options.plot is not None:
            raise CommandError(2, "lesson_one_picture", file=inputs.printable_name(options.program))
        marks = [marker.mark_file(program_file, name) for name, program_file in _programs(options)]
        _name_notes(marks, options, language)
    else:
        if options.plot is not None:
            check_picture(options)
        program_input = inputs.program(options)
        compilation = marker.compile(program_input)
        if not options.json:
            outputs.print_diagnostics(compilation, language)
        marks = [marker.mark(program_input, compilation)]
    if options.csv is not None:
        outputs.write(Path(options.csv), _as_csv(marks, language), "unwritable_more --csv")
    if options.plot is not None and marks[0].run is not None:
        draw_picture(options, marks[0].run.robot, language)
    if options.json:
        print(json.dumps([_mark_data(mark) for mark in marks], indent=2, ensure_ascii=False))
    elif _is_folder(options):
        _print_table(marks, options, language)
    else:
        _print_one(marks[0], seeds, options, language)
    return 0 if all(mark.verdict in (PASSED, NO_PROGRAM) for mark in marks) else 1


class _Marker:
    """Marks programs by one lesson."""

    def __init__(self, lesson: Lesson, robot: Robot, seeds: Sequence[int], language: str) -> None:
        self.lesson = lesson
        self.robot = robot
        self.seeds = seeds
        self.language = language

    def mark_file(self, file: ProgramFile, name: str) -> Mark:
        """Mark a file of a folder; one that cannot be read, and notes, get a row, too."""
        if _is_note(file):
            return Mark(name, NO_PROGRAM, 0, ())
        program_input = inputs.Input(name, file.data, Path(file.name))
        try:
            if file.problem is not None:
                raise file.problem
            compilation = self.compile(program_input)
        except CommandError as error:
            problem_text = error.plain_sentence(self.language)
            problem_text = problem_text.replace(
                inputs.printable_name(file.name), inputs.printable_name(name)
            )
            return Mark(name, UNREADABLE, 0, (("", problem_text),))
        return self.mark(program_input, compilation)

    def compile(self, program_input: inputs.Input) -> Compilation:
        if program_input.is_image:
            raise CommandError(
                2, "needs_text", file=inputs.printable_name(program_input.name), verb="lesson check"
            )
        robot = robot_of(program_input.data, self.robot)
        compilation = compilations.compile_input(
            program_input, robot, is_strict=True, names_robots=False
        )
        return fit_to_robot(compilation, robot)

    def mark(self, program_input: inputs.Input, compilation: Compilation) -> Mark:
        if not compilation.is_right:
            return Mark(program_input.name, MISTAKES, 0, tuple(self._mistakes(compilation)))
        robot = robot_of(program_input.data, self.robot)
        lesson = self.lesson._replace(
            robot=shipped_name_in(program_input.data) or self.lesson.robot
        )
        marking = Marking(compilation.source.text, image_maker(robot), robot, lesson, self.seeds)
        try:
            outcome = marking.run_to_end()
        except WorldRefused as error:
            values = {"file": inputs.printable_name(self.lesson.name), "seed": str(marking.seed)}
            raise inputs.refusal(error, self.language, "lesson_world", (), **values) from None
        except NoWebAssembly as error:
            raise missing_package_error("virtual_needs_wasmtime", error) from None
        return Mark(
            program_input.name,
            outcome.verdict,
            outcome.seed,
            self._finding_rows(outcome.findings),
            outcome.run,
        )

    def _finding_rows(self, findings: Iterable[Finding]) -> tuple[tuple[str, str], ...]:
        return tuple((finding.kind, sentence(finding, self.language)) for finding in findings)

    def _mistakes(self, compilation: Compilation) -> Iterable[tuple[str, str]]:
        for diagnostic in compilation.diagnostics:
            if diagnostic.is_mistake:
                mistake_message = message(diagnostic, compilation.source, self.language)
                values = {
                    "line": mistake_message.line,
                    "task": "",
                    "shown": mistake_message.message,
                }
                mistake_line = text("fault_line", self.language).format(**values)
                fix = (
                    text("lesson_try", self.language).format(fix=mistake_message.fix)
                    if mistake_message.fix
                    else ""
                )
                yield "", f"{mistake_line}   {fix}".strip()


def _is_folder(options: Namespace) -> bool:
    try:
        return options.program not in (None, "-") and Path(options.program).is_dir()
    except (OSError, ValueError):  # a name that no file can have
        return False


def _programs(options: Namespace) -> Iterator[tuple[str, ProgramFile]]:
    """Yield the files of a folder and those below, each with its name there.

    Raises CommandError.
    """
    folder = options.program
    try:
        os.scandir(folder).close()
    except OSError as error:
        raise CommandError(
            2, "lesson_folder", file=inputs.printable_name(folder), why=error
        ) from None
    names = list(islice(in_folder(folder, TEXT_SUFFIXES), MAX_PROGRAMS + 1))
    if len(names) > MAX_PROGRAMS:
        raise CommandError(
            2, "lesson_many", file=inputs.printable_name(folder), most=str(MAX_PROGRAMS)
        )
    for name in names:
        yield os.path.relpath(name, folder), read(name)


def _name_notes(marks: Sequence[Mark], options: Namespace, language: str) -> None:
    """Name the notes of a folder on standard error. Raises CommandError if all are notes."""
    notes = [inputs.printable_name(mark.name) for mark in marks if mark.verdict == NO_PROGRAM]
    if len(notes) == len(marks):
        raise CommandError(2, "lesson_empty", file=inputs.printable_name(options.program))
    if notes:
        sentence = text("lesson_notes", language)
        number = inputs.printable_name(options.number)
        print(sentence.format(files=", ".join(notes), number=number), file=sys.stderr)


def _is_note(file: ProgramFile) -> bool:
    """Return whether a `.txt` file is named like notes and has no line that looks like a program.

    When in doubt, it is a program: a pupil's work is marked, however wrong it is.
    """
    if file.name.lower().endswith(PROGRAM_SUFFIXES) or file.problem is not None:
        return False
    letters = unicodedata.normalize("NFD", Path(file.name).name)
    plain_name = "".join(letter for letter in letters if not unicodedata.combining(letter))
    if NOTES_NAME.match(plain_name) is None:
        return False

    try:
        text = decode(file.data)
    except Unreadable:
        return False
    return bool(text.strip()) and not any(map(PROGRAM_LINE.match, text.splitlines()))


def _print_one(mark: Mark, seeds: Sequence[int], options: Namespace, language: str) -> None:
    number, file = inputs.printable_name(options.number), inputs.printable_name(mark.name)
    if mark.verdict == MISTAKES:
        say("lesson_mistakes", language, file=file)
        return
    if mark.verdict == PASSED:
        key = "lesson_passed" if len(seeds) == 1 else "lesson_passed_worlds"
        say(key, language, file=file, number=number, worlds=len(seeds))
    else:
        key = "lesson_failed_world" if len(seeds) > 1 and mark.seed else "lesson_failed"
        say(key, language, file=file, seed=mark.seed)
        for _, sentence in mark.sentences:
            say("lesson_finding", language, said=sentence)
        if len(seeds) > 1 and mark.seed and not options.texts and mark.name != "-":
            say("lesson_again", language, number=number, file=file, seed=mark.seed)
    if options.plot is not None:
        say("picture", language, file=inputs.printable_name(options.plot))


def _print_table(marks: Sequence[Mark], options: Namespace, language: str) -> None:
    """Print a row for each program: its name, the verdict, and the first sentence."""
    rows = [
        (
            inputs.printable_name(mark.name),
            text(f"verdict_{mark.verdict}", language),
            _first_error(mark),
        )
        for mark in marks
    ]
    widths = [max(cell_len(row[k]) for row in rows) for k in (0, 1)]
    columns = get_terminal_size().columns if sys.stdout.isatty() else 0
    for name, verdict, shown_sentence in rows:
        prefix = f"{set_cell_size(name, widths[0])}  {set_cell_size(verdict, widths[1])}  "
        room = columns - cell_len(prefix) - 1
        if not columns or cell_len(shown_sentence) <= room:
            print(f"{prefix}{shown_sentence}".rstrip())
            continue
        if room < MIN_COLUMNS:  # the sentence has lines of its own
            print(prefix.rstrip())
            prefix, room = "    ", columns - 5
        for line in textwrap.wrap(shown_sentence, max(room, MIN_COLUMNS)):
            print(f"{prefix}{line}")
            prefix = " " * cell_len(prefix)
    passed_count = sum(mark.verdict == PASSED for mark in marks)
    count_text = text("lesson_count", language)
    number = inputs.printable_name(options.number)
    program_count = sum(mark.verdict != NO_PROGRAM for mark in marks)
    print(count_text.format(passed=passed_count, all=program_count, number=number))


def _first_error(mark: Mark) -> str:
    sentence = printable(mark.sentences[0][1], 300) if mark.sentences else ""
    return f"[{mark.seed}] {sentence}" if mark.seed else sentence


def _mark_data(mark: Mark) -> dict[str, object]:
    findings = [{"kind": kind, "sentence": sentence} for kind, sentence in mark.sentences]
    seed = mark.seed or None
    return {"file": mark.name, "verdict": mark.verdict, "seed": seed, "findings": findings}


def _as_csv(marks: Sequence[Mark], language: str) -> bytes:
    def cells(mark: Mark) -> tuple[object, ...]:
        verdict = text(f"csv_verdict_{mark.verdict}", language)
        return mark.name, verdict, mark.seed or "", mark.sentences[0][1] if mark.sentences else ""

    return as_csv("lesson", language, map(cells, marks))


__all__ = ("FAILED", "MISTAKES", "NO_PROGRAM", "PASSED", "UNREADABLE", "Mark", "check")
