"""Programs as text that a robot reads itself: what fits its reader, and lines for it."""
