"""WebAssembly in this process: one engine, each module compiled once, a store for each instance.

`page_wasm` has the same for Python in a page.

Knows how much a store may take. Does not know what is in a module. Importing this fails where
`wasmtime` is not installed, or cannot run on this computer.

A store keeps its memory until it is closed. The functions that a module imports must not keep
their owner alive, or the store would never be closed: `wasmtime` holds these functions in a table
of its own. So owners pass functions with weak references.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from ctypes import POINTER, addressof, byref, c_ubyte
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import wasmtime
from wasmtime import Config, Engine, Func, FuncType, Memory, Module, Store, ValType, WasmtimeError

# Memory of one instance. It does not grow: the modules have at most three pages.
MAX_BYTES = 1 << 20
# wasmtime keeps 4 GB of addresses for each memory otherwise: an address space with a limit
# (ulimit -v, a container) has no room for that, and any has only for 16,000 of them.
RESERVED_BYTES, GUARD_BYTES = MAX_BYTES, 1 << 16


class Instance:
    """A module that runs, from the constructor until `close`, which frees its memory.

    `functions` are those that it exports, `numbers` is its memory as numbers of 32 bits with a
    sign. Reading one there takes a fiftieth of the time of passing one in a call.
    """

    def __init__(self, path: Path, imports: Mapping[str, Callable[[], None]]) -> None:
        """`imports` are what the module imports, by name: functions without numbers."""
        self._store = Store(_engine())
        self._store.set_limits(memory_size=MAX_BYTES, instances=1, memories=1, tables=1)
        module = _module(path)
        imported_functions = [Func(self._store, FuncType([], []), imports[import_type.name or ""])
                 for import_type in module.imports]  # fmt: skip
        exports = wasmtime.Instance(self._store, module, imported_functions).exports(self._store)
        export_by_name = {export.name: exports[export.name] for export in module.exports}
        self.functions = {
            name: _bound_function(self._store, func)
            for name, func in export_by_name.items()
            if isinstance(func, Func)
        }
        memory = export_by_name["memory"]
        assert isinstance(memory, Memory)
        self._memory = memory
        base = addressof(memory.data_ptr(self._store).contents)
        data = (c_ubyte * memory.data_len(self._store)).from_address(base)
        self.numbers = memoryview(data).cast("B").cast("i")

    def call(self, name: str, *values: int) -> int:
        return int(self.functions[name](*values) or 0)

    def write(self, data: bytes, offset: int) -> None:
        self._memory.write(self._store, data, offset)

    def read(self, start: int, end: int) -> bytes:
        return bytes(self._memory.read(self._store, start, end))

    def close(self) -> None:
        self.functions = {}
        self.numbers.release()  # the memory is about to be freed
        self._store.close()


@lru_cache(maxsize=8)
def _module(path: Path) -> Module:
    """Compiling it takes a moment: once for each process."""
    return Module(_engine(), path.read_bytes())


def _bound_function(store: Store, function: Func) -> Callable[..., Any]:
    """Return a function of a module, of whole numbers, to call without its store.

    `wasmtime` looks at the types of all numbers at each call, which takes ten times as long as the
    call itself. If its internals differ, it is called in its own way.
    """
    try:
        from wasmtime import _ffi as ffi
        from wasmtime._func import enter_wasm

        function_type = function.type(store)
        parameter_count, result_types = len(function_type.params), function_type.results
        raw_values = (ffi.wasmtime_val_raw_t * max(parameter_count, 1))()
        unchecked_call, raw_function, trap_type = (
            ffi.wasmtime_func_call_unchecked,
            function._func,
            ffi.wasm_trap_t,
        )
    except (ImportError, AttributeError):
        return partial(function, store)
    numbers = memoryview(raw_values).cast("B").cast("q")
    stride = len(numbers) // len(raw_values)
    result_numbers = numbers if result_types == [ValType.i64()] else numbers.cast("B").cast("i")

    def call(*values: int) -> int | None:
        assert len(values) == parameter_count, values
        for k, value in enumerate(values):
            numbers[k * stride] = value
        trap = POINTER(trap_type)()
        error = unchecked_call(
            store._context(), byref(raw_function), raw_values, len(raw_values), byref(trap)
        )
        if error or trap:
            # An exception raised in a Python callback comes first.
            with enter_wasm(store) as error_holder:
                if error:
                    raise WasmtimeError._from_ptr(error)
                error_holder._obj.contents = trap.contents
        return result_numbers[0] if result_types else None

    return call


@lru_cache(maxsize=1)
def _engine() -> Engine:
    config = Config()
    config.memory_reservation = RESERVED_BYTES
    config.memory_reservation_for_growth = 0
    config.memory_guard_size = GUARD_BYTES
    # Each access is checked. Protection against speculative reads (Spectre) is off: this process
    # has no secrets that need it, and it costs a quarter of the machine's time.
    if hasattr(config, "cranelift_flag_set"):  # older ones do not have it
        config.cranelift_flag_set("enable_heap_access_spectre_mitigation", "false")
    return Engine(config)
