"""What a robot that reads text says to a person, beside what is wrong with a line.

Knows names and words in both languages. Generated into the firmware behind the problems. Texts are
ASCII, for any terminal.
"""

from __future__ import annotations

from typing import NamedTuple


class Remark(NamedTuple):
    """`english` and `spanish` are the text. Where it is empty, the firmware makes it."""

    name: str
    english: str
    spanish: str


# fmt: off
REMARKS = (  # in the order of their numbers
    Remark("OK",        "OK",                               "OK"),
    Remark("OK_BUTTON", "OK. The button starts it.",        "OK. El boton lo inicia."),
    Remark("OK_LOST",   "OK. The old program is lost.",     "OK. El programa anterior se perdio."),
    Remark("WAITING",   "Waiting for ",                     "Espero "),
    Remark("GIVEN_UP",  "Too late. Begin again.",           "Muy tarde. Empieza otra vez."),
    Remark("STOPPED",   "STOPPED",                          "DETENIDO"),
    Remark("LATCHED",   "It was stopped. Begin with SI|",   "Esta detenido. Empieza con SI|"),
    Remark("SAVING",    "Still saving. Send it again.",     "Aun guardo. Envialo otra vez."),
    Remark("REFUSED",   "Not possible here.",               "Aqui no es posible."),
    Remark("NOT_OWNER", "Owned: tsc text on, or button 2 s.", "Con dueno: tsc text on, o boton 2s"),
    Remark("HELD_BACK", "The teacher stopped it.",          "Lo detuvo el docente."),
    Remark("DONE",      "DONE",                             "FIN"),
    Remark("FAULT",     "FAULT ",                           "FALLA "),
    Remark("MISTAKE",   "",                                 ""),  # the column and the problem
    Remark("HELLO",     ", kit ",                           ", kit "),  # between name and kit
    Remark("HELP",      "",                                 ""),  # the words of this robot
    Remark("CUT",       "Bytes were lost. Begin again.",    "Se perdio algo. Empieza otra vez."),
    Remark("LEVEL_UNO", ", text uno",                       ", text uno"),  # behind the kit
    Remark("LEVEL_MEGA", ", text mega",                     ", text mega"),
    Remark("LEVEL_ESP32", ", text esp32",                   ", text esp32"),
    Remark("FAILED",    "It had a fault. Begin with SI|",   "Hubo una falla. Empieza con SI|"),
    Remark("MUTE",      "Too many. Wait 5 s.",              "Son muchos. Espera 5 s."),  # mistakes
)
# fmt: on
