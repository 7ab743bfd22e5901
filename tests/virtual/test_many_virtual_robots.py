"""Thirty virtual robots on one computer, some of them with bad links, and one command for all."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from tests.support.command import process
from tiniscript import robots
from tiniscript.virtual import directory, worlds
from tiniscript.virtual.robot import Settings, VirtualRobot
from tiniscript.virtual.simulator import Simulator
from tiniscript.virtual.transports import Transports

ROBOTS = 30
BAD = (4, 9, 22)  # whose links lose and change bytes
FAULTS = 4.0  # of 1000
FOREVER = "SI|LOOP(FOREVER);F(1, 40);R(1, 60);END_LOOP"


@contextmanager
def robot_fleet() -> Iterator[list[Simulator]]:
    """Robots that live, each in its own world, and can be found."""
    profile = robots.load("tinibot")
    is_over = threading.Event()
    simulators, notes = [], []
    for number in range(ROBOTS):
        robot = VirtualRobot(profile, worlds.load("obstacles"), Settings(seed=number + 1, baud=0))
        transports = Transports(0, False)
        simulators.append(Simulator(robot, transports, faults=FAULTS if number in BAD else 0.0))
        here = directory.Running(
            transports.address, "tinibot", "obstacles", "", transports.terminal
        )
        notes.append(directory.announce(here))

    def live(simulator: Simulator) -> None:
        while not is_over.is_set():
            simulator.turn(0.1)

    threads = [threading.Thread(target=live, args=(simulator,)) for simulator in simulators]
    for thread in threads:
        thread.start()
    try:
        yield simulators
    finally:
        is_over.set()
        for thread in threads:
            thread.join()
        for simulator, note in zip(simulators, notes, strict=True):
            directory.withdraw(note)
            simulator.transports.close()


def driven(simulator: Simulator) -> list[str]:
    return [event.text for event in simulator.robot.take_events() if event.what == "MOTORS"]


def test_thirty_virtual_robots_get_a_program_drive_and_stop() -> None:
    with robot_fleet() as simulators:
        done = process("upload", "-e", "SI|F(0.3, 80)", "--all", "--json")
        rows = [json.loads(line) for line in done.out.splitlines()]
        ports = {row["port"] for row in rows if row["event"] == "RESULT" and row["is_done"]}
        assert ports >= {simulator.transports.address for simulator in simulators}, done.err
        for simulator in simulators:
            assert driven(simulator) == ["MOTORS 80 80", "MOTORS 0 0"]
        done = process("upload", "-e", FOREVER, "--all", "--detach")
        assert done.out.count("tinibot") >= ROBOTS, done.err
        assert all(simulator.robot.is_running for simulator in simulators)
        done = process("stop", "--all")
        assert done.out.count("the robot has confirmed it") == ROBOTS, done.err
        assert not any(simulator.robot.is_running for simulator in simulators)
