"""Runs the simulated Uno by hand, with the options of `main.c`."""

from __future__ import annotations

import os
import sys

from tools.uno.build import build, missing

if reason := missing():
    sys.exit(f"uno: {reason}")
os.execv(build(), [str(build()), *sys.argv[1:]])
