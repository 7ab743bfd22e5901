"""Turns an AST into a checked program: symbols, types, IR, optimizer, lint, duration."""
