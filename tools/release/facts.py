"""Facts that a release states in more than one place: version, date, address, people.

Knows a clone as files, and git's answers about it. The version's home is
`tiniscript/base/version.py`, the address's is `[project.urls]` of `pyproject.toml`.
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

AUTHORS = "The TiniScript developers"
_DATED_SECTION = re.compile(r"^## (\d+\.\d+\.\d+) \((\d{4}-\d{2}-\d{2})\)$", re.MULTILINE)
# Each place that repeats the version, and how.
_VERSION_PATTERNS = {
    "CITATION.cff": r"(?m)^version: (\S+)$",
    "docs/en/versions.md": r"\| TiniScript, the package \| `([^`]+)` \|",
}
NO_CONTACT = "(whoever publishes this repository writes an address here)"
# Each place that repeats the authors.
_AUTHOR_PATTERNS = {
    "LICENSE": r"Copyright \(c\) \d{4} (.+)",
    "CITATION.cff": r'  - name: "(.+)"',
    "pyproject.toml": r'authors = \[\{ name = "([^"]+)" \}\]',
}


def version(root: Path) -> str:
    """Return the version of a clone, `0.2.0`."""
    version_file = root / "compiler" / "tiniscript" / "base" / "version.py"
    return _first_match(version_file, r'(?m)^__version__ = "(.+)"$')


def address(root: Path) -> str:
    """Return the address of the published clone, `https://…`, or "" if it has none."""
    return _first_match(root / "pyproject.toml", r'(?m)^Source = "(https://[^"]+)"$').rstrip("/")


def with_address(text: str, url: str) -> str:
    """Return `pyproject.toml` with another address."""
    text_without_address = re.sub(r"(?m)^\[project\.urls\]\n(?:\w+ = .*\n)*\n?", "", text)
    return f'{text_without_address.rstrip()}\n\n[project.urls]\nSource = "{url}"\n'


def epoch(root: Path) -> int:
    """Return the time of a clone's commit, in seconds since 1970: all that is made has it."""
    return int(_git(root, "log", "-1", "--format=%ct"))


def tags(root: Path) -> list[str]:
    """Return the tags of a clone's commit."""
    return _git(root, "tag", "--points-at", "HEAD").splitlines()


def release_problems(root: Path) -> Iterator[str]:
    """Yield a sentence for each thing that keeps a clone from being released."""
    changed_files = _git(root, "status", "--porcelain").splitlines()
    if changed_files:
        name = changed_files[0][3:]
        yield f"{len(changed_files)} files are not committed, {name} among them. Commit them first."
    own_version = version(root)
    yield from _check_tags(root, own_version)
    yield from _check_changelog(root, own_version)
    for name, pattern in _VERSION_PATTERNS.items():
        found_text = _first_match(root / name, pattern)
        if found_text != own_version:
            yield (
                f"{name} has version {found_text or 'none'}; "
                f"tiniscript/base/version.py has {own_version}."
            )
    for name, pattern in _AUTHOR_PATTERNS.items():
        found_text = _first_match(root / name, pattern)
        if found_text != AUTHORS:
            yield f"{name} names {found_text or 'nobody'}, not {AUTHORS}."
    if _first_match(root / "SECURITY.md", "(?m)^Contact: (.+)$") in ("", NO_CONTACT):
        yield "SECURITY.md does not say how to reach somebody: write an address after Contact."
    if not address(root):
        yield (
            "pyproject.toml does not say where it is published. Add there:  [project.urls]  and "
            'Source = "https://…". To rehearse with an address:  --url https://…'
        )


def _check_tags(root: Path, own_version: str) -> Iterator[str]:
    versions = [name for name in tags(root) if re.fullmatch(r"v\d.*", name)]
    if versions and f"v{own_version}" not in versions:
        yield (
            f"The commit has the tag {versions[0]}, and the version {own_version}: "
            "one of both is wrong."
        )
    elif not versions and _git(root, "tag", "--list", f"v{own_version}"):
        yield f"The tag v{own_version} is that of another commit: give this one a new version."


def _check_changelog(root: Path, own_version: str) -> Iterator[str]:
    text = (root / "CHANGELOG.md").read_text(encoding="utf-8")
    dated_section = _DATED_SECTION.search(text)
    if f"\n## {own_version}" not in text:
        yield f"CHANGELOG.md has no section for {own_version}."
    elif dated_section is None or dated_section.group(1) != own_version:
        yield f"CHANGELOG.md has no date for {own_version}. Write:  ## {own_version} (2026-01-31)"
    elif cited_text := _first_match(root / "CITATION.cff", r"(?m)^date-released: (\S+)$"):
        if cited_text != dated_section.group(2):
            changelog_date = dated_section.group(2)
            yield f"CITATION.cff has the date {cited_text}; CHANGELOG.md has {changelog_date}."
    _, _, text_below = text.partition("\n## Unreleased\n")
    if not text_below:
        yield "CHANGELOG.md has no section Unreleased: the next change has no place."
    elif f"\n## {own_version}" in text and text_below.partition("\n## ")[0].strip():
        yield (
            f"CHANGELOG.md has changes under Unreleased, above {own_version}: "
            "they are not released."
        )


def _first_match(path: Path, pattern: str) -> str:
    match = re.search(pattern, path.read_text(encoding="utf-8")) if path.is_file() else None
    return match.group(1) if match else ""


def _git(root: Path, *arguments: str) -> str:
    process = subprocess.run(["git", "-C", str(root), *arguments], capture_output=True, text=True)
    return process.stdout.strip("\n") if process.returncode == 0 else ""
