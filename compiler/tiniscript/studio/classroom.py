"""A class: its pupils, the robots that it has, whose turn it is, and what the teacher may do.

A pupil joins with the code of the class and gets a token. Anyone who wants a robot stands in one
queue; a turn ends when the pupil leaves the robot or is not heard, and after a time if somebody
waits. A pupil reaches only the robot of their own turn: the page of a request is never one that a
pupil names. A pupil's page reports its work, and whether a hand is up.

Pupils of a group (`groups`) have one place in the queue and one turn: each of them may take the
robot over, and each may stop it, whoever drives it. Their program is asked for without the lock of
the class.

Work belongs to the token of the page that made it. Another pupil's work never replaces it. If the
teacher gives it to another pupil, a copy stays until that pupil's page confirms that it has it.
Knows no HTTP, no file (`class_keeping`) and no clock of its own.
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
    MAX_LESSONS,
    MAX_PUPILS,
    MAX_WORKS,
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

OWN_NAME_CHARACTERS, MAX_COLOUR = 16, 31  # longest name and colour of a robot that a pupil names


class OwnRobot(NamedTuple):
    """A pupil's own virtual robot: `colour` is a number of the page's colours."""

    name: str = ""
    colour: int = 0

    @classmethod
    def of(cls, data: object) -> OwnRobot:
        """Return the robot in a page's data. Raises BadRequest."""
        if not isinstance(data, dict) or not isinstance(data.get("name"), str):
            raise BadRequest
        name = printable(data["name"][:OWN_NAME_CHARACTERS])
        return cls(name, whole_number(data, "colour", 0, MAX_COLOUR))


NO_OWN_ROBOT = OwnRobot()


class Handout(NamedTuple):
    """What the teacher gives to every pupil: a lesson, by its number, or a program."""

    key: str = ""  # a new one for each handout
    lesson: int = 0  # 0 for a program
    text: str = ""
    robot: str = ""

    @classmethod
    def of(cls, data: Json, key: str) -> Handout:
        """Return the handout in data from elsewhere. Raises BadRequest. A program that is too long
        is refused: one that is cut off is another program.
        """
        lesson = whole_number(data, "lesson", 0, len(catalogue.folders()), 0)
        if lesson:
            return cls(key, lesson)
        text, work = data.get("text"), Work.of(data)
        if work is None or not work.text.strip() or work.text != text:
            raise BadRequest
        return cls(key, 0, work.text, work.robot)


NO_HANDOUT = Handout()


@dataclass
class RunRequest:
    """The newest run of a pupil's page, requested by the teacher: the received part of its file,
    unchecked. It is in memory until the teacher's page has it.
    """

    number: int
    file_text: str = ""
    is_whole: bool = False

    def add(self, request: Json) -> None:
        """Take the next part. Raises BadRequest."""
        text, is_last = request.get("part"), request.get("is_last")
        if not isinstance(text, str) or not isinstance(is_last, bool):
            raise BadRequest
        whole_number(request, "from", len(self.file_text), len(self.file_text))
        if self.is_whole or len(self.file_text) + len(text) > recordings.MAX_BYTES:
            raise BadRequest
        self.file_text += text
        self.is_whole = is_last


@dataclass(eq=False)
class Pupil:
    """`name` is another than the `typed_name` if somebody here has that.

    `queue_number` and `hand_number`: the pupil wants a robot, or help; who has a
    smaller number is earlier.
    """

    number: int
    token: str
    name: str
    typed_name: str
    address: str
    heard_s: float
    work: Work = NOTHING
    version: int = 0  # version of the pupil's work
    is_right: bool = True  # a program without mistakes
    own_robot: OwnRobot = NO_OWN_ROBOT
    queue_number: int | None = None
    hand_number: int | None = None
    knows_end: bool = False
    handout_key: str = ""  # key of the newest handout that the page has opened
    run_request: RunRequest | None = None
    # The page's name for `hosting`: no page of the teacher's has it.
    hosting_page: str = field(default_factory=lambda: f"pupil-{secrets.token_hex(16)}")


@dataclass(eq=False)
class KeptWork:
    """Work of who is not here. A pupil from a file has no token and no address.

    `recipient_token` is that of the pupil whose page the teacher wants to have it, `handout_key`
    that of the newest handout that the pupil's page had opened.
    """

    name: str
    typed_name: str
    work: Work
    token: str = ""
    address: str = ""
    recipient_token: str = ""
    key: str = field(default_factory=new_token)  # key that pages use for the pupil
    handout_key: str = ""


@dataclass(eq=False)
class ClassRobot:
    """`hosted_robot` is the connection of this turn, once the pupil's page has it; `queue_number`
    is the pupil's former number; `stop_number` is that of the group's newest STOP, and `group_runs`
    receives the robot's events.
    """

    port: str
    name: str
    pupil: Pupil | None = None
    hosted_robot: HostedRobot | None = None
    queue_number: int | None = None
    began_s: float = 0.0
    free_at_s: float = 0.0
    stop_number: int = 0
    group_runs: GroupRuns | None = None

    @property
    def is_running(self) -> bool:
        return self.hosted_robot is not None and self.hosted_robot.is_running

    def begin(self, pupil: Pupil, now_s: float) -> None:
        self.pupil, self.hosted_robot, self.began_s = pupil, None, now_s
        self.queue_number, pupil.queue_number = pupil.queue_number, None

    def pass_to(self, pupil: Pupil) -> None:
        """Pass the rest of the turn to another pupil of the group, and stop what was started."""
        if self.hosted_robot is not None:
            self.hosted_robot.leave("group_other")
        self.pupil, self.hosted_robot = pupil, None

    def end(self) -> None:
        self.pupil = self.hosted_robot = None

    def take_back(self) -> None:
        """End a turn, and stop what it has started."""
        if self.hosted_robot is not None:
            self.hosted_robot.leave("turn_over")
        self.end()


LETTERS = "23456789ABCDEFGHJKLMNPQRSTUVWXYZ"  # letters that do not look alike
CODE_LETTERS = 6  # a thousand million codes
JOIN_BYTES = 1000
PLACES_PER_ADDRESS = 3  # most pupils at one address; the teacher may allow more
WORKS_PER_PLACE = 3  # most works for each pupil's place at one address
MAX_ROBOTS = 40
TURN_S = 180
SHORTEST_TURN_S, LONGEST_TURN_S = 10, 3600
CONNECT_S = 10.0  # time for a page to take its turn
QUEUE_S = 20.0  # a page that is silent for longer waits no more
# A page that was heard since then may get a turn, and keeps one while others wait. It asks once a
# second. With the time of one poll, the next one has waited less than 3 s.
PRESENCE_S = 2.0
# A page silent for longer may lose its place: at a full address, or to a pupil who returns with its
# name.
PLACE_S = 5.0
REST_S = 10.0  # pause of a robot after a failed turn
SILENT_S = 60.0  # silence after which a place in a full class may be given away
END_NOTICE_S = 6.0  # time for pages to hear that the class is over
# Wrong codes of a computer: twenty, then one in three seconds. A thousand million take a century.
WRONG_CODE_RATE = (20, 1 / 3)
# Burst and rate of a pupil's requests; a page that drives sends ten a second.
REQUEST_RATE = (80, 40)
# The robot requests that a pupil may make. Its name, its trim and its owner are the teacher's.
ALLOWED_REQUESTS = ("hello", "upload", "live", "start", "identify", "trim", "keys", "stop")
# Requests of the teacher's page that change what a class goes on with after a crash.
CHANGES = ("class_robot", "class_turn", "class_places", "class_code", "class_hand_out",
           "class_over", "class_remove", "class_bring", "class_forget", "class_give_back",
           "class_anew")  # fmt: skip

Clock = Callable[[], float]


class Classroom:
    """Any thread may call it. `tend` must be called once a second."""

    def __init__(
        self, hosting: Hosting, ports: list[str], turn_s: int | None = None,
        clock: Clock = monotonic, folder: Path | None = None,
    ) -> None:  # fmt: skip
        """`turn_s` of None: as in the class before a crash, or TURN_S. `folder`: for the data of
        groups.
        """
        self._groups = Groups(clock, folder)
        self.code = _new_code()
        self._hosting = hosting
        self._turn_s = TURN_S if turn_s is None else turn_s
        self._is_turn_given = turn_s is not None
        self._clock = clock
        self._lock = RLock()
        self._pupil_by_token: dict[str, Pupil] = {}  # keyed by token
        self._robots = [ClassRobot(port, _name_of(port)) for port in ports]
        self._places_per_address = PLACES_PER_ADDRESS
        self._wrong_code_rate = Rate(*WRONG_CODE_RATE)
        self._request_rate = Rate(*REQUEST_RATE)
        self._numbers = count(1)  # numbers of pupils, queue places and raised hands
        self._kept_work_by_key: dict[str, KeptWork] = {}  # keyed by the work's key
        self._handout = NO_HANDOUT
        # Whether the class continues after a crash, without a decision by the teacher.
        self._is_continued = False
        self._ending = ""  # how the class ends, or whether works are kept
        self._ended_s = 0.0

    # -- pupils -----------------------------------------------------------------------------------

    def most_bytes(self, token: str) -> int:
        if not token:
            return JOIN_BYTES
        with self._lock:
            return REQUEST_BYTES if token in self._pupil_by_token else 0

    def answer(self, token: str, address: str, request: Json) -> Json:
        """Return the answer to a pupil's request. Raises BadRequest."""
        with self._lock:
            if not token:
                return self._join(address, request)
            pupil = self._pupil_by_token.get(token)
            if pupil is None:
                raise BadRequest
            action = request.get("do")
            if action in ("stop", "stop_all"):
                return self._stop(pupil, request)
            if not self._request_rate.take_amount(token, self._clock()):
                raise BadRequest
            pupil.heard_s = self._clock()
            if action == "here":
                return self._report_page(pupil, request)
            if action == "connect":
                return self._connect(pupil, request)
            if action in ("beat", "leave"):
                return self._drive(pupil, request)
            if action == "run":
                if (
                    pupil.run_request is not None
                    and request.get("asked") == pupil.run_request.number
                ):
                    pupil.run_request.add(request)
                return {}
            if action in ("group_join", "group_leave"):
                return self._change_group(pupil, request)
        if action == "group":
            return self._groups.answer(token, request)
        raise BadRequest

    def _join(self, address: str, request: Json) -> Json:
        now_s = self._clock()
        code, name = request.get("code"), request.get("name")
        if request.get("do") != "join" or not isinstance(code, str) or not isinstance(name, str):
            raise BadRequest
        if not self._wrong_code_rate.has_left(address, now_s):
            return {"failure": "class_slow"}
        typed_code = "".join(code.upper().split()).encode("utf-8", "replace")
        if not hmac.compare_digest(typed_code, self.code.encode()):
            self._wrong_code_rate.take_amount(address, now_s)
            return {"failure": "class_wrong"}
        if self._ending:
            return {"failure": "class_over"}
        typed_name = plain_name(name)
        if not typed_name:
            return {"failure": "class_nameless"}
        returning_pupil = self._returning_pupil(request.get("before"), typed_name, now_s)
        if isinstance(returning_pupil, Pupil):  # the page has been away
            returning_pupil.heard_s, returning_pupil.address = now_s, address
            return {"token": returning_pupil.token, "name": returning_pupil.name}
        if returning_pupil is None:  # a returning pupil is not counted twice
            same_pupils = [
                pupil
                for pupil in self._pupils_at(address)
                if are_alike(pupil.typed_name, typed_name)
            ]
            self._give_place_away(now_s, PLACE_S, same_pupils)
        same_pupils = self._pupils_at(address)
        if len(same_pupils) >= self._places_per_address and not self._give_place_away(
            now_s, PLACE_S, same_pupils
        ):
            return {"failure": "class_crowded"}
        pupils = list(self._pupil_by_token.values())
        if len(pupils) >= MAX_PUPILS and not self._give_place_away(now_s, SILENT_S, pupils):
            return {"failure": "class_full"}
        if returning_pupil is None:
            if self._work_count(address) >= WORKS_PER_PLACE * self._places_per_address:
                return {"failure": "class_crowded"}
            if self._work_count() >= MAX_WORKS:
                return {"failure": "class_full"}
            returning_pupil = KeptWork(
                free_name(typed_name, self._names()), typed_name, NOTHING, new_token()
            )
        self._admit(returning_pupil, address, now_s)
        return {"token": returning_pupil.token, "name": returning_pupil.name}

    def _admit(self, work: KeptWork, address: str, now_s: float) -> None:
        """Admit the author of this work to the class."""
        self._kept_work_by_key.pop(work.key, None)
        self._pupil_by_token[work.token] = Pupil(
            next(self._numbers), work.token, work.name, work.typed_name, address, now_s, work.work,
            handout_key=work.handout_key,
        )  # fmt: skip

    def _returning_pupil(
        self, token: object, typed_name: str, now_s: float
    ) -> Pupil | KeptWork | None:
        """Return the pupil with the token of an earlier page and the same name."""
        for pupil in self._all_works():
            is_here = isinstance(pupil, Pupil) and now_s - pupil.heard_s <= PLACE_S
            if pupil.token and pupil.token == token and not is_here:
                return pupil if are_alike(pupil.typed_name, typed_name) else None
        return None

    def _pupils_at(self, address: str) -> list[Pupil]:
        return [pupil for pupil in self._pupil_by_token.values() if pupil.address == address]

    def _work_count(self, address: str | None = None) -> int:
        """Return the number of works in the class, of an address or in all."""
        return sum(address is None or work.address == address for work in self._all_works())

    def _names(self) -> list[str]:
        """Return the names of all who have a token."""
        return [work.name for work in self._all_works() if work.token]

    def _all_works(self) -> list[KeptWork | Pupil]:
        return [*self._kept_work_by_key.values(), *self._pupil_by_token.values()]

    def _give_place_away(self, now_s: float, silent_s: float, pupils: list[Pupil]) -> bool:
        """Take the place of the one of these that has been silent longest."""
        silent_pupils = [pupil for pupil in pupils
                  if now_s - pupil.heard_s > silent_s and self._turn(pupil) is None]  # fmt: skip
        if silent_pupils:
            self._forget(min(silent_pupils, key=lambda pupil: pupil.heard_s))
        return bool(silent_pupils)

    def _forget(self, pupil: Pupil) -> None:
        """A pupil is here no more; the work stays, for who comes back."""
        del self._pupil_by_token[pupil.token]
        if pupil.work.text:
            work = KeptWork(pupil.name, pupil.typed_name, pupil.work, pupil.token, pupil.address)
            work.handout_key = pupil.handout_key
            self._keep(work)
        for work in self._kept_work_by_key.values():
            if work.recipient_token == pupil.token:
                work.recipient_token = ""

    def _keep(self, work: KeptWork) -> None:
        self._kept_work_by_key[work.key] = work

    def _report_page(self, pupil: Pupil, request: Json) -> Json:
        """A page reports its program, and hears its place: 0 is a turn, -1 none."""
        self._update_work(pupil, request)
        robot_wish, hand_wish = request.get("wants"), request.get("hand")
        mates = self._mates(pupil)
        if robot_wish is False:
            for mate in mates:
                mate.queue_number = None
        elif robot_wish is True and not any(
            mate.queue_number or self._turn(mate) for mate in mates
        ):
            pupil.queue_number = next(self._numbers)
        if hand_wish is False:
            pupil.hand_number = None
        elif hand_wish is True and pupil.hand_number is None:
            pupil.hand_number = next(self._numbers)
        self._tend()
        if self._ending:
            pupil.knows_end = True
            return {"over": self._ending}
        turn, waiting_pupils = self._turn_of(mates), self._waiting_pupils()
        place = -1 if turn is None else 0
        for mate in mates:
            if mate in waiting_pupils:
                place = waiting_pupils.index(mate) + 1
        group, groups = self._groups.group_of(pupil.token), self._groups.overview()
        driver = turn.pupil if turn is not None else None
        given_work = next(
            (
                work
                for work in self._kept_work_by_key.values()
                if work.recipient_token == pupil.token
            ),
            None,
        )
        return {
            "name": pupil.name,
            "place": place,
            "waiting": len(waiting_pupils),
            "robots": len(self._robots),
            "robot": turn.name if turn else "",
            "left_s": self._remaining_s(turn) if turn else 0,
            "hand": pupil.hand_number is not None,
            **(
                {"run": pupil.run_request.number}
                if pupil.run_request and not pupil.run_request.is_whole
                else {}
            ),
            **({"stops": turn.stop_number} if turn is not None and group is not None else {}),
            **({"groups": groups} if groups else {}),
            **({"group": group.name} if group is not None else {}),
            **({"driver": driver.name} if driver is not None and driver is not pupil else {}),
            **(
                {"given": {"key": given_work.key, **given_work.work._asdict()}}
                if given_work
                else {}
            ),
            # Until the page has opened it, however often it is reloaded or not heard.
            **(
                {"handout": self._handout._asdict()}
                if self._handout.key not in ("", pupil.handout_key)
                else {}
            ),
        }

    def _update_work(self, pupil: Pupil, request: Json) -> None:
        """Update a pupil's work from a page; omitted parts stay. Raises BadRequest."""
        new_fields = {name: request[name] for name in Work._fields if request.get(name) is not None}
        if "robot" in new_fields:
            robot_of(new_fields)
        old_fields = {**pupil.work._asdict(), "lessons": list(pupil.work.lessons)}
        work = Work.of({**old_fields, **new_fields})
        if work is None:
            raise BadRequest
        if work != pupil.work:
            pupil.work = work
            pupil.version += 1
        if isinstance(request.get("is_right"), bool):
            pupil.is_right = request["is_right"]
        if request.get("own_robot") is not None:
            pupil.own_robot = OwnRobot.of(request["own_robot"])
        self._confirm_receipt(pupil, request.get("took"))
        if request.get("opened") == self._handout.key:
            pupil.handout_key = self._handout.key

    def _confirm_receipt(self, pupil: Pupil, receipt: object) -> None:
        """A page says that it has what it was given: the very text proves it."""
        fields = receipt if isinstance(receipt, dict) else {}
        kept_work = self._kept_work_by_key.get(str(fields.get("key")))
        if (
            kept_work is None
            or kept_work.recipient_token != pupil.token
            or fields.get("text") != kept_work.work.text
        ):
            return
        del self._kept_work_by_key[kept_work.key]
        lessons = dict.fromkeys((*kept_work.work.lessons, *pupil.work.lessons))
        pupil.work = kept_work.work._replace(lessons=tuple(lessons)[:MAX_LESSONS])
        pupil.version += 1

    def _connect(self, pupil: Pupil, request: Json) -> Json:
        self._tend()
        robot = self._turn(pupil) or self._turn_of(self._mates(pupil))
        if robot is None:
            return {"failure": "turn_none"}
        if robot.pupil is not pupil:
            if _count(request.get("saw_stops", robot.stop_number)) < robot.stop_number:
                return {"failure": "stopped_elsewhere"}  # the button was pressed before the stop
            robot.pass_to(pupil)
        # One that this page has left a moment ago is not the robot of this turn.
        answer = self._hosting.answer({**_own_request(pupil, request), "port": robot.port})
        if not answer:
            robot.hosted_robot = self._hosting.robot_of(pupil.hosting_page)
            self._share_with_group(robot)
        return answer

    def _share_with_group(self, robot: ClassRobot) -> None:
        """The group of who drives a robot sees what it tells, and no other one does any more."""
        if robot.hosted_robot is None or robot.pupil is None:
            return
        token = robot.pupil.token
        runs = self._groups.runs_of(token)
        if robot.group_runs is not None and robot.group_runs is not runs:
            robot.group_runs.add_news(token, [{"over": "left"}])
        robot.group_runs = runs
        witness = partial(runs.add_news, token) if runs is not None else None
        robot.hosted_robot.attending.witness = witness

    def _drive(self, pupil: Pupil, request: Json) -> Json:
        requests = request.get("asked", [])
        if not isinstance(requests, list) or not all(
            _is_allowed(robot_request) for robot_request in requests
        ):
            raise BadRequest
        return self._hosting.answer(_own_request(pupil, request))

    def _stop(self, pupil: Pupil, request: Json) -> Json:
        """Stop the pupil's own robot, or that of the group, whatever was requested. For others of
        the group it latches: earlier requests that arrive later are refused, whoever takes the
        robot over meanwhile.
        """
        robot = self._turn_of(self._mates(pupil))
        if robot is not None:
            stop_count = request.get("group_stops", 0)
            is_own = robot.pupil is pupil
            if is_own or self._groups.is_new_stop(pupil.token, _count(stop_count)):
                robot.stop_number = next(self._numbers)
                if not is_own and robot.hosted_robot is not None:
                    robot.hosted_robot.attending.latch()
        answer = self._hosting.answer({**_own_request(pupil, request), "do": "stop", "asked": []})
        return {**answer, **({"stops": robot.stop_number} if robot is not None else {})}

    # -- groups -----------------------------------------------------------------------------------

    def _change_group(self, pupil: Pupil, request: Json) -> Json:
        if request["do"] == "group_leave":
            self._groups.leave(pupil.token)
            self._share_turn_of(pupil)
            return {}
        if self._ending:
            return {"failure": "class_over"}
        answer = self._groups.join(pupil.token, pupil.name, request)
        mates = self._mates(pupil)
        queue_numbers = [mate.queue_number for mate in mates if mate.queue_number is not None]
        for mate in mates:  # from here on they share one place and one robot
            mate.queue_number = None
        own_turn = self._turn(pupil)
        if own_turn is not None and self._turn_of(mates[1:]) is not None:
            own_turn.take_back()
        if queue_numbers and self._turn_of(mates) is None:
            pupil.queue_number = min(queue_numbers)
        self._share_turn_of(pupil)
        return answer

    def _share_turn_of(self, pupil: Pupil) -> None:
        robot = self._turn(pupil)
        if robot is not None:
            self._share_with_group(robot)

    def _mates(self, pupil: Pupil) -> list[Pupil]:
        """Return all pupils of the group, the pupil first; of no group that one alone."""
        tokens = self._groups.mate_tokens(pupil.token)
        return [pupil, *(mate for mate in self._pupil_by_token.values()
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
                pupil.queue_number = None
        for robot in self._robots:
            if robot.pupil is not None:
                self._check_turn(robot, now_s)
        for robot in self._robots:
            if robot.pupil is None and not self._ending and robot.free_at_s <= now_s:
                self._begin_turn(robot, now_s)

    def _check_turn(self, robot: ClassRobot, now_s: float) -> None:
        """End a turn that has to end, and learn the name of a robot that has answered."""
        hosted_robot, pupil = robot.hosted_robot, robot.pupil
        assert pupil is not None
        if hosted_robot is not None:
            robot.name = hosted_robot.name or robot.name
        if hosted_robot is None:
            # The page was closed, and a returning pupil keeps the place.
            if now_s - pupil.heard_s > PRESENCE_S:
                pupil.queue_number = robot.queue_number
                robot.end()
            elif now_s - robot.began_s > CONNECT_S:
                robot.end()
        elif hosted_robot.has_ended and hosted_robot.attending.is_half_made:
            robot.hosted_robot = None  # the page does not know of it: it may connect again
        elif hosted_robot.has_ended:
            if not hosted_robot.name and not hosted_robot.was_left:  # another robot may answer
                robot.free_at_s = now_s + REST_S
            robot.end()
        elif self._waiting_pupils() and (
            now_s - robot.began_s >= self._turn_s or hosted_robot.attending.silent_s > PRESENCE_S
        ):
            robot.take_back()

    def _begin_turn(self, robot: ClassRobot, now_s: float) -> None:
        """Assign a robot to the next pupil, or to a present one of the same group."""
        for pupil in self._waiting_pupils():
            present_mates = [
                mate for mate in self._mates(pupil) if now_s - mate.heard_s <= PRESENCE_S
            ]
            if present_mates and self._hosting.is_free(robot.port):
                queue_number, pupil.queue_number = pupil.queue_number, None
                present_mates[0].queue_number = queue_number
                robot.begin(present_mates[0], now_s)
            if present_mates:
                return

    def tidy(self) -> None:
        """Delete the stored data of groups that this class does not have."""
        self._groups.tidy()

    def _waiting_pupils(self) -> list[Pupil]:
        numbered_pupils = [
            (pupil.queue_number, pupil)
            for pupil in self._pupil_by_token.values()
            if pupil.queue_number is not None
        ]
        return [pupil for _, pupil in sorted(numbered_pupils, key=lambda numbered: numbered[0])]

    def _turn(self, pupil: Pupil) -> ClassRobot | None:
        return next((robot for robot in self._robots if robot.pupil is pupil), None)

    def _remaining_s(self, robot: ClassRobot) -> int:
        return max(0, round(self._turn_s - (self._clock() - robot.began_s)))

    # -- the teacher ------------------------------------------------------------------------------

    def teach(self, request: Json) -> Json:
        """Return the answer to a request of the teacher's page. Raises BadRequest."""
        action = request.get("do")
        if action in ("group_visit", "group_leave", "group"):
            return self._take_part(action, request)
        if not isinstance(action, str) or not action.startswith("class"):
            return self._hosting.answer(request)
        # A list of ports may take seconds: no pupil's stop waits for it.
        class_robot = _requested_robot(request) if action == "class_robot" else None
        with self._lock:
            if class_robot is not None:
                self._set_in_class(class_robot, request.get("gives") is True)
            elif action == "class_turn":
                self._turn_s = whole_number(request, "seconds", SHORTEST_TURN_S, LONGEST_TURN_S)
            elif action == "class_places":
                self._places_per_address = whole_number(request, "places", 1, MAX_PUPILS)
            elif action == "class_code":
                self.code = _new_code()
            elif action == "class_hand_out":
                self._handout = Handout.of(request, new_token())
            elif action == "class_over":
                self._end(request.get("erases") is True)
            elif action == "class_text":
                return self._work_data(request)
            elif action in ("class_stop", "class_next", "class_remove", "class_hand"):
                pupil = self._pupil(request)
                if pupil is not None:  # the pupil may have left a moment ago
                    self._teach(action, pupil)
            elif action == "class_run":
                return self._requested_run(request)
            elif action == "class_work":
                return {"pupils": self.works()}
            elif action == "class_bring":
                self._restore_work(request)
            elif action == "class_forget":
                self._kept_work_by_key.pop(str(request.get("key")), None)
            elif action == "class_give_back":
                self._give_back(request)
            elif action == "class_anew":
                self._begin_anew()
            elif action != "class":
                raise BadRequest
            self._tend()
            return self._state()

    def _take_part(self, action: str, request: Json) -> Json:
        """Let the teacher edit with a group, without a turn or a place in the queue."""
        if action == "group":
            return self._groups.answer(TEACHER, request)
        if action == "group_leave":
            self._groups.leave(TEACHER)
            return {}
        return {"failure": "class_over"} if self._ending else self._groups.visit(request)

    def _teach(self, action: str, pupil: Pupil) -> None:
        robot = self._turn(pupil)
        if action == "class_hand":
            pupil.hand_number = None
        elif action == "class_stop":
            if robot is not None and robot.hosted_robot is not None:
                robot.hosted_robot.attending.latch()
        else:
            if robot is not None:
                robot.take_back()
            if action == "class_remove":
                self._groups.leave(pupil.token)
                self._forget(pupil)

    def _work_data(self, request: Json) -> Json:
        """Return the work of a pupil, or of a group, or kept work, by the key in the request."""
        group = self._groups.group_by_key(request.get("group"))
        if group is not None:
            return {"version": group.program.number, "history": self._groups.history_lines(group),
                    **Work(group.text)._asdict()}  # fmt: skip
        owner = self._pupil(request) or self._kept_work_by_key.get(str(request.get("key")))
        version = owner.version if isinstance(owner, Pupil) else 0
        return {"version": version, **(owner.work if owner else NOTHING)._asdict()}

    def _requested_run(self, request: Json) -> Json:
        """Ask a pupil's page for its newest run; return it once it is there."""
        pupil = self._pupil(request)
        if pupil is None:
            return {"run": ""}
        if request.get("asks") is True or pupil.run_request is None:
            pupil.run_request = RunRequest(next(self._numbers))
        if not pupil.run_request.is_whole:
            return {"run": None}
        file_text, pupil.run_request = pupil.run_request.file_text, None
        return {"run": file_text}

    # -- what is kept -----------------------------------------------------------------------------

    def works(self) -> list[Json]:
        """Return the work of all pupils, of those who are not here, too."""
        with self._lock:
            named_works = [
                (owner.name, owner.work) for owner in self._all_works() if owner.work.text
            ]
        return [{"name": name, **work._asdict()} for name, work in named_works]

    def _restore_work(self, request: Json) -> None:
        """Keep work that comes from a file, once. Raises BadRequest."""
        name, work = request.get("name"), Work.of(request)
        work_name = plain_name(name) if isinstance(name, str) else ""
        if not work_name or work is None:
            raise BadRequest
        if any(
            (kept_work.name, kept_work.work) == (work_name, work)
            for kept_work in self._kept_work_by_key.values()
        ):
            return
        if self._work_count() >= MAX_WORKS:
            raise BadRequest
        self._keep(KeptWork(work_name, work_name, work))

    def _give_back(self, request: Json) -> None:
        """Return kept work to one pupil, whose page puts it into the editor."""
        kept_work, pupil = self._kept_work_by_key.get(str(request.get("key"))), self._pupil(request)
        if kept_work is not None:  # the page may have taken it a moment ago
            kept_work.recipient_token = pupil.token if pupil else ""

    def _begin_anew(self) -> None:
        """Begin another class: nobody is in it, and nothing is kept of the one before."""
        for robot in self._robots:
            robot.take_back()
        self._groups.end()
        self._pupil_by_token.clear()
        self._kept_work_by_key.clear()
        self._handout = NO_HANDOUT
        self.code = _new_code()
        self._is_continued = False

    def state_to_keep(self) -> Json | None:
        """Return all that a class goes on with after a crash; None once it is over."""
        with self._lock:
            if self._ending:
                return None
            return {
                "code": self.code,
                "turn_s": self._turn_s,
                "places": self._places_per_address,
                "robots": [robot.port for robot in self._robots],
                "groups": self._groups.state_to_keep(),
                "handout": self._handout._asdict(),
                "kept": [
                    {
                        "name": item.name,
                        "written": item.typed_name,
                        "token": item.token,
                        "address": item.address,
                        "given_to": item.recipient_token,
                        "key": item.key,
                        "opened": item.handout_key,
                        **item.work._asdict(),
                    }
                    for item in self._kept_work_by_key.values()
                ],
                "pupils": [
                    {
                        "token": pupil.token,
                        "name": pupil.name,
                        "written": pupil.typed_name,
                        "address": pupil.address,
                        "opened": pupil.handout_key,
                        **pupil.work._asdict(),
                    }
                    for pupil in self._pupil_by_token.values()
                ],
            }

    def resume(self, state: Json, is_same_lesson: bool = True) -> int:
        """Continue a class from before a crash; return how many pupils it has. Damaged parts are
        left out. All work of another lesson is kept, and pupils join with another code."""
        with self._lock:
            now_s = self._clock()
            for row in _rows(state, "pupils")[:MAX_PUPILS]:
                kept_work = _work_of_row(row, Work.of(row) or NOTHING)
                if kept_work is not None and kept_work.token and kept_work.address:
                    self._admit(kept_work, kept_work.address, now_s)
            for row in _rows(state, "kept"):
                kept_work = _work_of_row(row, Work.of(row))
                if kept_work is not None and self._work_count() < MAX_WORKS:
                    if kept_work.recipient_token not in self._pupil_by_token:
                        kept_work.recipient_token = ""
                    self._keep(kept_work)
            self._is_continued = bool(self._pupil_by_token or self._kept_work_by_key)
            present_tokens = set(self._pupil_by_token) if is_same_lesson else set()
            self._groups.resume(_rows(state, "groups"), present_tokens.__contains__)
            if not is_same_lesson:
                for pupil in list(self._pupil_by_token.values()):
                    self._forget(pupil)
                return 0
            for port in state["robots"] if isinstance(state.get("robots"), list) else []:
                with suppress(BadRequest):
                    self._set_in_class(_requested_robot({"port": port, "gives": True}), True)
            code = state.get("code")
            if isinstance(code, str) and len(code) == CODE_LETTERS and set(code) <= set(LETTERS):
                self.code = code
            handout = state.get("handout")
            if isinstance(handout, dict) and is_token(handout.get("key")):
                with suppress(BadRequest):
                    self._handout = Handout.of(handout, handout["key"])
            with suppress(BadRequest):
                self._places_per_address = whole_number(state, "places", 1, MAX_PUPILS)
            if not self._is_turn_given:
                with suppress(BadRequest):
                    self._turn_s = whole_number(state, "turn_s", SHORTEST_TURN_S, LONGEST_TURN_S)
            return len(self._pupil_by_token)

    def _set_in_class(self, class_robot: ClassRobot, is_in_class: bool) -> None:
        """Add a robot to the class, or remove it."""
        port = canonical_port(class_robot.port)
        same_robots = [robot for robot in self._robots if canonical_port(robot.port) == port]
        for same_robot in same_robots:
            if not is_in_class:
                same_robot.take_back()
                self._robots.remove(same_robot)
        if is_in_class and not same_robots:
            if len(self._robots) >= MAX_ROBOTS:
                raise BadRequest
            self._robots.append(class_robot)

    def _end(self, erases: bool) -> None:
        for robot in self._robots:
            robot.take_back()
        self._groups.end()
        self._ending = "erased" if erases else "kept"
        self._ended_s = self._clock()

    @property
    def has_ended(self) -> bool:
        """Return whether the class is over and all reachable pages know it."""
        with self._lock:
            now_s = self._clock()
            present_pupils = [
                pupil for pupil in self._pupil_by_token.values() if now_s - pupil.heard_s <= QUEUE_S
            ]
            are_told = all(pupil.knows_end for pupil in present_pupils)
            return bool(self._ending) and (are_told or now_s - self._ended_s > END_NOTICE_S)

    def _state(self) -> Json:
        now_s, waiting_pupils = self._clock(), self._waiting_pupils()
        return {
            "code": self.code,
            "turn_s": self._turn_s,
            "places": self._places_per_address,
            "over": self._ending,
            "goes_on": self._is_continued,
            "lessons": len(catalogue.folders()),
            "handout": {
                "lesson": self._handout.lesson,
                "opened": sum(
                    pupil.handout_key == self._handout.key
                    for pupil in self._pupil_by_token.values()
                ),
            }
            if self._handout.key
            else None,
            "kept": [
                {
                    "key": item.key,
                    "name": item.name,
                    "lessons": item.work.lessons,
                    "given": self._pupil_number(item.recipient_token),
                    "alike": [
                        pupil.number
                        for pupil in self._pupil_by_token.values()
                        if are_alike(pupil.typed_name, item.typed_name)
                    ],
                }
                for item in self._kept_work_by_key.values()
            ],
            "pupils": [
                {
                    "number": pupil.number,
                    "name": pupil.name,
                    "silent_s": round(now_s - pupil.heard_s),
                    "place": waiting_pupils.index(pupil) + 1 if pupil in waiting_pupils else 0,
                    "robot": turn.name or turn.port if (turn := self._turn(pupil)) else "",
                    "is_running": turn is not None and turn.is_running,
                    "left_s": self._remaining_s(turn) if turn else 0,
                    "version": pupil.version,
                    "is_right": pupil.is_right,
                    "own_robot": pupil.own_robot._asdict(),
                    "hand": pupil.hand_number or 0,
                    "lessons": pupil.work.lessons,
                }
                for pupil in self._pupil_by_token.values()
            ],
            "groups": [
                {
                    "key": group.key,
                    "name": group.name,
                    "pupils": [self._pupil_number(member.token) for member in group.pupils],
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
        return next(
            (pupil for pupil in self._pupil_by_token.values() if pupil.number == number), None
        )

    def _pupil_number(self, token: str) -> int:
        return self._pupil_by_token[token].number if token in self._pupil_by_token else 0


def _own_request(pupil: Pupil, request: Json) -> Json:
    """Return a request about the pupil's own robot: what it calls its page tells tabs apart."""
    return {**request, "page": pupil.hosting_page, "tab": request.get("page")}


def _count(value: object) -> int:
    return value if type(value) is int else 0


def _is_allowed(request: object) -> bool:
    """Return whether a pupil may ask this of a robot."""
    if not isinstance(request, dict) or request.get("do") not in ALLOWED_REQUESTS:
        return False
    return request["do"] != "trim" or request.get("trim") is None


def _requested_robot(request: Json) -> ClassRobot:
    """Return the robot of a request, with the name that it had last. Raises BadRequest."""
    port = port_of(request)
    return ClassRobot(port, _name_of(port) if request.get("gives") is True else "")


def _rows(state: Json, name: str) -> list[Json]:
    rows = state.get(name)
    return [row for row in rows if isinstance(row, dict)] if isinstance(rows, list) else []


def _work_of_row(row: Json, work: Work | None) -> KeptWork | None:
    """Return the work and its owner in a row of a file; None if either is missing."""
    name = row.get("name")
    work_name = plain_name(name) if isinstance(name, str) else ""
    if work is None or not work_name:
        return None
    kept_work = KeptWork(work_name, work_name, work)
    typed_name, address = row.get("written"), row.get("address")
    if isinstance(typed_name, str):
        kept_work.typed_name = plain_name(typed_name) or work_name
    kept_work.address = address if isinstance(address, str) else ""
    kept_work.token = _token_of_row(row, "token")
    kept_work.recipient_token = _token_of_row(row, "given_to")
    kept_work.key = _token_of_row(row, "key") or kept_work.key
    kept_work.handout_key = _token_of_row(row, "opened")
    return kept_work


def _token_of_row(row: Json, name: str) -> str:
    return str(row[name]) if is_token(row.get(name)) else ""


def _new_code() -> str:
    return "".join(secrets.choice(LETTERS) for _ in range(CODE_LETTERS))


def _name_of(port: str) -> str:
    """Return the name of the robot that was there last, or nothing."""
    wanted_port = canonical_port(port)
    return next(
        (
            str(listed_port["name"])
            for listed_port in list_ports()
            if canonical_port(listed_port["port"]) == wanted_port
        ),
        "",
    )
