"""Sentences about findings: what the robot did, and a suggestion.

Knows every key of `judging`. Does not know when one applies.
"""

from __future__ import annotations

from tiniscript.base.languages import find_text, text
from tiniscript.base.source import printable
from tiniscript.base.words import WORDS
from tiniscript.lessons.findings import Finding
from tiniscript.lessons.forms import TEXT, sentences_in_form

# fmt: off
# of words whose row in the table of words has no example, or one for another robot
EXAMPLES = {
    "UNTIL": "F(FOREVER, 60) UNTIL({question})", "IF": "IF({question}) ... ENDIF",
    "WHILE": "WHILE({question}) ... END_WHILE", "LOOP": "LOOP(3) ... END_LOOP",
    "ELSE": "IF({question}) ... ELSE ... ENDIF", "DEF": "DEF {name} ... END_DEF",
    "WHEN": "WHEN({question}) ... END_WHEN", "TASK": "TASK ... END_TASK",
    "CM": "F(20 CM, 60)", "DEG": "R(90 DEG, 60)",
}
# fmt: on


def sentence(finding: Finding, language: str, form: str = TEXT) -> str:
    """Return the sentence about a finding; for blocks, code is between back quotes."""
    key = finding.key
    if find_text("lessons", f"said/{key}", language) is None:
        key = key.partition("/")[0]
    if key == "order" and finding.values["times"] != "1":
        key = "order_again"
    place = finding.labels[language] if finding.labels else ""
    sensor = finding.values.get("what") or "DISTANCE"
    values = {
        **{name: printable(value) for name, value in finding.values.items()},
        "place": place,
        "show": f"SHOW({sensor})",
        "example": _example(
            finding.values.get("word", ""),
            form,
            question=finding.values.get("question", ""),
            name=text("lessons", "new_word", language),
        ),
        "before": _event(finding, 1, language),
        "then": _event(finding, 2, language),
    }
    sentence_text = sentences_in_form(text("lessons", f"said/{key}", language), form).format(
        **values
    )
    if form == TEXT:
        sentence_text = sentence_text.replace("`", "")
    for pair in text("lessons", "contractions", language).split(", "):
        long_form, _, short_form = pair.partition("=")
        sentence_text = sentence_text.replace(f" {long_form} ", f" {short_form} ")
    return sentence_text


def _event(finding: Finding, number: int, language: str) -> str:
    """Return an event of the key `order/before/then` in words."""
    parts = [*finding.key.split("/"), "", ""]
    return find_text("lessons", f"event/{parts[number]}/{number}", language) or ""


def _example(word: str, form: str, **places: str) -> str:
    if word in EXAMPLES:
        example = EXAMPLES[word].format(**places)
        if form == TEXT:
            return example
        *parts, end_word = example.split(" ... ")  # the last part ends a block
        return "` … `".join(parts or [end_word])
    return WORDS[word].example if word in WORDS else word
