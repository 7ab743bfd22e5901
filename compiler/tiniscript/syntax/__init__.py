"""Turns text into tokens and an AST: lexer, parser, formatter; says what is missing in a text."""
