"""Coulomb friction in the wheels and in the steering of a swerve drive."""

from simgap.effects.dry_friction import dry_friction, sliding_of
from simgap.effects.effect import Parameter, Signals, Values
from simgap.effects.swerve.common import ModuleFriction, WheelFriction, module_load, wheel_load, wheel_speed
from simgap.physics.shapes import PerModule


class DriveCoulombFriction(WheelFriction):
    """A constant friction torque opposes the rotation of each wheel."""

    name = "coulomb_friction"
    drifts = True
    parameters = (Parameter("level", "N·m", 0.5, 0.0, 1e3),)
    formula = "wheel torque = −level · sign(wheel speed); at standstill it holds the motor's torque, up to its level"
    source = "Armstrong-Hélouvry, Dupont & Canudas de Wit 1994, A survey of models for friction, §3"
    sentence = "Dry friction of {level} N·m opposes each driven wheel; add Coulomb friction to the drive."
    excitation = "ramp the voltage slowly forward and backward, through standstill"
    symptom = "The drive torque jumps by twice a constant level when a wheel reverses."
    look_alikes = ("viscous_friction",)

    def friction(self, signals: Signals, values: Values, constants: Values) -> PerModule:
        """Return the friction about each axle, (..., 4) N·m."""
        speed, sliding = wheel_speed(signals, constants), sliding_of(signals, constants, "drive_")
        return dry_friction(values["level"], speed, wheel_load(signals), sliding)


class SteerCoulombFriction(ModuleFriction):
    """A constant friction torque opposes the rotation of each module."""

    name = "coulomb_friction"
    drifts = True
    parameters = (Parameter("level", "N·m", 0.5, 0.0, 1e3),)
    formula = "module torque = −level · sign(module speed); at standstill it holds the motor's torque, up to its level"
    source = DriveCoulombFriction.source
    sentence = (
        "Dry friction of {level} N·m opposes each steering module; add Coulomb friction to the steering."
    )
    excitation = "turn the modules slowly in both directions, through standstill"
    symptom = "The steering torque jumps by twice a constant level when a module reverses."

    def friction(self, signals: Signals, values: Values, constants: Values) -> PerModule:
        """Return the friction on each module, (..., 4) N·m."""
        speed, sliding = signals["steer_velocity"], sliding_of(signals, constants, "steer_")
        return dry_friction(values["level"], speed, module_load(signals, constants), sliding)
