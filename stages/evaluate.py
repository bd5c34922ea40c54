"""The stage that flies a policy."""

import logging
from dataclasses import dataclass, field
from pathlib import Path

from pipeline.policies.settings import PolicyEvaluation
from pipeline.stage import StageConfig, StageRun, stage


@dataclass
class EvaluateStage(StageConfig):
    """What evaluating a policy reads of the configuration."""

    evaluate: PolicyEvaluation = field(default_factory=PolicyEvaluation)


@stage(EvaluateStage)
def evaluate(config: EvaluateStage, run: StageRun) -> None:
    """Race a policy through its track from perturbed starts, and say how fast and how safely it flew."""
    chosen = config.evaluate
    folder = run.input(Path(chosen.policy) if chosen.policy else config.artifact("train_policy", ""))
    if not chosen.policy and not (folder / "policy").exists():
        logging.getLogger("simgap").info("evaluate: nothing is flown, since no policy was trained")
        (run.output / "metrics.json").write_text("{}\n")
        return
    _race(folder if chosen.policy else folder / "policy", config, run)


def _race(folder: Path, config: EvaluateStage, run: StageRun) -> None:
    from pipeline.policies.networks import Policy
    from pipeline.policies.racing.entry import race_from, race_in
    from pipeline.policies.racing.laps import fly_laps
    from pipeline.policies.storage import load_policy
    from stages._flown import write_laps
    from stages._simulators import chosen_simulator

    chosen = config.evaluate
    gaussian, description = load_policy(folder)
    track, settings = race_from(description.configuration, chosen.powertrain)
    platform = description.configuration["platform"]
    simulator, _ = chosen_simulator(chosen.simulator, platform, config, run)
    race = race_in(simulator, track, settings, chosen.starts)
    policy = Policy(gaussian)
    laps = fly_laps(race, lambda seen: policy(seen.policy), config.seed, chosen.laps, chosen.seconds)
    run.log_metrics(laps.metrics())
    write_laps(laps, race.track, race.period, run)


if __name__ == "__main__":
    evaluate.main()
