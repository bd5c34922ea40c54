"""Gears through which a module that turns also turns its wheel."""

from typing import Any

from simgap.effects.effect import ConstantEffect, Parameter, Values


class DriveSteerCoupling(ConstantEffect):
    """The drive shaft runs along the steering axis: turning the module turns the motor, whose torque turns it."""

    name = "drive_steer_coupling"
    kind = "swerve"
    acts_on = "drive"
    parameters = (Parameter("ratio", "1", 3.0, -50.0, 50.0),)
    formula = (
        "motor speed = gear_ratio · wheel speed + ratio · module rate; module torque += ratio · motor torque"
    )
    source = "virtual work of a coaxial gear train; Müller 1982, Epicyclic drive trains, §2"
    sentence = (
        "Each turn of a module turns its drive motor by {ratio} turns, and the motor pushes back on the module; couple "
        "the drive to the steering."
    )
    excitation = "accelerate hard while the modules turn freely, and turn the modules on the spot"

    def adjust(self, constants: Values, values: Values) -> dict[str, Any]:
        """Return the constants with the coupling's ratio."""
        return {**constants, "coupling_ratio": values["ratio"]}
