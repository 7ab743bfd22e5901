"""The ports and robots of this computer that a page reaches through `tsc studio`."""

from __future__ import annotations

import random
import time
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from tests.support.command import FOREVER, Command, run_subprocess
from tests.support.pty_robot import PtyRobot
from tests.support.rows import each_row
from tests.support.shared_pty_robot import SharedLine
from tests.support.waiting import HANG_LIMIT_S, until
from tiniscript import compile, robots
from tiniscript.library import opening
from tiniscript.library.errors import RobotError
from tiniscript.link import known_ports, ports
from tiniscript.link.known_ports import KnownPorts
from tiniscript.link.messages import STOP_BYTES
from tiniscript.link.ports import ListedPort
from tiniscript.studio import attending, hosted_robot
from tiniscript.studio import hosting as hosting_module
from tiniscript.studio.hosting import Hosting
from tiniscript.studio.robot_link import BadRequest
from tiniscript.virtual import directory
from tiniscript.virtual.directory import RunningRobot

KIT = robots.load("tinibot").kit
BEAT_S = 0.1
SILENT_MS = 2000  # after HEARD_S and the dead-man timer, and before LEFT_S ends the run


class Page:
    """A page that a test plays: it is heard while it waits for something."""

    def __init__(self, hosting: Hosting, name: str = "page") -> None:
        self.hosting = hosting
        self.name = name
        self.news: list[dict[str, Any]] = []
        self._seen_number = self.count = 0

    def connect(self, port: str, **fields: object) -> dict[str, Any]:
        request = {"do": "connect", "page": self.name, "port": port, "robot": "tinibot",
                   "language": "es", **fields}  # fmt: skip
        return self.hosting.answer(request)

    def beat(self, *requests: dict[str, Any], action: str = "beat") -> None:
        request = {
            "do": action,
            "page": self.name,
            "seen": self._seen_number,
            "asked": list(requests),
        }
        for item in self.hosting.answer(request)["news"]:
            self._seen_number = max(self._seen_number, item["number"])
            self.news.append(item)

    def until(
        self, is_reached: Callable[[dict[str, Any]], bool], timeout_s: float = HANG_LIMIT_S
    ) -> dict[str, Any]:
        """Wait for news, beating."""
        end_s = time.monotonic() + timeout_s
        while True:
            for item in self.news:
                if is_reached(item):
                    self.news.remove(item)
                    return item
            assert time.monotonic() < end_s, self.news
            time.sleep(BEAT_S)
            self.beat()

    def ask(self, action: object, **fields: object) -> dict[str, Any]:
        self.count += 1
        number = self.count
        self.beat({"do": action, "id": number, **fields})
        return self.until(lambda item: item.get("id") == number)

    def upload(self, text: str, robot: str = "tinibot", **fields: object) -> dict[str, Any]:
        image = compile(text, robot=robot).image.hex()
        return self.ask("upload", image=image, robot=robot, **{"runs": True, **fields})


@pytest.fixture
def hosting() -> Iterator[Hosting]:
    new_hosting = Hosting()
    yield new_hosting
    new_hosting.close()


@pytest.fixture
def robot() -> Iterator[PtyRobot]:
    with PtyRobot(KIT) as pty_robot:
        yield pty_robot


@pytest.fixture
def page(hosting: Hosting, robot: PtyRobot) -> Page:
    """A page that has met its robot."""
    made_page = Page(hosting)
    assert made_page.connect(robot.port) == {}
    connected_item = made_page.until(lambda item: "connected" in item)["connected"]
    assert (connected_item["robot"], connected_item["owner"], connected_item["is_running"]) == (
        "tinibot",
        "free",
        False,
    )
    return made_page


def start_drive(page: Page, robot: PtyRobot) -> None:
    page.upload(FOREVER)
    robot.until(lambda: robot.moves, "it drives")


def test_a_program_runs_and_its_values_arrive(page: Page, robot: PtyRobot) -> None:
    text = "SHOW(2.5);\nSHOW(1 < 2);\nF(0.1, 80)"
    receipt = page.upload(text)
    assert receipt["ok"] and receipt["program"] == f"{compile(text).checksum:08x}"
    shown_values = [page.until(lambda item: item.get("event") == "SHOW")["value"] for _ in range(2)]
    assert shown_values == ["2.5", "TRUE"]
    page.until(lambda item: item.get("event") == "DONE")
    assert "MOTORS 80 80" in robot.actions


def test_an_answer_precedes_its_consequences(page: Page) -> None:
    image = compile("SHOW(1)").image.hex()
    for number in range(5):
        page.news.clear()
        page.beat({"do": "live", "id": number + 1, "image": image, "robot": "tinibot"})
        while not any(item.get("event") == "DONE" for item in page.news):
            page.beat()
        order = [item["id"] if "id" in item else item["event"] for item in page.news]
        assert order == [number + 1, "STARTED", "SHOW", "DONE"]


def test_a_start_event_tells_whether_the_program_is_the_pages(page: Page) -> None:
    """A page records programs, but not a line that is tried."""
    image = compile("SHOW(1)").image.hex()
    for action, is_program in (("upload", True), ("live", False), ("start", True), ("live", False)):
        fields = {} if action == "start" else {"image": image, "robot": "tinibot"}
        page.news.clear()
        page.ask(action, **fields, **({"runs": True} if action == "upload" else {}))
        started_event = page.until(lambda item: item.get("event") == "STARTED")
        assert started_event["is_program"] is is_program, action
        page.until(lambda item: item.get("event") == "DONE")


def test_a_fault_reports_its_place(page: Page) -> None:
    page.upload("X = 0;\nSHOW(1 / X)")
    fault = page.until(lambda item: item.get("event") == "FAULT")
    assert fault["fault"] == "DIVIDE_BY_ZERO" and fault["at"] > 0


class EarlierRobot:
    """Closes its port at some time, or lets another command use it from some time on."""

    def __init__(self, clock: list[float], closed_s: float, holds_s: float) -> None:
        self.clock, self.closed_s, self.holds_s = clock, closed_s, holds_s

    @property
    def is_parting(self) -> bool:
        return self.clock[0] < self.closed_s

    @property
    def is_holding_port(self) -> bool:
        return self.clock[0] >= self.holds_s

    @property
    def free_s(self) -> float:
        return min(self.closed_s, self.holds_s)


@pytest.mark.parametrize("seed", range(20))
def test_a_port_is_opened_once_those_before_have_left_it(
    monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    """Or after the time that they may take; a page that has left meanwhile opens nothing."""
    rng, clock, opened_s = random.Random(seed), [0.0], list[float]()
    limit_s, poll_s = hosted_robot.PARTING_TIMEOUT_S, attending.POLL_INTERVAL_S

    def refuse(*_: object, **__: object) -> None:
        opened_s.append(clock[0])
        raise RobotError("port_missing", sentence_text="no such port")

    monkeypatch.setattr(hosted_robot, "monotonic", lambda: clock[0])
    monkeypatch.setattr(hosted_robot, "Client", refuse)
    monkeypatch.setattr(hosted_robot, "Thread", lambda **_: SimpleNamespace(start=lambda: None))
    for _ in range(5):
        clock[0], never_s = 0.0, 10 * limit_s
        opened_s.clear()
        earlier_robots = [
            EarlierRobot(clock, rng.choice((0, 1, 3, never_s)), rng.choice((2, never_s, never_s)))
            for _ in range(rng.randrange(4))
        ]
        left_s = rng.choice((0.0, 1.5, never_s, never_s))
        hosted = hosted_robot.HostedRobot("COM5", "tinibot", "en")
        hosted._earlier_robots = earlier_robots  # type: ignore[assignment]

        def wait(seconds: float, hosted: Any = hosted, left_s: float = left_s) -> None:
            clock[0] += seconds
            if clock[0] >= left_s:
                hosted.leave()

        for earlier in earlier_robots:
            vars(earlier)["join"] = wait
        wait(0)
        hosted._run()
        free_s = min(limit_s, max((robot.free_s for robot in earlier_robots), default=0.0))
        end_s = min(free_s, left_s)
        assert end_s <= clock[0] <= end_s + 2 * poll_s
        assert len(opened_s) == (not hosted.was_left) and hosted.has_ended
        assert hosted.was_left or end_s == free_s
        reasons = [item["over"] for item in hosted.attending._news if "over" in item]
        assert reasons == ["left" if hosted.was_left else "port_missing"]


class PlayedLink:
    """A link whose events come one at a time; `stop` does nothing but count."""

    def __init__(self, clock: list[float], owns_run: bool, events: list[str | None]) -> None:
        self.clock, self.owns_run, self.events = clock, owns_run, events
        self.stop_count = self.news_count = 0

    def news(self, timeout_s: float = 0.0) -> list[dict[str, Any]]:
        self.clock[0] += timeout_s
        self.news_count += 1
        event = self.events[self.news_count - 1] if self.news_count <= len(self.events) else None
        return [] if event is None else [{"event": event}]

    def stop(self) -> None:
        self.stop_count += 1


@pytest.mark.parametrize("seed", range(20))
def test_a_page_hears_of_its_stop_before_it_hears_that_it_is_over(
    monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    """All that happened is told. The wait ends with the confirmation, or a link that is lost."""
    rng, clock = random.Random(seed), [0.0]
    monkeypatch.setattr(hosted_robot, "monotonic", lambda: clock[0])
    monkeypatch.setattr(hosted_robot, "Thread", lambda **_: SimpleNamespace(start=lambda: None))
    poll_s, limit_s = attending.POLL_INTERVAL_S, opening.CONFIRM_TIMEOUT_S
    for _ in range(10):
        events = [rng.choice(("SHOW", None, None, "STOPPED", "LOST")) for _ in range(5)]
        link = PlayedLink(clock, rng.random() < 0.8, events)
        hosted = hosted_robot.HostedRobot("COM5", "tinibot", "en")
        start_s = clock[0]
        hosted._part_from_robot(link)  # type: ignore[arg-type]
        told_events = [item["event"] for item in hosted.attending._news]
        if not link.owns_run:
            assert (told_events, link.stop_count, hosted.is_unconfirmed) == ([], 0, False)
            continue
        ends = [k for k in range(1, 5) if events[k] in ("STOPPED", "LOST")]
        last = ends[0] if ends else 4
        shown = [event for event in events[1 : last + 1] if event is not None]
        assert told_events == [*([] if events[0] is None else [events[0]]), "STOPPING", *shown]
        assert link.stop_count == 1
        assert hosted.is_unconfirmed == (not ends or events[last] == "LOST")
        wait_s = last * poll_s if ends else limit_s
        assert wait_s - 1e-6 <= clock[0] - start_s <= wait_s + poll_s


@pytest.fixture
def always_attended(monkeypatch: pytest.MonkeyPatch) -> None:
    """The line attends to the robot whatever its page does: only a stop ends a run."""
    monkeypatch.setattr(hosted_robot.HostedRobot, "_ping_while_attended", lambda *_: None)
    monkeypatch.setattr(attending, "LEFT_S", 3600.0)


def check_stopped(robot: PtyRobot) -> None:
    robot.until(lambda: bytes(STOP_BYTES) in robot.received and not robot.moves, "it is stopped")
    assert "MOTORS 80 80" in robot.actions


@pytest.mark.usefixtures("always_attended")
def test_a_silent_page_stops_its_robot(page: Page, robot: PtyRobot) -> None:
    page.upload(FOREVER)
    start_s = time.monotonic()
    page.beat()
    check_stopped(robot)
    assert time.monotonic() - start_s >= attending.ATTENDED_S


@pytest.mark.usefixtures("always_attended")
def test_a_silent_page_is_noticed_after_a_reset(page: Page, robot: PtyRobot) -> None:
    """The robot counts its runs anew: the next one has the number of one that is over."""
    page.upload("SHOW(1)")
    page.until(lambda item: item.get("event") == "DONE")
    robot.switch_off()
    robot.switch_on()
    ran = page.upload(FOREVER)
    while "failure" in ran:  # until the session notices
        ran = page.upload(FOREVER)
    check_stopped(robot)


def test_a_responsive_page_continues(page: Page, robot: PtyRobot) -> None:
    page.upload(FOREVER)
    for _ in range(20):
        page.beat()
        time.sleep(BEAT_S)
    assert robot.moves


def test_no_pings_are_sent_for_a_silent_page(
    page: Page, robot: PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """This holds even if the thread that should stop the robot hangs."""
    start_drive(page, robot)
    monkeypatch.setattr(attending.Attending, "attend", lambda *_: time.sleep(0.1))
    page.beat()
    assert robot.standstill_after_ms(robot.robot_ms) < SILENT_MS  # stopped by its dead-man timer


def test_stop_stops_and_is_reported(hosting: Hosting, page: Page, robot: PtyRobot) -> None:
    """Also one that counts wrongly, before it is refused."""
    start_drive(page, robot)
    page.beat(action="stop")
    assert page.until(lambda item: item.get("event") == "STOPPED")["cause"] == "SEQUENCE"
    assert not robot.moves
    for stops in (-1, 0.5, "1", 2**40):
        start_drive(page, robot)
        with pytest.raises(BadRequest):
            hosting.answer({"do": "stop", "page": "page", "stops": stops})
        page.until(lambda item: item.get("event") == "STOPPED")
        assert not robot.moves, stops


def test_a_stop_by_another_command_is_reported(page: Page, robot: PtyRobot) -> None:
    start_drive(page, robot)
    from threading import Thread

    thread = Thread(target=lambda: run_subprocess("stop", "--port", robot.port))
    thread.start()
    page.until(lambda item: item.get("event") == "STOPPED")
    thread.join()
    assert not robot.moves


@pytest.mark.parametrize("does_page_leave", [True, False], ids=["page", "server"])
def test_the_end_of_a_page_and_of_the_server_stops_robots(
    hosting: Hosting, page: Page, robot: PtyRobot, does_page_leave: bool
) -> None:
    start_drive(page, robot)
    if does_page_leave:
        page.beat(action="leave")
        robot.until(lambda: not robot.moves, "it stands")
    else:
        hosting.close()
    assert not robot.moves


def test_a_run_of_another_command_continues_when_the_page_leaves(
    hosting: Hosting, page: Page, robot: PtyRobot
) -> None:
    """The next client reaches the robot through the holder of the port, and only the end of the
    studio stops it.
    """
    start_drive(page, robot)
    other_command = Command(
        "upload", "-e", "SI|LOOP(FOREVER);F(1, 30);END_LOOP", "--port", robot.port
    )
    other_command.until("running")
    page.beat(action="leave")
    start_ms = robot.robot_ms
    robot.until(lambda: robot.robot_ms > start_ms + 2000, "it goes on")
    assert robot.moves and other_command.process.poll() is None
    assert hosting.is_free(robot.port)
    second_page = Page(hosting, "another")
    assert second_page.connect(robot.port) == {}
    second_page.until(lambda item: "connected" in item)
    second_page.beat(action="leave")
    start_ms = robot.robot_ms
    robot.until(lambda: robot.robot_ms > start_ms + 1000, "it goes on")
    assert robot.moves and other_command.process.poll() is None
    assert hosting.close() == []
    robot.until(lambda: not robot.moves, "it stands")
    assert other_command.wait_for_result().code == 3


def test_a_port_has_one_page(
    hosting: Hosting, page: Page, robot: PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(attending, "LATCH_S", 3600.0)
    monkeypatch.setattr(attending, "LEFT_S", 3600.0)  # the page is silent while the command begins
    ports = hosting.answer({"do": "ports"})["ports"]
    assert all(set(port) == {"port", "name", "description", "virtual"} for port in ports)
    other_page = Page(hosting, "other")
    assert other_page.connect(robot.port) == {"failure": "other_tab"}
    assert page.connect(robot.port) == {}  # the page already has this robot
    hosted_robot = hosting.robot_of(page.name)
    assert hosted_robot and not hosted_robot.is_running
    start_drive(page, robot)
    assert hosted_robot.is_running
    # STOP of a page without a robot
    stop_report = {"name": robot.port, "stop": "asked"}
    assert hosting.answer({"do": "stop_all"}) == {"robots": [stop_report]}
    page.until(lambda item: item.get("event") == "STOPPED")
    stop_report["stop"] = "confirmed"
    assert hosting.answer({"do": "stops"}) == {"robots": [stop_report]}
    until(lambda: not hosted_robot.is_running, "it is known to stand")
    image = compile(FOREVER).image.hex()
    # The upload was under way.
    response = page.ask("upload", image=image, robot="tinibot", runs=True)
    assert response["failure"] == "stopped_elsewhere" and not robot.moves
    result = run_subprocess("upload", "--port", robot.port, "-e", FOREVER)  # by another command
    assert result.code != 0 and not robot.moves, result.out
    page.beat(action="leave")
    until(lambda: other_page.connect(robot.port) == {}, "the port is free")
    other_page.until(lambda item: "connected" in item)


def test_a_page_gets_the_reason_when_another_one_takes_its_robot(
    hosting: Hosting, page: Page, robot: PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(attending, "LEFT_S", 3600.0)
    hosted_robot = hosting.robot_of(page.name)
    assert hosted_robot
    hosted_robot.leave("turn_over")
    other_page = Page(hosting, "other")
    until(lambda: other_page.connect(robot.port) == {}, "the port is free")
    assert page.until(lambda item: "over" in item)["over"] == "turn_over"


@pytest.mark.parametrize("is_silent", [False, True])
def test_the_stop_at_the_end_of_a_turn_is_settled_within_the_turn(
    hosting: Hosting, page: Page, robot: PtyRobot, monkeypatch: pytest.MonkeyPatch, is_silent: bool
) -> None:
    """The person who ends the server is told about a silent robot."""
    start_drive(page, robot)
    page.beat()
    if is_silent:
        robot.switch_off()
        monkeypatch.setattr(opening, "CONFIRM_TIMEOUT_S", 0.3)
    hosted_robot = hosting.robot_of(page.name)
    assert hosted_robot
    page.news.clear()
    hosted_robot.leave("turn_over")
    page.until(lambda item: item.get("over") == "turn_over")
    events = [item["event"] for item in page.news if item.get("event") in ("STOPPING", "STOPPED")]
    assert events == (["STOPPING"] if is_silent else ["STOPPING", "STOPPED"])
    assert hosting.close() == ([robot.port] if is_silent else [])


def test_the_studio_shares_a_port_held_by_a_command(hosting: Hosting) -> None:
    with SharedLine() as (robot, _):
        page = Page(hosting)
        page.connect(robot.port)
        assert page.until(lambda item: "connected" in item)["held_by"] == "link"
        start_drive(page, robot)
        page.beat()
        assert robot.standstill_after_ms(robot.robot_ms) < SILENT_MS
        hosting.close()


def test_a_refusal_has_its_message(page: Page) -> None:
    response = page.upload("SHOW(LINE_L)", robot="liner")
    assert response["failure"] == "WRONG_KIT" and "kit" in response["said"]
    assert page.ask("start")["failure"] == "NO_PROGRAM"
    assert page.ask("identify")["ok"] and page.ask("name", name="Niña")["ok"]
    trim = {"is_exchanged": True, "is_left_reversed": False, "is_right_reversed": True,
            "balance": -7, "least": 12}  # fmt: skip
    assert page.ask("trim", trim=trim)["ok"]
    unmeasured = {"speed_40": 0, "speed_80": 0, "turn_40": 0, "turn_80": 0}
    assert page.ask("trim")["trim"] == {**trim, "pace": unmeasured}


def test_an_unopenable_or_unplugged_port_gives_a_message(
    hosting: Hosting, page: Page, robot: PtyRobot
) -> None:
    for port in ("/dev/nothing", "socket://127.0.0.1:1", "no such port"):
        other_page = Page(hosting, port)
        other_page.connect(port)
        over_item = other_page.until(lambda item: "over" in item)
        assert over_item["over"].startswith("port_") and port in over_item["said"]
    page.upload(FOREVER)
    robot.pull()
    over_item = page.until(lambda item: "over" in item)
    assert over_item["over"] == "port_gone" and "cable" in over_item["said"]


def test_anything_but_a_request_is_refused(hosting: Hosting) -> None:
    wrong_requests: list[dict[str, Any]] = [
        {},
        {"do": "fly"},
        {"do": "connect"},
        {"do": "connect", "page": "p", "port": "/dev/x\n", "robot": "tinibot", "language": "en"},
        {"do": "connect", "page": "p", "port": "/dev/x", "robot": "/etc/passwd", "language": "en"},
        {"do": "connect", "page": "p", "port": "/dev/x", "robot": "tinibot", "language": []},
        {"do": "connect", "page": "p" * 1000, "port": "/dev/x", "robot": "tinibot"},
        {"do": "beat", "page": ["p"]},
        {"do": "beat", "page": 0},
    ]
    for request in wrong_requests:
        with pytest.raises(BadRequest):
            hosting.answer(request)
            pytest.fail(f"not refused: {request}")


@each_row(
    "request",
    [
        {"do": "upload"},
        {"do": "upload", "image": "zz", "robot": "tinibot"},
        {"do": "upload", "image": "00", "robot": "tinibot"},
        {"do": "upload", "image": 5, "robot": "tinibot"},
        {"do": "name", "name": "x\n"},
        {"do": "name", "name": "x" * 17},
        {"do": "trim", "trim": {"balance": 99, "least": 0}},
        {"do": "trim", "trim": {"balance": "1", "least": 0}},
        {"do": "identify", "limit_ms": -1},
        {"do": ["identify"]},
    ],
)
def test_a_wrong_request_does_no_harm(page: Page, request: dict[str, Any]) -> None:
    """It does not harm the request after it in the same beat either."""
    wrong_id = page.count + 1
    page.count += 2
    page.beat({"id": wrong_id, **request}, {"id": page.count, "do": "identify"})
    assert page.until(lambda item: item.get("id") == wrong_id)["failure"] == "bad_request"
    assert page.until(lambda item: item.get("id") == page.count)["ok"]


def test_a_request_sent_before_a_stop_but_received_after_it_is_void(
    hosting: Hosting, page: Page, robot: PtyRobot
) -> None:
    hosting.answer({"do": "stop", "page": "page", "stops": 1})
    image = compile(FOREVER).image.hex()
    upload = {"do": "upload", "image": image, "robot": "tinibot", "runs": True}
    page.beat({"id": 50, "stops": 0, **upload})
    assert page.until(lambda item: item.get("id") == 50)["failure"] == "stopped_elsewhere"
    assert not robot.moves
    page.beat({"id": 51, "stops": 1, **upload})
    answer = page.until(lambda item: item.get("id") == 51)
    assert answer.get("ok"), answer


def test_a_duplicate_request_is_executed_once(page: Page, robot: PtyRobot) -> None:
    image = compile("SHOW(1)").image.hex()
    live_request = {"do": "live", "id": 9, "image": image, "robot": "tinibot"}
    page.beat(live_request)
    page.beat(live_request)
    page.until(lambda item: item.get("event") == "DONE")
    for _ in range(5):
        page.beat()
        time.sleep(BEAT_S)
    assert [item["event"] for item in page.news if "event" in item] == ["STARTED", "SHOW"]


def test_the_unread_event_queue_is_bounded() -> None:
    robot = hosted_robot.HostedRobot("socket://127.0.0.1:1", "tinibot", "en")
    robot.attending.queue_news([{"event": "SHOW", "value": str(k)} for k in range(3000)])
    robot.attending.queue_news([{"event": "DONE"}])
    news = robot.attending.on_beat([], 0)
    assert len(news) == attending.MAX_PENDING_NEWS and news[-1]["event"] == "DONE"
    robot.join(HANG_LIMIT_S)


@pytest.mark.parametrize("seed", range(20))
def test_ports_with_known_robots_are_offered_first(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The last used one before all others, each once."""
    rng = random.Random(seed)
    plugged, virtual, remembered = (
        [port for port in "abcdef" if rng.random() < 0.5] for _ in "pvr"
    )
    last_port = rng.choice([None, *remembered])
    running = [RunningRobot(port, "tinibot", "room", "", "") for port in virtual]
    names = dict.fromkeys(remembered, "TINI")
    monkeypatch.setattr(directory, "unclaimed_robots", lambda: running)
    monkeypatch.setattr(directory, "is_gone", lambda _: False)
    monkeypatch.setattr(hosting_module, "exists", lambda port: port in remembered)
    monkeypatch.setattr(ports, "list_ports", lambda: [ListedPort(port, "") for port in plugged])
    monkeypatch.setattr(known_ports, "remembered_ports", lambda: KnownPorts(last_port, names))
    offered = [row["port"] for row in hosting_module.list_ports()]
    assert sorted(offered) == sorted({*plugged, *virtual, *remembered})
    assert last_port is None or offered[0] == last_port
    are_known = [port in virtual or port in remembered for port in offered]
    assert are_known == sorted(are_known, reverse=True)
