"""A virtual robot in time, at a port of this computer."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.support.virtual_robot import floor, robot_in
from tiniscript.virtual.simulator import Simulator
from tiniscript.virtual.transports import Transports


@pytest.fixture
def simulator() -> Iterator[Simulator]:
    transports = Transports()
    yield Simulator(robot_in(floor()), transports)
    transports.close()
