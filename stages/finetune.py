"""The stage that fine-tunes a policy with the residuals of its own flights."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simgap.policies.settings import PolicyFinetuning, PolicyTraining
from simgap.runner import StageConfig, StageRun, stage
from simgap.stages._trainings import trained

if TYPE_CHECKING:
    from simgap.policies.storage import Description


@dataclass
class FinetuneStage(StageConfig):
    """The configuration of fine-tuning."""

    train_policy: PolicyTraining = field(default_factory=PolicyTraining)
    finetune: PolicyFinetuning = field(default_factory=PolicyFinetuning)


@stage(FinetuneStage)
def finetune(config: FinetuneStage, run: StageRun) -> None:
    """Fine-tune a policy in the simulator plus the residuals of its flights on the plant."""
    from simgap.policies.racing.entry import gone_on_with, trained_race
    from simgap.policies.storage import load_policy

    chosen = config.finetune
    if not chosen.enabled:
        run.leave_out("finetune: no policy is fine-tuned, because finetune.enabled is false")
        return
    chosen.check()
    policy = Path(chosen.policy) if chosen.policy else config.artifact("train_policy", "policy")
    residual = Path(chosen.residual) if chosen.residual else config.artifact("identify_residual", "")
    _, description = load_policy(run.input(policy))
    track, racing = trained_race(description.configuration)
    training = replace(
        config.train_policy,
        simulator=chosen.simulator or str(residual / "simulator"),
        observation=_if_there(residual / "observation"),
        start=str(policy),
        start_deviation=chosen.deviation,
        learning=replace(config.train_policy.learning, **_learning(description, chosen)),
        racing=gone_on_with(racing, chosen.randomised, chosen.thrust),
    )
    trained(training, track, description.configuration["platform"], config, run)


def _if_there(folder: Path) -> str | None:
    return str(folder) if folder.is_dir() else None


def _learning(description: "Description", chosen: PolicyFinetuning) -> dict[str, Any]:
    """Return the learning of the policy, except for what is chosen anew."""
    return {
        **description.configuration["learning"],
        "interactions": chosen.interactions,
        "learning_rate": chosen.learning_rate,
        "final_learning_rate": chosen.final_learning_rate,
    }


if __name__ == "__main__":
    from simgap.runner.command import main

    main(finetune)
