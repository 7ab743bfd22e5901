"""Programs with their maps from code to text."""

from __future__ import annotations

from tiniscript import Compilation, compile_text, robots
from tiniscript.library import source_map
from tiniscript.library.source_map import SourceMap

KIT = robots.load("tinibot").kit


def compiled(text: str) -> Compilation:
    found = compile_text(text, KIT, "drive.ts")
    assert found.is_right, [diagnostic.code.number for diagnostic in found.diagnostics]
    return found


def mapped(found: Compilation) -> SourceMap:
    return source_map.map_of_compiled(found)
