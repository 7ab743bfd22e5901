"""The sentences of `tsc firmware`, in English and Spanish."""

from __future__ import annotations

# fmt: off
FLASH_TEXTS: dict[str, tuple[str, str]] = {
    # key: (English, Spanish)
    "flash_waits": ("Waiting for the board on {port} …", "Esperando a la placa en {port} …"),
    "flash_writing": ("writing", "escribiendo"),
    "flash_reading": ("reading back", "comprobando"),
    "flash_older": ("Nothing answers yet; trying an older Nano.", "Todavía nadie responde; ahora como un Nano más antiguo."),
    "flash_done": ("{robot} on the {board}: {bytes} bytes written, read back and compared.",
                   "{robot} en el {board}: {bytes} bytes escritos y comprobados."),
    "flash_built": ("{robot} on {board}: its firmware builds. To write it:  tsc firmware --robot {robot} --port P",
                    "{robot} en la placa {board}: su firmware se compila. Para escribirlo:  tsc firmware --robot {robot} --port P"),
    "flash_written": ("{robot} on the {board}: written, and checked by the chip.",
                      "{robot} en la placa {board}: escrito, y comprobado por el chip."),
    "flash_not_written": ("tsc: the firmware of {robot} is built, but could not be written to the {board} on {port} ({why}). Is this the port of its USB cable (tsc ports)? Hold the board's BOOT button down while the writing begins, and run the command again. PlatformIO's output:  {log}",
                          "tsc: el firmware de {robot} está compilado, y no se pudo escribir en la placa {board} en {port} ({why}). ¿Es el puerto de su cable USB (tsc ports)? Repite el comando, y mantén pulsado el botón BOOT de la placa cuando empiece la escritura. Lo que dijo PlatformIO:  {log}"),
    "flash_row": ("{robot} on {board}: ready, {bytes} bytes", "{robot} en la placa {board}: listo, {bytes} bytes"),
    "flash_row_none": ("{robot} on {board}: is built when it is first written", "{robot} en la placa {board}: se compila la primera vez que se escribe"),
    "flash_missing": ("The firmware of {robot} for the {board} has to be built first, with PlatformIO.",
                      "Primero hay que compilar el firmware de {robot} para el {board}, con PlatformIO."),
    "flash_builds": ("PlatformIO builds the firmware of {robot} for the {board}; this happens once.",
                     "PlatformIO compila el firmware de {robot} para el {board}; eso se hace una sola vez."),
    "flash_fetches": ("PlatformIO fetches {what}, which takes some minutes the first time.",
                      "PlatformIO descarga {what}; la primera vez tarda unos minutos."),
    "flash_fetching": ("fetching", "descargando"),
    "flash_compiling": ("building", "compilando"),
    # wrong use
    "flash_no_port": ("tsc: on which port is the board? Name it with --port. The ports here:  tsc ports",
                      "tsc: ¿en qué puerto está la placa? Indícalo con --port. Los puertos de aquí:  tsc ports"),
    "flash_address": ("tsc: a firmware goes over the board's USB cable, and {port} is on a network or a radio. Plug the board into this computer; the ports here:  tsc ports",
                      "tsc: el firmware se escribe por el cable USB de la placa, y {port} está en una red o una radio. Conecta la placa a esta computadora; los puertos de aquí:  tsc ports"),
    "flash_no_fit": ("tsc: the robot {robot} does not fit the board {board}. It fits: {known}.",
                     "tsc: el robot {robot} no va con la placa {board}. Va con: {known}."),
    # it cannot be built
    "flash_no_sources": ("tsc: this tsc was installed without the firmware's sources. Install it again from a clone of TiniScript:  pip install \".[firmware]\"",
                         "tsc: este tsc se instaló sin las fuentes del firmware. Instálalo otra vez desde un clon de TiniScript:  pip install \".[firmware]\""),
    "flash_no_platformio": ("tsc: the firmware of {robot} for the {board} has to be built first, with PlatformIO, which is not on this computer. Install it:  {how}   and run the command again.",
                            "tsc: primero hay que compilar el firmware de {robot} para el {board}, con PlatformIO, que no está en esta computadora. Instálalo:  {how}   y repite el comando."),
    "flash_unreachable": ("tsc: PlatformIO could not fetch what it builds with ({why}). Is this computer online? Run this again when it is: once everything is downloaded, no internet is needed. PlatformIO's output is in {log}",
                          "tsc: PlatformIO no pudo descargar lo que necesita para compilar ({why}). ¿Tiene internet esta computadora? Repite el comando donde lo haya: una vez descargado, ya no hace falta. Todo lo que dijo PlatformIO está en {log}"),
    "flash_build_failed": ("tsc: the firmware of {robot} for the {board} could not be built ({why}). Bring PlatformIO up to date:  pip install --upgrade platformio   and run the command again. The compiler's output is in {log}",
                           "tsc: el firmware de {robot} para el {board} no se pudo compilar ({why}). Actualiza PlatformIO:  pip install --upgrade platformio   y repite el comando. Todo lo que dijo el compilador está en {log}"),
    "flash_too_large": ("tsc: the firmware of {robot} does not fit on the {board} ({why} bytes). The board is unchanged. Take devices out of its profile, or a board with more memory.",
                        "tsc: el firmware de {robot} no cabe en el {board} ({why} bytes). La placa quedó como estaba. Quita dispositivos de su perfil, o usa una placa con más memoria."),
    "flash_no_room": ("tsc: the firmware was not built: {why}. It is kept in {folder}; make room there, and run the command again.",
                      "tsc: el firmware no se compiló: {why}. Se guarda en {folder}; libera espacio ahí y repite el comando."),
    # it cannot be written
    "flash_no_avrdude": ("tsc: avrdude writes the firmware, but it is not on this computer. Install it:  {how}   The Arduino IDE's avrdude works, too.",
                         "tsc: el programa avrdude escribe el firmware, y no está en esta computadora. Instálalo:  {how}   El del Arduino IDE también sirve."),
    # it was not written
    "flash_nobody": ("tsc: no bootloader answers on {port}; the board is unchanged. Is this the port of its USB cable (tsc ports)? Is it a {board} (--board)? And whatever is on pins 0 and 1, such as the HC-05, must be unplugged while the firmware is written.",
                     "tsc: ningún cargador de arranque responde en {port}; la placa quedó como estaba. ¿Es el puerto de su cable USB (tsc ports)? ¿Es un {board} (--board)? Desconecta lo que esté en los pines 0 y 1, como el HC-05, mientras se escribe el firmware."),
    "flash_other_chip": ("tsc: the board on {port} is not a {board}: it has another chip. It is unchanged. Say which board it is with --board.",
                         "tsc: la placa en {port} no es un {board}: su chip es otro. Quedó como estaba. Indica qué placa es con --board."),
    "flash_port": ("tsc: avrdude cannot open the port {port}. Close what else uses it, or unplug the board and plug it in again; then try again.",
                   "tsc: avrdude no puede abrir el puerto {port}. Cierra lo que lo esté usando, o desconecta la placa y vuelve a conectarla; después prueba otra vez."),
    "flash_failed": ("tsc: avrdude could not write the firmware: {why}. Unplug the board, plug it in again, and try again.",
                     "tsc: avrdude no pudo escribir el firmware: {why}. Desconecta la placa, vuelve a conectarla y prueba otra vez."),
    # it was written in part
    "flash_differs": ("tsc: what was read back from the board is not what was written. Unplug what is on pins 0 and 1 and write it again; if that does not help, the board's memory is worn out.",
                      "tsc: lo que se leyó de la placa no es lo que se escribió. Desconecta lo que esté en los pines 0 y 1 y escríbelo otra vez; si no sirve, la memoria de la placa está gastada."),
    "flash_broken_off": ("tsc: the board on {port} fell silent in the middle, and now has only half of its firmware. Check its cable, unplug what is on pins 0 and 1, and run the command again: the board can still be written.",
                         "tsc: la placa en {port} dejó de responder a la mitad, y ahora tiene el firmware a medias. Revisa su cable, desconecta lo que esté en los pines 0 y 1 y repite el comando: todavía se puede escribir."),
    "flash_endless": ("tsc: avrdude did not finish on {port} and was stopped; the board may have only half of its firmware now. Unplug the board, plug it in again, and run the command again: the board can still be written. If that happens again, install another avrdude.",
                      "tsc: avrdude no terminó en {port} y se detuvo; quizá la placa tiene ahora el firmware a medias. Desconecta la placa, vuelve a conectarla y repite el comando: todavía se puede escribir. Si vuelve a pasar, instala otro avrdude."),
    "flash_stopped": ("tsc: stopped in the middle: the board has only half of its firmware now. Run the command again: the board can still be written.",
                      "tsc: se detuvo a la mitad: la placa tiene ahora el firmware a medias. Repite el comando: todavía se puede escribir."),
    # it was written
    "flash_silent": ("tsc: the firmware is on the board, but no robot answers on {port} yet. Press the board's reset button, and then:  tsc ping --port {port}",
                     "tsc: el firmware está en la placa, pero todavía ningún robot responde en {port}. Pulsa el botón de reinicio de la placa, y después:  tsc ping --port {port}"),
}
# fmt: on
