"""What is believed of an effect before anything was recorded: whether it is there, and how large it may be."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor

from simgap.effects import Effect, Parameter, ParameterError, WrenchEffect
from simgap.equations.fit import Fit
from simgap.gap.scales import Scales
from simgap.simulation import FittedEffect

_FREEDOM = 3.0
"""Degrees of freedom of Student's t: a value of several widths is improbable and not impossible."""
_RATIO_WIDTH = 0.3
"""Of the logarithm of a ratio that is no number of the platform, such as that of two time constants."""
_SHAPE_WIDTH = 1.0
"""Of the logarithm of a limit, or of a length, speed or time at which a law bends: its decade is known."""
_DEFAULTS = 2.0
"""Widths in realistic sizes, where the recording says nothing about a parameter's unit."""


@dataclass(frozen=True)
class Density:
    """The prior density of one parameter.

    Attributes:
        family: `t` (Student, of a size), `log` (log-normal, of a ratio or a shape), `normal` or `uniform` (of a share).
        centre: its middle, in the parameter's unit.
        width: in the parameter's unit, or of the logarithm.
        sided: whether it lies on one side of the centre only.
    """

    family: str
    centre: float
    width: float
    sided: bool = False

    def log(self, value: float) -> float:
        """Return the log density at a value, in the parameter's unit."""
        if self.family == "uniform":
            return -math.log(self.width)
        if self.family == "log":
            size = max(value, 1e-12)
            return _log_normal(math.log(size / self.centre) / self.width) - math.log(self.width * size)
        distance = (value - self.centre) / self.width
        shape = _log_student(distance) if self.family == "t" else _log_normal(distance)
        return shape - math.log(self.width) + math.log(2.0) * self.sided

    def precision(self, value: float) -> float:
        """Return the curvature of minus the log density near a value."""
        if self.family == "uniform":
            return 12.0 / self.width**2
        scale = self.width * (max(abs(value), 1e-12) if self.family == "log" else 1.0)
        return scale**-2


def density_of(effect: Effect, parameter: Parameter, scales: Scales) -> Density:
    """Return the prior density of a parameter of an effect, in the sizes of a recording."""
    known = scales.of(parameter.unit)
    is_ratio = parameter.unit == "1" and parameter.neutral == 1.0 and parameter.low > 0.0
    if isinstance(effect, ParameterError):
        return Density("log", 1.0, effect.spread)
    if is_ratio:
        return Density("log", 1.0, _RATIO_WIDTH)
    if parameter.name == effect.driver_at_rest:
        return Density("normal", *scales.driver(effect, parameter))
    if _is_size(effect, parameter) and not parameter.typical:
        width = known or _DEFAULTS * parameter.usual_in(scales.sizes)
        return Density("t", parameter.neutral, width, parameter.low == parameter.neutral)
    if parameter.unit == "1" and not (parameter.is_limit or parameter.typical):
        return Density("uniform", 0.5, parameter.high - parameter.low)
    size = parameter.usual_in(scales.sizes)
    return Density("log", size if parameter.typical else known or size, _SHAPE_WIDTH)


def densities_of(fitted: FittedEffect, scales: Scales) -> list[Density]:
    """Return the prior density of each parameter of an effect."""
    return [density_of(fitted.effect, parameter, scales) for parameter in fitted.effect.parameters]


def log_prior(fitted: Fit, scales: Scales) -> float:
    """Return the log density of a fit's parameters under their priors, in their units."""
    return sum((density.log(value) for density, value in _priors(fitted, scales)), 0.0)


def prior_precision(fitted: Fit, scales: Scales) -> Tensor:
    """Return the curvature of the priors at a fit's parameters, (parameters,)."""
    precision = [density.precision(value) for density, value in _priors(fitted, scales)]
    return torch.tensor(precision, dtype=torch.float64)


def log_odds(effect: Effect, constants: Mapping[str, Any]) -> float:
    """Return the log prior odds of an effect being there, beside what a platform says."""
    return math.log(effect.odds_in(constants))


def _priors(fitted: Fit, scales: Scales) -> list[tuple[Density, float]]:
    return [
        (density, float(value))
        for f in fitted.simulator.free
        for density, value in zip(densities_of(f, scales), f.values.values(), strict=True)
    ]


def _is_size(effect: Effect, parameter: Parameter) -> bool:
    """Whether a parameter says how much of an effect there is, not where its law bends or cuts off."""
    if parameter.is_limit:
        return False
    linear = isinstance(effect, WrenchEffect) and effect.linear
    return linear or parameter is effect.parameters[0] or parameter.neutral == 0.0


def _log_student(distance: float) -> float:
    peak = (
        math.lgamma((_FREEDOM + 1.0) / 2.0) - math.lgamma(_FREEDOM / 2.0) - 0.5 * math.log(_FREEDOM * math.pi)
    )
    return peak - 0.5 * (_FREEDOM + 1.0) * math.log1p(distance**2 / _FREEDOM)


def _log_normal(distance: float) -> float:
    return -0.5 * distance**2 - 0.5 * math.log(2.0 * math.pi)
