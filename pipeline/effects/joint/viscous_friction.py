"""Friction of a joint in proportion to its velocity."""

import math

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.joint.common import on_axis
from simgap.physics.shapes import Channels


class ViscousFriction(WrenchEffect):
    """Friction grows in proportion to the velocity."""

    name = "viscous_friction"
    drifts = True
    kind = "joint"
    acts_on = "torque"
    parameters = (Parameter("coefficient", "N·m·s/rad", 0.01, 0.0, 1e4),)
    prior_odds = 1.0
    needs = ("velocity",)
    formula = "torque = −coefficient · velocity"
    source = "Armstrong-Hélouvry, Dupont & Canudas de Wit 1994, A survey of models for friction, §3"
    sentence = (
        "Friction grows with the speed by {coefficient} {coefficient_unit}; add viscous friction to the "
        "simulator."
    )
    excitation = "hold constant speeds over the whole range, in both directions"
    symptom = "The effort at constant speed rises linearly with the speed."

    def stands_for(self, values: Values, constants: Values) -> float:
        """Return the share of the derivative gain of a position loop, which brakes in the same way."""
        gain = float(constants.get("derivative", 0.0))
        return float(values["coefficient"]) / gain if gain > 0.0 else math.inf

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the friction on the axis, N·m or N."""
        return on_axis(constants, -values["coefficient"] * signals["velocity"])
