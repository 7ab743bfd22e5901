"""An AST becomes a checked program: symbols, types, IR, optimizer, lint, duration."""
