"""What a sketch says in words, and what its functions are called: the catalogue `sketch`."""

from __future__ import annotations

import re

from tiniscript.base.languages import found, text

# What has a name of its own in each language.
IDENTIFIERS = [
    "forward",
    "backward",
    "turn_left",
    "turn_right",
    "motors",
    "drive_motor",
    "stop_motors",
    "wait",
    "wait_ms",
    "to_ms",
    "check_button",
    "wait_for_button",
    "halt",
    "finish",
    "begin_all",
    "start_forward",
    "start_backward",
    "start_left",
    "start_right",
    "start_wait",
    "start_move",
    "move_lasts",
    "end_move",
    "beep",
    "show_number",
    "show_yes_no",
    "time",
    "random",
    "rounded",
    "absolute",
    "smaller",
    "larger",
    "limited",
    "whole",
    "Number",
    "thousandths",
    "exactly",
    "in_range",
    "divided",
    "fault",
    "ping_ms",
    "part_of",
    "servo_pulse",
    "begin_servos",
    "started",
    "due",
    "random_state",
    "move_start",
    "move_ms",
    "move_left",
    "move_right",
    "move_drives",
    "move_runs",
    "was_up",
    "last_ping",
    "read",
    "set",
    "LEFT",
    "RIGHT",
    "PWM",
    "FORWARD",
    "BACKWARD",
    "PIN",
    "STANDBY",
    "BUZZER",
    "START_BUTTON",
    "TRIGGER",
    "ECHO",
    "SERVO_PINS",
    "SERVOS",
    "FOREVER",
    "pulse_us",
    "pulses_left",
    "value",
    "counted",
    "own_ping",
]
# Parameters and variables that stand in one helper alone, as its text has them.
LOCALS = [
    "seconds",
    "power",
    "left",
    "right",
    "percent",
    "next",
    "value",
    "isOn",
    "low",
    "high",
    "first",
    "last",
    "other",
    "count",
    "number",
    "way",
    "part",
    "echo",
    "triggerPin",
    "echoPin",
    "pwmPin",
    "forwardPin",
    "backwardPin",
    "stillUs",
    "pulses",
    "turn",
    "used",
    "result",
    "by",
    "size",
    "bySize",
    "isNegative",
    "units",
    "unit",
    "rest",
    "made",
    "half",
    "decimals",
    "places",
    "name",
    "late",
]
_LOCAL = re.compile(rf"(?<![$\w.])({'|'.join(LOCALS)})(?!\w)")


def said(key: str, language: str) -> str:
    """Return a note, or nothing where nothing is said."""
    return found("sketch", f"said/{key}", language) or ""


def called(key: str, language: str) -> str:
    """Return what something is called; other names stay what they are."""
    return found("sketch", f"name/{key}", language) or key


def with_locals(code: str, language: str) -> str:
    """Return a helper whose parameters and own variables are called as in the language."""
    return _LOCAL.sub(lambda match: text("sketch", f"local/{match[1]}", language), code)
