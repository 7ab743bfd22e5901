"""Archives whose bytes depend on what is in them alone, and how two of them differ.

Knows files and folders. Names are sorted, every time is the release's, owners are nobody.
"""

from __future__ import annotations

import hashlib
import tarfile
import time
import zipfile
from pathlib import Path

OLDEST = 315_532_800  # 1980-01-01: a ZIP file knows no earlier time
SHOWN = 5  # names of what differs


def pack(folder: Path, target: Path, epoch: int) -> Path:
    """Write a folder's files into a ZIP file, inside of a folder that is named like it.

    `epoch` is the time of all files, in seconds since 1970.
    """
    moment = time.gmtime(max(epoch, OLDEST))[:6]
    inside = target.name.removesuffix(".zip")
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(each for each in folder.rglob("*") if each.is_file()):
            name = f"{inside}/{path.relative_to(folder).as_posix()}"
            row = zipfile.ZipInfo(name, moment)
            row.compress_type = zipfile.ZIP_DEFLATED
            row.create_system = 3  # Unix, which keeps what may be started
            row.external_attr = (0o100755 if path.stat().st_mode & 0o100 else 0o100644) << 16
            archive.writestr(row, path.read_bytes())
    return target


def sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def difference(one: Path, other: Path) -> str:
    """Return what two files of the same name do not have in common, or nothing."""
    if one.read_bytes() == other.read_bytes():
        return ""
    ours, theirs = _members(one), _members(other)
    names = sorted(name for name in ours.keys() | theirs.keys()
                   if ours.get(name) != theirs.get(name))  # fmt: skip
    if not names:
        return f"{one.name}: times, rights or the order of its files"
    more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return f"{one.name}: {', '.join(names[:SHOWN])}{more}"


def _members(path: Path) -> dict[str, str]:
    """Return a digest of each file of an archive; a file that is none has no members."""
    found: dict[str, bytes] = {}
    if zipfile.is_zipfile(path):
        with zipfile.ZipFile(path) as packed:
            found = {name: packed.read(name) for name in packed.namelist()}
    elif tarfile.is_tarfile(path):
        with tarfile.open(path) as tar:
            rows = ((row.name, tar.extractfile(row)) for row in tar.getmembers())
            found = {name: content.read() for name, content in rows if content is not None}
    return {name: hashlib.sha256(data).hexdigest() for name, data in found.items()}
