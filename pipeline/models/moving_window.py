"""Moving-window learning: a model that is fitted anew to the last seconds of a run and predicts the ones that follow.

Source: Kantue & Pedro, grey-box modelling of multirotors in aggressive manoeuvres.
"""

from dataclasses import replace

import torch

from simgap.errors import InputError
from simgap.models.contract import DynamicsModel, FitContext
from simgap.models.residual_ratios import ratios
from simgap.models.settings import Training
from simgap.models.windows import Series


def moving_window_ratios(
    model: DynamicsModel, series: Series, training: Training, context: FitContext
) -> dict[str, dict[str, float]]:
    """Return `ratios` of every target of one-step predictions, each by a model of the seconds before it.

    Args:
        model: whose class, layout and settings are fitted; itself left as it is.
        series: of held-out runs.
        training: its `moving_window` is fitted, s, its `moving_step` predicted, s.
        context: of every fit; no checkpoint is written.

    Raises:
        InputError: when no segment holds a window and a step.
    """
    length, step = (
        round(seconds / series.time_step) for seconds in (training.moving_window, training.moving_step)
    )
    known = model.settings.sequence_length
    pairs = []
    for first, last in series.bounds.tolist():
        for start in range(first + length, last - max(step, 1) + 1, max(step, 1)):
            past, following = (
                replace(series, bounds=torch.tensor([bounds]))
                for bounds in ((start - length, start), (start - known, start + step))
            )
            fitted = type(model)(model.layout, model.settings, model.time_step)
            fitted.fit(past, past, training, replace(context, checkpoint=None))
            windows, targets = next(fitted.examples(following, "held-out").chunks())
            pairs.append((targets, targets - fitted.increments(windows)))
    if not pairs or step < 1:
        found = f"no held-out segment holds {training.moving_window} s and a step of {training.moving_step} s"
        raise InputError(found, "train.moving_window", "shorten it, or lengthen train.moving_step")
    measured, residual = (torch.cat(part).detach() for part in zip(*pairs, strict=True))
    return {
        name: ratios(measured[:, index], residual[:, index])
        for index, name in enumerate(model.layout.targets)
    }
