"""Files on the computer stay whole during changes: with a kill at any line, a full disk at any
byte, two commands at once.

A process of its own changes it, and is killed or held at a line of the code that writes. A reader
then finds the earlier content, with the change or without it, and so does the next change.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, nullcontext, suppress
from itertools import count
from pathlib import Path
from random import Random
from types import FrameType, ModuleType
from typing import Any, NamedTuple

import pytest

from tests.support.sampling import sample_of
from tiniscript.base import files
from tiniscript.bytecode import image as images
from tiniscript.cli import outputs
from tiniscript.cli.errors import CommandError
from tiniscript.flash import ready
from tiniscript.library import source_map
from tiniscript.library.source_map import SourceMap
from tiniscript.link import keys, known_ports, met_robots
from tiniscript.link.authority import RobotKey
from tiniscript.link.keys import BadKeys, KeyFile
from tiniscript.robots import given

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="processes are made with fork")

FIRST_NUMBER, SECOND_NUMBER, THIRD_NUMBER = 1, 2, 3
LONG_TEXT = "x" * 5000  # a disk that is full cuts it in its middle
LINES = 8  # lines at which a commit kills each action; --whole tries all


class KeptNumbers(NamedTuple):
    """`add` keeps a number, with the earlier ones unless it `is_alone`; `all` returns them.

    `failure` is what `add` raises where it cannot; without it, the number is not kept, that is all.
    """

    add: Callable[[int], object]
    all: Callable[[], list[int]]
    module: ModuleType
    is_alone: bool = False
    failure: tuple[type[Exception], ...] = ()


def key_file() -> KeyFile:
    return KeyFile(files.settings_folder() / "keys.json")


def add_key(number: int) -> None:
    key_file().add([RobotKey(number, 0, bytes((number,)) * 16, LONG_TEXT[:16])])


def met_robots_file() -> Path:
    return files.settings_folder() / "robots.json"


def program(number: int) -> bytes:
    return images.pack("SI", 0, bytes((number,)))


def found_maps() -> list[int]:
    numbers = (FIRST_NUMBER, SECOND_NUMBER, THIRD_NUMBER)
    return [number for number in numbers if source_map.recall(images.checksum(program(number)))]


def output() -> Path:
    files.settings_folder().mkdir(parents=True, exist_ok=True)
    return files.settings_folder() / "out.hex"


def found_output() -> list[int]:
    with suppress(FileNotFoundError):
        data = output().read_bytes()
        assert data == data[:1] * len(LONG_TEXT), "it is neither the old one nor the new"
        return [data[0]]
    return []


FIRMWARE_ROW = ":01000000{value:02X}{check:02X}\n"


def remember_firmware(number: int, value: int) -> None:
    rows = FIRMWARE_ROW.format(value=value, check=255 - value) * (len(LONG_TEXT) // 14)
    data = f"{rows}:00000001FF\n".encode()
    assert ready.store("robot", "uno", str(number), data).path.is_file()


def found_firmware() -> dict[int, int]:
    firmware_files = ready.files(ready.firmware_cache())
    return {int(file.digest): int(file.path.read_text()[9:11]) for file in firmware_files}


KEPT_FILES = {
    "ports": KeptNumbers(
        lambda number: known_ports.remember(f"/dev/ttyUSB{number}", LONG_TEXT),
        lambda: [
            int(port[-1])
            for port in known_ports.remembered_ports().name_by_port
            if port.startswith("/dev/ttyUSB")
        ],
        known_ports,
    ),
    "keys": KeptNumbers(
        add_key, lambda: [key.id for key in key_file().all()], keys, failure=(BadKeys,)
    ),
    "robots that were met": KeptNumbers(
        lambda number: met_robots.remember_robot(met_robots_file(), f"{number}{LONG_TEXT}", number),
        lambda: [*met_robots.read_met_robots(met_robots_file()).id_by_place.values()],
        met_robots,
    ),
    "robots that may answer": KeptNumbers(
        lambda number: met_robots.accept(met_robots_file(), number),
        lambda: met_robots.read_met_robots(met_robots_file()).accepted_ids,
        met_robots,
        failure=(OSError,),
    ),
    "profiles": KeptNumbers(
        lambda number: given.remember(f"/{LONG_TEXT}{number}", number),
        lambda: [number for number, _ in given._remembered_profiles()],
        given,
    ),
    "firmware": KeptNumbers(
        lambda number: remember_firmware(number, number),
        lambda: [*found_firmware()],
        ready,
        failure=(OSError,),
    ),
    "maps": KeptNumbers(
        lambda number: source_map.remember(program(number), SourceMap(LONG_TEXT, (), ())),
        found_maps,
        source_map,
    ),
    "a program": KeptNumbers(
        lambda number: outputs.write_output(str(output()), bytes((number,)) * len(LONG_TEXT)),
        found_output,
        outputs,
        is_alone=True,
        failure=(CommandError,),
    ),
}
each_kept_file = pytest.mark.parametrize("name", KEPT_FILES)
each_growing_file = pytest.mark.parametrize(
    "name", [name for name, kept_file in KEPT_FILES.items() if not kept_file.is_alone]
)


@pytest.fixture(autouse=True)
def _folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for variable in ("XDG_CACHE_HOME", "XDG_CONFIG_HOME"):
        monkeypatch.setenv(variable, str(tmp_path / variable))


def fork_child(action: Callable[[], object]) -> int:
    """Return the number of a process of its own that does something and ends with 0."""
    number = os.fork()
    if number == 0:
        code = 1
        try:
            action()
            code = 0
        finally:
            os._exit(code)
    return number


def wait_for_child(number: int) -> int:
    return os.waitstatus_to_exitcode(os.waitpid(number, 0)[1])


def trace_until_line(
    kept_memory: KeptNumbers, line: int, action: Callable[[], object]
) -> Callable[[], None]:
    """Return a tracer that counts the executed lines of the writing code, and acts at one."""
    traced_files = {kept_memory.module.__file__, files.__file__}
    lines_left = [line]

    def trace(frame: FrameType, event: str, _: Any) -> Any:
        if frame.f_code.co_filename not in traced_files:
            return None
        if event == "line":
            lines_left[0] -= 1
            if lines_left[0] == 0:
                action()
        return trace

    return lambda: sys.settrace(trace)


def lines_of(kept_memory: KeptNumbers, number: int) -> int:
    """Return the number of lines of a first execution."""
    read_end, write = os.pipe()
    count = [0]

    def count_lines() -> None:
        traced_files = {kept_memory.module.__file__, files.__file__}

        def trace(frame: FrameType, event: str, _: Any) -> Any:
            count[0] += event == "line"
            return trace if frame.f_code.co_filename in traced_files else None

        sys.settrace(trace)
        kept_memory.add(number)
        sys.settrace(None)
        os.write(write, count[0].to_bytes(4, "little"))

    assert wait_for_child(fork_child(count_lines)) == 0
    line_count = int.from_bytes(os.read(read_end, 4), "little")
    os.close(read_end)
    os.close(write)
    return line_count


def restore(kept_memory: KeptNumbers, tmp_path: Path) -> list[int]:
    """Restore the state with the first value stored; return the stored values."""
    for folder in tmp_path.iterdir():
        for path in sorted(folder.rglob("*"), reverse=True):
            path.unlink() if path.is_file() else path.rmdir()
    kept_memory.add(FIRST_NUMBER)
    assert kept_memory.all() == [FIRST_NUMBER]
    return [FIRST_NUMBER]


@pytest.mark.sampled("name", keep=3)
@each_kept_file
def test_a_kill_at_any_line_leaves_the_kept_data_intact(
    name: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    kept_memory = KEPT_FILES[name]
    restore(kept_memory, tmp_path)
    lines = lines_of(kept_memory, SECOND_NUMBER)
    assert lines > 10
    lines_reached = set()
    for line in sample_of(request.config, name, range(1, lines + 1), min(LINES, lines)):
        saved_numbers = restore(kept_memory, tmp_path)

        def kill_at_line(line: int = line) -> None:
            trace_until_line(kept_memory, line, lambda: os.kill(os.getpid(), signal.SIGKILL))()
            kept_memory.add(SECOND_NUMBER)

        assert wait_for_child(fork_child(kill_at_line)) == -signal.SIGKILL, line
        all_after = kept_memory.all()
        assert sorted(all_after) in (
            saved_numbers,
            expected_values(kept_memory, saved_numbers, SECOND_NUMBER),
        ), line
        lines_reached.add(len(all_after))
        kept_memory.add(THIRD_NUMBER)
        assert sorted(kept_memory.all()) == expected_values(
            kept_memory, sorted(all_after), THIRD_NUMBER
        ), line
    assert lines_reached


def expected_values(kept_memory: KeptNumbers, counts_before: list[int], number: int) -> list[int]:
    return [number] if kept_memory.is_alone else [*counts_before, number]


@each_kept_file
def test_a_disk_full_at_any_byte_leaves_the_kept_data_intact(name: str, tmp_path: Path) -> None:
    kept_memory = KEPT_FILES[name]
    for free_bytes in (0, 1, 10, 60):
        saved_numbers = restore(kept_memory, tmp_path)

        def limit_size(free_bytes: int = free_bytes) -> None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (free_bytes, free_bytes))
            with suppress(*kept_memory.failure):
                kept_memory.add(SECOND_NUMBER)

        assert wait_for_child(fork_child(limit_size)) == 0
        assert kept_memory.all() == saved_numbers, free_bytes
        assert not [*tmp_path.rglob(f"*{files.NEW_ENDING}")], "nothing is left of what did not fit"
        kept_memory.add(SECOND_NUMBER)
        assert sorted(kept_memory.all()) == expected_values(
            kept_memory, saved_numbers, SECOND_NUMBER
        ), free_bytes


@each_growing_file
def test_a_folder_that_cannot_be_made_ends_nothing(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept_memory = KEPT_FILES[name]
    (tmp_path / "file").touch()
    for variable in ("XDG_CACHE_HOME", "XDG_CONFIG_HOME"):
        monkeypatch.setenv(variable, str(tmp_path / "file"))
    for _ in range(2):
        with pytest.raises(kept_memory.failure) if kept_memory.failure else nullcontext():
            kept_memory.add(FIRST_NUMBER)


@pytest.mark.sampled("name", keep=2)
@each_growing_file
def test_concurrent_commands_lose_none_of_their_data(
    name: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    """One is paused at a line; the other one ends meanwhile, or waits for it."""
    kept_memory = KEPT_FILES[name]
    restore(kept_memory, tmp_path)
    lines = lines_of(kept_memory, SECOND_NUMBER)
    for line in sample_of(request.config, name, range(1, lines + 1), min(LINES, lines)):
        saved_numbers = restore(kept_memory, tmp_path)
        arrival_pipe, release_pipe = os.pipe(), os.pipe()
        wait_pipe = os.pipe()

        def pause_at_line(
            line: int = line, arrival_pipe: Any = arrival_pipe, release_pipe: Any = release_pipe
        ) -> None:
            trace_until_line(
                kept_memory,
                line,
                lambda: (os.write(arrival_pipe[1], b"1"), os.read(release_pipe[0], 1)),
            )()
            kept_memory.add(SECOND_NUMBER)

        def run_child(wait_pipe: Any = wait_pipe) -> None:
            vars(files)["sleep"] = lambda _: os.write(wait_pipe[1], b"w")
            kept_memory.add(THIRD_NUMBER)
            os.write(wait_pipe[1], b"e")

        first_child = fork_child(pause_at_line)
        assert os.read(arrival_pipe[0], 1)
        second_child = fork_child(run_child)
        assert os.read(wait_pipe[0], 1) in (b"w", b"e")
        os.write(release_pipe[1], b"1")
        assert (wait_for_child(first_child), wait_for_child(second_child)) == (0, 0), line
        assert sorted(kept_memory.all()) == [*saved_numbers, SECOND_NUMBER, THIRD_NUMBER], line
        for end in (*arrival_pipe, *release_pipe, *wait_pipe):
            os.close(end)


@each_growing_file
def test_a_suspended_writer_does_not_block_others_for_ever(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The other one keeps it without the lock, or says that it cannot, or leaves it as it was."""
    kept_memory = KEPT_FILES[name]
    saved_numbers = restore(kept_memory, tmp_path)
    now_s = 0.0

    def advance_time(seconds: float) -> None:
        nonlocal now_s
        now_s += seconds
        assert now_s < 2 * files.LOCK_WAIT_S, "it waits for ever"

    monkeypatch.setattr(files, "monotonic", lambda: now_s)
    monkeypatch.setattr(files, "sleep", advance_time)
    with ExitStack() as stack:
        for lock in [*tmp_path.rglob(f"*{files.LOCK_ENDING}")]:
            stack.enter_context(
                files.lock_file(lock.with_name(lock.name[: -len(files.LOCK_ENDING)]))
            )
        for _ in range(2):  # the second pass finds the existing files
            now_s = 0.0
            with suppress(*kept_memory.failure):
                kept_memory.add(SECOND_NUMBER)
            assert sorted(kept_memory.all()) in (
                saved_numbers,
                expected_values(kept_memory, saved_numbers, SECOND_NUMBER),
            )
    kept_memory.add(THIRD_NUMBER)
    assert THIRD_NUMBER in kept_memory.all()


# -- what something else has changed --------------------------------------------------------------


JUNK: tuple[Any, ...] = (
    None, True, -1, 1e400, 10**30, "", "x", "\x1b[2J", "\ud800", [], [[]], [[1, 2, 3]], {},
    {"a": 1},
)  # fmt: skip
JUNK_FILES = (
    b"", b"\xff\xfe", b"{}", b"[]", b"null", b"[" * 100_000, b"1" * 5000, b":zz", ":é\n".encode(),
    b" " * (1 << 21) + b"{}",
)  # fmt: skip


def damaged(data: bytes, rng: Random) -> bytes:
    """Return a file's bytes with junk in the place of any part."""
    if rng.random() < 0.1:
        return data[: rng.randrange(len(data))]
    try:
        holder: Any = [json.loads(data)]
    except ValueError:  # the file is not JSON
        k = rng.randrange(len(data))
        return data[:k] + bytes((rng.randrange(256),)) + data[k + 1 :]
    root, key = holder, 0
    while isinstance(holder[key], (list, dict)) and holder[key] and rng.random() < 0.8:
        holder = holder[key]
        key = rng.choice(list(holder) if isinstance(holder, dict) else range(len(holder)))
    if isinstance(holder, dict) and rng.random() < 0.3:
        del holder[key]
    else:
        holder[key] = rng.choice(JUNK)
    return json.dumps(root[0]).encode()


@pytest.mark.parametrize("seed", range(3))
@each_growing_file
def test_whatever_a_file_has_become_the_next_command_works(
    name: str, seed: int, tmp_path: Path
) -> None:
    """Keys that cannot be read are an error, and stay as they are; all else is kept again."""
    rng, kept_memory = Random(seed), KEPT_FILES[name]
    for junk in (*JUNK_FILES, *[None] * 20):
        restore(kept_memory, tmp_path)
        (path,) = (
            path for path in tmp_path.rglob("*") if path.is_file() and path.suffix != ".lock"
        )
        data = damaged(path.read_bytes(), rng) if junk is None else junk
        path.write_bytes(data)
        try:
            kept_memory.all()
            ports = known_ports.remembered_ports()
            assert isinstance(ports.last_port, str | None)
            assert all(name.isprintable() for name in ports.name_by_port.values())
            kept_memory.add(SECOND_NUMBER)
            assert SECOND_NUMBER in kept_memory.all(), data
        except BadKeys:
            assert kept_memory.module == keys and path.read_bytes() == data


# -- what there is no room for --------------------------------------------------------------------


class LimitedMemory(NamedTuple):
    """A memory with `room`: `entries` returns the numbers that it has, with the value of each.

    Where `ignores_known`, the mention of what it has makes that no newer.
    """

    module: ModuleType
    room: str
    remember: Callable[[int, int], object]
    entries: Callable[[], dict[int, int]]
    ignores_known: bool = False


def maps_by_number() -> dict[int, int]:
    maps = {number: source_map.recall(images.checksum(program(number))) for number in NUMBERS}
    return {number: int(found.lines[0]) for number, found in maps.items() if found is not None}


NUMBERS = range(1, 7)
LIMITED_MEMORIES = {
    "ports": LimitedMemory(
        known_ports,
        "MAX_PORTS",
        lambda number, value: known_ports.remember(f"COM{number}", str(value)),
        lambda: {
            int(port[-1]): int(name)
            for port, name in known_ports.remembered_ports().name_by_port.items()
        },
    ),
    "robots that were met": LimitedMemory(
        met_robots,
        "MAX_PLACES",
        lambda number, value: met_robots.remember_robot(met_robots_file(), str(number), value),
        lambda: {
            int(place): robot
            for place, robot in met_robots.read_met_robots(met_robots_file()).id_by_place.items()
        },
        ignores_known=True,
    ),
    "robots that may answer": LimitedMemory(
        met_robots,
        "MAX_PLACES",
        lambda number, _: met_robots.accept(met_robots_file(), number),
        lambda: dict.fromkeys(met_robots.read_met_robots(met_robots_file()).accepted_ids, 0),
    ),
    "profiles": LimitedMemory(
        given,
        "MAX_PROFILES",
        lambda number, _: given.remember(f"/{number}", number),
        lambda: dict.fromkeys((number for number, _ in given._remembered_profiles()), 0),
    ),
    "maps": LimitedMemory(
        source_map,
        "MAX_MAPS",
        lambda number, value: source_map.remember(
            program(number), SourceMap("", (str(value),), ())
        ),
        maps_by_number,
    ),
    "firmware": LimitedMemory(ready, "MAX_FILES", remember_firmware, found_firmware),
}
HAS_NO_VALUES = ("robots that may answer", "profiles")


def date_files(folder: Path, clock: Iterator[int]) -> None:
    """Give the file that was written last a time of its own, whatever the clock's precision."""
    paths = [path for path in folder.rglob("*") if path.suffix in (".json", ".hex")]
    newest = max(paths, key=lambda path: path.stat().st_mtime_ns)
    moment_s = next(clock)
    os.utime(newest, (moment_s, moment_s))


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", LIMITED_MEMORIES)
def test_what_was_kept_last_is_there_and_the_oldest_gives_way(
    name: str, seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """This holds whatever was kept before; each is there once, with its last value."""
    memory, rng, clock = LIMITED_MEMORIES[name], Random(seed), count(1)
    room = rng.choice((1, 3))
    monkeypatch.setattr(memory.module, memory.room, room)
    expected = dict[int, int]()
    for _ in range(25):
        number = rng.choice(NUMBERS)
        value = 0 if name in HAS_NO_VALUES else rng.randrange(1, 4)
        memory.remember(number, value)
        date_files(tmp_path, clock)
        if not (memory.ignores_known and expected.get(number) == value):
            expected.pop(number, None)
            expected[number] = value
            expected = dict([*expected.items()][-room:])
        assert memory.entries() == expected
        if name == "robots that may answer":
            accepted = met_robots.read_met_robots(met_robots_file()).accepted_ids
            assert len(accepted) == len(expected), "each is there once"


@pytest.mark.parametrize("seed", range(3))
def test_of_robots_that_were_met_and_that_may_answer_neither_loses_the_other(seed: int) -> None:
    """They are in one file."""
    rng, path, places, accepted = Random(seed), met_robots_file(), dict[str, int](), set[int]()
    for _ in range(20):
        robot = rng.choice(NUMBERS)
        if rng.random() < 0.5:
            met_robots.accept(path, robot)
            accepted.add(robot)
        else:
            place = rng.choice("ab")
            met_robots.remember_robot(path, place, robot)
            places[place] = robot
        found = met_robots.read_met_robots(path)
        assert (found.id_by_place, {*found.accepted_ids}) == (places, accepted)
