"""The functions behind `import tiniscript`, and what the command shares with them.

Puts the stages together and returns data. Prints nothing, asks nobody, and knows no command.
"""
