"""The stage that finds what a simulator still misses in flights of a policy."""

import logging
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pipeline.policies.residual.settings import DynamicsSettings, ObservationSettings, ResidualSettings
from pipeline.recordings.cleaning.settings import Cleaning
from pipeline.recordings.dataset import Dataset
from pipeline.stage import StageConfig, StageRun, stage

if TYPE_CHECKING:
    from pipeline.recordings.recording import Recording
    from pipeline.simulation import Simulator


@dataclass
class IdentifyResidualStage(StageConfig):
    """What finding residuals reads of the configuration."""

    platform: dict[str, Any] = field(default_factory=dict)
    dataset: Dataset = field(default_factory=Dataset)
    clean: Cleaning = field(default_factory=Cleaning)
    residual: ResidualSettings = field(default_factory=ResidualSettings)


@stage(IdentifyResidualStage)
def identify_residual(config: IdentifyResidualStage, run: StageRun) -> None:
    """Find what the on-board estimate and the simulator get wrong along recorded flights."""
    from pipeline.platforms import Quadrotor, platform_from_config
    from stages._simulators import chosen_simulator

    chosen, path = config.residual, _recorded(config)
    if not path.exists() or not isinstance(platform_from_config(config.platform), Quadrotor):
        logging.getLogger("simgap").info(
            "identify_residual: there are no flights whose residual could be found"
        )
        (run.output / "metrics.json").write_text("{}\n")
        return
    recording = _flights(config, run.input(path))
    simulator, _ = chosen_simulator(chosen.simulator, config.platform, config, run)
    metrics = _dynamics(simulator, recording, chosen.dynamics, run)
    if chosen.observation.enabled and "estimate_position_x" in recording.frame:
        metrics |= _observation(recording, chosen.observation, config.seed, run)
    run.log_metrics(metrics)


def _recorded(config: IdentifyResidualStage) -> Path:
    """Return where the flights are: those that are named, those of a deployed policy, or those of the branch."""
    if config.residual.recording:
        return Path(config.residual.recording)
    deployed = config.artifact("deploy", "recording.parquet")
    return deployed if deployed.exists() else config.artifact("clean", "recording.parquet")


def _flights(config: IdentifyResidualStage, path: Path) -> "Recording":
    """Return a recording, cleaned if it is not yet, no longer than asked for."""
    from pipeline.policies.residual.excerpt import first_seconds
    from pipeline.recordings.cleaning import clean_recording
    from pipeline.recordings.recording import read_recording, require_kind

    recording = read_recording(path, "quadrotor")
    require_kind(recording, "quadrotor", str(path))
    if not recording.cleaned:
        recording, _ = clean_recording(recording, config.clean, config.dataset.split, config.seed)
    return first_seconds(recording, config.residual.seconds)


def _dynamics(
    simulator: "Simulator", recording: "Recording", chosen: DynamicsSettings, run: StageRun
) -> dict[str, float]:
    """Write the simulator with what it leaves over; return how much that is, m/s²."""
    from pipeline.policies.residual.accelerations import left_over, nearest_of
    from pipeline.simulation import FittedEffect, write_simulator

    if not chosen.enabled:
        write_simulator(simulator, run.output / "simulator")
        return {}
    platform: Any = simulator.platform
    features, residual = left_over(simulator, recording, chosen.width)
    nearest = nearest_of(features, residual, chosen.samples, chosen.neighbours, platform)
    augmented = simulator.with_effects((*simulator.effects, FittedEffect(nearest, {}, known=True)))
    write_simulator(augmented, run.output / "simulator")
    size = residual.square().mean(0).sqrt().tolist()
    return {f"residual_force_{axis}": value for axis, value in zip("xyz", size, strict=True)}


def _observation(
    recording: "Recording", chosen: ObservationSettings, seed: int, run: StageRun
) -> dict[str, float]:
    """Write drawn residuals of the estimate and their picture; return how large the residuals are, m, m/s and rad."""
    from pipeline.policies.residual.beliefs import RESIDUALS, recorded_beliefs
    from pipeline.policies.residual.gaussian_processes import fit
    from pipeline.policies.residual.realisations import draw
    from pipeline.policies.residual.storage import save_observation
    from pipeline.report.realisations import draw_realisations

    features, residual = recorded_beliefs(recording.frame, chosen.samples)
    processes = fit(features, residual, chosen.judged_by, chosen.iterations)
    drawn = draw(processes, chosen.realisations, chosen.frequencies, chosen.anchors, seed)
    save_observation(processes, drawn, recording.source, run.output / "observation")
    draw_realisations(recording.frame, drawn, run.output / "realisations.png")
    size = residual.square().mean(0).sqrt().tolist()
    return {f"misjudged_{name}": value for name, value in zip(RESIDUALS, size, strict=True)}


if __name__ == "__main__":
    identify_residual.main()
