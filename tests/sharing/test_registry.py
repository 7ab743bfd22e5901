"""The holder of a port keeps it, whatever other commands do to the files of ports at any moment.

Something happens before each line of the registry that another command is at: a server registers,
or a lock is taken or let go. The result is the same as if they had come one after the other: the
server is found, and a lock has one owner.
"""

from __future__ import annotations

import os
import socket
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, Any

import pytest

from tiniscript.link.sharing import registry
from tiniscript.link.sharing.registry import Registration

PORT = "socket://127.0.0.1:9"


@pytest.fixture(autouse=True)
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


@pytest.fixture
def number() -> Iterator[int]:
    """A port of this computer at which somebody listens."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield server.getsockname()[1]


def registration(number: int, verb: str) -> Registration:
    return Registration(PORT, number, "0" * 32, "1" * 32, verb, 9600, os.getpid())


def dead() -> Registration:
    with socket.create_server(("127.0.0.1", 0)) as server:
        return registration(server.getsockname()[1], "upload")


def call_at_line(
    expected_line: int, action: Callable[[], object], runs: Callable[[], object]
) -> bool:
    """Call `runs`, and `action` just before its line number `expected_line` in the registry. Return
    whether it has so many lines."""
    lines = 0

    def trace(frame: Any, event: str, argument: object) -> Any:
        nonlocal lines
        if frame.f_code.co_filename != registry.__file__:
            return None
        if event == "line":
            lines += 1
            if lines == expected_line:
                sys.settrace(None)
                action()
        return trace

    gettrace_before = sys.gettrace()
    sys.settrace(trace)
    try:
        runs()
    finally:
        sys.settrace(gettrace_before)
    return lines >= expected_line


def each_line(
    prepare: Callable[[], tuple[Callable[[], object], Callable[[], object]]],
) -> Iterator[bool]:
    """Run it with something that happens at its first line, its second, and so on, until it has no
    more lines; yield each time whether it has happened."""
    expected_line, is_more = 0, True
    while is_more:
        expected_line += 1
        action, runs = prepare()
        is_more = call_at_line(expected_line, action, runs)
        yield is_more
    assert expected_line > 5


@pytest.mark.parametrize("other_action", ["tidies", "leaves"])
def test_a_server_registered_during_a_removal_is_found(number: int, other_action: str) -> None:
    live_registration = registration(number, "live")

    def prepare() -> tuple[Callable[[], object], Callable[[], object]]:
        gone_registration = dead()
        registry.write(gone_registration)
        runs = (
            registry.tidy
            if other_action == "tidies"
            else lambda: registry.remove(gone_registration)
        )
        return (lambda: registry.write(live_registration)), runs

    for has_registered in each_line(prepare):
        if not has_registered:
            continue
        assert registry.find_registration(PORT) == live_registration
        assert registry.find_all() == [live_registration]
        registry.remove(live_registration)
        assert registry.find_all() == []


def lock() -> IO[bytes] | None:
    return registry.lock_port(PORT)


def check_one_owner(owners: list[IO[bytes] | None]) -> None:
    """Only one has the lock; after its release, the next one gets it, and no file is left."""
    holders = [file for file in owners if file is not None and not file.closed]
    assert len(holders) <= 1, "two have the same lock"
    next_one = lock()
    assert (next_one is None) == bool(holders), "another one gets it, too"
    for file in (*holders, next_one):
        if file is not None:
            file.close()
    last_lock = lock()
    assert last_lock is not None
    last_lock.close()
    assert not registry.lock_path(PORT).exists()


def test_a_lock_has_one_owner_in_any_interleaving() -> None:
    def leave_lock_file() -> None:
        registry.lock_path(PORT).write_bytes(b"")  # left by a command that was killed

    registry._make_folder()
    for runs in ("claims", "tidies", "lets go"):
        for event in ("is claimed", "is let go", "is claimed and let go", "is tidied"):
            if runs == "lets go" and event == "is let go":
                continue
            owners: list[IO[bytes] | None] = []

            def prepare(
                runs: str = runs, event: str = event, owners: list[IO[bytes] | None] = owners
            ) -> tuple[Callable[[], object], Callable[[], object]]:
                owners.clear()
                leave_lock_file()
                owned_io = lock() if event == "is let go" or runs == "lets go" else None
                owners.append(owned_io)

                def interfere() -> None:
                    if event == "is let go" and owned_io is not None:
                        owned_io.close()
                    elif event == "is tidied":
                        registry.tidy()
                    elif event != "is let go":
                        owners.append(lock())
                        if event.endswith("let go") and owners[-1] is not None:
                            owners[-1].close()

                if runs == "claims":
                    return interfere, lambda: owners.append(lock())
                if runs == "tidies":
                    return interfere, registry.tidy
                assert owned_io is not None
                return interfere, owned_io.close

            for _ in each_line(prepare):
                check_one_owner(owners)


def test_releasing_a_lock_without_its_file_leaves_the_next_holders() -> None:
    """Somebody has emptied the cache."""
    old_lock = lock()
    registry.lock_path(PORT).unlink()
    second_lock = lock()
    assert old_lock is not None and second_lock is not None
    old_lock.close()
    check_one_owner([second_lock])


@pytest.mark.parametrize("other_host", ["school2", "school-2", "s", "school.local"])
@pytest.mark.parametrize("action_name", ["tidies", "finds", "registers", "leaves"])
def test_a_computer_leaves_another_ones_files_in_a_shared_home(
    action_name: str, other_host: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only the other computer can check whether a server listens at that port number."""
    foreign = dead()
    monkeypatch.setattr(registry, "gethostname", lambda: other_host)
    registry.write(foreign)
    monkeypatch.setattr(registry, "gethostname", lambda: "school")
    own_registration = registration(foreign.number, "live")
    actions: dict[str, Callable[[], object]] = {
        "tidies": registry.tidy,
        "finds": registry.find_all,
        "registers": lambda: registry.write(own_registration),
        "leaves": lambda: registry.remove(own_registration),
    }
    actions[action_name]()
    monkeypatch.setattr(registry, "gethostname", lambda: other_host)
    assert registry.find_registration(PORT) == foreign
