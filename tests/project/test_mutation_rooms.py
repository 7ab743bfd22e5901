"""`python -m tools.mutation.rooms`: what it changes, and what it calls unnoticed."""

from __future__ import annotations

import ast
from itertools import pairwise
from pathlib import Path

import pytest

from tests.support.casefile import ROOT
from tools.mutation import rooms
from tools.mutation.javascript_operators import javascript_changes
from tools.mutation.python_operators import python_changes
from tools.mutation.rooms import Change
from tools.mutation.rooms_equivalent import EQUIVALENT
from tools.mutation.rooms_table import ROOMS, Room

SOURCE = '''
from here import of
def low(a: int | None, *rest: int) -> bool:
    """a < b"""
    x = -1 + a  # a + b
    return not a is not None and x < 10
'''
TEST = """
from where import low
def test_low():
    assert low(3) and not low(4)
"""
LOW = "def low(a):\n    x = a * 1\n    return a < 4\n"
OWN = Room("own", ("where.py",), ("test_where.py",))


def test_each_operator_word_and_number_is_changed_and_nothing_else() -> None:
    lines = []
    for start, end, instead in python_changes(SOURCE):
        changed = SOURCE[:start] + instead + SOURCE[end:]
        ast.parse(changed)
        line = SOURCE.count("\n", 0, start)
        lines.append(changed.splitlines()[line].strip())
    assert lines == [
        "x = -2 + a  # a + b",
        "x = -1 - a  # a + b",
        "return  a is not None and x < 10",
        "return not a is  None and x < 10",
        "return not a is not None or x < 10",
        "return not a is not None and x <= 10",
        "return not a is not None and x < 11",
    ]


SCRIPT = """
// a < b
const MOST = 1_000; // and 2
class Box {
  #count = 0;
  add(text) {
    if (!text || text.length > MOST && text !== 'a < 3') return `${1 + 2} <`;
    this.#count += text.replace(/[/*] + 4/g, "5").length ?? 6;
    this.tell();
    return text;
  }
}
"""


def test_of_a_script_too() -> None:
    lines = []
    for start, end, instead in javascript_changes(SCRIPT):
        changed = SCRIPT[:start] + instead + SCRIPT[end:]
        lines.append(changed.splitlines()[SCRIPT.count("\n", 0, start)].strip())
    condition = "if (!text || text.length > MOST && text !== 'a < 3') return `${1 + 2} <`;"
    count = 'this.#count += text.replace(/[/*] + 4/g, "5").length ?? 6;'
    assert lines == [
        condition.replace("||", "&&"),
        condition.replace("> MOST", ">= MOST"),
        condition.replace("MOST &&", "MOST ||"),
        condition.replace("!==", "==="),
        count.replace("+=", "-="),
        count.replace("??", "&&"),
        condition.replace("!text", "text"),
        "const MOST = 1001; // and 2",
        "#count = 1;",
        count.replace("6", "7"),
        ";",
        ";",
        ";",
    ]


@pytest.mark.parametrize("room", ROOMS, ids=lambda room: room.name)
def test_each_room_has_changes_and_tests(room: Room) -> None:
    for change in rooms.changes_of(room):
        if change.file.endswith(".py"):
            ast.parse(change.text)
        assert change.was != change.becomes or "+" not in change.becomes
    assert len(list(rooms.changes_of(room))) > 50
    for test in room.tests:
        assert (ROOT / test.split("::")[0]).exists(), test


@pytest.fixture
def own_room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A room of two files; a copy of it is made in place of the repository's."""
    (tmp_path / "where.py").write_text(LOW, encoding="utf-8")
    (tmp_path / "test_where.py").write_text(TEST, encoding="utf-8")

    def copied(to: Path) -> None:
        for name in ("where.py", "test_where.py"):
            (to / name).write_bytes((tmp_path / name).read_bytes())

    monkeypatch.setattr(rooms, "copied", copied)
    return tmp_path


def test_what_no_test_notices_is_unnoticed(own_room: Path) -> None:
    chosen = list(rooms.changes_of(OWN, own_room))
    assert [each.becomes for each in chosen] == [
        "x = a // 1", "x = a * 2", "return a <= 4", "return a < 5",
    ]  # fmt: skip
    found = rooms.survivors(OWN, chosen)
    assert [each.becomes for each in found] == ["x = a // 1", "x = a * 2"]


def test_a_room_whose_tests_fail_as_it_is_is_told(own_room: Path) -> None:
    (own_room / "where.py").write_text(LOW.replace("4", "5"), encoding="utf-8")
    with pytest.raises(ValueError, match="test_low"):
        rooms.survivors(OWN, list(rooms.changes_of(OWN, own_room)))


def test_what_does_not_end_is_noticed(own_room: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rooms, "LIMIT_S", 20)
    text = LOW.replace("    return", "    while x: pass\n    return")
    assert rooms.survivors(OWN, [Change("where.py", 2, "", "", text)]) == []


def test_an_unknown_room_is_told_which_there_are(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        rooms.main(["cellar"])
    assert "There are: link, store" in capsys.readouterr().err


def test_what_is_listed_as_equivalent_is_still_there() -> None:
    patterns = {pattern for room in ROOMS for pattern in room.files}
    texts = [path.read_text(encoding="utf-8") for each in patterns for path in ROOT.glob(each)]
    lines = [line.strip() for text in texts for line in text.splitlines()]
    both = {" ".join(pair) for pair in pairwise(lines)}
    assert {was for was, _ in EQUIVALENT} <= both | set(lines)


def test_what_is_unnoticed_stays_open_until_a_test_notices_it(
    own_room: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    changes = list(rooms.changes_of(OWN, own_room))
    monkeypatch.setattr(rooms, "ROOMS", (OWN,))
    monkeypatch.setattr(rooms, "BY_NAME", {"own": OWN})
    monkeypatch.setattr(rooms, "WRITTEN", tmp_path / "rooms.json")
    monkeypatch.setattr(rooms, "changes_of", lambda room: changes)
    monkeypatch.setattr(rooms, "regenerate", lambda: None)
    assert rooms.rows() == [("`own`", "", "not run yet", "", "", "", "", "")]
    assert rooms.main(["own", "--tries", "0", "--write"]) == 1
    (row,) = rooms.rows()
    assert (row[1:4], row[-1]) == ((4, 4, 2), 2)
    assert rooms.shares()["own"]["open"] == [
        ["where.py", "x = a * 1", "x = a * 2"],
        ["where.py", "x = a * 1", "x = a // 1"],
    ]
    assert rooms.main(["own", "--tries", "1", "--seed", "0", "--write"]) == 0
    assert (rooms.rows()[0][2:4], rooms.rows()[0][-1]) == ((1, 0), 2), "what was not tried is open"
    test = TEST + "    assert 2 not in low.__code__.co_consts\n"
    (own_room / "test_where.py").write_text(test, encoding="utf-8")
    assert rooms.main(["own", "--again"]) == 1
    assert (rooms.rows()[0][2:4], rooms.rows()[0][-1]) == ((1, 0), 1)


def test_of_a_file_only_the_tests_about_it_run() -> None:
    room = Room("own", ("*.cpp",), ("tests/a.py", "tests/b.py", "tests/c.py"), {"x.cpp": "c b"})
    assert room.tests_of("src/x.cpp") == ("tests/c.py", "tests/b.py")
    assert room.tests_of("src/y.cpp") == room.tests


@pytest.mark.parametrize("room", ROOMS, ids=lambda room: room.name)
def test_each_word_about_a_file_means_a_test(room: Room) -> None:
    names = {path.name for pattern in room.files for path in ROOT.glob(pattern)}
    assert set(room.about) <= names
    for words in room.about.values():
        for word in words.split():
            assert any(word in test for test in room.tests), word
