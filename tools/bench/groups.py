"""Prints how soon mates see a change of their group's program: `python -m tools.bench.groups`.

A class as `tsc studio --class` has it, in a process of its own; pupils of groups of four ask it by
HTTP, as their pages do: a request that is held, and one for each change, every few seconds. Network
and browser are not in the figures. The processor's share is of one core.
"""

from __future__ import annotations

import http.client
import json
import multiprocessing
import random
import resource
import statistics
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from threading import Thread
from typing import Any

from tests.support.class_pages import class_of_many
from tiniscript.studio import serving
from tiniscript.studio.groups import MAX_MEMBERS
from tiniscript.together.form import data_of_change
from tiniscript.together.page import Page
from tools.bench import page as figures

Json = dict[str, Any]
PUPIL_COUNT, RUN_S = 30, 30.0
MAX_MS, MAX_SHARE_PERCENT = 4, 4
ROWS = (
    "one group, until the others receive a change: median, 95 of 100",
    f"{PUPIL_COUNT} pupils, until the others in a group receive a change: median, 95 of 100",
    f"{PUPIL_COUNT} pupils, share of one core, and total memory",
)
CHANGE_INTERVAL_S = (2.0, 6.0)  # range of time between a pupil's changes
PROGRAM = "F(1, 80)\nLOOP(3)\nB(1, 40)\nEND_LOOP\nS\n"
TIMEOUT_S = 30.0
MIB = 1 << 20


class Client:
    """A connection of a pupil's page."""

    def __init__(self, address: str, token: str = "") -> None:
        host = address.removeprefix("http://").rstrip("/")
        self._headers = {"Origin": address.rstrip("/"), "Content-Type": "application/json"}
        self._headers |= {serving.TOKEN_HEADER: token} if token else {}
        self._connection = http.client.HTTPConnection(host, timeout=TIMEOUT_S)

    def ask(self, do: str, **fields: Any) -> Json:
        body = json.dumps({"do": do, **fields})
        self._connection.request("POST", serving.ROBOTS_PATH, body, self._headers)
        answer: Json = json.loads(self._connection.getresponse().read())
        return answer


class Pupil:
    """Hears of changes in one thread, and makes some in another."""

    def __init__(self, address: str, code: str, number: int) -> None:
        join_answer = Client(address).ask("join", code=code, name=f"P{number}")
        self._listener = Client(address, join_answer["token"])
        self._sender = Client(address, join_answer["token"])
        self.group = f"G{number // MAX_MEMBERS}"
        answer = self._sender.ask("group_join", name=self.group, text=PROGRAM)
        self._page = Page.of(answer["page"], answer)
        self._random_source = random.Random(number)
        self.seen_s: dict[int, float] = {}  # arrival time of each change, by its number
        self.sent_s: dict[int, float] = {}

    def listen(self, end_s: float) -> None:
        number = saw_count = 0
        epoch, name = self._page.epoch, self._page.name
        while time.monotonic() < end_s:
            request = {"page": name, "since": number, "epoch": epoch, "saw": saw_count}
            answer = self._listener.ask("group", **request, waits=True)
            heard_s = time.monotonic()
            saw_count = answer["saw"]
            for change_number in range(number + 1, answer["n"] + 1):
                self.seen_s[change_number] = heard_s
            number = answer["n"]

    def change(self, end_s: float) -> None:
        while True:
            time.sleep(self._random_source.uniform(*CHANGE_INTERVAL_S))
            if time.monotonic() > end_s:
                return
            rows = [f"W({self._random_source.randint(1, 99)})", *self._page.lines[-6:]]
            self._page.type(rows, 0)
            self._page.leave()
            begin_s = time.monotonic()
            self._page.receive(self._sender.ask("group", **self._request()))
            self.sent_s[self._page.number] = begin_s

    def _request(self) -> Json:
        page = self._page
        changes = [data_of_change(change) for change in page.pending_changes]
        return {"page": page.name, "since": page.number, "epoch": page.epoch, "saw": 0,
                "changes": changes}  # fmt: skip


def serve_class(pipe: Connection) -> None:
    """Serve a class, whose address and code go through the pipe, until the pipe receives
    something."""
    with class_of_many() as class_:
        pipe.send((class_.server.address, class_.room.code))
        begin_s = time.process_time()
        pipe.recv()
        pipe.send(
            (
                time.process_time() - begin_s,
                resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024,
            )
        )


@contextmanager
def served_class() -> Iterator[tuple[str, str, Connection]]:
    parent_pipe, child_pipe = multiprocessing.Pipe()
    process = multiprocessing.get_context("spawn").Process(target=serve_class, args=(child_pipe,))
    process.start()
    try:
        yield *parent_pipe.recv(), parent_pipe
    finally:
        process.join(TIMEOUT_S)


def measure(pupil_count: int, run_s: float) -> tuple[list[float], float, float]:
    """Return milliseconds from changes to mates, share of a core, and memory in MiB."""
    with served_class() as (address, code, pipe):
        pupils = [Pupil(address, code, number) for number in range(pupil_count)]
        end_s = time.monotonic() + run_s
        threads = [
            Thread(target=work, args=(end_s,))
            for pupil in pupils
            for work in (pupil.listen, pupil.change)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        pipe.send("end")
        process_s, memory_bytes = pipe.recv()
    delays_ms = [
        1000 * (mate.seen_s[number] - sent_s)
        for pupil in pupils
        for number, sent_s in pupil.sent_s.items()
        for mate in pupils
        if mate is not pupil and mate.group == pupil.group and number in mate.seen_s
    ]
    return delays_ms, process_s / run_s, memory_bytes / MIB


def delays_text(delays_ms: list[float]) -> str:
    slow_ms = statistics.quantiles(delays_ms, n=20)[-1]
    return f"{statistics.median(delays_ms):.1f}, {slow_ms:.1f} ms"


def main() -> int:
    group_delays_ms, *_ = measure(MAX_MEMBERS, RUN_S)
    delays_ms, share, memory_mib = measure(PUPIL_COUNT, RUN_S)
    columns = (delays_text(group_delays_ms), delays_text(delays_ms),
             f"{100 * share:.1f} %, {memory_mib:.0f} MiB")  # fmt: skip
    limit_texts = (f"{MAX_MS} ms", f"{MAX_MS} ms", f"{MAX_SHARE_PERCENT} %")
    figures.show("groups", [list(row) for row in zip(ROWS, columns, limit_texts, strict=True)])
    is_slow = max(map(statistics.median, (group_delays_ms, delays_ms))) > MAX_MS
    return int(is_slow or 100 * share > MAX_SHARE_PERCENT)


if __name__ == "__main__":
    sys.exit(main())
