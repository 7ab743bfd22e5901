"""A checked program becomes instructions, and code bytes."""
