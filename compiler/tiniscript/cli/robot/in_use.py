"""Which robots are in use on this computer: on a port that a command holds, or virtual ones.

Opens no port and connects to no robot.
"""

from __future__ import annotations

from tiniscript.link import known_ports
from tiniscript.link.port_names import is_there, same_for_all
from tiniscript.link.sharing.registry import Registration, all_found
from tiniscript.link.sharing.shared_line import is_alive

AT_ONCE = 16  # servers that are checked at the same time


def ports(is_virtual: bool = False) -> list[str]:
    """Return the port of each robot that is in use, once; `is_virtual`: of virtual ones alone."""
    from tiniscript.virtual.directory import running

    held = _alive(all_found())
    found = [] if is_virtual else held[:]
    for robot in running():
        names = [robot.address, *([robot.terminal] if robot.terminal else [])]
        through = [port for port in names if same_for_all(port) in held]
        found.append(through[0] if through else robot.address)  # one robot, one port
    return list({same_for_all(port): port for port in found}.values())


def _alive(registrations: list[Registration]) -> list[str]:
    """Return the ports of the servers that still run; a hanging server delays no other check."""
    if len(registrations) < 2:  # importing threads takes longer than one answer
        return [registration.port for registration in registrations if is_alive(registration)]
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(AT_ONCE) as pool:
        alive = list(pool.map(is_alive, registrations))
    return [
        registration.port
        for registration, is_there in zip(registrations, alive, strict=True)
        if is_there
    ]


def to_stop(is_virtual: bool = False) -> list[str]:
    """Return the ports for `tsc stop` without `--port`.

    They include that of the last used robot, which may drive on without any command.
    """
    from tiniscript.virtual.directory import is_gone

    found = ports(is_virtual)
    last = known_ports.known().last
    if not is_virtual and last is not None and is_there(last) and not is_gone(last):
        found.append(last)
    return list({same_for_all(port): port for port in found}.values())
