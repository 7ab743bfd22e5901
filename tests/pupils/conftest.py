"""Chooses the programs of the corpus that a run uses."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import Entry, entries
from tests.pupils.cover import list_covering_entries


@pytest.fixture(scope="session")
def programs(pytestconfig: pytest.Config) -> tuple[Entry, ...]:
    """Programs that reach every branch; all with `--whole`, and where pins are written."""
    is_whole = pytestconfig.getoption("--whole") or pytestconfig.getoption("--accept")
    return entries() if is_whole else list_covering_entries()
