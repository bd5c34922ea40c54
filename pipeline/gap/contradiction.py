"""Consistency check of recording and platform, before any effect is tested.

A machine that moves against its commands, or a rate that is not the derivative of its angle, is not missing physics: a
sign, a frame, a unit or the motor order differs from the contract or the platform file. Nothing is named then.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from simgap.effects import ActuatorEffect
from simgap.gap.candidates import candidates_for
from simgap.gap.fit import Problem
from simgap.gap.gains import is_told_a_position
from simgap.gap.limits import excessive_thrust
from simgap.gap.prepare import Prepared
from simgap.gap.residuals import channels_on
from simgap.recordings.contradiction import Contradiction
from simgap.recordings.plausibility import contradicting_position, contradicting_rates
from simgap.recordings.recording import Recording
from simgap.simulation import Simulator
from simgap.simulation.blocks import Blocks

_DRIVING = 3.0  # times the noise, above which commanded and needed wrench are compared
_AGAINST = (
    -0.5
)  # correlation; a tenth of a second of delay does not make it negative on a machine that is controlled
_ALIKE = 0.7  # correlation above which sizes are compared
_LEAST_STRENGTH_RATIO = (
    1 / 30
)  # needed over commanded wrench; a motor may be limited to a tenth of its strength
_GREATEST_STRENGTH_RATIO = 8.0  # of the same; no single platform number is wrong by so much


@dataclass(frozen=True)
class Agreement:
    """Agreement of the wrench that the commands produce with the wrench that the recorded motion needs.

    Attributes:
        correlation: of the two.
        ratio: standard deviation of the needed wrench over that of the commanded one.
    """

    correlation: float
    ratio: float


def contradictions(recording: Recording, prepared: Prepared) -> list[Contradiction]:
    """Return all in a recording that contradicts itself or the platform, so that nothing can be named.

    What a rate of another unit needs of the commands says nothing more: the commands are asked where rates agree.

    Args:
        recording: cleaned.
        prepared: of it.
    """
    told = is_told_a_position(recording)
    found = [*contradicting_rates(recording.frame, recording.kind)] or [
        *(contradicting_position(recording.frame) if told else _driven_otherwise(recording, prepared)),
        *excessive_thrust(prepared),
    ]
    runs = tuple(dict.fromkeys(recording.frame["run"].astype(str)))
    return [replace(contradiction, runs=runs) for contradiction in found]


def _driven_otherwise(recording: Recording, prepared: Prepared) -> Iterator[Contradiction]:
    for channel, agreement in agreements(prepared.nominal, prepared.problem).items():
        column = _driving_column(recording, prepared.nominal, channel)
        if agreement.correlation < _AGAINST:
            yield Contradiction(
                column,
                "motor_order" if recording.kind == "quadrotor" else "sign",
                f"{channel}: the motion opposes the commands (correlation {agreement.correlation:.2f})",
                f"Compare sign, frame and numbering of {column!r} with the platform file; mend what is wrong.",
            )
        elif (
            agreement.correlation > _ALIKE
            and not _LEAST_STRENGTH_RATIO < agreement.ratio < _GREATEST_STRENGTH_RATIO
        ):
            ratio = agreement.ratio
            much = f"{ratio:.0f} times" if ratio > 1.0 else f"1/{1.0 / ratio:.0f} of"
            yield Contradiction(
                column,
                "unit",
                f"{channel}: by the platform file, the motion needs {much} the effort that was commanded",
                f"Check the unit of {column!r} (mN·m for N·m?), and gear ratio and inertia in the platform file.",
            )


def _driving_column(recording: Recording, simulator: Simulator, channel: str) -> str:
    """Return the recorded column, or group of columns, that drives a channel."""
    signals = sorted(simulator.mechanism.actuator_signals, key=lambda name: name[:5] != channel[:5])
    for signal in (name.replace("rotor", "motor") for name in signals):
        if signal in recording.frame:
            return signal
        if f"{signal}_1" in recording.frame:
            return f"{signal}_1..4"
    return channel


def agreements(simulator: Simulator, problem: Problem) -> dict[str, Agreement]:
    """Return the agreement of commanded and needed wrench, by channel.

    The linear effects of the catalogue are regressed out of both sides first: a spring that is pulled slowly moves
    against its acceleration. Channels are left out if the commanded wrench is below three times the noise, unless the
    needed one is above it and correlates with the commands.
    """
    idle = replace(problem, blocks=_idle(simulator, problem))
    needed = idle.residual(simulator)
    driven = needed - problem.residual(simulator)
    names = [channel.name for channel in channels_on(simulator, problem.blocks)]
    others = _linear_physics(simulator, idle)
    found = {}
    for index, (name, noise) in enumerate(zip(names, problem.noise, strict=True)):
        sides = torch.stack([needed[..., index].flatten(), driven[..., index].flatten()], -1)
        need, drive = _without(sides, others[..., index, :].flatten(0, 1)).T
        if not drive.any():
            continue
        correlation = float(torch.corrcoef(torch.stack([need, drive]))[0, 1])
        if drive.std() > _DRIVING * noise or (need.std() > _DRIVING * noise and correlation > _ALIKE):
            found[name] = Agreement(correlation, float(need.std() / drive.std()))
    return found


def _linear_physics(simulator: Simulator, problem: Problem) -> Tensor:
    """Return the columns of all effects of recorded signals that are linear here, (blocks, rows, channels, columns)."""
    effects = candidates_for(simulator, problem.blocks.signals, None)
    recorded = (effect for effect in effects if not isinstance(effect, ActuatorEffect))
    columns = (problem.regressors(simulator, effect) for effect in recorded)
    none = problem.residual(simulator)[..., None][..., :0]
    return torch.cat([none, *(column for column in columns if column is not None)], -1)


def _without(sides: Tensor, others: Tensor) -> Tensor:
    """Return each side (rows, 2) with other columns (rows, columns) regressed out."""
    size = others.square().mean(0).sqrt()
    scaled = others[:, size > 0] / size[size > 0]
    return sides - scaled @ torch.linalg.lstsq(scaled, sides, driver="gelsd").solution


def _idle(simulator: Simulator, problem: Problem) -> Blocks:
    """Return the blocks with all commands set to zero."""
    blocks, driving = problem.blocks, simulator.mechanism.actuator_signals

    def silenced(signals: Mapping[str, Tensor]) -> dict[str, Tensor]:
        return {name: torch.zeros_like(s) if name in driving else s for name, s in signals.items()}

    return replace(blocks, signals=silenced(blocks.signals), held_commands=silenced(blocks.held_commands))
