"""The stage that runs the fine-tuned policy on the simulated plant."""

from dataclasses import replace

from simgap.runner import StageRun, stage
from simgap.stages.deploy import DeployStage, race


@stage(DeployStage)
def redeploy(config: DeployStage, run: StageRun) -> None:
    """Race the fine-tuned policy on the simulated plant, as `deploy` did with the policy before."""
    policy = config.artifact("finetune", "policy")
    if policy.exists():
        race(replace(config, evaluate=replace(config.evaluate, policy=str(policy))), run)
        return
    run.leave_out("redeploy: nothing is deployed, because no policy was fine-tuned")


if __name__ == "__main__":
    from simgap.runner.command import main

    main(redeploy)
