"""Names of the problems with a port, without sentences."""

from __future__ import annotations

MISSING, FORBIDDEN, BUSY = "missing", "forbidden", "busy"
UNREACHABLE, NO_PORT, SLOW, BROKEN = "unreachable", "no_port", "slow", "broken"
# Errors of `ble://` and `tcp://`: a missing package, Bluetooth of this computer, the network.
NOT_INSTALLED = "not_installed"
RADIO_OFF, RADIO_FORBIDDEN = "radio_off", "radio_forbidden"
RADIO_SERVICE, RADIO_BROKEN = "radio_service", "radio_broken"
NO_MULTICAST, NOT_ANNOUNCED, STRANGE = "no_multicast", "not_announced", "strange"
# Errors of a search: no robot has the name, several have it, or its owner is no robot.
NOT_FOUND, SEVERAL, NO_ROBOT = "not_found", "several", "no_robot"
# Errors of a broker: it refuses us, its certificate is not trusted, another client has the robot.
REFUSED, UNTRUSTED, TAKEN = "refused", "untrusted", "taken"


class PortError(Exception):
    """A port that cannot be used: `reason` is a name from above, `detail` the system's message."""

    def __init__(self, reason: str, detail: str = "") -> None:
        super().__init__(reason)
        self.reason = reason
        self.detail = detail
