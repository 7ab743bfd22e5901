"""Programs with tasks for errors that the assembly of an Uno could have and others rarely show.

In most of them, the code of tasks is after the first 256 bytes, and ticks come late. Times are
milliseconds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from tests.support.cpp_checks import FAR_JUMP

CLOCK_PERIOD = 2**32  # period of the clock
SOON_MS = 600


class ProgramRuns(NamedTuple):
    """A program, and its runs: every how many asks it is not ready, lateness, begin and end."""

    text: str
    runs: Sequence[tuple[int, int, int, int]]
    readings: Mapping[str, Sequence[int]] = {}


STEPS = "TASK;LOOP(3);W(0.001);SHOW(TIME);W(0.02);SHOW(TIME);END_LOOP;END_TASK"
PROGRAMS = {
    "a check of 256 bytes, and who has the motors": ProgramRuns(
        f"""A = 0;N = 0
B(FOREVER, 30) UNTIL(DISTANCE{" + N" * 130} > 60);SHOW(TIME)
B(0.3, 30) UNTIL(DISTANCE > 90);SHOW(TIME);L(0.2, 20);F(0.1, N - 20)
R(0.021, 20) UNTIL(LIGHT_L > 500)
LOOP(5)
N = N + 1;A = TIME;F(0.3, 50) UNTIL(TIME > A + 0.03)
W(0.008);W(0.1) UNTIL(N > 0);W(0.008);SHOW(TIME)
END_LOOP
WHEN(TIME >= 0.1 AND TIME < 0.13);S;END_WHEN
TASK;F(0, 40);W(0.3);F(0.2, 50) UNTIL(LIGHT_L > 500);SHOW(TIME);END_TASK
TASK;W(0.01);W(FOREVER) UNTIL(N > 5);END_TASK""",
        ((0, 0, 0, 2000), (0, 6, 2**31 - 1, 2000), (0, 36, CLOCK_PERIOD - 100, 2000)),
        {"DISTANCE": [50_000] * 20 + [80_000]},
    ),
    "S ends the M of a lower task, and a fault all": ProgramRuns(
        f"""{FAR_JUMP}F(0.2, 30);SHOW(TIME);A = 0
TASK;W(0.1);S;W(0.02);F(0.02, 50);W(0.1);SHOW(1 / A);END_TASK
TASK;M(20, 20);W(0);W(1);SHOW(TIME);END_TASK
TASK;LOOP(FOREVER);W(0.01);SHOW(TIME);END_LOOP;END_TASK""",
        ((0, 0, 0, SOON_MS),),
    ),
    "a SHOW finds no room": ProgramRuns(
        f"""{FAR_JUMP}TASK;LOOP(9);LIGHT_L;F(0.004, 60);W(0.003);END_LOOP;END_TASK
TASK;LOOP(9);SHOW(TIME);SHOW(TRUE);S;A = LIGHT_L;W(0.004);END_LOOP;END_TASK
LOOP(9);B(0.01, 30) UNTIL(DISTANCE < 15 OR LIGHT_L > 500);SHOW(TIME);END_LOOP""",
        ((2, 0, 0, SOON_MS), (3, 0, 0, SOON_MS)),
        {"DISTANCE": [50_000] * 12 + [12_000]},
    ),
    "the motors are taken while a check waits for a reading": ProgramRuns(
        f"""{FAR_JUMP}TASK;LOOP(9);SHOW(1);F(0.03, 60);END_LOOP;END_TASK
LOOP(9);B(0.03, 30) UNTIL(DISTANCE < 15 OR LIGHT_L > 500);SHOW(TIME);END_LOOP""",
        ((2, 0, 0, SOON_MS),),
        {"DISTANCE": [50_000]},
    ),
    "nobody has the motors any more": ProgramRuns(
        "TASK;M(20, 20);W(0.05);SHOW(0.004);END_TASK;W(1)",
        ((0, 0, 0, SOON_MS),),
    ),
    "a move is taken after its end": ProgramRuns(
        f"""{FAR_JUMP}F(0.09, 30);SHOW(TIME);F(FOREVER, 20)
TASK;W(0.1);B(0.1, 50);SHOW(TIME);END_TASK""",
        ((0, 36, 0, SOON_MS),),
    ),
    "a watched move is longer than a minute": ProgramRuns(
        """N = 0
TASK;W(1);F(1, 40);END_TASK
F(70, 50) UNTIL(N > 0);SHOW(TIME);B(20000, 30);SHOW(TIME)
TASK;W(90);L(3, 40);W(1);R(3, 40);END_TASK""",
        ((0, 254, CLOCK_PERIOD - 80_000, 3_600_000),),
    ),
    "each byte of a time alone is not 0": ProgramRuns(
        """TASK;W(80);L(3, 40);W(150);L(3, 40);END_TASK
W(0.256);SHOW(TIME);W(65.536);SHOW(TIME);R(70, 30);SHOW(TIME)
F(65.546, 50) UNTIL(DISTANCE > 60);SHOW(TIME)
B(16777.226, 30);SHOW(TIME);W(16777.216);SHOW(TIME)
F(16777.226, 30) UNTIL(LIGHT_L > 500);SHOW(TIME)""",
        ((0, 3000, 0, 34_000_000),),
        {"DISTANCE": [50_000] * 20 + [80_000], "LIGHT_L": [0, 0, 600_000]},
    ),
    "so late, and each byte of it": ProgramRuns(
        f"{STEPS};F(FOREVER, 50) UNTIL(DISTANCE > 60)",
        ((0, 20, 0, SOON_MS), (0, 21, 0, SOON_MS), (0, 0x11B, 0, 6000), (0, 0x1001B, 0, 1_500_000)),
        {"DISTANCE": [50_000]},
    ),
    "hours late": ProgramRuns(f"{STEPS};B(30, 50)", ((0, 0x1000005, 2**31, 10**8),)),
}
