"""State-space model: ridge regression of the increment on state, input and the layout's products.

Series are low-passed before the fit, forwards and backwards so that nothing is shifted in time; predictions see what
was recorded.
"""

from dataclasses import dataclass, replace
from typing import ClassVar

import torch
from scipy.signal import butter
from torch import Tensor

from simgap.errors import InputError
from simgap.models.linear import LinearModel, LinearSettings
from simgap.models.settings import ModelSettings
from simgap.models.windows import Series
from simgap.models.zero_phase import both_ways


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

    def prepared(self, train: Series) -> Series:
        """Return the training series low-passed."""
        cutoff = self.settings.cutoff
        return train if cutoff is None else low_passed(train, cutoff, self.settings.order)

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
    for first, last in series.bounds.tolist():
        for part in smooth:
            if last > first:
                part[first:last] = both_ways(sections, part[first:last])
    return replace(series, states=torch.from_numpy(smooth[0]), actions=torch.from_numpy(smooth[1]))
