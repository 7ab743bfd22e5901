"""The page's own sources and data in node: a script plays a part of the page, no browser."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest

from tests.support.needs import need
from tests.support.waiting import HANG_LIMIT_S
from tiniscript.base.languages import SOURCE_LANGUAGE, language_info, languages
from tiniscript.studio import block_kinds
from tiniscript.studio.building import SOURCES
from tiniscript.studio.description import description
from tools import CannotMake
from tools.builds.page_texts import page_texts
from tools.builds.studio import find_tools


def in_node(script: Path, *words: str, input_text: str = "") -> list[str]:
    """Run a script with the folder of the page's sources and these words; return the lines that it
    prints. It reads `input_text` on its standard input."""
    try:
        node = find_tools().node
    except CannotMake as error:
        need(str(error))
    command = [*node, str(script), str(SOURCES / "src"), *words]
    result = subprocess.run(
        command,
        input=input_text,
        capture_output=True,
        text=True,
        timeout=2 * HANG_LIMIT_S,
        check=False,
    )
    assert result.returncode == 0, result.stderr
    return result.stdout.splitlines()


@pytest.fixture(scope="module")
def page_data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The generated data for the page's sources."""
    folder = tmp_path_factory.mktemp("page_data")
    content = {"languages": [(code, language_info(code).name) for code in languages()], "lock": {},
               "description": description(), "blocks": block_kinds.table_data(),
               "texts": page_texts(SOURCE_LANGUAGE)}  # fmt: skip
    for name, value in content.items():
        (folder / f"{name}.json").write_text(json.dumps(value), encoding="utf-8")
    return folder
