"""The command: its products in order, and its tools."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import pytest

from tools import CannotMake
from tools.release import __main__ as release
from tools.release import facts
from tools.release.parts import PARTS, Clone, chosen_parts


def test_parts_include_their_dependencies_in_order() -> None:
    assert chosen_parts([]) == list(PARTS)
    assert chosen_parts(["stick"]) == ["conformance", "wheel", "stick"]
    assert chosen_parts(["page", "library"]) == ["studio", "page", "library"]


def test_a_build_process_has_the_commits_time_and_no_settings(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONSTARTUP", "x")
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1")
    variables = Clone(tmp_path, tmp_path, "1", "", 77, 2, False).environment()
    assert variables["SOURCE_DATE_EPOCH"] == "77"
    assert variables["PYTHONHASHSEED"] == "2"
    assert variables["PYTHONPATH"].startswith(str(tmp_path))
    assert "PYTHONSTARTUP" not in variables


def test_failures_in_or_of_a_clone_are_errors(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    clone = Clone(tmp_path, tmp_path, "1", "", 77, 2, False)
    for code in range(4):
        for good_codes in ((0,), (0, 1)):
            words = ("-c", f"print('made'); raise SystemExit({code})")
            if code in good_codes:
                assert clone.python(*words, good_codes=good_codes) == "made\n"
                continue
            with pytest.raises(CannotMake, match="made"):
                clone.python(*words, good_codes=good_codes)
    monkeypatch.setattr(release, "ROOT", tmp_path / "nowhere")
    with pytest.raises(CannotMake, match="no clone"):
        release._clones(tmp_path, "", needs_whole_stick=False)


@pytest.mark.parametrize(
    ("has_complaint", "differs", "goes_on", "tags"), [*product((False, True), repeat=4)]
)
def test_a_faultless_commit_is_released_and_tagged(
    has_complaint: bool,
    differs: bool,
    goes_on: bool,
    tags: bool,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clones = [Clone(tmp_path, tmp_path / f"parts{k}", "1", "", 0, k, False) for k in (1, 2)]
    tagged_versions: list[str] = []

    def make(clone: Clone, _parts: object) -> dict[str, list[Path]]:
        clone.parts.mkdir()
        file = clone.parts / "site.zip"
        file.write_text(str(clone.seed) if differs else "the same")
        return {"site": [file]}

    monkeypatch.setattr(release, "find_missing_tool", lambda parts: "")
    monkeypatch.setattr(release, "_clones", lambda *_: clones)
    monkeypatch.setattr(release, "_make", make)
    monkeypatch.setattr(facts, "release_problems", lambda root: ["wrong"] * has_complaint)
    monkeypatch.setattr(release, "tag", lambda root, version: tagged_versions.append(version))
    options = ["--as-is"] * goes_on + ["--tag"] * tags
    code = release.main([str(tmp_path / "made"), *options])
    assert code == (2 if has_complaint and not goes_on else int(has_complaint or differs))
    assert bool(tagged_versions) == (tags and code == 0)
