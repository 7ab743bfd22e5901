"""WebAssembly in a page: the browser's own, for Python that runs in Pyodide, as in `wasm_store`.

Does not know what is in a module.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import js
from pyodide.ffi import create_proxy, to_js


class Instance:
    """A module that runs, from the constructor until `close`."""

    def __init__(self, path: Path, imports: Mapping[str, Callable[[], None]]) -> None:
        module = _load_module(path)
        self._proxies = []
        table: dict[str, dict[str, Any]] = {}
        for descriptor in js.WebAssembly.Module.imports(module):
            proxy = create_proxy(imports[descriptor.name])
            self._proxies.append(proxy)
            table.setdefault(descriptor.module, {})[descriptor.name] = proxy
        import_object = to_js(table, dict_converter=js.Object.fromEntries)
        exports = js.WebAssembly.Instance.new(module, import_object).exports
        names = [export.name for export in js.WebAssembly.Module.exports(module)]
        self.functions = {name: getattr(exports, name) for name in names}
        buffer = self.functions.pop("memory").buffer
        self._bytes = js.Uint8Array.new(buffer)
        self.numbers = MemoryNumbers(buffer)

    def call(self, name: str, *values: Any) -> int:
        if name == "run":  # for 64-bit times, JavaScript has its own integer type
            values = (js.BigInt(values[0]), *values[1:])
        return int(self.functions[name](*values) or 0)

    def write(self, data: bytes, offset: int) -> None:
        if data:
            self._bytes.subarray(offset, offset + len(data)).assign(data)

    def read(self, start: int, end: int) -> bytes:
        return bytes(self._bytes.subarray(start, end).to_bytes())

    def close(self) -> None:
        """Release the references to Python."""
        self.functions = {}
        for proxy in self._proxies:
            proxy.destroy()
        self._proxies = []


class MemoryNumbers:
    """A memory, which does not grow, as numbers of 32 bits with a sign."""

    def __init__(self, buffer: Any) -> None:
        self._array = js.Int32Array.new(buffer)

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return self._array.subarray(index.start, index.stop).to_py().tolist()
        return self._array[index]

    def __setitem__(self, index: int, value: int) -> None:
        self._array[index] = value


@lru_cache(maxsize=8)
def _load_module(path: Path) -> Any:
    return js.WebAssembly.Module.new(to_js(path.read_bytes()))
