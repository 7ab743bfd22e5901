"""Robots that no system lists: in reach of Bluetooth LE, or announced in the network.

Connects to none of them. Where a search is impossible, says why.
"""

from __future__ import annotations

from typing import NamedTuple

from tiniscript.cli.robot.connect import port_failure
from tiniscript.cli.texts.common import text
from tiniscript.link import ports
from tiniscript.link.errors import PortError
from tiniscript.link.port_names import (
    BLE,
    TCP,
    canonical,
    is_bluetooth,
    is_network_name,
    name_in,
    same_for_all,
)


class InReach(NamedTuple):
    """`about` maps ports to descriptions; `others` are ports that mean one of these, too;
    `absent` are known ports without a robot; `notes` say what was not searched, and why."""

    about: dict[str, str]
    others: list[str]
    absent: list[str]
    notes: list[str]


def found(known: list[str], language: str) -> InReach:
    """Search for some seconds. A robot that is known by a port of `known` keeps it."""
    from concurrent.futures import ThreadPoolExecutor

    whole = InReach({}, [], [], [])
    reasons = set()  # where both packages are missing, one note says it
    with ThreadPoolExecutor(2) as pool:
        searches = [(kind, pool.submit(search, known, language))
                    for kind, search in ((BLE, _by_radio), (TCP, _by_name))]  # fmt: skip
        for kind, search in searches:
            try:
                part = search.result()
            except PortError as failure:
                if failure.reason not in reasons:
                    whole.notes.append(port_failure(kind, failure).sentence(language))
                reasons.add(failure.reason)
                continue
            whole.about.update(part.about)
            whole.others.extend(part.others)
            whole.absent.extend(part.absent)
    return whole


def _by_radio(known: list[str], language: str) -> InReach:
    seen = ports.in_reach()
    names = [canonical(each.name) for each in seen]
    rows = []
    for each, name in zip(seen, names, strict=True):
        said = text("radio_port", language)
        said = f"{each.name}, {said}" if each.name else said
        means = {canonical(each.address)} | ({name} if names.count(name) == 1 else set())
        rows.append((BLE + each.address, {BLE + each for each in means}, said))
    ours = {port: BLE + name_in(port) for port in known if is_bluetooth(port)}
    return _rows(rows, ours)


def _by_name(known: list[str], language: str) -> InReach:
    there = ports.announced()
    rows = []
    for each in there:
        name = TCP + each.name if each.name.isprintable() else each.port
        said = text("announced_port", language).format(port=each.port)
        rows.append((name, {same_for_all(name), same_for_all(each.port)}, said))
    ours = {port: same_for_all(port) for port in known if is_network_name(port)}
    found = _rows(rows, ours)
    found.others.extend(each.port for each in there if each.port not in found.about)
    return found


def _rows(rows: list[tuple[str, set[str], str]], ours: dict[str, str]) -> InReach:
    """Name each robot by the port that the user knows: `rows` have a port, all that mean it, and a
    description; `ours` maps known ports to what they mean."""
    found = InReach({}, [], list(ours), [])
    for port, means, said in rows:
        known = [each for each, meant in ours.items() if meant in means]
        found.about[known[0] if known else port] = said
        found.others.extend(known[1:])
        for each in known:
            found.absent.remove(each)
    return found
