"""States of tasks."""

from __future__ import annotations

# Each has a task that faults when LIGHT_L has more than 500.
STATES = {
    state: f"N = 0;{text};TASK;W(FOREVER) UNTIL(LIGHT_L > 500);SHOW(1 / N);END_TASK"
    for state, text in {
        "the main task moves": "WHEN(FALSE);END_WHEN;F(600, 80)",
        "a task waits": "TASK;W(1.5);F(600, 80);END_TASK",
        "the body of a WHEN moves": "WHEN(TRUE);B(600, 40);END_WHEN;F(600, 80)",
        "a SHOW finds no room": "TASK;LOOP(FOREVER);SHOW(1);SHOW(2);END_LOOP;END_TASK;F(600, 80)",
        "an echo is slow": "WHEN(DISTANCE < 5);S;END_WHEN;F(600, 80)",
    }.items()
}
