"""The sentences of `tsc wifi`, in English and Spanish."""

from __future__ import annotations

# fmt: off
WIFI_TEXTS: dict[str, tuple[str, str]] = {
    # key: (English, Spanish)
    "wifi_password": ("Password of the network (nothing is shown while you type): ",
                      "Contraseña de la red (no se ve nada mientras escribes): "),
    "wifi_off": ("{robot} uses no WiFi. To make it join a network:  tsc wifi NETWORK",
                 "{robot} no usa WiFi. Para conectarlo a una red:  tsc wifi RED"),
    "wifi_forgotten": ("{robot} has forgotten its network, and uses no WiFi any more.",
                       "{robot} olvidó su red, y ya no usa WiFi."),
    "wifi_station_ready": ("{robot} is in the network {network}, at {address}. From a computer in it:  tsc ping --port tcp://{host}.local",
                           "{robot} está en la red {network}, en {address}. Desde una computadora de esa red:  tsc ping --port tcp://{host}.local"),
    "wifi_station_searching": ("{robot} keeps the network {network}, but does not reach it yet: is the network near, and at 2.4 GHz? The robot keeps trying. To check again:  tsc wifi",
                               "{robot} guarda la red {network}, y todavía no llega a ella: ¿está cerca, y es de 2.4 GHz? Lo sigue intentando. Para verlo otra vez:  tsc wifi"),
    "wifi_station_refused": ("{robot} keeps the network {network}, which does not let it in: the password may be wrong. To enter it again:  tsc wifi NETWORK",
                             "{robot} guarda la red {network}, que no lo deja entrar: quizá la contraseña es otra. Para escribirla otra vez:  tsc wifi RED"),
    "wifi_station_rests": ("{robot} keeps the network {network}, but its WiFi is off: three times in a row it restarted within 20 seconds of switching WiFi on. That may be weak batteries: charge or change them. Then set the network again, over its cable or Bluetooth:  tsc wifi NETWORK",
                           "{robot} guarda la red {network}, y su WiFi está apagado: tres veces seguidas se reinició en los 20 segundos después de encender el WiFi. Pueden ser pilas gastadas: cárgalas o cámbialas. Después indícale la red otra vez, por su cable o Bluetooth:  tsc wifi RED"),
    "wifi_access_point_rests": ("{robot} keeps its network {network}, but its WiFi is off: three times in a row it restarted within 20 seconds of switching WiFi on. That may be weak batteries: charge or change them. Then set the network again, over its cable or Bluetooth:  tsc wifi NAME --access-point",
                                "{robot} guarda su red {network}, y su WiFi está apagado: tres veces seguidas se reinició en los 20 segundos después de encender el WiFi. Pueden ser pilas gastadas: cárgalas o cámbialas. Después indícale la red otra vez, por su cable o Bluetooth:  tsc wifi NOMBRE --access-point"),
    "wifi_access_point_ready": ("{robot} has a network of its own, {network}: a computer that joins it finds the robot at {address}:  tsc ping --port tcp://{host}.local",
                                "{robot} tiene su propia red, {network}: una computadora que se conecta a ella encuentra el robot en {address}:  tsc ping --port tcp://{host}.local"),
    "wifi_access_point_searching": ("{robot} opens its network {network}. To check again:  tsc wifi",
                                    "{robot} está abriendo su red {network}. Para verlo otra vez:  tsc wifi"),
    "wifi_access_point_refused": ("{robot} could not open its network {network}. Switch it off and on, then:  tsc wifi",
                                  "{robot} no pudo abrir su red {network}. Apágalo y enciéndelo, y luego:  tsc wifi"),
    # what does not work
    "wifi_none": ("tsc: {robot} has no WiFi: that needs an ESP32, and firmware that knows WiFi.",
                  "tsc: {robot} no tiene WiFi: solo lo tienen robots con un ESP32, y un firmware que lo conozca."),
    "wifi_unowned": ("tsc: {robot} has no owner, and over WiFi only a robot with an owner drives. First make it yours:  tsc claim",
                     "tsc: {robot} no tiene dueño, y por WiFi solo se maneja un robot con dueño. Primero hazlo tuyo:  tsc claim"),
    "wifi_itself": ("tsc: over the network you cannot change the network: the connection would end before {robot} has answered. Use its cable or Bluetooth, with --port.",
                    "tsc: por la red no se puede cambiar la red: la conexión terminaría antes de que {robot} responda. Usa su cable o Bluetooth, con --port."),
    "wifi_one_way": ("tsc: a network, --forget, --broker or --no-broker, one at a time.",
                     "tsc: una red, --forget, --broker o --no-broker, uno a la vez."),
    "wifi_no_network": ("tsc: what should the robot's own network be called?   tsc wifi NAME --access-point",
                        "tsc: ¿cómo debe llamarse la red del robot?   tsc wifi NOMBRE --access-point"),
    "wifi_bad_network": ("tsc: a network's name has 1 to 32 printable bytes; this one has {bytes}.",
                         "tsc: el nombre de una red tiene de 1 a 32 bytes que se pueden imprimir; este tiene {bytes}."),
    "wifi_bad_password": ("tsc: the password must have 8 to 63 letters, digits and signs. Networks without a password are not for robots. The robot's network stays what it was.",
                          "tsc: la contraseña debe tener de 8 a 63 letras, cifras y signos. Un robot no usa redes sin contraseña. La red del robot queda como estaba."),
}
# fmt: on
