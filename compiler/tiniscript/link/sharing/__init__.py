"""One port, many commands: the command that holds a port shares its session with the others."""
