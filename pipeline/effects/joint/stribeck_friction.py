"""Dry friction of a joint that fades as the velocity grows (Stribeck effect)."""

import torch

from simgap.effects.dry_friction import dry_friction, sliding_of
from simgap.effects.effect import Parameter, Signals, Values
from simgap.effects.joint.common import AxisFriction, applied
from simgap.effects.scan import scan
from simgap.physics.shapes import Real


class StribeckFriction(AxisFriction):
    """Friction is larger near standstill and fades as the axis moves faster."""

    name = "stribeck_friction"
    parameters = (
        Parameter("extra_level", "N·m", 0.1, 0.0, 1e6),
        Parameter("velocity", "rad/s", 0.5, 1e-4, 1e3, neutral=1.0),
    )
    needs = ("velocity", "effort")
    formula = (
        "torque = −extra_level · exp(−(v / velocity)²) · sign(v); at standstill it holds, up to extra_level"
    )
    source = "Armstrong-Hélouvry, Dupont & Canudas de Wit 1994, A survey of models for friction"
    sentence = (
        "Breakaway takes {extra_level} {extra_level_unit} more than sliding, and the excess fades over "
        "{velocity} {velocity_unit}; add Stribeck friction to the simulator."
    )
    excitation = "ramp very slowly through standstill, and hold crawling speeds in both directions"
    symptom = "The axis sticks, breaks away with a jerk, and then needs less effort (stick-slip)."
    look_alikes = ("coulomb_friction", "hysteresis")

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan: without an excess the fading velocity has no gradient."""
        return scan(extra_level=(0.03, 0.3), velocity=(0.01, 0.04, 0.16, 0.6))

    def friction(self, signals: Signals, values: Values, constants: Values) -> Real:
        """Return the friction on the axis, N·m or N."""
        velocity, slides = signals["velocity"], sliding_of(signals, constants)
        level = values["extra_level"] * torch.exp(-(slides.moving(velocity) / values["velocity"]).square())
        return dry_friction(level, velocity, applied(signals, constants), slides)
