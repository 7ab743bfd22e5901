# Finds a Python for try.sh and test.sh, and what Debian keeps in packages of their own; environment.py
# makes the virtual environment .venv beside this folder. Sets PYTHON to its interpreter.

ROOT=$(cd "$(dirname "$0")/.." && pwd)
PYTHON="$ROOT/.venv/bin/python"

# in_language ENGLISH SPANISH PORTUGUESE: the sentence in the person's language, as `tsc` finds it.
in_language() {
    case "${LC_ALL:-${LC_MESSAGES:-${LANG:-}}}" in
    [eE][sS]*) printf '%s' "$2" ;;
    [pP][tT]*) printf '%s' "$3" ;;
    *) printf '%s' "$1" ;;
    esac
}
say() { printf '\033[1m%s\033[0m\n' "$(in_language "$@")" >&2; }
fail() { printf '%s\n' "$(in_language "$@")" >&2; exit 2; }

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

# apt_get WORDS: as root. Fails without a word where this user cannot become root.
apt_get() {
    if [ "$(id -u)" = 0 ]; then
        apt-get "$@" >&2
    else
        command -v sudo >/dev/null 2>&1 && sudo apt-get "$@" >&2
    fi
}

# Debian and Ubuntu keep a part of venv in a package of its own; it brings a Python, too.
install_venv() {
    command -v apt-get >/dev/null 2>&1 || fail \
        "This Python cannot make virtual environments (no ensurepip). Install that part of it." \
        "Este Python no puede crear entornos virtuales (falta ensurepip). Instala esa parte." \
        "Este Python não pode criar ambientes virtuais (falta ensurepip). Instale essa parte."
    say "Installing python3-venv with apt-get" "Se instala python3-venv con apt-get" \
        "Instalando python3-venv com apt-get"
    { apt_get update -qq && apt_get install -y -qq python3-venv; } || fail \
        "That did not work. Who administers this computer installs it as root, online:  apt-get install python3-venv" \
        "No se pudo. Quien administra esta computadora lo instala como root, con internet:  apt-get install python3-venv" \
        "Não deu certo. Quem administra este computador o instala como root, com internet:  apt-get install python3-venv"
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
    say "Installing with apt-get:$missing" "Se instala con apt-get:$missing" \
        "Instalando com apt-get:$missing"
    apt_get update -qq || say "apt-get could not ask for what is new." \
        "apt-get no pudo preguntar qué hay de nuevo." "O apt-get não conseguiu ver o que há de novo."
    found=""
    for package in $missing; do
        if apt-cache show "$package" >/dev/null 2>&1; then
            found="$found $package"
        else
            say "This system has no package $package: the tests that need it will be skipped." \
                "Este sistema no tiene el paquete $package: se omiten las pruebas que lo usan." \
                "Este sistema não tem o pacote $package: os testes que o usam são pulados."
        fi
    done
    [ -n "$found" ] || return 0
    # shellcheck disable=SC2086 # the names are words
    apt_get install -y -qq --no-install-recommends $found ||
        say "That did not work: the tests that need them will be skipped and say so." \
            "No se pudo: las pruebas que los usan se omiten y lo dicen." \
            "Não deu certo: os testes que os usam são pulados e dizem isso."
}

# What the tests need of Debian.
test_packages() {
    debian_packages g++ gcc-avr avr-libc binutils-avr simavr libsimavr-dev libelf-dev \
        arduino-core-avr arduino-builder avrdude doctest-dev clang-22 libclang-rt-22-dev \
        gcc-xtensa-lx106 gcc-riscv64-unknown-elf qemu-system-misc zsh less dbus-daemon mosquitto \
        libmbedtls-dev chromium chromium-headless-shell firefox-esr
}

# Sets found to a Python that can make virtual environments.
find_venv_python() {
    found=$(find_python) || found=""
    if [ -z "$found" ] && command -v apt-get >/dev/null 2>&1; then
        install_venv
        found=$(find_python) || found=""
    fi
    [ -n "$found" ] || fail \
        "TiniScript needs Python 3.10 or newer, and there is none here. Debian 12 and Ubuntu 22.04 have one." \
        "TiniScript necesita Python 3.10 o posterior, y aquí no hay. Debian 12 y Ubuntu 22.04 lo tienen." \
        "O TiniScript precisa de Python 3.10 ou mais novo, e aqui não há. O Debian 12 e o Ubuntu 22.04 têm."
    "$found" -c 'import ensurepip' 2>/dev/null || install_venv
}

# make_venv EXTRAS: installs this repo, with EXTRAS such as [test], if anything changed since.
make_venv() {
    found="$PYTHON"
    "$found" -m pip --version >/dev/null 2>&1 || find_venv_python
    "$found" "$ROOT/tools/environment.py" "$1" || exit 2
}
