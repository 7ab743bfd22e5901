"""A virtual robot and a computer that talks to it, in the robot's own time, without real waits."""

from __future__ import annotations

from collections.abc import Sequence

from tests.support.images import image_of
from tiniscript import robots
from tiniscript.base.trace import Event
from tiniscript.link.authority import KeyRing
from tiniscript.link.payloads import ReceiptReply
from tiniscript.link.requests import Reply
from tiniscript.virtual.computer import Computer
from tiniscript.virtual.robot import Settings, VirtualRobot
from tiniscript.virtual.world import World
from tiniscript.virtual.worlds import read


def floor(parts: str = "", start: str = "x_cm = 100\ny_cm = 100", size: int = 200) -> World:
    """Return a square floor with a border, and the additions of `parts`."""
    head = f"[floor]\nwidth_cm = {size}\nheight_cm = {size}\n[start]\n{start}\n"
    return read(head + parts, "floor")


def robot_in(
    world: World | None = None,
    name: str = "tinibot",
    memory: bytes | None = None,
    **settings: object,
) -> VirtualRobot:
    profile = robots.load(name)
    return VirtualRobot(profile, world or floor(), Settings(**settings), memory)  # type: ignore[arg-type]


def trace(events: Sequence[Event]) -> list[str]:
    """Return a robot's actions in its last run, in the form of `tsc run`."""
    start_indexes = [k for k, event in enumerate(events) if event.kind == "START"]
    start_ms = events[start_indexes[-1]].time_ms
    return [f"{event.time_ms - start_ms} {event.text}" for event in events[start_indexes[-1] + 1 :]]


class Talk(Computer):
    """A computer that sends programs as text."""

    def __init__(self, robot: VirtualRobot, nonce: int = 5, keys: KeyRing | None = None) -> None:
        super().__init__(robot, nonce, keys)

    def upload(
        self, text: str, runs: bool = True, is_detached: bool = False
    ) -> Reply[ReceiptReply]:
        self.wait_for(self.session.hello())
        kit = self.robot.profile.kit
        image = image_of(text, kit)
        return self.wait_for(self.session.upload(image, runs, True, is_detached))
