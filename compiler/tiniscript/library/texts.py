"""The sentences of the library's errors and listings, in English and Spanish.

The sentences of diagnostics are in `diagnostics/catalogue.toml`, those of a robot's answers in
`link/statuses.toml`. The command has sentences of its own, which name its options.
"""

from __future__ import annotations

from collections.abc import Mapping

LANGUAGES = ("en", "es")

# fmt: off
TEXTS: dict[str, tuple[str, str]] = {
    # wrong arguments
    "bad_language": ("language is en or es, not {found}.", "language es en o es, no {found}."),
    "bad_program": ("A program is text, an image (bytes) or a Program, not {found}.",
                    "Un programa es texto, una imagen (bytes) o un Program, no {found}."),
    "bad_number": ("{name} is {found}; it must be {range}.", "{name} es {found}; debe ser {range}."),
    "bad_robot": ("robot is the name of a robot or the path of a profile, not {found}.",
                  "robot es el nombre de un robot o la ruta de un perfil, no {found}."),
    "profile_refused": ("{reasons}", "{reasons}"),
    "world_refused": ("{reasons}", "{reasons}"),
    "no_sensor": ("{robot} has no sensor {found}. Its sensors: {known}.",
                  "{robot} no tiene el sensor {found}. Sus sensores: {known}."),
    "no_sensors": ("none", "ninguno"),
    "bad_readings": ("The readings of {name} are numbers, or True and False; there must be one at least.",
                     "Las lecturas de {name} son números, o True y False; debe haber al menos una."),
    "bad_reading": ("{found} is not a reading of {name}: it measures {range}.",
                    "{found} no es una lectura de {name}: mide {range}."),
    "range": ("{low} to {high}", "de {low} a {high}"),
    "range_yes_no": ("True or False", "True o False"),
    "bad_choice": ("{name} is {known}, not {found}.", "{name} es {known}, no {found}."),
    "no_wasmtime": ("The C++ machine and the virtual robot need wasmtime:  {how}  ({why})",
                    "La máquina en C++ y el robot virtual necesitan wasmtime:  {how}  ({why})"),
    "live_button": ("SB waits for the button, and a live line starts right away. Leave SB| out, or upload the line.",
                    "SB espera el botón, y una línea en vivo empieza de inmediato. Quita SB|, o súbela con upload."),
    "ping_program": ("PING has no program to start. Ask with status().",
                     "PING no tiene un programa que iniciar. Pregunta con status()."),
    "nothing_started": ("Nothing was started here that could end. Call upload, live or start first.",
                        "Aquí no se inició nada que pueda terminar. Llama primero a upload, live o start."),
    "closed": ("This connection is closed. Connect again.", "Esta conexión está cerrada. Conecta otra vez."),
    # listings
    "line": ("line {line}: {shown}", "línea {line}: {shown}"),
    # the choice of a port
    "which_port": ("Which port? Name it: connect(\"{example}\"). The ports here: {known}",
                   "¿Qué puerto? Indícalo: connect(\"{example}\"). Los puertos de aquí: {known}"),
    "last_port_missing": ("The last used port, {port}, is not there. Plug the robot in, or name another one. The ports here: {known}",
                          "El último puerto usado, {port}, no está. Conecta el robot, o indica otro. Los puertos de aquí: {known}"),
    "bad_port": ("{port} is no name of a port.", "{port} no es el nombre de un puerto."),
    # a port that does not open
    "port_missing": ("There is no port {port}, nor any other. Plug in the cable, or pair the robot's Bluetooth, and try again.",
                     "No hay un puerto {port}, ni ningún otro. Conecta el cable, o empareja el Bluetooth del robot, y prueba otra vez."),
    "port_missing_but": ("There is no port {port}. Plug the robot in and try again, or choose another: {known}",
                         "No hay un puerto {port}. Conecta el robot y prueba otra vez, o elige otro: {known}"),
    "port_forbidden": ("You may not use the port {port}. Ask whoever looks after this computer.",
                       "No tienes permiso para usar el puerto {port}. Pregunta a quien cuida esta computadora."),
    "port_forbidden_linux": ("You may not use the port {port}. Join the group of serial ports:  sudo usermod -aG dialout $USER   Then log out and in again.",
                             "No tienes permiso para usar el puerto {port}. Entra al grupo de puertos serie:  sudo usermod -aG dialout $USER   Después cierra la sesión y ábrela otra vez."),
    "port_busy": ("Another program is using the port {port}. Close it and try again.",
                  "Otro programa está usando el puerto {port}. Ciérralo y prueba otra vez."),
    "port_unreachable": ("Cannot reach the robot at {port}. Is it on, paired and near? Then try again.",
                         "No se puede llegar al robot en {port}. ¿Está encendido, emparejado y cerca? Prueba otra vez."),
    "port_slow": ("The port {port} does not open. Switch the robot off and on, see that its Bluetooth is paired, and try again.",
                  "El puerto {port} no se abre. Apaga y enciende el robot, mira que su Bluetooth esté emparejado, y prueba otra vez."),
    "port_no_port": ("{port} is not a serial port.", "{port} no es un puerto serie."),
    "port_broken": ("The port {port} cannot be used: {why}. Pull its cable out, plug it in again, and try again.",
                    "El puerto {port} no se puede usar: {why}. Saca su cable, conéctalo de nuevo, y prueba otra vez."),
    "port_not_installed": ("{port} needs a package that is not installed here ({why}). Install it and try again:  {how}",
                           "{port} necesita un paquete que aquí no está instalado ({why}). Instálalo y prueba otra vez:  {how}"),
    "port_radio_off": ("The Bluetooth of this computer is off, or it has none with Bluetooth LE. Switch it on or plug in a USB adapter for it, and try again.",
                       "El Bluetooth de esta computadora está apagado, o no tiene uno con Bluetooth LE. Enciéndelo o conecta un adaptador USB, y prueba otra vez."),
    "port_radio_forbidden": ("This program may not use Bluetooth. Allow it to the terminal in the system's privacy settings (on Linux ask whoever looks after this computer), and try again.",
                             "Este programa no tiene permiso para usar Bluetooth. Dáselo a la terminal en los ajustes de privacidad del sistema (en Linux, pídelo a quien cuida esta computadora) y prueba otra vez."),
    "port_radio_service": ("The Bluetooth service of this computer does not run. Start it and try again; on Linux:  sudo systemctl start bluetooth",
                           "El servicio de Bluetooth de esta computadora no está en marcha. Inícialo y prueba otra vez; en Linux:  sudo systemctl start bluetooth"),
    "port_radio_broken": ("Bluetooth does not work for {port}: {why}. Switch the Bluetooth of this computer off and on, then the robot, and try again.",
                          "Bluetooth no funciona para {port}: {why}. Apaga y enciende el Bluetooth de esta computadora, después el robot, y prueba otra vez."),
    "port_not_found": ("No {port} is in reach, nor any other robot with Bluetooth LE. Is it on and near? Whoever is connected to it already (a phone, another computer) has to disconnect first. Then try again.",
                       "No hay ningún {port} al alcance, ni otro robot con Bluetooth LE. ¿Está encendido y cerca? Quien ya esté conectado a él (un teléfono, otra computadora) debe desconectarse antes. Prueba otra vez."),
    "port_not_found_but": ("No {port} is in reach. Is it on and near? Whoever is connected to it already (a phone, another computer) has to disconnect first. In reach: {why}",
                           "No hay ningún {port} al alcance. ¿Está encendido y cerca? Quien ya esté conectado a él (un teléfono, otra computadora) debe desconectarse antes. Al alcance: {why}"),
    "port_several": ("Several robots are called {port}. Choose one by its address: {why}",
                     "Varios robots se llaman {port}. Elige uno por su dirección: {why}"),
    "port_no_robot": ("{port} has no service by which a robot is reached. Choose another.",
                      "{port} no tiene ningún servicio por el que se llegue a un robot. Elige otro."),
    "port_not_announced": ("No robot in this network announces itself as {port}. Is it on, and in the same network? If you know its address:  socket://HOST:PORT",
                           "Ningún robot de esta red se anuncia como {port}. ¿Está encendido y en la misma red? Si conoces su dirección:  socket://HOST:PUERTO"),
    "port_no_multicast": ("Robots cannot be found by name here: this computer reaches no network with multicast ({why}). Join the robot's network, or name its address:  socket://HOST:PORT",
                          "Aquí no se pueden encontrar robots por su nombre: esta computadora no llega a ninguna red con multicast ({why}). Entra en la red del robot, o indica su dirección:  socket://HOST:PUERTO"),
    "port_strange": ("{port} announces an address that is not in this network ({why}), so nothing connects to it. If it is yours:  socket://HOST:PORT",
                     "{port} anuncia una dirección que no es de esta red ({why}), así que nada se conecta a ella. Si es tuya:  socket://HOST:PUERTO"),
    "holder_other": ("The port {port} is held by a tiniscript of another version, {theirs} ({verb}). End that one, and try again.",
                     "El puerto {port} lo tiene un tiniscript de otra versión, {theirs} ({verb}). Termínalo, y prueba otra vez."),
    "holder_baud": ("The port {port} is held by {verb}, at {baud} baud. Leave baud out, or end that one and try again.",
                    "El puerto {port} lo tiene {verb}, a {baud} baudios. Quita baud, o termínalo y prueba otra vez."),
    # the connection to the robot
    "holder_ended": ("The command that held the port {port} has ended ({verb}), and with it a program that was not detached. Connect again.",
                     "El comando que tenía el puerto {port} terminó ({verb}), y con él un programa iniciado sin detach. Conecta otra vez."),
    "port_gone": ("The port {port} has vanished. A program that is not detached ends a second after that. Plug the cable in and connect again.",
                  "El puerto {port} desapareció. Un programa iniciado sin detach termina un segundo después. Enchufa el cable y conecta otra vez."),
    "radio_gone": ("The Bluetooth connection to {port} has ended. A program that is not detached ends a second after that. Is the robot on and near? Then connect again.",
                   "La conexión Bluetooth con {port} terminó. Un programa iniciado sin detach termina un segundo después. ¿El robot está encendido y cerca? Conecta otra vez."),
    "link_silent": ("Nothing answers on {port}. Is the robot on, and is this its port? If it has another speed, give baud.",
                    "Nada responde en {port}. ¿El robot está encendido, y es este su puerto? Si tiene otra velocidad, indica baud."),
    "link_other": ("Something answers on {port}, but it is not TiniScript. Perhaps the speed is another (baud), or the board has another sketch.",
                   "Algo responde en {port}, pero no es TiniScript. Quizá la velocidad es otra (baud), o la placa tiene otro programa."),
    "link_echo": ("What is sent to {port} comes back. Are TX and RX connected to each other, or is the radio module in its set-up mode?",
                  "Lo que se envía a {port} vuelve. ¿TX y RX están unidos entre sí, o el módulo de radio está en modo de configuración?"),
    "link_lost": ("Lost the connection to the robot on {port}: it does not answer any more. Its program ends by itself, unless it is detached. Look at its batteries and the distance.",
                  "Se perdió la conexión con el robot en {port}: ya no responde. Su programa termina solo, a menos que se iniciara con detach. Mira sus pilas y la distancia."),
    "stopped_elsewhere": ("The robot on {port} was stopped before it did this. Try again.",
                          "El robot en {port} se detuvo antes de hacer esto. Prueba otra vez."),
    "replaced": ("Somebody else has started another program on the robot on {port}, which ended this one.",
                 "Otra persona inició otro programa en el robot en {port}, y eso terminó este."),
    "not_confirmed": ("The robot on {port} has not confirmed the stop. If it moves, lift it, and take its batteries or its plug out. Leave its button alone: it would start a robot that has stopped.",
                      "El robot en {port} no ha confirmado que se detuvo. Si se mueve, levántalo y quítale las pilas o el enchufe. No toques su botón: haría arrancar un robot detenido."),
    "still_running": ("The program still runs after {seconds} s.", "El programa sigue en marcha después de {seconds} s."),
    "saves_later": ("The program is not saved yet: that is done as soon as the robot's motors have stopped. Do not switch it off before.",
                    "El programa todavía no está guardado: eso se hace en cuanto los motores del robot estén quietos. No lo apagues antes."),
    "low_supply": ("The robot's batteries are too weak to save the program: it is in RAM only. Change them and upload it again.",
                   "Las pilas del robot están demasiado gastadas para guardar el programa: está solo en RAM. Cámbialas y súbelo otra vez."),
    "not_saved": ("The robot could not save the program; it is in RAM only.",
                  "El robot no pudo guardar el programa; está solo en RAM."),
}
# fmt: on


def sentence(reason: str, language: str, values: Mapping[str, str]) -> str:
    """Return the sentence for a reason, with its gaps filled."""
    english, spanish = TEXTS[reason]
    return (spanish if language == "es" else english).format(**values)
