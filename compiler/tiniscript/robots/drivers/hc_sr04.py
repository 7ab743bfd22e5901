"""The ultrasonic sensor HC-SR04. Its distances are thousandths of a centimetre."""

from __future__ import annotations

from tiniscript.base.fixed_point import ONE
from tiniscript.base.kit import Device
from tiniscript.robots.driver import (
    BOARD_5V,
    GROUND,
    DriverPlan,
    HeaderPart,
    PinKey,
    SensorDriver,
    Shape,
    Terminal,
    limit_lines,
)
from tiniscript.robots.profile import Wiring

FARTHEST_DISTANCE = 400 * ONE  # reading without an echo


class HcSr04(SensorDriver):
    name = "hc_sr04"
    profile_help = "trigger, echo; in cm"
    used_by = "sensors number"
    pins = (PinKey("trigger", "output"), PinKey("echo", "echo"))
    fixed_shape = Shape(
        "sonar",
        "need_hc_sr04",
        (
            Terminal("VCC", rail=BOARD_5V),
            Terminal("TRIG", "trigger"),
            Terminal("ECHO", "echo"),
            Terminal("GND", rail=GROUND),
        ),
        "HC-SR04",
        note_keys=("mind_hc_sr04",),
        needs_5v=True,
    )

    def firmware_lines(self, part: HeaderPart, device: Device, wiring: Wiring) -> list[str]:
        trigger = part.pins.pin(wiring.pins["trigger"])
        part.begin_lines.append(f"begin_output({trigger}, false);")
        part.ultrasonic_texts.append(f"{{{trigger}, {part.pins.echo(wiring.pins['echo'])}}}")
        return [
            f"      if (!ultrasonic_read({len(part.ultrasonic_texts) - 1}, value)) return false;",
            *limit_lines(device, 0, FARTHEST_DISTANCE),
            "      return true;",
        ]

    def sketch_lines(
        self, plan: DriverPlan, device: Device, wiring: Wiring, name: str, comment: str
    ) -> list[str]:
        trigger = f"{device.name}_$TRIGGER_$PIN"
        plan.pin(trigger, wiring.pins["trigger"], "OUTPUT", comment)
        echo = plan.pin(f"{device.name}_$ECHO_$PIN", wiring.pins["echo"], "INPUT")
        drivers = [sensor.driver for sensor in plan.robot.board.sensors]
        first_lines, own_condition, last_lines = [], "", []
        if drivers.count(self.name) > 1:
            first_lines = ["static unsigned long $own_ping = -60;"]
            own_condition = " && millis() - $own_ping < 58"
            last_lines = ["$own_ping = $last_ping;"]
        farthest_distance = min(FARTHEST_DISTANCE, device.high)
        return [
            *first_lines,
            f"if (millis() - $last_ping < 30{own_condition}) return {name};",
            f"long $value = $ping_ms({trigger}, {echo}) * 4390UL >> 8;",
            *last_lines,
            f"{name} = {plan.value(f'constrain($value, {max(0, device.low)}, {farthest_distance})')};",
        ]


DRIVER = HcSr04()
