"""Files that are replaced atomically, and leftovers of killed commands."""

from __future__ import annotations

import json
import os
import socket
import stat
import subprocess
import sys
from contextlib import suppress
from itertools import product
from pathlib import Path
from time import time
from typing import IO

import platformdirs
import pytest

from tests.support.command import PROGRAM, Command, Tsc, run_in_process
from tiniscript.base import files
from tiniscript.cli import outputs
from tiniscript.library import source_map
from tiniscript.link.sharing import registry

LIBRARY_FOLDER = Path(files.__file__).parent


def test_the_folders_are_where_platformdirs_has_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """Though on Linux they are found without that."""
    values = (None, "", "part", "/elsewhere", "/elsewhere/", "~/cache")
    for folder, home in product(values, (None, "", "part", "/home/ada", "/")):
        for name, value in (
            ("XDG_CACHE_HOME", folder),
            ("XDG_CONFIG_HOME", folder),
            ("HOME", home),
        ):
            if value is None:
                monkeypatch.delenv(name, raising=False)
            else:
                monkeypatch.setenv(name, value)
        cache = platformdirs.user_cache_path("tiniscript", appauthor=False)
        settings = platformdirs.user_config_path("tiniscript", appauthor=False)
        assert (files.cache_folder(), files.settings_folder()) == (cache, settings), (folder, home)


def test_no_folder_on_windows_has_an_author_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    """Such folders would repeat the program's name as the author: tiniscript\\tiniscript."""
    calls: list[tuple[str, object]] = []

    def path(name: str, appauthor: object = None) -> Path:
        calls.append((name, appauthor))
        return Path(name)

    monkeypatch.setattr(files, "_linux_folder", lambda variable, default: None)
    monkeypatch.setattr(platformdirs, "user_cache_path", path)
    monkeypatch.setattr(platformdirs, "user_config_path", path)
    assert files.cache_folder() == files.settings_folder() == Path("tiniscript")
    assert calls == [("tiniscript", False)] * 2


def mode_of(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def test_a_new_file_follows_the_umask_and_an_existing_one_keeps_its_mode(tmp_path: Path) -> None:
    for umask in (0o022, 0o077, 0o002):
        umask_before = os.umask(umask)
        try:
            files.replace(tmp_path / f"{umask:o}", b"1")
        finally:
            os.umask(umask_before)
        assert mode_of(tmp_path / f"{umask:o}") == 0o666 & ~umask
    path = tmp_path / "x"
    path.write_bytes(b"1")
    for mode in (0o600, 0o644, 0o755, 0o666):
        path.chmod(mode)
        files.replace(path, b"%o" % mode)
        assert (mode_of(path), path.read_bytes()) == (mode, b"%o" % mode)


def test_another_hard_link_keeps_the_old_content_and_a_pipe_stays_a_pipe(tmp_path: Path) -> None:
    """A file is never overwritten in place, but a path without old content is written directly."""
    (tmp_path / "x").write_bytes(b"1")
    os.link(tmp_path / "x", tmp_path / "y")
    files.replace(tmp_path / "x", b"2")
    assert ((tmp_path / "x").read_bytes(), (tmp_path / "y").read_bytes()) == (b"2", b"1")
    os.mkfifo(tmp_path / "pipe")
    reader = os.open(tmp_path / "pipe", os.O_RDONLY | os.O_NONBLOCK)
    try:
        files.replace(tmp_path / "pipe", b"3")
        assert os.read(reader, 9) == b"3"
    finally:
        os.close(reader)
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)


def test_a_private_file_is_never_open_to_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    modes = []
    real_call = Path.chmod

    def chmod(self: Path, mode: int) -> None:
        modes.append(mode_of(self))
        real_call(self, mode)

    (tmp_path / "x").write_bytes(b"1")
    real_call(tmp_path / "x", 0o640)
    monkeypatch.setattr(Path, "chmod", chmod)
    files.replace(tmp_path / "x", b"2")
    assert modes == [0o600]


def test_a_link_planted_at_the_new_file_is_not_followed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Even one who knew its name could only keep the file from being written."""
    precious = tmp_path / "precious"
    precious.write_bytes(b"mine")
    monkeypatch.setattr(os, "urandom", lambda count: bytes(count))
    (tmp_path / f".x.{'00' * 8}.new").symlink_to(precious)
    with pytest.raises(FileExistsError):
        files.replace(tmp_path / "x", b"2")
    assert precious.read_bytes() == b"mine"
    assert not (tmp_path / "x").exists()


def test_the_temporary_name_differs_each_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = []
    real_call = Path.replace

    def replace(self: Path, target: Path) -> Path:
        names.append(self.name)
        return real_call(self, target)

    monkeypatch.setattr(Path, "replace", replace)
    for _ in range(20):
        files.replace(tmp_path / "x", b"2")
    assert len(set(names)) == 20
    assert not any(str(os.getpid()) == part for name in names for part in name.split("."))


def test_a_link_stays_a_link_and_a_cycle_of_links_ends(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    target, link = tmp_path / "folder" / "x", tmp_path / "link"
    target.write_bytes(b"1")
    link.symlink_to(target)
    files.replace(link, b"2")
    assert link.is_symlink() and target.read_bytes() == b"2"
    assert [path.name for path in (tmp_path / "folder").iterdir()] == ["x"]
    (tmp_path / "a").symlink_to("b")
    (tmp_path / "b").symlink_to("a")
    with pytest.raises(OSError, match="symbolic links"):
        files.replace(tmp_path / "a", b"x")


def test_a_failed_write_leaves_no_temporary_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "x").write_bytes(b"1")
    for failure in (OSError(28, "No space left on device"), KeyboardInterrupt()):

        def fail(*_: object, failure: BaseException = failure) -> None:
            raise failure

        monkeypatch.setattr(Path, "replace", fail)
        with pytest.raises(type(failure)):
            files.replace(tmp_path / "x", b"2")
        assert [path.name for path in tmp_path.iterdir()] == ["x"]
        assert (tmp_path / "x").read_bytes() == b"1"


def test_an_output_is_on_the_disk_before_it_replaces_the_old_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A stick that is pulled has the old file or the new one."""
    old_file, writes = tmp_path / "a.bin", list[tuple[bytes, bytes]]()
    old_file.write_bytes(b"TS\2old")
    sync = os.fsync

    def read_files(number: int) -> None:
        [new_file] = tmp_path.glob(f".*{files.NEW_ENDING}")
        writes.append((old_file.read_bytes(), new_file.read_bytes()))
        sync(number)

    monkeypatch.setattr(os, "fsync", read_files)
    outputs.write(old_file, b"TS\2new", "unwritable")
    assert writes == [(b"TS\2old", b"TS\2new")]
    assert old_file.read_bytes() == b"TS\2new"


def test_a_full_disk_leaves_nothing(tmp_path: Path) -> None:
    """A limit of the size of files is the disk that is full."""
    program = tmp_path / "a.ts"
    program.write_text(PROGRAM)
    code = (
        "import resource, signal, sys; signal.signal(signal.SIGXFSZ, signal.SIG_IGN);"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (8, 8));"
        "from tiniscript.cli import main; sys.exit(main(sys.argv[1:]))"
    )
    output = tmp_path / "a.bin"
    output.write_bytes(b"TS\2mine")
    completed = subprocess.run(
        [sys.executable, "-B", "-c", code, "compile", str(program), "-o", str(output)],
        capture_output=True,
    )
    assert completed.returncode == 2 and b"cannot be written" in completed.stderr
    assert output.read_bytes() == b"TS\2mine"
    names = sorted(path.name for path in tmp_path.rglob("*") if path.is_file())
    assert names == ["a.bin", "a.ts"], "nor is there an empty map"


def test_only_one_module_replaces_files() -> None:
    for path in LIBRARY_FOLDER.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        # One builds in a folder of its own, the other has its files in the memory of a browser.
        if path.name not in ("files.py", "building.py", "worker.py"):
            for word in ("write_text(", "write_bytes(", "O_EXCL", "mkstemp", ".replace(path)"):
                assert word not in text, f"{path.name}: {word}"


# -- remains of killed commands --------------------------------------------------------------------


def test_abandoned_files_of_the_cache_are_removed(tsc: Tsc, tmp_path: Path) -> None:
    folder = files.cache_folder() / "maps"
    folder.mkdir(parents=True)
    old_path, new_path = folder / ".x.json.00.new", folder / ".y.json.00.new"
    older_file = folder / "0badcafe.1234"  # a name in the form of older versions
    for path in (old_path, new_path, older_file):
        path.write_bytes(b"")
    for path in (old_path, older_file):
        os.utime(path, (time() - 7200, time() - 7200))
    assert tsc("compile", "-e", PROGRAM, "-o", tmp_path / "x.bin").code == 0
    names = {path.name for path in folder.iterdir()}
    assert {old_path.name, older_file.name} & names == set()
    assert new_path.name in names, "another command may be writing it now"
    empty = folder / "00000001.json"
    empty.write_bytes(b"")
    assert source_map.recall(1) is None
    assert not empty.exists()


def names() -> set[str]:
    return {path.name for path in registry._folder().iterdir()}


def test_a_lock_ends_with_its_command() -> None:
    lock = registry.lock_port("socket://127.0.0.1:1")
    assert lock is not None
    assert registry.lock_port("socket://127.0.0.1:1") is None
    registry.tidy()
    assert registry.lock_port("socket://127.0.0.1:1") is None, "it is held"
    assert len(names()) == 1
    lock.close()
    lock.close()
    assert names() == set()


def test_the_lock_and_the_registration_of_a_killed_command_are_removed() -> None:
    """The next command that checks removes them."""
    with socket.create_server(("127.0.0.1", 0)) as unused_socket:
        number = unused_socket.getsockname()[1]
    code = (
        "from tiniscript.link.sharing import registry; lock = registry.lock_port('socket://x:1');"
        f"registry.write(registry.Registration('socket://x:1', {number}, 't', 'a', 'link', 1, 2));"
        "print('held', flush=True); input()"
    )
    command = Command(code=code)
    command.until("held")
    assert registry.lock_port("socket://x:1") is None
    command.kill()
    assert len(names()) == 2
    assert json.loads(run_in_process("doctor", "--ports", "--json").out) is not None
    assert names() == set()


def test_a_lock_that_was_removed_in_between_locks_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """The owner left between our opening and our locking its file; another one came."""
    old_lock = registry.lock_port("socket://x:1")
    assert old_lock is not None
    real_call = registry._lock
    other_locks: list[IO[bytes] | None] = []

    def lock(file: registry._Lock) -> bool:
        if not other_locks:
            other_locks.append(None)
            old_lock.close()
            other_locks.append(registry.lock_port("socket://x:1"))
        return real_call(file)

    monkeypatch.setattr(registry, "_lock", lock)
    assert registry.lock_port("socket://x:1") is None
    assert other_locks[1] is not None, "one has it"
    other_locks[1].close()


@pytest.mark.parametrize("is_of_folder", [False, True], ids=["the link itself", "of a folder"])
def test_another_user_s_link_in_a_shared_folder_leads_nowhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, is_of_folder: bool
) -> None:
    """Tested where even root cannot be two users: /tmp is root's, and this user plays the other
    one.
    """
    kept_file = tmp_path / "kept"
    kept_file.mkdir()
    precious = kept_file / "precious"
    precious.write_text("mine")
    shared_path = tmp_path / "shared"
    shared_path.mkdir()
    shared_path.chmod(0o777)
    link = (
        shared_path / "way" if os.geteuid() == 0 else Path(f"/tmp/tiniscript-{os.urandom(8).hex()}")
    )
    link.symlink_to(kept_file if is_of_folder else precious)
    target = link / "precious" if is_of_folder else link
    try:
        if os.geteuid() == 0:
            files.replace(target, b"through an own link")
            os.chown(link, 65534, 65534, follow_symlinks=False)
        else:
            monkeypatch.setattr(os, "geteuid", lambda: 12345)
        bytes_before = precious.read_bytes()
        for path in (
            target,
            link.parent / ".." / link.parent.name / target.relative_to(link.parent),
        ):
            with pytest.raises(PermissionError):
                files.replace(path, b"somebody else's wish")
        assert precious.read_bytes() == bytes_before and sorted(kept_file.iterdir()) == [precious]
        if os.geteuid() == 0:
            # Others cannot write to the folder, so its owner has created it.
            shared_path.chmod(0o755)
            files.replace(target, b"now")
            assert precious.read_bytes() == b"now" and link.is_symlink()
    finally:
        link.unlink()


# -- data for the next command -------------------------------------------------------------------


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such modes")
def test_kept_files_are_private_even_if_they_were_not_before(
    tmp_path: Path,
) -> None:
    folder = tmp_path / "kept"
    for _ in range(2):
        assert files.keep(folder / "data", b"new")
        modes = [stat.S_IMODE(path.stat().st_mode) for path in (folder, folder / "data")]
        assert modes == [0o700, 0o600]
        folder.chmod(0o755)  # of an older version
        (folder / "data").chmod(0o644)
    (tmp_path / "file").touch()
    assert not files.keep(tmp_path / "file" / "data", b"new")
    assert not files.keep(folder / "da\0ta", b"new")


def test_a_lock_has_one_holder_until_it_ends_in_any_way(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    now_s = 0.0

    def sleep(seconds: float) -> None:
        nonlocal now_s
        now_s += seconds

    monkeypatch.setattr(files, "monotonic", lambda: now_s)
    monkeypatch.setattr(files, "sleep", sleep)
    path = tmp_path / "data"
    for _ in range(2):
        with suppress(KeyError), files.lock_file(path):
            start_s = now_s
            with pytest.raises(TimeoutError), files.lock_file(path):
                raise AssertionError("two have the lock")
            assert files.LOCK_WAIT_S <= now_s - start_s < files.LOCK_WAIT_S + 0.1
            raise KeyError
        start_s = now_s
        with files.lock_file(path):
            assert now_s == start_s


def test_only_regular_files_within_the_size_limit_are_read(tmp_path: Path) -> None:
    path = tmp_path / "data"
    path.write_bytes(b"12345")
    assert files.read_limited(path, 5) == b"12345"
    not_files = [tmp_path, Path(os.devnull)]
    if sys.platform != "win32":
        os.mkfifo(tmp_path / "pipe")
        not_files.append(tmp_path / "pipe")
    for file in not_files:
        with pytest.raises(OSError):
            files.read_limited(file, 5)
    with pytest.raises(OSError):
        files.read_limited(path, 4)
