"""Random programs that show values in loops and read sensors; how far runs of one are apart.

Their behaviour does not depend on the readings: a reading that changes a millisecond earlier or
later has no other effect.
"""

from __future__ import annotations

import random
from math import inf

SENSORS = ("DISTANCE", "LIGHT_L", "LIGHT_R")
MAX_DEPTH = 2
TimedAction = tuple[float, str]  # time and text of an action


def program(rng: random.Random) -> str:
    """Return a program for tinibot: loops with SHOWs, in one task or several."""
    return "\n".join(["SI|X = 1", _loop(rng, rng.choice(("FOREVER", "20")))])


def _loop(rng: random.Random, count: str) -> str:
    return f"LOOP({count})\n{_body(rng, 0)}\nSHOW({_value(rng)})\nEND_LOOP"


def _body(rng: random.Random, depth: int) -> str:
    return "\n".join(_statement(rng, depth) for _ in range(rng.randint(1, 4)))


def _statement(rng: random.Random, depth: int) -> str:
    time, power = f"{rng.choice((1, 5, 20, 20, 30, 50, 100)) / 1000:g}", rng.randint(30, 100)
    simple = (
        f"SHOW({_value(rng)})", f"SHOW({_value(rng)})", f"SHOW({_check(rng)})", f"W({time})",
        f"F({time}, {power})", f"L({time}, {power})", f"M({power}, -{power})",
        f"X = {_value(rng)}", f"BEEP({time}, 440)", f"F({time}, {power}) UNTIL({_check(rng)})",
    )  # fmt: skip
    if depth == MAX_DEPTH or rng.random() < 0.8:
        return rng.choice(simple)
    if rng.random() < 0.5:
        return f"IF({_check(rng)})\n{_body(rng, depth + 1)}\nENDIF"
    return f"LOOP({rng.randint(1, 4)})\n{_body(rng, depth + 1)}\nEND_LOOP"


def _value(rng: random.Random) -> str:
    return rng.choice((*SENSORS, "X", "TIME", "LIGHT_L - LIGHT_R", f"{rng.randint(1, 9)}"))


def _check(rng: random.Random) -> str:
    return rng.choice((f"{rng.choice(SENSORS)} < 0", f"{rng.choice(SENSORS)} >= 0"))


def largest_difference_ms(actions: list[TimedAction], other_actions: list[TimedAction]) -> float:
    """Return the largest time difference of two runs while both last: `inf` if their actions
    differ.
    """
    action_pairs = list(zip(actions, other_actions, strict=False))
    if any(action[1] != other_action[1] for action, other_action in action_pairs):
        return inf
    return max(
        (abs(action[0] - other_action[0]) for action, other_action in action_pairs), default=0
    )
