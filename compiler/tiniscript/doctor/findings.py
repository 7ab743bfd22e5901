"""What the doctor can find: the table of causes. Knows no sentence.

A cause is a short name that stays; its sentences are in `languages/en/command.toml`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

WRONG, NOTE, FINE = "wrong", "note", "fine"

# Each cause: whether something is wrong then. NOTE: it is good to know, and nothing is wrong.
CAUSES: dict[str, str] = {
    # the computer
    "no_port": WRONG,
    "charging_cable": WRONG,
    "port_missing": WRONG,
    "which_port": WRONG,
    "driver_missing": WRONG,
    "brltty": WRONG,
    "no_bluetooth": WRONG,
    "bluetooth_off": WRONG,
    "not_paired": WRONG,
    "no_rfcomm": WRONG,
    # the port
    "no_permission": WRONG,
    "login_again": WRONG,
    "busy": WRONG,
    "modem_manager": WRONG,
    "other_tsc": WRONG,
    "out_of_reach": WRONG,
    "other_host": WRONG,
    "slow_port": WRONG,
    "no_serial_port": WRONG,
    "port_broken": WRONG,
    "port_gone": WRONG,
    "not_opened": WRONG,
    # what answers there
    "echo": WRONG,
    "module_set_up": WRONG,
    "module_alone": WRONG,
    "wrong_baud": WRONG,
    "module_baud": WRONG,
    "crossed": WRONG,
    "other_sketch": WRONG,
    "bootloader_only": WRONG,
    "garbled": WRONG,
    "silent": WRONG,
    # the robot
    "firmware_older": WRONG,
    "firmware_newer": WRONG,
    "wrong_kit": WRONG,
    "unknown_kit": WRONG,
    "restarts": WRONG,
    "motors_restart": WRONG,
    "brown_out": WRONG,
    "hung": WRONG,
    "low_supply": WRONG,
    "wifi_rests": WRONG,
    "lossy": WRONG,
    "falls_silent": WRONG,
    "of_another_owner": NOTE,
    "stopped": NOTE,
    "not_saved_yet": NOTE,
    "other_program": NOTE,
    "fine": FINE,
}


class Finding(NamedTuple):
    """A cause, whether it is sure or only probable, and what was seen: it fills the sentences."""

    cause: str
    is_sure: bool
    values: Mapping[str, str] = {}

    @property
    def is_wrong(self) -> bool:
        return CAUSES[self.cause] == WRONG


def sure(cause: str, **values: str) -> Finding:
    return Finding(cause, True, values)


def probably(cause: str, **values: str) -> Finding:
    return Finding(cause, False, values)
