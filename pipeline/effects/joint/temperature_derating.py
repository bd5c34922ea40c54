"""Torque that a joint's motor loses as it warms up."""

from typing import Any

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.physics.shapes import Signal


class TemperatureDerating(ActuatorEffect):
    """Motor torque falls in proportion to the temperature above a reference."""

    order = 1
    name = "temperature_derating"
    kind = "joint"
    acts_on = "actuator"
    parameters = (
        Parameter("coefficient", "1/K", 0.003, 0.0, 0.05),
        Parameter("reference", "°C", 25.0, -60.0, 200.0, neutral=20.0),
    )
    needs = ("effort", "temperature")
    excluded_by = ("position_command",)  # of a position loop a weaker motor is a lower gain
    driver = "temperature"
    driver_at_rest = "reference"
    formula = "effort_effective = effort · (1 − coefficient · (temperature − reference))"
    source = (
        "Krishnan 2010, Permanent magnet synchronous and brushless DC motor drives: remanence and temperature"
    )
    sentence = (
        "The motor loses a fraction {coefficient} of its torque per kelvin above {reference} °C; add derating"
        " to the simulator."
    )
    excitation = "repeat the same motion cold and after long hard work"
    symptom = "The same command accelerates the axis less as the motor warms up."
    look_alikes = ("motor_constant_error",)

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the effort of the warm motor."""
        warmer = signals["temperature"] - values["reference"]
        return {"effort": signals["effort"] * (1.0 - values["coefficient"] * warmer)}, None
