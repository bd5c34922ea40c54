"""Floor 0: what makes a function a stage."""

from pipeline.stage.config import StageConfig
from pipeline.stage.run import StageRun
from pipeline.stage.seed import seed_everything
from pipeline.stage.wrapper import Stage, stage

__all__ = ["Stage", "StageConfig", "StageRun", "seed_everything", "stage"]
