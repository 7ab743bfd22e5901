"""Reasons that prevent a release: each has one sentence."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Callable
from itertools import count
from pathlib import Path

import pytest

from tests.support.casefile import ROOT
from tools import CannotMake
from tools.release import __main__ as release
from tools.release import facts
from tools.release.parts import Clone

VERSION = "9.8.7"
URL = "https://example.org/tiniscript"
FILES = ("CITATION.cff", "LICENSE", "SECURITY.md", "docs/en/versions.md", "pyproject.toml",
         "CHANGELOG.md", "compiler/tiniscript/base/version.py")  # fmt: skip
CHANGELOG = f"# Changelog\n\n## Unreleased\n\n## {VERSION} (2031-02-03)\n\n- All.\n"


def git(root: Path, *words: str) -> bytes:
    identity_options = (
        "-c",
        "user.name=a",
        "-c",
        "user.email=a@localhost",
        "-c",
        "init.defaultBranch=main",
    )
    command = ["git", "-C", str(root), *identity_options, *words]
    return subprocess.run(command, check=True, capture_output=True).stdout


def replace_in_file(name: str, old_text: str, new_text: str) -> Callable[[Path], None]:
    def change(root: Path) -> None:
        path = root / name
        text = path.read_text(encoding="utf-8")
        assert old_text in text, (name, old_text)
        path.write_text(text.replace(old_text, new_text), encoding="utf-8")

    return change


def commit(root: Path) -> None:
    git(root, "add", "-A")
    git(root, "commit", "-q", "--allow-empty", "-m", "a: b.")


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    """A repository with all that repeats a fact, ready to be released."""
    root = tmp_path / "clone"
    present_version = facts.version(ROOT)
    for name in FILES:
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, root / name)
        path = root / name
        text = path.read_text("utf-8").replace(present_version, VERSION)
        text = re.sub(r"(?m)^date-released: .*\n", "", text)
        path.write_text(text, encoding="utf-8")
    (root / "CHANGELOG.md").write_text(CHANGELOG, encoding="utf-8")
    replace_in_file("SECURITY.md", facts.NO_CONTACT, "people@example.org")(root)
    pyproject = root / "pyproject.toml"
    pyproject.write_text(facts.with_address(pyproject.read_text("utf-8"), URL), encoding="utf-8")
    git(tmp_path, "init", "-q", str(root))
    commit(root)
    return root


def test_a_ready_release_has_no_problems(clone: Path) -> None:
    assert list(facts.release_problems(clone)) == []
    git(clone, "tag", f"v{VERSION}")
    assert list(facts.release_problems(clone)) == []


WRONG_CHANGES: dict[str, Callable[[Path], object]] = {
    "CHANGELOG.md has no section for": replace_in_file(
        "CHANGELOG.md", f"## {VERSION} (", "## 1.0.0 ("
    ),
    "CHANGELOG.md has no date": replace_in_file("CHANGELOG.md", " (2031-02-03)", ""),
    "has no section Unreleased": replace_in_file("CHANGELOG.md", "## Unreleased\n", ""),
    "changes under Unreleased": replace_in_file(
        "CHANGELOG.md", "## Unreleased\n", "## Unreleased\n\n- B\n"
    ),
    "CITATION.cff has version": replace_in_file(
        "CITATION.cff", f"version: {VERSION}", "version: 0.0.1"
    ),
    "CITATION.cff has the date 2030": replace_in_file(
        "CITATION.cff", "license:", "date-released: 2030-01-01\nlicense:"
    ),
    "docs/en/versions.md has version": replace_in_file(
        "docs/en/versions.md", f"`{VERSION}`", "`0.0.1`"
    ),
    "LICENSE names Somebody": replace_in_file("LICENSE", facts.AUTHORS, "Somebody"),
    "CITATION.cff names nobody": replace_in_file("CITATION.cff", facts.AUTHORS, ""),
    "pyproject.toml names": replace_in_file("pyproject.toml", facts.AUTHORS, "Ann"),
    "does not say how to reach": replace_in_file(
        "SECURITY.md", "people@example.org", facts.NO_CONTACT
    ),
    "SECURITY.md does not say": replace_in_file(
        "SECURITY.md", "Contact: people@example.org", "Contact:"
    ),
    "does not say where it is published": replace_in_file("pyproject.toml", "Source =", "Home ="),
}


def test_each_release_problem_has_a_message(clone: Path) -> None:
    for problem, change in WRONG_CHANGES.items():
        change(clone)
        commit(clone)
        complaints = list(facts.release_problems(clone))
        assert len(complaints) == 1 and problem in complaints[0] and len(complaints[0]) < 200, (
            problem,
            complaints,
        )
        git(clone, "reset", "-q", "--hard", "HEAD~")


def test_an_uncommitted_file_is_named(clone: Path) -> None:
    (clone / "new.txt").touch()
    (complaint,) = facts.release_problems(clone)
    assert complaint.startswith("1 files are not committed, new.txt among them.")


def test_a_tag_of_this_version_on_another_commit_is_reported(clone: Path) -> None:
    git(clone, "tag", f"v{VERSION}")
    commit(clone)
    (complaint,) = facts.release_problems(clone)
    assert (
        complaint == f"The tag v{VERSION} is that of another commit: give this one a new version."
    )


def test_a_tag_of_another_version_is_reported(clone: Path) -> None:
    git(clone, "tag", "v1.2.3")
    git(clone, "tag", "seen")
    (complaint,) = facts.release_problems(clone)
    assert "v1.2.3" in complaint and VERSION in complaint


def test_a_release_gets_its_tag_once(clone: Path) -> None:
    for _ in range(2):
        release.tag(clone, VERSION)
    assert facts.tags(clone) == [f"v{VERSION}"]
    assert list(facts.release_problems(clone)) == []
    commit(clone)
    with pytest.raises(CannotMake, match=r"git tag does not work: .*already exists"):
        release.tag(clone, VERSION)


def test_an_address_has_one_place() -> None:
    text = (
        "[project]\nname = 'a'\n\n[project.urls]\nSource = \"https://a.example\"\n\n[tool]\nb = 1\n"
    )
    once = facts.with_address(text, URL)
    assert once.count("[project.urls]") == 1
    assert "a.example" not in once
    assert "[tool]\nb = 1\n" in once
    assert facts.with_address(once, URL) == once


@pytest.mark.parametrize("is_tagged", [False, True])
def test_a_different_address_is_kept(
    clone: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, is_tagged: bool
) -> None:
    """A commit that is ready for release stays so."""
    monkeypatch.setattr(release, "ROOT", clone)
    if is_tagged:
        release.tag(clone, VERSION)
    for url, commits in ((URL, 1), ("https://example.org/other", 2)):
        scratch = tmp_path / str(commits)
        scratch.mkdir()
        shared_clone, other_clone = release._clones(scratch, url, needs_whole_stick=False)
        assert shared_clone.seed != other_clone.seed, "an order of sets would be seen"
        log = subprocess.run(["git", "-C", shared_clone.root, "log", "--format=%s"], text=True,
                              capture_output=True, check=True)  # fmt: skip
        assert len(log.stdout.splitlines()) == commits
        assert shared_clone.address == url
        assert list(facts.release_problems(shared_clone.root)) == []


@pytest.mark.parametrize("url", ["", URL, "https://example.org/other"])
def test_clones_of_one_commit_give_the_same_bytes_whenever_they_are_made(
    clone: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, url: str
) -> None:
    monkeypatch.setattr(release, "ROOT", clone)
    commit_clone, numbers = release._commit, count(2_000_000_000)

    def commit_later(root: Path) -> None:
        monkeypatch.setenv("GIT_COMMITTER_DATE", f"{next(numbers)} +0000")
        commit_clone(root)

    monkeypatch.setattr(release, "_commit", commit_later)
    clones = list[Clone]()
    for name in ("first", "second"):
        (tmp_path / name).mkdir()
        clones += release._clones(tmp_path / name, url, needs_whole_stick=False)
    assert len({git(made_clone.root, "rev-parse", "HEAD^{tree}") for made_clone in clones}) == 1
    facts_kept = {one._replace(root=tmp_path, parts=tmp_path, seed=0) for one in clones}
    assert len(facts_kept) == 1
    variables = [made_clone.environment() for made_clone in clones]
    differing = {name for name in variables[0] if len({one[name] for one in variables}) > 1}
    assert differing == {"PYTHONHASHSEED", "PYTHONPATH"}


def test_this_repository_agrees_with_itself() -> None:
    """The exceptions come only with a release: a date, an address, a commit of everything."""
    brought = ("CHANGELOG.md", "not committed", "does not say", "The tag", "The commit has")
    assert [complaint for complaint in facts.release_problems(ROOT)
            if not any(word in complaint for word in brought)] == []  # fmt: skip
