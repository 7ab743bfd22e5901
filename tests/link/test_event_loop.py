"""The event loop of the libraries that need one: results, failures, and cancellation."""

from __future__ import annotations

import asyncio
import threading
from contextlib import suppress
from random import Random

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


async def begin_in_background(
    coroutine: EndlessCoroutine, tasks: list[asyncio.Task[None]], is_failing: bool
) -> None:
    """Leave a task behind, which fails when it is cancelled, or not."""

    async def work() -> None:
        try:
            await coroutine.work()
        finally:
            await asyncio.sleep(0)
            if is_failing:
                raise ValueError

    tasks.append(asyncio.create_task(work()))
    while not coroutine.has_begun.is_set():
        await asyncio.sleep(0)


@pytest.mark.parametrize("seed", range(10))
def test_whatever_ran_in_a_loop_its_end_leaves_nothing(
    monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    """Each call is like the first one, and the second end like none."""
    monkeypatch.setattr(event_loop, "CANCEL_S", 10.0)  # however busy this computer is
    rng, loop = Random(seed), EventLoop()
    coroutines, tasks = list[EndlessCoroutine](), list[asyncio.Task[None]]()
    for number in range(8):
        action = rng.choice(("result", "failure", "timeout", "background"))
        if action == "result":
            assert loop.run(asyncio.sleep(0, number), 100) == number
        elif action == "failure":
            with pytest.raises(ValueError, match="so it is"):
                loop.run(fail(), 100)
        else:
            coroutines.append(EndlessCoroutine())
            if action == "background":
                work = begin_in_background(coroutines[-1], tasks, rng.random() < 0.5)
                loop.run(work, 100)
                continue
            with pytest.raises(TimeoutError):
                loop.run(coroutines[-1].work(), 0)
            is_over = coroutines[-1].is_cancelled or not coroutines[-1].has_begun.is_set()
            assert is_over, "it is awaited"
    loop.close()
    assert not loop._thread.is_alive()
    assert all(task.done() for task in tasks)
    assert all(work.is_cancelled or not work.has_begun.is_set() for work in coroutines)
    monkeypatch.setattr(loop, "run", lambda *_: pytest.fail("nothing runs in a loop that ended"))
    loop.close()


def test_a_task_that_does_not_end_is_left_behind(monkeypatch: pytest.MonkeyPatch) -> None:
    """As where the system's Bluetooth service does not answer: the process ends all the same."""
    for name in ("END_S", "CANCEL_S"):
        monkeypatch.setattr(event_loop, name, 0.1)
    loop, tasks, may_end = EventLoop(), list[asyncio.Task[None]](), False

    async def work() -> None:
        while not may_end:
            with suppress(asyncio.CancelledError):
                await asyncio.Event().wait()

    async def begin() -> None:
        tasks.append(asyncio.create_task(work()))

    loop.run(begin(), 100)
    loop.close()
    loop._thread.join(100)
    assert not loop._thread.is_alive() and not tasks[0].done()
    may_end = tasks[0].cancel()
    loop._loop.run_until_complete(asyncio.wait(asyncio.all_tasks(loop._loop), timeout=10))


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
        "assert shared_loop() is shared_loop()\n"
    )
    result = Command(code=code).wait_for_result()
    assert (result.code, result.out, result.err) == (0, "cancelled\n", "")
