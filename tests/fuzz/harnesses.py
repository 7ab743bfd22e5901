"""The harnesses of `vm_arduino/extras/fuzz`, built with libFuzzer, ASan and UBSan, and their first
inputs.

Knows which sources a harness is made of, and which inputs it begins with: made of the cases and
examples, never kept in the repository. `python -m tests.fuzz.harnesses machine 1000000` runs one.
"""

from __future__ import annotations

import argparse
import os
import random
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from tests.machines.host import SOURCES, WARNINGS, build_with
from tests.support.casefile import ROOT
from tests.support.link_cases import link_cases
from tests.support.random_codes import random_codes, random_images
from tiniscript.bytecode.image import pack
from tiniscript.link.frames import decode_frame

COMPILER = "clang++-22"
FLAGS = ("-std=c++11", "-O2", "-g", "-fsanitize=fuzzer,address,undefined",
         "-fno-sanitize-recover=all")  # fmt: skip
# Arguments for comparisons at half the time. Only the machine's harness needs seeds: the others fix
# checksums themselves, and begin with every message and record.
NO_TRACE_CMP_FLAG = "-fno-sanitize-coverage=trace-cmp"
MAX_BYTES = 700  # most bytes of an input
DONE_LINE = re.compile(r"Done (\d+) runs")

VM = ("crc32.cpp", "find_word.cpp", "image.cpp", "verify.cpp", "bytecode.cpp", "decode_form.cpp")
PARTS = {
    "machine": ["src/vm/*.cpp"],
    "link": [*(f"src/vm/{name}" for name in VM), "src/link/*.cpp", "src/text/*.cpp",
             "extras/link/simulated_port.cpp"],
    "large_link": [],
    "store": ["src/vm/crc32.cpp", "src/store/store.cpp", "extras/powercut/contents.cpp",
              "extras/powercut/memory.cpp"],
    "mqtt": ["src/boards/esp32/mqtt.cpp"],
}  # fmt: skip
DEFINES_BY_HARNESS = {"large_link": ("-Dtiniscript_like_esp32",), "mqtt": ("-DARDUINO_ARCH_ESP32",)}
HEADERS = ("src/*.h", "src/boards/esp32/*.h", "src/vm/*.h", "src/link/*.h", "src/text/*.h",
           "src/store/*.h", "extras/fuzz/*.h", "extras/link/*.h",
           "extras/powercut/*.h")  # fmt: skip
PARTS["large_link"] = PARTS["link"]  # the same sources, with the frames and window of an ESP32
NAMES = tuple(PARTS)


@lru_cache(maxsize=1)
def missing() -> str:
    """Return the reason why building is impossible here, or ""."""
    if shutil.which(COMPILER) is None:
        return f"no {COMPILER} on this computer: apt-get install clang-22 libclang-rt-22-dev"
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "empty.cpp"
        source.write_text('extern "C" int LLVMFuzzerTestOneInput(const char*, long) { return 0; }')
        command = [COMPILER, *FLAGS, str(source), "-o", str(source.with_suffix(""))]
        is_built = subprocess.run(command, capture_output=True).returncode == 0
    return "" if is_built else "no libFuzzer for clang-22: apt-get install libclang-rt-22-dev"


def harness(name: str) -> Path:
    """Return the program of a harness."""
    cpp_paths = [SOURCES / "extras" / "fuzz" / f"{name.removeprefix('large_')}.cpp"]
    for pattern in PARTS[name]:
        cpp_paths += sorted(SOURCES.glob(pattern))
    header_paths = [path for pattern in HEADERS for path in sorted(SOURCES.glob(pattern))]
    own_defines = DEFINES_BY_HARNESS.get(name, ()) + (
        () if name == "machine" else (NO_TRACE_CMP_FLAG,)
    )
    return build_with(COMPILER, [*cpp_paths, *header_paths], (*FLAGS, *own_defines, *WARNINGS))


class Found(NamedTuple):
    """The result of a fuzzer's run: the number of inputs, and the error of the last one."""

    runs: int
    wrong: str
    input: bytes


def fuzz(program: Path, folder: Path, runs: int, seed: int) -> Found:
    """Run inputs, first those in `folder`, which grows; stop at the first that is wrong."""
    crash = folder.parent / f"{folder.name}-crash"
    command = [str(program), f"-runs={runs}", f"-seed={seed}", f"-max_len={MAX_BYTES}",
               f"-exact_artifact_path={crash}", "-print_final_stats=0", "-timeout=25",
               str(folder)]  # fmt: skip
    # No stack is kept for each allocation: the place of a wrong access is enough.
    options = {**os.environ, "ASAN_OPTIONS": "malloc_context_size=0"}
    completed = subprocess.run(command, capture_output=True, errors="replace", env=options)
    output = completed.stderr + completed.stdout
    if completed.returncode == 0:
        count = DONE_LINE.search(output)
        assert count, output[-2000:]
        return Found(int(count[1]), "", b"")
    errors = re.findall(r"WRONG .*|MISUSE .*|ERROR: .*|runtime error: .*", output)
    data = crash.read_bytes() if crash.exists() else b""
    return Found(0, "; ".join(errors[:3]) or output[-2000:], data)


# -- the first inputs -----------------------------------------------------------------------------


def seeds(name: str) -> Iterator[bytes]:
    """Yield inputs as `vm_arduino/extras/fuzz` reads them."""
    seed_makers = {"machine": machine_seeds, "link": link_seeds, "store": store_seeds,
            "mqtt": mqtt_seeds}  # fmt: skip
    yield from seed_makers[name.removeprefix("large_")]()


def machine_seeds() -> Iterator[bytes]:
    for code in random_codes(1, 150):
        yield bytes([7, 3, 1]) + pack("SI", 0, code)
    for image in random_images(1, 30):
        yield bytes([7, 3, 0]) + image


def link_seeds() -> Iterator[bytes]:
    """The conversations of the cases: the computer's bytes, with frames unwrapped."""
    for case in link_cases("link"):
        events = b"\0"
        for row in case.rows:
            words = re.match(r"\s*\d+ >x? ((?:[0-9a-f]{2} )*[0-9a-f]{2})\b", row)
            if words is None:
                continue
            data = bytes.fromhex(words[1])
            frame = decode_frame(data.rstrip(b"\0"))
            if frame is not None and frame.number < 0x40:
                events += bytes([frame.number, len(frame.payload)]) + frame.payload
            else:
                for begin in range(0, len(data), 15):
                    piece = data[begin : begin + 15]
                    events += bytes([0x80 + len(piece)]) + piece
            events += bytes([0x40, 50])  # 50 ms
        yield events
    for text in (b"SI|F(2, 80)", b"SB|LOOP(3);F(1,50);END_LOOP", b"S", b"HELP"):
        yield b"\0" + bytes([0xC0 + len(text)]) + text + bytes([0x41, 0, 8])


def store_seeds() -> Iterator[bytes]:
    rng = random.Random(1)
    for count in range(40):
        yield rng.randbytes(2) + b"\xff\0" + rng.randbytes(4 * (count % 12 + 1))
    for path in sorted((ROOT / "examples").glob("*.ts"))[:4]:
        yield rng.randbytes(3) + bytes([1]) + bytes([128, 0, 200]) + path.read_bytes()[:200]


def mqtt_seeds() -> Iterator[bytes]:
    """Messages of the robot's writer, and of a broker."""
    packets = ("20020000", "20020005", "d000", "9003000100", "3101ff", "30ffffffff7f", "3003000561")
    for text in packets:
        data = bytes.fromhex(text)
        yield bytes([0x40 + len(data)]) + data + bytes([0x42]) + b"\xd0\0"
    for topic, payload in ((20, 40), (64, 512), (65, 1), (1, 513), (0, 0)):
        message = bytes([0, topic]) + b"t" * topic + payload.to_bytes(2, "little")
        yield (message + b"p" * payload + b"\0") * 2


def first_inputs(name: str, folder: Path) -> Path:
    """Return a folder in another one, with the inputs that a harness begins with."""
    inputs = folder / name
    inputs.mkdir()
    for number, data in enumerate(seeds(name)):
        (inputs / f"{number:04}").write_bytes(data)
    return inputs


def main() -> int:
    parser = argparse.ArgumentParser(description="Fuzz a part of the robot's C++.")
    parser.add_argument("name", choices=NAMES)
    parser.add_argument("runs", type=int)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    reason = missing()
    if reason:
        print(reason)
        return 2
    with tempfile.TemporaryDirectory() as folder:
        inputs = first_inputs(options.name, Path(folder))
        report = fuzz(harness(options.name), inputs, options.runs, options.seed)
    if report.wrong:
        print(f"{report.wrong}\ninput: {report.input.hex()}")
        return 1
    print(f"{report.runs} runs of {options.name}, nothing wrong; seed {options.seed}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
