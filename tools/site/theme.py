"""What the site's theme says in English whatever the language, and how its Spanish half says it."""

from __future__ import annotations

import html
import re
from pathlib import Path

COLORS = "Cambiar entre colores claros, oscuros y automáticos"
SPANISH = {
    "Auto light/dark, in dark mode": "Automático, ahora oscuro",
    "Auto light/dark, in light mode": "Automático, ahora claro",
    "Back to top": "Volver arriba",
    "Contents": "Contenido",
    "Copyright © the TiniScript developers": "© los desarrolladores de TiniScript",
    "Dark mode": "Colores oscuros",
    "Expand": "Desplegar",
    "Home": "Inicio",
    "Light mode": "Colores claros",
    "Link to this heading": "Enlace a este título",
    "Made with": "Hecho con",
    "Menu": "Menú",
    "Next": "Siguiente",
    "On this page": "En esta página",
    "Please activate JavaScript to enable the search functionality.":
        "Para buscar, activa JavaScript.",
    "Previous": "Anterior",
    "Skip to content": "Saltar al contenido",
    "Studio": "Estudio",
    "Toggle Light / Dark / Auto color theme": COLORS,
    "Toggle site navigation sidebar": "Mostrar u ocultar la navegación",
    "Toggle table of contents sidebar": "Mostrar u ocultar el contenido de la página",
}  # fmt: skip
# A whole text between two tags, or a label.
SAID = re.compile(r'(>\s*|(?:aria-label|title)=")([^<>"]*?)(\s*<|")')


def translate(folder: Path) -> None:
    """Say in Spanish what the theme says on the pages in a folder."""
    for path in folder.rglob("*.html"):
        text = path.read_text(encoding="utf-8")
        path.write_text(SAID.sub(_in_spanish, text), encoding="utf-8")


def _in_spanish(said: re.Match[str]) -> str:
    plain = html.unescape(said[2])
    return f"{said[1]}{html.escape(SPANISH[plain])}{said[3]}" if plain in SPANISH else said[0]
