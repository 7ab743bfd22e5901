"""A robot's broker, as another command asks for it on a shared port: as it was, or refused."""

from __future__ import annotations

import json
from typing import Any

import pytest

from tiniscript.link.sharing.protocol import BadMessage
from tiniscript.link.sharing.requests import ClientRequests, asked_for
from tiniscript.link.wifi import BrokerSettings, Tls

PLAIN = BrokerSettings(bytes((192, 168, 1, 20)), 8883, "aula", b"robots", b"secret")
CLIENT: Any = ClientRequests()
NAMED = PLAIN._replace(name=b"broker.aula", tls=Tls(bytes(range(256)) * 8, 20261121))


class Session:
    """Keeps what it is asked for."""

    limit_ms = 0

    def use_broker(self, broker: BrokerSettings | None) -> Any:
        self.found = broker
        return self


def found(message: dict[str, Any]) -> BrokerSettings | None:
    session: Any = Session()
    asked_for(json.loads(json.dumps(message)), 1000)(session)
    answer: BrokerSettings | None = session.found
    return answer


@pytest.mark.parametrize("settings", [PLAIN, PLAIN._replace(name=b"x"), NAMED, None])
def test_it_comes_as_it_was_asked_for(settings: BrokerSettings | None) -> None:
    assert found(CLIENT.use_broker(settings).message) == settings


@pytest.mark.parametrize("other", [
    {"trust": ""}, {"trust": "00" * 2049}, {"trust": 1}, {"date": 0}, {"date": -1},
    {"date": True}, {"date": 1 << 32}, {"name": ""}, {"name": "00"}, {"name": "78" * 97},
    {"port": 0}, {"address": "7f"}, {"group": "a/b"},
])  # fmt: skip
def test_what_is_no_broker_is_refused(other: dict[str, Any]) -> None:
    message = dict(CLIENT.use_broker(NAMED).message)
    with pytest.raises(BadMessage):
        found({**message, **other})
