"""Quantities that several effects of a joint share."""

import torch

from simgap.effects.dry_friction import DryFriction
from simgap.effects.effect import Signals, Values
from simgap.physics.shapes import Channels, Real, Signal


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


def commanded(signals: Signals) -> str:
    """Return the name of the input of the drive: the voltage, else the effort, else what a position loop is told.

    Behind its loop a servo has an effort; before it, the position command alone.
    """
    return next((name for name in ("voltage", "effort") if name in signals), "position_command")


def driven_by(command: Signal, signals: Signals, constants: Values) -> dict[str, Signal]:
    """Return the changed signals behind the nominal motor under another command (...,), V or N·m or N.

    The back-EMF stays: a voltage changes the effort by the stall torque of the change.
    """
    name = commanded(signals)
    if name == "effort":
        return {name: command}
    return {
        name: command,
        "effort": signals["effort"] + effort_per_volt(constants) * (command - signals[name]),
    }


def effort_per_volt(constants: Values) -> Real | float:
    """Return the effort of the nominal motor at standstill per volt, N·m/V or N/V."""
    return constants["torque_constant"] * constants["gear_ratio"] / constants["resistance"]


def back_emf_damping(constants: Values) -> Real | float:
    """Return the effort that the nominal motor loses per velocity by its back-EMF, N·m·s/rad or N·s/m."""
    return effort_per_volt(constants) * constants["torque_constant"] * constants["gear_ratio"]
