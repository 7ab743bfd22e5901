"""Runs the simulated Uno by hand, with the options of `main.c`."""

from __future__ import annotations

import os
import sys

from tools.uno.build import built, missing

if why := missing():
    sys.exit(f"uno: {why}")
os.execv(built(), [str(built()), *sys.argv[1:]])
