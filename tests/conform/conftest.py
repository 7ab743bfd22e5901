"""Fixtures for all tests of the kit."""

from __future__ import annotations

import pytest

from tests.support.conformance_kit import have_kit


@pytest.fixture(scope="session", autouse=True)
def kit() -> None:
    have_kit()
