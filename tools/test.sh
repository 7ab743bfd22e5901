#!/bin/sh
# README's second command: sets everything up in .venv and runs all tests. The C++ machine is
# tested on this computer, on a simulated Arduino and on the emulated chips of ESP boards, and the
# sketch on a simulated Uno, with compilers and simulators from Debian's packages; where those cannot
# be had, its tests are skipped and say so (with CI=true they fail instead).
#
# --quick: a first answer, about a minute on two cores where .venv is there: linters, types, generated
# files, and the tests that a change in Python breaks most often. Asks apt for nothing, compiles nothing.
set -eu
. "$(dirname "$0")/venv.sh"
QUICK=""
if [ "${1:-}" = --quick ]; then
    shift
    QUICK="tests/project/test_directions.py tests/project/test_documents.py
        tests/syntax/test_lexer.py tests/syntax/test_parser.py tests/semantics tests/codegen
        tests/bytecode/test_image.py tests/diagnostics/test_rendering.py tests/robots/test_every_driver.py
        tests/languages/test_catalogues.py::test_a_catalogue_has_the_gaps_and_the_keys_of_the_english_one
        tests/pupils/test_pupils.py::test_the_corpus_is_as_it_was
        tests/vm/test_cases.py tests/cli/test_cli.py tests/cli/test_check.py tests/link/test_session.py
        tests/link/test_messages.py"
fi
make_venv "[test]"
[ -n "$QUICK" ] || test_packages

cd "$ROOT"
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
run pytest -n 4 --dist worksteal "$@" || {
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
