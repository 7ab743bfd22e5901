"""The tasks of an ESP32 at once, under ThreadSanitizer: main loop, radios, a broker. No race.

`vm_arduino/extras/esp32/two_cores.cpp` has a thread for each task.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.machines.esp32 import STAND_INS, TLS, flags_of
from tests.machines.host import BUILDS, SOURCES, made

CLANG = "clang++-22"
pytestmark = pytest.mark.skipif(
    shutil.which(CLANG) is None, reason=f"no {CLANG}: apt-get install clang-22 libclang-rt-22-dev"
)
FLAGS = ("-std=gnu++11", "-O1", "-g", "-fsanitize=thread", "-fno-exceptions", "-fno-rtti",
         *flags_of("esp32dev", 2))  # fmt: skip
THREADS = (
    "two_cores.cpp",
    "tasks_at_once.cpp",
    "simulated_chip.cpp",
    "simulated_radio.cpp",
    "simulated_tls.cpp",
)
PIPE = "src/boards/esp32/pipe.h"


def program(sources: Path = SOURCES) -> Path:
    code = [
        *(path for path in sorted((sources / "src").rglob("*.cpp")) if "avr" not in path.parts),
        *(sources / "extras" / "esp32" / name for name in THREADS),
    ]
    headers = [path.read_bytes() for path in sorted((sources / "src").rglob("*.h"))]
    headers += [path.read_bytes() for path in sorted(STAND_INS.rglob("*.h"))]
    objects = []
    BUILDS.mkdir(mode=0o700, exist_ok=True)
    for path in code:
        texts = [*headers, path.name.encode(), path.read_bytes()]
        objects.append(str(made(CLANG, BUILDS, ".o", FLAGS, texts, ["-c", str(path)])))
    return made(CLANG, BUILDS, "", FLAGS, [name.encode() for name in objects], [*objects, *TLS])


def run(sources: Path = SOURCES, seconds: int = 2) -> subprocess.CompletedProcess[str]:
    words = [str(program(sources)), str(seconds)]
    environment = {"TSAN_OPTIONS": "exitcode=66 halt_on_error=1"}
    return subprocess.run(
        words, capture_output=True, text=True, check=False, timeout=120, env=environment
    )


def test_no_two_cores_touch_the_same_at_once() -> None:
    done = run()
    assert done.returncode == 0, (done.stdout + done.stderr)[-4000:]


@pytest.mark.sampled("file", "old", "new", keep=2)
@pytest.mark.parametrize(("file", "old", "new"), [
    (PIPE, "__atomic_store_n(&behind_, behind, __ATOMIC_RELEASE);", "behind_ = behind;"),
    (PIPE, "__atomic_load_n(&behind_, __ATOMIC_ACQUIRE)", "behind_"),
    ("src/boards/esp32/watchdog.cpp", "return __atomic_load_n(&from, __ATOMIC_ACQUIRE);",
     "return from;"),
    ("src/boards/esp32/kept_settings.h",
     "      const CriticalSection critical;\n      *found = now_;", "      *found = now_;"),
    ("src/boards/esp32/broker_settings.cpp", "__atomic_load_n(&state, __ATOMIC_RELAXED)", "state"),
])  # fmt: skip
def test_a_race_is_noticed(file: str, old: str, new: str, tmp_path: Path) -> None:
    """What is published without the order of its bytes."""
    copy = Path(shutil.copytree(SOURCES, tmp_path / "vm", ignore=shutil.ignore_patterns(".pio")))
    text = (copy / file).read_text(encoding="utf-8")
    assert old in text
    (copy / file).write_text(text.replace(old, new), encoding="utf-8")
    for seconds in (2, 10, 40):  # a busy computer rarely runs both at once
        done = run(copy, seconds)
        if done.returncode:
            break
    assert done.returncode == 66 and "data race" in done.stderr, done.stdout
