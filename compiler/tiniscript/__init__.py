"""TiniScript: from a line of text to what a robot does.

For programs in Python there are `compile`, `check`, `run`, `show`, `connect` and `virtual_robot`:
`docs/en/api.md`. They are in `library/`, and are imported when they are used. The same holds for
`compile_text`, the whole way from text to image: `library/compiling.py`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tiniscript.base.version import __version__ as __version__
    from tiniscript.library.compiling import Compilation as Compilation
    from tiniscript.library.compiling import check_text as check_text
    from tiniscript.library.compiling import compile_text as compile_text
    from tiniscript.library.connection import Receipt, RobotConnection, RobotInfo, connect
    from tiniscript.library.errors import (
        ProgramError,
        RobotError,
        StopNotConfirmed,
        TiniScriptError,
        UsageError,
    )
    from tiniscript.library.events import Ending, RobotEvent
    from tiniscript.library.programs import Message, Program, check, compile, show
    from tiniscript.library.runs import Fault, Trace, TraceEvent, run
    from tiniscript.library.simulated import VirtualRobotConnection, virtual_robot

__all__ = (  # the names that `docs/en/api.md` documents
    "Ending",
    "Fault",
    "Message",
    "Program",
    "ProgramError",
    "Receipt",
    "RobotConnection",
    "RobotError",
    "RobotEvent",
    "RobotInfo",
    "StopNotConfirmed",
    "TiniScriptError",
    "Trace",
    "TraceEvent",
    "UsageError",
    "VirtualRobotConnection",
    "check",
    "compile",
    "connect",
    "run",
    "show",
    "virtual_robot",
)
_HOMES = {
    "library.compiling": ("Compilation", "check_text", "compile_text"),
    "library.connection": ("Receipt", "RobotConnection", "RobotInfo", "connect"),
    "library.events": ("Ending", "RobotEvent"),
    "library.errors": (
        "ProgramError",
        "RobotError",
        "StopNotConfirmed",
        "TiniScriptError",
        "UsageError",
    ),
    "library.programs": ("Message", "Program", "check", "compile", "show"),
    "library.runs": ("Fault", "Trace", "TraceEvent", "run"),
    "library.simulated": ("VirtualRobotConnection", "virtual_robot"),
    "base.version": ("__version__",),
}

if not TYPE_CHECKING:

    def __getattr__(name: str) -> object:
        """Import a name on demand, so that `import tiniscript` imports nothing else."""
        for home, names in _HOMES.items():
            if name in names:
                from importlib import import_module

                result = getattr(import_module(f"tiniscript.{home}"), name)
                globals()[name] = result
                return result
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

    def __dir__() -> list[str]:
        return sorted({*globals(), *__all__})
