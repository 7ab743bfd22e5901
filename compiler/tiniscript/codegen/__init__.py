"""Turns IR into what robots run: instructions, each with its source location; text; sketches."""
