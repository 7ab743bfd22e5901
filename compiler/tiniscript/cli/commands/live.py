"""`tsc live`: lines that the robot does at once."""

from __future__ import annotations

import contextlib
import re
import sys
from argparse import Namespace
from collections.abc import Callable, Iterable, Iterator

from tiniscript.base import files
from tiniscript.base.words import WORDS, lexicon_meaning
from tiniscript.cli import inputs, outputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot import own_kit, remote_keys
from tiniscript.cli.robot.bookkeeping import BOOKKEEPING_MARK, Bookkeeping
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.debugger import (
    Debugger,
    Halting,
    lines_of,
    places_of,
    require_breakpoints,
)
from tiniscript.cli.robot.description import introduce
from tiniscript.cli.robot.event_printer import EventPrinter, printer_of
from tiniscript.cli.robot.live_state import Line, LiveState, Value, header, open_ends
from tiniscript.cli.robot.remote_keys import TerminalRemote
from tiniscript.cli.robot.run_monitor import INTERRUPTED, RunMonitor, stop_and_say
from tiniscript.cli.texts import say, say_aside, text
from tiniscript.library import source_map
from tiniscript.library.compiling import add_robot_hints, kit_of
from tiniscript.library.known_kits import missing_need
from tiniscript.library.other_robots import is_other_robots
from tiniscript.library.refusing import lacks_remote
from tiniscript.link.messages import STATUSES
from tiniscript.link.outcomes import Event, ShownEvent
from tiniscript.link.requests import SHORT_BYTES, Reply, short_bytes
from tiniscript.robots.profile import Robot

PROMPT = "tini> "
MORE = "....> "  # a block is open
LEAVE, HELP_ME = "bye", "help"  # as the lexicon calls them


def run(options: Namespace, language: str) -> int:
    if options.line is not None and options.text is not None:
        raise CommandError(2, "two_programs")
    line: str | None = options.text if options.line is None else options.line
    if options.keys and (line == "-" or not sys.stdin.isatty()):
        raise CommandError(2, "keys_no_terminal")
    if options.keys and options.breaks:
        raise CommandError(2, "keys_break")
    robot = inputs.robot(options, language)

    known = LiveState(robot.kit)
    if line is not None and line != "-" and not _is_runnable(line, known, robot, options):
        return 1
    with Connection(options, robot, language) as connection:
        talk = Repl(connection, known, options)
        if options.keys:
            return talk.steer(line)
        if line is None and sys.stdin.isatty():
            return talk.prompt()
        talk.meet()
        if line is None or line == "-":
            return talk.all_of(sys.stdin)
        return talk.run_line(line, is_last=True)


def _is_runnable(line: str, known: LiveState, robot: Robot, options: Namespace) -> bool:
    """Whether a line has no mistakes, perhaps for the robot that answers; else print them."""
    language: str = options.language
    if options.robot is None:
        compiled = add_robot_hints(known.line(line, 0).compiled, robot, is_chosen=True)
        if is_other_robots(compiled.diagnostics):
            result = own_kit.find_answering_robot(options, robot, language)
            if result is not None:
                return True  # it is compiled again for that robot
    return _compile(line, known, robot, language, True, SHORT_BYTES, warns=False) is not None


def _compile(
    line: str, known: LiveState, robot: Robot, language: str, is_last: bool, room: int,
    warns: bool = True,
) -> Line | None:  # fmt: skip
    """Compile a line into at most `room` bytes of code, and print its diagnostics, those of a right
    line where it `warns`.

    Returns None if it has mistakes. Raises CommandError if it is too long.
    """
    if header(line) == "SB":
        raise CommandError(1, "live_button")
    result = known.line(line, 0 if is_last else room)
    if warns or not result.compiled.is_right:
        outputs.print_diagnostics(add_robot_hints(result.compiled, robot, is_chosen=True), language)
    if not result.compiled.is_right:
        return None
    assert result.compiled.verdict is not None
    if lacks := missing_need(result.compiled.verdict.needs, robot):
        raise CommandError(1, lacks, robot=robot.name, file="prog.ts")
    code = len(result.compiled.code)
    if code > room:
        raise CommandError(1, "live_too_long", code=str(code), room=str(room))
    return result


class Repl:
    """Lines to a robot, one after the other."""

    def __init__(self, connection: Connection, known: LiveState, options: Namespace) -> None:
        self.connection = connection
        self.options = options
        self.language = connection.language
        self.known = known
        self.remote: TerminalRemote | None = None
        self.breaks = lines_of(options.breaks, self.language)

    def meet(self) -> None:
        """Send HELLO to the robot, and use its kit. Raises CommandError if none answers, or it
        cannot halt where it is to."""
        self.connection.meet()
        if self.breaks:
            require_breakpoints(self.connection)
        if own_kit.use_answering_profile(self.connection, self.options):
            self.known.kit = self.connection.profile.kit

    def run_line(self, line: str, is_last: bool = False) -> int:
        """Run a line; return the exit code. Ctrl-C stops the robot."""
        if header(line) == "PING":
            return introduce(self.connection, is_json=False)
        robot = self.connection.profile
        room = short_bytes(self.connection.device_info)  # less where frames are sealed
        result = _compile(line, self.known, robot, self.language, is_last, room)
        if result is None:
            return 1
        if lacks_remote(result.compiled.code, self.known.kit, self.connection.device_info):
            raise self.connection.failure(Reply(STATUSES["NO_REMOTE"]))
        try:
            code = 0 if result.does_nothing else self._run(result, is_last)
        except KeyboardInterrupt:
            return stop_and_say(self.connection)
        if not code and result.forgets and not is_last:
            say_aside("live_forgets", self.language)
        if not code and result.defs:
            self.known.defs.update(result.defs)
            if result.does_nothing:
                names = ", ".join(result.defs)
                say("live_known", self.language, names=names)
        return code

    def read_block(self, line: str, more: Callable[[], str | None]) -> str:
        """Return a line with those that its blocks go on over, up to the first one with a mistake.

        `more` returns the next line, or None if there is none.
        """
        while ends := open_ends(line):
            closed = f"{line}\n{ends}"
            if not self.known.line(closed, 0).compiled.is_right:
                return closed
            following = more()
            if following is None:
                return line
            line = f"{line}\n{following}"
        return line

    def _run(self, line: Line, is_last: bool) -> int:
        compiled = line.compiled
        places = source_map.map_of_compiled(compiled)
        source_map.remember(compiled.image, places)  # tsc doctor names a fault's line later
        kit = kit_of(line.compiled, self.connection.profile)
        code = line.compiled.code
        halting = Halting(code, line.whole or places, line.before + 1)
        stops = self._stops_of(halting, is_last)
        reply = self.connection.request(lambda session: session.live(code, kit, bool(stops)))
        program = reply.values.program
        printer = printer_of(self.connection, False, places, program, line.whole)
        catch = Catch(line.shown, self.known, printer, is_last)
        simulator = self.connection.simulator
        if simulator is not None:
            simulator.watch()
        quiet = self.connection.quiet.with_words(self.connection.text("line_runs"))
        look = quiet.look if simulator is None else None  # its picture shows that
        monitor = RunMonitor(self.connection, printer, catch.hold, look)
        if self.remote is not None:
            monitor.look, monitor.look_s = self.remote.look, remote_keys.LOOK_S
        try:
            if not stops:
                return monitor.follow(reply.values.run)
            with Debugger(self.connection, printer, halting, stops) as debugger:
                monitor.look = debugger.look
                monitor.hold = lambda event: debugger.hold(event) or catch.hold(event)
                return monitor.follow(reply.values.run)
        finally:
            if simulator is not None:
                simulator.unwatch()

    def _stops_of(self, halting: Halting, is_last: bool) -> tuple[int, ...]:
        """Return where a line halts. Raises CommandError where the only one has no such place."""
        found: set[int] = set()
        for number in self.breaks:
            try:
                found.update(places_of((number,), halting))
            except CommandError:
                if is_last:
                    raise
        return tuple(sorted(found))

    def steer(self, line: str | None) -> int:
        """Drive what a line reads of a remote control, or the program that runs, by the keys of
        the terminal; return the exit code."""
        self.meet()
        with TerminalRemote(self.connection) as self.remote:
            self.connection.say("live_keys")
            code = self._attend() if line is None else self.run_line(line, is_last=True)
            return 0 if self.remote.has_quit and code == INTERRUPTED else code

    def _attend(self) -> int:
        """Pass keys on and print events, until somebody leaves, which stops the robot."""
        assert self.remote is not None
        simulator = self.connection.simulator
        if simulator is not None:
            simulator.watch()
        try:
            while not self._report_time_limit():
                self._print_pending_events(remote_keys.LOOK_S)
                self.remote.look()
            return 0
        except KeyboardInterrupt:
            return stop_and_say(self.connection)

    def all_of(self, file: Iterable[str]) -> int:
        """Run lines from a file until one fails."""
        lines = (line.rstrip("\r\n") for line in file)
        for line in lines:
            if line.strip():
                if self._report_time_limit():
                    return 0
                code = self.run_line(self.read_block(line, lambda: next(lines, None)))
                if code or self.connection.is_time_over:
                    return code
        return 0

    def _report_time_limit(self) -> bool:
        """Whether a virtual robot's time limit has passed between two lines; prints so then."""
        if self.connection.is_time_over:
            say("time_over", self.language)
            return True
        return False

    def _help(self) -> str:
        kit = self.known.kit
        names = ", ".join(kit.names)
        return text("live_help", self.language).format(
            show=f"SHOW({kit.sensors[0].name if kit.sensors else 'TIME'})",
            names=names or text("live_nothing", self.language),
        )

    def prompt(self) -> int:
        """Let a person type lines, until they leave."""
        self.meet()
        self.connection.say("live_hello")
        with _history(self.known):
            while True:
                try:
                    if self._read_and_run():
                        return 0
                except KeyboardInterrupt:
                    self._stop()

    def _read_and_run(self) -> bool:
        """Run what a person types next; return whether that was the last of it."""
        self._print_pending_events()
        try:
            line = self.read_block(input(PROMPT), lambda: input(MORE))
        except EOFError:
            print()
            return True
        if self._report_time_limit():
            return True
        self._print_pending_events()
        request = requested_command(line, self.known)
        if request == LEAVE:
            return True
        if request == HELP_ME:
            print(self._help())
        elif line.strip():
            self._try(line)
            return self.connection.is_time_over  # printed already
        return False

    def _try(self, line: str) -> None:
        """Run a line; print any failure, and go on with the session."""
        try:
            self.run_line(line)
        except CommandError as failure:
            if failure.key in ("port_gone", "radio_gone", "holder_ended"):
                raise
            print(failure.sentence(self.language), file=sys.stderr)

    def _stop(self) -> None:
        try:
            stop_and_say(self.connection)
        except CommandError as failure:
            print(failure.sentence(self.language), file=sys.stderr)

    def _print_pending_events(self, limit_s: float = 0) -> None:
        """Print the robot's events since the last line.

        The next line reports a lost robot, if it is still lost.
        """
        printer, bookkeeping = EventPrinter(self.language), Bookkeeping()
        while (found := self.connection.event(limit_s)) is not None:
            limit_s = 0
            if not bookkeeping.hides(found[1]):
                printer.tell(*found)


def requested_command(line: str, known: LiveState) -> str:
    """Return the command to tsc, not to the robot, that a line consists of, or an empty text.

    A name of the kit or of the user's program is no such command.
    """
    word = re.sub(r"\s*(\(\s*\))?[\s;]*$", "", line.lstrip()).upper()
    if word in (*known.defs, *known.kit.names):
        return ""
    return (
        HELP_ME
        if word == "?"
        else "".join(lexicon_meaning(word, LEAVE) or lexicon_meaning(word, HELP_ME))
    )


class Catch:
    """Hides the SHOW events that report a line's variables, and learns the values from them."""

    def __init__(
        self, shown: tuple[str, ...], known: LiveState, printer: EventPrinter, says_done: bool
    ) -> None:
        self.shown = shown
        self.known = known
        self.printer = printer
        self.says_done = says_done
        self.held: list[ShownEvent] = []

    def hold(self, event: Event) -> bool:
        if event.name == "SHOW":
            if not self.shown or not (_is_mark(event) or self.held):
                return False
            self.held.append(event)
            if len(self.held) > len(self.shown) + 1:  # a program shows the mark by chance
                self._release(1)
                while self.held and not _is_mark(self.held[0]):
                    self._release(1)
            return True
        if event.name == "DONE":
            shown_events = self.held[1:]
            if len(shown_events) == len(self.shown):
                for name, shown_event in zip(self.shown, shown_events, strict=True):
                    self.known.values[name] = Value(shown_event.value, bool(shown_event.is_yes_no))
            self.held = []
            return not self.says_done
        if event.name == "FAULT":  # the instructions that show the values cannot fault
            self._release()
        elif event.name == "STOPPED":
            self.held = []
        return False

    def _release(self, count: int | None = None) -> None:
        """Print held events after all, because the line itself has shown them: `count`, or all."""
        own = self.held[:count]
        del self.held[:count]
        for event in own:
            self.printer.tell(0, event)


def _is_mark(event: ShownEvent) -> bool:
    return event.value == BOOKKEEPING_MARK and not event.is_yes_no


@contextlib.contextmanager
def _history(known: LiveState) -> Iterator[None]:
    """Arrow keys bring back earlier lines, of earlier sessions too; Tab completes words."""
    if sys.platform == "win32":  # its console has a history of its own
        yield
        return
    try:
        import readline
    except ImportError:
        yield
        return
    path = files.cache_folder() / "live_history"
    kit = known.kit

    def complete(begun: str, number: int) -> str | None:
        words = sorted({*WORDS, *kit.names, *known.names()})
        fitting = [word for word in words if word.startswith(begun.upper())]
        return fitting[number] if number < len(fitting) else None

    with contextlib.suppress(OSError):
        readline.read_history_file(path)
    readline.set_completer(complete)
    readline.set_completer_delims(" \t;|()+-*/%=<>,")
    is_libedit = "libedit" in (readline.__doc__ or "")
    readline.parse_and_bind("bind ^I rl_complete" if is_libedit else "tab: complete")
    try:
        yield
    finally:
        readline.set_history_length(500)
        with contextlib.suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            readline.write_history_file(path)
