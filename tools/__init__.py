"""Tools for developers. Knows the repository, and adds its package to the path."""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "compiler")]


class CannotMake(RuntimeError):
    """Raised if something is missing or wrong, with the remedy."""
