"""Drawing on a terminal, and reading its keys."""

FRAME_S = 1 / 15  # seconds between two redraws
