"""The runner of PlatformIO's tests, which reports each test case by the name in `test_cases.cpp`.

A run that ends early, or in which no test case runs, is an error. PlatformIO's own runner for
doctest counts what it finds in the printed assertions, and lets both pass.
"""

from __future__ import annotations

import re

import click
from platformio.test.exception import UnitTestError, UnitTestSuiteError
from platformio.test.result import TestCase, TestStatus
from platformio.test.runners.base import TestRunnerBase

ENDING = re.compile(r"(PASSED|FAILED): (.*)")
END = "[doctest] test cases:"


class CustomTestRunner(TestRunnerBase):  # type: ignore[misc] # PlatformIO has no types
    EXTRA_LIB_DEPS = ("doctest/doctest@^2.4.9",)

    def setup(self) -> None:
        self.has_ended = False
        if self.platform.name != "native":
            raise UnitTestSuiteError("these tests are for a computer: pio test -e native")

    def on_testing_line_output(self, line: str) -> None:
        click.echo(line, nl=False)
        if ending := ENDING.fullmatch(line.rstrip()):
            self.test_suite.add_case(TestCase(ending[2], TestStatus[ending[1]]))
        self.has_ended |= line.startswith(END)

    def stage_testing(self) -> None:
        if self.options.without_testing:
            return
        cases = self.test_suite.cases
        try:
            super().stage_testing()
        except UnitTestError:
            # The exit code of doctest repeats that a case failed.
            has_failed = any(case.status is TestStatus.FAILED for case in cases)
            if not (self.has_ended and has_failed):
                raise
        if not self.has_ended:
            raise UnitTestSuiteError("the tests have ended before their end")
        if not cases:
            raise UnitTestSuiteError("no test case has run")
