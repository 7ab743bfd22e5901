"""The machine in Python."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tests.machines.host import Ran
from tiniscript.base.kit import Kit
from tiniscript.base.trace import Ending
from tiniscript.base.trace import Senses as Lists
from tiniscript.bytecode.image import ALL_NEEDS
from tiniscript.bytecode.verify import load_image
from tiniscript.vm.runner import run

if TYPE_CHECKING:
    from tests.machines import Senses


def run_in_python(image: bytes, kit: Kit, senses: Senses, has: int = ALL_NEEDS) -> Ran:
    """Run an image, which is read and verified as a machine that has so much of `needs` does it."""
    code = load_image(image, kit, has).code
    events = run(code, kit, lists_of(kit, senses), senses.max_ms, senses.max_steps, senses.seed)
    *lines, ending = events
    assert isinstance(ending, Ending)
    return Ran(ending.offset, ending.steps, "".join(f"{event}\n" for event in lines))


def run_python(image: bytes, kit: Kit, senses: Senses) -> str:
    """Return the trace of an image."""
    return run_in_python(image, kit, senses).trace


def lists_of(kit: Kit, senses: Senses) -> Lists:
    """Return the readings by the number of the sensor."""
    names = [device.name for device in kit.readings]
    return Lists(kit, {names.index(name): values for name, values in senses.readings.items()})
