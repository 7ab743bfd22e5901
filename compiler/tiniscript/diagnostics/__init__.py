"""Diagnostics: what is said of a program, by code and span, and which edits repair it safely."""
