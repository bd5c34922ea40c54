"""Construction of a race from its configuration or from a trained policy."""

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

import torch
from torch import Tensor

from simgap.gates.settings import TrackSettings
from simgap.gates.track import Track, track_from
from simgap.platforms import Quadrotor
from simgap.policies.racing.flying import Flown, flight_in
from simgap.policies.racing.racing import Misjudging, Racing
from simgap.policies.racing.randomisation import nothing_left_over
from simgap.policies.racing.settings import RacingSettings, Randomisation
from simgap.runner.mistakes import configuration_mistakes
from simgap.simulation import Simulator


def race_in(
    simulator: Simulator,
    track: TrackSettings,
    settings: RacingSettings,
    machines: int,
    device: torch.device | str = "cpu",
    misjudging: Misjudging | None = None,
) -> Racing:
    """Return the environment of a race in a simulator.

    Args:
        simulator: of a quadrotor.
        track: its gates.
        settings: of the race.
        machines: how many fly at once.
        device: where they are.
        misjudging: how they misjudge their states; None: they know them.

    Raises:
        InputError: when the simulator is not of a quadrotor, or the track cannot be flown, not even by a plan where
            one is to start from.
    """
    residual = nothing_left_over if settings.randomisation.enabled else None
    flight = flight_in(simulator, settings.flying, residual)
    gates = track_from(track)
    planned = _planned(gates, settings, simulator.platform.gravity) if settings.starts.planned else None
    return Racing(flight, gates, settings, machines, device, misjudging=misjudging, planned=planned)


def _planned(track: Track, settings: RacingSettings, gravity: float) -> Tensor:
    """Return the states of the time-optimal lap from each gate to the next, (gates, nodes of a phase, 13)."""
    from simgap.policies.racing.time_optimal import Limits, optimal_lap

    lap = optimal_lap(track, Limits.of(settings.flying), gravity)
    phases = lap.states[:-1].reshape(
        len(track), -1, lap.states.shape[1]
    )  # the first one ends in the first gate
    return torch.from_numpy(phases).roll(-1, 0)


def race_deployed(
    machines: Flown, platform: Quadrotor, track: TrackSettings, settings: RacingSettings, count: int
) -> Racing:
    """Return the environment of a race of machines that are no simulator's; nobody is trained in it.

    Raises:
        InputError: when the track cannot be flown.
    """
    flight = flight_in(Simulator(platform), settings.flying)
    return Racing(flight, track_from(track), settings, count, machines=machines)


def described_race(track: TrackSettings, settings: RacingSettings) -> dict[str, Any]:
    """Return what a policy has to be flown with, for its description."""
    return {"track": asdict(track), "racing": asdict(settings)}


def race_from(
    description: Mapping[str, Any], powertrain: bool | None
) -> tuple[TrackSettings, RacingSettings]:
    """Return the track that a policy was trained on, and the settings of a race there.

    Args:
        description: of `described_race`.
        powertrain: what is to be flown with; None for what was trained with.

    Raises:
        InputError: when it is not such a description.
    """
    track, settings = trained_race(description)
    return track, as_flown(settings, powertrain)


def trained_race(description: Mapping[str, Any]) -> tuple[TrackSettings, RacingSettings]:
    """Return track and settings that a policy was trained with.

    Args:
        description: of `described_race`.

    Raises:
        InputError: when it is not such a description.
    """
    from omegaconf import OmegaConf

    with configuration_mistakes("policy"):
        track = OmegaConf.to_object(
            OmegaConf.merge(OmegaConf.structured(TrackSettings), description["track"])
        )
        merged = OmegaConf.merge(OmegaConf.structured(RacingSettings), description["racing"])
        settings = OmegaConf.to_object(merged)
    assert isinstance(track, TrackSettings)
    assert isinstance(settings, RacingSettings)
    return track, settings


def as_flown(settings: RacingSettings, powertrain: bool | None) -> RacingSettings:
    """Return the settings of a training as a race has them: nothing is drawn for an episode, or planned.

    Args:
        settings: of the training.
        powertrain: what is to be flown with; None for what was trained with.
    """
    starts = replace(settings.starts, planned=0.0)
    settings = replace(settings, randomisation=Randomisation(), starts=starts)
    if powertrain is None:
        return settings
    return replace(settings, flying=replace(settings.flying, powertrain=powertrain))


def gone_on_with(settings: RacingSettings, randomised: bool, thrust: float = 0.0) -> RacingSettings:
    """Return the settings of a training as one has them that goes on with its policy: a crash costs what it did last.

    Args:
        settings: of the training.
        randomised: whether dynamics that were drawn for every episode still are; else it is as in a race.
        thrust: share by which the thrust of an episode differs at least, where a simulator knows one level of the
            battery and the machine flies with others.
    """
    kept = settings if randomised else as_flown(settings, None)
    randomisation = replace(kept.randomisation, thrust=max(kept.randomisation.thrust, thrust))
    return replace(kept, randomisation=randomisation, reward=replace(settings.reward, first_crash=None))
