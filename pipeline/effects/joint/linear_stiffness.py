"""A spring on a joint."""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.joint.common import on_axis
from simgap.physics.shapes import Channels


class LinearStiffness(WrenchEffect):
    """Stiffness beyond what the platform file has; negative where the file has too much."""

    name = "linear_stiffness"
    kind = "joint"
    acts_on = "torque"
    parameters = (Parameter("stiffness", "N·m/rad", 0.3, -1e6, 1e6),)
    needs = ("position",)
    formula = "torque = −stiffness · position"
    source = "Hooke's law"
    sentence = "A spring of {stiffness} {stiffness_unit} pulls the axis to zero; add it to the simulator."
    excitation = "slow motion over the whole travel, and free swings of several amplitudes"

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the spring's pull on the axis, N·m or N."""
        return on_axis(constants, -values["stiffness"] * signals["position"])
