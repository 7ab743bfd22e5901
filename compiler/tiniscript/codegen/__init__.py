"""Turns IR into code for robots: instructions, each with its source location; text; sketches."""
