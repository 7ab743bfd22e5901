"""Completion: the scripts' offers in a real shell, with every verb and option."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import sys
from pathlib import Path

import pytest

from tests.support.command import Tsc
from tests.support.terminal import Terminal
from tests.support.verbs import parsers, words_of
from tiniscript import robots
from tiniscript.base.languages import languages
from tiniscript.cli.commands import help_completion
from tiniscript.cli.texts.options import selecting_options_of
from tiniscript.cli.texts.verbs import VERBS, command_words
from tiniscript.diagnostics.codes import CODES

BASH = shutil.which("bash") or ""
ZSH = shutil.which("zsh") or ""


def complete(tsc: Tsc, *words: str) -> set[str]:
    """Return the completions of the last of these words."""
    result = tsc("help", "--completion", "bash", "--", *words[:-1], f".{words[-1]}").gives(0, "")
    return {line.partition("\t")[0] for line in result.out.splitlines()[1:]}


def test_verbs_options_and_values_are_completed(tsc: Tsc) -> None:
    assert complete(tsc, "") == set(VERBS)
    assert complete(tsc, "st") == {"start", "stop", "studio"}
    assert complete(tsc, "--lang", "es", "up") == {"upload"}
    assert complete(tsc, "--lang", "=", "es", "up") == {"upload"}
    assert complete(tsc, "--l") == {"--lang"}
    assert complete(tsc, "--lang", "") == set(languages())
    assert complete(tsc, "upload", "--no-") == {"--no-run", "--no-save"}
    assert complete(tsc, "upload", "a.ts", "--virtual", "--world", "l") == {"light", "line"}
    assert complete(tsc, "check", "--robot", "") == set(robots.names())
    assert complete(tsc, "check", "--robot", "=") == set(robots.names())
    assert complete(tsc, "check", "--robot", "=", "lin") == {"liner"}
    assert complete(tsc, "check", "--robot=lin") == {"--robot=liner"}
    assert complete(tsc, "run", "--machine", "") == {"python", "cpp"}
    assert complete(tsc, "set", "") == {"owner", "name", "trim", "text", "wifi"}
    assert complete(tsc, "set", "trim", "--exchange", "") == {"yes", "no"}
    assert complete(tsc, "set", "--port", "trim", "owner", "--") >= {"--give-up", "--list"}
    assert complete(tsc, "doctor", "--se") == {"--selftest"}
    assert complete(tsc, "doctor", "--module", "--p") == {"--port", "--pin"}
    assert complete(tsc, "firmware", "--chip", "nano") == {"nano", "nano-old"}
    assert complete(tsc, "firmware", "--board", "lin") == {"liner"}
    assert complete(tsc, "check", "--explain", "TS") == set(CODES)
    assert complete(tsc, "help", "fm") == complete(tsc, "ayuda", "fm") == {"fmt"}
    assert complete(tsc, "help", "--completion", "") == {"bash", "zsh", "powershell"}
    assert complete(tsc, "stop", "") >= {"--port", "--all"}  # `stop` has no arguments
    assert complete(tsc, "compile", "-o", "") == set()  # a file, which bash itself finds
    assert complete(tsc, "doctor", "--count", "") == set()
    assert complete(tsc, "nonsense", "") == set()


def test_every_option_of_every_verb_is_completed(tsc: Tsc) -> None:
    for command, parser in parsers().items():
        flags = {flag for action in parser._actions for flag in action.option_strings}
        flags |= {flag for option in selecting_options_of(command) for flag in option.flags.split()}
        words = command_words(command).split()
        values = [] if words[-1] in words_of(command) else ["x"]
        assert complete(tsc, *words, *values, "-") == flags, command


def words(tmp_path: Path) -> dict[str, str]:
    """Return variables for a shell in an empty home that has `tsc`."""
    tool = tmp_path / "bin" / "tsc"
    tool.parent.mkdir()
    tool.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -m tiniscript "$@"\n')
    tool.chmod(0o755)
    path = f"{tool.parent}{os.pathsep}{os.environ['PATH']}"
    return {**os.environ, "PATH": path, "HOME": str(tmp_path), "TERM": "dumb", "PS1": "> "}


@pytest.mark.skipif(not BASH, reason="there is no bash")
def test_tab_completes_in_bash(tmp_path: Path) -> None:
    (tmp_path / "my program.ts").write_text("S")
    (tmp_path / "rc").write_text(f'PS1="> "; cd {shlex.quote(str(tmp_path))}\n'
                                 'eval "$(tsc help --completion bash)"\n')  # fmt: skip
    command = [BASH, "--noprofile", "--rcfile", str(tmp_path / "rc"), "-i"]
    shell = Terminal(command=command, env=words(tmp_path))
    shell.until(">")
    shell.type("tsc che\t")
    shell.until("tsc check")
    shell.type("my\t")
    shell.until(r"my\\ program\.ts")
    shell.type("\n")
    shell.until("my program.ts: no mistakes")
    shell.type("tsc check --explain TS01\t\t")
    shell.until("TS011(.|\n)*TS012")
    shell.type("\x15exit\n")
    assert shell.end() == 0


@pytest.mark.skipif(not ZSH, reason="there is no zsh")
def test_tab_completes_in_zsh(tmp_path: Path) -> None:
    (tmp_path / ".zshrc").write_text(
        'PS1="> "; unsetopt zle_bracketed_paste; autoload -Uz compinit && compinit -u -D\n'
        f'cd {shlex.quote(str(tmp_path))}; eval "$(tsc help --completion zsh --lang es)"\n'
    )
    (tmp_path / "course.ts").write_text("S")
    environ = {**words(tmp_path), "ZDOTDIR": str(tmp_path), "TERM": "vt100"}
    shell = Terminal(command=[ZSH, "-i", "-o", "no_global_rcs"], env=environ, size=(80, 40))
    shell.until(">")
    shell.type("tsc st\t\t")
    shell.until("inicia el programa que tiene el robot")
    shell.until("detiene el robot ahora")
    for keys, expected in (
        ("\x15tsc upload --w\t", "tsc upload --world"), ("ob\t", "--world obstacles"),
        ("\x15tsc check cou\t", "tsc check course.ts"),
        ("\x15tsc set trim --exch\t", "tsc set trim --exchange"), ("y\t", "--exchange yes"),
    ):  # fmt: skip
        shell.type(keys)
        shell.until(expected)
    shell.type("\x15exit\r")
    assert shell.end() == 0


def test_brackets_and_quotes_of_the_powershell_script_balance() -> None:
    """No PowerShell is available to read the script. A quote of print would close a text, too."""
    script = help_completion.SCRIPTS["powershell"]
    assert not set("‘’‚‛“”„") & set(script)
    code = [re.sub(r"'(?:[^']|'')*'", "''", line) for line in script.splitlines()]
    code = [line for line in code if not line.startswith("#")]
    assert "'" not in "".join(code).replace("''", "")
    open_signs = []
    for sign in "".join(code):
        if sign in "([{":
            open_signs.append(sign)
        elif sign in ")]}":
            assert open_signs.pop() + sign in ("()", "[]", "{}")
    assert not open_signs


def test_an_unknown_shell_is_refused(tsc: Tsc) -> None:
    tsc("help", "--completion", "fish").gives(
        2, "--completion takes bash, zsh or powershell, not fish"
    )
    tsc("help", "--completion", "--lang", "es").gives(2, "a --completion le falta su valor")
