"""Torque that a joint's motor loses as it warms up.

A warm winding has more resistance, and warm magnets give less flux. At standstill both cost torque. Weaker magnets also
give less back-EMF, so that a motor under a voltage loses less of its torque at speed. With x the share of the torque
that is lost at standstill, s the magnets' part of it and k = K²/R the nominal motor's damping by its back-EMF,

    (1 − s·x)·(V − (1 − s·x)·K·ω) / R · K · (1 − x) / (1 − s·x) = (1 − x) · (K·(V − K·ω) / R + s·x·k·ω)

Where the effort is commanded a drive's current regulator hides the back-EMF, and the share x is all there is.
"""

from typing import Any

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.effects.joint.common import back_emf_damping
from simgap.physics.shapes import Real, Signal

_USUAL_SHARE = 0.24
"""Of the torque that a warm motor loses at standstill: copper gains 0.39 % of resistance per kelvin, and neodymium
magnets lose 0.12 % of their flux. Ferrites lose 0.2 %."""


class TemperatureDerating(ActuatorEffect):
    """Motor torque falls with the temperature above a reference; of a voltage-driven motor, the back-EMF too."""

    order = 1
    name = "temperature_derating"
    kind = "joint"
    acts_on = "actuator"
    parameters = (
        Parameter("coefficient", "1/K", 0.003, 0.0, 0.05),
        Parameter("reference", "°C", 25.0, -60.0, 200.0, neutral=20.0),
        Parameter("magnets_share", "1", _USUAL_SHARE, 0.0, 1.0, optional=True),
    )
    needs = ("effort", "temperature")
    excluded_by = ("position_command",)  # of a position loop a weaker motor is a lower gain
    driver = "temperature"
    driver_is_late = True  # a winding has a heat capacity
    driver_at_rest = "reference"
    formula = (
        "effort_effective = (1 − x) · (effort + s · x · back-EMF damping · velocity), "
        "x = coefficient · (temperature − reference), s = magnets_share under a voltage, else 0"
    )
    source = (
        "Krishnan 2010, Permanent magnet synchronous and brushless DC motor drives: remanence and temperature; "
        "IEC 60028: resistance of copper"
    )
    sentence = (
        "The motor loses a fraction {coefficient} of its torque per kelvin above {reference} °C; add derating"
        " to the simulator."
    )
    excitation = "repeat the same motion cold and after long hard work"
    symptom = "The same command accelerates the axis less as the motor warms up."
    look_alikes = ("motor_constant_error",)

    def load(self, signals: Signals, constants: Values) -> Real:
        """Return less than nothing: the loss in the winding, up to a factor, which warms it up instead."""
        return -signals["effort"].square()

    def starts(self) -> list[dict[str, float]]:
        """Start with the magnets of most motors."""
        return [self.neutral() | {"magnets_share": _USUAL_SHARE}]

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the effort of the warm motor."""
        lost = values["coefficient"] * (signals["temperature"] - values["reference"])
        effort = signals["effort"]
        if "voltage" in signals:
            flux_lost = values["magnets_share"] * lost
            effort = effort + flux_lost * back_emf_damping(constants) * signals["velocity"]
        return {"effort": effort * (1.0 - lost)}, None
