"""Hysteresis of a joint: pre-sliding friction, or a part that yields (Bouc-Wen model, Dahl's where it is symmetric).

The deflection depends on the distance moved and not on the speed, so it follows exactly from the recorded positions.
If the axis moves within a step, the wrench carries the deflection forward from the step's position to the present
one.

Along a way s in one direction, in displacements, the deflection a that counts in that direction has da/ds = 1 − rate·a.
The rate is (1 + asymmetry)/n while a grows (a ≥ 0), and (1 − asymmetry)/n while a is taken back (a < 0). Both have
solutions in closed form. With n = hypot(1 + asymmetry, asymmetry) the level is the force at which a slightly uneven law
settles, so that level and asymmetry are found apart from each other.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import torch
from torch import Tensor

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values, WrenchEffect
from simgap.effects.joint.common import on_axis
from simgap.effects.scan import scan
from simgap.effects.sizes import size_of, sizes_of
from simgap.physics.shapes import Channels, Signal
from simgap.physics.tracing import may_run_compiled

_LEVELS = (
    0.05,
    0.5,
)  # of the typical effort: friction takes some of it, seldom more; the level enters linearly
_PARTS = (
    0.0,
    0.2,
    0.4,
    0.6,
    0.8,
    0.95,
)  # of the way from the least to the greatest displacement, in logarithm
_ASYMMETRIES = (0.0,)
"""Dahl's law: from there steps find the asymmetry, which has a slope wherever there is a level. Starts at -1 and 0.5
beside it led two published recordings to the same values."""
_MOST, _STEEPEST = 1000.0, 30.0
"""As in `simgap.physics.hysteresis_steps`, whose import takes longer than all effects."""
_NEAR_ZERO = 1e-2
"""Argument below which a quotient by it is summed as a series, whose slope is not lost to rounding."""


class Hysteresis(ActuatorEffect, WrenchEffect):
    """Friction builds up over a short distance after each reversal, like a spring that yields (Bouc-Wen model)."""

    remembers = True
    linear = False
    order = 3
    name = "hysteresis"
    kind = "joint"
    acts_on = "torque"
    parameters = (
        Parameter("level", "N·m", 0.1, 0.0, 1e6),
        Parameter("displacement", "rad", 0.05, 1e-5, 10.0, neutral=0.1),
        Parameter("asymmetry", "1", 0.5, -3.0, 3.0, optional=True),
    )
    needs = ("position",)
    formula = (
        "torque = −level · z, dz/dt = (velocity − (|velocity| · z + asymmetry · velocity · |z|) / n) / displacement, "
        "n = hypot(1 + asymmetry, asymmetry)"
    )
    source = (
        "Bouc 1967; Wen 1976, Method for random vibration of hysteretic systems (J. Eng. Mech. Div. 102), exponent 1, "
        "asymmetry = δ/γ; at asymmetry 0 Dahl 1976, Solid friction damping of mechanical vibrations (AIAA J. 14)"
    )
    sentence = (
        "Friction builds up after each reversal like a spring of {level} {level_unit} per {displacement} "
        "{displacement_unit}, with asymmetry {asymmetry}; add hysteresis to the simulator."
    )
    excitation = "swing slowly at several small amplitudes, with many reversals"
    symptom = "Effort over position forms a loop after each reversal, of the same width at any speed."
    look_alikes = ("backlash", "coulomb_friction", "linear_stiffness")

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan: without a level neither displacement nor asymmetry has a gradient."""
        displacements = (0.001, 0.004, 0.015, 0.06, 0.2, 0.8)
        return scan(level=_LEVELS, displacement=displacements, asymmetry=_ASYMMETRIES)

    def starts_in(self, signals: Signals, constants: Values | None = None) -> list[dict[str, float]]:
        """Start between the travel in a sample (shorter is friction) and the whole travel (longer is a spring)."""
        level, displacement, _ = self.parameters_in(signals, constants)
        sizes = sizes_of(self.kind, signals, constants or {})
        position = signals["position"]
        least = max(float(position.diff(dim=1).abs().median()), displacement.low)
        most = max(sizes.get("travel", 1.0), least)
        between = [least * (most / least) ** part for part in _PARTS]
        size = size_of(level.unit, sizes)
        return scan(level=[size * share for share in _LEVELS], displacement=between, asymmetry=_ASYMMETRIES)

    def statement(self, values: Mapping[str, float], position_unit: str = "rad") -> str:
        """Return the sentence with what the force comes to in a long motion."""
        settling, _ = _rates(values["asymmetry"])
        unit = self.units(position_unit)["level"]
        settled = f"settles at {values['level'] / settling:.3g} {unit}" if settling * _MOST > 1.0 else ""
        said = super().statement(values, position_unit)
        return said.replace(";", f", and {settled or 'does not settle'};")

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the deflection (...,), in levels, and its position, rad or m; it starts at zero."""
        position = signals["position"]
        deflection, place = (torch.zeros_like(position), position) if memory is None else memory
        deflection = _deflected(deflection, position - place, values)
        out = {"hysteresis_deflection": deflection, "hysteresis_position": position}
        return out, (deflection, position)

    def along_time(
        self, signals: Signals, values: Values, constants: Values, time_step: float
    ) -> dict[str, Signal]:
        """Return blocks with the deflection.

        Two rates that take turns need a loop over samples. A compiled loop runs on the processor if no gradients are
        asked for.
        """
        position = signals["position"]
        if not may_run_compiled((position,), (values["displacement"], values["asymmetry"])):
            return super().along_time(signals, values, constants, time_step)
        deflection = _deflections(position, values["displacement"], values["asymmetry"])
        return {**signals, "hysteresis_deflection": deflection, "hysteresis_position": position}

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the resistance on the axis (...,), N·m or N."""
        moved = signals["position"] - signals["hysteresis_position"]
        deflection = _deflected(signals["hysteresis_deflection"], moved, values)
        return on_axis(constants, -values["level"] * deflection)


def _rates(asymmetry: Any) -> tuple[Any, Any]:
    """Return the rates of deflections that grow and that are taken back."""
    size = ((1.0 + asymmetry) ** 2 + asymmetry**2) ** 0.5
    return (1.0 + asymmetry) / size, (1.0 - asymmetry) / size


def _deflections(position: Tensor, displacement: float, asymmetry: float) -> Tensor:
    """Return the deflections along positions (blocks, samples), by the compiled loop."""
    from simgap.physics.hysteresis_steps import deflections_along  # its import takes longer than all effects

    place = position.numpy().astype(np.float64)
    travel = np.diff(place, axis=1, prepend=place[:, :1])
    return torch.from_numpy(deflections_along(travel, displacement, asymmetry)).to(position.dtype)


def _deflected(deflection: Tensor, travel: Tensor, values: Values) -> Tensor:
    """Return the deflection (...,) after a travel (...,), rad or m, in one direction."""
    if not may_run_compiled((deflection, travel), (values["displacement"], values["asymmetry"])):
        return _deflected_by_tensors(deflection, travel, values)
    from simgap.physics.hysteresis_steps import deflections_after  # its import takes longer than all effects

    held, moved = (each.double().contiguous().numpy().ravel() for each in (deflection, travel))
    after = deflections_after(held, moved, values["displacement"], values["asymmetry"])
    return torch.from_numpy(after).reshape(travel.shape).to(travel.dtype)


def _deflected_by_tensors(deflection: Tensor, travel: Tensor, values: Values) -> Tensor:
    """Return the deflection (...,) after a travel (...,), with gradients and on any device.

    What is held against the direction is taken back first; what is left of the travel loads.
    """
    loading, unloading = _rates(values["asymmetry"])
    backwards, left = travel < 0.0, travel.abs() / values["displacement"]
    along = torch.where(backwards, -deflection, deflection)
    against, zero = along < 0.0, torch.zeros_like(along)
    held, free = torch.where(against, along, zero), torch.where(against, zero, along)
    unwound = torch.minimum(left, _to_zero(held, unloading))
    along = _towards(held, unloading, unwound) + _towards(free, loading, left - unwound)
    along = along.clamp(-_MOST, _MOST)
    return torch.where(backwards, -along, along)


def _towards(along: Tensor, rate: Tensor | float, left: Tensor) -> Tensor:
    """Return the solution of d along = (1 − rate·along) d left."""
    exponent = (rate * left).clamp(min=-_STEEPEST)
    if isinstance(rate, Tensor):
        series = (1.0, -1 / 2, 1 / 6, -1 / 24, 1 / 120, -1 / 720)
        covered = left * _over(exponent, lambda x: -torch.expm1(-x), series)
    else:
        covered = -torch.expm1(-exponent) / rate if rate else left
    return along * torch.exp(-exponent) + covered


def _to_zero(along: Tensor, rate: Tensor | float) -> Tensor:
    """Return the way from a deflection of at most 0 to 0; a long one where it leads away from it."""
    shrunk = (-rate * along).clamp(min=-1.0 + 1e-6)
    if isinstance(rate, Tensor):
        return -along * _over(shrunk, torch.log1p, (1.0, -1 / 2, 1 / 3, -1 / 4, 1 / 5, -1 / 6, 1 / 7))
    return torch.log1p(shrunk) / rate if rate else -along


def _over(x: Tensor, function: Callable[[Tensor], Tensor], series: tuple[float, ...]) -> Tensor:
    """Return function(x) / x, near 0 by its power series, whose slope is finite."""
    near = x.abs() < _NEAR_ZERO
    small, large = torch.where(near, x, 0.0), torch.where(near, 1.0, x)
    total = torch.zeros_like(x)
    for factor in reversed(series):
        total = factor + small * total
    return torch.where(near, total, function(large) / large)
