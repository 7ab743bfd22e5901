"""The front end: text becomes tokens, tokens become an abstract syntax tree (AST)."""
