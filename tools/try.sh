#!/bin/sh
# README's first command: sets TiniScript up in .venv and runs the paper's obstacle program.
set -eu
. "$(dirname "$0")/venv.sh"
make_venv "[virtual]"

cd "$ROOT"
tsc() {
    say "\$ tsc $*"
    "$ROOT/.venv/bin/tsc" "$@"
    echo
}

out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
say "The program: examples/obstacle.ts"
cat examples/obstacle.ts
echo
tsc compile examples/obstacle.ts -o "$out/obstacle.bin"
tsc show "$out/obstacle.bin"
say "What the robot does: milliseconds, then what. It meets walls at 9 and at 7 cm."
if [ -t 2 ] && [ -z "${CI:-}" ]; then
    tsc run "$out/obstacle.bin" --sensor DISTANCE=50,9,50,30,7,60 --max-time 10 --show
else
    tsc run "$out/obstacle.bin" --sensor DISTANCE=50,9,50,30,7,60 --max-time 10
fi
say "Now yours:  . .venv/bin/activate   and   tsc run -e 'SI|F(2, 80)'"
