"""A supply whose voltage a joint's drive passes on.

A drive that only sets its duty has a share of one, one that makes up for the supply a share of zero. At the nominal
voltage, which no platform file of a joint holds, the motor gets what is commanded.
"""

from typing import Any

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.effects.scan import scan
from simgap.physics.shapes import Real, Signal


class BatterySag(ActuatorEffect):
    """The motor gets a part of the supply's voltage, not a voltage: with the supply it falls."""

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
        "The motor's voltage follows the battery's by a share of {share}, and is as commanded at {nominal_voltage} V; "
        "scale it in the simulator."
    )
    excitation = "the same motion with a full and with an empty battery, or under heavy load and light"

    def load(self, signals: Signals, constants: Values) -> Real:
        """Return what the motor draws, in proportion to its power: a battery gives way to it."""
        return signals["voltage"] * signals["effort"]

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan over the usual supplies."""
        return scan(share=(1.0,), nominal_voltage=(3.7, 5.0, 7.4, 12.0, 24.0, 48.0))

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the voltage at the motor, and the effort that it makes."""
        relative = signals["battery_voltage"] / values["nominal_voltage"] - 1.0
        change = signals["voltage"] * values["share"] * relative
        per_volt = constants["torque_constant"] * constants["gear_ratio"] / constants["resistance"]
        return {
            "voltage": signals["voltage"] + change,
            "effort": signals["effort"] + per_volt * change,
        }, None
