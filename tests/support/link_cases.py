"""Reads and plays the cases of the link: `link` and `packets` fences of Markdown files.

A `link` fence is a conversation. Rows without a time are commands: `host ...` of the session,
`robot ...` what happens to the robot, `wait N` milliseconds, `lose >` and `lose <` the next bytes
from either side, `late` that the robot looks at nothing before all has arrived. With rows `host
sends` (a frame), `host bytes` or `host types` (text), there is no session, and only the robot is
played.
Rows with a time are the results: `>` the bytes from the computer, `<` those from the robot (with
`x` where they are lost) and what they mean, `did` what the robot's link asks of the robot, `tells`
and `outcome` what the session says. Each side is played against the written bytes of the other.
Frequent rows have a name: a `rows NAME` fence has the rows without their time, and in the cases of
its file a time and the name refer to them.

A `packets` fence is for a receiver alone: `> bytes`, `wait N`, `held N` (bytes before a packet is
taken), and `=` what it finds. A `computer packets` fence is for the one in Python, a `robot
packets` fence for the one in C++. It may have many cases, each below a row with its subject.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from tests.machines.link import CppLink, Step
from tests.support.casefile import ROOT
from tiniscript.bytecode.image import pack, unpack
from tiniscript.link.connection import PendingRequest
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import (
    BY_NAME,
    BY_NUMBER,
    FIRST_EVENT,
    LARGE_WINDOW,
    Malformed,
    decode_payload,
    encode_payload,
)
from tiniscript.link.receiver import LARGE_PACKET, SMALL_PACKET, Receiver
from tiniscript.link.requests import OK
from tiniscript.link.sender import Sender
from tiniscript.link.session import Session
from tiniscript.link.sharing.protocol import event_fields
from tiniscript.link.statuses import name_of

STEP_MS = 10
KIT = 0x231B
SHOWN_BYTES = 24  # bytes shown of a longer packet
PACKET_ROW = re.compile("[>=]|wait |held ")
KINDS = ("link", "packets", "computer packets", "robot packets")


class LinkCase(NamedTuple):
    path: Path
    line: int  # line of the fence
    kind: str
    title: str
    rows: list[str]

    @property
    def id(self) -> str:
        return f"{self.path.stem}: {self.title}"


def documents() -> list[Path]:
    return [*sorted(ROOT.glob("tests/cases/link*.md")), ROOT / "docs" / "develop" / "link.md"]


def link_cases(kind: str) -> list[LinkCase]:
    """Return the cases of one kind. They are found, never listed."""
    return [case for path in documents() for case in _read(path) if case.kind == kind]


def _read(path: Path) -> list[LinkCase]:
    cases: list[LinkCase] = []
    rows_by_name = names_of(path)
    title, fence = "", ""
    for number, row in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if row.startswith("```"):
            fence = "" if fence else row[3:].strip() or "text"
            if fence in KINDS:
                cases.append(LinkCase(path, number, fence, title, []))
        elif fence in KINDS[1:] and not PACKET_ROW.match(row):
            if not cases[-1].rows:
                cases.pop()  # the case of the heading above, which has no code
            cases.append(LinkCase(path, number, fence, row, []))
        elif fence in KINDS:
            time, _, name = row.lstrip().partition(" ")
            lines = rows_by_name.get(name, []) if time.isdigit() else []
            cases[-1].rows.extend([f"{time:>6} {text}" for text in lines] or [row])
        elif not fence and row.startswith("#"):
            title = row.lstrip("# ")
    return cases


def names_of(path: Path) -> dict[str, list[str]]:
    """Return the rows that have a name, without their time."""
    fences = re.findall(r"(?ms)^```rows (\w+)\n(.*?)^```$", path.read_text(encoding="utf-8"))
    return {name: rows.splitlines() for name, rows in fences}


def accept(case: LinkCase, rows: list[str]) -> None:
    """Write the results into the case if they differ; git shows the changes."""
    written_case = next(link_case for link_case in _read(case.path) if link_case[2:] == case[2:])
    old_lines = case.path.read_text(encoding="utf-8").splitlines()
    is_over = re.compile(r"```" if case.kind == "link" else rf"(?!{PACKET_ROW.pattern})").match
    end = next(k for k in range(written_case.line, len(old_lines)) if is_over(old_lines[k]))
    old_lines[written_case.line : end] = shorten(rows, names_of(case.path))
    case.path.write_text("\n".join(old_lines) + "\n", encoding="utf-8")


def shorten(rows: list[str], named_mapping: Mapping[str, list[str]]) -> list[str]:
    """Return rows with names for those that have one."""
    shortened_rows = []
    while rows:
        time = rows[0][:7]
        for name, value in named_mapping.items():
            if rows[: len(value)] == [time + row for row in value]:
                shortened_rows.append(time + name)
                rows = rows[len(value) :]
                break
        else:
            shortened_rows.append(rows[0])
            rows = rows[1:]
    return shortened_rows


# -- conversations --------------------------------------------------------------------------------


class Computer(Protocol):
    def ask(self, words: list[str]) -> None: ...
    def poll(self, now_ms: int) -> bytes: ...
    def receive(self, data: bytes, now_ms: int) -> None: ...
    def outcome_rows(self) -> list[str]: ...


class Robot(Protocol):
    def let_happen(self, words: list[str]) -> None: ...
    def step(self, now_ms: int, data: bytes, is_late: bool) -> Step: ...


def play(rows: Iterable[str], computer: Computer, robot: Robot) -> list[str]:
    """Return the rows of a conversation: the requests, and their results."""
    played_rows = []
    now_ms = 0
    is_late = False
    losses_by_side = {">": 0, "<": 0}
    for row in rows:
        words = row.split()
        if not words or words[0].isdigit():
            continue
        played_rows.append(row)
        steps = 1
        if words[0] == "host":
            computer.ask(words[1:])
        elif words[0] == "robot":
            robot.let_happen(words[1:])
        elif words[0] == "lose":
            losses_by_side[words[1]] += 1
            continue
        elif words[0] == "late":
            is_late = True
            steps = 0
        else:
            assert words[0] == "wait", row
            steps = int(words[1]) // STEP_MS
        for _ in range(steps):
            data = computer.poll(now_ms)
            mark = _mark(">", data, losses_by_side)
            step = robot.step(now_ms, b"" if mark == ">x" else data, is_late)
            reply_mark = _mark("<", step.sent, losses_by_side)
            computer.receive(b"" if reply_mark == "<x" else step.sent, now_ms)
            if data:
                played_rows += wire_rows(now_ms, mark, data)
            played_rows += [f"{now_ms:6} did {row}" for row in step.did]
            if step.sent:
                played_rows += wire_rows(now_ms, reply_mark, step.sent)
            played_rows += [f"{now_ms:6} {row}" for row in computer.outcome_rows()]
            now_ms += STEP_MS
            is_late = False
    return played_rows


def _mark(side: str, data: bytes, losses_by_side: dict[str, int]) -> str:
    if data and losses_by_side[side]:
        losses_by_side[side] -= 1
        return side + "x"
    return side


def wire_rows(now_ms: int, mark: str, data: bytes) -> list[str]:
    """Return the rows of some bytes: one for each packet."""
    rows = []
    for packet in re.findall(rb"\0+|[^\0]+\0?", data):
        packet_text = packet.hex(" ")
        rows.append(f"{now_ms:6} {mark} {packet_text}    {meaning(packet)}".rstrip())
    return rows


def meaning(packet: bytes) -> str:
    """Return the meaning of a packet's bytes in words."""
    body = packet.rstrip(b"\0")
    if not body:
        return ""
    if body[0] >= 0x41 or re.match(rb"[\r\n]*[ -~](?:[ -~\r\n]|\Z)", body):  # no frame begins so
        return repr(body.decode("latin-1"))
    frame = decode_frame(body)
    return "damaged" if frame is None else frame_text(frame)


def frame_text(frame: Frame) -> str:
    message = BY_NUMBER.get(frame.number)
    if message is None:
        name, fields = f"message {frame.number}", None
    elif frame.is_reply:
        name, fields = message.name, message.reply
    else:
        name, fields = message.name, message.request
    words = [name]
    payload = frame.payload
    if frame.is_reply and frame.number < FIRST_EVENT:
        words.append(f"-> {name_of(payload[0])}")
        if payload[0]:
            return " ".join([*words, str(int.from_bytes(payload[1:3], "little"))])
        payload = payload[1:]
    if fields is None:
        return " ".join([*words, payload.hex(" ")]).strip()
    try:
        values = decode_payload(fields, payload)
    except Malformed:
        return " ".join([*words, "with a payload that does not fit"])
    return " ".join([*words, *(f"{name}={format_value(value)}" for name, value in values.items())])


def format_value(value: int | bytes) -> str:
    if isinstance(value, int):
        return str(value)
    shown_hex = value[:SHOWN_BYTES].hex() + ("..." if len(value) > SHOWN_BYTES else "")
    return shown_hex or "-"


class SessionSide:
    """The computer's half, for real."""

    def __init__(self) -> None:
        self.session = Session(nonce=0x01020304, kit=KIT)
        self.pending_requests: list[PendingRequest[Any]] = []
        self.now_ms = 0

    def ask(self, words: list[str]) -> None:
        session, rest = self.session, words[1:]
        data = bytes.fromhex(" ".join(word for word in rest if "=" not in word))
        flags = dict(word.split("=") for word in rest if "=" in word)
        if words[0] == "stop":
            session.stop(self.now_ms)
            return
        if words[0] == "places":
            session.tells_places = True
            return
        actions: dict[str, Callable[[], PendingRequest[Any]]] = {
            "start": lambda: session.start("detached" in flags),
            "live": lambda: session.live(data),
            "name": lambda: session.name(data),
            "upload": lambda: session.upload(
                unpack(pack(flags.get("start", "SI"), int(flags.get("devices", "0")), data)),
                runs=flags.get("run") != "no",
                saves=flags.get("save") != "no",
                kit=int(flags["kit"]) if "kit" in flags else None,
            ),
        }
        values = {name: int(value, 0) for name, value in flags.items() if value.isdecimal()}
        ask = actions.get(words[0]) or partial(getattr(session, words[0]), **values)
        self.pending_requests.append(ask())

    def poll(self, now_ms: int) -> bytes:
        self.now_ms = now_ms
        return self.session.poll(now_ms)

    def receive(self, data: bytes, now_ms: int) -> None:
        self.session.receive(data, now_ms)

    def outcome_rows(self) -> list[str]:
        rows = [_row("tells " + event.name, event_fields(event)) for event in self.session.events()]
        for request in [
            pending_request for pending_request in self.pending_requests if pending_request.outcome
        ]:
            assert request.outcome
            name = {-1: "LOST", -2: "CANCELLED"}.get(request.outcome.status)
            name = name or name_of(request.outcome.status)
            detail = f" {request.outcome.detail}" if request.outcome.detail else ""
            values = request.outcome.values._asdict() if request.outcome.status == OK else {}
            rows.append(_row(f"outcome {name}{detail}", values))
            self.pending_requests.remove(request)
        return rows


def _row(head: str, values: Mapping[str, int | bytes]) -> str:
    return " ".join([head, *(f"{name}={format_value(value)}" for name, value in values.items())])


class HandSender:
    """No session: frames and bytes as the rows want them, with a 0x00 before frames by the rule."""

    def __init__(self) -> None:
        self.sender = Sender()
        self.data = b""
        self.is_frame = self.is_hello = False

    def ask(self, words: list[str]) -> None:
        self.is_frame = words[0] == "sends"
        if words[0] == "bytes":
            self.data = bytes.fromhex(" ".join(words[1:]))
            return
        if words[0] == "types":
            self.data = ast.literal_eval("b" + " ".join(words[1:]))
            return
        seq, epoch, name, *rest = words[1:]
        message = BY_NAME[name]
        texts = dict(word.split("=") for word in rest)
        values = {
            field.name: bytes.fromhex(texts[field.name].replace("-", ""))
            if field.kind == "rest"
            else int(texts[field.name])
            for field in message.request
            if field.name in texts
        }
        payload = encode_payload(message.request, values)
        self.is_hello = name == "HELLO"
        self.data = encode_frame(Frame(message.number, int(seq), int(epoch), payload))

    def poll(self, now_ms: int) -> bytes:
        data, self.data = self.data, b""
        if data and self.is_frame:
            return self.sender.prepare_frames(data, now_ms, self.is_hello)
        if data.endswith(b"\0"):
            return self.sender.prepare_stop(data, now_ms)
        self.sender = Sender() if data else self.sender  # text: the next frame needs a 0x00
        return data

    def receive(self, data: bytes, now_ms: int) -> None: ...
    def outcome_rows(self) -> list[str]:
        return []


def computer_of(case: LinkCase) -> HandSender | SessionSide:
    return SessionSide() if has_session(case) else HandSender()


def has_session(case: LinkCase) -> bool:
    rows = [row.split()[:2] for row in case.rows]
    return not any(["host", kind] in rows for kind in ("sends", "bytes", "types"))


class CppSide:
    """The robot's half, for real."""

    def __init__(self, cpp: CppLink) -> None:
        self.cpp = cpp
        cpp.begin(kit=KIT)

    def let_happen(self, words: list[str]) -> None:
        letters = {"done": "d", "fault": "f", "show": "s", "button": "b", "released": "r",
                   "busy": "w", "saving": "k", "at": "a", "tells": "o", "off": "!"}  # fmt: skip
        if letters[words[0]] == "!":
            self.cpp.begin(kit=KIT, epoch=77)
        else:
            self.cpp.let_happen(letters[words[0]], int(words[1]) if len(words) > 1 else 0)

    def step(self, now_ms: int, data: bytes, is_late: bool) -> Step:
        return self.cpp.step(now_ms, data, is_late)


class WrittenSide:
    """Either half, as the rows of a case say it."""

    def __init__(self, rows: list[str]) -> None:
        self.rows = [row.split() for row in rows if row.split() and row.split()[0].isdigit()]

    def _data(self, now_ms: int, side: str) -> bytes:
        parts = []
        for time, mark, *words in self.rows:
            if int(time) == now_ms and mark.rstrip("x") == side:
                parts.append(re.match(r"(?:[0-9a-f]{2} )*(?:[0-9a-f]{2}\b)", " ".join(words)))
        return b"".join(bytes.fromhex(part[0]) for part in parts if part)

    def _rows(self, now_ms: int, *kinds: str) -> list[str]:
        rows = [row for row in self.rows if int(row[0]) == now_ms and row[1] in kinds]
        return [" ".join(row[1:]) for row in rows]

    # Frames from the computer.
    def ask(self, words: list[str]) -> None: ...
    def poll(self, now_ms: int) -> bytes:
        self.now_ms = now_ms
        return self._data(now_ms, ">")

    def receive(self, data: bytes, now_ms: int) -> None: ...
    def outcome_rows(self) -> list[str]:
        return self._rows(self.now_ms, "tells", "outcome")

    # Frames from the robot.
    def let_happen(self, words: list[str]) -> None: ...
    def step(self, now_ms: int, data: bytes, is_late: bool) -> Step:
        actions = [row.removeprefix("did ") for row in self._rows(now_ms, "did")]
        return Step(self._data(now_ms, "<"), actions)


# -- a receiver alone -----------------------------------------------------------------------------


def stream_of(case: LinkCase) -> tuple[list[tuple[int, int]], int]:
    """Return the times and bytes of a `packets` fence, and how long a packet is held."""
    stream = []
    now_ms = held_ms = 0
    for row in case.rows:
        words = row.split()
        if words[0] == ">":
            for word in re.findall(r'"[^"]*"|\S+', row[1:]):
                data = word[1:-1].encode() if word[0] == '"' else bytes.fromhex(word)
                stream += [(now_ms, byte) for byte in data]
        elif words[0] == "wait":
            now_ms += int(words[1])
        elif words[0] == "held":
            held_ms = int(words[1])
    return stream, held_ms


def packets_of(
    stream: Iterable[tuple[int, int]], held_ms: int = 0, is_large: bool = False
) -> list[str]:
    """Return the packets that the receiver in Python finds: the same rows as the one in C++.

    A large one holds several large frames.
    """
    packet_bytes, window = (LARGE_PACKET, LARGE_WINDOW) if is_large else (SMALL_PACKET, 1)
    receiver = Receiver(packet_bytes, window)
    rows = []
    bytes_left = 0
    for now_ms, byte in stream:
        if bytes_left:
            bytes_left -= 1
            if not bytes_left:
                receiver.take()
        if receiver.put(byte, now_ms):
            rows.append("stop")
        packet = receiver.packet
        if packet is None or bytes_left:
            continue
        row = f"{'text' if packet.is_text else 'frame'} {packet.length} {packet.data.hex(' ')}"
        if not packet.is_text:
            row += " damaged" if decode_frame(packet.data) is None else " whole"
        rows.append(row)
        bytes_left = held_ms + 1
        if not held_ms:
            receiver.take()
            bytes_left = 0
    assert all(len(bytes.fromhex(" ".join(re.findall(r"\b[0-9a-f]{2}\b", row.split(" ", 2)[2]))))
               <= packet_bytes for row in rows if row[0] in "ft")  # fmt: skip
    return [
        *rows,
        f"damaged {receiver.damaged_count % 256}, dropped {receiver.dropped_count % 256}",
    ]


def with_new_results(case: LinkCase, rows: list[str]) -> list[str]:
    return [*(row for row in case.rows if row[:1] != "="), *(f"= {row}" for row in rows)]
