"""Floor 0: what makes a function a stage."""

from simgap.runner.config import StageConfig
from simgap.runner.run import StageRun
from simgap.runner.seed import seed_everything
from simgap.runner.wrapper import Stage, stage

__all__ = ["Stage", "StageConfig", "StageRun", "seed_everything", "stage"]
