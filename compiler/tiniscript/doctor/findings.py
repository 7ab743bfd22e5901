"""The table of causes that the doctor, self-test, module set-up and trim can find.

Knows no sentence: those of a cause, a short name that stays, are in `languages/en/command.toml`,
and of a board that is not ours in `languages/en/foreign.toml`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from tiniscript.link import foreign

OK, OPEN, WRONG = "ok", "open", "wrong"  # OPEN: no fault is sure, and a person may look


class FindingKind(NamedTuple):
    """The meaning of a finding. `part`: the part of the robot that it concerns.

    `next_key` names the sentence with the next step, if that is not of this cause alone.
    """

    verdict: str
    part: str = ""
    next_key: str = ""


def _finding_kinds(
    verdict: str, part: str, causes: str, next_key: str = ""
) -> Iterable[tuple[str, FindingKind]]:
    return ((cause, FindingKind(verdict, part, next_key)) for cause in causes.split())


CAUSES = dict((
    # the computer
    *_finding_kinds(WRONG, "",
        "no_port charging_cable port_missing which_port driver_missing brltty"),
    *_finding_kinds(WRONG, "", "no_bluetooth bluetooth_off not_paired no_rfcomm"),
    # the port
    *_finding_kinds(WRONG, "",
        "no_permission login_again busy modem_manager other_tsc out_of_reach"),
    *_finding_kinds(WRONG, "",
        "other_host slow_port no_serial_port port_broken port_gone not_opened"),
    # Kinds of answers from a port.
    *_finding_kinds(WRONG, "",
        "echo module_set_up module_alone wrong_baud module_baud crossed one_way"),
    *_finding_kinds(WRONG, "", " ".join(foreign.NAMES)),
    *_finding_kinds(WRONG, "", "bootloader_only garbled silent"),
    # The robot, by its own answers.
    *_finding_kinds(WRONG, "", "other_robot unproven"),
    *_finding_kinds(OPEN, "", "of_another_owner stopped"),
    *_finding_kinds(WRONG, "kit", "wrong_kit unknown_kit"),
    *_finding_kinds(WRONG, "firmware", "firmware_older firmware_newer"),
    *_finding_kinds(WRONG, "line", "lossy falls_silent"),
    *_finding_kinds(WRONG, "supply",
        "low_supply brown_out hung restarts motors_restart wifi_rests"),
    *_finding_kinds(OPEN, "store", "not_saved_yet other_program"),
    *_finding_kinds(OK, "", "fine"),
    # each part, where it is looked at whole
    *_finding_kinds(OK, "answers", "is_there"),
    *_finding_kinds(WRONG, "answers", "plain", next_key="doctor"),
     # The robot's own facts, or faults of another part.
    *_finding_kinds(OK, "kit", "kit_is"),
    *_finding_kinds(OK, "firmware", "firmware_is"),
    *_finding_kinds(OK, "line", "line_is"),
    *_finding_kinds(OK, "supply", "supply_is"),
    *_finding_kinds(OK, "store", "saved empty"),
    *_finding_kinds(OPEN, "store", "unsaved", next_key="upload"),
    *_finding_kinds(OK, "trim", "trim_is"),
    *_finding_kinds(OK, "discs", "discs_rest"),
    *_finding_kinds(WRONG, "discs", "discs_noise", next_key="discs"),
    *_finding_kinds(OK, "sensor", "reads changes"),
    *_finding_kinds(OPEN, "sensor", "stuck as_bright", next_key="hand"),
    *_finding_kinds(WRONG, "sensor", "same no_reading echo_hung", next_key="wires"),
    *_finding_kinds(OK, "motor", "turns"),
    *_finding_kinds(WRONG, "motor", "other_turn", next_key="trim"),
    *_finding_kinds(WRONG, "motor", "still", next_key="wires"),
    # The buzzer ends with the same finding.
    *_finding_kinds(WRONG, "motor", "ended", next_key="batteries"),
    *_finding_kinds(OPEN, "motor", "unasked", next_key="person"),
    *_finding_kinds(WRONG, "motors", "same_wheel", next_key="pins"),
    *_finding_kinds(WRONG, "motors", "too_weak", next_key="wheels"),
    *_finding_kinds(WRONG, "motors", "too_uneven", next_key="brake"),
    *_finding_kinds(OK, "buzzer", "heard"),
    *_finding_kinds(WRONG, "buzzer", "unheard", next_key="wires"),
    # a module that is set up, and each of its settings
    *_finding_kinds(WRONG, "module", "module_silent"),
    *_finding_kinds(OK, "setting", "module_done module_done_baud module_done_later"),
    *_finding_kinds(OPEN, "setting", "module_unseen"),
    *_finding_kinds(WRONG, "setting", "module_refused module_lost_midway module_differs"),
    *_finding_kinds(WRONG, "setting", "module_elsewhere module_lost"),
))  # fmt: skip


class Finding(NamedTuple):
    """A cause, whether it is sure or only probable, and the evidence, which fills the sentences.

    `part_name` is the part that it is about, if that is another one than the table says: `left`.
    """

    cause: str
    is_sure: bool
    values: Mapping[str, str] = {}
    part_name: str = ""

    @property
    def verdict(self) -> str:
        return CAUSES[self.cause].verdict

    @property
    def is_wrong(self) -> bool:
        return self.verdict == WRONG

    @property
    def part(self) -> str:
        return self.part_name or CAUSES[self.cause].part


def sure_finding(cause: str, **values: str) -> Finding:
    return Finding(cause, True, values)


def probable_finding(cause: str, **values: str) -> Finding:
    return Finding(cause, False, values)
