"""The guarantees, how each is tested, and how many times that is to have been done.

The one table of the campaign: `docs/en/guarantees.md` and `python -m tools.campaign` are made from it.
Knows commands, and no results.
"""

from __future__ import annotations

from typing import NamedTuple


class Goal(NamedTuple):
    """`target` of `unit` are to be done, `piece_size` of them at a time, by `command`.

    In the command `{count}` and `{seed}` are those of a piece. A command that fails has found
    something. Seeds of pieces are `stride` apart. `paths` hold the code that it tries.
    """

    name: str
    guarantee: str
    unit: str
    target: int
    piece_size: int
    command: str
    paths: tuple[str, ...]
    stride: int = 1

    @property
    def code(self) -> tuple[str, ...]:
        """The code that a figure is about: the tested code, and the campaign itself."""
        return (*self.paths, self.command.split()[0].replace(".", "/") + "*")


def _code(*names: str) -> tuple[str, ...]:
    """Return the folders of the robot, and those of the package, by their names."""
    folders = (
        f"vm_arduino/src/{name[1:]}" if name[0] == "@" else f"compiler/tiniscript/{name}"
        for name in names
    )
    return tuple(folders)


FUZZ_TOOLS = "libFuzzer, ASan and UBSan"
_CHANNEL = "tests.link.test_link_channel"
_ROBOT = _code("@vm", "@store", "@link", "@text", "@firmware")
_UPLOADS = (*_code("link", "@store", "@link", "@firmware"), "tests/link")
_FRAMES = (*_code("link", "@link"), "tests/link")
_MACHINE = _code("bytecode", "vm", "@vm")
_COMPILER = _code("syntax", "semantics", "codegen")

# fmt: off
GOALS: tuple[Goal, ...] = (
    Goal("store", "If the plug is pulled during any write, the robot has the old program or the new one, and the same one at every later start.",
         "power cuts", 10_000_000, 2_000_000, "tests.firmware.test_store {count} --seed {seed}", _code("@store"), 20),
    Goal("uploads", "An upload over a bad radio reports success only if the robot has the program; nothing is done twice; after a stop nothing starts.",
         "uploads", 10_000, 500, f"{_CHANNEL} {{count}} --seed {{seed}}", _UPLOADS, 1000),
    Goal("uploads-large", "The same holds for a robot with large frames, with several of them under way, some of which arrive twice or in another order.",
         "uploads", 10_000, 500, f"{_CHANNEL} {{count}} --large --seed {{seed}}", _UPLOADS, 1000),
    Goal("broken-off", "If the largest upload is cut off, or the robot is stopped once or twice, at any byte, the robot holds the old program or the new one, and the next upload is complete.",
         "run over all bytes", 1, 1, "tests.firmware.test_cut_uploads", _UPLOADS),
    Goal("undos", "An undo whose answer is lost is not done twice.",
         "robots, four undos each", 10_000, 500, f"{_CHANNEL} {{count}} --undos --seed {{seed}}", _UPLOADS, 1000),
    Goal("lives", "A live line whose answer is lost is not run twice.",
         "live lines", 1_000_000, 20_000, "tests.link.test_live_lines {count} --seed {seed}", _UPLOADS),
    Goal("sealed", "A stranger on the line of a robot that seals cannot make it carry out or repeat anything, nor make the computer believe anything; everything that the computer reports as done has been done.",
         "uploads beside a stranger", 10_000, 500, "tests.link.test_sealed_channel {count} --seed {seed}", _UPLOADS, 1000),
    Goal("sealed-large", "The same holds for a robot with large frames.",
         "uploads beside a stranger", 10_000, 500, "tests.link.test_sealed_channel {count} --large --seed {seed}", _UPLOADS, 1000),
    Goal("downgrade", "If somebody in between removes the seals from HELLO, changes its id, refuses keys, answers for the robot or redirects the computer to another one, the computer reports it; nothing counts as done, and no stop as confirmed.",
         "requests and stops", 10_000, 2_000, "tests.firmware.test_downgrade {count} --seed {seed}", _UPLOADS, 2000),
    Goal("thieves", "Replayed, forged, reflected or cut frames on an owner's line, and frames of another session, do nothing; a stop works.",
         "frames", 100_000, 20_000, "tests.firmware.test_sealed_robot {count} --seed {seed}", _ROBOT),
    Goal("strangers", "A robot that has an owner but does not seal ignores replayed, forged and reordered frames from anyone without the key; a stop works.",
         "frames", 100_000, 20_000, "tests.firmware.test_authority {count} --seed {seed}", _ROBOT),
    Goal("between", "Whatever is lost, late, held back, cut or suspended between a command and its robot, each command ends, is silent for at most 3 s, prints each message only once, and prints nothing untrue; the next command works.",
         "commands", 1_000, 50, "tests.between.test_commands {count} --seed {seed}", (*_ROBOT, *_code("cli", "library", "link"), "tests/between"), 50),
    Goal("between-page", "The same holds for buttons pressed on the page, whatever happens between the page, tsc studio and the robot.",
         "runs of all actions and faults", 10, 1, "tests.studio.test_page_between {count} --seed {seed}", (*_ROBOT, *_code("studio", "link"), "tools/studio", "tests/between")),
    Goal("frames", "No damaged frame passes for an intact one, and damage costs at most one more frame.",
         "damaged frames", 100_000_000, 5_000_000, "tests.link.test_damaged_frames {count} --seed {seed}", _FRAMES),
    Goal("frames-large", "The same holds for large frames.",
         "damaged frames", 10_000_000, 2_000_000, "tests.link.test_damaged_frames {count} --large --seed {seed}", _FRAMES),
    Goal("field", "Whatever people, apps and radio modules have sent, a correct line runs or an answer says why not; a glitch never starts another program; a person and a computer on one port both get answers.",
         "robots of each kind", 100_000, 3_000, "tests.link.test_field {count} --seed {seed}", (*_ROBOT, *_FRAMES), 1000),
    Goal("pieces", "The guarantee for uploads also holds over radios that send 20-byte pieces, with pauses of up to 1.5 s between them.",
         "uploads", 10_000, 300, f"{_CHANNEL} {{count}} --pieces --seed {{seed}}", _UPLOADS, 1000),
    Goal("typed-stops", "The receiver recognizes a typed stop after any bytes, and never sees one in a frame that arrives intact.",
         "prefixes, and a hundred frames of each", 1_000_000, 100_000, "tests.link.test_typed_stops {count} --seed {seed}", _FRAMES),
    Goal("typed-stops-chip", "On a simulated Uno, at both rates, a typed stop after random bytes reaches the pins within a millisecond, or within 105 ms of the last byte if its packet began as a frame; the bytes before it start nothing.",
         "stops", 10_000, 500, "tests.firmware.test_typed_stops {count} --seed {seed}", _code("@"), 1000),
    Goal("rows", "Tests that run on only a sample of rows for each commit also pass with every row: chips, random programs and codes.",
         "run of all rows", 1, 1, "pytest tests -m sampled --whole -n 2 --dist worksteal", ("compiler", "vm_arduino", "tests")),
    Goal("pupils", "The messages about programs with mistakes, as pupils write them, have not changed; each repair helps and keeps the numbers; every program that is offered compiles.",
         "run of all programs", 1, 1, "pytest tests/pupils tests/semantics/test_offered.py --whole -n 2 --dist worksteal", (*_COMPILER, *_code("recovery", "diagnostics", "languages"), "tests/pupils")),
    Goal("fuzz-machine", f"No image harms the machine: all code that the verifier accepts runs without BAD_CODE ({FUZZ_TOOLS}).",
         "inputs", 100_000_000, 5_000_000, "tests.fuzz.harnesses machine {count} --seed {seed}", (*_code("@vm"), "tests/fuzz")),
    Goal("fuzz-link", f"No bytes harm the receiver, the link or the reader of text ({FUZZ_TOOLS}).",
         "inputs", 100_000_000, 1_000_000, "tests.fuzz.harnesses link {count} --seed {seed}", (*_code("@link", "@text"), "tests/fuzz")),
    Goal("fuzz-store", f"No contents of the EEPROM harm the store, at start or during saves ({FUZZ_TOOLS}).",
         "inputs", 10_000_000, 100_000, "tests.fuzz.harnesses store {count} --seed {seed}", (*_code("@store"), "tests/fuzz")),
    Goal("agreement", "The machines and verifiers in C++ and in Python give the same answers and behave the same.",
         "random and mutated codes", 10_000_000, 200_000, "tests.vm.test_cpp_agreement {count} --seed {seed}", (*_MACHINE, "tests/vm"), 1000),
    Goal("verifier", "Both verifiers and the one in the specification give the same verdict at the same offset.",
         "random and damaged codes", 10_000_000, 100_000, "tests.oracle.test_verifier {count} --seed {seed}", (*_MACHINE, "bytecode_spec.md", "tests/oracle"), 1000),
    Goal("machine", "For programs without tasks, the machine does the same as the one written from the specification.",
         "runs", 100_000, 5_000, "tests.oracle.test_machine {count} --seed {seed}", (*_MACHINE, "bytecode_spec.md", "tests/oracle")),
    Goal("compiler", "Programs do the same on the machines as in the interpreter written from the language reference.",
         "programs, right and broken", 100_000, 5_000, "tests.vm.test_agreement {count} --seed {seed}", (*_COMPILER, *_MACHINE, "tests/oracle"), 10_000),
    Goal("tasks", "Programs with TASK and WHEN do the same on the machines in Python and in C++ and in the interpreter written from the language reference.",
         "programs", 100_000, 5_000, "tests.oracle.test_tasks {count} --seed {seed}", (*_COMPILER, *_MACHINE, "tests/oracle"), 10_000),
    Goal("values", "Programs whose DEFs take values, with several tasks that reach the same DEF and DEFs that call each other, do the same on the machines in Python and in C++ and in the interpreter written from the language reference.",
         "programs", 100_000, 10_000, "tests.oracle.test_values {count} --seed {seed}", (*_COMPILER, *_MACHINE, "tests/oracle"), 10_000),
    Goal("ways", "Programs that move the robot by centimetres and degrees, half of them with tasks, do the same on the machines in Python and in C++ and in the interpreter written from the language reference.",
         "programs", 100_000, 5_000, "tests.oracle.test_ways {count} --seed {seed}", (*_COMPILER, *_MACHINE, "tests/oracle"), 10_000),
    Goal("page", "From a program's text, and from its blocks, the studio's page makes the same bytecode as tsc compile.",
         "programs", 1_000, 100, "tests.studio.random_in_page {count} --seed {seed}", (*_COMPILER, "tools/studio"), 100),
    Goal("reader", "The robot's reader gives the same result for a text as the compiler.",
         "programs, and twenty changed texts of each", 100_000, 1_000, "tests.text.test_reader_agreement {count} --seed {seed}", (*_COMPILER, *_code("@text"), "tests/text"), 10_000),
    Goal("text", "A robot obeys a line of text, whatever it has received before.",
         "robots", 10_000, 100, "tests.firmware.test_text {count} --seed {seed}", _ROBOT, 1000),
    Goal("waiting", "A robot runs exactly the code of a frame that it verified, whatever text waits before and after.",
         "programs", 100_000, 10_000, "tests.firmware.test_waiting_text {count} --seed {seed}", _ROBOT),
    Goal("clients", "After any frames a robot answers each intact frame, acts on nothing stale, and can be stopped.",
         "clients", 10_000, 100, "tests.firmware.test_hostile_client {count} --seed {seed}", _ROBOT, 1000),
    Goal("fuzz-mqtt", f"Whatever a broker says, an ESP32's MQTT reader finds the same as a second reader, within its memory ({FUZZ_TOOLS}).",
         "inputs", 10_000_000, 200_000, "tests.fuzz.harnesses mqtt {count} --seed {seed}", (*_code("@boards/esp32"), "tests/fuzz")),
    Goal("fuzz-compiler", "The compiler compiles any text, or refuses it with mistakes that it can name in every language.",
         "texts", 1_000_000, 5_000, "tests.fuzz.test_python compiler {count} --seed {seed}", (*_COMPILER, *_code("recovery", "diagnostics"), "tests/fuzz")),
    Goal("fuzz-profiles", "Any robot profile is read or refused.",
         "texts", 1_000_000, 5_000, "tests.fuzz.test_python profiles {count} --seed {seed}", (*_code("robots"), "tests/fuzz")),
    Goal("fuzz-worlds", "Any world is read or refused.",
         "texts", 1_000_000, 5_000, "tests.fuzz.test_python worlds {count} --seed {seed}", (*_code("virtual"), "tests/fuzz")),
    Goal("fuzz-answers", "Whatever a robot answers, every request of the computer ends.",
         "sequences of answers", 1_000_000, 5_000, "tests.fuzz.test_python answers {count} --seed {seed}", (*_code("link", "library"), "tests/fuzz")),
    Goal("fuzz-messages", "Any message from another command on a shared port counts as a request, or is refused.",
         "messages", 1_000_000, 5_000, "tests.fuzz.test_python messages {count} --seed {seed}", (*_code("link"), "tests/fuzz")),
    Goal("fuzz-greetings", "Any bytes from a stranger on a shared port count as a greeting, or are refused.",
         "sequences of bytes", 1_000_000, 5_000, "tests.fuzz.test_python greetings {count} --seed {seed}", (*_code("link"), "tests/fuzz")),
    Goal("mutation", "The tests of a module notice any small mistake in its code.",
         "mutants", 1_500, 150, "tools.mutation {count} --seed {seed}", ("compiler", "vm_arduino", "tests")),
)
# fmt: on

BY_NAME = {goal.name: goal for goal in GOALS}
