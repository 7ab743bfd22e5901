"""The cases for machines of others: all machines of ours agree, and one from the specification."""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
import time
from collections.abc import Sequence
from functools import partial
from itertools import count
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

from tests.conform.spec_machine import Spec, runs
from tests.oracle import verifier
from tests.support.casefile import ROOT
from tests.support.command import CommandResult, Tsc
from tests.support.waiting import has_ended, until
from tiniscript import compile_text, robots
from tiniscript.base.kit import Device, Kit
from tiniscript.base.trace import Senses as Lists
from tiniscript.base.trace import TracedRobot
from tiniscript.bytecode.opcodes import ISA_MAJOR, ISA_MINOR, OPS
from tiniscript.bytecode.verify import load_image
from tiniscript.conformance import kit as kit_files
from tiniscript.conformance import machine_process
from tiniscript.conformance.comparing import AGREES, DIFFERS, LACKS, verdicts
from tiniscript.conformance.kit import MachineCase, link_test_suite, machine_cases
from tiniscript.conformance.machine_process import MachineProcess, Problem
from tiniscript.conformance.port_checks import all_checks
from tiniscript.vm.state import DONE, FAULT
from tiniscript.vm.tasks import machine_of
from tools.builds import conformance

TINIBOT = tuple(line.removesuffix("\n") for line in robots.load("tinibot").kit.lines())
PAGE = ROOT / "docs" / "develop" / "conformance.md"
SPEC_MACHINE_COMMAND = shlex.join([sys.executable, "-m", "tests.conform.spec_machine"])


def test_a_sensor_without_readings_has_a_line_without_values() -> None:
    """According to docs/develop/conformance.md; the machine built from it reads 0."""
    case = next(
        machine_case
        for machine_case in machine_cases()
        if not machine_case.needs and machine_case.readings_by_sensor
    )
    rows = case._replace(readings_by_sensor={0: (), 1: (5000, -1)}).request().splitlines()
    assert [row for row in rows if row.startswith("readings")] == [
        "readings 0",
        "readings 1 5000 -1",
    ]
    shown_bytes = compile_text("SHOW(LIGHT_R)", robots.load("tinibot").kit).image
    case = case._replace(
        devices=TINIBOT,
        image=shown_bytes,
        readings_by_sensor={0: ()},
        call_intervals_ms=(1,),
        begin_ms=0,
    )
    (rows,) = runs(case.request().splitlines(keepends=True))
    assert Spec().answer(rows) == ["0 READ LIGHT_R 0", "0 SHOW 0", "0 DONE"]


def test_a_sensor_that_is_late_has_a_line_after_the_readings() -> None:
    image = compile_text("SHOW(LIGHT_R + TIME)", robots.load("tinibot").kit).image
    case = machine_cases()[0]._replace(
        devices=TINIBOT, image=image, readings_by_sensor={0: (5000,)},
        delays_by_sensor={0: (100, 0, 32)}, begin_ms=2**32 - 5, call_intervals_ms=(3,), until_ms=99,
    )  # fmt: skip
    (rows,) = runs(case.request().splitlines(keepends=True))
    assert rows[-7:-5] == ["readings 0 5000", "slow 0 100 0 32"]
    assert Spec().answer(rows) == ["33 READ LIGHT_R 5", "33 SHOW 5.033", "33 DONE"]
    late_case = case._replace(until_ms=31)
    (rows,) = runs(late_case.request().splitlines(keepends=True))
    assert Spec().answer(rows) == ["31 LIMIT"]


def machine(tmp_path: Path, source: str) -> str:
    """Return the command of a machine in Python."""
    path = tmp_path / "machine.py"
    path.write_text(f"import os, sys, time\n{source}\n", encoding="utf-8")
    return shlex.join([sys.executable, str(path)])


def conform(tsc: Tsc, command: str, *options: str) -> CommandResult:
    return tsc("doctor", "--conform", "--machine", command, *options)


def find_differences(tsc: Tsc, command: str, *options: str) -> list[dict[str, object]]:
    """Return the differences."""
    result = conform(tsc, command, "--json", *options).gives(1)
    rows: list[dict[str, object]] = json.loads(result.out)["found"]
    return rows


def test_the_machine_from_the_specification_passes_all_cases(
    tsc: Tsc, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    result = conform(tsc, SPEC_MACHINE_COMMAND).gives(0)
    needing = sum(bool(case.needs) for case in machine_cases())
    count = len(machine_cases()) - needing
    assert count > 600 and needing > 600
    assert result.out == (
        f"{needing} cases with TASK, WHEN, CM or DEG were skipped: "
        "this machine does not support them.\n"
        f"{count} of {count} cases pass. Kit 5, bytecode {ISA_MAJOR}.{ISA_MINOR}.\n"
    )
    tasks = "--only", "tasks: "
    assert json.loads(conform(tsc, SPEC_MACHINE_COMMAND, "--json", *tasks).out)["left_out"]
    spanish = conform(tsc, SPEC_MACHINE_COMMAND, *tasks, "--lang", "es").out
    assert "casos con TASK, WHEN, CM o DEG se dejaron fuera" in spanish


@pytest.mark.parametrize("refusal", ["UNKNOWN_NEEDS", "OTHER_VERSION"])
def test_a_machine_lacks_tasks_only_if_it_refuses_the_first_image_with_tasks(refusal: str) -> None:
    cases = [case for case in machine_cases() if case.needs][:4]
    answers = iter([f"REFUSED {refusal}"])
    judged = list(verdicts(cases, lambda request, most: [next(answers)]))
    assert [verdict.outcome for verdict in judged] == [LACKS] * 4
    answers_with_late_refusal = iter([*(case.answer for case in cases[:3]), [f"REFUSED {refusal}"]])
    judged = list(verdicts(cases, lambda request, most: next(answers_with_late_refusal)))
    assert [verdict.outcome for verdict in judged] == [AGREES] * 3 + [DIFFERS]
    answers_with_other_refusal = iter([["REFUSED DAMAGED"], *(case.answer for case in cases[1:])])
    judged = list(verdicts(cases, lambda request, most: next(answers_with_other_refusal)))
    assert [verdict.outcome for verdict in judged] == [DIFFERS] + [AGREES] * 3


# A file of `tests/oracle`, its text, the replacement, and a case that must be named.
BREAKAGES = [
    ("arithmetic", "(abs(number) * 2 + abs(by))", "(abs(number) * 2)", "arithmetic: MUL"),
    ("arithmetic", "a - b * (a // b)", "int(a - b * int(a / b))", "arithmetic: MOD"),
    ("arithmetic", "state >> 17", "state >> 16", "arithmetic: RANDOM"),
    ("arithmetic", "if places >= 3", "if places >= 2", "ROUND keeps two places"),
    ("arithmetic", "max(3 - places, 0), 11)", "max(3 - places, 0), 9)", "ROUND keeps two places"),
    ("machine", "WRAP > 20", "WRAP > 70", "(called every 45 ms)"),
    ("machine", "WRAP > 20", "WRAP > 21", "time: 21 ms late"),
    ("machine", "WRAP > 20", "WRAP > 19", "time: 20 ms late"),
    ("machine", "(self.clock - self.now) % WRAP", "max(self.clock - self.now, 0)",
     "(time wraps around)"),
    ("machine", "None:\n                    self.motors((0, 0))", "None: pass",
     "UNTIL ends a move"),
    ("machine", 'case "BREAK_LOOP":\n                self.counters.pop()', 'case "BREAK_LOOP":',
     "blocks: "),
    ("words", "(31_000, 20_000_000)", "(0, 10**12)", "moves: "),
    ("machine", "self.counters.append(times)", "self.counters[14:] = [times]",
     "Sixteen counted loops"),
    ("machine", "self.begin()\n            move.has_begun", "move.has_begun",
     "time: UNTIL begins 21 ms late"),
    ("machine", "(self.now - self.clock) % WRAP // 20", "(self.now - self.clock) // 20",
     "time: UNTIL past 2^32 ms"),
    ("machine", "self.stack.append(popped_values[0])\n ", "self.stack.append(1)\n ",
     "OR_ELSE leaves its value"),
    ("machine", "nearest_in_range(1000 * nearest_whole(value),", "nearest_in_range(value,",
     "An actuator gets whole numbers"),
    ("machine", "answer(value) if actuator", "answer(value == 1) if actuator",
     "An actuator gets whole numbers"),
    ("machine", '"B": (-1, -1)', '"B": (1, 1)',
     "A watched move goes back"),
    ("machine", "self.kit.actuators[operands[0]]", "self.kit.actuators[operands[0] & 3]",
     "devices: "),
    ("machine", "return result_or_fault(self.passed)", "return self.passed % WRAP",
     "time: TIME is over for good"),
    ("machine", "            self.wait_to(self.passed + 1)",
     "            self.wait_to(self.passed + 1)\n            self.clock = self.now", "late: "),
    ("machine", "        while self.is_slow(number, self.passed)",
     "        while self.is_slow(number, self.passed) and number", "late: "),
    ("verifier", "m.depth <= 16", "m.depth <= 17", "refused: "),
    ("verifier", "<= 32, TOO_DEEP", "<= 33, TOO_DEEP", "refused: "),
    ("verifier", "and inner.kind == IF), BAD_TARGET", "), BAD_TARGET", "refused: "),
    ("verifier", "len(m.joins) < 16", "len(m.joins) < 17", "refused: "),
    ("image", "or data[3] > MINOR", "", "images: a later minor version"),
    ("image", 'if len(data) != whole', 'if len(data) < whole', "images: "),
]  # fmt: skip


def patch_oracle(name: str, old_code: str, new_code: str) -> ModuleType:
    """Return a module of `tests/oracle` that is changed in one place."""
    module = ModuleType(f"tests.oracle.{name}")
    path = ROOT / "tests" / "oracle" / f"{name}.py"
    source, module.__file__ = path.read_text(encoding="utf-8"), str(path)
    assert old_code in source
    exec(compile(source.replace(old_code, new_code), name, "exec"), vars(module))
    return module


@pytest.mark.parametrize(
    ("file", "old_code", "new_code", "named_text"), BREAKAGES, ids=[b[1] for b in BREAKAGES]
)
def test_a_broken_machine_is_reported(
    file: str, old_code: str, new_code: str, named_text: str
) -> None:
    spec = Spec()
    if file == "verifier":
        assert old_code in verifier.text()
        spec.verifier = verifier.text().replace(old_code, new_code)
    elif file == "image":
        spec.image = patch_oracle(file, old_code, new_code)
    elif file == "machine":
        spec.machine = patch_oracle(file, old_code, new_code)
    else:
        spec.machine = patch_oracle("machine", "", "")
        spec.machine.__dict__.update(vars(patch_oracle(file, old_code, new_code)))
    cases = [case for case in machine_cases() if named_text in case.name and not case.needs]

    def answer_request(request: str, max_line_count: int) -> list[str]:
        try:
            return spec.answer(request.splitlines()[:-1])
        except LookupError:  # the machine has crashed
            return []

    assert any(verdict.outcome == DIFFERS for verdict in verdicts(cases, answer_request))


def test_each_instruction_runs() -> None:
    """An instruction without a case would not be tested."""
    opcodes = set()
    for case in machine_cases():
        if case.answer[-1].startswith("REFUSED"):
            continue
        kit = kit_of(case)
        code = load_image(case.image, kit).code
        robot = TracedRobot(kit, Lists(kit, case.readings_by_sensor))
        runs = machine_of(code, robot, len(kit.readings), case.seed)
        for _ in range(10_000):
            status = runs.tick(robot.now_ms, 1)
            opcodes.add([*code, 0][runs.offset])
            robot.now_ms = max(runs.wake_ms, robot.now_ms)
            if status in (DONE, FAULT) or robot.now_ms > case.until_ms:
                break
    assert [op.name for op in OPS if op.opcode[-1] not in opcodes] == []


def kit_of(case: MachineCase) -> Kit:
    devices: dict[str, list[Device]] = {"sensor": [], "actuator": []}
    speeds = {"speed": 0, "turn": 0}
    for line in case.devices:
        device_role, name, *rest = line.split(" ")
        if device_role in speeds:
            speeds[device_role] = int(name)
            continue
        kind, unit, low, high = rest
        devices[device_role].append(Device(name, kind, unit, int(low), int(high)))
    sensors, actuators = (tuple(devices) for devices in devices.values())
    return Kit(sensors, actuators, speeds["speed"], speeds["turn"])


def test_names_are_unique_and_each_refusal_has_a_case() -> None:
    from tiniscript.bytecode.image import REFUSALS
    from tiniscript.bytecode.verify import RULES

    cases = machine_cases()
    assert len({case.name for case in cases}) == len(cases)
    refused_names = {case.answer[-1].split()[1] for case in cases if "REFUSED" in case.answer[-1]}
    assert refused_names == {*REFUSALS, *RULES} - {"CODE_LENGTH"}  # in an image this is BAD_HEADER


# -- machines that are no machines ------------------------------------------------------------

ONE_SHOT = "list(iter(sys.stdin.readline, 'run\\n'))\nprint('0 DONE', flush=True)"


def test_a_machine_that_ends_after_each_answer_is_restarted(tsc: Tsc, tmp_path: Path) -> None:
    rows = find_differences(tsc, machine(tmp_path, ONE_SHOT), "--only", "images: ")
    assert rows
    assert {row["what"] for row in rows} == {"differs"}
    assert "images: no code" not in [row["name"] for row in rows]


HOSTILE = {
    "hang": ("time.sleep(600)", "did not finish its response in 1 s", 3),
    "crash": ("sys.exit('no such opcode')", "exit code 1: no such opcode", 20),
    "flood": ("while True: os.write(1, b'0 SHOW 1\\n' * 999)", "wrote far too much output", 3),
    "more": ("for row in sys.stdin:\n  if row == 'run\\n': os.write(1, b'0 DONE\\n0 DONE\\n')",
             "after the end of its response", 20),
}  # fmt: skip


@pytest.mark.parametrize("behaviour", HOSTILE)
def test_a_hostile_machine_is_named(behaviour: str, tsc: Tsc, tmp_path: Path) -> None:
    source, message, tried = HOSTILE[behaviour]
    command = machine(tmp_path, source)
    timeout_s = "1" if behaviour == "hang" else "100"  # a busy computer starts Python in a second
    result = conform(tsc, command, "--timeout", timeout_s).gives(1, out=message)
    assert result.out.splitlines()[-1].startswith("0 of ")
    assert "too many got no response." in result.out
    rows = find_differences(tsc, command, "--timeout", timeout_s)
    assert [row["what"] for row in rows] == [behaviour] * tried


def test_a_slow_reader_reads_nothing_of_the_next_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A number of a file that is closed is the next pipe's."""
    real_read = os.read

    def read_slowly(number: int, count: int) -> bytes:
        time.sleep(0.1)
        return real_read(number, count)

    monkeypatch.setattr(os, "read", read_slowly)
    process = MachineProcess(machine(tmp_path, HOSTILE["more"][0]), 100)
    for _ in range(3):
        with pytest.raises(Problem) as problem:
            process.ask("run\n", 0)
        assert problem.value.kind == "more"


def test_a_machine_that_has_ended_is_not_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    process = MachineProcess(machine(tmp_path, ONE_SHOT), 100)
    process.ask("run\n", 0)
    until(lambda: not process._reader.is_alive(), "it ends")
    looks = count()
    clock = SimpleNamespace(monotonic=lambda: next(looks))
    monkeypatch.setattr(machine_process, "time", clock)
    process.close()
    assert next(looks) == 1, "only when it began to wait"


def test_a_silent_crash_is_reported_with_its_exit_code(tsc: Tsc, tmp_path: Path) -> None:
    result = conform(tsc, machine(tmp_path, "sys.exit(3)"), "--only", "images: no code")
    assert re.search(r"exit code 3\b(?!:)", result.out)


def test_half_an_answer_is_reported_as_a_crash(tsc: Tsc, tmp_path: Path) -> None:
    source = "sys.stdin.readline()\nos.write(1, b'0 SHOW 1\\n')\nsys.exit('half')"
    conform(tsc, machine(tmp_path, source), "--only", "images: no code", "--timeout", "100").gives(
        1, out=("exit code 1: half", "line 1: 0 SHOW 1")
    )


def test_binary_output_is_shown_safely(tsc: Tsc, tmp_path: Path) -> None:
    source = "os.write(1, bytes(range(256)) + b'\\n\\x1b[2J 0 DONE')"
    result = conform(tsc, machine(tmp_path, source), "--only", "images: whole").gives(1)
    assert "\x1b" not in result.out
    assert "\0" not in result.out


def test_a_machine_that_reads_nothing_does_no_harm(tsc: Tsc, tmp_path: Path) -> None:
    """The longest image is more than a pipe holds."""
    command = machine(tmp_path, "time.sleep(60)")
    result = conform(tsc, command, "--only", "the longest code", "--timeout", "1")
    assert result.code == 1
    assert "did not finish" in result.out


def test_children_of_a_machine_end_with_it(tsc: Tsc, tmp_path: Path) -> None:
    note = tmp_path / "child"
    source = (
        "import subprocess\n"
        "child = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(600)'])\n"
        f"open({str(note)!r} + '.new', 'w').write(str(child.pid))\n"
        f"os.rename({str(note)!r} + '.new', {str(note)!r})\ntime.sleep(600)"
    )
    for timeout_s in ("1", "100"):  # a busy computer may take more than a second to start it
        conform(tsc, machine(tmp_path, source), "--only", "images: whole", "--timeout", timeout_s)
        if note.exists():
            break
    until(partial(has_ended, note.read_text()), "the child has ended")


@pytest.mark.parametrize("command", ["no_such_command", "", "'", "/"])
def test_a_command_that_does_not_start_is_reported(command: str, tsc: Tsc) -> None:
    result = conform(tsc, command).gives(2)
    assert "does not start" in result.err and "Errno" not in result.err
    assert "no arranca" in conform(tsc, command, "--lang", "es").err


def test_a_missing_case_file_names_the_command_that_makes_it(
    tsc: Tsc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kit_files, "FOLDER", tmp_path)
    for words in (("--machine", "x"), ("--port", "P")):
        err = tsc("doctor", "--conform", *words).gives(2).err
        assert f"{sys.executable} -m tools.builds.conformance" in err
        for language in ("es", "pt"):
            assert (
                "tools.builds.conformance"
                in tsc("doctor", "--conform", *words, "--lang", language).err
            )
    conformance.main([str(tmp_path)])
    conform(tsc, SPEC_MACHINE_COMMAND, "--only", "images: no code").gives(0)
    assert conformance.main([str(tmp_path / "nowhere")]) == 1


WITHOUT_PACKAGES_CODE = """
import sys
sys.modules.update(dict.fromkeys(("pytest", "hypothesis", "construct", "wasmtime", "PIL"), None))
from tools.builds import conformance
sys.exit(conformance.main(sys.argv[1:]))
"""


def test_cases_are_reproducible_without_test_packages(
    tmp_path: Path,
) -> None:
    """A release makes them in two clones, with sets in another order in each."""
    subprocess.run(
        [sys.executable, "-c", WITHOUT_PACKAGES_CODE, tmp_path],
        cwd=ROOT, check=True, capture_output=True, env={**os.environ, "PYTHONHASHSEED": "7"},
    )  # fmt: skip
    for name in conformance.FILES:
        assert (tmp_path / name).read_bytes() == (conformance.FOLDER / name).read_bytes()


def test_wrong_use_is_refused(tsc: Tsc) -> None:
    assert "--port" in tsc("doctor", "--conform").err
    assert tsc("doctor", "--conform").code == 2
    assert tsc("doctor", "--conform", "--machine", "x", "--only", "no such case").code == 2
    assert tsc("doctor", "--conform", "--machine", "x", "--timeout", "0").code == 2


# -- the page -----------------------------------------------------------------------------------


def fences() -> Sequence[str]:
    return re.findall(r"^```\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.M | re.S)


def test_the_page_shows_a_real_request_and_its_answer() -> None:
    case = next(case for case in machine_cases() if case.name == "bytecode_spec: Instructions")
    assert case.request() in fences()
    assert "".join(f"{row}\n" for row in case.answer) in fences()


def test_the_page_states_the_number_of_cases(tsc: Tsc) -> None:
    """About: a new case or two leave the page as true as it was."""
    count = len(machine_cases())
    needing = sum(bool(case.needs) for case in machine_cases())
    counts = {
        r"about (\d+) runs": count,
        r"about (\d+) checks": len(all_checks(link_test_suite())),
        r"(\d+) cases with TASK, WHEN, CM or DEG": needing,
        r" of (\d+) cases pass": count - needing,
    }
    text = PAGE.read_text(encoding="utf-8")
    for pattern, true_count in counts.items():
        match = re.search(pattern, text)
        assert match and int(match[1]) == pytest.approx(true_count, rel=0.05), (pattern, true_count)
