"""A weight on a turning joint.

`sine` is the part of a joint whose zero hangs down, `cosine` that of one whose zero is level. A sliding axis has none:
there gravity is a constant load.
"""

import torch

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.joint.common import on_axis
from simgap.physics.shapes import Channels


class GravityLoad(WrenchEffect):
    """The pull of a weight beyond what the platform file has, wherever the joint's zero points."""

    name = "gravity_load"
    kind = "joint"
    acts_on = "torque"
    parameters = (
        Parameter("sine", "N·m", 0.3, -1e4, 1e4),
        Parameter("cosine", "N·m", 0.1, -1e4, 1e4),
    )
    needs = ("position",)
    formula = "torque = −sine · sin(position) − cosine · cos(position)"
    source = "the pendulum's equation"
    sentence = (
        "A weight pulls on the joint with {sine} {sine_unit} (sine of the position) and {cosine} {cosine_unit} "
        "(cosine); add it to the simulator."
    )
    excitation = "slow motion through the whole turn, or rests at many angles"

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the weight's torque, N·m."""
        position = signals["position"]
        if constants["channel"] != "torque":
            return on_axis(constants, torch.zeros_like(position))
        pull = values["sine"] * torch.sin(position) + values["cosine"] * torch.cos(position)
        return on_axis(constants, -pull)
