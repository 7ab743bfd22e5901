"""Limits of a program and its code, the same on every machine."""

BLOCKS = 16  # nested in a text, those open around a call included
CODE_BYTES = 32767
STACK_VALUES = 16
VARIABLES = 32
COUNTERS = 16  # counted loops open at once, those around a call included
CALLS = 8
DEFS = 16
PARAMETERS = 4  # most parameters of a DEF
TASKS = 4  # beside the main one
NEST_WORDS = 32  # words that a verifier keeps for open blocks: one for an IF, two for a loop
JOINS = 16  # AND_THEN and OR_ELSE open at once
CHECK_MS = 20  # between two checks of an UNTIL
