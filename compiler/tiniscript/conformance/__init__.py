"""Tests of other people's machines and robots against the specification.

Knows the cases that `docs/develop/conformance.md` describes, how a machine is asked as a process of
its own and a robot over the link, and what differs. Prints nothing.
"""
