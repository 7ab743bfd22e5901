"""The sentences of `tsc conform`, in English and Spanish."""

from __future__ import annotations

# fmt: off
CONFORM_TEXTS: dict[str, tuple[str, str]] = {
    # key: (English, Spanish)
    "conform_which": ("tsc: what should be tested? Name a robot's port with --port, or a machine of your own with --machine 'COMMAND'.",
                      "tsc: ¿qué hay que probar? Indica el puerto de un robot con --port, o una máquina tuya con --machine 'COMANDO'."),
    "conform_both": ("tsc: test one at a time: --port or --machine.",
                     "tsc: prueba uno a la vez: --port o --machine."),
    "conform_no_case": ("tsc: no case has {found} in its name. Leave out --only to run all.",
                        "tsc: ningún caso tiene {found} en su nombre. Sin --only se prueban todos."),
    "conform_no_start": ("tsc: {command} does not start: {why}. Check the command; it is run in this folder, without a shell.",
                         "tsc: {command} no arranca: {why}. Revisa el comando; se ejecuta en esta carpeta, sin intérprete de comandos."),
    "conform_timeout": ("tsc: --timeout goes with --machine.", "tsc: --timeout va con --machine."),
    "conform_owned": ("tsc: this robot has an owner, so it obeys only its owner. Test one without an owner:  tsc disown",
                      "tsc: este robot tiene dueño, así que solo acepta lo que envía su dueño. Prueba uno sin dueño:  tsc disown"),
    "conform_silent": ("tsc: nothing on {port} answers HELLO. Check the port, its speed (--baud) and the power.",
                       "tsc: nada en {port} responde a HELLO. Revisa el puerto, su velocidad (--baud) y la alimentación."),
    "conform_gone": ("tsc: {port} is gone after {n} checks: {why}. Plug it in and begin again.",
                     "tsc: {port} ya no está, después de {n} pruebas: {why}. Conéctalo y empieza otra vez."),
    "conform_silent_check": ("  {detail}: no answer", "  {detail}: sin respuesta"),
    "conform_case": ("{name}", "{name}"),
    "conform_line": ("  line {line}: {got}\n  should be: {want}", "  línea {line}: {got}\n  debería ser: {want}"),
    "conform_nothing": ("(no line)", "(ninguna línea)"),
    "conform_hang": ("  did not end its answer in {seconds} s", "  no terminó su respuesta en {seconds} s"),
    "conform_crash": ("  ended before its answer did; exit code {detail}", "  terminó antes que su respuesta; código de salida {detail}"),
    "conform_flood": ("  wrote far more than the answer needs", "  escribió mucho más de lo que tiene la respuesta"),
    "conform_more": ("  went on writing after the end of its answer: {detail}", "  siguió escribiendo después del final de su respuesta: {detail}"),
    "conform_others": ("... and {n} more; --json lists all of them.", "... y {n} más; --json los lista todos."),
    "conform_given_up": ("The other cases were not tried: too many had no answer.", "Los otros casos no se probaron: demasiados quedaron sin respuesta."),
    "conform_machine_end": ("{good} of {all} cases agree. Kit {version}, bytecode {isa}.",
                            "{good} de {all} casos coinciden. Kit {version}, bytecode {isa}."),
    "conform_port_end": ("{good} of {all} checks agree. Kit {version}, link {link}, bytecode {isa}.",
                         "{good} de {all} pruebas coinciden. Kit {version}, conexión {link}, bytecode {isa}."),
}
# fmt: on
