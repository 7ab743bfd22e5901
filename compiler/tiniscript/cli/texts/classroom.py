"""The sentences of `tsc class`, and of `tsc wifi --broker`, in English and Spanish."""

from __future__ import annotations

# fmt: off
CLASS_TEXTS: dict[str, tuple[str, str]] = {
    # key: (English, Spanish)
    "broker_password": ("Password of {user} at the broker (nothing is shown while you type): ",
                        "Contraseña de {user} en el broker (no se ve nada mientras escribes): "),
    "class_gone": ("{robot} ({id}) is not at the broker any more: off, or out of the network.",
                   "{robot} ({id}) ya no está en el broker: apagado, o fuera de la red."),
    "class_over": ("no longer listened to", "ya no se escucha"),
    "path_trust": ("the certificate", "el certificado"),
    # the robot's broker
    "broker_none": ("{robot} uses no broker. For a class at an MQTT broker:  tsc wifi --broker HOST",
                    "{robot} no usa ningún broker. Para una clase en un broker MQTT:  tsc wifi --broker HOST"),
    "broker_off": ("{robot} uses no broker any more.", "{robot} ya no usa ningún broker."),
    "broker_ready": ("{robot} is at the broker {address}, in the class {group}. To see all of them:  tsc class --broker {address} --class {group}",
                     "{robot} está en el broker {address}, en la clase {group}. Para ver todos:  tsc class --broker {address} --class {group}"),
    "broker_searching": ("{robot} keeps the broker {address} and the class {group}, and does not reach it yet: does the broker run there, and is the robot in that network? It goes on trying. To look again:  tsc wifi",
                         "{robot} guarda el broker {address} y la clase {group}, y todavía no llega a él: ¿funciona ahí el broker, y está el robot en esa red? Lo sigue intentando. Para verlo otra vez:  tsc wifi"),
    "broker_refused": ("{robot} keeps the broker {address} and the class {group}, and is not let in there: the name or the password may be others. To give them again:  tsc wifi --broker HOST --user NAME",
                       "{robot} guarda el broker {address} y la clase {group}, que no lo deja entrar: quizá el nombre o la contraseña son otros. Para darlos otra vez:  tsc wifi --broker HOST --user NOMBRE"),
    # what does not work
    "class_no_broker": ("tsc: which broker? Name the computer on which it runs:  tsc class --broker HOST",
                        "tsc: ¿qué broker? Nombra la computadora donde está:  tsc class --broker HOST"),
    "class_no_upload": ("tsc: a program is for  tsc class upload", "tsc: un programa es para  tsc class upload"),
    "class_empty": ("tsc: no robot of the class {group} is at the broker {host}. Is it on, and was it brought there?   tsc wifi --broker HOST --class {group}",
                    "tsc: no hay ningún robot de la clase {group} en el broker {host}. ¿Está encendido, y lo llevaste ahí?   tsc wifi --broker HOST --class {group}"),
    "class_bad_name": ("tsc: a class is called by 1 to 16 of a to z, 0 to 9 and -, such as 3b. This is none: {found}",
                       "tsc: el nombre de una clase tiene de 1 a 16 de a a z, 0 a 9 y -, como 3b. Este no sirve: {found}"),
    "broker_bad_host": ("tsc: a broker is the name of a computer or its address, and perhaps a port: 192.168.1.20:1883. This is none: {found}",
                        "tsc: un broker es el nombre de una computadora o su dirección, y quizá un puerto: 192.168.1.20:1883. Esto no lo es: {found}"),
    "broker_unknown": ("tsc: no computer is called {host} here ({why}). Name the broker's address:  --broker 192.168.1.20",
                       "tsc: ninguna computadora se llama {host} aquí ({why}). Nombra la dirección del broker:  --broker 192.168.1.20"),
    "broker_itself": ("tsc: {host} means each computer itself: {robot} would look for the broker in itself. Name this computer's address in the network of the robots.",
                      "tsc: {host} es, para cada computadora, ella misma: {robot} buscaría el broker en sí mismo. Nombra la dirección de esta computadora en la red de los robots."),
    "broker_bad_user": ("tsc: a name at a broker has 1 to 32 bytes that can be printed.",
                        "tsc: un nombre en un broker tiene de 1 a 32 bytes que se pueden imprimir."),
    "broker_bad_password": ("tsc: the password must have 1 to 63 letters, digits and signs.",
                            "tsc: la contraseña debe tener de 1 a 63 letras, cifras y signos."),
    "broker_no_user": ("tsc: --user is for a broker:  --broker HOST --user NAME", "tsc: --user es para un broker:  --broker HOST --user NOMBRE"),
    "broker_unread": ("tsc: the file {file} with the certificate cannot be read ({why}).",
                      "tsc: no se puede leer el archivo {file} con el certificado ({why})."),
    "broker_trust_alone": ("tsc: --trust is for a connection with --tls.", "tsc: --trust es para una conexión con --tls."),
    "broker_over_it": ("tsc: over the broker you cannot change the broker: the connection would end before {robot} has answered. Use its cable or another connection, with --port.",
                       "tsc: por el broker no se puede cambiar el broker: la conexión terminaría antes de que {robot} responda. Usa su cable u otra conexión, con --port."),
    "broker_old": ("tsc: the firmware of {robot} knows no broker: it is older than this tsc. Bring a newer one to it.",
                   "tsc: el firmware de {robot} no conoce ningún broker: es más antiguo que este tsc. Ponle uno más nuevo."),
}
# fmt: on
