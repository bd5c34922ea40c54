"""The state space: ridge regression of the increment on the state, the input and the products that a layout adds.

Series are low-passed before the fit, forwards and backwards so that nothing is shifted in time; predictions see what
was recorded.
"""

from dataclasses import dataclass, replace
from typing import ClassVar

import torch
from scipy.signal import butter, sosfiltfilt
from torch import Tensor

from pipeline.errors import InputError
from pipeline.models.contract import FitContext
from pipeline.models.linear import LinearModel, LinearSettings
from pipeline.models.settings import ModelSettings, Training
from pipeline.models.windows import Series


@dataclass
class StateSpaceSettings(LinearSettings):
    """Settings of the state space."""

    name: str = "state_space"
    cutoff: float | None = (
        0.8  # of the Butterworth low-pass, share of half the sampling rate; null: no low-pass
    )
    order: int = 4  # of the low-pass


class StateSpaceModel(LinearModel):
    """A linear model of low-passed series that is linear in more than the features."""

    settings_class: ClassVar[type[ModelSettings]] = StateSpaceSettings
    settings: StateSpaceSettings

    def fit(
        self, train: Series, validation: Series, training: Training, context: FitContext | None = None
    ) -> float:
        """Solve the normal equations of the low-passed series; the validation series only scores, as it is."""
        cutoff = self.settings.cutoff
        if cutoff is not None:
            train = low_passed(train, cutoff, self.settings.order)
        return super().fit(train, validation, training)

    def regressors(self, features: Tensor) -> Tensor:
        """Return the layout's regressors."""
        return self.layout.regressors(features)


def low_passed(series: Series, cutoff: float, order: int) -> Series:
    """Return a series whose segments are filtered forwards and backwards by a Butterworth low-pass.

    Args:
        series: states and inputs.
        cutoff: share of half the sampling rate.
        order: of the low-pass.

    Raises:
        InputError: when the cutoff lies outside the spectrum.
    """
    if not 0.0 < cutoff < 1.0:
        raise InputError("must lie between 0 and 1", "model.cutoff", "give a share of half the sampling rate")
    sections = butter(order, cutoff, output="sos")
    smooth = [part.numpy().copy() for part in (series.states, series.actions)]
    usual = 3 * (2 * len(sections) + 1)  # samples by which SciPy extends a segment at either end
    for first, last in series.bounds.tolist():
        for part in smooth:
            if last > first:
                padding = min(usual, last - first - 1)
                part[first:last] = sosfiltfilt(sections, part[first:last], axis=0, padlen=padding)
    return replace(series, states=torch.from_numpy(smooth[0]), actions=torch.from_numpy(smooth[1]))
