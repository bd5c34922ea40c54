"""Dry friction of a joint that differs between the two directions of motion.

`coulomb_friction` is the level that both directions share. A `constant_load` of half the difference, together with
half of the difference as additional Coulomb friction, gives the same torque in motion and at rest.
"""

import torch

from simgap.effects.dry_friction import dry_friction, sliding_of
from simgap.effects.effect import Parameter, Signals, Values
from simgap.effects.joint.common import AxisFriction, applied
from simgap.physics.shapes import Real


class AsymmetricFriction(AxisFriction):
    """Dry friction is larger in one direction of motion than in the other."""

    name = "asymmetric_friction"
    parameters = (Parameter("difference", "N·m", 0.05, -1e6, 1e6),)
    needs = ("velocity", "effort")
    kinked = True
    formula = "torque = −difference where sign(velocity) = sign(difference), else 0; at standstill it holds that way"
    source = "Armstrong-Hélouvry, Dupont & Canudas de Wit 1994, A survey of models for friction, §3"
    sentence = (
        "Dry friction is {difference} {difference_unit} larger forward than backward; add this difference to "
        "the simulator."
    )
    excitation = (
        "run the same slow ramps in both directions, then repeat them with the axis mounted the other way "
        "round"
    )
    symptom = "The effort that the same slow speed needs differs between the two directions."
    look_alikes = ("coulomb_friction", "constant_load")

    def starts(self) -> list[dict[str, float]]:
        """Start on either side of zero, where the law has a kink."""
        return [{"difference": -1e-3}, {"difference": 1e-3}]

    def friction(self, signals: Signals, values: Values, constants: Values) -> Real:
        """Return the friction on the axis, N·m or N."""
        velocity, load = signals["velocity"], applied(signals, constants)
        difference = torch.as_tensor(values["difference"], dtype=velocity.dtype)
        forward, backward = difference.clamp_min(0.0), (-difference).clamp_min(0.0)
        return dry_friction(forward, velocity, load, sliding_of(signals, constants), backward)
