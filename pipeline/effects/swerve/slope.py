"""Floor that is not level."""

import torch

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.physics.shapes import Channels


class Slope(WrenchEffect):
    """The weight pulls the robot downhill in one world direction, at any heading."""

    name = "slope"
    kind = "swerve"
    acts_on = "chassis"
    parameters = (Parameter("rise_x", "1", 0.05, -0.7, 0.7), Parameter("rise_y", "1", 0.05, -0.7, 0.7))
    needs = ("heading",)
    formula = (
        "force = −mass · gravity · (rise_x, rise_y): sines of the climb along where the robot faced at the start of a "
        "run, and to its left"
    )
    source = "statics of an inclined plane"
    sentence = (
        "The floor rises by {rise_x} along the robot's first heading and by {rise_y} to its left; level the "
        "floor or tilt it in the simulator."
    )
    excitation = "drive back and forth along two different lines, always from the same first heading"
    symptom = "Drives in one world direction need more torque than drives in the opposite direction."

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the downhill pull in the robot's frame, N."""
        cosine, sine = torch.cos(signals["heading"]), torch.sin(signals["heading"])
        weight = constants["mass"] * constants["gravity"]
        return {
            "drive_x": -weight * (values["rise_x"] * cosine + values["rise_y"] * sine),
            "drive_y": -weight * (values["rise_y"] * cosine - values["rise_x"] * sine),
        }
