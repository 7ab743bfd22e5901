"""C++ sources without their comments."""

from __future__ import annotations

import re
from pathlib import Path


def code_of(path: Path) -> str:
    """Return the text of a file without its comments and strings."""
    text = path.read_text(encoding="utf-8")
    return re.sub(
        r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\])\'', " ", text, flags=re.S
    )
