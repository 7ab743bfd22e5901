"""Installs `tsc` from this stick, without internet, for the person who is logged in.

    python install.py [FOLDER]

makes a virtual environment in FOLDER (TiniScript in the home folder if none is given), where `tsc`
then is, and copies pages and examples into it. It asks for no administrator and writes nowhere
else.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

STICK = Path(__file__).resolve().parent
IS_WINDOWS = os.name == "nt"
LANGUAGES = ("en", "es", "pt")  # the order of languages in SENTENCES
LANGUAGE_CODES = {"spanish": "es", "portuguese": "pt"}  # names of languages in Windows
PAGES = ("index.html", "index.es.html", "index.pt.html")
TEXTS = {
    "old": ("This Python is {version}; tsc needs 3.10 or newer.",
            "Este Python es {version}; tsc necesita 3.10 o posterior.",
            "Este Python é {version}; tsc precisa de 3.10 ou mais novo."),
    "no_venv": ("This Python cannot make virtual environments. On Debian and Ubuntu:  sudo apt-get install python3-venv",
                "Este Python no puede crear entornos virtuales. En Debian y Ubuntu:  sudo apt-get install python3-venv",
                "Este Python não pode criar ambientes virtuais. No Debian e no Ubuntu:  sudo apt-get install python3-venv"),
    "where": ("Installing into {folder}. This takes a minute.",
              "Se instala en {folder}. Tarda un minuto.", "Instala-se em {folder}. Demora um minuto."),
    "failed": ("The stick has no packages for this computer ({system}, Python {version}). README.txt says for which it has.",
               "La memoria no tiene paquetes para esta computadora ({system}, Python {version}). README.txt dice para cuáles tiene.",
               "O pen drive não tem pacotes para este computador ({system}, Python {version}). README.txt diz para quais tem."),
    "no_robot": ("The virtual robot does not run on this computer: {why}",
                 "El robot virtual no funciona en esta computadora: {why}",
                 "O robô virtual não funciona neste computador: {why}"),
    "done": ("Done. In each new window first:  {activate}",
             "Listo. En cada ventana nueva, primero:  {activate}",
             "Pronto. Em cada janela nova, primeiro:  {activate}"),
    "pages": ("The guides:  {page}", "Las guías:  {page}", "Os guias:  {page}"),
}  # fmt: skip


def main(arguments: list[str]) -> int:
    folder = Path(arguments[0]).absolute() if arguments else Path.home() / "TiniScript"
    version = ".".join(map(str, sys.version_info[:2]))
    if sys.version_info < (3, 10):  # noqa: UP036 - anyone who has an older one reads this
        return _fail("old", version=version)
    _say("where", folder=folder)
    if subprocess.run([sys.executable, "-m", "venv", str(folder / "tsc")]).returncode:
        return _fail("no_venv")
    programs = folder / "tsc" / ("Scripts" if IS_WINDOWS else "bin")
    python = programs / ("python.exe" if IS_WINDOWS else "python")
    pip_command = [str(python), "-m", "pip", "--isolated", "--disable-pip-version-check", "install"]
    pip_command += ["--quiet", "--no-index", "--find-links", str(STICK / "wheels")]
    pip_command += ["--upgrade"]
    variables = {name: value for name, value in os.environ.items() if not name.startswith("PIP_")}
    first_try = subprocess.run(
        [*pip_command, "tiniscript[radio,virtual]"], env=variables, capture_output=True
    )
    if (
        first_try.returncode
        and subprocess.run([*pip_command, "tiniscript[virtual]"], env=variables).returncode
    ):
        return _fail("failed", system=sys.platform, version=version)
    for name in ("pages", "examples"):
        shutil.copytree(STICK / name, folder / name, dirs_exist_ok=True)
    command = [str(python), "-m", "tiniscript", "run", "--machine", "cpp", "-e", "SI|F(1, 80)"]
    result = subprocess.run(command, env=variables, capture_output=True)
    if result.returncode:
        reason = result.stderr.decode("utf-8", "replace").strip().splitlines() or ["?"]
        _say("no_robot", why=reason[0])
    activate = f'. "{programs}/activate"'
    if IS_WINDOWS:
        activate = f'& "{programs}\\Activate.ps1"'
    _say("done", activate=activate)
    _say("pages", page=folder / "pages" / PAGES[_language()])
    return 0


def _language() -> int:
    """Return the place of the person's language in LANGUAGES, that of English for any other."""
    import locale

    names = (os.environ.get(name) for name in ("LC_ALL", "LC_MESSAGES", "LANG"))
    locale_name = (next(filter(None, names), None) or locale.getlocale()[0] or "").lower()
    code = LANGUAGE_CODES.get(locale_name.partition("_")[0], locale_name[:2])
    return LANGUAGES.index(code) if code in LANGUAGES else 0


def _say(key: str, **values: object) -> None:
    print(TEXTS[key][_language()].format(**values), flush=True)


def _fail(key: str, **values: object) -> int:
    print(TEXTS[key][_language()].format(**values), file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
