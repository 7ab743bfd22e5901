"""Text becomes tokens, tokens an AST: lexer, parser, formatter; of wrong ones what was expected."""
