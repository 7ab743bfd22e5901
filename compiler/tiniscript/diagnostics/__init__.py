"""Diagnostics: what is said of a program, by code and span, in words of two languages."""
