"""What the page calls: requests and answers are JSON.

Knows the form of both. Runs in Pyodide, in a worker; knows nothing of a browser.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from tiniscript.diagnostics.rendering import Message
from tiniscript.studio import checking

if TYPE_CHECKING:
    from tiniscript.studio.simulation import Simulation

Answer = dict[str, Any]


def answer(request: str, data: bytes = b"") -> str:
    """Return the answer to a request; `data` is a program's text or file."""
    fields = json.loads(request)
    return json.dumps(_ASKED[fields["do"]](fields, data), ensure_ascii=False)


def _check(fields: Answer, data: bytes) -> Answer:
    found = checking.check(data, fields["robot"], fields["language"])
    return {
        "image": found.image.hex(),
        "bytes": found.code_bytes,
        "findings": [
            {**each.message._asdict(), "repair": [change._asdict() for change in each.repair]}
            for each in found.findings
        ],
        "places": found.places,
    }


def _open(fields: Answer, data: bytes) -> Answer:
    found = checking.opened(data, fields["robot"], fields["language"])
    if isinstance(found, Message):
        return {"message": found.message, "fix": found.fix}
    return {"text": found}


def _line(fields: Answer, data: bytes) -> Answer:
    found = checking.line(data, fields["robot"], fields["language"])
    if isinstance(found, Message):
        return {"message": found.message, "fix": found.fix}
    return {"text": found}


_simulation: Simulation | None = None  # a page has one robot


def _power_on(fields: Answer, data: bytes) -> Answer:
    from tiniscript.studio.simulation import Simulation

    global _simulation
    if _simulation is not None:
        _simulation.close()
    _simulation = Simulation(fields["robot"], fields["world"], data)
    return _simulation.state()


def _go(fields: Answer, data: bytes) -> Answer:
    assert _simulation is not None, "nothing is switched on"
    _simulation.go(fields["duration_ms"])
    return _simulation.state()


def _next(fields: Answer, data: bytes) -> Answer:
    assert _simulation is not None, "nothing is switched on"
    _simulation.go_to_next(fields["offsets"], fields["limit_ms"])
    return _simulation.state()


def _stop(fields: Answer, data: bytes) -> Answer:
    assert _simulation is not None, "nothing is switched on"
    _simulation.stop()
    return _simulation.state()


def _push(fields: Answer, data: bytes) -> Answer:
    assert _simulation is not None, "nothing is switched on"
    _simulation.push()
    return _simulation.state()


_ASKED: dict[str, Callable[[Answer, bytes], Answer]] = {
    "check": _check, "open": _open, "line": _line, "power_on": _power_on, "go": _go, "next": _next,
    "stop": _stop, "push": _push,
}  # fmt: skip
