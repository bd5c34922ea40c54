"""A load on a joint that is the same everywhere."""

import torch

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.joint.common import on_axis
from simgap.physics.shapes import Channels


class ConstantLoad(WrenchEffect):
    """A weight on a slide or a pulley, a constant-force spring, an offset of the drive."""

    name = "constant_load"
    kind = "joint"
    acts_on = "torque"
    parameters = (Parameter("load", "N·m", 0.1, -1e4, 1e4),)
    needs = ("position",)
    yields_to = ("coulomb_friction",)
    twins = ("asymmetric_friction",)
    formula = "torque = load"
    source = "Newton's second law"
    sentence = (
        "A constant {load} {load_unit} acts on the axis, a positive one in the positive direction; add it to the "
        "simulator."
    )
    excitation = "the same motion in both directions, and rests without a command"

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the load on the axis, N·m or N."""
        return on_axis(constants, values["load"] * torch.ones_like(signals["position"]))
