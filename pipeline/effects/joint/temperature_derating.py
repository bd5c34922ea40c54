"""A joint's motor that weakens as it warms up."""

from typing import Any

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.physics.shapes import Signal


class TemperatureDerating(ActuatorEffect):
    """Torque lost in proportion to the temperature above the one at which the motor is as the platform file says."""

    order = 1
    name = "temperature_derating"
    kind = "joint"
    acts_on = "actuator"
    parameters = (
        Parameter("coefficient", "1/K", 0.003, 0.0, 0.05),
        Parameter("reference", "°C", 25.0, -60.0, 200.0, neutral=20.0),
    )
    needs = ("effort", "temperature")
    driver = "temperature"
    driver_at_rest = "reference"
    formula = "effort_effective = effort · (1 − coefficient · (temperature − reference))"
    source = (
        "Krishnan 2010, Permanent magnet synchronous and brushless DC motor drives: remanence and temperature"
    )
    sentence = "The motor loses {coefficient} of its torque per kelvin above {reference} °C; add derating."
    excitation = "the same motion cold and after long hard work"

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the effort of the warm motor."""
        warmer = signals["temperature"] - values["reference"]
        return {"effort": signals["effort"] * (1.0 - values["coefficient"] * warmer)}, None
