"""The files generated from the table of messages: `messages.h`, `messages.cpp`, `link/payloads.py`.

`__main__.py` writes the files, and the tables of `docs/develop/link.md`, which are here too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import accumulate

from tiniscript.base.languages import SOURCE_LANGUAGE, text
from tiniscript.link import messages
from tiniscript.link.messages import FIRST_EVENT, MESSAGES, SHARED_REPLIES, Field, Message
from tools.generate.cpp_header import (
    camel,
    constants,
    constants_of,
    cpp_file,
    enumeration,
)

UNKNOWN_REQUEST = 255  # longer than any payload


def header(command: str) -> str:
    """Return `messages.h`: every number of the link."""
    message_rows = [(message.name, message.number, message.meaning) for message in MESSAGES]
    statuses = [
        (name, number, text("statuses", f"{name}/said", SOURCE_LANGUAGE))
        for name, number in messages.STATUSES.items()
    ]
    parts = (
        constants(
            ("kLinkMajor", messages.MAJOR),
            ("kLinkMinor", messages.MINOR),
        )
        + constants_of(
            messages, "SMALL_FRAME", "LARGE_FRAME", "LARGE_WINDOW", "HEAD_BYTES",
            "CRC_BYTES", "REPLY", "SEALED", "NAME_BYTES", "MAX_BALANCE", "MAX_LEAST",
            "STOP_ZEROS", "SILENCE_MS", "ZERO_MS", "TEXT_MS", "HELD_MS", "DEAD_MAN_MS", "LISTEN_MS",
            "AGAIN_MS", "KEY_BYTES", "CHALLENGE_BYTES", "TAG_BYTES", "AUTHORITY_MS",
            "LONG_MS", "CLAIM_MS", "FORGET_MS", "NETWORK_BYTES",
            "WIFI_TEXT_BYTES", "PASSWORD_BYTES", "MIN_PASSWORD", "CLASS_BYTES",
            "BROKER_PLACE_BYTES", "BROKER_NAME_BYTES", "TRUST_BYTES", "MAX_PAD", "HOLD_MS",
            "MAX_BREAKPOINTS", "AFTER_GAP",
        ),
        "// How a program starts, in one byte.\n"
        + constants(*((f"k{camel(name)}", bits) for bits, name, _ in messages.MODES)),
        "// How the motors are wired, in one byte.\n"
        + constants(*((f"k{camel(name)}", bits) for bits, name, _ in messages.WHEELS)),
        "// What the robot is able to do and who may drive it, in one number.\n"
        + constants(*((f"k{camel(name)}", bits) for bits, name, _ in messages.FEATURES)),
        enumeration("Message", message_rows),
        "// Requests are the numbers from 1 up to this one; from kFirstActing on they act.\n"
        + constants_of(messages, "FIRST_ACTING")
        + _last_request(),
        "// How long the payload of each request may be, from the first one on: least and most.\n"
        "// What this robot does not know has kUnknownRequest as its least.\n"
        + constants(("kUnknownRequest", UNKNOWN_REQUEST))
        + "extern const uint8_t kRequestBytes[][2] tini_progmem;\n",
        "// Where each field of a request begins.\n" + constants(*_offset_constants()),
        "// What begins a reply. Below 64: an image's Refusal, or the verifier's Rule.\n"
        + enumeration("Answer", statuses),
        *(
            enumeration(
                name, [(value_name, k, meaning) for k, (value_name, meaning) in enumerate(rows)]
            )
            for name, rows in (
                ("State", messages.STATES), ("Saved", messages.SAVED_STATES),
                ("Cause", messages.CAUSES), ("Reset", messages.RESETS),
                ("TextLevel", messages.TEXT_LEVELS),
                ("Key", messages.KEYS), ("WifiStep", messages.WIFI_STEPS),
                ("WifiMode", messages.WIFI_MODES), ("WifiState", messages.WIFI_STATES),
                ("ResumeHow", messages.RESUMES), ("TaskState", messages.TASK_STATES),
            )
        ),
        "// Faults that no instruction makes. The others are `Fault`.\n"
        + enumeration(
            "LinkFault", [(name, n, meaning) for n, name, meaning in messages.LINK_FAULTS]
        ),
    )  # fmt: skip
    comment_lines = (
        "The numbers of the link: messages, where the fields of their requests begin,",
        "statuses, states, times. Knows no behaviour. `docs/develop/link.md` says what they mean.",
    )
    body = "\n".join(parts)
    return cpp_file(command, "link/messages.h", comment_lines, body, "../vm/build.h", "../vm/cpu.h")


def tables(command: str) -> str:
    """Return `messages.cpp`: the table that the header declares."""
    requests = {request.number: request for request in _requests()}
    rows = [_length_row(requests.get(number)) for number in range(1, max(requests) + 1)]
    end_index = len(rows) - len(messages.READING_MESSAGES)
    first_index = end_index - len(messages.BREAKPOINT_MESSAGES)
    optional_rows = f"    tini_of_breakpoints(  //\n{''.join(rows[first_index:end_index])}    )\n"
    optional_rows += f"    tini_of_readings(  //\n{''.join(rows[end_index:])}    )\n"
    other_rows = "".join(rows[:first_index])
    table = f"const uint8_t kRequestBytes[][2] tini_progmem = {{\n{other_rows}{optional_rows}}};\n"
    return cpp_file(command, "link/messages.cpp", (), table, "sizes.h")


def _last_request() -> str:
    """Return kLastRequest: the requests that not every robot has come last."""
    parts = messages.BREAKPOINT_MESSAGES, messages.READING_MESSAGES
    last_names = [name for part in parts for name in part]
    last_requests = _requests()[-len(last_names) :]
    assert [message.name for message in last_requests] == last_names
    end = last_requests[0].number - 1 + len(parts[0])
    number = f"kTellsReadings    ? {last_requests[-1].number}\n"
    number += f"                                 : kHasBreakpoints ? {end}\n"
    number += f"                                                   : {last_requests[0].number - 1}"
    return f"constexpr uint8_t kLastRequest = {number};\n"


def _length_row(request: Message | None) -> str:
    """Return the row of a number; None: it is retired."""
    if request is None:
        return "    {kUnknownRequest, 0},  // retired\n"
    lengths = _length_range(request.request)
    for names, condition in (
        (messages.RADIO_MESSAGES, "kHasTransports"),
        (messages.REMOTE_MESSAGES, "kHasRemote"),
    ):
        if request.name in names:
            least_bytes, most_bytes = lengths.split(", ")
            lengths = (
                f"{condition} ? {least_bytes} : kUnknownRequest, {condition} ? {most_bytes} : 0"
            )
    return f"    {{{lengths}}},  // {request.name}\n"


def _length_range(fields: tuple[Field, ...]) -> str:
    """Return the least and the most of a payload; a payload that fills a frame depends on the
    robot."""
    least_bytes, most_bytes = messages.sizes(fields)
    is_filling = any(field.fills_frame for field in fields)
    return f"{least_bytes}, {'kPayloadBytes' if is_filling else most_bytes}"


def _requests() -> list[messages.Message]:
    requests = [message for message in MESSAGES if message.number < messages.FIRST_EVENT]
    numbers = sorted([*(request.number for request in requests), *messages.RETIRED_NUMBERS])
    assert numbers == list(range(1, len(numbers) + 1))
    return requests


def _offset_constants() -> list[tuple[str, int]]:
    constants = []
    for request in _requests():
        offsets = accumulate((field.least_bytes for field in request.request), initial=0)
        for field, offset in zip(request.request, offsets, strict=False):
            constants.append((f"k{camel(request.name)}{camel(field.name)}At", offset))
    return constants


# -- the tables of the document ------------------------------------------------------------------

Rows = tuple[Sequence[str], Sequence[Sequence[object]]]


def message_rows() -> Rows:
    rows = [
        (
            message.number,
            f"`{message.name}`",
            _fields_text(message.request) if message.number < messages.FIRST_EVENT else "",
            _fields_text(message.reply),
            message.meaning,
        )
        for message in MESSAGES
    ]
    rows += [(number, "retired", "", "", "") for number in messages.RETIRED_NUMBERS]
    rows.sort(key=lambda row: row[0])
    head = ("number", "message", "from the computer", "from the robot, after the status", "meaning")
    return head, rows


def _fields_text(fields: Sequence[Field]) -> str:
    """Return the fields of a payload as the document names them."""
    words = [
        f"{field.name}:{field.least_bytes}..{'' if field.fills_frame else field.most_bytes}"
        if field.kind == "rest"
        else f"{field.name}:{field.kind}"
        for field in fields
    ]
    return f"`{' '.join(words)}`" if words else "-"


def status_rows() -> Rows:
    rows = []
    for name, number in messages.STATUSES.items():
        detail = messages.DETAILS.get(name, "")
        rows.append(
            (number, f"`{name}`", detail, text("statuses", f"{name}/said", SOURCE_LANGUAGE))
        )
    return ("number", "status", "detail", "English"), rows


def number_rows(table: Sequence[tuple[str, str]]) -> Rows:
    rows = [(number, f"`{name}`", meaning) for number, (name, meaning) in enumerate(table)]
    return ("number", "name", "meaning"), rows


def bit_rows(
    table: Sequence[tuple[int, str, str]], bits: str = "bits", digit_count: int = 2
) -> Rows:
    rows = [
        (f"0x{number:0{digit_count}x}", f"`{name}`", meaning) for number, name, meaning in table
    ]
    return (bits, "name", "meaning"), rows


DOCUMENT_TABLES: dict[str, dict[str, Callable[[], Rows]]] = {
    "docs/develop/link.md": {
        "messages": message_rows,
        "modes": lambda: bit_rows(messages.MODES),
        "wheels": lambda: bit_rows(messages.WHEELS, "bit"),
        "features": lambda: bit_rows(messages.FEATURES, digit_count=4),
        "text levels": lambda: number_rows(messages.TEXT_LEVELS),
        "statuses": status_rows,
        "states": lambda: number_rows(messages.STATES),
        "saved": lambda: number_rows(messages.SAVED_STATES),
        "causes": lambda: number_rows(messages.CAUSES),
        "resets": lambda: number_rows(messages.RESETS),
        "resumes": lambda: number_rows(messages.RESUMES),
        "task states": lambda: number_rows(messages.TASK_STATES),
        "faults": lambda: (
            ("number", "fault", "when"),
            [(number, f"`{name}`", what) for number, name, what in messages.LINK_FAULTS],
        ),
    },
    "docs/develop/network.md": {
        "wifi_steps": lambda: number_rows(messages.WIFI_STEPS),
        "wifi_modes": lambda: number_rows(messages.WIFI_MODES),
        "wifi_states": lambda: number_rows(messages.WIFI_STATES),
    },
    "docs/develop/owners.md": {"keys": lambda: number_rows(messages.KEYS)},
}


def payloads(command: str) -> str:
    """Return `payloads.py`: a type for each reply and each event."""
    replies = [message for message in MESSAGES if message.number < FIRST_EVENT]
    events = [message for message in MESSAGES if message.number >= FIRST_EVENT]
    types: dict[str, list[Message]] = {}
    for reply in replies:
        types.setdefault(_reply_type_name(reply), []).append(reply)
    parts = [
        f"# Generated by {command} from the table in messages.py. Do not edit.\n"
        '"""The contents of a robot\'s replies and events. Knows fields, no bytes."""\n'
        "\n"
        "from typing import Literal, NamedTuple\n"
    ]
    for name, messages_of_type in types.items():
        message_names = ", ".join(message.name for message in messages_of_type)
        parts.append(
            _type_definition(
                name, f"Values in the reply to {message_names}.", messages_of_type[0].reply
            )
        )
    for event in events:
        name_line = f'    name: Literal["{event.name}"] = "{event.name}"\n'
        parts.append(
            _type_definition(_event_type_name(event), event.meaning, event.reply, name_line)
        )
    union_text = "".join(f"    | {type_name}\n" for type_name in types)
    entries = "".join(f'    "{reply.name}": {_reply_type_name(reply)},\n' for reply in replies)
    parts.append(
        f"SentReply = (\n{union_text.replace('| ', '', 1)})\n"
        f"REPLIES: dict[str, type[SentReply]] = {{\n{entries}}}\n"
    )
    return "\n\n".join(parts)


def _reply_type_name(message: Message) -> str:
    """Return the name of a reply's type, which several messages may share."""
    shared_names = (name for name, fields in SHARED_REPLIES.items() if fields == message.reply)
    return next(shared_names, camel(message.name) + "Reply")


def _event_type_name(message: Message) -> str:
    return camel(message.name) + "Event"


def _type_definition(name: str, meaning: str, fields: Sequence[Field], tag: str = "") -> str:
    rows = [f"    {field.name}: {'bytes' if field.kind == 'rest' else 'int'}\n" for field in fields]
    lines = "".join((*rows, tag))
    return f'class {name}(NamedTuple):\n    """{meaning}"""\n' + (f"\n{lines}" if lines else "")
