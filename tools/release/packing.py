"""Archives whose bytes depend only on their contents.

Knows files and folders. Names are sorted, every time is the release's, and there are no owners.
"""

from __future__ import annotations

import hashlib
import time
import zipfile
from pathlib import Path

EARLIEST_ZIP_TIME = 315_532_800  # 1980-01-01: a ZIP file knows no earlier time


def pack_folder(folder: Path, target: Path, epoch: int) -> Path:
    """Write a folder's files into a ZIP file, inside of a folder that is named like it.

    `epoch` is the time of all files, in seconds since 1970.
    """
    zip_time = time.gmtime(max(epoch, EARLIEST_ZIP_TIME))[:6]
    top_folder = target.name.removesuffix(".zip")
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(path for path in folder.rglob("*") if path.is_file()):
            name = f"{top_folder}/{path.relative_to(folder).as_posix()}"
            entry = zipfile.ZipInfo(name, zip_time)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system = 3  # Unix, which keeps the executable bit
            entry.external_attr = (0o100755 if path.stat().st_mode & 0o100 else 0o100644) << 16
            archive.writestr(entry, path.read_bytes())
    return target


def sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
