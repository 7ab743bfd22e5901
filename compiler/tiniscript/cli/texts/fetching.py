"""The sentences of `tsc` about what is missing and can be fetched, in English and Spanish."""

from __future__ import annotations

# fmt: off
FETCHING_TEXTS: dict[str, tuple[str, str]] = {
    # key: (English, Spanish)
    "fetch_size": ("That fetches about {mb} MB ({parts}) and takes about {minutes} minutes, once.",
                   "Para eso se descargan unos {mb} MB ({parts}); tarda unos {minutes} minutos, una sola vez."),
    "fetch_none": ("That fetches nothing more and takes about {minutes} minutes, once.",
                   "Para eso ya no se descarga nada; tarda unos {minutes} minutos, una sola vez."),
    "fetch_asks": ("Go on? [y/N] ", "¿Sigo? [s/N] "),
    "fetch_declined": ("tsc: then nothing was fetched, and nothing has changed.",
                       "tsc: entonces no se descargó nada, y nada cambió."),
    "fetch_unasked": ("tsc: nobody can be asked here. {said} The same command with --yes does it.",
                      "tsc: aquí no se le puede preguntar a nadie. {said} El mismo comando con --yes lo hace."),
    "fetch_offline": ("tsc: {doing}: that did not work ({why}). Is this computer online? A proxy is given by the variable HTTPS_PROXY, as http://proxy:3128. Do the same again where it is; all that was said is in {log}",
                      "tsc: {doing}: no se pudo ({why}). ¿Tiene internet esta computadora? Un proxy se indica con la variable HTTPS_PROXY, como http://proxy:3128. Haz lo mismo otra vez donde haya internet; todo lo que se dijo está en {log}"),
    "fetch_no_room": ("tsc: {doing}: the disk is full ({why}). Make room on it, and do the same again; all that was said is in {log}",
                      "tsc: {doing}: el disco está lleno ({why}). Haz espacio, y haz lo mismo otra vez; todo lo que se dijo está en {log}"),
    "fetch_failed": ("tsc: {doing}: that did not work ({why}). All that was said is in {log}",
                     "tsc: {doing}: no se pudo ({why}). Todo lo que se dijo está en {log}"),
    # what is fetched, and while it is
    "fetch_node": ("node.js from PyPI: {mb} MB", "node.js, de PyPI: {mb} MB"),
    "fetch_node_now": ("fetching node.js from PyPI", "descargando node.js de PyPI"),
    "fetch_npm": ("packages from npm: {mb} MB", "paquetes de npm: {mb} MB"),
    "fetch_npm_now": ("fetching packages from npm", "descargando paquetes de npm"),
    "fetch_platformio": ("PlatformIO from PyPI: {mb} MB", "PlatformIO, de PyPI: {mb} MB"),
    "fetch_platformio_now": ("fetching PlatformIO from PyPI", "descargando PlatformIO de PyPI"),
    "fetch_compiler": ("compiler and core of the board from PlatformIO: {mb} MB", "compilador y núcleo de la placa, de PlatformIO: {mb} MB"),
}
# fmt: on
