"""Who drives a robot that is reached over several transports, and when another one does."""

from __future__ import annotations

import pytest

from tests.firmware.test_esp32_transports import AWAY, Ends, booted, ended, uploaded
from tests.firmware.test_esp32_wifi import owned, remote
from tests.firmware.test_host_firmware import happened
from tests.machines.esp32 import Esp32Robot
from tests.support.esp32_radio import Bytes, LowEnergy, session, talk
from tests.support.images import image_of
from tests.support.owners import Keys
from tiniscript.link.messages import AUTHORITY_MS
from tiniscript.link.session import Session

SHORT = "SI|F(0.1, 30)"


def pair(is_owned: bool) -> tuple[Esp32Robot, Session, Session]:
    """Return a robot and two who may drive it."""
    if not is_owned:
        robot = booted()
        return robot, session(1, robot), session(2, robot)
    robot, first = owned(keys := Keys())
    return robot, first, remote(robot, keys, 2)


@pytest.mark.parametrize("is_owned", [False, True])
def test_an_open_page_that_does_nothing_gives_way(is_owned: bool) -> None:
    robot, page, other = pair(is_owned)
    ends: Ends = [(None, page), (LowEnergy(robot), other)]
    assert uploaded(robot, ends, page, SHORT) == "OK"
    talk(robot, ends, AUTHORITY_MS - 300)
    assert uploaded(robot, ends, other) == "OTHER_DRIVER", "it may be about to send the next one"
    talk(robot, ends, 60_000)
    assert uploaded(robot, ends, other) == "OK"
    assert happened(robot)[-1] == "MOTORS 80 80"
    assert uploaded(robot, ends, page, SHORT) == "OTHER_DRIVER"
    other.stop(robot.now_ms)
    talk(robot, ends, AUTHORITY_MS + 300)
    assert uploaded(robot, ends, page, SHORT) == "OK", "and so does the other one"


@pytest.mark.parametrize("is_owned", [False, True])
@pytest.mark.parametrize("is_detached", [False, True])
def test_whose_program_runs_keeps_the_wheel_while_he_is_heard(
    is_owned: bool, is_detached: bool
) -> None:
    robot, page, other = pair(is_owned)
    ends: Ends = [(None, page), (LowEnergy(robot), other)]
    upload = page.upload(image_of(AWAY), saves=False, is_detached=is_detached)
    assert ended(robot, ends, upload) == "OK"
    for _ in range(5):
        talk(robot, ends, 5000)
        assert uploaded(robot, ends, other) == "OTHER_DRIVER"
    assert happened(robot)[-1] == "MOTORS 80 80"
    page.stop(robot.now_ms)
    talk(robot, ends, AUTHORITY_MS + 300)
    assert uploaded(robot, ends, other) == "OK"


def test_a_page_gives_way_to_nobody_without_a_key() -> None:
    robot, page, _ = pair(is_owned=True)
    stranger, typed = session(5, robot), Bytes()
    end = LowEnergy(robot)
    assert uploaded(robot, [(None, page)], page, SHORT) == "OK"
    talk(robot, [(None, page)], 5000)
    assert uploaded(robot, [(None, page), (end, stranger)], stranger) == "NOT_OWNER"
    end.leave()
    typed.said = b"SI|F(60, 80)\n"
    talk(robot, [(None, page), (LowEnergy(robot), typed)], 1500)
    assert "MOTORS 80 80" not in happened(robot)


@pytest.mark.parametrize("is_owned", [False, True])
def test_an_upload_that_goes_on_is_not_overtaken(is_owned: bool) -> None:
    """However long it takes: each of its parts changes something."""
    robot, page, other = pair(is_owned)
    far = LowEnergy(robot)
    ends: Ends = [(None, page), (far, other)]
    long = page.upload(image_of("SB|" + ";".join("F(1, 80)" for _ in range(1500))), saves=False)
    answers = set()
    while long.outcome is None:
        for _ in range(20):  # a slow line
            if long.outcome is None:
                talk(robot, [(far, other)], 40)
                talk(robot, ends, 1)
        answers.add(uploaded(robot, [(far, other)], other, SHORT))
    assert long.outcome.status == 0
    assert answers == {"OTHER_DRIVER"}
