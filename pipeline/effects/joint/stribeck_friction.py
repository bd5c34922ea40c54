"""Dry friction of a joint that is greater the slower it moves."""

import torch

from simgap.effects.dry_friction import dry_friction, fades, sliding_of
from simgap.effects.effect import Parameter, Signals, Values
from simgap.effects.joint.common import AxisFriction, applied
from simgap.effects.scan import scan
from simgap.physics.shapes import Real


class StribeckFriction(AxisFriction):
    """What breaking away takes beyond Coulomb friction, and how fast it fades with speed."""

    name = "stribeck_friction"
    parameters = (
        Parameter("extra_level", "N·m", 0.1, 0.0, 1e4),
        Parameter("velocity", "rad/s", 0.5, 1e-4, 1e3, neutral=1.0),
    )
    needs = ("velocity", "effort")
    yields_to = ("coulomb_friction",)
    formula = (
        "torque = −extra_level · exp(−(v / velocity)²) · sign(v); at standstill it holds, up to extra_level"
    )
    source = "Armstrong-Hélouvry, Dupont & Canudas de Wit 1994, A survey of models for friction"
    sentence = (
        "Breaking away takes {extra_level} {extra_level_unit} more than sliding, which fades over {velocity} "
        "{velocity_unit}; add Stribeck friction."
    )
    excitation = "very slow ramps through standstill, and constant crawling speeds in both directions"

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan: the speed at which it fades has no slope where nothing fades."""
        return scan(extra_level=(0.01, 0.1, 1.0, 10.0), velocity=(0.03, 0.3, 3.0))

    def limit(self, values: Values, signals: Signals, constants: Values) -> str:
        """Friction that does not fade within the recorded speeds, or only where their sign is open, is Coulomb's."""
        slides = sliding_of(signals, constants)
        return "" if fades(signals["velocity"], values["velocity"], slides) else "coulomb_friction"

    def friction(self, signals: Signals, values: Values, constants: Values) -> Real:
        """Return the friction on the axis, N·m or N."""
        velocity = signals["velocity"]
        level = values["extra_level"] * torch.exp(-(velocity / values["velocity"]).square())
        load = applied(signals, constants)
        return dry_friction(level, velocity, load, sliding_of(signals, constants))
