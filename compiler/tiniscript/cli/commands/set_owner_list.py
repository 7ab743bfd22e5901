"""`tsc set owner --list`: the robots whose keys this computer has; a list for another computer."""

from __future__ import annotations

import json
import re
import sys
from argparse import Namespace
from pathlib import Path

from tiniscript.base import files
from tiniscript.cli import outputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.texts import say, text
from tiniscript.link import keys
from tiniscript.link.authority import RobotKey
from tiniscript.link.keys import BadKeys, KeyFile, TooManyKeys
from tiniscript.link.messages import KEYS


def run(options: Namespace, language: str) -> int:
    actions = options.list or None, options.export, options.bring, options.forget, options.accept
    if sum(action is not None for action in actions) > 1:
        raise CommandError(2, "one_way")
    key_file = KeyFile()
    try:
        robot_keys = key_file.all()
    except BadKeys as error:
        raise _key_file_error(key_file, "own_keys_bad", error) from None
    if keys.is_shared(key_file.path):
        warning = CommandError(0, "keys_shared", file=printable_name(str(key_file.path)))
        print(warning.sentence(language), file=sys.stderr)
    if options.export is not None:
        _export(robot_keys, options.export, language)
    elif options.bring is not None:
        _import(key_file, options.bring, language)
    elif options.forget is not None:
        _forget(key_file, robot_keys, options.forget, language)
    elif options.accept is not None:
        _accept(key_file, options.accept, language)
    elif options.json:
        print(json.dumps([_fields(key) for key in robot_keys], indent=2))
    else:
        _print(robot_keys, language)
    return 0


def _export(robot_keys: list[RobotKey], name: str, language: str) -> None:
    path = Path(name)
    if path.exists():
        raise CommandError(2, "export_there", file=printable_name(name))
    exported_keys = [key._replace(is_stale=False) for key in robot_keys if not key.is_pending]
    outputs.write(path, keys.encode_keys(exported_keys), "unwritable_more --export", keys.FILE_MODE)
    say("keys_exported", language, n=len(exported_keys), file=printable_name(name))


def _import(key_file: KeyFile, name: str, language: str) -> None:
    try:
        imported_keys = keys.decode_keys(files.read_limited(Path(name), keys.FILE_BYTES))
    except (OSError, ValueError, BadKeys):
        raise CommandError(2, "bad_keys", file=printable_name(name)) from None
    try:
        changed_count = key_file.add(imported_keys)
    except TooManyKeys:
        raise CommandError(
            2, "too_many_keys", most=str(keys.MAX_KEYS), file=printable_name(name)
        ) from None
    except BadKeys as error:
        raise _key_file_error(key_file, "own_keys_full", error) from None
    say(
        "keys_imported",
        language,
        n=changed_count,
        all=len(imported_keys),
        file=printable_name(name),
    )


def _forget(key_file: KeyFile, robot_keys: list[RobotKey], robot_name: str, language: str) -> None:
    forgotten_keys = [key for key in robot_keys if robot_name.lower() == f"{key.id:08x}"]
    forgotten_keys = forgotten_keys or [key for key in robot_keys if robot_name == key.name]
    if len({key.id for key in forgotten_keys}) != 1:
        raise CommandError(2, "no_such_key", robot=printable_name(robot_name))
    try:
        key_file.forget(forgotten_keys[0].id)
    except BadKeys as error:
        raise _key_file_error(key_file, "own_keys_full", error) from None
    say("keys_forgotten", language, robot=printable_name(robot_name))


def _accept(key_file: KeyFile, robot_id: str, language: str) -> None:
    if not re.fullmatch("[0-9a-fA-F]{8}", robot_id):
        raise CommandError(2, "no_id", robot=printable_name(robot_id))
    try:
        key_file.accept(int(robot_id, 16))
    except BadKeys as error:
        raise _key_file_error(key_file, "own_keys_full", error) from None
    say("robot_accepted", language, robot=robot_id.lower())


def _key_file_error(key_file: KeyFile, key: str, error: BadKeys) -> CommandError:
    return CommandError(
        2,
        key,
        file=printable_name(str(key_file.path)),
        why=f": {error.detail}" if error.detail else "",
    )


def _print(robot_keys: list[RobotKey], language: str) -> None:
    if not robot_keys:
        say("no_keys", language)
    for key in sorted(robot_keys, key=lambda key: (key.name, key.id, key.kind)):
        kind = text(f"kind_{KEYS[key.kind][0].lower()}", language)
        row = text("key_row", language).format(
            id=f"{key.id:08x}", kind=kind, name=printable_name(key.name)
        )
        marks = [name for name in ("pending", "stale") if getattr(key, f"is_{name}")]
        marks_text = "".join(f"   ({text(f'key_{name}', language)})" for name in marks)
        print(row.rstrip() + marks_text)


def _fields(key: RobotKey) -> dict[str, object]:
    return {"id": f"{key.id:08x}", "name": key.name, "kind": KEYS[key.kind][0].lower(),
            "is_pending": key.is_pending, "is_stale": key.is_stale,
            "seals": key.uses_seals}  # fmt: skip
