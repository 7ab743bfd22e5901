"""The parser: the AST of each construct with its spans, and recovery after a mistake.

An AST is drawn as an outline: a row for each node, `name arguments «its text»`, and deeper rows for
its content. An expression is drawn in brackets, its parts in the order of the AST.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from functools import cache
from textwrap import dedent

import pytest

from tests.oracle.interpreter import PAPER_KIT
from tests.oracle.programs import break_text, program
from tiniscript.base.fixed_point import as_text
from tiniscript.base.source import Source, Span
from tiniscript.diagnostics.codes import MAX_DIAGNOSTICS
from tiniscript.syntax import ast
from tiniscript.syntax.outline import _Line
from tiniscript.syntax.parser import _RULES, Parser, parse


def value(argument: ast.Argument | None) -> str:
    """Return `[DISTANCE 10 LT]`, with a `!` after a plain number, or `?` for an unreadable
    value."""
    if argument is None:
        return "?"
    parts = (
        as_text(int(part.value)) if part.op == "NUMBER" else str(part.value or part.op)
        for part in argument.expression
    )
    return f"[{' '.join(parts)}]" + "!" * argument.is_plain


def rows(body: tuple[ast.Instruction, ...], text: str, depth: int = 0) -> Iterator[str]:
    def row(name: str, span: Span) -> str:
        written_text = " ".join(text[span.start : span.end].split())
        return f"{'  ' * depth}{name} «{written_text}»"

    for node in body:
        if isinstance(node, ast.Command):
            values = "".join(" " + value(argument) for argument in node.arguments or ())
            brackets = " ()" if node.arguments == () else ""
            until = f" UNTIL {value(node.until)}" if node.until else ""
            yield row(f"{node.word}{brackets}{values}{until}", node.span)
        elif isinstance(node, ast.Assign):
            yield row(f"{node.name} = {value(node.value)}", node.span)
        elif isinstance(node, ast.If):
            yield row("if", node.span)
            for arm in node.arms:
                yield "  " + row(f"arm {value(arm.condition)}", arm.span)
                yield from rows(arm.body, text, depth + 2)
            if node.else_body:
                yield f"{'  ' * depth}  else"
                yield from rows(node.else_body, text, depth + 2)
        elif isinstance(node, ast.Loop):
            yield row(f"loop {value(node.times) if node.times else 'forever'}", node.span)
            yield from rows(node.body, text, depth + 1)
        elif isinstance(node, ast.While):
            yield row(f"while {value(node.condition)}", node.span)
            yield from rows(node.body, text, depth + 1)
        elif isinstance(node, ast.Break):
            yield row("break", node.span)
        elif isinstance(node, ast.Task):
            yield row(f"when {value(node.condition)}" if node.is_when else "task", node.span)
            yield from rows(node.body, text, depth + 1)
        else:
            yield row(f"def {node.name}", node.span)
            yield from rows(node.body, text, depth + 1)


def outline(text: str) -> str:
    return "\n".join(rows(parse(Source(text)).program.body, text))


def list_diagnostics(text: str) -> list[str]:
    """Return each diagnostic as its code and the text that it points at."""
    return [
        f"{diagnostic.code.number} {text[diagnostic.span.start : diagnostic.span.end]}"
        for diagnostic in parse(Source(text)).diagnostics
    ]


# -- instructions ---------------------------------------------------------------------------------

CONSTRUCTS = {
    "f ( 2 ,\n\n -80 )": "F [2]! [-80]! «f ( 2 , -80 )»",
    "LED(TRUE)": "LED [TRUE] «LED(TRUE)»",
    "F()": "F () «F()»",
    "F(FOREVER, 80) UNTIL(DISTANCE < 10)": (
        "F [FOREVER] [80]! UNTIL [DISTANCE 10 LT] «F(FOREVER, 80) UNTIL(DISTANCE < 10)»"
    ),
    "S;;\n;\r\nS": "S «S»\nS «S»",
    "IF(A)\nS\nELSEIF(Q)\nELSE\nW(1)\nEND_IF": """\
        if «ELSE W(1) END_IF»
          arm [A] «IF(A)»
            S «S»
          arm [Q] «ELSEIF(Q)»
          else
            W [1]! «W(1)»""",
    "LOOP(2 + N);BREAK;END_LOOP": """\
        loop [2 N ADD] «LOOP(2 + N);BREAK;END_LOOP»
          break «BREAK»""",
    "LOOP(FOREVER);WHILE(TRUE);S;END_WHILE;ENDLOOP": """\
        loop forever «LOOP(FOREVER);WHILE(TRUE);S;END_WHILE;ENDLOOP»
          while [TRUE] «WHILE(TRUE);S;END_WHILE»
            S «S»""",
    "DEF DANCE;L(1, 50);END_DEF;DANCE": """\
        def DANCE «DEF DANCE;L(1, 50);END_DEF»
          L [1]! [50]! «L(1, 50)»
        DANCE «DANCE»""",
    "WHEN(DISTANCE < 9);B(1, 50);END_WHEN;TASK;S;ENDTASK": """\
        when [DISTANCE 9 LT] «WHEN(DISTANCE < 9);B(1, 50);END_WHEN»
          B [1]! [50]! «B(1, 50)»
        task «TASK;S;ENDTASK»
          S «S»""",
}


@pytest.mark.parametrize("text", CONSTRUCTS)
def test_each_construct_has_its_node_with_the_text_that_it_spans(text: str) -> None:
    assert outline(text) == dedent(CONSTRUCTS[text])
    assert list_diagnostics(text) == []


@pytest.mark.parametrize(
    ("text", "start"),
    [("S", "SI"), ("SI|S", "SI"), ("\n\n sb |S", "SB"), ("PING|check_connection;\n", "PING")],
)
def test_setup_determines_how_a_program_starts(text: str, start: str) -> None:
    assert parse(Source(text)).program.start == start
    assert list_diagnostics(text) == []


def test_commands_assignments_and_definitions_have_spans() -> None:
    text = "X = (1);F(X, 80) UNTIL(TRUE);DEF A;END_DEF"
    assign, command, definition = parse(Source(text)).program.body
    assert isinstance(assign, ast.Assign) and assign.value is not None
    assert (assign.name_span, assign.value.span, assign.span) == ((0, 1), (4, 7), (0, 7))
    assert isinstance(command, ast.Command) and command.arguments and command.until
    assert (command.word_span, command.span) == ((8, 9), (8, 28))
    assert [argument.span for argument in command.arguments] == [(10, 11), (13, 15)]
    assert command.until.span == (23, 27)
    assert isinstance(definition, ast.Def)
    assert (definition.name_span, definition.span) == ((33, 34), (29, 42))


# -- expressions ----------------------------------------------------------------------------------

EXPRESSIONS = {
    # From lowest to highest precedence: OR, AND, NOT, comparisons, + -, * / %, minus.
    "A OR Q AND C": "[A OR_LEFT Q AND_LEFT C AND OR]",
    "A AND Q OR C": "[A AND_LEFT Q AND OR_LEFT C OR]",
    "NOT A AND Q": "[A NOT AND_LEFT Q AND]",
    "NOT A < 1": "[A 1 LT NOT]",
    "NOT NOT A": "[A NOT NOT]",
    "A + 1 < Q - 1": "[A 1 ADD Q 1 SUB LT]",
    "A + Q * C": "[A Q C MUL ADD]",
    "-A * Q": "[A NEG Q MUL]",
    "A - -Q": "[A Q NEG SUB]",
    # Operators of one level, from left to right.
    "A - Q - C": "[A Q SUB C SUB]",
    "A / Q * C % D": "[A Q DIV C MUL D MOD]",
    "A OR Q OR C": "[A OR_LEFT Q OR OR_LEFT C OR]",
    # brackets and functions
    "(A + Q) * C": "[A Q ADD C MUL]",
    "A = (Q <> C)": "[A Q C NE EQ]",
    "NOT (A OR Q)": "[A OR_LEFT Q OR NOT]",
    "MIN(A + 1, ABS(Q)) + C": "[A 1 ADD Q ABS MIN C ADD]",
    "ROUND(\n  A,\n  2\n)": "[A 2 ROUND]",
    # a minus right before a number belongs to it
    "-5": "[-5]!",
    "- 5": "[-5]!",
    "5": "[5]!",
    "(5)": "[5]",
    "-(5)": "[5 NEG]",
    "--5": "[-5 NEG]",
    "3 - 5": "[3 5 SUB]",
    "-2147483.648": "[-2147483.648]!",
    "TIME >= .5": "[TIME 0.5 GE]",
}


@pytest.mark.parametrize("text", EXPRESSIONS)
def test_parts_are_in_the_order_of_a_stack_machine(text: str) -> None:
    assert outline(f"X = {text}").partition(" «")[0] == f"X = {EXPRESSIONS[text]}"
    assert outline(f"SHOW(\n{text}\n)").partition(" «")[0] == f"SHOW {EXPRESSIONS[text]}"
    assert list_diagnostics(f"X = {text}") == []


def test_each_part_of_an_expression_has_its_span() -> None:
    text = "X = -1 + MAX(A, -Q)"
    (assign,) = parse(Source(text)).program.body
    assert isinstance(assign, ast.Assign) and assign.value is not None
    assert [(part.op, text[part.start : part.end]) for part in assign.value.expression] == [
        ("NUMBER", "-1"),
        ("NAME", "A"),
        ("NAME", "Q"),
        ("NEG", "-"),
        ("MAX", "MAX(A, -Q)"),
        ("ADD", "+"),
    ]


# -- mistakes -------------------------------------------------------------------------------------

MISTAKES: dict[str, tuple[list[str], str]] = {
    # the rest of the instruction is skipped
    "F(2 80);S": (["TS017 80"], "S «S»"),
    "F(2,;S": (["TS018 ;"], "S «S»"),
    "F(2, 80;S": (["TS016 ("], "S «S»"),
    "F 2 80;S": (["TS015 F"], "S «S»"),
    "F(2, 80));S": (["TS041 )"], "F [2]! [80]! «F(2, 80)»\nS «S»"),
    "X = 1 < 2 < 3;S": (["TS037 <"], "X = ? «X»\nS «S»"),
    "S = 5;S": (["TS105 S"], "S «S»"),
    "S S S": (["TS013 S"], "S «S»"),
    "F(2, 80);UNTIL(A)": (["TS029 UNTIL"], "F [2]! [80]! «F(2, 80)»"),
    "PING|F(2, 80)": (["TS035 PING"], ""),
    "GO|S": (["TS034 GO"], "S «S»"),
    # brackets hold back the end of a line, and no longer than that
    "X = (A)\n+ 1": (["TS042 +"], "X = [A] «X = (A)»"),
    # a block opens even where its header is wrong, and its end is no other mistake
    "IF DISTANCE < 10;S;ENDIF": (
        ["TS015 IF"],
        "if «IF DISTANCE < 10;S;ENDIF»\n  arm ? «IF»\n    S «S»",
    ),
    "LOOP();S;END_LOOP": (["TS020 ()"], "loop forever «LOOP();S;END_LOOP»\n  S «S»"),
    "DEF;S;END_DEF": (["TS040 DEF"], ""),
    # ends that belong to no block, or to another one
    "S;ENDIF;S": (["TS025 ENDIF"], "S «S»\nS «S»"),
    "IF(A);S": (["TS024 IF(A)"], "if «IF(A);S»\n  arm [A] «IF(A)»\n    S «S»"),
    "LOOP(2);IF(A);S;END_LOOP;S": (
        ["TS026 END_LOOP"],
        "loop [2]! «LOOP(2);IF(A);S;END_LOOP»\n  if «IF(A);S;END_LOOP»\n    arm [A] «IF(A)»\n"
        "      S «S»\nS «S»",
    ),
    "ELSE;S": (["TS025 ELSE"], "S «S»"),
    "LOOP(I = 1);S;END_LOOP": (["TS063 I"], "loop forever «LOOP(I = 1);S;END_LOOP»\n  S «S»"),
    "IF(A);ELSE;S;ELSE;W(1);ENDIF": (
        ["TS027 ELSE"],
        "if «ELSE;S;ELSE;W(1);ENDIF»\n  arm [A] «IF(A)»\n  else\n    W [1]! «W(1)»",
    ),
}


@pytest.mark.parametrize("text", MISTAKES)
def test_a_mistake_is_reported_once_and_parsing_continues(text: str) -> None:
    diagnostics, tree = MISTAKES[text]
    assert (list_diagnostics(text), outline(text)) == (diagnostics, tree)


def test_blocks_that_are_nested_too_deep_are_reported_once_and_left_out() -> None:
    text = "LOOP(2);" * 20 + "S;" + "END_LOOP;" * 20
    assert list_diagnostics(text) == ["TS302 LOOP(2)"]
    assert [row.strip().partition(" ")[0] for row in outline(text).split("\n")] == ["loop"] * 16


def test_any_name_may_be_an_instruction() -> None:
    assert list_diagnostics("REPETIR;FIN;GO(5)") == []


def test_a_def_may_be_called_by_a_word_of_another_language() -> None:
    assert list_diagnostics("DEF FIN;S;END_DEF;FIN") == []


def test_parsing_ends_after_enough_diagnostics() -> None:
    parsed_text = parse(Source("*;" * 5000))
    assert len(parsed_text.diagnostics) == MAX_DIAGNOSTICS + 1


# -- any text -------------------------------------------------------------------------------------

NESTING_DEPTH = 20_000


@pytest.mark.sampled("text", keep=4)
@pytest.mark.parametrize(
    "text",
    [
        "X = " + "(" * NESTING_DEPTH + "1" + ")" * NESTING_DEPTH,
        "X = " + "(" * NESTING_DEPTH,
        "X = " + "-" * NESTING_DEPTH + "A",
        "X = " + "NOT " * NESTING_DEPTH + "A",
        "X = " + "ABS(" * NESTING_DEPTH + "A" + ")" * NESTING_DEPTH,
        "X = " + "1 + (" * NESTING_DEPTH + "A",
        "IF(A);" * NESTING_DEPTH + "ENDIF;" * NESTING_DEPTH,
        "LOOP(2);" * NESTING_DEPTH,
        "IF(A);" + "ELSEIF(A);" * NESTING_DEPTH + "ENDIF",
        "}" * NESTING_DEPTH + "{" * NESTING_DEPTH,
        "F(" * NESTING_DEPTH,
    ],
    ids=lambda text: text[:12],
)
def test_no_depth_of_input_exhausts_the_stack(text: str) -> None:
    parsed_text = parse(Source(text))
    assert parsed_text.scan.tokens[-1].end == len(text)


@cache
def broken_programs() -> list[str]:
    rng = random.Random(20)
    return [break_text(rng, program(rng, PAPER_KIT)) for _ in range(600)]


def spans(body: tuple[ast.Instruction, ...]) -> Iterator[tuple[Span, tuple[ast.Instruction, ...]]]:
    for node in body:
        span, inside = node.span, getattr(node, "body", ())
        if isinstance(node, ast.If):  # its span begins with its last arm
            span = Span(node.arms[0].span.start, span.end)
            inside = (*(task for arm in node.arms for task in arm.body), *node.else_body)
        yield span, inside
        yield from spans(inside)


def test_nodes_of_any_text_follow_one_another_inside_their_blocks() -> None:
    for text in broken_programs():
        body = parse(Source(text)).program.body
        for outer, inside in ((Span(0, len(text)), body), *spans(body)):
            position = outer.start
            for node in inside:
                assert position <= node.span.start <= node.span.end <= outer.end, text
                position = node.span.start


def test_diagnostics_of_any_text_point_into_it() -> None:
    parsed = [(text, parse(Source(text)).diagnostics) for text in broken_programs()]
    assert sum(bool(diagnostics) for _, diagnostics in parsed) > len(parsed) // 2
    for text, diagnostics in parsed:
        for diagnostic in diagnostics:
            assert 0 <= diagnostic.span.start <= diagnostic.span.end <= len(text), text


def test_every_rule_of_a_derived_parser_is_found_by_its_table() -> None:
    rules = {rule.__name__ for rule in _RULES.values()} | {"command"}
    assert _Line in Parser.__subclasses__()
    for heir in Parser.__subclasses__():
        assert not rules & vars(heir).keys()
