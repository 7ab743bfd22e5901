"""`python -m tools.mutation`: each source is of a module that has tests; and the mutants that
once survived are noticed by their tests."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.project.known_mutants import KNOWN, Known
from tests.support import exchanged
from tests.support.casefile import ROOT
from tests.support.exchanged import Try
from tests.support.needs import need
from tools import mutation
from tools.mutation import MODULES, Copy, Module, Mutant, equivalent_mutants, mutants


@pytest.mark.sampled("module", keep=len(MODULES) // 3)
@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.name)
def test_each_module_has_mutants_and_tests(module: Module) -> None:
    assert len(mutants(module)) > 50
    for test in module.tests:
        assert (ROOT / test.split("::")[0]).exists(), test


def test_every_source_is_of_one_module() -> None:
    sources = [*ROOT.glob("compiler/tiniscript/**/*.py"), *ROOT.glob("tools/studio/src/**/*.js")]
    for suffix in ("cpp", "S"):
        sources += ROOT.glob(f"vm_arduino/src/*/**/*.{suffix}")
    paths = [path for module in MODULES for pattern in module.files for path in ROOT.glob(pattern)]
    assert sorted(paths) == sorted(path for path in sources if "esp32/arduino" not in str(path))


def test_tests_that_name_a_file_are_first_and_long_ones_last() -> None:
    tests = mutation.tests_of("compiler/tiniscript/link/seal.py")
    assert tests[0] == "tests/link/test_seal.py" and tests[-1] == "tests/link/test_named_robots.py"


def test_what_is_listed_as_equivalent_is_still_there() -> None:
    for file, old, _ in equivalent_mutants():
        lines = (ROOT / file).read_text(encoding="utf-8").splitlines()
        assert old in {line.strip() for line in lines}, f"{file}: {old}"


def tried(known: Known) -> Try:
    text = (ROOT / known.file).read_text(encoding="utf-8")
    assert text.count(known.original) == 1, f"{known.missing}: the code has changed: find it again"
    return Try(known.file, text.replace(known.original, known.becomes), known.test)


def test_known_mutants_are_of_code_and_tests_that_are_there() -> None:
    for known in KNOWN:
        file, _, name = tried(known).test.partition("::")
        texts = [path.read_text(encoding="utf-8") for path in (ROOT / file).parent.glob("*.py")]
        assert (ROOT / file).exists(), known.test
        assert any(f"def {name}(" in text for text in texts), known.test  # it may be imported


@pytest.mark.long
def test_known_mutants_are_noticed(tmp_path: Path) -> None:
    copy = Copy(tmp_path)
    tries = [tried(known) for known in KNOWN]
    answers = exchanged.answers(tries, tmp_path)
    skipped = []
    for known, one, answer in zip(KNOWN, tries, answers, strict=True):
        if answer == exchanged.SKIPS:
            skipped.append(known.test)
            continue
        assert answer != exchanged.PASSES, f"no test notices {known.missing}"
        if answer != exchanged.FAILS:
            mutant = Mutant(known.file, 0, known.original, known.becomes, one.text)
            noticed = copy.find_noticing_test(mutant, [known.test])
            assert noticed.startswith(f"FAILED {known.test}"), (
                f"{known.missing}: {answer}, {noticed}"
            )
    need(f"what these need is not on this computer: {', '.join(skipped)}" if skipped else "")
