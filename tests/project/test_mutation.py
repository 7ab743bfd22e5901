"""The tests notice what is wrong: a fair sample of the breaks of `python -m tools.mutation`.

One for each rule and each reason to refuse, one of every six opcodes, and what arithmetic and time
come to; and some lines of the assembly for the AVR. All of them: `python -m tools.mutation`, and
with `--avr`.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.machines import avr
from tests.machines.host import SOURCES, missing
from tests.support.avr_sample import AvrSample
from tests.support.cpp_sample import Sample, Unfit
from tools.mutation import __main__
from tools.mutation.assembly import (
    NEEDLESS,
    OPEN,
    assembly_breaks,
    gone_from_avr,
    noticeable_on_avr,
)
from tools.mutation.mutants import MACHINE, Break, Stale, breaks
from tools.mutation.operators import small_changes

needs_host = pytest.mark.skipif(bool(missing()), reason=missing() or "there is a compiler")
ONE_OPCODE_IN = 6
ONE_CHANGE_IN = 3  # of limits, arithmetic and time


def sampled() -> Iterator[Break]:
    """Yield breaks of every kind; for each rule and reason the first place that refuses for it."""
    seen: dict[str, int] = {}
    for each in __main__.noticeable(breaks(SOURCES)):
        if each.file.endswith(".h"):
            continue  # all is built again, for each of them: too long for a test
        if each.kind in ("rule", "refusal"):
            constant = each.name.split()[1]
            seen[constant] = seen.get(constant, 0) + 1
            if seen[constant] == 1:
                yield each
        else:
            seen[each.kind] = seen.get(each.kind, -1) + 1
            if seen[each.kind] % (ONE_OPCODE_IN if each.kind == "opcode" else ONE_CHANGE_IN) == 0:
                yield each


SAMPLE = list(sampled())


@pytest.fixture(scope="module")
def builds(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("builds")


@pytest.fixture(scope="module")
def sample(builds: Path) -> Iterator[Sample]:
    found = Sample(SOURCES, builds)
    yield found
    found.close()


@needs_host
@pytest.mark.parametrize("each", SAMPLE, ids=lambda each: each.name)
def test_break_is_noticed(each: Break, sample: Sample) -> None:
    result = __main__.tried(each, sample)
    assert result.kind, "every check passes"
    assert result.kind != __main__.BUILD, result.said


ONE_LINE_IN = 31  # of the assembly
AVR_BREAKS = [each for each in noticeable_on_avr(assembly_breaks(SOURCES)) if each.name not in OPEN]
AVR_SAMPLE = [
    each
    for kind in sorted({each.kind for each in AVR_BREAKS})
    for each in [each for each in AVR_BREAKS if each.kind == kind][::ONE_LINE_IN]
]


@pytest.fixture(scope="module")
def avr_sample() -> AvrSample:
    return AvrSample()


@pytest.mark.skipif(bool(avr.missing()), reason=avr.missing() or "there is a simulated chip")
@pytest.mark.parametrize("each", AVR_SAMPLE, ids=lambda each: each.name)
def test_break_of_the_assembly_is_noticed(each: Break, avr_sample: AvrSample) -> None:
    assert __main__.tried_on_avr(each, avr_sample).kind, "every answer is right"


def test_the_sample_of_the_assembly_is_fair() -> None:
    found = assembly_breaks(SOURCES)
    assert len({each.name for each in found}) == len(found) > 500
    assert {each.kind for each in AVR_SAMPLE} == {each.kind for each in found}
    assert {each.file for each in AVR_SAMPLE} == {each.file for each in found}


def test_what_is_needless_and_gone_is_told() -> None:
    found = assembly_breaks(SOURCES)
    assert {each.name for each in found} >= OPEN
    name = next(each.name for each in found if each.name in NEEDLESS)
    assert name not in {each.name for each in noticeable_on_avr(found)}
    assert name in gone_from_avr([each for each in found if each.name != name])


def test_the_sample_is_fair() -> None:
    kinds = {each.kind for each in SAMPLE}
    assert kinds == {"opcode", "rule", "refusal", "limit", "arithmetic"}
    assert len(SAMPLE) >= 40


def test_no_two_breaks_have_one_name() -> None:
    names = [each.name for each in breaks(SOURCES)]
    assert len({*names}) == len(names) > 300


def test_every_small_change_has_a_name_of_its_own() -> None:
    found = small_changes(SOURCES)
    assert len({each.name for each in found}) == len(found) > 500


@pytest.mark.parametrize(
    ("was", "becomes", "said"),
    [
        ("uint8_t code = ", "uint8_t codes = ", "OPCODE_IS_READ stands in 0 places"),
        ("Rule::kBadCall", "Rule::kBadDef", "Rule::kBadCall refuses nowhere"),
        ("kLateMs = 20", "kLateMs = 30", "'a program catches up with one ms more'"),
        ("kJoins = 16", "kJoins = kDefs", "does not say what kJoins is"),
    ],
)
def test_a_place_that_is_not_there_is_said(
    was: str, becomes: str, said: str, tmp_path: Path
) -> None:
    """No break is left out silently because the machine was rewritten."""
    copy = Path(shutil.copytree(SOURCES / MACHINE, tmp_path / MACHINE))
    for path in copy.glob("*"):
        text = path.read_text(encoding="utf-8")
        path.write_text(text.replace(was, becomes), encoding="utf-8")
    with pytest.raises(Stale, match=said):
        breaks(tmp_path)


@needs_host
def test_a_break_that_nothing_notices_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    each = Break("opcode", "some", "vm.cpp", "", "a < b;", "a <= b;")
    results = [__main__.Result(each, "", "", "", 1), __main__.Result(each, "case", "a", "", 1)]
    assert __main__.summary(results[1:], 1) == 0
    assert __main__.summary(results, 1) == 1
    assert "unnoticed: opcode: some\n  a < b;\n  a <= b;\n" in capsys.readouterr().out


def test_what_is_equivalent_is_a_change(monkeypatch: pytest.MonkeyPatch) -> None:
    each = Break("change", "some", "vm.cpp", "", "a < b;", "a <= b;")
    monkeypatch.setattr(__main__, "EQUIVALENT", {("a < b;", "a <= b;"): "", ("c;", ";"): ""})
    assert __main__.noticeable([each, each._replace(becomes="a > b;")]) == [
        each._replace(becomes="a > b;")
    ]
    assert __main__.gone([each]) == ["c;"]


@needs_host
def test_a_machine_that_is_wrong_already_proves_nothing(tmp_path: Path, builds: Path) -> None:
    copy = Path(shutil.copytree(SOURCES, tmp_path / "vm_arduino"))
    each = next(each for each in breaks(SOURCES) if each.kind == "opcode")
    (copy / MACHINE / each.file).write_text(each.text, encoding="utf-8")
    wrong = Sample(copy, builds)
    with pytest.raises(Unfit, match="case: "):
        wrong.failing(SOURCES)
    wrong.close()


def test_a_compiler_is_needed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(__main__, "missing", lambda: "no g++")
    assert __main__.main([]) == 2
    assert capsys.readouterr().err == "no g++\n"


def test_documents_tell_how_many_breaks_there_are() -> None:
    found = len(breaks(SOURCES))
    for name in ("CONTRIBUTING.md", "docs/promises.md"):
        told = re.findall(
            r"(?:in|list of) over (\d+)", (SOURCES.parent / name).read_text(encoding="utf-8")
        )
        assert told, name
        for each in told:
            assert 0 <= found - int(each) < 50, f"{name} says {each}, there are {found}"
