"""The configuration that all stages share."""

from dataclasses import dataclass, field
from pathlib import Path

from simgap.comparison.settings import Results
from simgap.tracking.config import Tracking


@dataclass
class StageConfig:
    """The keys that all stages share; a stage adds the top-level keys of `conf/config.yaml` that it reads.

    Attributes:
        name: the branch: what the artifacts are called together.
        artifacts: the directory of the branch's artifacts.
        seed: of every random draw.
        output: the directory to write; `artifacts/STAGE` when null.
        tracking: where runs are logged.
        results: how the jobs of a sweep are compared.
    """

    name: str = "default"
    artifacts: str = "artifacts/${name}"
    seed: int = 0
    output: str | None = None
    tracking: Tracking = field(default_factory=Tracking)
    results: Results = field(default_factory=Results)

    def artifact(self, stage: str, file: str) -> Path:
        """Return the path of a file that a stage of the same branch has written."""
        return Path(self.artifacts) / stage / file
