"""Friction in proportion to speed in a swerve drive's wheels and in its steering."""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.swerve.common import on_modules, on_wheels, wheel_speed
from simgap.physics.shapes import Channels


class DriveViscousFriction(WrenchEffect):
    """Friction in proportion to each wheel's speed."""

    name = "viscous_friction"
    kind = "swerve"
    acts_on = "drive"
    parameters = (Parameter("coefficient", "N·m·s/rad", 0.02, 0.0, 1e2),)
    formula = "wheel torque = −coefficient · wheel speed"
    source = "Armstrong-Hélouvry, Dupont & Canudas de Wit 1994, A survey of models for friction, §3"
    sentence = "Friction in each driven wheel grows by {coefficient} N·m per rad/s; add viscous friction to the drive."
    excitation = "hold constant speeds over the whole range, forward and backward"

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the friction summed on the chassis."""
        return on_wheels(-values["coefficient"] * wheel_speed(signals, constants), signals, constants)


class SteerViscousFriction(WrenchEffect):
    """Friction in proportion to each module's turning speed."""

    name = "viscous_friction"
    kind = "swerve"
    acts_on = "steer"
    parameters = (Parameter("coefficient", "N·m·s/rad", 0.05, 0.0, 1e2),)
    formula = "module torque = −coefficient · module speed"
    source = DriveViscousFriction.source
    sentence = (
        "Friction in each steering module grows by {coefficient} N·m per rad/s; add it to the steering."
    )
    excitation = "turn the modules at several constant speeds"

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the friction on each module, N·m."""
        return on_modules(-values["coefficient"] * signals["steer_velocity"])
