#!/bin/sh
# README's second command: sets everything up in .venv and runs all tests. The C++ machine is
# tested on this computer, on a simulated Arduino and on the emulated chips of ESP boards, and the
# sketch on a simulated Uno, with compilers and simulators from Debian's packages; where those cannot
# be had, its tests are skipped and say so (with CI=true they fail instead).
set -eu
. "$(dirname "$0")/venv.sh"
make_venv "[test]"
test_packages

cd "$ROOT"
run() {
    say "\$ $*"
    "$PYTHON" -m "$@"
}

run ruff check .
run ruff format --check .
run mypy
run mypy --platform win32 --cache-dir .mypy_cache/win32 compiler/tiniscript
run tools.generate --check
# The page of tsc studio, of packages from npm; without it its tests are skipped and say so.
run tools.builds.studio || [ -z "${CI:-}" ]
run pytest -n 2 --dist worksteal "$@"

# Every branch of what decides whether a robot may run an image is taken by a test that draws nothing.
run coverage run --branch --include="compiler/tiniscript/bytecode/verify.py,compiler/tiniscript/bytecode/image.py" \
    -m pytest tests/bytecode/test_image.py tests/bytecode/test_verify.py tests/vm/test_cases.py \
    -p no:xdist \
    -k "test_image or test_verify and not random and not up_to_two or test_listing_runs and python"
run coverage report --show-missing --fail-under=100
