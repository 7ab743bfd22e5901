"""Modules with their quirks: found at any speed, set up, and never lost without a word."""

from __future__ import annotations

import random
from collections import deque
from itertools import product

import pytest

from tests.support.rows import each_row
from tests.support.simulated_modules import KINDS, Bt05, Cc41, Hc05, Hc05New, Hc06, Hm10
from tests.support.simulated_modules import SimulatedModule as Simulated
from tests.support.simulated_wire import SimulatedWire
from tiniscript.link.modules import set_up
from tiniscript.link.modules.dialects import BAUDS, DIALECTS
from tiniscript.link.modules.set_up import Outcome, WantedSettings
from tiniscript.link.modules.talk import Module, find_module

of_each = pytest.mark.parametrize("kind", KINDS)


def find_only_module(wire: SimulatedWire) -> Module:
    module = find_module(wire)
    assert module is not None
    return module


def set_up_module(
    wire: SimulatedWire, settings: WantedSettings, module: Module | None = None
) -> list[Outcome]:
    """Set up the module that is met at the other end."""
    module = module or find_only_module(wire)
    reported_outcomes: list[Outcome] = []
    outcomes = set_up.apply_steps(
        wire, module, set_up.plan_steps(settings, module.dialect), reported_outcomes.append
    )
    assert reported_outcomes == outcomes
    return outcomes


def set_up_everything(wire: SimulatedWire, end: Simulated, name: str, baud: int) -> Module:
    """Set up everything; return the module as it was met, which has it all now."""
    module = find_only_module(wire)
    settings = WantedSettings(name, "135790"[: module.dialect.pin_digits], baud)
    outcomes = set_up_module(wire, settings, module)
    assert [outcome.status in set_up.GOOD_OUTCOMES for outcome in outcomes] == [True] * 3
    assert (end.name, end.pin, end.data_baud) == settings
    return module


class Odd:
    """A module, or a clone of it, on a wire: it echoes its input, is late, or is silent at some
    commands."""

    def __init__(
        self, module: Simulated, echoes: bool = False, late_ms: int = 0, deaf: str = "none"
    ):
        self.module, self.echoes, self.late_ms, self.deaf = module, echoes, late_ms, deaf
        self._heard = b""
        self._later: deque[tuple[int, bytes]] = deque()
        self._now_ms = 0

    @property
    def baud(self) -> int:
        return self.module.baud

    @baud.setter
    def baud(self, baud: int) -> None:
        self.module.baud = baud

    def restart(self) -> None:
        self.module.restart()

    def step(self, data: bytes) -> bytes:
        self._now_ms += 1
        self._heard += data
        count_before = len(self.module.commands)
        reply = self.module.step(data)
        if len(self.module.commands) > count_before:
            request_bytes, self._heard = self._heard, b""
            is_deaf = self.deaf in self.module.commands[-1]
            reply = b"" if is_deaf else (request_bytes + reply if self.echoes else reply)
        if reply:
            self._later.append((self._now_ms + self.late_ms, reply))
        if self._later and self._later[0][0] <= self._now_ms:
            return self._later.popleft()[1]
        return b""


@of_each
@pytest.mark.parametrize("late_ms", [0, 200])
def test_an_echoing_or_slow_module_is_set_up_alike(kind: str, late_ms: int) -> None:
    end: Simulated = KINDS[kind]()
    wire = SimulatedWire(Odd(end, echoes=True, late_ms=late_ms))
    plain_module = find_only_module(SimulatedWire(KINDS[kind]()))
    module = set_up_everything(wire, end, "Tini-7F3A", 9600)
    assert (module.dialect.name, module.version[:2]) == (kind, plain_module.version[:2])


@pytest.mark.parametrize("kind", ["HC-05", "HC-06"])
def test_a_module_without_a_version_is_found(kind: str) -> None:
    end: Simulated = KINDS[kind]()
    wire = SimulatedWire(Odd(end, deaf="VER"))
    module = find_only_module(wire)
    assert (module.dialect.name, module.version) == (kind, "")
    assert [
        outcome.status in set_up.GOOD_OUTCOMES
        for outcome in set_up_module(wire, WantedSettings("Tini"), module)
    ] == [True]
    assert end.name == "Tini"


def test_silence_and_a_mere_echo_are_not_a_module() -> None:
    class Echo:
        baud = 9600

        def step(self, data: bytes) -> bytes:
            return data

        def restart(self) -> None:
            """Do nothing, because no module is there."""

    assert find_module(SimulatedWire(Echo())) is None
    end = Hc06()
    end.is_on = False
    assert find_module(SimulatedWire(end)) is None


def test_every_dialect_has_a_simulated_module() -> None:
    assert set(KINDS) == {dialect.name for dialect in DIALECTS}


@of_each
def test_each_module_is_distinguished_from_all_others(kind: str) -> None:
    wire = SimulatedWire(KINDS[kind]())
    module = find_only_module(wire)
    assert (module.dialect.name, module.baud) == (kind, wire.end.baud)
    assert module.version and "\r" not in module.version


@pytest.mark.parametrize("baud", BAUDS)
@pytest.mark.parametrize("kind", [kind for kind in KINDS if not kind.startswith("HC-05")])
def test_a_module_is_found_at_any_speed(kind: str, baud: int) -> None:
    module = find_only_module(SimulatedWire(KINDS[kind](baud)))
    assert (module.dialect.name, module.baud) == (kind, baud)


@of_each
@pytest.mark.parametrize("baud", [9600, 57600, 115200])
def test_requested_settings_are_changed_and_others_kept(kind: str, baud: int) -> None:
    end: Simulated = KINDS[kind]()
    wire = SimulatedWire(end)
    settings_before = end.name, end.pin, end.data_baud
    assert set_up_module(wire, WantedSettings()) == []
    assert (end.name, end.pin, end.data_baud) == settings_before
    set_up_everything(wire, end, "Tini-7F3A", baud)
    end.power_on()
    assert end.baud == baud


def test_an_old_hc_05_gets_its_pin_without_quotes_and_a_new_one_with() -> None:
    for end in (Hc05(), Hc05New()):
        wire = SimulatedWire(end)
        (outcome,) = set_up_module(wire, WantedSettings(pin="4711"))
        assert (end.pin, outcome.status) == ("4711", set_up.DONE)


def test_stored_quotes_are_not_taken_for_the_pin() -> None:
    """An old module that is taken for a new one keeps the quotes: that is seen, and set again."""
    end = Hc05()
    end.version = "3.0-clone"
    wire = SimulatedWire(end)
    module = find_only_module(wire)
    assert module.dialect.name == "HC-05 3.x"
    (outcome,) = set_up_module(wire, WantedSettings(pin="4711"), module)
    assert (end.pin, outcome.status) == ("4711", set_up.DONE)


def test_a_sleeping_module_is_woken() -> None:
    end = Hm10()
    end.is_asleep = True
    wire = SimulatedWire(end)
    assert find_module(wire, wakes_module=False) is None
    assert find_only_module(wire).dialect.name == "HM-10"


def test_a_speed_that_was_set_before_a_restart_is_found_again() -> None:
    """Somebody pulled the plug between the command and the restart: the next run finds it."""
    end = Hm10()
    wire = SimulatedWire(end)
    module = find_only_module(wire)
    end.breaks_after = len(end.commands) + 1  # AT+BAUD is the last one that it hears
    outcomes = set_up_module(wire, WantedSettings(baud=115200), module)
    assert outcomes[-1].status == set_up.LOST
    end.breaks_after = None
    end.power_on()
    assert find_only_module(wire).baud == 115200


@pytest.mark.parametrize("commands", range(12))
@of_each
def test_an_interrupted_setup_is_completed_by_the_next_one(kind: str, commands: int) -> None:
    end = KINDS[kind]()
    wire = SimulatedWire(end)
    module = find_only_module(wire)
    end.breaks_after = len(end.commands) + commands
    outcomes = set_up_module(
        wire, WantedSettings("ANA", "135790"[: module.dialect.pin_digits], 57600), module
    )
    is_whole = end.is_on
    assert is_whole == (
        len(outcomes) == 3 and all(outcome.status in set_up.GOOD_OUTCOMES for outcome in outcomes)
    )
    end.breaks_after = None
    if kind.startswith("HC-05"):
        end.is_on = True  # the button is still held
    else:
        end.power_on()
    set_up_everything(wire, end, "ANA", 57600)


def test_a_clone_with_different_baud_codes_is_found_at_its_new_speed() -> None:
    """Such a clone reports CC41-A and counts as an MLT-BT05 at another speed; the user sees that
    speed."""

    class Liar(Cc41):
        bauds = Bt05.bauds

    end = Liar()
    wire = SimulatedWire(end)
    module = find_only_module(wire)
    assert module.dialect.name == "CC41-A"
    end.data_baud = 38400
    (outcome,) = set_up_module(wire, WantedSettings(baud=9600), module)
    assert (outcome.status, end.baud) == (set_up.DONE, 9600)
    outcomes = set_up_module(wire, WantedSettings(baud=57600))
    assert outcomes[-1].status == set_up.REFUSED
    end.bauds = Hm10.bauds
    outcomes = set_up_module(wire, WantedSettings(baud=9600))
    assert (outcomes[-1].status, outcomes[-1].answer) == (set_up.ELSEWHERE, "115200")
    assert end.baud == 115200


def test_a_refused_setting_is_not_reported_as_done() -> None:
    class Stubborn(Hc06):
        def answer(self, command: str) -> str:
            return "ERROR:(7)" if command.startswith("AT+PIN") else super().answer(command)

    end = Stubborn()
    wire = SimulatedWire(end)
    outcomes = set_up_module(wire, WantedSettings("ANA", "1111", 115200))
    assert [outcome.status for outcome in outcomes] == [set_up.UNSEEN, set_up.REFUSED]
    assert outcomes[-1].answer == "ERROR:(7)"
    assert (end.pin, end.baud) == ("1234", 9600)


@pytest.mark.parametrize(
    "forms", [*product(("keeps", "cuts", "changes nothing", "refuses", "is silent"), repeat=2)]
)
@pytest.mark.parametrize("kind", [Hc05, Hc05New])
def test_the_reported_pin_is_the_stored_one(kind: type[Hc05], forms: tuple[str, str]) -> None:
    """This holds however it treats each form, with quotes and without."""

    class Quirky(kind):  # type: ignore[misc, valid-type]
        def answer(self, command: str) -> str:
            if not command.startswith("AT+PSWD="):
                return str(super().answer(command))
            sent_text = command.partition("=")[2]
            does = forms[sent_text[:1] != '"']
            if does in ("keeps", "cuts"):
                self.pin = sent_text[: 3 if does == "cuts" else None]
            return {"refuses": "ERROR:(1D)\r\n", "is silent": ""}.get(does, "OK\r\n")

    end = Quirky()
    (outcome,) = set_up_module(SimulatedWire(end), WantedSettings(pin="4321"))
    has = end.pin.strip('"') if kind is Hc05New else end.pin
    if outcome.status == set_up.DONE:
        assert has == "4321"
    elif outcome.status == set_up.DIFFERS:
        assert outcome.answer.strip('"') == end.pin.strip('"') and has != "4321"
    else:
        assert outcome.status in (set_up.REFUSED, set_up.SILENT) and end.pin == kind.pin


def test_a_truncated_name_is_noticed() -> None:
    class Short(Hm10):
        def answer(self, command: str) -> str:
            answer = super().answer(command)
            self.name = self.name[:4]
            return answer

    wire = SimulatedWire(Short())
    (outcome,) = set_up_module(wire, WantedSettings("Tini-7F3A"))
    assert (outcome.status, outcome.answer) == (set_up.DIFFERS, "Tini")


@each_row(
    "settings, dialect, unsupported_name",
    [
        (WantedSettings("x" * 20), "HC-06", ""),
        (WantedSettings("x" * 21), "HC-06", "name"),
        (WantedSettings("x" * 12), "HM-10", ""),
        (WantedSettings("x" * 13), "HM-10", "name"),
        (WantedSettings(""), "HC-05", "name"),
        (WantedSettings(" a"), "HC-05", "name"),
        (WantedSettings("a,b"), "HC-05", "name"),
        (WantedSettings("ÑANDÚ"), "HC-05", "name"),
        (WantedSettings("a\r\nAT+ORGL"), "HC-05", "name"),
        (WantedSettings(pin="1234"), "HC-05", ""),
        (WantedSettings(pin="12345"), "HC-05", "pin"),
        (WantedSettings(pin="1234"), "HM-10", "pin"),
        (WantedSettings(pin="123456"), "CC41-A", ""),
        (WantedSettings(pin="12a4"), "HC-06", "pin"),
        (WantedSettings(pin="१२३४"), "HC-06", "pin"),
        (WantedSettings(baud=57600), "HC-06", ""),
        (WantedSettings(baud=57601), "HC-06", "baud"),
    ],
)
def test_unsupported_settings_are_known_in_advance(
    settings: WantedSettings, dialect: str, unsupported_name: str
) -> None:
    (found_dialect,) = (other for other in DIALECTS if other.name == dialect)
    assert set_up.unsupported_setting(settings, found_dialect) == unsupported_name


def test_a_name_made_from_an_id_fits_every_module() -> None:
    assert set_up.name_for(0x12347F3A) == "Tini-7F3A"
    assert all(
        not set_up.unsupported_setting(WantedSettings(set_up.name_for(7)), dialect)
        for dialect in DIALECTS
    )


@pytest.mark.parametrize("seed", range(12))
@of_each
def test_earlier_bytes_are_not_part_of_a_command(kind: str, seed: int) -> None:
    """A set-up that was interrupted anywhere in a command, however long ago."""
    rng = random.Random(f"{kind} {seed}")
    end: Simulated = KINDS[kind](*([rng.choice(BAUDS)] if not kind.startswith("HC-05") else []))
    wire = SimulatedWire(end, end.baud)
    plain_module = find_only_module(
        SimulatedWire(KINDS[kind](*([end.baud] if not kind.startswith("HC-05") else [])))
    )
    command = rng.choice(["AT", "AT+", "AT+VERSION", "AT+ROLE?", "AT\r", "A", "w" * 20, "\0"])
    wire.send(command.encode())
    wire.receive(rng.choice([1, 10, 100, 900]))
    assert find_only_module(wire) == plain_module
