"""The event loop of the libraries that need one: results, failures, and cancellation."""

from __future__ import annotations

import asyncio
import threading

import pytest

from tests.support.command import Command
from tests.support.interrupted import interrupted_bell
from tiniscript.link.transports import event_loop
from tiniscript.link.transports.event_loop import EventLoop


async def fail() -> None:
    raise ValueError("so it is")


class EndlessCoroutine:
    """A coroutine that ends when it is cancelled."""

    def __init__(self) -> None:
        self.has_begun = threading.Event()
        self.is_cancelled = False

    async def work(self) -> None:
        self.has_begun.set()
        try:
            await asyncio.Event().wait()
        finally:
            self.is_cancelled = True


def test_results_and_failures_are_returned() -> None:
    loop = EventLoop()
    assert loop.run(asyncio.sleep(0, "done"), 100) == "done"
    with pytest.raises(ValueError, match="so it is"):
        loop.run(fail(), 100)
    loop.close()
    loop.close()  # as at the end of the process


def test_a_timed_out_task_is_cancelled_before_the_failure() -> None:
    loop, coroutine = EventLoop(), EndlessCoroutine()
    with pytest.raises(TimeoutError):
        loop.run(coroutine.work(), 0)
    loop.run(asyncio.sleep(0), 100)
    assert coroutine.is_cancelled or not coroutine.has_begun.is_set()
    loop.close()


def test_ctrl_c_cancels_the_interrupted_task(monkeypatch: pytest.MonkeyPatch) -> None:
    loop, coroutine = EventLoop(), EndlessCoroutine()
    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(event_loop, "Bell", interrupted_bell(lambda: coroutine.has_begun.wait(100)))
        loop.run(coroutine.work(), 100)
    assert coroutine.is_cancelled
    loop.close()


def test_the_end_of_a_process_cancels_running_tasks() -> None:
    code = (
        "import asyncio, threading\n"
        "from tiniscript.link.transports.event_loop import shared_loop\n"
        "begun = threading.Event()\n"
        "async def work():\n"
        "    begun.set()\n"
        "    try: await asyncio.Event().wait()\n"
        "    finally: print('cancelled', flush=True)\n"
        "async def begin():\n"
        "    global task\n"
        "    task = asyncio.create_task(work())\n"
        "shared_loop().run(begin(), 100); begun.wait(100)\n"
    )
    result = Command(code=code).wait_for_result()
    assert (result.code, result.out, result.err) == (0, "cancelled\n", "")
