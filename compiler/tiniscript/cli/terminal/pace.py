"""How often a picture on the terminal is redrawn. A virtual robot needs it early: no imports."""

FRAME_S = 1 / 15
