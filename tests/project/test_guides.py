"""The guides for teachers are right: their typed lines get the answers that they show.

A fence `console robot` needs one: here it is the firmware on a port, with the name that the guide
used last. The commands of a guide run in their order, on one robot; a program that the guide has
the reader save (`course.ts`, named before its fence) is saved. Every output of `tsc` that a guide
shows must be possible.
"""

from __future__ import annotations

import re
import shlex
import sys
from collections.abc import Iterator
from contextlib import redirect_stderr
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.support.casefile import ROOT
from tests.support.pty_robot import PtyRobot
from tests.support.simulated_port import simulate
from tests.support.texts import catalogue_texts as command_texts
from tiniscript import robots
from tiniscript.cli import main
from tiniscript.link import ports
from tiniscript.link.ports import ListedPort
from tools.site.documents import sources

GUIDE_BY_LANGUAGE = {
    value: ROOT / name for value, name in sources(ROOT, "docs/en/monday.md").items()
}
# The robot's port by cable, then by Bluetooth, and the Windows names.
PORTS = {
    "COM3": "Arduino Uno (COM3)",
    "COM5": "Standard Serial over Bluetooth link (COM5)",
}
PRESS_DELAY_MS = 5000  # time until the button is pressed
LIGHT, DISTANCE = 500_000, 42_000  # thousandths

each_guide = pytest.mark.parametrize(
    ("language", "guide"), GUIDE_BY_LANGUAGE.items(), ids=list(GUIDE_BY_LANGUAGE)
)


class Step(NamedTuple):
    """A command with its output below, or a file (`name`) and its `text`.

    `first` and `last` are the rows of the guide that show something.
    """

    name: str
    words: list[str]
    text: str
    first: int
    last: int


def steps(guide: Path) -> list[Step]:
    step_list: list[Step] = []
    fence, name = "", ""
    for number, row in enumerate(guide.read_text(encoding="utf-8").splitlines()):
        if row.startswith("```"):
            fence = "" if fence else row[3:].strip() or "text"
            if fence == "tiniscript":
                assert name, f"{guide.name}:{number + 1}: what is this program called?"
                step_list.append(Step(name, [], "", number + 1, number + 1))
                name = ""
        elif fence == "console robot" and row.startswith("$ tsc "):
            step_list.append(Step("", shlex.split(row)[2:], "", number + 1, number + 1))
        elif fence in ("console robot", "tiniscript"):
            step_list[-1] = step_list[-1]._replace(
                text=f"{step_list[-1].text}{row}\n", last=number + 1
            )
        elif not fence:
            names = re.findall(r"`(\w+\.ts)`", row)
            name = names[-1] if names else name
    return step_list


def mask_output(text: str) -> str:
    """Return the output of a command without its varying parts."""
    rows = [row.rstrip() for row in text.splitlines()]
    for varies in (
        r"\d+\.\d (?=ms)",
        r"127\.0\.0\.1:\d+",
        r"\d+ cm in \d+\.\d s",
        r"\d+ cm en \d+\.\d s",
    ):
        rows = [re.sub(varies, "…", row) for row in rows]
    return "\n".join(row for row in rows if row)


@pytest.fixture
def pty_robot(monkeypatch: pytest.MonkeyPatch) -> Iterator[PtyRobot]:
    with PtyRobot(robots.load("tinibot").kit, bytes_per_ms=1) as robot:
        robot.ask(lambda robot: robot.set_readings(LIGHT, LIGHT, DISTANCE))
        yield robot


@each_guide
def test_commands_of_a_guide_print_the_shown_output(
    pty_robot: PtyRobot, language: str, guide: Path, capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LC_ALL", f"{language}_MX.UTF-8")
    rows = guide.read_text(encoding="utf-8").splitlines()
    name = "COM3"
    monkeypatch.setattr(ports, "list_ports", lambda: [ListedPort(pty_robot.port, PORTS[name])])
    printed: list[tuple[Step, str]] = []
    for step in steps(guide):
        if step.name:
            Path(step.name).write_text(step.text, encoding="utf-8")
            continue
        name = next((word for word in step.words if word in PORTS), name)
        if step.words == ["set", "owner"]:
            pty_robot.hold(after_ms=PRESS_DELAY_MS, times=3)  # a hand that tries again
        # It uses the robot's time, because a late answer counts as none; a terminal shows both
        # streams in the order of their writing.
        with simulate(pty_robot), redirect_stderr(sys.stdout):
            main([pty_robot.port if word in PORTS else word for word in step.words])
        pty_robot.let_go()
        printed.append((step, capsys.readouterr().out.replace(pty_robot.port, name)))
    assert len(printed) >= 10
    if request.config.getoption("--accept"):
        # It starts from the end, so that earlier rows keep their places.
        for step, current_text in reversed(printed):
            if mask_output(step.text) != mask_output(current_text):
                rows[step.first : step.last] = [row for row in current_text.splitlines() if row]
        guide.write_text("\n".join(rows) + "\n", encoding="utf-8")
        return
    for step, current_text in printed:
        assert mask_output(current_text) == mask_output(step.text), f"{guide.name}:{step.first}"


# -- the guides' claims about tsc


def _sentences(language: str) -> list[str]:
    """Return all that `tsc` says of robots and ports, with `{}` for each gap."""
    texts = list(command_texts(language).values())
    texts += [value for key, value in command_texts(language, "statuses").items() if "/said" in key]
    return [re.sub(r"\{\w+\}", "{}", text) for text in texts]


@each_guide
def test_the_sentences_of_the_table_are_those_of_tsc(language: str, guide: Path) -> None:
    *_, table = guide.read_text(encoding="utf-8").split("\n## ")
    quoted_texts = re.findall(r"^\| `([^`]+)` \|", table, re.M)
    assert len(quoted_texts) >= 5
    for sentence in quoted_texts:
        gaps = re.sub(r"COM\d|/dev/ttyUSB0", "{}", sentence)
        assert any(gaps in sentence for sentence in _sentences(language)), sentence


@each_guide
def test_all_guides_have_the_same_commands_and_headings(language: str, guide: Path) -> None:
    english_steps, own_steps = steps(GUIDE_BY_LANGUAGE["en"]), steps(guide)
    for step, own_step in zip(english_steps, own_steps, strict=True):
        assert step.words[:1] == own_step.words[:1]
        assert bool(step.name) == bool(own_step.name)
    headings = [
        len(re.findall(r"^## ", path.read_text(encoding="utf-8"), re.M))
        for path in (GUIDE_BY_LANGUAGE["en"], guide)
    ]
    assert headings[0] == headings[1]
