"""Shares one port among commands: the command that holds it lets others use its session."""
