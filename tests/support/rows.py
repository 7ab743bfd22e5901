"""A single test of many rows with the same assertion."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

import pytest

Test = Callable[..., None]
Row = TypeVar("Row")


def go_through(
    test: Callable[[Row], None], rows: Iterable[Row], name: Callable[[Row], str] = repr
) -> None:
    """Test each row, and report each failing one: like `each_row`, for rows made at run time."""
    errors: dict[str, Exception] = {}
    for row in rows:
        try:
            test(row)
        except Exception as error:  # any exception, so that the other rows run too
            errors[name(row)] = error
    if errors:
        failures = (f"{row}: {type(error).__name__}: {error}" for row, error in errors.items())
        raise AssertionError("\n\n".join(failures)) from next(iter(errors.values()))


def each_row(names: str, rows: Iterable[Any]) -> Callable[[Test], Test]:
    """Like `pytest.mark.parametrize`, in one test: all rows run, and it names each that fails.

    Take it where a row is quick and uses no fixture that keeps something: a test of its own costs
    six milliseconds. The row must exist.
    """
    expected_texts = [name.strip() for name in names.split(",")]
    sets = [
        pytest.ParameterSet.extract_from(row, force_tuple=len(expected_texts) == 1) for row in rows
    ]
    assert sets, "no rows"

    def parametrize(test: Test) -> Test:
        @functools.wraps(test)
        def whole(**arguments: Any) -> None:
            def check_row(row: Any) -> None:
                test(**arguments, **dict(zip(expected_texts, row.values, strict=True)))

            go_through(check_row, sets, lambda row: str(row.id or repr(row.values)))

        signature = inspect.signature(test)
        parameters = [
            parameter
            for name, parameter in signature.parameters.items()
            if name not in expected_texts
        ]
        assert len(parameters) == len(signature.parameters) - len(expected_texts), (
            f"it takes no {names}"
        )
        whole.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
        return whole

    return parametrize
