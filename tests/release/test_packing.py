"""Archives are the same wherever and whenever they are made."""

from __future__ import annotations

import os
import zipfile
from pathlib import Path

from tools.builds import library
from tools.release.packing import pack_folder, sha256

EPOCH = 1_700_000_000


def folder(place: Path, names: list[str], when: int) -> Path:
    for name in names:
        path = place / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"{name}\n", encoding="utf-8")
        os.utime(path, (when, when))
        path.chmod(0o755 if name.endswith(".sh") else 0o640 if when % 2 else 0o664)
    return place


def test_the_same_files_give_the_same_bytes(tmp_path: Path) -> None:
    names = ["b.sh", "a/ñ.txt", "a/b.txt"]
    one = folder(tmp_path / "one", names, EPOCH + 1)
    other_folder = folder(tmp_path / "other place", names[::-1], 10_000)
    first = pack_folder(one, tmp_path / "x-1.zip", EPOCH)
    (tmp_path / "again").mkdir()
    second = pack_folder(other_folder, tmp_path / "again" / "x-1.zip", EPOCH)
    assert first.read_bytes() == second.read_bytes()
    with zipfile.ZipFile(first) as zip_file:
        assert zip_file.namelist() == ["x-1/a/b.txt", "x-1/a/ñ.txt", "x-1/b.sh"]
        assert {row.date_time for row in zip_file.infolist()} == {(2023, 11, 14, 22, 13, 20)}


def test_unpacked_files_keep_their_executable_bit(tmp_path: Path) -> None:
    path = pack_folder(
        folder(tmp_path / "one", ["b.sh", "a.txt"], EPOCH), tmp_path / "x.zip", EPOCH
    )
    with zipfile.ZipFile(path) as zip_file:
        rights = {row.filename: row.external_attr >> 16 & 0o777 for row in zip_file.infolist()}
    assert rights == {"x/b.sh": 0o755, "x/a.txt": 0o644}


def test_the_library_is_built_reproducibly(tmp_path: Path) -> None:
    sums = set()
    for place in ("one", "other place"):
        path = tmp_path / place / "TiniScript"
        assert library.main([str(path), "--url", "https://example.org/t"]) == 0
        sums.add(sha256(pack_folder(path, tmp_path / place / "TiniScript-1.zip", EPOCH)))
    assert len(sums) == 1
