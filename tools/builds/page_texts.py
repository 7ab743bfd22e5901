"""What the page says in a language, and the Python in it: from the catalogues."""

from __future__ import annotations

import re
from gettext import c2py
from typing import Any

from tiniscript.base.catalogue_compiler import merged
from tiniscript.base.languages import files

# Of what the page's Python says; the sentences of lessons come with these.
MESSAGES = ("messages", "statuses", "refusals", "library", "robot", "names")
# What the page says as the command does: how a recording compares, and why a run has ended.
OF_COMMAND = {
    **{f"record_{what}": f"replay_{what}" for what in (
        "same", "missed", "empty", "value", "time", "robot_more", "virtual_more", "end", "at",
    )},
    **{key: key for key in (
        "fault_DIVIDE_BY_ZERO", "fault_NO_POWER", "fault_STUCK", "fault_STUCK_LEFT",
        "fault_STUCK_RIGHT", "stopped_NONE", "stopped_BUTTON", "stopped_TEXT", "stopped_CABLE",
    )},
    "stopped_SEQUENCE": "robot_stopped", "stopped_MESSAGE": "robot_stopped",
    "robot_stopped": "stopped", "say_done": "robot_done", "line": "replay_line",
    "class_free": "whose_free",
}  # fmt: skip
PERIOD = 100  # after so many numbers a rule of plurals repeats itself, but for the first hundred


def page_texts(language: str) -> dict[str, str | list[str]]:
    """Return the page's texts by key; of one with a plural, its forms.

    The one without a key has which form is for which number, from 0 to 199.
    """
    head, found = _texts("studio", language)
    _, said = _texts("command", language)
    found |= {key: said[each] for key, each in OF_COMMAND.items()}
    rule = re.search(r"plural=([^;\n]+)", head)
    form = c2py(rule[1] if rule else "0")
    return {
        "": "".join(str(form(number)) for number in range(2 * PERIOD)),
        **{key: forms if len(forms) > 1 else forms[0] for key, forms in found.items()},
    }


def messages(language: str) -> dict[str, dict[str, Any]]:
    """Return what `tiniscript.studio.worker` learns, by catalogue."""
    found = {name: _texts(name, language) for name in MESSAGES}
    return {name: {"": head, **texts} for name, (head, texts) in found.items()}


def _texts(name: str, language: str) -> tuple[str, dict[str, list[str]]]:
    return merged(*files(name, language))
