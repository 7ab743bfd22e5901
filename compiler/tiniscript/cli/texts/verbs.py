"""The verbs of `tsc`, in the order in which help has them, and what the catalogue `help` says of them.

Parsers, help, completion and the documents are made from it and from the table in `options.py`.
What is typed stands between backticks: documents show it as code, and on a terminal no line ends
in it.
"""

from tiniscript.base import languages

# A verb is a module of `cli/commands/`. Beside it is the heading below which help has it; where its
# example stands beside that of another verb, that verb.
VERBS: dict[str, str] = {
    "studio": "programs",
    "lesson": "programs",
    "check": "programs",
    "run": "programs",
    "compile": "programs",
    "show": "programs",
    "fmt": "programs",
    "explain": "programs",
    "upload": "robots",
    "live": "robots",
    "stop": "robots",
    "start": "robots",
    "undo": "start",
    "monitor": "robots",
    "fetch": "robots",
    "robot": "robots",
    "link": "robots",
    "class": "robots",
    "doctor": "trouble",
    "selftest": "doctor",
    "ports": "trouble",
    "info": "trouble",
    "ping": "info",
    "identify": "trouble",
    "claim": "settings",
    "disown": "claim",
    "keys": "claim",
    "name": "settings",
    "trim": "settings",
    "text": "settings",
    "wifi": "settings",
    "firmware": "building",
    "wiring": "building",
    "board": "building",
    "module": "building",
    "conform": "building",
    "help": "itself",
    "completion": "itself",
}
FIRST = (
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


def said(key: str, language: str) -> str:
    """Return a text of the catalogue, which may have none."""
    return languages.found("help", key, language) or ""


def of_verb(verb: str, what: str, language: str) -> str:
    """Return what is said of a verb.

    `example` is a command with it, the verb alone where it is not there, `summary` what that does,
    `says` what the verb does, `ends` what else there is to know. Where it is used in several ways,
    `usage` has a line for each.
    """
    return said(f"verb/{verb}/{what}", language) or verb * (what == "example")
