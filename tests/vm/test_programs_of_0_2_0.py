"""What 0.2.0 compiled compiles still, and a robot does the same, but for what Breaking names.

`programs_of_0_2_0.txt` has the programs of the documents, examples, cases, lessons and pupils of
that version, with the trace that its `tsc run` printed: a row `= robot`, the program, and rows of
the trace after `>`. Of a long one the first rows, how many there are, and the checksum of all.
"""

from __future__ import annotations

import re
import zlib
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.support.casefile import ROOT
from tiniscript import ProgramError, check, robots, run
from tiniscript.base.kit import KIT_WORDS_SINCE
from tiniscript.base.words import SINCE, WORDS

FILE = Path(__file__).with_name("programs_of_0_2_0.txt")
READINGS = (50, 9, 300, 20)  # of each sensor, as far as it reaches
ROWS = 12  # of a trace that are written out


class Old(NamedTuple):
    robot: str
    text: str
    said: str


def programs() -> list[Old]:
    parts = re.findall(r"(?m)^= (\w+)\n((?:.*\n)*?)((?:> .*\n)*)(?:\n|\Z)(?=\Z|= )",
                       FILE.read_text(encoding="utf-8"))  # fmt: skip
    return [Old(robot, text, said) for robot, text, said in parts]


def trace_of(old: Old) -> str:
    """Return the trace as the file has it."""
    kit = robots.load(old.robot).kit
    sensors: dict[str, list[float | bool]] = {
        sensor.name: [False, True, False, True] if sensor.is_yes_no
        else [min(max(value, sensor.low / 1000), sensor.high / 1000) for value in READINGS]
        for sensor in kit.sensors
    }  # fmt: skip
    trace = str(run(old.text, old.robot, sensors=sensors, max_time=20, max_steps=100_000))
    rows = trace.splitlines()
    said = "".join(f"> {row}\n" for row in rows[:ROWS])
    return said + f"> ... {len(rows)} rows, {zlib.crc32(trace.encode()):08x}\n" * (len(rows) > ROWS)


def names_a_newer_word(text: str) -> bool:
    return any(re.search(rf"(?i)\b(?:{word}\s*=|DEF\s+{word})", text) for word in SINCE)


def test_they_compile_still_and_do_the_same() -> None:
    olds = [old for old in programs() if not names_a_newer_word(old.text)]
    assert len(olds) > 300
    changed = []
    for old in olds:
        try:
            found = trace_of(old)
        except ProgramError as error:
            found = str(error)
        if found != old.said:
            changed.append((old.text, old.said, found))
    assert not changed, f"{len(changed)}, the first: {changed[0]}"


def test_a_newer_word_of_the_kit_gives_way_and_a_warning_says_so() -> None:
    """Each of these words is a name in one of them."""
    named = set()
    for old in programs():
        messages = [message for message in check(old.text, old.robot) if message.code == "TS842"]
        if messages:
            assert all(message.severity == "warning" for message in messages)
            named |= {message.message.split()[0] for message in messages}
    assert named == KIT_WORDS_SINCE.keys()


def test_of_those_with_a_newer_word_as_a_name_it_is_told_since_when() -> None:
    olds = [old for old in programs() if names_a_newer_word(old.text)]
    assert len(olds) >= 5
    for old in olds:
        (message,) = check(old.text, old.robot)
        assert message.code == "TS105" and "is a word of TiniScript since 0.3" in message.message
        word = message.message.split()[0]
        assert message.fix.startswith(f"MY_{word}")
        new = re.sub(rf"(?i)\b{word}\b", f"MY_{word}", old.text)  # as it says
        assert trace_of(old._replace(text=new)) == old.said


@pytest.mark.parametrize("path", ["CHANGELOG.md", "docs/en/versions.md"])
def test_the_documents_name_the_newer_words(path: str) -> None:
    said = (ROOT / path).read_text(encoding="utf-8")
    breaking = next(part for part in re.split(r"\n(?=- |\n)", said)
                    if "`CM`" in part and "0.3" in part)  # fmt: skip
    assert all(f"`{word}`" in breaking for word in SINCE)
    assert set(SINCE) <= set(WORDS)
