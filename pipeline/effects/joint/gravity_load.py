"""Gravity torque on a rotary joint.

`sine` is the part for a joint whose zero points straight down, `cosine` the part for one whose zero is horizontal. A
sliding axis has neither: there, gravity is a constant load.
"""

import math

import torch

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.joint.common import on_axis
from simgap.physics.shapes import Channels


class GravityLoad(WrenchEffect):
    """A weight pulls on the joint beyond what the platform file says, whatever the zero position."""

    name = "gravity_load"
    kind = "joint"
    acts_on = "torque"
    parameters = (
        Parameter("sine", "N·m", 0.3, -1e6, 1e6),
        Parameter("cosine", "N·m", 0.1, -1e6, 1e6),
    )
    needs = ("position",)
    formula = "torque = −sine · sin(position) − cosine · cos(position)"
    source = "the pendulum's equation"
    sentence = (
        "A weight pulls on the joint with {sine} {sine_unit} (sine of the position) and {cosine} "
        "{cosine_unit} (cosine); add it to the simulator."
    )
    excitation = "turn slowly through the whole range, or rest at many angles"
    symptom = "The effort at rest varies with the angle, once per turn."
    look_alikes = ("constant_load", "linear_stiffness")

    def odds_in(self, constants: Values) -> float:
        """Return even odds where the platform has a weight: what a drawing says of it is off by some percent."""
        return 1.0 if float(constants.get("gravity_torque", 0.0)) != 0.0 else self.prior_odds

    def stands_for(self, values: Values, constants: Values) -> float:
        """Return the share by which the weight of the platform would be off."""
        known = abs(float(constants.get("gravity_torque", 0.0)))
        size = math.hypot(float(values["sine"]), float(values["cosine"]))
        return size / known if known > 0.0 else math.inf

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the weight's torque, N·m."""
        position = signals["position"]
        if constants["channel"] != "torque":
            return on_axis(constants, torch.zeros_like(position))
        pull = values["sine"] * torch.sin(position) + values["cosine"] * torch.cos(position)
        return on_axis(constants, -pull)
