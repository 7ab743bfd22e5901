"""A simulation as the page starts it, with breakpoints, and its trace."""

from __future__ import annotations

from collections.abc import Iterable

from tests.support.virtual_robot import trace
from tiniscript.studio.checking import check
from tiniscript.studio.simulation import Marks, Simulation
from tiniscript.virtual import worlds


def trace_of(simulation: Simulation) -> list[str]:
    events = simulation.robot.take_events()
    return trace(events)


def started_simulation(
    text: str, held_parts: Iterable[int] = (), is_held: bool = False, robot: str = "tinibot"
) -> Simulation:
    """Return a simulation of a program with breakpoints in front of those parts of its text."""
    result = check(text.encode(), robot, "en")
    parts = tuple(place.offset for place in result.places)
    marks = Marks(parts, tuple(parts[k] for k in held_parts), len(result.variables), is_held)
    return Simulation(robot, worlds.load("obstacles"), result.image, marks)
