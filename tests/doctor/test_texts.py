"""Every cause has its sentences, and every sentence its cause."""

from __future__ import annotations

from string import Formatter

from tests.support.rows import each_row
from tests.support.texts import in_all
from tests.support.texts import said as all_said
from tiniscript.cli.commands.doctor import _said
from tiniscript.doctor.findings import CAUSES, PARTS, WRONG, Finding

# The values of each cause that has some; the sentences may use no others.
VALUES = {
    "port_missing": {"ports"}, "which_port": {"ports"}, "driver_missing": {"chip", "driver"},
    "brltty": {"chip"}, "no_rfcomm": {"number"}, "no_permission": {"group"},
    "login_again": {"group"}, "busy": {"by"}, "other_tsc": {"verb", "theirs"},
    "port_broken": {"why"}, "module_set_up": {"baud", "module"}, "module_alone": {"baud", "module"},
    "wrong_baud": {"baud", "expected"}, "module_baud": {"n"}, "other_sketch": {"said"},
    "bootloader_only": {"board"}, "garbled": {"n"}, "firmware_older": {"theirs", "ours"},
    "firmware_newer": {"theirs", "ours"}, "wrong_kit": {"kit", "robot", "expected"},
    "unknown_kit": {"kit"}, "restarts": {"count", "reset"}, "motors_restart": {"count", "reset"},
    "lossy": {"missed", "n", "damaged"}, "other_robot": {"id"}, "unproven": {"id"},
    "fine": {"name", "kit", "id", "n"},
}  # fmt: skip


@each_row("cause", CAUSES)
def test_a_cause_says_what_is_wrong_what_was_seen_and_what_to_do(cause: str) -> None:
    for kind in ("doctor", "seen", "next"):
        for said in in_all(f"{kind}_{cause}"):
            assert said
            gaps = {name for _, name, _, _ in Formatter().parse(said) if name}
            assert gaps <= VALUES.get(cause, set())


def test_no_sentence_is_of_a_cause_that_does_not_exist() -> None:
    known = {f"{kind}_{cause}" for kind in ("seen", "next") for cause in CAUSES}
    known |= {"seen_busy_unknown", "seen_other_sketch_silent"}
    known |= {"seen_restarts_once", "seen_motors_restart_once"}
    known |= {"seen_no_permission_other", "next_no_permission_other"}
    known |= {"seen_no_port_others", "next_no_port_others"}
    named = {key for key in all_said("en") if key.startswith(("seen_", "next_"))}
    assert named == known


def test_each_part_of_a_robot_has_its_causes() -> None:
    """What an examination finds wrong is about one of them, or may be no robot of ours."""
    about = [cause for causes in PARTS.values() for cause in causes]
    assert len(about) == len({*about}) and {*about} <= {*CAUSES}
    first = WRONG.index("firmware_older")
    assert {*WRONG[first:]} - {*about} == {"other_robot", "unproven"}


def test_one_restart_is_said_as_one() -> None:
    """A count of 1 has a sentence of its own: "1 veces" is no Spanish."""
    for cause in ("restarts", "motors_restart"):
        for count, words in (("1", ("once", "una vez")), ("3", ("3 times", "3 veces"))):
            values = {"count": count, "reset": "BROWN_OUT"}
            finding = Finding(cause, True, values)
            for language, word in zip(("en", "es"), words, strict=True):
                assert _said(finding, values, language)[1].startswith(word)
