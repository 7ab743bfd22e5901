"""The doctor: diagnoses a port, a module or a robot.

It looks at the computer through the door of `system`, at a port through that of `link.wire`, and at
a robot through that of `robot`. Its results are data (`findings`); the command prints them.
"""
