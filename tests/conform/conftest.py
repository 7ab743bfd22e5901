"""What all tests of the kit need."""

from __future__ import annotations

import pytest

from tests.support.conformance_kit import have_kit


@pytest.fixture(scope="session", autouse=True)
def kit() -> None:
    have_kit()
