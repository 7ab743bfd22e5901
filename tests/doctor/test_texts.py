"""Every cause has its sentences, and every sentence its cause."""

from __future__ import annotations

from collections.abc import Iterator
from string import Formatter

from tests.support.rows import each_row
from tests.support.texts import catalogue_texts as all_said
from tests.support.texts import texts_in_all_languages
from tiniscript.cli.robot.self_test import SELF_REPORTED_PARTS, SIDES
from tiniscript.cli.texts.causes import label, sentences_of
from tiniscript.doctor.findings import CAUSES, OK, Finding
from tiniscript.link import foreign

# The values of each cause that has some; the sentences may use no others.
VALUES = {
    "port_missing": {"ports"},
    "which_port": {"ports"},
    "driver_missing": {"chip", "driver"},
    "brltty": {"chip"},
    "no_rfcomm": {"number"},
    "no_permission": {"group"},
    "login_again": {"group"},
    "busy": {"by"},
    "other_tsc": {"verb", "theirs"},
    "port_broken": {"why"},
    "module_set_up": {"baud", "module"},
    "module_alone": {"baud", "module"},
    "wrong_baud": {"baud", "expected"},
    "module_baud": {"n"},
    "bootloader_only": {"board"},
    "garbled": {"n"},
    "firmware_older": {"theirs", "ours"},
    "firmware_newer": {"theirs", "ours"},
    "wrong_kit": {"kit", "robot", "expected"},
    "unknown_kit": {"kit"},
    "restarts": {"count", "reset"},
    "motors_restart": {"count", "reset"},
    "lossy": {"missed", "n", "damaged"},
    "other_robot": {"id"},
    "unproven": {"id"},
    "fine": {"name", "kit", "id", "n"},
    "plain": {"said"},
    "kit_is": {"robot"},
    "firmware_is": {"isa", "room", "largest", "window"},
    "line_is": {"n", "ms", "least", "most"},
    "supply_is": {"reset"},
    "trim_is": {"trim"},
    "discs_noise": {"left", "right"},
    "reads": {"name", "values"},
    "stuck": {"name", "values"},
    "changes": {"name", "values", "now"},
    "same": {"name", "values", "now"},
    "as_bright": {"name", "values", "now"},
    "no_reading": {"name", "said"},
    "ended": {"said"},
    "too_weak": {"n"},
    "too_uneven": {"n"},
    **{
        f"module_{outcome}": {"name", "said"}
        for outcome in ("refused", "differs", "elsewhere", "lost")
    },
}


# Parts with a single cause need no further symptom; several causes may share a next step.
PART_CAUSES = [
    value for value, row in CAUSES.items() if row.next_key or (row.verdict == OK and row.part)
]


def sentences(cause: str, *kinds: str) -> Iterator[str]:
    for kind in kinds:
        for sentence in texts_in_all_languages(f"{kind}_{cause}"):
            assert sentence
            gaps = {name for _, name, _, _ in Formatter().parse(sentence) if name}
            assert gaps <= VALUES.get(cause, set())
            yield sentence


@each_row("cause", [cause for cause in CAUSES if cause not in (*PART_CAUSES, *foreign.NAMES)])
def test_each_cause_has_a_finding_evidence_and_advice(cause: str) -> None:
    assert len([*sentences(cause, "found", "seen", "next")]) > 3


@each_row("cause", PART_CAUSES)
def test_each_fault_of_a_part_has_advice(cause: str) -> None:
    values = dict.fromkeys(VALUES.get(cause, ()), "7")
    assert [*sentences(cause, "found")]
    for language in ("en", "es", "pt"):
        advice = sentences_of(Finding(cause, True, values), language)
        assert advice.finding and not advice.evidence
        assert bool(advice.advice) == (CAUSES[cause].verdict != OK)


@each_row("cause", foreign.NAMES)
def test_each_foreign_board_has_a_finding_evidence_and_advice(cause: str) -> None:
    for language in ("en", "es", "pt"):
        for heard_text in ("Distance: 34", ""):
            sentences = sentences_of(Finding(cause, True, {"said": heard_text}), language)
            assert all(sentences) and "{" not in "".join(sentences)
            assert heard_text in sentences.evidence or cause == foreign.ECHO_SKETCH
        link = foreign.explain(foreign.ForeignBoard(cause, "a\x1bb", True), language)
        assert "a?b" in link.meaning and link.advice == sentences.advice


def test_every_sentence_about_a_board_has_a_row() -> None:
    names = {key.partition("/")[0] for key in all_said("en", "foreign")}
    assert names == {*foreign.NAMES, "says"}


def test_every_sentence_about_a_cause_has_its_cause() -> None:
    known_names = {f"found_{cause}" for cause in CAUSES}
    known_names |= {f"next_{row.next_key or cause}" for cause, row in CAUSES.items()}
    known_names -= {f"next_{cause}" for cause in PART_CAUSES}
    known_names |= {
        f"next_{CAUSES[cause].next_key}" for cause in PART_CAUSES if CAUSES[cause].next_key
    }
    known_names |= {f"seen_{cause}" for cause in CAUSES if cause not in PART_CAUSES}
    for kind in ("found", "seen", "next"):  # texts about other boards have their own catalogue
        known_names -= {f"{kind}_{cause}" for cause in foreign.NAMES}
    known_names |= {
        "seen_busy_unknown",
        "seen_other_sketch_silent",
        "seen_foreign",
        "seen_echo_sketch",
    }
    known_names |= {"seen_restarts_once", "seen_motors_restart_once"}
    known_names |= {"seen_no_permission_other", "next_no_permission_other"}
    known_names |= {"seen_no_port_others", "next_no_port_others"}
    names = {key for key in all_said("en") if key.startswith(("found_", "seen_", "next_"))}
    assert names == known_names


def test_each_part_has_a_name() -> None:
    parts = {row.part for row in CAUSES.values()} - {"", "motor"} | {*SIDES}
    for language in ("en", "es", "pt"):
        names = {label(Finding("plain", True, {"name": "X"}, part), language) for part in parts}
        assert len(names) == len(parts)
    assert {f"part_{part}" for part in parts} == {
        key for key in all_said("en") if key.startswith("part_")
    }


def test_findings_of_an_examination_concern_parts_or_foreign_devices() -> None:
    names = [*CAUSES]
    about_it = names[names.index("other_robot") : names.index("fine")]
    assert {cause for cause in about_it if not CAUSES[cause].part} == {
        "other_robot", "unproven", "of_another_owner", "stopped",
    }  # fmt: skip
    assert {CAUSES[cause].part for cause in about_it} == {"", *SELF_REPORTED_PARTS}


def test_a_single_restart_takes_the_singular() -> None:
    """A count of 1 has a sentence of its own: "1 veces" is no Spanish."""
    for cause in ("restarts", "motors_restart"):
        for count, words in (("1", ("once", "una vez")), ("3", ("3 times", "3 veces"))):
            values = {"count": count, "reset": "BROWN_OUT"}
            finding = Finding(cause, True, values)
            for language, word in zip(("en", "es"), words, strict=True):
                assert sentences_of(finding, language).evidence.startswith(word)
