"""Aerodynamic damping of the body rate."""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import along_axes
from simgap.physics.shapes import Channels


class AngularDrag(WrenchEffect):
    """A torque in proportion to the body rate opposes it."""

    name = "angular_drag"
    kind = "quadrotor"
    acts_on = "torque"
    parameters = (Parameter("coefficient", "N·m·s/rad", 1e-3, 0.0, 1.0),)
    needs = ("body_rate",)
    formula = "τ = −coefficient · ω"
    source = "Bouabdallah & Siegwart 2007, Full control of a quadrotor, §II"
    sentence = (
        "The air opposes rotation with {coefficient} N·m per rad/s of body rate; add angular drag to the "
        "simulator."
    )
    excitation = "roll, pitch and yaw at several constant rates"
    symptom = "A constant body rate needs a torque that grows with the rate."

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the torque, N·m."""
        return along_axes("torque", -values["coefficient"] * signals["body_rate"])
