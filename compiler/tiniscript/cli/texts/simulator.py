"""The sentences of `tsc` about the virtual robot, in English and Spanish."""

from __future__ import annotations

# fmt: off
VIRTUAL_TEXTS: dict[str, tuple[str, str]] = {
    # key: (English, Spanish)
    # options
    "virtual_needs_wasmtime": ("tsc: the virtual robot needs wasmtime, which cannot be used here: {why}.\n"
                               "Install it:  {how}",
                               "tsc: el robot virtual necesita wasmtime, que aquí no se puede usar: {why}.\n"
                               "Instálalo:  {how}"),
    "plot_needs_pillow": ("tsc: --plot needs Pillow, which cannot be used here: {why}.\n"
                          "Install it:  {how}",
                          "tsc: --plot necesita Pillow, que aquí no se puede usar: {why}.\n"
                           "Instálalo:  {how}"),
    "bad_hurry": ("tsc: --hurry takes how many times faster the robot goes, such as 10, or max; not {found}.",
                  "tsc: --hurry acepta cuántas veces más rápido va el robot, como 10, o max; no {found}."),
    "bad_motors": ("tsc: --motors takes two numbers, left and right, such as 100,90; not {found}.",
                   "tsc: --motors acepta dos números, izquierdo y derecho, como 100,90; no {found}."),
    "bad_button": ("tsc: {option} takes seconds, such as 2 or 2,10; not {found}.",
                   "tsc: {option} acepta segundos, como 2 o 2,10; no {found}."),
    "world_refused": ("tsc: the world {file} cannot be used:\n{reasons}",
                      "tsc: el mundo {file} no se puede usar:\n{reasons}"),
    "unwritable_picture": ("tsc: {file} cannot be written: {why}. Choose another place with --plot.",
                           "tsc: no se puede escribir {file}: {why}. Elige otro lugar con --plot."),
    "unwritable_memory": ("tsc: {file} cannot be written: {why}. Choose another place with --memory.",
                          "tsc: no se puede escribir {file}: {why}. Elige otro lugar con --memory."),
    "unreadable_memory": ("tsc: {file} cannot be read: {why}. Choose another file with --memory.",
                          "tsc: no se puede leer {file}: {why}. Elige otro archivo con --memory."),
    "bad_memory": ("tsc: {file} is not the memory of a robot: that has {bytes} bytes. Choose another file with --memory.",
                   "tsc: {file} no es la memoria de un robot, que tiene {bytes} bytes. Elige otro archivo con --memory."),
    "listen_taken": ("tsc: the port {port} cannot be used: {why}. Choose another with --listen, or leave it out.",
                     "tsc: no se puede usar el puerto {port}: {why}. Elige otro con --listen, o quita esa opción."),
    "no_pty": ("tsc: this system has no pseudo-terminals. Leave --pty out and use the address of the robot.",
               "tsc: este sistema no tiene pseudoterminales. Quita --pty y usa la dirección del robot."),
    "announce_needs": ("tsc: --announce needs a package that is not installed here ({why}). Install it and try again:  {how}",
                       "tsc: --announce necesita un paquete que aquí no está instalado ({why}). Instálalo y prueba otra vez:  {how}"),
    "name_taken": ("tsc: the name {name} cannot be announced: another robot of this computer has it, or it is too long. Choose another with --name.",
                   "tsc: no se puede anunciar el nombre {name}: lo tiene otro robot de esta computadora, o es demasiado largo. Elige otro con --name."),
    "no_announcement": ("tsc: the robot cannot be announced: {why}. Leave --announce out, and use its address.",
                        "tsc: no se puede anunciar el robot: {why}. Quita --announce y usa su dirección."),
    # what it says
    "robot_here": ("{robot} in the world \"{world}\". In another terminal:  tsc upload prog.ts --virtual   Ctrl-C ends.",
                   "{robot} en el mundo \"{world}\". En otra terminal:  tsc upload prog.ts --virtual   Ctrl-C termina."),
    "robot_keys": ("q: end   b: start button   h: hold it 2 s   r: reset   p: off and on",
                   "q: terminar   b: botón   h: botón 2 s   r: reinicio   p: apagar y encender"),
    "button_keys": ("b: start button   q: end   Ctrl-C: stop", "b: botón de inicio   q: terminar   Ctrl-C: detener"),
    "how_key": ("{start}: waits for its button, the key b", "{start}: espera su botón, la tecla b"),
    "how_pushed": ("{start}: its button is pushed right away, since there are no keys here",
                   "{start}: su botón se pulsa de inmediato, porque aquí no hay teclas"),
    "drove": ("The virtual robot drove {cm} cm in {seconds} s and touched nothing.",
              "El robot virtual recorrió {cm} cm en {seconds} s y no tocó nada."),
    "drove_touching_once": ("The virtual robot drove {cm} cm in {seconds} s and ran into something once.",
                            "El robot virtual recorrió {cm} cm en {seconds} s y chocó 1 vez."),
    "drove_touching": ("The virtual robot drove {cm} cm in {seconds} s and ran into something {n} times.",
                       "El robot virtual recorrió {cm} cm en {seconds} s y chocó {n} veces."),
    "drove_picture": ("Picture: {file}", "Imagen: {file}"),
    "time_over": ("The time of --for is over.", "Se acabó el tiempo de --for."),
    "robot_empty": ("no program yet", "todavía sin programa"),
    "robot_waits": ("its button starts it", "su botón lo inicia"),
    "ended_STOP": ("stopped", "detenido"),
    "ended_OFF": ("switched off", "apagado"),
    "virtual_port": ("virtual robot {robot}, world \"{world}\"", "robot virtual {robot}, mundo \"{world}\""),
    # with other verbs
    "offer_virtual": ("There is no robot here. Try the virtual one? [Y/n] ",
                      "Aquí no hay ningún robot. ¿Probar el virtual? [S/n] "),
    "choice_virtual": ("the virtual robot", "el robot virtual"),
    "which_port_or_virtual": ("tsc: which port? Name it once with --port; then it is remembered. The ports here:  tsc ports   Without a robot:  --virtual",
                              "tsc: ¿qué puerto? Indícalo una vez con --port; después se recuerda. Los puertos de aquí:  tsc ports   Sin robot:  --virtual"),
    "no_virtual": ("tsc: no virtual robot is running. Start one in another terminal:  tsc robot",
                   "tsc: no hay ningún robot virtual en marcha. Inicia uno en otra terminal:  tsc robot"),
    "which_virtual": ("tsc: several virtual robots are running. Name one with --port: {known}",
                      "tsc: hay varios robots virtuales en marcha. Indica uno con --port: {known}"),
    "virtual_and_port": ("tsc: --virtual does not go together with --port or --all. Leave one of them out.",
                         "tsc: --virtual no va junto con --port ni con --all. Quita uno de los dos."),
    "virtual_and_detach": ("tsc: the virtual robot of this command ends with it. Leave --detach out, or start one in another terminal:  tsc robot",
                           "tsc: el robot virtual de este comando termina con él. Quita --detach, o inicia uno en otra terminal:  tsc robot"),
    "only_virtual": ("tsc: {option} is for the virtual robot alone. Add --virtual, or leave {option} out.",
                     "tsc: {option} es solo para el robot virtual. Agrega --virtual, o quita {option}."),
}
# fmt: on
