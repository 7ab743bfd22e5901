"""A slotted disc on each wheel and a sensor with one channel, as a FC-03 has."""

from __future__ import annotations

from tiniscript.robots.driver import BOARD_5V, GROUND, DiscDriver, Shape, Terminal


class Slotted(DiscDriver):
    name = "slotted"
    looks = Shape(
        "disc",
        "need_slotted",
        (
            Terminal("left_d0", "left"),
            Terminal("right_d0", "right"),
            Terminal("VCC", rail=BOARD_5V),
            Terminal("GND", rail=GROUND),
        ),
        "FC-03",
        notes=("mind_slotted", "mind_no_text"),
        checks=("check_slotted",),
    )
    # fmt: off
    texts = {
        "need_slotted": ("2 × slotted optical sensor (FC-03, LM393) and 2 × disc with 20 holes for the motor shafts",
                         "2 × sensor óptico de ranura (FC-03, LM393) y 2 × disco de 20 ranuras para los ejes"),
        "terminal_left_d0": ("D0 left", "D0 izq."),
        "terminal_right_d0": ("D0 right", "D0 der."),
        "mind_slotted": ("Discs: the profile says how many holes a disc has and how wide a wheel is. Measure the wheel: 1 mm is 1.5 % of each way.",
                         "Discos: el perfil dice cuántas ranuras tiene un disco y cuánto mide una rueda. Mide la rueda: 1 mm es el 1.5 % de cada camino."),
        "mind_no_text": ("Discs: on an Uno or a Nano they have the place of the robot's reader of text. Programs come from tsc and from the studio; of lines that are typed it obeys S alone.",
                         "Discos: en una Uno o una Nano ocupan el lugar del lector de texto del robot. Los programas llegan de tsc y del estudio; de las líneas que se escriben solo obedece S."),
        "check_slotted": ("Discs: turn each wheel by hand. The lamp of its sensor blinks with each hole, and nothing rubs.",
                          "Discos: gira cada rueda con la mano. La luz de su sensor parpadea con cada ranura y nada roza."),
    }
    # fmt: on


DRIVER = Slotted()
