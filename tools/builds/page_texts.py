"""The texts of the page in a language, and of its Python: from the catalogues."""

from __future__ import annotations

from tiniscript.base.languages import Texts, language_info, read_language_file, text, texts
from tiniscript.base.words import WORDS
from tiniscript.robots import load, names

# Texts of the page's Python; those of lessons come with them.
CATALOGUES = ("messages", "statuses", "refusals", "library", "robot", "names", "foreign")
# Texts shared with the command: comparisons of recordings, and the reasons of a run's end.
COMMAND_TEXTS = {
    **{f"record_{what}": f"replay_{what}" for what in (
        "again", "otherwise", "same", "missed", "unread", "empty", "value", "time", "robot_more",
        "virtual_more", "end", "at", "nothing",
    )},
    **{key: key for key in (
        "fault_DIVIDE_BY_ZERO", "fault_NO_POWER", "fault_STUCK", "fault_STUCK_LEFT",
        "fault_STUCK_RIGHT", "stopped_NONE", "stopped_BUTTON", "stopped_TEXT", "stopped_CABLE",
    )},
    "stopped_SEQUENCE": "robot_stopped", "stopped_MESSAGE": "robot_stopped",
    "robot_stopped": "stopped", "say_done": "robot_done", "line": "replay_line",
    "class_free": "whose_free",
}  # fmt: skip


def search_words(language: str) -> dict[str, str]:
    """Return the search words of blocks: those of the lexicon, by their meaning.

    The key is a word of the text, or `turn` for those of them that turn.
    """
    wanted_names = {
        "turn",
        *WORDS,
        *(kit_name for name in names() for kit_name in load(name).kit.names),
    }
    result: dict[str, str] = {}
    for row in read_language_file(language, "lexicon.txt").split("\n"):
        meaning, bar, words = (part.strip() for part in row.partition("|"))
        if bar and meaning in wanted_names:
            result[f"words/{meaning}"] = words.lower().replace("_", " ")
    return result


def page_texts(language: str) -> dict[str, str | list[str]]:
    """Return the page's texts by key; of one with a plural, its forms.

    The one without a key has which form is for which number, from 0 to 199.
    """
    info = language_info(language)
    command_texts = texts("command", language)
    all_texts = texts("studio", language) | {
        key: command_texts[value] for key, value in COMMAND_TEXTS.items()
    }
    return {
        "": info.form_digits,
        "new_word": text("lessons", "new_word", language),
        **search_words(language),
        **{
            key: value if isinstance(value, str)
            else [value.get(form, value["other"]) for form in info.forms]
            for key, value in all_texts.items()
        },
    }  # fmt: skip


def messages(language: str) -> dict[str, Texts]:
    """Return the messages for `tiniscript.studio.worker`, by catalogue."""
    return {name: texts(name, language) for name in CATALOGUES}
