"""The packages: a wheel that builds its own firmware, and sources that can run their tests."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import zipfile
from functools import partial
from importlib.metadata import version
from pathlib import Path
from threading import Thread

import pytest

from tests.support.casefile import ROOT
from tests.support.command import rest_of
from tests.support.needs import need
from tests.support.platformio import prepare
from tests.support.waiting import HANG_LIMIT_S
from tiniscript.base.languages import cache_files
from tools.release import facts

SKIPPED_NAMES = (".git", ".venv", "build", "dist", "ready", "*.egg-info", "__pycache__", "*.pyc",
                 ".pio", "page", "node_modules", "made", "machine.json", "link.json",
                 ".*_cache", ".coverage", "own.h", "*.bin", "*.texts", "way.png")  # fmt: skip
SETUPTOOLS_FILES = {"PKG-INFO", "setup.cfg"}  # files added by setuptools
SOURCES = "tiniscript/flash/vm_arduino/"
BUILT_PAGE = "tiniscript/studio/page/index.html"  # built by tools.builds.studio before the wheel
CASES = "tiniscript/conformance/machine.json"  # built by tools.builds.conformance
URL = "https://example.org/tiniscript"
EPOCH = "1700000000"
BUILD_CODE = "import sys; from setuptools import build_meta; print(build_meta.{0}(sys.argv[1]))"

# Files that a collection reads, without a test for each row.
IMPORT_ALL_CODE = """
import importlib, pathlib, pytest
for path in sorted(pathlib.Path("tests").rglob("*.py")):
    try:
        importlib.import_module(".".join(path.with_suffix("").parts))
    except pytest.skip.Exception:
        pass
"""


def files_of(folder: Path) -> set[str]:
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture(scope="module")
def repo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository in which somebody has worked for a while."""
    if int(version("setuptools").partition(".")[0]) < 77:
        need("setuptools is older than 77")
    folder = tmp_path_factory.mktemp("package") / "repo"
    shutil.copytree(ROOT, folder, ignore=shutil.ignore_patterns(*SKIPPED_NAMES))
    pyproject = folder / "pyproject.toml"
    pyproject.write_text(facts.with_address(pyproject.read_text("utf-8"), URL), encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def repo_files(repo: Path) -> set[str]:
    """The files in the repository before any build."""
    return files_of(repo)


def build_package(repo: Path, package_kind: str, target: Path) -> Path:
    completed = subprocess.run(
        [sys.executable, "-c", BUILD_CODE.format(package_kind), str(target)],
        cwd=repo, capture_output=True, text=True, check=False,
        env={**os.environ, "SOURCE_DATE_EPOCH": EPOCH},
    )  # fmt: skip
    assert completed.returncode == 0, completed.stderr[-3000:]
    assert "deprecated" not in (completed.stdout + completed.stderr).lower()
    return target / completed.stdout.split()[-1]


@pytest.fixture(scope="module")
def wheel(repo: Path, repo_files: set[str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An unpacked wheel, as pip installs it."""
    stale = repo / "build" / "lib"
    for name in (
        "tiniscript/stale.py",
        "tiniscript/flash/ready/stale.hex",
        f"{SOURCES}src/stale.h",
    ):
        (stale / name).parent.mkdir(parents=True, exist_ok=True)
        (stale / name).touch()
    own_header = repo / "vm_arduino" / "src" / "boards" / "kits" / "own.h"
    own_header.write_text("#error")
    page = repo / "compiler" / BUILT_PAGE
    page.parent.mkdir()
    page.touch()
    cases = repo / "compiler" / CASES
    cases.touch()
    folder = tmp_path_factory.mktemp("wheel")
    with zipfile.ZipFile(build_package(repo, "build_wheel", folder)) as zip_file:
        zip_file.extractall(folder / "unpacked")
    own_header.unlink()
    cases.unlink()
    shutil.rmtree(page.parent)
    return folder / "unpacked"


@pytest.fixture(scope="module")
def source_folder(
    repo: Path, repo_files: set[str], tmp_path_factory: pytest.TempPathFactory
) -> Path:
    """A source package, unpacked."""
    folder = tmp_path_factory.mktemp("sdist")
    shutil.unpack_archive(build_package(repo, "build_sdist", folder), folder / "unpacked")
    path: Path
    (path,) = (folder / "unpacked").iterdir()
    return path


def python(*words: str, folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, **variables}
    return subprocess.run(
        [sys.executable, *words],
        cwd=folder, env=environment, capture_output=True, text=True, check=False,
    )  # fmt: skip


# -- the wheel


def test_a_wheel_contains_the_repositorys_files_and_nothing_stale(
    wheel: Path, repo_files: set[str]
) -> None:
    packed_names = {name for name in files_of(wheel) if name.startswith("tiniscript/")}
    package = {
        name.removeprefix("compiler/") for name in repo_files if name.startswith("compiler/")
    }
    package = {
        name for name in package
        if not name.startswith("tiniscript/languages/")
        or (name.endswith(".txt") and not name.endswith("/seen.txt"))
    }  # fmt: skip
    package |= {f"tiniscript/languages/{name}" for name in cache_files()}
    sources = {
        SOURCES + name.removeprefix("vm_arduino/")
        for name in repo_files
        if name.startswith("vm_arduino/src/")
        or name in ("vm_arduino/platformio.ini", "vm_arduino/partitions.csv")
    }
    assert packed_names == package | sources | {BUILT_PAGE, CASES}
    assert len(sources) > 50


def test_a_wheel_states_its_licence_and_its_description_has_absolute_links(
    wheel: Path, repo: Path
) -> None:
    (metadata_folder,) = wheel.glob("*.dist-info")
    assert (metadata_folder / "licenses" / "LICENSE").read_text() == (ROOT / "LICENSE").read_text()
    text = (metadata_folder / "METADATA").read_text(encoding="utf-8")
    head, _, shown_text = text.partition("\n\n")
    for row in (
        "License-Expression: MIT",
        f"Project-URL: Source, {URL}",
        f"Author: {facts.AUTHORS}",
        "Description-Content-Type: text/markdown",
    ):
        assert f"\n{row}\n" in f"{head}\n"
    links = re.findall(r"(!?)\[[^]]*\]\(([^)]+)\)", shown_text)
    assert len(links) > 30
    own_count = 0
    for is_picture, link in links:
        assert link.startswith(("https://", "#")), link
        if link.startswith(URL):
            kind, tag, path = link.removeprefix(f"{URL}/").split("#")[0].split("/", 2)
            assert kind == ("raw" if is_picture else "blob")
            assert tag == f"v{facts.version(ROOT)}"
            assert (repo / path).exists(), path
            own_count += 1
    assert own_count > 30


@pytest.mark.sampled(of="builds of PlatformIO")
def test_a_wheel_builds_its_own_firmware(wheel: Path, tmp_path: Path) -> None:
    variables, reason = prepare()
    need(reason)
    words = ("-m", "tiniscript", "firmware", "--build", "--yes", "--robot", "liner")
    completed = python(*words, folder=tmp_path, PYTHONPATH=str(wheel), **variables)
    assert completed.returncode == 0, completed.stderr
    assert completed.stdout.startswith("liner on nano: ready, ")


PAGE_MISSING = "tools.builds.studio"
FIRMWARE_MISSING = "tools.builds.firmware_files"
CASES_MISSING = "tools.builds.conformance"


PAGE_BUILD_SCRIPT = """#!/bin/sh
[ "$*" = "-m tiniscript.cli.page_build" ] || exit 1
mkdir compiler/tiniscript/studio/page
touch compiler/tiniscript/studio/page/index.html
"""


@pytest.mark.sampled(of="source packages")
@pytest.mark.parametrize("page", ["none", "built", "asked for"])
def test_a_wheel_reports_missing_parts(source_folder: Path, tmp_path: Path, page: str) -> None:
    """Only a person at a terminal is asked to build the page, as with `python -m build --wheel`;
    pip, which has no terminal, needs no npm."""
    folder = tmp_path / "sources"
    shutil.copytree(source_folder, folder)
    if page == "built":
        path = folder / "compiler" / BUILT_PAGE
        path.parent.mkdir()
        path.touch()
    stand_in = folder / ".venv" / "bin" / "python"
    stand_in.parent.mkdir(parents=True)
    stand_in.write_text(PAGE_BUILD_SCRIPT)
    stand_in.chmod(0o755)
    own_end, other_end = os.openpty()
    packages: list[bytes] = []
    reader = Thread(
        target=lambda: packages.extend(iter(lambda: rest_of(own_end), b"")), daemon=True
    )
    reader.start()
    command = [sys.executable, "-c", BUILD_CODE.format("build_wheel"), str(tmp_path)]
    stdin, stderr = (
        (other_end, other_end) if page == "asked for" else (subprocess.DEVNULL, subprocess.PIPE)
    )
    completed = subprocess.run(
        command, cwd=folder, stdin=stdin, stdout=subprocess.PIPE, stderr=stderr, text=True
    )
    os.close(other_end)
    reader.join(HANG_LIMIT_S)
    os.close(own_end)
    output = completed.stderr or b"".join(packages).decode()
    assert completed.returncode == 0, output
    assert "made without" in output and FIRMWARE_MISSING in output and CASES_MISSING in output
    assert (PAGE_MISSING in output) == (page == "none")
    with zipfile.ZipFile(tmp_path / completed.stdout.split()[-1]) as zip_file:
        assert (BUILT_PAGE in zip_file.namelist()) == (page != "none")
        zip_file.extractall(tmp_path / "made")
    version = python("-m", "tiniscript", "--version", "--lang", "en", folder=tmp_path,
                     PYTHONPATH=str(tmp_path / "made"))  # fmt: skip
    assert "without prebuilt firmware" in version.stdout
    assert ("without the tsc studio page" in version.stdout) == (page == "none")


@pytest.mark.sampled(of="source packages")
def test_an_installation_without_cases_names_the_command_that_makes_them(
    source_folder: Path, tmp_path: Path
) -> None:
    """Run in the sources it names, the command makes them for that installation."""
    sources = tmp_path / "sources"  # a separate copy, because running it leaves bytecode
    shutil.copytree(source_folder, sources)
    package = tmp_path / "an installation" / "tiniscript"
    shutil.copytree(sources / "compiler" / "tiniscript", package)
    words = ("-m", "tiniscript", "doctor", "--conform", "--lang", "en", "--only",
             "images: no code", "--json", "--machine",
             f"{sys.executable} -m tests.conform.spec_machine")  # fmt: skip
    tsc = partial(python, *words, folder=sources, PYTHONPATH=str(package.parent))
    lacks = tsc()
    assert lacks.returncode == 2 and not lacks.stdout
    _, _, command = lacks.stderr.strip().rpartition(":  ")
    assert CASES_MISSING in command and str(package) in command
    result = subprocess.run(shlex.split(command), cwd=sources, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    assert not (sources / "compiler" / CASES).exists()
    completed = tsc(PYTHONPATH=os.pathsep.join((str(package.parent), str(sources))))
    assert completed.returncode == 0, completed.stderr
    assert json.loads(completed.stdout)["agree"] == 1


# -- the source package


def test_a_source_package_has_the_whole_repository(
    source_folder: Path, repo_files: set[str]
) -> None:
    packed_names = {name for name in files_of(source_folder) if ".egg-info/" not in name}
    assert packed_names - SETUPTOOLS_FILES == repo_files - SETUPTOOLS_FILES


@pytest.mark.sampled(of="source packages")
def test_a_source_package_is_the_same_from_any_folder(
    repo: Path, source_folder: Path, tmp_path: Path
) -> None:
    """Twice in a row, of files with other times, in a folder with another name."""
    first_archive = next(source_folder.parent.parent.glob("*.tar.gz"))
    other_folder = tmp_path / "another place"
    shutil.copytree(repo, other_folder, copy_function=shutil.copy,
                    ignore=shutil.ignore_patterns("*.egg-info", "build"))  # fmt: skip
    second_archive = build_package(other_folder, "build_sdist", tmp_path / "made")
    assert first_archive.read_bytes() == second_archive.read_bytes()


def test_a_registry_accepts_both_packages(wheel: Path, source_folder: Path) -> None:
    files = [*wheel.parent.glob("*.whl"), *source_folder.parent.parent.glob("*.tar.gz")]
    assert len(files) == 2
    completed = python("-m", "twine", "check", "--strict", *map(str, files), folder=wheel)
    assert completed.returncode == 0, completed.stdout + completed.stderr
    assert completed.stdout.count("PASSED") == 2


@pytest.mark.sampled(of="source packages")
def test_the_tests_of_a_source_package_run(source_folder: Path) -> None:
    pytest_here = ("-m", "pytest", "-p", "no:cacheprovider")
    completed = python(
        "-c", IMPORT_ALL_CODE, folder=source_folder, PYTHONPATH=f"compiler{os.pathsep}."
    )
    assert completed.returncode == 0, completed.stderr[-3000:]
    test_files = ("tests/bytecode/test_image.py", "tests/robots/test_robots.py")
    without_plugins = {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    completed = python(
        *pytest_here, "-m", "not root", *test_files, folder=source_folder, **without_plugins
    )
    assert completed.returncode == 0, completed.stdout[-3000:]
