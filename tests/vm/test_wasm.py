"""`machine.wasm`: made from the sources that are here, and the same machine as Python's."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Sequence
from functools import cache, partial
from pathlib import Path

import pytest

from tests.machines import Senses
from tests.support.casefile import ROOT
from tests.support.command import Tsc
from tests.support.cpp_checks import check_round, run_late, some_task_programs
from tests.support.imported_modules import modules_imported_by
from tests.support.kits import KITS
from tiniscript import compile_text, robots
from tiniscript.base.kit import Kit
from tiniscript.bytecode.image import Image, ImageRefused, unpack
from tiniscript.bytecode.opcodes import BY_NAME, ISA_MAJOR, ISA_MINOR
from tiniscript.cli.commands import run
from tiniscript.library import install_advice
from tiniscript.vm.machine import Machine
from tiniscript.vm.runner import AnyMachine
from tiniscript.vm.state import DONE, FAULT, WAITING
from tiniscript.vm.tasks import machine_of
from tiniscript.vm.wasm import WasmMachine
from tools.builds import wasm

needs_zig = pytest.mark.skipif(
    bool(wasm.unavailable_reason()), reason=wasm.unavailable_reason() or "there is a compiler"
)
KIT = robots.load("tinibot").kit
SHOWS = [BY_NAME[name].code for name in ("SHOW", "SHOW_YES_NO")]


# -- the module ---------------------------------------------------------------------------------


@needs_zig
def test_the_module_is_built_from_these_sources(tmp_path: Path) -> None:
    """Byte for byte, wherever they are."""
    copy = Path(shutil.copytree(ROOT / "vm_arduino", tmp_path / "some where" / "else"))
    for module in wasm.MODULES:  # the modules may have been built here or elsewhere
        kept_bytes = (ROOT / module.path).read_bytes()
        stale = f"{module.path} is stale. Run: {wasm.COMMAND}"
        assert wasm.build(copy, module) == kept_bytes, stale


@needs_zig
def test_a_changed_machine_gives_a_different_module(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    modules = wasm.MODULES[:1]
    monkeypatch.setattr(wasm, "MODULES", modules)
    for module in modules:
        stale = tmp_path / module.path
        stale.parent.mkdir(parents=True, exist_ok=True)
        stale.write_bytes(b"\0asm")
    copy = Path(shutil.copytree(ROOT / "vm_arduino", tmp_path / "vm_arduino"))
    source = copy / "src" / "vm" / "state.h"
    text = source.read_text(encoding="utf-8")
    source.write_text(text.replace("kLateMs = 20", "kLateMs = 21"), encoding="utf-8")
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    monkeypatch.setattr(wasm, "ROOT", tmp_path)
    built = cache(wasm.build)  # the same each time, as the previous test shows
    monkeypatch.setattr(wasm, "build", built)
    assert wasm.main(["--check"]) == 1
    output = capsys.readouterr().err
    assert output.count("stale. Run: python -m tools.builds.wasm") == len(modules)
    assert wasm.main([]) == 0
    assert wasm.main(["--check"]) == 0
    for module in modules:
        assert (tmp_path / module.path).read_bytes() != (ROOT / module.path).read_bytes()
    built.cache_clear()
    source.write_text("?", encoding="utf-8")
    with pytest.raises(SystemExit, match=r"refuses extras/wasm/main\.cpp"):
        wasm.main([])


def test_another_compiler_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(wasm, "version", lambda name: "0.1.0")
    with pytest.raises(SystemExit, match=r"here is 0\.1\.0\. Run: pip install ziglang=="):
        wasm.main([])


def test_the_module_imports_only_the_robot() -> None:
    """No heap, no system, and no path of the computer that made it."""
    from wasmtime import Engine, Module

    machine = {"motors", "off", "read", "beep", "show", "set"}
    imported_modules = {wasm.MACHINE: machine, wasm.ROBOT: {"look"}, wasm.ROBOT_ESP32: {"look"}}
    for value, names in imported_modules.items():
        data = (ROOT / value.path).read_bytes()
        module = Module(Engine(), data)
        assert {import_type.module for import_type in module.imports} == {"robot"}
        assert {import_type.name for import_type in module.imports} == names
        assert not [word for word in (b".cpp", b"zig", b"clang", b"producers") if word in data]


# -- the command --------------------------------------------------------------------------------


def run_both(tsc: Tsc, *arguments: str) -> tuple[int, str, str]:
    """Assert that both machines print the same and end in the same way; return their trace."""
    python_result = tsc("run", *arguments)
    cpp_result = tsc("run", "--machine", "cpp", *arguments)
    assert (cpp_result.code, cpp_result.out, cpp_result.err) == (
        python_result.code,
        python_result.out,
        python_result.err,
    )
    return cpp_result.code, cpp_result.out, cpp_result.err


def test_a_fault_has_its_line(tsc: Tsc) -> None:
    code, out, err = run_both(tsc, "-e", "F(1, 50)\nA = 0\nSHOW(5 / A)", "--lang", "es")
    assert code == 1
    assert out.endswith("1000 FAULT DIVIDE_BY_ZERO\n")
    assert "SHOW(5 / A)" in err
    assert "3" in err


@pytest.mark.parametrize(
    ("waits", "at_ms"),
    [("W(2147483.647);W(0.001)", 2**31), ("W(2147483.647);W(2147483.647);W(3)", 2**32 + 2998)],
)
def test_an_overflowed_time_stays_overflowed(waits: str, at_ms: int, tsc: Tsc) -> None:
    """A time that is too large for a number stays too large: a clock of 32 bits wraps around."""
    _, out, _ = run_both(tsc, "-e", f"SI|{waits};SHOW(TIME)", "--max-time", "9999999")
    assert out == f"{at_ms} FAULT OVERFLOW\n"


def test_a_missing_wasmtime_is_reported_with_the_next_step(
    tsc: Tsc, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "wasmtime", None)
    for module in ("vm.wasm_store", "vm.wasm"):
        monkeypatch.delitem(sys.modules, f"tiniscript.{module}", raising=False)
    result = tsc("run", "-e", "F(1, 50)", "--machine", "cpp", "--lang", "es")
    assert (result.code, result.out) == (2, "")
    assert install_advice.command("virtual") in result.err
    assert "--machine python" in result.err


def test_python_runs_without_wasmtime() -> None:
    """Optional parts are not loaded."""
    modules = modules_imported_by(
        "from tiniscript.cli import main; assert main(['run', '-e', 'F(1, 50)']) == 0"
    )
    assert "tiniscript.vm.machine" in modules
    assert not {"wasmtime", "tiniscript.vm.wasm"} & modules


WAT = """(module (import "" "look" (func $look)) (export "look" (func $look))
  (memory (export "memory") 1)
  (func (export "sum") (param i64 i32) (result i64)
    (i64.add (local.get 0) (i64.extend_i32_s (local.get 1))))
  (func (export "negative") (param i32) (result i32) (i32.sub (i32.const 0) (local.get 0)))
  (func (export "trap") unreachable))"""


@pytest.mark.parametrize("is_known", [True, False])
def test_functions_are_called_alike_with_and_without_wasmtime_internals(
    is_known: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from wasmtime import Trap, _ffi

    from tiniscript.vm.wasm_store import Instance

    def look() -> None:
        raise KeyError("seen")

    if not is_known:
        monkeypatch.delattr(_ffi, "wasmtime_func_call_unchecked")
    (tmp_path / "module.wat").write_text(WAT, encoding="utf-8")
    instance = Instance(tmp_path / "module.wat", {"look": look})
    calls = instance.functions
    assert isinstance(calls["sum"], partial) != is_known
    assert calls["sum"](1 << 40, -1) == (1 << 40) - 1
    assert calls["negative"](1) == -1 and calls["negative"](-(1 << 31)) == -(1 << 31)
    with pytest.raises(KeyError, match="seen"):
        calls["look"]()
    with pytest.raises(Trap, match="unreachable"):
        calls["trap"]()
    assert calls["sum"](-2, -3) == -5
    instance.close()
    with pytest.raises(ValueError, match="closed"):
        calls["negative"](1)


# -- refusals --------------------------------------------------------------------------------------


def test_refused_images_raise_an_error() -> None:
    from tiniscript.vm.wasm import WasmImage

    good_image = compile_text("SHOW(DISTANCE)", KIT).image
    broken_images = [good_image[:length] for length in range(len(good_image))]
    broken_images += [
        good_image[:k] + bytes([good_image[k] ^ 255]) + good_image[k + 1 :]
        for k in range(len(good_image))
    ]
    broken_images += [good_image + b"?", good_image + bytes(60_000), good_image + bytes(100_000)]
    for data in broken_images:
        with pytest.raises(ImageRefused) as python_result:
            unpack(data)
        with pytest.raises(ImageRefused) as cpp_result:
            WasmImage(data, KIT)
        assert cpp_result.value.name == python_result.value.name
    changed_kit = KIT._replace(sensors=tuple(sensor._replace(unit="x") for sensor in KIT.sensors))
    with pytest.raises(ImageRefused, match="OTHER_KIT"):
        WasmImage(good_image, changed_kit)


def test_differing_verdicts_are_an_internal_error() -> None:
    unverified_image = Image("SI", 0, b"\xff", 0, (ISA_MAJOR, ISA_MINOR))
    with pytest.raises(AssertionError, match="refuses what Python accepts: UNKNOWN_OPCODE"):
        run._cpp_machine(unverified_image, robots.load("tinibot"))


# -- the machine --------------------------------------------------------------------------------


class Slow:
    """A robot that is ready each third time that it is asked."""

    def __init__(self) -> None:
        self.asked = 0
        self.calls: list[object] = []

    def is_ready(self) -> bool:
        self.asked += 1
        return self.asked % 3 == 0

    def motors(self, left: int, right: int) -> None:
        self.calls.append((left, right))

    def off(self) -> None:
        self.calls.append("off")

    def read(self, sensor: int) -> int | None:
        return (sensor % 3 - 1) * 2_147_483_000 if self.is_ready() else None

    def go_ms(self, extent: int, power: int, is_turn: bool) -> int:
        raise AssertionError

    def beep(self, hertz: int, duration_ms: int) -> None:
        self.calls.append(("beep", hertz, duration_ms))

    def show(self, value: int, is_yes_no: bool) -> bool:
        if self.is_ready():
            self.calls.append((value, is_yes_no))
            return True
        return False

    def set(self, actuator: int, value: int) -> None:
        self.calls.append(("set", actuator, value))


PROGRAM = "B(0.3, 80); BEEP(0.2, 440); GRIPPER(90); SHOW(DISTANCE); SHOW(DISTANCE < 0); F(1, 50)"


@pytest.mark.parametrize("begin_ms", [0, 5, 2**31 - 100, 2**32 - 500])
@pytest.mark.parametrize("budget", [1, 3, 100_000])
def test_a_slow_robot_agrees_from_any_start_time(begin_ms: int, budget: int) -> None:
    """Tick by tick the same, where the clock wraps around too."""
    from tiniscript.vm.wasm import WasmImage

    kit = robots.load("grabber").kit
    compilation = compile_text(PROGRAM, kit)
    assert compilation.is_right, compilation.diagnostics
    wasm_image = WasmImage(compilation.image, kit)
    runs = []
    for make in (Machine, wasm_image.machine):
        robot = Slow()
        machine: AnyMachine = make(compilation.code, robot, len(kit.readings), 1, begin_ms)
        now_ms, calls = begin_ms, []
        for _ in range(200):
            status = machine.tick(now_ms, budget)
            calls.append((status, now_ms, machine.wake_ms, machine.steps, machine.offset))
            if status == WAITING:
                machine.tick(machine.wake_ms - 1, budget)  # too early: that has no effect
                now_ms = machine.wake_ms
        runs.append((calls, robot.calls, machine.fault))
    assert runs[0] == runs[1]
    assert runs[0][1][-1] == "off"


def test_a_watched_move_may_last_longer_than_the_clock() -> None:
    from tiniscript.vm.wasm import WasmImage

    def run(image: bytes, kit: Kit, senses: Senses, late_ms: Sequence[int]) -> str:
        return run_late(image, kit, senses, late_ms, WasmImage(image, kit).machine)

    check_round(run)


def test_exceptions_of_a_robot_propagate() -> None:
    from tiniscript.vm.wasm import WasmImage

    class NoMotors(Slow):
        def motors(self, left: int, right: int) -> None:
            raise OSError("no motors")

    compilation = compile_text("F(1, 50)", KITS[0][1])
    machine = WasmImage(compilation.image, KITS[0][1]).machine(compilation.code, NoMotors())
    with pytest.raises(OSError, match="no motors"):
        machine.tick(0, 10)


class Narrow(Slow):
    """Its wire has room for each third value; it notes which SHOW each is of, refused ones too."""

    machine: Machine | WasmMachine

    def __init__(self) -> None:
        super().__init__()
        self.shown: list[tuple[int, bool]] = []

    def read(self, sensor: int) -> int | None:
        return (sensor % 3 - 1) * 2_147_483_000

    def show(self, value: int, is_yes_no: bool) -> bool:
        is_taken = super().show(value, is_yes_no)
        self.shown.append((self.machine.shown_at, is_taken))
        return is_taken


def test_both_machines_report_the_show_of_a_value() -> None:
    """The tasks are random; their values wait while others continue."""
    from tiniscript.vm.wasm import WasmImage

    kit, waited = KITS[0][1], 0
    for image, senses in some_task_programs(0, 60):
        code, traces = unpack(image).code, []
        for make in (machine_of, WasmImage(image, kit).machine):
            robot = Narrow()
            machine = robot.machine = make(code, robot, len(kit.readings), senses.seed)
            now_ms = 0
            while now_ms < senses.max_ms and machine.tick(now_ms, 1000) not in (DONE, FAULT):
                now_ms += 1
            traces.append((robot.calls, robot.shown))
        assert traces[0] == traces[1], image.hex()
        show_rows = traces[0][1]
        assert all(code[offset] in SHOWS for offset, _ in show_rows), image.hex()
        waited += sum(not is_taken for _, is_taken in show_rows)
    assert waited > 100
