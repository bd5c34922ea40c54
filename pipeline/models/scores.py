"""All that a trained model is scored by on held-out runs, as a stage writes it into its metrics."""

from collections.abc import Mapping
from typing import Any

from simgap.models.contract import DynamicsModel, FitContext
from simgap.models.error_distribution import error_quantiles
from simgap.models.evaluation import rollout_errors
from simgap.models.free_run import free_run_scores
from simgap.models.moving_window import moving_window_ratios
from simgap.models.output_groups import group_scores
from simgap.models.residual_ratios import residual_ratios
from simgap.models.settings import Training
from simgap.models.step_scores import NextValues, step_scores
from simgap.models.windows import Series


def held_out_scores(
    model: DynamicsModel, held: Series, settings: Training, context: FitContext
) -> dict[str, Any]:
    """Return the errors of many steps, and what else is asked for, by name.

    Args:
        model: trained.
        held: series of the held-out runs.
        settings: of the training, which say what is asked for.
        context: of a training that a score repeats, such as that of a moving window.
    """
    history, most = settings.evaluation_history, settings.evaluation_windows
    scores: dict[str, Any] = {**rollout_errors(model, held, settings.horizons, most, history)}
    for name, part in model.parts().items():
        scores[name] = rollout_errors(part, held, settings.horizons, most, history)
    if settings.quantiles:
        quantiles = error_quantiles(model, held, settings.horizons, settings.quantiles, most, history)
        scores["distribution"] = quantiles
    if settings.free_run:
        scores["free_run"] = free_run_scores(model, held, settings.free_run)
        scores |= {"test_windows": _test_windows(model, held, settings)} if settings.test_windows else {}
    if parameters := model.identified():
        scores["parameters"] = parameters
    if settings.residual_ratios:
        scores["residual_ratios"] = residual_ratios(model, held)
    if settings.moving_window:
        scores["moving_window"] = moving_window_ratios(model, held, settings, context)
    return scores


def one_step_scores(after: Mapping[str, NextValues], before: Mapping[str, NextValues]) -> dict[str, Any]:
    """Return the errors of one step, of each target and, as mean and variance, over targets of one kind.

    Args:
        after: next values by machine.
        before: the same before a bias correction; empty where there was none.
    """
    steps = step_scores(after, before)
    groups = group_scores(steps)
    return {"steps": steps} | ({"step_groups": groups} if groups else {})


def _test_windows(model: DynamicsModel, held: Series, settings: Training) -> dict[str, Any]:
    """Return the scores of free runs in each of the equal parts of the held-out time, from 1 on."""
    parts = settings.test_windows
    windows = (held.excerpt(1.0 / parts, number / parts) for number in range(parts))
    return {
        str(number): free_run_scores(model, window, settings.free_run)
        for number, window in enumerate(windows, start=1)
    }
