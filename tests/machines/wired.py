"""A computer and the simulated Uno with the real firmware, on one wire."""

from __future__ import annotations

from tiniscript.link.session import Session, Task
from tools.uno import CYCLES_PER_MS, Uno


class Wired:
    """Lets time pass for both, millisecond by millisecond."""

    def __init__(self, uno: Uno, session: Session) -> None:
        self.uno, self.session = uno, session
        self._seen = len(uno.sent)

    @property
    def now_ms(self) -> int:
        return self.uno.cycle // CYCLES_PER_MS

    def run(self, milliseconds: int) -> None:
        for _ in range(milliseconds):
            data = self.session.poll(self.now_ms)
            if data:
                self.uno.send(data)
            self.uno.run_ms(1)
            sent = self.uno.sent
            self.session.receive(bytes(byte.value for byte in sent[self._seen :]), self.now_ms)
            self._seen = len(sent)

    def until(self, task: Task, limit_ms: int = 20_000) -> int:
        """Run until a task is over; return how that ended."""
        for _ in range(limit_ms):
            if task.outcome is not None:
                return task.outcome.status
            self.run(1)
        raise AssertionError(f"not over after {limit_ms} ms")
