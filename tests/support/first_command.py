"""The first command, `tools/try.py`, and which of its streams are terminals."""

from __future__ import annotations

import sys
from importlib.util import module_from_spec, spec_from_file_location
from types import ModuleType

import pytest

from tests.support.casefile import ROOT


def load_first_command() -> ModuleType:
    """Return `tools/try.py`, whose name no `import` can have."""
    spec = spec_from_file_location("first_command", ROOT / "tools" / "try.py")
    assert spec and spec.loader
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def set_terminals(monkeypatch: pytest.MonkeyPatch, *names: str) -> None:
    for name in ("stdin", "stdout", "stderr"):
        monkeypatch.setattr(getattr(sys, name), "isatty", lambda name=name: name in names)
