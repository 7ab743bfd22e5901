"""The functions behind `import tiniscript`, and what the command shares with them.

Connects the stages and returns data. Prints nothing, reads no input, and knows no command.
"""
