"""`tsc doctor --module`: finds the Bluetooth module on a wire, and sets its name, PIN and speed."""

from __future__ import annotations

import re
from argparse import Namespace

from tiniscript.cli import inputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.terminal.progress import StatusLine
from tiniscript.cli.texts import text
from tiniscript.cli.texts.causes import finding_lines
from tiniscript.doctor.diagnosis import open_failure
from tiniscript.doctor.findings import Finding, sure_finding
from tiniscript.doctor.system import System
from tiniscript.link import ports
from tiniscript.link.errors import PortError
from tiniscript.link.modules import set_up
from tiniscript.link.modules.dialects import BAUDS, DIALECTS, Dialect, value_of
from tiniscript.link.modules.set_up import (
    BAUD,
    DONE,
    GOOD_OUTCOMES,
    NAME,
    PIN,
    Outcome,
    Step,
    WantedSettings,
)
from tiniscript.link.modules.talk import Module, ask, find_module
from tiniscript.link.wire import Wire


def run(options: Namespace, language: str) -> int:
    wanted_settings = _wanted_settings(options)
    port = _port(options)
    try:
        wire = Wire(ports.open_port(port, BAUDS[0]))
    except PortError as error:
        return _print_finding(
            open_failure(System(), port, error)._replace(part_name="module"), language
        )
    steps: list[Step] = []  # the speed, once a command for it may have been sent
    try:
        return _SetUp(wire, options, wanted_settings, language, steps).run()
    except OSError:
        exit_code = _print_finding(sure_finding("port_gone")._replace(part_name="module"), language)
        print(_speed_after_abort(steps, language))
        return exit_code
    except KeyboardInterrupt:
        raise CommandError(2, "module_stopped", left=_speed_after_abort(steps, language)) from None
    finally:
        wire.close()


def _print_finding(finding: Finding, language: str) -> int:
    """Print the finding; return the exit code."""
    print("\n".join(finding_lines([finding], language)), flush=True)
    return 3 if finding.is_wrong else 0


def _speed_after_abort(steps: list[Step], language: str) -> str:
    """Return the known facts about the speed of a module after an interrupted set-up."""
    if not steps:
        return text("module_left_nothing", language)
    return text("module_left", language).format(baud=steps[0].value)


def _wanted_settings(options: Namespace) -> WantedSettings:
    """Return the settings in the options. Raises CommandError for those that no module supports."""
    name: str | None = options.name
    if options.id is not None:
        if name is not None:
            raise CommandError(2, "module_name_and_id")
        if not re.fullmatch("[0-9a-fA-F]{1,8}", options.id):
            raise CommandError(2, "module_bad_id", found=printable_name(options.id) or "''")
        name = set_up.name_for(int(options.id, 16))
    baud = None
    if options.baud is not None:
        baud_of_text = {str(speed): speed for speed in BAUDS}
        if options.baud not in baud_of_text:
            raise CommandError(
                2, "module_bad_baud", known=", ".join(map(str, sorted(BAUDS))),
                found=printable_name(options.baud) or "''",
            )  # fmt: skip
        baud = baud_of_text[options.baud]
    wanted_settings = WantedSettings(name, options.pin, baud)
    misfits = [set_up.unsupported_setting(wanted_settings, dialect) for dialect in DIALECTS]
    if all(misfits):
        _refuse(wanted_settings, max(DIALECTS, key=lambda dialect: dialect.name_bytes), misfits[0])
    return wanted_settings


def _refuse(wanted_settings: WantedSettings, dialect: Dialect, setting: str) -> None:
    if setting == NAME:
        raise CommandError(
            2,
            "module_bad_name",
            most=str(dialect.name_bytes),
            found=printable_name(wanted_settings.name or "") or "''",
        )
    if setting == PIN:
        raise CommandError(2, "module_bad_pin", digits=str(dialect.pin_digits), module=dialect.name)


def _port(options: Namespace) -> str:
    if options.port is None:
        raise CommandError(2, "module_no_port")
    port = inputs.check_port(options.port)
    if ports.is_radio(port):
        raise CommandError(2, "module_by_radio", port=printable_name(port))
    return port


class _SetUp:
    def __init__(
        self,
        wire: Wire,
        options: Namespace,
        wanted_settings: WantedSettings,
        language: str,
        begun_steps: list[Step],
    ) -> None:
        self.wire, self.options, self.wanted_settings = wire, options, wanted_settings
        self.language, self.begun_steps = language, begun_steps
        self.port = printable_name(options.port)

    def run(self) -> int:
        status_line = StatusLine()
        module = find_module(
            self.wire,
            on_baud=lambda baud: status_line.show(self._text("module_looking", baud=str(baud))),
        )
        status_line.end()
        if module is None:
            return _print_finding(sure_finding("module_silent"), self.language)
        misfit = set_up.unsupported_setting(self.wanted_settings, module.dialect)
        if misfit:
            _refuse(self.wanted_settings, module.dialect, misfit)
        plan = set_up.plan_steps(self.wanted_settings, module.dialect)
        current_settings = self._read_settings(module)
        self._print_module(module, current_settings)
        outcomes: list[Outcome] = []
        if not self.options.dry_run:
            self.begun_steps += [step for step in plan if step.setting == BAUD]
            outcomes = set_up.apply_steps(self.wire, module, plan, self._print_outcome)
        else:
            self._print_plan(plan)
        is_done = all(outcome.status in GOOD_OUTCOMES for outcome in outcomes)
        if not plan:
            pin = "123456"[: module.dialect.pin_digits]
            print(self._text("module_nothing", port=self.port, pin=pin))
        elif outcomes and is_done:
            key = "module_then_button" if module.dialect.keeps_baud else "module_then"
            print(self._text(key))
        return 0 if is_done else 3

    def _text(self, key: str, **values: str) -> str:
        return text(key, self.language).format(**values)

    def _read_settings(self, module: Module) -> dict[str, str]:
        """Return the stored settings of a module. Its PIN is not read."""
        dialect = module.dialect
        questions = {NAME: dialect.name_question, BAUD: dialect.baud_question}
        values = {
            setting: value_of(ask(self.wire, question, dialect.line_end, dialect.wait_ms))
            for setting, question in questions.items()
            if question
        }
        if BAUD in values:
            baud_text = values[BAUD].split(",")[0]
            values[BAUD] = next(
                (str(baud) for baud, value in dialect.baud_codes.items() if value == baud_text), ""
            )
        return {setting: printable_name(value) for setting, value in values.items() if value}

    def _print_module(self, module: Module, current_settings: dict[str, str]) -> None:
        version = printable_name(module.version) or self._text("module_no_version")
        print(
            self._text("module_found", module=module.dialect.name, port=self.port,
                       version=version, baud=str(module.baud))
        )  # fmt: skip
        if current_settings:
            values = (
                self._text(f"module_what_{setting}", value=current_settings[setting])
                for setting in current_settings
            )
            print(self._text("module_now", values=", ".join(values)), flush=True)

    def _print_plan(self, plan: list[Step]) -> None:
        for step in plan:
            description = self._text(f"module_what_{step.setting}", value=step.value)
            commands = self._text("module_plan_or").join(step.commands)
            print(f"{description}: " + self._text("module_plan", commands=commands))

    def _print_outcome(self, outcome: Outcome) -> None:
        step, outcome_name, reply_text = outcome
        name = self._text(f"module_what_{step.setting}", value=step.value)
        if step.setting == BAUD and outcome_name == DONE:
            outcome_name = "done_baud" if reply_text == step.value else "done_later"
        reply_text = printable_name(reply_text) or self._text("module_no_word")
        _print_finding(
            sure_finding(f"module_{outcome_name}", name=name, said=reply_text), self.language
        )
