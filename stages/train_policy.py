"""The stage that trains a policy in a simulator."""

import json
import logging
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pipeline.artifacts import checkpoint_folder, remove_checkpoint
from pipeline.errors import InputError
from pipeline.policies.racing.settings import TASK, TrackSettings
from pipeline.policies.settings import PolicyTraining
from pipeline.stage import StageConfig, StageRun, stage

if TYPE_CHECKING:
    from pipeline.policies.training import Training


@dataclass
class TrainPolicyStage(StageConfig):
    """What training a policy reads of the configuration."""

    platform: dict[str, Any] = field(default_factory=dict)
    track: TrackSettings = field(default_factory=TrackSettings)
    train_policy: PolicyTraining = field(default_factory=PolicyTraining)


@stage(TrainPolicyStage)
def train_policy(config: TrainPolicyStage, run: StageRun) -> None:
    """Train a policy in a simulator by PPO, to race through the gates of a track."""
    task = config.train_policy.task
    if task is None:
        logging.getLogger("simgap").info(
            "train_policy: no policy is trained, since train_policy.task is null"
        )
        (run.output / "metrics.json").write_text("{}\n")
        return
    if task != TASK:
        raise InputError(f"there is no task {task!r}", "train_policy.task", f"use {TASK}")
    _train(config, run)


def _train(config: TrainPolicyStage, run: StageRun) -> None:
    from pipeline.policies.racing.entry import race_in
    from pipeline.policies.training import Training, final
    from stages._simulators import chosen_simulator

    chosen, track = config.train_policy, config.track
    simulator, simulator_hash = chosen_simulator(chosen.simulator, config.platform, config, run)
    race = race_in(simulator, track, chosen.racing, chosen.learning.machines, chosen.device)
    training = Training(race, chosen.learning, config.seed)
    identity = [asdict(chosen), asdict(track), config.platform, config.seed, simulator_hash]
    checkpoint = checkpoint_folder(config.artifacts, identity)
    curve = training.run(checkpoint, run.log_metrics)
    measures = final(curve)
    (run.output / "curve.json").write_text(json.dumps(curve) + "\n")
    _write(training, config, simulator_hash, measures, run.output / "policy")
    run.log_metrics(measures)
    remove_checkpoint(checkpoint)


def _write(
    training: "Training",
    config: TrainPolicyStage,
    simulator: str,
    measures: dict[str, float],
    folder: Path,
) -> None:
    """Write the policy for this project, and for machines that know nothing of it."""
    from pipeline.policies.export import export_policy
    from pipeline.policies.racing.entry import described_race
    from pipeline.policies.racing.racing import Racing
    from pipeline.policies.storage import Description, save_policy

    chosen = config.train_policy
    configuration = {
        **described_race(config.track, chosen.racing),
        "platform": config.platform,
        "learning": asdict(chosen.learning),
        "seed": config.seed,
    }
    description = Description(
        TASK,
        Racing.observation_size,
        Racing.action_size,
        chosen.racing.flying.period,
        chosen.learning.hidden,
        chosen.learning.slope,
        configuration,
        simulator,
        f"the last of {chosen.learning.interactions} interactions",
        measures,
    )
    save_policy(training.learner.gaussian, description, folder)
    export_policy(training.learner.gaussian, folder)


if __name__ == "__main__":
    train_policy.main()
