"""Constant load on a joint."""

import torch

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.joint.common import on_axis
from simgap.physics.shapes import Channels


class ConstantLoad(WrenchEffect):
    """A constant load acts on the axis, such as a weight, a spring or a drive offset."""

    name = "constant_load"
    kind = "joint"
    acts_on = "torque"
    parameters = (Parameter("load", "N·m", 0.1, -1e6, 1e6),)
    needs = ("position",)
    formula = "torque = load"
    source = "Newton's second law"
    sentence = (
        "A constant load of {load} {load_unit} acts on the axis, where positive means forward; add it to the "
        "simulator."
    )
    excitation = "run the same motion in both directions, and rest without a command"
    symptom = "The effort has the same offset at every position and speed."
    look_alikes = ("asymmetric_friction", "coulomb_friction", "gravity_load")

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the load on the axis, N·m or N."""
        return on_axis(constants, values["load"] * torch.ones_like(signals["position"]))
