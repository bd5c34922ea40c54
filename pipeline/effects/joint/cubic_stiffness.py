"""A spring on a joint that stiffens with its deflection."""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.joint.common import on_axis
from simgap.physics.shapes import Channels


class CubicStiffness(WrenchEffect):
    """The Duffing spring's cubic part; negative where the spring softens."""

    name = "cubic_stiffness"
    kind = "joint"
    acts_on = "torque"
    parameters = (Parameter("stiffness", "N·m/rad³", 0.3, -1e9, 1e9),)
    needs = ("position",)
    formula = "torque = −stiffness · position³"
    source = "Kovacic & Brennan 2011, The Duffing equation"
    sentence = "A spring stiffens with the cube of its deflection by {stiffness} {stiffness_unit}; add cubic stiffness."
    excitation = "free swings of several amplitudes up to the ends of the travel"

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the spring's pull on the axis, N·m or N."""
        return on_axis(constants, -values["stiffness"] * signals["position"].pow(3))
