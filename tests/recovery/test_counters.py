"""A counter of a loop keeps its values: LOOP has no counter, so a variable grows in its body."""

from __future__ import annotations

from itertools import product

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source, apply_edits
from tiniscript.diagnostics.fixing import edits_of
from tiniscript.diagnostics.rendering import message

HEADS = (
    "FOR {v} = {a} TO {b}", "for each {v} from {a} to {b}", "PARA {v} = {a} HASTA {b}",
    "para {v} de {a} ate {b} faca", "desde {v} = {a} hasta {b}", "for {v} in range({a}, {c}):",
    "para cada {v} de {a} a {b}", "for ({v} = {a}; {v} <= {b}; {v}++)",
    "for (int {v} = {a}; {v} < {c}; {v}++)",
)  # fmt: skip
LOOP_ENDS = ("NEXT {v}", "END_LOOP")
NAMES = ("I", "n", "vuelta2")
RANGES = ((1, 5), (0, 3), (2, 4), (1, 10))
BODIES = ("F(1, {v} * 10)", "W(1);SHOW({v});S", "IF({v} > 2);S;ENDIF")
SEPARATORS = ("\n", "\n  ")


def mend(wrong_text: str) -> str:
    """Return a program with all that its messages offer."""
    edits = [edit for diagnostic in check(wrong_text) for edit in edits_of(diagnostic) or []]
    return apply_edits(wrong_text, edits)


@pytest.mark.parametrize("head", HEADS)
@pytest.mark.parametrize("end", LOOP_ENDS)
def test_a_counter_that_is_used_grows_from_its_first_value(head: str, end: str) -> None:
    for name, (first, last), body, separator in product(NAMES, RANGES, BODIES, SEPARATORS):
        values = {"v": name, "a": first, "b": last, "c": last + 1}
        text_before, inside, text_after = (part.format(**values) for part in (head, body, end))
        wrong_text = f"SI|W(3)\n{text_before}{separator}{inside}\n{text_after}\nS"
        loop = f"LOOP({last - first + 1});{name.upper()} = {name.upper()} + 1"
        right_text = f"{name.upper()} = {first - 1};{loop}"
        assert right_text in [
            message(diagnostic, Source(wrong_text), "en").fix for diagnostic in check(wrong_text)
        ], wrong_text
        assert mend(wrong_text) == f"SI|W(3)\n{right_text}{separator}{inside}\nEND_LOOP\nS"
        assert not check(mend(wrong_text))


@pytest.mark.parametrize("text", ["for each {v} from {a} to {b}", "para cada {v} de {a} a {b}"])
@pytest.mark.parametrize("name", NAMES)
def test_an_unused_counter_becomes_a_loop_count(text: str, name: str) -> None:
    for first, last in RANGES:
        wrong_text = f"SI|{text.format(v=name, a=first, b=last)}\nF(1, 60)\nEND_LOOP"
        assert mend(wrong_text) == f"SI|LOOP({last - first + 1})\nF(1, 60)\nEND_LOOP"


@pytest.mark.parametrize(
    "text",
    ["FOR 3 TO 5", "FOR I = 5 TO 1", "FOR I = 1 TO V", "REPEAT 4", "FOR F = 1 TO 3", "I = 1 TO"],
)  # fmt: skip
def test_other_counting_loops_are_left_alone(text: str) -> None:
    fixes = [
        diagnostic.values.get("fix", "") for diagnostic in check(f"SI|{text}\nSHOW(I)\nEND_LOOP")
    ]
    assert not any("+ 1" in line for line in fixes)


STEPS = {
    "FOR I = {a} TO {b} STEP {s}": "NEXT I", "para I de {a} hasta {b} paso {s}": "fin",
    "for i in range({a}, {c}, {s}):": "END_LOOP",
}  # fmt: skip


@pytest.mark.parametrize(("head", "end"), STEPS.items())
def test_a_counter_with_steps_shows_the_same_numbers(head: str, end: str) -> None:
    """A loop is offered only where it counts as the other language does: not with a step of 0."""
    for first, last, step in product((0, 1, 5, 10), (0, 1, 6, 9, 100), (0, 1, 2, 3, 10)):
        wrong_text = f"{head.format(a=first, b=last, c=last + 1, s=step)}\nSHOW(I)\n{end}"
        (diagnostic, *_) = check(wrong_text)
        fix = diagnostic.values.get("fix", "")
        numbers = range(first, last + 1, step) if step else ()
        if not numbers:
            assert "I = I +" not in fix, wrong_text
            continue
        assert fix == f"I = {first - step};LOOP({len(numbers)});I = I + {step}", wrong_text
        sentences = " ".join(map(str, message(diagnostic, Source(wrong_text), "en")))
        assert "leaves out" not in sentences
