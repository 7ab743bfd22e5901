"""What only the simulated ATmega328P is asked: long loops, and code that no verifier accepts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from tests.machines import Senses
from tests.machines.chips import Chip
from tests.machines.host import Ran, ran, run_request
from tests.machines.python import ran_python
from tests.support.cpp_edges import changed_code, kit_of
from tests.support.kits import KITS
from tests.support.random_codes import jump, simple
from tiniscript import compile_text
from tiniscript.base.kit import Kit
from tiniscript.bytecode.image import ImageRefused
from tiniscript.bytecode.verify import Refused

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
        want = ran_python(image, kit, senses, has=0)
    except (Refused, ImageRefused):
        return  # what is refused does not run
    yield Question(name, b"R" + run_request(image, kit, senses), want, senses.max_ms)
    if not want.trace.endswith(" LIMIT\n"):
        slow = b"R" + run_request(image, kit, senses, not_ready=2)
        yield Question(f"{name}, not always ready", slow, want, senses.max_ms)
