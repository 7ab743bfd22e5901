"""The C++ machine takes no more of a chip than it may, and its figures are of runs that were right.

No time is asserted here. Cycles of the simulated chip are no time: they are always the same.
"""

from __future__ import annotations

import pytest

from tests.support.platformio import firmware, shared_folder
from tools import uno
from tools.bench import avr_bench, machine, sizes, sketch_cycles
from tools.bench.workloads import (
    MAX_CYCLES,
    WORKLOADS,
    Workload,
    WrongResult,
    check,
    expected_values,
)

needs_chip = pytest.mark.skipif(
    bool(avr_bench.missing_reason()),
    reason=avr_bench.missing_reason() or "there is a simulated chip",
)


@pytest.mark.parametrize("work", WORKLOADS, ids=lambda work: work.name)
def test_a_wrong_value_raises_an_error(work: Workload) -> None:
    expected = expected_values(work)
    check("some machine", work, expected)
    for wrong_values in ((*expected[:-1], expected[-1] + 1), expected[:-1]):
        with pytest.raises(WrongResult, match=f"some machine, work {work.name}"):
            check("some machine", work, wrong_values)


@needs_chip
@pytest.mark.parametrize(
    ("work", "must"),
    [pytest.param(*row, id=row[0].name) for row in zip(WORKLOADS, MAX_CYCLES, strict=True)],
)
def test_cycles_are_within_their_limits(work: Workload, must: float) -> None:
    assert 1 < machine.per_iteration(work) <= must


@needs_chip
def test_the_shipped_sketch_adds_only_its_main_loop(
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    """Its values are right; and the machine runs for so long that the rest costs little."""
    if uno.missing():
        pytest.skip(uno.missing())
    sketch = firmware("uno", tmp_path_factory.mktemp("sketch"), shared_folder(tmp_path_factory))
    for work in WORKLOADS:
        short = work._replace(loop_count=2000)
        alone = machine.per_iteration(short)
        assert alone < sketch_cycles.per_iteration(sketch, short) < 1.25 * alone


@needs_chip
@pytest.mark.parametrize("part", sizes.LIMITS)
def test_no_part_exceeds_its_size_limit(part: str) -> None:
    size, must = sizes.size(part), sizes.LIMITS[part]
    assert must.flash * 0.8 < size.flash <= must.flash
    assert must.ram / 2 < size.ram <= must.ram
