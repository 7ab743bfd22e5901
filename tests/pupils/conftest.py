"""Which programs of the corpus a run takes."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import Entry, entries
from tests.pupils.cover import covered


@pytest.fixture(scope="session")
def programs(pytestconfig: pytest.Config) -> tuple[Entry, ...]:
    """Those that reach every branch; with `--whole`, and where pins are written, all."""
    is_whole = pytestconfig.getoption("--whole") or pytestconfig.getoption("--accept")
    return entries() if is_whole else covered()
