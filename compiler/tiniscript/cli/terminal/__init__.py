"""Drawing on a terminal, and reading its keys."""

FRAME_S = 1 / 15  # how often a picture is redrawn
