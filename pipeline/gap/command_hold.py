"""Which way a recorded command is read, held or measured, once names say what it does."""

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

_SHIFT_TOLERANCE = 0.3  # of half a sample
_TIMES_NOISE_ENERGY = 10.0  # times the energy of the noise


def name_with_hold(
    prepared: Prepared, recording: Recording, nominal: Simulator, settings: Gap
) -> tuple[Prepared, Naming]:
    """Name what is missing, with the commands where they act.

    Which of the two readings of a command is right, held or measured, may not show before the physics is known. The
    other one is tried where a delay, lag or offset of half a sample was needed, which is no physics; on machines whose
    controllers are about as fast as their logs also where it may cost less, and where much has no name in this one.

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
    """Whether anything was recorded that a controller may hold."""
    return not COMMANDS.isdisjoint(prepared.problem.blocks.signals)


def _much_is_left(naming: Naming, prepared: Prepared) -> bool:
    """Whether every equation leaves so much more than noise that a wrong reading may be what is wrong with all."""
    return bool((excess_of(naming.fit, prepared.problem.noise) > _TIMES_NOISE_ENERGY).all())


def _may_cost_less(other: Prepared, prepared: Prepared, naming: Naming) -> bool:
    """Whether the other reading would cost less if all names but one had only made up for a wrong one."""
    refitted = fit(other.nominal.with_effects(naming.fit.simulator.effects), other.problem)
    noise = _greater_noise(prepared, other)
    return left_of(refitted, noise) + min(len(naming.named), 1) < cost_of(naming, noise)


def cost_of(naming: Naming, noise: Tensor) -> float:
    """Return what is left over a noise (channels,), and one for each name: a name is worth a factor of e."""
    return left_of(naming.fit, noise) + len(naming.named)


def _greater_noise(prepared: Prepared, other: Prepared) -> Tensor:
    """Return the noise of each channel as the reading has it that makes it greater: none wins by its noise."""
    return torch.maximum(prepared.problem.noise, other.problem.noise)


def left_of(fitted: Fit, noise: Tensor) -> float:
    """Return the logarithm of what a fit leaves over a noise, summed over channels."""
    return float(excess_of(fitted, noise).clamp_min(1.0).log().sum())


def _is_late_by_half_a_sample(naming: Naming, prepared: Prepared) -> bool:
    half = 0.5 * prepared.problem.blocks.time_step
    late = -half if prepared.problem.blocks.held else half
    simulator = naming.fit.simulator
    shifts = [f.effect.lateness(f.values, simulator.constants()) for f in simulator.free]
    return any(abs(shift - late) < _SHIFT_TOLERANCE * half for shift in shifts)
