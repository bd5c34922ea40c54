"""Friction of a joint in proportion to the square of its velocity."""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.joint.common import on_axis
from simgap.physics.shapes import Channels


class QuadraticFriction(WrenchEffect):
    """Friction grows with the square of the velocity, as in air, in a pump or in churned grease."""

    name = "quadratic_friction"
    kind = "joint"
    acts_on = "torque"
    parameters = (Parameter("coefficient", "N·m·s²/rad²", 1e-3, 0.0, 1e4),)
    needs = ("velocity",)
    formula = "torque = −coefficient · velocity · |velocity|"
    source = "Schlichting & Gersten 2017, Boundary-layer theory: discs that turn in a fluid"
    sentence = (
        "Friction grows with the square of the speed by {coefficient} {coefficient_unit}; add quadratic "
        "friction to the simulator."
    )
    excitation = "hold constant speeds up to the highest, in both directions"
    symptom = "The effort at constant speed curves upward with the speed."
    look_alikes = ("viscous_friction",)

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the friction on the axis, N·m or N."""
        velocity = signals["velocity"]
        return on_axis(constants, -values["coefficient"] * velocity * velocity.abs())
