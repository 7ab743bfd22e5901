"""The requests that a session makes: each is an exchange, which the session carries out.

Knows which exchange is made for which request. Knows no byte and no time.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

from tiniscript.bytecode.image import Image
from tiniscript.link import requests, wifi
from tiniscript.link.authority import KeyRing
from tiniscript.link.connection import DEADLINE_MS, PendingRequest
from tiniscript.link.handshake import Handshake
from tiniscript.link.messages import PLACES
from tiniscript.link.payloads import (
    EmptyReply,
    HelloReply,
    PingReply,
    ReceiptReply,
    StatusReply,
    TextReply,
    TrimReply,
    WifiReply,
)
from tiniscript.link.requests import DeviceInfo, Exchange, FetchedImage, Request
from tiniscript.link.robot_state import RobotState
from tiniscript.link.transmission import Transmission
from tiniscript.link.wifi import BrokerSettings, Network

CLAIM_LIMIT_MS = 45_000  # the robot waits for a hand on its button
T = TypeVar("T")


class PendingExchange(PendingRequest[T]):
    """An exchange and its timeout, from its first request on."""

    def __init__(
        self,
        exchange: Exchange[T],
        limit_ms: int = DEADLINE_MS,
        starts: bool = False,
        is_own: bool = False,
    ) -> None:
        super().__init__(limit_ms, starts)
        self.exchange = exchange
        self.deadline_ms = 0
        self.is_own = is_own  # made by the session itself
        self.is_busy = False  # the robot's last answer was BUSY
        self.shown = 0  # how often a key was shown again for it
        self.resumes: Interrupted | None = None


class Interrupted(NamedTuple):
    """An exchange whose request goes on when a key was shown again."""

    pending: PendingExchange[Any]
    transmission: Transmission


class SessionRequests:
    """The part of a session that makes exchanges and says what is known of the robot.

    `epoch` returns the robot's.
    """

    def __init__(
        self,
        nonce: int,
        kit: int,
        isa: tuple[int, int],
        keys: KeyRing | None,
        epoch: Callable[[], int],
    ) -> None:
        self.tells_places = False  # PLACE events are wanted
        self._state = RobotState()
        self._handshake = Handshake(nonce, kit, isa, self._state, keys, epoch)

    @property
    def robot(self) -> DeviceInfo | None:
        """The robot's description of itself, once it has answered HELLO."""
        return self._handshake.robot

    @property
    def is_latched(self) -> bool:
        return self._state.is_latched

    @property
    def is_running(self) -> bool:
        return self._state.is_running

    @property
    def is_open(self) -> bool:
        """Whether the robot has answered HELLO, and has not been lost since."""
        return self._handshake.is_open

    @property
    def run(self) -> int | None:
        """The last run that this session has started."""
        return self._state.run

    def _add(self, exchange: Exchange[T], starts: bool = False) -> PendingExchange[T]:
        raise NotImplementedError

    def hello(self) -> PendingExchange[HelloReply]:
        return self._add(self._handshake.hello())

    def ping(self) -> PendingExchange[PingReply]:
        return self._add(self._ping())

    def status(self) -> PendingExchange[StatusReply]:
        return self._add(self._status())

    def _ping(self, asks: bytes = b"") -> Exchange[PingReply]:
        ping = Request("PING", {"asks": asks})
        return self._handshake.with_key(lambda: requests.single(ping, PingReply))

    def _beat(self) -> Exchange[PingReply]:
        """Ping, and ask where the program is, if that is wanted and the robot tells it."""
        asks = self.tells_places and self.robot and self.robot.values.features & PLACES
        return self._ping(b"\1" if asks else b"")

    def _status(self) -> Exchange[StatusReply]:
        return self._handshake.with_key(lambda: requests.single(Request("STATUS"), StatusReply))

    def clear(self) -> PendingExchange[EmptyReply]:
        return self._add(self._handshake.open_then(requests.clear))

    def start(self, is_detached: bool = False) -> PendingExchange[ReceiptReply]:
        exchange = self._handshake.open_then(
            lambda: requests.start(is_detached, self._state.is_latched)
        )
        return self._add(exchange, starts=True)

    def live(self, code: bytes, kit: int = 0) -> PendingExchange[ReceiptReply]:
        """`kit` is the kit whose words the code uses, or 0 for none."""
        exchange = self._handshake.open_then(lambda: self._handshake.live(code, kit))
        return self._add(exchange, starts=True)

    def upload(
        self, image: Image, runs: bool = True, saves: bool = True, is_detached: bool = False,
        kit: int | None = None,
    ) -> PendingExchange[ReceiptReply]:  # fmt: skip
        mode = requests.mode_of(image, runs, saves, is_detached)
        exchange = self._handshake.open_then(lambda: self._handshake.upload(image, mode, kit))
        return self._add(exchange, starts=runs and image.start == "SI")

    def undo(self) -> PendingExchange[ReceiptReply]:
        """Have the robot hold the program before again; what runs ends."""
        request = Request("UNDO")
        return self._add(self._handshake.open_then(lambda: requests.patient(request, ReceiptReply)))

    def name(self, name: bytes) -> PendingExchange[EmptyReply]:
        return self._add(self._handshake.open_then(lambda: self._handshake.name(name)))

    def trim(self, trim: bytes = b"") -> PendingExchange[TrimReply]:
        """Set the trim of the motors, or only read it if `trim` is empty."""
        request = Request("TRIM", {"trim": trim})
        return self._add(self._handshake.open_then(lambda: requests.kept(request, TrimReply)))

    def fetch(self) -> PendingExchange[FetchedImage]:
        return self._add(self._handshake.with_key(requests.fetch))

    def identify(self) -> PendingExchange[EmptyReply]:
        identify = Request("IDENTIFY")
        return self._add(self._handshake.open_then(lambda: requests.single(identify, EmptyReply)))

    def claim(self, which: int) -> PendingExchange[EmptyReply]:
        """Claim the robot: `which` is one of KEYS. Waits until its button is held down."""
        pending = self._add(self._handshake.open_then(lambda: self._handshake.claim(which)))
        pending.limit_ms = CLAIM_LIMIT_MS
        return pending

    def disown(self, which: int) -> PendingExchange[EmptyReply]:
        return self._add(self._handshake.open_then(lambda: self._handshake.disown(which)))

    def hold_back(self) -> PendingExchange[EmptyReply]:
        return self._add(self._handshake.open_then(self._handshake.hold_back))

    def allow_text(self, is_allowed: bool) -> PendingExchange[TextReply]:
        return self._add(self._handshake.open_then(lambda: self._handshake.allow_text(is_allowed)))

    def wifi(self) -> PendingExchange[WifiReply]:
        """Ask what the robot's WiFi is set to."""
        return self._add(self._handshake.open_then(wifi.tell))

    def join(self, network: Network) -> PendingExchange[WifiReply]:
        """Have the robot join a network, or be its access point, now and after each reset."""
        return self._add(self._handshake.open_then(lambda: wifi.give(network)))

    def forget_wifi(self) -> PendingExchange[WifiReply]:
        return self._add(self._handshake.open_then(wifi.forget))

    def broker(self) -> PendingExchange[WifiReply]:
        """Ask which MQTT broker the robot uses."""
        return self._add(self._handshake.open_then(wifi.tell_broker))

    def use_broker(self, broker: BrokerSettings | None) -> PendingExchange[WifiReply]:
        """Have the robot use a broker, or none, now and after each reset."""
        return self._add(self._handshake.open_then(lambda: wifi.use_broker(broker)))
