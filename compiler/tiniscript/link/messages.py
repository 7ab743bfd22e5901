"""The single table of the link: messages, their fields, and every number that is sent.

`frames` and `session` import it; `python -m tools.generate` writes from it
`vm_arduino/src/link/messages.h` and the tables of `docs/develop/link.md`. Numbers on the wire are
stable: a number is never reused.

Knows numbers, sizes and times. Does not know how a message is answered.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from typing import NamedTuple

# Settings of a WiFi network are sent in several frames: its name, its password, and the action.
NETWORK_BYTES, PASSWORD_BYTES = 32, 63
# Shortest password of WPA2; longest name, or part of a password.
MIN_PASSWORD, WIFI_TEXT_BYTES = 8, 32
# Bytes of a class name (a to z, 0 to 9, -), and of an address with its port.
CLASS_BYTES, BROKER_PLACE_BYTES = 16, 6
BROKER_NAME_BYTES, TRUST_BYTES = 96, 2048  # bytes of a computer's name, and of a certificate in DER
WIFI_STEPS = (
    ("TELL", "Changes nothing."),
    ("NETWORK", "The name of a network. The robot forgets any earlier step."),
    ("PASSWORD", "The next part of the network's password."),
    ("JOIN", "The robot joins that network, now and after each reset."),
    ("HOST", "The robot is an access point with that name."),
    ("FORGET", "The robot no longer uses WiFi or a broker."),
    (
        "BROKER",
        "An MQTT broker: its address, its port (16 bits) and the class. The robot forgets any earlier step. Empty: no broker.",
    ),
    ("BROKER_USER", "The robot's user name at the broker."),
    ("BROKER_PASSWORD", "The next part of the robot's password at the broker."),
    ("USE_BROKER", "The robot connects to that broker, now and after each reset, or to none."),
    (
        "TELL_BROKER",
        "Changes nothing. The reply is about the broker: `mode` is 1 if there is one, the address is the broker's, and `network` is the class.",
    ),
    (
        "BROKER_NAME",
        "The next part of the broker's name, as in its certificate. If the name is not found, the address is used.",
    ),
    (
        "BROKER_TLS",
        "Use TLS with the broker. The text is today's date, as 20261121 (32 bits): a certificate that expired earlier is refused.",
    ),
    (
        "BROKER_TRUST",
        "The next part of the certificate, in DER, that signs the broker's certificate.",
    ),
)
WIFI_MODES = (
    ("OFF", "No network is set."),
    ("STATION", "The robot joins a network."),
    ("ACCESS_POINT", "The robot is an access point."),
)
WIFI_STATES = (
    ("OFF", "The robot has no WiFi, or has not started it."),
    ("SEARCHING", "It cannot find the network, or is waiting for an answer."),
    ("REFUSED", "The network has refused the robot: the password may be wrong."),
    ("READY", "It has an address."),
    ("UNTRUSTED", "The broker's certificate is not signed by the one that the robot trusts."),
    ("OTHER_NAME", "The broker's certificate is for a computer with another name."),
    ("EXPIRED", "The broker's certificate had expired before the robot got it."),
    (
        "NO_TLS",
        "The broker and the robot cannot agree on TLS, or the robot lacks the memory for it.",
    ),
    (
        "RESTS",
        "WiFi is off, because the robot restarted three times in a row soon after it started WiFi. JOIN, HOST and FORGET end that.",
    ),
)


MAJOR = 2  # a robot and a computer with different versions understand only each other's HELLO
MINOR = 2  # grows when messages, statuses or features are added

# Bytes of a frame before COBS. A large one has a 0 after its head, so that its first byte on the
# wire is at most 4. All robots accept small ones; HELLO reports whether they accept large ones, and
# how many requests they hold before the first answer.
SMALL_FRAME, LARGE_FRAME = 63, 250
LARGE_WINDOW = 4
HEAD_BYTES = 3  # type, sequence number, epoch
CRC_BYTES = 4
STATUS_BYTES = 1  # bytes before the fields of a reply
REPLY = 0x80  # flag of a type: sent to the computer
SEALED = 0x40  # flag of a type: a 0 and a counter before the payload, and a MAC after it
NAME_BYTES = 16
TRIM_BYTES, PACE_BYTES = 3, 8
KEY_BYTES = 16
CHALLENGE_BYTES = 8
TAG_BYTES = 8
PLACE_BYTES = 6  # bytes of a PING reply: the program's place (16 bits) and its checksum
NOISE_BYTES = 2  # noise of both discs
MAX_BREAKPOINTS = 4
VARIABLE_BYTES, TASK_BYTES = 4, 7  # bytes of one variable, and of one task
VARIABLES_BYTES = 13 * VARIABLE_BYTES  # variables in one frame
ALL_TASKS_BYTES = 5 * TASK_BYTES  # all tasks; the main one is last
AFTER_GAP = 0x80  # flag in READING's sensor: earlier readings were not sent
SHOW_PLACE_BYTES = 3  # bytes of a SHOW's place: its run, and its instruction (16 bits)
COUNTER_BYTES = 4


def payload_bytes(frame_bytes: int, is_sealed: bool = False) -> int:
    """Return the most bytes of a payload where a frame has `frame_bytes` at most."""
    extra_bytes = 1 + COUNTER_BYTES + TAG_BYTES if is_sealed else int(frame_bytes > SMALL_FRAME)
    return frame_bytes - HEAD_BYTES - CRC_BYTES - extra_bytes


PAYLOAD_BYTES = payload_bytes(SMALL_FRAME)
SEALED_PAYLOAD_BYTES = payload_bytes(SMALL_FRAME, is_sealed=True)

STOP_BYTES = 8  # zeros that a computer sends to stop a robot
STOP_ZEROS = 4  # zeros in a row that stop it
SILENCE_MS = 1000  # silence after which all bytes are text until a 0x00
ZERO_MS = 400  # silence after which a sender starts with a 0x00
TEXT_MS = 1100  # time for which text waits after a frame
HELD_MS = 100  # silence after which a typed stop acts inside a started frame
DEAD_MAN_MS = 1000  # dead-man timer: without a valid frame, an attached program ends
LISTEN_MS = 3000  # time without a valid frame after which a robot sends no events
AGAIN_MS = 50  # between two STOPPED events of a stopped robot
AUTHORITY_MS = 2000  # time without a valid frame after which a key must be shown again
LONG_MS = 1000  # a press of the button of this length has no effect
CLAIM_MS = 2000  # a press of this length lets a client claim the robot, or lets text drive it
FORGET_MS = 10_000  # a press of this length from power-on makes the robot forget its keys

# How a program starts and whether it is kept: one byte of LIVE, PROGRAM, BEGIN and START.
START_BITS, RUN, SAVE, DETACHED, HALTS = 0x03, 0x10, 0x20, 0x40, 0x80
MODES = (
    (START_BITS, "START_BITS", "The start mode of an image: 0 `SI`, 1 `SB`."),
    (RUN, "RUN", "Start it at once, if it is `SI`. LIVE has this bit and no other but HALTS."),
    (SAVE, "SAVE", "Keep it when the power is off."),
    (DETACHED, "DETACHED", "It continues without the link. START may have this bit and no other."),
    (
        HALTS,
        "HALTS",
        "Halt before its first statement: only LIVE, and only a robot with BREAKPOINTS.",
    ),
)

# A robot's features and its allowed drivers, in one number of the reply to HELLO. Older firmware
# sends 0.
TEXT_LEVEL, REMOTE, PLACES, OWNERS, OWNED = 0x0003, 0x0004, 0x0008, 0x0010, 0x0020
TEXT_ALLOWED = 0x0040
YOURS, BY_TEACHER, SEALS, WIFI_RESTS = 0x0080, 0x0100, 0x0200, 0x0400
BREAKPOINTS, READINGS = 0x0800, 0x1000
FEATURES = (
    (TEXT_LEVEL, "TEXT_LEVEL", "Which level of text the robot reads, a number of the table below."),
    (REMOTE, "REMOTE", "Its programs can read KEY_UP and the rest of a remote control: KEYS."),
    (PLACES, "PLACES", "When PING asks, it reports which instruction its program has reached."),
    (OWNERS, "OWNERS", "The robot knows owners."),
    (OWNED, "OWNED", "It has an owner."),
    (TEXT_ALLOWED, "TEXT_ALLOWED", "Lines of text may drive it."),
    (YOURS, "YOURS", "This session has authenticated with a key of the robot."),
    (BY_TEACHER, "BY_TEACHER", "That key was the teacher's."),
    (
        SEALS,
        "SEALS",
        "It accepts requests that need a key only if they are sealed, and seals its messages to the session that has authenticated.",
    ),
    (
        WIFI_RESTS,
        "WIFI_RESTS",
        "Its WiFi is off, after three restarts in a row soon after WiFi started.",
    ),
    (
        BREAKPOINTS,
        "BREAKPOINTS",
        "Its programs can halt at places: BREAK, RESUME, READ_VARIABLES, READ_TASKS.",
    ),
    (READINGS, "READINGS", "It can report what its programs read: TELL_READINGS."),
)
# The state of a remote control: a bit for each held key, and the pad in percent to the right and
# up. It expires after this time, so that an old state of a client that has left moves nothing.
REMOTE_KEYS = ("UP", "DOWN", "LEFT", "RIGHT", "A", "B")
MAX_PAD = 100
HOLD_MS = 500
# The keys of a robot: `kind` of CLAIM and AUTHENTICATE.
KEYS = (
    (
        "OWNER",
        "The key of whoever claimed the robot. Once it is claimed, nobody can drive the robot without a key.",
    ),
    (
        "TEACHER",
        "Gives the same rights. After a stop with this key, only this key or the button releases the robot.",
    ),
)

# The trim of the motors: their wiring, how much one is weakened, and the least power that moves.
EXCHANGED, LEFT_REVERSED, RIGHT_REVERSED = 0x01, 0x02, 0x04
MAX_BALANCE, MAX_LEAST = 40, 40  # percent
WHEELS = (
    (EXCHANGED, "EXCHANGED", "The left motor is where the right one should be."),
    (LEFT_REVERSED, "LEFT_REVERSED", "The left wheel turns the wrong way round."),
    (RIGHT_REVERSED, "RIGHT_REVERSED", "The right wheel turns the wrong way round."),
)


class Field(NamedTuple):
    """`kind` is one of KINDS, or `rest`: all remaining bytes, `least_bytes` to `most_bytes`.

    A field that `fills_frame` has as many bytes as the frame allows; `most_bytes` is that of a
    large one.
    """

    name: str
    kind: str
    least_bytes: int
    most_bytes: int
    fills_frame: bool = False


class Message(NamedTuple):
    """`request` has the fields that a computer sends, `reply` those that follow the status OK.

    An event has no request; its fields are in `reply`. A message that `is_action` is stale if its
    epoch is not the robot's.
    """

    number: int
    name: str
    is_action: bool
    request: tuple[Field, ...]
    reply: tuple[Field, ...]
    meaning: str


KINDS = {"u8": "B", "u16": "H", "u32": "I", "i8": "b", "i32": "i"}


def _fields(text: str, bytes_before: int = 0) -> tuple[Field, ...]:
    """Return the fields that a text names, after so many bytes of the payload."""
    fields: list[Field] = []
    for word in text.split():
        name, _, kind = word.partition(":")
        kind, _, range_of_rest = kind.partition("=")
        if kind == "rest":
            low, _, high = range_of_rest.partition("..")
            room = (
                payload_bytes(LARGE_FRAME)
                - bytes_before
                - sum(field.most_bytes for field in fields)
            )
            fields.append(Field(name, kind, int(low), int(high or room), fills_frame=not high))
        else:
            size = struct.calcsize(KINDS[kind])
            fields.append(Field(name, kind, size, size))
    return tuple(fields)


def _message(
    number: int, name: str, is_action: bool, request: str, reply: str, meaning: str
) -> Message:
    return Message(number, name, is_action, _fields(request), _fields(reply, STATUS_BYTES), meaning)


# The robot's memory has these records too: `port.h`.
_IDENTITY = "kit:u16 id:u32 nonce:u32 features:u16 reset:u8"
_STATUS = "state:u8 run:u8 program:u32 length:u16 slot:u8 saved:u8 fault:u8 fault_at:u16 fault_program:u32"
_PULSE = f"state:u8 run:u8 place:rest=0..{PLACE_BYTES}"
_RECEIPT = "program:u32 run:u8 slot:u8 saved:u8"

# fmt: off
MESSAGES = (
    # these are valid at any time, in any epoch
    _message(1, "HELLO", False, "major:u8 minor:u8 isa_major:u8 isa_minor:u8 kit:u16 nonce:u32",
             "major:u8 minor:u8 isa_major:u8 isa_minor:u8 largest:u8 window:u8 " + _IDENTITY + " room:u16 "
             + _STATUS + " name:rest=0..16",
             "Begins a session. The same `nonce` again is the same session."),
    _message(2, "PING", False, "asks:rest=0..1", _PULSE,
             "Asks whether the robot is there; also the heartbeat. With a one-byte payload, it also asks which instruction the program has reached."),
    _message(3, "STATUS", False, "",
             _STATUS + f" damaged:u8 dropped:u8 framing:u8 overrun:u8 noise:rest=0..{NOISE_BYTES}",
             "Asks what the robot is doing, what its last fault was, and how well it receives."),
    _message(4, "FETCH", False, "offset:u16", "length:u16 bytes:rest=0..",
             "Asks for the stored program's image, starting at `offset`. `length` is the length of the whole image."),
    _message(5, "STOP", False, "", "", "Does the same as the stop sequence, but gets an answer."),
    # these act: they are valid in one epoch only
    _message(6, "CLEAR", True, "", "", "Releases the latch that a stop or a fault has set."),
    _message(7, "START", True, "mode:u8", _RECEIPT, "Starts the program that the robot holds."),
    _message(8, "LIVE", True, "mode:u8 code:rest=0..", _RECEIPT,
             "Runs code once. The program that the robot holds does not change."),
    _message(9, "PROGRAM", True, "mode:u8 code:rest=0..", _RECEIPT, "Sends a whole program in one frame."),
    _message(11, "DATA", True, "offset:u16 bytes:rest=1..", "next:u16",
             "Sends the bytes after the checksum, starting at `offset`. The robot accepts only DATA that begins at `next`."),
    _message(12, "COMMIT", True, "checksum:u32", _RECEIPT, "Ends a longer program, with its image's checksum."),
    _message(14, "NAME", True, "name:rest=1..16", "", "Names the robot, in UTF-8. The answer is OK once the name is saved; until then it is SAVING or LOW_SUPPLY: ask again."),
    _message(15, "TRIM", True, f"trim:rest=0..{TRIM_BYTES + PACE_BYTES}", f"wheels:u8 balance:i8 least:u8 pace:rest=0..{PACE_BYTES}",
             "Sets the motors' trim, with the fields of the reply, with or without `pace`. Without any bytes, it only asks for the trim. Answers OK as NAME does."),
    _message(16, "CLAIM", True, f"kind:u8 key:rest=0..{KEY_BYTES}", "",
             "Gives the robot the key with the number `kind` after its button has been held. If `key` is empty, it removes the key with that number. Answers OK as NAME does."),
    _message(17, "AUTHENTICATE", True, f"kind:u8 tag:rest=0..{TAG_BYTES}", f"features:u16 challenge:rest=0..{CHALLENGE_BYTES}",
             "Without a tag, it asks for a challenge. With a tag, it proves possession of a key of the robot."),
    _message(18, "IDENTIFY", True, "", "", "Makes the robot blink and play the tune of its id."),
    _message(19, "UNDO", True, "", _RECEIPT,
             "Brings back the previous program. The running program ends; no program starts."),
    _message(20, "TEXT", True, "is_allowed:u8", "features:u16", "Sets whether lines of text may drive a robot with an owner, until power-off."),
    _message(21, "WIFI", True, f"step:u8 text:rest=0..{WIFI_TEXT_BYTES}", f"mode:u8 state:u8 address:u32 network:rest=0..{NETWORK_BYTES}",
             "Sets, forgets or reports the robot's WiFi, in several steps. It must be sealed. Answers OK as NAME does."),
    _message(22, "BEGIN", True, "mode:u8 isa_major:u8 isa_minor:u8 start:u8 header_length:u8 devices:u16 code_length:u16",
             "next:u16", "Begins a longer program, with the fields of its image's header before the checksum."),
    _message(23, "ABORT", True, "", "", "Drops the program that was begun."),
    _message(24, "KEYS", True, "keys:u8 x:i8 y:i8", _PULSE,
             "Sends the state of a remote control: a bit for each key that is held, and the position of its stick. Also a heartbeat."),
    _message(25, "BREAK", True, f"places:rest=0..{2 * MAX_BREAKPOINTS}", "",
             "Sets all places where a program halts, as 16-bit offsets: in the running program or, if none is running, in the one that the robot holds."),
    _message(26, "RESUME", True, "how:u8", "run:u8 was_halted:u8",
             "Continues a halted program; `how` says how far."),
    _message(27, "READ_VARIABLES", True, "first:u8", f"run:u8 is_halted:u8 values:rest=0..{VARIABLES_BYTES}",
             "Asks for the variables of the running program, starting with the variable `first`: 32 bits each."),
    _message(28, "READ_TASKS", True, "", f"run:u8 is_halted:u8 task:u8 offset:u16 tasks:rest=0..{ALL_TASKS_BYTES}",
             "Asks for the tasks of the running program, and where each of them is."),
    _message(29, "TELL_READINGS", True, "is_on:u8", "",
             "Sets whether the robot sends READING to this session."),
    # events: a robot sends these without being asked
    _message(32, "SHOW", False, "", f"value:i32 is_yes_no:u8 place:rest=0..{SHOW_PLACE_BYTES}",
             "A value that a program shows. `place`: its run, and where its SHOW is."),
    _message(33, "FAULT", False, "", "run:u8 fault:u8 offset:u16 program:u32",
             "The program has ended with a fault."),
    _message(34, "STOPPED", False, "", "cause:u8", "The robot was stopped: it has a new epoch. Repeated: it is still stopped."),
    _message(35, "DONE", False, "", "run:u8", "The program has ended."),
    _message(37, "HALTED", False, "", "run:u8 offset:u16 task:u8",
             "The program is halted before a statement. Repeated: it still is."),
    _message(38, "READING", False, "", "run:u8 sensor:u8 value:i32 ms:u16",
             "A reading has changed. `ms`: the low 16 bits of the time since the run's start."),
)
FIRST_ACTING = 6
RETIRED_NUMBERS = (10, 13)  # a request that is LF or CR on the wire could be the end of a line
RADIO_MESSAGES = ("WIFI",)  # requests that only robots with WiFi know,
REMOTE_MESSAGES = ("KEYS",)  # messages that need a remote control
# These are the last ones, so that the table of a robot without them ends before. A robot that
# reports readings has breakpoints.
BREAKPOINT_MESSAGES = ("BREAK", "RESUME", "READ_VARIABLES", "READ_TASKS")
READING_MESSAGES = ("TELL_READINGS",)
FIRST_EVENT = 32
# Replies with the same fields share a type: its name, and its fields.
SHARED_REPLIES = {
    "PingReply": _fields(_PULSE, STATUS_BYTES),
    "ReceiptReply": _fields(_RECEIPT),
    "NextReply": _fields("next:u16"),
    "EmptyReply": (),
}

# The status, the first byte of a reply. 1 to 19 are the refusals of an image, 20 to 63 the rules
# of the verifier: `bytecode_spec.md`. The sentences are in `statuses.toml`.
FIRST_RULE, FIRST_STATUS = 20, 64
STATUSES = {
    "OK": 0,
    "UNKNOWN_MESSAGE": 64,
    "BAD_LENGTH": 65,
    "BAD_VALUE": 66,
    "STALE": 67,
    "OTHER_LINK": 68,
    "OTHER_MACHINE": 69,
    "WRONG_KIT": 70,
    "TOO_LARGE": 71,
    "BUSY": 72,
    "LATCHED": 73,
    "NO_PROGRAM": 74,
    "NOT_BEGUN": 75,
    "INCOMPLETE": 76,
    "NOT_SEALED": 77,
    "SAVING": 78,
    "LOW_SUPPLY": 79,
    "NOT_KEPT": 80,
    "NOT_OWNER": 84,
    "WRONG_KEY": 85,
    "HOLD_BUTTON": 87,
    "HELD_BACK": 88,
    "NO_PREVIOUS": 90,
    "OTHER_DRIVER": 91,
    "UNOWNED": 92,
    "UNREADABLE": 93,
    "NO_REMOTE": 94,
    "NO_BREAKPOINTS": 95,
    "NO_READINGS": 96,
}
# The meaning of the number after a status other than OK. Statuses not listed here have 0.
DETAILS = {
    "OTHER_LINK": "the robot's major version",
    "OTHER_MACHINE": "the robot's instruction set: major times 256, and minor",
    "WRONG_KIT": "the fingerprint of the robot's kit",
    "TOO_LARGE": "bytes of code for which the robot has room",
    "INCOMPLETE": "the offset of the first byte that is missing",
}

STATES = (
    ("IDLE",    "Nothing is running. The button or START starts the program, if there is one."),
    ("RUNNING", "A program is running."),
    ("STOPPED", "The robot was stopped: nothing starts before CLEAR or the button."),
    ("FAULTED", "A fault has ended the program: nothing starts before CLEAR or the button."),
)
SAVED_STATES = (
    ("NOTHING",    "The robot holds no program."),
    ("MEMORY",     "The program is only in RAM: it is lost at power-off."),
    ("SAVING",     "It is being saved: saving ends when the motors have stood still for a moment."),
    ("STORED",     "It is saved."),
    ("LOW_SUPPLY", "It is only in RAM: the voltage is too low to save it. It is saved when the voltage recovers."),
    ("OTHER_VERSION", "The stored program is for another version of the robot's machine: the robot holds none."),
    ("UNREADABLE", "The robot cannot read its memory: it holds no program, and nobody can drive it."),
)
CAUSES = (
    ("NONE",     "Not stopped."),
    ("SEQUENCE", "By the stop sequence."),
    ("MESSAGE",  "By STOP."),
    ("BUTTON",   "By the button."),
    ("CABLE",    "By a lost connection: nobody is connected any more."),
    ("TEXT",     "By a line of text."),
)
RESUMES = (
    ("GO",   "To the next place."),
    ("STEP", "To the next statement of the same task, or to a place of another one if that comes first."),
)
TASK_STATES = (
    ("ENDED",   "It has ended, or there is none."),
    ("READY",   "It is the task's turn, or the task is waiting for a reading or to send a value."),
    ("WAITING", "It is waiting for its clock, or for the next check of an UNTIL or a WHEN."),
    ("DRIVING", "Its move has the motors."),
    ("BLOCKED", "Its move is waiting for the motors."),
)
RESETS = (
    ("UNKNOWN",   "The chip does not say."),
    ("POWER",     "Power on."),
    ("BUTTON",    "The reset button, or a computer that opened the port."),
    ("BROWN_OUT", "The voltage was too low."),
    ("WATCHDOG",  "The watchdog: the robot's own program hung."),
)
# The levels of text by number, as named in `robots/text_levels.py`; 0 means none.
TEXT_LEVELS = (
    ("NONE",  "The robot reads no text."),
    ("UNO",   "Level `uno`."),
    ("MEGA",  "Level `mega`."),
    ("ESP32", "Level `esp32`."),
)
# Faults that no instruction causes. The faults of instructions are in `opcodes.py`.
LINK_FAULTS = (
    (64, "LINK_LOST", "No valid frame for a second while an attached program was running."),
    (65, "MAX_RUN",   "A program without a dead-man timer ran longer than the robot allows."),
    (66, "STALL",     "The robot's own program hung."),
)
# fmt: on


def _row_numbers(table: tuple[tuple[str, str], ...], names: str) -> tuple[int, ...]:
    """Return the number of each name: its row in the table. Raises ValueError if it has none."""
    row_names = [name for name, _ in table]
    return tuple(row_names.index(name) for name in names.split())


STATE_IDLE, STATE_RUNNING, STATE_STOPPED, STATE_FAULTED = _row_numbers(
    STATES, "IDLE RUNNING STOPPED FAULTED"
)
KEY_OWNER, KEY_TEACHER = _row_numbers(KEYS, "OWNER TEACHER")
RESUME_GO, RESUME_STEP = _row_numbers(RESUMES, "GO STEP")
(
    SAVED_NOTHING,
    SAVED_SAVING,
    SAVED_STORED,
    SAVED_LOW_SUPPLY,
    SAVED_OTHER_VERSION,
    SAVED_UNREADABLE,
) = _row_numbers(SAVED_STATES, "NOTHING SAVING STORED LOW_SUPPLY OTHER_VERSION UNREADABLE")
FIRST_LINK_FAULT = LINK_FAULTS[0][0]  # faults from this number on are not caused by the program

BY_NUMBER = {message.number: message for message in MESSAGES}
BY_NAME = {message.name: message for message in MESSAGES}
STATUS_NAMES = {number: name for name, number in STATUSES.items()}


class Malformed(Exception):
    """A payload that does not fit the table."""


def encode_payload(fields: tuple[Field, ...], values: Mapping[str, int | bytes]) -> bytes:
    """Return the payload with these values, one for each field; an optional rest without a value is
    empty."""
    assert set(values) <= {field.name for field in fields}, (fields, values)
    parts = []
    for field in fields:
        value = values.get(field.name, b"") if field.kind == "rest" else values[field.name]
        if isinstance(value, bytes):
            assert field.kind == "rest" and field.least_bytes <= len(value) <= field.most_bytes, (
                field
            )
            parts.append(value)
        else:
            parts.append(struct.pack("<" + KINDS[field.kind], value))
    return b"".join(parts)


def decode_payload(fields: tuple[Field, ...], payload: bytes) -> dict[str, int | bytes]:
    """Return the values in a payload. Raises Malformed if its length does not fit."""
    values: dict[str, int | bytes] = {}
    offset = 0
    for field in fields:
        size = len(payload) - offset if field.kind == "rest" else field.least_bytes
        if not field.least_bytes <= size <= field.most_bytes or offset + size > len(payload):
            raise Malformed
        piece = payload[offset : offset + size]
        values[field.name] = (
            piece if field.kind == "rest" else struct.unpack("<" + KINDS[field.kind], piece)[0]
        )
        offset += size
    if offset != len(payload):
        raise Malformed
    return values


def sizes(fields: tuple[Field, ...]) -> tuple[int, int]:
    """Return the least and the greatest length of a payload with these fields."""
    return sum(field.least_bytes for field in fields), sum(field.most_bytes for field in fields)
