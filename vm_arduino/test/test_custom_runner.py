"""How PlatformIO runs the tests: it takes the counts of test cases that doctest ends with.

A run that ends early, or in which no test case runs, is an error. PlatformIO's own runner for
doctest counts what it finds in the printed assertions, and lets both pass.
"""

from __future__ import annotations

import re

import click
from platformio.test.exception import UnitTestError, UnitTestSuiteError
from platformio.test.result import TestCase, TestStatus
from platformio.test.runners.base import TestRunnerBase

END = re.compile(r"\[doctest\] test cases: .*\b(\d+) passed .*\b(\d+) failed")


class CustomTestRunner(TestRunnerBase):  # type: ignore[misc] # PlatformIO has no types
    EXTRA_LIB_DEPS = ("doctest/doctest@^2.4.9",)

    def setup(self) -> None:
        self.has_ended = False
        if self.platform.name != "native":
            raise UnitTestSuiteError("these tests are for a computer: pio test -e native")

    def on_testing_line_output(self, line: str) -> None:
        click.echo(line, nl=False)
        if found := END.match(line):
            self.has_ended = True
            for status, count in zip(
                (TestStatus.PASSED, TestStatus.FAILED), found.groups(), strict=True
            ):
                for number in range(int(count)):
                    self.test_suite.add_case(TestCase(f"{status.name} {number + 1}", status))

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
