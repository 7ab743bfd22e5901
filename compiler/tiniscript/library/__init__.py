"""The functions of `import tiniscript`, and those shared with the command.

`compiling` goes from text to image, one line per stage; `client` is the client of a robot for
library, command and studio.

Connects the stages and returns data. It prints nothing, reads no input, and knows no command.
"""
