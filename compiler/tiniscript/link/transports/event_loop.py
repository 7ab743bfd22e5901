"""An asyncio event loop in a thread of its own, for libraries that need one.

It begins with its first use. At the end of the process its tasks are cancelled, which ends open
connections. Knows no port.
"""

from __future__ import annotations

import asyncio
import atexit
from collections.abc import Coroutine
from contextlib import suppress
from threading import Lock, Thread
from time import monotonic
from typing import Any, TypeVar

from tiniscript.base.bell import Bell

POLL_INTERVAL_S = 0.1  # between two looks: on Windows, Ctrl-C does not interrupt a wait
CANCEL_S = 1.0  # timeout of cancelled tasks
END_S = 5.0  # timeout of the tasks that end with the process

T = TypeVar("T")


class EventLoop:
    """Runs coroutines for other threads."""

    def __init__(self) -> None:
        self._loop = asyncio.new_event_loop()
        self._thread = Thread(target=self._loop.run_forever, name="events", daemon=True)
        self._thread.start()
        atexit.register(self.close)

    def run(self, coroutine: Coroutine[Any, Any, T], timeout_s: float) -> T:
        """Run a coroutine and return its result. Raises TimeoutError after the time limit.

        After the time limit, or Ctrl-C, the coroutine is cancelled.
        """
        is_over = Bell()
        tasks: list[asyncio.Task[T]] = []

        def begin() -> None:
            tasks.append(self._loop.create_task(coroutine))
            tasks[0].add_done_callback(lambda _: is_over.ring())

        self._loop.call_soon_threadsafe(begin)
        end_s = monotonic() + timeout_s
        try:
            while not is_over.wait(max(0.0, min(POLL_INTERVAL_S, end_s - monotonic()))):
                if monotonic() >= end_s:
                    raise TimeoutError
        except BaseException:
            self._loop.call_soon_threadsafe(lambda: tasks[0].cancel())
            is_over.wait(CANCEL_S)
            raise
        return tasks[0].result()

    def close(self) -> None:
        """Cancel all tasks, and end the thread. The process ends: no more calls will run."""
        if not self._thread.is_alive():
            return
        with suppress(TimeoutError):
            self.run(_cancel_tasks(), END_S)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(CANCEL_S)


async def _cancel_tasks() -> None:
    tasks = asyncio.all_tasks() - {asyncio.current_task()}
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)


_shared_loops: list[EventLoop] = []
_lock = Lock()


def shared_loop() -> EventLoop:
    """Return the loop of this process."""
    with _lock:
        if not _shared_loops:
            _shared_loops.append(EventLoop())
        return _shared_loops[0]
