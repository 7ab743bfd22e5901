"""The cases of the link: each half against the written bytes of the other."""

from __future__ import annotations

import pytest

from tests.machines.link import cpp_link
from tests.support.link_cases import (
    CppSide,
    LinkCase,
    SessionSide,
    WrittenSide,
    accept,
    computer_of,
    has_session,
    link_cases,
    packets_of,
    play,
    stream_of,
    with_new_results,
)

LINK_CASES = link_cases("link")
SESSIONS = [case for case in LINK_CASES if has_session(case)]
PACKETS = link_cases("packets")
COMPUTERS, ROBOTS = link_cases("computer packets"), link_cases("robot packets")


@pytest.mark.parametrize("case", SESSIONS, ids=lambda case: case.id)
def test_the_computer_acts_as_its_cases_state(
    case: LinkCase, request: pytest.FixtureRequest
) -> None:
    if request.config.getoption("--accept"):
        pytest.skip("both halves are written by the next test")
    assert play(case.rows, SessionSide(), WrittenSide(case.rows)) == case.rows


@pytest.mark.parametrize("case", LINK_CASES, ids=lambda case: case.id)
def test_the_robot_acts_as_its_cases_state(case: LinkCase, request: pytest.FixtureRequest) -> None:
    if request.config.getoption("--accept"):
        rows = play(case.rows, computer_of(case), CppSide(cpp_link()))
        if rows != case.rows:
            accept(case, rows)
        return
    assert play(case.rows, WrittenSide(case.rows), CppSide(cpp_link())) == case.rows


@pytest.mark.parametrize("case", [*PACKETS, *COMPUTERS], ids=lambda case: case.id)
def test_the_receiver_acts_as_its_cases_state(
    case: LinkCase, request: pytest.FixtureRequest
) -> None:
    rows = with_new_results(case, packets_of(*stream_of(case)))
    if request.config.getoption("--accept"):
        if rows != case.rows:
            accept(case, rows)
        return
    assert rows == case.rows


@pytest.mark.parametrize("case", [*PACKETS, *ROBOTS], ids=lambda case: case.id)
def test_the_receiver_in_cpp_acts_as_its_cases_state(
    case: LinkCase, request: pytest.FixtureRequest
) -> None:
    rows = with_new_results(case, cpp_link().packets(*stream_of(case)))
    if request.config.getoption("--accept") and case in ROBOTS:
        if rows != case.rows:
            accept(case, rows)
        return
    assert rows == case.rows


def test_link_cases_exist() -> None:
    assert len(LINK_CASES) >= 25 and len(PACKETS) >= 12
