"""What may be wrong with a port: a name for each, without sentences."""

from __future__ import annotations

MISSING, FORBIDDEN, BUSY = "missing", "forbidden", "busy"
UNREACHABLE, NO_PORT, SLOW, BROKEN = "unreachable", "no_port", "slow", "broken"
# of `ble://` and `tcp://`: the package that is missing, Bluetooth of this computer, the network
NOT_INSTALLED = "not_installed"
RADIO_OFF, RADIO_FORBIDDEN = "radio_off", "radio_forbidden"
RADIO_SERVICE, RADIO_BROKEN = "radio_service", "radio_broken"
NO_MULTICAST, NOT_ANNOUNCED, STRANGE = "no_multicast", "not_announced", "strange"
# nobody has the name, several have it, whoever has it is no robot
NOT_FOUND, SEVERAL, NO_ROBOT = "not_found", "several", "no_robot"
# of a broker: it does not let us in, its certificate is not trusted, another client has the robot
REFUSED, UNTRUSTED, TAKEN = "refused", "untrusted", "taken"


class PortError(Exception):
    """A port that cannot be used: `reason` is a name from above, `detail` the system's message."""

    def __init__(self, reason: str, detail: str = "") -> None:
        super().__init__(reason)
        self.reason = reason
        self.detail = detail
