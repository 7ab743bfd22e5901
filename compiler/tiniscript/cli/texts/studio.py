"""The sentences of `tsc` about the studio, in English and Spanish."""

from __future__ import annotations

# fmt: off
STUDIO_TEXTS: dict[str, tuple[str, str]] = {
    # key: (English, Spanish)
    "studio_not_built": ("tsc: the studio's page is not in this installation. In a clone of the repository build it:  python -m tools.builds.studio   A wheel that is made after that has it: its users need nothing more.",
                         "tsc: la página del estudio no está en esta instalación. En un clon del repositorio, constrúyela:  python -m tools.builds.studio   Un wheel hecho después la trae: quien lo usa no necesita nada más."),
    "studio_taken": ("tsc: the port {port} cannot be had: {why}. Is another tsc studio running? Then open {address}. Or choose another with --listen: what a browser keeps of your work belongs to the port.",
                     "tsc: no se puede usar el puerto {port}: {why}. ¿Hay otro tsc studio? Entonces abre {address}. O elige otro con --listen: lo que un navegador guarda de tu trabajo es de cada puerto."),
    "studio_here": ("TiniScript Studio is at {address}   Ctrl-C ends.",
                    "TiniScript Studio está en {address}   Ctrl-C termina."),
}
