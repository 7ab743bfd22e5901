#!/bin/sh
# README's second command: sets everything up in .venv and runs the tests. The C++ machine is
# tested on this computer, on a simulated Arduino and on the emulated chips of ESP boards, and the
# sketch on a simulated Uno, with compilers and simulators from Debian's packages; where those cannot
# be had, its tests are skipped and say so (with CI=true they fail instead).
#
# --all: the second tier, too: tests that take long, of which most of what they notice is noticed by others,
# and all rows of those that draw a sample. At an issue's end and before a release.
#
# --quick: a first answer, about a minute on two cores where .venv is there: linters, types, generated
# files, and the tests that a change in Python breaks most often. Asks apt for nothing, compiles nothing.
set -eu
. "$(dirname "$0")/venv.sh"
QUICK=""
if [ "${1:-}" = --all ]; then
    shift
    set -- --whole "$@"
elif [ "${1:-}" = --quick ]; then
    shift
    QUICK="tests/project/test_directions.py tests/project/test_documents.py
        tests/syntax/test_lexer.py tests/syntax/test_parser.py tests/semantics tests/codegen
        tests/bytecode/test_image.py tests/diagnostics/test_rendering.py tests/robots/test_every_driver.py
        tests/languages/test_catalogues.py::test_a_catalogue_has_the_gaps_and_the_keys_of_the_english_one
        tests/pupils/test_pupils.py::test_the_corpus_is_unchanged
        tests/vm/test_cases.py tests/cli/test_cli.py tests/cli/test_check.py tests/link/test_session.py
        tests/link/test_messages.py"
fi
make_venv "[test]"
[ -n "$QUICK" ] || test_packages

cd "$ROOT"
TIMES=$(mktemp)
times >"$TIMES" # of the set-up
trap 'rm -f "$TIMES"' EXIT
trap 'exit 130' HUP INT TERM
# The processor time of what has run since, by the shell's own count.
report_cost() {
    times >>"$TIMES" # no pipe: in it the shell would be a fresh one
    set -- "$(LC_ALL=C awk -F '[ms ]+' '
        { gsub(",", "."); s = 60 * ($1 + $3) + $2 + $4; all += NR > 2 ? s : -s }
        END { printf "%.1f", all / 60 }' "$TIMES")"
    say "The tests took $1 minutes of processor time." \
        "Las pruebas tomaron $1 minutos de procesador." \
        "Os testes levaram $1 minutos de processador."
    if [ -n "${CI:-}" ] && [ "${1%.*}" -ge 20 ]; then
        say "That is more than the 20 minutes that people wait for." \
            "Son más de los 20 minutos que alguien espera." \
            "São mais do que os 20 minutos que alguém espera."
    fi
}
run() {
    say "\$ $*" "\$ $*" "\$ $*"
    "$PYTHON" -m "$@"
}

run ruff check .
run ruff format --check .
# Beside the tests, on what they leave of two cores; waited for at the end.
beside() {
    run mypy
    [ -n "$QUICK" ] || run mypy --platform win32 --cache-dir .mypy_cache/win32 compiler/tiniscript
    run tools.generate --check
    [ -z "$QUICK" ] || return 0
    # Every branch of what decides whether a robot may run an image is taken by a test that draws nothing.
    run coverage run --branch --include="compiler/tiniscript/bytecode/verify.py,compiler/tiniscript/bytecode/image.py" \
        -m pytest tests/bytecode/test_image.py tests/bytecode/test_verify.py tests/vm/test_cases.py \
        -p no:xdist -p no:cacheprovider \
        -k "test_image or test_verify or test_disassembly_runs and python"
    run coverage report --show-missing --fail-under=100
}
beside &
BESIDE=$!
finish() {
    wait "$BESIDE" || fail "Types, generated files or branches: see above." \
        "Tipos, archivos generados o ramas: mira arriba." \
        "Tipos, arquivos gerados ou ramos: veja acima."
    report_cost
}
if [ -n "$QUICK" ]; then
    # shellcheck disable=SC2086 # names of files
    run pytest -n 2 --dist worksteal -k "not host and not keeps_to_its_size" $QUICK "$@"
    finish
    exit
fi
# pytest rewrites each file's assertions and keeps that: once here, and not in each of its processes.
"$PYTHON" -m pytest --collect-only "$@" >/dev/null 2>&1 &
COLLECTS=$!
# The page of tsc studio, of packages from npm, unless it is of these sources; without it its tests are
# skipped and say so.
"$PYTHON" -m tools.builds.studio --check 2>/dev/null || run tools.builds.studio || [ -z "${CI:-}" ]
wait "$COLLECTS" || true # what is wrong the tests say
# A test that fails beside others runs once more, alone: one that passes there depends on the load. It is
# named, so that somebody mends it. Where more than three fail, none of them runs again.
run pytest -n 4 --dist worksteal --durations 20 "$@" || {
    code=$?
    failed=$("$PYTHON" -c 'import json; print(*json.load(open(".pytest_cache/v/cache/lastfailed")), sep="\n")') || exit
    [ "$code" = 1 ] && [ -n "$failed" ] && [ "$(printf '%s\n' "$failed" | wc -l)" -le 3 ] || exit "$code"
    run pytest --last-failed --last-failed-no-failures none "$@" || exit
    say "Failed beside other tests and passed alone:
$failed" "Fallaron junto a otras pruebas y pasaron solas:
$failed" "Falharam junto com outros testes e passaram sozinhos:
$failed"
}
finish
