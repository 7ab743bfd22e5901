"""The tasks of an ESP32 at once, under ThreadSanitizer: main loop, radios, a broker. No race.

`vm_arduino/extras/esp32/two_cores.cpp` has a thread for each task.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.machines.esp32 import STAND_INS_FOLDER, TLS, flags_of
from tests.machines.host import BUILD_CACHE, SOURCES, compile_once

CLANG = "clang++-22"
pytestmark = pytest.mark.skipif(
    shutil.which(CLANG) is None, reason=f"no {CLANG}: apt-get install clang-22 libclang-rt-22-dev"
)
FLAGS = ("-std=gnu++11", "-O1", "-g1", "-fsanitize=thread", "-fno-exceptions", "-fno-rtti",
         *flags_of("esp32dev", 2))  # fmt: skip
THREADS = (
    "two_cores.cpp",
    "tasks_at_once.cpp",
    "simulated_chip.cpp",
    "simulated_radio.cpp",
    "simulated_tls.cpp",
)


def program(sources: Path = SOURCES) -> Path:
    cpp_paths = [
        *(path for path in sorted((sources / "src").rglob("*.cpp")) if "avr" not in path.parts),
        *(sources / "extras" / "esp32" / name for name in THREADS),
    ]
    headers = [path.read_bytes() for path in sorted((sources / "src").rglob("*.h"))]
    headers += [path.read_bytes() for path in sorted(STAND_INS_FOLDER.rglob("*.h"))]
    objects = []
    for path in cpp_paths:
        texts = [*headers, path.name.encode(), path.read_bytes()]
        objects.append(str(compile_once(CLANG, BUILD_CACHE, ".o", FLAGS, texts, ["-c", str(path)])))
    return compile_once(
        CLANG, BUILD_CACHE, "", FLAGS, [name.encode() for name in objects], [*objects, *TLS]
    )


def run(sources: Path = SOURCES, seconds: int = 2) -> subprocess.CompletedProcess[str]:
    words = [str(program(sources)), str(seconds)]
    environment = {"TSAN_OPTIONS": "exitcode=66 halt_on_error=1"}
    return subprocess.run(
        words, capture_output=True, text=True, check=False, timeout=120, env=environment
    )


@pytest.mark.long
def test_two_cores_never_access_the_same_data_at_once() -> None:
    completed = run()
    assert completed.returncode == 0, (completed.stdout + completed.stderr)[-4000:]
