"""Noise of rows: what the noise of the sensors and the tolerances of the equations give."""

from dataclasses import replace

import torch
from torch import Tensor

from simgap.gap.derived_noise import noise_of_derived
from simgap.gap.residuals import channel_series, settling_of
from simgap.gap.sample_noise import sample_noise
from simgap.physics.weak_form import WindowFunctions
from simgap.simulation import Simulator
from simgap.simulation.blocks import Blocks


def noise_of_rows(simulator: Simulator, blocks: Blocks, functions: WindowFunctions) -> Tensor:
    """Return the standard deviation that sensor noise and tolerances give each channel's rows, (channels,).

    The noise of a sampled signal is what its fifth difference leaves: physics is smooth over six samples, white noise
    is not. It is taken of the measured side and of the predicted side, whose inputs are noisy too.
    Source: Gasser, Sroka & Jennen-Steinmetz 1986, Residual variance and residual pattern (Biometrika 73).
    """
    if "derived_velocity" in blocks.signals:
        return noise_of_derived(simulator, blocks, functions)
    deviations, kept = [], blocks.noise_kept
    # White noise is read off single samples: a mean of two no longer looks like it.
    for series in channel_series(simulator, replace(blocks, held=False)):
        mean_gain = functions.weights.square().sum(1).mean()
        if series.direct:
            variance = sample_noise(series.measured - series.predicted, kept) * mean_gain
        else:
            slopes = functions.differences if blocks.held else functions.slopes
            rate_gain = slopes.square().sum(1).mean()
            settling = settling_of(series.channel.name, simulator, blocks)
            variance = settling**2 * sample_noise(series.measured, kept) * rate_gain
            variance = variance + sample_noise(series.predicted, kept) * mean_gain
        deviations.append((variance + series.channel.tolerance**2).sqrt())
    return torch.stack(deviations)
