"""The functions that the page calls, with requests and answers in JSON.

Knows the form of both. Runs in Pyodide, in a worker; knows nothing of a browser.
"""

from __future__ import annotations

import json
import marshal
import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any

from tiniscript.base import languages
from tiniscript.base.kit import Kit
from tiniscript.bytecode.image import checksum
from tiniscript.diagnostics.rendering import Message
from tiniscript.library.named_robot import rename_robot
from tiniscript.studio import checking
from tiniscript.studio.block_form import data_of, first_blocks, from_data, in_order, size_of
from tiniscript.studio.block_printing import format_blocks
from tiniscript.studio.block_reading import LOOSE_PREFIX, read_blocks
from tiniscript.studio.block_speech import blocks_of, codes_in, mark_code

Json = dict[str, Any]
TOGETHER_MODULE = "tiniscript.studio.page_together"
MAX_BLOCKS = 1500  # most blocks that a page can move around


def answer(request: str, data: bytes = b"") -> str:
    """Return the answer to a request; `data` is a program's text or file."""
    fields = json.loads(request)
    return json.dumps(_request_handler(fields["do"])(fields, data), ensure_ascii=False)


def _check(fields: Json, data: bytes) -> Json:
    result = checking.check(data, fields["robot"], fields["language"])
    kit = checking.profile_of(result.robot).kit
    return {
        "image": result.image.hex(),
        "program": f"{checksum(result.image):08x}" if result.image else "",
        "bytes": result.code_bytes,
        "findings": [
            {
                **finding.message._asdict(),
                "may_repair": finding.may_repair,
                "on_blocks": _on_blocks(finding.on_blocks, kit),
            }
            for finding in result.findings
        ],
        "places": result.places,
        "halts": result.halts,
        "shows": [[offset, *show] for offset, show in result.shows],
        "variables": [variable._asdict() for variable in result.variables],
        "start": result.start,
        "robot": result.robot,
        "names_robot": result.names_robot,
        "sensors": result.read_sensors,
        "remote": result.remote_words,
        "loose": _loose(fields, data) if LOOSE_PREFIX.encode() in data else 0,
    }


def _on_blocks(message: Message, kit: Kit) -> Json:
    """Return a message for those who see blocks: its sentences, and which block each code is."""
    text, fix = (mark_code(sentence, kit) for sentence in (message.message, message.fix))
    return {"message": text, "fix": fix, "spoken": blocks_of(codes_in([text, fix]), kit)}


def _speak(fields: Json, data: bytes) -> Json:
    """Return the block that a piece of code becomes, if it is one."""
    del data
    return blocks_of([fields["code"]], checking.profile_of(fields["robot"]).kit)


def _repair(fields: Json, data: bytes) -> Json:
    """Return the edits of the button of the finding `which`; none means no button."""
    changes = checking.repair(data, fields["robot"], fields["which"])
    return {"changes": [change._asdict() for change in changes]}


def _loose(fields: Json, data: bytes) -> int:
    """Return the number of unattached instructions and values in a program."""
    stacks = read_blocks(data.decode(), checking.profile_for(data, fields["robot"]).kit).loose
    return sum(len(in_order(stack.body)) or 1 for stack in stacks)


def _open(fields: Json, data: bytes) -> Json:
    return _post_answer(checking.open_text(data, fields["robot"], fields["language"]))


def _line(fields: Json, data: bytes) -> Json:
    return _post_answer(checking.line_for_robot(data, fields["robot"], fields["language"]))


def _post_answer(message: str | Message) -> Json:
    if isinstance(message, Message):
        return {"message": message.message, "fix": message.fix, "code": message.code}
    return {"text": message}


def _blocks(fields: Json, data: bytes) -> Json:
    """Return the blocks of a text, or the `first` of them; of too many only their number."""
    form = read_blocks(data.decode(), checking.profile_for(data, fields["robot"]).kit)
    if "first" in fields:
        form = first_blocks(form, fields["first"])
    size = size_of(form)
    return {"size": size} if size > MAX_BLOCKS else {"size": size, **data_of(form)}


def _text(fields: Json, data: bytes) -> Json:
    return format_blocks(from_data(fields["form"]))._asdict()


def _rename(fields: Json, data: bytes) -> Json:
    """Return a program that names its robot with the robot that somebody has chosen in the page."""
    return {"text": rename_robot(data.decode(), fields["robot"])}


def _learn(fields: Json, data: bytes) -> Json:
    """Take the messages of a language, by catalogue and key; a page fetches what it needs."""
    folder = languages.FOLDER / fields["language"]
    folder.mkdir(exist_ok=True)
    for name, texts in json.loads(data).items():
        (folder / f"{name}{languages.CACHE_ENDING}").write_bytes(
            marshal.dumps(texts, languages.MARSHAL_VERSION)
        )
    languages.forget_languages()
    return {}


_HANDLERS: dict[str, Callable[[Json, bytes], Json]] = {
    "learn": _learn, "check": _check, "repair": _repair, "open": _open, "line": _line,
    "blocks": _blocks, "text": _text, "rename": _rename, "speak": _speak,
}  # fmt: skip


def _request_handler(action: str) -> Callable[[Json, bytes], Json]:
    """Return the handler of a request. The page starts without its robots, which load on demand."""
    if action in _HANDLERS:
        return _HANDLERS[action]
    if action.startswith(
        "group_"
    ):  # the page has loaded this module by now; its first archive lacks it
        sys.path_importer_cache.clear()
        handlers: dict[str, Callable[[Json, bytes], Json]] = import_module(TOGETHER_MODULE).HANDLERS
        return handlers[action]
    if action in ("connect", "link", "import_keys"):
        from tiniscript.studio.page_line import HANDLERS
    else:
        from tiniscript.studio.virtual_requests import HANDLERS
    return HANDLERS[action]
