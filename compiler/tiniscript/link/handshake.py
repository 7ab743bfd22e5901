"""HELLO: identifies computer and robot to each other; and the exchanges that need this.

Knows whether the robot has answered. Knows no frame and no time.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import Any, TypeVar

from tiniscript.bytecode.image import Image
from tiniscript.link import authority, requests, wifi
from tiniscript.link.authority import NOT_OWNER, KeyRing
from tiniscript.link.messages import (
    BREAKPOINTS,
    KEY_TEACHER,
    MAJOR,
    MINOR,
    OWNED,
    OWNERS,
    READINGS,
    SEALS,
    STATE_FAULTED,
    STATE_IDLE,
    STATE_RUNNING,
    STATUSES,
)
from tiniscript.link.outcomes import OTHER_ROBOT, UNPROVEN
from tiniscript.link.payloads import (
    REPLIES,
    AuthenticateReply,
    EmptyReply,
    HelloReply,
    PingReply,
    ReceiptReply,
    SentReply,
    StatusReply,
    TextReply,
    TrimReply,
)
from tiniscript.link.requests import OK, DeviceInfo, Exchange, Reply, Request, as_refusal
from tiniscript.link.robot_state import RobotState
from tiniscript.link.sealing import KEYLESS_MESSAGES

T = TypeVar("T")


class Handshake:
    """`nonce` is a random number of 32 bits; `kit` and `isa` are those of our programs; `keys`
    has the keys of robots; `current_epoch` returns the robot's; `place` is where it is reached.

    `is_open`: the robot has answered HELLO, and has not been lost since. `doubted` is the last
    epoch whose end is explained, while the end of a later one is not.
    """

    def __init__(
        self,
        nonce: int,
        kit: int,
        isa: tuple[int, int],
        state: RobotState,
        keys: KeyRing | None,
        current_epoch: Callable[[], int],
        place: str = "",
    ) -> None:
        self._nonce, self._kit, self._isa = nonce, kit, isa
        self._state = state
        self._keys = keys
        self._current_epoch = current_epoch
        self._place = place
        self.robot: DeviceInfo | None = None
        self.is_open = False
        self.doubted_epoch: int | None = None

    @property
    def is_in_doubt(self) -> bool:
        return self.doubted_epoch is not None

    def hello(self) -> Exchange[HelloReply]:
        values = {
            "major": MAJOR,
            "minor": MINOR,
            "isa_major": self._isa[0],
            "isa_minor": self._isa[1],
            "kit": self._kit,
            "nonce": self._nonce,
        }
        reply = yield from requests.send_single(Request("HELLO", values), HelloReply)
        if reply.status == OK:
            device_info = requests.device_info_of(reply.values)
            if authority.is_impostor(self._keys, self._place, device_info):
                self.is_open = False
                return Reply(OTHER_ROBOT, device_info.id)
            must_seal = authority.has_to_seal(self._keys, device_info)
            if must_seal and not device_info.values.features & SEALS:
                self.is_open = False
                return Reply(UNPROVEN)
            self.is_open = True
            if self._boot != reply.values.nonce:
                self._state.note_reset()
            self.robot = device_info
            self._state.state = reply.values.state
            is_owned = bool(device_info.values.features & OWNED)
            if is_owned or must_seal:
                key_reply = yield from self.authenticate(is_needed=must_seal and not is_owned)
                if key_reply.status == STATUSES["STALE"]:  # the robot was reset meanwhile
                    return as_refusal(key_reply)
                # The answer is sealed, and proves whether HELLO was genuine.
                if not is_owned and (key_reply.status != OK or key_reply.values.features & OWNED):
                    self.is_open = False
                    return Reply(UNPROVEN)
                return Reply(OK, 0, self.robot.values)
        return reply

    def open_then(self, make_exchange: Callable[[], Exchange[T]]) -> Exchange[T]:
        """Open the session if needed, then make and run an exchange; anew, after a reset or a
        fault. Requests that a stop has cancelled are not repeated: the session ensures that.
        """
        if not self.is_open or self.is_in_doubt:
            hello = yield from self.hello()
            if hello.status != OK:
                return as_refusal(hello)
        boot = self._boot
        reply = yield from self.with_key(make_exchange)
        if reply.status != STATUSES["STALE"]:
            return reply
        hello = yield from self.hello()
        resting_state = STATE_FAULTED if self._boot == boot else STATE_IDLE
        if hello.status in (OTHER_ROBOT, UNPROVEN):
            return as_refusal(hello)
        if hello.status != OK or self._state.state != resting_state:
            return reply
        # The frame arrived earlier, and was not carried out.
        return (yield from self.with_key(make_exchange))

    def with_key(self, make_exchange: Callable[[], Exchange[T]]) -> Exchange[T]:
        """Make and run an exchange; again, if the robot requires authentication first."""
        reply = yield from make_exchange()
        if reply.status not in (NOT_OWNER, STATUSES["HELD_BACK"]) or self._keys is None:
            return reply
        if not self.is_open:
            hello = yield from self.hello()
            if hello.status != OK:
                return as_refusal(hello)
        key_reply = yield from self.authenticate()
        if key_reply.status != OK:
            return as_refusal(reply if key_reply.status == NOT_OWNER else key_reply)
        return (yield from make_exchange())

    def authenticate(
        self, kind: int | None = None, is_needed: bool = True
    ) -> Exchange[AuthenticateReply]:
        """Try our keys of the robot; only `kind` if it is given. See `authority`."""
        assert self.robot
        keys, robot, nonce = self._keys, self.robot, self._nonce
        reply = yield from authority.authenticate(
            keys, robot, nonce, self._current_epoch, kind, is_needed
        )
        if reply.status == OK:
            self._take_features(reply.values.features)
            if keys is not None and robot.values.features & SEALS and self._place:
                keys.remember_robot(self._place, robot.id)
        return reply

    def _take_features(self, features: int) -> None:
        assert self.robot
        self.robot = requests.device_info_of(self.robot.values._replace(features=features))

    @property
    def _boot(self) -> int | None:
        """A number of the robot that is another one after each of its resets."""
        return self.robot.values.nonce if self.robot else None

    @property
    def is_unproven(self) -> bool:
        """Return whether unsealed frames may be forged, as far as our keys show."""
        return authority.has_to_seal(self._keys, self.robot)

    def may_have_done(self, name: str) -> bool:
        """Return whether this robot may have executed a request without a seal."""
        features = self.robot.values.features if self.robot else 0
        return name in KEYLESS_MESSAGES or features & (OWNED | SEALS) != OWNED | SEALS

    def prove_stopped(self, is_sealed: Callable[[], bool]) -> Exchange[StatusReply]:
        """Make a sealing robot prove that it is stopped."""
        hello = yield from self.hello()
        if hello.status != OK:
            return as_refusal(hello)
        reply = yield from status()
        if reply.status == OK and self.is_unproven:
            if not (is_sealed() and reply.values.state > STATE_RUNNING):
                return Reply(UNPROVEN)
        return reply

    def claim(self, kind: int) -> Exchange[EmptyReply]:
        assert self.robot
        if not self.robot.values.features & OWNERS:
            return Reply(STATUSES["UNKNOWN_MESSAGE"])
        assert self._keys is not None
        reply = yield from authority.claim(self._keys, self.robot, kind)
        if reply.status == OK:
            yield from self.authenticate()
        return reply

    def disown(self, kind: int) -> Exchange[EmptyReply]:
        assert self.robot and self._keys is not None
        reply = yield from authority.disown(self._keys, self.robot, kind)
        if reply.status == OK and kind != KEY_TEACHER:
            self._take_features(self.robot.values.features & ~OWNED)
        return reply

    def hold_back(self) -> Exchange[EmptyReply]:
        """Stop the robot so that only the teacher's key, or its button, releases it."""
        key_reply = yield from self.authenticate(KEY_TEACHER)
        if key_reply.status != OK:
            return as_refusal(key_reply)
        return (yield from requests.send_single(Request("STOP"), EmptyReply))

    def allow_text(self, is_allowed: bool) -> Exchange[TextReply]:
        request = Request("TEXT", {"is_allowed": int(is_allowed)})
        reply = yield from requests.send_single(request, TextReply)
        if reply.status == OK:
            self._take_features(reply.values.features)
        return reply

    def start(self, is_detached: bool) -> Exchange[ReceiptReply]:
        return requests.start(is_detached, self._state.is_latched)

    def live(self, code: bytes, kit: int, halts: bool) -> Exchange[ReceiptReply]:
        robot = yield from self._announce_kit(kit)
        if halts and not robot.values.features & BREAKPOINTS:
            return Reply(STATUSES["NO_BREAKPOINTS"])
        return (yield from requests.live(code, self._state.is_latched, kit, robot, halts))

    def upload(
        self, image: Image, runs: bool, saves: bool, is_detached: bool, kit: int | None
    ) -> Exchange[ReceiptReply]:
        kit = self._kit if kit is None else kit
        robot = yield from self._announce_kit(kit if image.devices else 0)
        mode = requests.mode_of(image, runs, saves, is_detached)
        is_latched = self._state.is_latched
        return (yield from requests.upload(image, mode, robot, self._isa, is_latched, kit))

    def break_at(self, places: bytes) -> Exchange[EmptyReply]:
        assert self.robot
        if places and not self.robot.values.features & BREAKPOINTS:
            return Reply(STATUSES["NO_BREAKPOINTS"])
        return (
            yield from requests.retry_while_busy(Request("BREAK", {"places": places}), EmptyReply)
        )

    def tell_readings(self, is_on: bool) -> Exchange[EmptyReply]:
        assert self.robot
        if not self.robot.values.features & READINGS:
            return Reply(STATUSES["NO_READINGS"])
        request = Request("TELL_READINGS", {"is_on": int(is_on)})
        return (yield from requests.send_single(request, EmptyReply))

    def name(self, name: bytes) -> Exchange[EmptyReply]:
        reply = yield from requests.save_and_confirm(Request("NAME", {"name": name}), EmptyReply)
        if reply.status in (OK, *requests.ACCEPTING_STATUSES) and self.robot:
            self.robot = requests.device_info_of(self.robot.values._replace(name=name))
        return reply

    def _announce_kit(self, kit: int) -> Generator[Request, Reply[SentReply], DeviceInfo]:
        """Repeat HELLO with the robot's kit if `kit` is that kit and HELLO named another one;
        return the robot's device info.

        This is needed because clients that share a session may have chosen different robots.
        """
        assert self.robot
        if kit != self._kit and kit == self.robot.kit:
            self._kit = kit
            yield from self.hello()
        return self.robot


def ping(question: bytes = b"") -> Exchange[PingReply]:
    return requests.send_single(Request("PING", {"asks": question}), PingReply)


def status() -> Exchange[StatusReply]:
    return requests.send_single(Request("STATUS"), StatusReply)


# Carries out those requests of a `Requester` that involve more than the message of their name.
_EXCHANGES: dict[str, Callable[..., Exchange[Any]]] = {
    "hello": Handshake.hello,
    "ping": lambda handshake: ping(),
    "clear": lambda handshake: requests.clear(),
    "start": Handshake.start,
    "live": Handshake.live,
    "upload": Handshake.upload,
    "undo": lambda handshake: requests.retry_while_busy(Request("UNDO"), ReceiptReply),
    "break_at": Handshake.break_at,
    "tell_readings": Handshake.tell_readings,
    "name": Handshake.name,
    "trim": lambda handshake, trim: requests.save_and_confirm(
        Request("TRIM", {"trim": trim}), TrimReply
    ),
    "fetch": lambda handshake: requests.fetch(),
    "claim": Handshake.claim,
    "disown": Handshake.disown,
    "hold_back": Handshake.hold_back,
    "allow_text": Handshake.allow_text,
    "wifi": lambda handshake: wifi.query("TELL"),
    "join": lambda handshake, network: wifi.join(network),
    "forget_wifi": lambda handshake: wifi.forget_network(),
    "broker": lambda handshake: wifi.query("TELL_BROKER"),
    "use_broker": lambda handshake, broker: wifi.use_broker(broker),
}


def exchange_by_name(name: str) -> Callable[..., Exchange[Any]]:
    """Return the function for the request of this name; it takes a handshake and arguments."""
    if name in _EXCHANGES:
        return _EXCHANGES[name]
    message = name.upper()
    return lambda handshake, **arguments: requests.send_single(
        Request(message, arguments), REPLIES[message]
    )


REQUESTS_WITHOUT_HELLO = ("ping", "status", "fetch")
