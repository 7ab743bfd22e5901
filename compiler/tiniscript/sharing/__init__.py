"""One port, many commands: who holds a port lets the others use its session."""
