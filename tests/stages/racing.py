"""A training of a policy that is far too short, and how a stage is run on it."""

from typing import Any

import pytest

from simgap.runner.command import main

RACE = ("platform=racer", "track=tiny", "train_policy=racing_quick", "tracking.enabled=false")
FEW = (
    *RACE,
    "train_policy.learning.interactions=12_000",
    "train_policy.learning.machines=32",
    "train_policy.learning.horizon=16",
    "train_policy.learning.minibatch=128",
    "train_policy.learning.checkpoint_every=3",
    "train_policy.racing.flying.substeps=2",
    "train_policy.racing.flying.integrator=euler",
)


def ran(stage: Any, *overrides: str) -> None:
    """Run the command in this process, which has paid for its imports."""
    with pytest.raises(SystemExit) as ended:
        main(stage, [*overrides])
    assert ended.value.code == 0
