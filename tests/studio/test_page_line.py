"""The session with a robot in the page, in the robot's own time, without real waits."""

from __future__ import annotations

import json
from pathlib import Path
from random import Random
from typing import Any

import pytest

from tests.support.node import in_node, page_data
from tests.support.virtual_robot import robot_in
from tiniscript import compile, robots
from tiniscript.link import keys
from tiniscript.link.authority import RobotKey
from tiniscript.link.messages import HOLD_MS, KEY_BYTES, KEY_TEACHER, REMOTE
from tiniscript.studio import page_line, worker
from tiniscript.studio.page_line import ATTENDED_MS, PageKeys, PageRobot
from tiniscript.studio.robot_link import MAX_WAITING, BadRequest

__all__ = ["page_data"]  # a fixture
TABS_SCRIPT = Path(__file__).with_name("stored_keys_in_node.mjs")
TABS_SEEDS = 30
FOREVER = "LOOP(FOREVER);\nF(1, 80);\nEND_LOOP"
OWNER = 0


class Page:
    """A page and its robot."""

    def __init__(self, page_keys: PageKeys | None = None, memory: bytes | None = None) -> None:
        self.robot = robot_in(memory=memory)
        self.page = PageRobot("tinibot", "en", page_keys or PageKeys(b""))
        self.news: list[dict[str, Any]] = []
        self.file = ""
        self._count = 0
        self._to_page = b""

    def advance(self, milliseconds: int, *requests: dict[str, Any], is_away: bool = False) -> None:
        """Advance time. A hidden page sends no requests."""
        for ms in range(milliseconds):
            now_ms = self.robot.now_ms + 1
            sent_bytes = b""
            if not is_away:
                answer = self.page.advance(self._to_page, now_ms, list(requests) if ms == 0 else [])
                sent_bytes, self._to_page = bytes.fromhex(answer["send"]), b""
                self.news += answer["news"]
                self.file = answer.get("keys", self.file)
            self._to_page += self.robot.step(now_ms, sent_bytes)

    def ask(self, action: str, limit_ms: int = 30_000, **fields: object) -> dict[str, Any]:
        self._count += 1
        self.advance(1, {"do": action, "id": self._count, **fields})
        for _ in range(limit_ms):
            answers = [item for item in self.news if item.get("id") == self._count]
            if answers:
                return answers[0]
            self.advance(1)
        raise AssertionError("no answer")

    def upload(self, text: str) -> dict[str, Any]:
        image = compile(text).image.hex()
        return self.ask("upload", image=image, robot="tinibot", runs=True)

    @property
    def moves(self) -> bool:
        return self.robot.driving.left != 0


@pytest.fixture
def page() -> Page:
    made_page = Page()
    assert made_page.ask("hello")["robot"]["robot"] == "tinibot"
    return made_page


def test_a_returning_page_stops_its_robot(page: Page) -> None:
    page.upload(FOREVER)
    page.advance(300)
    assert page.robot.is_running
    page.advance(ATTENDED_MS - 100, is_away=True)
    page.advance(50)
    assert page.robot.is_running  # a busy browser may take that long
    page.advance(ATTENDED_MS + 50, is_away=True)
    assert page.robot.is_running  # the dead-man timer takes longer
    page.advance(100)
    assert not page.robot.is_running
    assert page.news[-1] == {"event": "STOPPED", "cause": "SEQUENCE"}
    page.upload(FOREVER)
    page.advance(300)
    assert page.robot.is_running
    page.advance(1300, is_away=True)  # a page that stays away is not waited for
    assert not page.robot.is_running


def test_a_returning_page_gets_its_stop_after_any_absence(page: Page) -> None:
    for away_ms in (ATTENDED_MS + 50, 3000, 20_000, ATTENDED_MS + 50):
        assert page.upload(FOREVER)["ok"]
        page.advance(300)
        page.advance(away_ms, is_away=True)
        page.news.clear()
        page.advance(300)
        events = [item["event"] for item in page.news if "event" in item]
        assert events[-1] == "STOPPED" and "LOST" not in events, away_ms


def test_only_the_owner_drives_a_claimed_robot_from_the_page(page: Page) -> None:
    for _ in range(50):
        page.advance(1)
    page.robot.press()
    claimed = page.ask("claim")
    page.robot.let_go()
    assert claimed == {"id": 2, "ok": True}
    kept_bytes = page.file.encode()
    assert [key.kind for key in keys.decode_keys(kept_bytes)] == [OWNER]
    page.advance(3000)  # until the program is saved
    memory = page.robot.memory

    stranger = Page(memory=memory)
    assert stranger.ask("hello")["robot"]["owner"] == "other"
    assert stranger.upload(FOREVER)["failure"] == "NOT_OWNER"
    response = stranger.ask("keys", keys=1, x=0, y=0)
    assert response["failure"] == "NOT_OWNER" and response["said"]
    assert not stranger.robot.is_running

    owner = Page(PageKeys(kept_bytes), memory)
    assert owner.ask("hello")["robot"]["owner"] == "yours"
    assert owner.upload(FOREVER)["ok"]
    owner.advance(100)
    assert owner.robot.is_running


def key(robot: int, kind: int = OWNER, byte: int = 1) -> RobotKey:
    return RobotKey(robot, kind, bytes([byte] * 16), "TINI")


def test_keys_of_a_file_replace_those_of_the_same_robot() -> None:
    page_keys = PageKeys(keys.encode_keys([key(1, byte=1), key(2, byte=2)]))
    assert page_keys.add(keys.encode_keys([key(1, byte=9), key(3, byte=3)])) == 2
    assert sorted((key.id, key.key[0]) for key in keys.decode_keys(page_keys.file().encode())) == [
        (1, 9), (2, 2), (3, 3),
    ]  # fmt: skip


def ask(data: bytes, **fields: object) -> dict[str, Any]:
    """Return the answer of the page's Python."""
    answer: dict[str, Any] = json.loads(worker.answer(json.dumps(fields), data))
    return answer


@pytest.mark.parametrize("seed", range(10))
def test_concurrent_pages_lose_no_key(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Keys from a list, here or in another tab, or from a claim: the page keeps the newest of each
    robot and person, and so does the session with a connected robot.
    """
    monkeypatch.setattr(page_line, "_robot", None)
    rng, kept_text, known_text = Random(seed), "", ""
    newest_keys: dict[tuple[int, int], bytes] = {}

    def add_in_other_tab() -> None:
        nonlocal kept_text
        other_tab_keys = PageKeys(kept_text.encode())
        robot = rng.randrange(5, 9)
        other_tab_keys.add(keys.encode_keys([RobotKey(robot, OWNER, rng.randbytes(KEY_BYTES))]))
        kept_text = other_tab_keys.file()
        newest_keys.update({key.slot: key.key for key in other_tab_keys.keys})

    def link(now_ms: int) -> dict[str, Any]:
        fields = {} if kept_text == known_text else {"kept": kept_text}
        return ask(b"", do="link", now_ms=now_ms, asked=[], **fields)

    for now_ms in range(40):
        new_keys = [
            RobotKey(robot, rng.choice((OWNER, KEY_TEACHER)), rng.randbytes(KEY_BYTES))
            for robot in rng.sample(range(1, 5), 2)
        ]
        if rng.random() < 0.3:
            add_in_other_tab()
        match rng.choice(("connect", "import", "claim", "link")):
            case "connect":
                ask(kept_text.encode(), do="connect", robot="tinibot", language="en")
                new_keys, known_text = [], kept_text
            case "import":
                kept_text = ask(keys.encode_keys(new_keys), do="import_keys", kept=kept_text)[
                    "keys"
                ]
            case "claim" | "link" as action if page_line._robot:
                new_keys = new_keys[: action == "claim"]
                for key in (*new_keys, *new_keys):  # the second time it is there already
                    page_line._robot.keys.settle_key(key)
                answer = link(now_ms)
                assert ("keys" in answer) == bool(new_keys)
                known_text = kept_text
                if new_keys and rng.random() < 0.3:  # in this moment, so they are not stored
                    add_in_other_tab()
                    answer = link(now_ms)
                known_text = kept_text = answer.get("keys", kept_text)
            case _:
                continue
        newest_keys |= {key.slot: key.key for key in new_keys}
        kept_keys = keys.decode_keys(kept_text.encode()) if kept_text else []
        assert {key.slot: key.key for key in kept_keys} == newest_keys
        assert not page_line._robot or page_line._robot.keys.keys_of_robot(None) == kept_keys


def test_tabs_lose_no_keys_and_store_one_before_the_robot_does(
    page_data: Path,
) -> None:
    rows = [json.loads(line) for line in in_node(TABS_SCRIPT, str(page_data), str(TABS_SEEDS))]
    assert len(rows) == TABS_SEEDS and sum(row["count"] for row in rows) > 10 * TABS_SEEDS
    assert [row for row in rows if row["lost"] or row["early"]] == []


@pytest.mark.parametrize(
    "data", [b"", b"{", b"[]", b"\xff", b'{"tiniscript_keys": 1}', b"[" * 5000]
)
def test_anything_but_a_file_of_keys_changes_nothing(data: bytes) -> None:
    kept_text = keys.encode_keys([key(1)]).decode()
    assert ask(data, do="import_keys", kept=kept_text) == {"count": None}


def test_damaged_stored_keys_do_not_block_a_robot() -> None:
    assert ask(b"damaged", do="connect", robot="tinibot", language="es") == {}
    answer = ask(b"", do="link", now_ms=5, asked=[{"do": "hello", "id": 1}])
    assert answer["send"] and answer["news"] == []


def test_every_shipped_robot_can_be_named() -> None:
    for name in robots.names():
        assert PageRobot(name, "en", PageKeys(b"")).advance(b"", 0, [])["send"] == ""


def test_a_page_gets_the_place_of_its_program(page: Page) -> None:
    page.upload(FOREVER)
    page.advance(500)
    assert "PLACE" in {item.get("event") for item in page.news}


STICK = "SI|LOOP(FOREVER);\nM(PAD_Y, PAD_Y);\nIF(KEY_B);\nS;\nENDIF;\nW(0.02);\nEND_LOOP"


def hold_keys(page: Page, keys: int = 0, x: int = 0, y: int = 0) -> dict[str, Any]:
    return page.ask("keys", keys=keys, x=x, y=y)


def test_a_stick_is_held_until_it_returns_or_times_out(page: Page) -> None:
    assert page.ask("hello")["robot"]["has_remote"]
    page.upload(STICK)
    for _ in range(4):
        assert hold_keys(page, y=60)["ok"]
        page.advance(200)
        assert round(page.robot.driving.left) == 60
    assert hold_keys(page)["ok"]
    page.advance(60)
    assert round(page.robot.driving.left) == 0
    hold_keys(page, y=-60)
    page.advance(HOLD_MS - 100)
    assert round(page.robot.driving.left) == -60
    page.advance(200)
    assert round(page.robot.driving.left) == 0 and page.robot.is_running


def test_a_hanging_page_holds_no_keys(page: Page) -> None:
    page.upload(STICK)
    hold_keys(page, y=60)
    page.advance(100)
    page.advance(HOLD_MS + 50, is_away=True)
    assert round(page.robot.driving.left) == 0


def test_keys_after_a_stop_start_nothing_but_reach_the_next_program(page: Page) -> None:
    page.upload(STICK)
    hold_keys(page, y=60)
    page.ask("stop")
    assert not hold_keys(page, y=60).get("said"), "the stop is on its way, and ends it"
    for _ in range(5):
        page.advance(200)
        assert hold_keys(page, y=60)["ok"]
    assert round(page.robot.driving.left) == 0 and not page.robot.is_running
    page.upload(STICK)
    assert hold_keys(page, y=60)["ok"]
    page.advance(100)
    assert round(page.robot.driving.left) == 60


def test_keys_neither_end_nor_displace_an_upload(page: Page) -> None:
    image = compile("SI|" + "SHOW(1);" * 60).image.hex()
    upload_request = {"do": "upload", "image": image, "robot": "tinibot", "runs": True}
    page.advance(1, *({"do": "keys", "id": 100 + k, "keys": 0, "x": 0, "y": k} for k in range(60)))
    page.advance(1, {"id": 99, **upload_request})
    for k in range(40):
        page.advance(20, {"do": "keys", "id": 200 + k, "keys": 1, "x": 0, "y": k})
    page.advance(2000)
    answers = {item["id"]: item for item in page.news if "id" in item}
    assert answers[99].get("ok")
    assert {*range(100, 160), *range(200, 240)} <= answers.keys(), "each has its answer"
    assert not any(answer.get("said") for answer in answers.values())
    names = [{"do": "hello", "id": 300 + k} for k in range(MAX_WAITING)]
    keys = {"do": "keys", "id": 400, "keys": 0, "x": 0, "y": 0}
    page.advance(1, *names, keys)
    with pytest.raises(BadRequest):
        page.page.link.ask({"do": "hello", "id": 401})


@pytest.mark.parametrize(
    "wrong_fields",
    [{"keys": 64}, {"keys": -1}, {"x": 101}, {"y": -101}, {"x": 1.5}, {"keys": True}, {"y": None}],
    ids=str,
)
def test_impossible_key_states_are_refused(page: Page, wrong_fields: dict[str, Any]) -> None:
    with pytest.raises(BadRequest):
        page.page.link.ask({"do": "keys", "id": 1, "keys": 0, "x": 0, "y": 0, **wrong_fields})


def test_a_robot_without_a_remote_control_gets_no_key_messages(page: Page) -> None:
    robot = page.page.line.robot
    assert robot is not None
    values = robot.values._replace(features=robot.values.features & ~REMOTE)
    page.page.line.session._handshake.robot = robot._replace(values=values)
    response = hold_keys(page, y=60)
    assert response["failure"] == "NO_REMOTE" and "no remote control" in response["said"]
    assert page.upload(STICK)["failure"] == "NO_REMOTE"
    assert round(page.robot.driving.left) == 0
