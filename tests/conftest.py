"""Options and places that all tests share."""

from __future__ import annotations

import gc
import itertools
import os
import signal
import tempfile
from collections.abc import Callable, Iterator
from functools import lru_cache
from pathlib import Path

import pytest

from tests.machines.host import USER
from tests.machines.uno import skip_unless_available
from tests.support import order, sampling
from tests.support.command import PROGRAM, Command, Tsc
from tests.support.platformio import firmware, shared_folder
from tests.support.pty_robot import PtyRobot
from tiniscript import robots
from tiniscript.together.journal import Journal

# Hypothesis stores its findings outside of the repository.
os.environ.setdefault(
    "HYPOTHESIS_STORAGE_DIRECTORY", str(Path(tempfile.gettempdir()) / "tiniscript-hypothesis")
)
# PlatformIO reuses its objects for the same source, options and compiler.
os.environ.setdefault(
    "PLATFORMIO_BUILD_CACHE_DIR", str(Path(tempfile.gettempdir()) / f"tiniscript-platformio-{USER}")
)
UNSEEN = itertools.count()  # folders without tests of their own


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--accept", action="store_true", help="write what the machine did into the case files"
    )
    sampling.add_options(parser)


def pytest_configure(config: pytest.Config) -> None:
    """In CI, deprecations of pytest and in our own code are failures.

    Collected tests stay in memory: searching them for garbage would take two of five seconds.
    """
    gc.disable()
    if os.environ.get("CI"):
        for warned in (
            "pytest.PytestDeprecationWarning",
            "pytest.PytestCollectionWarning",
            "pytest.PytestUnknownMarkWarning",
            r"DeprecationWarning:(tiniscript|tests|tools)\b",
        ):
            config.addinivalue_line("filterwarnings", f"error::{warned}")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    sampling.leave_out(config, items)
    order.spread(items)


def pytest_collection_finish() -> None:
    gc.freeze()  # nor is it looked through during the tests
    gc.enable()


def pytest_terminal_summary(
    terminalreporter: pytest.TerminalReporter, config: pytest.Config
) -> None:
    if sample := sampling.how_to_repeat(config):
        terminalreporter.write_line(sample)


def pytest_sessionstart() -> None:
    """Restore the usual effect of Ctrl-C.

    A shell that starts the tests in the background has it ignored, and so would every command
    that a test starts and stops.
    """
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_runtest_setup(item: pytest.Item) -> None:
    is_root = hasattr(os, "geteuid") and os.geteuid() == 0
    if item.get_closest_marker("root") and not is_root:
        pytest.skip("only root can be another user, or lay a port over another one")


def pytest_sessionfinish(session: pytest.Session) -> None:
    """In CI, skipped tests are failures, because everything is installed there."""
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    # A worker has none, because one process receives all reports.
    if reporter is None or not os.environ.get("CI"):
        return
    skipped_tests = [report.nodeid for report in reporter.stats.get("skipped", [])]
    if skipped_tests:
        reporter.write_line(f"\nskipped in CI: {', '.join(skipped_tests)}")
        session.exitstatus = session.exitstatus or pytest.ExitCode.TESTS_FAILED


@pytest.fixture(autouse=True)
def own_cache(
    request: pytest.FixtureRequest,
    tmp_path_factory: pytest.TempPathFactory,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """No test reads or writes the user's own files, or follows the user's language.

    The folders are in the test's own. Most tests need none and store nothing, so they get no
    folder: pytest scans all folders of a run for the name of the next one.
    """
    if "tmp_path" in request.fixturenames:
        cache_folder = request.getfixturevalue("tmp_path")
    else:
        cache_folder = tmp_path_factory.getbasetemp() / "kept" / str(next(UNSEEN))
    monkeypatch.setenv("XDG_CACHE_HOME", str(cache_folder / "cache"))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(cache_folder / "settings"))
    monkeypatch.setenv("WIN_PD_OVERRIDE_LOCAL_APPDATA", str(cache_folder / "local"))
    monkeypatch.setenv("LC_ALL", "C.UTF-8")
    monkeypatch.setenv("DBUS_SYSTEM_BUS_ADDRESS", "unix:path=/nonexistent")  # nor their Bluetooth
    monkeypatch.delenv("TINISCRIPT_DEBUG", raising=False)


@pytest.fixture(autouse=True)
def closed_journals(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A class that a test lets crash has its files closed, as at the end of a process."""
    journals: list[Journal] = []
    make = Journal.__init__

    def make_and_note(journal: Journal, path: Path | None) -> None:
        make(journal, path)
        journals.append(journal)

    monkeypatch.setattr(Journal, "__init__", make_and_note)
    yield
    for journal in journals:
        journal.close()


@pytest.fixture
def tsc(capsys: pytest.CaptureFixture[str]) -> Tsc:
    return Tsc(capsys)


@pytest.fixture
def working_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The test's own folder, in which it is."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def program(tmp_path: Path) -> Path:
    path = tmp_path / "drive.ts"
    path.write_text(PROGRAM, encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def sketches(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Return a builder of PlatformIO environments that builds each once."""
    skip_unless_available()

    @lru_cache
    def sketch(environment: str) -> Path:
        return firmware(
            environment, tmp_path_factory.mktemp("sketch"), shared_folder(tmp_path_factory)
        )

    return sketch


@pytest.fixture(scope="session")
def sketch(sketches: Callable[[str], Path]) -> Path:
    return sketches("uno")


@pytest.fixture
def hasty(monkeypatch: pytest.MonkeyPatch) -> None:
    """Shorten the waits for a robot that will not answer."""
    monkeypatch.setattr("tiniscript.library.opening.ANSWER_TIMEOUT_MS", 800)
    monkeypatch.setattr("tiniscript.library.opening.CABLE_ANSWER_TIMEOUT_MS", 800)
    monkeypatch.setattr("tiniscript.library.opening.LONG_QUIET_S", 0.1)
    monkeypatch.setattr("tiniscript.library.client.REQUEST_TIMEOUT_MS", 800)


@pytest.fixture
def pty_robot() -> Iterator[PtyRobot]:
    """A robot of the kit `tinibot`."""
    with PtyRobot(robots.load("tinibot").kit) as robot:
        yield robot


@pytest.fixture
def link(pty_robot: PtyRobot) -> Iterator[Command]:
    """`tsc monitor --hold` on the robot's port."""
    command = Command("monitor", "--hold", "--port", pty_robot.port)
    command.until("share this port")
    yield command
    command.kill()
