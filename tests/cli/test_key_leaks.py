"""A key is in its file alone: in no output, no report, no other file, no list of processes."""

from __future__ import annotations

import base64
from pathlib import Path

import pytest

from tests.support.claimed_robots import claim_with_button
from tests.support.command import Command, run_in_process
from tests.support.pty_robot import PtyRobot, on
from tiniscript.link.keys import KeyFile

VERBS = (
    ("doctor", "--ports", "--ask", "--json"), ("doctor", "--count", "1"), ("doctor", "--json"),
    ("upload", "-e", "SI|F(0.1, 80)", "--json"), ("live", "SHOW(1)"),
    ("live", "SHOW(1 / 0 * X)"), ("start", "--json"), ("start", "--previous", "--json"),
    ("set", "name", "TINI"), ("set", "text", "on"), ("doctor", "--identify"),
    ("stop", "--teacher"), ("stop", "--json"), ("doctor", "--selftest", "--yes"),
    ("set", "owner", "--give-up", "--teacher"),
)  # fmt: skip


def forms(secret: bytes) -> list[bytes]:
    """Return the forms of a key without spaces: bytes, hex, base 64, and a list."""
    texts = (secret.hex(), secret.hex().upper(), str(list(secret)), repr(secret))
    forms = [secret, base64.b64encode(secret), *(text.encode() for text in texts)]
    return [b"".join(form.split()) for form in forms]


def has_one(secrets: list[bytes], data: bytes) -> bool:
    return any(secret in b"".join(data.split()) for secret in secrets)


def test_a_key_occurs_only_in_its_file(
    pty_robot: PtyRobot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tiniscript.link.ports.list_ports", list)
    assert claim_with_button(pty_robot).code == 0
    assert claim_with_button(pty_robot, "--teacher").code == 0
    secrets = [form for key in KeyFile().all() for form in forms(key.key)]
    assert len(secrets) == 12 and has_one(secrets, KeyFile().path.read_bytes())
    output = ""
    for verb in (*VERBS, ("doctor", "--report", str(tmp_path / "report.txt"))):
        result = run_in_process(*verb) if "--ports" in verb else on(pty_robot, *verb)
        assert result.code != 2, result.err
        output += result.out + result.err
    with monkeypatch.context() as debugging:
        debugging.setenv("TINISCRIPT_DEBUG", "1")
        result = on(pty_robot, "doctor", "--json")
        output += result.out + result.err
    output += (
        run_in_process("set", "owner", "--list").out
        + run_in_process("set", "owner", "--list", "--json").out
    )
    link = Command("monitor", "--hold", "--port", pty_robot.port)
    link.until("Ctrl-C")
    output += on(pty_robot, "upload", "-e", "SI|F(0.1, 80)").out
    for name in ("cmdline", "environ"):
        path = Path("/proc") / str(link.process.pid) / name
        output += path.read_bytes().decode("latin-1") if path.exists() else ""
    link.process.terminate()
    output += link.wait_for_result().out
    assert "tiniscript" in output
    assert not has_one(secrets, output.encode("latin-1", "replace"))
    files = [path for path in tmp_path.rglob("*") if path.is_file() and path != KeyFile().path]
    assert len(files) > 3
    for path in files:
        assert not has_one(secrets, path.read_bytes()), path
