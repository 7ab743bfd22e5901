"""Reads the text of a TiniScript program and checks all that can be wrong with it.

It shares nothing with the compiler. The result is a tree in which every instruction knows which
readings it takes. Numbers are Python integers that count thousandths; yes/no values are bools.
"""

from __future__ import annotations

from collections.abc import Mapping

from tests.oracle.ast import (
    Arm,
    Do,
    Expression,
    Facts,
    If,
    Loop,
    Program,
    Statement,
    Task,
    While,
    sensors_in,
)
from tests.oracle.expressions import ExpressionParser
from tests.oracle.readings import depths, fit, settle_readings
from tests.oracle.words import (
    ALIASES,
    BLOCK_WORDS,
    MAX_CALLS,
    MAX_DEFS,
    MAX_NESTING,
    MAX_TASKS,
    MAX_VALUES,
    MAX_VARIABLES,
    MOVES,
    RANGES,
    RESERVED,
    SETUPS,
    TASK_WORDS,
    UNITS,
)


class Parser(ExpressionParser):
    """Reads a program and checks everything that can be wrong with its text."""

    # The program and its blocks

    def program(self) -> Program:
        """SETUP|INSTRUCTIONS."""
        while self.token.kind == "newline":
            self.at += 1
        if self.next_is(*SETUPS) and self.tokens[self.at + 1].text == "|":
            setup = self.accept(*SETUPS)
            self.expect("|")
            if setup == "PING":
                self.ping()
                return Program([], {}, {})
        main = self.block()
        if self.token.kind != "end":
            self.fail(f"{self.token.text} without its beginning")
        facts: dict[str, Facts] = {}
        # In the order of the text, because calls only refer backwards.
        for name, body in self.defs.items():
            facts[name] = self.settle(body, facts)
        together = [self.settle(main, facts)]
        for task in self.tasks:
            task.reads = sensors_in((task.condition,))
            together.append(self.settle(task.body, facts))
        if sum(facts.nesting for facts in together) > MAX_NESTING:
            self.fail("blocks nested too deep in all tasks together")
        if sum(facts.calling for facts in together) > MAX_CALLS:
            self.fail("DEFs called too deep in all tasks together")
        values = {name: definition.values for name, definition in self.text.defs.items()}
        program = Program(main, self.defs, self.variables, values, self.tasks)
        if not fit(program):
            self.fail("no room for what each task has of its own")
        return program

    def settle(self, body: list[Statement], defs: Mapping[str, Facts]) -> Facts:
        """Settles the readings of the program or of a DEF and checks its depths."""
        nesting_depth, call_depth = depths(body, defs)
        if nesting_depth > MAX_NESTING:
            self.fail("blocks nested too deep")
        if call_depth > MAX_CALLS:
            self.fail("DEFs called too deep")
        return Facts(nesting_depth, call_depth, settle_readings(body, frozenset(), defs))

    def ping(self) -> None:
        """PING|check_connection has only empty instructions besides it."""
        while self.accept_separator():
            pass
        self.expect("CHECK_CONNECTION")
        while self.accept_separator():
            pass
        if self.token.kind != "end":
            self.fail("something after PING|check_connection")

    def block(self) -> list[Statement]:
        """Instructions up to the word that ends or divides a block, or the end of the text."""
        body: list[Statement] = []
        while self.token.kind != "end" and not self.next_is(*BLOCK_WORDS, *ALIASES):
            if self.accept_separator():
                continue
            statement = self.instruction()
            if statement is not None:
                body.append(statement)
            self.end_of_instruction()
        return body

    def end_of_instruction(self) -> None:
        """Every instruction, block header and block end needs a ; or an end of line after it."""
        if self.token.kind != "end" and not self.accept_separator():
            self.fail(f"the instruction should end before {self.token.text!r}")

    def inner_block(self, *end_words: str) -> list[Statement]:
        """A header's end, a body, and the check that the right word ends it (not taken)."""
        self.end_of_instruction()
        body = self.block()
        if ALIASES.get(self.token.text, self.token.text) not in end_words:
            self.fail(f"{' or '.join(end_words)} expected, not {self.token.text!r}")
        return body

    def instruction(self) -> Statement | None:
        """Return one instruction, with its block if it has one; None for START and DEF."""
        if self.token.kind != "word":
            self.fail(f"an instruction cannot begin with {self.token.text!r}")
        word = self.token.text
        self.at += 1
        if word == "START":
            return None
        if word == "DEF":
            self.definition()
            return None
        if word in TASK_WORDS:
            self.task(word)
            return None
        if word == "IF":
            return self.choice()
        if word in ("LOOP", "WHILE"):
            return self.repetition(word)
        if word in RANGES:
            return self.action(word)
        if word in ("S", "STOP"):
            return Do("S")
        if word == "SHOW":
            (value,) = self.arguments(1)
            return self.check_stack(Do("SHOW", arguments=(value,)))
        if word == "BREAK":
            if self.loops == 0:
                self.fail("BREAK outside a loop")
            return Do("BREAK")
        if word in RESERVED:
            self.fail(f"{word} cannot begin an instruction")
        return self.parse_named(word)

    def definition(self) -> None:
        """DEF NAME … END_DEF: at the top level only; its name is callable after END_DEF."""
        if self.blocks > 0 or self.open_def or self.in_task:
            self.fail("a DEF inside a block")
        name = self.token.text
        if self.token.kind != "word" or name in RESERVED:
            self.fail("a DEF needs a name")
        if name in (*self.variables, *self.defs, *self.sensors, *self.actuators):
            self.fail(f"the name {name} is taken")
        if len(self.defs) == MAX_DEFS:
            self.fail("too many DEFs")
        self.at += 1
        if self.accept("("):
            self.names(name)
        self.open_def = name
        body = self.inner_block("END_DEF")
        self.at += 1
        self.open_def = ""
        self.own = {}
        self.defs[name] = body

    def names(self, def_name: str) -> None:
        """The names in the brackets of a DEF."""
        while not self.next_is(")"):
            if self.own:
                self.expect(",")
            name = self.token.text
            if self.token.kind != "word" or name in RESERVED:
                self.fail("a value of a DEF needs a name")
            devices = (*self.sensors, *self.actuators)
            if name in (*self.own, *devices, *self.text.defs) or self.text.assigned_outside(name):
                self.fail(f"the name {name} is taken")
            self.own[name] = self.text.is_yes_no(name, self.text.defs[def_name])
            self.at += 1
        self.expect(")")
        if len(self.own) > MAX_VALUES:
            self.fail("too many values of a DEF")

    def task(self, word: str) -> None:
        """TASK … END_TASK and WHEN(c) … END_WHEN: at the top level only."""
        if self.blocks > 0 or self.open_def or self.in_task:
            self.fail(f"a {word} inside a block")
        condition = self.condition() if word == "WHEN" else None
        self.in_task = True
        body = self.inner_block(f"END_{word}")
        self.at += 1
        self.in_task = False
        self.tasks.append(Task(condition, body))
        if len(self.tasks) > MAX_TASKS:
            self.fail("too many tasks")

    def choice(self) -> If:
        """IF … ELSEIF … ELSE … ENDIF."""
        arms: list[Arm] = []
        self.blocks += 1
        word = "IF"
        while word != "ENDIF":
            condition = None if word == "ELSE" else self.condition()
            end_words = ("ENDIF",) if word == "ELSE" else ("ELSEIF", "ELSE", "ENDIF")
            arms.append(Arm(condition, self.inner_block(*end_words)))
            word = ALIASES.get(self.token.text, self.token.text)
            self.at += 1
        self.blocks -= 1
        return If(arms)

    def repetition(self, word: str) -> Loop | While:
        """LOOP(n) … END_LOOP and WHILE(c) … END_WHILE."""
        count: Expression | None = None
        condition: Expression | None = None
        if word == "WHILE":
            condition = self.condition()
        else:
            (count,) = self.arguments(1, may_be_forever=True)
            self.require_number(count)
            self.require_stack((count,))
        self.blocks += 1
        self.loops += 1
        body = self.inner_block(f"END_{word}")
        self.at += 1
        self.blocks -= 1
        self.loops -= 1
        return Loop(count, body) if condition is None else While(condition, body)

    def action(self, word: str) -> Do:
        """A word with values, and the UNTIL that moves and W may have."""
        ranges = RANGES[word]
        may_until = word in (*MOVES, "W")
        arguments = self.arguments(len(ranges), may_until, UNITS.get(word, ""))
        unit = UNITS[word] if self.has_unit else ""
        if unit and not self.speeds[unit]:
            self.fail(f"how fast the robot is with {unit} is not known")
        for argument, (low, high) in zip(arguments, ranges, strict=True):
            self.require_number(argument)
            self.require_range(argument, low, high)
        until: Expression | None = None
        if may_until and self.accept("UNTIL"):
            until = self.condition()
        has_tasks = any(token.text in TASK_WORDS for token in self.tokens)
        if arguments[0] is None and until is None and not has_tasks:
            self.fail("FOREVER needs UNTIL")
        return self.check_stack(Do(word, arguments=arguments, until=until, unit=unit))

    def parse_named(self, name: str) -> Do:
        """An instruction that begins with a name: assignment, reading, call or actuator."""
        if self.accept("="):
            if name in (*self.sensors, *self.actuators, *self.defs, self.open_def):
                self.fail(f"{name} is not a variable")
            # The expression comes first, because it may not use the new variable.
            value = self.expression()
            if name in self.own:
                if self.own[name] != value.is_yes_no:
                    self.fail(f"{name} has the other kind")
                return self.check_stack(Do("=", f"{self.open_def}.{name}", (value,)))
            if self.variables.setdefault(name, value.is_yes_no) != value.is_yes_no:
                self.fail(f"{name} has the other kind")
            if len(self.variables) > MAX_VARIABLES:
                self.fail("too many variables")
            return self.check_stack(Do("=", name, (value,)))
        if name in self.actuators:
            device = self.actuators[name]
            (argument,) = self.arguments(1)
            if device.is_yes_no:
                self.require_yes_no(argument)
            else:
                self.require_number(argument)
                self.require_range(argument, device.low, device.high)
            return self.check_stack(Do("SET", name, (argument,)))
        if name in self.sensors:
            return Do("READ", name)
        if name in self.defs:
            return self.call(name)
        self.fail(f"{name} is not an instruction here")

    def call(self, name: str) -> Do:
        """A call, with a value for each name in the brackets of the DEF."""
        definition = self.text.defs[name]
        if not definition.values and not self.next_is("("):
            return Do("CALL", name)
        arguments = self.arguments(len(definition.values))
        for value, argument in zip(definition.values, arguments, strict=True):
            assert argument is not None
            if argument.is_yes_no != self.text.is_yes_no(value, definition):
                self.fail(f"{value} has the other kind")
        return self.check_stack(Do("CALL", name, arguments))

    def check_stack(self, statement: Do) -> Do:
        """Return the instruction if the stack holds its values."""
        self.require_stack(statement.arguments)
        return statement

    # Arguments
