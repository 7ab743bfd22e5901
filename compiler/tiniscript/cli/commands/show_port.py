"""`tsc show --port`: the program that the robot holds, read back."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from tiniscript.cli import images, inputs, outputs
from tiniscript.cli.disassembling import print_disassembly
from tiniscript.cli.robot.connect import connect


def run(options: Namespace, language: str) -> int:
    robot = inputs.robot(options, language)
    with connect(options, language) as connection:
        connection.meet()
        data = connection.request(lambda session: session.fetch()).values.image
        name = connection.name
    program_input = inputs.Input(name, data, Path("fetched.bin"))
    if options.robot is None:
        robot = images.robot_for(program_input, robot)
    ready_program = images.ready_program(program_input, robot, language)
    assert ready_program is not None  # an image has no mistakes
    if options.output is not None:
        outputs.write(Path(options.output), data, "unwritable")
        connection.print_text(
            "fetched",
            target=inputs.printable_name(options.output),
            image=len(data),
            code=len(ready_program.image.code),
            checksum=f"{ready_program.image.checksum:08x}",
        )
    else:
        print_disassembly(ready_program, robot, name, language)
    return 0
