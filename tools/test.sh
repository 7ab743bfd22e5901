#!/bin/sh
# README's second command: sets everything up in .venv and runs all tests.
set -eu
. "$(dirname "$0")/venv.sh"
make_venv "[test]"

cd "$ROOT"
run() {
    say "\$ $*"
    "$PYTHON" -m "$@"
}

run ruff check .
run ruff format --check .
run mypy
"$PYTHON" tools/generate.py --check
run pytest -n 2 --dist worksteal "$@"

# Every branch of what decides whether a robot may run an image is taken by a test.
run coverage run --branch --include="compiler/tiniscript/verify.py,compiler/tiniscript/image.py" \
    -m pytest tests/test_image.py tests/test_verify.py tests/test_cases.py -p no:xdist
run coverage report --show-missing --fail-under=100
