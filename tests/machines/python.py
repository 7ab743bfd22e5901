"""The machine in Python."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tiniscript.image import unpack
from tiniscript.kit import Kit
from tiniscript.run import Ending, run
from tiniscript.run import Senses as Lists
from tiniscript.verify import verify

if TYPE_CHECKING:
    from tests.machines import Senses


def run_python(image: bytes, kit: Kit, senses: Senses) -> str:
    """Return the trace of an image, which is read and verified as a machine does it."""
    code = unpack(image, kit.fingerprint).code
    verify(code, len(kit.sensors), len(kit.actuators))
    events = run(code, kit, lists_of(kit, senses), senses.max_ms, senses.max_steps, senses.seed)
    return "".join(f"{event}\n" for event in events if not isinstance(event, Ending))


def lists_of(kit: Kit, senses: Senses) -> Lists:
    """Return the readings by the number of the sensor."""
    names = [device.name for device in kit.sensors]
    return Lists(kit, {names.index(name): values for name, values in senses.readings.items()})
