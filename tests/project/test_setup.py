"""The scripts that set TiniScript up and test it: on an ordinary machine."""

from __future__ import annotations

import io
import os
import random
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.casefile import ROOT
from tests.support.first_command import load_first_command, set_terminals
from tests.support.rows import each_row
from tools import environment

pytestmark = pytest.mark.skipif(not shutil.which("sh"), reason="no sh: Windows has no such scripts")

UNWANTED_VARIABLES = (
    "PYTHONDONTWRITEBYTECODE",
    "PYTHONUNBUFFERED",
    "PYTHONOPTIMIZE",
    "PYTEST_ADDOPTS",
)


STUB_VENV_SCRIPT = """
say() { :; }
find_venv_python() { :; }
test_packages() { echo packages by $(id -u); }
"""
STUB_TEST_SCRIPT = """
echo "$*, $(id -un)"
env
echo "FILES=$(ulimit -n)"
git log --format=HISTORY=%s
echo "THERE=$(ls -A | tr '\\n' ' ')"
echo "PIP=$(cat "${PIP_CONFIG_FILE:-/dev/null}")"
echo "NPM=$(cat "${NPM_CONFIG_USERCONFIG:-/dev/null}")"
mkdir -p .venv/bin
cp tests/x.py tests/x.pyc  # as tests leave it that have run
printf '#!/bin/sh\\necho $* by $(id -u)\\n' >.venv/bin/python
chmod +x .venv/bin/python
exit 7
"""


def ci(folder: Path) -> tuple[list[str], dict[str, str]]:
    """Run CI in a clone with an own test command. Return its output, and its variables."""
    files = {"tools/venv.sh": STUB_VENV_SCRIPT, "tools/test.sh": STUB_TEST_SCRIPT, "new": "",
             "tools/bare.sh": 'echo "BARE=$*, $(id -un)"\n',
             "tests/x.py": "@pytest.mark.root\n", "tests/y.py": "",
             ".ci/run": (ROOT / ".ci/run").read_text(encoding="utf-8")}  # fmt: skip
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    git = ["git", "-C", str(folder), "-c", "user.name=x", "-c", "user.email=x"]
    subprocess.run(["git", "init", "--quiet", str(folder)], check=True)
    subprocess.run([*git, "add", ".ci", "tests", "tools"], check=True)
    subprocess.run([*git, "commit", "--quiet", "-m", "first"], check=True)
    home = folder.parent / "home of root"
    (home / ".config" / "pip").mkdir(parents=True, exist_ok=True)
    (home / ".config" / "pip" / "pip.conf").write_text("[global] of root")
    (home / ".npmrc").write_text("registry of root")
    variables = {
        **os.environ, **dict.fromkeys(UNWANTED_VARIABLES, "1"), "PIP_INDEX_URL": "file:///no 'ne",
        "https_proxy": "http://p:1", "SECRET": "x", "HOME": str(home),
    }  # fmt: skip
    variables.pop("XDG_CONFIG_HOME", None)
    completed = subprocess.run(["sh", ".ci/run"], cwd=folder, env=variables, capture_output=True,
                          text=True)  # fmt: skip
    assert completed.returncode == 7, completed.stderr
    rows = completed.stdout.splitlines()
    return rows, dict(row.partition("=")[::2] for row in rows)


@pytest.mark.skipif(os.geteuid() == 0, reason="root is another user there")
def test_ci_runs_the_tests_as_users_do(tmp_path: Path) -> None:
    """It uses no options that hide failing tests, and the pip configuration of the machine."""
    rows, environment = ci(tmp_path / "clone")
    assert rows[0].startswith("BARE=-m not root, ")
    assert rows[1].startswith("--tenth -m not root, ")
    assert not set(UNWANTED_VARIABLES) & set(environment)
    assert (environment["CI"], environment["PIP_INDEX_URL"]) == ("true", "file:///no 'ne")
    assert int(environment["FILES"]) == 1024


@pytest.mark.root
def test_ci_of_root_runs_the_tests_as_a_new_user(tmp_path: Path) -> None:
    """It uses packages of Debian, runs root's own tests as root, and works repeatedly."""
    clone = tmp_path / "clone"
    for _ in range(2):
        rows, environment = ci(clone)
        assert {*rows[:2]} == {"packages by 0", f"BARE=-m not root, {environment['USER']}"}
        assert rows[2] == f"--tenth -m not root, {environment['USER']}"
        assert rows[-1] == "-m pytest -n 2 -p no:cacheprovider -m root tests/x.py by 0"
        assert not {*UNWANTED_VARIABLES, "SECRET"} & set(environment)
        assert (environment["CI"], environment["PIP_INDEX_URL"]) == ("true", "file:///no 'ne")
        assert (environment["https_proxy"], environment["FILES"]) == ("http://p:1", "1024")
        assert (environment["PIP"], environment["NPM"]) == ("[global] of root", "registry of root")
        assert (environment["HISTORY"], environment["THERE"]) == (
            "first",
            ".ci .git new tests tools ",
        )
        assert environment["HOME"].startswith("/home/") and not Path(environment["HOME"]).exists()
        assert subprocess.run(["id", environment["USER"]], capture_output=True).returncode
        shutil.rmtree(clone)


def test_the_first_tests_to_run_exist() -> None:
    script = (ROOT / "tools" / "test.sh").read_text(encoding="utf-8")
    names = script.partition('QUICK="tests')[2].partition('"')[0].split()
    assert len(names) > 10
    for name in ("tests" + names[0], *names[1:]):
        assert (ROOT / name.partition("::")[0]).exists(), name


# -- the virtual environment


INSTALLING_MESSAGE = "Installing TiniScript"
FAKE_PYTHON = (
    '#!/bin/sh\ncase "$*" in *" install "*) echo "$*" >>"$(dirname "$0")/../asked";; esac\n'
)
ENGLISH = {**os.environ, "LC_ALL": "C"}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder like a clone, whose Python installs nothing and records the requests."""
    clone = tmp_path / "clone"
    (clone / "tools").mkdir(parents=True)
    (clone / ".venv" / "bin").mkdir(parents=True)
    shutil.copy(ROOT / "tools" / "environment.py", clone / "tools")
    (clone / "pyproject.toml").write_text("one")
    python = clone / ".venv" / "bin" / "python"
    python.write_text(FAKE_PYTHON)
    python.chmod(0o755)
    return clone


def has_installed(clone: Path) -> bool:
    """Return whether the script has installed anything."""
    completed = subprocess.run(
        [sys.executable, str(clone / "tools" / "environment.py"), "[test]"],
        capture_output=True, text=True, check=True, env=ENGLISH,
    )  # fmt: skip
    return INSTALLING_MESSAGE in completed.stderr


def test_an_existing_installation_is_not_repeated(folder: Path) -> None:
    assert has_installed(folder)
    assert not has_installed(folder)
    assert (folder / ".venv" / "asked").read_text().endswith(f"--editable {folder}[test]\n")


def test_a_changed_pyproject_is_installed_whatever_its_time(folder: Path) -> None:
    """Changed in the same second, or restored from an older state of the repository."""
    assert has_installed(folder)
    (folder / "pyproject.toml").write_text("two")
    os.utime(folder / "pyproject.toml", (1, 1))
    assert has_installed(folder)
    assert not has_installed(folder)


def test_a_moved_folder_is_installed_again(folder: Path) -> None:
    assert has_installed(folder)
    moved_path = folder.rename(folder.with_name("moved"))
    assert has_installed(moved_path)


class Pip:
    """Stands in for `subprocess.run`: an environment in which pip installs, fails or is cut off."""

    def __init__(self, root: Path) -> None:
        self.root = root
        # Hash of pyproject.toml, and the packages installed for it.
        self.has: tuple[str, set[str]] = ("", set())
        self.end = "works"
        self.asked_count = 0

    def __call__(self, words: list[str], **_: object) -> subprocess.CompletedProcess[str]:
        if "install" in words:
            self.asked_count += 1
            state = (self.root / "pyproject.toml").read_text()
            if self.end != "works":
                self.has = ("a part", set())
            if self.end == "is cut off":
                raise KeyboardInterrupt
            if self.end == "fails":
                return subprocess.CompletedProcess(words, 1, "ERROR: no network")
            had = self.has[1] if self.has[0] == state else set()
            self.has = (state, had | {words[-1].removeprefix(str(self.root))})
        return subprocess.CompletedProcess(words, 0, "")


@pytest.mark.parametrize("seed", range(40))
def test_the_installed_packages_are_the_requested_ones(
    seed: int, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After any history of states of the repository, of extras, and of ends of pip. Existing
    packages need no network."""
    rng, pip = random.Random(seed), Pip(folder)
    monkeypatch.setattr(subprocess, "run", pip)
    for _ in range(12):
        state, extras = rng.choice(("one", "two")), rng.choice(("", "[test]", "[firmware]"))
        pip.end = rng.choice(("works", "works", "works", "fails", "is cut off"))
        (folder / "pyproject.toml").write_text(state)
        is_there, asked_count = pip.has[0] == state and extras in pip.has[1], pip.asked_count
        try:
            environment.make(extras, folder)
        except (SystemExit, KeyboardInterrupt):
            continue
        finally:
            assert (pip.asked_count == asked_count) == is_there
        assert pip.has[0] == state and extras in pip.has[1]


def run_script(
    folder: Path, programs: dict[str, str], **variables: str
) -> subprocess.CompletedProcess[str]:
    """Run a script that makes the environment, if there are these programs alone."""
    tools, path = folder / "tools", folder / "bin"
    tools.mkdir()
    path.mkdir()
    shutil.copy(ROOT / "tools" / "venv.sh", tools)
    sh, dirname, chmod = (shutil.which(name) for name in ("sh", "dirname", "chmod"))
    always = {"id": "echo 1000", "dirname": f'exec {dirname} "$@"', "chmod": f'exec {chmod} "$@"'}
    for name, text in {**always, **programs}.items():
        (path / name).parent.mkdir(parents=True, exist_ok=True)
        (path / name).write_text(f"#!{sh}\n{text}\n")
        (path / name).chmod(0o755)
    (tools / "script.sh").write_text('set -eu\n. "$(dirname "$0")/venv.sh"\nmake_venv "[test]"\n')
    return subprocess.run([str(sh), tools / "script.sh"], capture_output=True, encoding="utf-8",
                          env={"PATH": str(path), **variables})  # fmt: skip


def test_the_shell_leaves_the_work_to_python(tmp_path: Path) -> None:
    """`make_venv` gives the extras on, with the interpreter of `.venv` where it has pip."""
    python = {"../.venv/bin/python": 'case "$*" in *environment*) echo "$*";; esac'}
    completed = run_script(tmp_path, python)
    assert completed.stdout == f"{tmp_path / 'tools' / 'environment.py'} [test]\n", completed.stderr


@pytest.mark.parametrize("left", ["exit 1", "exit 127", "case $* in *pip*) exit 1;; esac; echo it"])
def test_the_shell_does_not_start_an_unusable_environment(left: str, tmp_path: Path) -> None:
    """Its creation may have been interrupted, or the system may have a new Python since."""
    python = 'case "$*" in *environment*) echo python3;; esac'
    completed = run_script(tmp_path, {"../.venv/bin/python": left, "python3": python})
    assert completed.stdout == "python3\n", completed.stderr


PYTHONS = ("python3", "python3.13", "python3.12", "python3.11", "python3.10", "python")


@pytest.mark.parametrize("seed", range(12))
def test_the_shell_uses_a_sufficiently_new_python(seed: int, tmp_path: Path) -> None:
    """Other versions, and their order, do not matter."""
    rng = random.Random(seed)
    minors = {name: rng.randint(7, 14) for name in PYTHONS if rng.random() < 0.5}
    programs = {
        name: f"""case "$*" in
*environment.py*) echo {name} ;;
*version_info*) exec {sys.executable} -c "import sys; sys.version_info = (3, {minor}); $2" ;;
esac"""
        for name, minor in minors.items()
    }
    completed = run_script(tmp_path, programs)
    new_enough = [name for name in PYTHONS if minors.get(name, 0) >= 10]
    assert completed.stdout == "".join(f"{name}\n" for name in new_enough[:1]), minors
    assert completed.returncode == (0 if new_enough else 2)


@pytest.mark.parametrize(("has_apt", "code"), [(True, 0), (False, 2)])
def test_a_debian_without_any_python_gets_one(has_apt: bool, code: int, tmp_path: Path) -> None:
    python = tmp_path / "bin" / "python3"
    brings = f'printf "#!/bin/sh\\n" >{python}; chmod +x {python}'
    apt = f'case "$*" in *"install -y"*python3-venv*) {brings};; esac'
    completed = run_script(
        tmp_path, {"apt-get": apt, "sudo": '"$@"'} if has_apt else {}, LC_ALL="C"
    )
    assert completed.returncode == code, completed.stderr
    assert ("needs Python 3.10 or newer" in completed.stderr) != has_apt
    assert python.exists() == has_apt


@pytest.mark.parametrize(
    ("sudo", "locale", "is_english"),
    [
        ({}, "C", True),
        ({"sudo": "exit 1"}, "es_MX.UTF-8", False),
        ({"sudo": '"$@"'}, "C", True),
    ],
    ids=["no sudo", "no rights", "no network"],
)
def test_users_who_cannot_install_venv_are_not_told_to(
    sudo: dict[str, str], locale: str, is_english: bool, tmp_path: Path
) -> None:
    fakes = {"python3": "case $* in *ensurepip*) exit 1;; esac", "apt-get": "exit 100", **sudo}
    completed = run_script(tmp_path, fakes, LANG=locale)
    assert completed.returncode == 2
    assert ("Who administers" in completed.stderr) == is_english
    assert ("Quien administra" in completed.stderr) != is_english
    assert "sudo" not in completed.stderr


@pytest.mark.parametrize("seed", range(6))
def test_the_packages_that_are_missing_and_known_are_installed(seed: int, tmp_path: Path) -> None:
    """Nobody becomes root for what is there, or for what this system does not have; where a package
    cannot be had, the tests begin without it."""
    rng, names = random.Random(seed), ["one", "two", "three", "four"]
    there, known = ({name for name in names if rng.random() < 0.5} for _ in range(2))
    if seed == 0:
        there = {*names}
    is_online, log = rng.random() < 0.5, tmp_path / "log"
    log.touch()
    sh = shutil.which("sh")
    says_yes = {
        "dpkg": f"case ' {' '.join(there)} ' in *\" $2 \"*) exit 0;; esac; exit 1",
        "apt-cache": f"case ' {' '.join(known)} ' in *\" $2 \"*) exit 0;; esac; exit 1",
        "apt-get": f'echo "$*" >>{log}; exit {0 if is_online else 100}',
        "sudo": '"$@"',
        "id": "echo 1000",
        "dirname": f'exec {shutil.which("dirname")} "$@"',
    }
    (tmp_path / "bin").mkdir()
    for name, text in says_yes.items():
        (tmp_path / "bin" / name).write_text(f"#!{sh}\n{text}\n")
        (tmp_path / "bin" / name).chmod(0o755)
    words = f'. "{ROOT / "tools" / "venv.sh"}"; debian_packages {" ".join(names)}; echo begins'
    completed = subprocess.run(
        [str(sh), "-euc", words, str(ROOT / "tools" / "test.sh")],
        capture_output=True, text=True, env={"PATH": str(tmp_path / "bin"), "LC_ALL": "C"},
    )  # fmt: skip
    assert (completed.returncode, completed.stdout) == (0, "begins\n"), completed.stderr
    missing = [name for name in names if name not in there]
    found = [name for name in missing if name in known]
    steps = log.read_text().splitlines()
    install = f"install -y -qq --no-install-recommends {' '.join(found)}"
    assert steps == ["update -qq"] * bool(missing) + [install] * bool(found)
    for name in missing:
        assert (f"has no package {name}:" in completed.stderr) == (name not in known)
    assert ("That did not work" in completed.stderr) == (bool(found) and not is_online)
    assert ("could not ask" in completed.stderr) == (bool(missing) and not is_online)


# -- tools/try.py, for every system


def test_windows_has_its_interpreter_and_its_line_elsewhere() -> None:
    from tools import environment

    assert environment.python_of(Path("x"), "nt") == Path("x/Scripts/python.exe")
    assert environment.python_of(Path("x"), "posix") == Path("x/bin/python")
    first_command = load_first_command()
    assert first_command.activation("nt") == r".venv\Scripts\Activate.ps1"
    assert first_command.activation("posix") == ". .venv/bin/activate"


def test_an_old_python_names_the_source_of_a_new_one(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from tools import environment

    for language, sentence in (("en", "needs Python"), ("es", "necesita"), ("pt", "precisa")):
        monkeypatch.setenv("LC_ALL", f"{language}_MX.UTF-8")
        with pytest.raises(SystemExit) as exit_code:
            environment.check_version((3, 9))
        assert exit_code.value.code == 2
        assert sentence in capsys.readouterr().err
    environment.check_version((3, 10))


def test_offline_users_are_told_about_proxies_and_the_usb_stick(folder: Path) -> None:
    """The hint precedes pip's own output, of which the end is enough."""
    python = folder / ".venv" / "bin" / "python"
    output = "  Traceback (most recent call last)\n  ERROR: no setuptools\nERROR: no network\n"
    python.write_text(
        f"#!/bin/sh\ncase $* in *' install '*) printf '{output}' >&2; exit 1;; esac\n"
    )
    completed = subprocess.run(
        [sys.executable, str(folder / "tools" / "environment.py"), "[virtual]"],
        capture_output=True, encoding="utf-8",
        env={**ENGLISH, "LC_ALL": "pt_BR.UTF-8", "PYTHONUTF8": "1"},
    )  # fmt: skip
    assert completed.returncode == 2
    sentence = "pip não conseguiu instalar; há internet?"
    assert completed.stderr.splitlines()[1].startswith(sentence), completed.stderr
    assert "HTTPS_PROXY" in completed.stderr and "USB" in completed.stderr
    assert "Traceback" not in completed.stderr
    assert completed.stderr.endswith("\nERROR: no setuptools\nERROR: no network\n")
    assert (folder / ".venv" / "pip.log").read_text() == output


def test_the_first_command_drives_the_virtual_robot(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """In an existing environment, because pip has tests of its own."""
    from tools import environment

    monkeypatch.setenv("LC_ALL", "es_MX.UTF-8")
    monkeypatch.setattr(environment, "make", lambda extras: Path(sys.executable))
    exists_before = (ROOT / "way.png").exists()
    assert load_first_command().main() == 0
    capture_result = capfd.readouterr()
    assert (ROOT / "way.png").is_file()
    if not exists_before:
        (ROOT / "way.png").unlink()
    program_start = "SI|LOOP(FOREVER);\n  F(FOREVER, 80) UNTIL(DISTANCE < 10);\n"
    assert capture_result.out.startswith(program_start)  # without its notes, in English
    assert "way.png" in capture_result.err
    assert "Ahora el tuyo" in capture_result.err
    assert "Aviso" not in capture_result.err
    # There is no one to answer the question.
    assert "estudio" not in capture_result.out + capture_result.err


class Calls:
    """Replaces `subprocess.run`: records the first command's children and plays their answers."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, megabytes: int) -> None:
        self.words: list[list[str]] = []
        self.megabytes = megabytes
        monkeypatch.setattr(subprocess, "run", self.run)

    def run(self, words: list[str], **options: object) -> subprocess.CompletedProcess[str]:
        self.words.append(words[1:])
        return subprocess.CompletedProcess(words, 0, f"{self.megabytes}\n", "")


@each_row(
    "typed_text, language, megabytes, question, opens",
    [
        ("y\n", "en_GB", 40, "Open the studio, with blocks, in your browser? (40 MB) [y/N] ", True),
        ("s\n", "es_MX", 101, "en tu navegador? (101 MB) [s/N] ", True),
        (" SIM \n", "pt_BR", 0, "no seu navegador? [s/N] ", True),
        ("\n", "en_GB", 40, "(40 MB)", False),
        ("n\n", "en_GB", 40, "(40 MB)", False),
        ("", "en_GB", 40, "(40 MB)", False),  # Ctrl-D
    ],
)
def test_the_first_command_ends_with_the_studio(
    typed_text: str, language: str, megabytes: int, question: str, opens: bool,
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    from tools import environment

    monkeypatch.setenv("LC_ALL", f"{language}.UTF-8")
    monkeypatch.setattr(environment, "make", lambda extras: Path(sys.executable))
    monkeypatch.setattr(sys, "stdin", io.StringIO(typed_text))
    set_terminals(monkeypatch, "stdin", "stdout")
    calls = Calls(monkeypatch, megabytes)
    assert load_first_command().main() == 0
    assert question in capsys.readouterr().out
    assert (["-m", "tiniscript", "studio", "--yes"] in calls.words) == opens


@each_row("terminals", [(), ("stdin",), ("stdout",), ("stdout", "stderr")])
def test_the_first_command_asks_no_question_without_a_terminal(
    terminals: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    from tools import environment

    monkeypatch.setattr(environment, "make", lambda extras: Path(sys.executable))
    monkeypatch.setattr(sys, "stdin", io.StringIO("y\n"))
    set_terminals(monkeypatch, *terminals)
    calls = Calls(monkeypatch, 40)
    assert load_first_command().main() == 0
    assert [words[2] for words in calls.words] == ["upload"]


def test_the_question_names_what_the_studio_downloads(monkeypatch: pytest.MonkeyPatch) -> None:
    from tiniscript.cli import page_build
    from tiniscript.studio import building, serving

    monkeypatch.setattr(serving, "is_built", lambda: False)
    monkeypatch.setattr(building, "find_tools", lambda: None)
    monkeypatch.setattr(building, "are_packages_fetched", lambda: False)
    assert page_build.megabytes() == building.NODE_MB + building.NPM_MB
    monkeypatch.setattr(building, "find_tools", lambda: building.Tools([], [], ""))
    assert page_build.megabytes() == building.NPM_MB == 40  # the number in the READMEs
    monkeypatch.setattr(serving, "is_built", lambda: True)
    assert page_build.megabytes() == 0
    completed = subprocess.run(
        [sys.executable, "-c", load_first_command().MEGABYTES_CODE], capture_output=True, text=True
    )
    assert completed.stdout.strip().isdigit(), completed.stderr


def test_every_sentence_of_the_first_command_has_all_languages() -> None:
    from tools import environment

    for table in (environment.TEXTS, load_first_command().TEXTS):
        for sentences in table.values():
            assert len({*sentences}) == len(environment.LANGUAGES)
            assert len({frozenset(re.findall(r"\{\w+\}", text)) for text in sentences}) == 1
