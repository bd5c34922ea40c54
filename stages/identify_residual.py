"""The stage that identifies the residual of a simulator from flights of a policy."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simgap.gap.settings import Gap
from simgap.policies.residual.settings import DynamicsSettings, ObservationSettings, ResidualSettings
from simgap.recordings.cleaning.settings import Cleaning
from simgap.recordings.dataset import Dataset
from simgap.runner import StageConfig, StageRun, stage

if TYPE_CHECKING:
    from simgap.recordings.recording import Recording
    from simgap.simulation import Simulator


@dataclass
class IdentifyResidualStage(StageConfig):
    """The configuration of residual identification."""

    platform: dict[str, Any] = field(default_factory=dict)
    dataset: Dataset = field(default_factory=Dataset)
    clean: Cleaning = field(default_factory=Cleaning)
    gap: Gap = field(default_factory=Gap)
    residual: ResidualSettings = field(default_factory=ResidualSettings)


@stage(IdentifyResidualStage)
def identify_residual(config: IdentifyResidualStage, run: StageRun) -> None:
    """Identify the errors of the on-board estimate and of the simulator along recorded flights."""
    from simgap.platforms import Quadrotor, platform_from_config
    from simgap.simulation import write_simulator
    from simgap.stages._simulators import chosen_simulator

    chosen, path = config.residual, _path_of_flights(config)
    unflown = not chosen.recording and not path.exists()
    if unflown or not isinstance(platform_from_config(config.platform), Quadrotor):
        run.leave_out("identify_residual: nothing is identified, because there are no recorded flights")
        return
    recording = _flights(config, run.input(path))
    simulator = _physics(chosen_simulator(chosen.simulator, config.platform, config, run)[0])
    if chosen.name_first:
        simulator = _named(recording, simulator, config.gap)
    augmented, metrics = _dynamics(simulator, recording, chosen.dynamics)
    write_simulator(augmented, run.output / "simulator")
    metrics |= _predicted(augmented, config, run)
    if chosen.observation.enabled and "estimate_position_x" in recording.frame:
        metrics |= _observation(recording, chosen.observation, config.seed, run)
    run.log_metrics(metrics)


def _physics(simulator: "Simulator") -> "Simulator":
    """Return a simulator without a residual that was found before: this stage finds all that the physics leaves."""
    from simgap.simulation.knn_residual import RecordedResidual

    kept = [fitted for fitted in simulator.effects if not isinstance(fitted.effect, RecordedResidual)]
    return simulator.with_effects(tuple(kept))


def _named(recording: "Recording", simulator: "Simulator", settings: Gap) -> "Simulator":
    from simgap.diagnosis.diagnose import diagnose

    return diagnose(recording, simulator, settings).simulator


def _path_of_flights(config: IdentifyResidualStage) -> Path:
    """Return where the flights are: those that are named, those of a deployed policy, or those of the branch."""
    if config.residual.recording:
        return Path(config.residual.recording)
    deployed = config.artifact("deploy", "recording.parquet")
    return deployed if deployed.exists() else config.artifact("clean", "recording.parquet")


def _flights(config: IdentifyResidualStage, path: Path) -> "Recording":
    """Return the flights to learn from: none that is held out to be predicted, and no longer than asked for."""
    from simgap.recordings.excerpt import first_seconds, of_runs
    from simgap.recordings.split import runs_of

    recording, chosen = _cleaned(config, path), config.residual
    if chosen.scored_on:
        held_out = runs_of(recording.split, "holdout")
        recording = of_runs(recording, [run for run in recording.runs if run not in held_out])
    return first_seconds(recording, chosen.seconds)


def _cleaned(config: IdentifyResidualStage, path: Path) -> "Recording":
    """Return a recording, cleaned if it is not yet."""
    from simgap.recordings.cleaning import clean_recording
    from simgap.recordings.recording import read_recording, require_kind

    recording = read_recording(path, "quadrotor")
    require_kind(recording, "quadrotor", str(path))
    if recording.cleaned:
        return recording
    return clean_recording(recording, config.clean, config.dataset.split, config.seed)[0]


def _dynamics(
    simulator: "Simulator", recording: "Recording", chosen: DynamicsSettings
) -> "tuple[Simulator, dict[str, float]]":
    """Return the simulator with what it leaves over, and how much that is, m/s²."""
    from simgap.policies.residual.accelerations import left_over, nearest_of
    from simgap.simulation import FittedEffect

    if not chosen.enabled:
        return simulator, {}
    platform: Any = simulator.platform
    features, residual = left_over(simulator, recording, chosen.width)
    nearest = nearest_of(features, residual, chosen.samples, chosen.neighbours, platform)
    size = residual.square().mean(0).sqrt().tolist()
    metrics = {f"residual_force_{axis}": value for axis, value in zip("xyz", size, strict=True)}
    return simulator.with_effects((*simulator.effects, FittedEffect(nearest, {}, known=True))), metrics


def _predicted(simulator: "Simulator", config: IdentifyResidualStage, run: StageRun) -> dict[str, float]:
    """Return how far predictions of runs that were held out are off, in SI units."""
    from simgap.recordings.excerpt import of_runs
    from simgap.recordings.split import require_holdout, runs_of
    from simgap.simulation import replay_error
    from simgap.simulation.blocks import cut_blocks

    metrics: dict[str, float] = {}
    horizon = config.residual.score_horizon
    for name, path in config.residual.scored_on.items():
        recording = _cleaned(config, run.input(Path(path)))
        require_holdout(recording.split, path)
        held_out = of_runs(recording, runs_of(recording.split, "holdout"))
        blocks = cut_blocks(held_out, simulator.platform, 2.0 * horizon, horizon)
        errors = replay_error(simulator, blocks, horizon)
        metrics |= {f"{name}/{key.removeprefix('replay_error_')}": value for key, value in errors.items()}
    return metrics


def _observation(
    recording: "Recording", chosen: ObservationSettings, seed: int, run: StageRun
) -> dict[str, float]:
    """Write drawn residuals of the estimate and their picture; return how large the residuals are, m, m/s and rad."""
    from simgap.policies.residual.beliefs import RESIDUALS, recorded_beliefs
    from simgap.policies.residual.gaussian_processes import fit
    from simgap.policies.residual.realisations import draw
    from simgap.policies.residual.storage import save_observation
    from simgap.report.realisations import draw_realisations

    beliefs = recorded_beliefs(recording.frame, chosen.samples)
    processes = fit(*beliefs, chosen.judged_by, chosen.iterations)
    drawn = draw(processes, chosen.realisations, chosen.frequencies, chosen.anchors, seed)
    save_observation(processes, drawn, recording.source, run.output / "observation")
    draw_realisations(recording.frame, drawn, run.output / "realisations.png")
    size = beliefs.residual.square().mean(0).sqrt().tolist()
    return {f"misjudged_{name}": value for name, value in zip(RESIDUALS, size, strict=True)}


if __name__ == "__main__":
    from simgap.runner.command import main

    main(identify_residual)
