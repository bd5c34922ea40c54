"""The pilot of a race: a trained policy or the time-optimal plan."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simgap.errors import InputError
from simgap.gates.settings import TrackSettings
from simgap.policies.racing.settings import RacingSettings
from simgap.policies.settings import PolicyEvaluation, PolicyTraining
from simgap.runner import StageConfig, StageRun

if TYPE_CHECKING:
    from simgap.policies.racing.laps import Pilot

POLICY, TIME_OPTIMAL = "policy", "time_optimal"


@dataclass(frozen=True)
class Entry:
    """A pilot and the race that it flies.

    Attributes:
        pilot: maps observations to actions.
        platform: configuration of the machine.
        track: its gates.
        settings: of the race.
    """

    pilot: "Pilot"
    platform: Mapping[str, Any]
    track: TrackSettings
    settings: RacingSettings


def policy_folder(chosen: PolicyEvaluation, config: StageConfig) -> Path:
    """Return the folder of the policy to fly, whether or not it exists."""
    return Path(chosen.policy) if chosen.policy else config.artifact("train_policy", "policy")


def is_entered(chosen: PolicyEvaluation, config: StageConfig) -> bool:
    """Return whether there is a pilot: a named or trained policy, or another pilot."""
    return chosen.pilot != POLICY or bool(chosen.policy) or policy_folder(chosen, config).exists()


def entered(
    chosen: PolicyEvaluation,
    platform: Mapping[str, Any],
    track: TrackSettings,
    training: PolicyTraining,
    config: StageConfig,
    run: StageRun,
) -> Entry:
    """Return pilot, machine and race; a policy brings the machine and the race that it was trained for.

    Raises:
        InputError: when there is no such pilot or no such policy, when it was trained for another machine than the
            one that is given, when no plan is found, or when nobody would fly.
    """
    chosen.check()
    if chosen.pilot == TIME_OPTIMAL:
        return _planned(platform, track, training.racing, chosen)
    if chosen.pilot != POLICY:
        raise InputError(
            f"unknown pilot {chosen.pilot!r}", "evaluate.pilot", f"use {POLICY} or {TIME_OPTIMAL}"
        )
    entry = _trained(policy_folder(chosen, config), chosen, run)
    _require_own(platform, entry, str(policy_folder(chosen, config)))
    return entry


def _planned(
    platform: Mapping[str, Any], track: TrackSettings, settings: RacingSettings, chosen: PolicyEvaluation
) -> Entry:
    from simgap.gates.track import track_from
    from simgap.platforms import platform_from_config
    from simgap.policies.racing.entry import as_flown
    from simgap.policies.racing.model_predictive import time_optimal_pilot

    settings, gravity = as_flown(settings, chosen.powertrain), platform_from_config(platform).gravity
    return Entry(time_optimal_pilot(track_from(track), settings, gravity), platform, track, settings)


def _trained(folder: Path, chosen: PolicyEvaluation, run: StageRun) -> Entry:
    from simgap.policies.networks import Policy
    from simgap.policies.racing.entry import race_from
    from simgap.policies.storage import load_policy

    gaussian, description = load_policy(run.input(folder))
    track, settings = race_from(description.configuration, chosen.powertrain)
    policy = Policy(gaussian)
    return Entry(lambda seen: policy(seen.policy), description.configuration["platform"], track, settings)


def _require_own(platform: Mapping[str, Any], entry: Entry, where: str) -> None:
    from simgap.platforms import platform_from_config

    if platform and platform_from_config(platform) != platform_from_config(entry.platform):
        remedy = "leave platform out, or train a policy for it"
        raise InputError("was trained for another platform", where, remedy)
