"""Programs as text that a robot reads itself: the limits of its reader, and lines for it."""
