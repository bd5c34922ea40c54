"""The stage that flies a race in a simulator."""

from dataclasses import dataclass, field
from typing import Any

from simgap.gates.settings import TrackSettings
from simgap.policies.settings import PolicyEvaluation, PolicyTraining
from simgap.runner import StageConfig, StageRun, stage


@dataclass
class EvaluateStage(StageConfig):
    """The configuration of policy evaluation."""

    platform: dict[str, Any] = field(default_factory=dict)
    track: TrackSettings = field(default_factory=TrackSettings)
    train_policy: PolicyTraining = field(default_factory=PolicyTraining)
    evaluate: PolicyEvaluation = field(default_factory=PolicyEvaluation)


@stage(EvaluateStage)
def evaluate(config: EvaluateStage, run: StageRun) -> None:
    """Race a policy in simulation from perturbed starts; report lap times and crashes."""
    from simgap.stages._pilots import is_entered

    if not is_entered(config.evaluate, config):
        run.leave_out("evaluate: nothing is flown, because no policy was trained")
        return
    _race(config, run)


def _race(config: EvaluateStage, run: StageRun) -> None:
    from simgap.policies.racing.entry import race_in
    from simgap.policies.racing.flying import left_out
    from simgap.policies.racing.laps import fly_laps
    from simgap.stages._lap_tables import write_laps
    from simgap.stages._pilots import entered
    from simgap.stages._simulators import chosen_simulator

    chosen = config.evaluate
    entry = entered(chosen, config.platform, config.track, config.train_policy, config, run)
    simulator, _ = chosen_simulator(chosen.simulator, entry.platform, config, run)
    for effect in left_out(simulator, entry.settings.flying):
        run.warn(effect)
    race = race_in(simulator, entry.track, entry.settings, chosen.starts)
    laps = fly_laps(race, entry.pilot, config.seed, chosen.laps, chosen.seconds)
    run.log_metrics(laps.metrics())
    write_laps(laps, race.track, entry.track.name, race.period, run)


if __name__ == "__main__":
    from simgap.runner.command import main

    main(evaluate)
