"""Makes "TiniScript", a library for PlatformIO's registry and the Arduino Library Manager.

    python -m tools.builds.library FOLDER

takes the machine, the link and their dependencies from `vm_arduino/src`, and the code for sketches
from `vm_arduino/extras/library`, and compiles the images of the examples. `pyproject.toml` or --url
names the location of its sources. `pio pkg pack FOLDER` checks it, and makes the upload from it.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
from pathlib import Path

from tiniscript import __version__, compile_text, robots
from tiniscript.base.kit import NUMBER, YES_NO, Device, Kit
from tools import ROOT
from tools.release.facts import AUTHORS, address

SOURCES = ROOT / "vm_arduino" / "src"
LIBRARY_SOURCES = ROOT / "vm_arduino" / "extras" / "library"
MODULES = ("vm", "link", "text")  # the link has the reader of text, which gets no memory here
SENTENCE = "The machine of TiniScript, a small language for cheap robots."
PARAGRAPH = (
    "With the motors and sensors of your own sketch, it runs images made by tsc compile, each "
    "verified before it runs. It uses no heap and never waits. With the link, tsc sends programs."
)
ARCHITECTURES = ("avr", "esp32", "esp8266")
PLATFORMS = ("atmelavr", "espressif32", "espressif8266")
KEYWORDS = ("education", "robotics", "bytecode", "interpreter", "robot")

HEAT_KIT = Kit((Device("HEAT", NUMBER, "%", 0, 100_000),), (Device("LAMP", YES_NO, "", 0, 1),))
# The programs of the examples, and their kits.
PROGRAMS = {
    "ImageInFlash": ("F(1, 80); R(0.5, 60)", robots.load("tinibot").kit),
    "OwnSensor": ("LOOP(FOREVER); SHOW(HEAT); LAMP(HEAT > 30); W(1); END_LOOP", HEAT_KIT),
}


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Make the library for Arduino and PlatformIO.")
    parser.add_argument("folder", type=Path, help="a new folder, or one that this has made")
    parser.add_argument("--url", default=address(ROOT), help="where its sources are, https://…")
    options = parser.parse_args(arguments)
    folder: Path = options.folder
    if folder.exists() and not is_ours(folder):
        print(f"{folder} is there, and is no library of TiniScript. Name another.", file=sys.stderr)
        return 2
    if not options.url:
        print("pyproject.toml has no address. Say it:  --url https://…", file=sys.stderr)
        return 2
    make(folder, options.url)
    print(f"TiniScript {__version__} is in {folder}. Pack it:  pio pkg pack {folder}")
    return 0


def is_ours(folder: Path) -> bool:
    """Return whether a folder is empty, or a library that was made here."""
    if not folder.is_dir():
        return False
    properties_path = folder / "library.properties"
    has_name = properties_path.is_file() and properties_path.read_text("utf-8").startswith(
        "name=TiniScript\n"
    )
    return has_name or not any(folder.iterdir())


def make(folder: Path, url: str) -> None:
    """Write the library into a folder; earlier content is removed."""
    if folder.exists():
        shutil.rmtree(folder)
    source = folder / "src"
    shutil.copytree(LIBRARY_SOURCES / "src", source)
    for module in MODULES:
        shutil.copytree(SOURCES / module, source / module)
    shutil.copyfile(SOURCES / "robot.h", source / "robot.h")
    for path in sorted((LIBRARY_SOURCES / "examples").rglob("*.ino")):
        target = folder / "examples" / path.parent.name / path.name
        target.parent.mkdir(parents=True)
        target.write_text(with_image(path), encoding="utf-8")
    for name in ("keywords.txt", "README.md"):
        shutil.copyfile(LIBRARY_SOURCES / name, folder / name)
    shutil.copyfile(ROOT / "LICENSE", folder / "LICENSE")
    (folder / "library.properties").write_text(properties(url), encoding="utf-8")
    (folder / "library.json").write_text(manifest(url), encoding="utf-8")


def with_image(example: Path) -> str:
    """Return an example with its program's image, as bytes of C."""
    text = example.read_text(encoding="utf-8")
    if "@IMAGE@" not in text:
        return text
    program, kit = PROGRAMS[example.stem]
    image = compile_text(program, kit).image
    rows = [image[k : k + 12] for k in range(0, len(image), 12)]
    lines = ",\n    ".join(", ".join(f"0x{byte:02x}" for byte in row) for row in rows)
    return text.replace("{@IMAGE@}", f"{{\n    {lines}}}")


def properties(url: str) -> str:
    """Return `library.properties`, for the Arduino Library Manager."""
    fields = {
        "name": "TiniScript",
        "version": __version__,
        "author": AUTHORS,
        "maintainer": AUTHORS,
        "sentence": SENTENCE,
        "paragraph": PARAGRAPH,
        "category": "Device Control",
        "url": url,
        "architectures": ",".join(ARCHITECTURES),
        "includes": "TiniScript.h",
        "license": "MIT",
    }
    return "".join(f"{name}={value}\n" for name, value in fields.items())


def manifest(url: str) -> str:
    """Return `library.json`, for PlatformIO."""
    fields = {
        "name": "TiniScript",
        "version": __version__,
        "description": f"{SENTENCE} {PARAGRAPH}",
        "keywords": list(KEYWORDS),
        "repository": {"type": "git", "url": url},
        "homepage": url,
        "authors": [{"name": AUTHORS, "maintainer": True}],
        "license": "MIT",
        "frameworks": ["arduino"],
        "platforms": list(PLATFORMS),
        "headers": ["TiniScript.h", "TiniScriptLink.h", "TiniMotor.h"],
    }
    return json.dumps(fields, indent=2) + "\n"


if __name__ == "__main__":
    sys.exit(main())
