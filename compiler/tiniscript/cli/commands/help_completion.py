"""`tsc help --completion`: the script for completing commands of `tsc` with the Tab key.

A shell's script asks `tsc` at each Tab for completions of the typed words: they come after `--`,
the last one with a dot before it, because PowerShell 5 drops an empty one. The first line of the
answer says whether a file would fit, too; each other one has a word, a tab, and what it does.
"""

from __future__ import annotations

import re
import sys
from argparse import Namespace

from tiniscript import robots
from tiniscript.cli.texts.options import (
    LESSON_ACTIONS,
    VERB,
    Kind,
    command_of,
    first_word,
    options_of,
    selecting_options_of,
)
from tiniscript.cli.texts.verbs import VERBS
from tiniscript.cli.texts.verbs import verb_sentence as summary_of
from tiniscript.cli.verbless import is_help
from tiniscript.diagnostics.codes import CODES
from tiniscript.flash.bootloaders import BOARDS
from tiniscript.link import ports
from tiniscript.virtual import worlds

FILE_KINDS = ("program", "robot", "world", "file", "action", "port")  # kinds that may name a file
SCRIPTS = {
    "bash": """\
# Tab completes commands of tsc. In ~/.bashrc:  eval "$(tsc help --completion bash)"
_tsc() {
    local IFS=$'\\n' found last=$COMP_CWORD
    found=($("$1" help --completion bash --lang LANGUAGE -- \\
        "${COMP_WORDS[@]:1:last-1}" ".${COMP_WORDS[last]}" 2>/dev/null))
    # where no word fits, bash completes files
    [[ ${found[0]-} == files ]] || compopt +o default 2>/dev/null
    COMPREPLY=("${found[@]:1}")
    COMPREPLY=("${COMPREPLY[@]%%$'\\t'*}")
}
complete -o default -F _tsc tsc tiniscript
""",
    "zsh": """\
#compdef tsc tiniscript
# Tab completes commands of tsc. In ~/.zshrc, behind compinit:  eval "$(tsc help --completion zsh)"
_tsc() {
  local -a found
  found=("${(@f)$("$words[1]" help --completion zsh --lang LANGUAGE -- \\
    "${(@)words[2,CURRENT-1]}" ".$words[CURRENT]" 2>/dev/null)}")
  local kind=$found[1]
  found=("${(@)${(@)${(@)found[2,-1]}//:/\\\\:}/$'\\t'/:}")
  (( $#found )) && _describe -V tsc found
  [[ $kind == files ]] && _files
}
if [[ $funcstack[1] == _tsc ]]; then _tsc "$@"; else compdef _tsc tsc tiniscript; fi
""",
    "powershell": """\
# Tab completes commands of tsc. In the file $PROFILE:
#   tsc help --completion powershell | Out-String | Invoke-Expression
Register-ArgumentCompleter -Native -CommandName tsc, tiniscript -ScriptBlock {
    param($word, $command, $position)
    $typed = @($command.CommandElements | Select-Object -Skip 1 |
        Where-Object { $_.Extent.EndOffset -lt $position } | ForEach-Object { $_.ToString() })
    $tsc = $command.CommandElements[0].ToString()
    # where nothing fits, PowerShell completes files
    & $tsc help --completion powershell --lang LANGUAGE '--' @typed ".$word" 2>$null |
        Select-Object -Skip 1 | ForEach-Object {
            $found, $says = $_ -split "`t", 2
            [System.Management.Automation.CompletionResult]::new(
                $found, $found, 'ParameterValue', $(if ($says) { $says } else { $found }))
        }
}
""",
}


def run(options: Namespace, language: str) -> int:
    if not options.words:
        sys.stdout.write(SCRIPTS[options.shell].replace("LANGUAGE", language))
        return 0
    *words_before, last_word = options.words
    last_word = last_word[1:]
    if last_word == "=":  # bash makes three words of --robot=liner
        last_word = ""
    kind, completions = _completions(
        [word for word in words_before if word != "="], last_word, language
    )
    print("files" if kind in FILE_KINDS else "words")
    for word, summary in completions:
        if word.startswith(last_word):
            print(f"{word}\t{summary}")
    return 0


def _completions(
    words_before: list[str], last_word: str, language: str
) -> tuple[str, list[tuple[str, str]]]:
    """Return the kind that the last word may have, and the words of that kind."""
    verb, words_before = _split_verb(words_before)
    if verb not in ("tsc", *VERBS):
        return "", []
    command, _ = command_of(verb, words_before)
    options = [*options_of(command), *selecting_options_of(command)]
    flags = {
        flag: option
        for option in options
        if not option.is_argument
        for flag in option.flags.split()
    }
    name, separator, _ = last_word.partition("=")
    option = flags.get(name if separator else words_before[-1] if words_before else "")
    kind = option.kind if option is not None else None
    if kind is None and not last_word.startswith("-"):
        arguments = [option.kind for option in options if option.is_argument]
        kind = VERB if verb == "tsc" else arguments[0] if arguments else None
    if kind is None:
        return "", [(flag, _first_clause(option.help(language))) for flag, option in flags.items()]
    prefix = f"{name}=" if separator else ""
    return kind.name, [
        (prefix + word, summary) for word, summary in _values_of_kind(kind, language)
    ]


def _split_verb(words: list[str]) -> tuple[str, list[str]]:
    """Return the verb, or `tsc` if there is none, and the words after it."""
    word_index = first_word("tsc", words)
    if word_index is None:
        return "tsc", words
    word = words[word_index]
    return ("help" if word not in VERBS and is_help(word) else word), words[word_index + 1 :]


def _values_of_kind(kind: Kind, language: str) -> list[tuple[str, str]]:
    """Return the named values of a kind, with their descriptions if known."""
    if kind is VERB:
        return [(verb, _first_clause(summary_of(verb, "summary", language))) for verb in VERBS]
    if kind.name == "port":
        return [(listed_port.port, listed_port.description) for listed_port in ports.list_ports()]
    names_of_kind = {
        "robot": robots.names(),
        "world": worlds.names(),
        "chip": BOARDS,
        "code": CODES,
        "action": LESSON_ACTIONS,
        "hurry": ("max",),
    }
    return [(word, "") for word in names_of_kind.get(kind.name, kind.choices)]


def _first_clause(summary: str) -> str:
    """Return the first clause of the description of an option or a verb, in one line."""
    return re.split(r"; |\. |: `", summary)[0].replace("`", "")
