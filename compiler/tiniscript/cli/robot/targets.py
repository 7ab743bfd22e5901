"""Which ports a verb works on that takes many: `--all`, or several `--port`."""

from __future__ import annotations

from argparse import Namespace
from typing import NamedTuple

from tiniscript.cli.errors import Trouble
from tiniscript.cli.inputs import shown
from tiniscript.cli.options import Options


class Post(NamedTuple):
    """A port, and what the robot there was called. `is_named`: a person has named the port;
    `is_known`: a robot has answered there before."""

    port: str
    name: str
    is_named: bool
    is_known: bool


def takes_ports(parser: Options) -> None:
    """Add what a verb has that may work on many robots at once."""
    parser.add_argument("--port", dest="ports", action="append", default=[])
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--baud")
    parser.add_argument("--virtual", action="store_true")


def are_many(options: Namespace) -> bool:
    """Whether the options ask for many robots; where not, `port` is the one that they name."""
    options.port = options.ports[0] if options.ports else None
    if options.virtual and (options.all or options.ports):
        raise Trouble(2, "virtual_and_port")
    if options.all and options.ports:
        raise Trouble(2, "all_or_ports", verb=options.verb)
    return bool(options.all) or len(options.ports) > 1


def posts(options: Namespace) -> list[Post]:
    """Return each port once: those that are named, else all on which a robot may be.

    Ports that are held come first, then those of robots that are known. None is opened.
    """
    from tiniscript.link import known_ports
    from tiniscript.link.port_names import is_there, same_for_all

    known = known_ports.known().names
    for port in options.ports:
        if not port.strip() or not port.isprintable():
            raise Trouble(2, "no_such_port", found=shown(port) or "''")
    ports = options.ports
    if options.all:
        from tiniscript.link.ports import listed
        from tiniscript.sharing.registry import all_found
        from tiniscript.virtual.directory import is_gone, running

        ports = [holder.port for holder in all_found()]
        ports += [port for port in known if is_there(port) and not is_gone(port)]
        ports += [found.port for found in listed()]
        ports += [robot.address for robot in running()]
    names = {same_for_all(port): name for port, name in reversed(known.items())}
    chosen = {same_for_all(port): port for port in reversed(ports)}
    return [
        Post(port, names.get(same, ""), not options.all, same in names)
        for same, port in reversed(chosen.items())
    ]
