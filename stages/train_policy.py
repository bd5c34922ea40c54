"""The stage that trains a policy in a simulator."""

from dataclasses import dataclass, field
from typing import Any

from simgap.errors import InputError
from simgap.gates.settings import TrackSettings
from simgap.policies.racing.settings import TASK
from simgap.policies.settings import PolicyTraining
from simgap.runner import StageConfig, StageRun, in_pipeline, stage
from simgap.stages._trainings import trained


@dataclass
class TrainPolicyStage(StageConfig):
    """The configuration of policy training."""

    platform: dict[str, Any] = field(default_factory=dict)
    track: TrackSettings = field(default_factory=TrackSettings)
    train_policy: PolicyTraining = field(default_factory=PolicyTraining)


@stage(TrainPolicyStage)
def train_policy(config: TrainPolicyStage, run: StageRun) -> None:
    """Train a racing policy in a simulator by PPO."""
    task = config.train_policy.task
    if task is None and in_pipeline():
        run.leave_out("train_policy: no policy is trained, because the branch sets no task")
        return
    if task is None:
        missing = (
            "train_policy=racing_quick" if config.platform else "platform=racer train_policy=racing_quick"
        )
        raise InputError(
            "no task is set, so there is nothing to train", "train_policy.task", f"give {missing}"
        )
    if task != TASK:
        raise InputError(f"there is no task {task!r}", "train_policy.task", f"use {TASK}")
    trained(config.train_policy, config.track, config.platform, config, run)


if __name__ == "__main__":
    from simgap.runner.command import main

    main(train_policy)
