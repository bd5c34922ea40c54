"""Dry friction of a joint in proportion to the load that its gear transmits."""

from simgap.effects.dry_friction import dry_friction, sliding_of
from simgap.effects.effect import Parameter, Signals, Values
from simgap.effects.joint.common import AxisFriction, applied
from simgap.physics.shapes import Real

_GREATEST_RATIO = 0.9  # a gear that loses nearly all of its load does not turn; another law applies there


class LoadDependentFriction(AxisFriction):
    """The gear loses a fraction of the effort that it transmits."""

    name = "load_dependent_friction"
    parameters = (Parameter("ratio", "1", 0.2, 0.0, _GREATEST_RATIO),)
    needs = ("velocity", "effort")
    takes_share = True
    formula = "torque = −ratio · |effort| · sign(velocity); at standstill it holds, up to ratio · |effort|"
    source = (
        "Duclusaud et al. 2024, Extended friction models for the physics simulation of servo actuators "
        "(arXiv 2410.08650)"
    )
    sentence = (
        "The gear loses a fraction {ratio} of the load that it transmits; add load-dependent friction to the "
        "simulator."
    )
    excitation = "repeat the same slow motion under several loads, lifting and lowering"
    symptom = "Friction is larger where the axis carries more load."
    look_alikes = ("coulomb_friction",)

    def friction(self, signals: Signals, values: Values, constants: Values) -> Real:
        """Return the friction on the axis, N·m or N."""
        level = values["ratio"] * signals["effort"].abs()
        load = applied(signals, constants)
        return dry_friction(level, signals["velocity"], load, sliding_of(signals, constants))
