"""What shows that a recording is not read as it was made, before any physics is asked.

A machine that moves against what drives it, or a rate that is not that of its angle, is no physics that was left out:
a sign, a frame, a unit or the order of the motors is another one than the contract's or the platform's. Whatever were
named there would be made up.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import torch
from torch import Tensor

from pipeline.gap.fit import Problem
from pipeline.gap.preparation import Prepared
from pipeline.gap.residuals import channels_on
from pipeline.recordings.plausibility import contradicting_rates
from pipeline.recordings.recording import Recording
from pipeline.simulation import Simulator
from pipeline.simulation.blocks import Blocks

_DRIVING = 3.0  # times the noise, which what is commanded has to make for its direction to be told
_AGAINST = (
    -0.5
)  # correlation; a tenth of a second of delay does not make it negative on a machine that is controlled


def contradictions(recording: Recording, prepared: Prepared) -> list[str]:
    """Return a sentence for all in a recording that contradicts itself or the platform, so that nothing can be named.

    Args:
        recording: cleaned.
        prepared: of it.
    """
    return [*contradicting_rates(recording.frame, recording.kind), *_driven_backwards(prepared)]


def _driven_backwards(prepared: Prepared) -> Iterator[str]:
    for channel, agreement in agreements(prepared.nominal, prepared.problem).items():
        if agreement < _AGAINST:
            yield (
                f"{channel}: the machine moves against what is commanded (correlation {agreement:.2f}): a sign, a "
                "frame or the order of the motors is not the platform's"
            )


def agreements(simulator: Simulator, problem: Problem) -> dict[str, float]:
    """Return how what the commands do in a simulator goes with what the recorded motion needs, by channel.

    The correlation over all windows; channels that no command drives beyond the noise are left out.
    """
    needed = replace(problem, blocks=_idle(simulator, problem)).residual(simulator)
    driven = needed - problem.residual(simulator)
    names = [channel.name for channel in channels_on(simulator, problem.blocks)]
    pairs = zip(names, needed.flatten(0, 1).T, driven.flatten(0, 1).T, problem.noise, strict=True)
    return {
        name: float(torch.corrcoef(torch.stack([need, drive]))[0, 1])
        for name, need, drive, noise in pairs
        if drive.std() > _DRIVING * noise
    }


def _idle(simulator: Simulator, problem: Problem) -> Blocks:
    """Return the blocks as if nothing had been commanded."""
    blocks, driving = problem.blocks, simulator.mechanism.actuator_signals

    def silenced(signals: Mapping[str, Tensor]) -> dict[str, Tensor]:
        return {name: torch.zeros_like(s) if name in driving else s for name, s in signals.items()}

    return replace(blocks, signals=silenced(blocks.signals), held_commands=silenced(blocks.held_commands))
