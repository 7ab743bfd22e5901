# Finds a Python for try.sh and test.sh, and what Debian keeps in packages of their own; environment.py
# makes the virtual environment .venv beside this folder. Sets PYTHON to its interpreter.

ROOT=$(cd "$(dirname "$0")/.." && pwd)
PYTHON="$ROOT/.venv/bin/python"

say() { printf '\033[1m%s\033[0m\n' "$*" >&2; }
fail() { printf '%s\n' "$*" >&2; exit 2; }

find_python() {
    for name in python3 python3.13 python3.12 python3.11 python3.10 python; do
        if command -v "$name" >/dev/null 2>&1 &&
            "$name" -c 'import sys; sys.exit(sys.version_info < (3, 10))' 2>/dev/null; then
            command -v "$name"
            return
        fi
    done
    return 1
}

# Debian and Ubuntu keep a part of venv in a package of its own; it brings a Python, too.
install_venv() {
    command -v apt-get >/dev/null 2>&1 ||
        fail "This Python cannot make virtual environments (no ensurepip). Install that part of it."
    if [ "$(id -u)" = 0 ]; then sudo=""; else sudo="sudo"; fi
    say "Installing python3-venv with apt-get"
    { $sudo apt-get update -qq && $sudo apt-get install -y -qq python3-venv; } >&2 ||
        fail "That did not work. Try yourself:  sudo apt-get install python3-venv"
}

# debian_packages NAMES: installs those that are missing, where apt-get is there to do it. A name
# that this release does not have keeps none of the others out.
debian_packages() {
    command -v apt-get >/dev/null 2>&1 || return 0
    missing=""
    for package in "$@"; do
        dpkg -s "$package" >/dev/null 2>&1 || missing="$missing $package"
    done
    [ -n "$missing" ] || return 0
    if [ "$(id -u)" = 0 ]; then sudo=""; else sudo="sudo"; fi
    say "Installing with apt-get:$missing"
    $sudo apt-get update -qq >&2 || say "apt-get could not ask for what is new."
    found=""
    for package in $missing; do
        if apt-cache show "$package" >/dev/null 2>&1; then
            found="$found $package"
        else
            say "This system has no package $package: the tests that need it will be skipped."
        fi
    done
    [ -n "$found" ] || return 0
    # shellcheck disable=SC2086 # the names are words
    $sudo apt-get install -y -qq --no-install-recommends $found >&2 ||
        say "That did not work: the tests that need them will be skipped and say so."
}

# make_venv EXTRAS: installs this repo, with EXTRAS such as [test], if anything changed since.
make_venv() {
    found="$PYTHON"
    if ! "$found" -m pip --version >/dev/null 2>&1; then
        found=$(find_python) || found=""
        if [ -z "$found" ] && command -v apt-get >/dev/null 2>&1; then
            install_venv
            found=$(find_python) || found=""
        fi
        [ -n "$found" ] ||
            fail "TiniScript needs Python 3.10 or newer. On Debian and Ubuntu: sudo apt-get install python3-venv"
        "$found" -c 'import ensurepip' 2>/dev/null || install_venv
    fi
    "$found" "$ROOT/tools/environment.py" "$1" || exit 2
}
