"""Turns text into tokens and an AST: lexer, parser, formatter; says what a wrong text lacks."""
