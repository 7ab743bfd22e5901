"""`python -m tools.generate` says which file it lacks."""

from __future__ import annotations

import pytest

from tests.support.casefile import ROOT
from tools.generate import __main__ as generate


@pytest.mark.parametrize("options", [[], ["--check"]])
def test_a_file_that_is_missing_is_named(
    options: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    lacking = ROOT / "docs" / "none.md"
    outputs = [(ROOT / "docs" / "made.md", lacking.read_text)]
    monkeypatch.setattr(generate, "OUTPUTS", outputs)
    with pytest.raises(SystemExit, match=r"docs/made\.md cannot be made: docs/none\.md is missing"):
        generate.main(options)
    assert not (ROOT / "docs" / "made.md").exists()
