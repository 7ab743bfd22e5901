"""Repairs of wrong programs: what the thing to try changes in the text, and which are sure."""
