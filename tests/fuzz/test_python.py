"""Anything at all, as a program, a profile, a world, a robot's answer or another command's message,
is either accepted or refused in the usual way.

Hypothesis generates them, from valid input and from scratch. `python -m tests.fuzz.test_python
compiler 100000` makes more than the tests do.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import pytest
from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy

from tests.support.casefile import ROOT
from tiniscript import compile_text, robots
from tiniscript.base.languages import languages
from tiniscript.base.source import Source
from tiniscript.bytecode.image import pack, unpack
from tiniscript.bytecode.verify import verify
from tiniscript.diagnostics.rendering import as_text, message
from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.messages import MESSAGES, PAYLOAD_BYTES
from tiniscript.link.session import Session
from tiniscript.link.sharing import protocol
from tiniscript.link.sharing.protocol import BadMessage, MessageReader
from tiniscript.link.sharing.requests import ClientRequests, request_maker
from tiniscript.robots.profile import ProfileRefused
from tiniscript.robots.reader import read as read_profile
from tiniscript.virtual.worlds import read as read_world

EXAMPLES = 150  # examples of each kind in the tests
KIT = robots.load("tinibot").kit
PIECES = (
    "SI|", "SB|", "LOOP(", "FOREVER", "IF ", "ELSE", "END_IF", "END_LOOP", "DEF X", "UNTIL(",
    "F(2, 80)", "X = ", "(", ")", ";", "\n", "|", '"', "//", "1e9", "-", "0.0005", "9" * 400,
    "\0", "\ufeff", "ñ", "\u2028",
    "[kit]", "[[kit.sensors]]", "name = ", "= {}", "[", "]", "nan", "inf", "true", "'", "=",
    "0x", ",", "\\",
)  # fmt: skip


@lru_cache
def _texts(pattern: str) -> list[str]:
    texts = [path.read_text(encoding="utf-8") for path in sorted(ROOT.glob(pattern))]
    assert texts, pattern
    return texts


def changed_texts(pattern: str) -> SearchStrategy[str]:
    """Texts of these files with pieces left out, put in or doubled, and texts of anything."""

    def change(text: str, edits: list[tuple[float, int, str]]) -> str:
        for where, removed_count, piece in edits:
            index = int(where * len(text))
            text = text[:index] + piece + text[index + removed_count :]
        return text

    edit = st.tuples(
        st.floats(0, 1), st.integers(0, 40), st.one_of(st.sampled_from(PIECES), st.text(max_size=9))
    )
    changed = st.builds(change, st.sampled_from(_texts(pattern)), st.lists(edit, max_size=6))
    return st.one_of(changed, st.text(max_size=300))


# -- laws ------------------------------------------------------------------------------------------


def check_program(text: str) -> None:
    """Check that a text has a valid image, or mistakes with messages in every language."""
    compilation = compile_text(text, KIT)
    assert compilation.is_right != any(
        diagnostic.is_mistake for diagnostic in compilation.diagnostics
    )
    if compilation.is_right:
        image = unpack(compilation.image)
        verify(image.code, len(KIT.readings), len(KIT.actuators))
    source = Source(text, "x.ts")
    for diagnostic in compilation.diagnostics:
        for language in languages():
            assert as_text(message(diagnostic, source, language), source, language)


def check_profile(text: str) -> None:
    try:
        robot = read_profile(text, "own")
    except ProfileRefused:
        return
    assert 0 <= robot.kit.fingerprint < 1 << 16


def check_world(text: str) -> None:
    try:
        read_world(text, "own")
    except ProfileRefused:
        return


def check_answers(items: list[tuple[int, int, bytes, bool]]) -> None:
    """A session hears whole frames and other bytes, and every request of it has an end."""
    session = Session(7, 9600, KIT.fingerprint)
    requests: list[Any] = [
        session.hello(), session.undo(), session.status(), session.fetch(), session.live(b"\x44"),
        session.upload(unpack(pack("SI", 0, bytes(80)))), session.trim(), session.name(b"X"),
    ]  # fmt: skip
    now_ms = 0
    seq = 7
    for number, delta, payload, is_frame in items:
        for _ in range(2):
            if session.poll(now_ms):
                seq = (seq + 1) & 0xFF
        frame = Frame(number, (seq + delta) & 0xFF, delta & 0xFF, payload, is_reply=True)
        session.receive(b"\0" + encode_frame(frame) if is_frame else payload + b"\0", now_ms)
        session.events()
        now_ms += 10 * (delta & 0x1F)
    session.stop(now_ms)
    for _ in range(200):
        session.poll(now_ms)
        now_ms += 50
    assert all(request.outcome is not None for request in requests)


def check_message(value: object) -> None:
    """A line of a shared port is a request that a session takes, or no message."""
    try:
        for read_message in MessageReader(1 << 20).read_messages(
            json.dumps(value).encode() + b"\n"
        ):
            ask = request_maker(read_message, 1000)
            session = Session(7, 9600, KIT.fingerprint)
            ask(session)
            for now_ms in range(0, 300, 50):
                session.poll(now_ms)
    except BadMessage:
        return


def check_line(data: bytes) -> None:
    """Any bytes of a stranger are a greeting, the beginning of one, or neither."""
    try:
        protocol.read_greeting(data)
        MessageReader(200).read_messages(data)
    except BadMessage:
        return


# -- generators --------------------------------------------------------------------------------

NUMBERS = [message.number for message in MESSAGES]
ITEMS = st.tuples(
    st.one_of(st.sampled_from(NUMBERS), st.integers(0, 63)),
    st.one_of(st.just(0), st.integers(-3, 40)),
    st.one_of(st.binary(max_size=PAYLOAD_BYTES), st.just(b"\0" + bytes(7))),
    st.booleans(),
)
_CLIENT: Any = ClientRequests()
RIGHT = [
    _CLIENT.hello().message, _CLIENT.undo().message, _CLIENT.name(b"X").message,
    _CLIENT.trim(b"abc").message, _CLIENT.start().message, _CLIENT.live(b"\x44\x01").message,
    _CLIENT.upload(unpack(pack("SI", 0, b"\x44"))).message,
]  # fmt: skip
VALUES = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=9)),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3), st.dictionaries(st.text(max_size=5), inner)
    ),
    max_leaves=5,
)  # fmt: skip
FIELDS = sorted({name for message in RIGHT for name in message})
NEAR = st.builds(
    lambda right, other: {**right, **other},
    st.sampled_from(RIGHT),
    st.dictionaries(
        st.sampled_from(FIELDS), st.one_of(VALUES, st.sampled_from(["00", "SI", "zz"]))
    ),
)  # fmt: skip
GREETING = b'{"tsc":"1.0","token":"' + b"0" * 32 + b'","verb":"stop"}\n'
STRANGERS = st.one_of(
    st.binary(max_size=300),
    st.builds(lambda cut, more: GREETING[:cut] + more, st.integers(0, 80), st.binary(max_size=40)),
)

KINDS: dict[str, tuple[Callable[..., None], SearchStrategy[Any]]] = {
    "compiler": (check_program, changed_texts("examples/*.ts")),
    "profiles": (check_profile, changed_texts("compiler/tiniscript/robots/*.toml")),
    "worlds": (check_world, changed_texts("compiler/tiniscript/virtual/worlds/*.toml")),
    "answers": (check_answers, st.lists(ITEMS, max_size=40)),
    "messages": (check_message, st.one_of(NEAR, VALUES)),
    "greetings": (check_line, STRANGERS),
}


def check_items(kind: str, count: int, number: int) -> None:
    """Check this many items of a kind, the same ones for the same number."""
    check, strategy = KINDS[kind]

    def check_value(value: Any) -> None:
        check(value)

    checked = settings(
        max_examples=count, deadline=None, database=None,
        suppress_health_check=list(HealthCheck),
    )(given(strategy)(check_value))  # fmt: skip
    seed(number)(checked)()


@pytest.mark.parametrize("kind", KINDS)
def test_any_input_is_accepted_or_refused(kind: str) -> None:
    check_items(kind, EXAMPLES, 1)


def main() -> None:
    parser = argparse.ArgumentParser(description="Make anything, and see that it is refused well.")
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    check_items(options.kind, options.count, options.seed)
    print(f"{options.count} runs of {options.kind}, nothing wrong; seed {options.seed}")


if __name__ == "__main__":
    main()
