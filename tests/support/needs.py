"""Prerequisites of tests on this computer, which the stand-ins check."""

from __future__ import annotations

import os

IS_CI = bool(os.environ.get("CI"))


def need(reason: str) -> None:
    """Skip a test where something is missing; in CI that is a failure."""
    if reason:
        assert not IS_CI, reason
        import pytest  # imported late, because the tools that build the tests also ask

        pytest.skip(reason.strip().replace("\n", "; "))
