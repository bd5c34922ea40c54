"""Zero-order hold or measured command: the second decision, made with named effects."""

import torch
from torch import Tensor

from simgap.gap.fit import Fit, excess_of, fit
from simgap.gap.hold_test import HELD_KINDS
from simgap.gap.name import Naming
from simgap.gap.prepare import Prepared, prepare
from simgap.gap.settings import Gap
from simgap.gap.short_lags import name_with_short_lags
from simgap.recordings.recording import Recording
from simgap.simulation import Simulator
from simgap.simulation.signals import COMMANDS

_SHIFT_TOLERANCE = 0.3  # tolerance, as a share of half a sample
_TIMES_NOISE_ENERGY = 10.0  # times the energy of the noise


def name_with_hold(
    prepared: Prepared, recording: Recording, nominal: Simulator, settings: Gap
) -> tuple[Prepared, Naming]:
    """Select effects with the right timing of commands: held between samples or measured at their own.

    The right reading may show only when the effects are known. The other reading is tried if a delay of half a sample
    was named. For joints and swerve drives it is also tried if it may cost less, or if every channel leaves much.

    Args:
        prepared: of the recording, as it looks.
        recording: cleaned.
        nominal: what is believed before.
        settings: of the gap engine.
    """
    prepared, naming = name_with_short_lags(prepared, settings)
    late = _is_late_by_half_a_sample(naming, prepared)
    if not (_has_commands(prepared) and (late or recording.kind in HELD_KINDS)):
        return prepared, naming
    other = prepare(recording, nominal, settings, held=not prepared.problem.blocks.held)
    if not (late or _much_is_left(naming, prepared) or _may_cost_less(other, prepared, naming)):
        return prepared, naming
    other, renamed = name_with_short_lags(other, settings)
    later = _is_late_by_half_a_sample(renamed, other)
    if late or later:
        return (other, renamed) if late and not later else (prepared, naming)
    noise = _greater_noise(prepared, other)
    return (other, renamed) if cost_of(renamed, noise) < cost_of(naming, noise) else (prepared, naming)


def _has_commands(prepared: Prepared) -> bool:
    """Whether a command that a controller may hold was recorded."""
    return not COMMANDS.isdisjoint(prepared.problem.blocks.signals)


def _much_is_left(naming: Naming, prepared: Prepared) -> bool:
    """Whether every channel leaves more than ten times the noise energy."""
    return bool((excess_of(naming.fit, prepared.problem.noise) > _TIMES_NOISE_ENERGY).all())


def _may_cost_less(other: Prepared, prepared: Prepared, naming: Naming) -> bool:
    """Whether the other reading would cost less if it needed only one name."""
    refitted = fit(other.nominal.with_effects(naming.fit.simulator.effects), other.problem)
    noise = _greater_noise(prepared, other)
    return left_of(refitted, noise) + min(len(naming.named), 1) < cost_of(naming, noise)


def cost_of(naming: Naming, noise: Tensor) -> float:
    """Return the sum of ln(energy/noise energy) over channels, plus one per name."""
    return left_of(naming.fit, noise) + len(naming.named)


def _greater_noise(prepared: Prepared, other: Prepared) -> Tensor:
    """Return the greater noise of both readings in each channel, so that none wins by its noise."""
    return torch.maximum(prepared.problem.noise, other.problem.noise)


def left_of(fitted: Fit, noise: Tensor) -> float:
    """Return ln(energy/noise energy) of a fit, summed over channels."""
    return float(excess_of(fitted, noise).clamp_min(1.0).log().sum())


def _is_late_by_half_a_sample(naming: Naming, prepared: Prepared) -> bool:
    half = 0.5 * prepared.problem.blocks.time_step
    late = -half if prepared.problem.blocks.held else half
    simulator = naming.fit.simulator
    shifts = [f.effect.lateness(f.values, simulator.constants()) for f in simulator.free]
    return any(abs(shift - late) < _SHIFT_TOLERANCE * half for shift in shifts)
