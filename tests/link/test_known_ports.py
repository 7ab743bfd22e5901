"""The ports that are remembered: none is lost to a simultaneous command, or for lack of room."""

from __future__ import annotations

import subprocess
import sys
from random import Random

import pytest

from tiniscript.link import known_ports

COMMAND_COUNT, PORT_COUNT = 6, 8
REMEMBER_SCRIPT = f"""
import sys
from tiniscript.link import known_ports
for number in range({PORT_COUNT}):
    known_ports.remember(f"socket://10.0.{{sys.argv[1]}}.{{number}}:1", "R", is_used=False)
"""


def test_commands_at_once_lose_no_port() -> None:
    processes = [
        subprocess.Popen([sys.executable, "-c", REMEMBER_SCRIPT, str(k)])
        for k in range(COMMAND_COUNT)
    ]
    assert [process.wait() for process in processes] == [0] * COMMAND_COUNT
    assert len(known_ports.remembered_ports().name_by_port) == COMMAND_COUNT * PORT_COUNT


def test_more_than_a_hundred_robots_are_remembered() -> None:
    for number in range(150):
        known_ports.remember(f"socket://10.0.0.{number}:1", f"R{number}", is_used=False)
    names = known_ports.remembered_ports().name_by_port
    assert len(names) == 150 and next(iter(names.values())) == "R149"


# The names of ports, and which of them always mean the same one: those of files never do, because a
# link in /dev may lead elsewhere later.
PORTS_BY_NAME = {
    "COM1": "COM1",
    "/dev/ttyUSB0": "/dev/ttyUSB0",
    "ble://Tini": "Tini by radio",
    "BLE://TINI": "Tini by radio",
    "tcp://tini": "Tini",
    "tcp://Tini.local": "Tini",
    "socket://localhost:1": "1",
    "SOCKET://127.0.0.1:1": "1",
    "socket://127.0.0.1:2": "2",
}


@pytest.mark.parametrize("seed", range(20))
def test_the_newest_port_is_first_and_the_last_used_one_is_known(seed: int) -> None:
    """This holds whatever was remembered before, and whether the port was used or only seen; a port
    of several names has the last one."""
    rng, last_port, names = Random(seed), None, dict[str, str]()
    for _ in range(20):
        port, name, is_used = (
            rng.choice([*PORTS_BY_NAME]),
            rng.choice("AB"),
            rng.random() < 0.5,
        )
        known_ports.remember(port, name, is_used)
        last_port = port if is_used else last_port
        other_names = {
            other_name: names[other_name]
            for other_name in names
            if PORTS_BY_NAME[other_name] != PORTS_BY_NAME[port]
        }
        names = {port: name, **other_names}
        assert known_ports.remembered_ports() == (last_port, names)
        assert [*known_ports.remembered_ports().name_by_port] == [*names]
