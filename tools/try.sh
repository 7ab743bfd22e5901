#!/bin/sh
# README's first command where there is a shell: finds a Python, brings Debian's python3-venv if it is
# missing, and leaves the rest to try.py, which is for every system.
set -eu
. "$(dirname "$0")/venv.sh"
make_venv "[virtual]"
exec "$PYTHON" "$ROOT/tools/try.py"
