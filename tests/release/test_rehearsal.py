"""The command: what it makes in which order, what it cannot begin with, what its table says."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from tools.release import __main__ as release
from tools.release.packing import pack
from tools.release.parts import PARTS, Clone, chosen
from tools.release.trying import (
    TRIES,
    Made,
    NotTried,
    TryFailed,
    try_firmware,
    try_page,
    try_site,
    try_stick,
)

END = ":00000001FF\n"


def test_parts_bring_those_that_they_need_in_their_order() -> None:
    assert chosen([]) == list(PARTS)
    assert chosen(["stick"]) == ["wheel", "stick"]
    assert chosen(["page", "library"]) == ["studio", "page", "library"]
    assert set(PARTS) - set(TRIES) == {"studio"}, "a part that nobody tries"


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


# -- the tries see what is wrong ------------------------------------------------------------------


def made(tmp_path: Path, name: str, files: dict[str, str]) -> Made:
    folder = tmp_path / "folder"
    for each, text in files.items():
        (folder / each).parent.mkdir(parents=True, exist_ok=True)
        (folder / each).write_text(text, encoding="utf-8")
    parts = tmp_path / "parts"
    parts.mkdir()
    pack(folder, parts / f"{name}-1.zip", 0)
    return Made(parts, tmp_path / "scratch", "1", {}, frozenset(("tini-uno-", "tini_es-uno-")))


FIRMWARE = {"NOTICE.txt": "", "LGPL-2.1.txt": "", "tini-uno-1.hex": END, "tini_es-uno-2.hex": END}


def test_firmware_is_whole_in_both_languages_with_its_notices(tmp_path: Path) -> None:
    good = made(tmp_path, "tiniscript-firmware", FIRMWARE)
    assert try_firmware(good) == "2 files, whole, with their notices"


@pytest.mark.parametrize("wrong", [
    {"tini-uno-1.hex": ":00"}, {"NOTICE.txt": None}, {"tini_es-uno-2.hex": None},
    {"tini-uno-1.hex": None, "tini_es-uno-2.hex": None},
])  # fmt: skip
def test_firmware_that_lacks_something_is_told(tmp_path: Path, wrong: dict[str, str]) -> None:
    files = {name: text for name, text in {**FIRMWARE, **wrong}.items() if text is not None}
    with pytest.raises(TryFailed):
        try_firmware(made(tmp_path, "tiniscript-firmware", files))


def test_a_dead_link_of_the_site_is_told(tmp_path: Path) -> None:
    files = {"index.html": '<a href="nowhere.html">x</a>'}
    with pytest.raises(TryFailed, match=r"nowhere\.html: no such file"):
        try_site(made(tmp_path, "tiniscript-site", files))


def test_a_page_that_lacks_a_file_is_told(tmp_path: Path) -> None:
    files = {"service_worker.js": 'const FILES = ["./", "main.js"];\n', "licences.txt": ""}
    with pytest.raises(TryFailed, match=r"lacks main\.js"):
        try_page(made(tmp_path, "tiniscript-studio", files))


def test_a_computer_that_cannot_cut_the_network_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stick = made(tmp_path, "tiniscript-stick", {"start.sh": "true"})
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(NotTried, match="unshare"):
        try_stick(stick)


def test_a_try_that_breaks_or_cannot_be_made_is_no_release(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def breaks(made: Made) -> str:
        return str(json.loads("a note"))

    def cannot(made: Made) -> str:
        raise NotTried("there is no tool")

    monkeypatch.setattr(release, "TRIES", {"wheel": breaks, "stick": cannot})
    file = tmp_path / "a.zip"
    file.write_bytes(b"PK")
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    clone = Clone(tmp_path, tmp_path, "1", "", 0, 1, False)
    rows, failed = release._looked_at([{"wheel": [file], "stick": [file]}], [clone], scratch)
    assert [row.tried for row in rows] == ["FAILED", "not tried"]
    assert len(failed) == 2 and "there is no tool" in failed[1]


def test_the_line_that_the_tries_wait_for_is_the_commands() -> None:
    """They run it in other environments: here the same is said by this one."""
    from tests.support.command import process
    from tools.release.trying import DROVE, LINE

    done = process("upload", "-e", LINE, "--virtual", "--for", "4", "--hurry", "20")
    assert done.code == 0, done.err
    assert DROVE.search(done.out + done.err)
