"""Robots that somebody has claimed."""

from __future__ import annotations

import sys
from pathlib import Path
from unittest import mock

import pytest

from tests.support.command import CommandResult
from tests.support.pty_robot import PtyRobot, on
from tiniscript.cli.commands import set_owner
from tiniscript.link.keys import KeyFile


def claim_with_button(pty_robot: PtyRobot, *options: str) -> CommandResult:
    """Claim the robot, with a hand on its button: an earlier press does not count."""

    def print_and_press(words: str, file: object = None, flush: bool = False) -> None:
        print(words, file=sys.stdout if file is None else sys.stderr, flush=flush)
        if file is not None:
            assert "2 s" in words
            pty_robot.hold(after_ms=1000, times=8)

    with mock.patch.object(set_owner, "print", print_and_press, create=True):
        result = on(pty_robot, "set", "owner", *options)
    pty_robot.let_go()
    secrets = [key.key.hex() for key in KeyFile().all()]
    assert not [secret for secret in secrets if secret in result.out + result.err]
    return result


def become_another_computer(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, name: str = "another"
) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / name))
