"""Makes small mistakes in the code, one at a time, and says which of them no test notices.

`python -m tools.mutation 150 --seed 1` draws 150 mutants, the same number of every module that
still has some, and runs the tests of each one's module until one fails, two mutants at a time.
`--file PATTERN` draws from less, `--list` only shows them, and `--first-tier` runs no long test.
Results are kept in the cache folder, so an interrupted run continues. Exit code 1: mutants
survived.

A survivor gets a test, and a row in `tests/project/known_mutants.py`, which CI tries; or a row in
`tools/equivalent_mutants.json`, if nothing can notice it. It knows how the languages are formatted
here (formatters put blanks around binary operators), not what the code does.
"""

from __future__ import annotations

import argparse
import hashlib
import io
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import tokenize
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import accumulate, zip_longest
from pathlib import Path
from typing import NamedTuple

from tests.support import order
from tiniscript.base.files import cache_folder
from tools import ROOT

TEST_LIMIT_S = 300  # processor time of the tests of one mutant: an endless loop is noticed, too
WAIT_LIMIT_S = 1800  # time limit for a process that makes no progress
MUTANTS_AT_ONCE = 2
NODE_MODULES = Path("tools/studio/node_modules")
FAILED_TEST = re.compile(r"(?:FAILED|ERROR) (\S+?\.py(?:::\w+)*(?:\[.*?\](?= - |$))?)")
# Files of a person, or being written.
UNCOPIED_NAMES = (".git", ".venv", ".*_cache", ".pio", "*.pyc.*", "node_modules", "own.h", "ready")

_CPP, _PY, _JS = "vm_arduino/src", "compiler/tiniscript", "tools/studio/src"
_HOST = "tests/firmware/test_host_firmware.py"


class Module(NamedTuple):
    """The files of a module, as patterns, and the tests about it, quick ones first."""

    name: str
    files: tuple[str, ...]
    tests: tuple[str, ...]


def _python(name: str, *tests: str) -> Module:
    return Module(name, (f"{_PY}/{name}/**/*.py",), tests or (f"tests/{Path(name).name}",))


# fmt: off
MODULES = (
    Module("base", (f"{_PY}/*.py", f"{_PY}/base/*.py"), ("tests/vm/test_fixed_point.py", "tests/vm/test_cases.py", "tests/languages", "tests/robots", "tests/cli/test_files.py", "tests/pupils/test_pupils.py")),
    _python("syntax", "tests/syntax", "tests/vm/test_cases.py", "tests/pupils"),
    _python("semantics", "tests/semantics", "tests/vm/test_cases.py", "tests/pupils/test_pupils.py"),
    _python("recovery", "tests/recovery", "tests/pupils"),
    _python("diagnostics", "tests/diagnostics", "tests/pupils"),
    Module("codegen", (f"{_PY}/codegen/*.py",), ("tests/codegen", "tests/vm/test_cases.py")),
    _python("bytecode", "tests/bytecode", "tests/vm/test_cases.py"),
    _python("vm", "tests/vm/test_cases.py", "tests/vm"),
    _python("codegen/text"), _python("codegen/sketch"), _python("conformance", "tests/conform"),
    _python("library"), _python("doctor"),
    _python("virtual", "tests/virtual", "tests/link/test_named_robots.py"),
    _python("link", "tests/link", "tests/sharing", "tests/modules", "tests/cli/test_keys.py", "tests/firmware/test_owners.py"),
    _python("robots", "tests/robots", "tests/wiring"), _python("flash"),
    _python("lessons", "tests/lessons", "tests/cli/test_lesson_command.py"),
    _python("together", "tests/together", "tests/studio/test_groups.py"),
    _python("studio"), _python("cli", "tests/cli", "tests/wiring", "tests/project/test_windows.py"),
    Module("machine", (f"{_CPP}/vm/*.cpp",), ("tests/vm/test_cases.py", "tests/vm/test_cpp_edges.py", "tests/vm/test_cpp_agreement.py", "tests/vm/test_cpp_chips.py")),
    Module("machine-avr", (f"{_CPP}/vm/*.S",), ("tests/vm/test_cases.py", "tests/vm/test_cpp_chips.py", "tests/vm/test_cpp_avr_arithmetic.py")),
    Module("reader", (f"{_CPP}/text/*.cpp", f"{_CPP}/text/*.S"), ("tests/text/test_reader.py", "tests/text", "tests/firmware/test_text_small.py")),
    Module("robot-link", (f"{_CPP}/link/*.cpp",), ("tests/link/test_link_cases.py", "tests/link", _HOST, "tests/firmware/test_owners.py", "tests/firmware/test_text.py")),
    Module("store", (f"{_CPP}/store/*.cpp",), ("tests/firmware/test_store.py", "tests/firmware/test_persistence.py", "tests/firmware/test_undo.py", _HOST)),
    Module("firmware", (f"{_CPP}/firmware/*.cpp",), (_HOST, *(f"tests/firmware/test_{name}.py" for name in ("persistence", "undo", "stops", "button", "owners", "trim", "text", "other_versions", "actuator_stops")))),
    Module("avr-boards", (f"{_CPP}/boards/*.cpp", f"{_CPP}/boards/avr/*.cpp", f"{_CPP}/boards/avr/*.S", f"{_CPP}/link/*.S"), tuple(f"tests/firmware/test_{name}.py" for name in ("boards", "board_devices", "board_sonar", "board_stops", "uno_robot", "uno_line", "uno_watchdog", "uno_supply", "uno_stops"))),
    Module("esp32-boards", (f"{_CPP}/boards/esp32/*.cpp",), tuple(f"tests/firmware/test_esp32_{name}.py" for name in ("robot", "store", "transports", "wifi", "broker", "protocol_sniffer"))),
    Module("page", (f"{_JS}/**/*.js",), ("tests/studio",)),
)
# fmt: on


class Mutant(NamedTuple):
    """A file below the repository, its text with one small mistake, and the line it was made in."""

    file: str
    line: int
    old_line: str
    new_line: str
    changed_text: str

    @property
    def name(self) -> str:
        return f"{self.file}:{self.line}: {self.old_line}  ->  {self.new_line}"


# -- mutation operators ----------------------------------------------------------------------------

Edit = tuple[int, int, str]  # start, end and replacement

SHARED_OPERATORS = {
    "<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "+": "-", "-": "+",
    "*": "/", "/": "*", "%": "*", "&": "|", "|": "&", "^": "&", "<<": ">>", ">>": "<<",
    "+=": "-=", "-=": "+=", "&=": "|=", "|=": "&=", "&&": "||", "||": "&&", "===": "!==",
    "!==": "===", "??": "&&",
}  # fmt: skip
PYTHON_OPERATORS = {**SHARED_OPERATORS, "*": "//", "//": "*", "/": "*"}
WORD_OPERATORS = {"and": "or", "or": "and", "True": "False", "False": "True", "break": "pass",
         "continue": "pass"}  # fmt: skip
OPPOSITE_BRANCHES = [("breq", "brne"), ("brsh", "brlo"), ("brcs", "brcc"), ("brmi", "brpl"),
                     ("brlt", "brge"), ("brtc", "brts"), ("sbrc", "sbrs"), ("sbic", "sbis"),
                     ("add", "sub"), ("adc", "sbc"), ("dec", "inc"), ("and", "or")]  # fmt: skip
OPPOSITE_INSTRUCTION = dict(OPPOSITE_BRANCHES) | {b: a for a, b in OPPOSITE_BRANCHES}

OPERATOR = re.compile(r"(?<= )(?:[!=]==?|<<|>>|[-+&|]=|[-+*/%&|^<>]|[<>]=|&&|\|\||\?\?)(?= )")
NOT = re.compile(r"!(?=[\w(])")
NUMBER = re.compile(r"(?<![\w.#$])(0x[0-9a-f]+|\d+)\b(?!\.)")
IF_CONDITION = re.compile(r"\bif \(")
# A call, an assignment or a way out, alone on its line; no declaration.
STATEMENT = re.compile(
    r"^ +(?!return \w|const |let |if |else|case |using |import |export |static |get |set |#\w+ = "
    r"|[A-Za-z][\w:<>]* [*&]?\w+(?: =|;|\{))[#\w*].*;$",
    re.M,
)
# Strings, comments, directives, and in JavaScript templates and patterns: their contents stay.
_STRING = r"\"(?:[^\"\\\n]|\\.)*\"|'(?:[^'\\\n]|\\.)*'"
_COMMENT = r"//[^\n]*|/\*.*?\*/"
_ITEM = r"\\.|\[(?:[^\]\\\n]|\\.)*\]"
_PATTERN = rf"(?<=[(,=:!&|?])\s?/(?:[^/\\\n\[ ]|{_ITEM})(?:[^/\\\n\[]|{_ITEM})*/\w*"
UNCHANGED_PARTS = {
    ".cpp": re.compile(rf"{_STRING}|{_COMMENT}|^ *#[^\n]*", re.S | re.M),
    ".js": re.compile(rf"{_STRING}|`(?:[^`\\]|\\.)*`|{_COMMENT}|{_PATTERN}", re.S),
}


def braces_edits(text: str, suffix: str) -> Iterator[Edit]:
    """Yield the edits of a text in C++ or JavaScript."""
    masked_text = UNCHANGED_PARTS[suffix].sub(lambda match: re.sub(r"[^\n]", "\0", match[0]), text)
    for match in OPERATOR.finditer(masked_text):
        yield match.start(), match.end(), SHARED_OPERATORS[match[0]]
    for match in NOT.finditer(masked_text):
        yield match.start(), match.end(), ""
    for match in NUMBER.finditer(masked_text):
        yield match.start(), match.end(), str(int(match[0], 0) + 1)
    for match in IF_CONDITION.finditer(masked_text):
        yield match.end(), _closing_bracket(masked_text, match.end()), "false"
    for match in STATEMENT.finditer(masked_text):
        yield match.end() - len(match[0].lstrip()), match.end(), ";"


def _closing_bracket(text: str, offset: int) -> int:
    """Return the place of the bracket that closes the one before `offset`."""
    depth = 1
    while depth:
        depth += {"(": 1, ")": -1}.get(text[offset], 0)
        offset += 1
    return offset - 1


def assembly_edits(text: str) -> Iterator[Edit]:
    """Yield the edits of a text in assembly: an instruction less, or the opposite one."""
    for match in re.finditer(r"^(?:\d+:)? +([a-z]\w*)(?: [^;\n]*)?", text, re.M):
        start, end = match.span(1)
        if match[1] in OPPOSITE_INSTRUCTION:
            yield start, end, OPPOSITE_INSTRUCTION[match[1]]
        yield start, match.end(), ""


def python_edits(text: str) -> Iterator[Edit]:
    """Yield the edits of a text in Python. Imports, heads and annotations stay."""
    line_offsets = [0, *accumulate(len(tokens) for tokens in text.splitlines(keepends=True))]
    tokens: list[tokenize.TokenInfo] = []
    depth = 0  # a class without functions contains only declarations
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type in (tokenize.COMMENT, tokenize.NL, tokenize.INDENT, tokenize.DEDENT):
            depth += (token.type == tokenize.INDENT) - (token.type == tokenize.DEDENT)
        elif token.type != tokenize.NEWLINE:
            tokens.append(token)
        elif tokens:
            if tokens[0].string not in ("import", "from", "def", "class", "@", "async", "type"):
                yield from _line_edits(tokens, line_offsets, is_inside=depth > 0)
            tokens = []


def _line_edits(
    tokens: list[tokenize.TokenInfo], line_starts: Sequence[int], *, is_inside: bool
) -> Iterator[Edit]:
    spans = [
        (line_starts[t.start[0] - 1] + t.start[1], line_starts[t.end[0] - 1] + t.end[1])
        for t in tokens
    ]
    words = [token.string for token in tokens]
    is_annotated = len(words) > 2 and words[1] == ":"
    value_start = words.index("=") if is_annotated and "=" in words else len(words) * is_annotated
    for index in range(value_start, len(words)):
        start, end = spans[index]
        previous_token = tokens[index - 1] if index else None
        follows_value = previous_token is not None and (
            previous_token.type in (tokenize.NAME, tokenize.NUMBER, tokenize.STRING)
            or previous_token.string in (")", "]", "}")
        )
        if tokens[index].type == tokenize.OP and words[index] in PYTHON_OPERATORS and follows_value:
            yield start, end, PYTHON_OPERATORS[words[index]]
        elif words[index] == "not" and words[index + 1] != "in":
            yield start, end, ""
        elif words[index] in WORD_OPERATORS:
            yield start, end, WORD_OPERATORS[words[index]]
        elif tokens[index].type == tokenize.NUMBER and words[index].isdecimal():
            yield start, end, str(int(words[index]) + 1)
    if words[0] in ("if", "elif", "while") and words[-1] == ":":
        yield spans[1][0], spans[-2][1], "False"
    is_call = words[-1] == ")" and words[0] not in ("return", "yield", "raise", "assert")
    if is_inside and tokens[0].type == tokenize.NAME and (is_call or words[0] == "raise"):
        yield spans[0][0], spans[-1][1], "pass"


EDITS: dict[str, Callable[[str], Iterator[Edit]]] = {
    ".py": python_edits,
    ".cpp": lambda text: braces_edits(text, ".cpp"),
    ".js": lambda text: braces_edits(text, ".js"),
    ".S": assembly_edits,
}


# -- which mutants ---------------------------------------------------------------------------------


def equivalent_mutants() -> dict[tuple[str, str, str], str]:
    """Return the reasons why mutants are equivalent: by file, line and replacement."""
    json_text = Path(__file__).with_name("equivalent_mutants.json").read_text("utf-8")
    rows: dict[str, list[tuple[str, str, str]]] = json.loads(json_text)
    return {
        (file, old_text, new_text): reason
        for reason, row_of_reason in rows.items()
        for file, old_text, new_text in row_of_reason
    }


def mutants(module: Module) -> list[Mutant]:
    """Return all mutants of a module but those that are listed as equivalent."""
    equivalent = equivalent_mutants()
    mutants = []
    for path in sorted({path for pattern in module.files for path in ROOT.glob(pattern)}):
        text = path.read_text(encoding="utf-8")
        if "enerated" in text.partition("\n")[0]:
            continue
        for start, end, replacement in EDITS[path.suffix](text):
            changed_text = text[:start] + replacement + text[end:]
            line = text.count("\n", 0, start)
            old_line, new_line = (
                whole_text.splitlines()[line].strip() for whole_text in (text, changed_text)
            )
            name = path.relative_to(ROOT).as_posix()
            if old_line != new_line and (name, old_line, new_line) not in equivalent:
                mutants.append(Mutant(name, line + 1, old_line, new_line, changed_text))
    return mutants


def draw(modules: Sequence[Module], count: int, seed: int, pattern: str = "*") -> list[Mutant]:
    """Draw mutants in turn from each module, the same ones for the same seed and code."""
    all_mutants = []
    for module in modules:
        module_mutants = [mutant for mutant in mutants(module) if Path(mutant.file).match(pattern)]
        random.Random(f"{seed} {module.name}").shuffle(module_mutants)
        all_mutants.append(module_mutants)
    mutants_in_turn = [
        mutant
        for mutants_of_turn in zip_longest(*all_mutants)
        for mutant in mutants_of_turn
        if mutant is not None
    ]
    return mutants_in_turn[:count]


def module_of(file: str) -> Module:
    """Return the module that a file is of."""
    return next(
        module
        for module in MODULES
        if any(ROOT / file in ROOT.glob(pattern) for pattern in module.files)
    )


def tests_of(file: str) -> list[str]:
    """Return the tests of a file's module: those first that name the file, and quick ones first."""
    stem = Path(file).stem

    def sort_key(path: Path) -> tuple[bool, int]:
        name, text = path.relative_to(ROOT).as_posix(), path.read_text(encoding="utf-8")
        is_long = name in order.LONG_FILES or name.startswith(order.PAGES)
        return is_long, -100 * (stem in path.stem) - len(re.findall(rf"\b{stem}\b", text))

    tests: dict[Path, None] = {}
    for test in module_of(file).tests:
        tests |= dict.fromkeys(sorted((ROOT / test).rglob("test_*.py")) or [ROOT / test])
    return [path.relative_to(ROOT).as_posix() for path in sorted(tests, key=sort_key)]


# -- trying them -----------------------------------------------------------------------------------


class Copy:
    """A copy of the repository, in which the tests run."""

    def __init__(self, folder: Path, *, is_first_tier: bool = False) -> None:
        self.folder = folder
        self.tier_arguments = ["-m", "not long"] if is_first_tier else []
        # Includes Python's bytecode of these files, and the built page.
        shutil.copytree(
            ROOT,
            folder,
            ignore=shutil.ignore_patterns(*UNCOPIED_NAMES),
            symlinks=True,
            dirs_exist_ok=True,
        )
        if (ROOT / NODE_MODULES).is_dir():
            (folder / NODE_MODULES).symlink_to(ROOT / NODE_MODULES)

    def try_mutant(self, mutant: Mutant) -> str:
        """Return the first failure of the module's tests with a mutant, or ""."""
        failure = self.find_noticing_test(mutant, tests_of(mutant.file))
        match = FAILED_TEST.match(
            failure
        )  # a test that also fails without the mutant does not count
        if match and (
            reason := self.first_failure([match[1]], is_page=mutant.file.endswith(".js"))
        ):
            return f"undecided, without it, too: {reason}"
        return failure

    def find_noticing_test(self, mutant: Mutant, tests: Sequence[str]) -> str:
        """Return a test that notices a mutant, or ""."""
        path = self.folder / mutant.file
        original_bytes, status = path.read_bytes(), path.stat()
        path.write_text(mutant.changed_text, encoding="utf-8")
        os.utime(path, (status.st_atime, status.st_mtime + 2))  # Python looks at whole seconds
        try:
            return self.first_failure(tests, is_page=path.suffix == ".js")
        finally:
            path.write_bytes(original_bytes)
            os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))

    def first_failure(self, tests: Sequence[str], *, is_page: bool = False) -> str:
        """Return the first failure of the tests, or ""."""
        if is_page and (reason := self._run_python(["-m", "tools.builds.studio", "--again"])):
            return f"the build: {reason}"
        # Tests of sizes, and of generated or built files, notice any change.
        test_filter = "not keeps_to_its_size and not generated and not same_page"
        pytest_arguments = [
            "-q",
            "-x",
            "-p",
            "no:cacheprovider",
            "-k",
            test_filter,
            *self.tier_arguments,
            *tests,
        ]
        return self._run_python(["-m", "pytest", *pytest_arguments])

    def _run_python(self, arguments: list[str]) -> str:
        environment = {
            **os.environ,
            "PYTHONPATH": str(self.folder / "compiler"),
            "PYTHONDONTWRITEBYTECODE": "1",
            "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",  # importing them takes longer than most tests
        }
        process = subprocess.Popen(
            ["sh", "-c", f'ulimit -t {TEST_LIMIT_S}; exec "$@"', "sh", sys.executable, *arguments],
            cwd=self.folder, env=environment, start_new_session=True, text=True, errors="replace",
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        )  # fmt: skip
        try:
            output, _ = process.communicate(timeout=WAIT_LIMIT_S)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)  # includes robots started by its tests
            process.communicate()
            return "it does not end"
        if process.returncode in (0, -signal.SIGKILL):
            return "it does not end" if process.returncode else ""
        messages = [line for line in output.splitlines() if line.startswith(("FAILED", "ERROR"))]
        return (
            messages[0] if messages else f"exit code {process.returncode}: {output[-200:].strip()}"
        )


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Make small mistakes; say which no test notices.")
    parser.add_argument("count", nargs="?", type=int, default=30, help="how many (30)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--file", default="*", help="only files like this one")
    parser.add_argument("--first-tier", action="store_true", help="run no long test")
    parser.add_argument("--list", action="store_true", help="only list them")
    options = parser.parse_args(arguments)
    chosen_mutants = draw(MODULES, options.count, options.seed, options.file)
    if options.list:
        print("\n".join(mutant.name for mutant in chosen_mutants))
        return 0
    tier = "-first-tier" if options.first_tier else ""
    results_path = cache_folder() / f"mutation-{_code_hash()}{tier}.json"
    results: dict[str, str] = (
        json.loads(results_path.read_text("utf-8")) if results_path.is_file() else {}
    )
    results_path.parent.mkdir(parents=True, exist_ok=True)

    def try_all(mutants_left: Iterator[Mutant]) -> None:
        with tempfile.TemporaryDirectory() as folder:
            repository_copy = Copy(Path(folder), is_first_tier=options.first_tier)
            for mutant in mutants_left:
                if mutant.name not in results:
                    results[mutant.name] = repository_copy.try_mutant(mutant)
                    results_path.write_text(json.dumps(results.copy(), indent=1), encoding="utf-8")
                print(f"{mutant.name}: {results[mutant.name] or '**nothing**'}", flush=True)

    with ThreadPoolExecutor(MUTANTS_AT_ONCE) as pool:
        list(pool.map(try_all, [iter(chosen_mutants)] * MUTANTS_AT_ONCE))
    survivors = [mutant.name for mutant in chosen_mutants if not results[mutant.name]]
    print(f"\n{len(chosen_mutants)} mutants, {len(survivors)} survived:", *survivors, sep="\n  ")
    return int(bool(survivors))


def _code_hash() -> str:
    """Return the hash of the tested code: results of other code do not count."""
    command = ["sh", "-c", "git rev-parse HEAD; git diff HEAD"]
    return hashlib.sha256(subprocess.check_output(command, cwd=ROOT)).hexdigest()[:12]


if __name__ == "__main__":
    sys.exit(main())
