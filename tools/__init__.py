"""What developers run. Knows where the repository is, and puts its package on the path."""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "compiler")]


class CannotMake(RuntimeError):
    """Something is missing or wrong; says what, and what to do."""
