"""A class at an address of the network: who gets an answer there, and loads that keep no one out.

`STRANGERS=10000 pytest -k many tests/studio/test_serving_class.py` takes a minute.
"""

from __future__ import annotations

import gzip
import json
import os
from collections.abc import Iterator
from contextlib import ExitStack, closing
from http.client import HTTPConnection
from pathlib import Path
from threading import active_count

import pytest

from tests.support import page_server
from tests.support.command import Tsc
from tests.support.crowd import HALF_A_REQUEST, crowd
from tests.support.page_server import ask, serves
from tests.support.studio import Class
from tests.support.waiting import HANG_LIMIT_S
from tiniscript.cli.commands import studio as command
from tiniscript.studio import class_keeping, serving
from tiniscript.studio.classroom import Classroom
from tiniscript.studio.hosting import Hosting

HOST = "127.0.0.2"  # it stands for an address of the network here
OTHER_HOST = "127.0.0.3"
STRANGER_COUNT = int(os.environ.get("STRANGERS", "2000"))


@pytest.fixture
def served_class(tmp_path: Path) -> Iterator[Class]:
    (tmp_path / "index.html").write_text('<!doctype html>\n<html lang="en">\n' + "x" * 5000)
    room = Classroom(Hosting(), [])
    page = serving.for_class(serving.files(tmp_path))
    try:
        server = serving.Server(page, 0, room.teach, room, HOST)
    except OSError:
        pytest.skip("this system has no 127.0.0.2")
    with serves(server):
        yield Class(server, room)


def host_header(class_: Class) -> str:
    return f"{HOST}:{class_.server.server_port}"


def post(class_: Class, request: object, token: str = "", **headers: str) -> int:
    """Post as a page of the class does; return the status."""
    body = json.dumps(request).encode()
    return page_server.post(host_header(class_), token, body, headers=headers)[0]


def join_class(class_: Class) -> str:
    request = {"do": "join", "code": class_.room.code, "name": "Ana"}
    return str(class_.room.answer("", OTHER_HOST, request)["token"])


@pytest.mark.parametrize(
    "host", ["127.0.0.1", "localhost", "evil.example", HOST, f"{HOST}.", "PORT.127.0.0.2"]
)
def test_the_host_must_be_exactly_the_shown_address(served_class: Class, host: str) -> None:
    port = served_class.server.server_port
    for name in (host, f"{host}:{port}", f"{host}:1"):
        if name == host_header(served_class):
            continue
        assert post(served_class, {"do": "join"}, Host=name) == 403
        assert post(served_class, {"do": "join"}, Origin=f"http://{name}") == 403
        assert ask(host_header(served_class), headers={"Host": name})[0].status == 403
    assert post(served_class, {"do": "join", "code": "", "name": ""}) == 200


def test_the_page_is_compressed_tagged_and_fetched_once(served_class: Class) -> None:
    connection = HTTPConnection(host_header(served_class), timeout=HANG_LIMIT_S)
    connection.request("GET", "/", headers={"Accept-Encoding": "gzip, deflate"})
    answer = connection.getresponse()
    data = answer.read()
    assert answer.getheader("Content-Encoding") == "gzip" and len(data) < 500
    assert b'<html lang="en" data-class>' in gzip.decompress(data)
    assert answer.getheader("Vary") == "Accept-Encoding"
    assert answer.getheader("Cross-Origin-Opener-Policy") is None
    assert "default-src 'none'" in str(answer.getheader("Content-Security-Policy"))
    tag = str(answer.getheader("ETag"))
    connection.request("GET", "/", headers={"If-None-Match": tag})
    second_answer = connection.getresponse()
    assert (second_answer.status, second_answer.read()) == (304, b"")
    connection.request("GET", "/")
    assert connection.getresponse().read().endswith(b"xxx")
    connection.close()


def test_a_token_grants_only_its_own_access(served_class: Class) -> None:
    ana, teacher = join_class(served_class), served_class.server.entrances.token
    assert post(served_class, {"do": "here"}, ana) == 200
    assert post(served_class, {"do": "class"}, ana) == 400
    assert post(served_class, {"do": "class"}, teacher) == 200
    assert post(served_class, {"do": "here"}, teacher) == 400
    assert post(served_class, {"do": "class"}) == 400
    assert post(served_class, {"do": "class"}, "0" * 32) == 403
    assert post(served_class, {"do": "here"}, **{serving.TOKEN_HEADER: f"{ana}, {teacher}"}) == 403


def test_requests_without_a_token_are_small(served_class: Class) -> None:
    request = {"do": "join", "code": "", "name": "x" * 2000}
    assert post(served_class, request) == 400
    ana = join_class(served_class)
    assert post(served_class, {"do": "here", "text": "x" * 150_000}, ana) == 200
    assert post(served_class, {"do": "here", "text": "x" * 300_000}, ana) == 400


@pytest.mark.parametrize("is_same", [False, True], ids=["another computer", "the same"])
def test_many_connections_block_nobody(served_class: Class, is_same: bool) -> None:
    """They come from one computer, a pupil's or another, and send nothing or half a request. The
    pupil's connection stays, and a new pupil is answered.
    """
    token = join_class(served_class)
    headers = {"Origin": f"http://{host_header(served_class)}", serving.TOKEN_HEADER: token}
    pupil = HTTPConnection(host_header(served_class), timeout=HANG_LIMIT_S)
    pupil.request("POST", serving.ROBOTS_PATH, '{"do": "here"}', headers)
    assert pupil.getresponse().read()
    kept_socket, threads_before = pupil.sock, active_count()
    source = kept_socket.getsockname()[0] if is_same else OTHER_HOST
    with ExitStack() as strangers:
        for _ in range(0, STRANGER_COUNT, 500):
            client_crowd = crowd(
                served_class.server.server_port, count=500, packets=(b"", HALF_A_REQUEST),
                host=HOST,
                source=source,
            )  # fmt: skip
            strangers.enter_context(client_crowd)
            pupil.request("POST", serving.ROBOTS_PATH, '{"do": "here"}', headers)
            assert pupil.getresponse().read()
            assert ask(host_header(served_class))[0].status == 200
        assert pupil.sock is kept_socket
        assert active_count() - threads_before <= serving.MAX_CLASS_CONNECTIONS + 30
    pupil.close()


def test_a_slow_stranger_does_not_disconnect_page_loads(served_class: Class) -> None:
    """The address that has most connections loses one, not the one that asked first."""
    early_client = HTTPConnection(host_header(served_class), timeout=HANG_LIMIT_S)
    early_client.connect()
    with crowd(
        served_class.server.server_port,
        count=serving.MAX_CLASS_CONNECTIONS + 50,
        host=HOST,
        source=OTHER_HOST,
    ):
        assert ask(host_header(served_class))[0].status == 200  # therefore all of them have arrived
        early_client.request("GET", "/")
        assert early_client.getresponse().status == 200
    early_client.close()


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (("--turn", "2"), 2, "Add --class."),
        (("--address", "127.0.0.1"), 2, "Add --class."),
        (("--port", "/dev/x"), 2, "Add --class."),
        (("--class", "--turn", "0"), 2, "--turn"),
        (("--class", "--address", "203.0.113.5"), 3, "--address"),
        (("--class", "--address", "x y\x1b[2J"), 2, "192.168.1.5"),
        (("--class", "--address", "\u00fc" * 300), 2, "192.168.1.5"),
        (("--class", "--address", "0.0.0.0"), 2, "192.168.1.5"),
        (("--class", "--address", "127.0.0.1", "--port", "a\nb"), 2, "port"),
    ],
    ids=range(9),
)
def test_the_command_reports_errors(
    tsc: Tsc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...], code: int,
    message: str,
) -> None:  # fmt: skip
    (tmp_path / "index.html").write_text('<!doctype html>\n<html lang="en">\n')
    monkeypatch.setattr(serving, "PAGE", tmp_path)
    result = tsc("studio", "--no-browser", "--lang", "en", *words)
    assert result.code == code and message in result.err, result.err
    assert "\x1b" not in result.err


def test_the_command_keeps_what_is_given_before_it_answers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "index.html").write_text('<!doctype html>\n<html lang="en">\n')
    monkeypatch.setattr(serving, "files", lambda read=serving.files: read(tmp_path))
    room = Classroom(Hosting(), [])
    with closing(class_keeping.Keeper()) as keeper:
        server = command._server(0, HOST, Hosting(), command._Class(room, keeper))
        with serves(server):
            request = {"do": "class_hand_out", "lesson": 3}
            assert post(Class(server, room), request, server.entrances.token) == 200
        kept_class = keeper.read()
        assert kept_class is not None and kept_class.state["handout"]["lesson"] == 3
        class_keeping.forget()


def test_a_users_second_class_is_refused_without_effects(
    tsc: Tsc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "index.html").write_text('<!doctype html>\n<html lang="en">\n')
    monkeypatch.setattr(serving, "PAGE", tmp_path)
    words = ("studio", "--class", "--address", HOST, "--no-browser", "--lang", "en")
    with closing(class_keeping.Keeper()) as first_keeper:
        room = Classroom(Hosting(), [])
        room.answer("", OTHER_HOST, {"do": "join", "code": room.code, "name": "Ana"})
        first_keeper.keep(room.state_to_keep())
        kept_bytes = class_keeping.path().read_bytes()
        result = tsc(*words)
        assert result.code == 3 and "another tsc studio." in result.err
        assert class_keeping.path().read_bytes() == kept_bytes
    # The first one has ended without a lock; one that cannot start does not leave one either.
    for _ in range(2):
        result = tsc(*words, "--listen", "1", "--address", "203.0.113.5")
        assert result.code == 3 and "203.0.113.5" in result.err
    assert class_keeping.path().read_bytes() == kept_bytes
