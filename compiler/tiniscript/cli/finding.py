"""Finds verbs by what they do: `tsc help "put firmware on"`.

Knows the tables of verbs and options in both languages, since a person may mix them.
"""

from __future__ import annotations

import re
import unicodedata
from math import log

from tiniscript.cli.texts.options import of_verb
from tiniscript.cli.texts.verbs import VERBS
from tiniscript.cli.verbless import MEANT

MOST = 5  # verbs in an answer
SHORTEST = 3  # letters of a word that says something
STEM = 5  # letters in which forms of a word agree: connect, connected; conecta, conectar
# Words that say nothing of what a command does.
IDLE = re.compile(
    "the|and|for|how|who|make|can|does|with|from|that|this|what|which|its|into|are|you|your|want"
    "|quien|una|uno|los|las|del|que|por|para|con|como|cual|sin|mas|puedo|quiero|hacer"
)


def verbs_for(said: str) -> list[str]:
    """Return the verbs whose texts have the words of a question, best first; most have none.

    A word counts more where fewer verbs have it, and more in a verb's name and summary than in
    what else is said of it.
    """
    texts = {verb: _weights(verb) for verb in VERBS}
    scores = dict.fromkeys(VERBS, 0.0)
    for stem in _stems(said):
        having = [verb for verb in VERBS if stem in texts[verb]]
        for verb in having:
            scores[verb] += texts[verb][stem] * log(1 + len(VERBS) / len(having))
    best = max(scores.values())
    found = [verb for verb in VERBS if scores[verb] and scores[verb] >= best / 2]
    return sorted(found, key=lambda verb: -scores[verb])[:MOST]


def _weights(verb: str) -> dict[str, int]:
    """Return what each stem of a verb's texts counts."""
    each = VERBS[verb]
    options = " ".join(" ".join((option.flags, *option.help)) for option in of_verb(verb)
                       if option.verbs not in ("*", "tsc"))  # fmt: skip
    elsewhere = " ".join(word for word, meant in MEANT.items() if meant == verb)
    weights = dict.fromkeys(_stems(" ".join((*each.ends, options))), 1)
    weights |= dict.fromkeys(_stems(" ".join(each.says)), 2)
    weights |= dict.fromkeys(_stems(" ".join(each.summary)), 4)
    return weights | dict.fromkeys(_stems(f"{verb} {elsewhere}"), 6)


def _stems(text: str) -> set[str]:
    plain = unicodedata.normalize("NFD", text.casefold())
    words = re.findall("[a-z]+", re.sub("[\u0300-\u036f]", "", plain))
    return {word[:STEM] for word in words if len(word) >= SHORTEST and not IDLE.fullmatch(word)}
