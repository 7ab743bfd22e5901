"""IR becomes instructions, and code bytes; each knows its source location."""
