#!/bin/sh
# README's first command: sets TiniScript up in .venv; then the paper's obstacle program is compiled,
# uploaded to the virtual robot, and drives around the obstacles. Ends by itself.
set -eu
. "$(dirname "$0")/venv.sh"
make_venv "[virtual]"

cd "$ROOT"
tsc() {
    say "\$ tsc $*"
    "$ROOT/.venv/bin/tsc" "$@"
    echo
}

say "The program: examples/obstacle.ts"
cat examples/obstacle.ts
echo
if [ -t 1 ] && [ -t 2 ] && [ -z "${CI:-}" ]; then
    say "For 30 seconds a virtual robot does it here. Ctrl-C stops it earlier."
    tsc upload examples/obstacle.ts --virtual --for 30 --plot way.png
else
    tsc upload examples/obstacle.ts --virtual --for 30 --hurry 20 --plot way.png
fi
say "The warning above: for a second at a time this robot drives without looking. In the room of the
virtual robot that is soon enough; examples/obstacle_until.ts looks 50 times a second."
say "Its way is drawn in way.png, in this folder."
say "Now yours:  . .venv/bin/activate   and   tsc upload -e 'SI|F(2, 80)' --virtual"
