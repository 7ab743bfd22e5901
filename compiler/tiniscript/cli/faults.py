"""A fault of a program, for a person: its meaning, and its line in the text."""

from __future__ import annotations

from tiniscript.cli.inputs import printable_name
from tiniscript.cli.texts import text
from tiniscript.library.source_map import SourceMap


def fault_text(
    fault: str, offset: int, program_map: SourceMap | None, is_image: bool, language: str
) -> str:
    """Return the meaning of a fault, and its line in the text.

    For an image this is the text that was last compiled to it; its name is added.
    """
    location = program_map.location_at(offset) if program_map is not None else None
    if program_map is None or location is None:
        place_text = text("fault_no_line", language).format(offset=f"{offset:04x}")
    else:
        line = program_map.line(location.line)
        end = location.end_column - 1 if location.end_line == location.line else len(line)
        excerpt = line[location.column - 1 : end] if len(line) > 100 else line.strip()
        excerpt = excerpt.replace("\t", " ")
        key = "fault_line_of" if is_image else "fault_line"
        name = printable_name(program_map.name)
        task = _task_text(program_map.task_of(location), language)
        place_text = text(key, language).format(
            name=name, line=location.line, task=task, shown=excerpt[:100]
        )
    meaning = text(f"fault_{fault}", language)
    return text("fault_at", language).format(fault=fault, what=meaning, place=place_text)


def _task_text(task: tuple[str, int] | None, language: str) -> str:
    """Return the name of the faulty task after a comma, or "" if it is unknown."""
    if task is None:
        return ""
    word, line = task
    key = "fault_in_task" if word else "fault_in_main"
    return text(key, language).format(word=word, line=line)
