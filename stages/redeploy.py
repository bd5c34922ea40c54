"""The stage that takes the policy that was trained further back to the concealed plant."""

from dataclasses import replace

from simgap.runner import StageRun, stage
from simgap.stages.deploy import DeployStage, race


@stage(DeployStage)
def redeploy(config: DeployStage, run: StageRun) -> None:
    """Race the policy that was trained further, as deploy did with the one that it comes from."""
    policy = config.artifact("finetune", "policy")
    if policy.exists():
        race(replace(config, evaluate=replace(config.evaluate, policy=str(policy))), run)
        return
    run.leave_out("redeploy: nothing is deployed, since no policy was trained further")


if __name__ == "__main__":
    from simgap.runner.command import main

    main(redeploy)
