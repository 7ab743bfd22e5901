"""Compile, check and show: programs as data."""

from __future__ import annotations

import os
from pathlib import Path

from tiniscript import robots
from tiniscript.base.files import read_limited
from tiniscript.base.languages import languages
from tiniscript.base.source import PROGRAM_SUFFIXES, printable
from tiniscript.bytecode import verify
from tiniscript.bytecode.disassembly import disassemble
from tiniscript.bytecode.image import Image, ImageRefused, unpack
from tiniscript.bytecode.verify import Refused
from tiniscript.diagnostics.rendering import Message as Message
from tiniscript.diagnostics.rendering import as_text, message
from tiniscript.library import source_map
from tiniscript.library.compiling import Compilation, compile_source, image_of
from tiniscript.library.errors import ProgramError, UsageError, sentence
from tiniscript.library.known_kits import find_robot_for
from tiniscript.library.named_robot import robot_of
from tiniscript.library.source_map import SourceMap
from tiniscript.robots.profile import ProfileRefused, Robot
from tiniscript.robots.refusals import describe

Language = str  # a language code, such as "en"
MAX_VALUE_CHARACTERS = 200  # characters of a name or a value in a sentence
MAX_REMARK_CHARACTERS = 60  # characters of a line in a disassembly
MAX_FILE_BYTES = 1_000_000  # most bytes of a file
FILE_SUFFIXES = (*PROGRAM_SUFFIXES, ".bin")


class Program:
    """A program that is ready to run. Immutable.

    `text` is None if it was read from an image; `robot` is the name of the robot that it was
    compiled for; `start` is SI, SB or PING; `checksum` identifies the image; `diagnostics` has
    warnings only, because a text with mistakes gives no Program.
    """

    __slots__ = ("_image", "_map", "_profile", "diagnostics", "image", "text")

    def __init__(
        self,
        text: str | None,
        image: bytes,
        parsed_image: Image,
        profile: Robot,
        program_map: SourceMap | None,
        diagnostics: tuple[Message, ...],
    ) -> None:
        """Internal: use `compile` instead."""
        self.text = text
        self.image = image
        self.diagnostics = diagnostics
        self._image = parsed_image
        self._profile = profile
        self._map = program_map

    @property
    def robot(self) -> str:
        return self._profile.name

    @property
    def code(self) -> bytes:
        return self._image.code

    @property
    def start(self) -> str:
        return self._image.start

    @property
    def checksum(self) -> int:
        return self._image.checksum

    def listing(self, language: Language = "en") -> str:
        """Return one line per instruction: offset, bytes, name, and the source line that it comes
        from."""
        kit = self._profile.kit if self._image.devices else None
        variables = self._map.variables if self._map is not None else ()
        return disassemble(self.code, remarks(self._map, _check_language(language)), kit, variables)

    def __repr__(self) -> str:
        name = "image" if self.text is None else repr(self.text[:40])
        return f"<Program {name}, {len(self.code)} bytes of code for {self.robot}>"


def compile(
    text: str, robot: str | os.PathLike[str] | None = None, *, name: str = "",
    optimize: bool = True, language: Language = "en",
) -> Program:  # fmt: skip
    """Compile a text for a robot: the name of a shipped one, or the path of a profile. By default
    it is the one that the text names, `// robot: liner`, or else tinibot.

    Raises ProgramError with all diagnostics if the text has mistakes. `name` is the program's name
    in messages and disassemblies; `language` (en, es) is that of diagnostics.
    """
    if not isinstance(text, str):
        raise UsageError("bad_program", _check_language(language), {"found": type(text).__name__})
    _refuse_file_name(text, language)
    return _compile_program(text, robot, name, optimize, language)


def check(
    text: str, robot: str | os.PathLike[str] | None = None, *, language: Language = "en"
) -> list[Message]:
    """Return all mistakes and warnings of a text by place; the list may be empty. `robot` as for
    `compile`. It never raises ProgramError. A program that is too large for the robot's board gives
    a warning."""
    if not isinstance(text, str):
        raise UsageError("bad_program", _check_language(language), {"found": type(text).__name__})
    compilation = _compile_for(text, robot, "", language, is_strict=False)[0]
    return diagnostics_of(compilation, language)


def show(
    program: Program | str | bytes, robot: str | os.PathLike[str] | None = None, *,
    language: Language = "en",
) -> str:  # fmt: skip
    """Return the disassembly of a program, a text or an image. Raises ProgramError."""
    return program_of(program, robot, language).listing(language)


# -- for the other files of the library -----------------------------------------------------------


def _refuse_file_name(text: str, language: Language) -> None:
    """Raise UsageError where a text is the name of a program's file."""
    if text.lower().endswith(FILE_SUFFIXES) and "\n" not in text and os.path.exists(text):  # noqa: PTH110
        values = {"path": printable(text, MAX_VALUE_CHARACTERS)}
        raise UsageError("file_name", _check_language(language), values)


def _read_file(path: os.PathLike[str], language: Language) -> str | bytes:
    """Return the text of a program's file, or the bytes of an image. Raises UsageError."""
    try:
        data = read_limited(Path(path), MAX_FILE_BYTES)
        return data if Path(path).suffix.lower() == ".bin" else data.decode("utf-8-sig")
    except (OSError, ValueError) as error:
        text = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        values = {"path": printable(str(path), 200), "why": printable(text, 200)}
        raise UsageError("unreadable", _check_language(language), values) from None


def program_of(
    program: Program | str | bytes | os.PathLike[str], robot: str | os.PathLike[str] | Robot | None,
    language: Language,
) -> Program:  # fmt: skip
    """Return a program for a robot; by default for the program's own robot or the default robot.

    Raises ProgramError, and UsageError for an argument that is not a program.
    """
    if isinstance(program, Program) and robot is None:
        return program
    if isinstance(program, os.PathLike):
        program = _read_file(program, language)
    if isinstance(program, str):
        _refuse_file_name(program, language)
        return _compile_program(program, robot, "", True, language)
    if robot is None or isinstance(robot, str | os.PathLike):
        profile = profile_of(robots.DEFAULT if robot is None else robot, language)
    else:
        profile = robot
    if isinstance(program, Program):
        parsed_image = _read_image(program.image, profile, language)
        return Program(program.text, program.image, parsed_image, profile, program._map,
                       program.diagnostics)  # fmt: skip
    if not isinstance(program, bytes | bytearray):
        raise UsageError(
            "bad_program", _check_language(language), {"found": type(program).__name__}
        )
    data = bytes(program)
    if robot is None:
        profile = find_robot_for(_unpack(data, language), profile) or profile
    parsed_image = _read_image(data, profile, language)
    return Program(None, data, parsed_image, profile, source_map.recall(parsed_image.checksum), ())


def profile_of(robot: str | os.PathLike[str], language: Language) -> Robot:
    """Return a robot's profile. Raises UsageError if it is missing or invalid."""
    _check_language(language)
    if not isinstance(robot, str | os.PathLike):
        raise UsageError("bad_robot", language, {"found": type(robot).__name__})
    try:
        return robots.load(os.fspath(robot))
    except ProfileRefused as error:
        values = {"reasons": "\n".join(describe(error, language))}
        raise UsageError("profile_refused", language, values) from None


def diagnostics_of(compilation: Compilation, language: Language) -> list[Message]:
    return [
        message(diagnostic, compilation.source, language) for diagnostic in compilation.diagnostics
    ]


def remarks(program_map: SourceMap | None, language: Language) -> dict[int, str]:
    """Return the source line for each instruction that begins one, as remarks in a disassembly."""
    remark_by_offset: dict[int, str] = {}
    if program_map is None:
        return remark_by_offset
    for location in program_map.locations:
        line = program_map.line(location.line)
        shown_text = line.strip()
        if len(shown_text) > MAX_REMARK_CHARACTERS:  # a long line: only its instruction
            end = location.end_column - 1 if location.end_line == location.line else len(line)
            shown_text = line[location.column - 1 : end][:MAX_REMARK_CHARACTERS]
        values = {"line": str(location.line), "shown": printable(shown_text.replace("\t", " "))}
        remark_by_offset[location.offset] = sentence("line", language, values)
    return remark_by_offset


def _compile_for(
    text: str, robot: str | os.PathLike[str] | Robot | None, name: str, language: Language,
    is_strict: bool = True, optimize: bool = True,
) -> tuple[Compilation, Robot]:  # fmt: skip
    """Return the compilation of a text for a robot; None: the named or the default one."""
    data = _encode(text)
    if robot is None:
        profile = robot_of(data, profile_of(robots.DEFAULT, language))
    else:
        profile = robot if isinstance(robot, Robot) else profile_of(robot, language)
    is_chosen = robot is not None
    return compile_source(data, profile, name, is_strict, optimize, is_chosen=is_chosen), profile


def _compile_program(
    text: str, robot: str | os.PathLike[str] | Robot | None, name: str, optimize: bool,
    language: Language,
) -> Program:  # fmt: skip
    compilation, profile = _compile_for(text, robot, name, language, optimize=optimize)
    diagnostics = tuple(diagnostics_of(compilation, language))
    if not compilation.is_right:
        source = compilation.source
        texts = [
            as_text(message(diagnostic, source, language), source, language)
            for diagnostic in compilation.diagnostics
        ]
        error = ProgramError("mistakes", language, sentence_text="\n".join(texts))
        error.diagnostics = diagnostics
        raise error
    program_map = source_map.map_of_compiled(compilation)
    return Program(
        text, compilation.image, image_of(compilation, profile), profile, program_map, diagnostics
    )


def _encode(text: str) -> bytes:
    return text.encode("utf-8", "surrogatepass")  # a lone surrogate becomes a mistake


def _read_image(data: bytes, profile: Robot, language: Language) -> Image:
    """Return an image, verified for this robot. Raises ProgramError."""
    image = _unpack(data, language)
    try:
        verify.check(image, profile.kit)
    except Refused as refusal:
        if refusal.name == "NO_SUCH_DEVICE" and image.devices:  # an image for a larger kit
            raise ProgramError("OTHER_KIT", language, {"robot": profile.name}) from None
        values = {"offset": f"{refusal.offset:04x}", "rule": refusal.name}
        text = sentence("bad_code", language, values)
        raise ProgramError(refusal.name, language, values, text) from None
    except ImageRefused as refusal:
        raise ProgramError(refusal.name, language, {"robot": profile.name}) from None
    return image


def _unpack(data: bytes, language: Language) -> Image:
    try:
        return unpack(data)
    except ImageRefused as error:
        raise ProgramError(error.name, _check_language(language)) from None


def _check_language(language: Language) -> Language:
    if language not in languages():
        values = {
            "found": printable(repr(language), MAX_VALUE_CHARACTERS),
            "known": ", ".join(languages()),
        }
        raise UsageError("bad_language", "en", values)
    return language
