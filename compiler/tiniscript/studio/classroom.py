"""A class: its pupils, the robots that it has, whose turn it is, and what the teacher may do.

A pupil joins with the code of the class and gets a token. Whoever wants a robot stands in one
queue; a turn ends when the pupil leaves the robot or is not heard, and after a time if somebody
waits. A pupil reaches only the robot of their own turn: the page of a request is never one that a
pupil names. A pupil's page tells of its work, and whether a hand is up.

Pupils of a group (`groups`) have one place in the queue and one turn: each of them may take the
robot over, and each may stop it, whoever drives it. Their program is asked for without the lock of
the class.

Work belongs to the token of the page that made it. Nobody else's replaces it or pushes it out: the
teacher gives it to another pupil, and a copy stays until that page has said that it has it. Knows
no HTTP, no file (`class_keeping`) and no clock of its own.
"""

from __future__ import annotations

import hmac
import secrets
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from itertools import count
from pathlib import Path
from threading import RLock
from time import monotonic
from typing import NamedTuple

from tiniscript.base.source import printable
from tiniscript.lessons import catalogue
from tiniscript.link.port_names import canonical_port
from tiniscript.studio import recordings
from tiniscript.studio.class_keeping import (
    MOST_LESSONS,
    MOST_PUPILS,
    MOST_WORKS,
    NOTHING,
    Work,
    is_token,
)
from tiniscript.studio.entrances import new_token
from tiniscript.studio.group_runs import GroupRuns
from tiniscript.studio.groups import TEACHER, Groups
from tiniscript.studio.hosted_robot import HostedRobot
from tiniscript.studio.hosting import Hosting, list_ports, port_of
from tiniscript.studio.names import are_alike, free_name, plain_name
from tiniscript.studio.rates import Rate
from tiniscript.studio.robot_link import BadRequest, Json, robot_of, whole_number
from tiniscript.studio.serving import REQUEST_BYTES

OWN_NAME_CHARACTERS, MOST_COLOUR = 16, 31  # of the robot that a pupil calls their own


class OwnRobot(NamedTuple):
    """What a pupil has made of the virtual robot: `colour` is a number of the page's colours."""

    name: str = ""
    colour: int = 0

    @classmethod
    def of(cls, found: object) -> OwnRobot:
        """Return what a page says. Raises BadRequest."""
        if not isinstance(found, dict) or not isinstance(found.get("name"), str):
            raise BadRequest
        name = printable(found["name"][:OWN_NAME_CHARACTERS])
        return cls(name, whole_number(found, "colour", 0, MOST_COLOUR))


NO_OWN_ROBOT = OwnRobot()


@dataclass
class AskedRun:
    """The newest run of a pupil's page, which the teacher has asked for: what has come of its file,
    which nobody here has checked. It is in memory until the teacher's page has it."""

    number: int
    file: str = ""
    is_whole: bool = False

    def add(self, request: Json) -> None:
        """Take the next part. Raises BadRequest."""
        part, is_last = request.get("part"), request.get("is_last")
        if not isinstance(part, str) or not isinstance(is_last, bool):
            raise BadRequest
        whole_number(request, "from", len(self.file), len(self.file))
        if self.is_whole or len(self.file) + len(part) > recordings.MOST_BYTES:
            raise BadRequest
        self.file += part
        self.is_whole = is_last


@dataclass(eq=False)
class Pupil:
    """`name` is another than the one that was `written` if somebody here has that.

    `waits` and `hand`: the pupil wants a robot, or help; who has a smaller number is earlier.
    """

    number: int
    token: str
    name: str
    written: str
    address: str
    heard_s: float
    work: Work = NOTHING
    version: int = 0  # of the work
    is_right: bool = True  # a program without mistakes
    own_robot: OwnRobot = NO_OWN_ROBOT
    waits: int | None = None
    hand: int | None = None
    knows_end: bool = False
    run: AskedRun | None = None
    # The page's name for `hosting`: no page of the teacher's has it.
    page: str = field(default_factory=lambda: f"pupil-{secrets.token_hex(16)}")


@dataclass(eq=False)
class KeptWork:
    """Work of who is not here. What comes from a file has no token and no address.

    `given_to` is the token of the pupil whose page the teacher wants to have it.
    """

    name: str
    written: str
    work: Work
    token: str = ""
    address: str = ""
    given_to: str = ""
    key: str = field(default_factory=new_token)  # for pages


@dataclass(eq=False)
class ClassRobot:
    """`hosted` is the connection of this turn, once the pupil's page has taken it; `waited` is the
    place in the queue that the pupil had; `stops` is the number of the newest STOP of a group, and
    `runs` is where it hears what the robot tells."""

    port: str
    name: str
    pupil: Pupil | None = None
    hosted: HostedRobot | None = None
    waited: int | None = None
    began_s: float = 0.0
    free_s: float = 0.0
    stops: int = 0
    runs: GroupRuns | None = None

    def begin(self, pupil: Pupil, now_s: float) -> None:
        self.pupil, self.hosted, self.began_s = pupil, None, now_s
        self.waited, pupil.waits = pupil.waits, None

    def pass_to(self, pupil: Pupil) -> None:
        """Let another pupil of the group have the rest of the turn, and stop what was started."""
        if self.hosted is not None:
            self.hosted.leave("group_other")
        self.pupil, self.hosted = pupil, None

    def end(self) -> None:
        self.pupil = self.hosted = None

    def take_back(self) -> None:
        """End a turn, and stop what it has started."""
        if self.hosted is not None:
            self.hosted.leave("turn_over")
        self.end()


LETTERS = "23456789ABCDEFGHJKLMNPQRSTUVWXYZ"  # none looks like another
CODE_LETTERS = 6  # a thousand million codes
JOIN_BYTES = 1000
PLACES = 3  # of one address; the teacher may allow more
WORKS = 3  # of one address for each of its places
MOST_ROBOTS = 40
TURN_S = 180
SHORTEST_S, LONGEST_S = 10, 3600
CONNECT_S = 10.0  # for a page to take its turn
QUEUE_S = 20.0  # a page that is silent for longer waits no more
# A page that was heard since then may get a turn, and keeps one while others wait. It asks once a
# second. With the time of a look the next one has waited less than 3 s.
HERE_S = 2.0
# A page that is silent for longer gives its place away: where its address is full, or to who comes
# back with its name.
PLACE_S = 5.0
REST_S = 10.0  # of a robot with which a turn has failed
SILENT_S = 60.0  # after which a place in a full class is given away
OVER_S = 6.0  # for pages to hear that the class is over
# Wrong codes of a computer: twenty, then one in three seconds. A thousand million take a century.
WRONG = (20, 1 / 3)
REQUESTS = (80, 40)  # of a pupil; a page that drives asks ten times a second
# What a pupil may ask of a robot. Its name, its trim and its owner are the teacher's.
MAY = ("hello", "upload", "live", "start", "identify", "trim", "keys", "stop")

Clock = Callable[[], float]


class Classroom:
    """Any thread may call it. `tend` must be called once a second."""

    def __init__(
        self, hosting: Hosting, ports: list[str], turn_s: int | None = None,
        clock: Clock = monotonic, folder: Path | None = None,
    ) -> None:  # fmt: skip
        """`turn_s` of None: as in the class from before a crash, else TURN_S. `folder`: for what is
        kept of groups."""
        self._groups = Groups(clock, folder)
        self.code = _new_code()
        self._hosting = hosting
        self._turn_s = TURN_S if turn_s is None else turn_s
        self._is_turn_given = turn_s is not None
        self._clock = clock
        self._lock = RLock()
        self._pupils: dict[str, Pupil] = {}  # by token
        self._robots = [ClassRobot(port, _name_of(port)) for port in ports]
        self._places = PLACES
        self._wrong = Rate(*WRONG)
        self._requests = Rate(*REQUESTS)
        self._numbers = count(1)  # of pupils, of places in the queue and of hands
        self._kept: dict[str, KeptWork] = {}  # by key
        self._goes_on = False  # after a crash, and the teacher has not said otherwise
        self._over = ""  # or whether pupils' work is kept
        self._over_s = 0.0

    # -- pupils -----------------------------------------------------------------------------------

    def most_bytes(self, token: str) -> int:
        if not token:
            return JOIN_BYTES
        with self._lock:
            return REQUEST_BYTES if token in self._pupils else 0

    def answer(self, token: str, address: str, request: Json) -> Json:
        """Return the answer to a pupil's request. Raises BadRequest."""
        with self._lock:
            if not token:
                return self._join(address, request)
            pupil = self._pupils.get(token)
            if pupil is None:
                raise BadRequest
            do = request.get("do")
            if do in ("stop", "stop_all"):
                return self._stop(pupil, request)
            if not self._requests.take(token, self._clock()):
                raise BadRequest
            pupil.heard_s = self._clock()
            if do == "here":
                return self._report_page(pupil, request)
            if do == "connect":
                return self._connect(pupil, request)
            if do in ("beat", "leave"):
                return self._drive(pupil, request)
            if do == "run":
                if pupil.run is not None and request.get("asked") == pupil.run.number:
                    pupil.run.add(request)
                return {}
            if do in ("group_join", "group_leave"):
                return self._change_group(pupil, request)
        if do == "group":
            return self._groups.answer(token, request)
        raise BadRequest

    def _join(self, address: str, request: Json) -> Json:
        now_s = self._clock()
        code, name = request.get("code"), request.get("name")
        if request.get("do") != "join" or not isinstance(code, str) or not isinstance(name, str):
            raise BadRequest
        if not self._wrong.has(address, now_s):
            return {"failure": "class_slow"}
        given = "".join(code.upper().split()).encode("utf-8", "replace")
        if not hmac.compare_digest(given, self.code.encode()):
            self._wrong.take(address, now_s)
            return {"failure": "class_wrong"}
        if self._over:
            return {"failure": "class_over"}
        plain = plain_name(name)
        if not plain:
            return {"failure": "class_nameless"}
        back = self._returning_pupil(request.get("before"), plain, now_s)
        if isinstance(back, Pupil):  # the page has been away
            back.heard_s, back.address = now_s, address
            return {"token": back.token, "name": back.name}
        if back is None:  # who comes back is not a second one
            same = [pupil for pupil in self._pupils_at(address) if are_alike(pupil.written, plain)]
            self._give_place_away(now_s, PLACE_S, same)
        same = self._pupils_at(address)
        if len(same) >= self._places and not self._give_place_away(now_s, PLACE_S, same):
            return {"failure": "class_crowded"}
        here = list(self._pupils.values())
        if len(here) >= MOST_PUPILS and not self._give_place_away(now_s, SILENT_S, here):
            return {"failure": "class_full"}
        if back is None:
            if self._works(address) >= WORKS * self._places:
                return {"failure": "class_crowded"}
            if self._works() >= MOST_WORKS:
                return {"failure": "class_full"}
            back = KeptWork(free_name(plain, self._names()), plain, NOTHING, new_token())
        self._begin(back, address, now_s)
        return {"token": back.token, "name": back.name}

    def _begin(self, work: KeptWork, address: str, now_s: float) -> None:
        """Who has made this work is here from now on."""
        self._kept.pop(work.key, None)
        self._pupils[work.token] = Pupil(
            next(self._numbers), work.token, work.name, work.written, address, now_s, work.work
        )

    def _returning_pupil(
        self, token: object, written: str, now_s: float
    ) -> Pupil | KeptWork | None:
        """Return who comes back with the token of an earlier page, and the same name."""
        for pupil in self._all_work():
            is_here = isinstance(pupil, Pupil) and now_s - pupil.heard_s <= PLACE_S
            if pupil.token and pupil.token == token and not is_here:
                return pupil if are_alike(pupil.written, written) else None
        return None

    def _pupils_at(self, address: str) -> list[Pupil]:
        return [pupil for pupil in self._pupils.values() if pupil.address == address]

    def _works(self, address: str | None = None) -> int:
        """Return how many works the class has, of an address or in all."""
        return sum(address is None or item.address == address for item in self._all_work())

    def _names(self) -> list[str]:
        """Return the names of all who have a token."""
        return [item.name for item in self._all_work() if item.token]

    def _all_work(self) -> list[KeptWork | Pupil]:
        return [*self._kept.values(), *self._pupils.values()]

    def _give_place_away(self, now_s: float, silent_s: float, pupils: list[Pupil]) -> bool:
        """Take the place of the one of these that has been silent longest."""
        silent = [pupil for pupil in pupils
                  if now_s - pupil.heard_s > silent_s and self._turn(pupil) is None]  # fmt: skip
        if silent:
            self._forget(min(silent, key=lambda pupil: pupil.heard_s))
        return bool(silent)

    def _forget(self, pupil: Pupil) -> None:
        """A pupil is here no more; the work stays, for who comes back."""
        del self._pupils[pupil.token]
        if pupil.work.text:
            self._keep(KeptWork(pupil.name, pupil.written, pupil.work, pupil.token, pupil.address))
        for item in self._kept.values():
            if item.given_to == pupil.token:
                item.given_to = ""

    def _keep(self, kept: KeptWork) -> None:
        self._kept[kept.key] = kept

    def _report_page(self, pupil: Pupil, request: Json) -> Json:
        """A page tells of its program, and hears its place: 0 is a turn, -1 none."""
        self._hear_work(pupil, request)
        wants, hand = request.get("wants"), request.get("hand")
        mates = self._mates(pupil)
        if wants is False:
            for mate in mates:
                mate.waits = None
        elif wants is True and not any(mate.waits or self._turn(mate) for mate in mates):
            pupil.waits = next(self._numbers)
        if hand is False:
            pupil.hand = None
        elif hand is True and pupil.hand is None:
            pupil.hand = next(self._numbers)
        self._tend()
        if self._over:
            pupil.knows_end = True
            return {"over": self._over}
        turn, waiting = self._turn_of(mates), self._waiting_pupils()
        place = -1 if turn is None else 0
        for mate in mates:
            if mate in waiting:
                place = waiting.index(mate) + 1
        group, groups = self._groups.of(pupil.token), self._groups.shown()
        driver = turn.pupil if turn is not None else None
        given = next((item for item in self._kept.values() if item.given_to == pupil.token), None)
        return {
            "name": pupil.name,
            "place": place,
            "waiting": len(waiting),
            "robots": len(self._robots),
            "robot": turn.name if turn else "",
            "left_s": self._remaining_s(turn) if turn else 0,
            "hand": pupil.hand is not None,
            **({"run": pupil.run.number} if pupil.run and not pupil.run.is_whole else {}),
            **({"stops": turn.stops} if turn is not None and group is not None else {}),
            **({"groups": groups} if groups else {}),
            **({"group": group.name} if group is not None else {}),
            **({"driver": driver.name} if driver is not None and driver is not pupil else {}),
            **({"given": {"key": given.key, **given.work._asdict()}} if given else {}),
        }

    def _hear_work(self, pupil: Pupil, request: Json) -> None:
        """Take what a page tells of its work; what it does not tell stays. Raises BadRequest."""
        told = {name: request[name] for name in Work._fields if request.get(name) is not None}
        if "robot" in told:
            robot_of(told)
        kept = {**pupil.work._asdict(), "lessons": list(pupil.work.lessons)}
        work = Work.of({**kept, **told})
        if work is None:
            raise BadRequest
        if work != pupil.work:
            pupil.work = work
            pupil.version += 1
        if isinstance(request.get("is_right"), bool):
            pupil.is_right = request["is_right"]
        if request.get("own_robot") is not None:
            pupil.own_robot = OwnRobot.of(request["own_robot"])
        self._hear_taken(pupil, request.get("took"))

    def _hear_taken(self, pupil: Pupil, took: object) -> None:
        """A page says that it has what it was given: the very text proves it."""
        result = took if isinstance(took, dict) else {}
        kept = self._kept.get(str(result.get("key")))
        if kept is None or kept.given_to != pupil.token or result.get("text") != kept.work.text:
            return
        del self._kept[kept.key]
        lessons = dict.fromkeys((*kept.work.lessons, *pupil.work.lessons))
        pupil.work = kept.work._replace(lessons=tuple(lessons)[:MOST_LESSONS])
        pupil.version += 1

    def _connect(self, pupil: Pupil, request: Json) -> Json:
        self._tend()
        robot = self._turn(pupil) or self._turn_of(self._mates(pupil))
        if robot is None:
            return {"failure": "turn_none"}
        if robot.pupil is not pupil:
            if _count(request.get("saw_stops", robot.stops)) < robot.stops:
                return {"failure": "stopped_elsewhere"}  # it was pressed before that
            robot.pass_to(pupil)
        # One that this page has left a moment ago is not the robot of this turn.
        answer = self._hosting.answer({**_own_request(pupil, request), "port": robot.port})
        if not answer:
            robot.hosted = self._hosting.robot_of(pupil.page)
            self._let_group_see(robot)
        return answer

    def _let_group_see(self, robot: ClassRobot) -> None:
        """The group of who drives a robot sees what it tells, and no other one does any more."""
        if robot.hosted is None or robot.pupil is None:
            return
        token = robot.pupil.token
        runs = self._groups.runs_of(token)
        if robot.runs is not None and robot.runs is not runs:
            robot.runs.tell(token, [{"over": "left"}])
        robot.runs = runs
        robot.hosted.attending.witness = partial(runs.tell, token) if runs is not None else None

    def _drive(self, pupil: Pupil, request: Json) -> Json:
        asked = request.get("asked", [])
        if not isinstance(asked, list) or not all(_is_allowed(item) for item in asked):
            raise BadRequest
        return self._hosting.answer(_own_request(pupil, request))

    def _stop(self, pupil: Pupil, request: Json) -> Json:
        """Stop the own robot, or that of the group, and no other, whatever was asked. For others of
        the group it latches: what was asked before it, and arrives later, is refused, whoever takes
        the robot over meanwhile."""
        robot = self._turn_of(self._mates(pupil))
        if robot is not None:
            stops = request.get("group_stops", 0)
            is_own = robot.pupil is pupil
            if is_own or self._groups.is_new_stop(pupil.token, _count(stops)):
                robot.stops = next(self._numbers)
                if not is_own and robot.hosted is not None:
                    robot.hosted.attending.latch()
        answer = self._hosting.answer({**_own_request(pupil, request), "do": "stop", "asked": []})
        return {**answer, **({"stops": robot.stops} if robot is not None else {})}

    # -- groups -----------------------------------------------------------------------------------

    def _change_group(self, pupil: Pupil, request: Json) -> Json:
        if request["do"] == "group_leave":
            self._groups.leave(pupil.token)
            self._see_turn_of(pupil)
            return {}
        if self._over:
            return {"failure": "class_over"}
        answer = self._groups.join(pupil.token, pupil.name, request)
        mates = self._mates(pupil)
        places = [mate.waits for mate in mates if mate.waits is not None]
        for mate in mates:  # from now on they have one place, and one robot
            mate.waits = None
        own_turn = self._turn(pupil)
        if own_turn is not None and self._turn_of(mates[1:]) is not None:
            own_turn.take_back()
        if places and self._turn_of(mates) is None:
            pupil.waits = min(places)
        self._see_turn_of(pupil)
        return answer

    def _see_turn_of(self, pupil: Pupil) -> None:
        robot = self._turn(pupil)
        if robot is not None:
            self._let_group_see(robot)

    def _mates(self, pupil: Pupil) -> list[Pupil]:
        """Return all pupils of the group, the pupil first; of no group that one alone."""
        tokens = self._groups.mates(pupil.token)
        return [pupil, *(mate for mate in self._pupils.values()
                         if mate.token in tokens and mate is not pupil)]  # fmt: skip

    def _turn_of(self, pupils: list[Pupil]) -> ClassRobot | None:
        return next((turn for turn in map(self._turn, pupils) if turn is not None), None)

    # -- turns ------------------------------------------------------------------------------------

    def tend(self) -> None:
        """End turns and begin others; to be called when nobody asks, too."""
        with self._lock:
            self._tend()

    def _tend(self) -> None:
        now_s = self._clock()
        for pupil in self._waiting_pupils():
            if now_s - pupil.heard_s > QUEUE_S:
                pupil.waits = None
        for robot in self._robots:
            if robot.pupil is not None:
                self._look_at(robot, now_s)
        for robot in self._robots:
            if robot.pupil is None and not self._over and robot.free_s <= now_s:
                self._begin_turn(robot, now_s)

    def _look_at(self, robot: ClassRobot, now_s: float) -> None:
        """End a turn that has to end."""
        hosted, pupil = robot.hosted, robot.pupil
        assert pupil is not None
        if hosted is None:
            if now_s - pupil.heard_s > HERE_S:  # it was closed: who comes back keeps the place
                pupil.waits = robot.waited
                robot.end()
            elif now_s - robot.began_s > CONNECT_S:
                robot.end()
        elif hosted.has_ended and hosted.attending.is_half_made:
            robot.hosted = None  # the page does not know of it: it may connect again
        elif hosted.has_ended:
            robot.name = hosted.name or robot.name
            if not hosted.name and not hosted.was_left:  # another robot is better
                robot.free_s = now_s + REST_S
            robot.end()
        elif self._waiting_pupils() and (
            now_s - robot.began_s >= self._turn_s or hosted.attending.silent_s > HERE_S
        ):
            robot.take_back()

    def _begin_turn(self, robot: ClassRobot, now_s: float) -> None:
        """Give a robot to who is next, or to who is here of the same group."""
        for pupil in self._waiting_pupils():
            here = [mate for mate in self._mates(pupil) if now_s - mate.heard_s <= HERE_S]
            if here and self._hosting.is_free(robot.port):
                place, pupil.waits = pupil.waits, None
                here[0].waits = place
                robot.begin(here[0], now_s)
            if here:
                return

    def tidy(self) -> None:
        """Delete what is kept of groups that this class has not."""
        self._groups.tidy()

    def _waiting_pupils(self) -> list[Pupil]:
        found = [(pupil.waits, pupil) for pupil in self._pupils.values() if pupil.waits is not None]
        return [pupil for _, pupil in sorted(found, key=lambda found: found[0])]

    def _turn(self, pupil: Pupil) -> ClassRobot | None:
        return next((robot for robot in self._robots if robot.pupil is pupil), None)

    def _remaining_s(self, robot: ClassRobot) -> int:
        return max(0, round(self._turn_s - (self._clock() - robot.began_s)))

    # -- the teacher ------------------------------------------------------------------------------

    def teach(self, request: Json) -> Json:
        """Return the answer to a request of the teacher's page. Raises BadRequest."""
        do = request.get("do")
        if do in ("group_visit", "group_leave", "group"):
            return self._take_part(do, request)
        if not isinstance(do, str) or not do.startswith("class"):
            return self._hosting.answer(request)
        # A list of ports may take seconds: no pupil's stop waits for it.
        given = _requested_robot(request) if do == "class_robot" else None
        with self._lock:
            if given is not None:
                self._give(given, request.get("gives") is True)
            elif do == "class_turn":
                self._turn_s = whole_number(request, "seconds", SHORTEST_S, LONGEST_S)
            elif do == "class_places":
                self._places = whole_number(request, "places", 1, MOST_PUPILS)
            elif do == "class_code":
                self.code = _new_code()
            elif do == "class_over":
                self._end(request.get("erases") is True)
            elif do == "class_text":
                return self._text(request)
            elif do in ("class_stop", "class_next", "class_remove", "class_hand"):
                pupil = self._pupil(request)
                if pupil is not None:  # who may have gone a moment ago
                    self._teach(do, pupil)
            elif do == "class_run":
                return self._run(request)
            elif do == "class_work":
                return {"pupils": self.work()}
            elif do == "class_bring":
                self._restore_work(request)
            elif do == "class_forget":
                self._kept.pop(str(request.get("key")), None)
            elif do == "class_give_back":
                self._give_back(request)
            elif do == "class_anew":
                self._begin_anew()
            elif do != "class":
                raise BadRequest
            self._tend()
            return self._state()

    def _take_part(self, do: str, request: Json) -> Json:
        """Let the teacher edit with a group. That is no turn, and no place in the queue."""
        if do == "group":
            return self._groups.answer(TEACHER, request)
        if do == "group_leave":
            self._groups.leave(TEACHER)
            return {}
        return {"failure": "class_over"} if self._over else self._groups.visit(request)

    def _teach(self, do: str, pupil: Pupil) -> None:
        robot = self._turn(pupil)
        if do == "class_hand":
            pupil.hand = None
        elif do == "class_stop":
            if robot is not None and robot.hosted is not None:
                robot.hosted.attending.latch()
        else:
            if robot is not None:
                robot.take_back()
            if do == "class_remove":
                self._groups.leave(pupil.token)
                self._forget(pupil)

    def _text(self, request: Json) -> Json:
        """Return the work of a pupil, or of a group, or kept work, of which the page names the
        key."""
        group = self._groups.by_key(request.get("group"))
        if group is not None:
            return {"version": group.program.number, "history": self._groups.told(group),
                    **Work(group.text)._asdict()}  # fmt: skip
        pupil = self._pupil(request) or self._kept.get(str(request.get("key")))
        version = pupil.version if isinstance(pupil, Pupil) else 0
        return {"version": version, **(pupil.work if pupil else NOTHING)._asdict()}

    def _run(self, request: Json) -> Json:
        """Ask a pupil's page for its newest run; return it once it is there."""
        pupil = self._pupil(request)
        if pupil is None:
            return {"run": ""}
        if request.get("asks") is True or pupil.run is None:
            pupil.run = AskedRun(next(self._numbers))
        if not pupil.run.is_whole:
            return {"run": None}
        file, pupil.run = pupil.run.file, None
        return {"run": file}

    # -- what is kept -----------------------------------------------------------------------------

    def work(self) -> list[Json]:
        """Return the work of all pupils, of those who are not here, too."""
        with self._lock:
            matches = [(item.name, item.work) for item in self._all_work() if item.work.text]
        return [{"name": name, **work._asdict()} for name, work in matches]

    def _restore_work(self, request: Json) -> None:
        """Keep work that comes from a file, once. Raises BadRequest."""
        name, work = request.get("name"), Work.of(request)
        plain = plain_name(name) if isinstance(name, str) else ""
        if not plain or work is None:
            raise BadRequest
        if any((item.name, item.work) == (plain, work) for item in self._kept.values()):
            return
        if self._works() >= MOST_WORKS:
            raise BadRequest
        self._keep(KeptWork(plain, plain, work))

    def _give_back(self, request: Json) -> None:
        """Give kept work to one pupil: their page puts it into the editor."""
        kept, pupil = self._kept.get(str(request.get("key"))), self._pupil(request)
        if kept is not None:  # the page may have taken it a moment ago
            kept.given_to = pupil.token if pupil else ""

    def _begin_anew(self) -> None:
        """Begin another class: nobody is in it, and nothing is kept of the one before."""
        for robot in self._robots:
            robot.take_back()
        self._groups.end()
        self._pupils.clear()
        self._kept.clear()
        self.code = _new_code()
        self._goes_on = False

    def state_to_keep(self) -> Json | None:
        """Return all that a class goes on with after a crash; None once it is over."""
        with self._lock:
            if self._over:
                return None
            return {
                "code": self.code,
                "turn_s": self._turn_s,
                "places": self._places,
                "robots": [robot.port for robot in self._robots],
                "groups": self._groups.state_to_keep(),
                "kept": [
                    {
                        "name": item.name,
                        "written": item.written,
                        "token": item.token,
                        "address": item.address,
                        "given_to": item.given_to,
                        "key": item.key,
                        **item.work._asdict(),
                    }
                    for item in self._kept.values()
                ],
                "pupils": [
                    {
                        "token": pupil.token,
                        "name": pupil.name,
                        "written": pupil.written,
                        "address": pupil.address,
                        **pupil.work._asdict(),
                    }
                    for pupil in self._pupils.values()
                ],
            }

    def go_on(self, kept: Json, is_same_lesson: bool = True) -> int:
        """Go on with a class from before a crash; return how many pupils it has. What is damaged
        of it is left out. Of another lesson's all is kept, and pupils come with another code."""
        with self._lock:
            now_s = self._clock()
            for row in _rows(kept, "pupils")[:MOST_PUPILS]:
                result = _work_of_row(row, Work.of(row) or NOTHING)
                if result is not None and result.token and result.address:
                    self._begin(result, result.address, now_s)
            for row in _rows(kept, "kept"):
                result = _work_of_row(row, Work.of(row))
                if result is not None and self._works() < MOST_WORKS:
                    result.given_to = result.given_to if result.given_to in self._pupils else ""
                    self._keep(result)
            self._goes_on = bool(self._pupils or self._kept)
            here = set(self._pupils) if is_same_lesson else set()
            self._groups.go_on(_rows(kept, "groups"), here.__contains__)
            if not is_same_lesson:
                for pupil in list(self._pupils.values()):
                    self._forget(pupil)
                return 0
            for port in kept["robots"] if isinstance(kept.get("robots"), list) else []:
                with suppress(BadRequest):
                    self._give(_requested_robot({"port": port, "gives": True}), True)
            code = kept.get("code")
            if isinstance(code, str) and len(code) == CODE_LETTERS and set(code) <= set(LETTERS):
                self.code = code
            with suppress(BadRequest):
                self._places = whole_number(kept, "places", 1, MOST_PUPILS)
            if not self._is_turn_given:
                with suppress(BadRequest):
                    self._turn_s = whole_number(kept, "turn_s", SHORTEST_S, LONGEST_S)
            return len(self._pupils)

    def _give(self, given: ClassRobot, is_given: bool) -> None:
        """Give a robot to the class, or take it away."""
        port = canonical_port(given.port)
        same = [robot for robot in self._robots if canonical_port(robot.port) == port]
        for class_robot in same:
            if not is_given:
                class_robot.take_back()
                self._robots.remove(class_robot)
        if is_given and not same:
            if len(self._robots) >= MOST_ROBOTS:
                raise BadRequest
            self._robots.append(given)

    def _end(self, erases: bool) -> None:
        for robot in self._robots:
            robot.take_back()
        self._groups.end()
        self._over = "erased" if erases else "kept"
        self._over_s = self._clock()

    @property
    def has_ended(self) -> bool:
        """Whether the class is over and all pages know it that can."""
        with self._lock:
            now_s = self._clock()
            here = [pupil for pupil in self._pupils.values() if now_s - pupil.heard_s <= QUEUE_S]
            are_told = all(pupil.knows_end for pupil in here)
            return bool(self._over) and (are_told or now_s - self._over_s > OVER_S)

    def _state(self) -> Json:
        now_s, waiting = self._clock(), self._waiting_pupils()
        return {
            "code": self.code,
            "turn_s": self._turn_s,
            "places": self._places,
            "over": self._over,
            "goes_on": self._goes_on,
            "lessons": len(catalogue.folders()),
            "kept": [
                {
                    "key": item.key,
                    "name": item.name,
                    "lessons": item.work.lessons,
                    "given": self._number(item.given_to),
                    "alike": [
                        pupil.number
                        for pupil in self._pupils.values()
                        if are_alike(pupil.written, item.written)
                    ],
                }
                for item in self._kept.values()
            ],
            "pupils": [
                {
                    "number": pupil.number,
                    "name": pupil.name,
                    "silent_s": round(now_s - pupil.heard_s),
                    "place": waiting.index(pupil) + 1 if pupil in waiting else 0,
                    "robot": turn.name or turn.port if (turn := self._turn(pupil)) else "",
                    "left_s": self._remaining_s(turn) if turn else 0,
                    "version": pupil.version,
                    "is_right": pupil.is_right,
                    "own_robot": pupil.own_robot._asdict(),
                    "hand": pupil.hand or 0,
                    "lessons": pupil.work.lessons,
                }
                for pupil in self._pupils.values()
            ],
            "groups": [
                {
                    "key": group.key,
                    "name": group.name,
                    "pupils": [self._number(each.token) for each in group.pupils],
                    "version": group.program.number,
                }
                for group in self._groups.all()
            ],
            "robots": [
                {
                    "port": robot.port,
                    "name": robot.name,
                    "pupil": robot.pupil.name if robot.pupil else "",
                    "left_s": self._remaining_s(robot) if robot.pupil else 0,
                }
                for robot in self._robots
            ],
        }

    def _pupil(self, request: Json) -> Pupil | None:
        number = request.get("pupil")
        return next((pupil for pupil in self._pupils.values() if pupil.number == number), None)

    def _number(self, token: str) -> int:
        return self._pupils[token].number if token in self._pupils else 0


def _own_request(pupil: Pupil, request: Json) -> Json:
    """Return a request about the pupil's own robot: what it calls its page tells tabs apart."""
    return {**request, "page": pupil.page, "tab": request.get("page")}


def _count(found: object) -> int:
    return found if type(found) is int else 0


def _is_allowed(asked: object) -> bool:
    """Return whether a pupil may ask this of a robot."""
    if not isinstance(asked, dict) or asked.get("do") not in MAY:
        return False
    return asked["do"] != "trim" or asked.get("trim") is None


def _requested_robot(request: Json) -> ClassRobot:
    """Return the robot of a request, with the name that it had last. Raises BadRequest."""
    port = port_of(request)
    return ClassRobot(port, _name_of(port) if request.get("gives") is True else "")


def _rows(kept: Json, name: str) -> list[Json]:
    result = kept.get(name)
    return [item for item in result if isinstance(item, dict)] if isinstance(result, list) else []


def _work_of_row(row: Json, work: Work | None) -> KeptWork | None:
    """Return whose work it is in a row of a file; None if it is nobody's, or no work."""
    name = row.get("name")
    plain = plain_name(name) if isinstance(name, str) else ""
    if work is None or not plain:
        return None
    result = KeptWork(plain, plain, work)
    written, address = row.get("written"), row.get("address")
    result.written = (plain_name(written) if isinstance(written, str) else "") or plain
    result.address = address if isinstance(address, str) else ""
    result.token, result.given_to = _token_of_row(row, "token"), _token_of_row(row, "given_to")
    result.key = _token_of_row(row, "key") or result.key
    return result


def _token_of_row(row: Json, name: str) -> str:
    return str(row[name]) if is_token(row.get(name)) else ""


def _new_code() -> str:
    return "".join(secrets.choice(LETTERS) for _ in range(CODE_LETTERS))


def _name_of(port: str) -> str:
    """Return the name of the robot that was there last, or nothing."""
    same = canonical_port(port)
    return next(
        (str(item["name"]) for item in list_ports() if canonical_port(item["port"]) == same), ""
    )
