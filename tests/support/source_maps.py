"""Programs with their maps from code to text."""

from __future__ import annotations

from tiniscript import Compilation, compile_text, robots
from tiniscript.library import source_map
from tiniscript.library.source_map import SourceMap

KIT = robots.load("tinibot").kit


def compile_right_text(text: str) -> Compilation:
    compilation = compile_text(text, KIT, "drive.ts")
    assert compilation.is_right, [diagnostic.code.number for diagnostic in compilation.diagnostics]
    return compilation


def make_source_map(compilation: Compilation) -> SourceMap:
    return source_map.map_of_compiled(compilation)
