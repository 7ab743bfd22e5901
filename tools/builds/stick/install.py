"""Installs `tsc` from this stick, without internet, for the person who is logged in.

    python install.py [FOLDER]

makes a virtual environment in FOLDER (TiniScript in the home folder if none is given), where `tsc`
then is, and copies pages and examples into it. Asks for no administrator and writes nowhere else.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

STICK = Path(__file__).resolve().parent
IS_WINDOWS = os.name == "nt"
SAID = {
    "old": ("This Python is {version}; tsc needs 3.10 or newer.",
            "Este Python es {version}; tsc necesita 3.10 o posterior."),
    "no_venv": ("This Python cannot make virtual environments. On Debian and Ubuntu:  sudo apt-get install python3-venv",
                "Este Python no puede crear entornos virtuales. En Debian y Ubuntu:  sudo apt-get install python3-venv"),
    "where": ("Installing into {folder}. This takes a minute.",
              "Se instala en {folder}. Tarda un minuto."),
    "failed": ("The stick has no packages for this computer ({system}, Python {version}). README.txt says for which it has.",
               "La memoria no tiene paquetes para esta computadora ({system}, Python {version}). README.txt dice para cuáles tiene."),
    "no_robot": ("The virtual robot does not run on this computer: {why}",
                 "El robot virtual no funciona en esta computadora: {why}"),
    "done": ("Done. In each new window first:  {activate}",
             "Listo. En cada ventana nueva, primero:  {activate}"),
    "pages": ("The guides:  {page}", "Las guías:  {page}"),
}  # fmt: skip


def main(words: list[str]) -> int:
    folder = Path(words[0]).absolute() if words else Path.home() / "TiniScript"
    version = ".".join(map(str, sys.version_info[:2]))
    if sys.version_info < (3, 10):  # noqa: UP036 - whoever has an older one reads this
        return _fail("old", version=version)
    _say("where", folder=folder)
    if subprocess.run([sys.executable, "-m", "venv", str(folder / "tsc")]).returncode:
        return _fail("no_venv")
    programs = folder / "tsc" / ("Scripts" if IS_WINDOWS else "bin")
    python = programs / ("python.exe" if IS_WINDOWS else "python")
    pip = [str(python), "-m", "pip", "--isolated", "--disable-pip-version-check", "install"]
    pip += ["--quiet", "--no-index", "--find-links", str(STICK / "wheels")]
    pip += ["--upgrade"]
    variables = {name: value for name, value in os.environ.items() if not name.startswith("PIP_")}
    first = subprocess.run([*pip, "tiniscript[radio,virtual]"], env=variables, capture_output=True)
    if first.returncode and subprocess.run([*pip, "tiniscript[virtual]"], env=variables).returncode:
        return _fail("failed", system=sys.platform, version=version)
    for name in ("pages", "examples"):
        shutil.copytree(STICK / name, folder / name, dirs_exist_ok=True)
    tried = [str(python), "-m", "tiniscript", "run", "--machine", "cpp", "-e", "SI|F(1, 80)"]
    ran = subprocess.run(tried, env=variables, capture_output=True)
    if ran.returncode:
        why = ran.stderr.decode("utf-8", "replace").strip().splitlines() or ["?"]
        _say("no_robot", why=why[0])
    activate = f'. "{programs}/activate"'
    if IS_WINDOWS:
        activate = f'& "{programs}\\Activate.ps1"'
    _say("done", activate=activate)
    _say("pages", page=folder / "pages" / ("indice.html" if _language() == "es" else "index.html"))
    return 0


def _language() -> str:
    for name in ("LC_ALL", "LC_MESSAGES", "LANG"):
        if os.environ.get(name):
            return "es" if os.environ[name].lower().startswith("es") else "en"
    import locale

    found = (locale.getlocale()[0] or "").lower()
    return "es" if found.startswith(("es", "spanish")) else "en"


def _say(key: str, **gaps: object) -> None:
    print(SAID[key][_language() == "es"].format(**gaps), flush=True)


def _fail(key: str, **gaps: object) -> int:
    print(SAID[key][_language() == "es"].format(**gaps), file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
