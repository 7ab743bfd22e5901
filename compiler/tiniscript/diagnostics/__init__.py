"""Diagnostics: what is said of a program, by code and span, and the edits that repair it."""
