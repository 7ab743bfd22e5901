"""Every program of the documents, the cases and the examples, with the robot that it is for."""

from __future__ import annotations

import re
from typing import NamedTuple

from tests.support.casefile import ROOT, all_cases, example_robot
from tiniscript import ProgramError, compile, robots
from tiniscript.diagnostics.rendering import Message
from tiniscript.library.named_robot import shipped_name_in

_ROBOT = re.compile(r"^\s*robot\s*=\s*(\w+)", re.MULTILINE)


class Program(NamedTuple):
    name: str
    text: str
    robot: str


def programs() -> list[Program]:
    program_list = []
    for case in all_cases():
        if "tiniscript" in case.parts:
            named_match = _ROBOT.search(case.parts.get("senses", ""))
            case_robot = shipped_name_in(case.parts["tiniscript"].encode()) or "tinibot"
            robot = (
                named_match[1] if named_match and named_match[1] in robots.names() else case_robot
            )
            program_list.append(Program(case.id, case.parts["tiniscript"], robot))
    for path in sorted((ROOT / "examples").glob("*.ts")):
        program_list.append(
            Program(path.name, path.read_text(encoding="utf-8"), example_robot(path))
        )
    return program_list


def image(program: Program) -> str:
    """Return the image that `tsc compile` makes, in hexadecimal; none if there are mistakes."""
    try:
        return compile(program.text, program.robot).image.hex()
    except ProgramError:
        return ""


# Reported at the upload of a correct program that the robot cannot run.
MISSING_PART_CODES = ("TS313", "TS315")


def messages_of(text: str, language: str) -> list[Message]:
    """Return the messages of `tsc compile` about a program."""
    try:
        return list(compile(text, language=language).diagnostics)
    except ProgramError as error:
        return list(error.diagnostics)
