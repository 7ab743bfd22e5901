"""The reader of text stays small on an Uno."""

from __future__ import annotations

import pytest

from tools.bench import text_size
from tools.bench.machine_size import AVR, missing


@pytest.mark.skipif(bool(missing(AVR)), reason=missing(AVR) or "there is a compiler")
def test_the_reader_fits() -> None:
    """Where it is passed as a pointer, as `near` does it: else it takes 100 bytes more."""
    found = text_size.size(AVR, "reader and answers")
    assert found.flash <= text_size.MUST
    assert 40 <= found.ram <= text_size.RAM_MUST
