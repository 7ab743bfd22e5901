"""`python -m tools.mutation`: which mistakes it makes, what it calls noticed; and the mutants that
once survived, each of which its test must notice at every run."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.project.known_mutants import KNOWN, Known
from tests.support.casefile import ROOT
from tools import mutation
from tools.mutation import EDITS, MODULES, Copy, Module, Mutant, drawn, equivalent, mutants

PYTHON = '''
from here import of
NAMES: dict[str, int] = {"a": 1}
def low(a: int | None, *rest: int) -> bool:
    """a < b"""
    x = -1 + a  # a + b
    if x not in rest and a is not None:
        tell(x)
    return x < 10
'''
SCRIPT = """
const MOST = 1000; // and 2
class Box {
  #count = 0;
  add(text) {
    if (!text || text.length > MOST) return `${1 + 2} <`;
    this.#count += text.replace(/[/*] + 4/g, "5").length ?? 6;
    this.tell();
    return text;
  }
}
"""
CPP = """
// a < b
#define LESS 3 < 4
uint8_t count = 7;
void tell(char letter) {
  if (letter == '<' && is_told(letter)) return;
  told = count;
}
"""
ASSEMBLY = """
tell: ; a add b
    ldi r18, 3  ; r18 = 3
1:  add r18, r19
    breq 1b
"""


def changed_lines(suffix: str, text: str) -> list[str]:
    found = []
    for start, end, instead in EDITS[suffix](text):
        changed = text[:start] + instead + text[end:]
        if suffix == ".py":
            ast.parse(changed)
        found.append(changed.splitlines()[text.count("\n", 0, start)].strip())
    return found


def test_each_operator_word_number_condition_and_call_is_changed_and_nothing_else() -> None:
    assert changed_lines(".py", PYTHON) == [
        'NAMES: dict[str, int] = {"a": 2}',
        "x = -2 + a  # a + b",
        "x = -1 - a  # a + b",
        "if x not in rest or a is not None:",
        "if x not in rest and a is  None:",
        "if False:",
        "pass",
        "return x <= 10",
        "return x < 11",
    ]


def test_of_a_script_and_of_the_robots_code_too() -> None:
    condition = "if (!text || text.length > MOST) return `${1 + 2} <`;"
    count = 'this.#count += text.replace(/[/*] + 4/g, "5").length ?? 6;'
    assert changed_lines(".js", SCRIPT) == [
        condition.replace("||", "&&"),
        condition.replace(">", ">=", 1),
        count.replace("+=", "-="),
        count.replace("??", "&&"),
        condition.replace("!text", "text"),
        "const MOST = 1001; // and 2",
        "#count = 1;",
        count.replace("6", "7"),
        "if (false) return `${1 + 2} <`;",
        ";",
        ";",
    ]
    condition = "if (letter == '<' && is_told(letter)) return;"
    assert changed_lines(".cpp", CPP) == [
        condition.replace("==", "!="),
        condition.replace("&&", "||"),
        "uint8_t count = 8;",
        "if (false) return;",
        ";",
    ]
    assert changed_lines(".S", ASSEMBLY) == [
        "; r18 = 3",
        "1:  sub r18, r19",
        "1:",
        "brne 1b",
        "",
    ]


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.name)
def test_each_module_has_mutants_and_tests(module: Module) -> None:
    assert len(mutants(module)) > 50
    for test in module.tests:
        assert (ROOT / test.split("::")[0]).exists(), test


def test_every_source_is_of_one_module() -> None:
    sources = [*ROOT.glob("compiler/tiniscript/**/*.py"), *ROOT.glob("tools/studio/src/**/*.js")]
    for suffix in ("cpp", "S"):
        sources += ROOT.glob(f"vm_arduino/src/*/**/*.{suffix}")
    found = [path for each in MODULES for pattern in each.files for path in ROOT.glob(pattern)]
    assert sorted(found) == sorted(path for path in sources if "esp32/arduino" not in str(path))


def test_the_same_seed_draws_the_same_mutants_in_turn_from_each_module() -> None:
    modules = [each for each in MODULES if each.name in ("codegen", "bytecode")]
    first = drawn(modules, 6, 1)
    assert first == drawn(modules, 6, 1) != drawn(modules, 6, 2)
    assert [mutation.module_of(each.file) for each in first] == modules * 3


def test_tests_that_name_a_file_are_first_and_long_ones_last() -> None:
    found = mutation.tests_of("compiler/tiniscript/link/seal.py")
    assert found[0] == "tests/link/test_seal.py" and found[-1] == "tests/link/test_named_robots.py"


def test_what_is_listed_as_equivalent_is_still_there() -> None:
    for file, was, _ in equivalent():
        lines = (ROOT / file).read_text(encoding="utf-8").splitlines()
        assert was in {line.strip() for line in lines}, f"{file}: {was}"


LOW = "def low(a):\n    x = a * 1\n    return a < 4\n"
TEST = "from where import low\ndef test_low():\n    assert low(3) and not low(4)\n"


@pytest.fixture
def two_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Copy:
    (tmp_path / "where.py").write_text(LOW, encoding="utf-8")
    (tmp_path / "test_where.py").write_text(TEST, encoding="utf-8")
    copy = Copy.__new__(Copy)
    copy.folder = tmp_path
    return copy


def test_what_a_test_notices_is_told_from_what_none_does(two_files: Copy) -> None:
    own = Module("own", ("where.py",), ("test_where.py",))
    found = {
        each.becomes: two_files.notices(each, own.tests) for each in mutants(own, two_files.folder)
    }
    assert [becomes for becomes, by in found.items() if not by] == ["x = a // 1", "x = a * 2"]
    assert found["return a <= 4"].startswith("FAILED test_where.py::test_low")
    assert (two_files.folder / "where.py").read_text(encoding="utf-8") == LOW
    assert two_files.failing(own.tests) == ""


def test_what_does_not_end_is_noticed(two_files: Copy, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mutation, "LIMIT_S", 3)
    text = LOW.replace("    return", "    while x: pass\n    return")
    mutant = Mutant("where.py", 2, "", "", text)
    assert two_files.notices(mutant, ["test_where.py"]) == "it does not end"


# -- mutants that once survived --------------------------------------------------------------------


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Copy]:
    yield Copy(tmp_path_factory.mktemp("mutants"))


@pytest.mark.parametrize("each", KNOWN, ids=lambda each: each.missing)
def test_a_known_mutant_is_noticed(each: Known, copy: Copy) -> None:
    text = (ROOT / each.file).read_text(encoding="utf-8")
    assert text.count(each.was) == 1, "the code has changed: find the place again"
    line = text[: text.index(each.was)].count("\n") + 1
    mutant = Mutant(each.file, line, each.was, each.becomes, text.replace(each.was, each.becomes))
    noticed = copy.notices(mutant, [each.test])
    assert noticed.startswith(f"FAILED {each.test}"), noticed or "no test notices it"
