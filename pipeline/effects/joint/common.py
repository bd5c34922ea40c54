"""Quantities that several effects of a joint share."""

import torch

from simgap.effects.dry_friction import DryFriction
from simgap.effects.effect import Signals, Values
from simgap.physics.shapes import Channels, Real


class AxisFriction(DryFriction):
    """Dry friction of a joint's axis."""

    kind = "joint"
    acts_on = "torque"
    holds = "axis_load"

    def on_channels(self, friction: Real, signals: Signals, constants: Values) -> Channels:
        """Return the friction on the axis, N·m or N."""
        return on_axis(constants, friction)


def applied(signals: Signals, constants: Values) -> Real:
    """Return the load on friction at standstill (...,), N·m or N: the remaining load, else effort minus known loads."""
    if AxisFriction.holds in signals:
        return signals[AxisFriction.holds]
    position = signals["position"]
    return (
        signals["effort"]
        - constants["gravity_torque"] * torch.sin(position)
        - constants["stiffness"] * position
    )


def on_axis(constants: Values, wrench: Real) -> Channels:
    """Name the joint's only channel."""
    return {constants["channel"]: wrench}
