"""Linear spring on a joint."""

import math

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.joint.common import on_axis
from simgap.physics.shapes import Channels


class LinearStiffness(WrenchEffect):
    """A spring pulls the axis to zero beyond what the platform file says, or less if negative."""

    name = "linear_stiffness"
    kind = "joint"
    acts_on = "torque"
    parameters = (Parameter("stiffness", "N·m/rad", 0.3, -1e6, 1e6),)
    needs = ("position",)
    formula = "torque = −stiffness · position"
    source = "Hooke's law"
    sentence = "A spring of {stiffness} {stiffness_unit} pulls the axis to zero; add it to the simulator."
    excitation = "move slowly over the whole travel, and swing freely at several amplitudes"
    symptom = "The effort at rest grows in proportion to the position."

    def odds_in(self, constants: Values) -> float:
        """Return even odds where the platform has a spring: catalogues promise its rate to a tenth."""
        return 1.0 if float(constants.get("stiffness", 0.0)) != 0.0 else self.prior_odds

    def stands_for(self, values: Values, constants: Values) -> float:
        """Return the share by which the spring of the platform would be off."""
        known = abs(float(constants.get("stiffness", 0.0)))
        return abs(float(values["stiffness"])) / known if known > 0.0 else math.inf

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the spring's pull on the axis, N·m or N."""
        return on_axis(constants, -values["stiffness"] * signals["position"])
