"""Creates the virtual environment `.venv` next to this folder, on each system, with Python alone.

`try.py` uses it, and `venv.sh` calls it as `environment.py "[test]"`. Errors are printed as a
sentence, with exit code 2. It knows pip and venv, but not the purpose of the environment.
"""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NEEDED_VERSION = (3, 10)
LANGUAGES = ("en", "es", "pt")  # the order of languages in SENTENCES
TEXTS = {
    "old": (
        "TiniScript needs Python 3.10 or newer; this is {version}. {get}",
        "TiniScript necesita Python 3.10 o posterior; este es {version}. {get}",
        "TiniScript precisa de Python 3.10 ou mais novo; este é {version}. {get}",
    ),
    "get_windows": (
        "Get one from python.org (its installer asks for no administrator), then:  py tools\\try.py",
        "Descárgalo de python.org (su instalador no pide administrador); después:  py tools\\try.py",
        "Baixe-o de python.org (o instalador não pede administrador); depois:  py tools\\try.py",
    ),
    "get": ("Get one from python.org.", "Descárgalo de python.org.", "Baixe-o de python.org."),
    "making": (
        "Making a virtual environment in .venv",
        "Se crea un entorno virtual en .venv",
        "Cria-se um ambiente virtual em .venv",
    ),
    "no_venv": (
        "This Python cannot make virtual environments. On Debian and Ubuntu:"
        "  sudo apt-get install python3-venv",
        "Este Python no puede crear entornos virtuales. En Debian y Ubuntu:"
        "  sudo apt-get install python3-venv",
        "Este Python não pode criar ambientes virtuais. No Debian e no Ubuntu:"
        "  sudo apt-get install python3-venv",
    ),
    "in_use": (
        "Cannot replace .venv: {why}. Close the windows that use it, and try again.",
        "No se puede reemplazar .venv: {why}. Cierra las ventanas que lo usan y repite.",
        "Não dá para substituir .venv: {why}. Feche as janelas que o usam e repita.",
    ),
    "installing": (
        "Installing TiniScript and what it needs from PyPI into .venv",
        "Se instala TiniScript y lo que necesita, desde PyPI, en .venv",
        "Instala-se o TiniScript e o que ele precisa, do PyPI, em .venv",
    ),
    "no_pip": (
        "pip could not install; is this computer online? A proxy is given by the variable"
        " HTTPS_PROXY, as http://proxy:3128. Without internet: docs/en/monday.md, a USB stick."
        " What pip said is in {log}; at its end:\n{end}",
        "pip no pudo instalar; ¿hay internet? Un proxy se indica con la variable"
        " HTTPS_PROXY, como http://proxy:3128. Sin internet: docs/es/monday.md, una memoria USB."
        " Lo que dijo pip está en {log}; al final:\n{end}",
        "pip não conseguiu instalar; há internet? Um proxy se indica com a variável"
        " HTTPS_PROXY, como http://proxy:3128. Sem internet: docs/pt/monday.md, um pen drive (USB)."
        " O que pip disse está em {log}; no fim:\n{end}",
    ),
}


def python_of(folder: Path, system: str = os.name) -> Path:
    """Return the interpreter of a virtual environment."""
    return folder / "Scripts" / "python.exe" if system == "nt" else folder / "bin" / "python"


def find_sentence(key: str, **values: str) -> str:
    """Return a sentence in the person's language."""
    return in_language(TEXTS[key], **values)


def in_language(sentences: tuple[str, ...], **values: str) -> str:
    """Return the sentence in the person's language, or in English."""
    language_code = language()
    return sentences[LANGUAGES.index(language_code) if language_code in LANGUAGES else 0].format(
        **values
    )


def say(line: str) -> None:
    """Print a line of our own, in bold where a terminal of Unix shows it."""
    bold_codes = ("\033[1m", "\033[0m") if os.name != "nt" and sys.stderr.isatty() else ("", "")
    print(f"{bold_codes[0]}{line}{bold_codes[1]}", file=sys.stderr, flush=True)


def make(extras: str, root: Path = ROOT) -> Path:
    """Install this folder with extras such as `[test]`, if anything changed since.

    Returns the interpreter. Exits with a sentence if it does not work.
    """
    check_version(sys.version_info[:2])
    python = python_of(root / ".venv")
    if not _runs(python, "-m", "pip", "--version"):
        _make_empty(root / ".venv")
    # The installed packages and their origin: file times miss changes within the same second, a
    # moved folder, and an older checkout. While pip runs, and after an interruption, none counts as
    # installed.
    stamp_file = root / ".venv" / "installed"
    source = f"{hashlib.sha256((root / 'pyproject.toml').read_bytes()).hexdigest()} {root}"
    installed_source, *installed_extras = (
        stamp_file.read_text(encoding="utf-8").split("\n") if stamp_file.is_file() else ("",)
    )
    if installed_source != source:
        installed_extras = []
    if extras not in installed_extras:
        stamp_file.unlink(missing_ok=True)
        say(find_sentence("installing"))
        pip_command = [
            str(python),
            "-m",
            "pip",
            "install",
            "--quiet",
            "--disable-pip-version-check",
        ]
        # Python compiles the imported modules, a third of all.
        pip_command += ["--no-input", "--no-compile", "--editable", f"{root}{extras}"]
        process = subprocess.run(
            pip_command,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            encoding="utf-8",
            errors="replace",
        )
        if process.returncode:
            log = root / ".venv" / "pip.log"
            log.write_text(process.stdout, encoding="utf-8")
            rows = [row.strip() for row in process.stdout.splitlines() if "ERROR:" in row]
            _fail(
                find_sentence(
                    "no_pip", log=log.relative_to(root).as_posix(), end="\n".join(rows[-2:])
                )
            )
        stamp_file.write_text("\n".join((source, *installed_extras, extras)), encoding="utf-8")
    return python


def check_version(version: tuple[int, int]) -> None:
    """Exit with a sentence where this Python is too old."""
    if version < NEEDED_VERSION:
        get_text = find_sentence("get_windows" if os.name == "nt" else "get")
        _fail(find_sentence("old", version=".".join(map(str, version)), get=get_text))


def _make_empty(folder: Path) -> None:
    import shutil

    say(find_sentence("making"))
    try:
        if folder.exists():
            shutil.rmtree(folder)
    except OSError as error:  # Windows removes no program that runs
        _fail(find_sentence("in_use", why=error.strerror or str(error)))
    if not _runs(Path(sys.executable), "-c", "import ensurepip"):
        _fail(find_sentence("no_venv"))
    if subprocess.run([sys.executable, "-m", "venv", str(folder)]).returncode:
        _fail(find_sentence("no_venv"))


def _runs(python: Path, *arguments: str) -> bool:
    try:
        return not subprocess.run([str(python), *arguments], capture_output=True).returncode
    except OSError:  # the file does not exist
        return False


def language() -> str:
    """Return the person's language, as `tsc` finds it."""
    sys.path.insert(0, str(ROOT / "compiler"))
    try:
        if sys.version_info >= NEEDED_VERSION:  # an older one cannot read that code
            from tiniscript.cli.texts import language_of

            return language_of([])
    except ImportError:
        pass
    finally:
        sys.path.remove(str(ROOT / "compiler"))
    return os.environ.get("LANG", "")[:2]


def _fail(find_sentence: str) -> None:
    print(find_sentence, file=sys.stderr)
    raise SystemExit(2)


if __name__ == "__main__":
    make(sys.argv[1] if len(sys.argv) > 1 else "")
