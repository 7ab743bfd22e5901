"""Which documents the site has, in which language, under which name, and beside which others.

Knows the repository's documents. A document that is here twice is one document in two languages.
`test_site.py` fails where a document of the repository is in no row.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

LANGUAGES = ("en", "es")
LIST = "docs/README.md"  # of all others, made from here


class Document(NamedTuple):
    """`sources` are its files in the repository, by language; `name` is that of its page."""

    name: str
    part: str
    sources: dict[str, str]


def _both(name: str, part: str, english: str, spanish: str) -> Document:
    return Document(name, part, {"en": english, "es": spanish})


def _english(part: str, *sources: str) -> list[Document]:
    return [Document(Path(source).stem.lower(), part, {"en": source}) for source in sources]


def _wiring(root: Path) -> list[Document]:
    found = sorted(path.name.split(".")[0] for path in root.glob("docs/wiring/*.en.md"))
    return [
        _both(f"wiring/{each}", "wiring", f"docs/wiring/{each}.en.md", f"docs/wiring/{each}.es.md")
        for each in found
    ]


def _lessons(root: Path) -> list[Document]:
    found: list[Document] = []
    for folder in sorted(root.glob("compiler/tiniscript/lessons/[0-9]*")):
        place = folder.relative_to(root).as_posix()
        for reader in ("pupil", "teacher"):
            sources = (f"{place}/{reader}.{language}.md" for language in LANGUAGES)
            found.append(_both(f"lessons/{folder.name}_{reader}", f"{reader}s", *sources))
    return found


def documents(root: Path) -> list[Document]:
    """Return the documents of a clone, in the order in which the site shows them."""
    return [
        _both("monday", "teach", "docs/monday.en.md", "docs/lunes.es.md"),
        _both("bring-up", "teach", "docs/bring-up.md", "docs/puesta-en-marcha.es.md"),
        _both("lessons", "teach", "docs/lessons.en.md", "docs/lecciones.es.md"),
        _both("materials", "teach", "docs/materials.en.md", "docs/materiales.es.md"),
        _both("measure", "teach", "docs/measure.en.md", "docs/medir.es.md"),
        _both("modules", "teach", "docs/modules.en.md", "docs/modulos.es.md"),
        _both("language", "write", "docs/language.en.md", "docs/lenguaje.es.md"),
        _both("robots", "write", "docs/robots.en.md", "docs/robots.es.md"),
        _both("studio", "write", "docs/studio.en.md", "docs/estudio.es.md"),
        _both("command", "write", "docs/command.en.md", "docs/comandos.es.md"),
        _both("class", "teach", "docs/class.en.md", "docs/clase.es.md"),
        _both("worlds", "write", "docs/worlds.en.md", "docs/mundos.es.md"),
        _both("library", "write", "docs/api.en.md", "docs/api.es.md"),
        *_wiring(root),
        *_lessons(root),
        _both("index", "trust", "README.md", "README.es.md"),
        _both("comparison", "trust", "docs/comparison.en.md", "docs/comparacion.es.md"),
        *_english("trust", "docs/promises.md", "docs/figures.md", "docs/computer.md",
                  "SECURITY.md", "CODE_OF_CONDUCT.md"),
        *_english("build", "CONTRIBUTING.md", "docs/first-change.md", "docs/translating.md",
                  "docs/architecture.md",
                  "bytecode_spec.md", "docs/conformance.md", "docs/link.md", "docs/owners.md",
                  "docs/network.md", "docs/text.md", "docs/store.md", "docs/esp32.md",
                  "docs/versions.md", "CHANGELOG.md"),
        Document("documents", "build", {"en": LIST}),
    ]  # fmt: skip


# Pages and places that others may link to under a name of before, in each half.
MOVED = {
    "en": {
        "house": "architecture",
        "class#what-such-a-page-has-not": "class#limits",
        "class#what-such-a-page-lacks": "class#limits",
        "class#what-you-see-and-do": "class#what-you-can-do",
        "computer#ten-thousand-connections": "computer#a-class",
        "computer#who-comes-in": "computer#who-gets-in",
        "conformance#the-file-of-cases": "conformance#the-files-of-cases",
        "contributing#a-release": "contributing#more",
        "contributing#a-robot-for-tests": "contributing#more",
        "contributing#architecture": "architecture",
        "contributing#how-the-house-is-built": "architecture",
        "contributing#longer-campaigns": "contributing#more",
        "contributing#the-c-machine": "contributing#more",
        "contributing#the-firmware": "contributing#more",
        "contributing#the-recovery-in-shadow": "contributing#more",
        "contributing#the-simulated-uno": "contributing#more",
        "contributing#the-studio-s-page": "contributing#more",
        "esp32#bring-up-20-minutes-with-a-board": (
            "esp32#bring-up-20-minutes-with-a-board-and-20-for-its-radios"
        ),
        "language#a-dance": "language#projects",
        "language#a-program-as-one-line": "text#the-checksum-of-a-line",
        "language#a-square": "language#projects",
        "language#a-warning-is-advice": "language#common-mistakes",
        "language#an-obstacle-course": "language#projects",
        "language#commas-semicolons-and-numbers": "language#common-mistakes",
        "language#fetching-something": "language#projects",
        "language#following-a-lamp": "language#projects",
        "language#following-a-line": "language#projects",
        "language#names": "language#variables",
        "language#on-the-robot": "language#trying-a-program",
        "language#questions-and-blocks": "language#common-mistakes",
        "lessons#a-task-is-checked": "lessons#how-a-task-is-checked",
        "link#at-a-broker": "network#at-a-broker",
        "link#one-port-many-commands": "network#one-port-many-commands",
        "link#owners": "owners#owners",
        "link#ports": "network#ports",
        "link#sealed-frames": "owners#sealed-frames",
        "link#several-transports": "network#several-transports",
        "link#why-it-is-so": "link#frames",
        "link#what-is-kept": "link#programs",
        "monday#three-lessons": "lessons",
        "promises#what-needs-no-numbers": "promises#guarantees-without-a-number",
        "promises#what-the-tests-notice": "promises#guarantees-without-a-number",
        "readme": "index",
        "robots#a-class-past-one-computer": "robots#a-class-with-several-computers",
        "store#in-which-order": "store#the-order-of-writes",
        "store#why-in-this-order": "store#why-this-order",
        "studio#a-world-of-your-own": "studio#your-own-world",
        "studio#looking-for-a-mistake": "studio#find-a-mistake",
        "text#three-programs-byte-by-byte": "text#a-program-byte-by-byte",
        "wiring/grabber#mind": "wiring/grabber#take-care",
        "wiring/liner#mind": "wiring/liner#take-care",
        "wiring/tinibot#mind": "wiring/tinibot#take-care",
        "wiring/tinibot32#mind": "wiring/tinibot32#take-care",
        "wiring/tinibotc3#mind": "wiring/tinibotc3#take-care",
        "worlds#what-the-robot-notices": "worlds#what-the-robot-senses",
    },
    "es": {
        "class#lo-que-una-página-así-no-tiene": "class#límites",
        "class#qué-ves-y-qué-puedes-hacer": "class#qué-puedes-hacer",
        "language#comas-punto-y-coma-y-números": "language#errores-comunes",
        "language#en-el-robot": "language#probar-un-programa",
        "language#nombres": "language#variables",
        "language#preguntas-y-bloques": "language#errores-comunes",
        "language#seguir-una-linterna": "language#proyectos",
        "language#seguir-una-línea": "language#proyectos",
        "language#traer-algo": "language#proyectos",
        "language#un-aviso-es-un-consejo": "language#errores-comunes",
        "language#un-baile": "language#proyectos",
        "language#un-cuadrado": "language#proyectos",
        "language#una-carrera-de-obstáculos": "language#proyectos",
        "modules#lo-que-hace": "modules#qué-hace",
        "monday#tres-lecciones": "lessons",
        "studio#buscar-un-error": "studio#encontrar-un-error",
        "studio#un-mundo-propio": "studio#tu-propio-mundo",
        "worlds#lo-que-nota-el-robot": "worlds#lo-que-percibe-el-robot",
        "readme": "index",
    },
}


PARTS = {
    "en": {
        "teach": "Teach",
        "write": "Write programs",
        "wiring": "Wire a robot",
        "pupils": "Lessons, for pupils",
        "teachers": "Lessons, for the teacher",
        "trust": "Decide",
        "build": "Build it with us",
    },
    "es": {
        "teach": "Enseñar",
        "write": "Escribir programas",
        "wiring": "Conectar un robot",
        "pupils": "Lecciones, para alumnos",
        "teachers": "Lecciones, para el docente",
        "trust": "Decidir",
        "build": "Construirlo con nosotros",
    },
}
