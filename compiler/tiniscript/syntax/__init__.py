"""Turns text into tokens and an AST: lexer, parser, formatter; reports missing parts of a text."""
