"""Machines and robots of others: `tsc conform`, and a machine in JavaScript that it tests."""
