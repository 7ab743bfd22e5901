"""Devices at the other end of a port are recognized and not disturbed."""

from __future__ import annotations

import pytest

from tests.support import foreign_boards as boards
from tests.support.simulated_ends import (
    KIT,
    QUESTIONS,
    BabblingEnd,
    Board,
    Echo,
    Firmware,
    Sketch,
    UnpoweredEnd,
    reset,
    state,
)
from tests.support.simulated_modules import Bt05, Hc05, Hc06, Hm10
from tests.support.simulated_wire import OtherEnd, SimulatedWire
from tiniscript.doctor.examination import Expectations, RobotAnswers, examine
from tiniscript.doctor.findings import Finding
from tiniscript.doctor.line import BAUDS, PortFacts, diagnose_line
from tiniscript.doctor.robot import WireRobot, hello_values
from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.messages import (
    LINK_FAULTS,
    OWNED,
    OWNERS,
    SAVED_STATES,
    STATUSES,
    STOP_ZEROS,
    WIFI_RESTS,
    YOURS,
)
from tiniscript.link.payloads import TrimReply
from tiniscript.link.wire import QUIET_MS
from tiniscript.robots import load

# Devices that are silent after their start.
SILENT_BOARDS = (boards.Esp32Board, boards.SilentPython, boards.DownloadBoard)
BOOTLOADER_BAUDS = (
    115200,
    57600,
)  # the speeds of bootloaders: there a board is heard when it starts
NAMES = {load(name).kit.fingerprint: name for name in ("tinibot", "liner", "grabber")}
SAVED_NUMBER_BY_NAME = {name: number for number, (name, _) in enumerate(SAVED_STATES)}
MEGA_GREETING = b"\x1b\x01\0\x01\x0e\x01\x14"  # the greeting of its bootloader
STALL_NUMBER = next(number for number, name, _ in LINK_FAULTS if name == "STALL")


def findings_on(
    end: OtherEnd,
    is_radio: bool = False,
    kit: int | None = None,
    baud: int = 9600,
    its_key: int | None = None,
) -> list[Finding]:
    """Return the findings; `its_key` is the id of the robot whose key the computer has."""
    wire = SimulatedWire(end, baud)
    expected = Expectations(kit, "tinibot", NAMES.get, lambda robot: robot == its_key)
    findings = diagnose_line(wire, PortFacts(baud, is_radio, 4711), expected)
    if is_radio:
        assert {speed for speed, _ in wire.sent_pieces} == {baud}
        assert wire.restarts == 0
    return findings


class WireEcho(Echo):
    """TX wired to RX: it returns everything, at any speed."""

    def __init__(self) -> None:
        super().__init__()
        self.is_bare = True


def watch_line(end: OtherEnd, watch_ms: int) -> dict[str, Finding]:
    """Return the findings after a robot is watched for so long."""
    robot = WireRobot(SimulatedWire(end), 4711, KIT)
    reply = robot.hello()
    assert reply is not None
    expected = Expectations(KIT, "tinibot", NAMES.get)
    return {finding.cause: finding for finding in examine(robot, reply, expected, watch_ms)}


def only_cause(end: OtherEnd, **options: object) -> tuple[str, bool]:
    (finding,) = findings_on(end, **options)  # type: ignore[arg-type]
    return finding.cause, finding.is_sure


def causes(end: OtherEnd, **options: object) -> dict[str, Finding]:
    return {finding.cause: finding for finding in findings_on(end, **options)}  # type: ignore[arg-type]


# -- a robot ------------------------------------------------------------------------------------


@pytest.mark.parametrize("is_radio", [False, True])
def test_a_healthy_robot_gets_only_harmless_requests(is_radio: bool) -> None:
    """No frame acts, and there are never four zeros in a row: these would stop it."""
    (finding,) = findings_on(Firmware(), is_radio=is_radio, kit=KIT)
    assert (finding.cause, finding.is_sure) == ("fine", True)
    assert (finding.values["name"], finding.values["id"]) == ("ANA", "12347f3a")
    end = Firmware(state=state("RUNNING"))
    end.deaf = 3
    findings_on(end, is_radio=is_radio, kit=KIT)
    assert set(end.requests) == QUESTIONS
    assert b"\0" * STOP_ZEROS not in b"".join(end.received)


@pytest.mark.parametrize(
    ("values", "cause"),
    [
        ({"isa_major": 1}, "firmware_older"),
        ({"isa_major": 3}, "firmware_newer"),
        ({"minor": 9}, "fine"),
        ({"isa_minor": 9}, "fine"),
        ({"kit": next(kit for kit, name in NAMES.items() if name == "liner")}, "wrong_kit"),
        ({"reset": reset("BROWN_OUT")}, "brown_out"),
        ({"reset": reset("WATCHDOG")}, "hung"),
        ({"reset": 5}, "fine"),
        ({"reset": 99}, "fine"),
        ({"fault": STALL_NUMBER}, "hung"),
        ({"features": WIFI_RESTS}, "wifi_rests"),
        ({"saved": SAVED_NUMBER_BY_NAME["LOW_SUPPLY"]}, "low_supply"),
    ],
)
def test_faults_that_a_robot_reports_are_found(values: dict[str, int], cause: str) -> None:
    assert only_cause(Firmware(**values), kit=KIT) == (cause, True)


@pytest.mark.parametrize(
    ("values", "cause"),
    [
        ({"state": state("STOPPED")}, "stopped"),
        ({"state": state("FAULTED")}, "stopped"),
        ({"saved": SAVED_NUMBER_BY_NAME["SAVING"]}, "not_saved_yet"),
        ({"saved": SAVED_NUMBER_BY_NAME["OTHER_VERSION"]}, "other_program"),
        ({"features": OWNERS | OWNED}, "of_another_owner"),
    ],
)
def test_notable_facts_are_not_faults(values: dict[str, int], cause: str) -> None:
    findings = findings_on(Firmware(**values), kit=KIT)
    assert [(finding.cause, finding.is_sure) for finding in findings] == [
        (cause, True),
        ("fine", True),
    ]
    assert not any(finding.is_wrong for finding in findings)


def test_a_robot_whose_key_this_computer_has_is_fine() -> None:
    for features, key in ((OWNERS, 5), (OWNERS | OWNED, 0x12347F3A), (OWNERS | OWNED | YOURS, 5)):
        assert only_cause(Firmware(features=features), kit=KIT, its_key=key) == ("fine", True)


@pytest.mark.parametrize(("features", "expected"), [(0, "-"), (OWNERS | OWNED, "OWNERS, OWNED")])
def test_a_report_lists_the_features_of_a_robot(features: int, expected: str) -> None:
    robot = WireRobot(SimulatedWire(Firmware(features=features)), 4711, KIT)
    reply, noted = robot.hello(), dict[str, str]()
    assert reply is not None
    list(examine(robot, reply, Expectations(KIT, "tinibot", NAMES.get, on_facts=noted.update), 0))
    assert noted["features"] == expected


def test_an_unknown_kit_is_reported() -> None:
    assert only_cause(Firmware(kit=0x1234)) == ("unknown_kit", True)
    assert only_cause(Firmware(kit=0x1234), kit=0x1234) == ("fine", True)


@pytest.mark.parametrize(
    ("refuses", "cause", "is_sure"),
    [
        (("OTHER_LINK", 0), "firmware_older", True),
        (("OTHER_LINK", 2), "firmware_newer", True),
        (("OTHER_LINK", 99), "firmware_newer", True),
        (("BAD_LENGTH", 0), "firmware_older", False),  # probably
    ],
)
def test_a_refused_hello_is_reported(refuses: tuple[str, int], cause: str, is_sure: bool) -> None:
    end = Firmware()
    end.hello_refusal = (STATUSES[refuses[0]], refuses[1])
    assert only_cause(end) == (cause, is_sure)


def test_spontaneous_and_watchdog_restarts_are_reported() -> None:
    end = Firmware()
    end.restarts_ms, end.resets = 700, "POWER"
    finding = causes(end)["restarts"]
    assert finding.is_sure and int(finding.values["count"]) >= 2
    assert finding.values["reset"] == "POWER"
    end = Firmware()
    end.restarts_ms, end.resets = 700, "WATCHDOG"
    assert "hung" in causes(end)


@pytest.mark.parametrize("restarts_ms", [1500, 4000, 9000])
def test_each_restart_counts_once(restarts_ms: int) -> None:
    end = Firmware()
    robot = WireRobot(SimulatedWire(end), 4711, KIT)
    end.restarts_ms, end.resets = restarts_ms, "POWER"
    hello = robot.hello()
    first_values = hello_values(hello)
    assert hello is not None and first_values is not None
    (finding,) = examine(robot, hello, Expectations(KIT, "tinibot", NAMES.get), 20_000)
    last_nonce = end.hello["nonce"]
    assert isinstance(last_nonce, int) and finding.values["count"] == str(
        last_nonce - first_values.nonce
    )


@pytest.mark.parametrize(("resets", "is_sure"), [("BROWN_OUT", True), ("POWER", False)])
def test_restarts_at_motor_starts_are_reported(resets: str, is_sure: bool) -> None:
    """The finding is sure if its chip reports the voltage, and probable otherwise."""

    class Driver(Firmware):
        def answer(self, data: bytes) -> bytes:
            if self.now_ms == 9000:  # the button is pressed
                self.hello["state"] = state("RUNNING")
            return super().answer(data)

    drivers = [Driver(), Driver()]
    for end in drivers:
        end.restarts_ms, end.resets = 10_000, resets
    assert watch_line(drivers[0], 12_000)["motors_restart"].is_sure == is_sure
    assert "motors_restart" not in causes(drivers[1])  # the watch was too short for that


@pytest.mark.parametrize("is_radio", [False, True])
def test_a_lossy_radio_is_reported(is_radio: bool) -> None:
    end = Firmware()
    end.deaf, end.hears_badly = 5, True
    finding = causes(end, is_radio=is_radio)["lossy"]
    assert finding.is_sure and int(finding.values["missed"]) >= 3
    assert int(finding.values["damaged"]) >= 3


@pytest.mark.parametrize("epoch", [0, 1, 7, 255])
def test_a_robot_reports_everything_whatever_was_stopped_before(epoch: int) -> None:
    end = Firmware()
    end.epoch, end.trim = epoch, {"wheels": 5, "balance": -2, "least": 30, "pace": b""}
    robot_answers: list[RobotAnswers] = []
    robot = WireRobot(SimulatedWire(end), 4711, KIT)
    reply = robot.hello()
    assert reply is not None
    examine(robot, reply, Expectations(KIT, "tinibot", NAMES.get, on_answers=robot_answers.append))
    assert robot_answers[0].trim == TrimReply(**end.trim)  # type: ignore[arg-type]


@pytest.mark.parametrize(("damaged_count", "is_lossy"), [(1, False), (2, True)])
def test_a_robot_that_hears_badly_but_answers_is_reported(
    damaged_count: int, is_lossy: bool
) -> None:
    class Noisy(Firmware):
        def answer(self, data: bytes) -> bytes:
            if len(self.requests) == 10:  # in the middle of the PINGs
                self.counts["framing"] = damaged_count
            return super().answer(data)

    assert ("lossy" in causes(Noisy())) == is_lossy


@pytest.mark.parametrize("count_before", [0, 100, 240, 253, 255])
@pytest.mark.parametrize("count", ["damaged", "framing", "overrun"])
def test_damage_is_counted_across_a_counter_overflow(count: str, count_before: int) -> None:
    """Its 256 values follow each other in a circle."""

    class Noisy(Firmware):
        def answer(self, data: bytes) -> bytes:
            if len(self.requests) == 10:  # in the middle of the PINGs
                self.counts[count] = (count_before + 4) % 256
            return super().answer(data)

    assert causes(Noisy(**{count: count_before}))["lossy"].values["damaged"] == "4"


def test_earlier_damage_on_a_line_counts() -> None:
    """Then it is probably bad; one lost frame among twenty proves nothing."""
    assert "lossy" not in causes(Firmware(overrun=19))
    assert not causes(Firmware(overrun=20))["lossy"].is_sure
    assert causes(Firmware(damaged=255, framing=0))["lossy"].values["missed"] == "0"
    end = Firmware()
    end.deaf = 17
    assert "lossy" not in causes(end)


@pytest.mark.parametrize("requests", [1, 5, 22])
def test_a_robot_that_falls_silent_is_reported(requests: int) -> None:
    end = Firmware()
    end.dies_after = requests
    assert only_cause(end) == ("falls_silent", False)


# -- no robot -----------------------------------------------------------------------------------


@pytest.mark.parametrize("baud", [19200, 38400, 57600, 115200])
def test_a_robot_at_another_baud_rate_is_found(baud: int) -> None:
    (finding,) = findings_on(Firmware(baud))
    assert (finding.cause, finding.is_sure) == ("wrong_baud", True)
    assert finding.values["baud"] == str(baud)


def test_a_robot_at_another_baud_rate_with_another_fault_is_found() -> None:
    end = Firmware(115200, saved=SAVED_NUMBER_BY_NAME["LOW_SUPPLY"])
    assert [finding.cause for finding in findings_on(end)] == ["wrong_baud", "low_supply"]


@pytest.mark.parametrize(
    ("end", "cause", "is_sure"),
    [
        (WireEcho(), "echo", True),
        (Sketch(), "other_sketch", True),
        (Sketch(115200), "other_sketch", True),
        (Hc05(), "module_set_up", True),
        (Hc06(), "module_alone", True),
        (Hm10(57600), "module_alone", True),
        (Bt05(), "module_alone", True),
        (Board(), "other_sketch", False),
        (Board(57600), "other_sketch", False),
        (Board(open_ms=None), "bootloader_only", True),
        (Board(57600, open_ms=None), "bootloader_only", True),
        (Board(115200, MEGA_GREETING, b"\x1b\x01\0\x0b\x0e\x01\0\x08AVRISP_2!"), "other_sketch",
            False),
        (BabblingEnd(), "garbled", False),
        (UnpoweredEnd(), "silent", False),
    ],
)  # fmt: skip
def test_causes_on_a_cable_are_found(end: OtherEnd, cause: str, is_sure: bool) -> None:
    assert only_cause(end) == (cause, is_sure)


@pytest.mark.parametrize("speed", BAUDS)
def test_bytes_heard_at_only_one_baud_rate_are_reported(speed: int) -> None:
    """This holds for each speed: at the others, the line is silent."""

    class Deaf(SimulatedWire):
        def receive(self, wait_ms: int, quiet_ms: int = QUIET_MS) -> bytes:
            heard_bytes = super().receive(wait_ms, quiet_ms)
            return heard_bytes if self.baud == speed else b""

    wire = Deaf(BabblingEnd(speed), BAUDS[0])
    expected = Expectations(None, "tinibot", NAMES.get)
    (finding,) = diagnose_line(wire, PortFacts(BAUDS[0], False, 4711), expected)
    assert finding.cause == "garbled"


@pytest.mark.parametrize(
    ("end", "cause", "is_sure"),
    [
        (Echo(), "echo", False),  # radios have one speed, so this may be a sketch
        (Sketch(), "other_sketch", True),
        (BabblingEnd(), "module_baud", False),  # the module's wire garbles the radio's data
        (UnpoweredEnd(), "crossed", False),
    ],
)
def test_causes_by_radio_are_found(end: OtherEnd, cause: str, is_sure: bool) -> None:
    assert only_cause(end, is_radio=True) == (cause, is_sure)


# -- boards that are not ours -------------------------------------------------------------------

KINDS = [
    (boards.FirmataBoard, "firmata", "StandardFirmata.ino 2.5"),
    (boards.MbotBoard, "mbot", "06.01.009"),
    (boards.SnekBoard, "snek", ""),
    (boards.PythonBoard, "micropython", ""),
    (boards.AtBoard, "at_firmware", "AT version:2.2.0.0"),
    (boards.Esp32Board, "esp32", "rst:0x1 (POWERON_RESET)"),
    (boards.SilentPython, "micropython", "MicroPython v1.20.0"),
    (boards.BrownoutBoard, "esp32_brownout", "Brownout detector was triggered"),
    (boards.DownloadBoard, "esp32_download", "DOWNLOAD(USB/UART0/1)"),
    (boards.EmptyBoard, "esp32_empty", "invalid header"),
    (boards.EchoSketch, "echo_sketch", ""),
    (boards.LineEchoSketch, "echo_sketch", "You said:"),
]


@pytest.mark.parametrize("its_baud", [9600, 19200, 38400, 57600, 115200])
@pytest.mark.parametrize(("kind", "cause", "sentence"), KINDS)
def test_a_foreign_board_on_a_cable_is_recognized(
    kind: type[boards.Board], cause: str, sentence: str, its_baud: int
) -> None:
    """This holds for any speed of the board, and any speed of a robot here."""
    for baud in (9600, 115200):
        (finding,) = findings_on(kind(its_baud), baud=baud)
        if kind in SILENT_BOARDS and its_baud not in (baud, *BOOTLOADER_BAUDS):
            assert finding.cause == "garbled", baud
            continue
        assert (finding.cause, finding.is_sure) == (cause, True), baud
        assert sentence in finding.values["said"], baud


@pytest.mark.parametrize(("kind", "cause", "sentence"), KINDS)
def test_a_foreign_board_by_radio_is_recognized(
    kind: type[boards.Board], cause: str, sentence: str
) -> None:
    """The board was not restarted, so its start message is not received."""
    end = kind(9600)
    end.now_ms = end._elapsed_ms = 10_000
    (finding,) = findings_on(end, is_radio=True)
    unheard = {
        boards.EchoSketch: "echo", boards.AtBoard: "echo", boards.Esp32Board: "crossed",
        boards.SilentPython: "crossed", boards.DownloadBoard: "crossed",
    }  # fmt: skip
    assert finding.cause == unheard.get(kind, cause)
    assert finding.is_sure == (kind not in unheard)


def test_a_robot_that_sends_but_hears_nothing_is_reported() -> None:
    """Its frames and lines are never those of a foreign board."""

    class OneWay(UnpoweredEnd):
        sent_bytes = b"// OK\r\n"

        def answer(self, data: bytes) -> bytes:
            return self.sent_bytes if self.now_ms % 300 == 0 else b""

    end = OneWay()
    for data in (end.sent_bytes, b"\0" + encode_frame(Frame(33, 0, 7, b"\x01\xff\x55\r\n>>> "))):
        end.sent_bytes = data
        for is_radio in (False, True):
            assert only_cause(end, is_radio=is_radio) == ("one_way", False)


@pytest.mark.parametrize("line", [
    b"Distancia: 34 cm \xc2\xa1m\xc3\xa1s!\r\n", b"\x1b[0;32mI (71) boot: x\x1b[0m\r\n",
    b"0\r\n", b"I received: 65\r\n", b"\xff\x00 Distance: 34 cm\r\n", b"a,b;c|",
])  # fmt: skip
def test_readable_text_means_the_right_baud_rate(line: bytes) -> None:
    for baud in (9600, 57600):
        end = Sketch(baud)
        end.line = line
        (finding,) = findings_on(end)
        assert finding.cause == "other_sketch", finding
    (finding,) = findings_on(end, baud=57600, is_radio=True)
    assert finding.cause == "other_sketch", finding


def test_text_of_a_probably_known_board_is_attributed_to_it() -> None:
    end = Sketch()
    end.line = boards.MBOT_START
    assert only_cause(end) == ("mbot", False)


def test_output_of_a_sketch_is_reported_as_shortened_text() -> None:
    end = Sketch()
    end.line = b"x" * 300 + b"\r\n"
    (finding,) = findings_on(end)
    assert finding.values["said"] == "x" * 60


def test_a_lost_wire_raises_an_os_error() -> None:
    wire = SimulatedWire(Firmware())
    wire.close()
    with pytest.raises(OSError):
        diagnose_line(wire, PortFacts(9600, False, 1), Expectations(None, "", NAMES.get))
