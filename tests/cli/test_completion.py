"""Completion: what the scripts offer in a real shell, and that they know every verb and option."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.command import Tsc
from tests.support.verbs import parsers
from tiniscript import robots
from tiniscript.cli.commands import completion
from tiniscript.cli.texts.verbs import VERBS
from tiniscript.diagnostics.codes import CODES

BASH = shutil.which("bash") or ""
ZSH = shutil.which("zsh") or ""
needs_bash = pytest.mark.skipif(not BASH, reason="there is no bash")
needs_zsh = pytest.mark.skipif(not ZSH, reason="there is no zsh")

ASKS = """
source "$1"; shift
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))
_tsc
printf '%s\\n' "${COMPREPLY[@]}"
"""


def offered(tmp_path: Path, *words: str) -> set[str]:
    """Return what bash offers for the last of these words."""
    script = tmp_path / "tsc.bash"
    script.write_text(completion.bash("en"), encoding="utf-8")
    done = subprocess.run(
        [BASH, "-uc", ASKS, "bash", str(script), "tsc", *words], capture_output=True, text=True
    )
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    return set(done.stdout.split())


@needs_bash
def test_bash_offers_verbs_options_and_values(tmp_path: Path) -> None:
    assert offered(tmp_path, "") == set(VERBS)
    assert offered(tmp_path, "st") == {"start", "stop", "studio"}
    assert offered(tmp_path, "--lang", "es", "up") == {"upload"}
    assert offered(tmp_path, "--lang", "=", "es", "up") == {"upload"}
    assert offered(tmp_path, "--l") == {"--lang"}
    assert offered(tmp_path, "--lang", "") == {"en", "es"}
    assert offered(tmp_path, "upload", "--no-") == {"--no-run", "--no-save"}
    assert offered(tmp_path, "upload", "a.ts", "--virtual", "--world", "l") == {"light", "line"}
    assert offered(tmp_path, "check", "--robot", "") == set(robots.names())
    assert offered(tmp_path, "check", "--robot", "=") == set(robots.names())
    assert offered(tmp_path, "check", "--robot", "=", "lin") == {"liner"}
    assert offered(tmp_path, "run", "--machine", "") == {"python", "cpp"}
    assert offered(tmp_path, "trim", "--exchange", "") == {"yes", "no"}
    assert offered(tmp_path, "firmware", "--board", "nano") == {"nano", "nano-old"}
    assert offered(tmp_path, "explain", "TS") == set(CODES)
    assert offered(tmp_path, "help", "fe") == offered(tmp_path, "ayuda", "fe") == {"fetch"}
    assert offered(tmp_path, "completion", "") == {"bash", "zsh", "powershell"}
    assert offered(tmp_path, "stop", "") >= {"--port", "--all"}  # it has no argument
    assert offered(tmp_path, "compile", "-o", "") == set()  # a file, which bash itself finds
    assert offered(tmp_path, "ping", "--count", "") == set()
    assert offered(tmp_path, "nonsense", "") == set()


@needs_bash
def test_bash_offers_every_option_of_every_verb(tmp_path: Path) -> None:
    for verb, parser in parsers().items():
        flags = {flag for each in parser._actions for flag in each.option_strings}
        assert offered(tmp_path, verb, "-") == flags, verb


def words(tmp_path: Path) -> dict[str, str]:
    """Return variables for a shell in an empty home that has `tsc`."""
    tool = tmp_path / "bin" / "tsc"
    tool.parent.mkdir()
    tool.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -m tiniscript "$@"\n')
    tool.chmod(0o755)
    path = f"{tool.parent}{os.pathsep}{os.environ['PATH']}"
    return {**os.environ, "PATH": path, "HOME": str(tmp_path), "TERM": "dumb", "PS1": "> "}


@needs_bash
def test_tab_in_bash(tmp_path: Path) -> None:
    from tests.support.shell import Shell

    (tmp_path / "my program.ts").write_text("S")
    (tmp_path / "rc").write_text(f'PS1="> "; cd {shlex.quote(str(tmp_path))}\n'
                                 'eval "$(tsc completion bash)"\n')  # fmt: skip
    shell = Shell([BASH, "--noprofile", "--rcfile", str(tmp_path / "rc"), "-i"], words(tmp_path))
    shell.until("> ")
    shell.type("tsc che\t")
    shell.until("tsc check ")
    shell.type("my\t")
    shell.until(r"my\\ program\.ts ")
    shell.type("\n")
    shell.until("my program.ts: no mistakes")
    shell.type("tsc explain TS01\t\t")
    assert "TS011" in shell.until("TS012")
    shell.type("\x15exit\n")
    assert shell.end() == 0


@needs_zsh
def test_tab_in_zsh(tmp_path: Path) -> None:
    from tests.support.shell import Shell

    (tmp_path / ".zshrc").write_text(
        'PS1="> "; unsetopt zle_bracketed_paste; autoload -Uz compinit && compinit -u -D\n'
        f'cd {shlex.quote(str(tmp_path))}; eval "$(tsc completion zsh --lang es)"\n'
    )
    (tmp_path / "course.ts").write_text("S")
    environ = {**words(tmp_path), "ZDOTDIR": str(tmp_path), "TERM": "vt100"}
    shell = Shell([ZSH, "-i", "-o", "no_global_rcs"], environ, rows=40)
    shell.until("> ")
    shell.type("tsc st\t\t")
    assert "inicia el programa que tiene el robot" in shell.until("detiene el robot ahora")
    shell.type("\x15tsc upload --w\t")
    shell.until("--world ")
    shell.type("ob\t")
    shell.until("obstacles ")
    shell.type("\x15tsc check cou\t")
    shell.until("course.ts ")
    shell.type("\x15tsc trim --exch\t")
    shell.until("--exchange ")
    shell.type("y\t")
    shell.until("yes ")
    shell.type("\x15exit\r")
    assert shell.end() == 0


@pytest.mark.parametrize("shell", ["bash", "zsh", "powershell"])
@pytest.mark.parametrize("language", ["en", "es"])
def test_scripts_name_every_verb_and_option(tsc: Tsc, shell: str, language: str) -> None:
    done = tsc("completion", shell, "--lang", language)
    assert done.code == 0
    for verb, parser in parsers().items():
        branch = branch_of(done.out, shell, verb)
        found = set(re.findall(r"(?<![\w-])-{1,2}[a-z][a-z-]*", branch))
        flags = {flag for each in parser._actions for flag in each.option_strings}
        assert flags <= found, verb
        assert found - flags <= {"--ask", "--show", "--virtual", "-e"}, verb  # named in texts


def branch_of(script: str, shell: str, verb: str) -> str:
    """Return the part of a script that is about a verb."""
    begin, end = {
        "bash": (rf"^        {verb}(?:\|\w+)?\)$", r"esac ;;$"),
        "zsh": (rf"^    {verb}(?:\|\w+)?\)$", r"^      ;;$"),
        "powershell": (rf"^        '{verb}' = \[ordered\]@{{$", r"^        }$"),
    }[shell]
    found = re.search(f"{begin}(.*?){end}", script, re.M | re.S)
    assert found, verb
    return found[1]


@pytest.mark.parametrize("language", ["en", "es"])
def test_brackets_and_quotes_of_powershell_close(language: str) -> None:
    """There is no PowerShell here to read the script. A quote of print would close a text, too."""
    script = completion.powershell(language)
    assert not set("‘’‚‛“”„") & set(script)
    code = [re.sub(r"'(?:[^']|'')*'", "''", line) for line in script.splitlines()]
    code = [line for line in code if not line.startswith("#")]
    assert "'" not in "".join(code).replace("''", "")
    opened = []
    for sign in "".join(code):
        if sign in "([{":
            opened.append(sign)
        elif sign in ")]}":
            assert opened.pop() + sign in ("()", "[]", "{}")
    assert not opened


def test_a_shell_that_is_not_known(tsc: Tsc) -> None:
    done = tsc("completion", "fish")
    assert done.code == 2
    assert "SHELL takes bash, zsh or powershell, not fish" in done.err
    done = tsc("completion", "--lang", "es")
    assert done.code == 2
    assert "falta shell" in done.err
