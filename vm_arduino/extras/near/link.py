"""Lets the linker put functions that call each other near to each other: PlatformIO runs this.

A call over less than 4 KB takes 2 bytes of flash, a longer one 4. `order.txt` has the order; what
it does not name comes behind. `python -m tools.builds.near` finds one.
"""

from pathlib import Path
from subprocess import run

from SCons.Script import DefaultEnvironment

HERE = "    *(.text)\n"  # of the linker's own script: what it names before that comes first

env = DefaultEnvironment()
chip = env.BoardConfig().get("build.mcu")
command = ["avr-gcc", f"-mmcu={chip}", "-Wl,--verbose"]
said = run(command, env=env["ENV"], capture_output=True, text=True, check=False).stdout
_, _, rest = said.partition("=" * 50 + "\n")
script, _, _ = rest.partition("=" * 50)
if script.count(HERE) != 1:
    print("The linker has another script than expected: the sketch takes 500 bytes more.")
else:
    project = Path(env.subst("$PROJECT_DIR"))
    order = (project / "extras" / "near" / "order.txt").read_text(encoding="utf-8")
    build = Path(env.subst("$BUILD_DIR"))
    build.mkdir(parents=True, exist_ok=True)
    rows = [f"    {row}\n" for row in order.splitlines() if not row.startswith("#")]
    (build / "near.ld").write_text(script.replace(HERE, "".join(rows) + HERE), encoding="utf-8")
    files = f"-Wl,-T,{build / 'near.ld'},-Map,{build / 'near.map'}"
    env.Append(LINKFLAGS=["-ffunction-sections", files])
    env.Depends("$BUILD_DIR/${PROGNAME}${PROGSUFFIX}", str(build / "near.ld"))
