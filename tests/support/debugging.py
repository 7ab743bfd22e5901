"""A computer that halts, steps and inspects a program on a robot of `host_firmware`."""

from __future__ import annotations

from collections.abc import Callable
from struct import iter_unpack
from typing import NamedTuple

from tests.machines.host_firmware import HostFirmware
from tests.support.images import image_of
from tests.support.robot_on_host import KIT, switched_on
from tiniscript.bytecode.image import Image
from tiniscript.link.messages import RESUME_GO, RESUME_STEP
from tiniscript.link.outcomes import Event
from tiniscript.link.payloads import HaltedEvent
from tiniscript.link.requests import OK
from tiniscript.link.session import Session


class Halt(NamedTuple):
    offset: int
    task: int


class DebuggedRobot:
    """A robot that holds a program, and its computer."""

    def __init__(
        self, image: Image | str, robot: HostFirmware | None = None, kit: int = KIT.fingerprint
    ) -> None:  # fmt: skip
        self.robot, self.session = robot or switched_on(), Session(1, 9600, kit)
        self.image = image_of(image) if isinstance(image, str) else image
        self.events: list[Event] = []
        upload = self.session.upload(self.image, runs=False, saves=False)
        assert self.robot.until(self.session, upload) == OK

    def places(self, *places: int) -> int:
        """Set places; return the status."""
        return self.robot.until(self.session, self.session.break_at(places))

    def start(self, is_detached: bool = False) -> None:
        assert self.robot.until(self.session, self.session.start(is_detached)) == OK

    def go(self, mode: int = RESUME_GO) -> bool:
        """Go on; return whether it was halted."""
        reply = self.robot.complete(self.session, self.session.resume(mode))
        return bool(reply.was_halted)

    def step(self) -> bool:
        return self.go(RESUME_STEP)

    def talk(self, milliseconds: int) -> list[Event]:
        self.robot.talk(self.session, milliseconds)
        events = self.session.events()
        self.events += events
        return events

    def halt(self, timeout_ms: int = 5000) -> Halt | None:
        """Wait for the next halt; None if the run ends first, or the time is over."""
        event = self.until(
            lambda event: event.name in ("HALTED", "DONE", "FAULT", "STOPPED"), timeout_ms
        )
        return Halt(event.offset, event.task) if isinstance(event, HaltedEvent) else None

    def until(self, matches: Callable[[Event], bool], timeout_ms: int = 5000) -> Event | None:
        end_ms = self.robot.now_ms + timeout_ms
        event: Event | None = None
        while self.robot.now_ms < end_ms and event is None:
            event = next(filter(matches, self.talk(1)), None)
        return event

    def is_halted(self) -> bool:
        return bool(self.robot.complete(self.session, self.session.read_tasks()).is_halted)

    def variables(self) -> list[int]:
        values: list[int] = []
        while len(values) < 32:
            request = self.session.read_variables(len(values))
            piece = [
                v for (v,) in iter_unpack("<i", self.robot.complete(self.session, request).values)
            ]
            if not piece:
                break
            values += piece
        return values

    def tasks(self) -> list[tuple[int, int, int]]:
        """Return state, place and remaining time of each task."""
        reply = self.robot.complete(self.session, self.session.read_tasks())
        return list(iter_unpack("<BHI", reply.tasks))


def debug(text: str, *places: int, robot: HostFirmware | None = None) -> DebuggedRobot:
    """Return a robot with a started program that has these breakpoints."""
    session = DebuggedRobot(text, robot)
    assert session.places(*places) == OK
    session.start()
    return session
