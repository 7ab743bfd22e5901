"""The commands of `tsc`, in the order of help, and their descriptions in the catalogue `help`.

A command is a verb, or a step of one, which more words choose: `tsc doctor --ports`. Parsers, help,
completion and the documents are made from it and from the table in `options.py`. Text to type is
between backticks: documents show it as code, and a terminal never breaks a line in it.
"""

from typing import NamedTuple

from tiniscript.base import languages

# A verb, and the heading below which help has it.
VERBS: dict[str, str] = {
    "studio": "programs",
    "lesson": "programs",
    "check": "programs",
    "run": "programs",
    "compile": "programs",
    "show": "programs",
    "fmt": "programs",
    "upload": "robots",
    "live": "robots",
    "start": "robots",
    "stop": "robots",
    "monitor": "robots",
    "robot": "robots",
    "class": "robots",
    "doctor": "trouble",
    "firmware": "building",
    "set": "settings",
    "help": "itself",
}


class Step(NamedTuple):
    """A step of a verb, which follows it: `tsc doctor --ports`.

    `command_text` is that command; the last of its flags chooses the step, and so do `flags`.
    """

    command_text: str
    flags: str = ""

    @property
    def head(self) -> str:
        """The words that come first, without a flag: `set owner`."""
        return self.command_text.partition(" -")[0]

    @property
    def selecting_flags(self) -> list[str]:
        """The flags that select a step; empty if words do."""
        own_flags = [word for word in self.command_text.split() if word.startswith("-")]
        return [*own_flags, *self.flags.split()]


# Each command is a module of `cli/commands/`, for a verb or a step of one, named as it is typed.
STEPS: dict[str, Step] = {
    "check_explain": Step("check --explain"),
    "show_port": Step("show --port", "--virtual"),
    "start_previous": Step("start --previous"),
    "monitor_hold": Step("monitor --hold"),
    "doctor_ports": Step("doctor --ports"),
    "doctor_identify": Step("doctor --identify"),
    "doctor_selftest": Step("doctor --selftest"),
    "doctor_module": Step("doctor --module"),
    "doctor_conform": Step("doctor --conform"),
    "firmware_wiring": Step("firmware --wiring"),
    "firmware_board": Step("firmware --board"),
    "set_owner": Step("set owner"),
    "set_owner_give_up": Step("set owner --give-up"),
    "set_owner_list": Step("set owner --list", "--export --import --forget --accept"),
    "set_name": Step("set name"),
    "set_trim": Step("set trim"),
    "set_text": Step("set text"),
    "set_wifi": Step("set wifi"),
    "help_completion": Step("help --completion"),
}
COMMANDS = (*VERBS, *STEPS)
# Verbs from before 0.3, with the commands that replace them; no current verb has such a name.
FORMER_COMMANDS = {
    "explain": "check_explain",
    "fetch": "show_port",
    "undo": "start_previous",
    "ports": "doctor_ports",
    "identify": "doctor_identify",
    "selftest": "doctor_selftest",
    "module": "doctor_module",
    "conform": "doctor_conform",
    "wiring": "firmware_wiring",
    "board": "firmware_board",
    "claim": "set_owner",
    "disown": "set_owner_give_up",
    "keys": "set_owner_list",
    "name": "set_name",
    "trim": "set_trim",
    "text": "set_text",
    "wifi": "set_wifi",
    "completion": "help_completion",
    "link": "monitor_hold",
    "info": "doctor",
    "ping": "doctor",
}
FIRST_COMMANDS = (
    "studio",
    "lesson",
    "check",
    "run",
    "compile",
    "upload",
    "live",
    "stop",
    "firmware",
    "doctor",
)
NOTES = ("note/program", "note/exit")


def verb_text(key: str, language: str) -> str:
    """Return a text of the catalogue, which may have none."""
    return languages.find_text("help", key, language) or ""


def command_words(command: str) -> str:
    """Return the words after `tsc` for a command: `doctor --ports`."""
    return STEPS[command].command_text if command in STEPS else command


def steps_of(command: str) -> list[str]:
    """Return the commands that begin with a command: the steps of a verb, or `set owner --list`."""
    prefix = f"{command_words(command)} "
    return [
        name
        for name, step in STEPS.items()
        if name != command and f"{step.head} ".startswith(prefix)
    ]


def settings() -> tuple[str, ...]:
    """Return the words that `tsc set` takes."""
    words = (step.head.split()[-1] for step in STEPS.values() if step.head.startswith("set "))
    return tuple(dict.fromkeys(words))


def verb_sentence(verb: str, part: str, language: str) -> str:
    """Return a sentence about a command.

    `example` is a command line, `summary` what it does, `says` what the command does, `ends`
    further information. If there are several ways to use it, `usage` has a line for each.
    """
    return verb_text(f"verb/{verb}/{part}", language) or command_words(verb) * (part == "example")
