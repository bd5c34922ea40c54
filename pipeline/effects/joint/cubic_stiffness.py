"""Spring on a joint whose stiffness grows with its deflection."""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.joint.common import on_axis
from simgap.physics.shapes import Channels


class CubicStiffness(WrenchEffect):
    """A spring force grows with the cube of the position (Duffing spring), or softens if negative."""

    name = "cubic_stiffness"
    kind = "joint"
    acts_on = "torque"
    parameters = (Parameter("stiffness", "N·m/rad³", 0.3, -1e9, 1e9),)
    needs = ("position",)
    formula = "torque = −stiffness · position³"
    source = "Kovacic & Brennan 2011, The Duffing equation"
    sentence = (
        "A spring force grows with the cube of the deflection by {stiffness} {stiffness_unit}; add cubic "
        "stiffness to the simulator."
    )
    excitation = "let the axis swing freely at several amplitudes, up to the ends of the travel"
    symptom = "The frequency of free swings changes with their amplitude."
    look_alikes = ("linear_stiffness", "gravity_load")

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the spring's pull on the axis, N·m or N."""
        return on_axis(constants, -values["stiffness"] * signals["position"].pow(3))
