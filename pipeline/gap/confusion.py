"""Effects that a recording cannot tell from a gain of a servo's position loop, and the log that would.

Where nobody gave a gain, it is fitted beside every effect. The recording says how much the two depend on each other.
An effect that hardly differs from another gain is not named: the gain explains what it explains.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from simgap.effects import Effect, WrenchEffect
from simgap.equations.fit import effect_jacobian, inverse_of
from simgap.gap.gains import IdentifiedGain
from simgap.gap.hypothesis import Hypothesis, information_of
from simgap.gap.name import Named, Naming
from simgap.simulation import FittedEffect

_INFLATION = 10.0
"""Of a parameter's variance by not knowing the other one: from here on collinearity is harmful.
Source: Marquardt 1970, Generalized inverses, ridge regression, biased linear estimation (Technometrics 12)."""
_LEAST_KNOWN = 1e-9
"""Of a parameter's information, which no other one takes: far above rounding, far below what makes a confusion."""
_EFFORT = "log the effort or the motor's current"
_LOADS = f"{_EFFORT}, or hold a known weight at several positions"
_SEPARATED_BY = {
    "viscous_friction": f"{_EFFORT}, or let the axis swing with the servo off",
    "coulomb_friction": "command slow ramps in both directions, with rests between them",
    "stribeck_friction": "command slow ramps in both directions, with rests between them",
    "inertia_error": f"{_EFFORT}, or put a known inertia on the axis",
    **dict.fromkeys(("gravity_load", "linear_stiffness", "constant_load", "cubic_stiffness"), _LOADS),
}
"""What tells an effect from a gain; any other one its own excitation."""


@dataclass(frozen=True)
class Confusion:
    """An effect that cannot be told from a gain.

    Attributes:
        gain: `proportional` or `derivative`.
        effect: which hardly differs from it here.
        correlation: of the two, by the recording alone.
    """

    gain: str
    effect: Effect
    correlation: float


def confusions_of(naming: Naming) -> list[Confusion]:
    """Return the effects that were considered and cannot be told from a gain that nobody gave."""
    found: dict[tuple[str, str], Confusion] = {}
    for hypothesis in _with_each(naming):
        for confusion in _in(hypothesis):
            found[confusion.gain, confusion.effect.key] = confusion
    return sorted(found.values(), key=lambda each: (each.gain, each.effect.key))


def confusion_remarks(confusions: Iterable[Confusion]) -> list[str]:
    """Return a sentence about each gain that effects cannot be told from."""
    by_advice: dict[tuple[str, str], list[Confusion]] = {}
    for each in confusions:
        advice = _SEPARATED_BY.get(each.effect.name, each.effect.excitation)
        by_advice.setdefault((each.gain, advice), []).append(each)
    return [
        f"this recording cannot tell {_listed(each.effect.name for each in alike)} from another {gain} gain "
        f"(correlation {_strongest(alike):+.3f}); to tell them apart, {advice}, or give controller.{gain}"
        for (gain, advice), alike in by_advice.items()
    ]


def told_apart(naming: Naming, remains: bool) -> tuple[Naming, list[str]]:
    """Return what is named less what gains that nobody gave leave undecided, and a sentence about each reason.

    Where much of the error remains beside such gains, their scale is not known, and with it that of every effort: then
    no friction and no load is named.

    Args:
        naming: of all hypotheses.
        remains: whether much of the error remains.
    """
    if not any(isinstance(f.effect, IdentifiedGain) for f in naming.fit.simulator.free):
        return naming, []
    confusions = confusions_of(naming)
    confused = {confusion.effect.key for confusion in confusions}
    kept = [named for named in naming.named if named.effect.key not in confused]
    unscaled = [named for named in kept if remains and _is_of_effort(named.effect)]
    dropped = confused | {named.effect.key for named in unscaled}
    decided = replace(
        naming,
        named=tuple(named for named in naming.named if named.effect.key not in dropped),
        rivalries=tuple(rivalry for rivalry in naming.rivalries if rivalry.winner.key not in dropped),
    )
    return decided, [*confusion_remarks(confusions), *_unscaled_remark(remains, unscaled)]


def _is_of_effort(effect: Effect) -> bool:
    """Whether an effect is a friction, a load or an inertia, or has a size in the unit of an effort."""
    return effect.acts_on == "torque" or any("N·m" in parameter.unit for parameter in effect.parameters)


def _unscaled_remark(remains: bool, unscaled: Sequence[Named]) -> list[str]:
    if not remains:
        return []
    withheld = _listed(named.effect.name for named in unscaled) if unscaled else ""
    example = f" ({withheld} would be)" if unscaled else ""
    return [
        "gains that nobody gave were identified, and much of the error remains beside them: their scale is not sure, "
        f"and no friction, load or inertia is named{example}; give controller.proportional and controller.derivative, "
        f"or {_EFFORT}"
    ]


def _with_each(naming: Naming) -> list[Hypothesis]:
    """Return the best hypothesis, and the same with one more linear law each.

    A law that is the same as a gain does nothing beside it, so that the search keeps no hypothesis with it.
    """
    best = naming.best
    others = (effect for effect in best.reading.catalogue if effect.key not in best.keys)
    linear = (effect for effect in others if isinstance(effect, WrenchEffect) and effect.linear)
    return [best, *(_beside(best, effect) for effect in linear)]


def _beside(best: Hypothesis, effect: Effect) -> Hypothesis:
    """Return the best hypothesis with one more effect that does nothing yet, and its columns."""
    found = best.fit
    simulator = found.simulator.with_effects(
        (*found.simulator.effects, FittedEffect(effect, effect.neutral()))
    )
    columns = effect_jacobian(simulator, effect, best.reading.problem, found.residual)
    fitted = replace(found, simulator=simulator, jacobian=torch.cat([found.jacobian, columns], dim=-1))
    return replace(best, keys=best.keys | {effect.key}, fit=fitted)


def _in(hypothesis: Hypothesis) -> list[Confusion]:
    correlation = _correlation(hypothesis)
    owners = [f.effect for f in hypothesis.fit.simulator.free for _ in f.effect.parameters]
    gains = [(place, effect) for place, effect in enumerate(owners) if isinstance(effect, IdentifiedGain)]
    return [
        Confusion(gain.gain, effect, float(correlation[own, place]))
        for own, gain in gains
        for place, effect in enumerate(owners)
        if effect.names_physics and float(correlation[own, place]) ** 2 > 1.0 - 1.0 / _INFLATION
    ]


def _correlation(hypothesis: Hypothesis) -> Tensor:
    """Return the correlations of the parameters of a hypothesis by the recording alone, (parameters, parameters).

    A prior would make any two parameters independent of which the recording says little. Where two do exactly the same,
    hardly anything is known of their difference.
    """
    information = information_of(hypothesis.fit, hypothesis.likelihood)
    covariance = inverse_of(information + _LEAST_KNOWN * torch.diag(information.diagonal()))
    size = covariance.diagonal().clamp_min(1e-300).sqrt()
    return covariance / size / size[:, None]


def _strongest(alike: list[Confusion]) -> float:
    return max((each.correlation for each in alike), key=abs)


def _listed(names: Iterable[str]) -> str:
    *first, last = (name.replace("_", " ") for name in names)
    return f"{', '.join(first)} and {last}" if first else last
