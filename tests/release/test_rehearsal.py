"""The command: what it makes in which order, and with what it builds."""

from __future__ import annotations

from pathlib import Path

import pytest

from tools.release.parts import PARTS, Clone, chosen_parts


def test_parts_bring_those_that_they_need_in_their_order() -> None:
    assert chosen_parts([]) == list(PARTS)
    assert chosen_parts(["stick"]) == ["conformance", "wheel", "stick"]
    assert chosen_parts(["page", "library"]) == ["studio", "page", "library"]


def test_a_process_that_builds_has_the_time_of_the_commit_and_no_settings(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONSTARTUP", "x")
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1")
    found = Clone(tmp_path, tmp_path, "1", "", 77, 2, False).environment()
    assert found["SOURCE_DATE_EPOCH"] == "77"
    assert found["PYTHONHASHSEED"] == "2"
    assert found["PYTHONPATH"].startswith(str(tmp_path))
    assert "PYTHONSTARTUP" not in found
