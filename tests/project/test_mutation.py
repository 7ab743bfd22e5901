"""`python -m tools.mutation`: each source is of a module that has tests; and the mutants that
once survived are noticed by their tests."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.project.known_mutants import KNOWN, Known
from tests.support import exchanged
from tests.support.casefile import ROOT
from tests.support.exchanged import MutantTrial
from tests.support.needs import need
from tools import mutation
from tools.mutation import MODULES, Copy, Module, Mutant, equivalent_mutants, mutants


@pytest.mark.sampled("module", keep=len(MODULES) // 3)
@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.name)
def test_each_module_has_mutants_and_tests(module: Module) -> None:
    assert len(mutants(module)) > 50
    for test in module.tests:
        assert (ROOT / test.split("::")[0]).exists(), test


def test_every_source_belongs_to_one_module() -> None:
    sources = [*ROOT.glob("compiler/tiniscript/**/*.py"), *ROOT.glob("tools/studio/src/**/*.js")]
    for suffix in ("cpp", "S"):
        sources += ROOT.glob(f"vm_arduino/src/*/**/*.{suffix}")
    paths = [path for module in MODULES for pattern in module.files for path in ROOT.glob(pattern)]
    assert sorted(paths) == sorted(path for path in sources if "esp32/arduino" not in str(path))


def test_tests_that_name_a_file_are_first_and_long_ones_last() -> None:
    tests = mutation.tests_of("compiler/tiniscript/link/seal.py")
    assert tests[0] == "tests/link/test_seal.py" and tests[-1] == "tests/link/test_named_robots.py"


def test_equivalent_mutants_match_existing_code() -> None:
    for file, old_code, _ in equivalent_mutants():
        lines = (ROOT / file).read_text(encoding="utf-8").splitlines()
        assert old_code in {line.strip() for line in lines}, f"{file}: {old_code}"


def make_try(known_mutant: Known) -> MutantTrial:
    text = (ROOT / known_mutant.file).read_text(encoding="utf-8")
    assert text.count(known_mutant.original) == 1, (
        f"{known_mutant.missing}: the code has changed: find it again"
    )
    return MutantTrial(
        known_mutant.file,
        text.replace(known_mutant.original, known_mutant.becomes),
        known_mutant.test,
    )


def test_known_mutants_match_existing_code_and_tests() -> None:
    for known_mutant in KNOWN:
        file, _, name = make_try(known_mutant).test.partition("::")
        texts = [path.read_text(encoding="utf-8") for path in (ROOT / file).parent.glob("*.py")]
        assert (ROOT / file).exists(), known_mutant.test
        assert any(f"def {name}(" in text for text in texts), (
            known_mutant.test
        )  # modules that may be imported


@pytest.mark.long
def test_known_mutants_are_noticed(tmp_path: Path) -> None:
    copy = Copy(tmp_path)
    tries = [make_try(known) for known in KNOWN]
    answers = exchanged.list_outcomes(tries, tmp_path)
    skipped = []
    for known_mutant, one, answer in zip(KNOWN, tries, answers, strict=True):
        if answer == exchanged.SKIPS:
            skipped.append(known_mutant.test)
            continue
        assert answer != exchanged.PASSES, f"no test notices {known_mutant.missing}"
        if answer != exchanged.FAILS:
            mutant = Mutant(
                known_mutant.file, 0, known_mutant.original, known_mutant.becomes, one.text
            )
            noticed_text = copy.find_noticing_test(mutant, [known_mutant.test])
            assert noticed_text.startswith(f"FAILED {known_mutant.test}"), (
                f"{known_mutant.missing}: {answer}, {noticed_text}"
            )
    need(f"what these need is not on this computer: {', '.join(skipped)}" if skipped else "")
