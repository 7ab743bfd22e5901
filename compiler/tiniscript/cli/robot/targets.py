"""The ports of a verb that works on many robots: `--all`, or several `--port`."""

from __future__ import annotations

from argparse import Namespace
from typing import NamedTuple

from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import shown


class Target(NamedTuple):
    """A port and the last known name of its robot. `is_named`: the user has named the port;
    `is_known`: a robot has answered there before."""

    port: str
    name: str
    is_named: bool
    is_known: bool


def are_many(options: Namespace) -> bool:
    """Whether the options name many robots; if not, `port` becomes the only port."""
    options.port = options.ports[0] if options.ports else None
    if options.virtual and (options.all or options.ports):
        raise CommandError(2, "virtual_and_port")
    if options.all and options.ports:
        raise CommandError(2, "all_or_ports", verb=options.verb)
    return bool(options.all) or len(options.ports) > 1 or options.verb == "class"


def targets(options: Namespace) -> list[Target]:
    """Return each port once: the named ones, else all that may have a robot.

    Ports in use come first, then ports of known robots. Opens none.
    """
    from tiniscript.link import known_ports
    from tiniscript.link.port_names import is_there, same_for_all

    known = known_ports.known().names
    for port in options.ports:
        if not port.strip() or not port.isprintable():
            raise CommandError(2, "no_such_port", found=shown(port) or "''")
    ports = options.ports
    if options.all:
        from tiniscript.link.ports import listed
        from tiniscript.link.sharing.registry import all_found
        from tiniscript.virtual.directory import is_gone, running

        ports = [registration.port for registration in all_found()]
        ports += [port for port in known if is_there(port) and not is_gone(port)]
        ports += [found.port for found in listed()]
        ports += [robot.address for robot in running()]
    names = {same_for_all(port): name for port, name in reversed(known.items())}
    chosen = {same_for_all(port): port for port in reversed(ports)}
    return [
        Target(port, names.get(same, ""), not options.all, same in names)
        for same, port in reversed(chosen.items())
    ]
