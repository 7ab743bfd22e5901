"""Tests of other people's machines and robots against the specification.

It knows the cases of `docs/develop/conformance.md`, how to ask a machine as a child process and a
robot over the link, and which answers differ. It prints nothing.
"""
