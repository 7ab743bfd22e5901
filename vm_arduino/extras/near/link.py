"""Makes the sketch shorter than compiler and linker do alone: PlatformIO runs this.

The linker puts functions that call each other near to each other: a call over less than 4 KB takes
2 bytes of flash, a longer one 4. `order.txt` has the order; what it does not name comes behind.
`python -m tools.builds.near` finds one. Then the compiler's assembly is made shorter by
`shorter.py`, and linked in place of what was linked before. Where something of that fails, the
sketch is the one before, which does the same.
"""

import shutil
import sys
from pathlib import Path
from subprocess import run

from SCons.Script import DefaultEnvironment

HERE = "    *(.text)\n"  # of the linker's own script: what it names before that comes first

env = DefaultEnvironment()
extras = Path(env.subst("$PROJECT_DIR")) / "extras" / "near"
sys.path.insert(0, str(extras))

sys.dont_write_bytecode = True  # this folder is part of the sketch
import shorter  # noqa: E402  (it lies beside this file, which is no module)

chip = env.BoardConfig().get("build.mcu")
# Who leaves owners out wants the flash; without their checks a LIVE has time left.
OWNERS = "tiniscript_with_owners"


def shorten(target: list, source: list, env: object) -> None:
    """Replace the linked sketch by a shorter one that does the same."""
    elf = Path(str(target[0])).resolve()
    folder = elf.parent / "shorter"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()

    def words(*variables: str) -> list[str]:
        found = [env.subst_list(each, target=target, source=source) for each in variables]
        return [str(each) for each in env.Flatten(found)]

    def done(*command: str) -> str:
        """Return what a command says, or end."""
        ran = run(command, cwd=folder, env=env["ENV"], capture_output=True, text=True, check=False)
        if ran.returncode != 0:
            raise RuntimeError(ran.stderr)
        return ran.stdout

    objects = [str(Path(str(each)).resolve()) for each in source]
    linked = [*words("$LINK", "$LINKFLAGS"), "-g0", "-o"]
    libraries = [_absolute(each) for each in words("$_LIBDIRFLAGS", "$_LIBFLAGS")]
    try:
        done(*linked, "whole.elf", "-save-temps", *objects, *libraries)
        (assembly,) = folder.glob("*.s")
        rows = [row.split() for row in done("avr-nm", "whole.elf").splitlines()]
        addresses = {row[2]: int(row[0], 16) for row in rows if len(row) == 3 and row[1] in "tT"}
        text = assembly.read_text(encoding="utf-8")
        has_owners = OWNERS in env.Flatten(env.get("CPPDEFINES", []))
        short = shorter.shorter(text, addresses, wants_room=not has_owners)
        (folder / "short.s").write_text(short, encoding="utf-8")
        done(*words("$CC"), f"-mmcu={chip}", "-c", "short.s", "-o", "short.o")
        others = [each for each in objects if each.endswith(".S.o")]
        done(*linked, "short.elf", "-fno-lto", "short.o", *others, *libraries)
        shutil.copyfile(folder / "short.elf", elf)
    except (OSError, RuntimeError, ValueError) as why:
        print(f"The sketch takes 1,700 bytes more: {why}")


def _absolute(word: str) -> str:
    """Return an argument of the linker that means the same in another folder."""
    option = "-L" if word.startswith("-L") else ""
    path = Path(word[len(option) :]).resolve()
    return f"{option}{path}" if path.exists() else word


command = ["avr-gcc", f"-mmcu={chip}", "-Wl,--verbose"]
said = run(command, env=env["ENV"], capture_output=True, text=True, check=False).stdout
_, _, rest = said.partition("=" * 50 + "\n")
script, _, _ = rest.partition("=" * 50)
if script.count(HERE) != 1:
    print("The linker has another script than expected: the sketch takes 2,200 bytes more.")
else:
    order = (extras / "order.txt").read_text(encoding="utf-8")
    build = Path(env.subst("$BUILD_DIR"))
    build.mkdir(parents=True, exist_ok=True)
    rows = [f"    {row}\n" for row in order.splitlines() if not row.startswith("#")]
    (build / "near.ld").write_text(script.replace(HERE, "".join(rows) + HERE), encoding="utf-8")
    files = f"-Wl,-T,{build / 'near.ld'},-Map,{build / 'near.map'}"
    # in one part: the assembly is one file
    env.Append(LINKFLAGS=["-ffunction-sections", "-flto-partition=none", files])
    program = "$BUILD_DIR/${PROGNAME}${PROGSUFFIX}"
    env.Depends(program, str(build / "near.ld"))
    env.AddPostAction(program, env.VerboseAction(shorten, "Shortening $TARGET"))
