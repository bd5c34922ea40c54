"""The stage that plans the fastest rest-to-rest motion of a swerve drive."""

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simgap.artifacts import checkpoint_folder, remove_checkpoint
from simgap.comparison.comparison import Metrics
from simgap.policies.profile.settings import Profile
from simgap.runner import StageConfig, StageRun, in_pipeline, stage

if TYPE_CHECKING:
    from simgap.policies.best import Best
    from simgap.policies.networks import Gaussian
    from simgap.policies.profile.drive import Drive
    from simgap.policies.profile.motion import Motion

FIGURE = "motions.svg"
IMPROVEMENTS = "improvements.svg"
_DRAWN = 8  # of the policies that were better than all before them, in the picture of a training


@dataclass
class ProfileStage(StageConfig):
    """The configuration of motion profiles."""

    platform: dict[str, Any] = field(default_factory=dict)
    profile: Profile = field(default_factory=Profile)


def compared(metrics: Mapping[str, Any]) -> dict[str, Metrics]:
    """Return the measures of the policy, and those of all that it is held against."""
    from simgap.policies.profile.contenders import POLICY

    found: dict[str, Metrics] = {}
    for key, value in metrics.items():
        name, slash, measure = key.rpartition("/")
        if slash and not name.startswith("training"):
            found.setdefault("" if name == POLICY else name, {})[measure] = value
    return found


@stage(ProfileStage, compared)
def profile(config: ProfileStage, run: StageRun) -> None:
    """Compare rest-to-rest motions: classical profiles, policies trained by PPO, and the time-optimal bound."""
    from simgap.platforms import Swerve, platform_from_config

    if in_pipeline() and not isinstance(platform_from_config(config.platform), Swerve):
        run.leave_out("profile: nothing is planned, because the platform is no swerve drive")
        return
    _plan(config, run)


def _plan(config: ProfileStage, run: StageRun) -> None:
    from simgap.policies.profile import contenders
    from simgap.policies.profile.storage import write_motions
    from simgap.report.motions import draw_motions
    from simgap.stages._drives import identified, policies

    task = config.profile
    task.check()
    drive = identified(config.platform, task, config, run)
    motions = contenders.classical(task, drive)
    for name, choice in policies(task).items():
        motions[name] = _learned(name, choice, config, drive, run)
    motions |= contenders.bounds(task, drive)
    write_motions(motions, run.output)
    draw_motions(motions, task.distance, run.output / FIGURE)
    found = _compared_measures(motions, task)
    for name in policies(task):
        if math.isnan(found[f"{name}/time"]):
            said = "the policy" if name == contenders.POLICY else name
            run.warn(f"{said} does not arrive: train it longer, or widen profile.narrow")
    run.log_metrics(found)


def _learned(name: str, choice: str, config: ProfileStage, drive: "Drive", run: StageRun) -> "Motion":
    """Train a policy, or go on where a training was killed; return what the fastest of its checkpoints does."""
    from simgap.policies.best import Best
    from simgap.policies.export import export_policy
    from simgap.policies.networks import Gaussian, Policy
    from simgap.policies.profile.environment import MotionProfile
    from simgap.policies.profile.rollout import drive_by_policy
    from simgap.policies.storage import Description, save_policy
    from simgap.policies.training import Training, final
    from simgap.stages._drives import driven_in

    task, driven = config.profile, driven_in(choice, drive, config.platform, config, run)

    def driven_by(gaussian: Gaussian) -> "Motion":
        return drive_by_policy(Policy(gaussian), task, drive, driven)

    machines = MotionProfile(task, drive, task.learning.machines, driven=driven)
    best = Best(
        lambda gaussian: driven_by(gaussian).arrival(task.distance, task.tolerance, task.speed_tolerance)
    )
    training = Training(machines, task.learning, config.seed, best)
    inputs = sorted(run.inputs.values())
    checkpoint = checkpoint_folder(config.artifacts, [asdict(task), config.seed, inputs, choice])
    curve = training.run(checkpoint, run.log_metrics)
    remove_checkpoint(checkpoint)
    run.log_metrics({f"training/{name}/{measure}": value for measure, value in final(curve).items()})
    gaussian = training.learner.gaussian
    description = Description(
        task="motion_profile",
        observation_size=MotionProfile.observation_size,
        action_size=MotionProfile.action_size,
        period=task.period,
        hidden=list(task.learning.hidden),
        slope=task.learning.slope,
        configuration=asdict(task),
        chosen_by=f"the fastest in the simulator {choice!r}, of those at the checkpoints and the last",
        measures=final(curve),
    )
    save_policy(gaussian, description, run.output / name)
    export_policy(gaussian, run.output / name)
    _draw_improvements(best, gaussian, driven_by, task.distance, run.output / f"{name}_{IMPROVEMENTS}")
    return driven_by(gaussian)


def _draw_improvements(
    best: "Best", gaussian: "Gaussian", driven_by: "Callable[[Gaussian], Motion]", target: float, path: Path
) -> None:
    """Draw what the policies did that were faster than all before them, evenly chosen; the best is the last."""
    import numpy as np

    from simgap.report.motions import draw_motions

    costs = best.costs
    motions = {}
    for number in np.linspace(0, len(costs) - 1, min(len(costs), _DRAWN)).astype(int):
        best.restore(gaussian, int(number))
        motions[f"{number + 1}: {costs[number]:.3f} s"] = driven_by(gaussian)
    if motions:
        draw_motions(motions, target, path)


def _compared_measures(motions: "Mapping[str, Motion]", task: Profile) -> dict[str, float]:
    """Return the measures of all motions, with how much faster each is than as published, and over the bound."""
    from simgap.policies.profile.contenders import BOUND, PUBLISHED, measures

    found = {name: measures(motion, task) for name, motion in motions.items()}
    published, bound = found[PUBLISHED]["time"], found[BOUND]["time"]
    for values in found.values():
        values["faster"] = 1.0 - values["time"] / published
        values["over_bound"] = values["time"] / bound - 1.0
    return {f"{name}/{key}": value for name, values in found.items() for key, value in values.items()}


if __name__ == "__main__":
    from simgap.runner.command import main

    main(profile)
