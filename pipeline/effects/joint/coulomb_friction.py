"""Dry friction of a joint."""

from torch import Tensor

from pipeline.effects.dry_friction import dry_friction, sliding_of
from pipeline.effects.effect import Parameter, Signals, Values, WrenchEffect
from pipeline.effects.joint.common import applied, on_axis


class CoulombFriction(WrenchEffect):
    """Constant friction against the direction of motion."""

    linear = False
    name = "coulomb_friction"
    kind = "joint"
    acts_on = "torque"
    parameters = (Parameter("level", "N·m", 0.1, 0.0, 1e4),)
    needs = ("velocity", "effort")
    formula = "torque = −level · sign(velocity); at standstill it holds whatever is applied, up to its level"
    source = "Armstrong-Hélouvry, Dupont & Canudas de Wit 1994, A survey of models for friction, §3"
    sentence = "Dry friction holds the axis back with {level} {level_unit} either way; add Coulomb friction."
    excitation = "slow ramps in both directions, through standstill"

    def wrench(self, signals: Signals, values: Values, constants: Values) -> dict[str, Tensor]:
        """Return the friction on the axis, N·m or N."""
        load = applied(signals, constants)
        friction = dry_friction(values["level"], signals["velocity"], load, sliding_of(signals, constants))
        return on_axis(constants, friction)
