"""The machine in C++ as users run it without a compiler: `machine.wasm` in wasmtime."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tests.machines.python import lists_of
from tiniscript.base.kit import Kit
from tiniscript.base.trace import Ending
from tiniscript.bytecode.image import HEADER_BYTES
from tiniscript.vm.runner import run

if TYPE_CHECKING:
    from tests.machines import Senses


def run_wasm(image: bytes, kit: Kit, senses: Senses) -> str:
    """Return the trace of an image, which is read and verified by the C++ machine."""
    from tiniscript.vm.wasm import WasmImage

    wasm_image = WasmImage(image, kit)
    events = run(
        image[HEADER_BYTES:],
        kit,
        lists_of(kit, senses),
        senses.max_ms,
        senses.max_steps,
        senses.seed,
        wasm_image.machine,
    )
    return "".join(f"{event}\n" for event in events if not isinstance(event, Ending))
