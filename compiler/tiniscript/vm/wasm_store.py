"""WebAssembly in this process: one engine, each module compiled once, a store for each instance.

Knows how much a store may take. Does not know what is in a module. Importing this fails where
`wasmtime` is not installed, or cannot run on this computer.

A store lives until it is closed, and then gives back all that it has. What the module calls must
not keep its owner alive, or nobody would close the store: `wasmtime` holds those functions in a
table of its own. So owners hand in what looks them up weakly.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from wasmtime import Config, Engine, Module, Store

# Of one instance's memory, which does not grow: the modules have three pages and fewer.
MOST_BYTES = 1 << 20
# wasmtime keeps 4 GB of addresses for each memory otherwise: an address space with a limit
# (ulimit -v, a container) has no room for that, and any has only for 16,000 of them.
RESERVED_BYTES, GUARD_BYTES = MOST_BYTES, 1 << 16


def store() -> Store:
    """Return a store for one instance. Who asks for it closes it."""
    made = Store(_engine())
    made.set_limits(memory_size=MOST_BYTES, instances=1, memories=1, tables=1)
    return made


@lru_cache(maxsize=8)
def module(path: Path) -> Module:
    """Compiling it takes a moment: once for each process."""
    return Module(_engine(), path.read_bytes())


@lru_cache(maxsize=1)
def _engine() -> Engine:
    config = Config()
    config.memory_reservation = RESERVED_BYTES
    config.memory_reservation_for_growth = 0
    config.memory_guard_size = GUARD_BYTES
    return Engine(config)
