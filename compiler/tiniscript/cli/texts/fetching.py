"""The sentences of `tsc` about what is missing and can be fetched, in English and Spanish."""

from __future__ import annotations

# fmt: off
FETCHING_TEXTS: dict[str, tuple[str, str]] = {
    # key: (English, Spanish)
    "fetch_size": ("That downloads about {mb} MB ({parts}) and takes about {minutes} minutes, once.",
                   "Para eso se descargan unos {mb} MB ({parts}); tarda unos {minutes} minutos, solo la primera vez."),
    "fetch_none": ("Nothing more to download; it takes about {minutes} minutes, once.",
                   "Ya no hay que descargar nada; tarda unos {minutes} minutos, solo la primera vez."),
    "fetch_asks": ("Go on? [y/N] ", "¿Sigo? [s/N] "),
    "fetch_declined": ("tsc: nothing was downloaded, and nothing has changed.",
                       "tsc: no se descargó nada, y nada cambió."),
    "fetch_unasked": ("tsc: there is no terminal here to ask at. {said} To go ahead, run the same command with --yes.",
                      "tsc: aquí no hay una terminal donde preguntar. {said} Para seguir, ejecuta el mismo comando con --yes."),
    "fetch_offline": ("tsc: {doing}: that did not work ({why}). Is this computer online? A proxy is given by the variable HTTPS_PROXY, as http://proxy:3128. Try again when it is; the full output is in {log}",
                      "tsc: {doing}: no se pudo ({why}). ¿Tiene internet esta computadora? Inténtalo otra vez cuando tenga. Un proxy se indica con la variable HTTPS_PROXY, como http://proxy:3128; la salida completa está en {log}"),
    "fetch_no_room": ("tsc: {doing}: the disk is full ({why}). Free some space and try again; the full output is in {log}",
                      "tsc: {doing}: el disco está lleno ({why}). Libera espacio e inténtalo otra vez; la salida completa está en {log}"),
    "fetch_failed": ("tsc: {doing}: that did not work ({why}). The full output is in {log}",
                     "tsc: {doing}: no se pudo ({why}). La salida completa está en {log}"),
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
