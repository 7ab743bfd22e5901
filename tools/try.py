"""README's first command, on each system: `py tools\\try.py`, `python3 tools/try.py`.

Sets TiniScript up in `.venv`; then a program is compiled, uploaded to the virtual robot, and drives
around the obstacles. It ends by itself or, for a person at a terminal who wants it, with the
studio. Needs no rights but those of its user.
"""

from __future__ import annotations

import os
import subprocess
import sys
from itertools import dropwhile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from tools import environment

PROGRAM = Path("examples") / "obstacle_until.ts"
YES_ANSWERS = ("1", "y", "yes", "s", "si", "sí", "sim")
MEGABYTES_CODE = "from tiniscript.cli.page_build import megabytes; print(megabytes())"
TEXTS = {
    "program": (
        "The program {program}: forward until something is within 10 cm, then beep,\n"
        "turn right and go on.",
        "El programa {program}: avanzar hasta que haya algo a menos de 10 cm; entonces\n"
        "pitar, girar a la derecha y seguir.",
        "O programa {program}: andar para a frente até haver algo a menos de 10 cm; então\n"
        "apitar, virar à direita e seguir.",
    ),
    "watch": (
        "For 30 seconds a virtual robot does it here. Ctrl-C stops it earlier.",
        "Un robot virtual lo hace aquí durante 30 segundos. Ctrl-C lo detiene antes.",
        "Um robô virtual faz isso aqui por 30 segundos. Ctrl-C o para antes.",
    ),
    "drawn": (
        "way.png, in this folder, shows its path.",
        "way.png, en esta carpeta, muestra su recorrido.",
        "way.png, nesta pasta, mostra o caminho dele.",
    ),
    "now": (
        'Now yours:  {activate}   and   tsc upload -e "SI|F(2, 80)" --virtual',
        'Ahora el tuyo:  {activate}   y   tsc upload -e "SI|F(2, 80)" --virtual',
        'Agora o seu:  {activate}   e   tsc upload -e "SI|F(2, 80)" --virtual',
    ),
    "studio": (
        "Open the studio, with blocks, in your browser?{size} [y/N] ",
        "¿Abrir el estudio, con bloques, en tu navegador?{size} [s/N] ",
        "Abrir o estúdio, com blocos, no seu navegador?{size} [s/N] ",
    ),
    "blocked": (
        "(Where PowerShell runs no scripts:  Set-ExecutionPolicy -Scope Process RemoteSigned"
        "   or, without it,  {tsc})",
        "(Si PowerShell no ejecuta scripts:  Set-ExecutionPolicy -Scope Process RemoteSigned"
        "   o, sin eso,  {tsc})",
        "(Se o PowerShell não roda scripts:  Set-ExecutionPolicy -Scope Process RemoteSigned"
        "   ou, sem isso,  {tsc})",
    ),
}


def activation(system: str = os.name) -> str:
    """Return the line that makes `tsc` a command of this window."""
    return r".venv\Scripts\Activate.ps1" if system == "nt" else ". .venv/bin/activate"


def main() -> int:
    python = environment.make("[virtual]")
    _say("program", program=PROGRAM.as_posix())
    rows = (ROOT / PROGRAM).read_text(encoding="utf-8").splitlines()
    print("\n".join(dropwhile(lambda row: row.startswith("//"), rows)), end="\n\n", flush=True)
    arguments = ["upload", str(PROGRAM), "--virtual", "--for", "30"]
    if sys.stdout.isatty() and sys.stderr.isatty() and not os.environ.get("CI"):
        _say("watch")
    else:
        arguments += ["--hurry", "20"]
    arguments += ["--plot", "way.png"]
    environment.say(f"$ tsc {' '.join(arguments)}")
    try:
        exit_code = subprocess.run(
            [str(python), "-m", "tiniscript", *arguments], cwd=ROOT
        ).returncode
    except KeyboardInterrupt:  # the robot has stopped, and tsc has reported it
        return 2
    print(flush=True)
    if exit_code:
        return exit_code
    _say("drawn")
    _say("now", activate=activation())
    if os.name == "nt":
        _say("blocked", tsc=r".venv\Scripts\tsc")
    if not (sys.stdin.isatty() and sys.stdout.isatty()) or not _ask_for_studio(python):
        return 0
    environment.say("$ tsc studio")
    try:
        arguments = [str(python), "-m", "tiniscript", "studio", "--yes"]
        return subprocess.run(arguments, cwd=ROOT).returncode
    except KeyboardInterrupt:  # the studio ends so
        return 0


def _ask_for_studio(python: Path) -> bool:
    """Ask whether the studio shall open, and say how much is downloaded for it."""
    try:
        process = subprocess.run(
            [str(python), "-c", MEGABYTES_CODE], capture_output=True, text=True
        )
        size = process.stdout.strip()
        text = f" ({size} MB)" if size not in ("", "0") else ""
        return (
            input(environment.in_language(TEXTS["studio"], size=text)).strip().lower()
            in YES_ANSWERS
        )
    except (EOFError, KeyboardInterrupt):
        print()
        return False


def _say(key: str, **values: str) -> None:
    environment.say(environment.in_language(TEXTS[key], **values))


if __name__ == "__main__":
    raise SystemExit(main())
