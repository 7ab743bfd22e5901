"""Lets programs of this computer find a virtual robot by its name, with multicast DNS.

The announcement stays on 127.0.0.1, as the robot does: in a room of many computers nobody hears of
the robots of the others. Knows zeroconf; importing this fails without it.
"""

from __future__ import annotations

from ipaddress import ip_address

from zeroconf import Error, NonUniqueNameException, ServiceInfo, Zeroconf

from tiniscript.link.port_names import TCP
from tiniscript.link.transports.network import MAX_NAME_BYTES, SERVICE, query_service
from tiniscript.virtual.directory import LOCAL_HOST

ASK_TIMEOUT_MS = (
    2500  # timeout for the owner of the name, which may not repeat itself within a second
)


class NameTaken(Exception):
    """Another robot has the name, or nothing can have it."""


class Announcement:
    """Says where a robot is until `close`; `port` is its name as a port."""

    def __init__(self, name: str, tcp_port: int) -> None:
        """`tcp_port` is the robot's TCP port. Raises NameTaken, and OSError without multicast."""
        if not 0 < len(name.encode()) <= MAX_NAME_BYTES:
            raise NameTaken
        self.port = TCP + name
        self._network = Zeroconf(interfaces=[LOCAL_HOST])
        try:
            info = ServiceInfo(
                SERVICE, f"{name}.{SERVICE}", tcp_port,
                addresses=[ip_address(LOCAL_HOST).packed], server=f"tini-{tcp_port}.local.",
            )  # fmt: skip
            # two programs of one computer may miss each other's answers while they register
            if query_service(self._network, info.name, ASK_TIMEOUT_MS) is not None:
                raise NonUniqueNameException
            self._network.register_service(info)
        except Error:
            self._network.close()
            raise NameTaken from None
        except BaseException:
            self._network.close()
            raise

    def close(self) -> None:
        """Announce that the robot is gone."""
        self._network.close()
