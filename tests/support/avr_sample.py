"""What the simulated ATmega328P is asked, quick enough to be asked of hundreds of programs for it.

Cases, listings, random programs and code that no verifier accepts. A program that answers as the
one that is right does passes; where an answer is another one, the machine in Python decides.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path
from subprocess import TimeoutExpired
from typing import NamedTuple

from tests.machines import Senses, avr
from tests.machines.chips import Chip, ran
from tests.machines.host import SOURCES, Ran, run_request
from tests.machines.python import ran_python
from tests.oracle import programs
from tests.support.casefile import all_cases
from tests.support.cpp_edges import changed_code, kit_of
from tests.support.cpp_sample import Unfit
from tests.support.images import image_for
from tests.support.kits import KITS
from tests.support.random_codes import jump, random_codes, simple
from tests.vm.test_cases import compiled, robot_and_senses
from tiniscript import compile_text
from tiniscript.bytecode.disassembly import read_listing
from tiniscript.bytecode.image import ImageRefused
from tiniscript.bytecode.verify import Refused
from tiniscript.kit import Kit

MOST_BYTES = 700
MOST_SECONDS = 4  # an answer takes a hundredth of one
SENSORS = 3  # of the kit of code that no verifier accepts: there is room for that many
# What the AVR does not look at: a statement on an empty stack empties it, the second of two values
# that is not there means nothing, and so does what NEXT counts without a loop.
LENIENT = (
    simple("SHOW"),
    simple("PUSH_TRUE") + simple("ADD") + simple("SHOW"),
    simple("PUSH_TRUE") + simple("MOTORS"),
    jump("NEXT", False, 0),
)


class Question(NamedTuple):
    """A request, and what the machine in Python does: a run, or how code that changed ends."""

    name: str
    request: bytes
    want: Ran | str
    max_ms: int

    def is_answered_by(self, said: str) -> bool:
        try:
            got = ran(said)
        except (AssertionError, ValueError, IndexError, Refused, ImageRefused):
            return False
        if isinstance(self.want, str):
            return got.trace.splitlines()[-1].split()[-1] == self.want
        return Chip("", lambda image, kit, senses: got, counts_jumps=True).agrees(
            got, self.want, self.max_ms
        )


def questions() -> Iterator[Question]:
    for case in all_cases():
        robot_of = "robot" in case.parts and "tiniscript" in case.parts
        if robot_of or ("bytecode" in case.parts and "refused" not in case.parts):
            robot, senses = robot_and_senses(case)
            if robot_of:
                image = compiled(case).image
            else:
                image = image_for(read_listing(case.parts["bytecode"]), robot.kit)
                senses = senses._replace(max_ms=min(senses.max_ms, 5000), max_steps=5000)
            yield from _question(case.id, image, robot.kit, senses)
    for number in range(200):
        rng = random.Random(number)
        oracle_kit, kit = KITS[number % 2]
        image = compile_text(programs.program(rng, oracle_kit), kit).image
        readings = programs.senses(rng, oracle_kit)
        yield from _question(
            f"program {number}", image, kit, Senses(readings, 3000, 2000, number + 1)
        )
    for number, code in enumerate(random_codes(0, 4000)):
        if number % 20 < 1 or number % 40 == 16:
            image = image_for(code, KITS[0][1], "SB")
            yield from _question(f"code {number}", image, KITS[0][1], Senses({}, 3000, 300))
    yield from of_changed_code()
    yield from of_long_loops()


def of_long_loops() -> Iterator[Question]:
    """Yield loops that count beyond 65535: with another one in it, and with a long body."""
    kit = KITS[0][1]
    inner = "LOOP(1); Y = X; END_LOOP;"
    far = f"IF(X < 0); {'Y = Y + 1; ' * 130} ENDIF; Y = X;"
    for name, body in (("a loop in a long loop", inner), ("a long body", far)):
        text = f"X = 0; Y = 0; LOOP(70000); X = X + 1; {body} END_LOOP; SHOW(Y)"
        yield from _question(name, compile_text(text, kit).image, kit, Senses())


def of_changed_code() -> Iterator[Question]:
    """Yield what ends in BAD_CODE, at each edge, and what just does not."""
    kit, senses = kit_of(SENSORS), Senses(max_ms=100, max_steps=100)
    for code, caught in changed_code(SENSORS):
        if code in LENIENT:
            continue
        want = "DONE" if caught is None else "BAD_CODE"
        request = b"U" + run_request(code, kit, senses)
        yield Question(f"changed {code.hex()}", request, want, senses.max_ms)


def _question(name: str, image: bytes, kit: Kit, senses: Senses) -> Iterator[Question]:
    if len(image) > MOST_BYTES:
        return
    try:
        want = ran_python(image, kit, senses)
    except (Refused, ImageRefused):
        return  # what is refused does not run
    yield Question(name, b"R" + run_request(image, kit, senses), want, senses.max_ms)
    if not want.trace.endswith(" LIMIT\n"):
        slow = b"R" + run_request(image, kit, senses, not_ready=2)
        yield Question(f"{name}, not always ready", slow, want, senses.max_ms)


class AvrSample:
    """The questions, and what the program of the machine as it is answers."""

    def __init__(self, sources: Path = SOURCES) -> None:
        elf = avr.program(sources)
        self._asked = [(each, avr.answer(elf, each.request)) for each in questions()]
        for question, said in self._asked:
            if not question.is_answered_by(said):
                raise Unfit(f"{question.name}: {said}")

    def failing(self, elf: bytes) -> str:
        """Return the name of a question that a program does not answer, or nothing.

        One that has told two programs apart is the first one to be asked.
        """
        for question, right in [*self._asked]:
            try:
                said = avr.answer(elf, question.request, MOST_SECONDS)
            except (AssertionError, TimeoutExpired):
                said = ""
            if said != right and not question.is_answered_by(said):
                self._asked.remove((question, right))
                self._asked.insert(0, (question, right))
                return question.name
        return ""
