"""The options of all commands: one table. The catalogue `help` describes each option.

Parsers, help, completion, `cli/paths.py` and the documents are made from it and from the table in
`verbs.py`, which says how texts are written.
"""

# No `from __future__ import annotations`: typing would compile each field's again, one by one.
from typing import NamedTuple

from tiniscript.base.languages import languages
from tiniscript.cli.texts.verbs import STEPS, command_words, settings, steps_of, verb_text
from tiniscript.robots.text_levels import LEVELS


class Kind(NamedTuple):
    """The kind of a value, for completion and for `cli/paths.py`.

    `reads` is the sentence that describes an input file, `writes` the sentence for an output file
    that cannot be written. A value that is not among `choices` is refused.
    """

    name: str
    reads: str = ""
    writes: str = ""
    choices: tuple[str, ...] = ()


class Option(NamedTuple):
    """An option of commands, or, where its name has no dash, an argument. All may be left out.

    `kind` and `value` (its name in help) describe the option's value; a switch has none. `dest` is
    its name in the code, if it is not the last of its flags. `repeats`: each use adds one value.
    `may_be_alone`: its value may be left out. `is_virtual`: only for the virtual robot. `silent_verbs`:
    commands that take it without a row in help.
    """

    flags: str
    verbs: str  # commands; "*" is each, and tsc itself; "tsc" is tsc itself
    kind: Kind | None = None
    value: str = ""
    dest: str = ""
    repeats: bool = False
    is_virtual: bool = False
    may_be_alone: bool = False
    silent_verbs: str = ""

    @property
    def is_argument(self) -> bool:
        return not self.flags.startswith("-")

    @property
    def name(self) -> str:
        """Its name in the code."""
        return self.dest or self.flags.split()[-1].lstrip("-").replace("-", "_")

    @property
    def default(self) -> object:
        """Its value if it is not given."""
        return [] if self.repeats else False if self.kind is None else None

    def help(self, language: str) -> str:
        """Return the description of the option."""
        return verb_text(f"option/{self.flags}/{self.verbs.split()[0]}", language)

    def shown_value(self, language: str) -> str:
        """Return the name of its value in help."""
        return verb_text(f"value/{self.value}", language) or self.value

    def applies_to(self, verb: str) -> bool:
        return self.verbs == "*" or verb in self.verbs.split()


PROGRAM = Kind("program", reads="path_program")
ROBOT = Kind("robot", reads="path_robot")
WORLD = Kind("world", reads="path_world")
PORT = Kind("port", reads="path_port")
IMAGE = Kind("file", writes="unwritable")
MAP = Kind("file", writes="unwritable_at --map")
PICTURE = Kind("file", writes="unwritable_at --plot")
REPORT = Kind("file", writes="unwritable_at --report")
ROWS = Kind("file", writes="unwritable_more --csv")
RECORDING = Kind("file", writes="unwritable_more --record")
KEYS = Kind("file", reads="path_keys")
NEW_KEYS = Kind("file", writes="unwritable_more --export")
MEMORY = Kind("file", reads="path_memory", writes="unwritable_at --memory")
TEXT = Kind("text")
NUMBER = Kind("number")
CODE = Kind("code")  # code of a message
CHIP = Kind("chip")
SENSOR = Kind("sensor")
VERB = Kind("verb")
HURRY = Kind("hurry")
LESSON_ACTION = Kind("action")  # action of tsc lesson
LANGUAGE = Kind("choice", choices=languages())
MACHINE = Kind("choice", choices=("python", "cpp"))
YES_NO = Kind("choice", choices=("yes", "no"))
ON_OFF = Kind("choice", choices=("on", "off"))
SETTING = Kind("choice", choices=settings())
CLASS_ACTION = Kind("choice", choices=("list", "upload", "stop", "show"))
TRUST = Kind("file", reads="path_trust")
SHELL = Kind("choice", choices=("bash", "zsh", "powershell"))
LEVEL = Kind("choice", choices=tuple(LEVELS))

# Options of each action of `tsc lesson` besides the lesson and the language.
LESSON_ACTIONS = {
    "show": ("teacher",),
    "check": ("program", "texts", "seed", "csv", "plot", "json"),
    "sheet": ("teacher", "output"),
}

A_FILE, A_ROBOT, A_TEXT, READINGS = "FILE", "NAME|FILE", "TEXT", "NAME=1,2,3"
P, N, S, X = "P", "N", "S", "X"
YES_OR_NO = "yes|no"
A_LEVEL = "|".join(LEVELS)

ONE_ROBOT_VERBS = (
    "live monitor_hold start monitor show_port set_name set_trim set_owner set_owner_give_up "
    "set_text set_wifi doctor_selftest"
)
VIRTUAL_ROBOT_VERBS = "upload live robot"  # may bring a virtual robot along
# Verbs that take an option which hardly anybody combines with them.
VERBS_WITHOUT_BAUD = (
    "check upload stop start_previous doctor_identify live start monitor show_port set_name "
    "set_trim set_owner set_owner_give_up set_text set_wifi doctor_selftest"
)
VERBS_WITHOUT_ROBOT = (
    "doctor_ports stop monitor_hold start monitor show_port set_name set_trim start_previous "
    "set_owner set_owner_give_up set_text set_wifi doctor_identify"
)

# fmt: off
OPTIONS: tuple[Option, ...] = (
    # arguments
    Option("action", "lesson", LESSON_ACTION, "ACTION"),
    Option("number", "lesson", TEXT, "N"),
    Option("program", "lesson", PROGRAM, "PROGRAM"),
    Option("action", "class", CLASS_ACTION, "ACTION"),
    Option("program", "class", PROGRAM, "PROGRAM"),
    Option("program", "compile run show fmt upload", PROGRAM, "PROGRAM"),
    Option("programs", "check", PROGRAM, "PROGRAM", repeats=True),
    Option("line", "live", TEXT, "LINE"),
    Option("what", "set", SETTING, "SETTING"),
    Option("name", "set_name", TEXT, "NEW"),
    Option("whether", "set_text", ON_OFF, "on|off"),
    Option("network", "set_wifi", TEXT, "NETWORK"),
    Option("about", "help", VERB, "COMMAND", repeats=True),
    Option("words", "help_completion", TEXT, A_TEXT, repeats=True, silent_verbs="help_completion"),
    # Options that choose a step of a verb.
    Option("--explain", "check_explain", CODE, "CODE", "code", may_be_alone=True),
    Option("--previous", "start_previous"),
    Option("--hold", "monitor_hold"),
    Option("--ports", "doctor_ports", dest="is_about_ports"),
    Option("--identify", "doctor_identify"),
    Option("--selftest", "doctor_selftest"),
    Option("--module", "doctor_module"),
    Option("--conform", "doctor_conform"),
    Option("--wiring", "firmware_wiring"),
    Option("--board", "firmware_board", ROBOT, A_ROBOT, "robot"),
    Option("--give-up", "set_owner_give_up"),
    Option("--list", "set_owner_list"),
    Option("--completion", "help_completion", SHELL, "|".join(SHELL.choices), "shell"),
    # the program
    Option("-e", "compile check run show fmt upload lesson class", TEXT, A_TEXT, "texts", repeats=True),
    Option("-e", "live", TEXT, A_TEXT, "text"),
    Option("--keys", "live"),
    # files
    Option("-o", "compile", IMAGE, A_FILE, "output"),
    Option("--text", "compile"),
    Option("--text-level", "check", LEVEL, A_LEVEL),
    Option("--text-level", "compile", LEVEL, A_LEVEL),
    Option("-o", "firmware_wiring", IMAGE, "PAGE.html", "output"),
    Option("-o", "firmware_board", IMAGE, A_FILE, "output"),
    Option("-o", "show_port", IMAGE, A_FILE, "output"),
    Option("-o", "lesson", IMAGE, "PAGE.html", "output"),
    Option("--arduino", "show"),
    Option("-o", "show", IMAGE, "SKETCH.ino", "output"),
    Option("--map", "compile", MAP, A_FILE),
    Option("--check", "fmt"),
    Option("--fix", "check"),
    Option("--diff --dry-run", "check", dest="diff"),
    Option("--csv", "check", ROWS, A_FILE),
    # a run
    Option("--sensor", "run", SENSOR, READINGS, repeats=True),
    Option("--max-time", "run", NUMBER, S),
    Option("--max-steps", "run", NUMBER, N),
    Option("--seed", "run", NUMBER, N),
    Option("--show", "run"),
    Option("--pace", "run", NUMBER, N),
    Option("--machine", "run", MACHINE, "python|cpp"),
    Option("--record", "run", RECORDING, A_FILE),
    Option("--world", "run", WORLD, A_ROBOT),
    # Options for another machine or robot.
    Option("--machine", "doctor_conform", TEXT, "COMMAND"),
    Option("--only", "doctor_conform", TEXT, A_TEXT),
    Option("--timeout", "doctor_conform", NUMBER, S),
    # a lesson
    Option("--teacher", "lesson"),
    Option("--seed", "lesson", NUMBER, N),
    Option("--csv", "lesson", ROWS, A_FILE),
    Option("--plot", "lesson", PICTURE, "F.png"),
    # the firmware
    Option("--port", "firmware", PORT, P),
    Option("--chip", "firmware", CHIP, "CHIP"),
    Option("--breakpoints", "firmware"),
    Option("--build", "firmware"),
    Option("--list", "firmware"),
    # Options that change the action of a verb.
    Option("--broker", "class", TEXT, "HOST[:PORT]"),
    Option("--broker", "set_wifi", TEXT, "HOST[:PORT]"),
    Option("--class", "class set_wifi", TEXT, "NAME", "group"),
    Option("--user", "class set_wifi", TEXT, "NAME"),
    Option("--no-broker", "set_wifi"),
    Option("--tls", "set_wifi"),
    Option("--trust", "set_wifi", TRUST, A_FILE),
    Option("--tls", "class"),
    Option("--trust", "class", TRUST, A_FILE),
    Option("--no-run", "upload class"),
    Option("--no-save", "upload class"),
    Option("--detach", "upload start class"),
    Option("--record", "upload", RECORDING, A_FILE),
    Option("--break", "upload", NUMBER, N, "breaks", repeats=True),
    Option("--break", "live", NUMBER, N, "breaks", repeats=True),
    Option("--verbose", "upload class"),
    Option("--ask", "doctor_ports"),
    Option("--count", "doctor", NUMBER, N),
    Option("--plot", "monitor"),
    Option("--csv", "monitor", ROWS, A_FILE),
    Option("--csv", "class", ROWS, A_FILE),
    Option("--max-time", "monitor class", NUMBER, S),
    Option("--show", "set_trim"),
    Option("--reset", "set_trim"),
    Option("--exchange", "set_trim", YES_NO, YES_OR_NO),
    Option("--reverse-left", "set_trim", YES_NO, YES_OR_NO),
    Option("--reverse-right", "set_trim", YES_NO, YES_OR_NO),
    Option("--balance", "set_trim", NUMBER, N),
    Option("--least", "set_trim", NUMBER, N),
    Option("--speed-40", "set_trim", NUMBER, N),
    Option("--speed-80", "set_trim", NUMBER, N),
    Option("--turn-40", "set_trim", NUMBER, N),
    Option("--turn-80", "set_trim", NUMBER, N),
    Option("--teacher", "set_owner"),
    Option("--access-point", "set_wifi"),
    Option("--forget", "set_wifi"),
    Option("--teacher", "set_owner_give_up"),
    Option("--teacher", "stop class"),
    Option("--export", "set_owner_list", NEW_KEYS, A_FILE),
    Option("--import", "set_owner_list", KEYS, A_FILE, "bring"),
    Option("--forget", "set_owner_list", TEXT, "ROBOT"),
    Option("--accept", "set_owner_list", TEXT, "ID"),
    Option("--name", "robot", TEXT, "NAME"),
    Option("--listen", "robot", NUMBER, P),
    Option("--listen", "studio", NUMBER, P),
    Option("--class", "studio", dest="is_class"),
    Option("--address", "studio", TEXT, "IP"),
    Option("--port", "studio", PORT, P, "ports", repeats=True),
    Option("--turn", "studio", NUMBER, N),
    Option("--no-browser", "studio"),
    Option("--announce", "robot"),
    Option("--pty", "robot"),
    Option("--memory", "robot", MEMORY, A_FILE),
    Option("--button-at", "robot", NUMBER, S),
    Option("--hold-at", "robot", NUMBER, S),
    Option("--yes", "doctor"),
    Option("--yes", "doctor_selftest"),
    Option("--yes", "studio firmware"),
    Option("--watch", "doctor", NUMBER, S),
    Option("--report", "doctor", REPORT, A_FILE),
    Option("--port", "doctor_module", PORT, P),
    Option("--name", "doctor_module", TEXT, "NAME"),
    Option("--id", "doctor_module", TEXT, "ID"),
    Option("--pin", "doctor_module", TEXT, "PIN"),
    Option("--baud", "doctor_module", NUMBER, N),
    Option("--dry-run", "doctor_module"),
    # the robot, and the way to it
    Option("--report", "doctor_selftest", REPORT, A_FILE),
    Option("--port", "doctor_conform", PORT, P),
    Option("--port", "doctor", PORT, P, "ports", repeats=True),
    Option("--port", "check", PORT, P),
    Option("--port", "doctor_ports", PORT, P),
    Option("--port", ONE_ROBOT_VERBS, PORT, P),
    Option("--port", "start_previous doctor_identify", PORT, P, "ports", repeats=True),
    Option("--port", "upload", PORT, P, "ports", repeats=True),
    Option("--port", "stop", PORT, P, "ports", repeats=True),
    Option("--all", "doctor doctor_identify"),
    Option("--all", "upload start_previous"),
    Option("--all", "stop"),
    Option("--baud", "doctor", NUMBER, N),
    Option("--baud", f"check {ONE_ROBOT_VERBS} upload stop start_previous doctor_identify", NUMBER, N, silent_verbs=VERBS_WITHOUT_BAUD),
    Option("--baud", "doctor_conform", NUMBER, N),
    Option("--baud", "doctor_ports", NUMBER, N, silent_verbs="doctor_ports"),
    Option("--baud", "robot", NUMBER, N),
    Option("--robot", "compile check run show fmt upload live class", ROBOT, A_ROBOT),
    Option("--robot", "firmware_wiring doctor_ports stop monitor_hold start monitor show_port set_name set_trim start_previous set_owner set_owner_give_up set_text set_wifi doctor_identify robot", ROBOT, A_ROBOT, silent_verbs=VERBS_WITHOUT_ROBOT),
    Option("--robot", "doctor_selftest doctor", ROBOT, A_ROBOT),
    Option("--robot", "firmware", ROBOT, A_ROBOT),
    Option("--virtual", "check"),
    Option("--virtual", "doctor monitor_hold start monitor show_port set_name set_trim start_previous set_owner set_owner_give_up set_text set_wifi doctor_identify doctor_selftest", silent_verbs="monitor_hold set_owner_give_up set_text doctor_identify"),
    Option("--virtual", "stop"),
    Option("--virtual", "upload"),
    Option("--virtual", "live"),
    # Options that change the output.
    Option("--json", "check show lesson doctor_ports set_owner_list doctor doctor_selftest doctor_conform", silent_verbs="set_owner_list"),
    Option("--json", "upload class"),
    Option("--json", "start_previous", silent_verbs="start_previous"),
    Option("--json", "stop doctor_identify", silent_verbs="doctor_identify"),
    Option("--json", "monitor_hold start monitor", silent_verbs="monitor_hold"),
    Option("--json", "set_trim", silent_verbs="set_trim"),
    # a virtual robot of one's own
    Option("--world", VIRTUAL_ROBOT_VERBS, WORLD, A_ROBOT, is_virtual=True),
    Option("--plot", VIRTUAL_ROBOT_VERBS, PICTURE, "F.png", is_virtual=True, silent_verbs="live"),
    Option("--for", VIRTUAL_ROBOT_VERBS, NUMBER, S, is_virtual=True, silent_verbs="live"),
    Option("--hurry", VIRTUAL_ROBOT_VERBS, HURRY, "N|max", is_virtual=True),
    Option("--sensor", VIRTUAL_ROBOT_VERBS, SENSOR, READINGS, repeats=True, is_virtual=True, silent_verbs="live"),
    Option("--noise", VIRTUAL_ROBOT_VERBS, NUMBER, X, is_virtual=True, silent_verbs="live"),
    Option("--motors", VIRTUAL_ROBOT_VERBS, NUMBER, "L,R", is_virtual=True, silent_verbs="live"),
    Option("--faults", VIRTUAL_ROBOT_VERBS, NUMBER, X, is_virtual=True, silent_verbs="live"),
    Option("--seed", VIRTUAL_ROBOT_VERBS, NUMBER, N, is_virtual=True, silent_verbs="live"),
    # every verb
    Option("--lang", "*", LANGUAGE, "|".join(LANGUAGE.choices)),
    Option("-h --help", "*"),
    Option("-V --version", "tsc"),
)
# fmt: on


def options_of(verb: str) -> list[Option]:
    """Return the options of a command, or of `tsc` itself, in the order of help."""
    return [option for option in OPTIONS if option.applies_to(verb)]


def selecting_options_of(command: str) -> list[Option]:
    """Return the options that make another command of this one."""
    return [
        option
        for name in steps_of(command)
        for option in options_of(name)
        if STEPS[name].head == command_words(command)
        and option.flags in STEPS[name].selecting_flags
    ]


def command_of(verb: str, words: list[str]) -> tuple[str, list[str]]:
    """Return the command that a verb and its words mean, and the remaining words.

    Without a step, this is the verb itself.
    """
    own_words = words[: words.index("--")] if "--" in words else words
    flags = {word.partition("=")[0] for word in own_words if word.startswith("-")}
    word_index = first_word(verb, own_words)
    verb_and_word = f"{verb} {words[word_index]}" if word_index is not None else verb
    fitting_steps = [name for name in steps_of(verb) if STEPS[name].head in (verb, verb_and_word)]
    command = next((name for name in fitting_steps if flags & {*STEPS[name].selecting_flags}), None)
    command = command or next(
        (name for name in fitting_steps if STEPS[name].command_text == verb_and_word), verb
    )
    if command == verb or STEPS[command].head == verb:
        return command, words
    return command, [word for k, word in enumerate(words) if k != word_index]


def first_word(verb: str, words: list[str]) -> int | None:
    """Return the index of the first word that is neither an option nor an option's value."""
    commands = (verb, *steps_of(verb))
    flags_with_value = {flag for command in commands for option in options_of(command)
              if option.kind is not None for flag in option.flags.split()}  # fmt: skip
    is_option_value = False
    for k, word in enumerate(words):
        if not is_option_value and not word.startswith("-"):
            return k
        is_option_value = not is_option_value and word in flags_with_value
    return None


def shown_of(verb: str) -> list[Option]:
    """Return the options of a verb, or of `tsc` itself, that help and documents show."""
    return [option for option in options_of(verb) if verb not in option.silent_verbs.split()]


def virtual_names() -> list[str]:
    """Return the names in the code of the options for a virtual robot of the command."""
    return [option.name for option in OPTIONS if option.is_virtual]
