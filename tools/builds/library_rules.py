"""The rules of the Arduino Library Manager and of PlatformIO's registry, written down.

They are those that arduino-lint calls errors in `--compliance strict --library-manager submit`, and
what `pio pkg pack` demands. Knows a library as a folder; names each rule that it breaks.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

CATEGORIES = (
    "Display", "Communication", "Signal Input/Output", "Sensors", "Device Control", "Timing",
    "Data Storage", "Data Processing", "Other",
)  # fmt: skip
NEEDED = ("name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url",
          "architectures")  # fmt: skip
KNOWN = (*NEEDED, "includes", "depends", "license", "dot_a_linkage", "precompiled", "ldflags")
ARCHITECTURES = ("avr", "esp32", "esp8266", "megaavr", "sam", "samd", "rp2040", "*")
KEYWORD_TYPES = ("KEYWORD1", "KEYWORD2", "KEYWORD3", "LITERAL1", "LITERAL2")
FOREIGN = (".exe", ".bat", ".dll", ".so", ".a", ".o", ".elf", ".hex", ".bin")
SEMVER = re.compile(r"(0|[1-9]\d*)\.(0|[1-9]\d*)\.(0|[1-9]\d*)(-[0-9A-Za-z.-]+)?")
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9 _.-]{0,62}")
FOLDERS = {"src", "examples", "extras", "utility"}


def complaints(folder: Path) -> list[str]:
    """Return what breaks a rule, a line each."""
    fields = properties(folder)
    return [
        *about_properties(fields, folder),
        *about_manifest(fields, folder),
        *about_files(fields.get("name", ""), folder),
        *about_examples(folder),
        *about_keywords(folder),
    ]


def properties(folder: Path) -> dict[str, str]:
    path = folder / "library.properties"
    rows = path.read_text(encoding="utf-8").splitlines() if path.is_file() else []
    pairs = (row.partition("=") for row in rows if row.strip() and not row.startswith("#"))
    return {name: value for name, _, value in pairs}


def about_properties(fields: dict[str, str], folder: Path) -> Iterator[str]:
    for name in NEEDED:
        if not fields.get(name, "").strip():
            yield f"library.properties: {name} is missing"
    for name in fields.keys() - set(KNOWN):
        yield f"library.properties: nobody knows {name}"
    name = fields.get("name", "")
    if not NAME.fullmatch(name) or name.lower().startswith("arduino") or "  " in name:
        yield f"library.properties: {name!r} is no name for a library"
    if not SEMVER.fullmatch(fields.get("version", "")):
        yield "library.properties: the version is not MAJOR.MINOR.PATCH"
    if fields.get("category") not in CATEGORIES:
        yield "library.properties: the category is none of the list"
    if not re.fullmatch(r"https?://[^\s/]+\.[^\s]+", fields.get("url", "")):
        yield "library.properties: the url is none"
    sentence = fields.get("sentence", "")
    if sentence and fields.get("paragraph", "").startswith(sentence):
        yield "library.properties: the paragraph says the sentence again"
    for each in fields.get("architectures", "").split(","):
        if each.strip() not in ARCHITECTURES:
            yield f"library.properties: nobody knows the architecture {each!r}"
    for each in filter(None, fields.get("includes", "").split(",")):
        if not (folder / "src" / each.strip()).is_file():
            yield f"library.properties: there is no {each} to include"


def about_manifest(fields: dict[str, str], folder: Path) -> Iterator[str]:
    try:
        found = json.loads((folder / "library.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        yield "library.json: it cannot be read"
        return
    for name in ("name", "version", "license"):
        if found.get(name) != fields.get(name):
            yield f"library.json: {name} is another one than in library.properties"
    for name in ("description", "keywords", "repository", "authors", "frameworks", "platforms"):
        if not found.get(name):
            yield f"library.json: {name} is missing"
    if len(found.get("description", "")) > 1000:
        yield "library.json: the description has more than 1000 letters"
    for header in found.get("headers", ()):
        if not (folder / "src" / header).is_file():
            yield f"library.json: there is no header {header}"


def about_files(name: str, folder: Path) -> Iterator[str]:
    if not (folder / "src" / f"{name}.h").is_file():
        yield f"src: the header {name}.h is missing"
    for needed in ("LICENSE", "README.md", "keywords.txt"):
        if not (folder / needed).is_file():
            yield f"{needed} is missing"
    for path in folder.iterdir():
        if path.is_dir() and path.name not in FOLDERS:
            yield f"{path.name}: a library has no such folder"
    for path in sorted(folder.rglob("*")):
        where = path.relative_to(folder).as_posix()
        if path.is_symlink():
            yield f"{where}: a link"
        if path.suffix.lower() in FOREIGN or path.name == ".development":
            yield f"{where}: no file of a library"
        if path.suffix.lower() in (".ino", ".pde") and "examples" not in where.split("/"):
            yield f"{where}: a sketch outside of examples"
        if not re.fullmatch(r"[A-Za-z0-9_.-]+", path.name):
            yield f"{where}: a name with other signs"


def about_examples(folder: Path) -> Iterator[str]:
    found = sorted((folder / "examples").glob("*"))
    if not found:
        yield "examples: there is none"
    for path in found:
        if not (path / f"{path.name}.ino").is_file():
            yield f"examples: {path.name} has no sketch of its name"


def about_keywords(folder: Path) -> Iterator[str]:
    path = folder / "keywords.txt"
    rows = path.read_text(encoding="utf-8").splitlines() if path.is_file() else []
    for number, row in enumerate(rows, 1):
        if not row.strip() or row.startswith("#"):
            continue
        words = row.split("\t")
        if len(words) < 2 or words[1] not in KEYWORD_TYPES or words[0] != words[0].strip():
            yield f"keywords.txt: line {number} is no word, a tab and its kind"
