"""`tsc completion`: the script with which a shell completes commands on Tab."""

from __future__ import annotations

import re
import sys
from argparse import Namespace
from collections.abc import Callable, Iterable

from tiniscript import robots
from tiniscript.cli.commands.lesson import ACTIONS
from tiniscript.cli.texts.options import Kind, Option, of_verb
from tiniscript.cli.texts.verbs import VERBS
from tiniscript.diagnostics.codes import CODES
from tiniscript.flash.bootloaders import BOARDS
from tiniscript.virtual import worlds

NAMES = "tsc", "tiniscript"
ALIASES = {"help": "ayuda"}
FILES = {
    "program",
    "robot",
    "world",
    "file",
    "action",
}  # kinds whose value may be the name of a file
DEVICES = "/dev/ttyUSB*", "/dev/ttyACM*", "/dev/rfcomm*", "/dev/cu.*"  # ports of Linux and macOS


def words_of(kind: Kind) -> list[str]:
    """Return the values of a kind that have names."""
    if kind.name == "robot":
        return robots.names()
    if kind.name == "world":
        return list(worlds.names())
    if kind.name == "board":
        return list(BOARDS)
    if kind.name == "code":
        return list(CODES)
    if kind.name == "action":
        return list(ACTIONS)
    return {"verb": list(VERBS), "hurry": ["max"]}.get(kind.name, list(kind.choices))


def argument_of(verb: str) -> Option | None:
    return next((option for option in of_verb(verb) if option.is_argument), None)


def flags_of(verb: str) -> list[str]:
    return [flag for each in of_verb(verb) if not each.is_argument for flag in each.flags.split()]


def _short(text: str) -> str:
    """Return the first part of what an option does, in one line."""
    return re.split(r"; |\. |: `", text)[0].replace("`", "")


# -- bash -----------------------------------------------------------------------------------------

_BASH = """\
# Tab completes commands of tsc. In ~/.bashrc:  eval "$(tsc completion bash)"
_tsc() {
    local cur="${COMP_WORDS[COMP_CWORD]}" before="${COMP_WORDS[COMP_CWORD-1]}"
    local verb="" words="" flags="" argument="" kind="" k
    # bash makes three words of --robot=liner
    if [[ $cur == "=" ]]; then
        cur=""
    elif [[ $before == "=" ]]; then
        before="${COMP_WORDS[COMP_CWORD-2]}"
    fi
    for ((k = 1; k < COMP_CWORD; k++)); do
        case "${COMP_WORDS[k]}" in
            --lang) [[ ${COMP_WORDS[k+1]} == "=" ]] && k=$((k + 1)); k=$((k + 1)) ;;
            -*) ;;
            *) verb="${COMP_WORDS[k]}"; break ;;
        esac
    done
    case "$verb" in
%(verbs)s
    esac
    if [[ -z $kind && $cur != -* ]]; then kind="$argument"; fi
    case "$kind" in
%(kinds)s
        port) words="$(%(ports)s)" ;;
        file) ;;
        "") words="$flags" ;;
    esac
    COMPREPLY=($(compgen -W "$words" -- "$cur"))
    case "$kind" in
        %(files)s) ;; # where no name fits, bash completes files
        *) compopt +o default 2>/dev/null ;;
    esac
}
complete -o default -F _tsc %(names)s
"""


def bash(language: str) -> str:
    """Return the script for bash, from 3.2 on. It has no texts, so it has no language."""
    return _BASH % {
        "verbs": "\n".join(_bash_verb(verb) for verb in ("tsc", *VERBS)),
        "kinds": "\n".join(
            f'        {name}) words="{" ".join(words)}" ;;' for name, words in _named().items()
        ),
        "ports": "; ".join(f"compgen -G '{each}'" for each in DEVICES),
        "files": "|".join(sorted(FILES | {"port"})),
        "names": " ".join(NAMES),
    }


def _bash_verb(verb: str) -> str:
    """Return the branch of a verb: its options, its argument, and the kind of each value."""
    kinds: dict[str, list[str]] = {}
    for option in of_verb(verb):
        if option.kind is not None and not option.is_argument:
            kinds.setdefault(_kind(option.kind), []).append(option.flags)
    argument = argument_of(verb)
    what = _kind(argument.kind) if argument is not None and argument.kind is not None else ""
    label = '""' if verb == "tsc" else "|".join([verb, *_alias(verb)])
    rows = [
        f"        {label})",
        f'            flags="{" ".join(flags_of(verb))}"',
        f'            argument="{"verb" if verb == "tsc" else what}"',
        '            case "$before" in',
        *(f"                {'|'.join(flags)}) kind={kind} ;;" for kind, flags in kinds.items()),
        "            esac ;;",
    ]
    return "\n".join(rows)


def _alias(verb: str) -> list[str]:
    return [ALIASES[verb]] if verb in ALIASES else []


def _kind(kind: Kind) -> str:
    """Return the name of a kind in a script: each list of choices has a name of its own."""
    return "_".join(kind.choices) if kind.choices else kind.name


def _named() -> dict[str, list[str]]:
    """Return the kinds whose values have names, with these."""
    found = {}
    for verb in ("tsc", *VERBS):
        for option in of_verb(verb):
            if option.kind is not None and (words := words_of(option.kind)):
                found[_kind(option.kind)] = words
    return found


# -- zsh ------------------------------------------------------------------------------------------

_ZSH = """\
#compdef %(names)s
# Tab completes commands of tsc. In ~/.zshrc, behind compinit:  eval "$(tsc completion zsh)"
_tsc_ports() {
  local -a ports
  ports=(%(ports)s)
  _alternative "ports:port:(${ports[*]})" 'files:file:_files'
}
_tsc_verbs() {
  local -a verbs
  verbs=(
%(verbs)s
  )
  _describe -t verbs 'tsc' verbs
}
%(kinds)s
_tsc() {
  local curcontext="$curcontext" context state line
  typeset -A opt_args
  _arguments -C \\
%(options)s \\
    '1: :_tsc_verbs' '*:: :->options' && return
  [[ $state == options ]] || return 1
  case $words[1] in
%(branches)s
  esac
}
if [[ $funcstack[1] == _tsc ]]; then _tsc "$@"; else compdef _tsc %(names)s; fi
"""


def zsh(language: str) -> str:
    """Return the script for zsh, which says what each option does."""
    k = language == "es"
    kinds = {name: words for name, words in _named().items() if name in FILES}
    return _ZSH % {
        "names": " ".join(NAMES),
        "ports": " ".join(f"{each}(N)" for each in DEVICES),
        "verbs": "\n".join(
            f"    {_quoted(f'{verb}:{each.summary[k]}')}" for verb, each in VERBS.items()
        ),
        "kinds": "\n".join(
            f"_tsc_{name}() {{ _alternative '{name}s:{name}:({' '.join(words)})' "
            "'files:file:_files' }"
            for name, words in kinds.items()
        ),
        "options": " \\\n".join(f"    {each}" for each in _specs("tsc", k)),
        "branches": "\n".join(
            f"    {'|'.join([verb, *_alias(verb)])})\n      _arguments \\\n"
            + " \\\n".join(f"        {each}" for each in _specs(verb, k))
            + "\n      ;;"
            for verb in VERBS
        ),
    }


def _specs(verb: str, is_spanish: bool) -> list[str]:
    """Return the options of a verb as `_arguments` wants them."""
    found = []
    for option in of_verb(verb):
        value = ""
        if option.kind is not None:
            value = f":{_escaped(option.value[is_spanish])}:{_action(option.kind)}"
        if option.is_argument:
            found.append(_quoted(f"{'*' if option.repeats else 1}{value}"))
            continue
        before = "*" if option.repeats else ""
        for flag in option.flags.split():
            if flag in ("-h", "--help", "-V", "--version"):
                before = "(- *)"
            says = _escaped(_short(option.help[is_spanish]))
            found.append(_quoted(f"{before}{flag}[{says}]{value}"))
    return found


def _action(kind: Kind) -> str:
    if kind.name == "verb":
        return "_tsc_verbs"
    if kind.name == "port":
        return "_tsc_ports"
    if kind.name in FILES:
        return f"_tsc_{kind.name}" if words_of(kind) else "_files"
    words = words_of(kind)
    return f"({' '.join(words)})" if words else " "


def _escaped(text: str) -> str:
    return re.sub(r"([\[\]:\\])", r"\\\1", text)


def _quoted(text: str) -> str:
    return "'" + text.replace("'", "'\\''") + "'"


# -- PowerShell -----------------------------------------------------------------------------------

_POWERSHELL = """\
# Tab completes commands of tsc. In the file $PROFILE:
#   tsc completion powershell | Out-String | Invoke-Expression
Register-ArgumentCompleter -Native -CommandName %(names)s -ScriptBlock {
    param($word, $command, $position)
    $verbs = [ordered]@{
%(verbs)s
    }
    # of each option: the kind of its value, and what it does
    $options = @{
%(options)s
    }
    $arguments = @{
%(arguments)s
    }
    $values = @{
%(values)s
    }
    $before = @($command.CommandElements | Select-Object -Skip 1 |
        Where-Object { $_.Extent.EndOffset -lt $position } | ForEach-Object { $_.ToString() })
    $verb = ''
    for ($k = 0; $k -lt $before.Count; $k++) {
        if ($before[$k] -eq '--lang') { $k++ }
        elseif (-not $before[$k].StartsWith('-')) { $verb = $before[$k]; break }
    }
    if (-not $options.ContainsKey($verb)) { return }
    $last = if ($before.Count) { $before[-1] } else { '' }
    $kind = if ($options[$verb].Contains($last)) { $options[$verb][$last][0] } else { '' }
    $found = [ordered]@{}
    if (-not $kind -and -not $word.StartsWith('-')) { $kind = $arguments[$verb] }
    if (-not $kind) {
        foreach ($each in $options[$verb].GetEnumerator()) { $found[$each.Key] = $each.Value[1] }
    } else {
        if ($kind -eq 'verb') { $found = $verbs }
        elseif ($kind -eq 'port') {
            try { foreach ($each in [System.IO.Ports.SerialPort]::GetPortNames()) {
                $found[$each] = $each
            } } catch { }
        }
        elseif ($values.ContainsKey($kind)) {
            foreach ($each in $values[$kind]) { $found[$each] = $each }
        }
    }
    # where nothing fits, PowerShell completes files
    foreach ($each in $found.GetEnumerator()) {
        if ($each.Key.StartsWith($word)) {
            [System.Management.Automation.CompletionResult]::new(
                $each.Key, $each.Key, 'ParameterValue', $each.Value)
        }
    }
}
"""


def powershell(language: str) -> str:
    """Return the script for PowerShell, from 5.1 on."""
    k = language == "es"
    names = {"": "tsc", **{verb: verb for verb in VERBS}}
    names |= {alias: verb for verb, alias in ALIASES.items()}
    return _POWERSHELL % {
        "names": ", ".join(NAMES),
        "verbs": _pairs((verb, _literal(each.summary[k])) for verb, each in VERBS.items()),
        "options": "\n".join(
            f"        {_literal(name)} = [ordered]@{{\n{_power_options(verb, k)}\n        }}"
            for name, verb in names.items()
        ),
        "arguments": _pairs(
            (name, _literal(_power_argument(verb))) for name, verb in names.items()
        ),
        "values": _pairs(
            (name, f"@({', '.join(map(_literal, words))})") for name, words in _named().items()
        ),
    }


def _power_options(verb: str, is_spanish: bool) -> str:
    rows = []
    for option in of_verb(verb):
        if not option.is_argument:
            kind = _kind(option.kind) if option.kind is not None else ""
            says = f"@({_literal(kind)}, {_literal(_short(option.help[is_spanish]))})"
            rows += [(flag, says) for flag in option.flags.split()]
    return _pairs(rows, 12)


def _power_argument(verb: str) -> str:
    argument = argument_of(verb)
    if verb == "tsc":
        return "verb"
    return _kind(argument.kind) if argument is not None and argument.kind is not None else ""


def _pairs(rows: Iterable[tuple[str, str]], indent: int = 8) -> str:
    return "\n".join(f"{' ' * indent}{_literal(name)} = {value}" for name, value in rows)


def _literal(text: str) -> str:
    return "'" + text.replace("'", "''") + "'"


SCRIPTS: dict[str, Callable[[str], str]] = {"bash": bash, "zsh": zsh, "powershell": powershell}


def run(options: Namespace, language: str) -> int:
    sys.stdout.write(SCRIPTS[options.shell](language))
    return 0
