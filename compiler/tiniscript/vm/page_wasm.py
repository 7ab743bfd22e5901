"""WebAssembly in a page: the browser's own, for what `virtual/module.py` has of wasmtime.

Has the names of `wasm_store` and those of wasmtime that are used with it, for Python that runs in
Pyodide. Does not know what is in a module.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, NamedTuple

import js
from pyodide.ffi import create_proxy, to_js

# Functions that take numbers of 64 bits, and which of their numbers: JavaScript has a type of its
# own for those.
_LONG = {"run": (0,)}


class Named(NamedTuple):
    name: str


class Store:
    """What one instance has had from Python; `close` lets go of it."""

    def __init__(self) -> None:
        self.proxies: list[Any] = []

    def close(self) -> None:
        for proxy in self.proxies:
            proxy.destroy()
        self.proxies = []


class Module:
    def __init__(self, data: bytes) -> None:
        self.js = js.WebAssembly.Module.new(to_js(data))
        self.imports = [(each.module, each.name)
                        for each in js.WebAssembly.Module.imports(self.js)]  # fmt: skip
        self.exports = [Named(each.name) for each in js.WebAssembly.Module.exports(self.js)]


class FuncType:
    def __init__(self, takes: Sequence[object], gives: Sequence[object]) -> None:
        assert not takes and not gives, "modules only import functions without numbers"


class Func:
    """A function of Python for a module, or one that a module exports."""

    def __init__(self, store: Store, kind: FuncType | None, function: Any) -> None:
        self.long: tuple[int, ...] = ()
        if kind is None:
            self.js = function
        else:
            self.js = create_proxy(function)
            store.proxies.append(self.js)

    def __call__(self, store: Store, *values: int) -> Any:
        if self.long:
            values = tuple(
                js.BigInt(value) if k in self.long else value for k, value in enumerate(values)
            )
        return self.js(*values)


class Memory:
    """The memory of an instance, which does not grow."""

    def __init__(self, memory: Any) -> None:
        self.js = memory
        self._bytes = js.Uint8Array.new(memory.buffer)

    def write(self, store: Store, data: bytes, start: int) -> None:
        if data:
            self._bytes.subarray(start, start + len(data)).assign(data)

    def read(self, store: Store, start: int, end: int) -> bytes:
        return bytes(self._bytes.subarray(start, end).to_bytes())


class Numbers:
    """A memory as numbers of 32 bits with a sign."""

    def __init__(self, memory: Memory) -> None:
        self._array = js.Int32Array.new(memory.js.buffer)

    def __getitem__(self, place: Any) -> Any:
        if isinstance(place, slice):
            return self._array.subarray(place.start, place.stop).to_py().tolist()
        return self._array[place]

    def __setitem__(self, place: int, value: int) -> None:
        self._array[place] = value

    def release(self) -> None:
        """Nothing is to be given back."""


class Instance:
    def __init__(self, store: Store, module: Module, imports: Sequence[Func]) -> None:
        table: dict[str, dict[str, Any]] = {}
        for (room, name), given in zip(module.imports, imports, strict=True):
            table.setdefault(room, {})[name] = given.js
        given = to_js(table, dict_converter=js.Object.fromEntries)
        self._names = [each.name for each in module.exports]
        self._exports = js.WebAssembly.Instance.new(module.js, given).exports

    def exports(self, store: Store) -> dict[str, Func | Memory]:
        found: dict[str, Func | Memory] = {}
        for name in self._names:
            each = getattr(self._exports, name)
            if hasattr(each, "buffer"):
                found[name] = Memory(each)
            else:
                function = Func(store, None, each)
                function.long = _LONG.get(name, ())
                found[name] = function
        return found


def store() -> Store:
    """Return a store for one instance. The caller closes it."""
    return Store()


@lru_cache(maxsize=8)
def module(path: Path) -> Module:
    return Module(path.read_bytes())


def called(store: Store, function: Func) -> Any:
    """Return a function of a module, to call without its store."""
    return partial(function, store)


def numbers(store: Store, memory: Memory) -> Numbers:
    """Return a memory as numbers of 32 bits with a sign."""
    return Numbers(memory)
