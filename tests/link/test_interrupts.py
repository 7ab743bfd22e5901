"""Ctrl-C at any moment causes only a KeyboardInterrupt, and the line continues."""

from __future__ import annotations

import asyncio
import random
import signal
import sys
from collections.abc import Callable
from contextlib import closing, suppress

import pytest

from tests.support.waiting import until
from tiniscript.base.bell import Bell
from tiniscript.link.messages import STOP_BYTES
from tiniscript.link.port_connection import PortConnection
from tiniscript.link.session import Session
from tiniscript.link.transports.event_loop import EventLoop
from tiniscript.link.transports.pushed import PushedTransport

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no timer of signals")

INTERRUPT_COUNT = 1_500
HAIL_COUNT = 8  # a task that takes a while to cancel


class Port(PushedTransport):
    def __init__(self) -> None:
        super().__init__()
        self.written_bytes = b""

    def write(self, data: bytes) -> None:
        self.written_bytes += data

    def close(self) -> None:
        self.end("closed")


def interrupt_often(work: Callable[[], object], count: int = INTERRUPT_COUNT) -> None:
    """Repeat work while Ctrl-C is pressed again and again. All other exceptions pass."""
    rng = random.Random(1)
    pressed_numbers: list[int] = []  # the interpreter discards exceptions in a callback

    def press(number: int, _: object) -> None:
        pressed_numbers.append(number)
        raise KeyboardInterrupt

    old_handler = signal.signal(signal.SIGALRM, press)
    try:
        for _ in range(count):
            pressed_numbers.clear()
            with suppress(KeyboardInterrupt):
                signal.setitimer(signal.ITIMER_REAL, rng.uniform(1e-5, 4e-4))
                while not pressed_numbers:
                    work()
    finally:
        signal.signal(signal.SIGALRM, old_handler)


def test_a_line_continues_and_can_still_stop() -> None:
    port = Port()
    with closing(PortConnection(port, Session(1))) as line:

        def work() -> None:
            line.runs(1)
            line.event(1e-5)
            line.end_run(1)

        interrupt_often(work)
        port.written_bytes = b""
        line.stop()
        until(lambda: bytes(STOP_BYTES) in port.written_bytes, "the stop is sent")


@pytest.mark.filterwarnings("ignore:coroutine .* was never awaited")
def test_an_event_loop_continues_after_an_interrupt() -> None:
    loop = EventLoop()
    interrupt_often(lambda: loop.run(asyncio.sleep(0), 100), HAIL_COUNT)
    assert loop.run(asyncio.sleep(0, "done"), 100) == "done"
    loop.close()


def test_a_bell_wakes_its_waiter() -> None:
    bell = Bell()

    def work() -> None:
        bell.ring()
        bell.wait(1e-5)
        bell.wait(1e-5)  # yields the interpreter, which might otherwise miss a signal

    interrupt_often(work)
    bell.ring()
    bell.ring()
    assert bell.wait(0)
    assert not bell.wait(0)
    assert bell.wait_until(lambda: True, 0)
    bell.ring()
    assert not bell.wait_until(lambda: False, 0.01)
