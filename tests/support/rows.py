"""One test of many rows that assert the same."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable
from typing import Any

import pytest

Test = Callable[..., None]


def each_row(names: str, rows: Iterable[Any]) -> Callable[[Test], Test]:
    """Like `pytest.mark.parametrize`, in one test: all rows run, and it names each that fails.

    Take it where a row is quick and uses no fixture that keeps something: a test of its own costs
    six milliseconds. There must be a row.
    """
    wanted = [name.strip() for name in names.split(",")]
    sets = [pytest.ParameterSet.extract_from(row, force_tuple=len(wanted) == 1) for row in rows]
    assert sets, "no rows"

    def made(test: Test) -> Test:
        @functools.wraps(test)
        def whole(**given: Any) -> None:
            wrong: dict[str, Exception] = {}
            for row in sets:
                try:
                    test(**given, **dict(zip(wanted, row.values, strict=True)))
                except Exception as why:  # of any kind: the other rows are to be seen, too
                    wrong[str(row.id or repr(row.values))] = why
            if wrong:
                said = (f"{row}: {type(why).__name__}: {why}" for row, why in wrong.items())
                raise AssertionError("\n\n".join(said)) from next(iter(wrong.values()))

        signature = inspect.signature(test)
        left = [each for name, each in signature.parameters.items() if name not in wanted]
        assert len(left) == len(signature.parameters) - len(wanted), f"it takes no {names}"
        whole.__signature__ = signature.replace(parameters=left)  # type: ignore[attr-defined]
        return whole

    return made
