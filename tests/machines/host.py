"""The machine in C++ on this computer, with the sanitizers of the compiler.

Builds `vm_arduino/extras/host` with g++ and talks to one process of it: many requests, each a
length and bytes. Errors in C++ (an access outside its memory, undefined arithmetic) end the
process; look at the request that was answered last.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import tempfile
import weakref
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from struct import Struct, pack
from threading import get_ident
from typing import IO, TYPE_CHECKING, NamedTuple

from tests.support.needs import need
from tiniscript.base.kit import Device, Kit
from tiniscript.bytecode.image import REFUSALS, ImageRefused
from tiniscript.bytecode.verify import RULES, Refused

if TYPE_CHECKING:
    from tests.machines import Senses
    from tests.machines.pace import Pace

ROOT = Path(__file__).resolve().parent.parent.parent
SOURCES = ROOT / "vm_arduino"
WARNINGS = ("-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror")
FLAGS = ("-std=c++11", "-O1", "-g1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
# Like Python's machine; a chip counts backward jumps and calls.
COUNTS_INSTRUCTIONS = "-Dtiniscript_counts_instructions"

LINE_MARKER_FOLDER = re.compile(
    rb'^(# \d+ ")[^"\n]*/', re.M
)  # line that names the source of the next lines
# Whose builds are used: root's tests in CI do not compile again what the user's tests have
# compiled.
USER = os.getuid() if hasattr(os, "getuid") else None
if USER == 0:
    USER = int(os.environ.get("TINISCRIPT_BUILDS_OF", 0))


def make_private_folder(folder: Path) -> Path:
    """Return a folder, which is made. It raises PermissionError if another user can write to it."""
    folder.mkdir(mode=0o700, exist_ok=True)
    stat_result = folder.lstat()
    if USER is not None and (
        stat_result.st_uid not in (USER, os.getuid()) or stat_result.st_mode & 0o022
    ):
        raise PermissionError(f"{folder}: somebody else may have put programs into it")
    return folder


BUILD_CACHE = make_private_folder(Path(tempfile.gettempdir()) / f"tiniscript-host-{USER}")

RULE_NAMES = {number: name for name, (number, _) in RULES.items()}
REFUSAL_NAMES = {number: name for name, (number, _) in REFUSALS.items()}


def missing() -> str:
    """Return the reason why there is no host machine, or ""."""
    return "" if shutil.which("g++") else "no g++ on this computer: the C++ machine is not built"


class Ran(NamedTuple):
    """A run: where the code was at its end, instructions that ran, and the trace."""

    offset: int
    steps: int
    trace: str


class Process:
    """A process that answers requests; its errors name it as `who`.

    It ends with its object: an unclosed one would live until the end of the tests, and a process
    has room for about a thousand pipes.
    """

    def __init__(self, command: Sequence[str | Path], name: str) -> None:
        self._who = name
        self._stderr_file = tempfile.TemporaryFile()  # noqa: SIM115
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._stderr_file
        )
        self._closed = weakref.finalize(self, _close, self._process, self._stderr_file)

    def end(self) -> None:
        self._process.kill()

    def close(self) -> None:
        self._closed()

    def has_ended(self) -> bool:
        return self._process.poll() is not None

    @property
    def pipes(self) -> tuple[IO[bytes], IO[bytes]]:
        """Return its input and its output."""
        assert self._process.stdin and self._process.stdout
        return self._process.stdin, self._process.stdout

    def report(self) -> str:
        """Return the last words of a process that has ended: the sanitizers' report."""
        status = self._process.wait()
        self._stderr_file.seek(0)
        report = self._stderr_file.read().decode(errors="replace")
        return f"{self._who} ended with status {status}:\n{report[:4000]}"

    def run(self, image: bytes, kit: Kit, senses: Senses) -> Ran:
        """Run an image, or raise its refusal."""
        raise NotImplementedError

    def agrees(self, run: Ran, expected: Ran, max_ms: int) -> bool:
        """Return whether it has done the same as the machine in Python."""
        return run == expected

    def run_at(self, pace: Pace, image: bytes, kit: Kit, senses: Senses) -> Ran:
        """Run an image on a robot that is called at a pace, and that some readings keep waiting."""
        return parse_run(self.ask(b"P", pace.pack(kit) + run_request(image, kit, senses)).decode())

    def verdicts(
        self, codes: Sequence[bytes], sensors: int, actuators: int, needs: int = 0
    ) -> list[tuple[int, int]]:
        """Return the number of the rule that each code breaks, or 0, and the offset."""
        answer = self.ask(b"V", bytes((sensors, actuators, needs)) + texts(*codes))
        return [(rule, offset) for rule, offset in Struct("<BH").iter_unpack(answer)]

    def refusals(self, images: Sequence[bytes]) -> list[int]:
        """Return the number of the reason for which each image's header is refused, or 0."""
        return list(self.ask(b"I", texts(*images)))

    def results(self, operations: Iterable[tuple[int, int, int]]) -> list[tuple[int, int]]:
        """Return the fault, or 0, and the result of each opcode with its two values."""
        form = Struct("<Bii")
        answer = self.ask(b"A", b"".join(form.pack(*operation) for operation in operations))
        return [(fault, result) for fault, result in Struct("<Bi").iter_unpack(answer)]

    def ask(self, letter: bytes, request: bytes) -> bytes:
        pipe_in, pipe_out = self.pipes
        try:
            pipe_in.write(pack("<I", len(request) + 1) + letter + request)
            pipe_in.flush()
        except BrokenPipeError:
            raise AssertionError(self.report()) from None
        head = pipe_out.read(4)
        answer = pipe_out.read(int.from_bytes(head, "little"))
        if len(head) < 4:
            raise AssertionError(self.report())
        return answer


def _close(process: subprocess.Popen[bytes], errors: IO[bytes]) -> None:
    process.kill()
    process.communicate()
    errors.close()


class Host(Process):
    """The process on this computer.

    `sources` is a folder like `vm_arduino`; the results are in `builds`.
    """

    def __init__(self, sources: Path = SOURCES, builds: Path = BUILD_CACHE) -> None:
        super().__init__([build_machine(sources, builds)], "the C++ machine")

    def run(
        self, image: bytes, kit: Kit, senses: Senses, not_ready: int = 0, begin_ms: int = 0
    ) -> Ran:
        """Run an image, or raise its refusal.

        At each `not_ready`th query, the robot is not ready; `begin_ms` is the initial time of the
        machine's clock.
        """
        request = run_request(image, kit, senses, not_ready, begin_ms)
        return parse_run(self.ask(b"R", request).decode())

    def run_unverified(self, code: bytes, kit: Kit, senses: Senses) -> Ran:
        """Run arbitrary code: it must end in a fault or continue, and never leave its memory."""
        return parse_run(self.ask(b"U", run_request(code, kit, senses)).decode())

    def run_late(self, image: bytes, kit: Kit, senses: Senses, late_ms: Sequence[int]) -> str:
        """Return the trace where the tick after each wait comes so late; after the last it ends."""
        count = len(late_ms)
        request = pack(f"<I{count}I", count, *late_ms) + run_request(image, kit, senses)
        return self.ask(b"L", request).decode()

    def all_of_three(self, first: int, sensors: int, actuators: int) -> tuple[int, int, int]:
        """Verify all codes of three bytes that begin with `first`, and run the accepted ones.

        Return how many are accepted, how many of these fail a run-time check, and the CRC-32 of all
        verdicts: number of the rule and offset, 0 and 0 for accepted code.
        """
        answer = self.ask(b"X", bytes((sensors, actuators, first)))
        accepted, wrong_count, checksum = Struct("<III").unpack(answer)
        return accepted, wrong_count, checksum


def run_request(
    data: bytes, kit: Kit, senses: Senses, not_ready: int = 0, begin_ms: int = 0
) -> bytes:
    """Return the request to run an image or code with this kit, these senses and limits."""
    limits = (senses.max_ms, senses.max_steps, senses.seed, begin_ms)
    hashes = iter(kit.hashes)
    parts = [pack("<IIII", *limits), bytes((len(kit.readings),))]
    for sensor in kit.readings:
        values = senses.readings.get(sensor.name, ())
        parts += [_pack_name(sensor, next(hashes)), pack(f"<H{len(values)}i", len(values), *values)]
    parts.append(bytes((len(kit.actuators),)))
    for actuator in kit.actuators:
        parts += [_pack_name(actuator, next(hashes)), pack("<ii", actuator.low, actuator.high)]
    parts.append(pack("<III", kit.speed, kit.turn, not_ready))
    return b"".join(parts) + texts(data)


def _pack_name(device: Device, hashed: int) -> bytes:
    return texts(device.name.encode()) + pack("<BH", device.is_yes_no, hashed)


def texts(*parts: bytes) -> bytes:
    """Return parts of a request, each after its length."""
    return b"".join(pack("<I", len(part)) + part for part in parts)


def first_number(answer: bytes) -> tuple[int, bytes]:
    """Return the number of four bytes at the beginning of an answer, and the rest."""
    return int.from_bytes(answer[:4], "little"), answer[4:]


def first_text(answer: bytes) -> tuple[bytes, bytes]:
    """Return the length-prefixed text at the start of an answer, and the rest."""
    length, rest = first_number(answer)
    return rest[:length], rest[length:]


def parse_run(answer: str) -> Ran:
    """Return the run that an answer tells of, or raise the refusal of the image."""
    trace, _, last_line = answer.removesuffix("\n").rpartition("\n")
    words = last_line.split()
    assert len(words) == 3, f"the machine ends with {answer[-2000:]!r}"
    first, second = int(words[1]), int(words[2])
    if words[0] == "REFUSED":
        raise ImageRefused(REFUSAL_NAMES[first])
    if words[0] == "BREAKS":
        raise Refused(RULE_NAMES[first], second)
    assert words[0] == "RAN", last_line
    return Ran(first, second, trace + "\n")


def build_machine(sources: Path, builds: Path = BUILD_CACHE) -> Path:
    """Return the program made from `sources`, a folder like `vm_arduino`."""
    inputs = files_in(sources, "src", "src/vm", "extras/chip", "extras/host")
    return compile_program(inputs, (*FLAGS, COUNTS_INSTRUCTIONS), builds)


def files_in(sources: Path, *folders: str) -> list[Path]:
    """Return the sources and headers in folders of `sources`, a folder like `vm_arduino`."""
    paths = (path for folder in folders for path in (sources / folder).glob("*"))
    return sorted(path for path in paths if path.suffix in (".h", ".cpp"))


def compile_program(
    inputs: Sequence[Path], flags: Sequence[str], builds: Path = BUILD_CACHE
) -> Path:
    """Return the program made from sources and headers; unchanged parts are reused.

    Workers may build at the same time: each object that two build at once is built twice, and the
    last one stays.
    """
    return build_with("g++", inputs, (*flags, *WARNINGS), builds)


def build_with(
    compiler: str, inputs: Sequence[Path], flags: Sequence[str], builds: Path = BUILD_CACHE
) -> Path:
    """Build with any compiler, and with all of its flags."""
    texts = {path: path.name.encode() + path.read_bytes() for path in inputs}
    objects = objects_of(compiler, builds, texts, lambda _: flags)
    return compile_once(compiler, builds, "", flags, [name.encode() for name in objects], objects)


def objects_of(
    compiler: str, builds: Path, texts: Mapping[Path, bytes],
    flags_of: Callable[[Path], Sequence[str]],
) -> list[str]:  # fmt: skip
    """Return the objects of all sources among `texts`, which has their headers, too.

    Two workers that need the same ones begin at different ends, and meet.
    """
    headers = [text for path, text in texts.items() if path.suffix == ".h"]
    sources = [path for path in texts if path.suffix == ".cpp"]
    is_other_end = os.environ.get("PYTEST_XDIST_WORKER", "gw0")[-1] in "13579"
    objects = {
        path: compile_once(
            compiler, builds, ".o", flags_of(path), [*headers, texts[path]], ["-c", str(path)]
        )
        for path in (reversed(sources) if is_other_end else sources)
    }
    return [str(objects[path]) for path in sources]


def compile_once(
    compiler: str, builds: Path, suffix: str, flags: Sequence[str], made_from: Iterable[bytes],
    words: list[str],
) -> Path:  # fmt: skip
    """Return the compiler's output for `words`, named after all its inputs."""
    path = builds / (_key(compiler, flags, made_from) + suffix)
    if not path.exists():
        preprocessed = _preprocess(compiler, builds, flags, words) if suffix == ".o" else path
        make_once(
            preprocessed,
            lambda temporary_path: _run_compiler(
                compiler, [*flags, *words, "-o", str(temporary_path)]
            ),
        )
        if preprocessed != path:
            temporary_path = path.with_suffix(f".{os.getpid()}-{get_ident()}")
            temporary_path.hardlink_to(preprocessed)
            temporary_path.replace(path)
            temporary_path.unlink(missing_ok=True)  # a hard link to the same file remains
    return path


def make_once(path: Path, make: Callable[[Path], object]) -> Path:
    """Return the file that `make` writes, which appears as a whole or not at all.

    If several workers need it, one makes it, and the others wait.
    """
    if not path.exists():
        import fcntl

        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with path.with_name(f"{path.name}.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not path.exists():
                temporary_path = path.with_name(f"{path.name}.{os.getpid()}")
                make(temporary_path)
                temporary_path.replace(path)
    return path


def build_cached(
    compiler: str, flags: Sequence[str], made_from: Iterable[bytes], make: Callable[[Path], object]
) -> Path:
    """Return a program that is made `once` from the same by the same compiler, in any run."""
    return make_once(BUILD_CACHE / f"{_key(compiler, flags, made_from)}.elf", make)


def contents(*folders: Path) -> list[bytes]:
    """Return the contents of the sources and headers in folders, each after its path."""
    paths = (path for folder in folders for path in folder.rglob("*.[chS]*"))
    return [part for path in sorted(paths) for part in (bytes(path), path.read_bytes())]


def _key(compiler: str, flags: Sequence[str], made_from: Iterable[bytes]) -> str:
    key = hashlib.sha256(repr((_version(compiler), tuple(flags))).encode())
    for part in made_from:
        key.update(part)
    return key.hexdigest()[:16]


@lru_cache
def _version(compiler: str) -> bytes:
    """Return the version of a compiler: another one makes other objects."""
    need("" if shutil.which(compiler) else f"no {compiler} on this computer")
    return _run_compiler(compiler, ["--version"])


def _preprocess(compiler: str, builds: Path, flags: Sequence[str], words: list[str]) -> Path:
    """Return the path of an object, named after its preprocessed source.

    Most files of a robot are the same for all chips, headers and sizes that macros choose.
    """
    text = _run_compiler(compiler, [*flags, *(word for word in words if word != "-c"), "-E"])
    kept_flags = [flag for flag in flags if not flag.startswith(("-D", "-isystem"))]
    key = hashlib.sha256(repr((_version(compiler), kept_flags)).encode())
    key.update(LINE_MARKER_FOLDER.sub(rb"\1", text))  # a copy of the sources is the same elsewhere
    return builds / f"same-{key.hexdigest()[:16]}.o"


def _run_compiler(compiler: str, words: Sequence[str]) -> bytes:
    completed = subprocess.run([compiler, *words], capture_output=True)
    errors = completed.stderr.decode(errors="replace")[:4000]
    assert completed.returncode == 0, f"{compiler} refuses the C++ sources:\n{errors}"
    return completed.stdout


@lru_cache(maxsize=1)
def host() -> Host:
    """Return the process that all tests of a worker share."""
    return Host()


def run_host(image: bytes, kit: Kit, senses: Senses) -> str:
    """Return the trace of an image, which is read and verified by the C++ machine."""
    return host().run(image, kit, senses).trace
