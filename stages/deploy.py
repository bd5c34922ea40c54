"""The stage that runs a trained policy or a planned motion on the simulated plant with concealed effects."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simgap.errors import InputError
from simgap.gates.settings import TrackSettings
from simgap.perception.settings import PerceptionSettings
from simgap.policies.profile.settings import Profile
from simgap.policies.settings import Deployment, PolicyEvaluation, PolicyTraining
from simgap.runner import StageConfig, StageRun, stage

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from simgap.plants.estimator import Aid
    from simgap.plants.swerve.open_loop import Trial
    from simgap.policies.profile.motion import Motion

FIGURE = "trials.svg"
TRIALS = "trials.parquet"


@dataclass
class DeployStage(StageConfig):
    """The configuration of deployment."""

    platform: dict[str, Any] = field(default_factory=dict)
    record: dict[str, Any] = field(default_factory=dict)
    profile: Profile = field(default_factory=Profile)
    deploy: Deployment = field(default_factory=Deployment)
    track: TrackSettings = field(default_factory=TrackSettings)
    perception: PerceptionSettings = field(default_factory=PerceptionSettings)
    train_policy: PolicyTraining = field(default_factory=PolicyTraining)
    evaluate: PolicyEvaluation = field(default_factory=PolicyEvaluation)


@stage(DeployStage)
def deploy(config: DeployStage, run: StageRun) -> None:
    """Run the policy (quadrotor) or the planned motion (swerve drive) on the simulated plant."""
    from simgap.platforms import Quadrotor, platform_from_config
    from simgap.stages._pilots import is_entered

    config.deploy.check()
    races = isinstance(platform_from_config(config.platform), Quadrotor)
    if races and is_entered(config.evaluate, config):
        race(config, run)
    elif not races and (config.deploy.plan or _plan(config).exists()):
        _drive(config, run)
    else:
        run.leave_out("deploy: nothing is deployed, because there is no policy and no planned motion")


def race(config: DeployStage, run: StageRun) -> None:
    """Race as `evaluate` does, but on the plant, and record some of the flights."""
    from simgap.plants import case_from_config
    from simgap.plants.race import RacedMachines
    from simgap.platforms import platform_from_config
    from simgap.policies.racing.deployed import Deployed, RateLoop
    from simgap.policies.racing.entry import race_deployed
    from simgap.policies.racing.laps import fly_laps
    from simgap.recordings.recording import write_recording
    from simgap.stages._lap_tables import write_laps
    from simgap.stages._pilots import entered

    chosen = config.evaluate
    entry = entered(chosen, config.platform, config.track, config.train_policy, config, run)
    platform: Any = platform_from_config(config.platform)
    case: Any = case_from_config(platform.kind, config.record)
    flying = entry.settings.flying
    loop = RateLoop(platform, flying.time_constant, RacedMachines.step)
    logged = min(config.deploy.most_flights, chosen.starts)
    aid = _aid(config, entry.track, case.estimates > 0, run)
    machines = RacedMachines(case, platform, loop, chosen.starts, chosen.seconds, config.seed, logged, aid)
    deployed = Deployed(lambda state, reference: machines.fly(state, reference, flying.period))
    race = race_deployed(deployed, platform, entry.track, entry.settings, chosen.starts)
    laps = fly_laps(race, entry.pilot, config.seed, chosen.laps, chosen.seconds)
    in_flight = laps.states[:, :, 0].isfinite().numpy()
    run.log_metrics(laps.metrics() | machines.estimates(in_flight))
    write_laps(laps, race.track, entry.track.name, race.period, run)
    lengths = in_flight[:, :logged].sum(0) * race.period
    recording = machines.recording(_whole_flights(lengths, config.deploy))
    write_recording(recording, run.output / "recording.parquet")


def _aid(config: DeployStage, track: TrackSettings, estimated: bool, run: StageRun) -> "Aid":
    """Return what takes the drift off the estimates of machines.

    Raises:
        InputError: on a detector that cannot be flown with.
    """
    from simgap.plants.estimator import STEP, Aid
    from simgap.stages._sights import chain_through, detector_folder, distances_seen

    settings, perception = config.deploy, config.perception
    folder = detector_folder(settings, perception, config)
    if folder and not estimated:
        remedy = "give record.estimates=1.0, or leave the detector out"
        raise InputError("leaves no error of an estimate to correct", "record.estimates", remedy)
    if folder:
        return Aid(sight=chain_through(folder, perception, track, config.evaluate.starts, STEP, config, run))
    return Aid(distances_seen(perception, track) if settings.gates else None, forgets=settings.forgets)


def _whole_flights(lengths: "NDArray[np.float64]", chosen: Deployment) -> "NDArray[np.float64]":
    """Return the lengths, s, of the first flights that together are as many and as long as asked for."""
    import numpy as np

    enough = int(np.searchsorted(np.cumsum(lengths), chosen.recorded_seconds)) + 1
    return lengths[: max(enough, chosen.flights)]


def _drive(config: DeployStage, run: StageRun) -> None:
    """Drive the smoothed voltages of motions in several trials each and report where the robot stops."""
    import pandas as pd

    from simgap.policies.profile.storage import read_motions

    planned = read_motions(run.input(_plan(config)))
    tables = []
    for name in dict.fromkeys([config.deploy.motion, *config.deploy.beside]):
        trials, measures = _driven(name, _chosen(planned, name), config, run)
        tables.append(_table(name, trials))
        prefix = "" if name == config.deploy.motion else f"{name}/"
        run.log_metrics({f"{prefix}{measure}": value for measure, value in measures.items()})
    pd.concat(tables, ignore_index=True).to_parquet(run.output / TRIALS, index=False)


def _driven(
    name: str, motion: "Motion", config: DeployStage, run: StageRun
) -> "tuple[list[Trial], dict[str, float]]":
    """Drive a motion; return its trials, and what was foreseen and came out."""
    from simgap.policies.profile.contenders import measures
    from simgap.policies.profile.motion import drive_open_loop
    from simgap.policies.profile.smoothing import smoothed
    from simgap.report.motions import draw_motions
    from simgap.stages._drives import IDENTIFIED, driven_in, identified, policies

    task = config.profile
    drive = identified(config.platform, task, config, run)
    driven = driven_in(policies(task).get(name, IDENTIFIED), drive, config.platform, config, run)
    voltage = smoothed(drive, motion, config.deploy.window)
    foreseen = drive_open_loop(drive, voltage, motion.period, driven)
    trials = _trials(config, foreseen)
    shown = [(trial.time, trial.position, trial.velocity) for trial in trials]
    figure = FIGURE if name == config.deploy.motion else f"{name}_{FIGURE}"
    draw_motions({name: foreseen}, task.distance, run.output / figure, shown)
    expected = {f"foreseen/{measure}": value for measure, value in measures(foreseen, task).items()}
    return trials, expected | _outcome(trials, config)


def _plan(config: DeployStage) -> Path:
    """Return the folder of the planned motions, whether or not it exists."""
    from simgap.policies.profile.storage import FILE

    return Path(config.deploy.plan) / FILE if config.deploy.plan else config.artifact("profile", FILE)


def _chosen(motions: "Mapping[str, Motion]", name: str) -> "Motion":
    from simgap.runner.project import nearest

    if name not in motions:
        raise InputError(f"there is no motion {name!r}", "deploy.motion", nearest(name, motions))
    return motions[name]


def _trials(config: DeployStage, motion: "Motion") -> "list[Trial]":
    from simgap.plants import case_from_config
    from simgap.plants.swerve.open_loop import drive_trials
    from simgap.platforms import platform_from_config

    platform: Any = platform_from_config(config.platform)
    case: Any = case_from_config("swerve", config.record)
    settings = config.deploy
    return drive_trials(
        case, platform, motion.voltage, motion.period, settings.trials, settings.scatter, config.seed
    )


def _table(name: str, trials: "list[Trial]") -> Any:
    import pandas as pd

    rows = [
        pd.DataFrame({"motion": name, "trial": number + 1} | vars(trial))
        for number, trial in enumerate(trials)
    ]
    return pd.concat(rows, ignore_index=True)


def _outcome(trials: "list[Trial]", config: DeployStage) -> dict[str, float]:
    """Return where the trials came to rest, m, when, s, with the spreads, and how many did so within what is asked."""
    import numpy as np

    settings, target = config.deploy, config.profile.distance
    ends = np.array([np.hypot(trial.position[-1] - target, trial.aside[-1]) for trial in trials])
    still = [
        trial.time[np.flatnonzero(np.abs(trial.velocity) >= config.profile.speed_tolerance)[-1]]
        for trial in trials
    ]
    return {
        "trials/number": float(len(trials)),
        "trials/inside": float((ends <= settings.within).sum()),
        "trials/mean_miss": float(ends.mean()),
        "trials/spread_miss": _spread(ends),
        "trials/worst_miss": float(ends.max()),
        "trials/time": float(np.mean(still)),
        "trials/spread_time": _spread(np.array(still)),
    }


def _spread(values: "NDArray[np.float64]") -> float:
    """Return the standard deviation over the trials; NaN of a single one."""
    return float(values.std(ddof=1)) if len(values) > 1 else float("nan")


if __name__ == "__main__":
    from simgap.runner.command import main

    main(deploy)
