"""Dry friction in a swerve drive's wheels and in its steering."""

from simgap.effects.dry_friction import dry_friction, sliding_of
from simgap.effects.effect import Parameter, Signals, Values
from simgap.effects.swerve.common import ModuleFriction, WheelFriction, module_load, wheel_load, wheel_speed
from simgap.physics.shapes import PerModule


class DriveCoulombFriction(WheelFriction):
    """Constant friction against each wheel's rotation."""

    name = "coulomb_friction"
    parameters = (Parameter("level", "N·m", 0.5, 0.0, 1e3),)
    formula = "wheel torque = −level · sign(wheel speed); at standstill it holds the motor's torque, up to its level"
    source = "Armstrong-Hélouvry, Dupont & Canudas de Wit 1994, A survey of models for friction, §3"
    sentence = (
        "Dry friction holds each driven wheel back with {level} N·m; add Coulomb friction to the drive."
    )
    excitation = "slow voltage ramps forward and backward, through standstill"

    def friction(self, signals: Signals, values: Values, constants: Values) -> PerModule:
        """Return the friction about each axle, (..., 4) N·m."""
        speed, sliding = wheel_speed(signals, constants), sliding_of(signals, constants, "drive_")
        return dry_friction(values["level"], speed, wheel_load(signals), sliding)


class SteerCoulombFriction(ModuleFriction):
    """Constant friction against each module's turning."""

    name = "coulomb_friction"
    parameters = (Parameter("level", "N·m", 0.5, 0.0, 1e3),)
    formula = "module torque = −level · sign(module speed); at standstill it holds the motor's torque, up to its level"
    source = DriveCoulombFriction.source
    sentence = (
        "Dry friction holds each steering module back with {level} N·m; add Coulomb friction to the steering."
    )
    excitation = "turn the modules slowly to and fro, through standstill"

    def friction(self, signals: Signals, values: Values, constants: Values) -> PerModule:
        """Return the friction on each module, (..., 4) N·m."""
        speed, sliding = signals["steer_velocity"], sliding_of(signals, constants, "steer_")
        return dry_friction(values["level"], speed, module_load(signals, constants), sliding)
