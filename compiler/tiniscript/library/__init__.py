"""The functions behind `import tiniscript`, and what the command shares with them.

`compiling` goes from text to image, one line per stage; `client` is the client of a robot for
library, command and studio.

Connects the stages and returns data. Prints nothing, reads no input, and knows no command.
"""
