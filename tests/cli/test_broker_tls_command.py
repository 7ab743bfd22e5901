"""`tsc set wifi --broker --tls`: a robot with an ESP32 at Mosquitto with certificates."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.machines.esp32 import HAS_TLS
from tests.support.certificates import Authority, der
from tests.support.claimed_robots import claim_with_button
from tests.support.command import run_in_process, run_subprocess
from tests.support.esp32_near import NETWORK, PASSWORD, put_network_in_reach
from tests.support.esp32_pty_robot import Esp32PtyRobot
from tests.support.mosquitto import Mosquitto
from tests.support.pty_robot import on
from tiniscript.link.messages import WIFI_STATES

pytestmark = pytest.mark.skipif(not HAS_TLS, reason="needs libmbedtls-dev")
NAME = "localhost"


class School(NamedTuple):
    robot: Esp32PtyRobot
    broker: Mosquitto
    authority: Authority

    def place(self, trust: Path | None = None) -> list[str]:
        return ["--broker", f"{NAME}:{self.broker.port}", "--class", "3b", "--tls",
                "--trust", str(trust or self.authority.file)]  # fmt: skip


@pytest.fixture
def school(tmp_path: Path) -> Iterator[School]:
    authority = Authority(tmp_path)
    broker = Mosquitto(tmp_path, "robots", "a secret", authority.rules(NAME))
    robot = Esp32PtyRobot("tinibot32")
    try:
        put_network_in_reach(robot)
        assert claim_with_button(robot).code == 0
        assert on(robot, "set", "wifi", NETWORK, data=PASSWORD + b"\n").code == 0
        yield School(robot, broker, authority)
    finally:
        robot.clear_away()
        broker.kill()


def test_a_robot_speaks_tls_with_brokers_that_it_trusts(school: School, tmp_path: Path) -> None:
    def set_wifi(*words: str) -> str:
        result = on(school.robot, "set", "wifi", *words, "--user", "robots", data=b"a secret\n")
        assert result.code == 0 and "a secret" not in result.out + result.err, result.err
        return result.out

    stranger = Authority(tmp_path, "Otra")
    assert "does not trust its certificate" in set_wifi(*school.place(stranger.file))
    err = set_wifi(*school.place())
    assert "is connected to the broker localhost, in the class 3b" in err
    later_output = on(school.robot, "set", "wifi").out
    assert "is connected to the broker" in later_output and "tsc class" not in later_output, (
        "it knows no port"
    )
    _, *next_command = shlex.split(err.partition("To see the whole class:  ")[2])
    assert (
        "no program; nothing is running; yours"
        in run_in_process(*next_command, data=b"a secret\n").out
    )


def test_an_invalid_certificate_is_reported_before_the_robot_is_asked(tmp_path: Path) -> None:
    authority, other_authority = Authority(tmp_path), Authority(tmp_path, "Otra")
    text = authority.file.read_bytes()
    pem_start = text.index(b"-----BEGIN")
    files = {
        "none": b"", "text": b"hello\n", "cut": text[: pem_start + 200], "der": authority.der[:-1],
        "two der": authority.der + other_authority.der,
        "two": text + other_authority.file.read_bytes(), "junk": text.replace(b"M", b"!"),
        "long": text[:pem_start] + bytes(5000), "key": (tmp_path / "Aula.key").read_bytes(),
    }  # fmt: skip
    for name, data in files.items():
        (tmp_path / name).write_bytes(data)
        words = ("set", "wifi", "--broker", NAME, "--tls", "--trust", str(tmp_path / name))
        for language, expected in (
            ("en", "is not a file with one"),
            ("es", "no es un archivo con un"),
        ):
            result = run_in_process(*words, "--port", "/none", "--lang", language)
            assert result.code == 2 and expected in result.err and result.err.count("\n") == 1, name
    for form in (authority.der, b"Certificate:\n  x\n" + text):
        (tmp_path / "good").write_bytes(form)
        words = ("set", "wifi", "--broker", NAME, "--tls", "--trust", str(tmp_path / "good"))
        assert run_in_process(*words, "--port", "/none").code == 3, "there is no such port"


def test_a_computer_trusts_the_brokers_own_certificate_regardless_of_its_signer(
    tmp_path: Path,
) -> None:
    """Like a robot, it refuses another certificate of the same authority. An untrusted broker and
    an absent one have different messages.

    Each in a process, since one keeps its connection to a broker.
    """
    authority = Authority(tmp_path)
    broker = Mosquitto(tmp_path, extra_lines=authority.rules(NAME))
    authority.rules("other.aula")
    binary = tmp_path / "own.der"
    binary.write_bytes(der(authority.sign(NAME)))
    (tmp_path / "none").write_bytes(b"hello")
    trusted_text, strange = "no robot of the class", "does not trust the certificate"
    try:
        for name, trust, expected in (
            (NAME, ("--trust", authority.sign(NAME)), trusted_text),
            ("127.0.0.1", ("--trust", authority.sign(NAME)), trusted_text),
            (NAME, ("--trust", binary), trusted_text),
            (NAME, ("--trust", authority.sign("other.aula")), strange),
            (NAME, ("--trust", tmp_path / "none"), strange),
            (NAME, (), strange),
        ):
            result = run_subprocess("class", "--broker", f"{name}:{broker.port}", "--tls", *trust)
            assert result.code == 3 and expected in result.err, (name, trust, result.err)
        result = run_subprocess("class", "--broker", f"{NAME}:{broker.port}")
        assert result.code == 3, "without TLS it is no broker"
    finally:
        broker.kill()


@pytest.mark.parametrize(("words", "message"), [
    (["--broker", NAME, "--tls"], "--tls --trust FILE"),
    (["--broker", NAME, "--trust", "x"], "--trust needs --tls."),
    (["--broker", NAME, "--tls", "--trust", "/none"], "cannot read the certificate file /none"),
    (["--broker", "127.0.0.1", "--tls", "--trust", "CA"], "certificate, not 127.0.0.1"),
    (["--tls"], "--broker HOST"), (["--trust", "CA"], "--broker HOST"),
])  # fmt: skip
def test_nonsensical_options_are_refused(words: list[str], message: str, tmp_path: Path) -> None:
    file = str(Authority(tmp_path).file)
    words = [file if word == "CA" else word for word in words]
    run_in_process("set", "wifi", *words, "--port", "/none").gives(2, message, out="")


def test_every_broker_state_has_a_message() -> None:
    from tiniscript.cli.robot.robot_broker import UNSTARTED_STATES
    from tiniscript.cli.texts import has_text

    for state, _ in WIFI_STATES:
        assert state in UNSTARTED_STATES or has_text(f"broker_{state.lower()}")
