"""Prints a compiled program, instruction by instruction: as lines, or as data."""

from __future__ import annotations

import json

from tiniscript.bytecode.disassembly import disassemble, rows
from tiniscript.cli import images
from tiniscript.cli.texts import say, text
from tiniscript.library.programs import remarks
from tiniscript.robots.profile import Robot


def print_disassembly(
    ready_program: images.ReadyProgram, robot: Robot, name: str, language: str
) -> None:
    image = ready_program.image
    key = "for_robot" if image.devices else "any_robot"
    robot_text = text(key, language).format(robot=robot.name)
    say("head", language, file=name, start=image.start, robot=robot_text, code=len(image.code),
        image=ready_program.image_bytes, checksum=f"{image.checksum:08x}")  # fmt: skip
    remark_by_offset = remarks(ready_program.program_map, language)
    kit = robot.kit if image.devices else None
    variables = ready_program.program_map.variables if ready_program.program_map is not None else ()
    print(disassemble(image.code, remark_by_offset, kit, variables), end="")


def print_json(ready_program: images.ReadyProgram, robot: Robot) -> None:
    image = ready_program.image
    instructions = []
    for row in rows(image.code):
        assert row.op is not None
        fields: dict[str, object] = {
            "offset": row.offset,
            "bytes": row.data.hex(),
            "name": row.op.name,
            "operands": list(row.operands),
            "text": row.text,
        }
        location = (
            ready_program.program_map.location_at(row.offset)
            if ready_program.program_map is not None
            else None
        )
        if location is not None:
            fields["line"] = location.line
            fields["column"] = location.column
        instructions.append(fields)
    print(json.dumps({
        "code_bytes": len(image.code),
        "image_bytes": ready_program.image_bytes,
        "start": image.start,
        "robot": robot.name if image.devices else None,
        "devices": f"{image.devices:04x}",
        "checksum": f"{image.checksum:08x}",
        "isa": f"{image.isa[0]}.{image.isa[1]}",
        "instructions": instructions,
    }, indent=2))  # fmt: skip
