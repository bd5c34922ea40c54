"""Coulomb friction of a joint."""

from simgap.effects.dry_friction import dry_friction, sliding_of
from simgap.effects.effect import Parameter, Signals, Values
from simgap.effects.joint.common import AxisFriction, applied
from simgap.physics.shapes import Real


class CoulombFriction(AxisFriction):
    """A constant friction opposes the direction of motion."""

    name = "coulomb_friction"
    drifts = True
    parameters = (Parameter("level", "N·m", 0.1, 0.0, 1e6),)
    prior_odds = 1.0
    needs = ("velocity", "effort")
    formula = "torque = −level · sign(velocity); at standstill it holds whatever is applied, up to its level"
    source = "Armstrong-Hélouvry, Dupont & Canudas de Wit 1994, A survey of models for friction, §3"
    sentence = (
        "Dry friction of {level} {level_unit} opposes motion in both directions; add Coulomb friction to the "
        "simulator."
    )
    excitation = "run slow ramps in both directions, through standstill"
    symptom = "The effort jumps by twice a constant level when the velocity changes sign."

    def friction(self, signals: Signals, values: Values, constants: Values) -> Real:
        """Return the friction on the axis, N·m or N."""
        load = applied(signals, constants)
        return dry_friction(values["level"], signals["velocity"], load, sliding_of(signals, constants))
