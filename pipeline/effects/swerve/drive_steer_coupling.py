"""Gear coupling between the steering and the drive of a swerve module."""

from typing import Any

from simgap.effects.effect import ConstantEffect, Parameter, Values


class DriveSteerCoupling(ConstantEffect):
    """A turning module also turns its drive motor, whose torque acts back on the module."""

    name = "drive_steer_coupling"
    kind = "swerve"
    acts_on = "drive"
    names_its_subject = True
    parameters = (Parameter("ratio", "1", 3.0, -50.0, 50.0),)
    formula = (
        "motor speed = gear_ratio · wheel speed + ratio · module rate; module torque += ratio · motor torque"
    )
    source = "virtual work of a coaxial gear train; Müller 1982, Epicyclic drive trains, §2"
    sentence = (
        "Each turn of a module turns its drive motor by {ratio} turns; couple the drive to the steering in "
        "the simulator."
    )
    excitation = "accelerate hard while the modules turn freely, and turn the modules on the spot"
    symptom = "The drive motor turns when the module turns, although the wheel does not roll."

    def adjust(self, constants: Values, values: Values) -> dict[str, Any]:
        """Return the constants with the coupling's ratio."""
        return {**constants, "coupling_ratio": values["ratio"]}
