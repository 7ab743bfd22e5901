"""Diagnostics: what is said about a program, by code and span, and which edits repair it safely."""
