"""Diagnostics: messages about a program, by code and span, and safe edits that repair it."""
