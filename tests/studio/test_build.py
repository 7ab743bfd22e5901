"""The build of the page: its inputs, their source, and its size."""

from __future__ import annotations

import json
import re
import shutil
import sys
import zipfile
from pathlib import Path
from random import Random

import pytest

from tests.support.casefile import ROOT
from tests.support.needs import need
from tiniscript.base.languages import SOURCE_LANGUAGE, languages, merged_catalogue, plural_text
from tiniscript.flash import ready
from tiniscript.studio import building, serving
from tiniscript.studio.block_kinds import BLOCK_TEXTS, KINDS, PLAIN_TEXTS
from tiniscript.studio.serving import POLICY
from tools import CannotMake
from tools.builds import studio
from tools.builds.page_texts import page_texts
from tools.studio import pack as packing
from tools.studio.pack import MODULES_NOT_HERE

LARGEST = 6_000_000  # bytes of all files, gzipped, with one language: no browser fetches another
GROUP_LARGEST = 35_000  # most bytes that pupils of a group download
SOURCES = ROOT / "tools" / "studio"
PACKAGE = ROOT / "compiler" / "tiniscript"
PAGE_SOURCES = {
    path: path.read_text(encoding="utf-8")
    for path in sorted((SOURCES / "src").rglob("*"))
    if path.suffix in (".js", ".html")
}
SHARED_KEYS = ("block", "blockly", "editor", "tip")  # keys of other tables, which follow below


@pytest.fixture(scope="module")
def page() -> Path:
    need(studio.unusable_reason())
    return studio.PAGE


def test_packages_are_pinned_without_a_fixed_registry() -> None:
    package_fields = json.loads((SOURCES / "package.json").read_text(encoding="utf-8"))
    for version in (
        *package_fields["dependencies"].values(),
        *package_fields["devDependencies"].values(),
    ):
        assert re.fullmatch(r"\d+\.\d+\.\d+", version)
    lock = json.loads((SOURCES / "package-lock.json").read_text(encoding="utf-8"))
    for name, package in lock["packages"].items():
        assert "resolved" not in package, name
        assert not name or package["integrity"].startswith("sha512-"), name


def test_no_unused_module_is_packed(page: Path) -> None:
    modules = []
    for archive in page.glob("*.zip"):
        with zipfile.ZipFile(archive) as zip_file:
            modules += [name.replace("/", ".") for name in zip_file.namelist()]
    assert len(modules) > 200
    assert not [
        name for name in modules if name.startswith(tuple(f"{name}." for name in MODULES_NOT_HERE))
    ]


def test_node_trusts_the_system_certificates(monkeypatch: pytest.MonkeyPatch) -> None:
    """For example those of a school's proxy; the environment may override it."""
    node_command = [sys.executable, "-c", "import os; print(os.environ['NODE_USE_SYSTEM_CA'])"]
    monkeypatch.delenv("NODE_USE_SYSTEM_CA", raising=False)
    assert studio.run(node_command) == "1\n"
    monkeypatch.setenv("NODE_USE_SYSTEM_CA", "0")
    assert studio.run(node_command) == "0\n"


@pytest.mark.parametrize("language", languages()[1:])
def test_a_text_has_the_gaps_of_the_english_one(language: str) -> None:
    """`%1` and so on, which Blockly and the page fill; gaps are checked of all catalogues."""
    for entry in merged_catalogue("studio", language).entries.values():
        places = sorted(re.findall(r"%[\d%]", entry.english))
        assert all(
            sorted(re.findall(r"%[\d%]", text)) == places for text in entry.translation.values()
        )


def test_every_text_is_used() -> None:
    """The code has its name, or a name in two parts: `why_${reason}` and the reason's name."""
    sources = "".join(PAGE_SOURCES.values())
    names = set(re.findall(r"['\"]([\w/]+)['\"]", sources))
    heads = tuple(re.findall(r"`(\w+[_/])\$\{", sources))
    package = (path.read_text(encoding="utf-8") for path in (PACKAGE.rglob("*.py")))
    built_text = (ROOT / "tools/builds/studio.py").read_text(
        encoding="utf-8"
    )  # the frame of the page
    words = set(re.findall(r"\w+", "".join((*package, sources, built_text))))
    keys = set(page_texts(SOURCE_LANGUAGE)) - {""}
    assert len(keys) > 600
    for key in keys:
        if key.partition("/")[0] not in SHARED_KEYS:
            rest = [key[len(head) :] for head in heads if key.startswith(head)]
            base_key = key.removesuffix("_sure")  # a button that is pressed twice
            assert base_key in names or words & {base_key, *rest}, key


def test_every_block_has_a_text_and_every_block_text_a_block() -> None:
    keys = set(page_texts(SOURCE_LANGUAGE))
    words = [*KINDS, *(word for kind in KINDS.values() for word in kind.words)]
    words += [unit for kind in KINDS.values() for unit in kind.units.values()]
    words += ["seconds", "SI", "SB", "PING", "elseif", "else"]
    blocks = {f"block/{word}" for word in words if not BLOCK_TEXTS.get(word)}
    blocks_with_text = {key for key in keys if key.startswith("block/")}
    assert blocks_with_text - {f"block/{word}" for word in PLAIN_TEXTS} == blocks
    tips = {key.partition("/")[2] for key in keys if key.startswith("tip/")}
    buttons = {"more", "less", "more_values", "less_values"}
    assert tips <= {*KINDS, "program", *buttons} and len(tips) > 25


def test_a_plural_has_the_form_of_its_number() -> None:
    """A rule repeats itself after a hundred: the page has a digit for each number before that."""
    for language in languages():
        texts = page_texts(language)
        forms = texts[""]
        for number in (*range(200), 1000, 1001, 2101, 1_000_000):
            form = forms[number if number < 100 else 100 + number % 100]
            expected_text = plural_text("studio", "mistakes", number, language)
            assert texts["mistakes"][int(form)] == expected_text, (language, number)


def test_no_text_is_inserted_as_markup() -> None:
    for path in (SOURCES / "src").rglob("*.js"):
        source = path.read_text(encoding="utf-8")
        for word in ("innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval(",
                     "new Function"):  # fmt: skip
            assert word not in source, f"{path.name}: {word}"


def test_the_page_is_small_enough(page: Path) -> None:
    files = [
        path
        for path in page.iterdir()
        if path.name not in (studio.STAMP, studio.LICENCES_FILE, serving.FIRMWARE_FILE)
    ]
    weights = weights_of(page)
    assert {*weights} == {path.name for path in files}
    language_sizes = [
        sum(weights[name] for name in studio.language_files(code)) for code in languages()
    ]
    assert sum(weights.values()) - sum(language_sizes) + max(language_sizes) <= LARGEST


def weights_of(page: Path) -> dict[str, int]:
    """Return the bytes of each file, packed as a server sends it."""
    rows = [row.split() for row in studio.size_rows(page)[1:-1]]
    return {name: int(packed.replace(",", "")) for _, packed, name in rows}


def test_the_files_of_a_group_are_small_enough(page: Path) -> None:
    """This counts all that a pupil's page fetches for a class; the wall is the teacher's."""
    weights = weights_of(page)
    names = {name for name in weights if name.startswith(("together.", "classroom-", "class."))}
    assert len(names) == 3
    [classroom] = (name for name in names if name.endswith(".js"))
    names |= imported_files(page, classroom) - imported_files(page, "main.js")
    assert not any(name.startswith("teacher-") for name in names)
    assert sum(weights[name] for name in names) <= GROUP_LARGEST


def imported_files(page: Path, name: str) -> set[str]:
    """Return the scripts that a browser fetches with this one."""
    names, new_names = set[str](), {name}
    while new_names:
        names |= new_names
        texts = [(page / new_name).read_text(encoding="utf-8") for new_name in new_names]
        imports = re.findall(r'(?:\bfrom|\bimport)\s*"\./([\w.-]+[.]js)"', "".join(texts))
        new_names = set(imports) - names
    return names


def test_the_page_has_its_policy_and_no_inline_code(page: Path) -> None:
    html = (page / "index.html").read_text(encoding="utf-8")
    assert POLICY in html
    assert not re.search(r"<script(?![^>]*\bsrc=)|\son\w+=|\sstyle=|<style|https?://", html)


def test_the_page_contains_the_licences_of_its_parts(page: Path) -> None:
    licences = (page / studio.LICENCES_FILE).read_text(encoding="utf-8")
    for name in (
        "@codemirror/view 6.",
        "@lezer/common 1.",
        "style-mod 4.",
        "pyodide 314.",
        "cobs 1.",
    ):
        assert f"\n{name}" in licences
    assert "Mozilla Public License 2.0" in licences and "Permission is hereby granted" in licences
    assert "typescript" not in licences and str(ROOT) not in licences


def test_no_address_of_the_building_computer_is_in_it(page: Path) -> None:
    for path in page.iterdir():
        assert str(ROOT).encode() not in path.read_bytes(), path.name


@pytest.mark.long
@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", ["Python", "modules"])
def test_the_same_sources_give_the_same_page(
    page: Path, tmp_path: Path, part: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One page is built again, the other one is the existing page."""

    def pack(call: list[str], *words: str) -> str:
        return (
            copy_built("*.zip", Path(words[-1]))
            if words[0] == "pack.mjs"
            else run_before(call, *words)
        )

    def copy_built(pattern: str, target: Path) -> str:
        for path in set(page.glob(pattern)) - {page / "service_worker.js"}:
            shutil.copy(path, target)
        return ""

    run_before = studio.run
    if part == "modules":
        monkeypatch.setattr(studio, "run", pack)
    else:
        monkeypatch.setattr(studio, "bundle", lambda tools, target: copy_built("*.js", target))
    change_sources_in(monkeypatch, "check_types")  # which was done when that one was built
    second_page = tmp_path / "page"
    studio.build(second_page)
    assert {path.name for path in second_page.iterdir()} == {path.name for path in page.iterdir()}
    for path in second_page.iterdir():
        assert path.read_bytes() == (page / path.name).read_bytes(), path.name


def page_sources(scratch: Path) -> set[Path]:
    """Return the files of which the page is made, or which make it: modules in Python, their data,
    and what esbuild reads. Texts of lessons are made of catalogues, which are among the data."""
    with zipfile.ZipFile(scratch / "library.zip", "w") as library:  # none of Python's own modules
        builder = packing.Packer([ROOT], library)
        builder.add(building.MODULE)
    paths = {ROOT / name for name in builder.own_files} - {ROOT / "tools" / "__init__.py"}
    for patterns in (packing.DATA_PATTERNS, packing.LESSON_DATA_PATTERNS):
        paths |= {PACKAGE.parent / name for name in packing.data_of(str(PACKAGE.parent), patterns)}
    paths |= {*PACKAGE.rglob("*.py"), *PACKAGE.rglob("languages/*/*.toml")}
    paths |= {path for path in (SOURCES / "src").rglob("*") if path.is_file()}
    return {path for path in paths if path.suffix != ".texts"}


def test_a_page_is_out_of_date_after_any_change_of_a_source(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sources = page_sources(tmp_path)
    assert len(sources) > 600 and sources <= {*building._sources()}
    digests, read_bytes, rng = {building.digest()}, Path.read_bytes, Random(1)
    for changed_path in rng.sample(sorted(sources), 3):

        def read_changed(path: Path, changed_path: Path = changed_path) -> bytes:
            data = bytearray(read_bytes(path))
            if path == changed_path:
                data[rng.randrange(len(data))] ^= 1
            return bytes(data)

        monkeypatch.setattr(Path, "read_bytes", read_changed)
        digests.add(building.digest())
    assert len(digests) == 4


def change_sources_in(monkeypatch: pytest.MonkeyPatch, step: str) -> None:
    """Have somebody save a source while a build is at this step."""
    monkeypatch.setattr(
        studio, step, lambda *_: monkeypatch.setattr(building, "digest", lambda: "newer sources")
    )


@pytest.mark.parametrize(
    "step", ["check_types", "bundle", "write_own_files", "write_service_worker"]
)
def test_a_page_whose_sources_change_while_it_is_built_is_not_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: str
) -> None:
    (tmp_path / studio.STAMP).write_text("{}")
    for name in ("check_types", "bundle", "write_own_files", "write_service_worker"):
        monkeypatch.setattr(studio, name, lambda *_: None)
    studio.rebuild(tmp_path)
    assert not studio.unusable_reason(tmp_path)
    change_sources_in(monkeypatch, step)
    studio.rebuild(tmp_path)
    assert "is out of date: the sources" in studio.unusable_reason(tmp_path)


def test_a_page_of_other_sources_is_not_used(tmp_path: Path) -> None:
    assert studio.COMMAND in studio.unusable_reason(tmp_path)
    (tmp_path / studio.STAMP).write_text('{"sources": "others"}')
    assert "is out of date: the sources" in studio.unusable_reason(tmp_path)
    assert studio.main(["--check", "-o", str(tmp_path)]) == 2


def test_firmware_is_beside_the_page_and_not_counted_in_its_size(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`tsc studio` and a static host give the same files, by the same list."""
    brought_ready_file = ready.ReadyFile(
        "tinibot", "uno", "digest", tmp_path / "tinibot-uno-digest.hex"
    )
    brought_ready_file.path.write_text(":0100000001FE\n:00000001FF\n")
    (tmp_path / "page").mkdir()
    monkeypatch.setattr(ready, "files", list)
    with pytest.raises(CannotMake, match="firmware_files"):
        studio.bring_firmware(tmp_path / "page")
    monkeypatch.setattr(ready, "files", lambda: [brought_ready_file])
    studio.bring_firmware(tmp_path / "page")
    served_files = serving.with_firmware({})
    assert {path.name for path in (tmp_path / "page").iterdir()} == set(served_files)
    for name, file in served_files.items():
        assert (tmp_path / "page" / name).read_bytes() == file.data
    [row] = json.loads(served_files[serving.FIRMWARE_FILE].data)
    assert row == {"title": "tinibot", "board": "uno", "file": brought_ready_file.path.name}
    assert served_files[row["file"]].data == brought_ready_file.path.read_bytes()
    assert len(studio.size_rows(tmp_path / "page")) == 2  # the head, and the sum


def test_only_an_existing_page_is_rebuilt(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert studio.main(["--again", "-o", str(tmp_path / "page")]) == 2
    assert "the page is not built" in capsys.readouterr().err
    assert not (tmp_path / "page").exists()
