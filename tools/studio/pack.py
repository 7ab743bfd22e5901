"""Packs the code of the page: this package, and the part of Python's library that it imports.

`pack.mjs` runs this in Pyodide, whose Python makes the bytecode. Every import of a module is
packed; of Python's own modules, only the imports at import time.
"""

from __future__ import annotations

import ast
import importlib._bootstrap_external as bootstrap
import importlib.util
import re
import sys
import zipfile
from collections.abc import Mapping
from pathlib import Path, PurePosixPath
from types import CodeType

ROOT_MODULE = "tiniscript.studio.worker"
# These are fetched when first needed; parts for few pages are as small as possible.
LESSONS_MODULE = "tiniscript.studio.page_lessons"
TOGETHER_MODULE = "tiniscript.studio.page_together"
# Modules that need parts missing in a browser: ports, a terminal, other programs, files of
# profiles.
LEFT_OUT_MODULES = (
    "tiniscript.cli",
    "tiniscript.doctor",
    "tiniscript.flash",
    "tiniscript.link.modules",
    "tiniscript.link.sharing",
    "tiniscript.robots.reader",
    "tiniscript.robots.wiring",
)
# Imported if there is a port, wasmtime or another system; never in a browser, nor a part of it.
MODULES_NOT_HERE = {"wasmtime", "serial", "bleak", "zeroconf", "platformdirs", "tomli",
            "ctypes", "multiprocessing", "urllib.request", "ssl",
            "asyncio.windows_events", "asyncio.windows_utils",
            "pydoc", "doctest", "unittest", "pdb", "argparse"}  # fmt: skip
DATA_PATTERNS = {
    "languages": ("*/lexicon.txt", "*/sounds.txt"),
    "virtual": ("*.wasm",),
    "virtual/worlds": ("*.toml",),
}
LESSON_DATA_PATTERNS = {"lessons": ("*/lesson.toml", "*/world.toml", "*/pupil.*.md"),
                   "languages": ("*/lessons.texts",)}  # fmt: skip
PRINTED_LINE = re.compile(r"((?:-|[0-9]{1,2}\.) +)?\[print\]")  # a line that is only on paper
INDENT = re.compile(r"^(?: {4})+", re.MULTILINE)
PAGE_SECTIONS = (
    0,
    2,
    3,
)  # sections of a pupil's page that are shown next to the simulator: `page_lessons`
ENCODINGS = ("encodings.latin_1", "encodings.ascii", "encodings.utf_8_sig", "encodings.cp437")
ZIP_TIME = (1980, 1, 1, 0, 0, 0)
Files = dict[str, bytes]


def imports_of(source: bytes, name: str, is_package: bool, includes_functions: bool) -> set[str]:
    """Return the modules that a module names in its imports."""
    tree = ast.parse(source)
    skipped_asts: set[ast.AST] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            skipped_asts |= {inner_node for part in node.body for inner_node in ast.walk(part)}
        elif not includes_functions and isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            skipped_asts |= set(ast.walk(node))
    imports: set[str] = set()
    for node in ast.walk(tree):
        if node in skipped_asts:
            continue
        if isinstance(node, ast.Import):
            imports |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parts = name.split(".") if is_package else name.split(".")[:-1]
                parts = parts[: len(parts) - node.level + 1]
                base = ".".join([*parts, *([base] if base else [])])
            imports.add(base)
            imports |= {f"{base}.{alias.name}" for alias in node.names}
    return imports


class Packer:
    """Finds modules in `folders` and in Python's library, each with all that it imports."""

    def __init__(self, folders: list[Path], library: zipfile.ZipFile) -> None:
        self.folders = folders
        self.library = library
        self.names = set(library.namelist())
        self.own_files: Files = {}
        self.standard_files: Files = {}
        self._seen_modules: set[str] = set()

    def add(self, name: str) -> None:
        """Add a module and what it needs; a list, because this does not recurse."""
        names_left = [name]
        while names_left:
            name = names_left.pop()
            for k in range(1, name.count(".") + 2):
                names_left += self._pack_module(".".join(name.split(".")[:k]))

    def _pack_module(self, name: str) -> list[str]:
        parents = (name.rsplit(".", k)[0] for k in range(name.count(".") + 1))
        if (
            name in self._seen_modules
            or not MODULES_NOT_HERE.isdisjoint(parents)
            or name.startswith(LEFT_OUT_MODULES)
        ):
            return []
        if name.startswith("_py") and f"_{name[3:]}" in sys.builtin_module_names:
            return []  # `_pydatetime`, which replaces a missing `_datetime`
        self._seen_modules.add(name)
        path = name.replace(".", "/")
        for candidate in (f"{path}/__init__.py", f"{path}.py"):
            is_package = candidate.endswith("__init__.py")
            for folder in self.folders:
                if (folder / candidate).is_file():
                    source = (folder / candidate).read_bytes()
                    self.own_files[candidate] = source
                    return sorted(imports_of(source, name, is_package, True))
            if candidate in self.names:
                source = self.library.read(candidate)
                self.standard_files[candidate] = source
                return sorted(imports_of(source, name, is_package, False))
        return []


NO_LINES = 0xF8  # marker of instructions without a line; their number less 1 is added
MAX_ENTRY_UNITS = 8  # the most of one entry


def _without_places(code: CodeType) -> CodeType:
    """Return code without the lines of its source, which are a fifth of it and compress badly, and
    without the qualified names of functions."""
    entries, rest_units = divmod(len(code.co_code) // 2, MAX_ENTRY_UNITS)
    lines = bytes(
        [NO_LINES + MAX_ENTRY_UNITS - 1] * entries + [NO_LINES + rest_units - 1] * (rest_units > 0)
    )
    constants = tuple(_without_places(constant) if isinstance(constant, CodeType) else constant
                      for constant in code.co_consts)  # fmt: skip
    return code.replace(co_linetable=lines, co_consts=constants, co_qualname=code.co_name)


def _without_types(source: bytes) -> ast.Module:
    """Return a module without the types of functions; fields of a class need theirs."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, ast.arg):
            node.annotation = None
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            node.returns = None
    return tree


def compile_module(source: bytes, name: str) -> bytes:
    """Return the bytecode of a module, without docstrings, asserts and types of functions."""
    tree = _without_types(source)
    code = _without_places(compile(tree, name, "exec", dont_inherit=True, optimize=2))
    digest = importlib.util.source_hash(source)
    pyc_data = bootstrap._code_to_hash_pyc(code, digest, False)  # type: ignore[attr-defined]
    return bytes(pyc_data)


def small_source(source: bytes) -> bytes:
    """Return the source of a module that does the same: packed, it is half of its bytecode, and
    Python takes some tenths of a second longer to load it."""
    tree = _without_types(source)
    documented_union_type = ast.Module | ast.ClassDef | ast.FunctionDef
    for node in ast.walk(tree):
        if isinstance(node, documented_union_type) and ast.get_docstring(node):
            node.body = node.body[1:] or [ast.Pass()]
    return INDENT.sub(lambda match: "\t" * (len(match[0]) // 4), ast.unparse(tree)).encode()


def write_archive(path: str, files: Files) -> None:
    """Write an archive, the same bytes for the same files. The server packs, if it does."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as archive:
        for name, data in sorted(files.items()):
            archive.writestr(zipfile.ZipInfo(name, ZIP_TIME), data)


def compile_all(files: Files) -> Files:
    return {
        str(PurePosixPath(name).with_suffix(".pyc")): compile_module(source, name)
        for name, source in files.items()
    }


def text_on_page(page_text: str) -> str:
    """Return the part of a pupil's page that the studio shows, and all its headings."""
    shown_lines: list[str] = []
    section = 0
    for line in page_text.split("\n"):
        is_heading = line.startswith("## ")
        section += is_heading
        if is_heading or (section in PAGE_SECTIONS and not PRINTED_LINE.match(line)):
            shown_lines.append(line)
    return "\n".join(shown_lines)


def data_of(package: str, rows: Mapping[str, tuple[str, ...]]) -> Files:
    """Return the files of folders that match their patterns."""
    return {
        path.relative_to(package).as_posix(): path.read_bytes()
        for folder, patterns in rows.items()
        for pattern in patterns
        for path in (Path(package) / "tiniscript" / folder).glob(pattern)
    }


def pack(start_modules: list[str], package: str, cobs: str, library_path: str, target: str) -> str:
    """Write `python.zip`, `tiniscript.zip`, `lessons.zip` and `together.zip`; return a description
    of the result."""
    library = zipfile.ZipFile(library_path)
    packer = Packer([Path(package), Path(cobs)], library)
    for name in (*start_modules, *ENCODINGS, ROOT_MODULE):
        packer.add(name)
    packed_names = set(packer.own_files)
    write_archive(
        f"{target}/tiniscript.zip",
        {**compile_all(packer.own_files), **data_of(package, DATA_PATTERNS)},
    )
    packer.add(LESSONS_MODULE)  # its archive contains the standard modules that these need
    lesson_sources = {
        name: source for name, source in packer.own_files.items() if name not in packed_names
    }
    packed_names |= set(lesson_sources)
    packer.add(TOGETHER_MODULE)
    together_sources = {
        name: source for name, source in packer.own_files.items() if name not in packed_names
    }
    data = data_of(package, LESSON_DATA_PATTERNS)
    data |= {name: text_on_page(page.decode()).encode() for name, page in data.items()
             if name.endswith(".md")}  # fmt: skip
    write_archive(f"{target}/lessons.zip", {**compile_all(lesson_sources), **data})
    small_files = {name: small_source(source) for name, source in together_sources.items()}
    write_archive(f"{target}/together.zip", small_files)
    write_archive(f"{target}/python.zip", compile_all(packer.standard_files))
    own_count, standard_count = len(packer.own_files), len(packer.standard_files)
    return f"{own_count} modules of tiniscript and cobs, {standard_count} of Python"
