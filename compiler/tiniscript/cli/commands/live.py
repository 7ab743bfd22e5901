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
    HaltableProgram,
    breakpoint_offsets,
    parse_lines,
    require_breakpoints,
)
from tiniscript.cli.robot.description import introduce
from tiniscript.cli.robot.event_printer import EventPrinter, printer_of
from tiniscript.cli.robot.live_state import LiveLine, LiveState, LiveValue, header, missing_ends
from tiniscript.cli.robot.remote_keys import TerminalRemote
from tiniscript.cli.robot.run_monitor import INTERRUPTED, RunMonitor, stop_and_say
from tiniscript.cli.texts import say, say_aside, text
from tiniscript.library import source_map
from tiniscript.library.compiling import add_robot_hints, used_fingerprint
from tiniscript.library.known_kits import missing_need_key
from tiniscript.library.other_robots import has_words_of_other_robots
from tiniscript.library.refusing import lacks_remote
from tiniscript.link.messages import STATUSES
from tiniscript.link.outcomes import Event, ShownEvent
from tiniscript.link.requests import SHORT_BYTES, Reply, short_bytes
from tiniscript.robots.profile import Robot

PROMPT = "tini> "
MORE_PROMPT = "....> "  # a block is open
LEAVE, HELP_ME = "bye", "help"  # the words of the lexicon


def run(options: Namespace, language: str) -> int:
    if options.line is not None and options.text is not None:
        raise CommandError(2, "two_programs")
    line: str | None = options.text if options.line is None else options.line
    if options.keys and (line == "-" or not sys.stdin.isatty()):
        raise CommandError(2, "keys_no_terminal")
    if options.keys and options.breaks:
        raise CommandError(2, "keys_break")
    robot = inputs.robot(options, language)

    state = LiveState(robot.kit)
    if line is not None and line != "-" and not _is_runnable(line, state, robot, options):
        return 1
    with Connection(options, robot, language) as connection:
        repl = Repl(connection, state, options)
        if options.keys:
            return repl.drive_by_keys(line)
        if line is None and sys.stdin.isatty():
            return repl.run_prompt()
        repl.meet_robot()
        if line is None or line == "-":
            return repl.run_lines(sys.stdin)
        return repl.run_line(line, is_last=True)


def _is_runnable(line: str, state: LiveState, robot: Robot, options: Namespace) -> bool:
    """Return whether a line has no mistakes, perhaps for the connected robot; otherwise print
    them.
    """
    language: str = options.language
    if options.robot is None:
        compilation = add_robot_hints(
            state.compile_line(line, 0).compilation, robot, is_chosen=True
        )
        if has_words_of_other_robots(compilation.diagnostics):
            answering_robot = own_kit.find_answering_robot(options, robot, language)
            if answering_robot is not None:
                return True  # the program is compiled again for that robot
    return _compile(line, state, robot, language, True, SHORT_BYTES, warns=False) is not None


def _compile(
    line: str, state: LiveState, robot: Robot, language: str, is_last: bool, room: int,
    warns: bool = True,
) -> LiveLine | None:  # fmt: skip
    """Compile a line into at most `room` bytes of code, and print its diagnostics, those of a right
    line where it `warns`.

    Returns None if it has mistakes. Raises CommandError if it is too long.
    """
    if header(line) == "SB":
        raise CommandError(1, "live_button")
    live_line = state.compile_line(line, 0 if is_last else room)
    if warns or not live_line.compilation.is_right:
        outputs.print_diagnostics(
            add_robot_hints(live_line.compilation, robot, is_chosen=True), language
        )
    if not live_line.compilation.is_right:
        return None
    assert live_line.compilation.verdict is not None
    if need_key := missing_need_key(live_line.compilation.verdict.needs, robot):
        raise CommandError(1, need_key, robot=robot.name, file="prog.ts")
    code_bytes = len(live_line.compilation.code)
    if code_bytes > room:
        raise CommandError(1, "live_too_long", code=str(code_bytes), room=str(room))
    return live_line


class Repl:
    """Lines to a robot, one after the other."""

    def __init__(self, connection: Connection, state: LiveState, options: Namespace) -> None:
        self.connection = connection
        self.options = options
        self.language = connection.language
        self.state = state
        self.remote: TerminalRemote | None = None
        self.break_lines = parse_lines(options.breaks, self.language)

    def meet_robot(self) -> None:
        """Send HELLO to the robot, and use its kit. Raises CommandError if none answers, or it
        cannot halt where it should."""
        self.connection.meet()
        if self.break_lines:
            require_breakpoints(self.connection)
        if own_kit.use_answering_profile(self.connection, self.options):
            self.state.kit = self.connection.profile.kit

    def run_line(self, line: str, is_last: bool = False) -> int:
        """Run a line; return the exit code. Ctrl-C stops the robot."""
        if header(line) == "PING":
            return introduce(self.connection, is_json=False)
        robot = self.connection.profile
        room = short_bytes(self.connection.device_info)  # less where frames are sealed
        live_line = _compile(line, self.state, robot, self.language, is_last, room)
        if live_line is None:
            return 1
        if lacks_remote(live_line.compilation.code, self.state.kit, self.connection.device_info):
            raise self.connection.error_for_reply(Reply(STATUSES["NO_REMOTE"]))
        try:
            exit_code = 0 if live_line.has_only_defs else self._run(live_line, is_last)
        except KeyboardInterrupt:
            return stop_and_say(self.connection)
        if not exit_code and live_line.loses_values and not is_last:
            say_aside("live_forgets", self.language)
        if not exit_code and live_line.text_by_def:
            self.state.text_by_def.update(live_line.text_by_def)
            if live_line.has_only_defs:
                names = ", ".join(live_line.text_by_def)
                say("live_known", self.language, names=names)
        return exit_code

    def read_block(self, line: str, read_more: Callable[[], str | None]) -> str:
        """Return a line with the further lines of its blocks, up to the first one with a mistake.

        `read_more` returns the next line, or None if there is none.
        """
        while ends := missing_ends(line):
            closed_line = f"{line}\n{ends}"
            if not self.state.compile_line(closed_line, 0).compilation.is_right:
                return closed_line
            next_line = read_more()
            if next_line is None:
                return line
            line = f"{line}\n{next_line}"
        return line

    def _run(self, line: LiveLine, is_last: bool) -> int:
        compilation = line.compilation
        program_map = source_map.map_of_compiled(compilation)
        source_map.remember(compilation.image, program_map)  # tsc doctor names a fault's line later
        kit = used_fingerprint(line.compilation, self.connection.profile)
        code = line.compilation.code
        haltable_program = HaltableProgram(
            code, line.whole_map or program_map, line.lines_before + 1
        )
        breakpoints = self._breakpoints_of(haltable_program, is_last)
        reply = self.connection.request(lambda session: session.live(code, kit, bool(breakpoints)))
        program = reply.values.program
        printer = printer_of(self.connection, False, program_map, program, line.whole_map)
        catcher = ValueCatcher(line.shown_variables, self.state, printer, is_last)
        simulator = self.connection.simulator
        if simulator is not None:
            simulator.start_drawing()
        notice = self.connection.wait_notice.with_sentence(self.connection.text("line_runs"))
        on_wait = notice.poll if simulator is None else None  # the simulator's picture shows that
        monitor = RunMonitor(self.connection, printer, catcher.hold_event, on_wait)
        if self.remote is not None:
            monitor.on_wait, monitor.wait_s = self.remote.poll, remote_keys.POLL_S
        try:
            if not breakpoints:
                return monitor.follow(reply.values.run)
            with Debugger(self.connection, printer, haltable_program, breakpoints) as debugger:
                monitor.on_wait = debugger.poll_keys
                monitor.hold = lambda event: debugger.hold_event(event) or catcher.hold_event(event)
                return monitor.follow(reply.values.run)
        finally:
            if simulator is not None:
                simulator.stop_drawing()

    def _breakpoints_of(self, program: HaltableProgram, is_last: bool) -> tuple[int, ...]:
        """Return the breakpoints of a line. Raises CommandError if its only one has no place to
        halt.
        """
        offsets: set[int] = set()
        for line in self.break_lines:
            try:
                offsets.update(breakpoint_offsets((line,), program))
            except CommandError:
                if is_last:
                    raise
        return tuple(sorted(offsets))

    def drive_by_keys(self, line: str | None) -> int:
        """Let the keys of the terminal act as the remote control of a line or of the running
        program; return the exit code."""
        self.meet_robot()
        with TerminalRemote(self.connection) as self.remote:
            self.connection.print_text("live_keys")
            exit_code = self._pass_keys_on() if line is None else self.run_line(line, is_last=True)
            return 0 if self.remote.has_quit and exit_code == INTERRUPTED else exit_code

    def _pass_keys_on(self) -> int:
        """Pass keys on and print events, until somebody leaves, which stops the robot."""
        assert self.remote is not None
        simulator = self.connection.simulator
        if simulator is not None:
            simulator.start_drawing()
        try:
            while not self._report_time_limit():
                self._print_pending_events(remote_keys.POLL_S)
                self.remote.poll()
            return 0
        except KeyboardInterrupt:
            return stop_and_say(self.connection)

    def run_lines(self, file: Iterable[str]) -> int:
        """Run lines from a file until one fails."""
        lines = (line.rstrip("\r\n") for line in file)
        for line in lines:
            if line.strip():
                if self._report_time_limit():
                    return 0
                exit_code = self.run_line(self.read_block(line, lambda: next(lines, None)))
                if exit_code or self.connection.is_time_over:
                    return exit_code
        return 0

    def _report_time_limit(self) -> bool:
        """Return whether a virtual robot's time limit has passed between two lines, and print
        that.
        """
        if self.connection.is_time_over:
            say("time_over", self.language)
            return True
        return False

    def _help_text(self) -> str:
        kit = self.state.kit
        names = ", ".join(kit.names)
        return text("live_help", self.language).format(
            show=f"SHOW({kit.sensors[0].name if kit.sensors else 'TIME'})",
            names=names or text("live_nothing", self.language),
        )

    def run_prompt(self) -> int:
        """Execute the lines that a person types, until they leave."""
        self.meet_robot()
        self.connection.print_text("live_hello")
        with _history(self.state):
            while True:
                try:
                    if self._read_and_run():
                        return 0
                except KeyboardInterrupt:
                    self._stop_robot()

    def _read_and_run(self) -> bool:
        """Run what a person types next; return whether that was the last of it."""
        self._print_pending_events()
        try:
            line = self.read_block(input(PROMPT), lambda: input(MORE_PROMPT))
        except EOFError:
            print()
            return True
        if self._report_time_limit():
            return True
        self._print_pending_events()
        command = requested_command(line, self.state)
        if command == LEAVE:
            return True
        if command == HELP_ME:
            print(self._help_text())
        elif line.strip():
            self._run_or_print(line)
            return self.connection.is_time_over  # printed already
        return False

    def _run_or_print(self, line: str) -> None:
        """Run a line; print any failure, and continue the session."""
        try:
            self.run_line(line)
        except CommandError as error:
            if error.key in ("port_gone", "radio_gone", "holder_ended"):
                raise
            print(error.sentence(self.language), file=sys.stderr)

    def _stop_robot(self) -> None:
        try:
            stop_and_say(self.connection)
        except CommandError as error:
            print(error.sentence(self.language), file=sys.stderr)

    def _print_pending_events(self, timeout_s: float = 0) -> None:
        """Print the robot's events since the last line.

        The next line reports a lost robot, if it is still lost.
        """
        printer, bookkeeping = EventPrinter(self.language), Bookkeeping()
        while (timed_event := self.connection.event(timeout_s)) is not None:
            timeout_s = 0
            if not bookkeeping.filter_event(timed_event[1]):
                printer.print_event(*timed_event)


def requested_command(line: str, state: LiveState) -> str:
    """Return the command to tsc, not to the robot, that a line consists of, or an empty text.

    A name of the kit or of the user's program is no such command.
    """
    word = re.sub(r"\s*(\(\s*\))?[\s;]*$", "", line.lstrip()).upper()
    if word in (*state.text_by_def, *state.kit.names):
        return ""
    return (
        HELP_ME
        if word == "?"
        else "".join(lexicon_meaning(word, LEAVE) or lexicon_meaning(word, HELP_ME))
    )


class ValueCatcher:
    """Hides the SHOW events that report a line's variables, and learns the values from them."""

    def __init__(
        self,
        shown_variables: tuple[str, ...],
        state: LiveState,
        printer: EventPrinter,
        prints_done: bool,
    ) -> None:
        self.shown_variables = shown_variables
        self.state = state
        self.printer = printer
        self.prints_done = prints_done
        self.held_events: list[ShownEvent] = []

    def hold_event(self, event: Event) -> bool:
        if event.name == "SHOW":
            if not self.shown_variables or not (_is_mark(event) or self.held_events):
                return False
            self.held_events.append(event)
            if (
                len(self.held_events) > len(self.shown_variables) + 1
            ):  # a program shows the mark by chance
                self._print_held_events(1)
                while self.held_events and not _is_mark(self.held_events[0]):
                    self._print_held_events(1)
            return True
        if event.name == "DONE":
            shown_events = self.held_events[1:]
            if len(shown_events) == len(self.shown_variables):
                for name, shown_event in zip(self.shown_variables, shown_events, strict=True):
                    self.state.value_by_name[name] = LiveValue(
                        shown_event.value, bool(shown_event.is_yes_no)
                    )
            self.held_events = []
            return not self.prints_done
        if event.name == "FAULT":  # the instructions that show the values cannot fault
            self._print_held_events()
        elif event.name == "STOPPED":
            self.held_events = []
        return False

    def _print_held_events(self, count: int | None = None) -> None:
        """Print held events after all, because the line itself has shown them: `count`, or all."""
        released_events = self.held_events[:count]
        del self.held_events[:count]
        for event in released_events:
            self.printer.print_event(0, event)


def _is_mark(event: ShownEvent) -> bool:
    return event.value == BOOKKEEPING_MARK and not event.is_yes_no


@contextlib.contextmanager
def _history(state: LiveState) -> Iterator[None]:
    """Arrow keys bring back earlier lines, of earlier sessions too; Tab completes words."""
    if sys.platform == "win32":  # the Windows console has its own history
        yield
        return
    try:
        import readline
    except ImportError:
        yield
        return
    path = files.cache_folder() / "live_history"
    kit = state.kit

    def complete(typed_word: str, index: int) -> str | None:
        words = sorted({*WORDS, *kit.names, *state.names()})
        matches = [word for word in words if word.startswith(typed_word.upper())]
        return matches[index] if index < len(matches) else None

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
