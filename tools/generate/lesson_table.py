"""The table of criteria in `docs/lessons.en.md`: what each means, and which keys it takes."""

from __future__ import annotations

from tiniscript.lessons.lesson import AREA, KINDS, WHATS, Kind


def criteria() -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Return its head and its rows."""
    rows: list[tuple[str, ...]] = [
        (f"`{name}`", kind.meaning, ", ".join(_takes(kind))) for name, kind in KINDS.items()
    ]
    return ("criterion", "met if", "takes"), rows


def _takes(kind: Kind) -> list[str]:
    """Return the keys, with their defaults where these say something."""
    found = ["`at`"] if kind.places else []
    if kind.words:
        found.append("`what`" if kind.words in WHATS else "`words`")
    for each in kind.numbers:
        is_said = each.default is not None and each.default < each.high
        found.append(f"`{each.key}`" + (f" ({each.default:g})" if is_said else ""))
    found += [f"`{each}`" for each in (*kind.flags, *(AREA if kind.has_area else ()))]
    return found
