"""Requests of pages to the robots of this computer: the ports, and one robot for each page.

A page is a random name that it has given itself; it drives one robot, and a port has one page. It
counts its connections: whatever comes late from one before reaches nothing of the next one, and the
same connect is done once. For a pupil, whose name here is given by the class, `tab` is the name of
the page.
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
from tiniscript.studio.hosted_robot import PARTING_TIMEOUT_S, HostedRobot
from tiniscript.studio.robot_link import MAX_COUNT, BadRequest, Json, robot_of, whole_number
from tiniscript.virtual import directory

NAME_CHARACTERS = 64  # most characters of a page's name
PORT_CHARACTERS = 300
MAX_ROBOTS = 40
MAX_REQUESTS = 8  # requests at a time
DESCRIPTION_CHARACTERS = 200
_OVER_ANSWER: Json = {"news": [{"over": "left", "said": "", "number": 0}]}


class Hosting:
    """All robots that pages of this server drive. Any thread may call it."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._robot_by_page: dict[str, HostedRobot] = {}
        self._parting_robots: list[HostedRobot] = []
        self._stopped_robots: list[HostedRobot] = []  # robots reached by the last STOP for all
        self._latched_until_s = 0.0

    def answer(self, request: Json) -> Json:
        """Return the answer to a page's request. Raises BadRequest."""
        action = request.get("do")
        if action == "ports":
            return {"ports": list_ports()}
        if action == "stop_all":
            return self._stop_all()
        if action == "stops":
            return self._stop_states()
        page = _text(request, "page", NAME_CHARACTERS)
        if action == "connect":
            return self._connect(page, request)
        with self._lock:
            robot = self._robot_by_page.get(page)
        if action not in ("beat", "stop", "leave"):
            raise BadRequest
        if robot is None:
            return _OVER_ANSWER
        if action == "stop":
            stop_count = 0
            try:
                if request.get("tab", page) == robot.tab:
                    stop_count = whole_number(request, "stops", 0, MAX_COUNT, 0)
            finally:  # whatever it counts
                robot.attending.stop(stop_count)
        if _connection(page, request) != (robot.tab, robot.connection):
            return _OVER_ANSWER
        if action == "leave":
            robot.leave()
        seen_number = whole_number(request, "seen", 0, MAX_COUNT, 0)
        stop_count = whole_number(request, "stops", 0, MAX_COUNT, 0)
        return {"news": robot.attending.on_beat(_requests(request), seen_number, stop_count)}

    def robot_of(self, page: str) -> HostedRobot | None:
        """Return the robot that a page drives, or has driven last."""
        with self._lock:
            return self._robot_by_page.get(page)

    def is_free(self, port: str) -> bool:
        """Return whether no page has a robot there, nor is one being left."""
        with self._lock:
            return not self._robots_at(port)

    def close(self) -> list[str]:
        """Stop what pages have started, and close all ports; return those if no robot has
        confirmed that."""
        with self._lock:
            # One that is parting may still be the robot that its page has driven last.
            hosted_robots = dict.fromkeys([*self._robot_by_page.values(), *self._parting_robots])
        for hosted_robot in hosted_robots:
            hosted_robot.leave(is_letting_go=True)
        for hosted_robot in hosted_robots:
            hosted_robot.join(PARTING_TIMEOUT_S)
        return [robot.port for robot in hosted_robots if robot.is_unconfirmed]

    def _connect(self, page: str, request: Json) -> Json:
        port, profile_name, language = port_of(request), robot_of(request), request.get("language")
        if language not in languages():
            raise BadRequest
        tab, connection = _connection(page, request)
        with self._lock:
            self._forget_ended()
            page_robot = self._robot_by_page.get(page)
            is_same = page_robot is not None and page_robot.tab == tab
            if page_robot is not None and is_same and connection <= page_robot.connection:
                page_robot.attending.connect_again()  # the answer was lost, or is late
                return {}
            port_robots = self._robots_at(port)
            rivals = [
                rival
                for rival in {*port_robots, *([page_robot] if page_robot else ())}
                if _is_driving(rival)
            ]
            if not all(rival.tab == tab or rival.attending.is_half_made for rival in rivals):
                return {"failure": "other_tab"}
            for rival in rivals:  # no page refers to it any more
                rival.leave()
            if sum(map(_is_driving, self._robot_by_page.values())) >= MAX_ROBOTS:
                return {"failure": "too_many"}
            if page_robot is not None:
                self._parting_robots.append(page_robot)
            stop_count = (
                page_robot.attending.stop_count if page_robot is not None and is_same else 0
            )
            hosted_robot = HostedRobot(
                port, profile_name, str(language), tab, connection, stop_count, port_robots
            )
            hosted_robot.attending.latch(self._latched_until_s, is_stopping=False)
            self._robot_by_page[page] = hosted_robot
        return {}

    def _robots_at(self, port: str) -> list[HostedRobot]:
        """Return the robots that use a port, or are closing it. One that holds it for another
        command shares it.
        """
        wanted_port = canonical_port(port)
        all_robots = [*self._robot_by_page.values(), *self._parting_robots]
        open_robots = [
            robot
            for robot in all_robots
            if (robot.is_parting or not robot.has_ended) and not robot.is_holding_port
        ]
        return [robot for robot in open_robots if canonical_port(robot.port) == wanted_port]

    def _forget_ended(self) -> None:
        """Forget what has ended, once its page knows why or is not there any more."""
        all_robots = dict.fromkeys([*self._robot_by_page.values(), *self._parting_robots])
        self._parting_robots = [
            hosted_robot for hosted_robot in all_robots if hosted_robot.is_parting
        ]
        self._robot_by_page = {name: robot for name, robot in self._robot_by_page.items()
                         if not (robot.has_ended and robot.attending.has_left)}  # fmt: skip

    def _stop_all(self) -> Json:
        """Stop all robots, and refuse requests under way for a while."""
        with self._lock:
            self._stopped_robots = [
                robot for robot in self._robot_by_page.values() if _is_driving(robot)
            ]
            self._latched_until_s = monotonic() + LATCH_S
        for hosted_robot in self._stopped_robots:
            hosted_robot.attending.latch()
        return self._stop_states()

    def _stop_states(self) -> Json:
        """Return the state of the last STOP for all."""
        with self._lock:
            hosted_robots = self._stopped_robots
        return {"robots": [{"name": robot.name or robot.port, "stop": robot.attending.last_stop}
                           for robot in hosted_robots]}  # fmt: skip


def list_ports() -> list[Json]:
    """Return the ports of this computer: the last used one, then those where a robot is known, then
    any others. Opens none of them.

    `name` is that of the robot that had answered there, `virtual` the profile of a virtual robot.
    """
    port_memory = known_ports.remembered_ports()
    virtual_robots = {robot.address: robot for robot in directory.unclaimed_robots()}
    description_by_port = {robot.port: robot.description for robot in ports.list_ports()}
    port_names = [
        *description_by_port,
        *(port for port in virtual_robots if port not in description_by_port),
    ]
    port_names += [
        port
        for port in port_memory.name_by_port
        if port not in port_names and exists(port) and not directory.is_gone(port)
    ]
    port_names.sort(
        key=lambda port: (
            port != port_memory.last_port,
            port not in virtual_robots and port not in port_memory.name_by_port,
        )
    )
    return [
        {
            "port": port,
            "name": virtual_robots[port].name
            if port in virtual_robots
            else port_memory.name_by_port.get(port, ""),
            "description": printable(description_by_port.get(port, ""), DESCRIPTION_CHARACTERS),
            "virtual": virtual_robots[port].robot if port in virtual_robots else None,
        }
        for port in port_names
    ]


def _is_driving(robot: HostedRobot) -> bool:
    return not robot.has_ended and not robot.is_parting


def _connection(page: str, request: Json) -> tuple[str, int]:
    """Return the page of a connection, and its number. Raises BadRequest."""
    tab = _text(request, "tab", NAME_CHARACTERS) if "tab" in request else page
    return tab, whole_number(request, "connection", 0, MAX_COUNT, 0)


def port_of(request: Json) -> str:
    """Return the port of a request. Raises BadRequest."""
    port = _text(request, "port", PORT_CHARACTERS).strip()
    if not port:
        raise BadRequest
    return port


def _text(request: Json, name: str, most_characters: int) -> str:
    text = request.get(name)
    if not isinstance(text, str) or not 1 <= len(text) <= most_characters or not text.isprintable():
        raise BadRequest
    return text


def _requests(request: Json) -> list[Json]:
    requests: Any = request.get("asked", [])
    if not isinstance(requests, list) or len(requests) > MAX_REQUESTS:
        raise BadRequest
    if not all(isinstance(request, dict) for request in requests):
        raise BadRequest
    return requests
