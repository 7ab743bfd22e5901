"""What a test needs on this computer: the stand-in that needs it asks for it."""

from __future__ import annotations

import os

IS_CI = bool(os.environ.get("CI"))


def need(why: str) -> None:
    """Skip a test where something is missing; in CI that is a failure."""
    if why:
        assert not IS_CI, why
        import pytest  # what tests are made with asks, too, where there is none

        pytest.skip(why.strip().replace("\n", "; "))
