"""The sentences of a finding by the doctor, self-test or a module's set-up."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from tiniscript.cli.texts import Sentence, has_text, text
from tiniscript.doctor.findings import CAUSES, Finding
from tiniscript.link import foreign
from tiniscript.link.messages import RESETS


class Sentences(NamedTuple):
    """Sentences about a finding: the finding, its evidence, and the next step; "" if there is none."""

    finding: str
    evidence: str
    advice: str


def sentences_of(
    finding: Finding, language: str, values: Mapping[str, str] | None = None
) -> Sentences:
    """Return the sentences about a finding; `values` replaces its own values."""
    gap_values = dict(finding.values if values is None else values)
    if gap_values.get("reset") in dict(RESETS):
        gap_values["reset"] = text(f"reset_{gap_values['reset']}", language)
    cause, row = finding.cause, CAUSES[finding.cause]
    evidence_key, advice_key = f"seen_{cause}", f"next_{row.next_key or cause}"
    if cause == "busy" and not gap_values["by"]:
        evidence_key = "seen_busy_unknown"
    if gap_values.get("count") == "1" and has_text(f"{evidence_key}_once"):
        evidence_key += "_once"
    if cause == "no_permission" and not gap_values["group"]:
        evidence_key, advice_key = "seen_no_permission_other", "next_no_permission_other"
    if cause in ("no_port", "charging_cable") and gap_values.get("ports"):
        evidence_key, advice_key = "seen_no_port_others", "next_no_port_others"
    if cause in foreign.NAMES:
        meaning, advice = (Sentence(part) for part in foreign.explanation_of(cause, language))
        if cause == foreign.ECHO_SKETCH:
            evidence_key = "seen_echo_sketch"
        elif cause == foreign.OTHER_SKETCH and not gap_values["said"]:
            evidence_key = "seen_other_sketch_silent"
        else:
            evidence_key = "seen_foreign"
        return Sentences(meaning, text(evidence_key, language).format(**gap_values), advice)
    # a part that is looked at whole has no `evidence_key`, and one that is right no next step
    keys = (
        f"found_{cause}",
        evidence_key if has_text(evidence_key) else "",
        advice_key if has_text(advice_key) else "",
    )
    return Sentences(*(text(key, language).format(**gap_values) if key else "" for key in keys))


def as_data(finding: Finding, language: str) -> dict[str, object]:
    """Return a finding as data, for programs and for people."""
    meaning, evidence, advice = sentences_of(finding, language)
    return {
        "cause": finding.cause,
        "is_wrong": finding.is_wrong,
        "is_sure": finding.is_sure,
        "values": dict(finding.values),
        "said": meaning,
        "seen": evidence,
        "next": advice,
    }


def label(finding: Finding, language: str) -> str:
    """Return the name of the part of a robot that a finding is about: `sensor DISTANCE`."""
    return text(f"part_{finding.part}", language).format(**finding.values)


def finding_lines(findings: Iterable[Finding], language: str) -> list[str]:
    """Return the lines about the parts in a conversation: their results, and the next step."""
    lines = []
    for finding in findings:
        meaning, evidence, advice = sentences_of(finding, language)
        mark = text(f"finding_{finding.verdict}", language)
        row = text("finding_row", language)
        lines.append(row.format(mark=mark, what=label(finding, language), said=meaning))
        if evidence:
            lines.append(text("finding_seen", language).format(seen=evidence))
        if advice:
            lines.append(text("finding_next", language).format(then=advice))
    return lines
