"""A fault of a program, for a person: what it means, and its line in the text."""

from __future__ import annotations

from tiniscript.cli.inputs import printable_name
from tiniscript.cli.texts import text
from tiniscript.library.source_map import Map


def fault_text(fault: str, offset: int, places: Map | None, is_image: bool, language: str) -> str:
    """Return the meaning of a fault, and its line in the text.

    For an image this is the text that was last compiled to it; its name is added.
    """
    place = places.at(offset) if places is not None else None
    if places is None or place is None:
        where = text("fault_no_line", language).format(offset=f"{offset:04x}")
    else:
        line = places.line(place.line)
        end = place.end_column - 1 if place.end_line == place.line else len(line)
        piece = line[place.column - 1 : end] if len(line) > 100 else line.strip()
        piece = piece.replace("\t", " ")
        key = "fault_line_of" if is_image else "fault_line"
        name = printable_name(places.name)
        task = _task_text(places.task_of(place), language)
        where = text(key, language).format(name=name, line=place.line, task=task, shown=piece[:100])
    meaning = text(f"fault_{fault}", language)
    return text("fault_at", language).format(fault=fault, what=meaning, place=where)


def _task_text(task: tuple[str, int] | None, language: str) -> str:
    """Return which task it was, with a comma before it; nothing where that is not known."""
    if task is None:
        return ""
    word, line = task
    key = "fault_in_task" if word else "fault_in_main"
    return text(key, language).format(word=word, line=line)
