"""How PlatformIO runs the tests: it counts the lines PASS and FAIL that `test_main.cpp` prints.

A run that ends early, or in which no test case runs, is an error. PlatformIO's own runner for
doctest counts what it finds in the printed assertions, and lets both pass.
"""

from __future__ import annotations

import re

import click
from platformio.test.exception import UnitTestError, UnitTestSuiteError
from platformio.test.result import TestCase, TestStatus
from platformio.test.runners.base import TestRunnerBase

CASE = re.compile(r"(PASS|FAIL) (.+)")
END = "[doctest] Status:"


class CustomTestRunner(TestRunnerBase):  # type: ignore[misc] # PlatformIO has no types
    EXTRA_LIB_DEPS = ("doctest/doctest@^2.4.9",)

    def setup(self) -> None:
        self.has_ended = False
        if self.platform.name != "native":
            raise UnitTestSuiteError("these tests are for a computer: pio test -e native")

    def on_testing_line_output(self, line: str) -> None:
        found = CASE.fullmatch(line.rstrip())
        if found:
            status = TestStatus.PASSED if found[1] == "PASS" else TestStatus.FAILED
            case = TestCase(found[2], status, stdout=line)
            self.test_suite.add_case(case)
            click.echo(case.humanize())
            return
        click.echo(line, nl=False)
        if END in line:
            self.has_ended = True

    def stage_testing(self) -> None:
        if self.options.without_testing:
            return
        cases = self.test_suite.cases
        try:
            super().stage_testing()
        except UnitTestError:
            # the exit code of doctest says once more that a case has failed
            has_failed = any(case.status is TestStatus.FAILED for case in cases)
            if not (self.has_ended and has_failed):
                raise
        if not self.has_ended:
            raise UnitTestSuiteError("the tests have ended before their end")
        if not cases:
            raise UnitTestSuiteError("no test case has run")
