"""`tsc robot --listen` and a plain TCP connection, as `nc` has it: a person types lines."""

from __future__ import annotations

import socket
import time
from pathlib import Path

from tests.support.edited_robots import TEXTS
from tests.support.virtual_command import FOREVER, robot, visitor
from tests.support.waiting import HANG_LIMIT_S

SILENT_S = 3  # longer than the second that a robot waits for, whose clock may go slower


def lines_until(client: socket.socket, end: str) -> list[str]:
    """Return the answer up to a line with this end."""
    client.settimeout(HANG_LIMIT_S)
    data = b""
    while not data.endswith(end.encode() + b"\r\n"):
        more = client.recv(1000)
        assert more, data
        data += more
    return data.decode().split("\r\n")[:-1]


def test_lines_are_answered_and_the_robot_drives() -> None:
    with (
        robot("--listen", "0", "--name", "KAT") as running_robot,
        visitor(running_robot.port) as client,
    ):
        client.sendall(b"PING|CHECK_CONNECTION\r\n")
        [hello] = lines_until(client, "text uno")
        assert hello.startswith("// KAT, kit ")
        client.sendall(b"SI|F(0.2,50);SHOW(1.5)\n")
        assert lines_until(client, "DONE") == ["// OK", "// 1.5", "// DONE"]
        assert running_robot.until("DONE")[1:3] == ["0 MOTORS 50 50", "200 MOTORS 0 0"]
        client.sendall(b"SI|FOO(1)\n")
        assert lines_until(client, "word") == ["// 4: Unknown word"]
        for line in FOREVER.replace(";", ";\n").encode().splitlines(keepends=True):
            client.sendall(line)
        client.sendall(b"\n")
        assert lines_until(client, "OK") == ["// OK"]
        client.sendall(b"s\n")
        assert lines_until(client, "STOPPED") == ["// STOPPED"]
        time.sleep(SILENT_S)  # earlier text would be ignored
        client.sendall(b"F(1,50)\n")
        assert lines_until(client, "SI|") == ["// It was stopped. Begin with SI|"]
        client.sendall(b"SI|F(0.1,50)\n")
        assert lines_until(client, "DONE") == ["// OK", "// DONE"]


def test_a_virtual_robot_uses_its_profiles_or_the_commands_language(tmp_path: Path) -> None:
    profile = tmp_path / "mine.toml"
    profile.write_text(TEXTS["tinibot"].replace("[board]\n", '[board]\nlanguage = "en"\n'))
    profile_options: list[str | Path] = ["--robot", profile]
    for words, answers in (([], ["// OK", "// FIN"]), (profile_options, ["// OK", "// DONE"])):
        with (
            robot("--listen", "0", "--lang", "es", *words) as running_robot,
            visitor(running_robot.port) as client,
        ):
            client.sendall(b"SI|F(0.1,50)\n")
            assert lines_until(client, answers[-1][3:]) == answers
