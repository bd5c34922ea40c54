"""Floor 0: runs a function as a pipeline stage: configuration, tracking, outputs, command line, sweeps."""

from simgap.runner.config import StageConfig
from simgap.runner.run import StageRun, in_pipeline
from simgap.runner.seed import seed_everything
from simgap.runner.wrapper import Stage, stage

__all__ = ["Stage", "StageConfig", "StageRun", "in_pipeline", "seed_everything", "stage"]
