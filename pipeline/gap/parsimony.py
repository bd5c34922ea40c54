"""Condensing: one effect replaces two parameter errors if it explains as much."""

import itertools
from collections.abc import Mapping, Sequence

from torch import Tensor

from simgap.effects import Effect, ParameterError
from simgap.gap.fit import Fit, Problem, fit
from simgap.gap.refit import extend, remove, shrink
from simgap.simulation import FittedEffect

_NEARLY_ALL = 0.98  # of what the two explain; the rest may be a small error of one of them


def single_cause(
    current: Fit, catalogue: Sequence[Effect], problem: Problem, known: Mapping[str, FittedEffect]
) -> tuple[Effect, Fit, Fit] | None:
    """Look for an effect with one parameter that replaces two parameter errors.

    Two wrong numbers together may imitate another law: a motor constant and an inertia that are wrong by the same ratio
    damp a joint exactly like viscous friction. One cause is likelier than two.

    Returns:
        The effect, the fit with it and the fit without the two that it replaces, or None.
    """
    present = {fitted.effect.key for fitted in current.simulator.free}
    errors = [f.effect for f in current.simulator.free if isinstance(f.effect, ParameterError)]
    contenders = [e for e in catalogue if e.key not in present and len(e.parameters) == 1]
    for pair in itertools.combinations(errors, 2):
        without, bare = current, current
        for error in pair:
            without = shrink(without, error, problem, known.get(error.key))
            bare = remove(bare, error, problem, known.get(error.key))
        # The others start from what they are beside the two: without anything in their place they would go astray.
        tried = [(effect, extend(bare, effect, problem)) for effect in contenders]
        if not tried:
            return None
        effect, likeliest = max(tried, key=lambda entry: _explained(without, entry[1].residual))
        fitted = fit(likeliest.simulator, problem)
        if _explained(without, fitted.residual) >= _NEARLY_ALL * _explained(without, current.residual):
            return effect, fitted, without
    return None


def _explained(without: Fit, residual: Tensor) -> float:
    return float(((without.residual / without.scale).square() - (residual / without.scale).square()).sum())
