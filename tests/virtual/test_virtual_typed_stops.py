"""Typed stops of the virtual robot: in every state of its receiver, and by its next client."""

from __future__ import annotations

from random import Random

import pytest

from tests.support.simulator_visits import until, visit
from tests.support.stop_spellings import RUNNING_LINE, SILENCE_MS
from tests.support.virtual_robot import robot_in
from tiniscript.link.messages import STOP_BYTES, TEXT_MS
from tiniscript.link.typed_stop import is_at_stop
from tiniscript.virtual.protocol_sniffer import sniff_robot_client
from tiniscript.virtual.robot import VirtualRobot
from tiniscript.virtual.simulator import Simulator

BITS = 10


def wait(robot: VirtualRobot, milliseconds: int, data: bytes = b"") -> None:
    robot.step(robot.now_ms + milliseconds, data)


def test_the_next_client_begins_a_line(simulator: Simulator) -> None:
    """Unfinished text of the previous client ends with its connection."""
    with visit(simulator) as client:
        client.sendall(RUNNING_LINE)
        until(simulator, lambda: simulator.robot.is_running)
        client.sendall(b"F(1,")
        until(simulator, lambda: bool(simulator.waiting_bytes))
    until(simulator, lambda: not simulator.waiting_bytes)
    with visit(simulator) as client:
        client.sendall(b"S\n")
        until(simulator, lambda: not simulator.robot.is_running)


def test_blank_lines_do_not_affect_a_clients_line(simulator: Simulator) -> None:
    for _ in range(2):
        with visit(simulator) as client:
            client.sendall(b"\n\n" + RUNNING_LINE)
            until(simulator, lambda: simulator.robot.is_running)
            client.sendall(b"S\n")
            until(simulator, lambda: not simulator.robot.is_running)
            wait(simulator.robot, SILENCE_MS + 100)


@pytest.mark.parametrize("word", [b"S", b"\r\nsToP ", b"\tS", b"\x1bS", b"SSSS", b"Stop.", b"PARA"])
def test_silence_completes_the_stop_of_a_possible_web_page(
    simulator: Simulator, word: bytes
) -> None:
    assert sniff_robot_client(word) is None
    with visit(simulator) as client:
        client.sendall(RUNNING_LINE)
        until(simulator, lambda: simulator.robot.is_running)
    with visit(simulator) as client:
        client.sendall(word)
        until(simulator, lambda: not simulator.robot.is_running)
        assert simulator.transports.visit_count == 1, "it lets nobody in"


def test_the_virtual_robot_recognizes_stop_lines_like_a_robot() -> None:
    rng, robot, kinds = Random(4), robot_in(), set()
    parts = [
        b"S", b"sTOP", b"T", b" ", b"\t;", b"\x1b", b"\x1b[", b"O", b"1", b"A", b"\x7f", b"\1",
        b".", b"NOW", b"alto", b"PARA", b"R",
    ]  # fmt: skip
    for _ in range(200):
        word = b"".join(rng.choices(parts, k=rng.randrange(1, 4)))
        word += rng.choice((b"S", b"S", b"Stop", b"Halt!", b"now"))
        wait(robot, TEXT_MS + SILENCE_MS)  # the robot's text comes after its frames
        wait(robot, 100, RUNNING_LINE)
        assert robot.is_running
        wait(robot, SILENCE_MS + 100, b"\n" + word)
        assert robot.is_running is not is_at_stop(word), word
        kinds.add(robot.is_running)
        wait(robot, 10, bytes(STOP_BYTES))
    assert len(kinds) == 2
