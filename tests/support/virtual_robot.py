"""A virtual robot and a computer that talks to it, in the robot's own time: nobody waits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from tiniscript import compile_text, robots
from tiniscript.bytecode.image import unpack
from tiniscript.link.authority import KeyRing
from tiniscript.link.connection import PendingRequest
from tiniscript.link.payloads import ReceiptReply
from tiniscript.link.requests import Reply
from tiniscript.link.session import Session
from tiniscript.virtual.robot import Settings, VirtualRobot
from tiniscript.virtual.world import World
from tiniscript.virtual.worlds import read
from tiniscript.vm.trace import Event

T = TypeVar("T")


def floor(parts: str = "", start: str = "x_cm = 100\ny_cm = 100", size: int = 200) -> World:
    """Return a square floor with a border, and with what `parts` add to it."""
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
    """Return what a robot did in its last run as `tsc run` prints it."""
    starts = [k for k, event in enumerate(events) if event.what == "START"]
    began_ms = events[starts[-1]].time_ms
    return [f"{each.time_ms - began_ms} {each.text}" for each in events[starts[-1] + 1 :]]


class Talk:
    """A computer at the robot's port."""

    def __init__(self, robot: VirtualRobot, nonce: int = 5, keys: KeyRing | None = None) -> None:
        profile = robot.profile
        self.robot = robot
        self.session = Session(nonce, profile.board.baud, profile.kit.fingerprint, keys=keys)

    def wait(self, milliseconds: int) -> None:
        for _ in range(milliseconds):
            now_ms = self.robot.now_ms + 1
            sent = self.robot.step(now_ms, self.session.poll(now_ms))
            self.session.receive(sent, now_ms)

    def until(self, request: PendingRequest[T], limit_ms: int = 60_000) -> Reply[T]:
        end_ms = self.robot.now_ms + limit_ms
        while request.outcome is None:
            assert self.robot.now_ms < end_ms, "the robot does not answer"
            self.wait(1)
        return request.outcome

    def upload(
        self, text: str, runs: bool = True, is_detached: bool = False
    ) -> Reply[ReceiptReply]:
        self.until(self.session.hello())
        kit = self.robot.profile.kit
        image = unpack(compile_text(text, kit).image)
        return self.until(self.session.upload(image, runs, True, is_detached))
