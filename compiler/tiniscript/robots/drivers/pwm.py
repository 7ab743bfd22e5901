"""A pin that is on for a part of the time: a lamp that is dimmed."""

from __future__ import annotations

from tiniscript.base.kit import Device
from tiniscript.robots.driver import ActuatorDriver, DriverPlan, HeaderPart, PinKey, lamp_shape
from tiniscript.robots.profile import Wiring


class PwmActuator(ActuatorDriver):
    name = "pwm"
    profile_help = "pin"
    used_by = "actuators number"
    pins = (PinKey("pin", "pwm"),)
    fixed_shape = lamp_shape(is_lit_by_low=False)

    def firmware_lines(self, part: HeaderPart, device: Device, wiring: Wiring) -> list[str]:
        pin, pwm = part.pins.pin(wiring.pins["pin"]), part.pins.pwm(wiring.pins["pin"])
        begin_line = f"begin_pwm(Pwm{pwm});" if part.is_esp32 else f"begin_output({pin}, false);"
        part.begin_lines.append(begin_line)
        part.off_lines.append(f"disconnect(Pwm{pwm});  // {device.name}")
        share = part.map_to_range(device, 0, 255)
        return [f"      connect(Pwm{pwm}, {share});", "      return;"]

    def sketch_lines(
        self, plan: DriverPlan, device: Device, wiring: Wiring, function: str, comment: str
    ) -> str:
        pin = plan.pin(f"{device.name}_$PIN", wiring.pins["pin"], "OUTPUT", comment)
        plan.off_lines.append(f"analogWrite({pin}, 0);")
        share = plan.part_of(device, 0, 255)
        return f"void {function}(long value) {{\n  analogWrite({pin}, {share});\n}}"


DRIVER = PwmActuator()
