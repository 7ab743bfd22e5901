"""Every case of every document, on every machine that must agree about it."""

from __future__ import annotations

import pytest

from tests.machines import MACHINES, Machine
from tests.support.case_runs import compile_case, robot_and_senses
from tests.support.casefile import Case, accept
from tests.support.images import image_for
from tests.support.rows import each_row
from tests.support.vm_cases import disassemblies_alone, having
from tiniscript.bytecode.disassembly import assemble, disassemble
from tiniscript.bytecode.verify import Refused, verify
from tiniscript.codegen.text.line import line_of, plain_code
from tiniscript.diagnostics.rendering import as_text, message
from tiniscript.syntax.formatter import format_source


def trace_of(case: Case, machine: Machine) -> str:
    """Return the trace of a program or a separate disassembly on a machine."""
    robot, senses = robot_and_senses(case)
    if "tiniscript" in case.parts:
        image = compile_case(case).image
    else:
        image = image_for(assemble(case.parts["bytecode"]), robot.kit)
    return machine(image, robot.kit, senses)


def expect(case: Case, part: str, actual: str, request: pytest.FixtureRequest) -> None:
    if actual != case.parts[part] and request.config.getoption("--accept"):
        accept(case, part, actual)
        return
    assert actual == case.parts[part], f"{case.path.name}:{case.line}"


@each_row("case", having("tiniscript"))
def test_program_compiles_or_its_mistake_is_stated(case: Case) -> None:
    """A program without a `mistake` fence has none, so no program in a document is wrong by
    accident."""
    compilation = compile_case(case)
    assert compilation.is_right == ("mistake" not in case.parts), [
        p.code for p in compilation.diagnostics
    ]


@pytest.mark.parametrize("machine", MACHINES)
@each_row("case", having("tiniscript", "robot"))
def test_a_program_has_its_stated_trace(
    case: Case, machine: str, request: pytest.FixtureRequest
) -> None:
    expect(case, "robot", trace_of(case, MACHINES[machine]), request)


@pytest.mark.parametrize("case", having("tiniscript", "bytecode"))
def test_the_bytecode_of_a_program_is_as_stated(case: Case, request: pytest.FixtureRequest) -> None:
    expect(case, "bytecode", disassemble(compile_case(case).code), request)


@pytest.mark.parametrize("case", having("tiniscript", "plain"))
def test_the_plain_code_of_a_program_is_as_stated(
    case: Case, request: pytest.FixtureRequest
) -> None:
    program = compile_case(case).program
    assert program is not None
    expect(case, "plain", disassemble(plain_code(program).code), request)


@pytest.mark.parametrize("case", having("tiniscript", "line"))
def test_the_line_of_a_program_is_as_stated(case: Case, request: pytest.FixtureRequest) -> None:
    expect(case, "line", line_of(compile_case(case).source) + "\n", request)


@each_row("case", [*having("tiniscript", "mistake"), *having("tiniscript", "warning")])
def test_diagnostics_of_a_program_are_as_stated(case: Case, request: pytest.FixtureRequest) -> None:
    compilation = compile_case(case)
    for part, is_mistake in (("mistake", True), ("warning", False)):
        if part in case.parts:
            sentences = [
                as_text(
                    message(diagnostic, compilation.source, case.language),
                    compilation.source,
                    case.language,
                )
                for diagnostic in compilation.diagnostics
                if diagnostic.is_mistake == is_mistake
            ]
            expect(case, part, "\n\n".join(sentences) + "\n", request)


@pytest.mark.parametrize("case", having("tiniscript", "formatted"))
def test_a_program_is_formatted_as_stated(case: Case, request: pytest.FixtureRequest) -> None:
    expect(case, "formatted", format_source(compile_case(case).source), request)


@pytest.mark.parametrize("machine", MACHINES)
@each_row("case", disassemblies_alone())
def test_disassembly_runs_or_is_refused(
    case: Case, machine: str, request: pytest.FixtureRequest
) -> None:
    """A disassembly that stands alone is run as it is, or refused with the rule and the offset."""
    code = assemble(case.parts["bytecode"])
    expect(case, "bytecode", disassemble(code), request)
    if "refused" in case.parts:
        robot, _ = robot_and_senses(case)
        with pytest.raises(Refused) as exception_info:
            verify(code, len(robot.kit.readings), len(robot.kit.actuators))
        error = exception_info.value
        expect(case, "refused", f"{error.number} {error.name} at {error.offset:04x}\n", request)
        return
    if "robot" in case.parts:
        expect(case, "robot", trace_of(case, MACHINES[machine]), request)
