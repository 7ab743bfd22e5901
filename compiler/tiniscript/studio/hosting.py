"""What a page may ask of the robots of this computer: which ports there are, and one robot a page.

A page is a random name that it has given itself; it drives one robot, and a port has one page. It
counts its connections: whatever comes late from one before reaches nothing of the next one, and the
same connect is done once. Of a pupil, whose name here is the class's own, `tab` is the name of the
page.
Knows no HTTP: `serving` lets only the page of this computer come here.
"""

from __future__ import annotations

from threading import Lock
from time import monotonic
from typing import Any

from tiniscript.base.languages import languages
from tiniscript.base.source import printable
from tiniscript.link import known_ports, ports
from tiniscript.link.port_names import canonical_port, exists
from tiniscript.studio.attending import LATCH_S
from tiniscript.studio.hosted_robot import PARTS_S, HostedRobot
from tiniscript.studio.robot_link import MOST_COUNT, BadRequest, Json, robot_of, whole_number
from tiniscript.virtual import directory

NAME_CHARACTERS = 64  # of a page
PORT_CHARACTERS = 300
MOST_ROBOTS = 40
MOST_ASKED = 8  # requests at a time
PORT_SHOWN = 200
_OVER: Json = {"news": [{"over": "left", "said": "", "number": 0}]}


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
            return {"ports": list_ports()}
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
            return _OVER
        if do == "stop":
            stops = 0
            try:
                if request.get("tab", page) == robot.tab:
                    stops = whole_number(request, "stops", 0, MOST_COUNT, 0)
            finally:  # whatever it counts
                robot.attending.stop(stops)
        if _connection(page, request) != (robot.tab, robot.connection):
            return _OVER
        if do == "leave":
            robot.leave()
        seen = whole_number(request, "seen", 0, MOST_COUNT, 0)
        stops = whole_number(request, "stops", 0, MOST_COUNT, 0)
        return {"news": robot.attending.on_beat(_requests(request), seen, stops)}

    def robot_of(self, page: str) -> HostedRobot | None:
        """Return what a page drives, or has driven last."""
        with self._lock:
            return self._by_page.get(page)

    def is_free(self, port: str) -> bool:
        """Return whether no page has a robot there, nor is one being left."""
        with self._lock:
            return not self._robots_at(port)

    def close(self) -> list[str]:
        """Stop what pages have started, and close all ports; return those where no robot has
        confirmed that."""
        with self._lock:
            hosted_robots = [*self._by_page.values(), *self._parting]
        for hosted_robot in hosted_robots:
            hosted_robot.leave(lets_go=True)
        for hosted_robot in hosted_robots:
            hosted_robot.join(PARTS_S)
        return [robot.port for robot in hosted_robots if robot.is_unconfirmed]

    def _connect(self, page: str, request: Json) -> Json:
        port, robot, language = port_of(request), robot_of(request), request.get("language")
        if language not in languages():
            raise BadRequest
        tab, connection = _connection(page, request)
        with self._lock:
            self._forget_ended()
            own = self._by_page.get(page)
            is_same = own is not None and own.tab == tab
            if own is not None and is_same and connection <= own.connection:
                own.attending.connect_again()  # the answer was lost, or it comes late
                return {}
            before = self._robots_at(port)
            rivals = [item for item in {*before, *([own] if own else ())} if _is_driving(item)]
            if not all(rival.tab == tab or rival.attending.is_half_made for rival in rivals):
                return {"failure": "other_tab"}
            for rival in rivals:  # nobody knows of it any more
                rival.leave()
            if sum(map(_is_driving, self._by_page.values())) >= MOST_ROBOTS:
                return {"failure": "too_many"}
            if own is not None:
                self._parting.append(own)
            stops = own.attending.stops if own is not None and is_same else 0
            hosted_robot = HostedRobot(port, robot, str(language), tab, connection, stops, before)
            hosted_robot.attending.latch(self._latched_until_s, stops=False)
            self._by_page[page] = hosted_robot
        return {}

    def _robots_at(self, port: str) -> list[HostedRobot]:
        """Return who has a port, or is closing it. One that holds it for another command shares it
        with whoever comes."""
        same = canonical_port(port)
        all_of_them = [*self._by_page.values(), *self._parting]
        held = [robot for robot in all_of_them
                if (robot.is_parting or not robot.has_ended) and not robot.holds]  # fmt: skip
        return [robot for robot in held if canonical_port(robot.port) == same]

    def _forget_ended(self) -> None:
        """Forget what has ended, once its page knows why or is not there any more."""
        all_of_them = dict.fromkeys([*self._by_page.values(), *self._parting])
        self._parting = [hosted_robot for hosted_robot in all_of_them if hosted_robot.is_parting]
        self._by_page = {name: robot for name, robot in self._by_page.items()
                         if not (robot.has_ended and robot.attending.has_left)}  # fmt: skip

    def _stop_all(self) -> Json:
        """Stop all robots, and refuse for a while what is on its way to them."""
        with self._lock:
            self._stopping = [robot for robot in self._by_page.values() if _is_driving(robot)]
            self._latched_until_s = monotonic() + LATCH_S
        for hosted_robot in self._stopping:
            hosted_robot.attending.latch()
        return self._stops()

    def _stops(self) -> Json:
        """Return what is known of the last STOP for all."""
        with self._lock:
            hosted_robots = self._stopping
        return {"robots": [{"name": robot.name or robot.port, "stop": robot.attending.last_stop}
                           for robot in hosted_robots]}  # fmt: skip


def list_ports() -> list[Json]:
    """Return the ports of this computer, the last used one first. Opens none of them.

    `name` is that of the robot that had answered there, `virtual` the profile of a virtual robot.
    """
    known = known_ports.remembered_ports()
    virtual = {item.address: item for item in directory.unclaimed_robots()}
    about = {item.port: item.description for item in ports.list_ports()}
    names = [*about, *(port for port in virtual if port not in about)]
    names += [port for port in known.names
              if port not in names and exists(port) and not directory.is_gone(port)]  # fmt: skip
    names.sort(key=lambda port: port != known.last_port)
    return [
        {
            "port": port,
            "name": virtual[port].name if port in virtual else known.names.get(port, ""),
            "description": printable(about.get(port, ""), PORT_SHOWN),
            "virtual": virtual[port].robot if port in virtual else None,
        }
        for port in names
    ]


def _is_driving(robot: HostedRobot) -> bool:
    return not robot.has_ended and not robot.is_parting


def _connection(page: str, request: Json) -> tuple[str, int]:
    """Return whose connection it is, and which of these. Raises BadRequest."""
    tab = _text(request, "tab", NAME_CHARACTERS) if "tab" in request else page
    return tab, whole_number(request, "connection", 0, MOST_COUNT, 0)


def port_of(request: Json) -> str:
    """Return the port of a request. Raises BadRequest."""
    port = _text(request, "port", PORT_CHARACTERS).strip()
    if not port:
        raise BadRequest
    return port


def _text(request: Json, name: str, most: int) -> str:
    result = request.get(name)
    if not isinstance(result, str) or not 1 <= len(result) <= most or not result.isprintable():
        raise BadRequest
    return result


def _requests(request: Json) -> list[Json]:
    requests: Any = request.get("asked", [])
    if not isinstance(requests, list) or len(requests) > MOST_ASKED:
        raise BadRequest
    if not all(isinstance(request, dict) for request in requests):
        raise BadRequest
    return requests
