"""`python -m tiniscript` is `tsc`."""

import sys

from tiniscript.cli import main

sys.exit(main())
