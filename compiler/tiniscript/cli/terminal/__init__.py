"""What is drawn on a terminal, and the keys that come from it."""
