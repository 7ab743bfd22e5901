"""What the doctor can find: the names of causes. Knows no sentence.

A cause is a short name that stays; its sentences are in `languages/en/command.toml`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

# fmt: off
WRONG = (
    # the computer
    "no_port", "charging_cable", "port_missing", "which_port", "driver_missing", "brltty",
    "no_bluetooth", "bluetooth_off", "not_paired", "no_rfcomm",
    # the port
    "no_permission", "login_again", "busy", "modem_manager", "other_tsc", "out_of_reach",
    "other_host", "slow_port", "no_serial_port", "port_broken", "port_gone", "not_opened",
    # what answers there
    "echo", "module_set_up", "module_alone", "wrong_baud", "module_baud", "crossed",
    "other_sketch", "bootloader_only", "garbled", "silent",
    # the robot
    "firmware_older", "firmware_newer", "wrong_kit", "unknown_kit", "restarts", "motors_restart",
    "brown_out", "hung", "low_supply", "wifi_rests", "lossy", "falls_silent", "other_robot",
    "unproven",
)
# fmt: on
NOTES = ("of_another_owner", "stopped", "not_saved_yet", "other_program")  # nothing is wrong then
# What of a robot a cause is about, for a list of what is good, too.
PARTS = {
    "kit": ("wrong_kit", "unknown_kit"),
    "firmware": ("firmware_older", "firmware_newer"),
    "line": ("lossy", "falls_silent"),
    "supply": ("low_supply", "brown_out", "hung", "restarts", "motors_restart", "wifi_rests"),
    "store": ("not_saved_yet", "other_program"),
}
CAUSES = (*WRONG, *NOTES, "fine")


class Finding(NamedTuple):
    """A cause, whether it is sure or only probable, and what was seen: it fills the sentences."""

    cause: str
    is_sure: bool
    values: Mapping[str, str] = {}

    @property
    def is_wrong(self) -> bool:
        return self.cause not in (*NOTES, "fine")


def sure(cause: str, **values: str) -> Finding:
    return Finding(cause, True, values)


def probably(cause: str, **values: str) -> Finding:
    return Finding(cause, False, values)
