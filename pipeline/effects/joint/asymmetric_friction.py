"""Dry friction of a joint that is greater one way than the other.

Coulomb friction is the level that both directions share. A constant load of half the difference, with half of it more
Coulomb friction, does the same, in motion and at rest, where friction holds the load too.
"""

import torch

from simgap.effects.dry_friction import dry_friction, sliding_of
from simgap.effects.effect import Parameter, Signals, Values
from simgap.effects.joint.common import AxisFriction, applied
from simgap.physics.shapes import Real


class AsymmetricFriction(AxisFriction):
    """What dry friction is greater by in one direction of motion: in the direction of its sign."""

    name = "asymmetric_friction"
    parameters = (Parameter("difference", "N·m", 0.05, -1e4, 1e4),)
    needs = ("velocity", "effort")
    yields_to = ("coulomb_friction", "constant_load")
    twins = ("constant_load",)
    kinked = True
    formula = "torque = −difference where sign(velocity) = sign(difference), else 0; at standstill it holds that way"
    source = "Armstrong-Hélouvry, Dupont & Canudas de Wit 1994, A survey of models for friction, §3"
    sentence = (
        "Dry friction is {difference} {difference_unit} greater forward than backward; add the difference of the "
        "two directions."
    )
    excitation = "the same slow ramps in both directions, and again with the axis mounted the other way round"

    def starts(self) -> list[dict[str, float]]:
        """Start on either side of none: which direction it is slowed in has no slope at zero."""
        return [{"difference": -1e-3}, {"difference": 1e-3}]

    def friction(self, signals: Signals, values: Values, constants: Values) -> Real:
        """Return the friction on the axis, N·m or N."""
        velocity, load = signals["velocity"], applied(signals, constants)
        difference = torch.as_tensor(values["difference"], dtype=velocity.dtype)
        forward, backward = difference.clamp_min(0.0), (-difference).clamp_min(0.0)
        return dry_friction(forward, velocity, load, sliding_of(signals, constants), backward)
