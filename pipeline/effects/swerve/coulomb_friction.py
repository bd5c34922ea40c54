"""Dry friction in a swerve drive's wheels and in its steering."""

from torch import Tensor

from pipeline.effects.dry_friction import dry_friction, sliding_of
from pipeline.effects.effect import Parameter, Signals, Values, WrenchEffect
from pipeline.effects.swerve.common import on_modules, on_wheels, steering_torque, wheel_speed


class DriveCoulombFriction(WrenchEffect):
    """Constant friction against each wheel's rotation."""

    linear = False
    name = "coulomb_friction"
    kind = "swerve"
    acts_on = "drive"
    parameters = (Parameter("level", "N·m", 0.5, 0.0, 1e3),)
    formula = "wheel torque = −level · sign(wheel speed); at standstill it holds the motor's torque, up to its level"
    source = "Armstrong-Hélouvry, Dupont & Canudas de Wit 1994, A survey of models for friction, §3"
    sentence = (
        "Dry friction holds each driven wheel back with {level} N·m; add Coulomb friction to the drive."
    )
    excitation = "slow voltage ramps forward and backward, through standstill"

    def wrench(self, signals: Signals, values: Values, constants: Values) -> dict[str, Tensor]:
        """Return the friction summed on the chassis."""
        speed, sliding = wheel_speed(signals, constants), sliding_of(signals, constants, "drive_")
        return on_wheels(
            dry_friction(values["level"], speed, signals["drive_torque"], sliding), signals, constants
        )


class SteerCoulombFriction(WrenchEffect):
    """Constant friction against each module's turning."""

    linear = False
    name = "coulomb_friction"
    kind = "swerve"
    acts_on = "steer"
    parameters = (Parameter("level", "N·m", 0.5, 0.0, 1e3),)
    formula = "module torque = −level · sign(module speed); at standstill it holds the motor's torque, up to its level"
    source = DriveCoulombFriction.source
    sentence = (
        "Dry friction holds each steering module back with {level} N·m; add Coulomb friction to the steering."
    )
    excitation = "turn the modules slowly to and fro, through standstill"

    def wrench(self, signals: Signals, values: Values, constants: Values) -> dict[str, Tensor]:
        """Return the friction on each module, N·m."""
        speed, sliding = signals["steer_velocity"], sliding_of(signals, constants, "steer_")
        applied = steering_torque(signals, constants)
        return on_modules(dry_friction(values["level"], speed, applied, sliding))
