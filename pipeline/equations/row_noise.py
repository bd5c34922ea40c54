"""Noise of rows: what the noise of the sensors and the tolerances of the equations give."""

from dataclasses import replace

import torch
from torch import Tensor

from simgap.equations.derived_noise import noise_of_derived
from simgap.equations.residuals import channel_series, channels_on, settling_of
from simgap.equations.sample_noise import sample_noise
from simgap.physics.weak_form import WindowFunctions
from simgap.simulation import Simulator
from simgap.simulation.blocks import Blocks

TOLERATED = 1.2
"""Energy of rows over that of their noise which tells nothing: the floor is itself an estimate."""


def noise_of_rows(simulator: Simulator, blocks: Blocks, functions: WindowFunctions) -> Tensor:
    """Return the standard deviation that sensor noise and tolerances give each channel's rows, (channels,).

    The noise of a sampled signal is what its fifth difference leaves: physics is smooth over six samples, white noise
    is not. It is taken of the measured side and of the predicted side, whose inputs are noisy too.
    Source: Gasser, Sroka & Jennen-Steinmetz 1986, Residual variance and residual pattern (Biometrika 73).
    """
    if "derived_velocity" in blocks.signals:
        return noise_of_derived(simulator, blocks, functions)
    measured, predicted = _variances(simulator, blocks, functions)
    return (measured + predicted).sqrt()


def share_of_motion(simulator: Simulator, blocks: Blocks, functions: WindowFunctions) -> Tensor:
    """Return how much of the energy of each channel's noise is that of the recorded motion, (channels,).

    The rest is that of what the simulator makes of its inputs. A derived velocity is all motion.
    """
    if "derived_velocity" in blocks.signals:
        return torch.ones(len(channels_on(simulator, blocks)), dtype=torch.float64)
    measured, predicted = _variances(simulator, blocks, functions)
    return measured / (measured + predicted).clamp_min(1e-300)


def _variances(simulator: Simulator, blocks: Blocks, functions: WindowFunctions) -> tuple[Tensor, Tensor]:
    """Return the variances that the noise of the measured and of the predicted side give rows, (channels,) each."""
    parts, kept = [], blocks.noise_kept
    # White noise is read off single samples: a mean of two no longer looks like it.
    for series in channel_series(simulator, replace(blocks, held=False)):
        mean_gain = functions.weights.square().sum(1).mean()
        tolerance = torch.tensor(series.channel.tolerance**2, dtype=torch.float64)
        if series.direct:
            both = sample_noise(series.measured - series.predicted, kept) * mean_gain
            parts.append((both + tolerance, torch.zeros_like(both)))
            continue
        slopes = functions.differences if blocks.held else functions.slopes
        rate_gain = slopes.square().sum(1).mean()
        settling = settling_of(series.channel.name, simulator, blocks)
        moved = settling**2 * sample_noise(series.measured, kept) * rate_gain
        parts.append((moved + tolerance, sample_noise(series.predicted, kept) * mean_gain))
    measured, predicted = zip(*parts, strict=True)
    return torch.stack(measured), torch.stack(predicted)
