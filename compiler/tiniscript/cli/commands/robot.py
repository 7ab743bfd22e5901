"""`tsc robot`: a virtual robot, on a port like any other robot."""

from __future__ import annotations

import signal
import sys
from argparse import Namespace
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any

from tiniscript.cli import inputs, outputs
from tiniscript.cli.errors import Trouble
from tiniscript.cli.inputs import shown
from tiniscript.cli.options import Options, decimal, whole_number
from tiniscript.cli.robot import simulator_options
from tiniscript.cli.robot.event_printer import Bookkeeping
from tiniscript.cli.terminal.keys import Keys, is_in_front
from tiniscript.cli.texts.common import text

if TYPE_CHECKING:
    from tiniscript.cli.terminal.run_drawing import Screen
    from tiniscript.cli.terminal.world_drawing import WorldPicture
    from tiniscript.virtual.robot import VirtualRobot
    from tiniscript.virtual.simulator import Host
    from tiniscript.virtual.transports import Guests
    from tiniscript.vm.trace import Event

HELP = (
    """\
tsc robot [--world NAME|FILE] [--robot NAME|FILE] [--plot way.png] [--for S] ...

A virtual robot: the firmware of the real one, in a world of walls, lines and lamps. It has a port
like any other robot; another terminal finds it with  tsc upload prog.ts --virtual   On a
terminal it is drawn, and keys push its buttons; elsewhere a line says what it does.
  --world W     its world: obstacles, line, light, or a file (obstacles)
  --robot R     which robot: a name (tinibot, ...) or a profile's file
  --name NAME   what it is called
  --listen P    its TCP port, on this computer alone (any free one)
  --pty         a pseudo-terminal too (not on Windows)
  --baud N      how fast its line is (as in its profile); 0 is as fast as possible
  --memory F    keeps what it has saved in a file; without it, that is forgotten
  --plot F.png  draws the world and the way when it ends
  --for S       ends after so many seconds of the robot's time
  --button-at S pushes the start button after so many seconds; 2,10: twice
  --hurry N     a program goes N times as fast; max: as fast as this computer can
  --sensor NAME=1,2,3   what a sensor says, instead of what it notices in the world
  --noise X     sensors and motors are off by about X percent (0)
  --motors L,R  percent of the speed that each motor should have (100,100)
  --faults X    of 1000 bytes on its line, X get lost, change or come late (0)
  --seed N      where chance begins: the same number is the same run (1)
Exit code: 0 when it has ended.
""",
    """\
tsc robot [--world NOMBRE|ARCHIVO] [--robot NOMBRE|ARCHIVO] [--plot camino.png] [--for S] ...

Un robot virtual: el firmware del verdadero, en un mundo de paredes, líneas y lámparas. Tiene un
puerto como cualquier robot; otra terminal lo encuentra con  tsc upload prog.ts --virtual   En una
terminal se dibuja, y hay teclas para sus botones; en otro lugar una línea dice lo que hace.
  --world W     su mundo: obstacles, line, light, o un archivo (obstacles)
  --robot R     qué robot: un nombre (tinibot, ...) o el archivo de un perfil
  --name NOMBRE cómo se llama
  --listen P    su puerto TCP, solo en esta computadora (uno libre)
  --pty         también una pseudoterminal (no en Windows)
  --baud N      la velocidad de su línea (la de su perfil); 0 es lo más rápido posible
  --memory F    conserva en un archivo lo que guarda; sin esto, se olvida
  --plot F.png  dibuja el mundo y el camino cuando termina
  --for S       termina después de tantos segundos del tiempo del robot
  --button-at S pulsa el botón de inicio después de tantos segundos; 2,10: dos veces
  --hurry N     un programa va N veces más rápido; max: lo más rápido que esta computadora pueda
  --sensor NOMBRE=1,2,3 lo que dice un sensor, en vez de lo que nota en el mundo
  --noise X     los sensores y motores se desvían más o menos X por ciento (0)
  --motors I,D  por ciento de la velocidad que cada motor debería tener (100,100)
  --faults X    de 1000 bytes en su línea, X se pierden, cambian o llegan tarde (0)
  --seed N      dónde empieza el azar: el mismo número es el mismo recorrido (1)
Código de salida: 0 cuando terminó.
""",
)

FASTEST_BAUD = 2_000_000
MEMORY_BYTES = 1024  # of an Uno's EEPROM
SAVE_S = 1.0  # between two looks at what the robot keeps
NAME_MS = 20_000  # of the robot's time, for which it may take to be named
QUIT = "qQ\x04"


def run(arguments: list[str], language: str) -> int:
    parser = Options("robot", language, HELP)
    parser.add_argument("--robot")
    for name in ("--name", "--listen", "--baud", "--memory", "--button-at"):
        parser.add_argument(name)
    parser.add_argument("--pty", action="store_true")
    simulator_options.takes_world(parser)
    options = parser.read(arguments)
    if options is None:
        return 0
    profile = inputs.robot(options, language)
    port = whole_number("--listen", options.listen, 0, 0, 65535, language)
    baud = whole_number("--baud", options.baud, profile.board.baud, 0, FASTEST_BAUD, language)
    pushes_ms = _pushes_ms(options.button_at)
    end_ms = simulator_options.end_ms(options, language)
    hurry = simulator_options.hurry_of(options, language)
    faults = simulator_options.faults_of(options, language)
    robot = simulator_options.made(options, profile, language, _memory(options.memory), baud)
    if options.name is not None:
        _name(robot, options.name)
    from tiniscript.virtual import directory
    from tiniscript.virtual.simulator import Host

    guests = _guests(port, options.pty)
    note = None
    try:
        running = directory.Running(
            guests.address, robot.profile.name, robot.world.name, options.name or "",
            guests.terminal,
        )  # fmt: skip
        note = directory.announce(running)
        host = Host(robot, guests, hurry, faults)
        host.end_ms = end_ms
        stage = _Stage(host, options, language)
        stage.show(pushes_ms, end_ms)
    finally:
        directory.withdraw(note)
        guests.close()
    return 0


class _Stage:
    """The robot before its public: the terminal, or whoever reads its lines."""

    def __init__(self, host: Host, options: Namespace, language: str) -> None:
        self.host = host
        self.options = options
        self.language = language
        self.screen: Screen | None = None
        self.picture: WorldPicture | None = None
        self.began_ms = 0  # when the program began whose lines are printed
        self._bookkeeping = Bookkeeping()
        self._kept = host.robot.memory
        self._look_s = monotonic()
        self._frame_s = 0.0

    def show(self, pushes_ms: list[int], end_ms: int | None) -> None:
        """Let the robot live until its time is over, or the person ends it."""
        robot = self.host.robot
        self._introduce()
        try:
            with Keys() as keys, ended_by_signal() as ended:
                self._begin()
                while not ended.is_set and (end_ms is None or robot.now_ms < end_ms):
                    if pushes_ms and robot.now_ms >= pushes_ms[0]:
                        pushes_ms.pop(0)
                        self.host.push()
                    self.host.turn(self._limit_s(pushes_ms, end_ms))
                    self._tell(robot.take_events())
                    self._save(is_due=False)
                    if not self._obey(keys.pressed()):
                        break
        except KeyboardInterrupt:
            pass
        finally:
            if self.screen is not None and self.picture is not None:
                robot.switch_off()
                for event in robot.take_events():
                    self.picture.take(event)
                self.screen.draw(self.picture, robot.now_ms)
                self.screen.end()
            self._save(is_due=True)
        if self.options.plot is not None:
            simulator_options.draw_picture(self.options, robot, self.language)
        print(simulator_options.summary(self.options, robot, self.language), file=sys.stderr)

    def _introduce(self) -> None:
        guests, robot = self.host.guests, self.host.robot
        print(guests.address, flush=True)
        if guests.terminal:
            print(guests.terminal, flush=True)
        language = self.language
        said = text("robot_here", language).format(
            robot=shown(self.options.name or "") or robot.profile.labels[language]["robot"],
            world=robot.world.labels[language],
        )
        print(said, file=sys.stderr, flush=True)

    def _begin(self) -> None:
        if not (sys.stderr.isatty() and is_in_front()):
            return
        from tiniscript.cli.terminal.run_drawing import Screen
        from tiniscript.cli.terminal.world_drawing import WorldPicture

        keys = text("robot_keys", self.language) if sys.stdin.isatty() else ""
        self.screen = Screen()
        self.picture = WorldPicture(self.host.robot, self.language, keys)
        self.screen.begin()

    def _limit_s(self, pushes_ms: list[int], end_ms: int | None) -> float:
        """Return how long nothing has to happen."""
        from tiniscript.cli.terminal.run_drawing import FRAME_S
        from tiniscript.virtual.simulator import CALM_S

        limits = [FRAME_S if self.screen else CALM_S]
        for due_ms in (*pushes_ms[:1], *([end_ms] if end_ms is not None else [])):
            limits.append(max(0.001, (due_ms - self.host.robot.now_ms) / 1000))
        return min(limits)

    def _tell(self, events: list[Event]) -> None:
        is_plain = self.screen is None or not sys.stdout.isatty()
        for event in events:
            if self._bookkeeping.hides_trace(event):
                continue
            if event.what == "START":
                self.began_ms = event.time_ms
            if self.picture is not None:
                self.picture.take(event)
            if is_plain:
                print(f"{event.time_ms - self.began_ms} {event.text}")
        if events and is_plain:
            sys.stdout.flush()
        self._draw()

    def _draw(self) -> None:
        from tiniscript.cli.terminal.run_drawing import FRAME_S

        if self.screen is not None and self.picture is not None:
            if monotonic() >= self._frame_s:
                self._frame_s = monotonic() + FRAME_S
                self.screen.draw(self.picture, self.host.robot.now_ms)

    def _obey(self, keys: str) -> bool:
        """Do what keys say; return whether to go on."""
        for key in keys:
            if key in QUIT:
                return False
            if key in "bB ":
                self.host.push()
            elif key in "rR":
                self.host.robot.power_cycle(2)
            elif key in "pP":
                self.host.robot.power_cycle()
        return True

    def _save(self, is_due: bool) -> None:
        """Keep what the robot keeps, where it has changed."""
        if self.options.memory is None or not (is_due or monotonic() > self._look_s + SAVE_S):
            return
        self._look_s = monotonic()
        memory = self.host.robot.memory
        if memory != self._kept or is_due:
            outputs.write(Path(self.options.memory), memory, "unwritable_memory")
            self._kept = memory


class Ended:
    """Whether somebody has asked the process to end."""

    def __init__(self) -> None:
        self.is_set = False

    def ask(self, *_: Any) -> None:
        """Do what a signal means. The exception may come in a callback of C, which drops it."""
        self.is_set = True
        raise KeyboardInterrupt


@contextmanager
def ended_by_signal() -> Iterator[Ended]:
    """Who ends this process ends it as Ctrl-C does: nothing is left lying around."""
    ended = Ended()
    numbers = (signal.SIGTERM, signal.SIGINT)
    before = [signal.signal(number, ended.ask) for number in numbers]
    try:
        yield ended
    finally:
        for number, handler in zip(numbers, before, strict=True):
            signal.signal(number, handler)


def _guests(port: int, has_terminal: bool) -> Guests:
    from tiniscript.virtual.transports import Guests, can_have_terminal

    if has_terminal and not can_have_terminal():
        raise Trouble(2, "no_pty")
    try:
        return Guests(port, has_terminal)
    except OSError as why:
        raise Trouble(3, "listen_taken", port=str(port), why=why.strerror or str(why)) from None


def _pushes_ms(found: str | None) -> list[int]:
    if found is None:
        return []
    values = [decimal(each.strip()) for each in found.split(",")]
    known = [each for each in values if each is not None and each >= 0]
    if len(known) != len(values):
        raise Trouble(2, "bad_button", found=shown(found) or "''")
    return sorted(known)


def _memory(name: str | None) -> bytes | None:
    """Return what a robot has kept; a file that is not there yet is a new robot's."""
    if name is None:
        return None
    try:
        with Path(name).open("rb") as file:
            data = file.read(MEMORY_BYTES + 1)
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as why:
        reason = why.strerror if isinstance(why, OSError) and why.strerror else str(why)
        raise Trouble(2, "unreadable_memory", file=shown(name), why=reason) from None
    if len(data) != MEMORY_BYTES:
        raise Trouble(2, "bad_memory", file=shown(name), bytes=str(MEMORY_BYTES))
    return data


def _name(robot: VirtualRobot, name: str) -> None:
    """Name the robot as `tsc name` does, before anybody is there."""
    from tiniscript.cli.commands.name import name_bytes
    from tiniscript.link.session import Session

    data = name_bytes(name)
    profile = robot.profile
    nonce = robot.chance.getrandbits(32)
    session = Session(nonce, profile.board.baud, profile.kit.fingerprint)
    task = session.name(data)
    while task.outcome is None and robot.now_ms < NAME_MS:
        now_ms = robot.now_ms + 1
        session.receive(robot.step(now_ms, session.poll(now_ms)), now_ms)
    robot.step(robot.now_ms + 500)  # it is saved
    robot.power_cycle()
