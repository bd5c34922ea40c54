"""Training of a policy, from scratch or from another policy."""

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simgap.gates.settings import TrackSettings
from simgap.policies.racing.settings import TASK
from simgap.policies.settings import PolicyTraining
from simgap.runner import StageConfig, StageRun

if TYPE_CHECKING:
    from simgap.policies.racing.racing import Misjudging
    from simgap.policies.training import Training


def trained(
    chosen: PolicyTraining,
    track: TrackSettings,
    platform: Mapping[str, Any],
    config: StageConfig,
    run: StageRun,
) -> None:
    """Train a policy and write it with its learning curve; an interrupted training is resumed.

    Args:
        chosen: what is trained, in what and from where.
        track: to race on.
        platform: whose own dynamics an ideal simulator is.
        config: of the stage.
        run: of the stage.

    Raises:
        InputError: when there is no such simulator, policy or residual, or a number is none to learn with.
    """
    from simgap.artifacts import checkpoint_folder, remove_checkpoint
    from simgap.policies.racing.entry import race_in
    from simgap.policies.racing.flying import left_out
    from simgap.policies.training import Training, final
    from simgap.stages._simulators import chosen_simulator

    chosen.learning.check("train_policy.learning")
    simulator, simulator_hash = chosen_simulator(chosen.simulator, platform, config, run)
    for effect in left_out(simulator, chosen.racing.flying):
        run.warn(effect)
    misjudging = _misjudging(chosen, run)
    machines = chosen.learning.machines
    race = race_in(simulator, track, chosen.racing, machines, chosen.device, misjudging)
    training = Training(race, chosen.learning, config.seed)
    if chosen.start:
        _go_on(training, run.input(Path(chosen.start)))
    if chosen.start_deviation:
        training.learner.gaussian.widen(chosen.start_deviation)
    identity = [asdict(chosen), asdict(track), dict(platform), config.seed, simulator_hash, run.inputs]
    checkpoint = checkpoint_folder(config.artifacts, identity)
    curve = training.run(checkpoint, run.log_metrics)
    measures = final(curve)
    (run.output / "curve.json").write_text(json.dumps(curve) + "\n")
    _write(training, chosen, track, platform, config.seed, simulator_hash, measures, run.output / "policy")
    run.log_metrics(measures)
    run.say(
        "{gates_per_second:.2f} gates and {crashes_per_second:.3f} crashes a second in the end".format(
            **measures
        )
    )
    remove_checkpoint(checkpoint)


def _misjudging(chosen: PolicyTraining, run: StageRun) -> "Misjudging | None":
    from simgap.policies.residual.misjudging import DrawnMisjudging
    from simgap.policies.residual.storage import load_observation

    if chosen.observation is None:
        return None
    return DrawnMisjudging(load_observation(run.input(Path(chosen.observation))), chosen.device)


def _go_on(training: "Training", folder: Path) -> None:
    """Start a training from the policy and the critic of another one."""
    from simgap.policies.storage import load_critic, load_policy

    learner = training.learner
    learner.gaussian.load_state_dict(load_policy(folder)[0].state_dict())
    load_critic(learner.critic, folder)


def _write(
    training: "Training",
    chosen: PolicyTraining,
    track: TrackSettings,
    platform: Mapping[str, Any],
    seed: int,
    simulator: str,
    measures: dict[str, float],
    folder: Path,
) -> None:
    """Write the policy in the format of this project and in one that needs nothing of it."""
    from simgap.policies.export import export_policy
    from simgap.policies.racing.entry import described_race
    from simgap.policies.racing.racing import Racing
    from simgap.policies.storage import Description, save_policy

    configuration = {
        **described_race(track, chosen.racing),
        "platform": platform,
        "learning": asdict(chosen.learning),
        "seed": seed,
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
    save_policy(training.learner.gaussian, description, folder, training.learner.critic)
    export_policy(training.learner.gaussian, folder)
