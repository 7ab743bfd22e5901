#!/bin/sh
# Installs tsc from this stick, and opens a shell in which it works:  sh start.sh
# With a folder after it: installs it there, and opens none.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
for name in python3 python3.15 python3.14 python3.13 python3.12 python3.11 python3.10 python; do
    if command -v "$name" >/dev/null 2>&1 &&
        "$name" -c 'import sys; sys.exit(sys.version_info < (3, 10))' 2>/dev/null; then
        "$name" "$here/install.py" "$@" || exit 2
        [ $# = 0 ] || exit 0
        cd "$HOME/TiniScript"
        PATH="$HOME/TiniScript/tsc/bin:$PATH"
        export PATH
        exec "${SHELL:-sh}"
    fi
done
echo "Python 3.10 or newer is missing: python.org, or the packages of this system." >&2
echo "Falta Python 3.10 o posterior: python.org, o los paquetes de este sistema." >&2
echo "Falta o Python 3.10 ou mais novo: python.org, ou os pacotes deste sistema." >&2
exit 2
