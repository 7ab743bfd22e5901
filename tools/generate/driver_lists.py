"""The lists of drivers in `robots/tinibot.toml`, the profile that people copy."""

from __future__ import annotations

import re
from pathlib import Path
from textwrap import wrap

from tiniscript.robots.drivers import DRIVERS

# The end of the line above each list, by the use of its drivers.
LINE_ENDS = {
    "motors": "Drivers of motors:",
    "discs": "tinibot2.toml has some.",
    "sensors number": "Drivers of sensors that are numbers:",
    "sensors yes/no": "Drivers of sensors that are yes/no:",
    "actuators number": "Drivers of actuators that are numbers, [board.actuators.NAME]:",
    "actuators yes/no": "Drivers of actuators that are yes/no:",
}
NAME_WIDTH, ROW_WIDTH = 12, 96


def with_drivers(profile: Path) -> str:
    """Return the text of a profile with each driver's description of its keys."""
    text = profile.read_text(encoding="utf-8")
    for used_by, line_end in LINE_ENDS.items():
        rows = "".join(
            _row(driver.name, driver.profile_help)
            for driver in DRIVERS.values()
            if driver.used_by == used_by
        )
        text_above, end_line, text_below = text.partition(f"{line_end}\n")
        assert end_line, f"{profile.name} has no line that ends with {line_end}"
        text = text_above + end_line + rows + re.sub(r"^(#   .*\n)*", "", text_below)
    return text


def _row(name: str, keys: str) -> str:
    """Return `#   hc_sr04     trigger, echo; in cm`, on as many lines as it needs."""
    first_indent = f"#   {name:{NAME_WIDTH}}"
    other_indent = "#".ljust(len(first_indent))
    rows = wrap(keys, ROW_WIDTH, initial_indent=first_indent, subsequent_indent=other_indent)
    return "".join(f"{row}\n" for row in rows)
