"""`tsc show`: the disassembly of a program, or the program as an Arduino sketch."""

from __future__ import annotations

import json
from argparse import Namespace

from tiniscript.bytecode.disassembly import disassemble, rows
from tiniscript.cli import compiling, images, inputs, outputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.texts import say, text
from tiniscript.codegen.sketch.writing import BOARDS, sketch_of
from tiniscript.library.programs import remarks
from tiniscript.robots.profile import Robot
from tiniscript.semantics.ir import every
from tiniscript.semantics.ways import is_open_way


def run(options: Namespace, language: str) -> int:
    given = inputs.program(options)
    robot = inputs.robot_for(given, options, language)
    if options.arduino:
        return _sketch(options, given, robot, language)
    if options.output is not None:
        raise CommandError(2, "output_needs_arduino", file=inputs.shown(options.output))
    if given.is_image and options.robot is None:
        robot = images.robot_for(given, robot)
    ready = images.ready(given, robot, language)
    if ready is None:
        return 1
    if options.json:
        print_json(ready, robot)
    else:
        print_disassembly(ready, robot, inputs.shown(given.name), language)
    return 0


def _sketch(options: Namespace, given: inputs.Input, robot: Robot, language: str) -> int:
    if options.json:
        raise CommandError(2, "sketch_or_json")
    if given.is_image:
        raise CommandError(2, "sketch_needs_text", file=inputs.shown(given.name))
    if robot.board.chip not in BOARDS:
        known = ", ".join(BOARDS)
        raise CommandError(2, "sketch_no_board", chip=robot.board.chip, known=known)
    compiled = compiling.compile_input(given, robot, is_strict=False)
    outputs.print_diagnostics(compiled, language)
    if not compiled.is_right:
        return 1
    assert compiled.program is not None
    if compiled.program.tasks:
        raise CommandError(2, "sketch_no_tasks", file=inputs.shown(given.name))
    assert compiled.verdict is not None
    if robot.kit.asks_remote(compiled.verdict.uses):
        raise CommandError(2, "sketch_no_remote", file=inputs.shown(given.name))
    if any(map(is_open_way, every(compiled.program))):
        raise CommandError(2, "sketch_no_ways", file=inputs.shown(given.name))
    sketch = sketch_of(compiled.source, compiled.program, robot, language).encode()
    if outputs.put(options.output, sketch):
        name = inputs.shown(robot.labels[language]["robot"])
        say("sketch", language, file=inputs.shown(options.output), robot=name)
    return 0


def print_disassembly(ready: images.Ready, robot: Robot, name: str, language: str) -> None:
    image = ready.image
    key = "for_robot" if image.devices else "any_robot"
    whose = text(key, language).format(robot=robot.name)
    say("head", language, file=name, start=image.start, robot=whose, code=len(image.code),
        image=ready.image_bytes, checksum=f"{image.checksum:08x}")  # fmt: skip
    found = remarks(ready.places, language)
    kit = robot.kit if image.devices else None
    variables = ready.places.variables if ready.places is not None else ()
    print(disassemble(image.code, found, kit, variables), end="")


def print_json(ready: images.Ready, robot: Robot) -> None:
    image = ready.image
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
        place = ready.places.at(row.offset) if ready.places is not None else None
        if place is not None:
            fields["line"] = place.line
            fields["column"] = place.column
        instructions.append(fields)
    print(json.dumps({
        "code_bytes": len(image.code),
        "image_bytes": ready.image_bytes,
        "start": image.start,
        "robot": robot.name if image.devices else None,
        "devices": f"{image.devices:04x}",
        "checksum": f"{image.checksum:08x}",
        "isa": f"{image.isa[0]}.{image.isa[1]}",
        "instructions": instructions,
    }, indent=2))  # fmt: skip
