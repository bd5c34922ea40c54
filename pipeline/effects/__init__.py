"""Floor 3: the catalogue of physics that the tool can name, one file per effect."""

from simgap.effects.catalogue import effect_by_key, effects_of, kinds, look_alikes_of
from simgap.effects.dry_friction import DryFriction
from simgap.effects.effect import (
    ActuatorEffect,
    CommandEffect,
    ConstantEffect,
    Effect,
    MeasurementEffect,
    Parameter,
    ParameterError,
    WrenchEffect,
)

__all__ = [
    "ActuatorEffect",
    "CommandEffect",
    "ConstantEffect",
    "DryFriction",
    "Effect",
    "MeasurementEffect",
    "Parameter",
    "ParameterError",
    "WrenchEffect",
    "effect_by_key",
    "effects_of",
    "kinds",
    "look_alikes_of",
]
