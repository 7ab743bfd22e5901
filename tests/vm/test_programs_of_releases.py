"""Programs of earlier releases still compile and act the same, except for changes listed as
Breaking.

`programs_of_0_2_0.txt` has the programs of the documents, examples, cases, lessons and pupils of
that version, with the trace that its `tsc run` printed: a row `= robot`, the program, and rows of
the trace after `>`. For a long trace, this has the first rows, the number of rows, and the checksum
of all. A later file has the programs that no earlier one has.

`python -m tests.vm.test_programs_of_releases` writes the file of this version, which a release does
once: afterwards it only grows old.
"""

from __future__ import annotations

import re
import zlib
from collections.abc import Iterator
from contextlib import suppress

import pytest

from tests.support.casefile import ROOT, all_cases, example_robot
from tests.support.released_programs import (
    FIRST_VERSION,
    FOLDER,
    ReleasedProgram,
    file_of_version,
    released_programs,
)
from tiniscript import ProgramError, __version__, check, robots, run
from tiniscript.base.kit import KIT_WORDS_SINCE
from tiniscript.base.words import VERSION_OF_WORD, WORDS
from tiniscript.lessons import catalogue
from tiniscript.library.named_robot import shipped_name_in

READINGS = (50, 9, 300, 20)  # values of each sensor within its range
ROWS = 12  # rows of a trace that are printed


def versions() -> list[str]:
    """Return the versions whose programs are kept, the first one first."""
    names = (path.stem.removeprefix("programs_of_") for path in FOLDER.glob("programs_of_*.txt"))
    return sorted(name.replace("_", ".") for name in names)


def trace_of(old: ReleasedProgram) -> str:
    """Return the trace as the file has it."""
    kit = robots.load(old.robot).kit
    sensors: dict[str, list[float | bool]] = {
        sensor.name: [False, True, False, True] if sensor.is_yes_no
        else [min(max(value, sensor.low / 1000), sensor.high / 1000) for value in READINGS]
        for sensor in kit.sensors
    }  # fmt: skip
    trace = str(run(old.text, old.robot, sensors=sensors, max_time=20, max_steps=100_000))
    rows = trace.splitlines()
    shown_text = "".join(f"> {row}\n" for row in rows[:ROWS])
    return shown_text + f"> ... {len(rows)} rows, {zlib.crc32(trace.encode()):08x}\n" * (
        len(rows) > ROWS
    )


def names_a_newer_word(text: str) -> bool:
    return any(re.search(rf"(?i)\b(?:{word}\s*=|DEF\s+{word})", text) for word in VERSION_OF_WORD)


def programs_of_this_version() -> Iterator[ReleasedProgram]:
    """Yield the programs of documents, examples, cases and lessons: some compile, some do not."""
    for path in sorted((ROOT / "examples").glob("*.ts")):
        yield ReleasedProgram(example_robot(path), path.read_text(encoding="utf-8"), "")
    for case in all_cases():
        named_match = re.search(r"(?m)^robot = (\w+)", case.parts.get("senses", ""))
        yield ReleasedProgram(
            named_match[1] if named_match else "tinibot", case.parts.get("tiniscript", ""), ""
        )
    for folder in catalogue.folders():
        robot = catalogue.load(folder).robot
        for answers in catalogue.answers(folder):
            yield from (ReleasedProgram(robot, answer.program, "") for answer in answers)


def write_release_file() -> str:
    """Return the file of this version."""
    earlier_versions = [version for version in versions() if version != __version__]
    earlier = {old[:2] for version in earlier_versions for old in released_programs(version)}
    parts: dict[tuple[str, str], str] = {}
    for old in programs_of_this_version():
        text = old.text.rstrip("\n") + "\n"
        robot = shipped_name_in(text.encode()) or old.robot
        is_plain = text.strip() and not re.search("(?m)^[=>] ", text)
        if is_plain and (robot, text) not in earlier and robot in robots.names():
            with suppress(ProgramError):
                parts[robot, text] = trace_of(ReleasedProgram(robot, text, ""))
    return "\n".join(f"= {robot}\n{text}{trace}" for (robot, text), trace in parts.items())


@pytest.mark.parametrize("version", versions())
def test_released_programs_still_compile_and_do_the_same(version: str) -> None:
    old_programs = [old for old in released_programs(version) if not names_a_newer_word(old.text)]
    assert len(old_programs) > (300 if version == FIRST_VERSION else 0)
    changed_traces = []
    for old in old_programs:
        try:
            trace = trace_of(old)
        except ProgramError as error:
            trace = str(error)
        if trace != old.trace:
            changed_traces.append((old.text, old.trace, trace))
    assert not changed_traces, f"{len(changed_traces)}, the first: {changed_traces[0]}"


def test_a_newer_word_of_the_kit_gives_way_with_a_warning() -> None:
    """Each of these words is a name in one of them."""
    named_words = set()
    for old in released_programs():
        messages = [message for message in check(old.text, old.robot) if message.code == "TS842"]
        if messages:
            assert all(message.severity == "warning" for message in messages)
            named_words |= {message.message.split()[0] for message in messages}
    assert named_words == KIT_WORDS_SINCE.keys()


def test_use_of_a_newer_word_as_a_name_is_reported_with_its_version() -> None:
    old_programs = [old for old in released_programs() if names_a_newer_word(old.text)]
    assert len(old_programs) >= 5
    for old in old_programs:
        (message,) = check(old.text, old.robot)
        assert (
            message.code == "TS105" and "has been a word of TiniScript since 0.3" in message.message
        )
        word = message.message.split()[0]
        assert message.fix.startswith(f"{word}_1")
        # The rename that the message suggests.
        new = re.sub(rf"(?i)\b{word}\b", f"{word}_1", old.text)
        assert trace_of(old._replace(text=new)) == old.trace


@pytest.mark.parametrize("path", ["CHANGELOG.md", "docs/en/versions.md"])
def test_the_documents_name_the_newer_words(path: str) -> None:
    document = (ROOT / path).read_text(encoding="utf-8")
    breaking = next(part for part in re.split(r"\n(?=- |\n)", document)
                    if "`CM`" in part and "0.3" in part)  # fmt: skip
    assert all(f"`{word}`" in breaking for word in VERSION_OF_WORD)
    assert set(VERSION_OF_WORD) <= set(WORDS)


def test_each_release_has_its_programs() -> None:
    """Every minor release since the first that stored its programs, as listed in CHANGELOG; a patch
    release adds none.
    """
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    released = re.findall(r"(?m)^## (\d+\.\d+\.0) \(", text)
    assert released[released.index(FIRST_VERSION) :: -1] == versions(), (
        "python -m tests.vm.test_programs_of_releases writes those of this version"
    )


if __name__ == "__main__":
    file_of_version(__version__).write_text(write_release_file(), encoding="utf-8")
