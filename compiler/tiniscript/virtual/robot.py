"""A robot in its world: its firmware, its body and its sensors.

Time and bytes are arguments: knows no clock and no port. The same settings, bytes and times give
the same run.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from random import Random
from typing import NamedTuple

from tiniscript.base.trace import Event, TracedRobot
from tiniscript.link.names import fault_name, saved_name
from tiniscript.robots.driver import AT_STOP, HOLD_CHOICE
from tiniscript.robots.drivers import discs_of
from tiniscript.robots.kinematics import Pose
from tiniscript.robots.kit_words import kit_words
from tiniscript.robots.ports import ESP32S
from tiniscript.robots.profile import Robot, language_number
from tiniscript.virtual.bout import driving_in
from tiniscript.virtual.module import (
    NO_OFFSET,
    PATH,
    PATH_DISCS,
    PATH_ESP32,
    PATH_MEGA,
    POWER_ON,
    RESET_BUTTON,
    Firmware,
    FirmwareSettings,
)
from tiniscript.virtual.sensing import Sensing
from tiniscript.virtual.wheels import Roughness, Wheels
from tiniscript.virtual.world import World, WorldRefused

__all__ = ("POWER_ON", "RESET_BUTTON", "Settings", "VirtualRobot")

LEVELS_PER_PERCENT = 2.55  # PWM levels per percent of power
BITS_PER_BYTE = 10  # bits per byte on the line
MAX_EVENTS = 100_000  # most events that are kept until they are fetched


class Settings(NamedTuple):
    """Settings that differ from the profile.

    `seed` starts the random numbers. `noise` is a fraction: 0.05 is 5 %. `motors` are percent of
    each motor's nominal speed. `baud` of 0: a byte takes no time; None: as in the profile.
    `eeprom_us` is the time to save one byte; None: as the chip takes.
    `given_readings` are readings of single sensors. `roughness` is what discs and their wheels do
    to a robot that has them.
    """

    seed: int = 1
    noise: float = 0.0
    motors: tuple[float, float] = (100.0, 100.0)
    baud: int | None = None
    eeprom_us: int | None = None
    given_readings: Mapping[int, Sequence[int]] = {}
    roughness: Roughness = Roughness()


PLAIN_SETTINGS = Settings()
EEPROM_US = 3400  # time for an AVR to write a byte of EEPROM
MODULE_BY_BOARD = {
    "mega": PATH_MEGA,
    **dict.fromkeys(ESP32S, PATH_ESP32),
}  # other chips than an Uno's
FLASH_US = 10  # an ESP32's NVS writes a whole program at once


class VirtualRobot:
    """A robot that is switched on, at the start of its world.

    Raises WorldRefused if it does not fit there, and NoWebAssembly.
    """

    def __init__(
        self,
        profile: Robot,
        world: World,
        settings: Settings = PLAIN_SETTINGS,
        memory: bytes | None = None,
    ) -> None:
        self.profile = profile
        self.world = world
        self.settings = settings
        self.now_ms = 0
        self.random_source = Random(settings.seed)
        self.driving = driving_in(profile.body, world)
        discs = profile.board.discs
        self.wheels: Wheels | None = None
        if discs:
            self.wheels = Wheels(
                profile.body,
                discs,
                discs_of(discs).has_two_channels,
                settings.roughness,
                settings.seed,
                self.driving.set_motors,
            )
        if self.driving.is_blocked():
            start_text = f"x_cm = {world.start.x_cm:g}, y_cm = {world.start.y_cm:g}"
            raise WorldRefused(("start_blocked", {"path": "start", "place": start_text}))
        self.sensing = Sensing(
            profile,
            world,
            settings.noise,
            self.random_source,
            settings.given_readings,
            self.driving.other_outlines,
        )
        self.is_running = False
        self.started_ms: int | None = None  # start of its first program
        self.ended_ms: int | None = None  # end of its newest program
        self.is_at_rest = False
        self._event_count_at_rest = 0  # number of events from before the robot was at rest
        self.is_lit = False  # the light is on: the button would start a program
        self.fault = ""  # the fault that has ended the last program
        self.actuators: dict[int, int] = {}  # the current value of each
        self._traced_robot = TracedRobot(profile.kit, self._sensor_reading)
        self._end_event = ""  # how the program ended, as far as known
        self._remote_reading = 0  # state of the remote control that the current reading uses
        self._power_on_ms = 0  # time of the last power-on
        self._firmware = self._power_up(POWER_ON, memory)

    # -- what happens to it -----------------------------------------------------------------------

    def step(self, now_ms: int, data: bytes = b"") -> bytes:
        """Go on up to a time; bytes arrive from now on. Return what the robot sends meanwhile.

        Time stops where the program is held.
        """
        sent_bytes = self._firmware.run((now_ms - self._power_on_ms) * 1000, data)
        self.now_ms = now_ms
        if self._firmware.is_watched:
            self.now_ms = min(now_ms, self._power_on_ms + self._firmware.now_us // 1000)
        self._settle()
        if self.is_at_rest:
            del self._traced_robot.events[self._event_count_at_rest :]
        del self._traced_robot.events[:-MAX_EVENTS]
        return sent_bytes

    def press(self) -> None:
        """The start button goes down."""
        self._firmware.press()
        self._settle()

    def let_go(self) -> None:
        """The start button comes up."""
        self._firmware.let_go()
        self._settle()

    def power_cycle(self, reset: int = POWER_ON) -> None:
        """Switch off and on: pose and EEPROM are kept."""
        memory = self._firmware.memory()
        self.switch_off()
        self._firmware.close()
        self._firmware = self._power_up(reset, memory)

    def rest(self) -> None:
        """End its time: it no longer moves, whatever its firmware does."""
        self._halt("STOP")
        self.driving.rest()
        self.is_at_rest = True
        self._event_count_at_rest = len(self._traced_robot.events)

    def switch_off(self) -> None:
        """Switch it off. Its clock must not advance until it is switched on again."""
        self._halt("OFF")
        self.actuators.clear()

    def _power_up(self, reset: int, memory: bytes | None) -> Firmware:
        self._power_on_ms = self.now_ms
        kit, board = self.profile.kit, self.profile.board
        baud = board.baud if self.settings.baud is None else self.settings.baud
        is_esp32 = board.chip in ESP32S
        eeprom_us = self.settings.eeprom_us
        if eeprom_us is None:
            eeprom_us = FLASH_US if is_esp32 else EEPROM_US
        discs = board.discs
        edge_cm, edge_degrees = (0, 0)
        if discs:
            wheel_base_cm = self.profile.body.wheel_base_cm
            edge_cm, edge_degrees = discs_of(discs).edges(discs, wheel_base_cm)
        return Firmware(
            self,
            FirmwareSettings(
                kit_words=kit_words(kit),
                hashes=kit.hashes,
                kit=kit.fingerprint,
                sensors=len(kit.sensors),
                actuators=len(kit.actuators),
                reset=reset,
                seed=self.random_source.getrandbits(32),
                max_run_ms=board.max_run_seconds * 1000,
                speed=kit.speed,
                turn=kit.turn,
                edge_cm=edge_cm,
                edge_degrees=edge_degrees,
                has_two_channels=discs is not None and discs_of(discs).has_two_channels,
                byte_us=round(BITS_PER_BYTE * 1_000_000 / baud) if baud else 0,
                eeprom_us=eeprom_us,
                language=language_number(board.language),
            ),
            memory,
            MODULE_BY_BOARD.get(board.chip, PATH_DISCS if board.discs else PATH),
        )

    # -- what it does -----------------------------------------------------------------------------

    def take_events(self) -> list[Event]:
        """Return the actions since the last call.

        These are a run's events, START, STOP, RELEASE of an actuator, and OFF.
        """
        events, self._traced_robot.events, self._event_count_at_rest = (
            self._traced_robot.events,
            [],
            0,
        )
        return events

    @property
    def pose(self) -> Pose:
        if self.wheels:
            self.wheels.go_on(self.now_ms)
        return self.driving.pose_at(self.now_ms)

    @property
    def unread_bytes(self) -> int:
        """Return the number of received bytes that the firmware has not read."""
        return self._firmware.unread_bytes

    @property
    def memory(self) -> bytes:
        """Return the content of its EEPROM."""
        return self._firmware.memory()

    def motors(self, now_ms: int, left: int, right: int) -> None:
        """Set what the motors get, -255 to 255: the trim has been looked at."""
        powers = (left / LEVELS_PER_PERCENT, right / LEVELS_PER_PERCENT)
        self._set_motors(now_ms, *powers)
        self._traced_robot.motors(*(round(power) for power in powers))

    def steer(self, now_ms: int, left: int, right: int) -> None:
        """Set what the motors get while the firmware measures a move: the trace has its begin."""
        self._set_motors(now_ms, left / LEVELS_PER_PERCENT, right / LEVELS_PER_PERCENT)

    def edges(self, now_ms: int) -> int:
        """Return the number of edges passed by both discs."""
        self._advance_to(now_ms)
        return self.wheels.edges(self.now_ms) if self.wheels else 0

    def read(self, now_ms: int, sensor: int, remote: int) -> int:
        """Return a reading; `remote` is what the firmware has heard from a remote control."""
        self._advance_to(now_ms)
        self._remote_reading = remote
        return self._traced_robot.read(sensor) or 0

    def beep(self, now_ms: int, hertz: int, duration_ms: int) -> None:
        self._advance_to(now_ms)
        self._traced_robot.beep(hertz, duration_ms)

    def show(self, now_ms: int, value: int, is_yes_no: int, offset: int) -> None:
        self._advance_to(now_ms)
        self._traced_robot.show(value, bool(is_yes_no))
        self._traced_robot.events[-1] = self._traced_robot.events[-1]._replace(offset=offset)

    def set(self, now_ms: int, actuator: int, value: int) -> None:
        self._advance_to(now_ms)
        self._traced_robot.set(actuator, value)
        self.actuators[actuator] = self._traced_robot.events[-1].values[1]
        self.sensing.turn(actuator, self.actuators[actuator])

    def actuators_off(self, now_ms: int) -> None:
        """Turn actuators off; a servo gets no more pulses, unless its profile holds it."""
        self._advance_to(now_ms)
        board, kit = self.profile.board, self.profile.kit
        for number, value in sorted(self.actuators.items()):
            if kit.actuators[number].is_yes_no:
                if value:
                    self._traced_robot.set(number, 0)
                    self.actuators[number] = 0
            elif board.actuators[number].settings.get(AT_STOP) != HOLD_CHOICE:
                name = kit.actuators[number].name
                self._traced_robot.record("RELEASE", (number,), f"RELEASE {name}")
                del self.actuators[number]

    def stop(self, now_ms: int) -> None:
        self._set_motors(now_ms, 0, 0)
        if self.is_running:
            self.is_running = False
            self.ended_ms = self.now_ms
            self._end_event = "STOP"

    def release(self, now_ms: int) -> None:
        self._settle()  # two programs may follow each other in one step
        self._advance_to(now_ms)
        if self.is_at_rest:
            return
        self.is_running = True
        if self.started_ms is None:
            self.started_ms = self.now_ms
        self.ended_ms = None
        self.fault = ""
        self._record("START")

    def light(self, now_ms: int, is_on: int) -> None:
        self.is_lit = bool(is_on)

    def on_finish(self, now_ms: int) -> None:
        self._end_event = "DONE"

    def on_fault(self, now_ms: int) -> None:
        self._end_event = "FAULT"

    # ---------------------------------------------------------------------------------------------

    def _advance_to(self, now_ms: int) -> None:
        self.now_ms = self._power_on_ms + now_ms
        self._traced_robot.now_ms = self.now_ms

    def _set_motors(self, now_ms: int, left: float, right: float) -> None:
        self._advance_to(now_ms)
        if self.is_at_rest:
            return
        speeds = []
        for power, percent in zip((left, right), self.settings.motors, strict=True):
            deviation = (
                self.random_source.gauss(0.0, self.settings.noise) if self.settings.noise else 0.0
            )
            speeds.append(power * percent / 100 * (1 + deviation))
        if self.wheels:
            self.wheels.set(self.now_ms, *speeds)
        else:
            self.driving.set_motors(self.now_ms, *speeds)

    def _halt(self, event_name: str) -> None:
        """Its motors have no power from now on, and a program that runs has ended, as is
        `event_name`. Its time need not advance."""
        if self.wheels:
            self.wheels.go_on(self.now_ms)
            self.wheels.brake()
        self.driving.set_motors(self.now_ms, 0, 0)
        self._traced_robot.now_ms = self.now_ms
        if self.is_running:
            self._record(event_name)
            self.ended_ms = self.now_ms
        self.is_running = False

    def _sensor_reading(self, sensor: int) -> int:
        if self.wheels:
            self.wheels.go_on(self.now_ms)
        return self.sensing.read(sensor, self.driving.advance_to(self.now_ms), self._remote_reading)

    def _settle(self) -> None:
        """Report how a program has ended: only now is it known whether it ended by itself."""
        if not self._end_event:
            return
        event_text, self._end_event = self._end_event, ""
        if event_text == "FAULT":
            number = self._firmware.call("fault")
            self.fault = fault_name(number)
            event_text = f"FAULT {self.fault}"
        self._record(event_text)

    def _record(self, text: str) -> None:
        self._traced_robot.record(text.partition(" ")[0], (), text)

    @property
    def offset(self) -> int | None:
        """Return the start of the current instruction, or None if no program runs."""
        code_offset = self._firmware.call("at") % (1 << 32)
        return None if code_offset == NO_OFFSET else code_offset

    @property
    def task_offsets(self) -> list[int]:
        """Return the offsets of what the program does now, one for each of its tasks."""
        offsets = self._firmware.tasks()
        return offsets or ([] if self.offset is None else [self.offset])

    @property
    def driving_task_offset(self) -> int | None:
        """Return the place of the task that controls running motors; None without tasks."""
        code_offset = self._firmware.call("driver")
        return None if code_offset == NO_OFFSET else code_offset

    @property
    def firmware(self) -> Firmware:
        """The firmware, for who holds its program and looks at it."""
        return self._firmware

    def go_on(self) -> None:
        """Resume a paused program."""
        self._firmware.go_on()
        self._settle()

    @property
    def saved_state(self) -> str:
        """Return the storage state of its program: NOTHING, MEMORY, SAVING or STORED."""
        return saved_name(self._firmware.call("saved"))
