"""Supply voltage that reaches a joint's motor.

A drive that only sets a duty cycle has a share of one. A drive that compensates for its supply has a share of zero.
At the nominal voltage the motor gets the commanded voltage. A joint's platform file does not hold this voltage, so it
is a parameter here.
"""

from typing import Any

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.effects.joint.common import driven_by
from simgap.effects.scan import scan
from simgap.physics.shapes import Real, Signal


class BatterySag(ActuatorEffect):
    """The motor voltage falls with the supply voltage."""

    name = "battery_sag"
    kind = "joint"
    acts_on = "actuator"
    parameters = (
        Parameter("share", "1", 1.0, 0.0, 2.0),
        Parameter("nominal_voltage", "V", 12.0, 0.5, 2000.0, neutral=24.0),
    )
    needs = ("voltage", "battery_voltage")
    driver = "battery_voltage"
    driver_at_rest = "nominal_voltage"
    formula = "voltage_effective = voltage · (1 + share · (battery_voltage / nominal_voltage − 1))"
    source = "Mohan 2003, Electric drives: the mean voltage of a pulse-width-modulated converter"
    sentence = (
        "The motor voltage changes with the battery by a share of {share}, relative to {nominal_voltage} V; scale"
        " it in the simulator."
    )
    excitation = "repeat the same motion on a full and on an empty battery, or under heavy and light load"
    symptom = "The same commanded voltage gives less torque and speed as the battery voltage falls."
    look_alikes = ("motor_constant_error", "temperature_derating")

    def load(self, signals: Signals, constants: Values) -> Real:
        """Return the motor's power, up to a factor: it loads the battery."""
        return signals["voltage"] * signals["effort"]

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan over the usual supplies."""
        return scan(share=(1.0,), nominal_voltage=(3.7, 5.0, 7.4, 12.0, 24.0, 48.0))

    def starts_in(self, signals: Signals, constants: Values | None = None) -> list[dict[str, float]]:
        """Start from supplies around the one that was recorded, if it was."""
        if "battery_voltage" not in signals:
            return self.starts()
        usual = float(signals["battery_voltage"].median())
        return scan(share=(1.0,), nominal_voltage=(0.8 * usual, usual, 1.25 * usual))

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the voltage at the motor, and the effort that it makes."""
        relative = signals["battery_voltage"] / values["nominal_voltage"] - 1.0
        voltage = signals["voltage"] * (1.0 + values["share"] * relative)
        return driven_by(voltage, signals, constants), None
