"""The ultrasonic sensor HC-SR04. Its distances are thousandths of a centimetre."""

from __future__ import annotations

from tiniscript.fixed_point import ONE
from tiniscript.kit import Device
from tiniscript.robots.driver import (
    BOARD_5V,
    GROUND,
    Part,
    PinKey,
    Plan,
    SensorDriver,
    Shape,
    Terminal,
    in_limits,
)
from tiniscript.robots.profile import Wiring

FARTHEST = 400 * ONE  # reading without an echo


class HcSr04(SensorDriver):
    name = "hc_sr04"
    used_by = "sensors number"
    pins = (PinKey("trigger", "output"), PinKey("echo", "echo"))
    looks = Shape(
        "sonar",
        "need_hc_sr04",
        (
            Terminal("VCC", rail=BOARD_5V),
            Terminal("TRIG", "trigger"),
            Terminal("ECHO", "echo"),
            Terminal("GND", rail=GROUND),
        ),
        "HC-SR04",
        notes=("mind_hc_sr04",),
        needs_5v=True,
    )
    # fmt: off
    texts = {
        "need_hc_sr04": ("distance sensor HC-SR04", "sensor de distancia HC-SR04"),
        "mind_hc_sr04": ("HC-SR04: it needs 5 V. With 3.3 V it measures nonsense.",
                         "HC-SR04: necesita 5 V. Con 3.3 V mide cualquier cosa."),
        "mind_hc_sr04_3v3": ("HC-SR04: it needs 5 V, and its ECHO answers with 5 V: the resistors of 1 kΩ and 2 kΩ bring that down to 3.3 V. The pin is between the two: 1 kΩ to ECHO, 2 kΩ to GND. Otherwise ECHO destroys it.",
                             "HC-SR04: necesita 5 V, y su ECHO responde con 5 V: las resistencias de 1 kΩ y 2 kΩ lo bajan a 3.3 V. El pin va entre las dos: 1 kΩ hacia ECHO, 2 kΩ hacia GND. De otro modo, ECHO lo daña."),
    }
    # fmt: on

    def firmware(self, part: Part, device: Device, wiring: Wiring) -> list[str]:
        trigger = part.pins.pin(wiring.pins["trigger"])
        part.begin.append(f"begin_output({trigger}, false);")
        part.ultrasonics.append(f"{{{trigger}, {part.pins.echo(wiring.pins['echo'])}}}")
        return [
            f"      if (!ultrasonic_read({len(part.ultrasonics) - 1}, value)) return false;",
            *in_limits(device, 0, FARTHEST),
            "      return true;",
        ]

    def sketch(
        self, plan: Plan, device: Device, wiring: Wiring, name: str, beside: str
    ) -> list[str]:
        trigger = f"{device.name}_$TRIGGER_$PIN"
        plan.pin(trigger, wiring.pins["trigger"], "OUTPUT", beside)
        echo = plan.pin(f"{device.name}_$ECHO_$PIN", wiring.pins["echo"], "INPUT")
        drivers = [each.driver for each in plan.robot.board.sensors]
        first, again, last = [], "", []
        if drivers.count(self.name) > 1:
            first = ["static unsigned long $own_ping = -60;"]
            again = " && millis() - $own_ping < 58"
            last = ["$own_ping = $last_ping;"]
        farthest = min(FARTHEST, device.high)
        return [
            *first,
            f"if (millis() - $last_ping < 30{again}) return {name};",
            f"long $value = $ping_ms({trigger}, {echo}) * 4390UL >> 8;",
            *last,
            f"{name} = {plan.value(f'constrain($value, {max(0, device.low)}, {farthest})')};",
        ]


DRIVER = HcSr04()
