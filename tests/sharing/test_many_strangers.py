"""Ten thousand connections to this computer's servers: nothing grows, a stop gets through.

`python -m tests.sharing.test_many_strangers 10000` makes this many of each kind and prints the
growth; the tests make fewer.
"""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple
from urllib.parse import urlsplit
from urllib.request import urlopen

import pytest

from tests.support.command import run_subprocess
from tests.support.port_strangers import drive_robot, registration_of, say_all
from tests.support.waiting import HANG_LIMIT_S
from tiniscript.studio.serving import MAX_CONNECTIONS

pytestmark = pytest.mark.skipif(
    sys.platform != "linux", reason="only Linux says what a process has"
)

CONNECTION_COUNT = 400  # connections of a test
FILES = 140  # extra open files of a listener, for silent clients
ALLOWED_GROWTH_KB = 8_000  # extra memory of a Python process that has handled errors
# Clients and their first bytes. Each sends something, and reads nothing.
KINDS = ("closed", "silent", "half-open", "slow", "half a frame", "half a greeting", "browser")
VISITORS = """
import contextlib, socket, sys, time
port, kind, count = int(sys.argv[1]), sys.argv[2], int(sys.argv[3])
REQUEST = b"GET / HTTP/1.1\\r\\nHost: robot\\r\\n\\r\\n"
HALVES = {"half a frame": b"\\0", "half a greeting": b'{"tsc"'}
SAYS = {**HALVES, "slow": b"P", "browser": REQUEST}.get(kind, b"")
GOES_ON = {**dict.fromkeys(HALVES, b""), "slow": b"O"}.get(kind, SAYS)
peers = []
for k in range(count):
    peer = socket.socket()
    peer.setblocking(False)
    peer.connect_ex(("127.0.0.1", port))
    peers.append(peer)
    with contextlib.suppress(OSError):
        if SAYS:
            peer.send(SAYS)
        if kind == "half-open":
            peer.shutdown(socket.SHUT_WR)
    if kind == "closed":
        peers.pop().close()
print("here", flush=True)
while sys.stdin.buffer.read(1):
    for peer in peers:
        with contextlib.suppress(OSError):
            peer.send(GOES_ON)
    print("said", flush=True)
"""


class Usage(NamedTuple):
    files: int
    memory_kb: int


def measure_process(pid: int) -> Usage:
    """Return the open files and the memory of a process."""
    status = Path(f"/proc/{pid}/status").read_text(encoding="ascii")
    [memory] = [row.split()[1] for row in status.splitlines() if row.startswith("VmRSS")]
    return Usage(len(list(Path(f"/proc/{pid}/fd").iterdir())), int(memory))


@contextmanager
def visitors(port: int, kind: str, count: int) -> Iterator[None]:
    command = [
        "sh",
        "-c",
        f'ulimit -n {count + 100}; exec "$@"',
        "sh",
        sys.executable,
        "-c",
        VISITORS,
    ]
    with subprocess.Popen(
        [*command, str(port), kind, str(count)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as visitor:
        try:
            assert visitor.stdin and visitor.stdout
            assert visitor.stdout.readline() == b"here\n"
            visitor.stdin.write(b"!")
            visitor.stdin.flush()
            assert visitor.stdout.readline() == b"said\n"
            yield
        finally:
            visitor.kill()
            visitor.communicate()


def wait_until_settled(pid: int, files: int) -> Usage:
    """Wait until a process has no more files than this; return the final numbers, larger if it
    hangs.
    """
    end_s = time.monotonic() + HANG_LIMIT_S
    while (child := measure_process(pid)).files > files and time.monotonic() < end_s:
        time.sleep(0.1)
    return child


def attack(kind: str, count: int) -> list[tuple[str, Usage, Usage, Usage]]:
    """Come to a virtual robot and to the command that drives it. Return what each process had.

    Measure before they connect, while they are there, and after they have left.
    """
    with drive_robot() as (robot, port, command, _):
        places = [
            ("virtual robot", robot.pid, int(port.rpartition(":")[2])),
            ("shared port", command.pid, registration_of(port).number),
        ]
        say_all(port, 15, 100)
        children = []
        for name, pid, number in places:
            usage_before = measure_process(pid)
            with visitors(number, kind, count):
                usage_during = measure_process(pid)
                state = json.loads(run_subprocess("doctor", "--port", port, "--json").out)["robot"][
                    "state"
                ]
                assert state == "RUNNING"
            children.append(
                (name, usage_before, usage_during, wait_until_settled(pid, usage_before.files + 3))
            )
        with visitors(places[0][2], kind, count), visitors(places[1][2], kind, count):
            assert run_subprocess("stop", "--port", port).code == 0
        out, err = command.communicate(timeout=HANG_LIMIT_S)
        assert command.returncode == 3
        assert b"was stopped from a computer" in out + err
        # Without a holder, clients are admitted in order, at most 256 a second. Half a greeting is
        # text, and a typing client holds the robot.
        with visitors(places[0][2], kind, min(count, CONNECTION_COUNT)):
            result = run_subprocess("stop", "--port", port)
            assert kind == "half a greeting" or (result.code, result.err) == (0, "")
        robot.send_signal(signal.SIGINT)
        assert b"FAULT" not in robot.communicate(timeout=HANG_LIMIT_S)[0]
    return children


@pytest.mark.sampled("kind")
@pytest.mark.parametrize("kind", KINDS)
def test_strangers_cause_no_growth_and_a_stop_gets_through(kind: str) -> None:
    for name, usage_before, usage_during, usage_after in attack(kind, CONNECTION_COUNT):
        assert usage_during.files <= usage_before.files + FILES, name
        assert usage_after.files <= usage_before.files + 3, name
        assert usage_after.memory_kb <= usage_before.memory_kb + ALLOWED_GROWTH_KB, name


@contextmanager
def studio() -> Iterator[tuple[int, int]]:
    """A `tsc studio` that may have 256 files open: the number of its process, and its port."""
    with TemporaryDirectory() as folder:
        Path(folder, "index.html").write_text("<!doctype html>")
        code = (
            "import sys; from pathlib import Path; from tiniscript.studio import serving; "
            f"serving.PAGE = Path({folder!r}); from tiniscript.cli import main; "
            "sys.exit(main(['studio', '--listen', '0', '--no-browser']))"
        )
        words = ["sh", "-c", 'ulimit -n 256; exec "$@"', "sh", sys.executable, "-c", code]
        with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
            try:
                assert process.stdout
                address = process.stdout.readline().decode().strip()
                yield process.pid, urlsplit(address).port or 0
            finally:
                process.kill()
                process.communicate()


def page(port: int) -> bytes:
    with urlopen(f"http://127.0.0.1:{port}/", timeout=HANG_LIMIT_S) as response:
        data: bytes = response.read()
    return data


def attack_studio(count: int) -> list[tuple[str, Usage, Usage, Usage]]:
    """Come to one studio in each way. Return the kind, and what the studio had."""
    children = []
    with studio() as (pid, port):
        assert page(port) == b"<!doctype html>"
        for kind in KINDS:
            usage_before = measure_process(pid)
            with visitors(port, kind, count):
                assert page(port) == b"<!doctype html>"
                usage_during = wait_until_settled(pid, usage_before.files + MAX_CONNECTIONS + 3)
            children.append(
                (kind, usage_before, usage_during, wait_until_settled(pid, usage_before.files + 3))
            )
            assert page(port) == b"<!doctype html>"
    return children


def test_the_studio_serves_its_page_among_many_strangers() -> None:
    for kind, usage_before, usage_during, usage_after in attack_studio(CONNECTION_COUNT):
        assert usage_during.files <= usage_before.files + MAX_CONNECTIONS + 3, kind
        assert usage_after.files <= usage_before.files + 3, kind
        assert usage_after.memory_kb <= usage_before.memory_kb + ALLOWED_GROWTH_KB, kind


def run_campaign(count: int) -> None:
    print("| who comes | where | open files before, meanwhile, after | KB before, after |")
    print("|---|---|---|---|")
    of_robots = ((kind, *row) for kind in KINDS for row in attack(kind, count))
    of_the_studio = ((row[0], "studio", *row[1:]) for row in attack_studio(count))
    for kind, name, usage_before, usage_during, usage_after in chain(of_robots, of_the_studio):
        print(
            f"| {count:,} {kind} | {name} "
            f"| {usage_before.files}, {usage_during.files}, {usage_after.files} "
            f"| {usage_before.memory_kb:,}, {usage_after.memory_kb:,} |", flush=True,
        )  # fmt: skip


if __name__ == "__main__":
    run_campaign(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000)
