"""The install commands that tsc prints for a missing part, before any package is on PyPI."""

from __future__ import annotations

import re
import shlex
import sys
from importlib import metadata
from pathlib import Path

import pytest

from tests.support.casefile import ROOT
from tiniscript.library import install_advice

EXTRAS = (install_advice.VIRTUAL, install_advice.FIRMWARE)


@pytest.fixture(autouse=True)
def plain(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A virtual environment that is active, and no clone."""
    monkeypatch.setattr(install_advice, "CLONE", tmp_path)
    monkeypatch.setattr(sys, "prefix", str(tmp_path / "env"))
    monkeypatch.setenv("VIRTUAL_ENV", str(tmp_path / "env"))
    rows = ["cobs>=1", 'pillow>=10.1; extra == "virtual"', 'wasmtime>=20; extra == "virtual"',
            'platformio>=6.1; extra == "firmware"']  # fmt: skip
    monkeypatch.setattr(metadata, "requires", lambda name: rows)


def clone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "a clone"
    (folder / "compiler" / "tiniscript").mkdir(parents=True)
    (folder / "pyproject.toml").touch()
    monkeypatch.setattr(install_advice, "CLONE", folder)
    return folder


def test_advice_names_the_package_on_pypi() -> None:
    assert install_advice.command("virtual") == 'pip install "pillow>=10.1" "wasmtime>=20"'
    assert install_advice.command("firmware") == 'pip install "platformio>=6.1"'


def test_a_pipx_installation_gets_pipx_advice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    clone(tmp_path, monkeypatch)
    (tmp_path / "env").mkdir()
    (tmp_path / "env" / "pipx_metadata.json").touch()
    assert install_advice.command("firmware") == 'pipx inject tiniscript "platformio>=6.1"'


def test_an_environment_that_is_not_active_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """`pip` alone would be that of another Python."""
    monkeypatch.delenv("VIRTUAL_ENV")
    monkeypatch.setattr(sys, "executable", "/some where/python")
    assert (
        install_advice.command("firmware")
        == '"/some where/python" -m pip install "platformio>=6.1"'
    )


def test_pipx_is_advised_if_pip_is_not_allowed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = clone(tmp_path, monkeypatch)
    monkeypatch.setattr(sys, "base_prefix", sys.prefix)
    monkeypatch.setattr("sysconfig.get_path", lambda name: str(tmp_path))
    (tmp_path / "EXTERNALLY-MANAGED").touch()
    assert install_advice.command("virtual") == f'pipx install "{folder}[virtual]"'


def test_missing_metadata_is_tolerated(monkeypatch: pytest.MonkeyPatch) -> None:
    def nothing(name: str) -> list[str]:
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "requires", nothing)
    assert install_advice.command("virtual") == 'pip install "tiniscript[virtual]"'


@pytest.mark.parametrize("word", ["plain", "a b", 'a"b', "a$HOME[x]", "a`b`", "a\\b", "x>=1", "!"])
def test_the_advised_command_is_quoted_for_the_shell(word: str) -> None:
    assert shlex.split(install_advice.quote(word)) == [word]


def test_the_extras_are_those_of_the_package() -> None:
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    for extra in EXTRAS:
        assert re.search(rf"^{extra} = \[", text, re.M)


def test_only_one_module_knows_how_to_install_an_extra() -> None:
    """The texts of `tsc firmware` do where the sources are missing: then there is no other way."""
    folder = ROOT / "compiler" / "tiniscript"
    files = {
        path.name
        for path in folder.rglob("*.py")
        if re.search(r"install[^\n]*\[(virtual|firmware)\]", path.read_text(encoding="utf-8"))
    }
    assert files <= {"firmware.py", "install_advice.py"}
