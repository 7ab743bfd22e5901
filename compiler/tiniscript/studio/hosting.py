"""What a page may ask of the robots of this computer: which ports there are, and one robot a page.

A page is a random name that it has given itself; it drives one robot, and a port has one page.
Knows no HTTP: `serving` lets only the page of this computer come here.
"""

from __future__ import annotations

from threading import Lock
from time import monotonic
from typing import Any

from tiniscript.base.languages import languages
from tiniscript.base.source import printable
from tiniscript.link import known_ports, ports
from tiniscript.link.port_names import is_there, same_for_all
from tiniscript.studio.attending import LATCH_S
from tiniscript.studio.hosted_robot import HostedRobot
from tiniscript.studio.robot_link import MOST_COUNT, BadRequest, Json, robot_of, whole
from tiniscript.virtual import directory

NAME_CHARACTERS = 64  # of a page
PORT_CHARACTERS = 300
MOST_ROBOTS = 40
MOST_ASKED = 8  # requests at a time
END_S = 8.0  # for stops to be confirmed when the server ends
PORT_SHOWN = 200


class Hosting:
    """All robots that pages of this server drive. Any thread may call it."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._by_page: dict[str, HostedRobot] = {}
        self._parting: list[HostedRobot] = []
        self._stopping: list[HostedRobot] = []  # those that the last STOP for all has reached
        self._latched_until_s = 0.0

    def answer(self, request: Json) -> Json:
        """Return the answer to a page's request. Raises BadRequest."""
        do = request.get("do")
        if do == "ports":
            return {"ports": listed()}
        if do == "stop_all":
            return self._stop_all()
        if do == "stops":
            return self._stops()
        page = _text(request, "page", NAME_CHARACTERS)
        if do == "connect":
            return self._connect(page, request)
        with self._lock:
            robot = self._by_page.get(page)
        if do not in ("beat", "stop", "leave"):
            raise BadRequest
        if robot is None:
            return {"news": [{"over": "left", "said": "", "number": 0}]}
        if do == "stop":
            stops = 0
            try:
                stops = whole(request, "stops", 0, MOST_COUNT, 0)
            finally:  # whatever it counts
                robot.attending.stop(stops)
        elif do == "leave":
            robot.leave()
        seen = whole(request, "seen", 0, MOST_COUNT, 0)
        return {"news": robot.attending.on_requests(_requests(request), seen)}

    def robot_of(self, page: str) -> HostedRobot | None:
        """Return what a page drives, or has driven last."""
        with self._lock:
            return self._by_page.get(page)

    def is_free(self, port: str) -> bool:
        """Return whether no page has a robot there, nor is one being left."""
        with self._lock:
            all_of_them = [*self._by_page.values(), *self._parting]
        held = [each for each in all_of_them if each.is_parting or not each.has_ended]
        return same_for_all(port) not in {same_for_all(each.port) for each in held}

    def close(self) -> None:
        """Stop what pages have started, and close all ports."""
        with self._lock:
            found = [*self._by_page.values(), *self._parting]
        for each in found:
            each.leave()
        for each in found:
            each.join(END_S)

    def _connect(self, page: str, request: Json) -> Json:
        port, robot, language = port_of(request), robot_of(request), request.get("language")
        if language not in languages():
            raise BadRequest
        with self._lock:
            self._forget_ended()
            own = self._by_page.get(page)
            if own is not None and not own.has_ended:
                return {"failure": "connected"}
            taken = [same_for_all(each.port) for each in self._by_page.values()
                     if not each.has_ended]  # fmt: skip
            if same_for_all(port) in taken:
                return {"failure": "other_tab"}
            if len(taken) >= MOST_ROBOTS:
                return {"failure": "too_many"}
            made = HostedRobot(port, robot, str(language))
            made.attending.latch(self._latched_until_s, stops=False)
            self._by_page[page] = made
        return {}

    def _forget_ended(self) -> None:
        """Forget what has ended, once its page knows why or is not there any more."""
        all_of_them = [*self._by_page.values(), *self._parting]
        self._parting = [each for each in all_of_them if each.is_parting]
        self._by_page = {name: each for name, each in self._by_page.items()
                         if not (each.has_ended and each.attending.has_left)}  # fmt: skip

    def _stop_all(self) -> Json:
        """Stop all robots, and refuse for a while what is on its way to them."""
        with self._lock:
            self._stopping = [each for each in self._by_page.values() if not each.has_ended]
            self._latched_until_s = monotonic() + LATCH_S
        for each in self._stopping:
            each.attending.latch()
        return self._stops()

    def _stops(self) -> Json:
        """Return what is known of the last STOP for all."""
        with self._lock:
            found = self._stopping
        return {"robots": [{"name": each.name or each.port, "stop": each.attending.last_stop}
                           for each in found]}  # fmt: skip


def listed() -> list[Json]:
    """Return the ports of this computer, the last used one first. Opens none of them.

    `name` is that of the robot that had answered there, `virtual` the profile of a virtual robot.
    """
    known = known_ports.known()
    virtual = {each.address: each for each in directory.for_all()}
    about = {each.port: each.description for each in ports.listed()}
    names = [*about, *(port for port in virtual if port not in about)]
    names += [port for port in known.names
              if port not in names and is_there(port) and not directory.is_gone(port)]  # fmt: skip
    names.sort(key=lambda port: port != known.last)
    return [
        {
            "port": port,
            "name": virtual[port].name if port in virtual else known.names.get(port, ""),
            "description": printable(about.get(port, ""), PORT_SHOWN),
            "virtual": virtual[port].robot if port in virtual else None,
        }
        for port in names
    ]


def port_of(request: Json) -> str:
    """Return the port of a request. Raises BadRequest."""
    port = _text(request, "port", PORT_CHARACTERS).strip()
    if not port:
        raise BadRequest
    return port


def _text(request: Json, name: str, most: int) -> str:
    found = request.get(name)
    if not isinstance(found, str) or not 1 <= len(found) <= most or not found.isprintable():
        raise BadRequest
    return found


def _requests(request: Json) -> list[Json]:
    found: Any = request.get("asked", [])
    if not isinstance(found, list) or len(found) > MOST_ASKED:
        raise BadRequest
    if not all(isinstance(each, dict) for each in found):
        raise BadRequest
    return found
