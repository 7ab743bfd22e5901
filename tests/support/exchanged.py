"""Tries mutants in children of one process, which has imported and collected everything.

For a mutant of Python a child exchanges the code of the functions that differ, in their place; the
file of any other is written while its child builds it and runs the test.
"""

from __future__ import annotations

import importlib
import inspect
import json
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import NamedTuple

import pytest
from _pytest.runner import runtestprotocol

from tests.support.casefile import ROOT

LIMIT_S = 60  # processor time
TROUBLE_CODE = 2  # exit code of a child whose test was not run
SKIPPED_CODE = 3  # outcome if a test lacks something on this computer
PASSES, FAILS, SKIPS = "passes", "fails", "skips"
Pair = tuple[CodeType, CodeType]


class MutantTrial(NamedTuple):
    """A file, its text with a mistake, and the test that is to notice it."""

    file: str
    text: str
    test: str


class NoFunctionFound(Exception):
    """Raised if the difference is in no function that can be found."""


def list_outcomes(tries: Sequence[MutantTrial], folder: Path) -> list[str]:
    """Return for each whether its test FAILS, PASSES or SKIPS, or the reason why that is unknown.

    `folder` is a copy of the repository. In this run, the tests of Python, which are quick, must
    pass without a mistake.
    """
    environment = {"PYTHONPATH": str(folder / "compiler"), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    completed = subprocess.run(
        [sys.executable, "-m", "tests.support.exchanged"], cwd=folder, text=True,
        capture_output=True, input=json.dumps(tries), env={**os.environ, **environment},
    )  # fmt: skip
    assert completed.returncode == 0, completed.stderr
    texts: list[str] = json.loads(completed.stdout)
    return texts


class Plugin:
    """Runs the test of each try instead of all that are collected."""

    def __init__(self, tries: Sequence[MutantTrial]) -> None:
        self.tries = tries
        self.answers: list[str] = []

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        items_by_test = [
            [item for item in session.items if item.nodeid.split("[")[0] == tried_test.test]
            for tried_test in self.tries
        ]
        quick = [item for tried_test, row in zip(self.tries, items_by_test, strict=True)
                 for item in row if tried_test.file.endswith(".py")]  # fmt: skip
        assert _run_in_child(quick, lambda: None) != FAILS, "they fail without a mutant, too"
        self.answers += map(_run_try, self.tries, items_by_test)
        return True


def _run_try(tried_test: MutantTrial, items: Sequence[pytest.Item]) -> str:
    path = ROOT / tried_test.file
    if path.suffix == ".py":
        try:
            return _run_in_child(items, _exchange(tried_test))
        except NoFunctionFound as error:
            return str(error)
    original_data = path.read_bytes()
    path.write_text(tried_test.text, encoding="utf-8")
    try:
        return _run_in_child(items, lambda: None)
    finally:
        path.write_bytes(original_data)


def _run_in_child(items: Sequence[pytest.Item], begin_try: Callable[[], None]) -> str:
    """Run tests after `begin_try`; an endless loop fails."""
    child = os.fork()
    if child == 0:
        code = TROUBLE_CODE
        try:
            os.setsid()
            resource.setrlimit(resource.RLIMIT_CPU, (LIMIT_S, LIMIT_S))
            begin_try()
            rows = [runtestprotocol(item, log=False, nextitem=None) for item in items]
            reports = [test_report for row in rows for test_report in row]
            code = int(any(report.failed for report in reports if report.when == "call"))
            if not code and any(report.skipped for report in reports):
                code = SKIPPED_CODE
        finally:
            os._exit(code)
    _, status = os.waitpid(child, 0)
    with suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)  # also ends the processes of its tests
    code = os.waitstatus_to_exitcode(status)
    assert code != TROUBLE_CODE
    return {0: PASSES, SKIPPED_CODE: SKIPS}.get(code, FAILS)


def _exchange(tried_test: MutantTrial) -> Callable[[], None]:
    """Return a function that installs the mutant in the imported module."""
    name = tried_test.file.removeprefix("compiler/").removesuffix(".py").replace("/", ".")
    module = importlib.import_module(name.removesuffix(".__init__"))
    original_text = (ROOT / tried_test.file).read_text(encoding="utf-8")
    function_by_code = {function.__code__: function for function in _functions(module, module)}
    pairs = list(
        _pairs(
            *(compile(text, tried_test.file, "exec") for text in (original_text, tried_test.text))
        )
    )
    if not pairs or any(old_code not in function_by_code for old_code, _ in pairs):
        raise NoFunctionFound("a function that differs is not found")

    def exchange() -> None:
        for old_code, becomes in pairs:
            function_by_code[old_code].__code__ = becomes

    return exchange


def _pairs(old_code: CodeType, becomes: CodeType) -> Iterator[Pair]:
    """Yield the functions that differ in the code of a module or a class, outermost ones."""
    old_functions, new_functions = (
        [const for const in code.co_consts if isinstance(const, CodeType)]
        for code in (old_code, becomes)
    )
    if _own_content(old_code) != _own_content(becomes) or len(old_functions) != len(new_functions):
        raise NoFunctionFound("what differs is in no function")
    for pair in zip(old_functions, new_functions, strict=True):
        if pair[0] != pair[1]:
            if pair[0].co_flags & inspect.CO_OPTIMIZED:
                yield pair
            else:
                yield from _pairs(*pair)


def _own_content(code: CodeType) -> tuple[object, ...]:
    plain_constants = [const for const in code.co_consts if not isinstance(const, CodeType)]
    return code.co_code, code.co_names, repr(plain_constants)


def _functions(owner: ModuleType | type, module: ModuleType) -> Iterator[FunctionType]:
    """Yield the functions of a module, and of its classes."""
    for value in vars(owner).values():
        for name in ("", "__func__", "fget", "fset", "func", "__wrapped__"):
            function = getattr(value, name, None) if name else value
            if isinstance(function, FunctionType):
                yield function
        if isinstance(value, type) and value.__module__ == module.__name__:
            yield from _functions(value, module)


def main() -> int:
    plugin = Plugin([MutantTrial(*values) for values in json.load(sys.stdin)])
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # pytest's output goes to standard error
    tests = dict.fromkeys(tried_test.test for tried_test in plugin.tries)
    code = pytest.main(["-q", "-p", "no:cacheprovider", "-s", "--whole", *tests], [plugin])
    json.dump(plugin.answers, answers)
    answers.flush()
    return int(code)


if __name__ == "__main__":
    sys.exit(main())
