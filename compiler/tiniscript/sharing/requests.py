"""What a guest may wish for: as a note that it writes, and as what the holder then asks.

Each wish is here twice, one above the other. Whatever comes in a note is looked at here, before
the session sees it.
"""

from __future__ import annotations

from collections.abc import Callable

from tiniscript.bytecode.image import STARTS, Image
from tiniscript.link.connection import Asked, Asks
from tiniscript.link.messages import NAME_BYTES, TRIM_BYTES
from tiniscript.link.requests import Reply
from tiniscript.sharing import protocol
from tiniscript.sharing.protocol import BadNote, Note

CODE_BYTES = 0x7FFF  # as an image's header can say
_PLAIN = ("hello", "ping", "status", "clear", "fetch")


class Wish:
    """Something that a guest has asked for: what `link.asking` says of it."""

    def __init__(self, do: str, starts: bool = False, **fields: object) -> None:
        self.note: Note = {"do": do, **fields}
        self.starts = starts
        self.limit_ms = 20_000
        self.done_bytes = 0
        self.outcome: Reply | None = None


class Wishes:
    """All that a guest can ask for: the same as a session."""

    def hello(self) -> Wish:
        return Wish("hello")

    def ping(self) -> Wish:
        return Wish("ping")

    def status(self) -> Wish:
        return Wish("status")

    def clear(self) -> Wish:
        return Wish("clear")

    def fetch(self) -> Wish:
        return Wish("fetch")

    def name(self, name: bytes) -> Wish:
        return Wish("name", name=name.hex())

    def trim(self, trim: bytes = b"") -> Wish:
        return Wish("trim", trim=trim.hex())

    def start(self, is_detached: bool = False) -> Wish:
        return Wish("start", starts=True, is_detached=is_detached)

    def live(self, code: bytes, kit: int = 0) -> Wish:
        return Wish("live", starts=True, code=code.hex(), kit=kit)

    def upload(
        self, image: Image, runs: bool = True, saves: bool = True, is_detached: bool = False
    ) -> Wish:
        return Wish(
            "upload",
            starts=runs and image.start == "SI",
            start=image.start,
            kit=image.kit,
            code=image.code.hex(),
            checksum=image.checksum,
            isa=bytes(image.isa).hex(),
            runs=runs,
            saves=saves,
            is_detached=is_detached,
        )


def asked_for(note: Note, limit_ms: int) -> Callable[[Asks], Asked]:
    """Return what asks a session for what a note wishes. Raises BadNote."""
    ask = _asked_for(note)

    def limited(session: Asks) -> Asked:
        task = ask(session)
        task.limit_ms = limit_ms
        return task

    return limited


def is_detached(note: Note) -> bool:
    """Return whether a note wishes for a run that needs nobody."""
    return note.get("is_detached") is True


def _asked_for(note: Note) -> Callable[[Asks], Asked]:
    do = protocol.word(note, "do")
    if do in _PLAIN:
        return lambda session: _plain(session, do)
    if do == "name":
        name = protocol.data(note, "name")
        if not 1 <= len(name) <= NAME_BYTES:
            raise BadNote
        return lambda session: session.name(name)
    if do == "trim":
        trim = protocol.data(note, "trim")
        if len(trim) not in (0, TRIM_BYTES):
            raise BadNote
        return lambda session: session.trim(trim)
    if do == "start":
        is_alone = protocol.answer(note, "is_detached")
        return lambda session: session.start(is_alone)
    if do == "live":
        code, kit = protocol.data(note, "code"), protocol.number(note, "kit")
        return lambda session: session.live(code, kit)
    if do == "upload":
        image = _image(note)
        runs, saves, is_alone = (
            protocol.answer(note, name) for name in ("runs", "saves", "is_detached")
        )
        return lambda session: session.upload(image, runs, saves, is_alone)
    raise BadNote


def _plain(session: Asks, do: str) -> Asked:
    asked: Asked = getattr(session, do)()
    return asked


def _image(note: Note) -> Image:
    start, code, isa = (
        protocol.word(note, "start"),
        protocol.data(note, "code"),
        protocol.data(note, "isa"),
    )
    kit, checksum = protocol.number(note, "kit"), protocol.number(note, "checksum")
    is_sound = start in STARTS[:2] and len(code) <= CODE_BYTES and len(isa) == 2
    if not is_sound or not 0 <= kit < 1 << 16 or not 0 <= checksum < 1 << 32:
        raise BadNote
    return Image(start, kit, code, checksum, (isa[0], isa[1]))
