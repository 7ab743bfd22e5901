#!/bin/sh
# README's second command as somebody has it who has neither sudo nor Debian's packages: the folders of
# tests that need most of them skip what they lack, say why, and fail nowhere. What is missing is hidden
# behind a folder of links. Options go to pytest.
set -eu
. "$(dirname "$0")/venv.sh"
make_venv "[test]"
cd "$ROOT"
unset CI
BARE=$(mktemp -d)
trap 'rm -rf "$BARE"' EXIT
trap 'exit 130' HUP INT TERM
for path in /usr/local/bin/* /usr/bin/* /bin/*; do
    name=${path##*/}
    case "$name" in
    *g++* | *gcc* | avr* | *simavr* | clang* | cc | c++ | qemu* | mosquitto* | sudo) ;;
    *) [ ! -f "$path" ] || ln -sf "$path" "$BARE/$name" ;;
    esac
done
PATH=$BARE "$PYTHON" -m pytest -n 2 -p no:cacheprovider "$@" tests/flash tests/project
