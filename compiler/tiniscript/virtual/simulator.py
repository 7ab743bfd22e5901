"""Runs a virtual robot against the real clock and its clients.

The robot's time follows real time, or runs faster while a program runs; it runs slower if this
computer is busy. A faster robot has its dead-man timer kept alive by heartbeats of this process.
`robot` simulates the robot, `transports` handles its clients.
"""

from __future__ import annotations

from random import Random
from threading import Thread
from time import monotonic

from tiniscript.link.messages import STOP_BYTES
from tiniscript.virtual import directory
from tiniscript.virtual.robot import VirtualRobot
from tiniscript.virtual.transports import BadLine, Transports

HEARTBEAT_MS = 300  # interval in the robot's time
SILENCE_S = 1.0
MAX_FRAME_BYTES = 100  # bytes of a frame on the wire, and some


class Heartbeat:
    def __init__(self) -> None:
        self._frame = b""  # the last one
        self._unfinished_packet = b""  # start of an unfinished packet
        self._received_s = 0.0
        self._heartbeat_ms = 0

    def on_bytes(self, data: bytes, wall_s: float) -> None:
        """Take bytes that the computer has sent."""
        self._received_s = wall_s
        *frames, self._unfinished_packet = (self._unfinished_packet + data).split(b"\0")
        self._unfinished_packet = self._unfinished_packet[:MAX_FRAME_BYTES]
        for frame in frames:
            if frame and len(frame) < MAX_FRAME_BYTES:
                self._frame = b"\0" + frame + b"\0"  # the frame sent for each heartbeat

    def forget(self) -> None:
        """Forget the last frame, because another client connects."""
        self._frame = self._unfinished_packet = b""

    def bytes_due(self, now_ms: int, wall_s: float) -> bytes:
        """Return the bytes to repeat at the robot's time `now_ms`, usually none."""
        is_silent = wall_s - self._received_s > SILENCE_S
        if self._unfinished_packet or is_silent or now_ms < self._heartbeat_ms + HEARTBEAT_MS:
            return b""
        self._heartbeat_ms = now_ms
        return self._frame


MAX_DELAY_S = 0.25  # a larger delay slows the robot's clock down
BUSY_S = 0.002  # between two polls while bytes are in transit,
NEAR_S = 0.02  # pause while a client is connected or a program runs
IDLE_S = 0.25  # pause otherwise
TRAFFIC_S = 0.05  # time after a byte in which more bytes are expected
STRIDE_MS = 100  # robot time between two polls of the line while it runs faster
TURN_S = 0.01  # real time that a fast run may take before the caller gets its turn
MAX_WAITING_BYTES = 512  # limit of bytes waiting for the robot; then the line is not read
PUSH_MS = 60  # duration of a button press
HOLD_MS = 2300  # duration of a long press, which confirms a claim


class Simulator:
    """`hurry` is how many times as fast a running program goes; 0 is as fast as possible.

    About `faults` of 1000 bytes are damaged, in both directions.
    """

    def __init__(
        self, robot: VirtualRobot, transports: Transports, hurry: float = 1.0, faults: float = 0.0
    ) -> None:
        self.robot = robot
        self.transports = transports
        self.hurry = hurry
        self.end_ms: int | None = None  # end of the simulation in the robot's time
        self.duration_ms: int | None = None  # duration after the start of its first program
        random_source = Random(robot.settings.seed ^ 0x5A5A)
        self.to_robot, self.from_robot = (
            BadLine(faults, random_source),
            BadLine(faults, random_source),
        )
        self._heartbeat = Heartbeat()
        self._wall_s = self._traffic_s = monotonic()
        self._owed_ms = 0.0  # robot's time of less than one millisecond, carried over
        self._visit_count = 0
        self._last_byte = b""  # byte of the client
        self._release_ms: int | None = None
        self._waiting_push_ms = 0  # duration of a press that has to wait
        self._up_until_ms = 0  # time for which a released button stays up

    @property
    def over_ms(self) -> int | None:
        """Return the end of the robot's time, if known."""
        started_ms = self.robot.started_ms
        if self.duration_ms is not None and started_ms is not None:
            return started_ms + self.duration_ms
        return self.end_ms

    @property
    def is_over(self) -> bool:
        over_ms = self.over_ms
        return over_ms is not None and self.robot.now_ms >= over_ms

    def push(self, duration_ms: int = PUSH_MS) -> None:
        """Push the start button and let it go; where it is down or just was, a moment later."""
        now_ms = self.robot.now_ms
        must_wait = self._release_ms is not None or now_ms < self._up_until_ms
        self._waiting_push_ms = duration_ms if must_wait else 0
        if not must_wait:
            self.robot.press()
            self._release_ms = now_ms + duration_ms
            self._up_until_ms = now_ms + duration_ms + PUSH_MS

    @property
    def waiting_bytes(self) -> int:
        """Return the number of bytes that the robot has yet to receive."""
        return self.robot.unread_bytes + self.to_robot.byte_count

    def turn(self, timeout_s: float = IDLE_S) -> None:
        """Wait for bytes, at most `timeout_s`; then advance the robot to the present."""
        is_full = self.waiting_bytes >= MAX_WAITING_BYTES
        self.transports.wait(min(timeout_s, self._pause_s()), is_full)
        wall_s = monotonic()
        elapsed_s = min(wall_s - self._wall_s, MAX_DELAY_S)
        self._wall_s = wall_s
        data = b"" if is_full else self.transports.receive()
        if self.transports.visit_count != self._visit_count:
            self._visit_count = self.transports.visit_count
            self._heartbeat.forget()
            if self._last_byte not in b"\0\r\n":  # ends an unfinished line of the previous client
                self.to_robot.send_bytes(b"\0", self.robot.now_ms)
            self._last_byte = b""
            self.from_robot.clear()
        if self.transports.take_stop() and self.robot.is_running:
            self.to_robot.send_bytes(bytes(STOP_BYTES), self.robot.now_ms)
        if data:
            self._traffic_s = wall_s
            self._heartbeat.on_bytes(data, wall_s)
            self._last_byte = data[-1:]
            self.to_robot.send_bytes(data, self.robot.now_ms)
        self._go_on(elapsed_s)
        self.transports.send(b"")

    def _pause_s(self) -> float:
        if self._is_hurrying():
            return 0.0 if not self.hurry else BUSY_S
        if self._wall_s - self._traffic_s < TRAFFIC_S or self.robot.unread_bytes:
            return BUSY_S
        if self.robot.is_running or self.transports.is_connected or self._is_pushing:
            return NEAR_S
        return IDLE_S

    @property
    def _is_pushing(self) -> bool:
        return self._waiting_push_ms != 0 or self._release_ms is not None

    def _is_hurrying(self) -> bool:
        return self.robot.is_running and self.hurry != 1 and not self.is_over

    def _go_on(self, elapsed_s: float) -> None:
        self._owed_ms += (
            elapsed_s * 1000 * (self.hurry if self._is_hurrying() and self.hurry else 1)
        )
        end_s = self._wall_s + TURN_S
        while True:
            is_hurrying = self._is_hurrying()
            step_ms = STRIDE_MS if is_hurrying else int(self._owed_ms)
            if is_hurrying and self.hurry:
                step_ms = min(step_ms, int(self._owed_ms))
            step_ms = self._limit_step(step_ms)
            if step_ms < 1:
                break
            self._step(step_ms, is_hurrying)
            self._owed_ms = max(0.0, self._owed_ms - step_ms)
            if monotonic() > end_s:
                self._owed_ms = min(self._owed_ms, MAX_DELAY_S * 1000)
                break
            if not is_hurrying:
                break

    def _limit_step(self, step_ms: int) -> int:
        """Return the length of a step, so that a program ends exactly with the robot's time."""
        if self.duration_ms is not None and self.is_over and self.robot.is_running:
            self.robot.rest()
        over_ms = self.over_ms
        if self.duration_ms is not None and self.robot.started_ms is None:
            return min(step_ms, STRIDE_MS, self.duration_ms)  # a program may begin in this step
        if over_ms is None or self.is_over:
            return step_ms
        return min(step_ms, over_ms - self.robot.now_ms)

    def _step(self, step_ms: int, is_hurrying: bool) -> None:
        now_ms = self.robot.now_ms
        if self._release_ms is not None and now_ms >= self._release_ms:
            self._release_ms = None
            self.robot.let_go()
        elif self._waiting_push_ms:
            self.push(self._waiting_push_ms)
        data = self.to_robot.take_arrived(now_ms)
        if is_hurrying and self.transports.is_connected and not data:
            data = self._heartbeat.bytes_due(now_ms, self._wall_s)
        sent_bytes = self.robot.step(now_ms + step_ms, data)
        if sent_bytes:
            self._traffic_s = self._wall_s
            self.from_robot.send_bytes(sent_bytes, self.robot.now_ms)
        self.transports.send(self.from_robot.take_arrived(self.robot.now_ms))


JOIN_TIMEOUT_S = 5.0


class SimulatorThread:
    """A virtual robot of this process, at a port: a thread runs its clock until `close`.

    Others find it as one of the command `verb`.
    """

    turn_s = 0.05  # the longest wait of the thread

    def __init__(
        self, robot: VirtualRobot, verb: str, hurry: float = 1.0, faults: float = 0.0
    ) -> None:
        self.robot = robot
        self.transports = Transports()
        self.port = self.transports.address
        self.simulator = Simulator(robot, self.transports, hurry, faults)
        self._is_pushed = self._is_over = False
        self._bug: BaseException | None = None
        names = robot.profile.name, robot.world.name
        self._note_path = directory.announce(
            directory.RunningRobot(self.port, *names, "", "", verb)
        )
        self._thread = Thread(target=self._run, name="virtual robot", daemon=True)

    def push(self) -> None:
        """Ask the thread to press and release the start button."""
        self._is_pushed = True

    def on_turn(self) -> None:
        """The thread calls this when the robot's time has advanced, and when it is switched off."""

    def close(self) -> None:
        """Switch it off. Raises what the thread has raised."""
        directory.withdraw(self._note_path)
        self._is_over = True
        self._thread.join(JOIN_TIMEOUT_S)
        self.transports.close()
        if self._bug is not None:
            raise self._bug

    def _run(self) -> None:
        try:
            while not self._is_over:
                if self._is_pushed:
                    self._is_pushed = False
                    self.simulator.push()
                self.simulator.turn(self.turn_s)
                self.on_turn()
            self.robot.switch_off()
            self.on_turn()
        except BaseException as bug:
            self._bug = bug
            self.transports.close()
