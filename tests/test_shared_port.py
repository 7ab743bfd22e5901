"""One port, many commands: whoever holds it lets the others use its session."""

from __future__ import annotations

import json
import os
import signal
import socket
import stat
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

import pytest

from tests.command import TSC, Done, Tsc, process
from tests.desk import Desk
from tests.machines.tabletop import missing
from tiniscript import __version__, robots
from tiniscript.link.frames import decoded
from tiniscript.link.line import Line
from tiniscript.link.outcomes import Event
from tiniscript.link.ports import opened
from tiniscript.link.session import Session, Task
from tiniscript.sharing import holders, notes
from tiniscript.sharing.holders import Holder
from tiniscript.sharing.host import FULL_BYTES, Host

pytest.importorskip("pty", reason="Windows has no pseudo-terminals of this kind")
pytestmark = pytest.mark.skipif(bool(missing()), reason=missing() or "there is a compiler")

KIT = robots.load("tinibot").kit
FOREVER = "SI|LOOP(FOREVER);F(1, 80);END_LOOP"
LONG = "LOOP(2);" + "".join(f"M({k}, 50);W(0.01);" for k in range(1, 56)) + "END_LOOP"


@pytest.fixture
def desk() -> Iterator[Desk]:
    with Desk(KIT) as found:
        yield found


class Command:
    """A `tsc` that stays."""

    def __init__(self, *arguments: str, code: str = "") -> None:
        words = [sys.executable, "-c", code] if code else TSC
        self.process = subprocess.Popen(
            [*words, *arguments], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )  # fmt: skip

    def until(self, said: str) -> None:
        """Wait until it has printed a line with these words."""
        assert self.process.stdout
        for line in self.process.stdout:
            if said in line.decode():
                return
        raise AssertionError(f"never printed: {said}. {self.ended().err}")

    def signal(self, number: int) -> None:
        self.process.send_signal(number)

    def ended(self) -> Done:
        out, err = self.process.communicate(timeout=30)
        return Done(self.process.returncode, out.decode(), err.decode())


@pytest.fixture
def link(desk: Desk) -> Iterator[Command]:
    """`tsc link` on the desk's port."""
    command = Command("link", "--port", desk.port)
    command.until("share this port")
    yield command
    command.process.kill()
    command.process.communicate()


def on(desk: Desk, *arguments: str | Path) -> Done:
    return process(*arguments, "--port", desk.port)


def uploading(desk: Desk, text: str = FOREVER) -> Command:
    """A program that runs, and the command that attends to it."""
    command = Command("upload", "-e", text, "--port", desk.port)
    command.until("running")
    desk.until(lambda: desk.moves, "it drives")
    return command


def hellos(desk: Desk) -> int:
    """Return how often a session was begun: as often as the port was opened."""
    frames = map(decoded, desk.heard.split(b"\0"))
    return sum(frame is not None and frame.number == 1 for frame in frames)


# -- what others can do -------------------------------------------------------------------------


def test_stop_works_while_another_terminal_drives(desk: Desk) -> None:
    command = uploading(desk)
    done = on(desk, "stop")
    assert (done.code, done.out) == (
        0, f"Stopped: the robot on {desk.port} has confirmed it.\n",
    )  # fmt: skip
    assert not desk.moves
    done = command.ended()
    assert done.code == 3
    assert "The robot was stopped from a computer." in done.out
    assert hellos(desk) == 1


def test_commands_share_a_session_that_is_begun_once(
    desk: Desk, link: Command, tmp_path: Path
) -> None:
    done = on(desk, "upload", "-e", "SI|F(0.1, 80);SHOW(1.5)")
    assert (done.code, done.err) == (0, "")
    assert done.out.splitlines()[1:] == ["SHOW 1.5", "Done.", "Saved in slot 0."]
    assert on(desk, "upload", "-e", "SI|F(0.1, 30)").code == 0
    assert on(desk, "live", "X = 1 / 0").code == 1
    assert "3 round trips" in on(desk, "ping", "--count", "3").out
    ours, theirs = tmp_path / "ours.bin", tmp_path / "theirs.bin"
    process("compile", "-e", LONG, "-o", ours)
    assert on(desk, "upload", ours, "--no-run", "--no-save").code == 0
    assert on(desk, "fetch", "-o", theirs).code == 0
    assert theirs.read_bytes() == ours.read_bytes()
    assert on(desk, "name", "Ñandú").code == 0
    assert json.loads(on(desk, "info", "--json").out)["name"] == "Ñandú"
    assert on(desk, "start").out.endswith("Done.\n")
    assert hellos(desk) == 1
    link.signal(signal.SIGINT)
    done = link.ended()
    assert done.code == 0
    assert "tsc upload: has come." in done.out
    assert "SHOW 1.5" in done.out


def test_all_names_of_a_port_lead_to_its_holder(desk: Desk, link: Command, tmp_path: Path) -> None:
    name = tmp_path / "by-id"
    name.symlink_to(desk.port)
    assert process("stop", "--port", name).code == 0
    assert "SHOW 2" in process("live", "SHOW(2)", "--port", name).out
    assert hellos(desk) == 1
    rows = json.loads(process("ports", "--json").out)
    assert {row["port"]: row["held_by"] for row in rows}[desk.port] == "link"
    done = process("ports", "--ask", "--port", name)
    assert "robot" in done.out and "held by tsc link" in done.out
    done = process("info", "--port", name, "--baud", "115200")
    assert done.code == 3
    assert "held by tsc link, at 9600 baud" in done.err
    done = process("link", "--port", name)
    assert done.code == 3
    assert "shared already, by tsc link" in done.err


def test_an_address_is_held_like_a_port(desk: Desk) -> None:
    bridge = Command(code=BRIDGE.format(port=desk.port))
    assert bridge.process.stdout
    address = f"socket://localhost:{int(bridge.process.stdout.readline())}"
    command = Command("upload", "-e", FOREVER, "--port", address)
    command.until("running")
    assert process("stop", "--port", address.replace("localhost", "127.0.0.1")).code == 0
    assert command.ended().code == 3
    assert hellos(desk) == 1
    bridge.process.kill()
    bridge.process.communicate()


BRIDGE = """
import socket, threading, serial
tcp = socket.create_server(("127.0.0.1", 0))
print(tcp.getsockname()[1], flush=True)
peer, _ = tcp.accept()
device = serial.Serial({port!r}, timeout=0.005)
def back():
    while True:
        peer.sendall(device.read(200))
threading.Thread(target=back, daemon=True).start()
while data := peer.recv(1000):
    device.write(data)
"""


def test_a_guest_may_have_chosen_another_robot(desk: Desk) -> None:
    command = Command("monitor", "--port", desk.port, "--robot", "grabber")
    assert command.process.stderr
    command.process.stderr.readline()  # it watches
    desk.ask(lambda robot: robot.sense(0, 0, 42_000))
    assert "SHOW 42" in on(desk, "live", "SHOW(DISTANCE)").out
    done = on(desk, "live", "GRIPPER(90)", "--robot", "grabber")
    assert done.code == 3
    assert "--robot tinibot" in done.err
    done = on(desk, "upload", "-e", "SHOW(LINE_L)", "--robot", "liner")
    assert done.code == 3
    assert "--robot tinibot" in done.err
    command.signal(signal.SIGINT)
    assert command.ended().code == 0


def test_monitor_shows_what_live_does_and_not_its_bookkeeping(desk: Desk, link: Command) -> None:
    monitor = Command("monitor", "--port", desk.port, "--json")
    assert monitor.process.stderr
    monitor.process.stderr.readline()
    live = Command("live", "--port", desk.port)
    assert live.process.stdin and live.process.stdout
    live.process.stdin.write(b"X = 3; SHOW(X)\nX = X + 1\nSHOW(X)\n")
    done = live.ended()
    assert [line for line in done.out.splitlines() if line != "Done."] == ["SHOW 3", "SHOW 4"]
    assert monitor.process.stdout
    rows = [json.loads(monitor.process.stdout.readline()) for _ in range(5)]
    assert [(row["event"], row.get("value")) for row in rows] == [
        ("SHOW", 3), ("DONE", None), ("DONE", None), ("SHOW", 4), ("DONE", None),
    ]  # fmt: skip
    monitor.signal(signal.SIGINT)
    assert monitor.ended().out == ""


def test_an_upload_through_a_holder_imports_no_more_than_it_needs() -> None:
    """So the robot moves before a person has let go of the key."""
    code = (
        "import sys; from tiniscript.cli import main; assert main(sys.argv[1:]) == 0; "
        "print(' '.join(sys.modules))"
    )
    with Shared() as (desk, _):
        command = Command("upload", "-e", "SI|F(0.1, 30)", "--port", desk.port, code=code)
        modules = set(command.ended().out.splitlines()[-1].split())
    unwanted = {"serial", "cobs", "construct", "tomllib", "tomli", "rich", "threading",
                "tiniscript.link.session", "tiniscript.link.ports", "tiniscript.cli.crew",
                "tiniscript.messages"}  # fmt: skip
    assert sorted(unwanted & modules) == []


# -- whose run it is ------------------------------------------------------------------------------


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGSTOP])
def test_a_robot_stops_without_the_command_that_has_started_it(
    desk: Desk, link: Command, number: int
) -> None:
    command = uploading(desk)
    gone_ms = desk.robot_ms
    command.signal(number)
    desk.until(lambda: not desk.moves, "it stops by itself")
    # at once, if the holder sees it go
    assert int(desk.timed[-1].split()[0]) <= gone_ms + (1500 if number == signal.SIGSTOP else 900)
    assert on(desk, "upload", "-e", "SI|F(0.1, 30)").code == 0
    command.process.kill()
    command.process.communicate()


def test_ctrl_c_in_a_guest_stops_the_robot(desk: Desk, link: Command) -> None:
    command = uploading(desk)
    command.signal(signal.SIGINT)
    done = command.ended()
    assert done.code == 2
    assert "the robot has confirmed it" in done.err
    assert not desk.moves


def test_a_program_that_needs_nobody_outlives_its_command(desk: Desk, link: Command) -> None:
    assert on(desk, "upload", "-e", FOREVER, "--detach").code == 0
    desk.ask(lambda robot: robot.wait(1500))
    assert desk.moves
    assert on(desk, "stop").code == 0
    assert not desk.moves


def test_a_second_program_ends_the_first_and_both_know(desk: Desk) -> None:
    first = uploading(desk)
    second = Command("upload", "-e", "SI|LOOP(20);F(0.1, 30);END_LOOP", "--port", desk.port)
    second.until("running")
    done = first.ended()  # it held the port
    assert done.code == 3
    assert "another program" in done.err
    done = second.ended()
    assert done.code == 3
    assert "has ended (tsc upload)" in done.err
    desk.until(lambda: not desk.moves, "nobody is left who attends")


# -- endings of a holder --------------------------------------------------------------------------


def test_a_holder_that_leaves_stops_the_run_of_its_guest(desk: Desk, link: Command) -> None:
    command = uploading(desk)
    link.signal(signal.SIGINT)
    assert link.ended().code == 0
    assert not desk.moves
    done = command.ended()
    assert done.code == 3
    assert "has ended (tsc link)" in done.err
    assert holders.found(desk.port) is None
    assert on(desk, "upload", "-e", "SI|F(0.1, 30)").code == 0
    assert hellos(desk) == 2


def test_a_holder_that_is_killed_blocks_nobody(desk: Desk, link: Command) -> None:
    command = uploading(desk)
    link.process.kill()
    done = command.ended()
    assert done.code == 3
    assert "has ended (tsc link)" in done.err
    desk.until(lambda: not desk.moves, "it stops by itself")
    assert holders.found(desk.port) is not None
    assert desk.port not in [row["port"] for row in json.loads(process("ports", "--json").out)
                             if row["held_by"]]  # fmt: skip
    done = on(desk, "info")
    assert (done.code, done.err) == (0, "")
    assert "LINK_LOST" in done.out
    assert holders.found(desk.port) is None


def test_a_stop_gets_through_while_its_holder_ends(desk: Desk) -> None:
    """Whoever comes in the middle opens the port itself."""
    for wait_s in (0, 0.1):
        holder = uploading(desk)
        stop = Command("stop", "--port", desk.port)
        time.sleep(wait_s)
        holder.process.kill()
        done = stop.ended()
        assert (done.code, done.err) == (0, "")
        assert not desk.moves
        holder.process.communicate()
    assert on(desk, "upload", "-e", FOREVER, "--detach").code == 0
    with socket.create_server((notes.HOST, 0)) as holding:
        found = Holder(desk.port, holding.getsockname()[1], "a", "b", "link", 9600, 1)
        holders.write(found)
        stop = Command("stop", "--port", desk.port)
        peer, _ = holding.accept()
        with peer:
            peer.recv(1000)
            peer.sendall(notes.written({"tsc": __version__, "answer": "b"}))
            assert b"stop" in peer.recv(1000)
    assert stop.ended().code == 0
    assert not desk.moves


def test_a_cable_that_is_pulled_is_said_to_all(desk: Desk, link: Command) -> None:
    command = uploading(desk)
    desk.pull()
    for each in (command, link):
        done = each.ended()
        assert done.code == 3
        assert "has vanished" in done.err


def test_a_robot_that_was_lost_is_found_again(desk: Desk, link: Command) -> None:
    desk.switch_off()
    link.until("Looking for it")
    desk.switch_on()
    link.until("is there again")
    assert "SHOW 7" in on(desk, "live", "SHOW(7)").out


def test_of_two_who_want_a_port_one_gets_it(desk: Desk) -> None:
    commands = [Command("link", "--port", desk.port) for _ in range(3)]
    held: list[str] = []
    desk.until(lambda: sum(each.process.poll() is not None for each in commands) == 2, "one stays")
    for each in commands:
        if each.process.poll() is None:
            assert on(desk, "stop").code == 0
            each.signal(signal.SIGINT)
            done = each.ended()
            assert (done.code, done.err) == (0, "\n")
        else:
            done = each.ended()
            assert done.code == 3
            held.append(done.err)
    assert all("shared already" in said for said in held)


def test_of_two_who_want_an_address_one_gets_it(desk: Desk) -> None:
    bridge = Command(code=BRIDGE.format(port=desk.port))
    assert bridge.process.stdout
    address = f"socket://127.0.0.1:{int(bridge.process.stdout.readline())}"
    commands = [Command("link", "--port", address) for _ in range(3)]
    desk.until(lambda: sum(each.process.poll() is not None for each in commands) == 2, "one stays")
    losers = [each.ended() for each in commands if each.process.poll() is not None]
    assert [done.code for done in losers] == [3, 3]
    assert all("shared already" in done.err for done in losers)
    for each in (*commands, bridge):
        each.process.kill()
        each.process.communicate()


def test_commands_that_come_at_once_are_all_served(desk: Desk) -> None:
    commands = [Command("info", "--port", desk.port) for _ in range(3)]
    commands.append(Command("upload", "-e", "SB|S", "--port", desk.port))
    assert [each.ended().err for each in commands] == ["", "", "", ""]


def test_a_tsc_of_another_version_can_be_stopped(desk: Desk) -> None:
    newer = "import sys, tiniscript; tiniscript.__version__ = '9.1'; " + (
        "from tiniscript.cli import main; sys.exit(main(sys.argv[1:]))"
    )
    command = Command("upload", "-e", FOREVER, "--port", desk.port, code=newer)
    command.until("running")
    for language, words in (("en", "another version, 9.1"), ("es", "otra versión, 9.1")):
        done = on(desk, "info", "--lang", language)
        assert done.code == 3
        assert words in done.err
    assert on(desk, "stop").code == 0
    assert command.ended().code == 3


# -- who may come in ------------------------------------------------------------------------------


def greeting(holder: Holder, **other: object) -> bytes:
    note = {"tsc": __version__, "token": holder.token, "verb": "upload"}
    return notes.written({**note, **other})


def visitor(holder: Holder) -> socket.socket:
    return socket.create_connection((notes.HOST, holder.number), 10)


def is_let_go(peer: socket.socket) -> bool:
    """Whether a holder closes a connection without a word."""
    try:
        return peer.recv(100) == b""
    except ConnectionError:
        return True


def test_only_the_user_may_come_in(desk: Desk, link: Command) -> None:
    holder = holders.found(desk.port)
    assert holder is not None
    folder = holders._folder()
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    for path in folder.iterdir():
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
    command = uploading(desk)
    rude = (
        greeting(holder, token="0" * 32),
        greeting(holder, token="é"),
        greeting(holder, token=5),
        greeting(holder, verb="x" * 99),
        notes.written({"do": "stop"}),
        b"GET / HTTP/1.1\r\n\r\n",
        b"[" * 900 + b"\n",
        b"\0" * 100 + b"\n",
        b"a" * 5000,
    )
    for data in rude:
        with visitor(holder) as peer:
            peer.sendall(data)
            assert is_let_go(peer)
    assert desk.moves
    silent = [visitor(holder) for _ in range(100)]
    assert on(desk, "stop").code == 0
    assert command.ended().code == 3
    for peer in silent:
        assert is_let_go(peer)
        peer.close()


@pytest.mark.parametrize(
    "wrong",
    [
        {"do": "fly"},
        {"do": "name", "name": ""},
        {"do": "name", "name": "zz"},
        {"do": "name", "name": "00" * 17},
        {"do": "live", "code": "00", "kit": "5"},
        {"do": "live", "code": 7, "kit": 0},
        {"do": "start", "is_detached": 1},
        {"do": "upload", "start": "PING", "kit": 0, "code": "", "checksum": 0, "isa": "0100",
         "runs": True, "saves": False, "is_detached": False},
        {"do": "upload", "start": "SI", "kit": -1, "code": "", "checksum": 0, "isa": "0100",
         "runs": True, "saves": False, "is_detached": False},
        {"do": "ping", "id": "1"},
        {"do": 5},
    ],
)  # fmt: skip
def test_wrong_notes_of_a_guest_end_its_visit_alone(wrong: dict[str, object]) -> None:
    with Shared() as (desk, holder), visitor(holder) as peer:
        peer.sendall(greeting(holder) + notes.written({"id": 1, "limit_ms": 100, **wrong}))
        said = b""
        while part := _rest(peer):
            said += part
        assert said == notes.written({"tsc": __version__, "answer": holder.answer})
        assert "SHOW 1" in on(desk, "live", "SHOW(1)").out


def _rest(peer: socket.socket) -> bytes:
    try:
        return peer.recv(65536)
    except ConnectionError:
        return b""


class Shared:
    """A line of this process that is shared."""

    def __enter__(self) -> tuple[Desk, Holder]:
        self.desk = Desk(KIT)
        device = opened(self.desk.port, 9600)
        self.line = Line(device, Session(1, 9600, KIT.fingerprint))
        self.host = Host(self.line, self.desk.port, 9600, "link")
        return self.desk, self.host.holder

    def __exit__(self, *_: object) -> None:
        self.host.close()
        self.line.close()
        self.desk.clear_away()


def test_whoever_reads_slowly_misses_values_and_holds_up_nobody() -> None:
    shared = Shared()
    with shared as (desk, holder), visitor(holder) as peer:
        peer.sendall(greeting(holder))
        reader = notes.Notes(notes.LINE_BYTES)
        found = reader.put(peer.recv(65536))
        count = 50 * FULL_BYTES // 60
        for k in range(count):
            shared.host._hear([(k, Event("SHOW", {"value": k, "is_yes_no": 0}))])
        shared.host._hear([(count, Event("DONE", {"run": 9}))])
        assert "SHOW 1" in on(desk, "live", "SHOW(1)").out
        while not any(note.get("event") == "DONE" for note in found):
            data = peer.recv(65536)
            assert data, "it was let go"
            found += reader.put(data)
        found = found[: [note.get("event") for note in found].index("DONE")]
        missed = [notes.values(note)["count"] for note in found if note.get("event") == "MISSED"]
        shown = sum(note.get("event") == "SHOW" for note in found)
        assert sum(int(each) for each in missed) + shown == count
        assert missed


def test_nothing_is_shared_where_nothing_can_be_written(
    tsc: Tsc, desk: Desk, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(blocked))
    assert tsc("upload", "-e", "SI|F(0.1, 30)", "--port", desk.port).code == 0
    done = tsc("link", "--port", desk.port)
    assert done.code == 3
    assert "cannot be shared" in done.err


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", '{"port": 5}', "[" * 5000, "\0"])
def test_a_file_that_says_nothing_is_no_holder(desk: Desk, text: str) -> None:
    with Shared() as (other, holder):
        path = holders._path(other.port)
        path.write_text(text)
        assert holders.found(other.port) is None
        assert holders.all_found() == []
    path.write_text(json.dumps(holder._replace(port=desk.port)._asdict()))
    assert holders.found(other.port) is None
    if os.name == "posix":
        path.write_text(json.dumps(holder._asdict()))
        assert holders.found(other.port) == holder
        path.parent.chmod(0o755)
        assert holders.found(other.port) is None


def test_somebody_else_at_the_number_of_a_crashed_holder_is_no_holder(desk: Desk) -> None:
    with socket.create_server((notes.HOST, 0)) as stranger:
        number = stranger.getsockname()[1]
        holders.write(Holder(desk.port, number, "a", "b", "link", 9600, 1))
        command = Command("info", "--port", desk.port)
        peer, _ = stranger.accept()
        with peer:
            peer.recv(1000)
            peer.sendall(notes.written({"tsc": __version__, "answer": "c"}))
            done = command.ended()
    assert (done.code, done.err) == (0, "")
    assert holders.found(desk.port) is None


def test_a_bug_of_ours_in_a_thread_is_raised_where_somebody_waits() -> None:
    for part in ("session", "host"):
        shared = Shared()
        with shared as (_, holder), visitor(holder) as peer:
            if part == "session":
                shared.line.session._tasks.append(cast("Task", None))
            else:
                shared.host._orphans.append(cast("Any", None))
            with pytest.raises(AttributeError):
                while True:
                    shared.line.event()
            peer.settimeout(10)
            assert is_let_go(peer)
