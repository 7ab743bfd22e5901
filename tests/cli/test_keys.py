"""The file with a person's keys, and `tsc set owner --list`."""

from __future__ import annotations

import json
import stat
import subprocess
import sys
from pathlib import Path
from typing import cast

import pytest

from tests.support.command import Tsc
from tiniscript.base import files
from tiniscript.link import met_robots
from tiniscript.link.authority import RobotKey, disown
from tiniscript.link.keys import MAX_KEYS, BadKeys, KeyFile, encode_keys
from tiniscript.link.messages import KEY_OWNER, KEY_TEACHER, STATUSES
from tiniscript.link.payloads import EmptyReply, HelloReply
from tiniscript.link.requests import OK, DeviceInfo, Reply

OWNER_KEY = RobotKey(0x12345678, KEY_OWNER, bytes(range(16)), "TINI")
SECRET = OWNER_KEY.key.hex()


@pytest.fixture
def key_file(tmp_path: Path) -> KeyFile:
    return KeyFile(tmp_path / "settings" / "keys.json")


def test_the_key_file_is_private(key_file: KeyFile) -> None:
    key_file.create_pending_key(1, KEY_OWNER, "A")
    assert stat.S_IMODE(key_file.path.stat().st_mode) == 0o600
    assert stat.S_IMODE(key_file.path.parent.stat().st_mode) == 0o700
    key_file.path.chmod(0o644)
    key_file.create_pending_key(2, KEY_OWNER, "B")
    assert stat.S_IMODE(key_file.path.stat().st_mode) == 0o600


@pytest.mark.parametrize(
    "data",
    [b"", b"{", b"[]", b"null", b'{"tiniscript_keys": 2, "keys": []}', b"\xff\xfe",
     b'{"tiniscript_keys": 1, "keys": [{}]}', b'{"tiniscript_keys": 1, "keys": 3}',
     encode_keys([OWNER_KEY]).replace(b"owner", b"boss"),
     encode_keys([OWNER_KEY]).replace(SECRET[:2].encode(), b"zz"),
     encode_keys([OWNER_KEY._replace(key=bytes(16))]),
     encode_keys([OWNER_KEY._replace(key=bytes(3))]),
     encode_keys([OWNER_KEY]).replace(b"12345678", b"1234567"), b"[" * 100_000,
     encode_keys([OWNER_KEY]).replace(b"12345678", b"-1234567"),
     encode_keys([OWNER_KEY] * (MAX_KEYS + 1))],
)  # fmt: skip
def test_an_invalid_key_file_is_left_as_it_is(key_file: KeyFile, data: bytes) -> None:
    key_file.path.parent.mkdir()
    key_file.path.write_bytes(data)
    with pytest.raises(BadKeys) as exception_info:
        key_file.all()
    assert SECRET not in repr(exception_info.value)
    assert key_file.keys_of_robot(1) == []
    assert key_file.create_pending_key(1, KEY_OWNER, "A") is None
    key_file.settle_key(OWNER_KEY)
    key_file.drop_key(OWNER_KEY)
    assert key_file.path.read_bytes() == data


def test_known_seal_support_survives_a_list_without_it(
    key_file: KeyFile,
) -> None:
    key_file.settle_key(OWNER_KEY._replace(uses_seals=True))
    key_file.settle_key(OWNER_KEY._replace(id=7))
    assert [key.uses_seals for key in key_file.keys_of_robot(None)] == [True, False]
    key_file.add([OWNER_KEY, OWNER_KEY._replace(id=7)])
    assert [key.uses_seals for key in key_file.keys_of_robot(OWNER_KEY.id)] == [True]
    assert KeyFile(key_file.path, serves_virtual_robots=True).keys_of_robot(OWNER_KEY.id) == [
        OWNER_KEY
    ]
    # a different key, so nothing is known about it
    key_file.add([OWNER_KEY._replace(key=b"\2" * 16)])
    assert [key.uses_seals for key in key_file.keys_of_robot(OWNER_KEY.id)] == [False]


def test_the_keys_of_one_robot_are_forgotten(tsc: Tsc) -> None:
    ring = KeyFile()
    teacher = OWNER_KEY._replace(kind=KEY_TEACHER)
    ring.add(
        [OWNER_KEY, teacher, OWNER_KEY._replace(id=7, name="A"), OWNER_KEY._replace(id=8, name="A")]
    )
    for robot in ("tini", "A", "", "00000009"):  # two are called A
        assert tsc("set", "owner", "--forget", robot).code == 2
        assert len(ring.all()) == 4
    for robot in ("TINI", "12345678"):
        ring.add([OWNER_KEY, teacher])
        tsc("set", "owner", "--forget", robot).gives(0, out=robot)
        assert {key.id for key in ring.all()} == {7, 8}
    assert tsc("set", "owner", "--forget", "12345678").code == 2
    assert tsc("set", "owner", "--forget", "7", "--export", "f").code == 2


CLAIM_CODE = """
import sys
from pathlib import Path
from tiniscript.base import files
from tiniscript.link.keys import KeyFile
files.LOCK_WAIT_S = 600.0  # others claim without a pause, which people do not
ring, first = KeyFile(Path(sys.argv[1])), int(sys.argv[2])
for robot in range(first, first + 25):
    key = ring.create_pending_key(robot, 0, "R")
    assert key
    ring.settle_key(key)
    ring.mark_stale(key) if robot % 5 == 0 else None
"""


def test_many_claims_at_once_lose_no_key(key_file: KeyFile) -> None:
    """Each is a process of its own, as each `tsc set owner` is."""
    commands = [
        [sys.executable, "-c", CLAIM_CODE, str(key_file.path), str(100 * k)] for k in range(4)
    ]
    processes = [subprocess.Popen(command) for command in commands]
    assert [process.wait() for process in processes] == [0] * 4
    robot_keys = key_file.all()
    assert sorted(key.id for key in robot_keys) == [
        100 * k + n for k in range(4) for n in range(25)
    ]
    assert not any(key.is_pending for key in robot_keys)
    assert [key.is_stale for key in robot_keys] == [key.id % 5 == 0 for key in robot_keys]


def test_a_suspended_command_does_not_block_others_for_ever(
    key_file: KeyFile, monkeypatch: pytest.MonkeyPatch
) -> None:
    key_file.add([OWNER_KEY])
    monkeypatch.setattr(files, "LOCK_WAIT_S", 0.1)
    with files.lock_file(key_file.path):
        assert key_file.create_pending_key(1, KEY_OWNER, "A") is None
        with pytest.raises(BadKeys):
            key_file.add([OWNER_KEY._replace(id=2)])
        key_file.drop_key(OWNER_KEY)
        assert key_file.all() == [OWNER_KEY]
    assert key_file.create_pending_key(1, KEY_OWNER, "A")


def test_no_text_of_a_key_has_its_bytes() -> None:
    assert SECRET not in repr(OWNER_KEY) + str(OWNER_KEY) + f"{[OWNER_KEY]}"


def test_the_command_lists_names_and_no_key(tsc: Tsc) -> None:
    assert "tsc set owner" in tsc("set", "owner", "--list").out
    KeyFile().add([OWNER_KEY, OWNER_KEY._replace(kind=KEY_TEACHER, key=b"\1" * 16)])
    for language, word in (("en", "teacher"), ("es", "docente")):
        listed_result = tsc("set", "owner", "--list", "--lang", language).gives(
            0, out=(word, "12345678", "TINI")
        )
        assert SECRET not in listed_result.out
    rows = json.loads(tsc("set", "owner", "--list", "--json").out)
    assert [row["kind"] for row in rows] == ["owner", "teacher"]
    assert SECRET not in json.dumps(rows)


def test_a_class_list_is_exported_and_imported(
    tsc: Tsc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "one"))
    KeyFile().add([OWNER_KEY])
    KeyFile().create_pending_key(7, KEY_OWNER, "not confirmed")
    listed_path = tmp_path / "class.json"
    output = tsc("set", "owner", "--export", str(listed_path)).out
    assert "class.json: 1." in output and f"tsc set owner --import {listed_path}" in output
    assert stat.S_IMODE(listed_path.stat().st_mode) == 0o600
    tsc("set", "owner", "--export", str(listed_path)).gives(
        2, "already exists. Choose another name"
    )
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "two"))
    assert (
        "class.json: 1. New here, or changed: 1."
        in tsc("set", "owner", "--import", str(listed_path)).out
    )
    assert KeyFile().all() == [OWNER_KEY]
    listed_path.write_text("nothing")
    tsc("set", "owner", "--import", str(listed_path)).gives(2, "--export")
    assert tsc("set", "owner", "--import", str(tmp_path / "none")).code == 2
    tsc("set", "owner", "--import", str(listed_path), "--export", str(tmp_path / "x")).gives(
        2, "use only one of"
    )


def test_keys_that_do_not_fit_leave_the_existing_keys(tsc: Tsc, tmp_path: Path) -> None:
    """The keys of a stranger would remove a person's own robots."""
    key_file, large_file = KeyFile(), tmp_path / "many.json"
    key_file.add([OWNER_KEY])
    foreign_keys = [RobotKey(robot, KEY_OWNER, bytes([7] * 16), "X") for robot in range(MAX_KEYS)]
    large_file.write_bytes(encode_keys(foreign_keys))
    for language, words in (("en", "2000 keys"), ("es", "2000 llaves")):
        tsc("set", "owner", "--import", str(large_file), "--lang", language).gives(2, words, out="")
    assert key_file.all() == [OWNER_KEY]
    assert key_file.add(foreign_keys[1:]) == MAX_KEYS - 1
    assert key_file.create_pending_key(5_000, KEY_OWNER, "A") is None, (
        "no key is dropped for a new one"
    )
    assert OWNER_KEY in key_file.all() and len(key_file.all()) == MAX_KEYS


def test_a_broken_or_publicly_readable_file_is_reported(tsc: Tsc) -> None:
    path = KeyFile().path
    KeyFile().add([OWNER_KEY])
    path.chmod(0o644)
    assert "chmod 600" in tsc("set", "owner", "--list").err
    path.write_text("broken")
    tsc("set", "owner", "--list").gives(2, "--import")
    assert path.read_text() == "broken"


def test_abandoned_claims_leave_few_keys() -> None:
    """Each key that is shown takes time: of pending ones the last two are kept, of each kind."""
    key_file = KeyFile()
    for _ in range(6):
        key_file.create_pending_key(OWNER_KEY.id, OWNER_KEY.kind, "TINI")
        last_key = key_file.create_pending_key(OWNER_KEY.id, 1 - OWNER_KEY.kind, "TINI")
    other_key = key_file.create_pending_key(7, 0, "")
    assert last_key and other_key
    key_file.mark_stale(last_key)
    robot_keys = key_file.keys_of_robot(OWNER_KEY.id)
    assert sorted(key.kind for key in robot_keys) == [0, 0, 1, 1]
    assert robot_keys[-1] == last_key._replace(is_stale=True) and key_file.keys_of_robot(7) == [
        other_key
    ]


@pytest.mark.parametrize("kind", [KEY_OWNER, KEY_TEACHER])
@pytest.mark.parametrize("status", [OK, STATUSES["NOT_OWNER"]])
def test_giving_up_a_robot_removes_one_key(key_file: KeyFile, kind: int, status: int) -> None:
    """The other one it still has, and so has this computer; a refused one stays."""
    ring = [
        OWNER_KEY._replace(id=robot, kind=kind, key=bytes([robot % 256, kind] * 8))
        for robot in (OWNER_KEY.id, 7)
        for kind in (KEY_OWNER, KEY_TEACHER)
    ]
    key_file.add(ring)
    robot = DeviceInfo("TINI", OWNER_KEY.id, (2, 1), 0, 389, cast(HelloReply, None))
    exchange = disown(key_file, robot, kind)
    next(exchange)
    with pytest.raises(StopIteration):
        exchange.send(Reply(status, 0, EmptyReply()))
    key_ids = {(key.id, key.kind) for key in key_file.all()}
    given_up_keys = {(key.id, key.kind) for key in ring} - key_ids
    assert given_up_keys == ({(OWNER_KEY.id, kind)} if status == OK else set())


ROBOT_ADDRESS = "tcp://ana"


def test_the_addresses_of_robots_are_kept_privately(key_file: KeyFile) -> None:
    key_file.remember_robot(ROBOT_ADDRESS, OWNER_KEY.id)
    key_file.remember_robot("/dev/ttyUSB0", 7)
    key_file.remember_robot(ROBOT_ADDRESS, 8)
    path = key_file.path.with_name("robots.json")
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700
    reopened_key_file = KeyFile(key_file.path)
    assert (
        reopened_key_file.robot_at(ROBOT_ADDRESS),
        reopened_key_file.robot_at("/dev/ttyUSB0"),
        reopened_key_file.robot_at(""),
    ) == (
        8,
        7,
        None,
    )
    assert not reopened_key_file.accepts(9)
    key_file.accept(9)
    assert reopened_key_file.accepts(9) and reopened_key_file.robot_at(ROBOT_ADDRESS) == 8
    assert KeyFile(key_file.path, accepts_all=True).accepts(10)
    KeyFile(key_file.path, serves_virtual_robots=True).remember_robot(ROBOT_ADDRESS, 11)
    assert reopened_key_file.robot_at(ROBOT_ADDRESS) == 8


@pytest.mark.parametrize(
    "data",
    [b"", b"[]", b"{", b"\xff", b"[" * 100_000, b'{"places": [], "accepted": []}',
     b'{"places": {"a": 7}, "accepted": []}', b'{"places": {}, "accepted": ["x"]}'],
)  # fmt: skip
def test_an_invalid_file_of_addresses_is_replaced(key_file: KeyFile, data: bytes) -> None:
    key_file.path.parent.mkdir()
    key_file.path.with_name("robots.json").write_bytes(data)
    assert key_file.robot_at(ROBOT_ADDRESS) is None and not key_file.accepts(7)
    key_file.remember_robot(ROBOT_ADDRESS, 7)
    assert key_file.robot_at(ROBOT_ADDRESS) == 7


def test_a_failure_to_keep_addresses_ends_nothing(key_file: KeyFile) -> None:
    key_file.path.parent.write_bytes(b"a file where the folder should be")
    key_file.remember_robot(ROBOT_ADDRESS, 7)
    assert key_file.robot_at(ROBOT_ADDRESS) is None
    with pytest.raises(BadKeys):
        key_file.accept(7)


def test_the_number_of_kept_addresses_is_limited(
    key_file: KeyFile, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(met_robots, "MAX_PLACES", 3)
    for number in range(5):
        key_file.remember_robot(f"tcp://{number}", number)
    assert [key_file.robot_at(f"tcp://{number}") for number in range(5)] == [None, None, 2, 3, 4]


@pytest.mark.parametrize("robot", ["", "7", "ANA", "1234567g", "123456789", "-1234567"])
def test_only_an_id_is_accepted(tsc: Tsc, robot: str) -> None:
    tsc("set", "owner", f"--accept={robot}").gives(2, "is not a robot's id")
