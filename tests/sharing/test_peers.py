"""Another user of this computer does not get through to a virtual robot."""

from __future__ import annotations

import errno
import os
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.support.command import Command, run_in_process, run_subprocess
from tests.support.port_strangers import drive_robot, registration_of
from tests.support.socket_pairs import connected_pair
from tests.support.virtual_command import Robot, robot, visitor
from tests.support.waiting import HANG_LIMIT_S
from tiniscript.base import files
from tiniscript.link.sharing import peers, registry
from tiniscript.link.sharing.registry import Registration
from tiniscript.virtual import directory
from tiniscript.virtual.transports import Transports

linux = pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells the user")

NOBODY_UID = 65534
LINE = b"SI|F(0.1,50)\r\n"
# Says a line as another user; then hangs up at once, resets the connection, or stays.
STRANGER_SCRIPT = """
import encodings.idna, os, socket, struct, sys
os.setgid(65534); os.setuid(65534)
peer = socket.create_connection(("127.0.0.1", int(sys.argv[1])))
if sys.argv[2] == "reset":
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
peer.sendall(bytes.fromhex(sys.argv[3]))
if sys.argv[2] == "stays":
    peer.settimeout(120)
    try:
        print(len(peer.recv(100)))
    except ConnectionError:
        print(0)
peer.close()
"""


@linux
def test_the_peer_of_a_connection_has_its_user() -> None:
    own_end, other_end = connected_pair()
    with own_end, other_end:
        owner = peers._socket_owner(own_end.getpeername(), own_end.getsockname())
        assert owner == (os.geteuid(), os.fstat(other_end.fileno()).st_ino)
        assert peers.is_of_this_user(own_end)
        other_end.shutdown(socket.SHUT_WR)  # the other end still listens
        assert peers.is_of_this_user(own_end)


@linux
def test_a_closed_peer_has_an_unknown_user() -> None:
    own_end, other_end = connected_pair()
    with own_end:
        other_end.sendall(LINE)
        other_end.close()
        assert not peers._socket_owner(own_end.getpeername(), own_end.getsockname()).is_open
        assert not peers.is_of_this_user(own_end)


@linux
def test_the_kernel_reports_an_unowned_socket() -> None:
    with pytest.raises(FileNotFoundError):
        peers._socket_owner(("127.0.0.1", 1), ("127.0.0.1", 2))


@linux
@pytest.mark.parametrize(("own_uid", "user", "inode", "is_let_in"), [
    (1234, 1234, 5, True),
    (1234, 1234, 0, False),
    (1234, 0, 5, True),  # root has every right
    (1234, 0, 0, False),
    (1234, NOBODY_UID, 5, False),
    (1234, NOBODY_UID, 0, False),
    (0, 0, 5, True),
    (0, 0, 0, False),
    (0, NOBODY_UID, 5, False),
])  # fmt: skip
def test_only_sockets_of_the_same_user_are_admitted(
    monkeypatch: pytest.MonkeyPatch, own_uid: int, user: int, inode: int, is_let_in: bool
) -> None:
    monkeypatch.setattr(os, "geteuid", lambda: own_uid)
    monkeypatch.setattr(
        peers, "_socket_owner", lambda peer, own_address: peers.SocketOwner(user, inode)
    )
    own_end, other_end = connected_pair()
    with own_end, other_end:
        assert peers.is_of_this_user(own_end) == is_let_in


def test_a_system_without_socket_owners_admits_all(monkeypatch: pytest.MonkeyPatch) -> None:
    def failing_owner(number: int) -> object:
        def other_end(peer: object, own_address: object) -> peers.SocketOwner:
            raise OSError(number, "no")

        return other_end

    own_end, peer_end = connected_pair()
    with own_end, peer_end:
        monkeypatch.setattr(peers, "_socket_owner", failing_owner(errno.EOPNOTSUPP))
        assert peers.is_of_this_user(own_end)
        monkeypatch.setattr(sys, "platform", "linux")
        for number in (errno.ENOENT, errno.EMFILE, errno.ENFILE):  # closed, or the query failed
            monkeypatch.setattr(peers, "_socket_owner", failing_owner(number))
            assert not peers.is_of_this_user(own_end)


@linux
@pytest.mark.root
@pytest.mark.parametrize("attack", ["stays", "leaves", "reset"])
def test_another_user_cannot_drive(attack: str) -> None:
    with robot("--listen", "0") as running_robot:
        number = running_robot.port.rpartition(":")[2]
        words = [sys.executable, "-I", "-c", STRANGER_SCRIPT, number, attack, LINE.hex()]
        for _ in range(3):
            completed = subprocess.run(words, capture_output=True, text=True, timeout=HANG_LIMIT_S)
            assert completed.returncode == 0, completed.stderr
            assert completed.stdout.strip() == ("0" if attack == "stays" else "")
        time.sleep(1)
        with visitor(running_robot.port) as client:
            client.settimeout(HANG_LIMIT_S)
            client.sendall(LINE)
            heard_bytes = b""
            while not heard_bytes.endswith(b"// DONE\r\n"):
                heard_bytes += client.recv(1000)
        assert running_robot.until("DONE")[1:] == ["0 MOTORS 50 50", "100 MOTORS 0 0", "100 DONE"]


# -- another server in a robot's place -------------------------------------------------------------

# Listens at a port as another user, and prints what it receives.
LISTENER_SCRIPT = """
import os, socket, sys
os.setgid(65534); os.setuid(65534)
listening = socket.create_server(("127.0.0.1", int(sys.argv[1])))
print("listens", flush=True)
while True:
    peer, _ = listening.accept()
    print(peer.recv(1000), flush=True)
"""


@linux
def test_a_listening_port_has_its_user(monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        number = server.getsockname()[1]
        assert not peers.is_of_another_user(number)
        monkeypatch.setattr(os, "geteuid", lambda: NOBODY_UID)
        assert peers.is_of_another_user(number) == (os.getuid() != 0)  # root has every right
    assert not peers.is_of_another_user(number)  # no server listens there


def test_a_port_at_which_another_user_listens_is_not_a_robot(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """After a crash, the robot's file is still there."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        number = server.getsockname()[1]
        address = f"socket://127.0.0.1:{number}"
        note = directory.announce(directory.RunningRobot(address, "tinibot", "room", "", ""))
        assert [entry.address for entry in directory.running_robots()] == [address]
        monkeypatch.setattr(peers, "is_of_another_user", lambda port: port == number)
        for _ in range(2):
            assert directory.running_robots() == []
            for words in (["show"], ["upload", "-e", "SI|S"], ["stop"], ["live", "S"]):
                for port in (address, address.replace("127.0.0.1", "localhost")):
                    result = run_in_process(*words, "--port", port)
                    result.gives(3, "another user of this computer is listening")
        server.settimeout(HANG_LIMIT_S)
        peer, _ = server.accept()
        with peer:
            peer.settimeout(HANG_LIMIT_S)
            assert peer.recv(1000) == b""  # no bytes were sent
        run_in_process("start", "--port", address, "--lang", "es").gives(3, "escucha otro usuario")
        monkeypatch.setattr(peers, "is_of_another_user", lambda port: False)
        assert directory.is_virtual(address)
    assert directory.running_robots() == []
    assert note is not None and not note.exists()


@linux
@pytest.mark.root
def test_the_owner_of_a_killed_robots_port_is_checked() -> None:
    running_robot = Robot("--listen", "0")
    running_robot.kill()
    listener = Command(running_robot.port.rpartition(":")[2], code=LISTENER_SCRIPT)
    listener.until("listens")
    run_subprocess("upload", "-e", "SI|S", "--port", running_robot.port).gives(3, "another user")
    run_subprocess("start", "--virtual").gives(3)
    listener.process.kill()
    assert listener.process.stdout
    assert set(listener.process.stdout.read().split()) <= {b"b''"}


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="no pseudo-terminals here")
def test_a_pseudo_terminal_is_private_to_its_user(monkeypatch: pytest.MonkeyPatch) -> None:
    import pty

    open_pty = pty.openpty

    def open_group_pty() -> tuple[int, int]:
        """Open a listener with the usual settings."""
        our_end, device_end = open_pty()
        os.fchmod(device_end, 0o620)
        return our_end, device_end

    monkeypatch.setattr(pty, "openpty", open_group_pty)
    transports = Transports(has_terminal=True)
    try:
        assert Path(transports.terminal).stat().st_mode & 0o777 == 0o600
    finally:
        transports.close()


@linux
def test_the_token_is_in_one_private_file() -> None:
    """It is in no command line, environment, output or other file."""
    with drive_robot() as (virtual, port, command, receipt):
        registration = registration_of(port)
        secrets = [secret.encode() for secret in (registration.token, registration.answer)]
        assert run_subprocess("doctor", "--port", port).code == 0
        places = [receipt]
        for pid in (virtual.pid, command.pid):
            places += [Path(f"/proc/{pid}/{name}").read_bytes() for name in ("cmdline", "environ")]
        found_paths = []
        for path in files.cache_folder().rglob("*"):
            if path.is_file():
                content = path.read_bytes()
                found_paths += [path] if any(secret in content for secret in secrets) else []
                places.append(str(path).encode())
        assert run_subprocess("stop", "--port", port).code == 0
        places += command.communicate(timeout=HANG_LIMIT_S)
    assert len(found_paths) == 1 and len(places) > 7
    assert not [data for data in places for secret in secrets if secret in data]


def test_files_of_dead_commands_are_removed_and_those_of_servers_kept() -> None:
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        server.listen()
        number = server.getsockname()[1]
        living = Registration("/dev/x", number, "a" * 32, "b" * 32, "link", 9600, os.getpid())
        registry.write(living)
        registry.tidy()
        assert registry.is_taken(number)
        assert len(list((files.cache_folder() / "held").glob("*.json"))) == 1
    registry.tidy()
    assert not registry.is_taken(number)
    assert not list((files.cache_folder() / "held").glob("*.json"))


@linux
def test_a_port_whose_server_has_just_ended_is_free() -> None:
    """Connections that it has closed are remembered by the system for a minute."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        number = server.getsockname()[1]
        client = socket.create_connection(server.getsockname())
        accepted_socket, _ = server.accept()
        accepted_socket.close()
        assert client.recv(1) == b""
        client.close()
    assert not registry.is_taken(number)


@pytest.mark.parametrize("has_third", [False, True])
def test_a_file_replaced_during_its_removal_is_kept(tmp_path: Path, has_third: bool) -> None:
    """A server writes its own between our look and our hands; a third one may come meanwhile."""
    path = tmp_path / "port.json"
    path.write_text("of the next server")
    removed_files: list[object] = []

    def is_meant(removed: object) -> bool:
        removed_files.append(removed)
        if has_third and len(removed_files) == 2:
            path.write_text("of a third one")
        return len(removed_files) == 1

    registry._remove(path, is_meant)
    assert path.read_text() == ("of a third one" if has_third else "of the next server")
    assert list(tmp_path.iterdir()) == [path]


def test_releasing_a_port_leaves_the_next_holders_file(tmp_path: Path) -> None:
    """Somebody has removed ours meanwhile, and another command has the port."""
    path = tmp_path / "port"
    for is_others in (False, True):
        locked_file = registry._try_lock(path)
        assert locked_file is not None
        if is_others:
            path.unlink()
            path.write_text("of another command")
        locked_file.close()
        assert path.exists() == is_others


def test_a_readable_folder_is_made_private_and_its_contents_distrusted() -> None:
    registration = Registration("/dev/x", 1, "a" * 32, "b" * 32, "link", 9600, os.getpid())
    registry.write(registration)
    folder = files.cache_folder() / "held"
    assert registry.find_registration("/dev/x") == registration
    folder.chmod(0o750)
    assert registry.find_registration("/dev/x") is None
    registry.write(registration)
    assert folder.stat().st_mode & 0o777 == 0o700
    assert registry.find_registration("/dev/x") == registration


def test_a_registration_made_during_a_removal_is_kept(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The port was taken again between looking at the note and removing it."""
    registration_before, new_registration = (
        Registration("/dev/x", number, "a" * 32, "b" * 32, "link", 9600, os.getpid())
        for number in (1, 2)
    )
    registry.write(new_registration)
    real_read = registry._read
    paths = []

    def read(path: Path) -> Registration | None:
        paths.append(path)
        return registration_before if len(paths) == 1 else real_read(path)

    with monkeypatch.context() as patch:
        patch.setattr(registry, "_read", read)
        registry.remove(registration_before)
    assert len(paths) == 2
    assert registry.find_registration("/dev/x") == new_registration
