"""Viscous friction in the wheels and in the steering of a swerve drive."""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.swerve.common import on_modules, on_wheels, wheel_speed
from simgap.physics.shapes import Channels


class DriveViscousFriction(WrenchEffect):
    """Friction grows in proportion to each wheel's speed."""

    name = "viscous_friction"
    drifts = True
    kind = "swerve"
    acts_on = "drive"
    parameters = (Parameter("coefficient", "N·m·s/rad", 0.02, 0.0, 1e2),)
    formula = "wheel torque = −coefficient · wheel speed"
    source = "Armstrong-Hélouvry, Dupont & Canudas de Wit 1994, A survey of models for friction, §3"
    sentence = "Friction in each driven wheel grows by {coefficient} N·m per rad/s; add viscous friction to the drive."
    excitation = "hold constant speeds over the whole range, forward and backward"
    symptom = "The drive torque at constant speed rises linearly with the speed."

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the friction summed on the chassis."""
        return on_wheels(-values["coefficient"] * wheel_speed(signals, constants), signals, constants)


class SteerViscousFriction(WrenchEffect):
    """Friction grows in proportion to each module's speed."""

    name = "viscous_friction"
    drifts = True
    kind = "swerve"
    acts_on = "steer"
    parameters = (Parameter("coefficient", "N·m·s/rad", 0.05, 0.0, 1e2),)
    formula = "module torque = −coefficient · module speed"
    source = DriveViscousFriction.source
    sentence = (
        "Friction in each steering module grows by {coefficient} N·m per rad/s; add viscous friction to the "
        "steering."
    )
    excitation = "turn the modules at several constant speeds"
    symptom = "The steering torque at constant speed rises linearly with the speed."

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the friction on each module, N·m."""
        return on_modules(-values["coefficient"] * signals["steer_velocity"])
